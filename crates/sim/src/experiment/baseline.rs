//! Table II (a): R2P2 against the virtual leader–follower method.
//!
//! # Source
//! [R2P2] §V-D, Table II (a): four bearings on three terrains, tolerance 0.20 m; the baseline fails (F-B) from 45° on.
//!
//! # Deviations
//! As for Table II (b); the baseline's own are in [`cohaul_core::control::vlf`].
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::design::{Design, SINGLE, Terrain};
use super::summary::CellSummary;
use super::tight::MASS;
use super::trials::Level;
use super::verdict::{self, Verdict};
use super::{Experiment, Results, Section};
use crate::statistics::wilson;

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
    Terrain::ALL.iter().flat_map(|terrain| BEARINGS.map(|b| cell(method, controller, *terrain, b))).collect()
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
        let fails = |b: &f64| *b > 40.0;
        let vlf = cells("vlf", "{vlf: {}}").into_iter().zip(BEARINGS.iter().cycle());
        let vlf = vlf.map(|(cell, b)| cell.paper("outcome", if fails(b) { "F-B" } else { "S" }));
        vlf.chain(cells("r2p2", "{r2p2: {}}").into_iter().map(|cell| cell.paper("outcome", "S"))).collect()
    }

    fn sections(&self, results: &Results) -> Vec<Section> {
        vec![verdict::section(&self.verdicts(results))]
    }

    fn verdicts(&self, results: &Results) -> Vec<Verdict> {
        vec![baseline_fails(results, "vlf")]
    }
}

/// "VLF method is successful only for the first two cases over all the three surface inclination scenarios."
fn baseline_fails(results: &Results, method: &str) -> Verdict {
    let statement = format!("{method} reaches the goal at bearings of 15° and 30° only");
    let mut parts = Vec::new();
    let (mut agrees, mut better) = (true, true);
    for bearing in BEARINGS {
        let wanted = [("method", Level::from(method)), ("bearing_deg", Level::from(bearing))];
        let has = |cell: &&CellSummary| wanted.iter().all(|(factor, level)| cell.key.level(factor) == Some(level));
        let (reached, n) =
            results.cells.iter().filter(has).fold((0, 0), |(reached, n), cell| (reached + cell.reached, n + cell.n));
        if n == 0 {
            return Verdict::unknown(&statement);
        }
        let succeeds = 2 * reached > n;
        agrees &= succeeds == (bearing < 40.0);
        better &= succeeds || bearing > 40.0;
        let (low, high) = wilson(reached, n);
        parts.push(format!("{bearing}°: {reached}/{n} ({low:.2} to {high:.2})"));
    }
    let better = if better && !agrees { "; ours does better than the paper says" } else { "" };
    Verdict { statement, agrees: Some(agrees), evidence: format!("reached {}{better}", parts.join(", ")) }
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
            .map(|cell| cell.set("teams.0.robots.model", "omnidirectional"));
        let without = cells("vlf_without_repositioning", "{vlf: {reposition: false}}");
        omnidirectional.chain(without).map(|cell| cell.set("teams.0.mission.time_limit", 400)).collect()
    }
}
