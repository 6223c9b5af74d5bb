//! Planar rigid motions: poses, twists, wrenches.
//!
//! Frames are in the names: `a_from_b` maps coordinates in b to coordinates in a.

use nalgebra::{Isometry2, Vector2, Vector3};

/// A rigid motion of the plane; `world_from_robot` is also the robot's pose in the world, m and rad.
pub type Pose2 = Isometry2<f64>;

/// Velocity of a planar body, m/s and rad/s. The field holding it says in which frame it is expressed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist2 {
    /// Linear velocity of the reference point, m/s.
    pub linear: Vector2<f64>,
    /// Yaw rate, rad/s, counter-clockwise.
    pub angular: f64,
}

/// Force and torque on a planar body, N and N·m, about the body's reference point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench2 {
    /// Force, N.
    pub force: Vector2<f64>,
    /// Torque about the vertical axis, N·m, counter-clockwise.
    pub torque: f64,
}

impl Twist2 {
    /// At rest.
    pub const ZERO: Self = Self { linear: Vector2::new(0.0, 0.0), angular: 0.0 };

    /// From its three numbers, m/s, m/s, rad/s.
    pub const fn new(x: f64, y: f64, angular: f64) -> Self {
        Self { linear: Vector2::new(x, y), angular }
    }

    /// As (vx, vy, ω).
    pub fn vector(&self) -> Vector3<f64> {
        Vector3::new(self.linear.x, self.linear.y, self.angular)
    }

    /// Velocity of the point at `offset` (m, same frame) from the reference point, m/s.
    pub fn velocity_at(&self, offset: &Vector2<f64>) -> Vector2<f64> {
        self.linear + self.angular * perpendicular(offset)
    }

    /// The same motion with its linear part turned by `angle` rad (a change of axes, not of the reference point).
    #[must_use]
    pub fn rotated(&self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { linear: rotate(&self.linear, sin, cos), angular: self.angular }
    }
}

impl Wrench2 {
    /// No force.
    pub const ZERO: Self = Self { force: Vector2::new(0.0, 0.0), torque: 0.0 };

    /// From its three numbers, N, N, N·m.
    pub const fn new(x: f64, y: f64, torque: f64) -> Self {
        Self { force: Vector2::new(x, y), torque }
    }

    /// As (fx, fy, τ).
    pub fn vector(&self) -> Vector3<f64> {
        Vector3::new(self.force.x, self.force.y, self.torque)
    }

    /// The wrench of `force` (N) acting at `point` (m, same frame).
    pub fn from_force_at(force: Vector2<f64>, point: &Vector2<f64>) -> Self {
        Self { force, torque: cross(point, &force) }
    }

    /// Power delivered to a body moving with `twist` (same frame, same reference point), W.
    pub fn power(&self, twist: &Twist2) -> f64 {
        self.force.dot(&twist.linear) + self.torque * twist.angular
    }
}

/// z component of a × b.
pub fn cross(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The vector turned a quarter turn counter-clockwise.
pub fn perpendicular(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// The vector turned by the angle whose sine and cosine are given.
pub fn rotate(v: &Vector2<f64>, sin: f64, cos: f64) -> Vector2<f64> {
    Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

/// Unit vector at `angle` rad from the x axis.
pub fn unit(angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(cos, sin)
}

/// The angle shifted by whole turns into (−π, π]; NaN and infinities give NaN.
///
/// ```
/// # use cohaul_core::se2::wrap_angle;
/// assert!((wrap_angle(3.0 * std::f64::consts::PI) - std::f64::consts::PI).abs() < 1e-12);
/// assert_eq!(wrap_angle(-std::f64::consts::PI), std::f64::consts::PI);
/// assert_eq!(wrap_angle(0.5), 0.5);
/// ```
pub fn wrap_angle(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if angle > -PI && angle <= PI {
        return angle;
    }
    let wrapped = angle.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}

/// A pose from its three numbers, m, m, rad.
pub fn pose(x: f64, y: f64, yaw: f64) -> Pose2 {
    Pose2::new(Vector2::new(x, y), yaw)
}

/// Position of a pose, m.
pub fn position(pose: &Pose2) -> Vector2<f64> {
    pose.translation.vector
}

/// Yaw of a pose in (−π, π], rad.
pub fn yaw(pose: &Pose2) -> f64 {
    pose.rotation.angle()
}

/// Whether every number of a pose is finite.
pub fn is_finite(pose: &Pose2) -> bool {
    pose.translation.vector.iter().all(|v| v.is_finite())
        && pose.rotation.re.is_finite()
        && pose.rotation.im.is_finite()
}

/// Exponential: the displacement of a body that keeps `twist` (body frame) for one unit of time.
pub fn exp(twist: &Twist2) -> Pose2 {
    let w = twist.angular;
    // sin(w)/w and (1 − cos w)/w, by series where the quotients lose digits
    let (a, b) = if w.abs() < 1e-4 {
        (1.0 - w * w / 6.0, w / 2.0 - w * w * w / 24.0)
    } else {
        (w.sin() / w, (1.0 - w.cos()) / w)
    };
    let v = twist.linear;
    Pose2::new(Vector2::new(a * v.x - b * v.y, b * v.x + a * v.y), w)
}

/// Logarithm: the body twist that leads to `pose` in one unit of time; inverse of [`exp`] for yaw in (−π, π].
pub fn log(pose: &Pose2) -> Twist2 {
    let w = yaw(pose);
    let half = 0.5 * w;
    // half / tan(half)
    let c = if w.abs() < 1e-4 { 1.0 - w * w / 12.0 } else { half / half.tan() };
    let p = position(pose);
    Twist2 { linear: Vector2::new(c * p.x + half * p.y, -half * p.x + c * p.y), angular: w }
}

/// Adjoint: the twist of one rigid body seen from frame a, given seen from frame b and `a_from_b`.
pub fn adjoint(a_from_b: &Pose2, twist_in_b: &Twist2) -> Twist2 {
    let linear = a_from_b.rotation * twist_in_b.linear;
    let p = position(a_from_b);
    Twist2 { linear: linear - twist_in_b.angular * perpendicular(&p), angular: twist_in_b.angular }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_inverts_exp() {
        for (x, y, w) in [(0.3, -0.2, 0.0), (0.3, -0.2, 1e-6), (1.0, 2.0, 3.0), (-1.0, 0.5, -2.5)] {
            let twist = Twist2::new(x, y, w);
            let back = log(&exp(&twist));
            assert!((back.vector() - twist.vector()).norm() < 1e-9, "{twist:?} {back:?}");
        }
    }

    #[test]
    fn adjoint_keeps_power() {
        // the power of a wrench is the same number in every frame
        let a_from_b = pose(0.4, -0.3, 0.7);
        let twist_in_b = Twist2::new(0.1, 0.2, 0.3);
        let twist_in_a = adjoint(&a_from_b, &twist_in_b);
        let point_in_b = Vector2::new(0.5, 0.6);
        let force_in_b = Vector2::new(-1.0, 2.0);
        let point_in_a = a_from_b * nalgebra::Point2::from(point_in_b);
        let force_in_a = a_from_b.rotation * force_in_b;
        let in_b = Wrench2::from_force_at(force_in_b, &point_in_b).power(&twist_in_b);
        let in_a = Wrench2::from_force_at(force_in_a, &point_in_a.coords).power(&twist_in_a);
        assert!((in_a - in_b).abs() < 1e-12);
    }
}
