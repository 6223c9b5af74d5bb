//! Rectangles that drive: how far apart they are, and whether they touch while they move.
//!
//! # Source
//! Separating axes for convex shapes; conservative advancement over a step by bisection: a gap that no motion within the
//! interval can close needs no closer look. Units of the turning radius.

use super::curve::{Place, Segment, Steer};

/// Half of an interval's motion below which a gap that is not certain counts as contact.
const RESOLUTION: f64 = 1e-4;

/// A rectangle about the reference point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    /// From the reference point to the middle, ahead.
    pub(super) offset: f64,
    /// Half of the length.
    pub(super) half_length: f64,
    /// Half of the width.
    pub(super) half_width: f64,
    /// From the middle to a corner.
    pub(super) radius: f64,
}

impl Body {
    pub(super) fn new(front: f64, rear: f64, width: f64) -> Self {
        let (half_length, half_width) = (0.5 * (front + rear), 0.5 * width);
        Self { offset: 0.5 * (front - rear), half_length, half_width, radius: half_length.hypot(half_width) }
    }

    /// Middle of the body at `place`.
    #[inline]
    pub(super) fn middle(&self, place: &Place) -> (f64, f64) {
        (place.x + self.offset * place.cos, place.y + self.offset * place.sin)
    }

    /// How far the point (x, y) is outside of the body grown by `margin` with square corners; negative within.
    #[inline]
    pub(super) fn gap_to_point(&self, place: &Place, (x, y): (f64, f64), margin: f64) -> f64 {
        let (mx, my) = self.middle(place);
        let (dx, dy) = (x - mx, y - my);
        let ahead = (place.cos * dx + place.sin * dy).abs() - self.half_length - margin;
        let aside = (place.cos * dy - place.sin * dx).abs() - self.half_width - margin;
        ahead.max(aside)
    }

    /// Largest gap over the axes of two bodies; they overlap where it is negative.
    #[inline]
    pub(super) fn gap(&self, a: &Place, b: &Place) -> f64 {
        let (ax, ay) = self.middle(a);
        let (bx, by) = self.middle(b);
        let (dx, dy) = (bx - ax, by - ay);
        let c = (a.cos * b.cos + a.sin * b.sin).abs();
        let s = (a.cos * b.sin - a.sin * b.cos).abs();
        let along = self.half_length * (1.0 + c) + self.half_width * s;
        let across = self.half_width * (1.0 + c) + self.half_length * s;
        let gaps = [
            (a.cos * dx + a.sin * dy).abs() - along,
            (a.cos * dy - a.sin * dx).abs() - across,
            (b.cos * dx + b.sin * dy).abs() - along,
            (b.cos * dy - b.sin * dx).abs() - across,
        ];
        gaps.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Largest gap over the axes of the body and a convex polygon, counter-clockwise.
    pub(super) fn gap_to_polygon(&self, place: &Place, corners: &[(f64, f64)]) -> f64 {
        let (mx, my) = self.middle(place);
        let axes = [(place.cos, place.sin, self.half_length), (-place.sin, place.cos, self.half_width)];
        let mut gap = f64::NEG_INFINITY;
        for (ux, uy, half) in axes {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for (x, y) in corners {
                let along = ux * (x - mx) + uy * (y - my);
                low = low.min(along);
                high = high.max(along);
            }
            gap = gap.max(low - half).max(-high - half);
        }
        for (i, (x, y)) in corners.iter().enumerate() {
            let (x2, y2) = corners[(i + 1) % corners.len()];
            let (ex, ey) = (x2 - x, y2 - y);
            let length = ex.hypot(ey);
            if length > 0.0 {
                // outwards of a counter-clockwise edge
                let (nx, ny) = (ey / length, -ex / length);
                let reach: f64 = axes.iter().map(|(ux, uy, half)| half * (ux * nx + uy * ny).abs()).sum();
                gap = gap.max(nx * (mx - x) + ny * (my - y) - reach);
            }
        }
        gap
    }

    /// Bound on how fast any point of the body, grown by `margin` with square corners, moves while it drives `step` within
    /// a unit of time.
    #[inline]
    pub(super) fn speed(&self, step: Segment, margin: f64) -> f64 {
        let reach = self.offset.abs() + self.radius + margin * std::f64::consts::SQRT_2;
        match step.steer {
            Steer::Straight => step.length.abs(),
            Steer::Left | Steer::Right => step.length.abs() * (1.0 + reach),
            Steer::Spin => step.length.abs() * reach,
        }
    }
}

/// A body at `from` on its way along `step` after the share `time` of the step.
#[inline]
pub(super) fn during(from: &Place, step: Segment, time: f64) -> Place {
    from.after(Segment { length: step.length * time, ..step })
}

/// Whether `gap` stays positive over a step, given that it closes by at most `speed` per step.
pub(super) fn stays_open(speed: f64, gap: &dyn Fn(f64) -> f64) -> bool {
    open_between(speed, gap, 0.5, 0.5)
}

fn open_between(speed: f64, gap: &dyn Fn(f64) -> f64, middle: f64, half: f64) -> bool {
    let here = gap(middle);
    if here > speed * half {
        return true;
    }
    if here <= 0.0 || speed * half < RESOLUTION {
        return false;
    }
    let quarter = 0.5 * half;
    open_between(speed, gap, middle - quarter, quarter) && open_between(speed, gap, middle + quarter, quarter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_of_rectangles() {
        let body = Body::new(2.0, 1.0, 2.0);
        let at = Place::new;
        assert!((body.gap(&at(0.0, 0.0, 0.0), &at(4.0, 0.0, 0.0)) - 1.0).abs() < 1e-12);
        assert!((body.gap(&at(0.0, 0.0, 0.0), &at(0.0, 2.5, 0.0)) - 0.5).abs() < 1e-12);
        assert!(body.gap(&at(0.0, 0.0, 0.0), &at(1.0, 1.0, 0.7)) < 0.0);
        let square = [(3.0, -1.0), (4.0, -1.0), (4.0, 1.0), (3.0, 1.0)];
        assert!((body.gap_to_polygon(&at(0.0, 0.0, 0.0), &square) - 1.0).abs() < 1e-12);
        assert!(body.gap_to_polygon(&at(1.5, 0.0, 0.3), &square) < 0.0);
        assert!((body.gap_to_point(&at(0.0, 0.0, 0.0), (3.0, 0.0), 0.8) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn bodies_that_pass_through_each_other_within_a_step_are_seen() {
        let body = Body::new(0.2, 0.2, 0.1);
        let (a, b) = (Place::new(0.0, 0.0, 0.0), Place::new(1.0, 0.02, 0.0));
        let (there, back) =
            (Segment { steer: Steer::Straight, length: 1.0 }, Segment { steer: Steer::Straight, length: -1.0 });
        let gap = |time: f64| body.gap(&during(&a, there, time), &during(&b, back, time));
        assert!(gap(0.0) > 0.0 && gap(1.0) > 0.0);
        assert!(!stays_open(body.speed(there, 0.0) + body.speed(back, 0.0), &gap));
    }
}
