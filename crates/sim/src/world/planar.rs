//! The planar world: rapier2d moves the bodies and resolves their contacts.

use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::se2::{Pose2, Twist2};
use nalgebra::Vector2;
use rapier2d::prelude::{
    CoefficientCombineRule, ColliderBuilder, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, Vector,
};

use super::WorldSetup;
use super::ground::{Engine, robot_moment};

/// Bodies of a planar world.
pub(super) struct PlanarEngine {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

fn vector(v: &Vector2<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32)
}

fn pose(p: &Pose2) -> Pose {
    Pose::new(vector(&p.translation.vector), p.rotation.angle() as f32)
}

/// A collider for a convex polygon; rectangles along the axes get the cheaper cuboid.
fn polygon(shape: &ConvexPolygon) -> Option<ColliderBuilder> {
    let (low, high) = shape.bounds();
    let area = (high.x - low.x) * (high.y - low.y);
    if shape.vertices().len() == 4 && (area - shape.area()).abs() < 1e-9 * area && (low + high).norm() < 1e-9 {
        return Some(ColliderBuilder::cuboid(high.x as f32, high.y as f32));
    }
    let points: Vec<Vector> = shape.vertices().iter().map(vector).collect();
    ColliderBuilder::convex_polyline(points)
}

impl PlanarEngine {
    pub(super) fn new(setup: &WorldSetup) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = (setup.step_nanos as f64 * 1e-9) as f32;
        world.integration_parameters.num_solver_iterations = setup.iterations as usize;
        // it freezes contact normals until a body has turned by 11°: a turning load would slip away from its robots
        world.integration_parameters.contact_recycling = false;
        let mut bodies = Vec::new();
        for load in &setup.loads {
            let body = RigidBodyBuilder::dynamic().pose(pose(&load.world_from_load)).can_sleep(false);
            if let Some(collider) = polygon(&load.footprint) {
                let collider = collider
                    .mass(load.mass as f32)
                    .friction(load.contact_friction as f32)
                    .friction_combine_rule(CoefficientCombineRule::Min);
                bodies.push(world.insert(body, collider).0);
            }
        }
        for robot in &setup.robots {
            let model = &robot.model;
            let body = RigidBodyBuilder::dynamic().pose(pose(&robot.world_from_robot)).can_sleep(false);
            // a ball's collider has the moment of a disc
            debug_assert!((robot_moment(1.0, model.radius) - 0.5 * model.radius * model.radius).abs() < 1e-12);
            let collider = ColliderBuilder::ball(model.radius as f32)
                .mass(model.mass as f32)
                .friction(1.0)
                .friction_combine_rule(CoefficientCombineRule::Min);
            bodies.push(world.insert(body, collider).0);
        }
        for obstacle in &setup.obstacles {
            let centred = obstacle.centred();
            if let Some(collider) = polygon(&centred) {
                let body = RigidBodyBuilder::fixed().translation(vector(&obstacle.centroid()));
                world.insert(body, collider.friction(0.3).friction_combine_rule(CoefficientCombineRule::Min));
            }
        }
        Self { world, bodies }
    }
}

impl Engine for PlanarEngine {
    fn pose(&self, body: usize) -> Pose2 {
        let pose = self.world.bodies[self.bodies[body]].position();
        let (re, im) = (f64::from(pose.rotation.re), f64::from(pose.rotation.im));
        Pose2::from_parts(
            nalgebra::Translation2::new(f64::from(pose.translation.x), f64::from(pose.translation.y)),
            nalgebra::UnitComplex::from_complex(nalgebra::Complex::new(re, im)),
        )
    }

    fn twist(&self, body: usize) -> Twist2 {
        let body = &self.world.bodies[self.bodies[body]];
        let linear = body.linvel();
        Twist2::new(f64::from(linear.x), f64::from(linear.y), f64::from(body.angvel()))
    }

    fn set_pose(&mut self, body: usize, to: &Pose2) {
        self.world.bodies[self.bodies[body]].set_position(pose(to), false);
    }

    fn set_twist(&mut self, body: usize, twist: &Twist2) {
        let body = &mut self.world.bodies[self.bodies[body]];
        body.set_linvel(vector(&twist.linear), false);
        body.set_angvel(twist.angular as f32, false);
    }

    fn set_wrench(&mut self, body: usize, force: Vector2<f64>, torque: f64) {
        let body = &mut self.world.bodies[self.bodies[body]];
        body.reset_forces(false);
        body.reset_torques(false);
        body.add_force(vector(&force), false);
        body.add_torque(torque as f32, false);
    }

    fn advance(&mut self) {
        self.world.step();
    }
}
