//! The way of one body, step by step.

use super::curve::{Curve, Place, Segment, Steer};
use super::field::Field;

/// A step in which a body stands still.
pub(super) const WAIT: Segment = Segment { steer: Steer::Straight, length: 0.0 };

/// Length that is rounding only, in turning radii: curves come out of roots, which double how many digits are lost.
const NOTHING: f64 = 3e-8;

/// Places after 0, 1, 2, … steps and the steps between them.
#[derive(Clone, Debug)]
pub(super) struct Way {
    pub(super) places: Vec<Place>,
    pub(super) steps: Vec<Segment>,
    /// Sum of lengths with penalties.
    pub(super) cost: f64,
    /// Sum of lengths; a wait counts a whole step.
    pub(super) length: f64,
}

impl Way {
    /// Standing at `place` for good.
    pub(super) fn resting(place: Place) -> Self {
        Self { places: vec![place], steps: Vec::new(), cost: 0.0, length: 0.0 }
    }

    /// The way that `steps` make from `start`; it ends in `goal`, if there is one (which they reach but for rounding).
    pub(super) fn new(field: &Field, start: Place, mut steps: Vec<Segment>, goal: Option<Place>) -> Self {
        // resting is no step
        while steps.last().is_some_and(|step| step.length == 0.0) {
            steps.pop();
        }
        let mut places = Vec::with_capacity(steps.len() + 1);
        places.push(start);
        let (mut at, mut gear, mut cost, mut length) = (start, 0, 0.0, 0.0);
        for step in &steps {
            at = if step.length == 0.0 { at } else { at.after(*step) };
            places.push(at);
            let (price, now) = field.cost(&field.prices, gear, *step);
            cost += price;
            gear = now;
            length += if step.length == 0.0 { field.step } else { step.length.abs() };
        }
        if let (Some(last), Some(goal)) = (places.last_mut(), goal) {
            *last = goal;
        }
        Self { places, steps, cost, length }
    }

    /// Number of steps.
    pub(super) const fn len(&self) -> usize {
        self.steps.len()
    }

    /// Where the body is after `time` steps.
    pub(super) fn place(&self, time: usize) -> &Place {
        &self.places[time.min(self.steps.len())]
    }

    /// What the body does in the step after `time`.
    pub(super) fn step(&self, time: usize) -> Segment {
        self.steps.get(time).copied().unwrap_or(WAIT)
    }
}

/// The steps that make up a curve: whole ones, and a shorter last one per segment.
pub(super) fn steps_of(curve: &Curve, step: f64) -> impl Iterator<Item = Segment> + '_ {
    curve.segments().iter().flat_map(move |segment| {
        let length = segment.length.abs();
        let sign = segment.length.signum();
        // a rest that is only rounding belongs to the last whole step
        let whole = ((length + NOTHING) / step) as usize;
        let rest = length - whole as f64 * step;
        let full = std::iter::repeat_n(Segment { length: sign * step, ..*segment }, whole);
        let last = (rest > NOTHING).then_some(Segment { length: sign * rest, ..*segment });
        full.chain(last)
    })
}
