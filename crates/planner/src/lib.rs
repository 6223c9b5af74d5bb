//! What a team can do together: formations, capacity, and the programs that decide them.
#![forbid(unsafe_code)]

pub mod capacity;
pub mod conic;
pub mod formation;
