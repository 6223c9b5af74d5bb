//! Certifies the way of a load: how near load and robots come to anything, worked out anew from the scenario alone.
//!
//! # Method
//! The way is the one that the controller's rules give for the scenario's waypoints: on each the load turns to the bearing of the
//! next, the shorter way round, then translates. Distances are those between the load's polygon, the robots' discs in
//! their slots, obstacles and walls, in one pose at a time. A branch and bound over poses makes that a bound on all poses: the
//! body moves by at most the way of its centre plus its reach times the turn, so a piece of the way around a pose with distance d
//! keeps at least d less that. Pieces are halved until the bound is within [`RESOLUTION`] of a distance found.
//!
//! Shares nothing but data types with the planner.

use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

use cohaul_core::control::r2p2::Parameters;
use cohaul_core::geometry::query::{distance_polygon_circle, distance_polygons};
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::scenario::document::{Controller, Drive, Scenario};
use cohaul_core::se2::{Pose2, pose, position, wrap_angle, yaw};
use nalgebra::{Point2, Vector2};

use super::Obstruction;

/// Difference between the bound and a distance that occurs, m.
pub const RESOLUTION: f64 = 0.002;
/// Most poses looked at: ways of thousands of legs among hundreds of obstacles stay below.
const POSES: usize = 200_000;

/// How near load and robots come to anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// They keep at least this distance, m; infinite where nothing is around.
    pub least: f64,
    /// Pose of the load where they come this near, within [`RESOLUTION`].
    pub world_from_load: Pose2,
    /// To what.
    pub nearest: Option<Obstruction>,
}

impl Clearance {
    /// Refuses a clearance below `needed` m by more than [`RESOLUTION`].
    ///
    /// # Errors
    /// [`Refused::TooNear`].
    pub fn at_least(self, needed: f64) -> Result<Self, Refused> {
        if self.least + RESOLUTION >= needed { Ok(self) } else { Err(Refused::TooNear { clearance: self, needed }) }
    }
}

impl fmt::Display for Clearance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(nearest) = self.nearest else { return write!(f, "with nothing around") };
        let at = position(&self.world_from_load);
        write!(
            f,
            "at least {:.3} m clear of everything, nearest to {nearest} at ({:.2}, {:.2})",
            self.least, at.x, at.y
        )
    }
}

/// Why a way is not certified.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// It comes too near to something.
    #[error("{clearance}, where {needed:.3} m are needed")]
    TooNear {
        /// How near.
        clearance: Clearance,
        /// How far it should stay, m.
        needed: f64,
    },
    /// The scenario cannot be built, or has no such team.
    #[error("the scenario cannot be built")]
    Scenario,
    /// The way is too long to be looked at.
    #[error("the way has too many poses to be looked at")]
    TooLong,
}

/// The body with all that is around.
struct Surroundings {
    load: ConvexPolygon,
    robots: Vec<Vector2<f64>>,
    radius: f64,
    /// Farthest point of the body from the load's centre, m.
    reach: f64,
    obstacles: Vec<(ConvexPolygon, Pose2, Obstruction)>,
    walls: Option<[f64; 4]>,
}

/// A straight piece or a turn: poses between two ends.
#[derive(Clone, Copy)]
struct Piece {
    from: Vector2<f64>,
    to: Vector2<f64>,
    yaw: f64,
    turn: f64,
}

impl Piece {
    fn middle(&self) -> Pose2 {
        let at = (self.from + self.to) / 2.0;
        pose(at.x, at.y, self.yaw + self.turn / 2.0)
    }

    fn halves(&self) -> [Self; 2] {
        let middle = (self.from + self.to) / 2.0;
        let half = self.turn / 2.0;
        [Self { to: middle, turn: half, ..*self }, Self { from: middle, yaw: self.yaw + half, turn: half, ..*self }]
    }

    /// How far any point of a body with `reach` is at most from where it is in the middle.
    fn motion(&self, reach: f64) -> f64 {
        ((self.to - self.from).norm() + reach * self.turn.abs()) / 2.0
    }
}

/// A piece with a bound on its distances; the least first.
struct Bounded(f64, Piece);

impl Ord for Bounded {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.0.total_cmp(&self.0)
    }
}

