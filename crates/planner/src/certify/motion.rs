//! What lies between two poses, computed from them alone.
//!
//! A body that keeps its velocity in its own frame for one step goes through p(u) = p₀ + u · sinc(½ u φ) · R(θ₀ + ½ u φ) v,
//! θ(u) = θ₀ + u φ for u from 0 to 1. Velocity v and turn φ follow from the two poses: the chord, seen from the heading
//! halfway, is sinc(½ φ) · v. Where v points along the body the way is an arc or a straight line.

use std::f64::consts::{FRAC_PI_2, PI};

use cohaul_core::se2::{Pose2, cross, position, rotate, unit, wrap_angle, yaw};
use nalgebra::Vector2;

/// Motion from one pose to the next in one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    from: Vector2<f64>,
    heading: f64,
    /// In the body's frame, m per step: along it and to its left.
    pub velocity: Vector2<f64>,
    /// rad per step, in (−π, π].
    pub turn: f64,
}

/// sin(x) / x.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

impl Motion {
    pub(super) fn between(from: &Pose2, to: &Pose2) -> Self {
        let (start, heading) = (position(from), yaw(from));
        let turn = wrap_angle(yaw(to) - heading);
        let half = unit(heading + 0.5 * turn);
        let chord = position(to) - start;
        let stretch = 1.0 / sinc(0.5 * turn);
        let velocity = stretch * Vector2::new(half.dot(&chord), cross(&half, &chord));
        Self { from: start, heading, velocity, turn }
    }

    /// Stays in this pose.
    pub(super) fn rest(pose: &Pose2) -> Self {
        Self { from: position(pose), heading: yaw(pose), velocity: Vector2::zeros(), turn: 0.0 }
    }

    /// Length of the way.
    pub(super) fn length(&self) -> f64 {
        self.velocity.norm()
    }

    /// Reference point and heading at `share` of the step.
    pub(super) fn at(&self, share: f64) -> (Vector2<f64>, f64) {
        let (sin, cos) = (self.heading + 0.5 * share * self.turn).sin_cos();
        let gone = share * sinc(0.5 * share * self.turn) * rotate(&self.velocity, sin, cos);
        (self.from + gone, self.heading + share * self.turn)
    }

    /// Least and greatest coordinates of the reference point on its way, and when they are reached: for x, then for y.
    pub(super) fn extremes(&self) -> [[(f64, f64); 2]; 2] {
        let ends = [(0.0, self.at(0.0).0), (1.0, self.at(1.0).0)];
        let mut extremes = [[(0.0, f64::INFINITY), (0.0, f64::NEG_INFINITY)]; 2];
        let mut add = |share: f64, point: Vector2<f64>| {
            for axis in 0..2 {
                let [low, high] = &mut extremes[axis];
                if point[axis] < low.1 {
                    *low = (share, point[axis]);
                }
                if point[axis] > high.1 {
                    *high = (share, point[axis]);
                }
            }
        };
        ends.iter().for_each(|(share, point)| add(*share, *point));
        if self.turn != 0.0 {
            // where the velocity is along an axis: its direction is a multiple of a quarter turn
            let first = self.heading + self.velocity.y.atan2(self.velocity.x);
            let (low, high) = (first.min(first + self.turn), first.max(first + self.turn));
            let mut quarter = (low / FRAC_PI_2).ceil();
            while quarter * FRAC_PI_2 <= high {
                let share = ((quarter * FRAC_PI_2 - first) / self.turn).clamp(0.0, 1.0);
                add(share, self.at(share).0);
                quarter += 1.0;
            }
        }
        debug_assert!(self.turn.abs() <= PI);
        extremes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul_core::se2::pose;

    /// Quarter circle of radius 3 to the left: length 3 π / 2, through (3 sin 45°, 3 (1 − cos 45°)).
    #[test]
    fn a_quarter_circle_is_one() {
        let motion = Motion::between(&pose(0.0, 0.0, 0.0), &pose(3.0, 3.0, FRAC_PI_2));
        assert!((motion.length() - 3.0 * FRAC_PI_2).abs() < 1e-12); // rounding only, here and below
        assert!(motion.velocity.y.abs() < 1e-12);
        let (middle, heading) = motion.at(0.5);
        let root = 3.0 * std::f64::consts::FRAC_1_SQRT_2;
        assert!((middle - Vector2::new(root, 3.0 - root)).norm() < 1e-12);
        assert!((heading - 0.25 * PI).abs() < 1e-12);
    }

    #[test]
    fn the_ends_are_the_poses() {
        for (x, y, turn) in [(1.0, 2.0, 3.0), (-4.0, 0.5, -2.9), (0.0, 0.0, 1.0), (2.0, 0.0, 0.0), (0.0, 1.0, 1e-9)] {
            let (from, to) = (pose(5.0, -3.0, 3.0), pose(5.0 + x, -3.0 + y, 3.0 + turn));
            let motion = Motion::between(&from, &to);
            assert!((motion.at(0.0).0 - position(&from)).norm() < 1e-12);
            assert!((motion.at(1.0).0 - position(&to)).norm() < 1e-12, "{x} {y} {turn}");
            assert!(wrap_angle(motion.at(1.0).1 - yaw(&to)).abs() < 1e-12);
        }
    }

    /// Half a circle of radius 1 upwards from (0, 0): it bulges out to x = 1, and ends above where it began.
    #[test]
    fn a_bulge_between_two_poses_is_seen() {
        let motion = Motion::between(&pose(0.0, 0.0, 0.0), &pose(0.0, 2.0, PI));
        let [[low, high], _] = motion.extremes();
        assert!((high.1 - 1.0).abs() < 1e-12 && (high.0 - 0.5).abs() < 1e-12);
        assert!(low.1.abs() < 1e-12);
    }
}
