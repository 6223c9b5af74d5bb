//! The referee: measures an episode and tells when it is over, from the true poses.
//!
//! # Source
//! [R2P2] §V: success, failure A (time), failure B (the load slips out of the formation or down the slope, robots collide).
//!
//! # Deviations
//! Failure B is not defined in numbers there. Here: two or more robots farther than 0.6 m from their slots, the load's centre
//! outside the hull of three or more robots, or more than 1 m farther from the next waypoint than it ever was on the way to
//! it and at its start; a collision is a distance of centres below two radii less 5 mm.
//!
//! [R2P2]: cohaul_core::_documentation::references

use cohaul_core::control::Command;
use cohaul_core::control::guidance::GoalYaw;
use cohaul_core::geometry::query::distance_polygon_circle;
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::scenario::Instance;
use cohaul_core::scenario::document::Scenario;
use cohaul_core::se2::{Pose2, position, wrap_angle, yaw};
use cohaul_core::transport::formation::CagingPair;
use nalgebra::Vector2;

use crate::outcome::{End, Outcome};
use crate::world::World;

/// A robot farther from its slot than this has left the formation, m.
const LEFT_SLOT: f64 = 0.6;
/// A load that recedes from its waypoint by more than this is lost, m.
const RECEDED: f64 = 1.0;
/// Overlap of two robots that counts as a collision, m.
const COLLISION: f64 = 0.005;

/// One team under observation.
struct TeamScore {
    load: LoadId,
    first_robot: usize,
    /// Slot centres in the load's frame, m.
    slots: Vec<Vector2<f64>>,
    pairs: Vec<CagingPair>,
    /// Start, then the waypoints, the goal last.
    path: Vec<Vector2<f64>>,
    tolerance: f64,
    goal_yaw: Option<GoalYaw>,
    radius: f64,
    /// Waypoints passed.
    passed: usize,
    /// Distance from the next waypoint when the last one was passed, m.
    leg: f64,
    last: Vector2<f64>,
    length: f64,
    deviation_squared: f64,
    deviation_max: f64,
    looks: usize,
}

/// Everything measured in an episode.
pub(crate) struct Score {
    teams: Vec<TeamScore>,
    robots: usize,
    radii: Vec<f64>,
    obstacles: Vec<ConvexPolygon>,
    workspace: Option<[f64; 4]>,
    repositions: usize,
    reposition_time: f64,
    stopped: bool,
    control_effort: f64,
    energy: f64,
    min_distance: f64,
    min_clearance: f64,
    caging_violation: f64,
    penalty_per_teleport: f64,
    teleports: usize,
}

impl Score {
    pub(crate) fn new(scenario: &Scenario, instance: &Instance, world: &dyn World) -> Self {
        let teams: Vec<TeamScore> = instance
            .teams
            .iter()
            .enumerate()
            .map(|(team, built)| {
                let mission = &scenario.teams[team].mission;
                let start = position(&world.load_pose(built.load));
                let mut path = vec![start];
                path.extend(mission.points().map(|p| Vector2::new(p.x, p.y)));
                TeamScore {
                    load: built.load,
                    first_robot: built.first_robot.index(),
                    slots: (0..built.robots()).map(|p| position(&built.formation.load_from_robot(p))).collect(),
                    pairs: built.formation.caging_pairs(instance.load_polygon(built.load.index())),
                    leg: (path[1] - start).norm(),
                    path,
                    tolerance: mission.tolerance,
                    goal_yaw: mission.goal_yaw(),
                    radius: built.model.radius,
                    passed: 0,
                    last: start,
                    length: 0.0,
                    deviation_squared: 0.0,
                    deviation_max: 0.0,
                    looks: 0,
                }
            })
            .collect();
        let radii: Vec<f64> =
            instance.teams.iter().flat_map(|t| std::iter::repeat_n(t.model.radius, t.robots())).collect();
        Self {
            teams,
            robots: radii.len(),
            radii,
            obstacles: instance.obstacles.clone(),
            workspace: scenario.terrain.workspace,
            repositions: 0,
            reposition_time: 0.0,
            stopped: false,
            control_effort: 0.0,
            energy: 0.0,
            min_distance: f64::INFINITY,
            min_clearance: f64::INFINITY,
            caging_violation: 0.0,
            penalty_per_teleport: scenario.physics.teleport_penalty,
            teleports: 0,
        }
    }

    /// A robot was put into its slot.
    pub(crate) fn teleported(&mut self) {
        self.teleports += 1;
    }

    /// Adds one step of `dt` seconds; `stopped` tells whether any stop flag is up.
    pub(crate) fn step(&mut self, world: &dyn World, dt: f64, stopped: bool) {
        if stopped {
            self.reposition_time += dt;
            self.repositions += usize::from(!self.stopped);
        }
        self.stopped = stopped;
        for robot in 0..self.robots {
            let robot = RobotId(robot as u16);
            let Command { linear, lateral, angular } = world.robot_speeds(robot);
            self.control_effort += (linear * linear + lateral * lateral + angular * angular) * dt;
            self.energy += world.traction_power(robot) * dt;
        }
    }

