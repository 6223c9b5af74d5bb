//! Assignments in the order of their cost.
//!
//! # Source
//! Murty, "An algorithm for ranking all the assignments in order of increasing cost" (1968), with the partition of Lawler (1972)
//! and the reuse of duals of Miller, Stone and Cox (1997): each part needs one shortest path.
//!
//! # Deviations
//! Only assignments with as many goals taken as possible are listed.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::convert::Infallible;

use super::matching::{Matching, Scratch};
use super::{Assignment, Costs};

/// The assignments of agents to goals, the cheapest first.
#[derive(Clone, Debug)]
pub struct NextBest {
    costs: Costs,
    parts: BinaryHeap<Part>,
    made: u32,
    scratch: Scratch,
    /// How many agents take a goal.
    taken: usize,
}

/// The assignments that share a beginning, with the best of them.
#[derive(Clone, Debug)]
struct Part {
    cost: f64,
    number: u32,
    matching: Matching,
    /// The agents before this one keep their goals in all assignments of the part.
    first: usize,
    /// What the agent `first` does not take.
    forbidden: Vec<u32>,
}

impl Ord for Part {
    // the heap's greatest is the cheapest, the oldest among equals
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

impl NextBest {
    /// All assignments under these costs.
    pub fn new(costs: &Costs) -> Self {
        let Ok(all) = Self::first::<Infallible>(costs, || Ok(()));
        all
    }

    /// The same; `tick` is asked again and again whether to go on, at least once for every agent.
    pub(crate) fn first<E>(costs: &Costs, tick: impl FnMut() -> Result<(), E>) -> Result<Self, E> {
        let mut scratch = Scratch::default();
        let matching = Matching::new(costs, &mut scratch, tick)?;
        let goals = matching.goals();
        let taken = goals.iter().flatten().count();
        let cost = Assignment::new(costs, goals).cost;
        let parts = BinaryHeap::from([Part { cost, number: 0, matching, first: 0, forbidden: Vec::new() }]);
        Ok(Self { costs: costs.clone(), parts, made: 1, scratch, taken })
    }

    /// The next assignment; `tick` as in [`NextBest::first`]. After an error, nothing more is to be asked.
    pub(crate) fn following<E>(&mut self, mut tick: impl FnMut() -> Result<(), E>) -> Result<Option<Assignment>, E> {
        let Some(part) = self.parts.pop() else { return Ok(None) };
        let goals = part.matching.goals();
        // what is left of the part: the first agent that differs from this assignment takes something else
        for agent in part.first..self.costs.agents() {
            tick()?;
            let mut forbidden = if agent == part.first { part.forbidden.clone() } else { Vec::new() };
            forbidden.push(part.matching.column(agent));
            let mut matching = part.matching.clone();
            if !matching.forbid(&self.costs, agent, &forbidden, &mut self.scratch) {
                continue;
            }
            let goals = matching.goals();
            if goals.iter().flatten().count() < self.taken {
                continue;
            }
            let cost = Assignment::new(&self.costs, goals).cost;
            self.parts.push(Part { cost, number: self.made, matching, first: agent, forbidden });
            self.made += 1;
        }
        Ok(Some(Assignment::new(&self.costs, goals)))
    }
}

impl Iterator for NextBest {
    type Item = Assignment;

    fn next(&mut self) -> Option<Assignment> {
        let Ok(next) = self.following::<Infallible>(|| Ok(()));
        next
    }
}
