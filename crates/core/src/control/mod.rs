//! The decision of one robot: what it sees, what it commands, and why.
//!
//! A controller is its immutable parameters; what it remembers is its `Memory`. The simulator and the robot run the same
//! controllers behind the same [`guard`].
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

pub mod filter;
pub mod flow;
pub mod guard;
pub mod guidance;
pub mod r2p2;
pub mod vlf;

use serde::{Deserialize, Serialize};

use crate::id::RobotId;
use crate::se2::{Pose2, Twist2, is_finite};
use crate::time::Time;
use crate::transport::primitive::Primitive;
use crate::transport::role::Role;

/// Body velocity command: forward and sideways speed, m/s, and yaw rate, rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Forward speed, m/s; negative drives backwards.
    pub linear: f64,
    /// Speed to the left, m/s; only an omnidirectional base can do it.
    pub lateral: f64,
    /// Yaw rate, rad/s, counter-clockwise.
    pub angular: f64,
}

impl Command {
    /// Wheels held still.
    pub const STOP: Self = Self { linear: 0.0, lateral: 0.0, angular: 0.0 };

    /// A command to a differential drive: forward speed, m/s, and yaw rate, rad/s.
    pub const fn drive(linear: f64, angular: f64) -> Self {
        Self { linear, lateral: 0.0, angular }
    }
}

/// Raised stop flags of the peers: one bit per robot of the team, in team order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct StopFlags(pub u64);

impl StopFlags {
    /// Sets or clears the flag of the robot at `place` in its team (0 to 63).
    pub fn set(&mut self, place: usize, raised: bool) {
        let bit = 1_u64 << (place & 63);
        self.0 = if raised { self.0 | bit } else { self.0 & !bit };
    }

    /// Whether any robot but the one at `place` asks the others to stop.
    pub fn any_but(self, place: usize) -> bool {
        self.0 & !(1_u64 << (place & 63)) != 0
    }
}

/// Everything one robot knows at one of its control ticks ([R2P2] §I, assumption iv: own pose, load pose, stop flags).
///
/// [R2P2]: crate::_documentation::references
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Instant of the decision.
    pub time: Time,
    /// Instant at which the poses were measured; never later than `time`.
    pub sampled: Time,
    /// The observing robot.
    pub robot: RobotId,
    /// Pose of the robot.
    pub world_from_robot: Pose2,
    /// Pose of the load; its x axis is the load's heading.
    pub world_from_load: Pose2,
    /// Velocity of the load's centre in the world frame, differentiated from its poses, m/s and rad/s.
    pub load_twist_in_world: Twist2,
    /// Stop flags last heard from the team.
    pub stop_flags: StopFlags,
}

impl Observation {
    /// Whether every number in it is finite.
    pub fn is_finite(&self) -> bool {
        is_finite(&self.world_from_robot)
            && is_finite(&self.world_from_load)
            && self.load_twist_in_world.vector().iter().all(|v| v.is_finite())
    }
}

/// Where a robot stands in its cycle of work and repositioning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Acts on its role.
    #[default]
    Work,
    /// Waits, wheels held, because a peer's stop flag is up.
    Hold,
    /// Repositioning: turns parallel to the edge.
    TurnParallel,
    /// Repositioning: drives along the edge to its slot.
    Slide,
    /// Repositioning: turns to face the edge.
    TurnFacing,
    /// Repositioning: creeps up to the edge.
    Approach,
    /// The last waypoint is reached.
    Done,
    /// Repositioning in simulation only: put into its slot at once.
    Teleport,
}

impl Phase {
    /// Every phase, in the order of their numbers in logs.
    pub const ALL: [Self; 8] = [
        Self::Work,
        Self::Hold,
        Self::TurnParallel,
        Self::Slide,
        Self::TurnFacing,
        Self::Approach,
        Self::Done,
        Self::Teleport,
    ];

    /// Whether the robot repositions itself, and so keeps its stop flag raised.
    pub const fn is_repositioning(self) -> bool {
        matches!(self, Self::TurnParallel | Self::Slide | Self::TurnFacing | Self::Approach | Self::Teleport)
    }
}

/// Why the guard replaced a command by a stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// It did not.
    #[default]
    None,
    /// The poses are older than the limit.
    Stale,
    /// An observation or a command is NaN or infinite.
    NotFinite,
    /// The command exceeds the robot's speed limits.
    OverLimit,
    /// The controller failed.
    Controller,
}

