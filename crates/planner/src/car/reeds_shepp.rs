//! Shortest curves of a car that drives both ways, no tighter than its turning radius, among no obstacles.
//!
//! # Source
//! [Reeds & Shepp 1990] "Optimal paths for a car that goes both forwards and backwards", Pacific J. Math. 145(2), §8,
//! formulas 8.1–8.11: nine families of words, each with its mirror images in time, left–right, and order. `φ` → `turn`,
//! `t, u, v` as printed. A shortest curve is always among them.
//!
//! # Deviations
//! - The guard of 8.4 (the last arc of C|CC) is the one that holds geometrically; every word's end is checked in a test.
//! - All words are given, not only the shortest: where a robot is in the way, the next one may be free.

use std::f64::consts::{FRAC_PI_2, PI};

use super::curve::{Curve, Place, Segment, Steer, wrap};

/// Slack in the signs of lengths, so that rounding does not lose a word that ends exactly at a boundary.
const SLACK: f64 = 1e-10;

/// Goal as seen from the start, with what all formulas need of it. Units of the turning radius.
#[derive(Clone, Copy)]
struct Sight {
    x: f64,
    y: f64,
    turn: f64,
    sin: f64,
    cos: f64,
}

impl Sight {
    fn new(x: f64, y: f64, turn: f64) -> Self {
        let (sin, cos) = turn.sin_cos();
        Self { x, y, turn, sin, cos }
    }

    /// Driven in the other gear.
    fn backwards(self) -> Self {
        Self { x: -self.x, turn: -self.turn, sin: -self.sin, ..self }
    }

    /// Left and right exchanged.
    fn mirrored(self) -> Self {
        Self { y: -self.y, turn: -self.turn, sin: -self.sin, ..self }
    }

    /// Start and goal exchanged.
    fn reversed(self) -> Self {
        Self { x: self.x * self.cos + self.y * self.sin, y: self.x * self.sin - self.y * self.cos, ..self }
    }

    /// ξ = x − sin φ, η = y − 1 + cos φ.
    fn same_side(self) -> (f64, f64) {
        (self.x - self.sin, self.y - 1.0 + self.cos)
    }

    /// ξ = x + sin φ, η = y − 1 − cos φ.
    fn other_side(self) -> (f64, f64) {
        (self.x + self.sin, self.y - 1.0 - self.cos)
    }
}

/// 8.1, L+ S+ L+.
fn lsl(to: Sight) -> Option<[f64; 3]> {
    let (xi, eta) = to.same_side();
    let t = eta.atan2(xi);
    let v = wrap(to.turn - t);
    (t >= -SLACK && v >= -SLACK).then(|| [t, xi.hypot(eta), v])
}

/// 8.2, L+ S+ R+.
fn lsr(to: Sight) -> Option<[f64; 3]> {
    let (xi, eta) = to.other_side();
    let square = xi * xi + eta * eta;
    if square < 4.0 {
        return None;
    }
    let u = (square - 4.0).sqrt();
    let t = wrap(eta.atan2(xi) + 2.0_f64.atan2(u));
    let v = wrap(t - to.turn);
    (t >= -SLACK && v >= -SLACK).then_some([t, u, v])
}

/// 8.3 and 8.4, L+ R− L with the last arc in either gear.
fn lrl(to: Sight) -> Option<[f64; 3]> {
    let (xi, eta) = to.same_side();
    let square = xi * xi + eta * eta;
    if square > 16.0 {
        return None;
    }
    let u = -2.0 * (0.25 * square.sqrt()).asin();
    let t = wrap(eta.atan2(xi) + 0.5 * u + PI);
    let v = wrap(to.turn - t + u);
    (t >= -SLACK && u <= SLACK).then_some([t, u, v])
}

/// The first and the last arc of a word of four, τ and ω.
fn outer(u: f64, v: f64, (xi, eta): (f64, f64), turn: f64) -> (f64, f64) {
    let delta = wrap(u - v);
    let a = u.sin() - delta.sin();
    let b = u.cos() - delta.cos() - 1.0;
    let t = (eta * a - xi * b).atan2(xi * a + eta * b);
    let side = 2.0 * (delta.cos() - v.cos() - u.cos()) + 3.0;
    let tau = if side < 0.0 { wrap(t + PI) } else { t };
    (tau, wrap(tau - u + v - turn))
}

