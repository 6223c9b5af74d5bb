//! Ways for all bodies, fast: everyone's own best way first, then conflicts are negotiated, then the whole is improved.
//!
//! # Source
//! Negotiation: [McMurchie1995] — meeting others costs little at first and more in every round, so that whoever can avoid a
//! crowded place cheaply does. Repair and improvement by replanning few bodies at a time: [Li2022].
//!
//! # Deviations
//! - Rounds are counted, not timed: the same instance gives the same plan.
//! - Neighbourhoods are bodies that meet and those that keep them from their own best ways; where that does not help, others
//!   too. What is drawn comes from a fixed sequence.
//!
//! [Li2022]: cohaul_core::_documentation::references
//! [McMurchie1995]: cohaul_core::_documentation::references

use std::sync::Arc;

use super::curve::Place;
use super::field::{Field, Prices};
use super::hybrid_astar::{Ask, Care, HybridAstar};
use super::reach;
use super::traffic::Traffic;
use super::way::Way;
use crate::outcome::Effort;
use crate::search::{Budget, Spent};

/// States that one search may expand while conflicts are negotiated.
pub(super) const LIMIT: u64 = 2_000;
/// Most rounds of negotiation, which ends sooner where it gets no further, then of repair around single conflicts.
const ROUNDS: usize = 12;
const REPAIRS: usize = 2_000;
/// Factor on what lies ahead: greedy searches find detours sooner.
pub(super) const GREED: f64 = 1.5;
/// What the first meetings cost, in steps, and by how much it grows each round.
const FIRST_WEIGHT: f64 = 1.0;
const GROWTH: f64 = 1.3;
/// Heaviest meeting, in steps.
const MOST_WEIGHT: f64 = 200.0;

/// One body's task.
#[derive(Clone, Copy)]
pub(super) struct Task {
    pub(super) start: Place,
    /// None: it only must not be in the way.
    pub(super) goal: Option<Place>,
}

