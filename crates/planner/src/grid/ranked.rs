//! Assignments of grid goals in the order of their cost.

use super::check::Checked;
use crate::assign::{Costs, NextBest};
use crate::search::{Assigned, Assignments, Budget, Spent};

/// The goals of all agents as one list of cells, with what they cost.
pub(super) struct Wishes {
    /// Steps by agent and cell of the list.
    pub costs: Costs,
    /// By agent and cell of the list: which of the agent's goals is there.
    pub which: Vec<Vec<Option<usize>>>,
}

impl Wishes {
    pub(super) fn new(checked: &Checked) -> Self {
        let mut cells: Vec<u32> = checked.targets.iter().flatten().flatten().map(|target| target.cell).collect();
        cells.sort_unstable();
        cells.dedup();
        let mut values = Vec::with_capacity(cells.len() * checked.starts.len());
        let mut which = Vec::with_capacity(checked.starts.len());
        for (targets, &start) in checked.targets.iter().zip(&checked.starts) {
            let mut own = vec![None; cells.len()];
            let row = values.len();
            values.resize(row + cells.len(), f64::INFINITY);
            for (goal, target) in targets.iter().enumerate() {
                let Some(target) = target else { continue };
                if let Ok(at) = cells.binary_search(&target.cell)
                    && own[at].is_none()
                {
                    own[at] = Some(goal);
                    values[row + at] = f64::from(target.distances[start as usize]);
                }
            }
            which.push(own);
        }
        Self { costs: Costs::new(checked.starts.len(), cells.len(), values), which }
    }
}

/// The assignments, the cheapest first.
pub(super) struct Ranked {
    wishes: Wishes,
    /// Nothing before the first is asked for.
    next_best: Option<NextBest>,
}

impl Ranked {
    pub(super) const fn new(wishes: Wishes) -> Self {
        Self { wishes, next_best: None }
    }
}

impl Assignments for Ranked {
    fn next(&mut self, budget: &Budget<'_>) -> Result<Option<Assigned>, Spent> {
        let work = self.wishes.costs.work();
        let mut ranked = match self.next_best.take() {
            Some(ranked) => ranked,
            None => NextBest::first(&self.wishes.costs, || budget.spend(work))?,
        };
        let next = ranked.following(|| budget.spend(work))?;
        self.next_best = Some(ranked);
        Ok(next.map(|assignment| {
            let which = &self.wishes.which;
            let goals = assignment.goals.iter().zip(which).map(|(goal, which)| which[(*goal)?]).collect();
            Assigned { goals, cost: assignment.cost }
        }))
    }
}
