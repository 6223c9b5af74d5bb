//! The cheapest way over a roadmap: A* over legs, each tested when it is its turn.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI};

use cohaul_core::se2::wrap_angle;
use nalgebra::Vector2;

use super::body::{CLASS, CLASSES, Room, class_of};
use super::roadmap::Roadmap;
use super::task::Task;
use crate::search::{Budget, Spent};

/// What a turn costs, m per rad: R2P2 turns at about 0.3 rad/s and drives at about 0.2 m/s.
const TURN: f64 = 0.7;
/// What a waypoint costs, m: robots change roles there, and may have to reposition themselves.
const STOP: f64 = 0.3;
/// Deviation from a turn's nominal angle within which the load may go the other way round, rad.
const DOUBT: f64 = 0.35;
/// Difference of headings up to which one serves for another where the load may travel backwards, rad.
const NEAR: f64 = 0.3;
/// Legs shorter than this are none, m.
const SHORTEST: f64 = 0.05;

/// A leg that is known to be good.
#[derive(Clone, Copy)]
struct Leg {
    to: u32,
    heading: f64,
    cost: f64,
    before: u32,
    /// Another good leg to the same point.
    sibling: u32,
}

/// A leg that is still to be tested.
struct Candidate {
    /// Cost of the way including the leg, and of at least what comes after it, m.
    total: f64,
    to: u32,
    before: u32,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // the cheapest first; equal ones in the order in which they were found
        other.total.total_cmp(&self.total).then(other.before.cmp(&self.before)).then(other.to.cmp(&self.to))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// No leg: where the search begins.
const NONE: u32 = u32::MAX;
const START: u32 = 0;
const GOAL: u32 = 1;

pub(super) struct Search<'a> {
    task: &'a Task,
    map: &'a Roadmap,
    budget: &'a Budget<'a>,
    /// Tests of legs: 0 not done, 1 good, 2 bad; by start, then end, and by travelling backwards.
    tested: Vec<u8>,
    /// Classes of headings that the body may have at each point, one bit each.
    free: Vec<Option<u128>>,
    /// The good leg to each point that was found last.
    latest: Vec<u32>,
    legs: Vec<Leg>,
    open: BinaryHeap<Candidate>,
    room: Room,
}

/// The cheapest way found over `map`, its points from start to goal; `None` if there is none.
///
/// # Errors
/// A spent budget.
pub(super) fn cheapest(task: &Task, map: &Roadmap, budget: &Budget<'_>) -> Result<Option<Vec<Vector2<f64>>>, Spent> {
    let count = map.points.len();
    let mut search = Search {
        task,
        map,
        budget,
        tested: vec![0; 2 * count * count],
        free: vec![None; count],
        latest: vec![NONE; count],
        legs: Vec::new(),
        open: BinaryHeap::new(),
        room: Room::default(),
    };
    search.run()
}

/// Classes of headings free at `at`, one bit each.
///
/// # Errors
/// A spent budget.
pub(super) fn free_classes(
    task: &Task,
    at: &Vector2<f64>,
    budget: &Budget<'_>,
    room: &mut Room,
) -> Result<u128, Spent> {
    let mut free = (1_u128 << CLASSES) - 1;
    budget.spend(1 + task.obstacles.len() as u64 / 32)?;
    for obstacle in task.obstacles.iter().filter(|o| o.least_distance(at, at) < task.body.reach + task.margin) {
        if super::body::distance_to_polygon(at, &obstacle.corners) >= task.body.reach + task.margin {
            continue;
        }
        budget.spend(CLASSES as u64 / 4)?;
        for class in 0..CLASSES {
            if free >> class & 1 == 1 && !task.body.stands(at, class, &obstacle.corners, task.margin, room) {
                free &= !(1 << class);
            }
        }
    }
    Ok(free)
}

