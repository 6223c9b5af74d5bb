//! Planning problems from files: read, solved within a deadline, explained by the names of the agents.

pub mod generate;
pub mod report;

use std::path::{Path, PathBuf};

use cohaul_core::se2;
use cohaul_planner::certify::{self, Violation};
use cohaul_planner::instance::{Instance, Obstacle};
use cohaul_planner::io::{self, Document, FormatError, Heading, movingai, schedule};
use cohaul_planner::outcome::{Effort, Ended, Outcome, Reason};
use cohaul_planner::plan::{CarPlan, Claims, GridPlan};
use cohaul_planner::search::Budget;
use cohaul_planner::{car, grid};

use crate::files::{self, FileError};
use crate::memory;
use crate::page;
use crate::stopwatch::Stopwatch;

/// The searches by the names that the command has for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planner {
    /// For agents on grids.
    Grid(grid::Planner),
    /// For bodies that drive.
    Car,
}

impl Planner {
    /// All of them, by name.
    pub const NAMES: [(&'static str, Self); 7] = [
        ("cbs", Self::Grid(grid::Planner::Cbs)),
        ("ecbs", Self::Grid(grid::Planner::Ecbs)),
        ("cbs-ta", Self::Grid(grid::Planner::CbsTa)),
        ("ecbs-ta", Self::Grid(grid::Planner::EcbsTa)),
        ("ita-cbs", Self::Grid(grid::Planner::ItaCbs)),
        ("ita-ecbs", Self::Grid(grid::Planner::ItaEcbs)),
        ("cl-cbs", Self::Car),
    ];

    /// The one called `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(known, _)| *known == name).map(|(_, planner)| planner)
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(_, known)| *known == self).map_or("", |(name, _)| name)
    }

    /// The usual one for an instance.
    pub const fn for_instance(instance: &Instance) -> Self {
        match instance {
            Instance::Grid(grid) if grid.assignment => Self::Grid(grid::Planner::EcbsTa),
            Instance::Grid(_) => Self::Grid(grid::Planner::Ecbs),
            _ => Self::Car,
        }
    }
}

/// What is read besides the file itself.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// The map of a MovingAI scenario, in place of the one that it names.
    pub map: Option<PathBuf>,
    /// CL-CBS's `config.yaml`, in place of what the file says of the body.
    pub vehicle: Option<PathBuf>,
    /// Only so many of the agents.
    pub agents: Option<usize>,
    /// Whether bodies may start inside an obstacle.
    pub free_starts: bool,
}

/// Reads the instance in `path`. The map that a MovingAI scenario names is looked for in the scenario's folder.
///
/// # Errors
/// Files that cannot be read, or what is wrong with them.
pub fn read(path: &Path, source: &Source) -> Result<Document, FileError> {
    parse(&files::read_text(path)?, path, source)
}

/// Reads the instance in `text` as if it came from `path`.
///
/// # Errors
/// What is wrong with it, or files that belong to it and cannot be read.
pub fn parse(text: &str, path: &Path, source: &Source) -> Result<Document, FileError> {
    let name = path.display().to_string();
    if !text.starts_with("version ") {
        let config = source.vehicle.as_deref().map(read_vehicle).transpose()?;
        let mut document = io::read_document(text, &name, &io::Options { config, agents: source.agents })?;
        if let Instance::Car(car) = &mut document.instance {
            car.free_starts = source.free_starts;
        }
        return Ok(document);
    }
    // only the last part of the name: the others are folders of whoever made the scenario
    let named = || movingai::map_name(text).and_then(|map| map.rsplit(['/', '\\']).next());
    let map = source.map.clone().unwrap_or_else(|| path.with_file_name(named().unwrap_or("map")));
    let map_text = files::read_text(&map)?;
    let map_name = map.display().to_string();
    let map = movingai::Text { name: &map_name, text: &map_text };
    let scenario = movingai::Text { name: &name, text };
    let instance = Instance::Grid(movingai::read(map, scenario, source.agents)?);
    Ok(Document { instance, heading: Heading::default() })
}

/// Whether the file in `path` is the scenario of a mission.
///
/// # Errors
/// A file that cannot be read.
pub fn is_mission(path: &Path) -> Result<bool, FileError> {
    Ok(files::read_text(path)?.lines().any(|line| line.starts_with("format:")))
}

fn read_vehicle(path: &Path) -> Result<io::Config, FileError> {
    let text = files::read_text(path)?;
    Ok(io::read_config(&text, &path.display().to_string())?)
}

/// A plan of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyPlan {
    /// On a grid.
    Grid(GridPlan),
    /// In the plane.
    Car(CarPlan),
}

impl AnyPlan {
    /// Reads the plan in `path` for an instance.
    ///
    /// # Errors
    /// A file that cannot be read, or what is wrong with it.
    pub fn read(path: &Path, document: &Document) -> Result<Self, FileError> {
        Ok(Self::parse(&files::read_text(path)?, &path.display().to_string(), document)?)
    }

