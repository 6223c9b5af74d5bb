//! An instance prepared for searching: lengths in turning radii, obstacles sorted into cells, motions priced.

use super::body::{Body, during, stays_open};
use super::curve::{Curve, Place, Segment, Steer};
use super::{Model, steering};
use crate::instance::{CarInstance, Drive, Obstacle};
use cohaul_core::se2::Pose2;

/// Most cells of the index; larger maps get larger cells.
const MOST_CELLS: f64 = 1e6;
/// Most entries of obstacles in cells, unless there are more obstacles than that.
const MOST_ENTRIES: usize = 1_000_000;

/// Factors on the cost of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Prices {
    pub(super) turning: f64,
    pub(super) reversing: f64,
    pub(super) switching: f64,
}

/// An obstacle in turning radii.
#[derive(Clone, Debug)]
enum Solid {
    Point { at: (f64, f64), margin: f64 },
    Polygon { corners: Vec<(f64, f64)> },
}

impl Solid {
    /// What lies within `reach` of it: left, right, low and high ends.
    fn extent(&self, reach: f64) -> [f64; 4] {
        match self {
            Self::Point { at: (x, y), margin } => {
                let far = reach + margin * std::f64::consts::SQRT_2;
                [x - far, x + far, y - far, y + far]
            }
            Self::Polygon { corners } => {
                let none = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
                let [left, right, low, high] = corners.iter().fold(none, |[left, right, low, high], (x, y)| {
                    [left.min(*x), right.max(*x), low.min(*y), high.max(*y)]
                });
                [left - reach, right + reach, low - reach, high + reach]
            }
        }
    }
}

/// The prepared instance. Lengths in units of the turning radius.
#[derive(Clone)]
pub(super) struct Field {
    /// Metres per unit.
    pub(super) scale: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) body: Body,
    /// Least distance of reference points of [`Model::Clcbs`], squared.
    pub(super) separation_squared: f64,
    pub(super) model: Model,
    pub(super) drive: Drive,
    /// Longest way in a step.
    pub(super) step: f64,
    /// Sine and cosine of a whole step's turn.
    pub(super) step_sin_cos: (f64, f64),
    pub(super) prices: Prices,
    solids: Vec<Solid>,
    cell: f64,
    columns: usize,
    rows: usize,
    /// Obstacles of cell i are `listed[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    listed: Vec<u32>,
}

/// Why a body cannot be at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Blocked {
    Outside,
    By(usize),
}

impl Prices {
    /// What counts is length alone.
    pub(super) const LENGTH: Self = Self { turning: 1.0, reversing: 1.0, switching: 1.0 };
}

impl Field {
    pub(super) fn new(instance: &CarInstance, model: Model) -> Self {
        let vehicle = &instance.vehicle;
        let scale = vehicle.turning_radius;
        let unit = 1.0 / scale;
        let body = Body::new(vehicle.front * unit, vehicle.rear * unit, vehicle.width * unit);
        let solids: Vec<Solid> = instance
            .obstacles
            .iter()
            .map(|obstacle| match obstacle {
                Obstacle::Point { at, radius } => {
                    Solid::Point { at: (at.x * unit, at.y * unit), margin: radius.max(0.0) * unit }
                }
                Obstacle::Polygon(corners) => Solid::Polygon {
                    corners: corners.iter().map(|corner| (corner.x * unit, corner.y * unit)).collect(),
                },
            })
            .collect();
        let (width, height) = (instance.width * unit, instance.height * unit);
        let cell = 1.0_f64.max((width * height / MOST_CELLS).sqrt()).max(width / MOST_CELLS).max(height / MOST_CELLS);
        let columns = (width / cell) as usize + 1;
        let rows = (height / cell) as usize + 1;
        let step = vehicle.step_angle;
        let mut field = Self {
            scale,
            width,
            height,
            body,
            // a hair more than the rule, so that rounding cannot break it
            separation_squared: (vehicle.separation() * unit).powi(2) * (1.0 + 1e-9),
            model,
            drive: vehicle.drive,
            step,
            step_sin_cos: step.sin_cos(),
            prices: Prices {
                turning: vehicle.turning_penalty,
                reversing: vehicle.reversing_penalty,
                switching: vehicle.switching_penalty,
            },
            solids,
            cell,
            columns,
            rows,
            first: Vec::new(),
            listed: Vec::new(),
        };
        field.sort_into_cells();
        field
    }

    /// The same for bodies whose front is their rear: driving backwards becomes driving forwards.
    pub(super) fn turned_round(&self) -> Self {
        let body = Body { offset: -self.body.offset, ..self.body };
        Self { body, ..self.clone() }
    }