impl Fault {
    /// Every fault, in the order of their numbers in logs.
    pub const ALL: [Self; 5] = [Self::None, Self::Stale, Self::NotFinite, Self::OverLimit, Self::Controller];
}

/// A command together with its reason, so that a log explains behaviour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decision {
    /// What the wheels shall do.
    pub command: Command,
    /// Own stop flag: asks the peers to hold while this robot repositions itself.
    pub stop: bool,
    /// Which motion of the load the robot works for.
    pub primitive: Option<Primitive>,
    /// The robot's role in that motion.
    pub role: Option<Role>,
    /// Where the robot stands in its cycle.
    pub phase: Phase,
    /// Why the guard stopped the robot.
    pub fault: Fault,
    /// Index of the waypoint that the robot drives for; the goal is the last.
    pub waypoint: u16,
    /// Bearing of the waypoint minus the load's heading, (−π, π], rad.
    pub heading_error: f64,
    /// Distance of the load's centre from the waypoint, m.
    pub distance: f64,
    /// Deviation of the robot from its slot along the edge, m.
    pub slot_tangential: f64,
    /// Distance between the robot's body and the edge, m; negative when they overlap.
    pub slot_gap: f64,
    /// Heading of the robot minus the slot's facing, rad.
    pub slot_heading: f64,
}

/// Why a controller could not decide.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ControlError {
    /// The observation carries a NaN or an infinity.
    #[error("observation of robot {robot} at {time_s:.3} s is not finite")]
    NotFinite {
        /// The robot.
        robot: RobotId,
        /// When, s.
        time_s: f64,
    },
    /// A parameter is outside its range.
    #[error("{parameter} is {value}, must be {expected}")]
    Parameter {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// A recorded memory does not belong to this controller.
    #[error("recorded memory does not fit the controller: {reason}")]
    Memory {
        /// What the decoder said.
        reason: String,
    },
}

/// A controller is its immutable parameters; what it remembers is `Memory`.
pub trait Controller {
    /// What it carries from one tick to the next.
    type Memory: Clone + Default + Serialize + serde::de::DeserializeOwned;

    /// Decides one tick. Allocates nothing.
    ///
    /// # Errors
    /// Only for observations no decision can be made from; the guard turns an error into a stop.
    fn step(&self, memory: &mut Self::Memory, observation: &Observation) -> Result<Decision, ControlError>;
}

/// A controller with its memory inside: the object-safe form.
pub trait Step: Send {
    /// Decides one tick. Allocates nothing.
    ///
    /// # Errors
    /// As [`Controller::step`].
    fn step(&mut self, observation: &Observation) -> Result<Decision, ControlError>;

    /// Back to the memory of the first tick.
    fn reset(&mut self);

    /// The memory as JSON, for the log.
    fn memory(&self) -> String;

    /// Restores what [`Step::memory`] gave.
    ///
    /// # Errors
    /// If the text is not a memory of this controller.
    fn restore(&mut self, memory: &str) -> Result<(), ControlError>;
}

/// A controller and its memory.
#[derive(Clone, Debug)]
pub struct Stepper<C: Controller> {
    controller: C,
    memory: C::Memory,
}

impl<C: Controller> Stepper<C> {
    /// With the memory of the first tick.
    pub fn new(controller: C) -> Self {
        Self { controller, memory: C::Memory::default() }
    }
}

impl<C: Controller + Send> Step for Stepper<C>
where
    C::Memory: Send,
{
    fn step(&mut self, observation: &Observation) -> Result<Decision, ControlError> {
        self.controller.step(&mut self.memory, observation)
    }

    fn reset(&mut self) {
        self.memory = C::Memory::default();
    }

    fn memory(&self) -> String {
        serde_json::to_string(&self.memory).unwrap_or_default()
    }

    fn restore(&mut self, memory: &str) -> Result<(), ControlError> {
        self.memory =
            serde_json::from_str(memory).map_err(|error| ControlError::Memory { reason: error.to_string() })?;
        Ok(())
    }
}

impl Step for Box<dyn Step> {
    fn step(&mut self, observation: &Observation) -> Result<Decision, ControlError> {
        (**self).step(observation)
    }

    fn reset(&mut self) {
        (**self).reset();
    }

    fn memory(&self) -> String {
        (**self).memory()
    }

    fn restore(&mut self, memory: &str) -> Result<(), ControlError> {
        (**self).restore(memory)
    }
}
