//! Waypoints for a load and its team through obstacles: `mission: {plan: auto}`.
//!
//! # Source
//! [R2P2] §III and §IV-A take waypoints as given; the load turns on the spot towards the next one, then translates along a
//! straight line. So a way is a polyline, the heading on each leg is its bearing, and what needs room is the load with its
//! robots in their slots: swept along each leg, turned at each waypoint.
//!
//! # Method
//! - The body is the convex hull of the load and of the robots in their slots (`body.rs`). A leg sweeps the hull over all
//!   headings that the controller lets a translation have; it is tested exactly against every convex obstacle. Turns are tested
//!   in classes of 5°, each a convex hull too.
//! - Points to turn at lie beside the corners of obstacles and in their gaps; where these do not suffice, also on grids of 0.5
//!   and 0.25 m (`roadmap.rs`).
//! - A* over legs finds the cheapest way of the roadmap (`way.rs`): metres, plus 0.7 m per radian turned, plus 0.3 m per
//!   waypoint, which makes it about a time. Legs are tested when it is their turn.
//! - If nothing is found, a flood over cells tells whether even the body's inner disc has no way, which is a proof (`flood.rs`).
//!
//! # Deviations
//! - The cheapest way over the roadmap is not the cheapest of all. The first roadmap that has one ends the search. Where the
//!   team cannot turn as it likes, legs that come in within 5° of each other count as one.
//! - "No way" is a proof for the body's inner disc; for the body it is an answer of the finest roadmap.
//! - The other teams and their loads are not looked at: they move.
//!
//! [R2P2]: cohaul_core::_documentation::references

mod body;
pub mod check;
pub mod clutter;
mod flood;
mod roadmap;
pub mod swept;
mod task;
mod way;

use std::fmt;

use cohaul_core::scenario::document::{Plan, Point, Scenario};
use cohaul_core::scenario::{self, Problem};
use cohaul_core::se2::wrap_angle;
use nalgebra::Vector2;

use crate::formation::{self, Chosen, FormationPlanError};
use crate::outcome::{Effort, Ended, Outcome, Reason};
use crate::search::{Budget, Spent};
use check::{Clearance, Refused};
use roadmap::Roadmap;
use task::Task;

/// Room for what the controller does beside its line, m: measured, see [`margin`].
const ROOM: f64 = 0.15;
/// Longest leg, m: a load leaves its line by up to a quarter of the controller's threshold times the leg's length.
const LONGEST: f64 = 2.0;
/// Spacings of the grids tried one after the other, m.
const GRIDS: [Option<f64>; 3] = [None, Some(0.5), Some(0.25)];
/// Work allowed where a scenario is resolved, in tests of a leg against an obstacle (some microseconds each).
pub const EFFORT: u64 = 2_000_000;

/// Distance that load and robots keep from obstacles on the way planned, m, for waypoints that count as reached within
/// `tolerance` m.
///
/// Measured with [`swept`] in missions of `cohaul reproduce r2p2-clutter`: under R2P2 load and robots left the sweep of their
/// plan by at most 0.09 m on flat ground (seeds 1 to 5 on 20 maps; tolerances of 0.05, 0.1 and 0.2 m and `drive: nearest` make no
/// difference, seed 6) and by at most 0.11 m on slopes of 5° (seed 6). The margin is 4 cm more, and at least the tolerance,
/// within which the controller may be anywhere.
pub fn margin(tolerance: f64) -> f64 {
    ROOM.max(tolerance)
}

/// What is fixed in the surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Obstruction {
    /// `terrain.obstacles`, counted from 0.
    Obstacle(usize),
    /// `terrain.walls`.
    Wall,
    /// A load that nobody moves, counted from 0.
    Load(usize),
}

impl fmt::Display for Obstruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Obstacle(index) => write!(f, "obstacle {index}"),
            Self::Wall => write!(f, "a wall"),
            Self::Load(index) => write!(f, "load {index}"),
        }
    }
}

