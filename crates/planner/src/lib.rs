//! What a team can do together: formations, capacity, the programs that decide them, and plans for many agents.
#![forbid(unsafe_code)]

pub mod assign;
pub mod capacity;
pub mod conic;
pub mod formation;
pub mod grid;
pub mod instance;
pub mod outcome;
pub mod plan;
pub mod search;
