//! What a team can do together: formations, capacity, the programs that decide them, and plans for many agents.
#![forbid(unsafe_code)]

pub mod assign;
pub mod capacity;
pub mod car;
pub mod certify;
pub mod conic;
pub mod formation;
pub mod generate;
pub mod grid;
pub mod instance;
pub mod io;
pub mod load_path;
pub mod outcome;
pub mod plan;
pub mod search;
