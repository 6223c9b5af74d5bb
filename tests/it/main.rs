//! Tests across crates, in one binary.
#![expect(clippy::disallowed_methods, reason = "tests read files, the clock and UPDATE_GOLDEN")]

mod allocations;
mod contact;
mod layering;
mod missions;
mod scenarios;
