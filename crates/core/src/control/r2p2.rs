//! R2P2: roles with rules and proportional-control primitives.
//!
//! # Source
//! [R2P2] §IV. Per tick: primitive (§IV-A, [`guidance`](super::guidance)), role (§IV-B, [`role`]), speeds (§IV-C, eqs. 3–5),
//! and at intervals the check of the own slot ([`Repositioning`]). `v_b`, `ω_b` → `load_twist`, `r` → `lever`, `1/k_p` → `rotation_gain`,
//! `translation_gain` (Table III tunes the reciprocals), `v_min` → `speed_min`, `v_max` of eq. 4 → `load_speed_max`.
//!
//! # Deviations
//! Those that change a printed law have a key of their own in the scenario file; `variant: literal` switches all of these off.
//! - `wrap`: the yaw error is the shortest signed angle; the paper compares |θ_c| with |θ_R|.
//! - `heading_release` < `heading_threshold`: hysteresis, so that a rotation does not stop at the edge of its tolerance.
//! - `turn_with_load`: ω has the sense of ω_b. A robot that stays at its place of the load turns with it; the printed −ω_b
//!   holds only if ω is counted clockwise.
//! - `gap_gain`: eq. 4 moves a preventing robot as fast as the load already moves; it is brought back to the edge when it
//!   has run ahead.
//! - `push_turns`: eq. 3 has ω = 0, which lets the heading error grow with the load's rotation.
//! - `support: track`: eq. 5 lets a robot that faces the short end back straight off; the prose wants it to trace its place.
//! - `stance: arc`: robots stand along the path of their slot instead of square to the edge. Eqs. 4 and 5 give the speed
//!   ω_b r of the slot on its arc; a robot square to the edge cannot follow that arc and has to reposition itself.
//! - `prevent: paced`: a preventing robot gives way at the speed that the pushing robots aim at (eq. 3, which it can work out
//!   by itself) instead of the speed that the load has. Eq. 4 is a unit feedback: a load at rest between pushing and
//!   preventing robots stays at rest, a load that a slope accelerates takes them along.
//! - `drive: nearest`, goals with an orientation, turns across the half turn: see [`super::guidance`].
//! - `reposition: teleport` puts a robot into its slot at once, as §VI does; only a simulator can.
//! - |ω_b| in eq. 4, which otherwise drives preventing robots forward in clockwise turns.
//!
//! [R2P2]: crate::_documentation::references

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

mod parameters;

use super::guidance::{Guidance, Progress, Task};
use super::{Command, ControlError, Controller, Decision, Observation, Phase};
use crate::kinematics::BaseLimits;
use crate::scenario::document::{self, Drive, Prevent, Reposition, Stance, Support};
use crate::se2::{Twist2, cross, perpendicular, position, unit, wrap_angle, yaw};
use crate::time::Time;
use crate::transport::formation::Slot;
use crate::transport::primitive::Primitive;
use crate::transport::reposition::{Deviation, Repositioning};
use crate::transport::role::{self, Role, RoleTolerances};

pub use parameters::Parameters;

/// Lever arm below which a robot turns the load not at all, and ε of the rule |w_i| > L/2 + ε, m.
pub const TOLERANCES: RoleTolerances = RoleTolerances { side: 0.02, torque: 0.05 };
/// Feedback of a heading error while working, 1/s.
const HEADING_GAIN: f64 = 1.0;
/// The same where the robot has to turn to its arc, 1/s.
const ARC_HEADING_GAIN: f64 = 3.0;
/// Steering per deviation from the slot's path, rad/m, and its limit, rad.
const STEERING: (f64, f64) = (3.0, 0.35);
/// Speed by which a preventing robot in contact gives way faster than the pace, m/s: more than commands are truncated by.
const YIELD: f64 = 0.02;
/// Deviation along the edge that a robot following its slot may have, relative to the others.
const TRACKING_LAG: f64 = 2.5;
/// Heading error at which a robot on its arc only turns, rad.
const TURN_FIRST: f64 = 0.5;

