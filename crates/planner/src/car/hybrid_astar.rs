//! A way for one body through the traffic of the others: hybrid-state A* over place, heading and time.
//!
//! # Source
//! [CL-CBS] §IV-B, spatiotemporal hybrid-state A*: whole steps straight, left and right in both gears, and waiting; an
//! analytic curve to the goal is tried wherever a state is expanded.
//!
//! # Deviations
//! - The curve is tried with the four cheapest words, not only the shortest, and the search goes on until no state could still lead to
//!   a way that is cheaper by more than `ratio`: the first curve that fits is rarely the best.
//! - A goal counts as reached only if nobody drives over it afterwards; the original forgets that.
//! - After the last motion of the others time is no longer told apart, so that the search space is finite.
//! - Meeting others costs what the caller says, which may be infinite.
//! - Heuristics of new states are their parent's less the step, made exact when they come to be expanded.
//!
//! [CL-CBS]: cohaul_core::_documentation::references

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

use super::body::during;
use super::curve::{Curve, Place, Segment, Steer, wrap};
use super::field::{Field, Prices};
use super::steering;
use super::table::Table;
use super::traffic::Traffic;
use super::way::{WAIT, Way, steps_of};
use crate::search::{Budget, Spent};

/// Least number of headings that are told apart, and how many per largest turn of a step; more do not fit into keys.
const HEADINGS: f64 = 24.0;
const HEADINGS_PER_STEP: f64 = 2.5;
const MOST_HEADINGS: f64 = 255.0;
/// Cells per step length.
const CELLS_PER_STEP: f64 = 1.0;
/// Longest way, in steps: what keys can tell apart.
const MOST_STEPS: f64 = 65_000.0;
/// Steps along a curve that are counted as an expansion, beyond those of everyday curves.
const STEPS_PER_EXPANSION: usize = 256;
/// Excess of a state's own total over what it was queued with that is not worth queueing it again.
const REQUEUE: f64 = 1e-3;

/// What is asked of the search.
#[derive(Clone, Copy)]
pub(super) struct Ask<'a> {
    pub(super) field: &'a Field,
    pub(super) traffic: &'a Traffic,
    /// What a step costs in which one is in the way of a body, by body; 0 for the one that is planned.
    pub(super) weights: &'a [f64],
    pub(super) prices: &'a Prices,
    pub(super) start: Place,
    /// Where to; none: to any place where the body is not in the way.
    pub(super) goal: Option<Place>,
    /// Where not to be.
    pub(super) rules: &'a [Avoid],
    /// Factor on what lies ahead: the result may cost this many times the least that is found possible.
    pub(super) ratio: f64,
    /// No way that costs this or more is wanted.
    pub(super) below: f64,
    /// Most states to expand.
    pub(super) limit: u64,
    pub(super) care: Care,
    /// Into how many a whole step, and a cell, is divided.
    pub(super) fineness: u32,
}

/// What the search leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Care {
    /// It waits and reverses only where others are in the way; of the states in a cell it keeps the cheapest.
    Quick,
    /// It waits and reverses everywhere.
    Thorough,
    /// It keeps all states that are not the same, and what it says is ahead is never too much: its bound is one.
    /// `ratio` then counts when the search ends, not in which order it goes.
    Exact,
}

/// Where a body must not be at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avoid {
    /// The step after which, or in which, the moment is.
    pub(super) time: u32,
    /// Which share of the step has passed.
    pub(super) share: f64,
    /// The middle of what is forbidden.
    pub(super) place: Place,
    /// How far it reaches, for places.
    pub(super) reach: f64,
    /// What a radian of heading counts.
    pub(super) lever: f64,
}

impl Avoid {
    /// Whether a body that drives `step` from `from` in the step after `time` keeps to it.
    fn allows(&self, from: &Place, step: Segment, time: u32) -> bool {
        if time != self.time {
            return true;
        }
        let at = if step.length == 0.0 { *from } else { during(from, step, self.share) };
        apart(&at, &self.place) + self.lever * wrap(at.yaw - self.place.yaw).abs() >= self.reach
    }
}

