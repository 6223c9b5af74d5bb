//! What a planner answers: who is where in which step, and what the planner claims about it.

use cohaul_core::se2::Pose2;

use crate::instance::Cell;

/// States of all agents, step by step, and what is claimed about them.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan<S> {
    /// One route per agent, in the order of the instance.
    pub routes: Vec<Route<S>>,
    /// What the planner says about it.
    pub claims: Claims,
}

/// Where one agent is in step 0, 1, 2, …; after the last it stays there for good.
#[derive(Clone, Debug, PartialEq)]
pub struct Route<S> {
    /// The agent's name.
    pub name: String,
    /// Which of its goals it takes, an index into the agent's `goals`; none, and it only is not in the way.
    pub goal: Option<usize>,
    /// States in order, at least the start.
    pub states: Vec<S>,
}

/// A plan on a grid.
pub type GridPlan = Plan<Cell>;

/// A plan for bodies that drive: poses of the reference points. Between two of them lies one arc or straight line (or, for
/// differential drives, a turn in place), driven at constant speed.
pub type CarPlan = Plan<Pose2>;

/// Numbers that a plan comes with; a foreign plan may have none of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Claims {
    /// What the planner minimised: on grids the sum over agents of the step of the last arrival, except that where goals are
    /// assigned, waiting at the goal costs nothing (see [`grid`](crate::grid)); for cars the sum of lengths with penalties.
    pub cost: Option<f64>,
    /// Grids: the last arrival in steps; cars: the longest of the agents' ways in metres, a wait counting one step's length.
    pub makespan: Option<f64>,
    /// Grids: the sum over agents of the step of the last arrival; cars: the sum of the agents' ways in metres, a wait counting one step's length.
    pub flowtime: Option<f64>,
    /// No plan can cost less; for cars within a bound no plan of the search space, see [`car`](crate::car).
    pub lower_bound: Option<f64>,
    /// The cost is at most this times the lower bound.
    pub bound: Option<f64>,
}
