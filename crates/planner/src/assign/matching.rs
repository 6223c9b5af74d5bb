//! Minimum-cost assignments by shortest augmenting paths.
//!
//! # Source
//! Kuhn, "The Hungarian method for the assignment problem" (1955), in the form of Jonker and Volgenant (1987); Mills-Tettey et
//! al., "The dynamic Hungarian algorithm for the assignment problem with changing costs" (2007) for changed rows.
//!
//! # Deviations
//! Each agent may idle, which is dearer than any cost: costs are pairs (idle agents, cost), compared in this order, so that no
//! large number has to stand for "infinitely dear" and nothing is lost to rounding. Goals that nobody takes behave as if
//! one idle row, the hub, held them all at cost 0; their duals are 0.

use std::convert::Infallible;
use std::ops::{Add, Sub};

use super::{Assignment, Costs};

/// A cost with the number of agents that go without a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weight {
    pub idle: i32,
    pub cost: f64,
}

impl Weight {
    pub(super) const ZERO: Self = Self { idle: 0, cost: 0.0 };
    /// More than any sum.
    const FAR: Self = Self { idle: i32::MAX, cost: 0.0 };

    pub(super) const fn of(cost: f64) -> Self {
        Self { idle: 0, cost }
    }

    const fn idling(cost: f64) -> Self {
        Self { idle: 1, cost }
    }

    pub(super) fn less(self, other: Self) -> bool {
        self.idle < other.idle || (self.idle == other.idle && self.cost < other.cost)
    }
}

impl Add for Weight {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { idle: self.idle + other.idle, cost: self.cost + other.cost }
    }
}

impl Sub for Weight {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { idle: self.idle - other.idle, cost: self.cost - other.cost }
    }
}

const NONE: u32 = u32::MAX;

/// An optimal assignment with the duals that prove it. Columns are the goals, then one place to idle for each agent.
#[derive(Clone, Debug)]
pub(crate) struct Matching {
    goals: usize,
    row_dual: Vec<Weight>,
    column_dual: Vec<Weight>,
    column_of: Vec<u32>,
    row_of: Vec<u32>,
}

/// Scratch memory of the augmenting paths.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    distance: Vec<Weight>,
    /// The row from which a column was reached; the hub is row `agents`.
    from: Vec<u32>,
    scanned: Vec<bool>,
    /// Scanned rows with the distance at which they were entered.
    rows: Vec<(u32, Weight)>,
}

impl Matching {
    /// An optimal assignment; `tick` is asked before each agent whether to go on.
    pub(crate) fn new<E>(
        costs: &Costs,
        scratch: &mut Scratch,
        mut tick: impl FnMut() -> Result<(), E>,
    ) -> Result<Self, E> {
        let (agents, goals) = (costs.agents(), costs.goals());
        let mut matching = Self {
            goals,
            row_dual: vec![Weight::ZERO; agents],
            column_dual: vec![Weight::ZERO; goals + agents],
            column_of: vec![NONE; agents],
            row_of: vec![NONE; goals + agents],
        };
        for agent in 0..agents {
            tick()?;
            // idling is always possible: there is always a path
            matching.augment(costs, agent, None, 0, &[], true, scratch);
        }
        Ok(matching)
    }

    /// The goal of an agent.
    pub(crate) fn goal(&self, agent: usize) -> Option<usize> {
        let column = self.column_of[agent] as usize;
        (column < self.goals).then_some(column)
    }

    /// The goals of all agents.
    pub(crate) fn goals(&self) -> Vec<Option<usize>> {
        (0..self.column_of.len()).map(|agent| self.goal(agent)).collect()
    }

    /// Makes the assignment optimal again after costs of one agent rose; false if there is none.
    pub(crate) fn raise(&mut self, costs: &Costs, agent: usize, scratch: &mut Scratch) -> bool {
        let target = self.column_of[agent];
        self.augment(costs, agent, Some(target), 0, &[], true, scratch)
    }