/// A way for one load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadPath {
    /// Points for the load's centre before the goal, world, m.
    pub waypoints: Vec<Vector2<f64>>,
    /// Length of the way to the goal, m.
    pub length: f64,
    /// All turns together, rad.
    pub turning: f64,
}

/// A way with its certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// The team's id.
    pub team: String,
    /// The way.
    pub path: LoadPath,
    /// Least distance of load and robots from anything on it.
    pub clearance: Clearance,
}

impl fmt::Display for Planned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LoadPath { waypoints, length, turning } = &self.path;
        let clearance = &self.clearance;
        write!(
            f,
            "team `{}`: a way of {length:.2} m with {} waypoint{} and turns of {:.0}° in all, {clearance}",
            self.team,
            waypoints.len(),
            if waypoints.len() == 1 { "" } else { "s" },
            turning.to_degrees(),
        )?;
        for (i, at) in waypoints.iter().enumerate() {
            write!(f, "\n  waypoint {}: ({:.3}, {:.3})", i + 1, at.x, at.y)?;
        }
        Ok(())
    }
}

/// Why a load has no way.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadPathError {
    /// The slots cannot be chosen.
    #[error(transparent)]
    Formation(#[from] FormationPlanError),
    /// The scenario itself cannot be built.
    #[error(transparent)]
    Scenario(#[from] Problem),
    /// There is no room where the load starts.
    #[error(
        "team `{team}`: no way: at its start the team is nearer to {obstruction} than the {margin:.2} m that it needs to move"
    )]
    Start {
        /// The team's id.
        team: String,
        /// What is too near.
        obstruction: Obstruction,
        /// Distance needed, m.
        margin: f64,
    },
    /// There is no room at the goal.
    #[error(
        "team `{team}`: no way: at the goal ({x:.2}, {y:.2}) the team would be nearer than {margin:.2} m to {obstruction} \
         with whatever heading the goal allows"
    )]
    Goal {
        /// The team's id.
        team: String,
        /// What is in the way.
        obstruction: Obstruction,
        /// Distance needed, m.
        margin: f64,
        /// The goal, m.
        x: f64,
        /// The goal, m.
        y: f64,
    },
    /// Nothing leads from the start to the goal.
    #[error(
        "team `{team}`: no way leads to the goal for a team that is {width:.2} m wide as it travels and keeps {margin:.2} m \
         on each side: {}{}",
        blockers(in_the_way),
        if *.proven { "" } else { " (none was found; the search was not exhaustive)" }
    )]
    NoPassage {
        /// The team's id.
        team: String,
        /// Room that the team takes across its heading, m.
        width: f64,
        /// Distance needed on each side, m.
        margin: f64,
        /// Everything whose removal alone would open a way.
        in_the_way: Vec<Obstruction>,
        /// Whether it is certain that there is none.
        proven: bool,
    },
    /// The search was ended before it found one.
    #[error("team `{team}`: no way was found within the work allowed")]
    BudgetSpent {
        /// The team's id.
        team: String,
    },
    /// The independent check found fault with the way.
    #[error("team `{team}`: the way planned does not pass its check: {refused}")]
    Unsafe {
        /// The team's id.
        team: String,
        /// What is wrong.
        refused: Refused,
    },
    /// The scenario with its waypoints is not valid.
    #[error("the way planned does not fit into the scenario: {0}")]
    Invalid(String),
}

fn blockers(obstructions: &[Obstruction]) -> String {
    match obstructions {
        [] => "several things are in the way together".to_owned(),
        [one] => format!("{one} is in the way"),
        several => {
            let names: Vec<String> = several.iter().map(ToString::to_string).collect();
            format!("any one of these is in the way: {}", names.join(", "))
        }
    }
}

