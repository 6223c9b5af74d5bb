//! Table I once more, its static friction of 0.9 read as that between load and ground.
//!
//! # Source
//! [R2P2] §V-C. A load at rest breaks away at 0.9 of its weight: 53 N for 6 kg, where all six robots together have 53 N of
//! traction and the two that push have 18 N.
//!
//! # Deviations
//! Time limit 300 s instead of 1500: what has stalled stays stalled.
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::Experiment;
use super::design::Design;
use super::generalize::table_1;

/// `r2p2-breakaway`.
pub struct Breakaway;

impl Experiment for Breakaway {
    fn name(&self) -> &'static str {
        "r2p2-breakaway"
    }

    fn about(&self) -> &'static str {
        "Table I with its static friction of 0.9 between load and ground: the load at rest breaks away at 0.9 of its weight. \
         Compare with `r2p2-generalize`, where 0.9 is the friction of the wheels. Time limit 300 s."
    }

    fn trials(&self) -> usize {
        5
    }

    fn cells(&self) -> Vec<Design> {
        let changed = |cell: Design| cell.set("terrain.friction.static", 0.9).set("teams.0.mission.time_limit", 300);
        table_1().into_iter().map(changed).collect()
    }
}
