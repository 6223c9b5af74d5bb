//! The keys of the virtual leader–follower controller.

use std::f64::consts::PI;

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of the virtual leader–follower baseline (R2P2, §V-A).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Vlf {
    /// Speed of every robot while the load translates, m/s.
    #[garde(range(min = 0.001, max = 10.0))]
    pub speed: f64,
    /// Highest speed on the way to a new place in the formation, m/s.
    #[garde(range(min = 0.001, max = 10.0))]
    pub speed_max: f64,
    /// Speed per distance on that way, 1/s.
    #[garde(range(min = 0.01, max = 100.0))]
    pub gain: f64,
    /// Distance from its new place at which a robot has arrived, m.
    #[garde(range(min = 0.001, max = 1.0))]
    pub arrival: f64,
    /// Control rate, Hz.
    #[garde(range(min = 0.1, max = 1000.0))]
    pub rate_hz: f64,
    /// Heading error that starts a rotation, rad.
    #[garde(range(min = 0.001, max = PI))]
    pub heading_threshold: f64,
    /// Heading error that ends a rotation, rad.
    #[garde(range(min = 0.0, max = PI))]
    pub heading_release: f64,
    /// Whether robots reposition themselves.
    pub reposition: bool,
    /// Control steps between two checks of the own slot while the load translates.
    #[garde(range(min = 1, max = 1_000_000))]
    pub check_interval: u32,
    /// Deviation along the edge that starts a repositioning, m.
    #[garde(range(min = 0.001, max = 10.0))]
    pub reposition_tangential: f64,
    /// Deviation of the heading that starts one when a translation begins, rad.
    #[garde(range(min = 0.001, max = PI))]
    pub reposition_heading: f64,
    /// Clearance that starts one, m.
    #[garde(range(min = 0.001, max = 10.0))]
    pub reposition_gap: f64,
}

impl Default for Vlf {
    fn default() -> Self {
        Self {
            speed: 0.1,
            speed_max: 0.22,
            gain: 1.0,
            arrival: 0.02,
            rate_hz: 20.0,
            heading_threshold: 0.2,
            heading_release: 0.1,
            reposition: true,
            check_interval: 25,
            reposition_tangential: 0.05,
            reposition_heading: 0.26,
            reposition_gap: 0.06,
        }
    }
}
