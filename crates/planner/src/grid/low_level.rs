//! The way of one agent through steps and cells.
//!
//! # Source
//! Silver, "Cooperative pathfinding" (2005) for A* over steps and cells with exact distances; Pearl and Kim (1982) for the
//! focal list, with conflicts as its order (Barer et al. 2014).
//!
//! # Deviations
//! The states of a step share one layer of a flat table, and all steps after the last rule and the last arrival of others share
//! the last layer, which bounds the search. A path is cheap enough if its cost is within the weight of the least bound, or
//! within a ceiling that the caller names. Ends are states of their own, since only they answer for conflicts at the goal
//! after the arrival.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::space::{MOVES, NONE, Space, WAIT, opposite};
use super::timetable::{CELL, Timetable};
use crate::search::{Budget, Spent};

/// Marks the entry of an end.
const END: u32 = 1 << 31;
/// No path is longer.
const FARTHEST: f64 = 16_000_000.0;
/// More conflicts are not counted.
const MOST: u64 = 0xffff;
/// Marks a state whose predecessor is in the last layer too.
const LATE: u8 = 8;
/// Marks the start.
const START: u8 = 16;

/// What is asked.
pub(super) struct Request<'a> {
    pub start: u32,
    /// The goal with the distances to it; without one, an agent may end anywhere and each move costs 1.
    pub goal: Option<(u32, &'a [u32])>,
    /// Whether waiting at the goal costs nothing.
    pub rest_is_free: bool,
    /// The first step in which the agent may be at its goal for good.
    pub earliest: u32,
    /// The last step in which it may arrive.
    pub latest: u32,
    /// From which step on a cell is barred for good, by cell; empty if none is.
    pub closed: &'a [u32],
    /// Where the agent has to be next, by step: (step, cell), steps descending; empty if it is free.
    pub waypoints: &'a [(u32, u32)],
    /// How many steps of detour a conflict is worth.
    pub price: u64,
    pub weight: f64,
    pub floor: f64,
    pub ceiling: f64,
}

/// What was found: the cells by step are in the caller's buffer.
pub(super) struct Answer {
    pub cost: u32,
    pub lower_bound: u32,
}

#[derive(Clone, Copy, Default)]
struct State {
    stamp: u32,
    /// Cost so far.
    cost: u32,
    conflicts: u16,
    via: u8,
    open: bool,
}

/// Scratch memory of the search.
#[derive(Default)]
pub(super) struct LowLevel {
    stamp: u32,
    cells: usize,
    price: u64,
    states: Vec<State>,
    /// Those that are cheap enough: fewest conflicts, then least f, then most steps.
    focal: BinaryHeap<Reverse<(u64, u32)>>,
    /// Those that are not yet, by f.
    waiting: Vec<Vec<u32>>,
    /// How many open states have an f.
    open: Vec<u32>,
    /// Ends: at which state, and how it was reached.
    ends: Vec<(u32, State)>,
    /// Conflicts at the goal after a step.
    after: Vec<u32>,
    pub expanded: u64,
}

