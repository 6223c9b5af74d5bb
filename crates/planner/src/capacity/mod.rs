//! What a team can move: whether it can, with which margin, and where it ends.
//!
//! # Source
//! [R2P2] §I asks whether the robots' traction suffices and leaves it to trial. Here the mission is gone through without
//! inertia (`capacity/rollout.rs`) for one mass after the other: a load that gets stuck, cannot be held or goes astray is too
//! heavy.
//!
//! # Deviations
//! - Collisions between robots, repositioning and noise are not in it. Against masses bisected in the simulator (to 3 %) it is
//!   within that on flat ground and mostly within 5 % on slopes up to 6°. Of 108 draws (`tests/it/capacity.rs`) two are more
//!   than 10 % off, 15 % at most, on slopes where gravity nearly balances friction or the load slides by itself: a few
//!   centimetres of drift near the goal turn its bearing.
//! - With open sides (four robots at a rectangle) it holds up to slopes of a third of the load's friction. Beyond that the load
//!   drifts out, the mission is a matter of luck, and no limit is sharp.
//! - Obstacles and walls are not looked at.
//!
//! [R2P2]: cohaul_core::_documentation::references

mod quasistatic;
mod rollout;

use std::fmt;

use cohaul_core::contact::slope::Slope;
use cohaul_core::control::guidance::Guidance;
use cohaul_core::control::r2p2::Parameters;
use cohaul_core::scenario::Problem;
use cohaul_core::scenario::document::{Controller, Drive, Scenario, Slots};
use nalgebra::Vector2;
use serde::Serialize;

use crate::formation::{self, Demand, FormationPlanError};
use crate::load_path::{self, LoadPathError};
use rollout::{Cause, Failure, Task, roll};

/// What a team can move, everything but the quantity in question as in the scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Capacity {
    /// The team's id.
    pub team: String,
    /// How many robots it has.
    pub robots: usize,
    /// Whether it can do its mission.
    pub feasible: bool,
    /// Largest mass over the load's mass.
    pub margin: f64,
    /// Mass of the load, kg.
    pub mass_kg: f64,
    /// Largest mass, kg; 0 if not even 10 g would arrive.
    pub max_mass_kg: f64,
    /// Steepest slope in the direction that is worst for the mission, degrees; `None` if not even flat ground will do.
    pub max_slope_deg: Option<f64>,
    /// Size of the smallest team that still can, slots chosen anew; `None` if none of up to 12 robots can.
    pub min_robots: Option<usize>,
    /// What ends the mission just beyond the largest mass; `None` if nothing does up to 10 t.
    pub limit: Option<Limit>,
    /// The same in words.
    pub explanation: String,
}

/// What ends a mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// What the team could not do.
    pub demand: &'static str,
    /// On the way to which waypoint, counted from 1; the goal is the last.
    pub leg: usize,
    /// How it went wrong.
    pub cause: &'static str,
    /// Robots whose traction is spent, counted from 1.
    pub robots_at_limit: Vec<usize>,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} on leg {} binds: {}", self.demand, self.leg, self.cause)?;
        let robots: Vec<String> = self.robots_at_limit.iter().map(usize::to_string).collect();
        match robots.len() {
            0 => Ok(()),
            1 => write!(f, "; robot {} is at the limit of its traction", robots[0]),
            _ => write!(f, "; robots {} are at the limit of their traction", robots.join(", ")),
        }
    }
}

impl Limit {
    fn new(failure: &Failure) -> Self {
        let demand = match failure.demand {
            Demand::Move(primitive) => match primitive {
                cohaul_core::transport::primitive::Primitive::Translate => "translate",
                cohaul_core::transport::primitive::Primitive::Rotate(_) => "rotate",
            },
            Demand::Hold => "hold",
        };
        let cause = match failure.cause {
            Cause::Stuck => "the load does not move",
            Cause::Runaway => "the load slides away",
            Cause::Astray => "the load moves, but not to where it should",
            Cause::TooSlow => "the load moves, but not within the time allowed",
        };
        let robots_at_limit = failure.at_limit.iter().map(|place| place + 1).collect();
        Self { demand, leg: failure.leg + 1, cause, robots_at_limit }
    }
}

