//! Tests across crates, in one binary.

mod contact;
mod scenarios;