/// What the search found.
pub(super) struct Found {
    pub(super) way: Option<Way>,
    /// Its cost and what meeting others costs.
    pub(super) total: f64,
    /// No way costs less, meetings included; of meaning with [`Care::Exact`] only.
    pub(super) least: f64,
    /// States that were expanded.
    pub(super) expanded: u64,
    /// Whether all that there is to search was searched.
    pub(super) exhausted: bool,
}

#[derive(Clone, Copy)]
struct Node {
    place: Place,
    /// Cost so far, meetings included.
    cost: f64,
    time: u32,
    parent: u32,
    step: Segment,
    gear: i8,
    /// How many curves from here were priced; until then `ahead` is no more than a bound.
    curves: u8,
    /// Where the first of them is kept.
    first: u32,
    ahead: f64,
}

/// Cheapest first, then the furthest, then the first that was made.
#[derive(Clone, Copy, PartialEq)]
struct Open {
    total: f64,
    cost: f64,
    node: u32,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .total
            .total_cmp(&self.total)
            .then_with(|| self.cost.total_cmp(&other.cost))
            .then_with(|| other.node.cmp(&self.node))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Memory that searches use one after the other.
pub(super) struct HybridAstar {
    nodes: Vec<Node>,
    open: BinaryHeap<Open>,
    reached: Table,
    curves: Vec<(f64, Curve)>,
}

/// A curve that reaches the goal.
struct Arrival {
    node: u32,
    curve: Curve,
    total: f64,
}

impl HybridAstar {
    pub(super) fn new() -> Self {
        Self { nodes: Vec::new(), open: BinaryHeap::new(), reached: Table::new(), curves: Vec::new() }
    }

    /// The cheapest way that was found.
    pub(super) fn find(&mut self, ask: &Ask<'_>, budget: &Budget<'_>) -> Result<Found, Spent> {
        let (field, traffic) = (ask.field, ask.traffic);
        self.nodes.clear();
        self.open.clear();
        self.reached.clear();
        self.curves.clear();
        let parked = ask.goal.map_or_else(Vec::new, |goal| traffic.weigh_parked(field, ask.weights, &goal));
        let last_rule = ask.rules.iter().map(|rule| rule.time + 1).max().unwrap_or(0);
        let limits = Limits {
            settled: (traffic.settled() as u32).max(last_rule),
            order: if ask.care == Care::Exact { 1.0 } else { ask.ratio },
            end: if ask.care == Care::Exact { ask.ratio } else { 1.0 },
        };
        let mut best: Option<Arrival> = None;
        let mut below = ask.below;
        let mut expanded = 0;
        let mut least = f64::INFINITY;
        let root = Node {
            place: ask.start,
            cost: 0.0,
            time: 0,
            parent: u32::MAX,
            step: WAIT,
            gear: 0,
            curves: 0,
            first: 0,
            ahead: ask.goal.map_or(0.0, |goal| field.distance(&ask.start, &goal)),
        };
        self.nodes.push(root);
        self.open.push(Open { total: limits.order * root.ahead, cost: 0.0, node: 0 });
        self.reached.improves(key(ask, &limits, &root), 0.0);
        while let Some(top) = self.open.pop() {
            if top.total * limits.end >= below || expanded >= ask.limit {
                least = top.total.min(below);
                break;
            }
            let index = top.node;
            let mut node = self.nodes[index as usize];
            if let Some(goal) = ask.goal
                && node.curves == 0
            {
                let list = steering::cheapest(field, ask.prices, node.gear, &node.place, &goal);
                node.first = self.curves.len() as u32;
                node.curves = list.as_slice().len() as u8;
                self.curves.extend_from_slice(list.as_slice());
                let price = list.as_slice().first().map_or(f64::INFINITY, |(price, _)| *price);
                node.ahead = if ask.care == Care::Exact { field.distance(&node.place, &goal) } else { price };
                self.nodes[index as usize] = node;
                let total = node.cost + limits.order * node.ahead;
                if total > top.total + REQUEUE {
                    self.open.push(Open { total, ..top });
                    continue;
                }
            }
            budget.spend(1)?;
            expanded += 1;
            let mut hindered = false;
            if ask.goal.is_none() {
                match rest(ask, &node) {
                    total if total < below => {
                        below = total;
                        best = Some(Arrival { node: index, curve: Curve::new(&[]), total });
                        hindered = total > node.cost;
                    }
                    _ => hindered = true,
                }
            }
            for i in node.first..node.first + u32::from(node.curves) {
                let (price, curve) = self.curves[i as usize];
                if node.cost + price >= below {
                    break;
                }
                match follow(ask, &node, &curve, &parked, below, budget)? {
                    Some(total) if total < below => {
                        below = total;
                        best = Some(Arrival { node: index, curve, total });
                        hindered |= total > node.cost + price + 1e-9;
                    }
                    _ => hindered = true,
                }
            }
            self.expand(ask, index, below, hindered, &limits);
        }
        let exhausted = least == f64::INFINITY;
        let (way, total) = match best {
            Some(arrival) => (Some(self.trace(ask, &arrival)), arrival.total),
            None => (None, f64::INFINITY),
        };
        Ok(Found { way, total, least: least.min(total), expanded, exhausted })
    }

