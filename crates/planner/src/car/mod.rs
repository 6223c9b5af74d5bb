//! Plans for bodies that drive: cars that turn on arcs, forwards only or both ways, and differential drives.
//!
//! # Source
//! [CL-CBS], sequential CL-CBS (`batch`).
//!
//! # Deviations
//! - Bodies are planned fast first (`fleet.rs`): everyone's own best way, negotiation, repair, improvement. The conflict tree
//!   (`domain.rs`) is grown where a bound is asked for that this does not reach, or where it fails.
//! - Robots that rest at their goals are heeded by everyone, whenever they are planned.
//! - Instances without any solution are told with their reasons.
//!
//! Costs are lengths with penalties; the lower bound is the sum of the shortest curves that the bodies can drive with
//! nothing in their way, over the best assignment of goals: no plan at all costs less. Where the tree was grown for `bound`, it
//! may be larger: then no plan of the search space costs less, which is whole steps and waits, then one curve. A plan with
//! shorter steps might.
//!
//! [CL-CBS]: cohaul_core::_documentation::references

mod body;
mod check;
pub mod curve;
mod domain;
pub mod dubins;
mod field;
mod fleet;
mod flood;
mod goals;
mod hybrid_astar;
mod improve;
mod push;
mod reach;
pub mod reeds_shepp;
mod steering;
mod table;
mod traffic;
mod way;

use std::sync::Arc;

use crate::instance::CarInstance;
use crate::outcome::{Effort, Ended, Outcome, Reason};
use crate::plan::{CarPlan, Claims, Plan, Route};
use crate::search::{self, Assigned, Assignments, Budget, Found, Given, Settings, Spent};

use check::{Checked, check, malformed};
use domain::Cars;
use field::Field;
use fleet::{Fleet, Task};
pub use goals::Metric;
use goals::Ranked;
pub use push::{Push, push_costs};
use way::Way;

/// Assignments that are planned where goals are to be assigned; the cheapest plan is kept.
const ASSIGNMENTS: usize = 3;
/// By how much the cost may exceed the bound in the tree that is grown where the fast planner fails.
const LOOSE: f64 = 3.0;

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
    /// By which factor the cost may exceed the lower bound at most, at least 1. Without it the fast planner's plan is taken as
    /// it is.
    pub bound: Option<f64>,
    /// So many bodies are planned at once, the later ones around the earlier ones; all at once without it.
    pub batch: Option<usize>,
    /// What assignments are judged by.
    pub metric: Metric,
    /// How often all ways are improved after a plan was found.
    pub improvements: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { model: Model::Clcbs, bound: None, batch: None, metric: Metric::Curve, improvements: 2 }
    }
}

/// A plan of the fast planner.
struct Draft {
    goals: Vec<Option<usize>>,
    ways: Vec<Arc<Way>>,
}

impl Draft {
    fn cost(&self) -> f64 {
        self.ways.iter().map(|way| way.cost).sum()
    }
}

/// What the fast planner comes to.
enum Drafted {
    Ways(Vec<Arc<Way>>),
    /// It finds no ways that do not meet.
    Nothing,
    /// The goal of this agent is out of reach even with nobody else there.
    OutOfReach(usize),
}

/// What all steps of planning share.
struct Planner<'a> {
    field: &'a Field,
    checked: &'a Checked,
    options: &'a Options,
    effort: Effort,
    /// No plan costs less, in turning radii.
    lower: f64,
}

/// Plans ways for all bodies.
pub fn solve(instance: &CarInstance, options: &Options, budget: &Budget<'_>) -> Ended<CarPlan> {
    let ended = |outcome, effort| Ended { outcome, effort };
    if let Err(Spent) = budget.spend(1) {
        return ended(Outcome::BudgetSpent { best_bound: 0.0 }, Effort::default());
    }
    if let Some(what) = malformed(instance) {
        return ended(Outcome::Infeasible(vec![Reason::Malformed { what }]), Effort::default());
    }
    let field = Field::new(instance, options.model);
    let checked = match check(&field, instance, budget) {
        Err(Spent) => return ended(Outcome::BudgetSpent { best_bound: 0.0 }, Effort::default()),
        Ok(Ok(checked)) => checked,
        Ok(Err(reasons)) => return ended(Outcome::Infeasible(reasons), Effort::default()),
    };
    let mut planner = Planner { field: &field, checked: &checked, options, effort: Effort::default(), lower: 0.0 };
    let outcome = match planner.run(instance.assignment, budget) {
        Ok(Ok(draft)) => Outcome::Solved(plan(instance, &field, options, &draft, planner.lower)),
        Ok(Err(reasons)) => Outcome::Infeasible(reasons),
        Err(Spent) => Outcome::BudgetSpent { best_bound: planner.lower * field.scale },
    };
    ended(outcome, planner.effort)
}

