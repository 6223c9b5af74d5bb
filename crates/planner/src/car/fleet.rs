//! Ways for all bodies, fast: everyone's own best way first, then conflicts are negotiated, then the whole is improved.
//!
//! # Source
//! Negotiation: [PathFinder] — meeting others costs little at first and more in every round, so that whoever can avoid a
//! crowded place cheaply does. Repair and improvement by replanning few bodies at a time: [MAPF-LNS2].
//!
//! # Deviations
//! - Rounds are counted, not timed: the same instance gives the same plan.
//! - Neighbourhoods are a body and those that keep it from its own best way; nothing is drawn at random.

use std::sync::Arc;

use super::curve::Place;
use super::field::Field;
use super::hybrid_astar::{Ask, HybridAstar};
use super::traffic::Traffic;
use super::way::Way;
use crate::outcome::Effort;
use crate::search::{Budget, Spent};

/// States that one search may expand while conflicts are negotiated.
const LIMIT: u64 = 4_000;
/// Rounds of negotiation.
const ROUNDS: usize = 60;
/// What the first meetings cost, in steps, and by how much it grows each round.
const FIRST_WEIGHT: f64 = 1.0;
const GROWTH: f64 = 1.3;
/// Heaviest meeting, in steps.
const MOST_WEIGHT: f64 = 200.0;

/// One body's task.
#[derive(Clone, Copy)]
pub(super) struct Task {
    pub(super) start: Place,
    pub(super) goal: Place,
}

/// The planner of a whole fleet and its memory.
pub(super) struct Fleet<'a> {
    field: &'a Field,
    tasks: &'a [Task],
    search: HybridAstar,
    traffic: Traffic,
    weights: Vec<f64>,
    /// Everyone's best way with nobody else there.
    alone: Vec<Arc<Way>>,
    pub(super) effort: Effort,
}

impl<'a> Fleet<'a> {
    /// Plans everyone's own best way; `Err(Ok(body))` where a body has none.
    pub(super) fn new(field: &'a Field, tasks: &'a [Task], budget: &Budget<'_>) -> Result<Self, Result<usize, Spent>> {
        let bodies = tasks.len();
        let mut fleet = Self {
            field,
            tasks,
            search: HybridAstar::new(),
            traffic: Traffic::new(bodies),
            weights: vec![0.0; bodies],
            alone: Vec::with_capacity(bodies),
            effort: Effort::default(),
        };
        let empty = Traffic::new(bodies);
        for (body, task) in tasks.iter().enumerate() {
            let mut ask = Ask {
                field,
                traffic: &empty,
                weights: &fleet.weights,
                start: task.start,
                goal: task.goal,
                ratio: 1.0,
                below: f64::INFINITY,
                limit: LIMIT,
                thorough: false,
            };
            let mut found = fleet.search.find(&ask, budget).map_err(Err)?;
            fleet.effort.low_level_expanded += found.expanded;
            if found.way.is_none() {
                ask.thorough = true;
                ask.limit = u64::MAX;
                ask.ratio = 2.0;
                found = fleet.search.find(&ask, budget).map_err(Err)?;
                fleet.effort.low_level_expanded += found.expanded;
            }
            match found.way {
                Some(way) => fleet.alone.push(Arc::new(way)),
                None => return Err(Ok(body)),
            }
        }
        Ok(fleet)
    }

    /// Plans `body` anew where meeting others costs `self.weights`; whether a way was found.
    fn replan(
        &mut self,
        body: usize,
        ratio: f64,
        below: f64,
        budget: &Budget<'_>,
    ) -> Result<Option<(Way, f64)>, Spent> {
        let task = self.tasks[body];
        let own = std::mem::replace(&mut self.weights[body], 0.0);
        let ask = Ask {
            field: self.field,
            traffic: &self.traffic,
            weights: &self.weights,
            start: task.start,
            goal: task.goal,
            ratio,
            below,
            limit: LIMIT,
            thorough: false,
        };
        let found = self.search.find(&ask, budget);
        self.weights[body] = own;
        let found = found?;
        self.effort.low_level_expanded += found.expanded;
        Ok(found.way.map(|way| (way, found.total)))
    }

