//! Both worlds against closed forms, at the default step.

use cohaul_core::contact::limit_surface::LimitSurface;
use cohaul_core::contact::slope::Slope;
use cohaul_core::control::Command;
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::robot::RobotModel;
use cohaul_core::scenario::document::{Physics, WorldKind};
use cohaul_core::se2::{Pose2, Twist2, pose, position, unit, yaw};
use cohaul_sim::world::{LoadBody, RobotBody, World, WorldSetup, build};
use cohaul_tests::oracle::{off_centre_push, stopping_distance};

const WORLDS: [WorldKind; 2] = [WorldKind::Planar, WorldKind::Spatial];
const LOAD: LoadId = LoadId(0);

fn paper_load(mass: f64, world_from_load: Pose2, twist: Twist2) -> LoadBody {
    let footprint = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
    let surface = LimitSurface::exact(&footprint);
    LoadBody { footprint, height: 0.1, mass, contact_friction: 0.3, surface, world_from_load, twist }
}

fn setup(friction: f64, slope_deg: f64, load: LoadBody, robots: Vec<RobotBody>) -> WorldSetup {
    let physics = Physics::default();
    WorldSetup {
        slope: Slope::new(slope_deg.to_radians(), 0.0),
        friction_dynamic: friction,
        friction_static: friction,
        friction_wheel: 0.9,
        loads: vec![load],
        robots,
        obstacles: Vec::new(),
        step_nanos: (physics.step * 1e9).round() as i64,
        iterations: physics.iterations,
    }
}

fn run(world: &mut dyn World, commands: &[Command], seconds: f64) {
    let steps = (seconds / Physics::default().step).round() as usize;
    for _ in 0..steps {
        world.step(commands);
    }
}

#[test]
fn load_stops_after_the_closed_form_distance() {
    // the integrator's own error is v₀Δt/2 per solver sub-step
    for kind in WORLDS {
        let mut worst: f64 = 0.0;
        for slope_deg in [0.0_f64, 5.0, -5.0] {
            for i in 0..12 {
                // direction of travel in the load's frame; travel is along the fall line
                let heading = f64::from(i) * 30.0_f64.to_radians();
                let load = paper_load(2.0, pose(0.0, 0.0, heading), Twist2::new(0.5, 0.0, 0.0));
                let mut world = build(kind, &setup(0.1, slope_deg, load, Vec::new()));
                run(&mut *world, &[], 30.0);
                let travelled = position(&world.load_pose(LOAD)).x;
                let expected = stopping_distance(0.5, 0.1, slope_deg.to_radians());
                let error = travelled / expected - 1.0;
                worst = worst.max(error.abs());
                assert!(error.abs() < 0.01, "{kind:?} {slope_deg}° {i}: {travelled} m, expected {expected} m");
                assert_eq!(world.load_twist(LOAD), Twist2::ZERO);
            }
        }
        println!("{kind:?}: stopping distance within {:.2} %", worst * 100.0);
    }
}

#[test]
fn spinning_load_feels_the_uniform_pressure_friction_radius() {
    for kind in WORLDS {
        let load = paper_load(2.0, pose(0.0, 0.0, 0.3), Twist2::new(0.0, 0.0, 2.0));
        let moment = 2.0 * load.footprint.second_moment();
        let mut world = build(kind, &setup(0.1, 0.0, load, Vec::new()));
        run(&mut *world, &[], 0.5);
        // torque from the spin lost in 0.5 s
        let torque = moment * (2.0 - world.load_twist(LOAD).angular) / 0.5;
        let radius = torque / (0.1 * 2.0 * 9.81);
        println!("{kind:?}: friction radius {radius:.4} m");
        assert!((radius / 0.359 - 1.0).abs() < 0.02, "{kind:?} {radius}");
    }
}

#[test]
fn load_holds_below_the_friction_angle_and_slides_above() {
    let critical = 5.0_f64.to_radians().tan();
    for kind in WORLDS {
        for heading in [0.0, 37.0_f64.to_radians()] {
            let start = pose(0.0, 0.0, heading);
            let held = paper_load(2.0, start, Twist2::ZERO);
            let mut world = build(kind, &setup(critical * 1.005, 5.0, held, Vec::new()));
            run(&mut *world, &[], 60.0);
            let creep = position(&world.load_pose(LOAD)).norm() / 60.0;
            assert!(creep < 1e-4, "{kind:?}: creeps at {creep} m/s");
            let sliding = paper_load(2.0, start, Twist2::ZERO);
            let mut world = build(kind, &setup(critical * 0.995, 5.0, sliding, Vec::new()));
            run(&mut *world, &[], 10.0);
            // ½ g (sin α − μ cos α) t²
            let expected = -0.5 * 9.81 * 0.005 * 5.0_f64.to_radians().sin() * 100.0;
            let travelled = position(&world.load_pose(LOAD)).x;
            assert!((travelled / expected - 1.0).abs() < 0.05, "{kind:?}: {travelled} m, expected {expected} m");
        }
    }
}

