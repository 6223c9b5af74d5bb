//! How far a mission left the room that its plan took into account: what the margin is measured by.

use cohaul_core::scenario::Problem;
use cohaul_core::scenario::document::Scenario;
use cohaul_core::se2::{Pose2, wrap_angle};
use nalgebra::{Point2, Vector2};

use super::body::{CLASS, signed_distance};
use super::task::Task;

/// The room that the planner takes for one way: the sweep of every leg and of every turn, without the margin.
#[derive(Clone, Debug)]
pub struct Swept {
    /// Convex, counter-clockwise, world, m.
    pieces: Vec<Vec<Vector2<f64>>>,
    load: Vec<Vector2<f64>>,
    radius: f64,
}

impl Swept {
    /// Of the way of team `team` (from 0) of a resolved scenario; `None` if there is no such team.
    ///
    /// # Errors
    /// A scenario that cannot be built.
    pub fn new(scenario: &Scenario, team: usize) -> Result<Option<Self>, Problem> {
        let instance = scenario.instance()?;
        let (Some(task), Some(built)) = (Task::new(scenario, team)?, instance.teams.get(team)) else { return Ok(None) };
        let mut pieces = Vec::new();
        let (mut at, mut heading) = (task.start, task.start_yaw);
        let turn = |at: &Vector2<f64>, from: f64, to: f64, pieces: &mut Vec<_>| {
            let turn = wrap_angle(to - from);
            let steps = (turn.abs() / CLASS).ceil() as usize;
            let headings = (0..=steps).map(|k| from + turn * k as f64 / steps.max(1) as f64);
            pieces.extend(headings.map(|heading| task.body.standing(at, super::body::class_of(heading))));
        };
        for point in scenario.teams[team].mission.points() {
            let to = Vector2::new(point.x, point.y);
            let way = to - at;
            let mut ahead = way.y.atan2(way.x);
            if task.either_way && wrap_angle(ahead - heading).abs() > std::f64::consts::FRAC_PI_2 {
                ahead += std::f64::consts::PI;
            }
            turn(&at, heading, ahead, &mut pieces);
            pieces.push(task.body.passing(&at, &to, ahead));
            (at, heading) = (to, ahead);
        }
        if let Some(yaw) = task.goal_yaw {
            turn(&at, heading, yaw, &mut pieces);
        }
        let load = instance.load_polygon(built.load.index()).vertices().to_vec();
        Ok(Some(Self { pieces, load, radius: built.model.radius }))
    }

    /// How far the load and its robots reach beyond that room, m; negative if all of them lie within it.
    pub fn beyond(&self, world_from_load: &Pose2, robots: &[Vector2<f64>]) -> f64 {
        let from_pieces = |at: &Vector2<f64>| {
            self.pieces.iter().map(|piece| signed_distance(at, piece)).fold(f64::INFINITY, f64::min)
        };
        let corners = self.load.iter().map(|v| from_pieces(&(world_from_load * Point2::from(*v)).coords));
        let bodies = robots.iter().map(|robot| from_pieces(robot) + self.radius);
        corners.chain(bodies).fold(f64::NEG_INFINITY, f64::max)
    }
}
