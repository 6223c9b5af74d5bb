//! Plans in the layout of libMultiRobotPlanning and CL-CBS, so that their viewers show ours and we check theirs.
//!
//! ```yaml
//! statistics:
//!   cost: 6
//!   makespan: 3
//! schedule:
//!   agent0:
//!     - x: 0
//!       y: 1
//!       t: 0
//! ```
//!
//! Cars have a `yaw` too, which turns as in the instance's file. Every number is written with the digits that bring it back.
//! Statistics may be missing, and others than ours are passed over.

use std::fmt::Write as _;

use cohaul_core::se2::{self, Pose2};

use super::error::{FormatError, FormatProblem, abbreviated};
use super::write::quoted;
use super::yaml::{Node, Tree};
use super::{Heading, MAX_COORDINATE};
use crate::instance::{CarInstance, Cell, GridInstance};
use crate::outcome::Effort;
use crate::plan::{CarPlan, Claims, GridPlan, Plan, Route};

/// What a plan's file says about the search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Work that was done.
    pub effort: Effort,
    /// CPU time of the search with its set-up, s.
    pub runtime: Option<f64>,
}

/// A plan on a grid as text.
pub fn write_grid(plan: &GridPlan, statistics: &Statistics) -> String {
    write(plan, statistics, |text, cell| {
        let _ = write!(text, "    - x: {}\n      y: {}\n", cell.x, cell.y);
    })
}

/// A plan for bodies as text; yaws turn as `heading` says.
pub fn write_car(plan: &CarPlan, heading: Heading, statistics: &Statistics) -> String {
    write(plan, statistics, |text, pose| {
        let at = se2::position(pose);
        let yaw = heading.turned(se2::yaw(pose));
        let _ = write!(text, "    - x: {}\n      y: {}\n      yaw: {yaw}\n", at.x, at.y);
    })
}

fn write<S>(plan: &Plan<S>, statistics: &Statistics, state: impl Fn(&mut String, &S)) -> String {
    let states: usize = plan.routes.iter().map(|route| route.states.len()).sum();
    let mut text = String::with_capacity(256 + 40 * plan.routes.len() + 96 * states);
    text.push_str("statistics:\n");
    let Claims { cost, makespan, flowtime, lower_bound, bound } = plan.claims;
    let numbers = [
        ("cost", cost),
        ("makespan", makespan),
        ("flowtime", flowtime),
        ("lowerBound", lower_bound),
        ("bound", bound),
        ("runtime", statistics.runtime),
    ];
    for (key, value) in numbers {
        if let Some(value) = value.filter(|value| value.is_finite()) {
            let _ = writeln!(text, "  {key}: {value}");
        }
    }
    let Effort { high_level_expanded, low_level_expanded, assignments } = statistics.effort;
    let _ = write!(
        text,
        "  highLevelExpanded: {high_level_expanded}\n  lowLevelExpanded: {low_level_expanded}\n  numTaskAssignments: {assignments}\n"
    );
    text.push_str(if plan.routes.is_empty() { "schedule: {}\n" } else { "schedule:\n" });
    for route in &plan.routes {
        let _ = writeln!(text, "  {}:", quoted(&route.name));
        for (step, at) in route.states.iter().enumerate() {
            state(&mut text, at);
            let _ = writeln!(text, "      t: {step}");
        }
    }
    text
}

/// Reads a plan for `instance`; `name` is the file's, for messages. Routes come out in the order of the instance. Where goals
/// are assigned, a route takes the goal in which it ends.
///
/// # Errors
/// What is wrong, and where: no schedule, agents missing or unknown, steps that do not follow one another.
pub fn read_grid(text: &str, name: &str, instance: &GridInstance) -> Result<GridPlan, FormatError> {
    let tree = Tree::read(name, text)?;
    let names: Vec<&str> = instance.agents.iter().map(|agent| agent.name.as_str()).collect();
    let mut plan = read(&tree, &names, |x, y, _| {
        let read = |node: Node<'_>, what: &str| {
            let value = node.whole(what)?;
            let range = "between -1000000000 and 1000000000";
            match i32::try_from(value) {
                Ok(value) if value.abs() <= 1_000_000_000 => Ok(value),
                _ => Err(node.error(FormatProblem::OutOfRange { what: what.to_owned(), value: value as f64, range })),
            }
        };
        Ok(Cell { x: read(x, "x")?, y: read(y, "y")? })
    })?;
    for (route, agent) in plan.routes.iter_mut().zip(&instance.agents) {
        let end = route.states.last();
        let taken = agent.goals.iter().position(|goal| Some(goal) == end);
        route.goal = if instance.assignment { taken } else { own_goal(&agent.goals) };
    }
    Ok(plan)
}

/// How far a body may end from a goal, metres and radians, so that the goal still counts as taken by it; the certifier says
/// whether it is reached.
const NEAR: f64 = 0.5;

/// The same for bodies; yaws turn as `heading` says.
///
/// # Errors
/// As [`read_grid`].
pub fn read_car(text: &str, name: &str, instance: &CarInstance, heading: Heading) -> Result<CarPlan, FormatError> {
    let tree = Tree::read(name, text)?;
    let names: Vec<&str> = instance.agents.iter().map(|agent| agent.name.as_str()).collect();
    let mut plan = read(&tree, &names, |x, y, yaw| {
        let yaw = yaw.ok_or_else(|| x.error(FormatProblem::MissingKey { key: "yaw", place: "a state" }))?;
        let number = |node: Node<'_>, what: &str| {
            let value = node.number(what)?;
            let range = "between -1000000 and 1000000";
            if value.abs() > MAX_COORDINATE {
                return Err(node.error(FormatProblem::OutOfRange { what: what.to_owned(), value, range }));
            }
            Ok(value)
        };
        Ok(se2::pose(number(x, "x")?, number(y, "y")?, heading.turned(number(yaw, "yaw")?)))
    })?;
    for (route, agent) in plan.routes.iter_mut().zip(&instance.agents) {
        route.goal = match route.states.last() {
            Some(end) if instance.assignment => nearest(end, &agent.goals),
            _ => own_goal(&agent.goals),
        };
    }
    Ok(plan)
}

