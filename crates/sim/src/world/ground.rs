//! The ground under every world: exact friction of the loads, wheels of the robots, tilted gravity.
//!
//! An [`Engine`] moves free bodies and resolves their contacts with each other; it knows no ground. Per step and body:
//!
//! 1. predict the velocity without friction from the contact impulse of the step before, V_f = V₀ + M⁻¹J_c + g Δt;
//! 2. friction takes what it can, P = M (V⁺ − V_f), and is given to the engine as a force;
//! 3. the engine steps; the velocity balance gives the contact impulse, J_c = M (V₁ − V₀) − P − M g Δt;
//! 4. the velocity is corrected with friction answering to that impulse, V = friction(V₀ + M⁻¹J_c + g Δt).
//!
//! The engine advances positions with the velocity after each of its n sub-steps, which falls short of the mean velocity
//! by ΔV/2n where it changes by ΔV in the step. Step 2 therefore hands over V₀ − ΔV/2n: the distance travelled is that
//! of uniform acceleration, whatever n.
//!
//! While a body sticks, the prediction error telescopes over the steps; while it slides, steps 1 and 3 alternate on one
//! convex problem. At a fixed point both agree exactly: no creep at rest, exact stopping distances.
//!
//! A robot is the same kind of body: two wheels whose contact patches move backwards at the commanded speed, so that its
//! drive and its traction limit μ_w N are one friction problem. Its wheels also resist sideways.

use cohaul_core::contact::friction::{FrictionSolver, Inertia};
use cohaul_core::contact::limit_surface::{LimitSurface, SupportPoint};
use cohaul_core::control::Command;
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::kinematics::BaseLimits;
use cohaul_core::se2::{Pose2, Twist2};
use cohaul_core::time::Time;
use nalgebra::{Vector2, Vector3};

use super::{World, WorldSetup};

/// Free planar bodies and the contacts between them. Bodies are numbered: loads first, then robots.
pub(super) trait Engine: Send {
    /// Pose of a body.
    fn pose(&self, body: usize) -> Pose2;
    /// Velocity of a body's centre, world frame.
    fn twist(&self, body: usize) -> Twist2;
    /// Moves a body elsewhere.
    fn set_pose(&mut self, body: usize, pose: &Pose2);
    /// Replaces the velocity of a body.
    fn set_twist(&mut self, body: usize, twist: &Twist2);
    /// Replaces the force (N) and torque (N·m) on a body for the next step, world frame.
    fn set_wrench(&mut self, body: usize, force: Vector2<f64>, torque: f64);
    /// Advances one step.
    fn advance(&mut self);
}

/// A body on the ground with what it remembers from step to step.
struct Body {
    solver: FrictionSolver,
    /// Limit impulse per step while sliding, N·s.
    limit: f64,
    /// Limit impulse per step at rest, N·s.
    limit_at_rest: f64,
    /// Contact impulse of the step before, world frame.
    contact: Vector3<f64>,
    /// Velocity before the step, world frame.
    before: Vector3<f64>,
    /// The same as handed to the engine.
    handed: Vector3<f64>,
    /// Friction impulse of the step, world frame.
    friction: Vector3<f64>,
}

impl Body {
    /// Velocity after friction, world frame, from the velocity `free`; `ground` is the ground's velocity in the body frame.
    fn after_friction(&mut self, free: &Vector3<f64>, heading: &Vector2<f64>, ground: &Vector3<f64>) -> Vector3<f64> {
        let (cos, sin) = (heading.x, heading.y);
        let relative = Twist2::new(
            cos * free.x + sin * free.y - ground.x,
            cos * free.y - sin * free.x - ground.y,
            free.z - ground.z,
        );
        let breaks_away = self.limit_at_rest > self.limit && self.solver.at_rest();
        let mut after = self.solver.solve(&relative, if breaks_away { self.limit_at_rest } else { self.limit });
        if breaks_away && !self.solver.at_rest() {
            after = self.solver.solve(&relative, self.limit);
        }
        let (x, y) = (after.linear.x + ground.x, after.linear.y + ground.y);
        Vector3::new(cos * x - sin * y, sin * x + cos * y, after.angular + ground.z)
    }
}

/// The commanded motion of one robot's wheels.
struct Drive {
    limits: BaseLimits,
    speeds: Command,
    /// Forward speed and yaw rate of the robot after the last step.
    actual: Command,
    /// Force of the ground on the robot in the last step, N, and the power it fed in, W.
    traction: f64,
    power: f64,
}

/// A world: an engine with ground under it.
pub(super) struct GroundedWorld<E> {
    engine: E,
    bodies: Vec<Body>,
    loads: usize,
    drives: Vec<Drive>,
    gravity: Vector3<f64>,
    step: f64,
    /// 1/2n for n sub-steps of the engine.
    lead: f64,
    step_nanos: i64,
    time: Time,
}

