//! What makes one conflict-based search a planner for grids or for cars.
//!
//! # Source
//! The interface follows conflict-based search (Sharon et al., "Conflict-based search for optimal multi-agent pathfinding",
//! 2015) with the pieces that its bounded-suboptimal (Barer et al. 2014, ECBS) and disjoint (Li et al. 2019) variants ask of a
//! single-agent search.
//!
//! # Deviations
//! The search never looks into a path, a rule or a conflict: it keeps costs, lower bounds and who conflicts with whom.
//!
//! # How the search uses a domain
//! 1. For every assignment that it looks at, it asks [`Domain::plan`] for a path of each agent without rules, one after the
//!    other, each seeing those planned before it.
//! 2. It asks [`Domain::clash`] for every pair, takes the [`Clash`] that is first in `priority`, and has it [split] into two
//!    branches. In each branch it plans the agent again that is bound by the new rule (and, if the rule binds everyone, all
//!    whose path does not [obey](Domain::obeys) it), and asks for the clashes of these agents only.
//! 3. It repeats that until a node of the tree is without clashes.
//!
//! What has to hold for the answer to be right:
//! - `plan` must return `None` only if no path obeys all the rules, and `lower_bound` must not exceed the cost of any path
//!   that does;
//! - a path that was planned obeys the rules that it was planned with;
//! - every pair of paths without a clash can be driven together;
//! - no pair of paths that obeys neither branch of a split can be driven together.
//!
//! [split]: Domain::split

use std::sync::Arc;

use super::{Budget, Spent};

/// One kind of agents and of space. Implementations own their caches and scratch memory, which is why the methods take
/// `&mut self`; the answers must not depend on what was asked before, except through the budget.
pub trait Domain {
    /// The way of one agent, whatever it consists of. Shared, never changed.
    type Path;
    /// A constraint on the way of one agent, or of all agents (see [`Bound::everyone`]).
    type Rule: Clone;
    /// Where and how two ways are in conflict.
    type Conflict: Clone;

    /// How many agents there are; they are called 0, 1, ….
    fn agents(&self) -> usize;

    /// A path of one agent that obeys all rules, or `None` if there is none.
    ///
    /// Let L be the least cost of such a path. The answer's `lower_bound` is at most L; its cost is at most the larger of
    /// `query.weight` · `lower_bound` and `query.ceiling`. Among the paths that are cheap enough, one with few conflicts
    /// with the `query.paths` of the other agents is wanted; which one is up to the domain, but always the same.
    ///
    /// Search spaces must be finite (a horizon after the last rule), so that `None` comes after finite time.
    ///
    /// # Errors
    /// [`Spent`] as soon as the budget is; every expansion is to be counted with [`Budget::spend`].
    fn plan(&mut self, query: &Query<'_, Self>, budget: &Budget<'_>) -> Result<Option<Planned<Self::Path>>, Spent>;

    /// What two agents' ways have against each other, the one conflict that is best to split; `None` if nothing. Called with
    /// `first < second`, once per pair of paths that meet in a node.
    fn clash(
        &mut self,
        first: usize,
        first_path: &Self::Path,
        second: usize,
        second_path: &Self::Path,
    ) -> Option<Clash<Self::Conflict>>;

    /// Two branches for a clash. Each has to forbid what the agent it binds does in this conflict, so that the search gets
    /// ahead; together they must not lose a solution.
    fn split(&mut self, first: usize, second: usize, conflict: &Self::Conflict) -> [Bound<Self::Rule>; 2];

    /// Whether a path that was planned without it obeys a rule that binds everyone: agents whose path does need not be
    /// planned again. Asked for the agent that the rule names, too. Domains whose rules bind one agent each keep this default.
    fn obeys(&self, agent: usize, path: &Self::Path, bound: &Bound<Self::Rule>) -> bool {
        let _ = (agent, path, bound);
        true
    }

    /// States that `plan` expanded so far, for the record.
    fn expanded(&self) -> u64;
}

