//! What R2P2 withstands: noise, loss and age of poses, wrong mass and friction.
//!
//! # Source
//! Not in [R2P2], which assumes exact poses and known properties. One factor varies at a time; the others stay as in the
//! middle cell of Table I (2 kg, friction 0.01).
//!
//! # Deviations
//! Robots stop when the last pose is older than 0.15 s. With a constant latency every pose is older than that, so the limit is
//! 0.15 s beyond the latency.
//!
//! [R2P2]: cohaul_core::_documentation::references

use std::path::Path;

use super::design::{Design, SINGLE, Terrain};
use super::figure::{self, Panels};
use super::summary::CellSummary;
use super::trials::Level;
use super::{Experiment, Results};
use crate::files::FileError;
use crate::plot::{Lines, Series};

/// Mass and friction of the undisturbed cell.
const MASS: f64 = 2.0;
const FRICTION: f64 = 0.01;

/// Success over one disturbance, a series per terrain.
fn curve(results: &Results, disturbance: &str, x: &str) -> Lines {
    let wanted = Level::from(disturbance);
    let series = Terrain::ALL
        .iter()
        .map(|terrain| {
            let name = Level::from(terrain.name());
            let cells = results.cells.iter().filter(|cell| {
                cell.key.level("disturbance") == Some(&wanted) && cell.key.level("terrain") == Some(&name)
            });
            let of_level = |cell: &CellSummary| match cell.key.level("level") {
                Some(Level::Number(level)) => *level,
                _ => f64::NAN,
            };
            let (points, intervals) = cells
                .map(|cell| {
                    ((of_level(cell), cell.reached as f64 / cell.n.max(1) as f64), (cell.wilson[0], cell.wilson[1]))
                })
                .unzip();
            Series {
                name: terrain.name().to_owned(),
                points,
                intervals,
                joined: true,
                marked: true,
                ..Series::default()
            }
        })
        .collect();
    Lines {
        x: x.to_owned(),
        y: "share that reached the goal".to_owned(),
        y_shows: Some((0.0, 1.0)),
        series,
        ..Lines::default()
    }
}

/// `r2p2-robustness`.
pub struct Robustness;

impl Experiment for Robustness {
    fn name(&self) -> &'static str {
        "r2p2-robustness"
    }

    fn about(&self) -> &'static str {
        "Success over pose noise (0 to 2 cm with 0 to 4°, at 40 Hz), lost poses, their age, and over mass and friction that \
         are half to one and a half times the nominal 2 kg and 0.01. Time limit 400 s."
    }

    fn figures(&self, results: &Results, folder: &Path) -> Result<(), FileError> {
        let rows =
            [("noise_cm", "sd of the position, cm"), ("dropout", "share of lost poses"), ("latency_ms", "latency, ms")];
        let more = [("mass_factor", "mass ÷ 2 kg"), ("friction_factor", "friction ÷ 0.01")];
        let row = |factors: &[(&str, &str)]| factors.iter().map(|(name, x)| curve(results, name, x)).collect();
        figure::save(folder, self.name(), &Panels { rows: vec![row(&rows), row(&more)] })
    }

    fn cells(&self) -> Vec<Design> {
        let mut cells = Vec::new();
        for terrain in Terrain::ALL {
            let cell = |disturbance: &str, level: f64| {
                Design::new(SINGLE)
                    .level("disturbance", disturbance)
                    .level("level", level)
                    .terrain(terrain)
                    .goal(45.0, 1.0)
                    .set("loads.0.mass", MASS)
                    .set("terrain.friction.dynamic", FRICTION)
                    .set("teams.0.mission.time_limit", 400)
            };
            for noise_cm in [0.0, 0.25, 0.5, 1.0, 1.5, 2.0] {
                cells.push(
                    cell("noise_cm", noise_cm)
                        .set("sensors.position_sd", noise_cm / 100.0)
                        .set("sensors.yaw_sd_deg", 2.0 * noise_cm),
                );
            }
            for dropout in [0.0, 0.1, 0.2, 0.3, 0.5, 0.7] {
                cells.push(cell("dropout", dropout).set("sensors.dropout", dropout));
            }
            for latency_ms in [0.0, 50.0, 100.0, 150.0, 200.0] {
                let latency = latency_ms / 1000.0;
                cells.push(
                    cell("latency_ms", latency_ms)
                        .set("sensors.latency", latency)
                        .set("sensors.timeout", 0.15 + latency),
                );
            }
            for factor in [0.5, 0.75, 1.0, 1.25, 1.5] {
                cells.push(cell("mass_factor", factor).set("loads.0.mass", MASS * factor));
                cells.push(cell("friction_factor", factor).set("terrain.friction.dynamic", FRICTION * factor));
            }
        }
        cells
    }
}