/// The planner of a whole fleet and its memory.
pub(super) struct Fleet<'a> {
    pub(super) field: &'a Field,
    pub(super) tasks: &'a [Task],
    pub(super) search: HybridAstar,
    pub(super) traffic: Traffic,
    pub(super) weights: Vec<f64>,
    /// What searches go by at present.
    pub(super) prices: Prices,
    /// Into how many steps are divided, by body.
    pub(super) fineness: Vec<u32>,
    /// Everyone's best way with nobody else there.
    pub(super) alone: Vec<Arc<Way>>,
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
            prices: field.prices,
            fineness: vec![1; bodies],
            alone: Vec::with_capacity(bodies),
            effort: Effort::default(),
        };
        for body in 0..bodies {
            match fleet.plan_alone(body, budget).map_err(Err)? {
                Some(way) => fleet.alone.push(Arc::new(way)),
                None => return Err(Ok(body)),
            }
        }
        Ok(fleet)
    }

    /// The best way of a body with nobody else there; nothing if there is none.
    fn plan_alone(&mut self, body: usize, budget: &Budget<'_>) -> Result<Option<Way>, Spent> {
        let task = self.tasks[body];
        let Some(goal) = task.goal else { return Ok(Some(Way::resting(task.start))) };
        let (search, expanded) = (&mut self.search, &mut self.effort.low_level_expanded);
        let found = reach::way(self.field, task.start, goal, search, expanded, budget)?;
        Ok(found.map(|(way, fineness)| {
            self.fineness[body] = fineness;
            way
        }))
    }

    /// Plans `body` anew where meeting others costs `self.weights`; whether a way was found.
    pub(super) fn replan(
        &mut self,
        body: usize,
        ratio: f64,
        limit: u64,
        below: f64,
        budget: &Budget<'_>,
    ) -> Result<Option<(Way, f64)>, Spent> {
        let task = self.tasks[body];
        let fineness = self.fineness[body];
        // its own way is in nobody's way
        let own = self.traffic.way(body).cloned();
        self.traffic.set(body, None);
        let ask = Ask {
            field: self.field,
            traffic: &self.traffic,
            weights: &self.weights,
            prices: &self.prices,
            start: task.start,
            goal: task.goal,
            rules: &[],
            ratio,
            below,
            limit,
            care: if fineness == 1 { Care::Quick } else { Care::Thorough },
            fineness,
        };
        let found = self.search.find(&ask, budget);
        self.traffic.set(body, own);
        let found = found?;
        self.effort.low_level_expanded += found.expanded;
        Ok(found.way.map(|way| (way, found.total)))
    }

    /// Ways that do not meet, if negotiation finds them. In batches of `batch` bodies in the order of the instance, those of
    /// earlier batches are never asked to make way again, unless nothing else helps.
    pub(super) fn plan(&mut self, batch: usize, budget: &Budget<'_>) -> Result<bool, Spent> {
        let bodies = self.tasks.len();
        let mut clean = true;
        for first in (0..bodies).step_by(batch.max(1)) {
            let last = (first + batch.max(1)).min(bodies);
            for body in first..last {
                self.traffic.set(body, Some(self.alone[body].clone()));
            }
            clean = self.negotiate((first..last).collect(), budget)? || self.repair(budget)?;
        }
        Ok(clean)
    }

    /// Lets the bodies in `order` make way for each other and for all others that have a way.
    fn negotiate(&mut self, mut order: Vec<usize>, budget: &Budget<'_>) -> Result<bool, Spent> {
        order.sort_by(|a, b| self.alone[*b].cost.total_cmp(&self.alone[*a].cost).then(a.cmp(b)));
        let mut weight = FIRST_WEIGHT * self.field.step;
        let mut before = usize::MAX;
        for round in 0..ROUNDS {
            self.effort.high_level_expanded += 1;
            let mut crossed = 0;
            for (rank, body) in order.clone().into_iter().enumerate() {
                let way = self.traffic.way(body).cloned();
                let Some(way) = way else { continue };
                if self.traffic.met(self.field, body, &way).is_empty() {
                    continue;
                }
                crossed += 1;
                self.weights.fill(MOST_WEIGHT * self.field.step);
                for (later, other) in order.iter().enumerate() {
                    // in the first round those that still come will give way themselves
                    self.weights[*other] = if round == 0 && later > rank { 0.3 * weight } else { weight };
                }
                if let Some((way, _)) = self.replan(body, GREED, LIMIT, f64::INFINITY, budget)? {
                    self.traffic.set(body, Some(Arc::new(way)));
                }
            }
            if crossed == 0 {
                return Ok(true);
            }
            if round > 2 && crossed >= before {
                break;
            }
            before = crossed;
            if round == 0 {
                weight *= 4.0;
            }
            weight = (weight * GROWTH).min(MOST_WEIGHT * self.field.step);
        }
        Ok(false)
    }

    /// Pairs whose ways meet, in order.
    fn conflicts(&self) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        for body in 0..self.tasks.len() {
            if let Some(way) = self.traffic.way(body) {
                let met = self.traffic.met(self.field, body, way);
                pairs.extend(met.into_iter().filter(|other| *other > body).map(|other| (body, other)));
            }
        }
        pairs
    }

    /// Plans pairs that still meet anew together with those around them, in ever another order, until nobody meets.
    fn repair(&mut self, budget: &Budget<'_>) -> Result<bool, Spent> {
        let mut pairs = self.conflicts();
        let mut turn = 0x2545_f491_u32;
        let mut draw = |below: usize| {
            // xorshift: any order will do, as long as it is another one
            turn ^= turn << 13;
            turn ^= turn >> 17;
            turn ^= turn << 5;
            turn as usize % below.max(1)
        };
        let mut stuck = 0;
        for _ in 0..REPAIRS {
            if pairs.is_empty() {
                return Ok(true);
            }
            self.effort.high_level_expanded += 1;
            let (first, second) = pairs[draw(pairs.len())];
            let mut group = vec![first, second];
            for body in [first, second] {
                let alone = self.alone[body].clone();
                let mut near = self.traffic.met(self.field, body, &alone);
                if let Some(way) = self.traffic.way(body) {
                    near.extend(self.traffic.met(self.field, body, way));
                }
                group.extend(near);
            }
            // anybody, where it does not get ahead
            for _ in 0..stuck.min(4) {
                group.push(draw(self.tasks.len()));
            }
            group.retain(|body| self.traffic.way(*body).is_some());
            let mut seen = Vec::new();
            group.retain(|body| {
                !seen.contains(body) && {
                    seen.push(*body);
                    true
                }
            });
            group.truncate(3 + draw(6));
            for i in (1..group.len()).rev() {
                group.swap(i, draw(i + 1));
            }
            let old: Vec<Option<Arc<Way>>> = group.iter().map(|member| self.traffic.way(*member).cloned()).collect();
            for member in &group {
                self.traffic.set(*member, None);
            }
            self.weights.fill((4 << (stuck / 8).min(5)) as f64 * self.field.step);
            let limit = LIMIT << (stuck / 16).min(3);
            let mut complete = true;
            for member in &group {
                match self.replan(*member, GREED, limit, f64::INFINITY, budget)? {
                    Some((way, _)) => self.traffic.set(*member, Some(Arc::new(way))),
                    None => complete = false,
                }
            }
            let mut now = Vec::new();
            if complete {
                now.extend(pairs.iter().copied().filter(|(a, b)| !group.contains(a) && !group.contains(b)));
                for member in &group {
                    if let Some(way) = self.traffic.way(*member) {
                        let met = self.traffic.met(self.field, *member, way);
                        now.extend(met.into_iter().map(|other| (other.min(*member), other.max(*member))));
                    }
                }
                now.sort_unstable();
                now.dedup();
            }
            if complete && now.len() <= pairs.len() {
                stuck = if now.len() < pairs.len() { 0 } else { stuck + 1 };
                pairs = now;
            } else {
                for (member, way) in group.iter().zip(old) {
                    self.traffic.set(*member, way);
                }
                stuck += 1;
            }
        }
        Ok(pairs.is_empty())
    }

    /// The ways as they are.
    pub(super) fn ways(&self) -> Vec<Arc<Way>> {
        (0..self.tasks.len()).map(|body| self.traffic.way(body).unwrap_or(&self.alone[body]).clone()).collect()
    }
}
