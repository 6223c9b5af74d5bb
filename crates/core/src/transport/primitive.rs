//! Which motion of the load comes next.
//!
//! # Source
//! [R2P2] §IV-A. `θ_R` → bearing of the waypoint, `θ_c` → heading of the load, `ε` → `threshold`.
//!
//! # Deviations
//! - The error is the shortest signed angle; the paper compares the two angles unwrapped, which turns the wrong way round
//!   when they lie on both sides of ±π (`wrap: false` restores it).
//! - Once it turns, the load turns until the error is below `release` < ε; the paper has one threshold
//!   (`heading_release` = `heading_threshold` restores it).
//!
//! [R2P2]: crate::_documentation::references

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// Sense of a rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// Counter-clockwise, positive.
    Counterclockwise,
    /// Clockwise, negative.
    Clockwise,
}

impl Turn {
    /// +1 counter-clockwise, −1 clockwise ([R2P2] §IV-B, τ_des).
    ///
    /// [R2P2]: crate::_documentation::references
    pub const fn sign(self) -> f64 {
        match self {
            Self::Counterclockwise => 1.0,
            Self::Clockwise => -1.0,
        }
    }
}

/// One of the three motions of the load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Primitive {
    /// Turn on the spot.
    Rotate(Turn),
    /// Straight along the heading.
    Translate,
}

impl Primitive {
    /// Every primitive, in the order of their numbers in logs.
    pub const ALL: [Self; 3] = [Self::Rotate(Turn::Counterclockwise), Self::Rotate(Turn::Clockwise), Self::Translate];
}

/// Bearing θ_R of `target` from `center`, both in the world, m; rad in (−π, π].
pub fn bearing(center: &Vector2<f64>, target: &Vector2<f64>) -> f64 {
    (target.y - center.y).atan2(target.x - center.x)
}

/// Chooses the motion from the heading error, rad.
///
/// `previous` is the motion of the tick before. A rotation under way goes on until the error is below `release`; from
/// rest or a translation one begins when it exceeds `threshold`.
///
/// ```
/// # use cohaul_core::transport::primitive::{choose, Primitive, Turn};
/// assert_eq!(choose(0.3, None, 0.2, 0.1), Primitive::Rotate(Turn::Counterclockwise));
/// assert_eq!(choose(-0.3, None, 0.2, 0.1), Primitive::Rotate(Turn::Clockwise));
/// assert_eq!(choose(0.15, None, 0.2, 0.1), Primitive::Translate);
/// // a rotation under way goes on
/// let turning = Some(Primitive::Rotate(Turn::Counterclockwise));
/// assert_eq!(choose(0.15, turning, 0.2, 0.1), Primitive::Rotate(Turn::Counterclockwise));
/// ```
pub fn choose(heading_error: f64, previous: Option<Primitive>, threshold: f64, release: f64) -> Primitive {
    let limit = match previous {
        Some(Primitive::Rotate(Turn::Counterclockwise)) if heading_error > 0.0 => release,
        Some(Primitive::Rotate(Turn::Clockwise)) if heading_error < 0.0 => release,
        _ => threshold,
    };
    if heading_error > limit {
        Primitive::Rotate(Turn::Counterclockwise)
    } else if heading_error < -limit {
        Primitive::Rotate(Turn::Clockwise)
    } else {
        Primitive::Translate
    }
}