fn own_goal<T>(goals: &[T]) -> Option<usize> {
    (!goals.is_empty()).then_some(0)
}

fn nearest(end: &Pose2, goals: &[Pose2]) -> Option<usize> {
    let apart = |goal: &Pose2| {
        let between = goal.inv_mul(end);
        se2::position(&between).norm().max(se2::yaw(&between).abs())
    };
    let (distance, index) =
        goals.iter().map(apart).zip(0..).min_by(|a: &(f64, usize), b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
    (distance <= NEAR).then_some(index)
}

fn read<S>(
    tree: &Tree<'_>,
    names: &[&str],
    state: impl Fn(Node<'_>, Node<'_>, Option<Node<'_>>) -> Result<S, FormatError>,
) -> Result<Plan<S>, FormatError> {
    let root = tree.root();
    let (schedule, claims) = match (root.get("schedule"), root.get("statistics")) {
        (Some(schedule), statistics) => (schedule, statistics.map(read_claims).transpose()?.unwrap_or_default()),
        (None, _) if root.get("agents").is_some() => {
            let found = "this is an instance, not a plan";
            let remedy = "give it as --instance, and the plan first";
            return Err(root.error(FormatProblem::OtherKind { found, remedy }));
        }
        (None, _) => return Err(root.error(FormatProblem::MissingKey { key: "schedule", place: "the plan" })),
    };
    let places = Places::of(schedule, names)?;
    let mut routes: Vec<Option<Route<S>>> = names.iter().map(|_| None).collect();
    for (key, name, states) in schedule.entries("schedule")? {
        let Some(index) = places.index(name) else {
            return Err(key.error(FormatProblem::UnknownAgent { name: abbreviated(name) }));
        };
        if routes[index].is_some() {
            return Err(key.error(FormatProblem::DuplicateKey { key: abbreviated(name) }));
        }
        let name = names[index].to_owned();
        let states = read_states(states, &name, &state)?;
        if states.is_empty() {
            return Err(key.error(FormatProblem::EmptyRoute { name }));
        }
        routes[index] = Some(Route { name, goal: None, states });
    }
    if let Some(index) = routes.iter().position(Option::is_none) {
        return Err(schedule.error(FormatProblem::MissingAgent { name: names[index].to_owned() }));
    }
    Ok(Plan { routes: routes.into_iter().flatten().collect(), claims })
}

/// Which agent a name of the schedule means.
struct Places<'a> {
    /// Names in order, with the agents that bear them.
    names: Vec<(&'a str, usize)>,
    /// The programs that the format is from call agents by their numbers, whatever the instance calls them.
    by_number: bool,
}

impl<'a> Places<'a> {
    fn of(schedule: Node<'_>, names: &[&'a str]) -> Result<Self, FormatError> {
        let mut sorted: Vec<(&str, usize)> = names.iter().copied().zip(0..).collect();
        sorted.sort_unstable();
        let mut places = Self { names: sorted, by_number: false };
        let mut keys = schedule.entries("schedule")?;
        places.by_number = keys.any(|(_, name, _)| places.index(name).is_none())
            && schedule.entries("schedule")?.all(|(_, name, _)| number(name).is_some_and(|index| index < names.len()));
        Ok(places)
    }

    fn index(&self, name: &str) -> Option<usize> {
        if self.by_number {
            return number(name);
        }
        let found = self.names.binary_search_by(|(known, _)| (*known).cmp(name)).ok()?;
        Some(self.names[found].1)
    }
}

/// K of `agentK`.
fn number(name: &str) -> Option<usize> {
    let digits = name.strip_prefix("agent")?;
    digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok()).flatten()
}

fn read_states<S>(
    list: Node<'_>,
    name: &str,
    state: &impl Fn(Node<'_>, Node<'_>, Option<Node<'_>>) -> Result<S, FormatError>,
) -> Result<Vec<S>, FormatError> {
    let place = "a state";
    let mut states = Vec::with_capacity(list.len());
    for (expected, node) in list.items("schedule")?.enumerate() {
        let [x, y, yaw, t] = node.fields(place, ["x", "y", "yaw", "t"])?;
        let need = |found: Option<_>, key| found.ok_or_else(|| node.error(FormatProblem::MissingKey { key, place }));
        let (x, y, t) = (need(x, "x")?, need(y, "y")?, need(t, "t")?);
        let found = t.whole("t")?;
        let expected = expected as i64;
        if found != expected {
            return Err(t.error(FormatProblem::Step { name: abbreviated(name), found, expected }));
        }
        states.push(state(x, y, yaw)?);
    }
    Ok(states)
}

fn read_claims(statistics: Node<'_>) -> Result<Claims, FormatError> {
    let mut claims = Claims::default();
    if statistics.is_null() {
        return Ok(claims);
    }
    for (_, key, value) in statistics.entries("statistics")? {
        let claim = match key {
            "cost" => &mut claims.cost,
            "makespan" => &mut claims.makespan,
            "flowtime" => &mut claims.flowtime,
            "lowerBound" => &mut claims.lower_bound,
            "bound" => &mut claims.bound,
            _ => continue,
        };
        if !value.is_null() {
            *claim = Some(value.number(key)?);
        }
    }
    Ok(claims)
}

#[cfg(test)]
mod tests;
