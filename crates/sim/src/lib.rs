//! Worlds, episodes and experiments, and the page that shows them.
#![forbid(unsafe_code)]

pub mod page;
