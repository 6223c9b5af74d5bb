//! Scenario files: what is moved, by whom, over which ground, how.

pub mod document;
pub mod instance;
