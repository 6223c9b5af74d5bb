//! Where all bodies are in every step, and who is in whose way.
//!
//! Positions lie in rows by step, so that asking whether anybody is near is one pass over a row.

use std::sync::Arc;

use super::Model;
use super::body::{during, stays_open};
use super::curve::{Place, Segment};
use super::field::Field;
use super::way::{WAIT, Way};

/// The ways of all bodies. Those without a way are nowhere.
pub(super) struct Traffic {
    bodies: usize,
    /// Rows that are filled: steps 0 to `rows − 1`; afterwards all stand where the last row has them.
    rows: usize,
    x: Vec<f64>,
    y: Vec<f64>,
    ways: Vec<Option<Arc<Way>>>,
}

impl Traffic {
    pub(super) fn new(bodies: usize) -> Self {
        Self { bodies, rows: 1, x: vec![f64::NAN; bodies], y: vec![f64::NAN; bodies], ways: vec![None; bodies] }
    }

    /// Step from which on nobody moves.
    pub(super) const fn settled(&self) -> usize {
        self.rows - 1
    }

    pub(super) fn way(&self, body: usize) -> Option<&Arc<Way>> {
        self.ways[body].as_ref()
    }

    /// Gives a body a way, or takes it away.
    pub(super) fn set(&mut self, body: usize, way: Option<Arc<Way>>) {
        if let Some(way) = &way {
            while self.rows <= way.len() {
                let last = (self.rows - 1) * self.bodies;
                self.x.extend_from_within(last..);
                self.y.extend_from_within(last..);
                self.rows += 1;
            }
        }
        for row in 0..self.rows {
            let (x, y) = way.as_ref().map_or((f64::NAN, f64::NAN), |way| {
                let place = way.place(row);
                (place.x, place.y)
            });
            self.x[row * self.bodies + body] = x;
            self.y[row * self.bodies + body] = y;
        }
        let before = std::mem::replace(&mut self.ways[body], way);
        // rows at the end in which nobody moves any more are of no use
        if before.is_some_and(|before| before.len() == self.settled()) {
            let last = self.ways.iter().flatten().map(|way| way.len()).max().unwrap_or(0);
            self.rows = last + 1;
            self.x.truncate(self.rows * self.bodies);
            self.y.truncate(self.rows * self.bodies);
        }
    }

    /// Sum of `weights` over the bodies that are in the way of a body which drives `step` from `from` to `to` in the step
    /// after `time`. Bodies of weight 0 do not count.
    #[inline]
    pub(super) fn weigh(
        &self,
        field: &Field,
        weights: &[f64],
        from: &Place,
        step: Segment,
        to: &Place,
        time: usize,
    ) -> f64 {
        match field.model {
            Model::Clcbs => {
                let row = (time + 1).min(self.rows - 1) * self.bodies;
                let (xs, ys) = (&self.x[row..row + self.bodies], &self.y[row..row + self.bodies]);
                let mut sum = 0.0;
                for ((x, y), weight) in xs.iter().zip(ys).zip(weights) {
                    let (dx, dy) = (x - to.x, y - to.y);
                    sum += if dx * dx + dy * dy < field.separation_squared { *weight } else { 0.0 };
                }
                sum
            }
            Model::Exact => {
                let row = time.min(self.rows - 1) * self.bodies;
                let (xs, ys) = (&self.x[row..row + self.bodies], &self.y[row..row + self.bodies]);
                let reach = 2.0 * (field.body.offset.abs() + field.body.radius + field.step);
                let mut sum = 0.0;
                for (other, ((x, y), weight)) in xs.iter().zip(ys).zip(weights).enumerate() {
                    let (dx, dy) = (x - from.x, y - from.y);
                    if *weight > 0.0
                        && dx * dx + dy * dy < reach * reach
                        && let Some(way) = &self.ways[other]
                        && !passes(field, from, step, way.place(time), way.step(time))
                    {
                        sum += weight;
                    }
                }
                sum
            }
        }
    }

    /// For every step: the sum of weights of all that pass over a body which rests at `goal` from that step on.
    pub(super) fn weigh_parked(&self, field: &Field, weights: &[f64], goal: &Place) -> Vec<f64> {
        let mut sums = vec![0.0; self.rows + 1];
        for time in (0..self.rows).rev() {
            sums[time] = sums[time + 1] + self.weigh(field, weights, goal, WAIT, goal, time);
        }
        sums
    }

    /// Bodies that the way of `body` meets.
    pub(super) fn met(&self, field: &Field, body: usize, way: &Way) -> Vec<usize> {
        match field.model {
            Model::Clcbs => {
                let mut met = vec![false; self.bodies];
                for time in 1..self.rows.max(way.len() + 1) {
                    let row = time.min(self.rows - 1) * self.bodies;
                    let place = way.place(time);
                    let (xs, ys) = (&self.x[row..row + self.bodies], &self.y[row..row + self.bodies]);
                    for ((x, y), met) in xs.iter().zip(ys).zip(&mut met) {
                        let (dx, dy) = (x - place.x, y - place.y);
                        *met |= dx * dx + dy * dy < field.separation_squared;
                    }
                }
                met[body] = false;
                (0..self.bodies).filter(|other| met[*other]).collect()
            }
            Model::Exact => (0..self.bodies)
                .filter(|other| *other != body)
                .filter(|other| {
                    self.ways[*other].as_ref().is_some_and(|theirs| meetings(field, way, theirs).next().is_some())
                })
                .collect(),
        }
    }
}

/// Whether two bodies stay clear of each other in a step.
pub(super) fn passes(field: &Field, a: &Place, step_a: Segment, b: &Place, step_b: Segment) -> bool {
    let speed = field.body.speed(step_a, 0.0) + field.body.speed(step_b, 0.0);
    let (ax, ay) = field.body.middle(a);
    let (bx, by) = field.body.middle(b);
    // no closer look where they cannot meet
    if (ax - bx).hypot(ay - by) > 2.0 * field.body.radius + speed {
        return true;
    }
    if speed == 0.0 {
        return field.body.gap(a, b) > 0.0;
    }
    stays_open(speed, &|time| field.body.gap(&during(a, step_a, time), &during(b, step_b, time)))
}

/// Steps after which, or in which, two ways meet: the step's number.
pub(super) fn meetings<'a>(field: &'a Field, a: &'a Way, b: &'a Way) -> impl Iterator<Item = usize> + 'a {
    (0..a.len().max(b.len())).filter(move |time| match field.model {
        Model::Clcbs => {
            let (p, q) = (a.place(time + 1), b.place(time + 1));
            (p.x - q.x).powi(2) + (p.y - q.y).powi(2) < field.separation_squared
        }
        Model::Exact => !passes(field, a.place(*time), a.step(*time), b.place(*time), b.step(*time)),
    })
}
