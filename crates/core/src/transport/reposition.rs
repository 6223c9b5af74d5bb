//! Back to the slot: turn parallel to the edge, drive along it, turn to face it, creep up to it.
//!
//! # Source
//! [R2P2] §IV: "first rotates so that it is parallel to the edge, then it translates back to its original position. Finally,
//! it reorients itself perpendicular to the nearest box-edge." Thresholds and speeds are not given there.
//!
//! # Deviations
//! - Forward or in reverse, whichever turns less.
//! - A last phase creeps up to the edge, because the paper leaves the distance from it to chance. It never retreats: on a
//!   slope the load would follow.
//! - Phases that nothing calls for are skipped, and a manoeuvre ends after [`Repositioning::timeout`].
//!
//! [R2P2]: crate::_documentation::references

use crate::control::{Command, Phase};
use crate::se2::{Pose2, position, wrap_angle, yaw};
use crate::transport::formation::Slot;

/// Thresholds and speeds of the manoeuvre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repositioning {
    /// Heading error that ends a turn parallel to the edge, rad.
    pub parallel: f64,
    /// Heading error that ends the turn to the edge, rad.
    pub facing: f64,
    /// Distance along the edge that ends the drive, m.
    pub tangential: f64,
    /// Distance to the wanted gap that ends the approach, m.
    pub gap: f64,
    /// Highest speed along the edge, m/s.
    pub speed: f64,
    /// Longest manoeuvre, s.
    pub timeout: f64,
}

impl Default for Repositioning {
    fn default() -> Self {
        Self { parallel: 0.05, facing: 0.04, tangential: 0.01, gap: 0.01, speed: 0.2, timeout: 20.0 }
    }
}

/// Where a robot is relative to its slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Along the slot's tangent, m.
    pub tangential: f64,
    /// Distance between body and edge, m.
    pub gap: f64,
    /// Heading minus facing, (−π, π], rad.
    pub heading: f64,
}

impl Deviation {
    /// Where a robot of `radius` m at `load_from_robot` is relative to `slot`.
    pub fn new(slot: &Slot, radius: f64, load_from_robot: &Pose2) -> Self {
        let in_load = position(load_from_robot);
        let facing = slot.facing;
        Self {
            tangential: slot.tangent().dot(&(in_load - slot.contact)),
            gap: facing.dot(&(slot.contact - in_load)) - radius,
            heading: wrap_angle(yaw(load_from_robot) - facing.y.atan2(facing.x)),
        }
    }
}

/// Lowest speed that the truncation of commands leaves effective, m/s and rad/s.
const CREEP: f64 = 0.02;
/// Gain of turns and of the drive along the edge, 1/s.
const GAIN: f64 = 2.0;

impl Repositioning {
    /// The first phase of a manoeuvre that starts at `deviation`.
    pub fn first_phase(&self, deviation: &Deviation) -> Phase {
        if deviation.tangential.abs() > self.tangential { Phase::TurnParallel } else { Phase::TurnFacing }
    }

    /// Phase and command of one tick. `wanted_gap` is the slot's gap, m; [`Phase::Work`] means the manoeuvre is over. A robot
    /// that works parallel to the edge (`stays_parallel`) is done at the end of its drive along it.
    pub fn step(
        &self,
        mut phase: Phase,
        deviation: &Deviation,
        wanted_gap: f64,
        stays_parallel: bool,
    ) -> (Phase, Command) {
        if phase == Phase::TurnParallel {
            let error = self.parallel_error(deviation);
            if error.abs() > self.parallel {
                return (phase, turn(error));
            }
            phase = Phase::Slide;
        }
        if phase == Phase::Slide {
            if deviation.tangential.abs() > self.tangential {
                let error = self.parallel_error(deviation);
                // the tangent is a quarter turn clockwise from the facing: towards it means heading −π/2
                let along_tangent = if deviation.heading < 0.0 { 1.0 } else { -1.0 };
                let wanted = -GAIN * deviation.tangential;
                let speed = wanted.signum() * wanted.abs().clamp(CREEP, self.speed);
                return (phase, Command::drive(along_tangent * speed, GAIN * error));
            }
            if stays_parallel {
                return (Phase::Work, Command::STOP);
            }
            phase = Phase::TurnFacing;
        }
        if phase == Phase::TurnFacing {
            if deviation.heading.abs() > self.facing {
                return (phase, turn(-deviation.heading));
            }
            phase = Phase::Approach;
        }
        let ahead = deviation.gap - wanted_gap;
        if phase == Phase::Approach && ahead > self.gap {
            let linear = (GAIN * ahead).clamp(CREEP, self.speed / 2.0);
            return (phase, Command::drive(linear, -GAIN * deviation.heading));
        }
        (Phase::Work, Command::STOP)
    }

    /// Angle to the nearer of the two headings parallel to the edge, rad.
    fn parallel_error(&self, deviation: &Deviation) -> f64 {
        let quarter = std::f64::consts::FRAC_PI_2;
        let parallel = if deviation.heading < 0.0 { -quarter } else { quarter };
        wrap_angle(parallel - deviation.heading)
    }
}

/// A turn on the spot by `error` rad.
fn turn(error: f64) -> Command {
    Command::drive(0.0, error.signum() * (GAIN * error.abs()).clamp(2.0 * CREEP, 1.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The manoeuvre ends in the slot, wherever it starts, for an ideal unicycle beside a resting load.
    #[test]
    fn every_start_ends_in_the_slot() {
        let manoeuvre = Repositioning::default();
        let wanted_gap = 0.01;
        for i in 0..200 {
            let a = f64::from(i) * 0.618_034;
            let mut deviation = Deviation {
                tangential: 0.4 * a.sin(),
                gap: 0.06 + 0.05 * (1.7 * a).cos(),
                heading: wrap_angle(2.6 * a),
            };
            let mut phase = manoeuvre.first_phase(&deviation);
            let mut ticks = 0;
            while phase != Phase::Work {
                let (next, command) = manoeuvre.step(phase, &deviation, wanted_gap, false);
                phase = next;
                deviation.heading = wrap_angle(deviation.heading + command.angular * 0.05);
                deviation.tangential -= command.linear * deviation.heading.sin() * 0.05;
                deviation.gap -= command.linear * deviation.heading.cos() * 0.05;
                ticks += 1;
                assert!(ticks < 400, "{i}: {phase:?} {deviation:?}");
            }
            assert!(deviation.tangential.abs() < 0.02, "{i}: {deviation:?}");
            assert!(deviation.heading.abs() < 0.1, "{i}: {deviation:?}");
        }
    }
}
