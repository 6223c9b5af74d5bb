//! Agents on a grid for the conflict-based search.
//!
//! # Source
//! Sharon et al. (2015) for vertex and edge conflicts; Boyarski et al., "ICBS: improved conflict-based search" (2015) for
//! cardinal conflicts; Li et al., "Disjoint splitting for multi-agent path finding" (2019); Li et al., "New techniques for
//! pairwise symmetry breaking in multi-agent path finding" (2020) for conflicts at goals.
//!
//! # Deviations
//! Which steps of a path are without alternative is found together with the path.

use std::sync::Arc;

use super::low_level::{LowLevel, Request};
use super::narrow::Narrow;
use super::space::{NONE, Space};
use super::timetable::{Timetable, direction};
use crate::search::{Bound, Budget, Clash, Domain, Planned, Query, Spent};

/// Steps of detour that a conflict is worth in a bounded search. Found by trial: more finds longer ways round what the tree
/// resolves cheaply, less leaves it too much to resolve.
const PRICE: u64 = 4;

/// What an agent may or must do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Not be in a cell in a step.
    NotAt { step: u32, cell: u32 },
    /// Not move from one cell in a step to another.
    NotMove { step: u32, from: u32, to: u32 },
    /// Be in a cell in a step; keeps all others away from it.
    At { step: u32, cell: u32 },
    /// Move from one cell in a step to another; keeps all others out of the way.
    Move { step: u32, from: u32, to: u32 },
    /// Arrive later than in a step.
    ArriveAfter { step: u32 },
    /// Arrive in a step or before; keeps all others away from the goal from then on.
    ArriveBy { step: u32, cell: u32 },
}

/// Two agents in one cell, or two that swap theirs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Conflict {
    pub step: u32,
    /// Where the first agent is in that step.
    pub from: u32,
    /// Where it is in the next, if the two swap.
    pub to: Option<u32>,
    /// Which of the two, if any, has arrived for good.
    pub arrived: Option<Which>,
    /// Which of the two the disjoint split is about.
    pub about: Which,
}

/// One of two agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    First,
    Second,
}

/// The way of an agent.
pub(super) struct Path {
    /// Where it is, by step; it stays in the last.
    pub cells: Vec<u32>,
    /// Whether it has a goal, at which it then is at the end.
    has_goal: bool,
    /// Whether each step is without alternative of the same cost; empty if that is not known.
    narrow: Vec<bool>,
}

impl Path {
    fn at(&self, step: usize) -> u32 {
        self.cells[step.min(self.cells.len() - 1)]
    }

    fn is_narrow(&self, step: usize) -> bool {
        self.narrow.get(step).copied().unwrap_or(!self.narrow.is_empty() && self.has_goal)
    }
}

/// A goal that agents are asked to reach.
#[derive(Clone)]
pub(super) struct Target {
    pub cell: u32,
    /// Steps from every cell.
    pub distances: Arc<[u32]>,
}

/// How conflicts are split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Splits {
    /// Whether conflicts with agents at their goals are split by arrival. Not sound if goals change within a tree.
    pub arrivals: bool,
}

/// Agents on a grid.
pub(super) struct Grid {
    pub space: Space,
    starts: Vec<u32>,
    /// Goals of each agent; none for those that cannot be reached.
    targets: Vec<Vec<Option<Target>>>,
    splits: Splits,
    rest_is_free: bool,
    table: Timetable,
    /// The paths that the table counts.
    counted: Vec<Option<Arc<Path>>>,
    low_level: LowLevel,
    narrow: Narrow,
    closed: Vec<u32>,
    waypoints: Vec<(u32, u32)>,
    cells: Vec<u32>,
}

impl Grid {
    pub(super) fn new(
        space: Space,
        starts: Vec<u32>,
        targets: Vec<Vec<Option<Target>>>,
        splits: Splits,
        rest_is_free: bool,
    ) -> Self {
        let cells = space.cells();
        let counted = starts.iter().map(|_| None).collect();
        Self {
            space,
            starts,
            targets,
            splits,
            rest_is_free,
            table: Timetable::new(cells),
            counted,
            low_level: LowLevel::default(),
            narrow: Narrow::default(),
            closed: Vec::new(),
            waypoints: Vec::new(),
            cells: Vec::new(),
        }
    }

