//! The load's velocity from its measured poses.
//!
//! # Source
//! [R2P2] §IV-C uses v_b and ω_b but lists neither among the observations (§I, iv): they are differentiated from the poses.
//!
//! # Deviations
//! First-order low-pass; the paper does not say how it differentiates.
//!
//! [R2P2]: crate::_documentation::references

use crate::se2::{Pose2, Twist2, position, wrap_angle, yaw};
use crate::time::Time;

/// Filtered difference quotient of a pose.
#[derive(Clone, Copy, Debug)]
pub struct TwistEstimator {
    time_constant: f64,
    last: Option<(Time, Pose2)>,
    twist: Twist2,
}

impl TwistEstimator {
    /// With a low-pass of `time_constant` seconds.
    pub const fn new(time_constant: f64) -> Self {
        Self { time_constant, last: None, twist: Twist2::ZERO }
    }

    /// Takes a pose measured at `sampled`; samples that are not newer than the last one are ignored.
    pub fn update(&mut self, sampled: Time, world_from_load: &Pose2) {
        if let Some((before, pose)) = &self.last {
            let dt = sampled.since(*before);
            if dt <= 0.0 {
                return;
            }
            let linear = (position(world_from_load) - position(pose)) / dt;
            let angular = wrap_angle(yaw(world_from_load) - yaw(pose)) / dt;
            let share = dt / (dt + self.time_constant);
            self.twist.linear += share * (linear - self.twist.linear);
            self.twist.angular += share * (angular - self.twist.angular);
        }
        self.last = Some((sampled, *world_from_load));
    }

    /// Velocity of the load's centre in the world frame, m/s and rad/s.
    pub const fn twist_in_world(&self) -> Twist2 {
        self.twist
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se2::pose;

    #[test]
    fn steady_motion_across_the_half_turn_is_found() {
        let mut estimator = TwistEstimator::new(0.05);
        for k in 0..100 {
            let t = f64::from(k) * 0.025;
            estimator.update(Time::from_seconds(t), &pose(0.1 * t, -0.2 * t, 3.0 + 0.3 * t));
        }
        let error = estimator.twist_in_world().vector() - Twist2::new(0.1, -0.2, 0.3).vector();
        assert!(error.norm() < 1e-9);
    }
}
