//! What a team can do together: formations, capacity, the programs that decide them, and plans for many agents.
#![forbid(unsafe_code)]

pub mod capacity;
pub mod conic;
pub mod formation;
pub mod instance;
pub mod load_path;
pub mod outcome;
pub mod plan;
pub mod search;
