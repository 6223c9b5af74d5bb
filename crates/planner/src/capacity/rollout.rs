//! A mission without inertia: from pose to pose, each robot in its slot and commanded as R2P2 commands it.
//!
//! # Source
//! [R2P2] §IV: primitives, roles and speeds are those of [`cohaul_core::control::r2p2`]; how load and robots answer is
//! [`quasistatic`](super::quasistatic).
//!
//! # Deviations
//! - Robots never leave their slots, so nothing is said about the time that repositioning takes.
//! - Supporting robots stand. Near the limit the load creeps, from one stop of the team to the next; their commands are
//!   truncated to nothing then, and the load that leans on one of them on a slope rubs along it.
//! - Of the controller's keys those of gaps, supporting robots and turning pushers (`gap_gain`, `support`, `push_turns`) are not
//!   looked at: the verdict is for the recommended laws.
//! - Between the load and the others there is no friction: it would hold the load as often as help it.
//!
//! [R2P2]: cohaul_core::_documentation::references

use cohaul_core::contact::limit_surface::LimitSurface;
use cohaul_core::contact::slope::Slope;
use cohaul_core::control::guidance::{self, Guidance, Progress};
use cohaul_core::control::r2p2::{Parameters, TOLERANCES, prevent_speed, push_speed};
use cohaul_core::robot::RobotModel;
use cohaul_core::scenario::document::{Prevent, Stance};
use cohaul_core::se2::{Pose2, Twist2, exp, perpendicular, position, yaw};
use cohaul_core::transport::formation::{Formation, Slot};
use cohaul_core::transport::primitive::Primitive;
use cohaul_core::transport::role::{self, Role};
use nalgebra::Vector2;

use super::quasistatic::{Contact, Ground, Motion, motion};
use crate::conic::ConicError;
use crate::formation::Demand;

/// Everything that decides whether a team moves a load of a given mass.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    pub formation: Formation,
    pub model: RobotModel,
    /// Shape of the load's friction on the ground.
    pub surface: LimitSurface,
    /// Half the load's extent across its heading, m.
    pub half_length: f64,
    /// Mass of the load in the scenario, kg.
    pub mass: f64,
    /// Between robot and load.
    pub contact_friction: f64,
    /// Between a sliding load and the ground.
    pub friction_dynamic: f64,
    /// Between a resting load and the ground.
    pub friction_static: f64,
    /// Between wheels and ground.
    pub friction_wheel: f64,
    /// Where the load starts.
    pub world_from_load: Pose2,
    /// Where the load has to go.
    pub guidance: Guidance,
    /// s.
    pub time_limit: f64,
    pub parameters: Parameters,
}

/// What stopped a mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// The load does not move.
    Stuck,
    /// Nothing holds the load.
    Runaway,
    /// The load moves, but not to where it should.
    Astray,
    /// The load moves, but not fast enough for the time allowed.
    TooSlow,
}

/// Where a mission ended before its goal.
#[derive(Clone, Debug)]
pub(crate) struct Failure {
    pub cause: Cause,
    pub demand: Demand,
    /// Leg of the mission, from 0.
    pub leg: usize,
    /// Robots whose wheels slip, by their places.
    pub at_limit: Vec<usize>,
}

/// Speed below which the load is stuck, m/s.
const STUCK: f64 = 2e-3;
/// Distance and turn of the load per step, m and rad.
const STRIDE: (f64, f64) = (0.05, 0.05);
/// Turn of the load after which it is asked anew whether the robots hold it, rad.
const HOLD_AGAIN: f64 = 0.1;
/// Longest step, s.
const LONGEST: f64 = 1.0;
/// Steps, beyond those for the way itself, after which the load goes nowhere.
const STEPS: usize = 3000;
/// A load that recedes from its waypoint by more than this is lost, m.
const RECEDED: f64 = 1.0;
/// Speed at which a supporting robot lets a load come that leans on it, m/s: it stands a gap away from the load.
const SETTLE: f64 = 1e-3;
/// Speed by which a preventing robot in contact gives way faster than the pace, m/s.
const YIELD: f64 = 0.01;

