//! Files of planning problems and of plans.
//!
//! | format | read by | written by |
//! |---|---|---|
//! | libMultiRobotPlanning YAML: agents on a grid, goals given or to be assigned | [`read`] | [`write()`] |
//! | CL-CBS YAML: cars in the plane, and what we add to it | [`read`] | [`write()`] |
//! | CL-CBS `config.yaml` | [`read_config`] | |
//! | MovingAI `.map` with `.scen` | [`movingai::read`] | [`movingai::write()`] |
//! | schedules of libMultiRobotPlanning and CL-CBS | [`schedule::read_grid`], [`schedule::read_car`] | [`schedule::write_grid`], [`schedule::write_car`] |
//!
//! # YAML instances
//! The kind follows from the content: starts of two numbers are cells of a grid, of three are poses of bodies.
//!
//! ```yaml
//! agents:
//! - {name: agent0, start: [0, 3], goal: [3, 1]}
//! - {name: agent1, start: [1, 1], potentialGoals: [[3, 1], [2, 7]]}   # goals to be assigned; may be empty
//! map:
//!   dimensions: [8, 8]
//!   obstacles: [[5, 4], [1, 3]]    # may be absent or empty
//! ```
//!
//! Poses are `[x, y, yaw]` in metres and radians. As in CL-CBS a yaw turns clockwise: the body points along (cos yaw, −sin yaw),
//! so yaws change sign when they are read. What we add:
//!
//! | key | means |
//! |---|---|
//! | `heading: counterclockwise` | yaws turn as everywhere else in this project; `clockwise` is what CL-CBS does |
//! | `vehicle:` | the keys of CL-CBS's `config.yaml`, and `drive: car`, `forward_car` or `differential`, and `stepTime` in s |
//! | `potentialGoals:` | goals to be assigned, for bodies too |
//! | `polygons:` in `map:` | convex polygons as lists of corners |
//!
//! ```
//! use cohaul_planner::instance::Instance;
//! use cohaul_planner::io;
//!
//! let text = "agents: [{name: a, start: [2, 3, 1.57], goal: [9, 3, 0]}]\nmap: {dimensions: [20, 10]}\n";
//! let Instance::Car(cars) = io::read(text, "cars.yaml", &io::Options::default())? else { panic!() };
//! assert_eq!(cars.agents[0].start.rotation.angle(), -1.57);
//!
//! let error = io::read("agents: []\n", "empty.yaml", &io::Options::default()).unwrap_err();
//! assert_eq!(error.to_string(), "empty.yaml:1:1: `map` is missing in the file");
//! # Ok::<(), io::FormatError>(())
//! ```

mod error;
mod instance;
pub mod movingai;
pub mod schedule;
mod vehicle;
mod write;
mod yaml;

pub use error::{FormatError, FormatProblem};
pub use instance::{Document, Options, read, read_document};
pub use vehicle::{Config, read_config};
pub use write::write;

/// Longest file that is read, bytes. Read no more than one byte beyond it: a longer file is refused anyway.
pub const MAX_BYTES: usize = yaml::MAX_BYTES;
/// Most cells of a grid, or of a plane when it is cut into squares of one step's length.
pub const MAX_CELLS: usize = 16 << 20;
/// Most agents.
pub const MAX_AGENTS: usize = 100_000;
/// Most goals of all agents together.
pub const MAX_GOALS: usize = 4 << 20;
/// Most obstacles in the plane, and most corners of one.
pub const MAX_OBSTACLES: usize = 1 << 20;
/// Largest coordinate, metres, and largest yaw.
pub const MAX_COORDINATE: f64 = 1e6;

/// How a file's yaws turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heading {
    /// As in CL-CBS: the body points along (cos yaw, −sin yaw).
    #[default]
    Clockwise,
    /// As everywhere else: the body points along (cos yaw, sin yaw).
    CounterClockwise,
}

impl Heading {
    /// From the yaw of a file to one that turns counter-clockwise, and back.
    pub fn turned(self, yaw: f64) -> f64 {
        match self {
            // no minus before a zero
            Self::Clockwise => 0.0 - yaw,
            Self::CounterClockwise => yaw,
        }
    }
}