    fn expand(&mut self, ask: &Ask<'_>, index: u32, below: f64, hindered: bool, limits: &Limits) {
        let (field, traffic) = (ask.field, ask.traffic);
        let node = self.nodes[index as usize];
        let mut in_the_way = hindered;
        let everything = ask.care != Care::Quick;
        let length = field.step / f64::from(ask.fineness);
        let (sin, cos) = if ask.fineness == 1 { field.step_sin_cos } else { length.sin_cos() };
        for (steer, sign) in field.primitives() {
            if *sign < 0.0 && !everything && !in_the_way && node.gear >= 0 && node.time > 0 {
                continue;
            }
            let step = Segment { steer: *steer, length: sign * length };
            let place = node.place.moved(step, (sign * sin, cos));
            let (price, gear) = field.cost(ask.prices, node.gear, step);
            let cost = node.cost + price;
            let ahead = ask.goal.map_or(0.0, |goal| (node.ahead - price).max(apart(&place, &goal)));
            if cost + ahead >= below || !field.is_free(&node.place, step, &place) || !keeps(ask, &node, step) {
                in_the_way |= !ask.rules.is_empty();
                continue;
            }
            let met = traffic.weigh(field, ask.weights, &node.place, step, &place, node.time as usize);
            in_the_way |= met > 0.0;
            let time = node.time + 1;
            let cost = cost + met;
            self.add(
                ask,
                below,
                limits,
                Node { place, cost, time, parent: index, step, gear, curves: 0, first: 0, ahead },
            );
        }
        if (in_the_way || everything) && node.time < limits.settled && keeps(ask, &node, WAIT) {
            let met = traffic.weigh(field, ask.weights, &node.place, WAIT, &node.place, node.time as usize);
            let cost = node.cost + field.step + met;
            let waited = Node { cost, time: node.time + 1, parent: index, step: WAIT, ..node };
            self.add(ask, below, limits, waited);
        }
    }

    fn add(&mut self, ask: &Ask<'_>, below: f64, limits: &Limits, node: Node) {
        if node.cost + node.ahead < below && self.reached.improves(key(ask, limits, &node), node.cost as f32) {
            let index = self.nodes.len() as u32;
            let total = node.cost + limits.order * node.ahead;
            self.open.push(Open { total, cost: node.cost, node: index });
            self.nodes.push(node);
        }
    }