    /// Looks at the world, `dt` seconds after the last look; tells how the mission ended if it did.
    pub(crate) fn look(&mut self, world: &dyn World, dt: f64) -> Option<End> {
        let mut end = None;
        for a in 0..self.robots {
            let at = position(&world.robot_pose(RobotId(a as u16)));
            for b in a + 1..self.robots {
                let distance = (position(&world.robot_pose(RobotId(b as u16))) - at).norm();
                let clearance = distance - self.radii[a] - self.radii[b];
                self.min_distance = self.min_distance.min(distance);
                self.min_clearance = self.min_clearance.min(clearance);
                if clearance < -COLLISION {
                    end = Some(End::Collided);
                }
            }
            for obstacle in &self.obstacles {
                self.min_clearance =
                    self.min_clearance.min(distance_polygon_circle(obstacle, &Pose2::identity(), &at, self.radii[a]));
            }
        }
        let mut all_reached = true;
        for team in &mut self.teams {
            let lost = team.look(world, dt, &mut self.caging_violation, self.workspace.as_ref());
            if lost {
                end = end.or(Some(End::LoadLost));
            }
            all_reached &= team.passed + 1 == team.path.len();
        }
        end.or(all_reached.then_some(End::Reached))
    }

    pub(crate) fn outcome(&self, world: &dyn World, end: End) -> Outcome {
        let over = |f: &dyn Fn(&TeamScore) -> f64| self.teams.iter().map(f).fold(0.0, f64::max);
        Outcome {
            outcome: end,
            success: end == End::Reached,
            time_s: world.time().seconds(),
            final_error_m: over(&|t| (t.goal() - position(&world.load_pose(t.load))).norm()),
            final_yaw_error_rad: over(&|t| {
                let leg = t.goal() - t.path[t.path.len() - 2];
                let wanted = t.goal_yaw.map_or(leg.y.atan2(leg.x), |goal| goal.yaw);
                wrap_angle(wanted - yaw(&world.load_pose(t.load))).abs()
            }),
            waypoints_reached: self.teams.iter().map(|t| t.passed).sum(),
            repositions: self.repositions,
            reposition_time_s: self.reposition_time,
            min_robot_distance_m: self.min_distance,
            min_clearance_m: self.min_clearance,
            path_length_m: over(&|t| t.length),
            path_deviation_rms_m: over(&|t| (t.deviation_squared / t.looks.max(1) as f64).sqrt()),
            path_deviation_max_m: over(&|t| t.deviation_max),
            control_effort: self.control_effort,
            energy_j: self.energy,
            caging_violation_s: self.caging_violation,
            penalty_s: self.teleports as f64 * self.penalty_per_teleport,
        }
    }
}

impl TeamScore {
    fn goal(&self) -> Vector2<f64> {
        self.path[self.path.len() - 1]
    }

    /// Whether the load has the orientation that the goal asks for.
    fn is_oriented(&self, world_from_load: &Pose2) -> bool {
        self.goal_yaw.is_none_or(|goal| wrap_angle(goal.yaw - yaw(world_from_load)).abs() < goal.tolerance)
    }

    /// Measures the team's load; whether it is lost.
    fn look(&mut self, world: &dyn World, dt: f64, violation: &mut f64, workspace: Option<&[f64; 4]>) -> bool {
        let world_from_load = world.load_pose(self.load);
        let center = position(&world_from_load);
        let robot = |place: usize| position(&world.robot_pose(RobotId((self.first_robot + place) as u16)));
        self.length += (center - self.last).norm();
        self.last = center;
        while self.passed + 1 < self.path.len()
            && (self.path[self.passed + 1] - center).norm() < self.tolerance
            && (self.passed + 2 < self.path.len() || self.is_oriented(&world_from_load))
        {
            self.passed += 1;
            self.leg = self.path.get(self.passed + 1).map_or(0.0, |next| (next - center).norm());
        }
        let from = self.path[self.passed.min(self.path.len() - 2)];
        let to = self.path[(self.passed + 1).min(self.path.len() - 1)];
        let deviation = distance_to_segment(&center, &from, &to);
        self.deviation_squared += deviation * deviation;
        self.deviation_max = self.deviation_max.max(deviation);
        self.looks += 1;
        let open =
            |pair: &CagingPair| (robot(pair.first) - robot(pair.second)).norm() - 2.0 * self.radius >= pair.limit;
        if self.pairs.iter().any(open) {
            *violation += dt;
        }
        if self.passed + 1 == self.path.len() {
            return false;
        }
        let strayed = (0..self.slots.len())
            .filter(|place| {
                let slot = world_from_load * nalgebra::Point2::from(self.slots[*place]);
                (robot(*place) - slot.coords).norm() > LEFT_SLOT
            })
            .count();
        let outside = workspace
            .is_some_and(|[x0, y0, x1, y1]| !(*x0..=*x1).contains(&center.x) || !(*y0..=*y1).contains(&center.y));
        strayed >= 2
            || outside
            || (to - center).norm() > self.leg + RECEDED
            || (self.slots.len() >= 3 && !encloses(&center, (0..self.slots.len()).map(robot)))
    }
}

/// Distance of `point` from the segment, m.
fn distance_to_segment(point: &Vector2<f64>, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
    (point - from - share * along).norm()
}

/// Whether `point` lies in the convex hull of `others`: no half-plane through it is free of them.
fn encloses(point: &Vector2<f64>, others: impl Iterator<Item = Vector2<f64>>) -> bool {
    let mut bearings: Vec<f64> = others.map(|o| (o.y - point.y).atan2(o.x - point.x)).collect();
    bearings.sort_by(f64::total_cmp);
    let Some(first) = bearings.first().copied() else { return false };
    let next = bearings.iter().skip(1).copied().chain([first + std::f64::consts::TAU]);
    bearings.iter().zip(next).all(|(a, b)| b - a <= std::f64::consts::PI)
}
