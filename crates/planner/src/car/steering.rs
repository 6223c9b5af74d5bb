//! The curves by which a body can go from one place to another, by the way it drives.

use std::f64::consts::PI;

use super::curve::{Curve, Place, Segment, Steer, wrap};
use super::field::{Field, Prices};
use super::{dubins, reeds_shepp};
use crate::instance::Drive;

/// Curves that are looked at, the cheapest ones.
pub(super) const SHORT: usize = 4;

/// The cheapest curves, in order.
pub(super) struct Shortlist {
    curves: [(f64, Curve); SHORT],
    count: usize,
}

impl Shortlist {
    pub(super) fn new() -> Self {
        Self { curves: [(f64::INFINITY, Curve::new(&[])); SHORT], count: 0 }
    }

    /// The curves with their prices.
    pub(super) fn as_slice(&self) -> &[(f64, Curve)] {
        &self.curves[..self.count]
    }

    #[inline]
    fn offer(&mut self, price: f64, curve: impl FnOnce() -> Curve) {
        let mut at = self.count;
        while at > 0 && self.curves[at - 1].0 > price {
            at -= 1;
        }
        if at < SHORT {
            self.count = (self.count + 1).min(SHORT);
            self.curves[at..self.count].rotate_right(1);
            self.curves[at] = (price, curve());
        }
    }
}

/// The cheapest curves from `start`, reached in `gear`, to `goal` among no obstacles.
pub(super) fn cheapest(field: &Field, prices: &Prices, gear: i8, start: &Place, goal: &Place) -> Shortlist {
    let mut list = Shortlist::new();
    match field.drive {
        Drive::Car => {
            let (x, y, turn) = start.towards(goal);
            reeds_shepp::words(x, y, turn, |word| {
                let mut price = 0.0;
                let mut gear = gear;
                for (i, length) in word.lengths().iter().enumerate() {
                    if length.abs() > 1e-12 {
                        let piece = field.segment_cost(prices, gear, *length, !word.is_straight(i));
                        price += piece;
                        gear = if *length < 0.0 { -1 } else { 1 };
                    }
                }
                list.offer(price, || word.curve());
            });
        }
        Drive::ForwardCar => dubins::words(start.towards(goal), |steers, lengths| {
            let curve = dubins::curve(steers, lengths);
            list.offer(field.curve_cost(prices, gear, &curve), || curve);
        }),
        Drive::Differential => {
            for backwards in [false, true] {
                let curve = turn_drive_turn(start, goal, backwards);
                list.offer(field.curve_cost(prices, gear, &curve), || curve);
            }
        }
    }
    list
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