/// What is asked of [`Domain::plan`].
pub struct Query<'a, D: Domain + ?Sized> {
    /// Who is to be planned.
    pub agent: usize,
    /// Where to: an index into the agent's goals. `None`: nowhere, it only must not be in the way.
    pub goal: Option<usize>,
    /// All rules that bind this agent: those that name it, and those that name another and bind everyone. Youngest first.
    pub rules: &'a [Bound<D::Rule>],
    /// The present paths of all agents, `None` where not planned yet. Soft: to be avoided where that costs little. The
    /// agent's own entry is not to be heeded.
    pub paths: &'a [Option<Planned<D::Path>>],
    /// How much dearer than the lower bound a path may be, at least 1.
    pub weight: f64,
    /// A lower bound that is known already, from fewer rules; 0 if none.
    pub floor: f64,
    /// What the path may cost whatever its lower bound is: what it costs already, when a found plan is polished; else 0.
    pub ceiling: f64,
}

/// A path with what it costs.
pub struct Planned<P> {
    /// The path.
    pub path: Arc<P>,
    /// Its cost.
    pub cost: f64,
    /// No path that obeys the rules it was planned with costs less.
    pub lower_bound: f64,
}

impl<P> Clone for Planned<P> {
    fn clone(&self) -> Self {
        Self { path: Arc::clone(&self.path), cost: self.cost, lower_bound: self.lower_bound }
    }
}

/// What two paths have against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clash<C> {
    /// The conflict that is to be split first.
    pub conflict: C,
    /// How many conflicts these two paths have, at least 1; only for ordering.
    pub count: u32,
    /// Which pair is split first: the one with the least. Conflicts whose both branches cost more (cardinal) should come
    /// before those of which one does (semi-cardinal), and these before the rest; earlier before later.
    pub priority: u32,
}

/// A rule with the agent that it names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bound<R> {
    /// Whom it names.
    pub agent: usize,
    /// What it says.
    pub rule: R,
    /// Whether it binds all other agents too (in its own way: "agent 3 is here at step 5" keeps the others away). Disjoint
    /// splitting and rules about goals need it.
    pub everyone: bool,
}

impl<R> Bound<R> {
    /// A rule that binds the agent that it names, and nobody else.
    pub const fn on(agent: usize, rule: R) -> Self {
        Self { agent, rule, everyone: false }
    }

    /// A rule about one agent that the others have to heed too.
    pub const fn about(agent: usize, rule: R) -> Self {
        Self { agent, rule, everyone: true }
    }

    /// Whether `agent` has to obey it.
    pub const fn binds(&self, agent: usize) -> bool {
        self.everyone || self.agent == agent
    }
}

/// Goals of all agents, one assignment after the other.
pub trait Assignments {
    /// The next assignment, never cheaper than the one before; `None` when there are no more.
    ///
    /// # Errors
    /// [`Spent`] as soon as the budget is.
    fn next(&mut self, budget: &Budget<'_>) -> Result<Option<Assigned>, Spent>;
}

/// Which goal each agent takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Assigned {
    /// Per agent an index into its goals; `None`: it takes none.
    pub goals: Vec<Option<usize>>,
    /// No plan with these goals, or with those of a later assignment, costs less.
    pub cost: f64,
}

/// The one assignment of agents that have one goal each, or none.
#[derive(Clone, Debug)]
pub struct Given(Option<Assigned>);

impl Given {
    /// `goals` and nothing after them.
    pub const fn new(goals: Vec<Option<usize>>) -> Self {
        Self(Some(Assigned { goals, cost: 0.0 }))
    }
}

impl Assignments for Given {
    fn next(&mut self, _: &Budget<'_>) -> Result<Option<Assigned>, Spent> {
        Ok(self.0.take())
    }
}

/// How a conflict-based search ended.
pub enum Found<P> {
    /// Paths of all agents without conflicts.
    Solved {
        /// Which goals the agents took.
        goals: Vec<Option<usize>>,
        /// Their paths.
        paths: Vec<Planned<P>>,
        /// Sum of the paths' costs.
        cost: f64,
        /// No plan costs less, with any assignment.
        lower_bound: f64,
    },
    /// The tree was searched to its end: there is no plan.
    Exhausted,
    /// The budget was spent first.
    Spent {
        /// No plan costs less, with any assignment.
        best_bound: f64,
    },
}
