//! The last gate before the wheels: whatever is stale, not finite or over the limits becomes a stop.
//!
//! The guard knows nothing of the controller behind it. A stop holds the wheels; it never drives backwards, so a load on a
//! slope stays where the team holds it. The fault is cleared by the first sound decision.

use super::{Command, ControlError, Decision, Fault, Observation, Step};
use crate::kinematics::BaseLimits;

/// Limits of the guard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuardLimits {
    /// Age of a pose beyond which the robot stops, s.
    pub pose_timeout: f64,
    /// Speeds that no command may exceed.
    pub robot: BaseLimits,
}

/// A controller behind its guard.
pub struct Guard<S> {
    inner: S,
    limits: GuardLimits,
}

impl<S: Step> Guard<S> {
    /// Guards `inner`.
    pub const fn new(inner: S, limits: GuardLimits) -> Self {
        Self { inner, limits }
    }

    /// Decides one tick: the controller's decision if it is sound, a stop with its fault otherwise. Allocates nothing.
    pub fn step(&mut self, observation: &Observation) -> Decision {
        if !observation.is_finite() {
            return stopped(Decision::default(), Fault::NotFinite);
        }
        let age = observation.time.since(observation.sampled);
        if !(0.0..=self.limits.pose_timeout).contains(&age) {
            return stopped(Decision::default(), Fault::Stale);
        }
        match self.inner.step(observation) {
            Ok(decision) => self.check(decision),
            Err(ControlError::NotFinite { .. }) => stopped(Decision::default(), Fault::NotFinite),
            Err(_) => stopped(Decision::default(), Fault::Controller),
        }
    }

    fn check(&self, decision: Decision) -> Decision {
        let Command { linear, lateral, angular } = decision.command;
        if !(linear.is_finite() && lateral.is_finite() && angular.is_finite()) {
            return stopped(decision, Fault::NotFinite);
        }
        // a rounding error above the limit is not a fault
        let margin = 1.0 + 1e-9;
        let robot = &self.limits.robot;
        let over = |speed: f64, limit: f64| speed.abs() > limit * margin;
        if over(linear, robot.linear) || over(lateral, robot.lateral) || over(angular, robot.angular) {
            return stopped(decision, Fault::OverLimit);
        }
        decision
    }

    /// The controller.
    pub fn inner(&self) -> &S {
        &self.inner
    }

    /// The controller, to reset it or to restore its memory.
    pub fn inner_mut(&mut self) -> &mut S {
        &mut self.inner
    }
}

/// The decision with its command replaced by a stop.
fn stopped(decision: Decision, fault: Fault) -> Decision {
    Decision { command: Command::STOP, fault, ..decision }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::RobotId;
    use crate::robot::RobotModel;
    use crate::se2::{Pose2, Twist2};
    use crate::time::Time;

    struct Fixed(Result<Command, ControlError>);

    impl Step for Fixed {
        fn step(&mut self, _: &Observation) -> Result<Decision, ControlError> {
            self.0.clone().map(|command| Decision { command, ..Decision::default() })
        }
        fn reset(&mut self) {}
        fn memory(&self) -> String {
            String::new()
        }
        fn restore(&mut self, _: &str) -> Result<(), ControlError> {
            Ok(())
        }
    }

    fn observation(age: f64) -> Observation {
        Observation {
            time: Time::from_seconds(10.0),
            sampled: Time::from_seconds(10.0 - age),
            robot: RobotId(0),
            world_from_robot: Pose2::identity(),
            world_from_load: Pose2::identity(),
            load_twist_in_world: Twist2::ZERO,
            stop_flags: super::super::StopFlags::default(),
        }
    }

    fn decide(result: Result<Command, ControlError>, observation: &Observation) -> Decision {
        let limits = GuardLimits { pose_timeout: 0.15, robot: RobotModel::TURTLEBOT3_BURGER.limits };
        Guard::new(Fixed(result), limits).step(observation)
    }

    #[test]
    fn sound_decisions_pass_unchanged() {
        let command = Command::drive(0.22, -2.84);
        assert_eq!(decide(Ok(command), &observation(0.149)).command, command);
    }

    #[test]
    fn everything_else_is_a_stop_with_its_fault() {
        let drive = |linear, angular| Ok(Command::drive(linear, angular));
        let mut lost = observation(0.0);
        lost.world_from_load.translation.vector.x = f64::NAN;
        let error = ControlError::Memory { reason: String::new() };
        for (result, observation, fault) in [
            (drive(0.1, 0.0), observation(0.16), Fault::Stale),
            (drive(0.1, 0.0), observation(-0.01), Fault::Stale),
            (drive(0.1, 0.0), lost, Fault::NotFinite),
            (drive(f64::NAN, 0.0), observation(0.0), Fault::NotFinite),
            (drive(0.0, f64::INFINITY), observation(0.0), Fault::NotFinite),
            (drive(0.23, 0.0), observation(0.0), Fault::OverLimit),
            (drive(0.0, -3.0), observation(0.0), Fault::OverLimit),
            (Ok(Command { lateral: 0.1, ..Command::STOP }), observation(0.0), Fault::OverLimit),
            (Err(error), observation(0.0), Fault::Controller),
        ] {
            let decision = decide(result, &observation);
            assert_eq!((decision.command, decision.fault), (Command::STOP, fault));
        }
    }
}