    /// The optimal assignment in which `agent` takes none of the columns `forbidden`, its present one among them, and the
    /// agents before it keep theirs; false if there is none.
    pub(super) fn forbid(&mut self, costs: &Costs, agent: usize, forbidden: &[u32], scratch: &mut Scratch) -> bool {
        let target = self.column_of[agent];
        let idle = !forbidden.contains(&((self.goals + agent) as u32));
        self.augment(costs, agent, Some(target), agent, forbidden, idle, scratch)
    }

    /// The column of an agent: a goal, or its place to idle.
    pub(super) fn column(&self, agent: usize) -> u32 {
        self.column_of[agent]
    }

    /// Gives `agent` a column: along the shortest path to a free column or, if `target` says which column it gives up, along
    /// the shortest one that ends there. Agents before `first` keep theirs. False if there is no path.
    #[expect(clippy::too_many_arguments, reason = "one loop for all that is asked of it")]
    fn augment(
        &mut self,
        costs: &Costs,
        agent: usize,
        target: Option<u32>,
        first: usize,
        forbidden: &[u32],
        may_idle: bool,
        scratch: &mut Scratch,
    ) -> bool {
        let (goals, agents) = (self.goals, self.column_of.len());
        let columns = goals + agents;
        let hub = agents as u32;
        let Scratch { distance, from, scanned, rows } = scratch;
        distance.clear();
        distance.resize(columns, Weight::FAR);
        from.clear();
        from.resize(columns, NONE);
        scanned.clear();
        scanned.resize(columns, false);
        rows.clear();
        for fixed in 0..first {
            scanned[self.column_of[fixed] as usize] = true;
        }
        let mut hub_at = None;
        let mut row = agent;
        let mut entered = Weight::ZERO;
        let end = loop {
            rows.push((row as u32, entered));
            let base = entered - self.row_dual[row];
            for (column, &cost) in costs.of(row).iter().enumerate() {
                if scanned[column] || cost == f64::INFINITY {
                    continue;
                }
                if row == agent && forbidden.contains(&(column as u32)) {
                    continue;
                }
                let through = base + Weight::of(cost) - self.column_dual[column];
                if through.less(distance[column]) {
                    distance[column] = through;
                    from[column] = row as u32;
                }
            }
            let idle = goals + row;
            let alone = costs.at(row, goals);
            if !scanned[idle] && alone < f64::INFINITY && (row != agent || may_idle) {
                let through = base + Weight::idling(alone) - self.column_dual[idle];
                if through.less(distance[idle]) {
                    distance[idle] = through;
                    from[idle] = row as u32;
                }
            }
            let next = loop {
                let mut nearest = NONE;
                let mut least = Weight::FAR;
                for column in 0..columns {
                    if !scanned[column] && distance[column].less(least) {
                        least = distance[column];
                        nearest = column as u32;
                    }
                }
                if nearest == NONE {
                    return false;
                }
                let column = nearest as usize;
                scanned[column] = true;
                if target == Some(nearest) || (target.is_none() && self.row_of[column] == NONE) {
                    break (nearest, None);
                }
                if self.row_of[column] != NONE {
                    break (nearest, Some(self.row_of[column]));
                }
                // a column that nobody holds leads to the hub, and from there to all others
                if hub_at.is_none() {
                    hub_at = Some((least, nearest));
                    for other in 0..columns {
                        let through = least - self.column_dual[other];
                        if !scanned[other] && through.less(distance[other]) {
                            distance[other] = through;
                            from[other] = hub;
                        }
                    }
                }
            };
            let (column, held_by) = next;
            match held_by {
                None => break column,
                Some(next_row) => {
                    entered = distance[column as usize];
                    row = next_row as usize;
                }
            }
        };
        let total = distance[end as usize];
        // duals: what was scanned nearer than the end moves by the difference
        let mut shift = Weight::ZERO;
        if let Some((at, _)) = hub_at {
            shift = total - at;
        }
        for &(row, entered) in rows.iter() {
            self.row_dual[row as usize] = self.row_dual[row as usize] + (total - entered);
        }
        for column in 0..columns {
            if scanned[column] && from[column] != NONE && distance[column].less(total) {
                self.column_dual[column] = self.column_dual[column] - (total - distance[column]);
            }
        }
        if shift != Weight::ZERO {
            for dual in &mut self.row_dual {
                *dual = *dual - shift;
            }
            for dual in &mut self.column_dual {
                *dual = *dual + shift;
            }
        }
        self.flip(agent, end, hub, hub_at, from);
        true
    }

