//! How a search ends. It always does: with a plan, with the reason why there is none, or with its budget spent.

use std::fmt;

/// How a search ended, and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended<P> {
    /// What came out.
    pub outcome: Outcome<P>,
    /// What it took.
    pub effort: Effort,
}

/// What a search came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome<P> {
    /// A plan.
    Solved(P),
    /// There is none, for these reasons (at least one).
    Infeasible(Vec<Reason>),
    /// Neither was found within the budget.
    BudgetSpent {
        /// No plan can cost less.
        best_bound: f64,
    },
}

/// Work that was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Nodes of the conflict tree that were expanded.
    pub high_level_expanded: u64,
    /// States that single-agent searches expanded.
    pub low_level_expanded: u64,
    /// Assignments of goals that were looked at.
    pub assignments: u64,
}

/// Why there is no plan. Agents are indices into the instance.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// The start lies outside of the map.
    StartOutside {
        /// Whose.
        agent: usize,
    },
    /// The start is blocked.
    StartBlocked {
        /// Whose.
        agent: usize,
        /// By which obstacle, an index into the instance's; none on grids.
        obstacle: Option<usize>,
    },
    /// A goal lies outside of the map.
    GoalOutside {
        /// Whose.
        agent: usize,
        /// Which of the agent's goals.
        goal: usize,
    },
    /// A goal is blocked.
    GoalBlocked {
        /// Whose.
        agent: usize,
        /// Which of the agent's goals.
        goal: usize,
        /// By which obstacle, an index into the instance's; none on grids.
        obstacle: Option<usize>,
    },
    /// Two agents cannot both stand where they start.
    StartsCollide {
        /// One agent.
        first: usize,
        /// The other.
        second: usize,
    },
    /// Two agents cannot both stand at their goals.
    GoalsCollide {
        /// One agent.
        first: usize,
        /// The other.
        second: usize,
    },
    /// No way leads from the start to the goal, even with nobody else there.
    Unreachable {
        /// Whose.
        agent: usize,
        /// Which of the agent's goals.
        goal: usize,
    },
    /// Agent without any goal in an instance that does not assign goals.
    NoGoal {
        /// Who.
        agent: usize,
    },
    /// The instance makes no sense: it has numbers that are none, or absurdly large ones, or obstacles without an inside.
    Malformed {
        /// What makes none.
        what: String,
    },
    /// All that there is to search was searched.
    Exhausted,
}

impl Reason {
    /// The agents that it is about.
    pub fn agents(&self) -> Vec<usize> {
        match *self {
            Self::StartOutside { agent }
            | Self::StartBlocked { agent, .. }
            | Self::GoalOutside { agent, .. }
            | Self::GoalBlocked { agent, .. }
            | Self::Unreachable { agent, .. }
            | Self::NoGoal { agent } => vec![agent],
            Self::StartsCollide { first, second } | Self::GoalsCollide { first, second } => vec![first, second],
            Self::Malformed { .. } | Self::Exhausted => Vec::new(),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StartOutside { agent } => write!(f, "the start of agent {agent} lies outside of the map"),
            Self::StartBlocked { agent, obstacle: None } => write!(f, "the start of agent {agent} is blocked"),
            Self::StartBlocked { agent, obstacle: Some(at) } => {
                write!(f, "the start of agent {agent} touches obstacle {at}")
            }
            Self::GoalOutside { agent, goal } => write!(f, "goal {goal} of agent {agent} lies outside of the map"),
            Self::GoalBlocked { agent, goal, obstacle: None } => write!(f, "goal {goal} of agent {agent} is blocked"),
            Self::GoalBlocked { agent, goal, obstacle: Some(at) } => {
                write!(f, "goal {goal} of agent {agent} touches obstacle {at}")
            }
            Self::StartsCollide { first, second } => {
                write!(f, "the starts of agents {first} and {second} are too close to each other")
            }
            Self::GoalsCollide { first, second } => {
                write!(f, "the goals of agents {first} and {second} are too close to each other")
            }
            Self::Unreachable { agent, goal } => {
                write!(f, "no way leads from the start of agent {agent} to its goal {goal}")
            }
            Self::NoGoal { agent } => write!(f, "agent {agent} has no goal"),
            Self::Malformed { what } => f.write_str(what),
            Self::Exhausted => write!(f, "every possibility was searched"),
        }
    }
}
