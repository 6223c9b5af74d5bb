//! Worlds, episodes, and the `cohaul` command.
#![forbid(unsafe_code)]

pub mod world;
