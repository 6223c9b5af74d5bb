//! The spatial world: rapier3d moves the bodies and resolves their contacts.
//!
//! Robots are balls at the load's mid-height, locked to the plane, that do not touch the ground: cylinders climb the load's
//! edge or jam on it. Loads rest on the ground plane without engine friction; the ground friction is ours.

use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::se2::{Pose2, Twist2, yaw};
use nalgebra::Vector2;
use rapier3d::prelude::{
    CoefficientCombineRule, ColliderBuilder, Group, InteractionGroups, InteractionTestMode, PhysicsWorld, Pose,
    RigidBodyBuilder, RigidBodyHandle, Rotation, SharedShape, Vector,
};

use super::WorldSetup;
use super::ground::Engine;

const LOAD: Group = Group::GROUP_1;
const ROBOT: Group = Group::GROUP_2;
const GROUND: Group = Group::GROUP_3;
const OBSTACLE: Group = Group::GROUP_4;

/// Bodies of a spatial world.
pub(super) struct SpatialEngine {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

fn groups(member: Group, touches: Group) -> InteractionGroups {
    InteractionGroups::new(member, touches, InteractionTestMode::And)
}

fn prism(shape: &ConvexPolygon, half_height: f64) -> Option<ColliderBuilder> {
    let (low, high) = shape.bounds();
    let area = (high.x - low.x) * (high.y - low.y);
    if shape.vertices().len() == 4 && (area - shape.area()).abs() < 1e-9 * area && (low + high).norm() < 1e-9 {
        return Some(ColliderBuilder::cuboid(high.x as f32, high.y as f32, half_height as f32));
    }
    let points: Vec<Vector> = [-half_height, half_height]
        .iter()
        .flat_map(|z| shape.vertices().iter().map(|v| Vector::new(v.x as f32, v.y as f32, *z as f32)))
        .collect();
    ColliderBuilder::convex_hull(&points)
}

fn pose(p: &Pose2, z: f64) -> Pose {
    let rotation = Rotation::from_rotation_z(yaw(p) as f32);
    Pose::from_parts(Vector::new(p.translation.x as f32, p.translation.y as f32, z as f32), rotation)
}

impl SpatialEngine {
    pub(super) fn new(setup: &WorldSetup) -> Self {
        let mut world = PhysicsWorld::new();
        // only the part that presses onto the ground: the part along it is applied together with the friction
        world.gravity = Vector::new(0.0, 0.0, -setup.slope.normal as f32);
        world.integration_parameters.dt = (setup.step_nanos as f64 * 1e-9) as f32;
        world.integration_parameters.num_solver_iterations = setup.iterations as usize;
        // it freezes contact normals until a body has turned by 11°: a turning load would slip away from its robots
        world.integration_parameters.contact_recycling = false;
        let ground = ColliderBuilder::new(SharedShape::halfspace(Vector::Z))
            .friction(0.0)
            .friction_combine_rule(CoefficientCombineRule::Min)
            .collision_groups(groups(GROUND, LOAD));
        world.insert(RigidBodyBuilder::fixed(), ground);
        let tallest = setup.loads.iter().map(|l| l.height).fold(0.0, f64::max);
        let mut bodies = Vec::new();
        for load in &setup.loads {
            let half_height = load.height / 2.0;
            let body = RigidBodyBuilder::dynamic().pose(pose(&load.world_from_load, half_height)).can_sleep(false);
            if let Some(collider) = prism(&load.footprint, half_height) {
                let collider = collider
                    .mass(load.mass as f32)
                    .friction(load.contact_friction as f32)
                    .friction_combine_rule(CoefficientCombineRule::Min)
                    .collision_groups(groups(LOAD, LOAD | ROBOT | GROUND | OBSTACLE));
                bodies.push(world.insert(body, collider).0);
            }
        }
        for robot in &setup.robots {
            let model = &robot.model;
            let body = RigidBodyBuilder::dynamic()
                .pose(pose(&robot.world_from_robot, tallest / 2.0))
                .enabled_translations(true, true, false)
                .enabled_rotations(false, false, true)
                .can_sleep(false);
            let collider = ColliderBuilder::ball(model.radius as f32)
                .density(0.0)
                .friction(1.0)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .collision_groups(groups(ROBOT, LOAD | ROBOT | OBSTACLE));
            let handle = world.insert(body, collider).0;
            let moment = super::ground::robot_moment(model.mass, model.radius) as f32;
            let mass = rapier3d::prelude::MassProperties::new(Vector::ZERO, model.mass as f32, Vector::splat(moment));
            world.bodies[handle].set_additional_mass_properties(mass, false);
            bodies.push(handle);
        }
        for obstacle in &setup.obstacles {
            let centred = obstacle.centred();
            if let Some(collider) = prism(&centred, 0.25) {
                let at = obstacle.centroid();
                let body = RigidBodyBuilder::fixed().translation(Vector::new(at.x as f32, at.y as f32, 0.25));
                let collider = collider
                    .friction(0.3)
                    .friction_combine_rule(CoefficientCombineRule::Min)
                    .collision_groups(groups(OBSTACLE, LOAD | ROBOT));
                world.insert(body, collider);
            }
        }
        Self { world, bodies }
    }
}

impl Engine for SpatialEngine {
    fn pose(&self, body: usize) -> Pose2 {
        let pose = self.world.bodies[self.bodies[body]].position();
        // direction of the body's x axis, projected onto the ground
        let x = pose.rotation * Vector::X;
        Pose2::from_parts(
            nalgebra::Translation2::new(f64::from(pose.translation.x), f64::from(pose.translation.y)),
            nalgebra::UnitComplex::from_complex(nalgebra::Complex::new(f64::from(x.x), f64::from(x.y))),
        )
    }

    fn twist(&self, body: usize) -> Twist2 {
        let body = &self.world.bodies[self.bodies[body]];
        let (linear, angular) = (body.linvel(), body.angvel());
        Twist2::new(f64::from(linear.x), f64::from(linear.y), f64::from(angular.z))
    }

    fn set_pose(&mut self, body: usize, to: &Pose2) {
        let body = &mut self.world.bodies[self.bodies[body]];
        let height = body.translation().z;
        body.set_position(pose(to, f64::from(height)), false);
    }

    fn set_twist(&mut self, body: usize, twist: &Twist2) {
        let body = &mut self.world.bodies[self.bodies[body]];
        let (linear, angular) = (body.linvel(), body.angvel());
        body.set_linvel(Vector::new(twist.linear.x as f32, twist.linear.y as f32, linear.z), false);
        body.set_angvel(Vector::new(angular.x, angular.y, twist.angular as f32), false);
    }

    fn set_wrench(&mut self, body: usize, force: Vector2<f64>, torque: f64) {
        let body = &mut self.world.bodies[self.bodies[body]];
        body.reset_forces(false);
        body.reset_torques(false);
        body.add_force(Vector::new(force.x as f32, force.y as f32, 0.0), false);
        body.add_torque(Vector::new(0.0, 0.0, torque as f32), false);
    }

    fn advance(&mut self) {
        self.world.step();
    }
}
