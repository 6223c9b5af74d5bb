//! Worlds, episodes, and the `cohaul` command.
#![forbid(unsafe_code)]

pub mod capacity;
pub mod cli;
pub mod compare;
pub mod episode;
pub mod error;
pub mod experiment;
pub mod files;
mod memory;
pub mod mission;
pub mod outcome;
pub mod page;
pub mod planning;
pub mod plot;
pub mod recording;
pub mod replay;
mod score;
pub mod sensor;
pub mod statistics;
pub mod stopwatch;
pub mod world;
