//! Fig. 7: how the robots' speeds and the load's heading evolve during a rotation.
//!
//! # Source
//! [R2P2] §V-E, Fig. 7: a turn of 75° on flat ground, sliding friction 0.001 (the caption swaps it with the static 0.9). Four
//! traces: heading error, angular speed of the load, speeds of the pushing and of the preventing robots.
//!
//! # Deviations
//! The turn is the first part of a mission to a goal at 75° and 1 m. It ends when the first robot translates.
//!
//! [R2P2]: cohaul_core::_documentation::references

use std::path::Path;

use cohaul_core::control::{Decision, Observation};
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::scenario::document::Scenario;
use cohaul_core::se2::{position, wrap_angle, yaw};
use cohaul_core::time::Time;
use cohaul_core::transport::primitive::Primitive;
use cohaul_core::transport::role::Role;
use nalgebra::Vector2;

use super::design::{Design, SINGLE};
use super::figure::{self, Panels};
use super::trials::{Trial, numbers};
use super::{Experiment, Measured, Results, Section};
use crate::episode::{self, Recorder};
use crate::error::SimError;
use crate::files::{self, FileError};
use crate::outcome::End;
use crate::plot::{Lines, Series};
use crate::statistics::{ascending, quantile};
use crate::world::World;

/// One instant of a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// s.
    pub time: f64,
    /// Bearing of the goal minus the load's heading, rad.
    pub heading_error: f64,
    /// Angular speed of the load, rad/s.
    pub yaw_rate: f64,
    /// Mean speed of the pushing robots, m/s; NaN in the last instant.
    pub push: f64,
    /// Mean speed of the preventing robots, m/s; NaN in the last instant.
    pub prevent: f64,
}

/// Records the rotation at the start of a mission of one team.
#[derive(Debug)]
pub struct RotationTrace {
    goal: Vector2<f64>,
    /// What was seen, 20 times per second, until the first robot translates.
    pub instants: Vec<Instant>,
    ended: bool,
}

impl RotationTrace {
    /// For a mission whose first waypoint is `goal`, world frame, m.
    pub fn new(goal: Vector2<f64>) -> Self {
        Self { goal, instants: Vec::new(), ended: false }
    }
}

impl Recorder for RotationTrace {
    fn memory(&mut self, _: Time, _: RobotId, _: &str) -> Result<(), SimError> {
        Ok(())
    }

    fn decision(&mut self, _: &Observation, _: &Decision) -> Result<(), SimError> {
        Ok(())
    }

    fn state(&mut self, world: &dyn World, decisions: &[Decision]) -> Result<(), SimError> {
        if self.ended || decisions.iter().any(|d| d.primitive.is_none()) {
            return Ok(());
        }
        let load = world.load_pose(LoadId(0));
        let way = self.goal - position(&load);
        self.ended = decisions.iter().any(|d| d.primitive == Some(Primitive::Translate));
        let mean = |role: Role| {
            // in the last instant roles are those of the translation
            if self.ended {
                return f64::NAN;
            }
            let speeds: Vec<f64> = (0..)
                .zip(decisions)
                .filter(|(_, d)| d.role == Some(role))
                .map(|(robot, _)| world.robot_speeds(RobotId(robot)).linear)
                .collect();
            speeds.iter().sum::<f64>() / speeds.len().max(1) as f64
        };
        self.instants.push(Instant {
            time: world.time().seconds(),
            heading_error: wrap_angle(way.y.atan2(way.x) - yaw(&load)),
            yaw_rate: world.load_twist(LoadId(0)).angular,
            push: mean(Role::Push),
            prevent: mean(Role::Prevent),
        });
        Ok(())
    }
}

/// Runs the mission of one team and gives its rotation.
///
/// # Errors
/// Those of [`episode::run`].
pub fn trace(
    scenario: &Scenario,
    stop: &mut dyn FnMut(Time, Time) -> bool,
) -> Result<(crate::outcome::Outcome, Vec<Instant>), SimError> {
    let first = scenario.teams[0].mission.points().next().map_or_else(Vector2::zeros, |p| Vector2::new(p.x, p.y));
    let mut recorder = RotationTrace::new(first);
    let outcome = episode::run(scenario, &mut recorder, stop)?;
    Ok((outcome, recorder.instants))
}

/// The four traces below each other.
fn panels(instants: &[Instant]) -> Panels {
    let row = |y: &str, of: fn(&Instant) -> f64| {
        let points = instants.iter().map(|instant| (instant.time, of(instant))).collect();
        let series = vec![Series { points, joined: true, ..Series::default() }];
        vec![Lines { x: "time, s".to_owned(), y: y.to_owned(), series, ..Lines::default() }]
    };
    let mut rows = vec![
        row("heading error, °", |i| i.heading_error.to_degrees()),
        row("load, rad/s", |i| i.yaw_rate),
        row("push, m/s", |i| i.push),
        row("prevent, m/s", |i| i.prevent),
    ];
    rows[0][0].title = "A turn of 75°".to_owned();
    Panels { rows }
}

/// `r2p2-rotation`.
pub struct Rotation;

impl Experiment for Rotation {
    fn name(&self) -> &'static str {
        "r2p2-rotation"
    }

    fn about(&self) -> &'static str {
        "Fig. 7: the load turns by 75° on flat ground, friction 0.001. The paper's rotation is done at an error of 0.2 rad = \
         11.46°."
    }

    fn cells(&self) -> Vec<Design> {
        let cell = Design::new(SINGLE)
            .level("bearing_deg", 75.0)
            .goal(75.0, 1.0)
            .set("terrain.friction.dynamic", 0.001)
            .paper("rotation_error_deg", 11.46);
        vec![cell]
    }

    fn run(
        &self,
        trial: Trial,
        scenario: &Scenario,
        stop: &mut dyn FnMut(Time, Time) -> bool,
    ) -> Result<Measured, FileError> {
        let (outcome, instants) = trace(scenario, stop)?;
        if outcome.outcome == End::Interrupted {
            return Ok(None);
        }
        let mut trial = trial.with_outcome(&outcome)?;
        if let Some(last) = instants.last() {
            trial.push("rotation_time_s", last.time);
            trial.push("rotation_error_deg", last.heading_error.to_degrees().abs());
        }
        let peak = instants.iter().map(|i| i.yaw_rate.abs()).fold(0.0, f64::max);
        trial.push("peak_yaw_rate", peak);
        Ok(Some(trial))
    }

    fn figures(&self, results: &Results, folder: &Path) -> Result<(), FileError> {
        for design in self.cells() {
            let cell = design.cell(&results.world, &results.changes)?;
            let scenario = files::draw(&cell.scenario, Some(results.seed))?;
            let (_, instants) = trace(&scenario, &mut |_, _| false)?;
            figure::save(folder, self.name(), &panels(&instants))?;
        }
        Ok(())
    }

    fn sections(&self, results: &Results) -> Vec<Section> {
        let of = |name: &str| {
            let values = ascending(&numbers(&results.trials, name));
            format!("{:.2} ({:.2} to {:.2})", quantile(&values, 0.5), quantile(&values, 0.0), quantile(&values, 1.0))
        };
        let text = format!(
            "Median (least to greatest) over the seeds: the rotation takes {} s and ends at an error of {}°; the load turns at \
             most {} rad/s. The paper's threshold is 11.46°.",
            of("rotation_time_s"),
            of("rotation_error_deg"),
            of("peak_yaw_rate"),
        );
        vec![Section::text("The rotation", text)]
    }
}
