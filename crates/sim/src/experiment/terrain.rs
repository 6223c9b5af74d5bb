//! Fig. 6: one path over flat ground, down and up a slope.
//!
//! # Source
//! [R2P2] §V-B, Fig. 6: 2 kg, friction 0.01, 5°; 337, 385 and 840 s.
//!
//! # Deviations
//! The paper draws its waypoints without giving coordinates: these are ours, so only the order of the terrains compares.
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::design::{Base, DOWNHILL, Design, FLAT, Terrain, UPHILL};
use super::{Experiment, Results, Section, median_of};

/// `r2p2-terrain`.
pub struct TerrainMissions;

impl Experiment for TerrainMissions {
    fn name(&self) -> &'static str {
        "r2p2-terrain"
    }

    fn about(&self) -> &'static str {
        "Fig. 6: one path over flat ground, down and up a slope of 5°. The waypoints are ours: the paper draws its own \
         without giving coordinates, so only the order of the terrains can be compared with its times."
    }

    fn cells(&self) -> Vec<Design> {
        let cell = |base: Base, terrain: Terrain, time_s: f64| {
            Design::new(base).level("terrain", terrain.name()).paper("time_s", time_s).paper("outcome", "S")
        };
        vec![
            cell(FLAT, Terrain::Flat, 337.0),
            cell(DOWNHILL, Terrain::Downhill, 385.0),
            cell(UPHILL, Terrain::Uphill, 840.0),
        ]
    }

    fn sections(&self, results: &Results) -> Vec<Section> {
        let mut order: Vec<_> = Terrain::ALL
            .iter()
            .map(|terrain| (median_of(results, &[("terrain", terrain.name().into())], "time_s"), terrain.name()))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let names: Vec<String> = order.iter().map(|(time, name)| format!("{name} ({time:.1} s)")).collect();
        vec![Section::text(
            "Order of the terrains",
            format!("From fast to slow, by median: {}. The paper's order is flat, downhill, uphill.", names.join(", ")),
        )]
    }
}
