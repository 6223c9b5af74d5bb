//! What a team really moves: the heaviest load that reaches its goal, found by running the mission.
//!
//! Whether a mission succeeds is taken to depend on the mass in one way: what is too heavy stays too heavy when it gets
//! heavier. Near the limit seeds disagree, so a majority of them decides.

use cohaul_core::scenario::document::Scenario;

use crate::episode::{self, NoRecorder};
use crate::error::SimError;

/// Where to look for the limit, and how closely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bracket {
    /// A mass that is tried first and given back as 0 if it does not arrive, kg.
    pub low: f64,
    /// The largest mass of interest, kg.
    pub high: f64,
    /// Largest ratio, less 1, of the two masses between which the limit is left.
    pub resolution: f64,
}

/// The heaviest load, kg, with which most of `seeds` reach the goal: the mass of load `load` is bisected geometrically
/// within `bracket`. 0 if not even the lightest arrives, `bracket.high` if the heaviest does.
///
/// `scenario` is resolved: nothing left to draw, no slots left to choose.
///
/// # Errors
/// A scenario that cannot be run.
pub fn largest_mass(scenario: &Scenario, load: usize, seeds: &[u64], bracket: &Bracket) -> Result<f64, SimError> {
    let arrives = |mass: f64| majority(scenario, load, mass, seeds);
    let (mut low, mut high) = (bracket.low, bracket.high);
    if !arrives(low)? {
        return Ok(0.0);
    }
    if arrives(high)? {
        return Ok(high);
    }
    while high > low * (1.0 + bracket.resolution) {
        let middle = (low * high).sqrt();
        if arrives(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok((low * high).sqrt())
}

/// Whether more than half of the seeds succeed; as few are run as decide it.
fn majority(scenario: &Scenario, load: usize, mass: f64, seeds: &[u64]) -> Result<bool, SimError> {
    let mut scenario = scenario.clone();
    if let Some(load) = scenario.loads.get_mut(load) {
        load.mass = mass;
    }
    let needed = seeds.len() / 2 + 1;
    let (mut reached, mut failed) = (0, 0);
    for seed in seeds {
        scenario.seed = *seed;
        if episode::run(&scenario, &mut NoRecorder, &mut |_, _| false)?.success {
            reached += 1;
        } else {
            failed += 1;
        }
        if reached >= needed || failed > seeds.len() - needed {
            break;
        }
    }
    Ok(reached >= needed)
}