#[test]
fn off_centre_push_turns_the_load_as_the_exact_limit_surface_says() {
    // independent check of the oracle: the values of a separate computation
    for (offset, expected_deg) in [(0.1, 15.6), (0.3, 14.9), (0.5, 13.3)] {
        let exact_deg = off_centre_push(0.35, 1.35, offset, 0.2).to_degrees().abs();
        assert!((exact_deg / expected_deg - 1.0).abs() < 0.02, "oracle {offset} m: {exact_deg}°");
        for kind in WORLDS {
            let mut load = paper_load(2.0, pose(0.0, 0.0, 0.0), Twist2::ZERO);
            load.contact_friction = 0.0;
            // one heavy robot that keeps its speed and its line
            let mut model = RobotModel::TURTLEBOT3_BURGER;
            model.mass = 100.0;
            model.mass_on_wheels = 100.0;
            model.limits.linear_acceleration = 1e3;
            let robot = RobotBody { model, world_from_robot: pose(-0.175 - 0.105, offset, 0.0) };
            let mut world = build(kind, &setup(0.3, 0.0, load, vec![robot]));
            let push = Command::drive(0.02, 0.0);
            // until the robot has driven 0.2 m from first touch
            run(&mut *world, &[push], 10.0);
            let turned = yaw(&world.load_pose(LOAD)).to_degrees().abs();
            println!("{kind:?} {offset} m: {turned:.2}° (closed form {exact_deg:.2}°)");
            assert!(
                (turned / expected_deg - 1.0).abs() < 0.05,
                "{kind:?} {offset} m: {turned}°, expected {expected_deg}°"
            );
        }
    }
}

#[test]
fn two_robots_move_17_kg_and_not_19() {
    // traction of two 1 kg robots at wheel friction 0.9: 17.66 N; friction of 17 kg at 0.1: 16.7 N, of 19 kg: 18.6 N
    for kind in WORLDS {
        for (mass, moves) in [(17.0, true), (19.0, false)] {
            let load = paper_load(mass, pose(0.0, 0.0, 0.0), Twist2::ZERO);
            let robot = |y: f64| RobotBody {
                model: RobotModel::TURTLEBOT3_BURGER,
                world_from_robot: pose(-0.175 - 0.105 - 0.002, y, 0.0),
            };
            let mut world = build(kind, &setup(0.1, 0.0, load, vec![robot(0.5), robot(-0.5)]));
            let push = Command::drive(0.1, 0.0);
            run(&mut *world, &[push; 2], 1.0);
            let start = position(&world.load_pose(LOAD)).x;
            run(&mut *world, &[push; 2], 10.0);
            let travelled = position(&world.load_pose(LOAD)).x - start;
            println!("{kind:?} {mass} kg: {travelled:.4} m, traction {:.2} N", world.traction(RobotId(0)));
            assert_eq!(travelled > 0.5, moves, "{kind:?} {mass} kg: {travelled} m");
            assert!(moves || travelled < 0.02, "{kind:?} {mass} kg creeps {travelled} m");
        }
    }
}

/// A robot sideways on a slope, wheels held: it must not slide, and no load may push it faster than its traction allows.
#[test]
fn robots_hold_on_the_slope_in_every_direction() {
    for kind in WORLDS {
        for i in 0..8 {
            let start = pose(3.0, 0.0, f64::from(i) * 45.0_f64.to_radians());
            let robot = RobotBody { model: RobotModel::TURTLEBOT3_BURGER, world_from_robot: start };
            let load = paper_load(2.0, pose(0.0, 0.0, 0.0), Twist2::ZERO);
            let mut world = build(kind, &setup(0.5, 5.0, load, vec![robot]));
            run(&mut *world, &[Command::STOP], 60.0);
            let moved = (position(&world.robot_pose(RobotId(0))) - position(&start)).norm();
            assert!(moved < 1e-4, "{kind:?}: {moved} m");
        }
    }
    let _ = unit(0.0);
}
