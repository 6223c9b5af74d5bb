//! The parameters of R2P2, every one decided.

use crate::scenario::document::{self, Drive, Prevent, Reposition, Stance, Support, Variant};

/// Parameters with every value decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Pushing speed per heading error, m/s per rad.
    pub rotation_gain: f64,
    /// Pushing speed per distance, 1/s.
    pub translation_gain: f64,
    /// Lowest pushing speed, m/s.
    pub speed_min: f64,
    /// Highest speed, m/s.
    pub speed_max: f64,
    /// Highest speed of a preventing robot, m/s.
    pub load_speed_max: f64,
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Heading error that starts a rotation, rad.
    pub heading_threshold: f64,
    /// Heading error that ends a rotation, rad.
    pub heading_release: f64,
    /// Shortest signed angles.
    pub wrap: bool,
    /// What a supporting robot does.
    pub support: Support,
    /// How robots stand to the edge.
    pub stance: Stance,
    /// At which speed preventing robots give way.
    pub prevent: Prevent,
    /// Whether a pushing robot turns with the load.
    pub push_turns: bool,
    /// Whether ω has the load's sense.
    pub turn_with_load: bool,
    /// Speed per clearance at which a preventing robot returns to the edge, 1/s.
    pub gap_gain: f64,
    /// Which way round the load travels.
    pub drive: Drive,
    /// How robots return to their slots.
    pub reposition: Reposition,
    /// Control steps between two checks of the own slot.
    pub check_interval: u32,
    /// Deviation along the edge that starts a repositioning, m.
    pub reposition_tangential: f64,
    /// Deviation of the heading that starts a repositioning, rad.
    pub reposition_heading: f64,
    /// Clearance that starts a repositioning, m.
    pub reposition_gap: f64,
}

impl Parameters {
    /// The values of `keys`, those not given taken from its variant.
    pub fn new(keys: &document::R2p2) -> Self {
        let literal = keys.variant == Variant::Literal;
        let heading_threshold = keys.heading_threshold.unwrap_or(0.2);
        Self {
            rotation_gain: keys.rotation_gain.unwrap_or(0.25),
            translation_gain: keys.translation_gain.unwrap_or(0.3),
            speed_min: keys.speed_min.unwrap_or(0.1),
            speed_max: keys.speed_max.unwrap_or(0.22),
            load_speed_max: keys.load_speed_max.unwrap_or(0.22),
            rate_hz: keys.rate_hz.unwrap_or(20.0),
            heading_threshold,
            heading_release: keys.heading_release.unwrap_or(if literal {
                heading_threshold
            } else {
                heading_threshold.min(0.1)
            }),
            wrap: keys.wrap.unwrap_or(!literal),
            support: keys.support.unwrap_or(if literal { Support::Literal } else { Support::Track }),
            stance: keys.stance.unwrap_or(if literal { Stance::Square } else { Stance::Arc }),
            prevent: keys.prevent.unwrap_or(if literal { Prevent::Literal } else { Prevent::Paced }),
            push_turns: keys.push_turns.unwrap_or(!literal),
            turn_with_load: keys.turn_with_load.unwrap_or(!literal),
            gap_gain: keys.gap_gain.unwrap_or(if literal { 0.0 } else { 1.0 }),
            reposition: keys.reposition.unwrap_or(Reposition::Drive),
            drive: keys.drive.unwrap_or(Drive::Forward),
            check_interval: keys.check_interval.unwrap_or(25),
            reposition_tangential: keys.reposition_tangential.unwrap_or(0.05),
            reposition_heading: keys.reposition_heading.unwrap_or(0.26),
            reposition_gap: keys.reposition_gap.unwrap_or(0.06),
        }
    }
}
