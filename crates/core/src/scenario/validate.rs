//! Rules between values: names, shapes, formations, room at the start.

use nalgebra::Vector2;

use super::document::{Caging, Controller, Plan, Point, R2p2, Scenario, Slots, Team};
use super::error::{Fault, Problem};
use super::instance::Instance;
use super::tree::{Node, Value};
use crate::control::r2p2::Parameters;
use crate::geometry::query::{distance_polygon_circle, distance_polygons};
use crate::geometry::shape::{ConvexPolygon, ShapeError};
use crate::se2::{Pose2, position};
use crate::transport::formation::FormationError;

/// How many robots the planner finds slots for.
const AUTO: std::ops::RangeInclusive<usize> = 3..=12;

/// Checks the rules in the order of the file; gives the warnings.
pub(crate) fn validate(scenario: &Scenario, tree: &Node) -> Result<Vec<Fault>, Fault> {
    let rules = Rules { scenario, tree };
    rules.names()?;
    rules.regions()?;
    rules.values()?;
    let instance = scenario.bodies(true).map_err(|problem| rules.locate(problem))?;
    let mut warnings = Vec::new();
    rules.formations(&instance, &mut warnings)?;
    rules.points(&instance)?;
    rules.room(&instance)?;
    Ok(warnings)
}

struct Rules<'a> {
    scenario: &'a Scenario,
    tree: &'a Node,
}

