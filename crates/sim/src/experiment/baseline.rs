//! Table II (a): R2P2 against the virtual leader–follower method.
//!
//! # Source
//! [R2P2] §V-D, Table II (a): four bearings on three terrains, tolerance 0.20 m; the baseline fails (F-B) from 45° on.
//!
//! # Deviations
//! As for Table II (b); the baseline's own are in [`cohaul_core::control::vlf`].
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::Experiment;
use super::design::{Design, SINGLE, Terrain};
use super::tight::MASS;

const BEARINGS: [f64; 4] = [15.0, 30.0, 45.0, 60.0];

fn cell(method: &str, controller: &str, terrain: Terrain, bearing: f64) -> Design {
    Design::new(SINGLE)
        .level("method", method)
        .terrain(terrain)
        .level("bearing_deg", bearing)
        .goal(bearing, 1.0)
        .set("loads.0.mass", MASS)
        .set("teams.0.mission.tolerance", 0.2)
        .set("teams.0.controller", controller)
}

fn cells(method: &str, controller: &str) -> Vec<Design> {
    Terrain::ALL
        .iter()
        .flat_map(|terrain| BEARINGS.map(|b| (b, cell(method, controller, *terrain, b))))
        .map(|(b, cell)| {
            let fails = method == "vlf" && b > 40.0;
            cell.paper("outcome", if fails { "F-B" } else { "S" })
        })
        .collect()
}

/// `r2p2-baseline`.
pub struct Baseline;

impl Experiment for Baseline {
    fn name(&self) -> &'static str {
        "r2p2-baseline"
    }

    fn about(&self) -> &'static str {
        "Table II (a): R2P2 and the virtual leader–follower method (VLF) at bearings of 15° to 60° on three terrains, \
         tolerance 0.20 m."
    }

    fn cells(&self) -> Vec<Design> {
        [cells("vlf", "{vlf: {}}"), cells("r2p2", "{r2p2: {}}")].concat()
    }
}

/// `r2p2-baseline-variants`.
pub struct BaselineVariants;

impl Experiment for BaselineVariants {
    fn name(&self) -> &'static str {
        "r2p2-baseline-variants"
    }

    fn about(&self) -> &'static str {
        "The missions of Table II (a) with two more readings of VLF: with omnidirectional robots, where the paper says that it \
         works, and with differential drives that never reposition themselves (time limit 400 s)."
    }

    fn cells(&self) -> Vec<Design> {
        let omnidirectional = cells("vlf_omnidirectional", "{vlf: {}}")
            .into_iter()
            .map(|cell| cell.set("teams.0.robots.model", "omnidirectional").set("teams.0.mission.time_limit", 400));
        let without = Terrain::ALL.iter().flat_map(|terrain| {
            BEARINGS.map(|b| {
                let cell = cell("vlf_without_repositioning", "{vlf: {reposition: false}}", *terrain, b);
                cell.set("teams.0.mission.time_limit", 400).paper("outcome", if b > 40.0 { "F-B" } else { "S" })
            })
        });
        omnidirectional.chain(without).collect()
    }
}
