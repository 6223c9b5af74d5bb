//! Whole missions of other teams: the laboratory mission, ten robots, two teams.
//!
//! # Source
//! [R2P2] §VII (four robots, about 25 min on the robots, about 3 min in simulation); the authors' videos (ten robots, no
//! numbers).
//!
//! # Deviations
//! The laboratory mission starts with heading 0 and has friction 0.1, both not stated, and a slot near each corner. The
//! waypoints of the ten-robot missions are ours, as in `r2p2-terrain`; two teams in one world are not in the paper.
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::Experiment;
use super::design::{Design, HARDWARE, TEN, TWO_TEAMS, Terrain};

/// `r2p2-hardware`.
pub struct Hardware;

impl Experiment for Hardware {
    fn name(&self) -> &'static str {
        "r2p2-hardware"
    }

    fn about(&self) -> &'static str {
        "The laboratory mission of §VII: four robots with 0.5 kg of ballast, a load of 1.2 m × 0.22 m and 1.2 kg, two legs \
         with turns of about 40° and 120°. The paper's 180 s are those of its simulator; its robots took about 25 minutes."
    }

    fn cells(&self) -> Vec<Design> {
        vec![Design::new(HARDWARE).level("robots", 4_usize).paper("time_s", 180.0).paper("outcome", "S")]
    }
}

/// `r2p2-ten`.
pub struct Ten;

impl Experiment for Ten {
    fn name(&self) -> &'static str {
        "r2p2-ten"
    }

    fn about(&self) -> &'static str {
        "Ten robots on three terrains. The paper shows such missions in a video only; the waypoints are ours."
    }

    fn cells(&self) -> Vec<Design> {
        Terrain::ALL.iter().map(|terrain| Design::new(TEN).terrain(*terrain).paper("outcome", "S")).collect()
    }
}

/// `r2p2-two-teams`.
pub struct TwoTeams;

impl Experiment for TwoTeams {
    fn name(&self) -> &'static str {
        "r2p2-two-teams"
    }

    fn about(&self) -> &'static str {
        "Two teams of six with a load each, at the same time in one world, on disjoint paths. Not in the paper."
    }

    fn cells(&self) -> Vec<Design> {
        vec![Design::new(TWO_TEAMS).level("teams", 2_usize)]
    }
}
