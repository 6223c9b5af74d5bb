//! Who pushes, who prevents, who supports.
//!
//! # Source
//! [R2P2] §IV-B. `w_i` → `slot_in_load.y`, `L/2` → `half_length`, `ε` → `side_tolerance`, `f̂_i` → `facing`, `d̂` →
//! `direction`, `τ_i` → `torque_arm`, `τ_des` → [`Turn::sign`](super::primitive::Turn::sign).
//!
//! # Deviations
//! - `f̂_i` is the facing of the robot's slot, not its momentary heading: the paper assumes them equal, and while a robot
//!   repositions itself the heading would flip its role.
//! - |τ_i| below `torque_tolerance` counts as zero: an exact zero never happens with measured poses.
//! - The rule |w_i| > L/2 + ε ("Support by default") is applied in rotations too.
//!
//! [R2P2]: crate::_documentation::references

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::primitive::Primitive;
use crate::se2::cross;

/// What a robot does for the motion of the load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Drives the load towards the goal.
    Push,
    /// Gives way in front of the load, never faster than its speed limit, so that the load cannot run away.
    Prevent,
    /// Follows the load so that it cannot slip out of the formation.
    Support,
}

impl Role {
    /// Every role, in the order of their numbers in logs.
    pub const ALL: [Self; 3] = [Self::Push, Self::Prevent, Self::Support];
}

/// Tolerances of the role rules, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoleTolerances {
    /// ε of |w_i| > L/2 + ε, m.
    pub side: f64,
    /// Lever arm below which a robot turns the load not at all, m.
    pub torque: f64,
}

/// Role of the robot at `position_in_load` (m) facing along `facing_in_load` (unit vector).
///
/// `half_length` is half the extent of the load across its heading, m; `direction_in_load` the unit vector to the
/// waypoint, used while translating.
pub fn assign(
    primitive: Primitive,
    position_in_load: &Vector2<f64>,
    facing_in_load: &Vector2<f64>,
    direction_in_load: &Vector2<f64>,
    half_length: f64,
    tolerances: &RoleTolerances,
) -> Role {
    if position_in_load.y.abs() > half_length + tolerances.side {
        return Role::Support;
    }
    let sense = match primitive {
        // s_i = f̂_i · d̂
        Primitive::Translate => facing_in_load.dot(direction_in_load),
        // τ_i = (r_i − c) × f̂_i
        Primitive::Rotate(turn) => {
            let torque_arm = cross(position_in_load, facing_in_load);
            if torque_arm.abs() < tolerances.torque { 0.0 } else { torque_arm * turn.sign() }
        }
    };
    if sense > 0.0 {
        Role::Push
    } else if sense < 0.0 {
        Role::Prevent
    } else {
        Role::Support
    }
}