    /// Lists in every cell the obstacles that a body whose reference point is there may touch within a step.
    fn sort_into_cells(&mut self) {
        let reach = self.body.offset.abs() + self.body.radius + self.step;
        let boxes: Vec<[f64; 4]> = self.solids.iter().map(|solid| solid.extent(reach)).collect();
        // columns and rows that a box touches, first and last; none where it is off the map
        let touched = |field: &Self, [left, right, low, high]: [f64; 4]| {
            let clamp = |value: f64, most: usize| ((value / field.cell).max(0.0) as usize).min(most - 1);
            let is_on_map = right >= 0.0 && high >= 0.0 && left <= field.width && low <= field.height;
            is_on_map.then(|| {
                let (columns, rows) = (field.columns, field.rows);
                ((clamp(left, columns), clamp(right, columns)), (clamp(low, rows), clamp(high, rows)))
            })
        };
        // large obstacles by the thousand ask for larger cells
        loop {
            let entries: usize = boxes
                .iter()
                .filter_map(|extent| touched(self, *extent))
                .map(|((left, right), (low, high))| (right - left + 1) * (high - low + 1))
                .sum();
            if entries <= MOST_ENTRIES.max(boxes.len()) || self.columns * self.rows == 1 {
                break;
            }
            self.cell *= 2.0;
            self.columns = (self.width / self.cell) as usize + 1;
            self.rows = (self.height / self.cell) as usize + 1;
        }
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (index, extent) in boxes.iter().enumerate() {
            let Some(((left, right), (low, high))) = touched(self, *extent) else { continue };
            for row in low..=high {
                for column in left..=right {
                    pairs.push(((row * self.columns + column) as u32, index as u32));
                }
            }
        }
        pairs.sort_unstable();
        self.first = vec![0; self.columns * self.rows + 1];
        for (cell, _) in &pairs {
            self.first[*cell as usize + 1] += 1;
        }
        for cell in 1..self.first.len() {
            self.first[cell] += self.first[cell - 1];
        }
        self.listed = pairs.into_iter().map(|(_, index)| index).collect();
    }

    /// `pose` in units of the turning radius.
    pub(super) fn place(&self, pose: &Pose2) -> Place {
        let at = pose.translation.vector / self.scale;
        Place { x: at.x, y: at.y, yaw: pose.rotation.angle(), cos: pose.rotation.re, sin: pose.rotation.im }
    }

    /// `place` in metres.
    pub(super) fn pose(&self, place: &Place) -> Pose2 {
        Pose2::new(nalgebra::Vector2::new(place.x * self.scale, place.y * self.scale), place.yaw)
    }

    #[inline]
    pub(super) fn is_inside(&self, x: f64, y: f64) -> bool {
        x >= 0.0 && y >= 0.0 && x <= self.width && y <= self.height
    }

    #[inline]
    fn near(&self, place: &Place) -> &[u32] {
        let column = ((place.x / self.cell) as usize).min(self.columns - 1);
        let row = ((place.y / self.cell) as usize).min(self.rows - 1);
        let cell = row * self.columns + column;
        &self.listed[self.first[cell] as usize..self.first[cell + 1] as usize]
    }

    fn gap(&self, solid: u32, place: &Place) -> f64 {
        match &self.solids[solid as usize] {
            Solid::Point { at, margin } => self.body.gap_to_point(place, *at, *margin),
            Solid::Polygon { corners } => self.body.gap_to_polygon(place, corners),
        }
    }

    /// What keeps a body from standing at `place`.
    pub(super) fn blocked(&self, place: &Place) -> Option<Blocked> {
        if !self.is_inside(place.x, place.y) {
            return Some(Blocked::Outside);
        }
        self.near(place).iter().find(|solid| self.gap(**solid, place) <= 0.0).map(|solid| Blocked::By(*solid as usize))
    }

    /// Whether a body of any heading whose reference point is within `slack` of (x, y) touches an obstacle.
    pub(super) fn surely_blocked(&self, (x, y): (f64, f64), slack: f64) -> bool {
        let rear = self.body.half_length - self.body.offset;
        let front = self.body.half_length + self.body.offset;
        let core = rear.min(front).min(self.body.half_width) - slack;
        let place = Place { x: x.clamp(0.0, self.width), y: y.clamp(0.0, self.height), yaw: 0.0, cos: 1.0, sin: 0.0 };
        self.near(&place).iter().any(|solid| match &self.solids[*solid as usize] {
            Solid::Point { at, margin } => (at.0 - x).hypot(at.1 - y) < core + margin,
            Solid::Polygon { corners } => distance_to_polygon(corners, (x, y)) < core,
        })
    }

    /// Whether nothing fixed is in the way of `step`, which leads from `from` to `to`.
    #[inline]
    pub(super) fn is_free(&self, from: &Place, step: Segment, to: &Place) -> bool {
        match self.model {
            Model::Clcbs => self.is_inside(to.x, to.y) && self.near(to).iter().all(|solid| self.gap(*solid, to) > 0.0),
            Model::Exact => self.is_inside(to.x, to.y) && self.stays_inside(from, step) && self.sweeps_free(from, step),
        }
    }

