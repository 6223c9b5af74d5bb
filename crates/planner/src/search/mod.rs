//! Searches for the ways of many agents.

mod budget;
mod cbs;
mod domain;
mod focal;
mod incremental;
mod tree;

pub use budget::{Budget, Spent};
pub use cbs::{Settings, solve};
pub use domain::{Assigned, Assignments, Bound, Clash, Domain, Found, Given, Planned, Query};
pub use incremental::{Columns, solve_incremental};
