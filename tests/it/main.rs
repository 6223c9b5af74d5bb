//! Tests across crates, in one binary.
#![expect(clippy::disallowed_methods, reason = "tests read the repository's files and start programs")]

mod allocations;
mod capacity;
mod contact;
mod formation;
mod layering;
mod missions;
mod scenarios;
