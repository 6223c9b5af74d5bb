//! Experiments: many trials, their table, and what it says.

mod columns;
mod lines;
mod named;
pub mod store;
pub mod summary;
pub mod table;
pub mod trials;