impl LowLevel {
    /// Finds a path through `table`, whose bars it heeds and whose agents it avoids, and writes its cells to `path`.
    pub(super) fn plan(
        &mut self,
        space: &Space,
        table: &Timetable,
        request: &Request<'_>,
        path: &mut Vec<u32>,
        budget: &Budget<'_>,
    ) -> Result<Option<Answer>, Spent> {
        path.clear();
        let cells = space.cells();
        let last = table.layers() - 1;
        self.prepare(table, request);
        let height = |cell: u32| request.goal.map_or(0, |(_, distances)| distances[cell as usize]);
        let first = height(request.start);
        let late_start = request.closed.get(request.start as usize).is_some_and(|&from| from == 0);
        if first == NONE || late_start || table.slot(0, request.start).barred & CELL != 0 {
            return Ok(None);
        }
        // a bound known already widens the focal list from the beginning; f below it is left as it is
        let mut least = first;
        let limit = |least: u32| -> u32 {
            let bound = f64::from(least).max(request.floor);
            (request.weight * bound + 1e-9).max(request.ceiling).max(bound).min(FARTHEST) as u32
        };
        let mut allowed = limit(least);
        self.visit(request.start, 0, 0, START, first, allowed);
        if request.goal.is_some_and(|(goal, _)| goal == request.start) || (request.goal.is_none() && last == 0) {
            let start = State { stamp: self.stamp, cost: 0, conflicts: 0, via: START, open: true };
            self.end(request, last, request.start, start, allowed);
        }
        loop {
            // the least f of all open states
            while self.open.get(least as usize).is_some_and(|&count| count == 0) {
                least += 1;
            }
            let raised = limit(least);
            if raised > allowed || self.focal.is_empty() {
                let mut upto = raised.max(allowed);
                if self.focal.is_empty() {
                    // nothing else is open: the cheapest that waits bounds the rest
                    let Some(next) = (allowed as usize + 1..self.waiting.len()).find(|&f| !self.waiting[f].is_empty())
                    else {
                        return Ok(None);
                    };
                    upto = upto.max(limit(next as u32));
                    least = least.max(next as u32);
                }
                for f in allowed as usize + 1..=(upto as usize).min(self.waiting.len().saturating_sub(1)) {
                    let mut list = std::mem::take(&mut self.waiting[f]);
                    for &index in &list {
                        self.enter(index, f as u32);
                    }
                    list.clear();
                    self.waiting[f] = list;
                }
                allowed = upto;
            }
            let Some(Reverse((_, index))) = self.focal.pop() else { continue };
            if index & END != 0 {
                let (at, state) = self.ends[(index & !END) as usize];
                self.trace(space, at, state.via, path);
                if request.goal.is_none() {
                    while path.len() > 1 && path[path.len() - 1] == path[path.len() - 2] {
                        path.pop();
                    }
                }
                let lower_bound = f64::from(least).max(request.floor).min(f64::from(state.cost)) as u32;
                return Ok(Some(Answer { cost: state.cost, lower_bound }));
            }
            let state = self.states[index as usize];
            if !state.open {
                continue;
            }
            let f = state.cost + height(index % cells as u32);
            budget.spend(1)?;
            self.expanded += 1;
            self.states[index as usize].open = false;
            self.open[f as usize] -= 1;
            let (layer, cell) = (index as usize / cells, index % cells as u32);
            let next_layer = (layer + 1).min(last);
            let late = if layer == last { LATE } else { 0 };
            let barred = table.slot(layer, cell).barred;
            for direction in 0..=WAIT {
                let next = if direction < MOVES {
                    if barred & 1 << direction != 0 {
                        continue;
                    }
                    space.neighbours[cell as usize][direction]
                } else {
                    cell
                };
                if next == NONE {
                    continue;
                }
                let rest = height(next);
                if rest == NONE || table.slot(next_layer, next).barred & CELL != 0 {
                    continue;
                }
                let rests =
                    direction == WAIT && request.goal.is_none_or(|(goal, _)| goal == cell && request.rest_is_free);
                let cost = state.cost + u32::from(!rests);
                let f = cost + rest;
                if next_layer as u32 + rest > request.latest
                    || request.closed.get(next as usize).is_some_and(|&from| next_layer as u32 >= from)
                    || !reaches(space, request.waypoints, next_layer as u32, next)
                {
                    continue;
                }
                let met = table.conflicts(layer, next_layer, next, direction);
                let conflicts = u32::from(state.conflicts).saturating_add(met).min(MOST as u32);
                let index = (next_layer * cells) as u32 + next;
                let via = direction as u8 | late;
                let opened = self.visit_checked(index, cost, conflicts as u16, via, f, allowed, cells, &height);
                // who only waits has arrived before; without a goal, the last layer is where everybody stays
                let ends = match request.goal {
                    Some((goal, _)) => goal == next && direction < MOVES,
                    None => opened && next_layer == last,
                };
                if ends {
                    let state = State { stamp: self.stamp, cost, conflicts: conflicts as u16, via, open: true };
                    self.end(request, last, index, state, allowed);
                }
            }
        }
    }

    /// Clears the tables and counts who crosses the goal when.
    fn prepare(&mut self, table: &Timetable, request: &Request<'_>) {
        self.stamp = self.stamp.wrapping_add(1);
        self.cells = table.cells();
        self.price = request.price;
        let size = table.layers() * self.cells;
        if self.stamp == 0 {
            self.states.fill(State::default());
            self.stamp = 1;
        }
        if self.states.len() < size {
            // not twice as much as needed: tables are large
            self.states.reserve_exact(size + size / 4 - self.states.len());
            self.states.resize(size, State::default());
        }
        self.focal.clear();
        self.ends.clear();
        self.waiting.iter_mut().for_each(Vec::clear);
        self.open.fill(0);
        self.after.clear();
        if let Some((goal, _)) = request.goal {
            self.after.resize(table.layers(), 0);
            let mut sum = 0;
            for layer in (0..table.layers()).rev() {
                self.after[layer] = sum;
                sum += u32::from(table.slot(layer, goal).here);
            }
        }
    }