/// Forward speed of a robot in [`Role::Push`] (eq. 3), m/s.
///
/// `error` is in metres while translating and in radians while rotating; `gain` is the reciprocal of the paper's k_p.
///
/// ```
/// # use cohaul_core::control::r2p2::push_speed;
/// assert_eq!(push_speed(0.5, 0.3, 0.05, 0.22), 0.15);
/// assert_eq!(push_speed(0.0, 0.3, 0.05, 0.22), 0.05); // never below speed_min
/// assert_eq!(push_speed(9.0, 0.3, 0.05, 0.22), 0.22); // never above speed_max
/// ```
pub fn push_speed(error: f64, gain: f64, speed_min: f64, speed_max: f64) -> f64 {
    (gain * error).clamp(speed_min, speed_max)
}

/// Forward speed of a robot in [`Role::Prevent`] (eq. 4), m/s: it gives way at the load's speed, at most `speed_max`.
///
/// `lever` is the distance of its slot from the load's centre, m.
///
/// ```
/// # use cohaul_core::control::r2p2::prevent_speed;
/// assert_eq!(prevent_speed(0.1, -0.2, 0.5, 0.3), -0.2); // the sense of the rotation does not matter
/// assert_eq!(prevent_speed(0.4, 0.0, 0.5, 0.3), -0.3);
/// ```
pub fn prevent_speed(load_speed: f64, load_yaw_rate: f64, lever: f64, speed_max: f64) -> f64 {
    -(load_speed + load_yaw_rate.abs() * lever).min(speed_max)
}

/// Forward speed of a robot in [`Role::Support`] as printed (eq. 5), m/s.
///
/// ```
/// # use cohaul_core::control::r2p2::support_speed;
/// assert_eq!(support_speed(0.1, 0.2, 0.5), 0.0);
/// ```
pub fn support_speed(load_speed: f64, load_yaw_rate: f64, lever: f64) -> f64 {
    -load_speed + load_yaw_rate * lever
}

/// R2P2 of one robot.
#[derive(Clone, Debug)]
pub struct R2p2 {
    parameters: Parameters,
    manoeuvre: Repositioning,
    slot: Slot,
    /// Place in the team.
    place: usize,
    radius: f64,
    gap: f64,
    /// Greatest distance of a slot from the load's centre, m.
    outermost: f64,
    /// Half the load's extent across its heading, m.
    half_length: f64,
    guidance: Guidance,
    limits: BaseLimits,
}

/// What a robot carries from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    progress: Progress,
    phase: Phase,
    /// Control steps since the last check of the slot.
    since_check: u32,
    /// When the current manoeuvre began.
    began: Time,
}

/// Everything of one tick that the laws need, in the load's frame.
struct Situation {
    primitive: Primitive,
    role: Role,
    /// |v_b|, m/s, and v_b in the load frame.
    load_twist: Twist2,
    heading_error: f64,
    distance: f64,
    deviation: Deviation,
    /// Heading of the robot in the load frame, rad.
    heading: f64,
    /// Robot's centre minus its slot's, load frame, m.
    offset: Vector2<f64>,
}