    /// Reads the plan in `text`, which comes from the file `name`, for an instance.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str, name: &str, document: &Document) -> Result<Self, FormatError> {
        match &document.instance {
            Instance::Grid(grid) => Ok(Self::Grid(schedule::read_grid(text, name, grid)?)),
            Instance::Car(car) => Ok(Self::Car(schedule::read_car(text, name, car, document.heading)?)),
            _ => Err(unknown(name)),
        }
    }

    /// As text; yaws turn as in the instance's file.
    pub fn to_text(&self, heading: Heading, statistics: &schedule::Statistics) -> String {
        match self {
            Self::Grid(plan) => schedule::write_grid(plan, statistics),
            Self::Car(plan) => schedule::write_car(plan, heading, statistics),
        }
    }

    /// What is wrong with it, by the certifier.
    pub fn violations(&self, instance: &Instance, model: car::Model) -> Vec<Violation> {
        match (self, instance) {
            (Self::Grid(plan), Instance::Grid(instance)) => certify::grid(instance, plan),
            (Self::Car(plan), Instance::Car(instance)) => {
                let model = match model {
                    car::Model::Clcbs => certify::Model::Clcbs,
                    car::Model::Exact => certify::Model::Exact,
                };
                certify::car(instance, plan, model)
            }
            // plans are read and made for their instances
            _ => Vec::new(),
        }
    }

    /// A page that plays it, with what is wrong with it.
    pub fn page(&self, title: &str, instance: &Instance, violations: &[Violation]) -> String {
        let planned = self.planned(instance);
        planned.map(|planned| page::plan_page(title, planned, violations)).unwrap_or_default()
    }

    /// A picture of it, SVG, with what is wrong with it.
    pub fn picture(&self, title: &str, instance: &Instance, violations: &[Violation]) -> String {
        let planned = self.planned(instance);
        planned.map(|planned| page::plan_picture(title, planned, violations)).unwrap_or_default()
    }

    /// It with its instance; nothing for an instance of another kind.
    const fn planned<'a>(&'a self, instance: &'a Instance) -> Option<page::Planned<'a>> {
        match (self, instance) {
            (Self::Grid(plan), Instance::Grid(instance)) => Some(page::Planned::Grid(instance, plan)),
            (Self::Car(plan), Instance::Car(instance)) => Some(page::Planned::Car(instance, plan)),
            _ => None,
        }
    }

    /// What the planner says about it.
    pub const fn claims(&self) -> &Claims {
        match self {
            Self::Grid(plan) => &plan.claims,
            Self::Car(plan) => &plan.claims,
        }
    }
}

fn unknown(name: &str) -> FormatError {
    let found = "this is an instance of a kind that is not known here";
    FormatError::new(name, 1, 1, io::FormatProblem::OtherKind { found, remedy: "give a grid, or cars" })
}

/// CPU time, s, that it takes to give back a byte of a search's memory, measured: the deadline includes that.
const GIVING_BACK: f64 = 0.4e-9;
/// Memory, bytes, beyond which a search gives up.
pub const MOST_MEMORY: f64 = 4.0 * 1024.0 * 1024.0 * 1024.0;

/// The usual bound on grids.
pub const GRID_BOUND: f64 = 1.3;

/// What to plan with.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// Which search.
    pub planner: Planner,
    /// By which factor the cost may exceed the lower bound; without it [`GRID_BOUND`] on grids, and for bodies that drive
    /// the fast planner's plan as it is.
    pub bound: Option<f64>,
    /// When bodies count as touching.
    pub model: car::Model,
    /// How many bodies that drive are planned at once; all without it.
    pub batch: Option<usize>,
    /// What assignments of goals to bodies that drive are judged by.
    pub metric: car::Metric,
    /// CPU time, s, after which the search gives up.
    pub timeout: f64,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Answer {
    /// A plan, the reasons why there is none, or the bound that was reached.
    pub outcome: Outcome<AnyPlan>,
    /// What it took.
    pub effort: Effort,
    /// CPU time of the search with its set-up, s.
    pub runtime: f64,
}