    /// Moves the agents along a path that ends in a column.
    fn flip(&mut self, agent: usize, end: u32, hub: u32, hub_at: Option<(Weight, u32)>, from: &[u32]) {
        let mut column = end;
        loop {
            let row = from[column as usize];
            if row == hub {
                // the hub takes this column and gives up the one through which it was reached
                self.row_of[column as usize] = NONE;
                let Some((_, entry)) = hub_at else { return };
                column = entry;
                continue;
            }
            let given_up = self.column_of[row as usize];
            self.column_of[row as usize] = column;
            self.row_of[column as usize] = row;
            if row as usize == agent {
                return;
            }
            column = given_up;
        }
    }

    /// Sum of the duals: the cost of the assignment, for agents from `first` on.
    #[cfg(test)]
    fn proves(&self, costs: &Costs) -> bool {
        (0..self.column_of.len()).all(|row| {
            let reduced = |column: usize| {
                let cost = if column < self.goals {
                    Weight::of(costs.of(row)[column])
                } else {
                    Weight::idling(costs.at(row, self.goals))
                };
                cost - self.row_dual[row] - self.column_dual[column]
            };
            let tight = reduced(self.column_of[row] as usize);
            let columns = (0..self.goals).filter(|&goal| costs.of(row)[goal].is_finite()).chain([self.goals + row]);
            tight.idle == 0
                && tight.cost.abs() < 1e-9
                && columns.into_iter().all(|column| {
                    let reduced = reduced(column);
                    reduced.idle > 0 || (reduced.idle == 0 && reduced.cost > -1e-9)
                })
        })
    }
}

/// The cheapest of the assignments in which as many agents as possible take a goal.
pub fn optimal(costs: &Costs) -> Assignment {
    let Ok(matching) = Matching::new::<Infallible>(costs, &mut Scratch::default(), || Ok(()));
    Assignment::new(costs, matching.goals())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Raising costs one by one gives what solving anew gives, and the duals prove it each time.
    #[test]
    fn raised_costs_keep_the_assignment_optimal() {
        let mut state = 5_u64;
        let mut below = |limit: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % limit
        };
        for _ in 0..60 {
            let (agents, goals) = (1 + below(7) as usize, 1 + below(7) as usize);
            let values = (0..agents * goals).map(|_| below(20) as f64).collect();
            let mut costs = Costs::new(agents, goals, values);
            let mut scratch = Scratch::default();
            let Ok(mut matching) = Matching::new::<Infallible>(&costs, &mut scratch, || Ok(()));
            assert!(matching.proves(&costs));
            for _ in 0..30 {
                let agent = below(agents as u64) as usize;
                let goal = below(goals as u64) as usize;
                let raised = if below(9) == 0 { f64::INFINITY } else { costs.of(agent)[goal] + below(6) as f64 };
                costs.raise_to(agent, goal, raised);
                assert!(matching.raise(&costs, agent, &mut scratch));
                assert!(matching.proves(&costs), "{costs:?}");
                let anew = optimal(&costs);
                let cost = Assignment::new(&costs, matching.goals());
                assert_eq!(cost.cost, anew.cost);
                assert_eq!(cost.goals.iter().flatten().count(), anew.goals.iter().flatten().count());
            }
        }
    }
}