    fn trace(&self, ask: &Ask<'_>, arrival: &Arrival) -> Way {
        let mut steps: Vec<Segment> = Vec::new();
        let mut at = arrival.node;
        while let Some(node) = self.nodes.get(at as usize) {
            if node.parent == u32::MAX {
                break;
            }
            steps.push(node.step);
            at = node.parent;
        }
        steps.reverse();
        steps.extend(steps_of(&arrival.curve, ask.field.step));
        Way::new(ask.field, ask.start, steps, ask.goal)
    }
}

/// What a search goes by.
struct Limits {
    /// Step after which nothing changes any more.
    settled: u32,
    /// Factor on what lies ahead, for the order of states.
    order: f64,
    /// Factor on the first state in order, for the end of the search.
    end: f64,
}

/// What tells states apart.
#[inline]
fn key(ask: &Ask<'_>, limits: &Limits, node: &Node) -> u64 {
    let place = &node.place;
    let time = u64::from(node.time.min(limits.settled)) & 0xffff;
    if ask.care == Care::Exact {
        // the same but for rounding; gears differ in what the next step costs
        let fine = |value: f64| (value * 1e6).round() as i64 as u64;
        let turned = fine(wrap(place.yaw)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let at = fine(place.x).wrapping_mul(0xc2b2_ae3d_27d4_eb4f) ^ fine(place.y).wrapping_mul(0x1656_67b1_9e37_79f9);
        return at.rotate_left(17) ^ turned ^ time.wrapping_mul(0xff51_afd7_ed55_8ccd) ^ (node.gear as u64) << 40;
    }
    let fineness = f64::from(ask.fineness);
    let cells = fineness * CELLS_PER_STEP / ask.field.step;
    let headings = (fineness * HEADINGS.max(HEADINGS_PER_STEP * TAU / ask.field.step)).min(MOST_HEADINGS);
    let (x, y) = ((place.x * cells) as u64 & 0xf_ffff, (place.y * cells) as u64 & 0xf_ffff);
    let heading = (wrap(place.yaw) * (headings / TAU)).floor() as i64 as u64 & 0xff;
    time << 48 | x << 28 | y << 8 | heading
}

/// Whether all rules allow `step` from `node`.
#[inline]
fn keeps(ask: &Ask<'_>, node: &Node, step: Segment) -> bool {
    ask.rules.iter().all(|rule| rule.allows(&node.place, step, node.time))
}

/// Whether all rules allow to rest at `place` from `time` on.
fn may_rest(ask: &Ask<'_>, place: &Place, time: u32) -> bool {
    ask.rules.iter().all(|rule| rule.time < time || rule.allows(place, WAIT, rule.time))
}

/// Cost of resting at `node` for good.
fn rest(ask: &Ask<'_>, node: &Node) -> f64 {
    if !may_rest(ask, &node.place, node.time) {
        return f64::INFINITY;
    }
    let met = (node.time as usize..=ask.traffic.settled())
        .map(|time| ask.traffic.weigh(ask.field, ask.weights, &node.place, WAIT, &node.place, time));
    node.cost + met.sum::<f64>()
}

/// Distance of two places.
fn apart(a: &Place, b: &Place) -> f64 {
    ((a.x - b.x).powi(2) + (a.y - b.y).powi(2)).sqrt()
}

/// Cost of reaching the goal from `node` along `curve` and resting there; nothing where something fixed is in the way or
/// it costs `below` or more.
fn follow(
    ask: &Ask<'_>,
    node: &Node,
    curve: &Curve,
    parked: &[f64],
    below: f64,
    budget: &Budget<'_>,
) -> Result<Option<f64>, Spent> {
    let field = ask.field;
    let length: f64 = curve.segments().iter().map(|segment| segment.length.abs()).sum();
    if f64::from(node.time) + length / field.step > MOST_STEPS {
        return Ok(None);
    }
    let (mut at, mut cost, mut gear, mut time) = (node.place, node.cost, node.gear, node.time as usize);
    let (sin, cos) = field.step_sin_cos;
    for step in steps_of(curve, field.step) {
        let whole = step.length.abs() == field.step;
        let to = if whole && step.steer != Steer::Straight {
            at.moved(step, (step.length.signum() * sin, cos))
        } else {
            at.after(step)
        };
        if !field.is_free(&at, step, &to) || !ask.rules.iter().all(|rule| rule.allows(&at, step, time as u32)) {
            return Ok(None);
        }
        let (price, now) = field.cost(ask.prices, gear, step);
        cost += price + ask.traffic.weigh(field, ask.weights, &at, step, &to, time);
        if cost >= below {
            return Ok(None);
        }
        (at, gear, time) = (to, now, time + 1);
        if time % STEPS_PER_EXPANSION == 0 {
            budget.spend(1)?;
        }
    }
    let total = cost + parked[time.min(parked.len() - 1)];
    Ok((total < below && may_rest(ask, &at, time as u32)).then_some(total))
}
