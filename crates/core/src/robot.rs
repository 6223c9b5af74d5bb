//! Robot models: size, mass, traction, limits.

use crate::kinematics::BaseLimits;

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
    pub limits: BaseLimits,
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
        limits: BaseLimits {
            linear: 0.22,
            lateral: 0.0,
            angular: 2.84,
            linear_acceleration: 1.0,
            angular_acceleration: 6.0,
            command_step: 0.01,
        },
    };

    /// A base of the same size, mass and speed that drives in any direction: for comparisons with methods made for such
    /// robots ([R2P2] §V-D).
    ///
    /// [R2P2]: crate::_documentation::references
    pub const OMNIDIRECTIONAL: Self =
        Self { limits: BaseLimits { lateral: 0.22, ..Self::TURTLEBOT3_BURGER.limits }, ..Self::TURTLEBOT3_BURGER };
}
