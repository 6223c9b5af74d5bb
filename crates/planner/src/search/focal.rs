//! Which node of the conflict tree comes next.
//!
//! # Source
//! Pearl and Kim, "Studies in semi-admissible heuristics" (1982), as used by Barer et al. (2014): among the open nodes whose
//! cost is within `weight` times the least lower bound of all open nodes, the one with the fewest conflicts.
//!
//! # Deviations
//! FOCAL is taken from the least lower *bound*, not from the least cost, so that what is found first is within `weight` of
//! the optimum. Every fourth node is taken for its lower bound, which raises it (as the explicit estimation search of Li et
//! al., "EECBS: a bounded-suboptimal search for multi-agent path finding" (2021) does from time to time). With weight 1 this is
//! best-first search with ties broken by conflicts.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Slack for comparing sums of floats that were added up in different ways, relative.
pub(super) const ROUNDING: f64 = 1e-10;

/// Every so many nodes, one is taken for its lower bound instead of its conflicts. Found by trial: a tree that is searched by
/// conflicts alone gets lost where the bound leaves too little room, and a raised bound gives it some.
const RAISE: u32 = 4;

/// A node with its rank; the least rank comes first, the youngest node among equals.
#[derive(Clone, Copy)]
struct Entry {
    rank: [f64; 3],
    node: u32,
}

impl Ord for Entry {
    // the heap's greatest is what comes first
    fn cmp(&self, other: &Self) -> Ordering {
        let [a, b, c] = self.rank;
        let [d, e, f] = other.rank;
        d.total_cmp(&a).then(e.total_cmp(&b)).then(f.total_cmp(&c)).then(self.node.cmp(&other.node))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// What the list needs to know of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standing {
    /// No plan below this node costs less.
    pub lower_bound: f64,
    /// Sum of the costs of its paths.
    pub cost: f64,
    /// How many conflicts its paths have.
    pub conflicts: u32,
}

/// The open nodes.
pub(super) struct Open {
    weight: f64,
    turns: u32,
    /// All, by lower bound; some of them may be taken already.
    by_bound: BinaryHeap<Entry>,
    /// Those that may be taken, by conflicts.
    focal: BinaryHeap<Entry>,
    /// Those that are too dear still, by cost.
    waiting: BinaryHeap<Entry>,
    /// Which nodes left the list, by node.
    taken: Vec<bool>,
    standing: Vec<Standing>,
}

impl Open {
    /// An empty list; nodes are to be pushed in the order of their numbers 0, 1, ….
    pub(super) const fn new(weight: f64) -> Self {
        Self {
            weight,
            turns: 0,
            by_bound: BinaryHeap::new(),
            focal: BinaryHeap::new(),
            waiting: BinaryHeap::new(),
            taken: Vec::new(),
            standing: Vec::new(),
        }
    }

    /// Adds the next node.
    pub(super) fn push(&mut self, standing: Standing) {
        let node = self.taken.len() as u32;
        self.taken.push(false);
        self.standing.push(standing);
        self.by_bound.push(Entry { rank: [standing.lower_bound, f64::from(standing.conflicts), standing.cost], node });
        self.waiting.push(Entry { rank: [standing.cost, f64::from(standing.conflicts), standing.lower_bound], node });
    }

    /// The least lower bound of the open nodes, `None` if there are none.
    pub(super) fn bound(&mut self) -> Option<f64> {
        while let Some(first) = self.by_bound.peek() {
            if !self.taken[first.node as usize] {
                return Some(first.rank[0]);
            }
            self.by_bound.pop();
        }
        None
    }

    /// The next node, if nothing outside of the list has a lower bound below `others`.
    pub(super) fn pop(&mut self, others: f64) -> Option<u32> {
        let least = self.bound()?;
        let limit = self.limit(least.min(others));
        while let Some(cheapest) = self.waiting.peek() {
            let node = cheapest.node;
            if !self.taken[node as usize] {
                if cheapest.rank[0] > limit {
                    break;
                }
                let Standing { lower_bound, cost, conflicts } = self.standing[node as usize];
                self.focal.push(Entry { rank: [f64::from(conflicts), cost, lower_bound], node });
            }
            self.waiting.pop();
        }
        self.turns = self.turns.wrapping_add(1);
        if self.turns.is_multiple_of(RAISE) {
            return self.cheapest();
        }
        while let Some(first) = self.focal.pop() {
            if !self.taken[first.node as usize] {
                self.taken[first.node as usize] = true;
                return Some(first.node);
            }
        }
        // only if the least bound stands beside a cost that is too high, which a sound domain does not produce but through
        // rounding: searching below it is right all the same
        self.cheapest()
    }

    /// The node of the least lower bound.
    fn cheapest(&mut self) -> Option<u32> {
        self.bound()?;
        let first = self.by_bound.pop()?;
        self.taken[first.node as usize] = true;
        Some(first.node)
    }

    /// What a plan may cost when no plan costs less than `bound`.
    pub(super) fn limit(&self, bound: f64) -> f64 {
        self.weight * bound * (1.0 + ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standing(lower_bound: f64, cost: f64, conflicts: u32) -> Standing {
        Standing { lower_bound, cost, conflicts }
    }

    #[test]
    fn weight_one_is_best_first_with_ties_broken_by_conflicts() {
        let mut open = Open::new(1.0);
        for (bound, conflicts) in [(5.0, 0), (4.0, 3), (4.0, 1), (6.0, 0)] {
            open.push(standing(bound, bound, conflicts));
        }
        let order: Vec<_> = std::iter::from_fn(|| open.pop(f64::INFINITY)).collect();
        assert_eq!(order, [2, 1, 0, 3]);
    }

    #[test]
    fn focal_takes_fewest_conflicts_within_the_weight_of_the_least_bound() {
        let mut open = Open::new(1.5);
        open.push(standing(10.0, 12.0, 4));
        open.push(standing(11.0, 15.0, 1));
        open.push(standing(11.0, 15.5, 0));
        assert_eq!(open.pop(f64::INFINITY), Some(1), "node 2 is dearer than 1.5 · 10");
        assert_eq!(open.bound(), Some(10.0));
        assert_eq!(open.pop(f64::INFINITY), Some(0));
        assert_eq!(open.pop(f64::INFINITY), Some(2));
        assert_eq!(open.pop(f64::INFINITY), None);
    }
}