/// 8.7, L+ R+ L− R−, both middle arcs equally long.
fn lrlr_turned(to: Sight) -> Option<[f64; 4]> {
    let centre = to.other_side();
    let rho = 0.25 * (2.0 + centre.0.hypot(centre.1));
    if rho > 1.0 {
        return None;
    }
    let u = rho.acos();
    let (t, v) = outer(u, -u, centre, to.turn);
    (t >= -SLACK && v <= SLACK).then_some([t, u, -u, v])
}

/// 8.8, L+ R− L− R+, both middle arcs equally long.
fn lrlr_between(to: Sight) -> Option<[f64; 4]> {
    let centre = to.other_side();
    let rho = (20.0 - centre.0 * centre.0 - centre.1 * centre.1) / 16.0;
    if !(0.0..=1.0).contains(&rho) {
        return None;
    }
    let u = -rho.acos();
    let (t, v) = outer(u, u, centre, to.turn);
    (t >= -SLACK && v >= -SLACK).then_some([t, u, u, v])
}

/// 8.9, L+ R−π/2 S− L−.
fn lrsl(to: Sight) -> Option<[f64; 4]> {
    let (xi, eta) = to.same_side();
    let square = xi * xi + eta * eta;
    if square < 4.0 {
        return None;
    }
    let r = (square - 4.0).sqrt();
    let u = 2.0 - r;
    let t = wrap(eta.atan2(xi) + r.atan2(-2.0));
    let v = wrap(to.turn - FRAC_PI_2 - t);
    (t >= -SLACK && u <= SLACK && v <= SLACK).then_some([t, -FRAC_PI_2, u, v])
}

/// 8.10, L+ R−π/2 S− R−.
fn lrsr(to: Sight) -> Option<[f64; 4]> {
    let (xi, eta) = to.other_side();
    let rho = xi.hypot(eta);
    if rho < 2.0 {
        return None;
    }
    let t = xi.atan2(-eta);
    let u = 2.0 - rho;
    let v = wrap(t + FRAC_PI_2 - to.turn);
    (t >= -SLACK && u <= SLACK && v <= SLACK).then_some([t, -FRAC_PI_2, u, v])
}

/// 8.11, L+ R−π/2 S− L−π/2 R+.
fn lrslr(to: Sight) -> Option<[f64; 5]> {
    let (xi, eta) = to.other_side();
    let square = xi * xi + eta * eta;
    if square < 4.0 {
        return None;
    }
    let u = 4.0 - (square - 4.0).sqrt();
    if u > SLACK {
        return None;
    }
    let t = wrap(((4.0 - u) * xi - 2.0 * eta).atan2(-2.0 * xi + (u - 4.0) * eta));
    let v = wrap(t - to.turn);
    (t >= -SLACK && v >= -SLACK).then_some([t, -FRAC_PI_2, u, -FRAC_PI_2, v])
}

const L: Steer = Steer::Left;
const R: Steer = Steer::Right;
const S: Steer = Steer::Straight;

const fn other(steer: Steer) -> Steer {
    match steer {
        Steer::Left => Steer::Right,
        Steer::Right => Steer::Left,
        same => same,
    }
}

/// Calls `found` with the steering and lengths of every word that leads to `to`.
fn words(to: Sight, found: &mut dyn FnMut(&[Steer], &[f64])) {
    let mut steers = [S; 5];
    let mut lengths = [0.0; 5];
    for image in 0..4 {
        let backwards = image & 1 == 1;
        let mirrored = image & 2 == 2;
        let mut seen = to;
        if backwards {
            seen = seen.backwards();
        }
        if mirrored {
            seen = seen.mirrored();
        }
        let mut give = |word: &[Steer], values: Option<&[f64]>, reversed: bool| {
            let Some(values) = values else { return };
            let n = values.len();
            for i in 0..n {
                let from = if reversed { n - 1 - i } else { i };
                steers[i] = if mirrored { other(word[from]) } else { word[from] };
                lengths[i] = if backwards { -values[from] } else { values[from] };
            }
            found(&steers[..n], &lengths[..n]);
        };
        give(&[L, S, L], lsl(seen).as_ref().map(<[f64; 3]>::as_slice), false);
        give(&[L, S, R], lsr(seen).as_ref().map(<[f64; 3]>::as_slice), false);
        give(&[L, R, L], lrl(seen).as_ref().map(<[f64; 3]>::as_slice), false);
        give(&[L, R, L, R], lrlr_turned(seen).as_ref().map(<[f64; 4]>::as_slice), false);
        give(&[L, R, L, R], lrlr_between(seen).as_ref().map(<[f64; 4]>::as_slice), false);
        give(&[L, R, S, L], lrsl(seen).as_ref().map(<[f64; 4]>::as_slice), false);
        give(&[L, R, S, R], lrsr(seen).as_ref().map(<[f64; 4]>::as_slice), false);
        give(&[L, R, S, L, R], lrslr(seen).as_ref().map(<[f64; 5]>::as_slice), false);
        // the same from the goal's end; the other families are their own images
        let seen = seen.reversed();
        give(&[L, R, L], lrl(seen).as_ref().map(<[f64; 3]>::as_slice), true);
        give(&[L, R, S, L], lrsl(seen).as_ref().map(<[f64; 4]>::as_slice), true);
        give(&[L, R, S, R], lrsr(seen).as_ref().map(<[f64; 4]>::as_slice), true);
    }
}

