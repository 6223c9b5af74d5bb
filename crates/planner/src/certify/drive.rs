//! What a vehicle can do in one step, and what its way counts.

use std::f64::consts::FRAC_PI_2;

use cohaul_core::se2::{Pose2, position};

use super::claims::Range;
use super::motion::Motion;
use crate::instance::{Drive, Vehicle};
use crate::plan::Route;

/// By how much poses may be off wherever they come from, m and rad.
const LEAST: f64 = 1e-6;
/// Digits with which plans count as printed rather than as exact.
const FEWEST_DIGITS: i32 = 6;
const MOST_DIGITS: i32 = 9;
/// Half a unit of the sixth digit of a yaw, which is at most a few radians.
const PRINTED_ANGLE: f64 = 5e-6;

/// By how much the poses of a plan may be off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerance {
    /// m.
    pub position: f64,
    /// rad.
    pub angle: f64,
    /// Whether the plan was printed with few digits.
    pub is_printed: bool,
}

impl Tolerance {
    /// From the coordinates of a plan, whose numbers are finite.
    pub(super) fn of(routes: &[Option<&Route<Pose2>>]) -> Self {
        let mut largest = 0.0_f64;
        let mut digits = FEWEST_DIGITS;
        for pose in routes.iter().flatten().flat_map(|route| &route.states) {
            for value in position(pose).iter() {
                let again = |digits: i32| format!("{value:.*e}", digits as usize - 1).parse().ok() == Some(*value);
                while !again(digits) {
                    digits += 1;
                    if digits > MOST_DIGITS {
                        return Self { position: LEAST, angle: LEAST, is_printed: false };
                    }
                }
                largest = largest.max(value.abs());
            }
        }
        // 123.456 has its first digit at 10², its sixth at 10⁻³
        let last = if largest > 0.0 { 10_f64.powf(largest.log10().floor() - f64::from(digits - 1)) } else { 0.0 };
        let angle = PRINTED_ANGLE * 0.1_f64.powi(digits - FEWEST_DIGITS);
        Self { position: LEAST + 0.5 * last, angle: LEAST + angle, is_printed: true }
    }

    /// Depth to which bodies may overlap that reach this far from their reference points, m.
    pub(super) fn depth(&self, reach: f64) -> f64 {
        if self.is_printed { LEAST + 2.0 * (self.position + reach * self.angle) } else { LEAST }
    }

    /// Whether two poses are the same.
    pub(super) fn is_same(&self, one: &Pose2, other: &Pose2) -> bool {
        (position(one) - position(other)).norm() <= 2.0 * self.position
            && one.rotation.angle_to(&other.rotation).abs() <= 2.0 * self.angle
    }
}

/// What is wrong with a step.
pub(super) enum Fault {
    /// It cannot be made.
    Impossible(String),
    /// Only a vehicle that reverses could make it.
    Backwards(f64),
}

/// What a step is, with the distances below which nothing can be told from nothing.
struct Kind {
    is_wait: bool,
    is_in_place: bool,
    turns: bool,
    /// m.
    slack: f64,
    /// rad.
    angle: f64,
}

fn kind(motion: &Motion, tolerance: &Tolerance) -> Kind {
    let angle = 2.0 * tolerance.angle;
    // the chord is stretched by up to π/2, and its direction is as uncertain as the headings
    let slack = 2.0 * FRAC_PI_2 * tolerance.position + motion.length() * angle;
    let (is_in_place, turns) = (motion.length() <= slack, motion.turn.abs() > angle);
    Kind { is_wait: is_in_place && !turns, is_in_place, turns, slack, angle }
}

/// What is wrong with `motion` for `vehicle`, if anything is.
pub(super) fn fault(vehicle: &Vehicle, motion: &Motion, tolerance: &Tolerance) -> Option<Fault> {
    let Kind { is_wait, is_in_place, turns, slack, angle } = kind(motion, tolerance);
    if is_wait {
        return None;
    }
    let (length, turn, longest) = (motion.length(), motion.turn.abs(), vehicle.step_length());
    if vehicle.drive == Drive::Differential && is_in_place {
        return (turn > vehicle.step_angle + angle).then(|| {
            Fault::Impossible(format!("turns in place by {turn:.6} rad, more than {:.6}", vehicle.step_angle))
        });
    }
    if motion.velocity.y.abs() > slack {
        return Some(Fault::Impossible(format!(
            "moves sideways by {:.6} m: no arc leads there",
            motion.velocity.y.abs()
        )));
    }
    if length > longest + slack {
        return Some(Fault::Impossible(format!("goes {length:.6} m, further than {longest:.6}")));
    }
    match vehicle.drive {
        Drive::Differential if turns => {
            Some(Fault::Impossible(format!("turns by {turn:.6} rad while it goes {length:.6} m")))
        }
        Drive::Differential => None,
        Drive::Car | Drive::ForwardCar if turn > (length + slack) / vehicle.turning_radius + angle => {
            let radius = length / turn;
            Some(Fault::Impossible(format!(
                "turns with a radius of {radius:.6} m, tighter than {}",
                vehicle.turning_radius
            )))
        }
        Drive::ForwardCar if motion.velocity.x < -slack => Some(Fault::Backwards(-motion.velocity.x)),
        Drive::Car | Drive::ForwardCar => None,
    }
}

/// Way and cost of a route.
pub(super) fn way_and_cost(vehicle: &Vehicle, states: &[Pose2], tolerance: &Tolerance) -> (Range, Range) {
    let stays = |pair: &&[Pose2]| pair[0] == pair[1];
    let trailing = states.windows(2).collect::<Vec<_>>().iter().rev().take_while(|pair| stays(pair)).count();
    let (mut way, mut cost) = ((0.0, 0.0), (0.0, 0.0));
    let mut backwards = None;
    for pair in states.windows(2).take((states.len().saturating_sub(1)).saturating_sub(trailing)) {
        let motion = Motion::between(&pair[0], &pair[1]);
        let kind = kind(&motion, tolerance);
        let longest = vehicle.step_length();
        let (mut step, mut factor) = ((motion.length(), motion.length()), 1.0);
        if kind.is_wait {
            // what is not quite nothing may be the last bit of a curve too
            step = (if stays(&pair) { longest } else { motion.length() }, longest);
        } else {
            if kind.turns {
                factor *= vehicle.turning_penalty;
            }
            if kind.is_in_place && vehicle.drive == Drive::Differential {
                let turned = longest * motion.turn.abs() / vehicle.step_angle;
                step = (turned, turned);
            } else {
                let is_reverse = motion.velocity.x < 0.0;
                if is_reverse {
                    factor *= vehicle.reversing_penalty;
                }
                if backwards.is_some_and(|before| before != is_reverse) {
                    factor *= vehicle.switching_penalty;
                }
                backwards = Some(is_reverse);
            }
        }
        way = (way.0 + step.0, way.1 + step.1);
        cost = (cost.0 + step.0 * factor, cost.1 + step.1 * factor);
    }
    if tolerance.is_printed {
        cost.0 = way.0;
    }
    (way, cost)
}
