//! The bodies of a scenario: "parse, then trust".

use nalgebra::Vector2;

use super::document::{Ballast, BallastPlace, Load, Plan, Pose, RobotKind, Robots, Scenario, Shape, Slots, Team};
use super::error::Problem;
use crate::geometry::shape::{ConvexPolygon, ShapeError};
use crate::id::{LoadId, RobotId};
use crate::kinematics::BaseLimits;
use crate::robot::RobotModel;
use crate::se2::{Pose2, pose};
use crate::transport::formation::{Formation, FormationError};

/// Every body of a scenario, built once.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The loads, in the order of the file.
    pub loads: Vec<LoadInstance>,
    /// The teams, in the order of the file.
    pub teams: Vec<TeamInstance>,
    /// The obstacles in the world, m.
    pub obstacles: Vec<ConvexPolygon>,
}

/// A load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadInstance {
    /// Footprint about the centroid; the heading is the x axis, m.
    pub polygon: ConvexPolygon,
    /// Where it starts.
    pub world_from_load: Pose2,
}

/// A team.
#[derive(Clone, Debug, PartialEq)]
pub struct TeamInstance {
    /// Its load.
    pub load: LoadId,
    /// Its robots, all alike.
    pub model: RobotModel,
    /// Their slots.
    pub formation: Formation,
    /// Its first robot; the others follow.
    pub first_robot: RobotId,
}

impl TeamInstance {
    /// How many robots it has.
    pub fn robots(&self) -> usize {
        self.formation.slots().len()
    }
}

impl Scenario {
    /// Every body of the scenario.
    ///
    /// # Errors
    /// None for a scenario that came from [`parse`](super::parse), unless it leaves the choice of slots or the waypoints to
    /// the planner ([`Slots::Auto`], [`Plan::Auto`]).
    pub fn instance(&self) -> Result<Instance, Problem> {
        if let Some(team) = self.teams.iter().find(|team| team.mission.plan == Plan::Auto) {
            return Err(Problem::Unplanned { team: team.id.clone() });
        }
        self.bodies(false)
    }

    /// Every body of the scenario; teams whose slots are still to be chosen have no robots yet if `unresolved` allows it.
    pub(crate) fn bodies(&self, unresolved: bool) -> Result<Instance, Problem> {
        let shape = |path: String| move |error| Problem::Shape { path, error };
        let mut loads = Vec::new();
        for (i, load) in self.loads.iter().enumerate() {
            let polygon = load.polygon().map_err(shape(load.shape_path(i)))?;
            loads.push(LoadInstance { polygon, world_from_load: load.pose.pose() });
        }
        let mut obstacles = Vec::new();
        for (i, corners) in self.terrain.obstacles.iter().enumerate() {
            obstacles.push(polygon(corners).map_err(shape(format!("terrain.obstacles.{i}")))?);
        }
        let mut teams = Vec::new();
        let mut first_robot: u16 = 0;
        for team in &self.teams {
            let unknown = || Problem::UnknownLoad {
                team: team.id.clone(),
                load: team.load.clone(),
                loads: self.loads.iter().map(|load| load.id.clone()).collect(),
            };
            let load = self.loads.iter().position(|load| load.id == team.load).ok_or_else(unknown)?;
            let model = team.robots.model();
            let formation = if unresolved && team.formation.slots == Slots::Auto {
                Formation::unresolved(team.formation.gap, model.radius)
            } else {
                team.formation(&loads[load].polygon)
                    .map_err(|error| Problem::Formation { team: team.id.clone(), error })?
            };
            let robots = formation.slots().len();
            teams.push(TeamInstance { load: LoadId(load as u16), model, formation, first_robot: RobotId(first_robot) });
            first_robot = first_robot.saturating_add(robots as u16);
        }
        Ok(Instance { loads, teams, obstacles })
    }
}

impl Instance {
    /// Footprint of load `load` about its centroid, m.
    pub fn load_polygon(&self, load: usize) -> &ConvexPolygon {
        &self.loads[load].polygon
    }

    /// The robots of team `team`.
    pub fn robot_model(&self, team: usize) -> &RobotModel {
        &self.teams[team].model
    }

    /// The slots of team `team`.
    pub fn formation(&self, team: usize) -> &Formation {
        &self.teams[team].formation
    }

    /// Where load `load` starts, before any jitter.
    pub fn start_pose_of_load(&self, load: usize) -> Pose2 {
        self.loads[load].world_from_load
    }

    /// Where the robot at `place` of team `team` starts, before any jitter: in its slot.
    pub fn start_pose_of_robot(&self, team: usize, place: usize) -> Pose2 {
        let team = &self.teams[team];
        self.loads[team.load.index()].world_from_load * team.formation.load_from_robot(place)
    }
}

impl Pose {
    /// As a rigid motion, m and rad.
    pub fn pose(&self) -> Pose2 {
        pose(self.x, self.y, self.yaw_deg.to_radians())
    }
}

impl Load {
    /// Footprint about the centroid, m: the heading is the x axis, a rectangle's length lies along y.
    ///
    /// # Errors
    /// Corners that make no convex polygon.
    pub fn polygon(&self) -> Result<ConvexPolygon, ShapeError> {
        match &self.shape {
            Shape::Rectangle { length, width } => ConvexPolygon::rectangle(*width, *length),
            Shape::Polygon { vertices } => Ok(polygon(vertices)?.centred()),
        }
    }

    pub(crate) fn shape_path(&self, index: usize) -> String {
        match self.shape {
            Shape::Rectangle { .. } => format!("loads.{index}.shape.rectangle"),
            Shape::Polygon { .. } => format!("loads.{index}.shape.polygon.vertices"),
        }
    }
}

impl Team {
    /// The slots around a load with footprint `load`.
    ///
    /// # Errors
    /// See [`FormationError`].
    pub fn formation(&self, load: &ConvexPolygon) -> Result<Formation, FormationError> {
        let formation = &self.formation;
        let radius = self.robots.model().radius;
        Formation::new(load, &formation.slots, self.robots.count, formation.contact_placement, formation.gap, radius)
    }
}

impl Robots {
    /// Size, mass with ballast, traction and limits of each robot.
    pub fn model(&self) -> RobotModel {
        let base = match self.model {
            RobotKind::Turtlebot3Burger => RobotModel::TURTLEBOT3_BURGER,
            RobotKind::Omnidirectional => RobotModel::OMNIDIRECTIONAL,
        };
        let limits = BaseLimits {
            linear_acceleration: self.acceleration,
            angular_acceleration: self.angular_acceleration,
            command_step: self.command_step,
            ..base.limits
        };
        let (mass, on_wheels) = match self.ballast {
            None => (0.0, 0.0),
            Some(Ballast { mass, at: BallastPlace::Front }) => (mass, mass),
            Some(Ballast { mass, at: BallastPlace::Rear }) => (mass, 0.0),
        };
        RobotModel { mass: base.mass + mass, mass_on_wheels: base.mass_on_wheels + on_wheels, limits, ..base }
    }
}

fn polygon(corners: &[[f64; 2]]) -> Result<ConvexPolygon, ShapeError> {
    let corners: Vec<_> = corners.iter().map(|[x, y]| Vector2::new(*x, *y)).collect();
    ConvexPolygon::new(&corners)
}
