//! Cars for the conflict-based search.
//!
//! # Source
//! [CL-CBS] §IV-A, the body conflict tree.
//!
//! # Deviations
//! - A branch keeps a body from what it did itself, not from where the other was: the original's constraint, "not near the
//!   other's pose for three steps", also forbids plans in which the other has gone elsewhere, so that solutions are lost.
//!   Here each branch forbids all places that lie within half of the conflict's depth of the body's own. Whatever two such
//!   places are, they collide: no plan is lost.
//! - Lower bounds are those of the search space, which is: whole steps and waits, then one curve. They come from a search
//!   whose heuristic is never too much and which merges only states that are the same.
//!
//! [CL-CBS]: cohaul_core::_documentation::references

use std::collections::BTreeMap;

use super::Model;
use super::body::during;
use super::curve::Place;
use super::field::Field;
use super::hybrid_astar::{Ask, Avoid, Care, HybridAstar};
use super::reach;
use super::traffic::{Traffic, meetings};
use super::way::Way;
use crate::search::{Bound, Budget, Clash, Domain, Planned, Query, Spent};

/// States that a quick search may expand.
const QUICK: u64 = 4_000;
/// What a meeting costs where bodies should keep clear of others but need not, in steps.
const COURTESY: f64 = 2.0;
/// Moments of a step at which the depth of a conflict is measured.
const MOMENTS: u32 = 8;
/// Least depth of a conflict: what a closer look cannot tell from contact.
const LEAST_DEPTH: f64 = 2e-4;

/// Two bodies collide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collision {
    time: u32,
    share: f64,
    first: Place,
    second: Place,
    /// How far the bodies, or their discs, overlap.
    depth: f64,
}

/// All cars with the memory of their searches.
pub(super) struct Cars<'a> {
    field: &'a Field,
    starts: &'a [Place],
    goals: &'a [Vec<Option<Place>>],
    search: HybridAstar,
    expanded: u64,
    /// By agent and goal: into how many steps have to be divided; nothing where the goal is out of reach.
    fineness: BTreeMap<(usize, usize), Option<u32>>,
}

impl<'a> Cars<'a> {
    pub(super) fn new(field: &'a Field, starts: &'a [Place], goals: &'a [Vec<Option<Place>>]) -> Self {
        Self { field, starts, goals, search: HybridAstar::new(), expanded: 0, fineness: BTreeMap::new() }
    }
}

impl Cars<'_> {
    /// Into how many a body's steps have to be divided so that it reaches its goal; nothing if it does not.
    fn fineness(
        &mut self,
        agent: usize,
        goal: Option<usize>,
        place: Option<Place>,
        budget: &Budget<'_>,
    ) -> Result<Option<u32>, Spent> {
        let (Some(goal), Some(place)) = (goal, place) else { return Ok(Some(1)) };
        if let Some(known) = self.fineness.get(&(agent, goal)) {
            return Ok(*known);
        }
        let (start, search) = (self.starts[agent], &mut self.search);
        let found = reach::way(self.field, start, place, search, &mut self.expanded, budget)?;
        let fineness = found.map(|(_, fineness)| fineness);
        self.fineness.insert((agent, goal), fineness);
        Ok(fineness)
    }
}

