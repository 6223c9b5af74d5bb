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
    /// Heading that the goal asks for, or else the bearing from the last waypoint to the goal, minus the load's heading at the
    /// last step, absolute, rad: about π for a load that drove backwards.
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
    /// Time added for robots that were put into their slots, s; not part of `time_s`.
    pub penalty_s: f64,
}

impl Outcome {
    /// As one JSON object, with the names of `--json`.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Rows of a table for people: label and value with unit.
    pub fn rows(&self) -> Vec<(String, String)> {
        let share = 100.0 * self.reposition_time_s / self.time_s.max(f64::MIN_POSITIVE);
        [
            ("outcome", self.outcome.name().replace('_', " ")),
            ("time", format!("{:.1} s", self.time_s)),
            ("final distance", format!("{:.3} m", self.final_error_m)),
            ("final heading error", format!("{:.1}°", self.final_yaw_error_rad.to_degrees())),
            ("waypoints reached", self.waypoints_reached.to_string()),
            ("repositionings", format!("{} ({share:.0} % of the time)", self.repositions)),
            ("path of the load", format!("{:.2} m", self.path_length_m)),
            (
                "deviation from the path",
                format!("{:.3} m rms, {:.3} m max", self.path_deviation_rms_m, self.path_deviation_max_m),
            ),
            ("least distance of robots", format!("{:.3} m", self.min_robot_distance_m)),
            ("least clearance", format!("{:.3} m", self.min_clearance_m)),
            ("traction work", format!("{:.1} J", self.energy_j)),
            ("control effort", format!("{:.1}", self.control_effort)),
            ("cage open", format!("{:.2} s", self.caging_violation_s)),
            ("penalty for teleports", format!("{:.0} s", self.penalty_s)),
        ]
        .map(|(label, value)| (label.to_owned(), value))
        .into_iter()
        .filter(|(label, _)| self.penalty_s > 0.0 || label != "penalty for teleports")
        .collect()
    }
}
