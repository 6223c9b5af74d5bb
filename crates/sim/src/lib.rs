//! Worlds, episodes, and the `cohaul` command.
#![forbid(unsafe_code)]

pub mod episode;
pub mod error;
pub mod outcome;
pub mod page;
mod score;
pub mod sensor;
pub mod world;
