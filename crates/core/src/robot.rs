//! Robot models: size, mass, traction, limits.

use crate::kinematics::UnicycleLimits;

/// What the worlds and the controllers need to know of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotModel {
    /// Radius of the round body, m.
    pub radius: f64,
    /// Mass with ballast, kg.
    pub mass: f64,
    /// Mass resting on the driven wheels, kg: what traction comes from.
    pub mass_on_wheels: f64,
    /// Distance between the wheels, m.
    pub track: f64,
    /// Speed and acceleration limits, command truncation.
    pub limits: UnicycleLimits,
}

impl RobotModel {
    /// TurtleBot3 Burger ([TB3]); the whole weight is taken to rest on the driven wheels.
    ///
    /// [TB3]: crate::_documentation::references
    pub const TURTLEBOT3_BURGER: Self = Self {
        radius: 0.105,
        mass: 1.0,
        mass_on_wheels: 1.0,
        track: 0.160,
        limits: UnicycleLimits {
            linear: 0.22,
            angular: 2.84,
            linear_acceleration: 1.0,
            angular_acceleration: 6.0,
            command_step: 0.01,
        },
    };
}
