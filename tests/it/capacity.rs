//! What the planner says a team can move, against what it moves in the simulator; and teams that lose robots.

use std::path::{Path, PathBuf};

use cohaul_core::scenario::document::{Scenario, Slots};
use cohaul_core::scenario::{Override, parse};
use cohaul_planner::capacity::{assess, max_mass};
use cohaul_planner::formation::{ReformError, reform};
use cohaul_sim::experiment::bisect::{Bracket, largest_mass};
use rayon::prelude::*;

fn scenario(changes: &[String]) -> Scenario {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/r2p2/flat.yaml");
    let overrides: Vec<Override> = changes.iter().map(|c| Override::parse(c).unwrap()).collect();
    parse("flat.yaml", &std::fs::read(path).unwrap(), &overrides).unwrap().resolve(None, &mut || 0.5).unwrap()
}

fn flat(changes: &[&str]) -> Scenario {
    scenario(&changes.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>())
}

/// SplitMix64, uniform in [0, 1).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// A metre in some direction, up or down some slope: mass, friction, slope, bearing, team and ballast drawn. Four robots stand
/// on two sides of the load only; they get slopes of at most a third of the load's friction, on which it does not drift out
/// at the open sides.
fn combination(draws: &mut Draws) -> Vec<String> {
    let friction = draws.between(0.05, 0.2);
    let four = draws.next() < 0.5;
    let steepest = if four { (friction / 3.0).atan().to_degrees() } else { 6.0 };
    let slope = draws.between(-steepest, steepest);
    let bearing = draws.between(0.0, 60.0).to_radians();
    let mass = draws.between(1.0, 10.0);
    let (x, y) = (bearing.cos(), bearing.sin());
    let mut changes = vec![
        format!("terrain.friction.dynamic={friction}"),
        format!("terrain.slope_deg={slope}"),
        format!("loads.0.mass={mass}"),
        format!("teams.0.mission={{goal: {{x: {x}, y: {y}}}, time_limit: 300}}"),
    ];
    if four {
        changes.push("teams.0.robots.count=4".to_owned());
        changes.push("teams.0.formation={slots: four}".to_owned());
    }
    let ballast = draws.next();
    if ballast < 0.5 {
        let place = if ballast < 0.25 { "front" } else { "rear" };
        changes.push(format!("teams.0.robots.ballast={{mass: {}, at: {place}}}", draws.between(0.2, 1.0)));
    }
    changes
}

/// Predicted and simulated largest mass of twelve combinations, kg.
fn twelve(seed: u64) -> Vec<(Vec<String>, f64, f64)> {
    let mut draws = Draws(seed);
    let combinations: Vec<_> = (0..12).map(|_| combination(&mut draws)).collect();
    let bracket = Bracket { low: 0.5, high: 150.0, resolution: 0.03 };
    combinations
        .into_par_iter()
        .map(|changes| {
            let scenario = scenario(&changes);
            let predicted = max_mass(&scenario, 0).unwrap().min(bracket.high);
            let simulated = largest_mass(&scenario, 0, &[1, 2, 3], &bracket).unwrap();
            (changes, predicted, simulated)
        })
        .collect()
}

#[test]
fn dev() {
    for seed in 1..=5 {
        println!("seed {seed}");
        for (changes, predicted, simulated) in twelve(seed) {
            println!("{:6.1} % pred {predicted:.2} sim {simulated:.2} {}", (predicted / simulated - 1.0) * 100.0, changes.join(" "));
        }
    }
}