    /// Makes the table count the paths of all agents but one.
    fn count(&mut self, agent: usize, paths: &[Option<Planned<Path>>]) -> Result<(), Spent> {
        for (other, (counted, planned)) in self.counted.iter_mut().zip(paths).enumerate() {
            let wanted = planned.as_ref().filter(|_| other != agent).map(|planned| &planned.path);
            let same = match (&*counted, wanted) {
                (Some(old), Some(new)) => Arc::ptr_eq(old, new),
                (None, None) => true,
                _ => false,
            };
            if same {
                continue;
            }
            if let Some(old) = counted.take() {
                self.table.count(&self.space, &old.cells, u8::MAX)?;
            }
            if let Some(new) = wanted {
                self.table.count(&self.space, &new.cells, 1)?;
                *counted = Some(Arc::clone(new));
            }
        }
        Ok(())
    }

    /// Enters rules into the table; what they say of the arrival: (earliest, latest).
    fn bar(&mut self, agent: usize, goal: Option<u32>, rules: &[Bound<Rule>]) -> Result<(u32, u32), Spent> {
        self.table.lift();
        self.closed.clear();
        self.waypoints.clear();
        let (mut earliest, mut latest) = (0, u32::MAX);
        let bar_cell = |table: &mut Timetable, earliest: &mut u32, step: u32, cell: u32| {
            table.bar_cell(step as usize, cell)?;
            if goal == Some(cell) {
                *earliest = (*earliest).max(step + 1);
            }
            Ok(())
        };
        for bound in rules {
            let own = bound.agent == agent;
            match bound.rule {
                Rule::NotAt { step, cell } => bar_cell(&mut self.table, &mut earliest, step, cell)?,
                Rule::NotMove { step, from, to } => {
                    if let Some(direction) = direction(&self.space, from, to) {
                        self.table.bar_move(step as usize, from, direction)?;
                    }
                }
                Rule::At { step, cell } if own => self.waypoints.push((step, cell)),
                Rule::At { step, cell } => bar_cell(&mut self.table, &mut earliest, step, cell)?,
                Rule::Move { step, from, to } if own => self.waypoints.extend([(step, from), (step + 1, to)]),
                Rule::Move { step, from, to } => {
                    bar_cell(&mut self.table, &mut earliest, step, from)?;
                    bar_cell(&mut self.table, &mut earliest, step + 1, to)?;
                    if let Some(direction) = direction(&self.space, to, from) {
                        self.table.bar_move(step as usize, to, direction)?;
                    }
                }
                Rule::ArriveAfter { step } => {
                    earliest = earliest.max(step + 1);
                    self.table.extend(step as usize + 2)?;
                }
                Rule::ArriveBy { step, .. } if own => {
                    latest = latest.min(step);
                    self.table.extend(step as usize + 2)?;
                }
                Rule::ArriveBy { step, cell } => {
                    self.closed.resize(self.space.cells(), NONE);
                    let from = &mut self.closed[cell as usize];
                    *from = (*from).min(step);
                    self.table.extend(step as usize + 2)?;
                }
            }
        }
        self.waypoints.sort_unstable_by(|a, b| b.cmp(a));
        if let Some(&(step, _)) = self.waypoints.first() {
            self.table.extend(step as usize + 2)?;
        }
        Ok((earliest, latest))
    }
}

impl Domain for Grid {
    type Path = Path;
    type Rule = Rule;
    type Conflict = Conflict;

    fn agents(&self) -> usize {
        self.starts.len()
    }

    fn plan(&mut self, query: &Query<'_, Self>, budget: &Budget<'_>) -> Result<Option<Planned<Path>>, Spent> {
        let target = match query.goal {
            None => None,
            Some(goal) => match self.targets[query.agent].get(goal) {
                Some(Some(target)) => Some(target.clone()),
                _ => return Ok(None),
            },
        };
        self.count(query.agent, query.paths)?;
        let (earliest, latest) = self.bar(query.agent, target.as_ref().map(|target| target.cell), query.rules)?;
        let request = Request {
            start: self.starts[query.agent],
            goal: target.as_ref().map(|target| (target.cell, &*target.distances)),
            rest_is_free: self.rest_is_free,
            earliest,
            latest,
            closed: &self.closed,
            waypoints: &self.waypoints,
            price: if query.weight > 1.0 { PRICE } else { u64::from(u16::MAX) },
            weight: query.weight,
            floor: query.floor,
            ceiling: query.ceiling,
        };
        // a goal that somebody else keeps
        if target.as_ref().is_some_and(|target| self.closed.get(target.cell as usize).is_some_and(|&from| from != NONE))
        {
            return Ok(None);
        }
        let found = self.low_level.plan(&self.space, &self.table, &request, &mut self.cells, budget)?;
        let Some(answer) = found else { return Ok(None) };
        let mut narrow = Vec::new();
        // what is dearer than it must be has alternatives, and where resting made a path longer than its cost, they are not
        // looked for
        if target.is_some() && answer.cost == answer.lower_bound && answer.cost as usize + 1 == self.cells.len() {
            narrow = self.narrow.find(&self.space, &self.table, &request, self.cells.len() - 1, budget)?;
        }
        let path = Path { cells: self.cells.clone(), has_goal: target.is_some(), narrow };
        Ok(Some(Planned {
            path: Arc::new(path),
            cost: f64::from(answer.cost),
            lower_bound: f64::from(answer.lower_bound),
        }))
    }

