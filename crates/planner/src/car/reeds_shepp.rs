//! Shortest curves of a car that drives both ways, no tighter than its turning radius, among no obstacles.
//!
//! # Source
//! [ReedsShepp1990] §8, formulas 8.1–8.11: nine families of words, each with its mirror images in time, left–right, and order. `φ` → `turn`,
//! `t, u, v` as printed. A shortest curve is always among them.
//!
//! # Deviations
//! - Bearings are computed once per turning circle and carried over to the mirror images; 8.11 is written with them.
//! - All words are given, not only the shortest: where a robot is in the way, the next one may be free.
//!
//! [ReedsShepp1990]: cohaul_core::_documentation::references

use std::f64::consts::{FRAC_PI_2, PI};

use super::curve::{Curve, Place, Segment, Steer, wrap};

/// Slack in the signs of lengths, so that rounding does not lose a word that ends exactly at a boundary.
const SLACK: f64 = 1e-10;

const L: Steer = Steer::Left;
const R: Steer = Steer::Right;
const S: Steer = Steer::Straight;

/// The shapes of words before any mirroring; the last three also occur in the reverse order.
const SHAPES: [&[Steer]; 11] = [
    &[L, S, L],
    &[L, S, R],
    &[L, R, L],
    &[L, R, L, R],
    &[L, R, L, R],
    &[L, R, S, L],
    &[L, R, S, R],
    &[L, R, S, L, R],
    &[L, R, L],
    &[L, S, R, L],
    &[R, S, R, L],
];

/// A word: its shape, whether left and right are exchanged, and its lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word {
    shape: u8,
    mirrored: bool,
    lengths: [f64; 5],
}

impl Word {
    /// The segments' steering and lengths.
    pub(super) fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        SHAPES[usize::from(self.shape)].iter().zip(&self.lengths).map(|(steer, length)| {
            let steer = match (steer, self.mirrored) {
                (Steer::Left, true) => Steer::Right,
                (Steer::Right, true) => Steer::Left,
                (same, _) => *same,
            };
            Segment { steer, length: *length }
        })
    }

    /// Lengths only; those beyond the last segment are 0.
    pub(super) const fn lengths(&self) -> &[f64; 5] {
        &self.lengths
    }

    /// Whether segment `i` is straight.
    #[inline]
    pub(super) fn is_straight(&self, i: usize) -> bool {
        SHAPES[usize::from(self.shape)].get(i) == Some(&S)
    }

    /// The word as a curve.
    pub(super) fn curve(&self) -> Curve {
        let mut segments = [Segment { steer: S, length: 0.0 }; 5];
        for (slot, segment) in segments.iter_mut().zip(self.segments()) {
            *slot = segment;
        }
        Curve::new(&segments)
    }
}

/// Centre of the goal's turning circle as seen from that of the start: (ξ, η), its distance squared and its bearing.
#[derive(Clone, Copy)]
struct Centre {
    xi: f64,
    eta: f64,
    square: f64,
    bearing: f64,
}

impl Centre {
    fn new(xi: f64, eta: f64) -> Self {
        Self { xi, eta, square: xi * xi + eta * eta, bearing: eta.atan2(xi) }
    }

    /// For driving in the other gear.
    fn backwards(self) -> Self {
        Self { xi: -self.xi, bearing: wrap(PI - self.bearing), ..self }
    }
}

/// 8.1, L+ S+ L+.
fn lsl(same: Centre, turn: f64) -> Option<[f64; 5]> {
    let t = same.bearing;
    if t < -SLACK {
        return None;
    }
    let v = wrap(turn - t);
    (v >= -SLACK).then(|| [t, same.square.sqrt(), v, 0.0, 0.0])
}

/// 8.2, L+ S+ R+.
fn lsr(other: Centre, turn: f64) -> Option<[f64; 5]> {
    if other.square < 4.0 {
        return None;
    }
    let u = (other.square - 4.0).sqrt();
    let t = wrap(other.bearing + 2.0_f64.atan2(u));
    if t < -SLACK {
        return None;
    }
    let v = wrap(t - turn);
    (v >= -SLACK).then_some([t, u, v, 0.0, 0.0])
}

/// 8.3 and 8.4, L+ R− L with the last arc in either gear.
fn lrl(same: Centre, turn: f64) -> Option<[f64; 5]> {
    if same.square > 16.0 {
        return None;
    }
    let u = -2.0 * (0.25 * same.square.sqrt()).asin();
    let t = wrap(same.bearing + 0.5 * u + PI);
    let v = wrap(turn - t + u);
    (t >= -SLACK && u <= SLACK).then_some([t, u, v, 0.0, 0.0])
}

/// The first and the last arc of a word of four, τ and ω.
fn outer(u: f64, v: f64, other: Centre, turn: f64) -> (f64, f64) {
    let delta = wrap(u - v);
    let a = u.sin() - delta.sin();
    let b = u.cos() - delta.cos() - 1.0;
    let t = (other.eta * a - other.xi * b).atan2(other.xi * a + other.eta * b);
    let side = 2.0 * (delta.cos() - v.cos() - u.cos()) + 3.0;
    let tau = if side < 0.0 { wrap(t + PI) } else { t };
    (tau, wrap(tau - u + v - turn))
}

