//! Does a plan keep its word? An independent check of plans, ours and foreign ones.
//!
//! It shares only data types with the planners: [`crate::instance`], [`crate::plan`] and poses. Motions, distances, sweeps,
//! ways and assignments are computed here once more by other means, so that an error in a search does not hide itself; a
//! test reads the sources of this module and sees that it reaches for nothing else.
//!
//! What is checked: every agent has its route, from its start to a goal of its own; each step can be made; nobody leaves
//! the map or touches what is blocked; nobody meets anybody else, those included who have arrived and stay; as many goals
//! are taken as could be; the claimed numbers are those of the plan.
//!
//! # Claims
//! A claim that is missing is not checked. The claimed lower bound must not exceed the cost, and the cost must not exceed
//! the claimed bound times the lower bound; together they make a claim of optimality (bound 1) one that cost and lower
//! bound agree. Whether a lower bound is one cannot be seen from a plan. A bound without a lower bound is held against an
//! independent weak one: the shortest ways of all agents as if they were alone (grids), their straight distances (cars),
//! under the cheapest assignment where goals are assigned.
//!
//! # Work
//! It is bounded by the size of the plan times a constant, whatever the numbers in it are; pairs that are too many to be
//! looked at are reported as [`ViolationKind::Unchecked`], so a plan that is passed was checked in full.

mod agents;
mod assignment;
mod bodies;
mod car;
mod claims;
mod drive;
mod grid;
mod meetings;
mod motion;
mod sweep;

use std::collections::BTreeMap;
use std::fmt;

use crate::instance::{CarInstance, GridInstance};
use crate::plan::{CarPlan, GridPlan};

/// Most violations that are reported.
pub const VIOLATIONS_MAX: usize = 100;

/// Kinds and agents that are told apart while looking; beyond, new ones are dropped.
const KEPT_MAX: usize = 10_000;

/// When bodies that drive count as being in each other's way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// As CL-CBS has it: reference points keep [`Vehicle::separation`](crate::instance::Vehicle::separation), and obstacles
    /// keep out of the bodies, at the ends of steps.
    Clcbs,
    /// Rectangles that sweep along their arcs, at every time.
    Exact,
}

/// What is wrong with a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ViolationKind {
    /// The instance makes no sense, so nothing can be checked against it.
    Instance,
    /// An agent has no route, or a route no agent, or they are not in the same order.
    Agents,
    /// A number is not finite, or absurdly large, or a heading is none.
    Number,
    /// A route does not begin where its agent stands.
    Start,
    /// A step that cannot be made: too far, or for bodies no arc that they can drive.
    Step,
    /// A body that only drives forwards goes backwards.
    Direction,
    /// A reference point or cell lies outside of the map.
    Outside,
    /// A cell is blocked, or a body touches an obstacle.
    Obstacle,
    /// Two agents in one place, or two bodies that overlap.
    Collision,
    /// Two agents change places.
    Swap,
    /// A route does not end in its goal.
    Goal,
    /// Two agents take one goal, or fewer goals are taken than could be.
    Assignment,
    /// The claimed cost is not that of the plan.
    Cost,
    /// The claimed makespan is not that of the plan.
    Makespan,
    /// The claimed flowtime is not that of the plan.
    Flowtime,
    /// The claimed lower bound exceeds the cost.
    LowerBound,
    /// The cost is not within the claimed bound.
    Bound,
    /// Something could not be checked, for it takes too much work.
    Unchecked,
}

impl ViolationKind {
    /// As reports and files have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Instance => "instance",
            Self::Agents => "agents",
            Self::Number => "number",
            Self::Start => "start",
            Self::Step => "step",
            Self::Direction => "direction",
            Self::Outside => "outside",
            Self::Obstacle => "obstacle",
            Self::Collision => "collision",
            Self::Swap => "swap",
            Self::Goal => "goal",
            Self::Assignment => "assignment",
            Self::Cost => "cost",
            Self::Makespan => "makespan",
            Self::Flowtime => "flowtime",
            Self::LowerBound => "lower_bound",
            Self::Bound => "bound",
            Self::Unchecked => "unchecked",
        }
    }
}

impl fmt::Display for ViolationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One thing that is wrong with a plan.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Violation {
    /// What.
    pub kind: ViolationKind,
    /// When, in steps; between two steps where it happens there.
    pub time: f64,
    /// Who, as indices into the instance's agents, ascending; nobody where it is about the plan as a whole.
    pub agents: Vec<usize>,
    /// What exactly, with numbers.
    pub detail: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {:.3}: {}: {}", self.time, self.kind, self.detail)
    }
}

