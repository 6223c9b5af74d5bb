//! The curves by which a body can go from one place to another, by the way it drives.

use std::f64::consts::PI;

use super::curve::{Curve, Place, Segment, Steer, wrap};
use super::{dubins, reeds_shepp};
use crate::instance::Drive;

/// Curves from `start` to `goal` among no obstacles, appended to `all`.
pub(super) fn curves(drive: Drive, start: &Place, goal: &Place, all: &mut Vec<Curve>) {
    match drive {
        Drive::Car => reeds_shepp::curves(start, goal, all),
        Drive::ForwardCar => dubins::curves(start, goal, all),
        Drive::Differential => {
            for backwards in [false, true] {
                all.push(turn_drive_turn(start, goal, backwards));
            }
        }
    }
}

/// Length that no way from `start` to `goal` undercuts, turns in place counting their angle.
pub(super) fn distance(drive: Drive, start: &Place, goal: &Place) -> f64 {
    match drive {
        Drive::Car => reeds_shepp::distance(start, goal),
        Drive::ForwardCar => dubins::distance(start, goal),
        // what is driven and what is turned add up
        Drive::Differential => (goal.x - start.x).hypot(goal.y - start.y) + wrap(goal.yaw - start.yaw).abs(),
    }
}

fn turn_drive_turn(start: &Place, goal: &Place, backwards: bool) -> Curve {
    let (dx, dy) = (goal.x - start.x, goal.y - start.y);
    let apart = dx.hypot(dy);
    if apart < 1e-9 {
        return Curve::new(&[Segment { steer: Steer::Spin, length: wrap(goal.yaw - start.yaw) }]);
    }
    let heading = dy.atan2(dx) + if backwards { PI } else { 0.0 };
    Curve::new(&[
        Segment { steer: Steer::Spin, length: wrap(heading - start.yaw) },
        Segment { steer: Steer::Straight, length: if backwards { -apart } else { apart } },
        Segment { steer: Steer::Spin, length: wrap(goal.yaw - heading) },
    ])
}