    /// Whether the reference point stays on the map between the ends of an arc.
    fn stays_inside(&self, from: &Place, step: Segment) -> bool {
        if !matches!(step.steer, Steer::Left | Steer::Right) || step.length == 0.0 {
            return true;
        }
        let turn = if step.steer == Steer::Left { step.length } else { -step.length };
        // an arc reaches furthest where its tangent lies along an axis
        let quarter = std::f64::consts::FRAC_PI_2;
        let (low, high) = if turn > 0.0 { (from.yaw, from.yaw + turn) } else { (from.yaw + turn, from.yaw) };
        let mut heading = (low / quarter).ceil() * quarter;
        while heading < high {
            let at = during(from, step, (heading - from.yaw) / turn);
            if !self.is_inside(at.x, at.y) {
                return false;
            }
            heading += quarter;
        }
        true
    }

    fn sweeps_free(&self, from: &Place, step: Segment) -> bool {
        self.near(from).iter().all(|solid| {
            let margin = match &self.solids[*solid as usize] {
                Solid::Point { margin, .. } => *margin,
                Solid::Polygon { .. } => 0.0,
            };
            let speed = self.body.speed(step, margin);
            if speed == 0.0 {
                return self.gap(*solid, from) > 0.0;
            }
            stays_open(speed, &|time| self.gap(*solid, &during(from, step, time)))
        })
    }

    /// Cost of `step` after one in `gear` (1 forwards, −1 backwards, 0 none yet), and the gear after it.
    #[inline]
    pub(super) fn cost(&self, prices: &Prices, gear: i8, step: Segment) -> (f64, i8) {
        let length = step.length.abs();
        if length == 0.0 {
            return (self.step, gear);
        }
        match step.steer {
            Steer::Spin => (length * prices.turning, gear),
            steer => {
                let mut cost = length;
                if steer != Steer::Straight {
                    cost *= prices.turning;
                }
                let now = if step.length < 0.0 { -1 } else { 1 };
                if now < 0 {
                    cost *= prices.reversing;
                }
                if gear != 0 && gear != now {
                    cost *= prices.switching;
                }
                (cost, now)
            }
        }
    }

    /// Cost of a piece of a curve, a turn or straight, after a step in `gear`: whole steps and a shorter last one.
    #[inline]
    pub(super) fn segment_cost(&self, prices: &Prices, gear: i8, length: f64, turns: bool) -> f64 {
        let size = length.abs();
        let mut rate = if turns { prices.turning } else { 1.0 };
        let mut cost = size;
        if length < 0.0 {
            rate *= prices.reversing;
        }
        if gear != 0 && (gear < 0) != (length < 0.0) {
            cost += (prices.switching - 1.0) * size.min(self.step);
        }
        rate * cost
    }

    /// Cost of a whole curve after a step in `gear`.
    pub(super) fn curve_cost(&self, prices: &Prices, mut gear: i8, curve: &Curve) -> f64 {
        let mut cost = 0.0;
        for segment in curve.segments() {
            if segment.steer == Steer::Spin {
                cost += segment.length.abs() * prices.turning;
            } else {
                cost += self.segment_cost(prices, gear, segment.length, segment.steer != Steer::Straight);
                gear = if segment.length < 0.0 { -1 } else { 1 };
            }
        }
        cost
    }

    /// Length that no way between the places undercuts.
    pub(super) fn distance(&self, start: &Place, goal: &Place) -> f64 {
        steering::distance(self.drive, start, goal)
    }

    /// Whole steps that a body can make.
    pub(super) const fn primitives(&self) -> &'static [(Steer, f64)] {
        const CAR: [(Steer, f64); 6] = [
            (Steer::Straight, 1.0),
            (Steer::Left, 1.0),
            (Steer::Right, 1.0),
            (Steer::Straight, -1.0),
            (Steer::Left, -1.0),
            (Steer::Right, -1.0),
        ];
        const FORWARD: [(Steer, f64); 3] = [(Steer::Straight, 1.0), (Steer::Left, 1.0), (Steer::Right, 1.0)];
        const DIFFERENTIAL: [(Steer, f64); 4] =
            [(Steer::Straight, 1.0), (Steer::Spin, 1.0), (Steer::Spin, -1.0), (Steer::Straight, -1.0)];
        match self.drive {
            Drive::Car => &CAR,
            Drive::ForwardCar => &FORWARD,
            Drive::Differential => &DIFFERENTIAL,
        }
    }
}

/// Distance of a point from a convex polygon, counter-clockwise; 0 within.
fn distance_to_polygon(corners: &[(f64, f64)], (x, y): (f64, f64)) -> f64 {
    let mut inside = true;
    let mut nearest = f64::INFINITY;
    for (i, (x1, y1)) in corners.iter().enumerate() {
        let (x2, y2) = corners[(i + 1) % corners.len()];
        let (ex, ey) = (x2 - x1, y2 - y1);
        inside &= ex * (y - y1) - ey * (x - x1) >= 0.0;
        let square = ex * ex + ey * ey;
        let share = if square > 0.0 { (((x - x1) * ex + (y - y1) * ey) / square).clamp(0.0, 1.0) } else { 0.0 };
        nearest = nearest.min((x1 + share * ex - x).hypot(y1 + share * ey - y));
    }
    if inside && !corners.is_empty() { 0.0 } else { nearest }
}
