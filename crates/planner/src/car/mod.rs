//! Bodies that drive.

mod body;
pub mod curve;
pub mod dubins;
mod field;
mod fleet;
mod hybrid_astar;
pub mod reeds_shepp;
mod steering;
mod table;
mod traffic;
mod way;

use crate::instance::CarInstance;
use crate::outcome::{Ended, Outcome, Reason};
use crate::plan::{CarPlan, Claims, Plan, Route};
use crate::search::Budget;

use field::{Blocked, Field};
use fleet::{Fleet, Task};

/// When bodies count as touching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// As CL-CBS has it: at the ends of steps reference points keep [`Vehicle::separation`](crate::instance::Vehicle::separation),
    /// and no obstacle lies in a body.
    #[default]
    Clcbs,
    /// Rectangles, all through every step.
    Exact,
}

/// How to plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// When bodies count as touching.
    pub model: Model,
    /// How often all ways are improved after a plan was found.
    pub improvements: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { model: Model::Clcbs, improvements: 3 }
    }
}

/// Plans ways for all bodies.
pub fn solve(instance: &CarInstance, options: &Options, budget: &Budget<'_>) -> Ended<CarPlan> {
    let field = Field::new(instance, options.model);
    let tasks: Vec<Task> = instance
        .agents
        .iter()
        .map(|agent| Task {
            start: field.place(&agent.start),
            goal: field.place(agent.goals.first().unwrap_or(&agent.start)),
        })
        .collect();
    let mut reasons = Vec::new();
    for (agent, task) in tasks.iter().enumerate() {
        match field.blocked(&task.start) {
            Some(Blocked::Outside) => reasons.push(Reason::StartOutside { agent }),
            Some(Blocked::By(at)) => reasons.push(Reason::StartBlocked { agent, obstacle: Some(at) }),
            None => {}
        }
        match field.blocked(&task.goal) {
            Some(Blocked::Outside) => reasons.push(Reason::GoalOutside { agent, goal: 0 }),
            Some(Blocked::By(at)) => reasons.push(Reason::GoalBlocked { agent, goal: 0, obstacle: Some(at) }),
            None => {}
        }
    }
    if !reasons.is_empty() {
        return Ended { outcome: Outcome::Infeasible(reasons), effort: Default::default() };
    }
    let lower: f64 = tasks.iter().map(|task| field.distance(&task.start, &task.goal)).sum::<f64>() * field.scale;
    let mut fleet = match Fleet::new(&field, &tasks, budget) {
        Ok(fleet) => fleet,
        Err(Ok(agent)) => {
            return Ended {
                outcome: Outcome::Infeasible(vec![Reason::Unreachable { agent, goal: 0 }]),
                effort: Default::default(),
            };
        }
        Err(Err(_)) => {
            return Ended { outcome: Outcome::BudgetSpent { best_bound: lower }, effort: Default::default() };
        }
    };
    let solved = fleet.negotiate(budget);
    if solved != Ok(true) {
        return Ended { outcome: Outcome::BudgetSpent { best_bound: lower }, effort: fleet.effort };
    }
    let _ = fleet.improve(options.improvements, budget);
    let ways = fleet.ways();
    let routes = instance
        .agents
        .iter()
        .zip(&ways)
        .map(|(agent, way)| {
            let mut states: Vec<_> = way.places.iter().map(|place| field.pose(place)).collect();
            states[0] = agent.start;
            if let (Some(last), Some(goal)) = (states.last_mut(), agent.goals.first()) {
                *last = *goal;
            }
            Route { name: agent.name.clone(), goal: Some(0), states }
        })
        .collect();
    let claims = Claims {
        cost: Some(ways.iter().map(|way| way.cost).sum::<f64>() * field.scale),
        makespan: Some(ways.iter().map(|way| way.length).fold(0.0, f64::max) * field.scale),
        flowtime: Some(ways.iter().map(|way| way.length).sum::<f64>() * field.scale),
        lower_bound: Some(lower),
        bound: None,
    };
    Ended { outcome: Outcome::Solved(Plan { routes, claims }), effort: fleet.effort }
}
