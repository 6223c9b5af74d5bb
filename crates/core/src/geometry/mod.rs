//! Shapes of loads, robots and obstacles.

pub mod query;
pub mod shape;