impl PartialOrd for Bounded {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Bounded {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Bounded {}

/// How near the load of team `team` (from 0) and its robots come to anything on the way to the goal, within [`RESOLUTION`].
///
/// # Errors
/// A scenario that cannot be built, or a way too long to be looked at.
pub fn clearance(scenario: &Scenario, team: usize) -> Result<Clearance, Refused> {
    let surroundings = Surroundings::new(scenario, team).ok_or(Refused::Scenario)?;
    let pieces = pieces(scenario, team).ok_or(Refused::Scenario)?;
    let mut open = BinaryHeap::new();
    let mut least = Clearance { least: f64::INFINITY, world_from_load: Pose2::identity(), nearest: None };
    let mut poses = 0;
    let mut look = |piece: Piece, least: &mut Clearance| {
        poses += 1;
        let world_from_load = piece.middle();
        let (distance, nearest) = surroundings.distance(&world_from_load);
        if distance < least.least {
            *least = Clearance { least: distance, world_from_load, nearest };
        }
        let bound = distance - piece.motion(surroundings.reach);
        (poses <= POSES).then_some(Bounded(bound, piece)).ok_or(Refused::TooLong)
    };
    for piece in pieces {
        open.push(look(piece, &mut least)?);
    }
    while let Some(Bounded(bound, piece)) = open.pop() {
        if bound >= least.least - RESOLUTION || least.least <= 0.0 {
            // what is left keeps at least that
            least.least = least.least.min(bound.max(least.least - RESOLUTION));
            break;
        }
        for half in piece.halves() {
            open.push(look(half, &mut least)?);
        }
    }
    Ok(least)
}

/// The way as turns and straight pieces.
fn pieces(scenario: &Scenario, team: usize) -> Option<Vec<Piece>> {
    let spec = scenario.teams.get(team)?;
    let load = scenario.loads.iter().find(|load| load.id == spec.load)?;
    let either_way = match &spec.controller {
        Controller::R2p2(keys) => Parameters::new(keys).drive == Drive::Nearest,
        Controller::Vlf(_) => false,
    };
    let start = load.pose.pose();
    let (mut at, mut heading) = (position(&start), yaw(&start));
    let mut pieces = Vec::new();
    for point in spec.mission.points() {
        let to = Vector2::new(point.x, point.y);
        let way = to - at;
        if way.norm() > 0.0 {
            let ahead = wrap_angle(way.y.atan2(way.x) - heading);
            let turn = if either_way && ahead.abs() > FRAC_PI_2 { wrap_angle(ahead - PI) } else { ahead };
            pieces.push(Piece { from: at, to: at, yaw: heading, turn });
            heading += turn;
        }
        pieces.push(Piece { from: at, to, yaw: heading, turn: 0.0 });
        at = to;
    }
    if let Some(goal) = spec.mission.goal_yaw() {
        pieces.push(Piece { from: at, to: at, yaw: heading, turn: wrap_angle(goal.yaw - heading) });
    }
    Some(pieces)
}

impl Surroundings {
    fn new(scenario: &Scenario, team: usize) -> Option<Self> {
        let instance = scenario.instance().ok()?;
        let built = instance.teams.get(team)?;
        let load = instance.loads.get(built.load.index())?.polygon.clone();
        let robots: Vec<Vector2<f64>> =
            (0..built.robots()).map(|place| position(&built.formation.load_from_robot(place))).collect();
        let radius = built.model.radius;
        let reach = robots.iter().map(|robot| robot.norm() + radius).fold(load.radius(), f64::max);
        let fixed = instance.obstacles.iter().enumerate();
        let mut obstacles: Vec<_> =
            fixed.map(|(index, o)| (o.clone(), Pose2::identity(), Obstruction::Obstacle(index))).collect();
        for (index, other) in instance.loads.iter().enumerate() {
            if !instance.teams.iter().any(|team| team.load.index() == index) {
                obstacles.push((other.polygon.clone(), other.world_from_load, Obstruction::Load(index)));
            }
        }
        Some(Self { load, robots, radius, reach, obstacles, walls: scenario.terrain.walls })
    }

    /// Distance of the body from what is nearest, m; at most 0 if they overlap.
    fn distance(&self, world_from_load: &Pose2) -> (f64, Option<Obstruction>) {
        let mut least = (f64::INFINITY, None);
        let mut take = |distance: f64, what: Obstruction| {
            if distance < least.0 {
                least = (distance, Some(what));
            }
            least.0
        };
        let center = position(world_from_load);
        let robots: Vec<Vector2<f64>> =
            self.robots.iter().map(|robot| (world_from_load * Point2::from(*robot)).coords).collect();
        if let Some([x_min, y_min, x_max, y_max]) = self.walls {
            let inside = |at: &Vector2<f64>| (at.x - x_min).min(x_max - at.x).min(at.y - y_min).min(y_max - at.y);
            for corner in self.load.vertices() {
                take(inside(&(world_from_load * Point2::from(*corner)).coords), Obstruction::Wall);
            }
            for robot in &robots {
                take(inside(robot) - self.radius, Obstruction::Wall);
            }
        }
        for (obstacle, world_from_obstacle, what) in &self.obstacles {
            // the nearest point of the body is nearer than its centre by at most its reach
            let far = distance_polygon_circle(obstacle, world_from_obstacle, &center, self.reach);
            if far >= take(f64::INFINITY, *what) {
                continue;
            }
            take(distance_polygons(&self.load, world_from_load, obstacle, world_from_obstacle), *what);
            for robot in &robots {
                take(distance_polygon_circle(obstacle, world_from_obstacle, robot, self.radius), *what);
            }
        }
        least
    }
}