impl R2p2 {
    /// The controller of one robot.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(keys: &document::R2p2, task: Task<'_>) -> Result<Self, ControlError> {
        let mut parameters = Parameters::new(keys);
        let positive = |parameter, value: f64| {
            if value > 0.0 { Ok(()) } else { Err(ControlError::Parameter { parameter, value, expected: "positive" }) }
        };
        positive("rate_hz", parameters.rate_hz)?;
        positive("speed_max", parameters.speed_max)?;
        parameters.speed_max = parameters.speed_max.min(task.limits.linear);
        if !(0.0..=parameters.speed_max).contains(&parameters.speed_min) {
            return Err(ControlError::Parameter {
                parameter: "speed_min",
                value: parameters.speed_min,
                expected: "between 0 and speed_max",
            });
        }
        let slot = task.slot()?;
        Ok(Self {
            parameters,
            manoeuvre: Repositioning::default(),
            slot,
            place: task.place,
            radius: task.formation.radius(),
            gap: task.formation.gap(),
            outermost: task.formation.outermost(),
            half_length: task.half_length,
            guidance: Guidance {
                waypoints: task.waypoints,
                tolerance: task.tolerance,
                goal_yaw: task.goal_yaw,
                threshold: parameters.heading_threshold,
                release: parameters.heading_release,
                wrap: parameters.wrap,
                either_way: parameters.drive == Drive::Nearest,
            },
            limits: task.limits,
        })
    }

    /// Distance of the slot from the load's centre, m.
    fn lever(&self) -> f64 {
        self.slot.center(self.radius, self.gap).norm()
    }

    /// Unit vector along which the slot moves in the load's frame while the primitive goes on.
    fn path(&self, primitive: Primitive) -> Vector2<f64> {
        match primitive {
            Primitive::Translate => Vector2::x(),
            Primitive::Rotate(turn) => {
                let center = self.slot.center(self.radius, self.gap);
                turn.sign() * perpendicular(&center) / center.norm()
            }
        }
    }

    /// Heading that the robot's role wants, load frame, rad.
    fn wanted_heading(&self, primitive: Primitive, role: Role, heading: f64) -> f64 {
        let facing = self.slot.facing;
        let path = match (role, self.parameters.stance, self.parameters.support) {
            (Role::Support, _, Support::Track) => self.path(primitive),
            (Role::Support, ..) | (_, Stance::Square, _) => return facing.y.atan2(facing.x),
            (_, Stance::Arc, _) => self.path(primitive),
        };
        // forwards or backwards: towards the load, or for a supporting robot whichever turns less
        let toward = match role {
            Role::Support => path.dot(&unit(heading)),
            _ => path.dot(&facing),
        };
        let axis = if toward < 0.0 { -path } else { path };
        axis.y.atan2(axis.x)
    }

    /// Whether the own slot calls for a repositioning.
    fn is_off(&self, situation: &Situation) -> bool {
        let p = &self.parameters;
        let d = &situation.deviation;
        let tracks = self.tracks(situation.role);
        let tangential = if tracks { TRACKING_LAG * p.reposition_tangential } else { p.reposition_tangential };
        let turns_by_itself = tracks || p.stance == Stance::Arc;
        d.tangential.abs() > tangential
            || d.gap > p.reposition_gap
            || (!turns_by_itself && d.heading.abs() > p.reposition_heading)
    }

    /// Whether the role keeps the robot parallel to the edge, following its slot.
    fn tracks(&self, role: Role) -> bool {
        role == Role::Support && self.parameters.support == Support::Track
    }

    /// Speed that the pushing robots aim at (eq. 3), m/s.
    fn pace(&self, s: &Situation) -> f64 {
        let p = &self.parameters;
        match s.primitive {
            Primitive::Translate => push_speed(s.distance, p.translation_gain, p.speed_min, p.speed_max),
            Primitive::Rotate(_) => {
                // no faster than the outermost robot can follow
                let follows = match p.stance {
                    Stance::Arc => (self.lever() / self.outermost).min(1.0),
                    Stance::Square => 1.0,
                };
                let speed_max = (p.speed_max * follows).max(p.speed_min);
                push_speed(s.heading_error.abs(), p.rotation_gain, p.speed_min, speed_max)
            }
        }
    }

    /// Speeds by role (§IV-C).
    fn work(&self, s: &Situation) -> Command {
        let p = &self.parameters;
        let lever = self.lever();
        let load_speed = s.load_twist.linear.norm();
        let turn_rate = if p.turn_with_load { s.load_twist.angular } else { -s.load_twist.angular };
        let wanted = self.wanted_heading(s.primitive, s.role, s.heading);
        let error = wrap_angle(wanted - s.heading);
        let on_arc = p.stance == Stance::Arc;
        let gain = if on_arc { ARC_HEADING_GAIN } else { HEADING_GAIN };
        let pace = self.pace(s);
        match s.role {
            Role::Push => match (p.push_turns, on_arc) {
                (false, _) => Command::drive(pace, 0.0),
                (true, false) => Command::drive(pace, turn_rate + gain * error),
                (true, true) => self.along(s, wanted, pace, turn_rate),
            },
            Role::Prevent => {
                let back = p.gap_gain * (s.deviation.gap - self.gap);
                let linear = match p.prevent {
                    Prevent::Literal => {
                        prevent_speed(load_speed, s.load_twist.angular, lever, p.load_speed_max)
                            + back.clamp(0.0, p.speed_min)
                    }
                    Prevent::Paced => -pace.min(p.load_speed_max) + back.clamp(-YIELD, p.speed_min),
                };
                if on_arc {
                    self.along(s, wanted, linear, turn_rate)
                } else {
                    let feedback = if p.push_turns { gain * error } else { 0.0 };
                    Command::drive(linear, turn_rate + feedback)
                }
            }
            Role::Support => match p.support {
                Support::Park => Command::STOP,
                Support::Literal => Command::drive(support_speed(load_speed, s.load_twist.angular, lever), turn_rate),
                Support::Track => {
                    // the slot's velocity along the robot's axis, plus a pull back to the slot
                    let center = self.slot.center(self.radius, self.gap);
                    let slot_velocity = s.load_twist.velocity_at(&center);
                    let axis = unit(s.heading);
                    let linear = (slot_velocity - 2.0 * s.offset).dot(&axis);
                    self.along(s, wanted, linear, s.load_twist.angular)
                }
            },
        }
    }

    /// Drives at `speed` along the slot's path whose direction is `wanted` (load frame), steering back onto it.
    fn along(&self, s: &Situation, wanted: f64, speed: f64, turn_rate: f64) -> Command {
        // deviation to the left of the path
        let left = cross(&unit(wanted), &s.offset);
        let sense = if speed < 0.0 { -1.0 } else { 1.0 };
        let steer = if speed.abs() > 0.01 { -sense * (STEERING.0 * left).clamp(-STEERING.1, STEERING.1) } else { 0.0 };
        let error = wrap_angle(wanted + steer - s.heading);
        let ease = (1.0 - error.abs() / TURN_FIRST).clamp(0.0, 1.0);
        Command::drive(speed * ease, turn_rate + ARC_HEADING_GAIN * error)
    }

    fn limited(&self, command: Command) -> Command {
        Command {
            linear: command.linear.clamp(-self.limits.linear, self.limits.linear),
            lateral: 0.0,
            angular: command.angular.clamp(-self.limits.angular, self.limits.angular),
        }
    }
}

