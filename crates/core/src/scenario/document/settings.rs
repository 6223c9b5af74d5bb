//! How the simulator measures and integrates.

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How poses are measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Sensors {
    /// Rate, Hz.
    #[garde(range(min = 0.1, max = 1000.0))]
    pub rate_hz: f64,
    /// Standard deviation of each coordinate, m.
    #[garde(range(min = 0.0, max = 1.0))]
    pub position_sd: f64,
    /// Standard deviation of the yaw, degrees.
    #[garde(range(min = 0.0, max = 180.0))]
    pub yaw_sd_deg: f64,
    /// Age of a pose when it arrives, s.
    #[garde(range(min = 0.0, max = 10.0))]
    pub latency: f64,
    /// Share of the poses that get lost, 0 to 1.
    #[garde(range(min = 0.0, max = 1.0))]
    pub dropout: f64,
    /// Age of the last pose at which a robot stops, s.
    #[garde(range(min = 0.01, max = 60.0))]
    pub timeout: f64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self { rate_hz: 40.0, position_sd: 0.0, yaw_sd_deg: 0.0, latency: 0.0, dropout: 0.0, timeout: 0.15 }
    }
}

/// Integration of the simulated world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Physics {
    /// Time step, s.
    #[garde(range(min = 1e-4, max = 0.1))]
    pub step: f64,
    /// Solver iterations per step.
    #[garde(range(min = 1, max = 64))]
    pub iterations: u32,
    /// Time added for each robot put into its slot by `reposition: teleport`, s; it does not count against the time limit.
    #[garde(range(min = 0.0, max = 1e4))]
    pub teleport_penalty: f64,
}

impl Default for Physics {
    fn default() -> Self {
        Self { step: 0.01, iterations: 2, teleport_penalty: 5.0 }
    }
}

/// Random displacement of every body at the start, uniform and independent, drawn from the seed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Start {
    /// Half-width for each coordinate, m.
    #[garde(range(min = 0.0, max = 1.0))]
    pub position_jitter: f64,
    /// Half-width for the yaw, degrees.
    #[garde(range(min = 0.0, max = 180.0))]
    pub yaw_jitter_deg: f64,
}