impl Planner<'_> {
    /// A plan, or the reasons why there is none.
    fn run(&mut self, assign: bool, budget: &Budget<'_>) -> Result<Result<Draft, Vec<Reason>>, Spent> {
        let mut without = Vec::new();
        let mut reasons = Vec::new();
        let mut most = 0;
        loop {
            let (field, checked, metric) = (self.field, self.checked, self.options.metric);
            let mut assignments = assignments(field, checked, assign.then_some(metric), &without, budget)?;
            let Some(assigned) = assignments.next(budget)? else {
                reasons.push(Reason::Exhausted);
                return Ok(Err(reasons));
            };
            // as many goals are taken as somebody can stand in, or it is said why not
            let taken = assigned.goals.iter().flatten().count();
            most = most.max(taken);
            if taken < most {
                return Ok(Err(reasons));
            }
            self.lower = self.bound_of(&assigned, budget)?;
            // in two steps the first assignment is the only one
            let given = metric == Metric::Manhattan && assign;
            let only = given.then(|| Given::new(assigned.goals.clone()));
            match self.fast(assigned, &mut *assignments, assign, budget)? {
                Ok(Some(draft)) if self.is_cheap(&draft) => return Ok(Ok(draft)),
                Ok(_) => return self.tree(only, assign, &without, budget),
                Err((agent, goal)) => {
                    reasons.push(Reason::Unreachable { agent, goal });
                    if !assign {
                        return Ok(Err(reasons));
                    }
                    without.push((agent, goal));
                }
            }
        }
    }

    fn is_cheap(&self, draft: &Draft) -> bool {
        self.options.bound.is_none_or(|bound| draft.cost() <= bound.max(1.0) * self.lower + 1e-9)
    }

    fn goal(&self, agent: usize, goal: Option<usize>) -> Option<curve::Place> {
        self.checked.goals[agent].get(goal?).copied().flatten()
    }

    /// Sum of the shortest curves; with assignments that are judged by them, no plan at all costs less.
    fn bound_of(&self, assigned: &Assigned, budget: &Budget<'_>) -> Result<f64, Spent> {
        if assigned.cost > 0.0 {
            return Ok(assigned.cost);
        }
        if self.options.metric == Metric::Manhattan {
            // the assignment may not be the best one for cars
            let mut best = Ranked::new(self.field, self.checked, Metric::Curve, &[], budget)?;
            return Ok(best.next(budget)?.map_or(0.0, |assigned| assigned.cost));
        }
        let goals =
            assigned.goals.iter().enumerate().filter_map(|(agent, goal)| Some((agent, self.goal(agent, *goal)?)));
        Ok(goals.map(|(agent, goal)| self.field.distance(&self.checked.starts[agent], &goal)).sum())
    }

    /// The cheapest of the fast planner's plans over the first assignments; the pair of agent and goal that is out of reach.
    fn fast(
        &mut self,
        first: Assigned,
        rest: &mut dyn Assignments,
        assign: bool,
        budget: &Budget<'_>,
    ) -> Result<Result<Option<Draft>, (usize, usize)>, Spent> {
        let mut best: Option<Draft> = None;
        let mut next = Some(first);
        for round in 0..ASSIGNMENTS {
            let Some(assigned) = next.take() else { break };
            self.effort.assignments += u64::from(assign);
            let tasks: Vec<Task> = (0..self.checked.starts.len())
                .map(|agent| Task { start: self.checked.starts[agent], goal: self.goal(agent, assigned.goals[agent]) })
                .collect();
            match self.draft(&tasks, budget) {
                Ok(Drafted::Ways(ways)) => {
                    let draft = Draft { goals: assigned.goals, ways };
                    if best.as_ref().is_none_or(|best| draft.cost() < best.cost()) {
                        best = Some(draft);
                    }
                }
                Ok(Drafted::Nothing) => {}
                Ok(Drafted::OutOfReach(agent)) => {
                    if let (0, Some(goal)) = (round, assigned.goals[agent]) {
                        return Ok(Err((agent, goal)));
                    }
                }
                // what was found before is a plan
                Err(Spent) if best.is_some() => break,
                Err(Spent) => return Err(Spent),
            }
            if !assign || self.options.metric == Metric::Manhattan {
                break;
            }
            // what was found before is a plan, again
            next = match rest.next(budget) {
                Err(Spent) if best.is_some() => break,
                following => following?,
            };
            // an assignment that cannot be cheaper than the plan is of no use
            let cost = best.as_ref().map_or(f64::INFINITY, Draft::cost);
            next = next.filter(|assigned| assigned.cost < cost);
        }
        Ok(Ok(best))
    }

    /// Ways for these tasks by the fast planner.
    fn draft(&mut self, tasks: &[Task], budget: &Budget<'_>) -> Result<Drafted, Spent> {
        let mut fleet = match Fleet::new(self.field, tasks, budget) {
            Ok(fleet) => fleet,
            Err(Ok(agent)) => return Ok(Drafted::OutOfReach(agent)),
            Err(Err(spent)) => return Err(spent),
        };
        let planned = fleet.plan(self.options.batch.unwrap_or(tasks.len()), budget);
        if planned == Ok(true) {
            // improvement that is cut short leaves a plan
            let _ = fleet.improve(self.options.improvements, budget);
        }
        self.effort.high_level_expanded += fleet.effort.high_level_expanded;
        self.effort.low_level_expanded += fleet.effort.low_level_expanded;
        Ok(if planned? { Drafted::Ways(fleet.ways()) } else { Drafted::Nothing })
    }

    /// The conflict tree: one whose assignment follows the constraints, where goals are to be assigned.
    fn tree(
        &mut self,
        only: Option<Given>,
        assign: bool,
        without: &[(usize, usize)],
        budget: &Budget<'_>,
    ) -> Result<Result<Draft, Vec<Reason>>, Spent> {
        let (field, checked) = (self.field, self.checked);
        let mut cars = Cars::new(field, &checked.starts, &checked.goals);
        let settings = Settings::within(self.options.bound.unwrap_or(LOOSE));
        let (found, effort) = match only {
            Some(mut only) => search::solve(&mut cars, &mut only, &settings, budget),
            None if assign => {
                let Ranked { costs, which, .. } = Ranked::new(field, checked, Metric::Curve, without, budget)?;
                search::solve_incremental(&mut cars, &costs, &which, &settings, budget)
            }
            None => search::solve(&mut cars, &mut *assignments(field, checked, None, &[], budget)?, &settings, budget),
        };
        self.effort.high_level_expanded += effort.high_level_expanded;
        self.effort.low_level_expanded += effort.low_level_expanded;
        self.effort.assignments += effort.assignments;
        match found {
            Found::Solved { goals, paths, lower_bound, .. } => {
                self.lower = self.lower.max(lower_bound);
                Ok(Ok(Draft { goals, ways: paths.into_iter().map(|planned| planned.path).collect() }))
            }
            Found::Exhausted => Ok(Err(vec![Reason::Exhausted])),
            Found::Spent { best_bound } => {
                self.lower = self.lower.max(best_bound);
                Err(Spent)
            }
        }
    }
}

