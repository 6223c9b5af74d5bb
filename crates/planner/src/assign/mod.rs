//! Who takes which goal: optimal assignments, one after the other.
//!
//! Assignments are ordered by how many agents go without a goal, then by the sum of costs: as many agents as possible take a
//! goal, and among those assignments the cheapest comes first.
//!
//! ```
//! use cohaul_planner::assign::{Costs, NextBest, optimal};
//!
//! let costs = Costs::new(2, 2, vec![1.0, 2.0, 2.0, 5.0]);
//! assert_eq!(optimal(&costs).goals, [Some(1), Some(0)]);
//! let totals: Vec<_> = NextBest::new(&costs).map(|assignment| assignment.cost).collect();
//! assert_eq!(totals, [4.0, 6.0]);
//! ```

mod matching;
mod next_best;

pub use matching::optimal;
pub(crate) use matching::{Matching, Scratch};
pub use next_best::NextBest;

/// What it costs each agent to take each goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Costs {
    agents: usize,
    goals: usize,
    values: Vec<f64>,
    /// What it costs each agent to go without a goal; infinite where that is impossible.
    idle: Vec<f64>,
}

impl Costs {
    /// Costs by agent and goal: that of agent `i` and goal `j` is at `i · goals + j`. What is not finite, or missing, is
    /// forbidden.
    pub fn new(agents: usize, goals: usize, mut values: Vec<f64>) -> Self {
        values.resize(agents.saturating_mul(goals), f64::INFINITY);
        for value in &mut values {
            if !value.is_finite() {
                *value = f64::INFINITY;
            }
        }
        Self { agents, goals, values, idle: vec![0.0; agents] }
    }

    /// How many agents there are.
    pub const fn agents(&self) -> usize {
        self.agents
    }

    /// How many goals there are.
    pub const fn goals(&self) -> usize {
        self.goals
    }

    /// Expansions' worth of work that one augmenting path may take.
    pub(crate) const fn work(&self) -> u64 {
        let (agents, goals) = (self.agents as u64, self.goals as u64);
        1 + agents.saturating_mul(agents.saturating_add(goals)) / 128
    }

    /// What it costs `agent` to take each goal; infinite where it may not.
    pub fn of(&self, agent: usize) -> &[f64] {
        &self.values[agent * self.goals..(agent + 1) * self.goals]
    }

    /// What it costs `agent` to take a goal or, if `column` is past the goals, to go without.
    pub(crate) fn at(&self, agent: usize, column: usize) -> f64 {
        if column < self.goals { self.values[agent * self.goals + column] } else { self.idle[agent] }
    }

    /// Raises a cost to at least `cost`; columns as in [`Costs::at`].
    pub(crate) fn raise_to(&mut self, agent: usize, column: usize, cost: f64) {
        let entry =
            if column < self.goals { &mut self.values[agent * self.goals + column] } else { &mut self.idle[agent] };
        *entry = entry.max(cost);
    }
}

/// Which goal each agent takes, and the sum of the costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// By agent; `None` where none was left.
    pub goals: Vec<Option<usize>>,
    /// Sum of the costs of those that take one.
    pub cost: f64,
}

impl Assignment {
    fn new(costs: &Costs, goals: Vec<Option<usize>>) -> Self {
        let cost = goals.iter().enumerate().filter_map(|(agent, goal)| Some(costs.of(agent)[(*goal)?])).sum();
        Self { goals, cost }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small numbers from a seed.
    struct Numbers(u64);

    impl Numbers {
        fn below(&mut self, limit: u64) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) % limit
        }
    }

    fn random(numbers: &mut Numbers, whole: bool) -> Costs {
        let (agents, goals) = (numbers.below(5) as usize, numbers.below(5) as usize);
        let values = (0..agents * goals).map(|_| match numbers.below(5) {
            0 => f64::INFINITY,
            _ if whole => numbers.below(8) as f64,
            _ => numbers.below(1000) as f64 / 7.0,
        });
        Costs::new(agents, goals, values.collect())
    }

    /// All assignments, by going through them: (idle, cost, goals), sorted.
    fn all(costs: &Costs) -> Vec<(usize, f64, Vec<Option<usize>>)> {
        fn extend(costs: &Costs, goals: &mut Vec<Option<usize>>, found: &mut Vec<(usize, f64, Vec<Option<usize>>)>) {
            let agent = goals.len();
            if agent == costs.agents() {
                let Assignment { goals, cost } = Assignment::new(costs, goals.clone());
                found.push((goals.iter().filter(|goal| goal.is_none()).count(), cost, goals));
                return;
            }
            for goal in (0..costs.goals()).map(Some).chain([None]) {
                let free = goal.is_none_or(|goal| costs.of(agent)[goal].is_finite() && !goals.contains(&Some(goal)));
                if free {
                    goals.push(goal);
                    extend(costs, goals, found);
                    goals.pop();
                }
            }
        }
        let mut found = Vec::new();
        extend(costs, &mut Vec::new(), &mut found);
        found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        found
    }

    /// Against all assignments, one by one: the best, and the whole order.
    #[test]
    fn assignments_come_in_the_order_of_brute_force() {
        let mut numbers = Numbers(7);
        for case in 0..600 {
            let costs = random(&mut numbers, case % 2 == 0);
            let expected = all(&costs);
            let fewest = expected[0].0;
            let expected: Vec<_> = expected.into_iter().filter(|(idle, ..)| *idle == fewest).collect();
            let best = optimal(&costs);
            assert!((best.cost - expected[0].1).abs() < 1e-9, "case {case}: {costs:?}");
            let mut listed: Vec<_> = NextBest::new(&costs).collect();
            assert_eq!(listed.len(), expected.len(), "case {case}: {costs:?}");
            for (assignment, (_, cost, _)) in listed.iter().zip(&expected) {
                assert!((assignment.cost - cost).abs() < 1e-9, "case {case}: {costs:?}");
            }
            listed.sort_by(|a, b| a.goals.cmp(&b.goals));
            listed.dedup_by(|a, b| a.goals == b.goals);
            assert_eq!(listed.len(), expected.len(), "case {case}: something is listed twice");
        }
    }

    #[test]
    fn nobody_and_nothing_are_one_empty_assignment() {
        assert_eq!(optimal(&Costs::new(0, 3, Vec::new())).goals, []);
        assert_eq!(optimal(&Costs::new(2, 0, Vec::new())).goals, [None, None]);
        assert_eq!(NextBest::new(&Costs::new(2, 0, Vec::new())).count(), 1);
    }

    /// Sums of whole numbers below 2⁵³ are exact, however large the other costs are.
    #[test]
    fn large_costs_do_not_hide_small_differences() {
        let large = 9_000_000_000_000.0;
        let costs = Costs::new(2, 2, vec![large + 1.0, large, large, large]);
        assert_eq!(optimal(&costs).cost, 2.0 * large);
    }
}
