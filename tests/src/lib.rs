//! Oracles shared by the tests.
#![forbid(unsafe_code)]

pub mod oracle;