    /// Opens a state that was not seen before, at less cost, or at the same cost with fewer conflicts.
    #[expect(clippy::too_many_arguments, reason = "the hot loop's own variables")]
    fn visit_checked(
        &mut self,
        index: u32,
        cost: u32,
        conflicts: u16,
        via: u8,
        f: u32,
        allowed: u32,
        cells: usize,
        height: &impl Fn(u32) -> u32,
    ) -> bool {
        let old = self.states[index as usize];
        if old.stamp == self.stamp {
            if cost > old.cost || (cost == old.cost && (!old.open || conflicts >= old.conflicts)) {
                return false;
            }
            if old.open {
                let former = old.cost + height(index % cells as u32);
                self.open[former as usize] -= 1;
            }
        }
        self.visit(index, cost, conflicts, via, f, allowed);
        true
    }

    fn visit(&mut self, index: u32, cost: u32, conflicts: u16, via: u8, f: u32, allowed: u32) {
        self.states[index as usize] = State { stamp: self.stamp, cost, conflicts, via, open: true };
        self.add_open(f);
        self.enter_or_wait(index, f, allowed);
    }

    /// Adds an end at a state that was reached as `state` says, if the agent may stay there.
    fn end(&mut self, request: &Request<'_>, last: usize, index: u32, mut state: State, allowed: u32) {
        let layer = index as usize / self.cells;
        let may = if request.goal.is_some() { layer as u32 >= request.earliest } else { layer == last };
        let goal = request.goal.map(|(goal, _)| goal);
        let passed = request.waypoints.iter().all(|&(step, cell)| step <= layer as u32 || goal == Some(cell));
        if may && passed {
            let after = self.after.get(layer).copied().unwrap_or(0);
            state.conflicts = (u64::from(state.conflicts) + u64::from(after)).min(MOST) as u16;
            let end = self.ends.len() as u32 | END;
            self.ends.push((index, state));
            self.add_open(state.cost);
            self.enter_or_wait(end, state.cost, allowed);
        }
    }

    fn enter_or_wait(&mut self, index: u32, f: u32, allowed: u32) {
        if f <= allowed {
            self.enter(index, f);
        } else {
            if self.waiting.len() <= f as usize {
                self.waiting.resize_with(f as usize + 1, Vec::new);
            }
            self.waiting[f as usize].push(index);
        }
    }

    fn add_open(&mut self, f: u32) {
        if self.open.len() <= f as usize {
            self.open.resize(f as usize + 1, 0);
        }
        self.open[f as usize] += 1;
    }

    /// Puts an open state, or the end at one, into the focal list.
    fn enter(&mut self, index: u32, f: u32) {
        let at = (index & !END) as usize;
        let state = if index & END != 0 { self.ends[at].1 } else { self.states[at] };
        let conflicts = u64::from(state.conflicts);
        let rank = u64::from(f) + self.price * conflicts;
        let key = rank.min(0xff_ffff) << 40 | conflicts << 24 | (0xff_ffff - u64::from(state.cost));
        self.focal.push(Reverse((key, index)));
    }

    /// Writes the cells from the start to a state that was reached by `via`.
    fn trace(&self, space: &Space, end: u32, mut via: u8, path: &mut Vec<u32>) {
        let (mut layer, mut cell) = (end as usize / self.cells, end % self.cells as u32);
        loop {
            path.push(cell);
            if via & START != 0 {
                break;
            }
            let direction = (via & 7) as usize;
            if direction < MOVES {
                cell = space.neighbours[cell as usize][opposite(direction)];
            }
            if via & LATE == 0 {
                layer -= 1;
            }
            via = self.states[layer * self.cells + cell as usize].via;
        }
        path.reverse();
    }
}

/// Whether the next waypoint can be reached from a cell in a step.
pub(super) fn reaches(space: &Space, waypoints: &[(u32, u32)], step: u32, cell: u32) -> bool {
    // few: they come from positive rules on one agent
    waypoints
        .iter()
        .rev()
        .find(|&&(at, _)| at >= step)
        .is_none_or(|&(at, waypoint)| space.at_least(cell, waypoint) <= at - step)
}