/// Assignments by a metric, or the one that everyone's own goals are, without the pairs in `without`.
fn assignments<'a>(
    field: &'a Field,
    checked: &'a Checked,
    metric: Option<Metric>,
    without: &[(usize, usize)],
    budget: &Budget<'_>,
) -> Result<Box<dyn Assignments + 'a>, Spent> {
    Ok(match metric {
        Some(metric) => Box::new(Ranked::new(field, checked, metric, without, budget)?),
        None => {
            let goals = checked.goals.iter().map(|goals| (!goals.is_empty()).then_some(0)).collect();
            Box::new(Given::new(goals))
        }
    })
}

/// Routes and claims, in metres.
fn plan(instance: &CarInstance, field: &Field, options: &Options, draft: &Draft, lower: f64) -> CarPlan {
    let route = |((agent, way), goal): ((&crate::instance::CarAgent, &Arc<Way>), &Option<usize>)| {
        let mut states: Vec<_> = way.places.iter().map(|place| field.pose(place)).collect();
        if let Some(first) = states.first_mut() {
            *first = agent.start;
        }
        // as the instance has it, to the last bit
        if let (Some(last), Some(goal)) = (states.last_mut(), goal.and_then(|goal| agent.goals.get(goal))) {
            *last = *goal;
        }
        Route { name: agent.name.clone(), goal: *goal, states }
    };
    let routes = instance.agents.iter().zip(&draft.ways).zip(&draft.goals).map(route).collect();
    let ways = &draft.ways;
    let claims = Claims {
        cost: Some(draft.cost() * field.scale),
        makespan: Some(ways.iter().map(|way| way.length).fold(0.0, f64::max) * field.scale),
        flowtime: Some(ways.iter().map(|way| way.length).sum::<f64>() * field.scale),
        lower_bound: Some(lower.min(draft.cost()) * field.scale),
        bound: options.bound.map(|bound| bound.max(1.0)),
    };
    Plan { routes, claims }
}
