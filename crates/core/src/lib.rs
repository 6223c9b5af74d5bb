//! Contact physics and the decisions of one robot: no clock, no file, no network, no randomness.
#![forbid(unsafe_code)]

pub mod _documentation;
pub mod contact;
pub mod control;
pub mod geometry;
pub mod id;
pub mod kinematics;
#[cfg(feature = "mcap")]
pub mod record;
pub mod robot;
pub mod scenario;
pub mod se2;
pub mod time;
pub mod transport;