    /// Ways that do not meet, if negotiation finds them.
    pub(super) fn negotiate(&mut self, budget: &Budget<'_>) -> Result<bool, Spent> {
        let bodies = self.tasks.len();
        for body in 0..bodies {
            self.traffic.set(body, Some(self.alone[body].clone()));
        }
        let mut order: Vec<usize> = (0..bodies).collect();
        order.sort_by(|a, b| self.alone[*b].cost.total_cmp(&self.alone[*a].cost).then(a.cmp(b)));
        let mut weight = FIRST_WEIGHT * self.field.step;
        for round in 0..ROUNDS {
            self.effort.high_level_expanded += 1;
            let mut clean = true;
            for (rank, body) in order.clone().into_iter().enumerate() {
                let way = self.traffic.way(body).cloned();
                let Some(way) = way else { continue };
                if self.traffic.met(self.field, body, &way).is_empty() {
                    continue;
                }
                clean = false;
                for (later, other) in order.iter().enumerate() {
                    // in the first round those that still come will give way themselves
                    self.weights[*other] = if round == 0 && later > rank { 0.3 * weight } else { weight };
                }
                if let Some((way, _)) = self.replan(body, 1.02, f64::INFINITY, budget)? {
                    self.traffic.set(body, Some(Arc::new(way)));
                }
            }
            if clean {
                return Ok(true);
            }
            if round == 0 {
                weight *= 4.0;
            }
            weight = (weight * GROWTH).min(MOST_WEIGHT * self.field.step);
        }
        Ok(false)
    }

    /// Improves ways that do not meet, `rounds` times over all bodies.
    pub(super) fn improve(&mut self, rounds: usize, budget: &Budget<'_>) -> Result<(), Spent> {
        let bodies = self.tasks.len();
        self.weights.fill(f64::INFINITY);
        for _ in 0..rounds {
            let mut order: Vec<usize> = (0..bodies).collect();
            let excess = |fleet: &Self, body: usize| {
                fleet.traffic.way(body).map_or(0.0, |way| way.cost) - fleet.alone[body].cost
            };
            order.sort_by(|a, b| excess(self, *b).total_cmp(&excess(self, *a)).then(a.cmp(b)));
            let mut better = false;
            for body in order {
                if excess(self, body) < 0.1 * self.field.step {
                    continue;
                }
                let blockers: Vec<usize> =
                    self.traffic.met(self.field, body, &self.alone[body].clone()).into_iter().map(|(b, _)| b).collect();
                better |= self.exchange(body, &blockers, budget)?;
            }
            if !better {
                break;
            }
        }
        Ok(())
    }

    /// Lets `body` plan as if `blockers` were not there, then these around it; keeps the result if it costs less in all.
    fn exchange(&mut self, body: usize, blockers: &[usize], budget: &Budget<'_>) -> Result<bool, Spent> {
        let mut group = vec![body];
        group.extend(blockers.iter().take(5));
        let old: Vec<Option<Arc<Way>>> = group.iter().map(|member| self.traffic.way(*member).cloned()).collect();
        let before: f64 = old.iter().flatten().map(|way| way.cost).sum();
        for member in &group {
            self.traffic.set(*member, None);
        }
        let mut after = 0.0;
        let mut least: f64 = group.iter().map(|member| self.alone[*member].cost).sum();
        for member in &group {
            least -= self.alone[*member].cost;
            let below = before - after - least - 1e-6;
            let found = self.replan(*member, 1.01, below, budget);
            match found {
                Ok(Some((way, _))) => {
                    after += way.cost;
                    self.traffic.set(*member, Some(Arc::new(way)));
                }
                failed => {
                    for (member, way) in group.iter().zip(old) {
                        self.traffic.set(*member, way);
                    }
                    return failed.map(|_| false);
                }
            }
        }
        Ok(true)
    }

    /// The ways as they are.
    pub(super) fn ways(&self) -> Vec<Arc<Way>> {
        (0..self.tasks.len()).map(|body| self.traffic.way(body).unwrap_or(&self.alone[body]).clone()).collect()
    }
}