/// Length of the shortest curve from `start` to `goal`, in turning radii.
pub fn distance(start: &Place, goal: &Place) -> f64 {
    let (x, y, turn) = start.towards(goal);
    let mut least = f64::INFINITY;
    words(Sight::new(x, y, turn), &mut |_, lengths| {
        least = least.min(lengths.iter().map(|length| length.abs()).sum());
    });
    least
}

/// Every word's curve from `start` to `goal`, appended to `curves`.
pub fn curves(start: &Place, goal: &Place, curves: &mut Vec<Curve>) {
    let (x, y, turn) = start.towards(goal);
    words(Sight::new(x, y, turn), &mut |steers, lengths| {
        let mut segments = [Segment { steer: S, length: 0.0 }; 5];
        for (segment, (steer, length)) in segments.iter_mut().zip(steers.iter().zip(lengths)) {
            *segment = Segment { steer: *steer, length: *length };
        }
        curves.push(Curve::new(&segments));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number in [0, 1) from a counter; no generator is needed for that.
    fn uniform(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[test]
    fn every_word_ends_at_the_goal() {
        let mut seed = 1;
        let mut all = Vec::new();
        for _ in 0..20_000 {
            let start = Place::new(0.3, -0.2, 9.0 * uniform(&mut seed));
            let goal =
                Place::new(12.0 * uniform(&mut seed) - 6.0, 12.0 * uniform(&mut seed) - 6.0, 9.0 * uniform(&mut seed));
            all.clear();
            curves(&start, &goal, &mut all);
            assert!(!all.is_empty());
            for curve in &all {
                let end = curve.end(&start);
                let miss = (end.x - goal.x).hypot(end.y - goal.y) + wrap(end.yaw - goal.yaw).abs();
                assert!(miss < 1e-6, "{curve:?} misses by {miss}");
            }
            let least = all.iter().map(Curve::length).fold(f64::INFINITY, f64::min);
            assert!((least - distance(&start, &goal)).abs() < 1e-9);
            assert!(least >= (goal.x - start.x).hypot(goal.y - start.y) - 1e-9);
        }
    }

    #[test]
    fn distance_is_a_metric_that_knows_symmetry() {
        let mut seed = 2;
        let mut place = || Place::new(8.0 * uniform(&mut seed), 8.0 * uniform(&mut seed), 7.0 * uniform(&mut seed));
        for _ in 0..5_000 {
            let (a, b, c) = (place(), place(), place());
            assert!((distance(&a, &b) - distance(&b, &a)).abs() < 1e-9);
            assert!(distance(&a, &c) <= distance(&a, &b) + distance(&b, &c) + 1e-9);
        }
    }

    #[test]
    fn known_lengths() {
        let at = |x, y, yaw| distance(&Place::new(0.0, 0.0, 0.0), &Place::new(x, y, yaw));
        assert!((at(5.0, 0.0, 0.0) - 5.0).abs() < 1e-12);
        assert!((at(-5.0, 0.0, 0.0) - 5.0).abs() < 1e-12);
        assert!((at(1.0, 1.0, FRAC_PI_2) - FRAC_PI_2).abs() < 1e-12);
        // turning about on the spot: three arcs of π/3
        assert!((at(0.0, 0.0, PI) - PI).abs() < 1e-9);
    }
}