impl Rules<'_> {
    fn fault(&self, path: &str, problem: Problem) -> Fault {
        Fault { problem, place: self.tree.place(path) }
    }

    fn contradiction(&self, path: String, reason: String, remedy: &str) -> Result<(), Fault> {
        Err(self.fault(&path.clone(), Problem::Contradiction { path, reason, remedy: remedy.to_owned() }))
    }

    /// Finds the key at fault for a problem with a body.
    fn locate(&self, problem: Problem) -> Fault {
        let team_index = |id: &String| self.scenario.teams.iter().position(|team| team.id == *id).unwrap_or_default();
        let path = match &problem {
            Problem::Shape { path, error: ShapeError::NotConvex { index } | ShapeError::NotFinite { index } } => {
                let corner = format!("{path}.{index}");
                if self.tree.get(&corner).is_some() { corner } else { path.clone() }
            }
            Problem::Shape { path, .. } => path.clone(),
            Problem::UnknownLoad { team, .. } => format!("teams.{}.load", team_index(team)),
            Problem::Formation { team, error } => {
                let team = team_index(team);
                let slots = &self.scenario.teams[team].formation.slots;
                match (error, slots) {
                    (FormationError::Count { .. }, _) => format!("teams.{team}.robots.count"),
                    (FormationError::Edge { slot, .. }, _) => {
                        format!("teams.{team}.formation.slots.custom.{slot}.edge")
                    }
                    (FormationError::Overlap { second, .. }, Slots::Custom(_)) => {
                        format!("teams.{team}.formation.slots.custom.{second}")
                    }
                    (FormationError::NotRectangle { .. }, _) => format!("teams.{team}.formation.slots"),
                    _ => format!("teams.{team}.formation.contact_placement"),
                }
            }
            _ => String::new(),
        };
        self.fault(&path, problem)
    }

    fn names(&self) -> Result<(), Fault> {
        let loads: Vec<_> = self.scenario.loads.iter().map(|load| &load.id).collect();
        let teams: Vec<_> = self.scenario.teams.iter().map(|team| &team.id).collect();
        for (kind, ids) in [("loads", loads), ("teams", teams)] {
            for (i, id) in ids.iter().enumerate() {
                if ids[..i].contains(id) {
                    let problem = Problem::DuplicateId { kind, id: (*id).clone() };
                    return Err(self.fault(&format!("{kind}.{i}.id"), problem));
                }
            }
        }
        for (i, team) in self.scenario.teams.iter().enumerate() {
            if let Some(other) = self.scenario.teams[..i].iter().find(|other| other.load == team.load) {
                let problem =
                    Problem::SharedLoad { first: other.id.clone(), second: team.id.clone(), load: team.load.clone() };
                return Err(self.fault(&format!("teams.{i}.load"), problem));
            }
        }
        Ok(())
    }

    fn regions(&self) -> Result<(), Fault> {
        let terrain = &self.scenario.terrain;
        for (name, region) in [("walls", terrain.walls), ("workspace", terrain.workspace)] {
            if let Some([x_min, y_min, x_max, y_max]) = region
                && !(x_min < x_max && y_min < y_max)
            {
                let reason = format!("[{x_min}, {y_min}, {x_max}, {y_max}] is not [x_min, y_min, x_max, y_max]");
                return self.contradiction(
                    format!("terrain.{name}"),
                    reason,
                    "give the lower corner first: [x_min, y_min, x_max, y_max]",
                );
            }
        }
        if let Some(breakaway) = terrain.friction.breakaway
            && breakaway < terrain.friction.dynamic
        {
            let reason =
                format!("static friction {breakaway} is less than dynamic friction {}", terrain.friction.dynamic);
            return self.contradiction(
                "terrain.friction.static".to_owned(),
                reason,
                "a load at rest holds at least as well as a sliding one: raise static, lower dynamic, or write null",
            );
        }
        Ok(())
    }

    fn values(&self) -> Result<(), Fault> {
        for (i, team) in self.scenario.teams.iter().enumerate() {
            let count = team.robots.count;
            if team.formation.slots == Slots::Auto && !AUTO.contains(&count) {
                let reason = format!("slots `auto` are for {} to {} robots, not {count}", AUTO.start(), AUTO.end());
                return self.contradiction(
                    format!("teams.{i}.robots.count"),
                    reason,
                    "change the number of robots, or list `custom` slots, one per robot",
                );
            }
            if let Some(rates) = &team.robots.rates_hz
                && rates.len() != count
            {
                let reason = format!("{} rates for {count} robots", rates.len());
                return self.contradiction(
                    format!("teams.{i}.robots.rates_hz"),
                    reason,
                    "give one rate per robot, or leave rates_hz out",
                );
            }
            let waypoints = format!("teams.{i}.mission.waypoints");
            if team.mission.waypoints.is_empty()
                && self.tree.get(&waypoints).is_some_and(|node| matches!(node.value, Value::List(_)))
            {
                return Err(self.fault(&waypoints.clone(), Problem::EmptyWaypoints { path: waypoints }));
            }
            if team.mission.plan == Plan::Auto && !team.mission.waypoints.is_empty() {
                let reason = "the plan is `auto`, but waypoints are given".to_owned();
                return self.contradiction(waypoints, reason, "leave out `waypoints`, or `plan: auto`");
            }
            match &team.controller {
                Controller::R2p2(r2p2) => self.r2p2(i, team, r2p2)?,
                Controller::Vlf(vlf) => {
                    self.release(&format!("teams.{i}.controller.vlf"), vlf.heading_release, vlf.heading_threshold)?;
                }
            }
        }
        Ok(())
    }

    fn r2p2(&self, i: usize, team: &Team, r2p2: &R2p2) -> Result<(), Fault> {
        let keys = format!("teams.{i}.controller.r2p2");
        let base = team.robots.model().limits.linear;
        if let Some(low) = r2p2.speed_min
            && low > r2p2.speed_max.unwrap_or(base)
        {
            let high = r2p2.speed_max.map_or(format!("the base's {base} m/s"), |high| format!("speed_max {high}"));
            return self.contradiction(
                format!("{keys}.speed_min"),
                format!("{low} m/s is more than {high}"),
                "lower speed_min or raise speed_max up to what the base can do",
            );
        }
        if let Some(release) = r2p2.heading_release {
            self.release(&keys, release, Parameters::new(r2p2).heading_threshold)?;
        }
        Ok(())
    }

    /// A rotation ends below the error that starts it.
    fn release(&self, keys: &str, release: f64, threshold: f64) -> Result<(), Fault> {
        if release <= threshold {
            return Ok(());
        }
        let reason = format!("{release} rad is more than heading_threshold {threshold}");
        self.contradiction(
            format!("{keys}.heading_release"),
            reason,
            "a rotation ends below the error that starts it: lower heading_release",
        )
    }

    fn formations(&self, instance: &Instance, warnings: &mut Vec<Fault>) -> Result<(), Fault> {
        for (i, (team, built)) in self.scenario.teams.iter().zip(&instance.teams).enumerate() {
            let load = &instance.loads[built.load.index()].polygon;
            let length = (0..load.vertices().len()).map(|edge| load.edge(edge).length()).fold(0.0, f64::max);
            let needed = 4.0 * built.model.radius;
            if length <= needed {
                let problem = Problem::ShortEdge { load: team.load.clone(), length, needed };
                warnings
                    .push(self.fault(&self.scenario.loads[built.load.index()].shape_path(built.load.index()), problem));
            }
            if team.formation.slots == Slots::Auto {
                continue; // checked when the slots are chosen
            }
            if let Some(gap) = built.formation.caging_gaps(load).into_iter().next() {
                let fault =
                    self.fault(&format!("teams.{i}.formation.caging"), Problem::Caging { team: team.id.clone(), gap });
                match caging(team) {
                    Caging::Required => return Err(fault),
                    Caging::Partial => warnings.push(fault),
                    Caging::None => {}
                }
            }
        }
        Ok(())
    }

    /// Starts, waypoints and goals are inside, and none of the latter in an obstacle.
    fn points(&self, instance: &Instance) -> Result<(), Fault> {
        for (i, load) in self.scenario.loads.iter().enumerate() {
            let what = format!("load `{}`'s start", load.id);
            self.inside(&format!("loads.{i}.pose"), &what, Vector2::new(load.pose.x, load.pose.y))?;
        }
        for (i, team) in self.scenario.teams.iter().enumerate() {
            let waypoints = team.mission.waypoints.iter().enumerate().map(|(k, at)| {
                (format!("teams.{i}.mission.waypoints.{k}"), format!("team `{}`'s waypoint {k}", team.id), at)
            });
            let goal = (format!("teams.{i}.mission.goal"), format!("team `{}`'s goal", team.id), &team.mission.goal);
            for (path, what, Point { x, y }) in waypoints.chain([goal]) {
                let at = Vector2::new(*x, *y);
                self.inside(&path, &what, at)?;
                for (obstacle, polygon) in instance.obstacles.iter().enumerate() {
                    if distance_polygon_circle(polygon, &Pose2::identity(), &at, 0.0) < 0.0 {
                        let problem = Problem::InObstacle { what, x: at.x, y: at.y, obstacle };
                        return Err(self.fault(&path, problem));
                    }
                }
            }
        }
        Ok(())
    }

    fn inside(&self, path: &str, what: &str, at: Vector2<f64>) -> Result<(), Fault> {
        let terrain = &self.scenario.terrain;
        for (region, limits) in [("walls", terrain.walls), ("workspace", terrain.workspace)] {
            if let Some(limits) = limits
                && clearance(limits, &at) < 0.0
            {
                let problem = Problem::Outside { what: what.to_owned(), x: at.x, y: at.y, region };
                return Err(self.fault(path, problem));
            }
        }
        Ok(())
    }

    /// No two bodies overlap at the start.
    fn room(&self, instance: &Instance) -> Result<(), Fault> {
        let bodies = self.bodies(instance);
        let obstacles: Vec<_> = instance.obstacles.iter().map(Body::fixed).collect();
        for (i, first) in bodies.iter().enumerate() {
            if let Some(walls) = self.scenario.terrain.walls {
                let clear = first.corners().iter().map(|at| clearance(walls, at)).fold(f64::INFINITY, f64::min)
                    - first.margin();
                if clear < 0.0 {
                    let problem =
                        Problem::Overlap { first: first.name(), second: "a wall".to_owned(), depth: Some(-clear) };
                    return Err(self.fault(&first.path(), problem));
                }
            }
            for second in &bodies[..i] {
                if first.load == second.load {
                    continue; // the formation keeps its robots apart and off the load
                }
                if let Some(depth) = first.overlap(second) {
                    let problem = Problem::Overlap { first: first.name(), second: second.name(), depth };
                    return Err(self.fault(&first.path(), problem));
                }
            }
            for (obstacle, fixed) in obstacles.iter().enumerate() {
                if let Some(depth) = first.overlap(fixed) {
                    let problem =
                        Problem::Overlap { first: first.name(), second: format!("obstacle {obstacle}"), depth };
                    return Err(self.fault(&format!("terrain.obstacles.{obstacle}"), problem));
                }
            }
        }
        Ok(())
    }

    fn bodies<'a>(&'a self, instance: &'a Instance) -> Vec<Body<'a>> {
        let mut bodies = Vec::new();
        for (load, built) in instance.loads.iter().enumerate() {
            bodies.push(Body {
                shape: BodyShape::Polygon(&built.polygon, built.world_from_load),
                center: position(&built.world_from_load),
                reach: built.polygon.radius(),
                label: Label::Load(&self.scenario.loads[load].id),
                load,
            });
        }
        for (team, built) in instance.teams.iter().enumerate() {
            for place in 0..built.robots() {
                bodies.push(Body {
                    shape: BodyShape::Circle,
                    center: position(&instance.start_pose_of_robot(team, place)),
                    reach: built.model.radius,
                    label: Label::Robot(place, &self.scenario.teams[team].id),
                    load: built.load.index(),
                });
            }
        }
        bodies
    }
}

