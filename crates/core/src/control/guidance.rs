//! Where the load has to go next: waypoint, primitive, heading error.
//!
//! # Source
//! [R2P2] §IV-A: the load turns towards its waypoint, then moves along its heading. The choice itself is
//! [`primitive::choose`].
//!
//! # Deviations
//! - `drive: nearest` lets the load travel backwards where that needs less turning; the paper always drives heading first.
//! - A goal may have an orientation: within half the tolerance of the goal the load turns on the spot until it has it. The
//!   paper leaves the final orientation to chance.
//! - A waypoint before the goal is passed at 85 % of its tolerance: it stays passed, and poses have noise. The goal does not: a
//!   team that is moved off it goes on.
//! - A waypoint is also passed by a load that came nearly as close some time ago, the sooner the closer it came. Robots look at
//!   the load at different instants: one alone may have seen it within 85 %, and robots that are at odds about the
//!   waypoint push against each other. All have seen nearly the same closest distance, so all pass nearly together,
//!   whatever the load does meanwhile.
//! - A turn under way keeps its sense while the bearing crosses the half turn; the paper does not go beyond 75°.
//!
//! [R2P2]: crate::_documentation::references

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::ControlError;
use crate::kinematics::BaseLimits;
use crate::se2::{Pose2, position, unit, wrap_angle, yaw};
use crate::transport::formation::{Formation, Slot};
use crate::transport::primitive::{self, Primitive, Turn};

/// Heading error beyond a quarter turn at which the load changes which way round it drives, rad.
const TURN_AROUND: f64 = 0.3;
/// Distance from the half turn within which a turn under way keeps its sense, rad.
const HALF_TURN: f64 = 0.6;
/// Share of the tolerance within which a waypoint before the goal is passed: noise must not pass it for a load that never was
/// within the tolerance.
const PASS: f64 = 0.85;
/// Share of the tolerance from which on closeness counts towards passing a waypoint.
const NEAR: f64 = 0.95;
/// Sum over ticks of [`NEAR`] minus the closest distance in tolerances at which a waypoint is passed. At 20 ticks a second: one
/// second after a load came within 90 %, half of it at 85 %. It grows without a step from never: two robots whose closest
/// distances differ by little differ in time by little.
const LINGER: f64 = 1.0;
/// Share of the goal's tolerances that the team aims at before it turns, and with which it is done turning.
const AIM: f64 = 0.5;

/// What one robot is to do in one mission.
#[derive(Clone, Debug)]
pub struct Task<'a> {
    /// The team's slots.
    pub formation: &'a Formation,
    /// The robot's place in the team.
    pub place: usize,
    /// Half the load's extent across its heading, m.
    pub half_length: f64,
    /// Points for the load's centre, world frame, m; the goal is the last.
    pub waypoints: Vec<Vector2<f64>>,
    /// Distance at which one counts as reached, m.
    pub tolerance: f64,
    /// Orientation at the goal, if one is asked for.
    pub goal_yaw: Option<GoalYaw>,
    /// Limits of the robot.
    pub limits: BaseLimits,
}

impl Task<'_> {
    /// The robot's slot.
    ///
    /// # Errors
    /// A place that the formation does not have.
    pub fn slot(&self) -> Result<Slot, ControlError> {
        self.formation.slots().get(self.place).copied().ok_or(ControlError::Parameter {
            parameter: "place",
            value: self.place as f64,
            expected: "a slot of the formation",
        })
    }
}

/// Orientation that a goal asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalYaw {
    /// Heading of the load in the world, rad.
    pub yaw: f64,
    /// How far off it may be, rad.
    pub tolerance: f64,
}

/// The way of one load and how it is followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Guidance {
    /// Points for the load's centre, world frame, m; the goal is the last.
    pub waypoints: Vec<Vector2<f64>>,
    /// Distance at which one counts as reached, m.
    pub tolerance: f64,
    /// Orientation at the goal.
    pub goal_yaw: Option<GoalYaw>,
    /// Heading error that starts a rotation, rad (ε).
    pub threshold: f64,
    /// Heading error that ends a rotation, rad.
    pub release: f64,
    /// Shortest signed angles.
    pub wrap: bool,
    /// Whether the load may travel backwards.
    pub either_way: bool,
}

/// What is remembered from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Next waypoint.
    pub waypoint: u16,
    /// Motion of the last tick.
    pub primitive: Option<Primitive>,
    /// Whether the load travels backwards on this leg; not decided before its first tick.
    pub backwards: Option<bool>,
    /// Whether the load is turning to its final orientation.
    pub aligning: bool,
    /// Closest distance to the waypoint so far, m.
    #[serde(default)]
    pub closest: Option<f64>,
    /// How long and how closely the load has been near the waypoint, in tolerances × ticks.
    #[serde(default)]
    pub lingered: f64,
}