impl<E: Engine> GroundedWorld<E> {
    pub(super) fn new(mut engine: E, setup: &WorldSetup) -> Self {
        let step = setup.step_nanos as f64 * 1e-9;
        let pressure = setup.slope.normal * step;
        let mut bodies = Vec::with_capacity(setup.loads.len() + setup.robots.len());
        for (index, load) in setup.loads.iter().enumerate() {
            let inertia = Inertia { mass: load.mass, moment: load.mass * load.footprint.second_moment() };
            let normal = load.mass * pressure;
            bodies.push(Body {
                solver: FrictionSolver::new(inertia, &load.surface),
                limit: setup.friction_dynamic * normal,
                limit_at_rest: setup.friction_static * normal,
                contact: Vector3::zeros(),
                before: Vector3::zeros(),
                handed: Vector3::zeros(),
                friction: Vector3::zeros(),
            });
            engine.set_twist(index, &load.twist);
        }
        for robot in &setup.robots {
            let model = &robot.model;
            let inertia = Inertia { mass: model.mass, moment: robot_moment(model.mass, model.radius) };
            let wheel = |side: f64| SupportPoint { position: Vector2::new(0.0, side * model.track / 2.0), weight: 0.5 };
            let limit = setup.friction_wheel * model.mass_on_wheels * pressure;
            bodies.push(Body {
                solver: FrictionSolver::new(inertia, &LimitSurface::Exact(vec![wheel(1.0), wheel(-1.0)])),
                limit,
                limit_at_rest: limit,
                contact: Vector3::zeros(),
                before: Vector3::zeros(),
                handed: Vector3::zeros(),
                friction: Vector3::zeros(),
            });
        }
        let drives = setup
            .robots
            .iter()
            .map(|r| Drive {
                limits: r.model.limits,
                speeds: Command::STOP,
                actual: Command::STOP,
                traction: 0.0,
                power: 0.0,
            })
            .collect();
        let gravity = setup.slope.tangential * step;
        Self {
            engine,
            bodies,
            loads: setup.loads.len(),
            drives,
            gravity: Vector3::new(gravity.x, gravity.y, 0.0),
            step,
            lead: 0.5 / f64::from(setup.iterations),
            step_nanos: setup.step_nanos,
            time: Time::ZERO,
        }
    }

    fn robot_body(&self, robot: RobotId) -> usize {
        self.loads + robot.index()
    }
}

/// Moment of inertia of a robot: a uniform disc, kg·m².
pub(super) fn robot_moment(mass: f64, radius: f64) -> f64 {
    0.5 * mass * radius * radius
}

/// Velocity of the ground as the wheels see it, body frame.
fn wheel_motion(drives: &[Drive], loads: usize, body: usize) -> Vector3<f64> {
    body.checked_sub(loads).map_or_else(Vector3::zeros, |robot| {
        let speeds = drives[robot].speeds;
        Vector3::new(speeds.linear, speeds.lateral, speeds.angular)
    })
}

fn heading(pose: &Pose2) -> Vector2<f64> {
    Vector2::new(pose.rotation.re, pose.rotation.im)
}

impl<E: Engine> World for GroundedWorld<E> {
    fn time(&self) -> Time {
        self.time
    }

    fn load_pose(&self, load: LoadId) -> Pose2 {
        self.engine.pose(load.index())
    }

    fn load_twist(&self, load: LoadId) -> Twist2 {
        self.engine.twist(load.index())
    }

    fn robot_pose(&self, robot: RobotId) -> Pose2 {
        self.engine.pose(self.robot_body(robot))
    }

    fn robot_speeds(&self, robot: RobotId) -> Command {
        self.drives[robot.index()].actual
    }

    fn traction(&self, robot: RobotId) -> f64 {
        self.drives[robot.index()].traction
    }

    fn traction_power(&self, robot: RobotId) -> f64 {
        self.drives[robot.index()].power
    }

    fn place(&mut self, robot: RobotId, world_from_robot: &Pose2) {
        let index = self.robot_body(robot);
        self.engine.set_pose(index, world_from_robot);
        self.engine.set_twist(index, &Twist2::ZERO);
        // what it felt where it was says nothing about where it is
        self.bodies[index].contact = Vector3::zeros();
        self.bodies[index].solver.reset();
        self.drives[robot.index()].speeds = Command::STOP;
    }

    fn step(&mut self, commands: &[Command]) {
        for (drive, command) in self.drives.iter_mut().zip(commands) {
            drive.speeds = drive.limits.approach(drive.speeds, drive.limits.accepted(*command), self.step);
        }
        for (index, body) in self.bodies.iter_mut().enumerate() {
            let heading = heading(&self.engine.pose(index));
            let ground = wheel_motion(&self.drives, self.loads, index);
            let inertia = body.solver.inertia();
            body.before = self.engine.twist(index).vector();
            let free = body.before + inertia.velocity_change(&body.contact) + self.gravity;
            let after = body.after_friction(&free, &heading, &ground);
            body.friction = inertia.impulse(&(after - free));
            let applied = body.friction + inertia.impulse(&self.gravity);
            body.handed = body.before - (after - body.before) * self.lead;
            self.engine.set_twist(index, &Twist2::new(body.handed.x, body.handed.y, body.handed.z));
            let wrench = applied / self.step;
            self.engine.set_wrench(index, Vector2::new(wrench.x, wrench.y), wrench.z);
        }
        self.engine.advance();
        for (index, body) in self.bodies.iter_mut().enumerate() {
            let heading = heading(&self.engine.pose(index));
            let ground = wheel_motion(&self.drives, self.loads, index);
            let inertia = body.solver.inertia();
            let moved = self.engine.twist(index).vector();
            body.contact = inertia.impulse(&(moved - body.handed - self.gravity)) - body.friction;
            let free = body.before + inertia.velocity_change(&body.contact) + self.gravity;
            let after = body.after_friction(&free, &heading, &ground);
            self.engine.set_twist(index, &Twist2::new(after.x, after.y, after.z));
            if let Some(drive) = index.checked_sub(self.loads).and_then(|robot| self.drives.get_mut(robot)) {
                drive.actual = Command {
                    linear: heading.x * after.x + heading.y * after.y,
                    lateral: heading.x * after.y - heading.y * after.x,
                    angular: after.z,
                };
                drive.traction = body.friction.xy().norm() / self.step;
                drive.power = (body.friction.dot(&after) / self.step).max(0.0);
            }
        }
        self.time = self.time.plus_nanos(self.step_nanos);
    }
}
