//! Tests across crates, in one binary.
#![expect(clippy::disallowed_methods, reason = "tests read the repository's files and start programs")]

mod allocations;
mod beyond;
mod capacity;
mod cars;
mod certify;
mod compare;
mod contact;
mod experiments;
mod flow;
mod formation;
mod formats;
mod layering;
mod load_path;
mod missions;
mod scenarios;
mod sweep;
mod trials;