/// Moves a load of `mass` kg over `slope` from the start to the goal.
pub(crate) fn roll(task: &Task, mass: f64, slope: &Slope) -> Result<(), Failure> {
    let mut pose = task.world_from_load;
    let mut progress = Progress::default();
    let mut leg = 0;
    let mut started = f64::INFINITY;
    let mut twist = Twist2::ZERO;
    let mut forces = vec![0.0; task.formation.slots().len()];
    let mut time = 0.0;
    let (slides, mut held) = (slope.slides(task.friction_static), f64::INFINITY);
    let way = task.guidance.waypoints.iter().fold((0.0, position(&pose)), |(way, at), p| (way + (p - at).norm(), *p)).0;
    for _ in 0..STEPS + (4.0 * way / STRIDE.0) as usize {
        let Some(next) = task.guidance.next(&mut progress, &pose) else { return Ok(()) };
        let distance = next.distance;
        if usize::from(progress.waypoint) > leg || started.is_infinite() {
            leg = usize::from(progress.waypoint);
            started = distance;
        }
        let chosen = next.primitive;
        let step = Step { task, slope, heading: yaw(&pose), next, twist };
        let fail = |cause, demand, motion: Option<&Motion>| Failure {
            cause,
            demand,
            leg,
            at_limit: motion.map_or_else(
                || (0..forces.len()).collect(),
                |m| (0..m.slips.len()).filter(|i| m.slips[*i] && m.forces[*i] > 1e-3).collect(),
            ),
        };
        let contacts = step.contacts(&forces);
        let demand = Demand::Move(chosen);
        if slides && (yaw(&pose) - held).abs() > HOLD_AGAIN {
            held = yaw(&pose);
            if !step.holds(mass, &contacts) {
                return Err(fail(Cause::Runaway, Demand::Hold, None));
            }
        }
        let Ok(moved) = step.motion(mass, &contacts) else { return Err(fail(Cause::Runaway, demand, None)) };
        let speed = moved.twist.linear.norm();
        let rate = moved.twist.angular.abs();
        if is_stuck(&moved.twist, task) {
            return Err(fail(Cause::Stuck, demand, Some(&moved)));
        }
        if distance > started + RECEDED {
            return Err(fail(Cause::Astray, demand, Some(&moved)));
        }
        if time > task.time_limit {
            return Err(fail(Cause::TooSlow, demand, Some(&moved)));
        }
        let (far, turned) = step.strides();
        let dt = (far / speed.max(1e-9)).min(turned / rate.max(1e-9)).min(LONGEST);
        time += dt;
        twist = moved.twist;
        forces = moved.forces;
        pose *= exp(&Twist2 { linear: twist.linear * dt, angular: twist.angular * dt });
    }
    let demand = Demand::Move(progress.primitive.unwrap_or(Primitive::Translate));
    Err(Failure { cause: Cause::Astray, demand, leg, at_limit: Vec::new() })
}

/// Whether the load as good as rests.
fn is_stuck(twist: &Twist2, task: &Task) -> bool {
    twist.linear.norm() + twist.angular.abs() * task.half_length < STUCK
}

/// One instant of a mission.
struct Step<'a> {
    task: &'a Task,
    slope: &'a Slope,
    /// Of the load, rad.
    heading: f64,
    /// What the load shall do.
    next: guidance::Motion,
    /// Of the load a step before, in its own frame.
    twist: Twist2,
}