impl Domain for Cars<'_> {
    type Path = Way;
    type Rule = Avoid;
    type Conflict = Collision;

    fn agents(&self) -> usize {
        self.starts.len()
    }

    fn plan(&mut self, query: &Query<'_, Self>, budget: &Budget<'_>) -> Result<Option<Planned<Way>>, Spent> {
        let start = self.starts[query.agent];
        let goal = match query.goal {
            Some(goal) => match self.goals[query.agent].get(goal).copied().flatten() {
                Some(place) => Some(place),
                None => return Ok(None),
            },
            None => None,
        };
        let Some(fineness) = self.fineness(query.agent, query.goal, goal, budget)? else { return Ok(None) };
        let rules: Vec<Avoid> =
            query.rules.iter().filter(|bound| bound.binds(query.agent)).map(|bound| bound.rule).collect();
        let mut traffic = Traffic::new(self.starts.len());
        let mut weights = vec![0.0; self.starts.len()];
        for (body, planned) in query.paths.iter().enumerate() {
            if let (Some(planned), true) = (planned, body != query.agent) {
                traffic.set(body, Some(planned.path.clone()));
                weights[body] = COURTESY * self.field.step;
            }
        }
        let nobody = vec![0.0; self.starts.len()];
        let mut floor = query.floor.max(goal.map_or(0.0, |goal| self.field.distance(&start, &goal)));
        let attempts = [
            (&weights, Care::Quick, 1.1, QUICK),
            (&nobody, Care::Quick, 1.0, QUICK),
            (&nobody, Care::Exact, query.weight, u64::MAX),
        ];
        for (weights, care, ratio, limit) in attempts {
            let ask = Ask {
                field: self.field,
                traffic: &traffic,
                weights,
                prices: &self.field.prices,
                start,
                goal,
                rules: &rules,
                ratio,
                below: f64::INFINITY,
                limit,
                care,
                fineness,
            };
            let before = self.expanded;
            let found = self.search.find(&ask, budget)?;
            self.expanded = before + found.expanded;
            if care == Care::Exact {
                floor = floor.max(found.least);
            }
            if let Some(way) = found.way {
                let cost = way.cost;
                if care == Care::Exact || cost <= (query.weight * floor).max(query.ceiling) {
                    return Ok(Some(Planned { path: way.into(), cost, lower_bound: floor.min(cost) }));
                }
            }
        }
        Ok(None)
    }

    fn clash(&mut self, _: usize, first: &Way, _: usize, second: &Way) -> Option<Clash<Collision>> {
        let mut count = 0;
        let mut earliest = None;
        for time in meetings(self.field, first, second) {
            count += 1;
            earliest.get_or_insert(time);
        }
        let time = earliest?;
        Some(Clash { conflict: deepest(self.field, first, second, time), count, priority: time as u32 })
    }

    fn split(&mut self, first: usize, second: usize, conflict: &Collision) -> [Bound<Avoid>; 2] {
        let lever = match self.field.model {
            Model::Clcbs => 0.0,
            Model::Exact => self.field.body.radius + self.field.body.offset.abs(),
        };
        let avoid =
            |place| Avoid { time: conflict.time, share: conflict.share, place, reach: 0.5 * conflict.depth, lever };
        [Bound::on(first, avoid(conflict.first)), Bound::on(second, avoid(conflict.second))]
    }

    fn expanded(&self) -> u64 {
        self.expanded
    }
}

/// The moment of the step after `time` at which two ways collide most.
fn deepest(field: &Field, first: &Way, second: &Way, time: usize) -> Collision {
    let moments = match field.model {
        // only the ends of steps count
        Model::Clcbs => MOMENTS..=MOMENTS,
        Model::Exact => 0..=MOMENTS,
    };
    let mut worst: Option<Collision> = None;
    for moment in moments {
        let share = f64::from(moment) / f64::from(MOMENTS);
        let at = |way: &Way| {
            let step = way.step(time);
            if step.length == 0.0 { *way.place(time) } else { during(way.place(time), step, share) }
        };
        let (a, b) = (at(first), at(second));
        let gap = match field.model {
            Model::Clcbs => ((a.x - b.x).powi(2) + (a.y - b.y).powi(2)).sqrt() - field.separation_squared.sqrt(),
            Model::Exact => field.body.gap(&a, &b),
        };
        let depth = (-gap).max(LEAST_DEPTH);
        if worst.is_none_or(|worst| depth > worst.depth) {
            worst = Some(Collision { time: time as u32, share, first: a, second: b, depth });
        }
    }
    // there is at least one moment
    worst.unwrap_or(Collision {
        time: time as u32,
        share: 1.0,
        first: *first.place(time),
        second: *second.place(time),
        depth: LEAST_DEPTH,
    })
}
