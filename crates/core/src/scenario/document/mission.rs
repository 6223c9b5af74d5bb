//! What a team shall reach, and how it decides.

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{R2p2, Vlf};
use crate::control::guidance::GoalYaw;
use crate::se2::wrap_angle;

/// What a team shall reach.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct Mission {
    /// Points that the load's centre passes in this order, before the goal. Leave the key out for a mission without any:
    /// an empty list is refused.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[garde(length(max = 1000), dive)]
    #[schemars(length(min = 1))]
    pub waypoints: Vec<Point>,
    /// Whether the waypoints are given, or planned through the obstacles before the mission starts (see `cohaul check`).
    #[serde(default, skip_serializing_if = "Plan::is_given")]
    pub plan: Plan,
    /// Where the load's centre shall end.
    #[garde(dive)]
    pub goal: Point,
    /// Heading that the load shall end with, degrees; any where it is not given.
    #[serde(default)]
    #[garde(inner(range(min = -360.0, max = 360.0)))]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub goal_yaw_deg: Option<f64>,
    /// How far off that heading may be, degrees.
    #[serde(default = "Mission::default_yaw_tolerance_deg")]
    #[garde(range(min = 0.1, max = 180.0))]
    pub yaw_tolerance_deg: f64,
    /// Distance at which a waypoint and the goal count as reached, m.
    #[serde(default = "Mission::default_tolerance")]
    #[garde(range(min = 0.001, max = 10.0))]
    pub tolerance: f64,
    /// Time allowed, s.
    #[serde(default = "Mission::default_time_limit")]
    #[garde(range(min = 0.1, max = 1e6))]
    pub time_limit: f64,
}

impl Mission {
    /// The waypoints and the goal, in the order in which the load passes them.
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.waypoints.iter().chain([&self.goal])
    }

    /// The orientation that the goal asks for.
    pub fn goal_yaw(&self) -> Option<GoalYaw> {
        let yaw_deg = self.goal_yaw_deg?;
        Some(GoalYaw { yaw: wrap_angle(yaw_deg.to_radians()), tolerance: self.yaw_tolerance_deg.to_radians() })
    }

    const fn default_yaw_tolerance_deg() -> f64 {
        11.46
    }

    const fn default_tolerance() -> f64 {
        0.10
    }

    const fn default_time_limit() -> f64 {
        1500.0
    }
}

/// Where waypoints come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Plan {
    /// The scenario lists them, or has none.
    #[default]
    Given,
    /// The planner finds a way for load and team through obstacles and walls.
    Auto,
}

impl Plan {
    fn is_given(&self) -> bool {
        *self == Self::Given
    }
}

/// A point of the ground plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub struct Point {
    /// m.
    #[garde(range(min = -1e4, max = 1e4))]
    pub x: f64,
    /// m.
    #[garde(range(min = -1e4, max = 1e4))]
    pub y: f64,
}

/// How each robot of a team decides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[garde(allow_unvalidated)]
pub enum Controller {
    /// Roles with rules and proportional-control primitives.
    R2p2(#[garde(dive)] R2p2),
    /// Virtual leader and followers: the baseline that R2P2 is compared with.
    Vlf(#[garde(dive)] Vlf),
}