/// What the scenario means where it does not say.
fn caging(team: &Team) -> Caging {
    let default = if team.formation.slots == Slots::Six { Caging::Required } else { Caging::Partial };
    team.formation.caging.unwrap_or(default)
}

/// Distance of a point from the sides of a rectangle, m; negative outside.
fn clearance([x_min, y_min, x_max, y_max]: [f64; 4], at: &Vector2<f64>) -> f64 {
    (at.x - x_min).min(x_max - at.x).min(at.y - y_min).min(y_max - at.y)
}

enum BodyShape<'a> {
    Circle,
    Polygon(&'a ConvexPolygon, Pose2),
}

enum Label<'a> {
    Load(&'a str),
    Robot(usize, &'a str),
    Obstacle,
}

/// A body at the start, in the world, m.
struct Body<'a> {
    shape: BodyShape<'a>,
    center: Vector2<f64>,
    reach: f64,
    label: Label<'a>,
    /// The load it is or moves.
    load: usize,
}

impl<'a> Body<'a> {
    fn fixed(polygon: &'a ConvexPolygon) -> Self {
        let center = polygon.centroid();
        let reach = polygon.vertices().iter().map(|v| (v - center).norm()).fold(0.0, f64::max);
        let shape = BodyShape::Polygon(polygon, Pose2::identity());
        Self { shape, center, reach, label: Label::Obstacle, load: usize::MAX }
    }

