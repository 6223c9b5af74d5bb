//! Whether two bodies that move on arcs meet within a step.
//!
//! # Source
//! Conservative advancement: from a time at which the bodies are known to be apart, go on by as much as they cannot meet
//! in. The bound on the motion is of second order along one direction that separates them: a point of a body that keeps
//! velocity v and turn φ in its own frame has the acceleration |φ| |v + φ × r| and no more, so the gap of two points along
//! the direction after δ is at least f + f′ δ − ½ M δ². Touching bodies that slide along each other therefore do not stop
//! it, as a bound on the speed alone would.
//!
//! Convex polygons are apart exactly when they are along the normal of a side of one of them. When they are, their
//! distance is that gap, or that of two corners; otherwise the greatest such gap is minus the depth of their overlap.

use cohaul_core::se2::{perpendicular, rotate};
use nalgebra::Vector2;

use super::motion::Motion;

/// Most advances within one step.
const ADVANCES_MAX: u32 = 20_000;
/// Times at which the depth of an overlap is looked for once there is one.
const LOOKS: u32 = 64;

/// A convex body on its way; one corner is a point.
pub(super) struct Moving<'a> {
    pub motion: Motion,
    /// Corners in the body's frame, counter-clockwise.
    pub corners: &'a [Vector2<f64>],
}

/// What came out of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meeting {
    /// Nowhere deeper than allowed.
    Apart,
    /// They overlap.
    Overlap {
        /// First time seen, share of the step.
        at: f64,
        /// Deepest overlap that was seen in the step, m.
        depth: f64,
    },
    /// They are so close for so long that it could not be decided.
    Undecided {
        /// From here on, share of the step.
        at: f64,
    },
}

/// A corner at one time.
#[derive(Clone, Copy)]
struct Corner {
    point: Vector2<f64>,
    velocity: Vector2<f64>,
}

/// A body at one time.
struct Placed {
    corners: Vec<Corner>,
}

impl Moving<'_> {
    fn place(&self, share: f64, placed: &mut Placed) {
        let (reference, heading) = self.motion.at(share);
        let (sin, cos) = heading.sin_cos();
        let speed = rotate(&self.motion.velocity, sin, cos);
        placed.corners.clear();
        placed.corners.extend(self.corners.iter().map(|corner| {
            let arm = rotate(corner, sin, cos);
            Corner { point: reference + arm, velocity: speed + self.motion.turn * perpendicular(&arm) }
        }));
    }

    /// No corner accelerates more than this, m per step².
    fn acceleration(&self) -> f64 {
        let reach = self.corners.iter().map(Vector2::norm).fold(0.0, f64::max);
        self.motion.turn.abs() * (self.motion.length() + self.motion.turn.abs() * reach)
    }
}

/// How far two bodies are apart: a direction from the first to the second, and the gap along it; a negative one is the depth
/// of their overlap.
struct Gap {
    direction: Vector2<f64>,
    width: f64,
}

fn gap(first: &[Corner], second: &[Corner]) -> Gap {
    let mut best = Gap { direction: Vector2::x(), width: f64::NEG_INFINITY };
    let mut consider = |direction: Vector2<f64>| {
        let near = second.iter().map(|c| direction.dot(&c.point)).fold(f64::INFINITY, f64::min);
        let far = first.iter().map(|c| direction.dot(&c.point)).fold(f64::NEG_INFINITY, f64::max);
        if near - far > best.width {
            best = Gap { direction, width: near - far };
        }
    };
    for (corners, sign) in [(first, 1.0), (second, -1.0)] {
        for (index, corner) in corners.iter().enumerate() {
            let along = corners[(index + 1) % corners.len()].point - corner.point;
            // corners are counter-clockwise: outside is on the right
            if let Some(outward) = (-perpendicular(&along)).try_normalize(0.0) {
                consider(sign * outward);
            }
        }
    }
    let mut nearest: Option<(f64, Vector2<f64>)> = None;
    for a in first {
        for b in second {
            let between = b.point - a.point;
            let distance = between.norm_squared();
            if nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, between));
            }
        }
    }
    if let Some(direction) = nearest.and_then(|(_, between)| between.try_normalize(0.0)) {
        consider(direction);
    }
    best
}

/// How long the bodies stay apart by more than −`depth` along `direction`, in steps.
fn safe(first: &[Corner], second: &[Corner], direction: &Vector2<f64>, acceleration: f64, depth: f64) -> f64 {
    let mut least = f64::INFINITY;
    for a in first {
        for b in second {
            let room = direction.dot(&(b.point - a.point)) + depth;
            let rate = direction.dot(&(b.velocity - a.velocity));
            let root = (rate * rate + 2.0 * acceleration * room.max(0.0)).sqrt();
            // the same root of the parabola, written so that nothing cancels
            let time = if rate < 0.0 {
                2.0 * room / (root - rate)
            } else if acceleration > 0.0 {
                (rate + root) / acceleration
            } else {
                f64::INFINITY
            };
            least = least.min(time);
        }
    }
    least
}

/// Depth by which the bodies overlap at `share` of the step; negative where they are apart.
pub(super) fn overlap(first: &Moving<'_>, second: &Moving<'_>, share: f64) -> f64 {
    let (mut a, mut b) = (Placed { corners: Vec::new() }, Placed { corners: Vec::new() });
    first.place(share, &mut a);
    second.place(share, &mut b);
    -gap(&a.corners, &b.corners).width
}

/// Whether the bodies overlap anywhere in the step. An overlap deeper than `depth` is always found, one shallower than half of
/// it never. Counts the looks at both bodies onto `looked`.
pub(super) fn meeting(first: &Moving<'_>, second: &Moving<'_>, depth: f64, looked: &mut u64) -> Meeting {
    let acceleration = first.acceleration() + second.acceleration();
    let (mut a, mut b) = (Placed { corners: Vec::new() }, Placed { corners: Vec::new() });
    let mut share = 0.0;
    for _ in 0..ADVANCES_MAX {
        *looked += 1;
        first.place(share, &mut a);
        second.place(share, &mut b);
        let gap = gap(&a.corners, &b.corners);
        if gap.width < -0.5 * depth {
            *looked += u64::from(LOOKS) + 1;
            let deepest = (0..=LOOKS)
                .map(|look| overlap(first, second, share + (1.0 - share) * f64::from(look) / f64::from(LOOKS)))
                .fold(-gap.width, f64::max);
            return Meeting::Overlap { at: share, depth: deepest };
        }
        if share >= 1.0 {
            return Meeting::Apart;
        }
        let next = share + safe(&a.corners, &b.corners, &gap.direction, acceleration, depth);
        // too small to be seen
        if next.is_nan() || next <= share {
            return Meeting::Undecided { at: share };
        }
        if next > 1.0 {
            return Meeting::Apart;
        }
        share = next;
    }
    Meeting::Undecided { at: share }
}
