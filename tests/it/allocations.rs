//! A decision allocates nothing.

use cohaul_core::control::guard::{Guard, GuardLimits};
use cohaul_core::control::guidance::Task;
use cohaul_core::control::r2p2::R2p2;
use cohaul_core::control::{Command, Observation, Stepper, StopFlags};
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::id::RobotId;
use cohaul_core::robot::RobotModel;
use cohaul_core::scenario::document::{self, Slots};
use cohaul_core::se2::{Twist2, pose};
use cohaul_core::time::Time;
use cohaul_core::transport::formation::Formation;
use nalgebra::Vector2;

#[test]
fn a_guarded_decision_of_r2p2_allocates_nothing() {
    let load = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
    let model = RobotModel::TURTLEBOT3_BURGER;
    let formation = Formation::new(&load, &Slots::Six, 6, 0.175, 0.01, model.radius).unwrap();
    for place in 0..6 {
        let task = Task {
            formation: &formation,
            place,
            half_length: 0.675,
            waypoints: vec![Vector2::new(0.2, 0.4), Vector2::new(9.0, 2.0)],
            tolerance: 0.1,
            goal_yaw: None,
            limits: model.limits,
        };
        let controller = R2p2::new(&document::R2p2::default(), task).unwrap();
        let mut guard = Guard::new(Stepper::new(controller), GuardLimits { pose_timeout: 0.15, robot: model.limits });
        let mut moved = 0;
        let counted = allocation_counter::measure(|| {
            for tick in 0..10_000_i64 {
                // loads and robots everywhere, so that every phase, role and fault is passed
                let a = tick as f64 * 0.618_034;
                let world_from_load = pose(3.0 * (0.01 * a).sin().abs(), 0.3 * a.cos(), 0.4 * (0.02 * a).sin());
                let offset = pose(0.1 * (0.3 * a).sin(), 0.1 * (0.7 * a).cos(), 0.5 * a.sin());
                let observation = Observation {
                    time: Time::from_nanos(tick * 50_000_000),
                    sampled: Time::from_nanos(tick * 50_000_000 - if tick % 50 == 0 { 400_000_000 } else { 0 }),
                    robot: RobotId(place as u16),
                    world_from_robot: world_from_load * formation.load_from_robot(place) * offset,
                    world_from_load,
                    load_twist_in_world: Twist2::new(0.1 * a.sin(), 0.0, if tick % 97 == 0 { f64::NAN } else { 0.1 }),
                    stop_flags: StopFlags(u64::from(tick % 7 == 0) << ((place + 1) % 6)),
                };
                moved += i32::from(guard.step(&observation).command != Command::STOP);
            }
        });
        assert_eq!(counted.count_total, 0, "place {place}");
        assert!(moved > 1000, "{moved}");
    }
}
