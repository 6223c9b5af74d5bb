//! The log: one MCAP file per episode that alone reproduces its run.
//!
//! # Source
//! [MCAP], profile `ros2`: schemas are concatenated `.msg` texts, payloads CDR. Foxglove, `ros2 bag`, rosbags and pandas
//! read the same file.
//!
//! | topic | type | what |
//! |---|---|---|
//! | `/<robot>/observation` | `cohaul_msgs/Observation` | what a controller saw, bit for bit |
//! | `/<robot>/decision` | `cohaul_msgs/Decision` | what it decided and why, bit for bit |
//! | `/<robot>/memory` | `cohaul_msgs/Memory` | what it remembered at the start and at each reset |
//! | `/<robot>/state`, `/loads/<load>/state` | `cohaul_msgs/RobotState`, `LoadState` | the truth, bit for bit |
//! | `/<robot>/pose`, `/loads/<load>/pose` | `geometry_msgs/PoseStamped` | the same for any tool |
//! | `/<robot>/cmd_vel` | `geometry_msgs/TwistStamped` | the command |
//! | `/tf` | `tf2_msgs/TFMessage` | `map` → `<robot>/base_footprint`, `map` → `load_<load>` |
//! | `/cohaul/markers` | `visualization_msgs/MarkerArray` | outlines, roles, waypoints |
//! | `/cohaul/outcome` | `cohaul_msgs/Outcome` | how the episode ended |
//!
//! Scenario text, seed, world, version and git revision stand in a metadata record named `cohaul`, the scenario text also
//! in an attachment; both come before the first message, so that an unfinished file has them.
//!
//! Writing ends a chunk every [`FLUSH_EVERY`] messages: a killed process loses no more than these. [`recover`] makes a
//! valid file of what is left.
//!
//! [MCAP]: crate::_documentation::references

pub mod cdr;
mod chunk;
mod container;
mod error;
mod header;
pub mod marker;
pub mod message;
mod reader;
mod recover;
#[cfg(test)]
mod tests;
mod writer;

pub use error::RecordError;
pub use header::Header;
pub use reader::{LogReader, Record};
pub use recover::{Recovered, recover};
pub use writer::{FLUSH_EVERY, LogWriter};

/// Longest record that is written or read, bytes. A damaged length beyond it is refused before memory is reserved.
const RECORD_LIMIT: usize = 16 << 20;
