//! Who takes which goal, by what the way there costs a car.

use super::check::{Checked, collide};
use super::curve::Place;
use super::field::Field;
use crate::assign::{Costs, NextBest};
use crate::search::{Assigned, Assignments, Budget, Spent};

/// Goals whose prices are found in the time of an expansion.
const PRICED_PER_EXPANSION: usize = 16;

/// What an assignment of goals to cars is judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Length of the shortest curve that the body can drive among no obstacles.
    #[default]
    Curve,
    /// |Δx| + |Δy|, as on a grid: what a pipeline of two steps goes by, which assigns first and plans then.
    Manhattan,
}

/// The goals of all agents as one list, the cheapest assignments first.
pub(super) struct Ranked<'a> {
    field: &'a Field,
    places: Vec<Place>,
    /// By agent and place of the list: which of the agent's goals is there.
    pub(super) which: Vec<Vec<Option<usize>>>,
    /// By agent and place of the list.
    pub(super) costs: Costs,
    /// Nothing before the first is asked for.
    next_best: Option<NextBest>,
    /// Whether costs are bounds on what the ways cost.
    bounds: bool,
}

impl<'a> Ranked<'a> {
    /// Assignments without the pairs of agent and goal in `without`.
    ///
    /// # Errors
    /// [`Spent`] as soon as the budget is.
    pub(super) fn new(
        field: &'a Field,
        checked: &Checked,
        metric: Metric,
        without: &[(usize, usize)],
        budget: &Budget<'_>,
    ) -> Result<Self, Spent> {
        let bits = |place: &Place| [place.x.to_bits(), place.y.to_bits(), place.cos.to_bits(), place.sin.to_bits()];
        let mut places: Vec<Place> = checked.goals.iter().flatten().flatten().copied().collect();
        places.sort_unstable_by_key(bits);
        places.dedup_by_key(|place| bits(place));
        let mut values = Vec::with_capacity(places.len() * checked.starts.len());
        let mut which = Vec::with_capacity(checked.starts.len());
        for (agent, (goals, start)) in checked.goals.iter().zip(&checked.starts).enumerate() {
            let mut own = vec![None; places.len()];
            let row = values.len();
            values.resize(row + places.len(), f64::INFINITY);
            for (goal, place) in goals.iter().enumerate() {
                if goal % PRICED_PER_EXPANSION == 0 {
                    budget.spend(1)?;
                }
                let Some(place) = place else { continue };
                if without.contains(&(agent, goal)) {
                    continue;
                }
                if let Ok(at) = places.binary_search_by_key(&bits(place), bits)
                    && own[at].is_none()
                {
                    own[at] = Some(goal);
                    values[row + at] = match metric {
                        Metric::Curve => field.distance(start, place),
                        Metric::Manhattan => (place.x - start.x).abs() + (place.y - start.y).abs(),
                    };
                }
            }
            which.push(own);
        }
        let costs = Costs::new(checked.starts.len(), places.len(), values);
        Ok(Self { field, places, which, costs, next_best: None, bounds: metric == Metric::Curve })
    }
}

impl Assignments for Ranked<'_> {
    /// Assignments whose goals can all be occupied at once.
    fn next(&mut self, budget: &Budget<'_>) -> Result<Option<Assigned>, Spent> {
        let work = self.costs.work();
        let mut ranked = match self.next_best.take() {
            Some(ranked) => ranked,
            None => NextBest::first(&self.costs, || budget.spend(work))?,
        };
        loop {
            let Some(assignment) = ranked.following(|| budget.spend(work))? else { return Ok(None) };
            let taken: Vec<&Place> = assignment.goals.iter().flatten().map(|goal| &self.places[*goal]).collect();
            let clear =
                taken.iter().enumerate().all(|(i, a)| taken[i + 1..].iter().all(|b| !collide(self.field, a, b)));
            if clear {
                self.next_best = Some(ranked);
                let goals = assignment.goals.iter().zip(&self.which).map(|(goal, which)| which[(*goal)?]).collect();
                return Ok(Some(Assigned { goals, cost: if self.bounds { assignment.cost } else { 0.0 } }));
            }
        }
    }
}
