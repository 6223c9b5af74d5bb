//! What a path is asked for: the moving body, what is in the way, where from and where to.

use cohaul_core::control::r2p2::Parameters;
use cohaul_core::scenario::Problem;
use cohaul_core::scenario::document::{Controller, Drive, Mission, Plan, Scenario, Terrain};
use cohaul_core::se2::{position, yaw};
use nalgebra::{Point2, Vector2};

use super::body::{Body, distance_to_segment};
use super::{Obstruction, margin};

/// Thickness of the slabs that stand for walls, m.
const SLAB: f64 = 1.0;
/// Heading beyond the controller's threshold that a load was seen to have against the straight line of a leg, rad.
const BEYOND_THRESHOLD: f64 = 0.1;

/// Something fixed.
#[derive(Clone, Debug)]
pub(super) struct Obstacle {
    /// Counter-clockwise, world, m.
    pub corners: Vec<Vector2<f64>>,
    /// What it is.
    pub what: Obstruction,
    /// Centre of a circle around it, m.
    center: Vector2<f64>,
    /// Radius of that circle, m.
    radius: f64,
}

impl Obstacle {
    fn new(corners: Vec<Vector2<f64>>, what: Obstruction) -> Self {
        let center = corners.iter().sum::<Vector2<f64>>() / corners.len().max(1) as f64;
        let radius = corners.iter().map(|corner| (corner - center).norm()).fold(0.0, f64::max);
        Self { corners, what, center, radius }
    }

    /// A distance that the way `from`–`to` surely keeps from it, m.
    pub fn least_distance(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
        distance_to_segment(&self.center, from, to) - self.radius
    }

    /// The same for another obstacle.
    pub fn least_distance_of(&self, other: &Self) -> f64 {
        (self.center - other.center).norm() - self.radius - other.radius
    }
}

/// One load's way.
#[derive(Clone, Debug)]
pub(super) struct Task {
    pub body: Body,
    pub obstacles: Vec<Obstacle>,
    pub start: Vector2<f64>,
    pub start_yaw: f64,
    pub goal: Vector2<f64>,
    pub goal_yaw: Option<f64>,
    /// Where the load's centre may be: lower and upper corner, m.
    pub region: Option<(Vector2<f64>, Vector2<f64>)>,
    /// Distance to keep, m.
    pub margin: f64,
    /// Whether the load may travel backwards.
    pub either_way: bool,
    /// Whether turns go the shorter way round.
    pub wraps: bool,
}

impl Task {
    /// The task of team `team` of a scenario whose slots are chosen.
    ///
    /// # Errors
    /// A scenario that cannot be built.
    pub fn new(scenario: &Scenario, team: usize) -> Result<Option<Self>, Problem> {
        let mut given = scenario.clone();
        for team in &mut given.teams {
            team.mission.plan = Plan::Given;
        }
        let instance = given.instance()?;
        let (Some(built), Some(spec)) = (instance.teams.get(team), scenario.teams.get(team)) else { return Ok(None) };
        let load = built.load.index();
        let mission = &spec.mission;
        let (threshold, either_way, wraps) = match &spec.controller {
            Controller::R2p2(keys) => {
                let parameters = Parameters::new(keys);
                (parameters.heading_threshold, parameters.drive == Drive::Nearest, parameters.wrap)
            }
            Controller::Vlf(keys) => (keys.heading_threshold, false, true),
        };
        let radius = built.model.radius;
        let robots: Vec<Vector2<f64>> =
            (0..built.robots()).map(|place| position(&built.formation.load_from_robot(place))).collect();
        let polygon = instance.load_polygon(load);
        let mut obstacles = Vec::new();
        for (index, obstacle) in instance.obstacles.iter().enumerate() {
            obstacles.push(Obstacle::new(obstacle.vertices().to_vec(), Obstruction::Obstacle(index)));
        }
        for (index, other) in instance.loads.iter().enumerate() {
            if instance.teams.iter().all(|team| team.load.index() != index) {
                // nobody moves it
                let corners = other.polygon.vertices().iter();
                let corners = corners.map(|v| (other.world_from_load * Point2::from(*v)).coords).collect();
                obstacles.push(Obstacle::new(corners, Obstruction::Load(index)));
            }
        }
        obstacles.extend(slabs(&scenario.terrain));
        let start = instance.start_pose_of_load(load);
        Ok(Some(Self {
            body: Body::new(polygon, &robots, radius, threshold + BEYOND_THRESHOLD),
            obstacles,
            start: position(&start),
            start_yaw: yaw(&start),
            goal: Vector2::new(mission.goal.x, mission.goal.y),
            goal_yaw: mission.goal_yaw().map(|goal| goal.yaw),
            region: region(&scenario.terrain, mission),
            margin: margin(mission.tolerance),
            either_way,
            wraps,
        }))
    }

    /// Whether the load's centre may be at `at`.
    pub fn is_inside(&self, at: &Vector2<f64>) -> bool {
        self.region.is_none_or(|(low, high)| at.x >= low.x && at.y >= low.y && at.x <= high.x && at.y <= high.y)
    }
}

/// The walls as four slabs outside of them.
fn slabs(terrain: &Terrain) -> Vec<Obstacle> {
    let Some([x_min, y_min, x_max, y_max]) = terrain.walls else { return Vec::new() };
    let slab = |[left, low, right, high]: [f64; 4]| {
        let corners = [(left, low), (right, low), (right, high), (left, high)].map(|(x, y)| Vector2::new(x, y));
        Obstacle::new(corners.to_vec(), Obstruction::Wall)
    };
    let (low, high) = (y_min - SLAB, y_max + SLAB);
    vec![
        slab([x_min - SLAB, low, x_min, high]),
        slab([x_max, low, x_max + SLAB, high]),
        slab([x_min, low, x_max, y_min]),
        slab([x_min, y_max, x_max, high]),
    ]
}

/// Where the load's centre may be: within the walls, and within the workspace with room for a load that misses its line.
fn region(terrain: &Terrain, mission: &Mission) -> Option<(Vector2<f64>, Vector2<f64>)> {
    let mut region: Option<(Vector2<f64>, Vector2<f64>)> = None;
    for (limits, room) in [(terrain.walls, 0.0), (terrain.workspace, margin(mission.tolerance))] {
        let Some([x_min, y_min, x_max, y_max]) = limits else { continue };
        let (low, high) = (Vector2::new(x_min + room, y_min + room), Vector2::new(x_max - room, y_max - room));
        region = Some(region.map_or((low, high), |(a, b)| (a.sup(&low), b.inf(&high))));
    }
    region
}
