//! Table II (b): bearings up to 75° with a tolerance of 10 cm.
//!
//! # Source
//! [R2P2] §V-D, Table II (b): five bearings on three terrains, friction 0.1 sliding and 0.9 at rest, every mission a success.
//!
//! # Deviations
//! The paper gives neither range nor unit of the mass 0.05: 1 m as in Table I, and kilograms. Its 0.9 is read as the friction
//! between wheels and ground (see `r2p2-breakaway` for the other reading).
//!
//! [R2P2]: cohaul_core::_documentation::references

use super::Experiment;
use super::design::{Design, SINGLE, Terrain};

/// Mass of the load in Table II, kg.
pub(super) const MASS: f64 = 0.05;

/// `r2p2-tight`.
pub struct Tight;

impl Experiment for Tight {
    fn name(&self) -> &'static str {
        "r2p2-tight"
    }

    fn about(&self) -> &'static str {
        "Table II (b): R2P2 at bearings of 15° to 75° on three terrains, tolerance 0.10 m."
    }

    fn cells(&self) -> Vec<Design> {
        let bearings = [15.0, 30.0, 45.0, 60.0, 75.0];
        let cell = |terrain, bearing: f64| {
            Design::new(SINGLE)
                .terrain(terrain)
                .level("bearing_deg", bearing)
                .goal(bearing, 1.0)
                .set("loads.0.mass", MASS)
                .set("teams.0.mission.tolerance", 0.1)
                .paper("outcome", "S")
        };
        Terrain::ALL.iter().flat_map(|terrain| bearings.map(|bearing| cell(*terrain, bearing))).collect()
    }
}