impl LoadPathError {
    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::Formation(error) => error.remedy(),
            Self::Scenario(problem) => problem.remedy(),
            Self::Start { .. } => "move the load's `pose` away from it".to_owned(),
            Self::Goal { .. } => "move the goal away from it, or ask for no `goal_yaw_deg`".to_owned(),
            Self::NoPassage { .. } => {
                "make room, use a smaller `tolerance`, a smaller load or other slots, or list `waypoints`".to_owned()
            }
            Self::BudgetSpent { .. } | Self::Unsafe { .. } | Self::Invalid(_) => {
                "list `waypoints` instead of `plan: auto`".to_owned()
            }
        }
    }
}

/// A way for the load of team `team` (from 0), whose slots must be chosen. Agents of reasons are teams; an obstacle that is none
/// of `terrain.obstacles` is not named.
///
/// # Errors
/// A scenario that cannot be built, or has no such team.
pub fn plan(scenario: &Scenario, team: usize, budget: &Budget<'_>) -> Result<Ended<LoadPath>, Problem> {
    let Some(task) = Task::new(scenario, team)? else {
        let reasons = vec![Reason::NoGoal { agent: team }];
        return Ok(Ended { outcome: Outcome::Infeasible(reasons), effort: Effort::default() });
    };
    let named = |obstruction| if let Obstruction::Obstacle(index) = obstruction { Some(index) } else { None };
    let outcome = match solve(&task, budget) {
        Ok(Found::Path(path)) => Outcome::Solved(path),
        Ok(Found::StartBlocked(by)) => {
            Outcome::Infeasible(vec![Reason::StartBlocked { agent: team, obstacle: named(by) }])
        }
        Ok(Found::GoalBlocked(by)) => {
            Outcome::Infeasible(vec![Reason::GoalBlocked { agent: team, goal: 0, obstacle: named(by) }])
        }
        Ok(Found::NoPassage { .. }) => Outcome::Infeasible(vec![Reason::Unreachable { agent: team, goal: 0 }]),
        Err(Spent) => Outcome::BudgetSpent { best_bound: (task.goal - task.start).norm() },
    };
    Ok(Ended { outcome, effort: Effort::default() })
}

enum Found {
    Path(LoadPath),
    StartBlocked(Obstruction),
    GoalBlocked(Obstruction),
    NoPassage { proven: bool },
}

fn solve(task: &Task, budget: &Budget<'_>) -> Result<Found, Spent> {
    let mut room = body::Room::default();
    // classes that lie half beyond the heading count too: a robot turns either way first
    let start = way::free_classes(task, &task.start, budget, &mut room)?;
    if start >> body::class_of(task.start_yaw) & 1 == 0 {
        return Ok(Found::StartBlocked(nearest(task, &task.start)));
    }
    let goal = way::free_classes(task, &task.goal, budget, &mut room)?;
    let blocked = task.goal_yaw.map_or(goal == 0, |yaw| goal >> body::class_of(yaw) & 1 == 0);
    if blocked || !task.is_inside(&task.goal) {
        return Ok(Found::GoalBlocked(nearest(task, &task.goal)));
    }
    for (stage, spacing) in GRIDS.into_iter().enumerate() {
        // before anything laborious: is there room for the least part of it?
        if stage == 1 && !flood::connects(task, task.body.inner + task.margin, budget)? {
            return Ok(Found::NoPassage { proven: true });
        }
        let map = Roadmap::new(task, spacing, budget)?;
        if let Some(points) = way::cheapest(task, &map, budget)? {
            return Ok(Found::Path(path(task, &points)));
        }
    }
    Ok(Found::NoPassage { proven: false })
}

/// What is nearest to a place.
fn nearest(task: &Task, at: &Vector2<f64>) -> Obstruction {
    let distance = |obstacle: &&task::Obstacle| body::distance_to_polygon(at, &obstacle.corners);
    let nearest = task.obstacles.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(Obstruction::Wall, |obstacle| obstacle.what)
}

