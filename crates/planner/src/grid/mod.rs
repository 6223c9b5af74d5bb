//! Plans for agents on a 4-connected grid.
//!
//! Agents move by one cell or wait in every step, never two in one cell, never two that swap theirs, and stay where they end.
//! The cost of an agent is the step of its last arrival at its goal. Where goals are assigned, costs are as in
//! libMultiRobotPlanning: every step costs 1, but waiting at the goal costs nothing, even if the agent leaves it once more to
//! make way; an agent without a goal pays for its moves only.
//!
//! ```
//! use cohaul_planner::grid::{Options, Planner, solve};
//! use cohaul_planner::instance::{Cell, GridAgent, GridInstance};
//! use cohaul_planner::outcome::Outcome;
//! use cohaul_planner::search::Budget;
//!
//! let agent = |name: &str, start, goal| GridAgent { name: name.to_owned(), start, goals: vec![goal] };
//! let (left, right) = (Cell { x: 0, y: 0 }, Cell { x: 2, y: 0 });
//! let instance = GridInstance {
//!     width: 3,
//!     height: 2,
//!     blocked: vec![false; 6],
//!     agents: vec![agent("a", left, right), agent("b", right, left)],
//!     assignment: false,
//! };
//! let options = Options { planner: Planner::Cbs, bound: 1.0 };
//! let ended = solve(&instance, &options, &Budget::new(10_000, &|| false));
//! let Outcome::Solved(plan) = ended.outcome else { panic!() };
//! assert_eq!(plan.claims.cost, Some(6.0)); // one of them steps aside: two more steps
//! ```

mod check;
mod domain;
mod low_level;
mod narrow;
mod ranked;
mod space;
#[cfg(test)]
mod tests;
mod timetable;

use self::check::{Checked, check};
use self::domain::{Grid, Path, Splits};
use self::ranked::{Ranked, Wishes};
use crate::instance::GridInstance;
use crate::outcome::{Effort, Ended, Outcome, Reason};
use crate::plan::{Claims, GridPlan, Plan, Route};
use crate::search::{self, Budget, Found, Given, Planned, Settings};

/// How to plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Which search.
    pub planner: Planner,
    /// By which factor the cost may exceed the lower bound, at least 1. Only for the planners that are bounded.
    pub bound: f64,
}

/// The searches for grids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planner {
    /// Conflict-based search: optimal.
    Cbs,
    /// The same, within a bound of the optimum.
    Ecbs,
    /// Conflict-based search over a forest of assignments: optimal. The same as [`Planner::Cbs`]: whether goals are assigned is
    /// the instance's to say.
    CbsTa,
    /// The same, within a bound of the optimum.
    EcbsTa,
    /// Conflict-based search in one tree, in which the assignment follows the constraints: optimal.
    ItaCbs,
    /// The same, within a bound of the optimum.
    ItaEcbs,
}

/// Finds a plan for an instance.
///
/// All starts, and all goals that are not to be assigned, are checked first, and what is wrong with them is reported at once.
/// Where goals are assigned, those that are blocked, outside or out of reach are nobody's, and as many agents as possible take
/// another. Instances whose tables would take more memory than the searches may use (about 33 million cells times steps) end
/// as if the budget were spent.
pub fn solve(instance: &GridInstance, options: &Options, budget: &Budget<'_>) -> Ended<GridPlan> {
    let checked = match check(instance, budget) {
        Ok(Ok(checked)) => checked,
        Ok(Err(reasons)) => return Ended { outcome: Outcome::Infeasible(reasons), effort: Effort::default() },
        Err(search::Spent) => {
            return Ended { outcome: Outcome::BudgetSpent { best_bound: 0.0 }, effort: Effort::default() };
        }
    };
    let weight = match options.planner {
        Planner::Cbs | Planner::CbsTa | Planner::ItaCbs => 1.0,
        Planner::Ecbs | Planner::EcbsTa | Planner::ItaEcbs => options.bound,
    };
    let settings = Settings::within(weight);
    let one_tree = instance.assignment && matches!(options.planner, Planner::ItaCbs | Planner::ItaEcbs);
    // in the one tree, goals change below a rule
    let splits = Splits { arrivals: !one_tree };
    let wishes = instance.assignment.then(|| Wishes::new(&checked));
    let Checked { space, starts, targets } = checked;
    let own = targets.iter().map(|targets| (!targets.is_empty()).then_some(0)).collect();
    let mut grid = Grid::new(space, starts, targets, splits, instance.assignment);
    let (found, effort) = match wishes {
        None => search::solve(&mut grid, &mut Given::new(own), &settings, budget),
        Some(Wishes { costs, which }) if one_tree => {
            search::solve_incremental(&mut grid, &costs, &which, &settings, budget)
        }
        Some(wishes) => search::solve(&mut grid, &mut Ranked::new(wishes), &settings, budget),
    };
    let outcome = match found {
        Found::Solved { goals, paths, lower_bound, .. } => {
            Outcome::Solved(plan(instance, &grid, &goals, &paths, lower_bound, settings.weight))
        }
        Found::Exhausted => Outcome::Infeasible(vec![Reason::Exhausted]),
        Found::Spent { best_bound } => Outcome::BudgetSpent { best_bound },
    };
    Ended { outcome, effort }
}

/// Routes and claims.
fn plan(
    instance: &GridInstance,
    grid: &Grid,
    goals: &[Option<usize>],
    paths: &[Planned<Path>],
    lower_bound: f64,
    bound: f64,
) -> GridPlan {
    let (mut cost, mut flowtime) = (0, 0);
    let mut makespan = 0;
    let mut routes = Vec::with_capacity(paths.len());
    for ((agent, planned), &goal) in instance.agents.iter().zip(paths).zip(goals) {
        let mut cells = planned.path.cells.as_slice();
        // rules may have kept an agent waiting at its goal
        while let [.., before, last] = cells
            && before == last
        {
            cells = &cells[..cells.len() - 1];
        }
        let at = cells.len() - 1;
        // where goals are assigned, and for agents without one, waiting in the last cell costs nothing
        let rests = |pair: &[u32]| pair[0] == pair[1] && (goal.is_none() || pair[0] == cells[at]);
        let paid = cells.windows(2).filter(|pair| !rests(pair)).count();
        let moves = cells.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let arrival = if goal.is_some() { at } else { moves };
        flowtime += arrival;
        cost += match goal {
            Some(_) if !instance.assignment => arrival,
            Some(_) => paid,
            None => moves,
        };
        makespan = makespan.max(cells.len() - 1);
        let states = cells.iter().map(|&cell| grid.space.cell(cell)).collect();
        routes.push(Route { name: agent.name.clone(), goal, states });
    }
    let cost = cost as f64;
    let claims = Claims {
        cost: Some(cost),
        makespan: Some(makespan as f64),
        flowtime: Some(flowtime as f64),
        lower_bound: Some(lower_bound.min(cost)),
        bound: Some(bound),
    };
    Plan { routes, claims }
}