/// 8.7, L+ R+ L− R−, both middle arcs equally long.
fn lrlr_turned(other: Centre, turn: f64) -> Option<[f64; 5]> {
    if other.square > 4.0 {
        return None;
    }
    let u = (0.25 * (2.0 + other.square.sqrt())).min(1.0).acos();
    let (t, v) = outer(u, -u, other, turn);
    (t >= -SLACK && v <= SLACK).then_some([t, u, -u, v, 0.0])
}

/// 8.8, L+ R− L− R+, both middle arcs equally long.
fn lrlr_between(other: Centre, turn: f64) -> Option<[f64; 5]> {
    let rho = (20.0 - other.square) / 16.0;
    if !(0.0..=1.0).contains(&rho) {
        return None;
    }
    let u = -rho.acos();
    let (t, v) = outer(u, u, other, turn);
    (t >= -SLACK && v >= -SLACK).then_some([t, u, u, v, 0.0])
}

/// 8.9, L+ R−π/2 S− L−.
fn lrsl(same: Centre, turn: f64) -> Option<[f64; 5]> {
    // the straight piece is driven backwards: r is at least 2
    if same.square < 8.0 - SLACK {
        return None;
    }
    let r = (same.square - 4.0).sqrt();
    let u = (2.0 - r).min(0.0);
    let t = wrap(same.bearing + FRAC_PI_2 + 2.0_f64.atan2(r));
    if t < -SLACK {
        return None;
    }
    let v = wrap(turn - FRAC_PI_2 - t);
    (v <= SLACK).then_some([t, -FRAC_PI_2, u, v, 0.0])
}

/// 8.10, L+ R−π/2 S− R−.
fn lrsr(other: Centre, turn: f64) -> Option<[f64; 5]> {
    if other.square < 4.0 {
        return None;
    }
    let t = wrap(other.bearing + FRAC_PI_2);
    if t < -SLACK {
        return None;
    }
    let u = 2.0 - other.square.sqrt();
    let v = wrap(t + FRAC_PI_2 - turn);
    (v <= SLACK).then_some([t, -FRAC_PI_2, u, v, 0.0])
}

/// 8.11, L+ R−π/2 S− L−π/2 R+.
fn lrslr(other: Centre, turn: f64) -> Option<[f64; 5]> {
    let square = other.square;
    if square < 20.0 - SLACK {
        return None;
    }
    let u = (4.0 - (square - 4.0).sqrt()).min(0.0);
    // the bearing of (−2 ξ − (4 − u) η, (4 − u) ξ − 2 η), which is (−2 + (4 − u) i) (ξ + η i)
    let t = wrap(other.bearing + FRAC_PI_2 + 2.0_f64.atan2(4.0 - u));
    if t < -SLACK {
        return None;
    }
    let v = wrap(t - turn);
    (v >= -SLACK).then_some([t, -FRAC_PI_2, u, -FRAC_PI_2, v])
}

/// Calls `found` with every word that leads to (x, y, turn) as seen from the start.
#[inline]
pub(super) fn words(x: f64, y: f64, turn: f64, mut found: impl FnMut(Word)) {
    let (sin, cos) = turn.sin_cos();
    for mirrored in [false, true] {
        // left and right exchanged
        let (y, turn, sin) = if mirrored { (-y, -turn, -sin) } else { (y, turn, sin) };
        // start and goal exchanged
        let (rx, ry) = (x * cos + y * sin, x * sin - y * cos);
        let centres = [
            Centre::new(x - sin, y - 1.0 + cos),
            Centre::new(x + sin, y - 1.0 - cos),
            Centre::new(rx - sin, ry - 1.0 + cos),
            Centre::new(rx + sin, ry - 1.0 - cos),
        ];
        for backwards in [false, true] {
            // driven in the other gear
            let turn = if backwards { -turn } else { turn };
            let [same, other, same_reversed, other_reversed] =
                if backwards { centres.map(Centre::backwards) } else { centres };
            let mut give = |shape: u8, lengths: Option<[f64; 5]>, count: usize| {
                if let Some(mut lengths) = lengths {
                    if shape >= 8 {
                        lengths[..count].reverse();
                    }
                    if backwards {
                        lengths = lengths.map(|length| -length);
                    }
                    found(Word { shape, mirrored, lengths });
                }
            };
            give(0, lsl(same, turn), 3);
            give(1, lsr(other, turn), 3);
            give(2, lrl(same, turn), 3);
            give(3, lrlr_turned(other, turn), 4);
            give(4, lrlr_between(other, turn), 4);
            give(5, lrsl(same, turn), 4);
            give(6, lrsr(other, turn), 4);
            give(7, lrslr(other, turn), 5);
            give(8, lrl(same_reversed, turn), 3);
            give(9, lrsl(same_reversed, turn), 4);
            give(10, lrsr(other_reversed, turn), 4);
        }
    }
}

/// Length of the shortest curve from `start` to `goal`, in turning radii.
pub fn distance(start: &Place, goal: &Place) -> f64 {
    let (x, y, turn) = start.towards(goal);
    let mut least = f64::INFINITY;
    words(x, y, turn, |word| {
        least = least.min(word.lengths.iter().map(|length| length.abs()).sum());
    });
    least
}

/// Every word's curve from `start` to `goal`, appended to `curves`.
pub fn curves(start: &Place, goal: &Place, curves: &mut Vec<Curve>) {
    let (x, y, turn) = start.towards(goal);
    words(x, y, turn, |word| curves.push(word.curve()));
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
