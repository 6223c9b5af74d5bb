//! Simulated worlds: rigid bodies whose contact comes from an engine and whose friction with the ground is ours.

mod ground;
mod planar;
mod spatial;

use cohaul_core::contact::limit_surface::LimitSurface;
use cohaul_core::contact::slope::Slope;
use cohaul_core::control::Command;
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::robot::RobotModel;
use cohaul_core::scenario::document::WorldKind;
use cohaul_core::se2::{Pose2, Twist2};
use cohaul_core::time::Time;

use ground::GroundedWorld;

/// A load as a world needs it.
#[derive(Clone, Debug)]
pub struct LoadBody {
    /// Footprint with its centroid at the origin.
    pub footprint: ConvexPolygon,
    /// m.
    pub height: f64,
    /// kg.
    pub mass: f64,
    /// Coefficient of friction between robots and this load.
    pub contact_friction: f64,
    /// How its friction with the ground depends on the direction of motion.
    pub surface: LimitSurface,
    /// Pose at the start.
    pub world_from_load: Pose2,
    /// Velocity at the start, world frame.
    pub twist: Twist2,
}

/// A robot as a world needs it.
#[derive(Clone, Debug)]
pub struct RobotBody {
    /// Size, mass, limits.
    pub model: RobotModel,
    /// Pose at the start.
    pub world_from_robot: Pose2,
}

/// Everything a world is made of.
#[derive(Clone, Debug)]
pub struct WorldSetup {
    /// Inclination of the ground.
    pub slope: Slope,
    /// Coefficient of friction between a sliding load and the ground.
    pub friction_dynamic: f64,
    /// Between a resting load and the ground.
    pub friction_static: f64,
    /// Between wheels and ground.
    pub friction_wheel: f64,
    /// Loads, in the order of their ids.
    pub loads: Vec<LoadBody>,
    /// Robots, in the order of their ids.
    pub robots: Vec<RobotBody>,
    /// Fixed obstacles in the world frame.
    pub obstacles: Vec<ConvexPolygon>,
    /// Time step, ns.
    pub step_nanos: i64,
    /// Solver iterations of the engine per step.
    pub iterations: u32,
}

/// A simulated world, advanced step by step.
pub trait World: Send {
    /// Now.
    fn time(&self) -> Time;

    /// Pose of a load.
    fn load_pose(&self, load: LoadId) -> Pose2;

    /// Velocity of a load's centre, world frame.
    fn load_twist(&self, load: LoadId) -> Twist2;

    /// Pose of a robot.
    fn robot_pose(&self, robot: RobotId) -> Pose2;

    /// Forward speed and yaw rate of a robot, m/s and rad/s.
    fn robot_speeds(&self, robot: RobotId) -> Command;

    /// Force with which the ground drives a robot in the last step, N, in the plane.
    fn traction(&self, robot: RobotId) -> f64;

    /// Power that the ground fed into a robot in the last step, W; braking counts as zero.
    fn traction_power(&self, robot: RobotId) -> f64;

    /// Puts a robot somewhere else, at rest.
    fn place(&mut self, robot: RobotId, world_from_robot: &Pose2);

    /// Advances one step; `commands` holds one velocity command per robot.
    fn step(&mut self, commands: &[Command]);
}

/// Builds the world of the given kind.
pub fn build(kind: WorldKind, setup: &WorldSetup) -> Box<dyn World> {
    match kind {
        WorldKind::Planar => Box::new(GroundedWorld::new(planar::PlanarEngine::new(setup), setup)),
        WorldKind::Spatial => Box::new(GroundedWorld::new(spatial::SpatialEngine::new(setup), setup)),
    }
}