/// The motion that comes next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Turn or translate.
    pub primitive: Primitive,
    /// Whether the primitive is another one than in the tick before.
    pub changed: bool,
    /// Wanted minus actual heading, rad.
    pub heading_error: f64,
    /// Distance of the load's centre from the waypoint, m.
    pub distance: f64,
    /// Unit vector to the waypoint, load frame.
    pub direction: Vector2<f64>,
}

impl Guidance {
    /// The motion for a load at `world_from_load`; `None` while it is at the goal.
    pub fn next(&self, progress: &mut Progress, world_from_load: &Pose2) -> Option<Motion> {
        let center = position(world_from_load);
        let heading = yaw(world_from_load);
        let target = loop {
            let point = *self.waypoints.get(usize::from(progress.waypoint))?;
            let distance = (point - center).norm();
            let is_goal = usize::from(progress.waypoint) + 1 == self.waypoints.len();
            let orientation = self.goal_yaw.filter(|_| is_goal);
            let reached = match orientation {
                None if is_goal => distance < self.tolerance,
                None => distance < PASS * self.tolerance || self.lingers(progress, distance),
                Some(goal) => {
                    let limit = if progress.aligning { self.tolerance } else { AIM * self.tolerance };
                    progress.aligning = distance < limit;
                    progress.aligning && wrap_angle(goal.yaw - heading).abs() < AIM * goal.tolerance
                }
            };
            if !reached {
                break point;
            }
            if is_goal {
                // not for good: whoever pushes it off again, or a measurement that was wrong, finds the team ready
                return None;
            }
            progress.waypoint += 1;
            progress.backwards = None;
            progress.closest = None;
            progress.lingered = 0.0;
        };
        let bearing = primitive::bearing(&center, &target);
        let (heading_error, primitive) = if let (true, Some(goal)) = (progress.aligning, self.goal_yaw) {
            let error = self.signed(goal.yaw - heading, progress.primitive);
            // it turns until it is done
            let turn = if error > 0.0 { Turn::Counterclockwise } else { Turn::Clockwise };
            (error, Primitive::Rotate(turn))
        } else {
            let ahead =
                if self.goes_backwards(progress, wrap_angle(bearing - heading)) { bearing - PI } else { bearing };
            let error = self.signed(ahead - heading, progress.primitive);
            (error, primitive::choose(error, progress.primitive, self.threshold, self.release))
        };
        let changed = progress.primitive != Some(primitive);
        progress.primitive = Some(primitive);
        Some(Motion {
            primitive,
            changed,
            heading_error,
            distance: (target - center).norm(),
            direction: unit(wrap_angle(bearing - heading)),
        })
    }

    /// Whether the load has been near its waypoint for so long that other robots may have passed it.
    fn lingers(&self, progress: &mut Progress, distance: f64) -> bool {
        let closest = progress.closest.map_or(distance, |closest| closest.min(distance));
        progress.closest = Some(closest);
        progress.lingered += (NEAR - closest / self.tolerance).max(0.0);
        progress.lingered >= LINGER
    }

    /// Whether the load travels backwards, given the heading error of driving forwards.
    fn goes_backwards(&self, progress: &mut Progress, error: f64) -> bool {
        if !self.either_way {
            return false;
        }
        let backwards = match progress.backwards {
            None => error.abs() > FRAC_PI_2,
            Some(true) => error.abs() > FRAC_PI_2 - TURN_AROUND,
            Some(false) => error.abs() > FRAC_PI_2 + TURN_AROUND,
        };
        progress.backwards = Some(backwards);
        backwards
    }

