//! Searches for the ways of many agents.

mod budget;

pub use budget::{Budget, Spent};
