//! Tests across crates, in one binary.

mod allocations;
mod contact;
mod missions;
mod scenarios;