/// What is wrong with a plan on a grid; nothing, and the plan is right.
///
/// In the order of time, then of agents; of each kind and each set of agents the first only, and at most
/// [`VIOLATIONS_MAX`].
///
/// # Cost
/// The sum over agents of the step of the last arrival; of an agent without a goal, its moves. Plans that assign goals may
/// instead count as the programs of libMultiRobotPlanning do, where waiting in the goal is free even for those who leave it
/// once more. The makespan is the step of the last arrival of all, or the dearest agent's cost where goals are assigned.
///
/// ```
/// use cohaul_planner::certify;
/// use cohaul_planner::instance::{Cell, GridAgent, GridInstance};
/// use cohaul_planner::plan::{Claims, GridPlan, Route};
///
/// let (start, goal) = (Cell { x: 0, y: 0 }, Cell { x: 1, y: 0 });
/// let agent = GridAgent { name: "a".into(), start, goals: vec![goal] };
/// let instance =
///     GridInstance { width: 2, height: 1, blocked: vec![false; 2], agents: vec![agent], assignment: false };
/// let route = Route { name: "a".into(), goal: Some(0), states: vec![start, goal] };
/// let mut plan = GridPlan { routes: vec![route], claims: Claims { cost: Some(1.0), ..Claims::default() } };
/// assert!(certify::grid(&instance, &plan).is_empty());
/// plan.claims.cost = Some(0.0);
/// assert_eq!(certify::grid(&instance, &plan)[0].kind.name(), "cost");
/// ```
pub fn grid(instance: &GridInstance, plan: &GridPlan) -> Vec<Violation> {
    grid::check(instance, plan)
}

/// What is wrong with a plan for bodies that drive; nothing, and the plan is right. Order and number as in [`grid`](fn@grid).
///
/// # Steps
/// Between two poses lies one arc or straight line, at most [`step_length`](crate::instance::Vehicle::step_length) long and
/// no tighter than the turning radius, or a wait; for differential drives a straight line or a turn in place by at most
/// `step_angle`. Which one follows from the two poses.
///
/// # Tolerances
/// Poses may be off by 1 µm and 1 µrad. Where every coordinate of a plan can be written with six digits, as the C++ programs
/// print them, or with up to nine, by half a unit of the last digit of the largest of them too. Steps, starts and goals are held against
/// twice that; bodies may overlap by 1 µm, or by what the digits leave open.
///
/// # Ways and costs
/// The way of an arc or a straight line is its length, of a wait one step's length, of a turn in place by the angle a
/// `step_length · |a| / step_angle`. Waits after the last arrival are free. Flowtime is the sum of all ways, makespan the
/// longest agent's way. The cost is the sum of ways, times the turning penalty where the step turns, times the reversing penalty
/// where it goes backwards, times the switching penalty where it goes the other way than the last step before it that went
/// either way. CL-CBS charges the last curve of each route without most penalties, and nothing in its files says where that
/// curve begins: a plan of so few digits may claim any cost from its flowtime to the cost with all penalties.
pub fn car(instance: &CarInstance, plan: &CarPlan, model: Model) -> Vec<Violation> {
    car::check(instance, plan, model)
}

/// What was found so far: of each kind and each set of agents the first.
#[derive(Default)]
struct Findings {
    found: BTreeMap<(ViolationKind, Vec<usize>), Violation>,
}

impl Findings {
    /// Notes a violation; `detail` is only made where it is the first of its kind.
    fn add(&mut self, kind: ViolationKind, time: f64, agents: &[usize], detail: impl FnOnce() -> String) {
        let mut agents = agents.to_vec();
        agents.sort_unstable();
        let key = (kind, agents);
        let is_full = self.is_full();
        match self.found.get_mut(&key) {
            Some(known) if time < known.time => {
                known.time = time;
                known.detail = detail();
            }
            Some(_) => {}
            None if is_full => {}
            None => {
                let violation = Violation { kind, time, agents: key.1.clone(), detail: detail() };
                self.found.insert(key, violation);
            }
        }
    }

    fn is_full(&self) -> bool {
        self.found.len() >= KEPT_MAX
    }

    fn finish(self) -> Vec<Violation> {
        let mut violations: Vec<Violation> = self.found.into_values().collect();
        violations
            .sort_by(|a, b| a.time.total_cmp(&b.time).then_with(|| a.agents.cmp(&b.agents)).then(a.kind.cmp(&b.kind)));
        violations.truncate(VIOLATIONS_MAX);
        violations
    }
}

/// How much may still be looked at.
struct Work {
    left: u64,
}

impl Work {
    /// Whether `amount` more may be done; once not, never again.
    fn spend(&mut self, amount: u64) -> bool {
        self.left = self.left.saturating_sub(amount);
        self.left > 0
    }
}
