//! Virtual leader and followers: the baseline that R2P2 is compared with.
//!
//! # Source
//! [R2P2] §V-A, eq. 6, Fig. 5: the load's centre is the leader. To turn the load, every robot drives to its place turned about
//! the centre by the whole angle, rᵢ′ = c + R(θ)(rᵢ − c), minding its position only; to move the load, all robots drive at one
//! constant velocity towards the waypoint. Robots reposition themselves as in R2P2: when a translation begins, and every 25
//! control steps of it. `θ` → `turn`, `c` → `center`.
//!
//! # Deviations
//! The paper gives no law for the way to rᵢ′ and no speed. Here:
//! - A differential drive heads for its place, forwards or backwards, whichever turns less, and slows down while it is off its
//!   bearing. While the load translates it stands along the direction of travel.
//! - A robot that has arrived while the load lags behind computes a new place from where it is; otherwise it would stand
//!   still until the time is over.
//! - An omnidirectional base keeps facing the edge and drives straight: the kind of robot that [Wan2017] used, whom the paper
//!   cites for the method.
//!
//! [R2P2]: crate::_documentation::references
//! [Wan2017]: crate::_documentation::references

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::guidance::{Guidance, Motion, Progress, Task};
use super::{Command, ControlError, Controller, Decision, Observation, Phase};
use crate::kinematics::BaseLimits;
use crate::scenario::document;
use crate::se2::{position, rotate, wrap_angle, yaw};
use crate::time::Time;
use crate::transport::formation::Slot;
use crate::transport::primitive::Primitive;
use crate::transport::reposition::{Deviation, Repositioning};

/// Feedback of a heading error, 1/s.
const HEADING_GAIN: f64 = 3.0;
/// Heading error at which a robot only turns, rad.
const TURN_FIRST: f64 = 0.8;

/// The place that a robot drives to while the load turns (eq. 6), world frame, m.
///
/// ```
/// # use cohaul_core::control::vlf::turned_place;
/// # use nalgebra::Vector2;
/// let place = turned_place(&Vector2::new(1.0, 1.0), &Vector2::new(2.0, 1.0), std::f64::consts::FRAC_PI_2);
/// assert!((place - Vector2::new(1.0, 2.0)).norm() < 1e-12);
/// ```
pub fn turned_place(center: &Vector2<f64>, at: &Vector2<f64>, turn: f64) -> Vector2<f64> {
    center + turned(&(at - center), turn)
}

/// `v` turned by `angle` rad.
fn turned(v: &Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    rotate(v, sin, cos)
}

/// The follower's controller.
#[derive(Clone, Debug)]
pub struct Vlf {
    keys: document::Vlf,
    guidance: Guidance,
    manoeuvre: Repositioning,
    slot: Slot,
    place: usize,
    radius: f64,
    gap: f64,
    limits: BaseLimits,
}

/// What a follower carries from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    progress: Progress,
    phase: Phase,
    /// Where it drives to while the load turns, world frame, m.
    target: Option<[f64; 2]>,
    /// Control steps since the last check of the slot.
    since_check: u32,
    /// When the current manoeuvre began.
    began: Time,
}

