//! Improving a plan in which nobody meets: a few bodies at a time are planned anew, the others stay as they are.
//!
//! # Source
//! Large neighbourhood search, as [Li2022] and its forerunners use it.
//!
//! # Deviations
//! Nothing is drawn at random: a neighbourhood is a body that pays most for the others, with those that keep it from its own
//! best way. At the end the bodies that arrive last may hurry.
//!
//! [Li2022]: cohaul_core::_documentation::references

use std::sync::Arc;

use super::field::Prices;
use super::fleet::{Fleet, GREED, LIMIT};
use super::hybrid_astar::{Ask, Care};
use super::traffic::Traffic;
use super::way::Way;
use crate::search::{Budget, Spent};

/// States that improvement may expand, per body.
const IMPROVEMENT: u64 = 200;
/// Excess over the own best way that is not worth an attempt, in steps.
const WORTHWHILE: f64 = 1.0;
/// What a metre of the longest way may cost in all.
const HURRY: f64 = 4.0;
/// How often the last one may hurry.
const HURRIES: usize = 8;

impl Fleet<'_> {
    /// Improves ways that do not meet, `rounds` times over all bodies.
    pub(super) fn improve(&mut self, rounds: usize, budget: &Budget<'_>) -> Result<(), Spent> {
        let bodies = self.tasks.len();
        self.weights.fill(f64::INFINITY);
        let most = self.effort.low_level_expanded + IMPROVEMENT * bodies as u64;
        for _ in 0..rounds {
            let mut order: Vec<usize> = (0..bodies).collect();
            let excess = |fleet: &Self, body: usize| {
                fleet.traffic.way(body).map_or(0.0, |way| way.cost) - fleet.alone[body].cost
            };
            order.sort_by(|a, b| excess(self, *b).total_cmp(&excess(self, *a)).then(a.cmp(b)));
            let mut better = false;
            for body in order {
                if self.effort.low_level_expanded > most {
                    return Ok(());
                }
                if excess(self, body) < WORTHWHILE * self.field.step {
                    continue;
                }
                let blockers = self.traffic.met(self.field, body, &self.alone[body]);
                better |= self.exchange(body, &blockers, budget)?;
            }
            if !better {
                break;
            }
        }
        self.shorten(budget)
    }

    /// Lets the body that arrives last hurry, over and over, while what the others pay for it stays below [`HURRY`].
    fn shorten(&mut self, budget: &Budget<'_>) -> Result<(), Spent> {
        for _ in 0..self.tasks.len().min(HURRIES) {
            let length = |fleet: &Self, body: usize| fleet.traffic.way(body).map_or(0.0, |way| way.length);
            let last =
                (0..self.tasks.len()).max_by(|a, b| length(self, *a).total_cmp(&length(self, *b)).then(b.cmp(a)));
            let Some(last) = last else { return Ok(()) };
            // its shortest way with nobody else there, whatever turning and reversing cost
            let nobody = Traffic::new(0);
            let ask = Ask {
                field: self.field,
                traffic: &nobody,
                weights: &[],
                prices: &Prices::LENGTH,
                start: self.tasks[last].start,
                goal: self.tasks[last].goal,
                rules: &[],
                ratio: 1.0,
                below: length(self, last) - 1e-6,
                limit: LIMIT,
                care: Care::Quick,
                fineness: self.fineness[last],
            };
            let found = self.search.find(&ask, budget)?;
            self.effort.low_level_expanded += found.expanded;
            let Some(shortest) = found.way else { return Ok(()) };
            let mut group = vec![last];
            group.extend(self.traffic.met(self.field, last, &shortest).into_iter().take(5));
            if !self.hurry(&group, budget)? {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Plans the first of `group` for the shortest way and the others around it; keeps that if it is worth it.
    fn hurry(&mut self, group: &[usize], budget: &Budget<'_>) -> Result<bool, Spent> {
        let old: Vec<Option<Arc<Way>>> = group.iter().map(|member| self.traffic.way(*member).cloned()).collect();
        let longest = |fleet: &Self| {
            (0..fleet.tasks.len()).filter_map(|body| Some(fleet.traffic.way(body)?.length)).fold(0.0, f64::max)
        };
        let before = old.iter().flatten().map(|way| way.cost).sum::<f64>() + HURRY * longest(self);
        for member in group {
            self.traffic.set(*member, None);
        }
        let mut after = 0.0;
        let mut done = Ok(true);
        for (rank, member) in group.iter().enumerate() {
            self.prices = if rank == 0 { Prices::LENGTH } else { self.field.prices };
            match self.replan(*member, GREED, LIMIT, f64::INFINITY, budget) {
                Ok(Some((way, _))) => {
                    after += way.cost;
                    self.traffic.set(*member, Some(Arc::new(way)));
                }
                failed => {
                    done = failed.map(|_| false);
                    break;
                }
            }
        }
        self.prices = self.field.prices;
        if done != Ok(true) || after + HURRY * longest(self) > before - 1e-6 {
            for (member, way) in group.iter().zip(old) {
                self.traffic.set(*member, way);
            }
            return done.map(|_| false);
        }
        Ok(true)
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
            let found = self.replan(*member, GREED, LIMIT, below, budget);
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
}
