//! Tests across crates, in one binary.

mod allocations;
mod contact;
mod layering;
mod missions;
mod scenarios;