    fn clash(&mut self, _: usize, first: &Path, _: usize, second: &Path) -> Option<Clash<Conflict>> {
        let steps = first.cells.len().max(second.cells.len());
        let mut best: Option<Clash<Conflict>> = None;
        let mut count = 0;
        for step in 0..steps {
            let (a, b) = (first.at(step), second.at(step));
            let (next_a, next_b) = (first.at(step + 1), second.at(step + 1));
            let swap = a == next_b && b == next_a && a != b;
            if a != b && !swap {
                continue;
            }
            count += 1;
            let is_narrow = |path: &Path| path.is_narrow(step) && (!swap || path.is_narrow(step + 1));
            let (narrow_first, narrow_second) = (is_narrow(first), is_narrow(second));
            let arrived = if swap || !self.splits.arrivals {
                None
            } else if step + 1 >= first.cells.len() && first.has_goal {
                Some(Which::First)
            } else if step + 1 >= second.cells.len() && second.has_goal {
                Some(Which::Second)
            } else {
                None
            };
            let class = match (narrow_first, narrow_second) {
                (true, true) => 0,
                (false, false) => 2,
                _ => 1,
            };
            let class = 2 * class + u32::from(arrived.is_none());
            let priority = class << 24 | (step as u32).min(0xff_ffff);
            if best.as_ref().is_none_or(|best| priority < best.priority) {
                let about = if narrow_second && !narrow_first { Which::Second } else { Which::First };
                let conflict = Conflict { step: step as u32, from: a, to: swap.then_some(next_a), arrived, about };
                best = Some(Clash { conflict, count: 0, priority });
            }
        }
        best.map(|best| Clash { count, ..best })
    }

    fn split(&mut self, first: usize, second: usize, conflict: &Conflict) -> [Bound<Rule>; 2] {
        let Conflict { step, from, to, arrived, about } = *conflict;
        if let Some(which) = arrived {
            let agent = if which == Which::First { first } else { second };
            return [
                Bound::on(agent, Rule::ArriveAfter { step }),
                Bound::about(agent, Rule::ArriveBy { step, cell: from }),
            ];
        }
        let (no_first, no_second, yes_first, yes_second) = match to {
            None => {
                let (no, yes) = (Rule::NotAt { step, cell: from }, Rule::At { step, cell: from });
                (no, no, yes, yes)
            }
            Some(to) => (
                Rule::NotMove { step, from, to },
                Rule::NotMove { step, from: to, to: from },
                Rule::Move { step, from, to },
                Rule::Move { step, from: to, to: from },
            ),
        };
        match about {
            Which::First => [Bound::on(first, no_first), Bound::about(first, yes_first)],
            Which::Second => [Bound::on(second, no_second), Bound::about(second, yes_second)],
        }
    }

    fn obeys(&self, agent: usize, path: &Path, bound: &Bound<Rule>) -> bool {
        let own = bound.agent == agent;
        match bound.rule {
            Rule::At { step, cell } => (path.at(step as usize) == cell) == own,
            Rule::Move { step, from, to } => {
                let (now, next) = (path.at(step as usize), path.at(step as usize + 1));
                if own { now == from && next == to } else { now != from && next != to && !(now == to && next == from) }
            }
            Rule::ArriveBy { step, .. } if own => path.cells.len() <= step as usize + 1,
            Rule::ArriveBy { step, cell } => {
                (step as usize..path.cells.len()).all(|at| path.cells[at] != cell) && path.at(path.cells.len()) != cell
            }
            Rule::NotAt { .. } | Rule::NotMove { .. } | Rule::ArriveAfter { .. } => true,
        }
    }

    fn expanded(&self) -> u64 {
        self.low_level.expanded
    }
}