    fn name(&self) -> String {
        match self.label {
            Label::Load(id) => format!("load `{id}`"),
            Label::Robot(place, team) => format!("robot {place} of team `{team}`"),
            Label::Obstacle => "an obstacle".to_owned(),
        }
    }

    /// What moves it: the pose of its load.
    fn path(&self) -> String {
        format!("loads.{}.pose", self.load)
    }

    fn corners(&self) -> Vec<Vector2<f64>> {
        match &self.shape {
            BodyShape::Circle => vec![self.center],
            BodyShape::Polygon(polygon, pose) => {
                polygon.vertices().iter().map(|v| (pose * nalgebra::Point2::from(*v)).coords).collect()
            }
        }
    }

    /// How far the body reaches beyond its corners, m.
    fn margin(&self) -> f64 {
        if matches!(self.shape, BodyShape::Circle) { self.reach } else { 0.0 }
    }

    /// `None` if they are apart or touch; else the depth, where one of them is a circle.
    fn overlap(&self, other: &Self) -> Option<Option<f64>> {
        if (self.center - other.center).norm() > self.reach + other.reach {
            return None;
        }
        let depth = match (&self.shape, &other.shape) {
            (BodyShape::Circle, BodyShape::Circle) => self.reach + other.reach - (self.center - other.center).norm(),
            (BodyShape::Circle, BodyShape::Polygon(polygon, pose)) => {
                -distance_polygon_circle(polygon, pose, &self.center, self.reach)
            }
            (BodyShape::Polygon(polygon, pose), BodyShape::Circle) => {
                -distance_polygon_circle(polygon, pose, &other.center, other.reach)
            }
            (BodyShape::Polygon(first, first_pose), BodyShape::Polygon(second, second_pose)) => {
                return (distance_polygons(first, first_pose, second, second_pose) <= 0.0).then_some(None);
            }
        };
        (depth > 0.0).then_some(Some(depth))
    }
}
