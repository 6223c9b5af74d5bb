//! What each departure from the printed equations is worth: every one switched off alone.
//!
//! # Source
//! The departures of [`cohaul_core::control::r2p2`], on the middle cell of Table I (2 kg, friction 0.01) of each terrain.
//!
//! # Deviations
//! None; time limit 400 s.

use super::Experiment;
use super::design::{Design, SINGLE, Terrain};

/// Name of the variant, and the controller's keys.
const VARIANTS: [(&str, &str); 16] = [
    ("recommended", "{}"),
    ("literal", "{variant: literal}"),
    ("no_wrap", "{wrap: false}"),
    ("no_hysteresis", "{heading_release: 0.2}"),
    ("opposite_turn_rate", "{turn_with_load: false}"),
    ("push_without_turning", "{push_turns: false}"),
    ("no_gap_feedback", "{gap_gain: 0}"),
    ("support_as_printed", "{support: literal}"),
    ("support_parked", "{support: park}"),
    ("square_stance", "{stance: square}"),
    ("prevent_as_printed", "{prevent: literal}"),
    ("square_and_prevent_as_printed", "{stance: square, prevent: literal}"),
    ("no_repositioning", "{reposition: never}"),
    ("literal_with_turn_rate", "{variant: literal, turn_with_load: true}"),
    ("literal_with_tracking_support", "{variant: literal, support: track}"),
    ("literal_with_gap_feedback", "{variant: literal, gap_gain: 1.0}"),
];

/// `r2p2-ablation`.
pub struct Ablation;

impl Experiment for Ablation {
    fn name(&self) -> &'static str {
        "r2p2-ablation"
    }

    fn about(&self) -> &'static str {
        "Each departure from the equations as printed, switched off alone; and the equations as printed, alone and with single \
         departures switched on. Middle cell of Table I: 2 kg, friction 0.01, goal at 45° and 1 m; there no angle crosses the half turn, so \
         `no_wrap` cannot differ. Time limit 400 s."
    }

    fn cells(&self) -> Vec<Design> {
        let cell = |name: &str, keys: &str, terrain| {
            Design::new(SINGLE)
                .level("variant", name)
                .terrain(terrain)
                .goal(45.0, 1.0)
                .set("loads.0.mass", 2.0)
                .set("terrain.friction.dynamic", 0.01)
                .set("teams.0.mission.time_limit", 400)
                .set("teams.0.controller", format_args!("{{r2p2: {keys}}}"))
        };
        VARIANTS.iter().flat_map(|(name, keys)| Terrain::ALL.map(|terrain| cell(name, keys, terrain))).collect()
    }
}
