//! How an episode ended, in numbers.

use serde::Serialize;

/// How an episode ended ([R2P2] §V: success, failure A and failure B).
///
/// [R2P2]: cohaul_core::_documentation::references
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// Every load is within tolerance of its goal.
    Reached,
    /// The time allowed is over (failure A).
    TimedOut,
    /// A load slipped out of its formation or down the slope (failure B).
    LoadLost,
    /// Two robots collided (failure B).
    Collided,
    /// Stopped from outside.
    Interrupted,
}

impl End {
    /// As in `--json`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::TimedOut => "timed_out",
            Self::LoadLost => "load_lost",
            Self::Collided => "collided",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Result of an episode. With several teams, lengths and errors are the largest over the loads, counts are sums.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// How it ended.
    pub outcome: End,
    /// Whether every load was delivered.
    pub success: bool,
    /// Simulated duration, s.
    pub time_s: f64,
    /// Distance of the load's centre from its goal at the last step, m.
    pub final_error_m: f64,
    /// Bearing from the last waypoint to the goal minus the load's heading at the last step, absolute, rad.
    pub final_yaw_error_rad: f64,
    /// Waypoints passed, goals included.
    pub waypoints_reached: usize,
    /// Intervals in which at least one robot's stop flag was up.
    pub repositions: usize,
    /// Their total length, s.
    pub reposition_time_s: f64,
    /// Least distance between the centres of two robots, m.
    pub min_robot_distance_m: f64,
    /// Least distance between the bodies of two robots, or of a robot and an obstacle, m.
    pub min_clearance_m: f64,
    /// Length of the load's path, m.
    pub path_length_m: f64,
    /// Root mean square of the load's distance from the straight lines between its waypoints, m.
    pub path_deviation_rms_m: f64,
    /// Largest such distance, m.
    pub path_deviation_max_m: f64,
    /// ∫(v² + ω²)dt summed over the robots.
    pub control_effort: f64,
    /// Traction work of the robots, J.
    pub energy_j: f64,
    /// Time during which the robots did not enclose the load's centre, s.
    pub caging_violation_s: f64,
}