impl Step<'_> {
    /// How far the load may move, m, and turn, rad, until the next look: near its goal and its heading no farther than half of
    /// what is left, or half of the tolerance.
    fn strides(&self) -> (f64, f64) {
        let guidance = &self.task.guidance;
        let narrow = |left: f64, tolerance: f64, stride: f64| (0.5 * left).min(stride).max(0.25 * tolerance);
        let band = guidance.goal_yaw.map_or(guidance.release, |goal| goal.tolerance.min(guidance.release));
        let turned = narrow(self.next.heading_error.abs(), band.max(1e-3), STRIDE.1);
        (narrow(self.next.distance, guidance.tolerance, STRIDE.0).min(STRIDE.0), turned.min(STRIDE.1))
    }

    /// Gravity along the ground in the load's frame, m/s².
    fn gravity(&self) -> Vector2<f64> {
        let (sin, cos) = (-self.heading).sin_cos();
        cohaul_core::se2::rotate(&self.slope.tangential, sin, cos)
    }

    fn motion(&self, mass: f64, contacts: &[Contact]) -> Result<Motion, ConicError> {
        let task = self.task;
        let normal = mass * self.slope.normal;
        let weight = mass * self.gravity();
        let ground = |friction: f64| Ground { surface: &task.surface, limit: friction * normal, weight };
        if task.friction_static > task.friction_dynamic {
            // it has to break away first, again after every stop
            let still = motion(&ground(task.friction_static), contacts)?;
            if is_stuck(&still.twist, task) {
                return Ok(still);
            }
        }
        motion(&ground(task.friction_dynamic), contacts)
    }

    /// Whether the robots keep the load in its place while all of them stand.
    fn holds(&self, mass: f64, contacts: &[Contact]) -> bool {
        let standing: Vec<Contact> =
            contacts.iter().map(|c| Contact { command: Vector2::zeros(), rubbing: 0.0, ..*c }).collect();
        self.motion(mass, &standing).is_ok_and(|motion| is_stuck(&motion.twist, self.task))
    }

    /// The robots, given the contact forces of the step before.
    fn contacts(&self, forces: &[f64]) -> Vec<Contact> {
        let task = self.task;
        let traction = task.friction_wheel * task.model.mass_on_wheels * self.slope.normal;
        let weight = task.model.mass * self.gravity();
        let slots = task.formation.slots().iter().zip(forces);
        slots
            .map(|(slot, force)| {
                let (command, role) = self.command(slot);
                // who pushes or gives way moves along with the load; who supports has to be passed by it
                let rubbing = if role == Role::Support { task.contact_friction * force } else { 0.0 };
                Contact { point: slot.contact, facing: slot.facing, command, traction, weight, rubbing }
            })
            .collect()
    }

    /// Velocity of a robot's wheels, load frame, m/s ([R2P2] §IV-C), and its role.
    ///
    /// [R2P2]: cohaul_core::_documentation::references
    fn command(&self, slot: &Slot) -> (Vector2<f64>, Role) {
        let p = &self.task.parameters;
        let center = slot.center(self.task.formation.radius(), self.task.formation.gap());
        let lever = center.norm();
        let next = &self.next;
        let half_length = self.task.half_length;
        let role = role::assign(next.primitive, &center, &slot.facing, &next.direction, half_length, &TOLERANCES);
        let path = match next.primitive {
            Primitive::Translate => Vector2::x(),
            Primitive::Rotate(turn) => turn.sign() * perpendicular(&center) / lever,
        };
        let axis = match (p.stance, path.dot(&slot.facing) < 0.0) {
            (Stance::Square, _) => slot.facing,
            (Stance::Arc, true) => -path,
            (Stance::Arc, false) => path,
        };
        let pace = match next.primitive {
            Primitive::Translate => push_speed(next.distance, p.translation_gain, p.speed_min, p.speed_max),
            Primitive::Rotate(_) => {
                let follows = match p.stance {
                    Stance::Arc => (lever / self.task.formation.outermost()).min(1.0),
                    Stance::Square => 1.0,
                };
                let fastest = (p.speed_max * follows).max(p.speed_min);
                push_speed(next.heading_error.abs(), p.rotation_gain, p.speed_min, fastest)
            }
        };
        let velocity = match role {
            Role::Push => pace * axis,
            Role::Prevent => match p.prevent {
                Prevent::Paced => -(pace.min(p.load_speed_max) + YIELD) * axis,
                Prevent::Literal => {
                    prevent_speed(self.twist.linear.norm(), self.twist.angular, lever, p.load_speed_max) * axis
                }
            },
            Role::Support => -SETTLE * slot.facing,
        };
        (velocity, role)
    }
}
