//! What a team really moves: the heaviest load that reaches its goal, found by running the mission.
//!
//! Whether a mission succeeds is taken to depend on the mass in one way: what is too heavy stays too heavy when it gets
//! heavier. Near the limit seeds disagree, so a majority of them decides. A load that outruns its robots was not moved by
//! them, even if it slid to where its goal happened to be.

use std::cell::Cell;

use cohaul_core::control::{Decision, Observation};
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::scenario::document::Scenario;
use cohaul_core::time::Time;

use crate::episode::{self, Recorder};
use crate::error::SimError;
use crate::world::World;

/// Where to look for the limit, and how closely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bracket {
    /// The lightest load tried, kg: if it does not arrive, the answer is 0.
    pub low: f64,
    /// The heaviest load tried, kg: if it arrives, it is the answer.
    pub high: f64,
    /// Ratio, less 1, of the two masses between which the limit is left.
    pub resolution: f64,
}

/// Speed of a load over that of its robots at their fastest from which on it outruns them.
const OUTRUN: f64 = 1.25;
/// Looks on end, 20 per second, at which it is faster: what lasts less is a push across the gap to the next robot.
const LOOKS: u32 = 20;

/// The heaviest load, kg, with which most of `seeds` reach their goals: the mass of load `load` (from 0) is bisected
/// geometrically within `bracket`.
///
/// `scenario` is drawn, with nothing left open.
///
/// # Errors
/// A scenario that cannot be run.
pub fn largest_mass(scenario: &Scenario, load: usize, seeds: &[u64], bracket: &Bracket) -> Result<f64, SimError> {
    Ok((limit(scenario, load, seeds, bracket, &mut |_, _| false)?).map_or(0.0, |limit| limit.mass()))
}

/// Two masses between which the limit lies, kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassLimit {
    /// The heaviest that arrived; 0 if none did.
    pub arrived: f64,
    /// The lightest that did not; the same where the heaviest of the bracket arrived.
    pub failed: f64,
}

impl MassLimit {
    /// The limit in one number: the geometric mean, kg.
    pub fn mass(&self) -> f64 {
        (self.arrived * self.failed).sqrt()
    }
}

/// As [`largest_mass`], with both ends; `None` if `stop` (as in [`episode::run`]) ended the search.
///
/// # Errors
/// A scenario that cannot be run.
pub fn limit(
    scenario: &Scenario,
    load: usize,
    seeds: &[u64],
    bracket: &Bracket,
    stop: &mut dyn FnMut(Time, Time) -> bool,
) -> Result<Option<MassLimit>, SimError> {
    let mut stopped = false;
    let mut arrives = |mass: f64| {
        majority(scenario, load, mass, seeds, &mut |now, end| {
            stopped |= stop(now, end);
            stopped
        })
    };
    let found = bisect(&mut arrives, bracket)?;
    Ok((!stopped).then_some(found))
}

fn bisect(arrives: &mut dyn FnMut(f64) -> Result<bool, SimError>, bracket: &Bracket) -> Result<MassLimit, SimError> {
    let (mut low, mut high) = (bracket.low, bracket.high);
    if !arrives(low)? {
        return Ok(MassLimit { arrived: 0.0, failed: low });
    }
    if arrives(high)? {
        return Ok(MassLimit { arrived: high, failed: high });
    }
    while high > low * (1.0 + bracket.resolution) {
        let middle = (low * high).sqrt();
        if arrives(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(MassLimit { arrived: low, failed: high })
}

/// Whether more than half of the seeds succeed; as few are run as decide it.
fn majority(
    scenario: &Scenario,
    load: usize,
    mass: f64,
    seeds: &[u64],
    stop: &mut dyn FnMut(Time, Time) -> bool,
) -> Result<bool, SimError> {
    let mut scenario = scenario.clone();
    if let Some(load) = scenario.loads.get_mut(load) {
        load.mass = mass;
    }
    let fastest = scenario.teams.iter().map(|team| team.robots.model().limits.linear).fold(0.0, f64::max);
    let needed = seeds.len() / 2 + 1;
    let (mut reached, mut failed) = (0, 0);
    for seed in seeds {
        scenario.seed = *seed;
        let outran = Cell::new(false);
        let mut watch = Watch { load: LoadId(load as u16), limit: OUTRUN * fastest, fast: 0, outran: &outran };
        let outcome = episode::run(&scenario, &mut watch, &mut |now, end| outran.get() || stop(now, end))?;
        if outcome.success && !outran.get() {
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

/// Notices a load that outruns its robots.
struct Watch<'a> {
    load: LoadId,
    /// m/s.
    limit: f64,
    /// Looks on end at which it was faster.
    fast: u32,
    outran: &'a Cell<bool>,
}

impl Recorder for Watch<'_> {
    fn memory(&mut self, _: Time, _: RobotId, _: &str) -> Result<(), SimError> {
        Ok(())
    }

    fn decision(&mut self, _: &Observation, _: &Decision) -> Result<(), SimError> {
        Ok(())
    }

    fn state(&mut self, world: &dyn World, _: &[Decision]) -> Result<(), SimError> {
        self.fast = if world.load_twist(self.load).linear.norm() > self.limit { self.fast + 1 } else { 0 };
        if self.fast >= LOOKS {
            self.outran.set(true);
        }
        Ok(())
    }
}