impl Controller for R2p2 {
    type Memory = Memory;

    fn step(&self, memory: &mut Memory, observation: &Observation) -> Result<Decision, ControlError> {
        if !observation.is_finite() {
            let time_s = observation.time.seconds();
            return Err(ControlError::NotFinite { robot: observation.robot, time_s });
        }
        let p = &self.parameters;
        let load_heading = yaw(&observation.world_from_load);
        let load_from_robot = observation.world_from_load.inv_mul(&observation.world_from_robot);
        let in_load = position(&load_from_robot);
        let facing = self.slot.facing;
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

        let place = self.slot.center(self.radius, self.gap);
        let role = role::assign(motion.primitive, &place, &facing, &motion.direction, self.half_length, &TOLERANCES);
        let situation = Situation {
            primitive: motion.primitive,
            role,
            load_twist: observation.load_twist_in_world.rotated(-load_heading),
            heading_error: motion.heading_error,
            distance: motion.distance,
            deviation,
            heading: yaw(&load_from_robot),
            offset: in_load - place,
        };
        decision.primitive = Some(motion.primitive);
        decision.role = Some(role);
        decision.heading_error = motion.heading_error;
        decision.distance = motion.distance;

        // check of the own slot: at intervals and whenever the primitive changes
        memory.since_check += 1;
        let peers_hold = observation.stop_flags.any_but(self.place);
        if !memory.phase.is_repositioning() || memory.phase == Phase::Teleport {
            let interval_over = memory.since_check >= p.check_interval;
            let due = memory.phase != Phase::Done
                && (motion.changed || interval_over || (peers_hold && memory.phase != Phase::Hold));
            if due {
                memory.since_check = 0;
            }
            memory.phase = if due && p.reposition != Reposition::Never && self.is_off(&situation) {
                memory.began = observation.time;
                match p.reposition {
                    Reposition::Teleport => Phase::Teleport,
                    _ => self.manoeuvre.first_phase(&deviation),
                }
            } else if peers_hold {
                Phase::Hold
            } else {
                Phase::Work
            };
        }
        decision.command = match memory.phase {
            Phase::Hold | Phase::Done | Phase::Teleport => Command::STOP,
            Phase::Work => self.work(&situation),
            _ => {
                let parallel = self.tracks(role) && deviation.gap <= p.reposition_gap;
                let (mut phase, command) = self.manoeuvre.step(memory.phase, &deviation, self.gap, parallel);
                if observation.time.since(memory.began) > self.manoeuvre.timeout {
                    phase = Phase::Work;
                }
                memory.phase = phase;
                if phase == Phase::Work { Command::STOP } else { command }
            }
        };
        decision.command = self.limited(decision.command);
        decision.phase = memory.phase;
        decision.stop = memory.phase.is_repositioning();
        Ok(decision)
    }
}
