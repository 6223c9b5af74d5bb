//! Tests across crates, in one binary.
#![expect(clippy::disallowed_methods, reason = "tests read the repository's files and start programs")]

mod allocations;
mod beyond;
mod compare;
mod contact;
mod experiments;
mod flow;
mod layering;
mod missions;
mod scenarios;
mod trials;