/// Plans, until the deadline on `watch` or until `interrupted`. Nothing where the planner is for instances of another kind.
pub fn solve(
    instance: &Instance,
    request: &Request,
    watch: &Stopwatch,
    interrupted: &dyn Fn() -> bool,
) -> Option<Answer> {
    let own = Stopwatch::start();
    let held = memory::resident();
    let stop = || {
        let grown = memory::resident() - held;
        interrupted() || watch.seconds().0 + GIVING_BACK * grown >= request.timeout || grown > MOST_MEMORY
    };
    let budget = Budget::new(u64::MAX, &stop);
    let (outcome, effort) = match (instance, request.planner) {
        (Instance::Grid(instance), Planner::Grid(planner)) => {
            let Ended { outcome, effort } =
                grid::solve(instance, &grid::Options { planner, bound: request.bound.unwrap_or(GRID_BOUND) }, &budget);
            (of_kind(outcome, AnyPlan::Grid), effort)
        }
        (Instance::Car(instance), Planner::Car) => {
            let options = car::Options {
                model: request.model,
                bound: request.bound,
                batch: request.batch,
                metric: request.metric,
                ..car::Options::default()
            };
            let Ended { outcome, effort } = car::solve(instance, &options, &budget);
            (of_kind(outcome, AnyPlan::Car), effort)
        }
        _ => return None,
    };
    Some(Answer { outcome, effort, runtime: own.seconds().0 })
}

fn of_kind<P>(outcome: Outcome<P>, kind: impl Fn(P) -> AnyPlan) -> Outcome<AnyPlan> {
    match outcome {
        Outcome::Solved(plan) => Outcome::Solved(kind(plan)),
        Outcome::Infeasible(reasons) => Outcome::Infeasible(reasons),
        Outcome::BudgetSpent { best_bound } => Outcome::BudgetSpent { best_bound },
    }
}

/// The name of an agent of an instance.
pub fn name(instance: &Instance, agent: usize) -> String {
    let name = match instance {
        Instance::Grid(grid) => grid.agents.get(agent).map(|agent| &agent.name),
        Instance::Car(car) => car.agents.get(agent).map(|agent| &agent.name),
        _ => None,
    };
    name.cloned().unwrap_or_else(|| format!("number {agent}"))
}

/// What kind of reason it is, for programs.
pub const fn kind(reason: &Reason) -> &'static str {
    match reason {
        Reason::StartOutside { .. } => "start_outside",
        Reason::StartBlocked { .. } => "start_blocked",
        Reason::GoalOutside { .. } => "goal_outside",
        Reason::GoalBlocked { .. } => "goal_blocked",
        Reason::StartsCollide { .. } => "starts_collide",
        Reason::GoalsCollide { .. } => "goals_collide",
        Reason::Unreachable { .. } => "unreachable",
        Reason::NoGoal { .. } => "no_goal",
        Reason::Malformed { .. } => "malformed",
        Reason::Exhausted => "exhausted",
        _ => "other",
    }
}

/// A reason in words, with the names of agents and the places of goals and obstacles.
pub fn explain(reason: &Reason, instance: &Instance) -> String {
    let name = |agent: usize| format!("`{}`", name(instance, agent));
    let touched =
        |obstacle: Option<usize>| obstacle.map_or_else(|| "is blocked".to_owned(), |at| touches(instance, at));
    match *reason {
        Reason::StartOutside { agent } => format!("the start of {} lies outside of the map", name(agent)),
        Reason::StartBlocked { agent, obstacle } => format!("the start of {} {}", name(agent), touched(obstacle)),
        Reason::GoalOutside { agent, goal } => {
            format!("the goal {}of {} lies outside of the map", place(instance, agent, goal), name(agent))
        }
        Reason::GoalBlocked { agent, goal, obstacle } => {
            format!("the goal {}of {} {}", place(instance, agent, goal), name(agent), touched(obstacle))
        }
        Reason::StartsCollide { first, second } => {
            format!("{} and {} cannot both stand where they start", name(first), name(second))
        }
        Reason::GoalsCollide { first, second } => {
            format!("{} and {} cannot both stand at their goals", name(first), name(second))
        }
        Reason::Unreachable { agent, goal } => {
            format!("no way leads from the start of {} to its goal {}", name(agent), place(instance, agent, goal))
        }
        Reason::NoGoal { agent } => format!("{} has no goal", name(agent)),
        _ => reason.to_string(),
    }
    .trim_end()
    .to_owned()
}

fn touches(instance: &Instance, obstacle: usize) -> String {
    let found = match instance {
        Instance::Car(car) => car.obstacles.get(obstacle),
        _ => None,
    };
    match found {
        Some(Obstacle::Point { at, .. }) => format!("touches the obstacle at ({}, {})", at.x, at.y),
        _ => format!("touches obstacle {obstacle}"),
    }
}

/// Where a goal is, and a space.
fn place(instance: &Instance, agent: usize, goal: usize) -> String {
    match instance {
        Instance::Grid(grid) => {
            grid.agents.get(agent).and_then(|agent| agent.goals.get(goal)).map(|at| format!("({}, {}) ", at.x, at.y))
        }
        Instance::Car(car) => car.agents.get(agent).and_then(|agent| agent.goals.get(goal)).map(|goal| {
            let at = se2::position(goal);
            format!("({}, {}) ", at.x, at.y)
        }),
        _ => None,
    }
    .unwrap_or_default()
}