impl Search<'_> {
    fn run(&mut self) -> Result<Option<Vec<Vector2<f64>>>, Spent> {
        self.expand(START, self.task.start_yaw, 0.0, NONE)?;
        while let Some(Candidate { to, before, .. }) = self.open.pop() {
            self.budget.spend(1)?;
            let (from, heading, cost) = self.end_of(before);
            let Some((ahead, backwards)) = self.heading(from, to, heading) else { continue };
            let leg = self.index(from, to, backwards);
            let cost = cost + self.cost(from, to, heading, ahead);
            if self.is_worse(to, ahead, cost)?
                || !self.is_good(from, to, ahead, leg)?
                || !self.can_turn(from, heading, ahead)?
            {
                continue;
            }
            if to == GOAL
                && let Some(yaw) = self.task.goal_yaw
                && !self.can_turn(to, ahead, yaw)?
            {
                continue;
            }
            let index = self.legs.len() as u32;
            let sibling = std::mem::replace(&mut self.latest[to as usize], index);
            self.legs.push(Leg { to, heading: ahead, cost, before, sibling });
            if to == GOAL {
                return Ok(Some(self.way(index)));
            }
            self.expand(to, ahead, cost, index)?;
        }
        Ok(None)
    }

    fn end_of(&self, leg: u32) -> (u32, f64, f64) {
        self.legs.get(leg as usize).map_or((START, self.task.start_yaw, 0.0), |leg| (leg.to, leg.heading, leg.cost))
    }

    /// Whether a leg to `point` is of no use, for another one leads there that does as well: with nearly the same heading, or
    /// with any where the body may turn as it likes.
    fn is_worse(&mut self, point: u32, heading: f64, cost: f64) -> Result<bool, Spent> {
        if self.latest[point as usize] == NONE {
            return Ok(false);
        }
        let free = self.free_at(point)? == (1 << CLASSES) - 1;
        let near = match (free, self.task.either_way) {
            (true, false) => PI,
            (true, true) => NEAR,
            (false, _) => CLASS,
        };
        let mut at = self.latest[point as usize];
        while let Some(leg) = self.legs.get(at as usize) {
            let turn = wrap_angle(heading - leg.heading).abs();
            if turn <= near && leg.cost + TURN * turn <= cost + 1e-9 {
                return Ok(true);
            }
            at = leg.sibling;
        }
        Ok(false)
    }

    /// Takes up the legs from `point` on.
    fn expand(&mut self, point: u32, heading: f64, cost: f64, before: u32) -> Result<(), Spent> {
        let count = self.map.points.len();
        self.budget.spend(1 + count as u64 / 64)?;
        let at = self.map.points[point as usize];
        for to in 0..count as u32 {
            let length = (self.map.points[to as usize] - at).norm();
            let longest = self.map.longest_leg(point as usize, to as usize);
            if to == START || length < SHORTEST || length > longest {
                continue;
            }
            let Some((ahead, backwards)) = self.heading(point, to, heading) else { continue };
            let leg = self.index(point, to, backwards);
            if self.tested[leg] == 2 {
                continue;
            }
            let total = cost + self.cost(point, to, heading, ahead) + self.at_least(to, ahead);
            self.open.push(Candidate { total, to, before });
        }
        Ok(())
    }

    /// Heading on the leg of a load that comes with `heading`, and whether it travels backwards; `None` where it might
    /// choose either.
    fn heading(&self, from: u32, to: u32, heading: f64) -> Option<(f64, bool)> {
        let way = self.map.points[to as usize] - self.map.points[from as usize];
        let bearing = way.y.atan2(way.x);
        if !self.task.either_way {
            return Some((bearing, false));
        }
        let error = wrap_angle(bearing - heading).abs();
        if (error - FRAC_PI_2).abs() < DOUBT {
            return None;
        }
        Some(if error > FRAC_PI_2 { (wrap_angle(bearing - PI), true) } else { (bearing, false) })
    }

    fn index(&self, from: u32, to: u32, backwards: bool) -> usize {
        let count = self.map.points.len();
        (from as usize * count + to as usize) * 2 + usize::from(backwards)
    }

    fn cost(&self, from: u32, to: u32, heading: f64, ahead: f64) -> f64 {
        let length = (self.map.points[to as usize] - self.map.points[from as usize]).norm();
        length + TURN * wrap_angle(ahead - heading).abs() + STOP
    }

    /// What the way from `point` on costs at least.
    fn at_least(&self, point: u32, heading: f64) -> f64 {
        if point == GOAL {
            return self.task.goal_yaw.map_or(0.0, |yaw| TURN * wrap_angle(yaw - heading).abs());
        }
        let way = self.task.goal - self.map.points[point as usize];
        // legs that lead there must lie on both sides of the bearing, or on it
        let turn = if self.task.either_way { 0.0 } else { wrap_angle(way.y.atan2(way.x) - heading).abs() };
        way.norm() + TURN * turn + STOP
    }

    /// Whether the body keeps its distance along a leg.
    fn is_good(&mut self, from: u32, to: u32, heading: f64, leg: usize) -> Result<bool, Spent> {
        if self.tested[leg] == 0 {
            let (start, end) = (self.map.points[from as usize], self.map.points[to as usize]);
            let Task { body, obstacles, margin, .. } = self.task;
            self.budget.spend(1 + obstacles.len() as u64 / 32)?;
            let mut good = true;
            for obstacle in obstacles.iter().filter(|o| o.least_distance(&start, &end) < body.reach + margin) {
                self.budget.spend(1)?;
                // rounded by the spread the body may reach a little beyond its own farthest corner, never less far
                if !body.passes(&start, &end, heading, &obstacle.corners, *margin, &mut self.room) {
                    good = false;
                    break;
                }
            }
            self.tested[leg] = if good { 1 } else { 2 };
        }
        Ok(self.tested[leg] == 1)
    }

    /// Whether the body can turn at `point` from one heading to another, as the controller would.
    fn can_turn(&mut self, point: u32, from: f64, to: f64) -> Result<bool, Spent> {
        let free = self.free_at(point)?;
        if free == (1 << CLASSES) - 1 {
            return Ok(true);
        }
        let turn = wrap_angle(to - from);
        if PI - turn.abs() < DOUBT || !self.task.wraps {
            return Ok(false);
        }
        let (first, last) = if turn >= 0.0 { (class_of(from), class_of(to)) } else { (class_of(to), class_of(from)) };
        let classes = (last + CLASSES - first) % CLASSES;
        Ok((0..=classes).all(|k| free >> ((first + k) % CLASSES) & 1 == 1))
    }

    fn free_at(&mut self, point: u32) -> Result<u128, Spent> {
        let index = point as usize;
        if let Some(free) = self.free[index] {
            return Ok(free);
        }
        let free = free_classes(self.task, &self.map.points[index], self.budget, &mut self.room)?;
        self.free[index] = Some(free);
        Ok(free)
    }

    fn way(&self, last: u32) -> Vec<Vector2<f64>> {
        let mut points = Vec::new();
        let mut leg = last;
        while let Some(Leg { to, before, .. }) = self.legs.get(leg as usize) {
            points.push(self.map.points[*to as usize]);
            leg = *before;
        }
        points.push(self.task.start);
        points.reverse();
        points
    }
}