impl Vlf {
    /// The controller of one robot.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(keys: &document::Vlf, task: Task<'_>) -> Result<Self, ControlError> {
        let mut keys = *keys;
        for (parameter, value) in [("rate_hz", keys.rate_hz), ("speed", keys.speed), ("speed_max", keys.speed_max)] {
            if value.is_nan() || value <= 0.0 {
                return Err(ControlError::Parameter { parameter, value, expected: "positive" });
            }
        }
        keys.speed = keys.speed.min(task.limits.linear);
        keys.speed_max = keys.speed_max.min(task.limits.linear);
        Ok(Self {
            slot: task.slot()?,
            manoeuvre: Repositioning::default(),
            place: task.place,
            radius: task.formation.radius(),
            gap: task.formation.gap(),
            limits: task.limits,
            guidance: Guidance {
                waypoints: task.waypoints,
                tolerance: task.tolerance,
                goal_yaw: task.goal_yaw,
                threshold: keys.heading_threshold,
                release: keys.heading_release,
                wrap: true,
                either_way: false,
            },
            keys,
        })
    }

    /// Whether the base drives in any direction.
    fn is_omnidirectional(&self) -> bool {
        self.limits.lateral > 0.0
    }

    /// The command that moves the robot at `velocity` (world frame, m/s), facing `facing` where it can choose.
    fn toward(&self, velocity: &Vector2<f64>, heading: f64, facing: f64) -> Command {
        if self.is_omnidirectional() {
            let in_robot = turned(velocity, -heading);
            let turn = wrap_angle(facing - heading);
            return Command { linear: in_robot.x, lateral: in_robot.y, angular: HEADING_GAIN * turn };
        }
        let mut error = wrap_angle(velocity.y.atan2(velocity.x) - heading);
        let mut speed = velocity.norm();
        if error.abs() > FRAC_PI_2 {
            error = wrap_angle(error + std::f64::consts::PI);
            speed = -speed;
        }
        let ease = (1.0 - error.abs() / TURN_FIRST).max(0.0);
        Command::drive(speed * ease, HEADING_GAIN * error)
    }

    /// Drives to the turned place; new places are computed when the old ones are reached.
    fn turn(&self, memory: &mut Memory, motion: &Motion, observation: &Observation, facing: f64) -> Command {
        let at = position(&observation.world_from_robot);
        let center = position(&observation.world_from_load);
        let heading = yaw(&observation.world_from_robot);
        let old = memory.target.map(|[x, y]| Vector2::new(x, y));
        let target = match old {
            Some(target) if (target - at).norm() > self.keys.arrival => target,
            _ => turned_place(&center, &at, motion.heading_error),
        };
        memory.target = Some([target.x, target.y]);
        let way = target - at;
        if way.norm() < f64::EPSILON {
            return Command::STOP;
        }
        let speed = (self.keys.gain * way.norm()).min(self.keys.speed_max);
        self.toward(&(way.normalize() * speed), heading, facing)
    }

    fn limited(&self, command: Command) -> Command {
        let Command { linear, lateral, angular } = command;
        Command {
            linear: linear.clamp(-self.limits.linear, self.limits.linear),
            lateral: lateral.clamp(-self.limits.lateral, self.limits.lateral),
            angular: angular.clamp(-self.limits.angular, self.limits.angular),
        }
    }
}

impl Controller for Vlf {
    type Memory = Memory;