    /// The difference of two headings as an error, rad.
    fn signed(&self, difference: f64, under_way: Option<Primitive>) -> f64 {
        if !self.wrap {
            return difference;
        }
        let error = wrap_angle(difference);
        match under_way {
            Some(Primitive::Rotate(Turn::Counterclockwise)) if error < HALF_TURN - PI => error + TAU,
            Some(Primitive::Rotate(Turn::Clockwise)) if error > PI - HALF_TURN => error - TAU,
            _ => error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se2::pose;

    fn guidance(goal: (f64, f64)) -> Guidance {
        Guidance {
            waypoints: vec![Vector2::new(goal.0, goal.1)],
            tolerance: 0.1,
            goal_yaw: None,
            threshold: 0.2,
            release: 0.1,
            wrap: true,
            either_way: false,
        }
    }

    #[test]
    fn a_turn_keeps_its_sense_across_the_half_turn() {
        let straight_back = guidance((-1.0, 0.0));
        let mut progress = Progress::default();
        let first = straight_back.next(&mut progress, &pose(0.0, 0.0, -0.01)).unwrap();
        let sense = first.primitive;
        for k in 0..20 {
            let shaken = 0.03 * f64::from(k % 3 - 1);
            let motion = straight_back.next(&mut progress, &pose(0.0, 0.0, shaken)).unwrap();
            assert_eq!(motion.primitive, sense);
            assert!((motion.heading_error.abs() - PI).abs() < 0.05);
        }
    }

    /// Going back 170° takes a turn of 10° when the load may travel backwards, and the direction says so.
    #[test]
    fn driving_either_way_turns_less() {
        let mut either = guidance(((170.0_f64).to_radians().cos(), (170.0_f64).to_radians().sin()));
        either.either_way = true;
        let mut progress = Progress::default();
        let motion = either.next(&mut progress, &pose(0.0, 0.0, 0.0)).unwrap();
        assert!((motion.heading_error + 10.0_f64.to_radians()).abs() < 1e-12);
        assert_eq!(motion.primitive, Primitive::Translate);
        assert!(motion.direction.x < -0.98);
        // a load that hangs about the quarter turn does not change its mind
        let mut progress = Progress::default();
        let mut quarter = guidance((0.0, 1.0));
        quarter.either_way = true;
        quarter.next(&mut progress, &pose(0.0, 0.0, 0.05)).unwrap();
        let chosen = progress.backwards;
        for k in 0..20 {
            quarter.next(&mut progress, &pose(0.0, 0.0, 0.1 * f64::from(k % 3 - 1))).unwrap();
            assert_eq!(progress.backwards, chosen);
        }
    }

    /// Robots decide 20 times a second at instants of their own, poses come 40 times a second. In a mission of two teams a load
    /// came within 85 % of the tolerance for a single sample and was pushed back: three robots had seen it, three had not and
    /// never did, because each half turned the load its own way from then on until it was lost.
    #[test]
    fn robots_that_look_at_different_instants_pass_a_waypoint_together() {
        let leg = Guidance { waypoints: vec![Vector2::zeros(), Vector2::new(0.0, 1.0)], ..guidance((0.0, 0.0)) };
        let approach = |sample: u32| (0.3 - 0.0025 * f64::from(sample)).max(0.0865);
        // the dip is on an even or an odd sample; afterwards the load stays, is pulled back in part, or far
        for dip in [100, 101] {
            for recede in [0.0, 0.01, 0.3] {
                for noise in [0.0, 0.004] {
                    let mut robots = [Progress::default(); 2];
                    let mut passed = [None; 2];
                    for sample in 0..200_u32 {
                        let shaken = noise * (f64::from(sample * 7 % 11) / 5.0 - 1.0);
                        let distance = match sample {
                            _ if sample == dip => 0.0845,
                            _ if sample > dip => 0.0865 + recede * (f64::from(sample - dip) / 20.0).min(1.0),
                            _ => approach(sample) + shaken.max(0.0),
                        };
                        let robot = usize::from(sample % 2 == 1);
                        leg.next(&mut robots[robot], &pose(-distance, 0.0, 0.0)).unwrap();
                        if robots[robot].waypoint == 1 && passed[robot].is_none() {
                            passed[robot] = Some(sample);
                        }
                    }
                    let [even, odd] = passed.map(|sample| sample.expect("the waypoint is passed"));
                    assert!(even.abs_diff(odd) <= 40, "{even} and {odd} of 40 samples a second");
                }
            }
        }
    }

    /// Closeness that is no closeness never adds up.
    #[test]
    fn a_waypoint_that_the_load_stays_away_from_is_not_passed() {
        let leg = Guidance { waypoints: vec![Vector2::zeros(), Vector2::new(0.0, 1.0)], ..guidance((0.0, 0.0)) };
        let mut progress = Progress::default();
        for _ in 0..100_000 {
            leg.next(&mut progress, &pose(-0.0951, 0.0, 0.0)).unwrap();
        }
        assert_eq!(progress.waypoint, 0);
    }

    #[test]
    fn an_oriented_goal_is_done_when_place_and_heading_are_right() {
        let mut oriented = guidance((1.0, 0.0));
        oriented.goal_yaw = Some(GoalYaw { yaw: FRAC_PI_2, tolerance: 0.2 });
        let mut progress = Progress::default();
        let at = |progress: &mut Progress, x, heading| oriented.next(progress, &pose(x, 0.0, heading));
        assert_eq!(at(&mut progress, 0.92, 0.0).unwrap().primitive, Primitive::Translate); // half the tolerance first
        let motion = at(&mut progress, 0.96, 0.0).unwrap();
        assert_eq!(motion.primitive, Primitive::Rotate(Turn::Counterclockwise));
        assert!((motion.heading_error - FRAC_PI_2).abs() < 1e-12);
        assert!(at(&mut progress, 0.93, 1.0).is_some()); // drifting within the tolerance is no reason to stop
        assert!(at(&mut progress, 0.88, 1.0).is_some_and(|m| m.distance > 0.1));
        assert!(!progress.aligning); // pushed out of it, the load goes back first
        assert!(at(&mut progress, 0.97, 1.5).is_none());
    }
}
