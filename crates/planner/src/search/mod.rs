//! Searches for the ways of many agents.

mod budget;
mod domain;

pub use budget::{Budget, Spent};
pub use domain::{Assigned, Assignments, Bound, Clash, Domain, Found, Given, Planned, Query};
