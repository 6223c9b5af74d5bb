//! Bases and their limits.

use crate::control::Command;

/// Limits of a base that drives along its heading and turns, or of one that drives sideways too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseLimits {
    /// Highest forward and backward speed, m/s.
    pub linear: f64,
    /// Highest speed sideways, m/s; 0 for a differential drive.
    pub lateral: f64,
    /// Highest yaw rate, rad/s.
    pub angular: f64,
    /// Linear acceleration limit, m/s².
    pub linear_acceleration: f64,
    /// Angular acceleration limit, rad/s².
    pub angular_acceleration: f64,
    /// Step to which the base truncates commands toward zero, m/s and rad/s; 0 for none ([TB3]).
    ///
    /// [TB3]: crate::_documentation::references
    pub command_step: f64,
}

impl BaseLimits {
    /// The command as the base takes it: within the limits, truncated toward zero to whole steps.
    ///
    /// ```
    /// # use cohaul_core::{control::Command, robot::RobotModel};
    /// let base = RobotModel::TURTLEBOT3_BURGER.limits;
    /// let taken = base.accepted(Command { linear: -0.119, lateral: 0.1, angular: 9.0 });
    /// assert_eq!(taken, Command { linear: -0.11, lateral: 0.0, angular: 2.84 });
    /// ```
    pub fn accepted(&self, command: Command) -> Command {
        Command {
            linear: truncate(command.linear.clamp(-self.linear, self.linear), self.command_step),
            lateral: truncate(command.lateral.clamp(-self.lateral, self.lateral), self.command_step),
            angular: truncate(command.angular.clamp(-self.angular, self.angular), self.command_step),
        }
    }

    /// The speeds after `dt` seconds of approaching `command` from `speeds` within the acceleration limits.
    pub fn approach(&self, speeds: Command, command: Command, dt: f64) -> Command {
        let linear = self.linear_acceleration * dt;
        let angular = self.angular_acceleration * dt;
        Command {
            linear: speeds.linear + (command.linear - speeds.linear).clamp(-linear, linear),
            lateral: speeds.lateral + (command.lateral - speeds.lateral).clamp(-linear, linear),
            angular: speeds.angular + (command.angular - speeds.angular).clamp(-angular, angular),
        }
    }
}

/// `value` truncated toward zero to a whole number of steps; a hair below a step counts as the step.
fn truncate(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step + value.signum() * 1e-9).trunc() * step } else { value }
}
