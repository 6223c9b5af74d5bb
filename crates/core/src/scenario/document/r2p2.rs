//! The keys of the R2P2 controller.

use std::f64::consts::PI;

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of R2P2. Whatever is not given comes from `variant`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct R2p2 {
    /// Which reading of the paper the other keys default to.
    pub variant: Variant,
    /// Pushing speed per heading error, m/s per rad (the reciprocal of the paper's k_p).
    #[garde(range(min = 0.001, max = 100.0))]
    pub rotation_gain: Option<f64>,
    /// Pushing speed per distance, 1/s (the reciprocal of the paper's k_p).
    #[garde(range(min = 0.001, max = 100.0))]
    pub translation_gain: Option<f64>,
    /// Lowest pushing speed, m/s.
    #[garde(range(min = 0.0, max = 10.0))]
    pub speed_min: Option<f64>,
    /// Highest speed, m/s.
    #[garde(range(min = 0.001, max = 10.0))]
    pub speed_max: Option<f64>,
    /// Highest speed at which a preventing robot gives way, m/s (v_max of eq. 4).
    #[garde(range(min = 0.0, max = 10.0))]
    pub load_speed_max: Option<f64>,
    /// Control rate, Hz.
    #[garde(range(min = 0.1, max = 1000.0))]
    pub rate_hz: Option<f64>,
    /// Heading error that starts a rotation, rad (ε of §IV-A).
    #[garde(range(min = 0.001, max = PI))]
    pub heading_threshold: Option<f64>,
    /// Heading error that ends a rotation, rad.
    #[garde(range(min = 0.0, max = PI))]
    pub heading_release: Option<f64>,
    /// Shortest signed angles instead of the unwrapped comparison of §IV-A.
    pub wrap: Option<bool>,
    /// What a supporting robot does.
    pub support: Option<Support>,
    /// How robots stand to the edge while they work.
    pub stance: Option<Stance>,
    /// At which speed preventing robots give way.
    pub prevent: Option<Prevent>,
    /// Whether a pushing robot turns with the load; the paper has ω = 0 (eq. 3).
    pub push_turns: Option<bool>,
    /// Whether ω of eqs. 4 and 5 has the load's sense; the paper prints the opposite one.
    pub turn_with_load: Option<bool>,
    /// Speed per clearance at which a preventing robot returns to the edge, 1/s; eq. 4 has none.
    #[garde(range(min = 0.0, max = 100.0))]
    pub gap_gain: Option<f64>,
    /// How robots return to their slots.
    pub reposition: Option<Reposition>,
    /// Which way round the load travels.
    pub drive: Option<Drive>,
    /// Control steps between two checks of the own slot.
    #[garde(range(min = 1, max = 1_000_000))]
    pub check_interval: Option<u32>,
    /// Deviation along the edge that starts a repositioning, m.
    #[garde(range(min = 0.001, max = 10.0))]
    pub reposition_tangential: Option<f64>,
    /// Deviation of the heading that starts a repositioning, rad.
    #[garde(range(min = 0.001, max = PI))]
    pub reposition_heading: Option<f64>,
    /// Clearance that starts a repositioning, m.
    #[garde(range(min = 0.001, max = 10.0))]
    pub reposition_gap: Option<f64>,
}

/// Which reading of the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    /// The equations as they work.
    #[default]
    Recommended,
    /// The equations as printed.
    Literal,
}

/// What a supporting robot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// Follows its slot.
    Track,
    /// Eq. 5 as printed.
    Literal,
    /// Stands still until it has to reposition itself.
    Park,
}

/// How robots stand to the edge while they work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stance {
    /// Along the path of their slot: tangential to its arc while the load turns.
    Arc,
    /// Square to the edge, as in the paper.
    Square,
}

/// At which speed preventing robots give way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Prevent {
    /// At the speed that the pushing robots aim at (eq. 3).
    Paced,
    /// At the speed that the load has (eq. 4).
    Literal,
}

/// How robots return to their slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reposition {
    /// They drive there while the others wait.
    Drive,
    /// The simulator puts them there at once, for a fixed penalty (R2P2, §VI); `physics.teleport_penalty`.
    Teleport,
    /// They do not.
    Never,
}

/// Which way round a load travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Heading first, as in the paper.
    Forward,
    /// Heading first or last, whichever needs less turning.
    Nearest,
}