    fn step(&self, memory: &mut Memory, observation: &Observation) -> Result<Decision, ControlError> {
        if !observation.is_finite() {
            let time_s = observation.time.seconds();
            return Err(ControlError::NotFinite { robot: observation.robot, time_s });
        }
        let keys = &self.keys;
        let load_from_robot = observation.world_from_load.inv_mul(&observation.world_from_robot);
        let deviation = Deviation::new(&self.slot, self.radius, &load_from_robot);
        let mut decision = Decision {
            slot_tangential: deviation.tangential,
            slot_gap: deviation.gap,
            slot_heading: deviation.heading,
            ..Decision::default()
        };
        let motion = self.guidance.next(&mut memory.progress, &observation.world_from_load);
        decision.waypoint = memory.progress.waypoint;
        let Some(motion) = motion else {
            memory.phase = Phase::Done;
            decision.phase = Phase::Done;
            decision.waypoint += 1;
            return Ok(decision);
        };
        decision.primitive = Some(motion.primitive);
        decision.heading_error = motion.heading_error;
        decision.distance = motion.distance;

        let translates = motion.primitive == Primitive::Translate;
        if translates || motion.changed {
            // a place of an earlier turn is no target, even if this turn begins while the robot holds
            memory.target = None;
        }
        let peers_hold = observation.stop_flags.any_but(self.place);
        memory.since_check += 1;
        if !memory.phase.is_repositioning() {
            let begins = translates && motion.changed;
            let due =
                memory.phase != Phase::Done && (begins || (translates && memory.since_check >= keys.check_interval));
            if due {
                memory.since_check = 0;
            }
            let off = deviation.tangential.abs() > keys.reposition_tangential
                || deviation.gap > keys.reposition_gap
                || (begins && deviation.heading.abs() > keys.reposition_heading);
            memory.phase = if due && keys.reposition && off {
                memory.began = observation.time;
                self.manoeuvre.first_phase(&deviation)
            } else if peers_hold {
                Phase::Hold
            } else {
                Phase::Work
            };
        }
        let heading = yaw(&observation.world_from_robot);
        let facing = yaw(&observation.world_from_load) + self.slot.facing.y.atan2(self.slot.facing.x);
        let command = match memory.phase {
            Phase::Work if translates => {
                let along = turned(&motion.direction, yaw(&observation.world_from_load));
                self.toward(&(keys.speed * along), heading, facing)
            }
            Phase::Work => self.turn(memory, &motion, observation, facing),
            Phase::Hold | Phase::Done | Phase::Teleport => Command::STOP,
            phase => {
                let (mut phase, command) = self.manoeuvre.step(phase, &deviation, self.gap, false);
                if observation.time.since(memory.began) > self.manoeuvre.timeout {
                    phase = Phase::Work;
                }
                memory.phase = phase;
                if phase == Phase::Work { Command::STOP } else { command }
            }
        };
        decision.command = self.limited(command);
        decision.phase = memory.phase;
        decision.stop = memory.phase.is_repositioning();
        Ok(decision)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::StopFlags;
    use crate::geometry::shape::ConvexPolygon;
    use crate::id::RobotId;
    use crate::robot::RobotModel;
    use crate::scenario::document::Slots;
    use crate::se2::{Twist2, pose};
    use crate::transport::formation::Formation;

    /// A turn that began while the robot held its wheels once drove to the place of the turn before.
    #[test]
    fn every_turn_has_places_of_its_own() {
        let load = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
        let formation = Formation::new(&load, &Slots::Six, 6, 0.175, 0.01, 0.105).unwrap();
        let task = Task {
            formation: &formation,
            place: 0,
            half_length: 0.675,
            waypoints: vec![Vector2::new(1.0, 0.0)],
            tolerance: 0.1,
            goal_yaw: None,
            limits: RobotModel::TURTLEBOT3_BURGER.limits,
        };
        let follower = Vlf::new(&document::Vlf::default(), task).unwrap();
        let mut memory = Memory::default();
        let mut tick = |seconds: f64, heading: f64, flags: u64| {
            let world_from_load = pose(0.0, 0.0, heading);
            let observation = Observation {
                time: Time::from_seconds(seconds),
                sampled: Time::from_seconds(seconds),
                robot: RobotId(0),
                world_from_robot: world_from_load * formation.load_from_robot(0),
                world_from_load,
                load_twist_in_world: Twist2::ZERO,
                stop_flags: StopFlags(flags),
            };
            follower.step(&mut memory, &observation).unwrap();
            memory.target
        };
        let first = tick(0.0, 0.5, 0).unwrap();
        assert_eq!(tick(0.1, 0.0, 0), None); // translates
        assert_eq!(tick(0.2, -0.5, 2), None); // the second turn begins while a peer repositions itself
        let second = tick(0.3, -0.5, 0).unwrap();
        assert_ne!(first, second);
        // the slot turned by the whole error lies where the slot of the aligned load is
        let expected = position(&formation.load_from_robot(0));
        assert!((Vector2::from(second) - expected).norm() < 1e-9, "{second:?} {expected}");
    }
}
