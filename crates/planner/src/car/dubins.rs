//! Shortest curves of a car that only drives forwards, no tighter than its turning radius, among no obstacles.
//!
//! # Source
//! [Dubins1957]: six words,
//! four of two arcs with a straight line between, two of three arcs. The lengths are those of the tangents between the
//! turning circles.
//!
//! [Dubins1957]: cohaul_core::_documentation::references

use std::f64::consts::TAU;

use super::curve::{Curve, Place, Segment, Steer};

/// Distance of points below which they are the same but for rounding, in turning radii.
const SAME: f64 = 1e-9;

/// `angle` within [0, 2π); what is only by rounding less than a full turn is none.
fn forwards(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned > TAU - 1e-10 { 0.0 } else { turned }
}

/// Calls `found` with the steering and lengths of every word that leads to (x, y, turn) as seen from the start.
pub(super) fn words((x, y, turn): (f64, f64, f64), mut found: impl FnMut([Steer; 3], [f64; 3])) {
    for mirrored in [false, true] {
        let (y, turn) = if mirrored { (-y, -turn) } else { (y, turn) };
        let (left, right) = if mirrored { (Steer::Right, Steer::Left) } else { (Steer::Left, Steer::Right) };
        let (sin, cos) = turn.sin_cos();
        // from the centre of the first left circle to that of the last left circle
        let (xi, eta) = (x - sin, y - 1.0 + cos);
        let apart = xi.hypot(eta);
        // where both circles are one there is no tangent, and what rounding makes of it may be a full turn off
        let (t, apart) = if apart < SAME { (0.0, 0.0) } else { (forwards(eta.atan2(xi)), apart) };
        found([left, Steer::Straight, left], [t, apart, forwards(turn - t)]);
        if apart <= 4.0 + SAME {
            // a right circle touches both
            let u = TAU - 2.0 * (0.25 * apart).min(1.0).asin();
            let t = forwards(eta.atan2(xi) + 0.5 * u);
            found([left, right, left], [t, u, forwards(turn - t + u)]);
        }
        // to that of the last right circle
        let (xi, eta) = (x + sin, y - 1.0 - cos);
        let square = xi * xi + eta * eta;
        if square >= 4.0 - SAME {
            let u = (square - 4.0).max(0.0).sqrt();
            let t = forwards(eta.atan2(xi) + 2.0_f64.atan2(u));
            found([left, Steer::Straight, right], [t, u, forwards(t - turn)]);
        }
    }
}

/// Length of the shortest curve from `start` to `goal`, in turning radii.
pub fn distance(start: &Place, goal: &Place) -> f64 {
    let mut least = f64::INFINITY;
    words(start.towards(goal), |_, lengths| least = least.min(lengths.iter().sum()));
    least
}

/// A word as a curve.
pub(super) fn curve(steers: [Steer; 3], lengths: [f64; 3]) -> Curve {
    let segment = |i: usize| Segment { steer: steers[i], length: lengths[i] };
    Curve::new(&[segment(0), segment(1), segment(2)])
}

/// Every word's curve from `start` to `goal`, appended to `curves`.
pub fn curves(start: &Place, goal: &Place, curves: &mut Vec<Curve>) {
    words(start.towards(goal), |steers, lengths| curves.push(curve(steers, lengths)));
}

#[cfg(test)]
mod tests {
    use super::super::curve::wrap;
    use super::super::reeds_shepp;
    use super::*;

    fn uniform(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[test]
    fn every_word_drives_forwards_to_the_goal() {
        let mut seed = 3;
        let mut all = Vec::new();
        for _ in 0..20_000 {
            let start = Place::new(0.0, 0.0, 7.0 * uniform(&mut seed));
            let goal =
                Place::new(10.0 * uniform(&mut seed) - 5.0, 10.0 * uniform(&mut seed) - 5.0, 7.0 * uniform(&mut seed));
            all.clear();
            curves(&start, &goal, &mut all);
            for curve in &all {
                let end = curve.end(&start);
                let miss = (end.x - goal.x).hypot(end.y - goal.y) + wrap(end.yaw - goal.yaw).abs();
                assert!(miss < 1e-6, "{curve:?} misses by {miss}");
                assert!(curve.segments().iter().all(|segment| segment.length >= 0.0));
            }
            assert!(distance(&start, &goal) >= reeds_shepp::distance(&start, &goal) - 1e-9);
        }
    }
}