/// The way along `points`, long legs in several pieces.
fn path(task: &Task, points: &[Vector2<f64>]) -> LoadPath {
    let mut waypoints = Vec::new();
    let (mut length, mut turning, mut heading) = (0.0, 0.0, task.start_yaw);
    for pair in points.windows(2) {
        let way = pair[1] - pair[0];
        let pieces = (way.norm() / LONGEST).ceil().max(1.0);
        waypoints.extend((1..=pieces as usize).map(|k| pair[0] + way * (k as f64 / pieces)));
        length += way.norm();
        let turn = wrap_angle(way.y.atan2(way.x) - heading);
        let backwards = task.either_way && turn.abs() > std::f64::consts::FRAC_PI_2;
        let turn = if backwards { wrap_angle(turn + std::f64::consts::PI) } else { turn };
        turning += turn.abs();
        heading = wrap_angle(heading + turn);
    }
    waypoints.pop();
    turning += task.goal_yaw.map_or(0.0, |yaw| wrap_angle(yaw - heading).abs());
    LoadPath { waypoints, length, turning }
}

/// The scenario with everything decided that it leaves to the planner: `slots: auto` become `custom` slots, `plan: auto`
/// becomes waypoints. A scenario without either comes back as it is.
///
/// # Errors
/// Slots that cannot be chosen, loads without a way.
pub fn resolve(scenario: &Scenario) -> Result<Scenario, LoadPathError> {
    Ok(resolve_with(scenario)?.0)
}

/// The same with what was chosen and planned, one entry for every team that left it open.
///
/// # Errors
/// Those of [`resolve`].
pub fn resolve_with(scenario: &Scenario) -> Result<(Scenario, Vec<Chosen>, Vec<Planned>), LoadPathError> {
    let (mut resolved, chosen) = formation::resolve_with(scenario)?;
    let mut paths = Vec::new();
    for team in 0..resolved.teams.len() {
        if resolved.teams[team].mission.plan == Plan::Auto {
            paths.push((team, plan_for(&resolved, team)?));
        }
    }
    for (team, path) in &paths {
        let mission = &mut resolved.teams[*team].mission;
        mission.plan = Plan::Given;
        mission.waypoints = path.waypoints.iter().map(|at| Point { x: at.x, y: at.y }).collect();
    }
    let mut planned = Vec::new();
    for (index, path) in paths {
        let spec = &resolved.teams[index];
        let (team, needed) = (spec.id.clone(), margin(spec.mission.tolerance));
        let clearance = check::clearance(&resolved, index).and_then(|clearance| clearance.at_least(needed));
        match clearance {
            Ok(clearance) => planned.push(Planned { team, path, clearance }),
            Err(refused) => return Err(LoadPathError::Unsafe { team, refused }),
        }
    }
    if !planned.is_empty() {
        let text = resolved.to_yaml().map_err(|error| LoadPathError::Invalid(error.to_string()))?;
        scenario::parse(&resolved.name, text.as_bytes(), &[])
            .map_err(|error| LoadPathError::Invalid(error.message()))?;
    }
    Ok((resolved, chosen, planned))
}

fn plan_for(scenario: &Scenario, team: usize) -> Result<LoadPath, LoadPathError> {
    let id = || scenario.teams[team].id.clone();
    let spent = |Spent| LoadPathError::BudgetSpent { team: id() };
    let Some(task) = Task::new(scenario, team)? else { return Err(spent(Spent)) };
    let budget = Budget::new(EFFORT, &|| false);
    let margin = task.margin;
    match solve(&task, &budget).map_err(spent)? {
        Found::Path(path) => Ok(path),
        Found::StartBlocked(obstruction) => Err(LoadPathError::Start { team: id(), obstruction, margin }),
        Found::GoalBlocked(obstruction) => {
            Err(LoadPathError::Goal { team: id(), obstruction, margin, x: task.goal.x, y: task.goal.y })
        }
        Found::NoPassage { proven } => {
            let half = if proven { task.body.inner } else { task.body.half_width().min(task.body.reach) };
            let in_the_way = flood::in_the_way(&task, half + margin, &budget).map_err(spent)?;
            Err(LoadPathError::NoPassage { team: id(), width: 2.0 * half, margin, in_the_way, proven })
        }
    }
}