/// Why nothing can be said.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CapacityError {
    /// The scenario cannot be built.
    #[error(transparent)]
    Scenario(#[from] Problem),
    /// Slots left open cannot be chosen.
    #[error(transparent)]
    Formation(#[from] FormationPlanError),
    /// Waypoints left open cannot be planned.
    #[error(transparent)]
    LoadPath(LoadPathError),
    /// The team's controller is not R2P2.
    #[error("team `{team}` is not driven by r2p2, and only for that controller is it known what a team can move")]
    Controller {
        /// The team's id.
        team: String,
    },
    /// There is no such team.
    #[error("there is no team {team}: the scenario has {teams}")]
    NoSuchTeam {
        /// Team asked for, counted from 0.
        team: usize,
        /// How many there are.
        teams: usize,
    },
}

impl From<LoadPathError> for CapacityError {
    fn from(error: LoadPathError) -> Self {
        match error {
            LoadPathError::Formation(error) => Self::Formation(error),
            error => Self::LoadPath(error),
        }
    }
}

/// Largest mass of interest, kg, and the lightest load tried, kg.
const MASSES: (f64, f64) = (1e4, 0.01);
/// Factor between masses tried until the limit lies between two of them.
const STRIDE: f64 = 3.0;
/// Relative difference at which the search for the largest mass ends.
const MASS_RESOLUTION: f64 = 0.005;
/// Directions in which a slope is tried.
const DIRECTIONS: usize = 8;
/// Difference at which the search for the steepest slope ends, degrees.
const SLOPE_RESOLUTION: f64 = 0.2;
/// Sizes of teams for which slots can be chosen.
const TEAMS: std::ops::RangeInclusive<usize> = 3..=12;

/// What every team of a drawn scenario can move; slots and waypoints left open (`slots: auto`, `plan: auto`) are chosen first.
///
/// # Errors
/// A scenario that cannot be built, or open slots that cannot be chosen.
pub fn assess(scenario: &Scenario) -> Result<Vec<Capacity>, CapacityError> {
    let resolved = load_path::resolve(scenario)?;
    (0..resolved.teams.len()).map(|team| assess_team(&resolved, team)).collect()
}

/// What team `team` (from 0) of a resolved scenario can move.
///
/// # Errors
/// A scenario that cannot be built.
pub fn assess_team(scenario: &Scenario, team: usize) -> Result<Capacity, CapacityError> {
    let teams = scenario.teams.len();
    let spec = scenario.teams.get(team).ok_or(CapacityError::NoSuchTeam { team, teams })?;
    let task = task(scenario, team)?;
    let mass_kg = task.mass;
    let slope = slope(scenario);
    let failure = roll(&task, mass_kg, &slope).err();
    let feasible = failure.is_none();
    let (max_mass_kg, limit) = largest_mass(&task, &slope);
    let limit = limit.as_ref().map(Limit::new);
    let margin = max_mass_kg / mass_kg;
    let explanation = match (&failure, &limit) {
        (Some(failure), _) => Limit::new(failure).to_string(),
        (None, Some(limit)) => format!("beyond {max_mass_kg:.2} kg {limit}"),
        (None, None) => format!("nothing binds up to {max_mass_kg:.0} kg"),
    };
    Ok(Capacity {
        team: spec.id.clone(),
        robots: spec.robots.count,
        feasible,
        margin,
        mass_kg,
        max_mass_kg,
        max_slope_deg: steepest(&task),
        min_robots: smallest_team(scenario, team, feasible),
        limit,
        explanation,
    })
}

/// The largest mass, kg, that team `team` (from 0) of a resolved scenario brings to its goal: [`Capacity::max_mass_kg`] alone.
///
/// # Errors
/// A scenario that cannot be built.
pub fn max_mass(scenario: &Scenario, team: usize) -> Result<f64, CapacityError> {
    Ok(largest_mass(&task(scenario, team)?, &slope(scenario)).0)
}

fn slope(scenario: &Scenario) -> Slope {
    Slope::new(scenario.terrain.slope_deg.to_radians(), scenario.terrain.uphill_deg.to_radians())
}

fn task(scenario: &Scenario, team: usize) -> Result<Task, CapacityError> {
    let instance = scenario.instance()?;
    let teams = scenario.teams.len();
    let missing = CapacityError::NoSuchTeam { team, teams };
    let (Some(built), Some(spec)) = (instance.teams.get(team), scenario.teams.get(team)) else { return Err(missing) };
    let index = built.load.index();
    let polygon = instance.load_polygon(index);
    let (low, high) = polygon.bounds();
    let Controller::R2p2(keys) = &spec.controller else {
        return Err(CapacityError::Controller { team: spec.id.clone() });
    };
    let mut parameters = Parameters::new(keys);
    parameters.speed_max = parameters.speed_max.min(built.model.limits.linear);
    parameters.speed_min = parameters.speed_min.min(parameters.speed_max);
    let friction = &scenario.terrain.friction;
    Ok(Task {
        formation: built.formation.clone(),
        model: built.model,
        surface: formation::surface(scenario.terrain.ground, polygon),
        half_length: (high.y - low.y) / 2.0,
        mass: scenario.loads[index].mass,
        contact_friction: scenario.loads[index].contact_friction,
        friction_dynamic: friction.dynamic,
        friction_static: friction.breakaway.unwrap_or(friction.dynamic),
        friction_wheel: friction.wheel,
        world_from_load: instance.start_pose_of_load(index),
        guidance: Guidance {
            waypoints: spec.mission.points().map(|p| Vector2::new(p.x, p.y)).collect(),
            tolerance: spec.mission.tolerance,
            goal_yaw: spec.mission.goal_yaw(),
            threshold: parameters.heading_threshold,
            release: parameters.heading_release,
            wrap: parameters.wrap,
            either_way: parameters.drive == Drive::Nearest,
        },
        time_limit: spec.mission.time_limit,
        parameters,
    })
}

/// The largest mass that arrives, kg, and what stops a heavier one.
fn largest_mass(task: &Task, slope: &Slope) -> (f64, Option<Failure>) {
    let (heaviest, lightest) = MASSES;
    let mut low = task.mass;
    let mut high = low;
    let mut failure;
    loop {
        match roll(task, high, slope) {
            Ok(()) if high >= heaviest => return (heaviest, None),
            Ok(()) => (low, high) = (high, (high * STRIDE).min(heaviest)),
            Err(found) => {
                failure = found;
                break;
            }
        }
    }
    while low >= high {
        // the mass given is too much already
        if high <= lightest {
            return (0.0, Some(failure));
        }
        low = (high / STRIDE).max(lightest);
        if let Err(found) = roll(task, low, slope) {
            (high, failure) = (low, found);
        }
    }
    while high > low * (1.0 + MASS_RESOLUTION) {
        let middle = (low * high).sqrt();
        match roll(task, middle, slope) {
            Ok(()) => low = middle,
            Err(found) => (high, failure) = (middle, found),
        }
    }
    (low, Some(failure))
}

/// The steepest slope, degrees, on which the mission succeeds whichever way is up.
fn steepest(task: &Task) -> Option<f64> {
    let mut first = 0;
    let mut passes = |degrees: f64| {
        // what failed last is tried first
        (0..DIRECTIONS).all(|i| {
            let direction = (first + i) % DIRECTIONS;
            let uphill = std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64;
            let passes = roll(task, task.mass, &Slope::new(degrees.to_radians(), uphill)).is_ok();
            if !passes {
                first = direction;
            }
            passes
        })
    };
    // on steeper ground the robots themselves slide
    let grip = task.friction_wheel * task.model.mass_on_wheels / task.model.mass;
    let (mut low, mut high) = (0.0, grip.atan().to_degrees());
    if !passes(low) {
        return None;
    }
    while high - low > SLOPE_RESOLUTION {
        let middle = f64::midpoint(low, high);
        if passes(middle) { low = middle } else { high = middle }
    }
    Some(low)
}

/// The fewest robots, slots chosen anew, that can do the mission; the team as it is counts too.
fn smallest_team(scenario: &Scenario, team: usize, feasible: bool) -> Option<usize> {
    let count = scenario.teams[team].robots.count;
    let last = if feasible { count.min(*TEAMS.end() + 1) - 1 } else { *TEAMS.end() };
    let can = |robots: usize| {
        let mut other = scenario.clone();
        let spec = &mut other.teams[team];
        spec.robots.count = robots;
        spec.robots.rates_hz = None;
        spec.formation.slots = Slots::Auto;
        let resolved = formation::resolve(&other).ok();
        let built = resolved.and_then(|resolved| task(&resolved, team).ok());
        built.is_some_and(|task| roll(&task, task.mass, &slope(scenario)).is_ok())
    };
    (*TEAMS.start()..=last).find(|robots| can(*robots)).or_else(|| feasible.then_some(count))
}
