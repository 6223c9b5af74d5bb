//! Poses and velocities from measured poses.
//!
//! # Source
//! [R2P2] §IV-C uses v_b and ω_b but lists neither among the observations (§I, iv): they are differentiated from the poses. The
//! filter is the α-β filter, the steady state of a Kalman filter for constant velocity; [Kalata1984] gives its gains from the
//! tracking index λ = σ_a T² / σ: acceleration of the body against noise of the measurement, T the time between two samples.
//!
//! # Deviations
//! - The paper does not say how it differentiates, and measures without noise. Without noise (σ = 0) poses pass unchanged
//!   (α = 1) and velocities through a first-order low-pass (β = T / (T + τ)).
//! - β is at most that without noise: the optimum for hardly any noise follows every sample.
//! - T is the time since the last sample that arrived: gains follow when samples get lost.
//!
//! [R2P2]: crate::_documentation::references
//! [Kalata1984]: crate::_documentation::references

use crate::se2::{Pose2, Twist2, pose, position, wrap_angle, yaw};
use crate::time::Time;

/// Time constant of the velocity without noise, s.
const TIME_CONSTANT: f64 = 0.05;

/// What a filter knows of the measurement and of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterModel {
    /// Standard deviation of each measured coordinate, m.
    pub position_sd: f64,
    /// Standard deviation of the measured yaw, rad.
    pub yaw_sd: f64,
    /// Acceleration that the body is capable of, m/s².
    pub acceleration: f64,
    /// Angular acceleration that it is capable of, rad/s².
    pub angular_acceleration: f64,
}

/// Filtered pose and velocity of one body.
#[derive(Clone, Copy, Debug)]
pub struct PoseFilter {
    model: FilterModel,
    state: Option<State>,
}

#[derive(Clone, Copy, Debug)]
struct State {
    sampled: Time,
    pose: Pose2,
    twist: Twist2,
}

/// The gains (α, β) for samples `dt` s apart ([Kalata1984]).
///
/// [Kalata1984]: crate::_documentation::references
fn gains(sd: f64, acceleration: f64, dt: f64) -> (f64, f64) {
    if sd <= 0.0 {
        return (1.0, dt / (dt + TIME_CONSTANT));
    }
    let index = acceleration * dt * dt / sd;
    let r = (4.0 + index - (8.0 * index + index * index).sqrt()) / 4.0;
    let alpha = 1.0 - r * r;
    // for very little noise the formula's β exceeds that without noise, and the velocity would ring
    (alpha, (2.0 * (2.0 - alpha) - 4.0 * r).min(dt / (dt + TIME_CONSTANT)))
}

impl PoseFilter {
    /// That has seen nothing yet.
    pub const fn new(model: FilterModel) -> Self {
        Self { model, state: None }
    }

    /// Takes a pose measured at `sampled`; samples that are not newer than the last one are ignored.
    pub fn update(&mut self, sampled: Time, measured: &Pose2) {
        let Some(state) = &mut self.state else {
            self.state = Some(State { sampled, pose: *measured, twist: Twist2::ZERO });
            return;
        };
        let dt = sampled.since(state.sampled);
        if dt <= 0.0 {
            return;
        }
        let FilterModel { position_sd, yaw_sd, acceleration, angular_acceleration } = self.model;
        let (alpha, beta) = gains(position_sd, acceleration, dt);
        let (alpha_yaw, beta_yaw) = gains(yaw_sd, angular_acceleration, dt);
        let expected = position(&state.pose) + dt * state.twist.linear;
        let expected_yaw = yaw(&state.pose) + dt * state.twist.angular;
        let surprise = position(measured) - expected;
        let surprise_yaw = wrap_angle(yaw(measured) - expected_yaw);
        state.twist.linear += beta / dt * surprise;
        state.twist.angular += beta_yaw / dt * surprise_yaw;
        let mut filtered = *measured;
        if position_sd > 0.0 {
            filtered.translation.vector = expected + alpha * surprise;
        }
        if yaw_sd > 0.0 {
            filtered.rotation = pose(0.0, 0.0, expected_yaw + alpha_yaw * surprise_yaw).rotation;
        }
        state.pose = filtered;
        state.sampled = sampled;
    }

    /// The last pose; `None` before the first sample.
    pub fn pose(&self) -> Option<Pose2> {
        self.state.map(|state| state.pose)
    }

    /// Velocity of the body's centre in the world frame, m/s and rad/s.
    pub fn twist_in_world(&self) -> Twist2 {
        self.state.map_or(Twist2::ZERO, |state| state.twist)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOAD: FilterModel =
        FilterModel { position_sd: 0.0, yaw_sd: 0.0, acceleration: 0.5, angular_acceleration: 1.0 };

    #[test]
    fn steady_motion_across_the_half_turn_is_found() {
        for (position_sd, yaw_sd) in [(0.0, 0.0), (1e-6, 1e-6), (0.01, 0.03)] {
            let mut filter = PoseFilter::new(FilterModel { position_sd, yaw_sd, ..LOAD });
            for k in 0..400 {
                let t = f64::from(k) * 0.025;
                filter.update(Time::from_seconds(t), &pose(0.1 * t, -0.2 * t, 3.0 + 0.3 * t));
            }
            let error = filter.twist_in_world().vector() - Twist2::new(0.1, -0.2, 0.3).vector();
            assert!(error.norm() < 1e-6, "{error}");
        }
    }

    /// Noise of 1 cm and 2° at 40 Hz: the filter halves it and finds the velocity of a body at rest within 3 cm/s and 4°/s
    /// (standard deviations; 0.4 m/s and 80°/s without a filter).
    #[test]
    fn noise_is_held_down() {
        let (position_sd, yaw_sd) = (0.01, 2.0_f64.to_radians());
        let mut filter = PoseFilter::new(FilterModel { position_sd, yaw_sd, ..LOAD });
        // a fixed sequence with the moments of a normal distribution: sum of twelve uniform numbers
        let mut state = 1_u64;
        let mut normal = || {
            let sum: f64 = (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (state >> 11) as f64 / (1_u64 << 53) as f64
                })
                .sum();
            sum - 6.0
        };
        let mut squares = [0.0; 4];
        let n = 4000;
        for k in 0..n {
            let noisy = pose(position_sd * normal(), position_sd * normal(), yaw_sd * normal());
            filter.update(Time::from_seconds(f64::from(k) * 0.025), &noisy);
            let (at, twist) = (filter.pose().unwrap(), filter.twist_in_world());
            for (square, value) in squares.iter_mut().zip([at.translation.x, yaw(&at), twist.linear.x, twist.angular]) {
                *square += value * value / f64::from(n);
            }
        }
        let [x, turn, speed, rate] = squares.map(f64::sqrt);
        assert!(x < 0.5 * position_sd && turn < 0.5 * yaw_sd, "{x} {turn}");
        assert!(speed < 0.03 && rate < 4.0_f64.to_radians(), "{speed} {rate}");
    }

    #[test]
    fn old_samples_are_ignored() {
        let mut filter = PoseFilter::new(LOAD);
        filter.update(Time::from_seconds(1.0), &pose(1.0, 0.0, 0.0));
        filter.update(Time::from_seconds(0.5), &pose(9.0, 0.0, 0.0));
        assert_eq!(filter.pose(), Some(pose(1.0, 0.0, 0.0)));
    }
}
