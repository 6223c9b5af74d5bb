//! Inclined ground as tilted gravity.
//!
//! The world's x and y axes lie in the ground plane and z is its outward normal; a slope changes the direction of gravity,
//! never the geometry.

use nalgebra::Vector2;

use crate::se2::unit;

/// Standard gravity, m/s².
pub const GRAVITY: f64 = 9.81;

/// Gravity seen from a ground plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// Acceleration along the ground, world frame, m/s².
    pub tangential: Vector2<f64>,
    /// Acceleration into the ground, m/s², positive.
    pub normal: f64,
}

impl Slope {
    /// Ground inclined by `angle` (rad), ascending most steeply along `uphill` (rad from the world's x axis).
    ///
    /// ```
    /// # use cohaul_core::contact::slope::{Slope, GRAVITY};
    /// assert_eq!(Slope::new(0.0, 1.0).normal, GRAVITY);
    /// let up = Slope::new(5.0_f64.to_radians(), 0.0);
    /// assert!((up.tangential.x + GRAVITY * 5.0_f64.to_radians().sin()).abs() < 1e-12);
    /// ```
    pub fn new(angle: f64, uphill: f64) -> Self {
        Self { tangential: -GRAVITY * angle.sin() * unit(uphill), normal: GRAVITY * angle.cos() }
    }

    /// Whether a body at rest starts to slide: the tangent of the inclination exceeds the coefficient of friction.
    pub fn slides(&self, friction: f64) -> bool {
        self.tangential.norm() > friction * self.normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a slope of angle α a load starts to slide when tan α > μ.
    #[test]
    fn load_slides_just_past_the_friction_angle() {
        let friction = 0.3_f64;
        let margin = 1e-9; // rad; the threshold itself is exact
        assert!(!Slope::new(friction.atan() - margin, 0.4).slides(friction));
        assert!(Slope::new(friction.atan() + margin, 0.4).slides(friction));
    }
}
