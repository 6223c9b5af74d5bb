//! Missions whose waypoints were planned through obstacles.
//!
//! # Source
//! Not in [R2P2], which takes waypoints as given. Maps come from [`clutter`].
//!
//! # Deviations
//! None: the controller knows nothing of obstacles, the planner keeps load and robots away from them. How far the missions leave
//! the room that the plan took into account is what the plan's margin was chosen by.
//!
//! [R2P2]: cohaul_core::_documentation::references

use cohaul_core::control::{Decision, Observation};
use cohaul_core::geometry::query::{distance_polygon_circle, distance_polygons};
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::scenario::document::Scenario;
use cohaul_core::scenario::{Instance, Problem};
use cohaul_core::se2::{Pose2, position};
use cohaul_core::time::Time;
use cohaul_planner::load_path::swept::Swept;
use cohaul_planner::load_path::{self, clutter};
use nalgebra::{Point2, Vector2};

use super::design::{CLUTTER, Design};
use super::trials::{Trial, numbers};
use super::{Experiment, Measured, Results, Section};
use crate::episode::{self, Recorder};
use crate::error::SimError;
use crate::files::FileError;
use crate::outcome::End;
use crate::statistics::{ascending, quantile};
use crate::world::World;

/// Maps of the table.
const MAPS: usize = 20;
/// Consecutive seeds that share their maps: seeds 1 to 5, 6 to 10, …
const SHARED: u64 = 5;

/// What a mission takes of the room around its way.
struct Room {
    swept: Swept,
    instance: Instance,
    walls: Option<[f64; 4]>,
    /// Farthest beyond the room of the plan, m.
    beyond: f64,
    /// Least distance of load and robots from obstacles and walls, m.
    clear: f64,
}

impl Room {
    fn new(scenario: &Scenario) -> Result<Option<Self>, Problem> {
        let Some(swept) = Swept::new(scenario, 0)? else { return Ok(None) };
        let instance = scenario.instance()?;
        let walls = scenario.terrain.walls;
        Ok(Some(Self { swept, instance, walls, beyond: f64::NEG_INFINITY, clear: f64::INFINITY }))
    }
}

impl Recorder for Room {
    fn memory(&mut self, _: Time, _: RobotId, _: &str) -> Result<(), SimError> {
        Ok(())
    }

    fn decision(&mut self, _: &Observation, _: &Decision) -> Result<(), SimError> {
        Ok(())
    }

    fn state(&mut self, world: &dyn World, _: &[Decision]) -> Result<(), SimError> {
        let load = world.load_pose(LoadId(0));
        let team = &self.instance.teams[0];
        let robots: Vec<Vector2<f64>> =
            (0..team.robots()).map(|robot| position(&world.robot_pose(RobotId(robot as u16)))).collect();
        self.beyond = self.beyond.max(self.swept.beyond(&load, &robots));
        let polygon = self.instance.load_polygon(0);
        for obstacle in &self.instance.obstacles {
            self.clear = self.clear.min(distance_polygons(polygon, &load, obstacle, &Pose2::identity()));
            for robot in &robots {
                let distance = distance_polygon_circle(obstacle, &Pose2::identity(), robot, team.model.radius);
                self.clear = self.clear.min(distance);
            }
        }
        if let Some([x_min, y_min, x_max, y_max]) = self.walls {
            let inside = |at: &Vector2<f64>| (at.x - x_min).min(x_max - at.x).min(at.y - y_min).min(y_max - at.y);
            for corner in polygon.vertices() {
                self.clear = self.clear.min(inside(&(load * Point2::from(*corner)).coords));
            }
            for robot in &robots {
                self.clear = self.clear.min(inside(robot) - team.model.radius);
            }
        }
        Ok(())
    }
}

/// `r2p2-clutter`.
pub struct Clutter;

impl Experiment for Clutter {
    fn name(&self) -> &'static str {
        "r2p2-clutter"
    }

    fn about(&self) -> &'static str {
        "Waypoints planned through 6 to 12 obstacles (`plan: auto`): 20 maps, ten metres from start to goal, the straight line \
         blocked. Every five consecutive seeds have maps of their own. Not in the paper."
    }

    fn trials(&self) -> usize {
        SHARED as usize
    }

    fn cells(&self) -> Vec<Design> {
        (1..=MAPS).map(|map| Design::new(CLUTTER).level("map", map).set("terrain.obstacles", "[]")).collect()
    }

    fn run(
        &self,
        mut trial: Trial,
        scenario: &Scenario,
        stop: &mut dyn FnMut(Time, Time) -> bool,
    ) -> Result<Measured, FileError> {
        let map = trial.key.level("map").map(ToString::to_string).and_then(|map| map.parse().ok()).unwrap_or(0_u64);
        let set = trial.seed.saturating_sub(1) / SHARED;
        let open = clutter::scenario(scenario, set.wrapping_mul(MAPS as u64).wrapping_add(map))?;
        let (scenario, _, planned) = load_path::resolve_with(&open)?;
        let Some(mut room) = Room::new(&scenario).map_err(SimError::from)? else { return Ok(None) };
        let outcome = episode::run(&scenario, &mut room, stop)?;
        if outcome.outcome == End::Interrupted {
            return Ok(None);
        }
        trial.record(&outcome)?;
        trial.push("obstacles", scenario.terrain.obstacles.len());
        for way in &planned {
            trial.push("waypoints", way.path.waypoints.len());
            trial.push("planned_length_m", way.path.length);
            trial.push("planned_turning_rad", way.path.turning);
            trial.push("planned_clearance_m", way.clearance.least);
        }
        trial.push("clearance_m", room.clear);
        trial.push("beyond_plan_m", room.beyond);
        Ok(Some(trial))
    }

    fn sections(&self, results: &Results) -> Vec<Section> {
        let of = |name: &str| {
            let values = ascending(&numbers(&results.trials, name));
            format!("{:.3} ({:.3} to {:.3})", quantile(&values, 0.5), quantile(&values, 0.0), quantile(&values, 1.0))
        };
        let touched = numbers(&results.trials, "clearance_m").iter().filter(|clear| **clear <= 0.0).count();
        let text = format!(
            "Median (least to greatest): the ways planned are {} m long with {} waypoints and keep {} m from everything. In the \
             missions load and robots leave the room that the plan took into account by {} m, where its margin is {:.2} m, and \
             keep {} m from obstacles and walls; {touched} of {} touch one.",
            of("planned_length_m"),
            of("waypoints"),
            of("planned_clearance_m"),
            of("beyond_plan_m"),
            load_path::margin(0.1),
            of("clearance_m"),
            results.trials.len(),
        );
        vec![Section::text("Room", text)]
    }
}
