//! Numbers that nobody would write: no panic, no endless search, no plan that is wrong.

use std::time::Duration;

use cohaul_core::se2::pose;
use cohaul_planner::car::{Options, solve};
use cohaul_planner::instance::{CarInstance, Drive, Obstacle, Vehicle};
use cohaul_planner::outcome::{Outcome, Reason};
use cohaul_planner::search::Budget;
use cpu_time::ThreadTime;
use nalgebra::Point2;

use super::{MODELS, block, cars, options, solved};

/// Ends within two seconds, right if solved.
fn ends(instance: &CarInstance, what: &str) {
    for model in MODELS {
        for bound in [None, Some(1.2)] {
            let options = Options { bound, ..options(model) };
            let start = ThreadTime::now();
            let ended =
                solve(instance, &options, &Budget::new(5_000, &|| start.elapsed() > Duration::from_millis(300)));
            let took = start.elapsed();
            assert!(took < Duration::from_secs(2), "{what}: {took:?}");
            if let Outcome::Solved(plan) = &ended.outcome {
                super::assert_right(instance, &options, plan, what);
            }
        }
    }
}

#[test]
fn nobody_and_those_who_are_there() {
    let nobody = cars(50.0, 50.0, &[]);
    let there = cars(50.0, 50.0, &[((20.0, 20.0, 1.0), (20.0, 20.0, 1.0))]);
    for model in MODELS {
        for bound in [None, Some(1.0)] {
            let options = Options { bound, ..options(model) };
            assert_eq!(solved(&nobody, &options, "nobody").claims.cost, Some(0.0));
            let plan = solved(&there, &options, "there");
            assert_eq!((plan.claims.cost, plan.routes[0].states.len()), (Some(0.0), 1));
        }
    }
    let mut nobody = nobody;
    nobody.assignment = true;
    solved(&nobody, &options(MODELS[0]), "nobody");
}

#[test]
fn vehicles_that_nobody_has() {
    let tasks = [((10.0, 10.0, 0.0), (40.0, 40.0, 1.0)), ((40.0, 12.0, 2.0), (11.0, 40.0, -1.0))];
    let tiny = |radius: f64| Vehicle { turning_radius: radius, ..Vehicle::default() };
    let mut vehicles = vec![
        ("radius of 1 cm", tiny(0.01)),
        ("radius of 1 µm", tiny(1e-6)),
        ("radius of 1 km", tiny(1e3)),
        ("small steps", Vehicle { step_angle: 0.01, ..Vehicle::default() }),
        ("tiny steps", Vehicle { step_angle: 1e-9, ..Vehicle::default() }),
        ("large body", Vehicle { front: 300.0, ..Vehicle::default() }),
        ("flea", Vehicle { front: 1e-6, rear: 1e-6, width: 1e-6, ..Vehicle::default() }),
        (
            "dear",
            Vehicle { turning_penalty: 1e6, reversing_penalty: 1e9, switching_penalty: 1e9, ..Vehicle::default() },
        ),
        ("no vehicle", tiny(0.0)),
        ("nothing", tiny(f64::NAN)),
        ("no steps", Vehicle { step_angle: 0.0, ..Vehicle::default() }),
    ];
    for drive in [Drive::ForwardCar, Drive::Differential] {
        vehicles.push(("small and another drive", Vehicle { drive, ..tiny(1e-3) }));
    }
    for (what, vehicle) in vehicles {
        let mut instance = cars(50.0, 50.0, &tasks);
        instance.vehicle = vehicle;
        ends(&instance, what);
    }
}

#[test]
fn maps_that_nobody_has() {
    let task = [((10.0, 10.0, 0.0), (40.0, 40.0, 1.0))];
    ends(&cars(1e6, 1e6, &[((10.0, 10.0, 0.0), (9e5, 9e5, 1.0))]), "huge");
    ends(&cars(1e7, 50.0, &task), "long");
    ends(&cars(f64::INFINITY, f64::INFINITY, &task), "endless");
    ends(&cars(f64::NAN, 50.0, &task), "no number");
    ends(&cars(0.0, 0.0, &[((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))]), "none");
    ends(&cars(50.0, 50.0, &[((f64::NAN, 10.0, 0.0), (40.0, f64::INFINITY, 1.0))]), "places that are none");
    ends(&cars(50.0, 50.0, &[((10.0, 10.0, 1e9), (40.0, 40.0, -1e15))]), "headings");
}

#[test]
fn obstacles_that_nobody_has() {
    let tasks = [((10.0, 10.0, 0.0), (400.0, 400.0, 1.0)), ((40.0, 12.0, 2.0), (11.0, 400.0, -1.0))];
    let grid = |number: usize, side: f64| {
        (0..number * number).map(move |k| {
            let (x, y) = ((k % number) as f64 / number as f64 * side + 5.0, (k / number) as f64 / number as f64 * side);
            Obstacle::Point { at: Point2::new(x + 1.0, y + 3.0), radius: 0.1 }
        })
    };
    let mut instance = cars(1_000.0, 1_000.0, &tasks);
    instance.obstacles = grid(100, 1_000.0).collect();
    ends(&instance, "ten thousand points");
    // each as long as the map, and none in the way
    let mut instance = cars(10_000.0, 10_000.0, &tasks);
    instance.obstacles =
        (0..2_000).map(|k| block((0.0, 1e4), (500.0 + 4.0 * f64::from(k), 501.0 + 4.0 * f64::from(k)))).collect();
    instance.obstacles.extend((0..500).map(|k| {
        let x = f64::from(k) * 10.0;
        Obstacle::Polygon(vec![Point2::new(x, 600.0), Point2::new(x + 5_000.0, 9_000.0), Point2::new(x, 602.0)])
    }));
    ends(&instance, "walls across a large map");
    let mut instance = cars(500.0, 500.0, &tasks);
    instance.obstacles = vec![
        Obstacle::Polygon(Vec::new()),
        Obstacle::Point { at: Point2::new(f64::NAN, 1.0), radius: f64::NAN },
        Obstacle::Point { at: Point2::new(-1e12, 1.0), radius: 1.0 },
        Obstacle::Point { at: Point2::new(200.0, 200.0), radius: f64::INFINITY },
    ];
    while !instance.obstacles.is_empty() {
        let told = super::reasons(super::plan(&instance, &options(MODELS[0])), "obstacles that are none");
        assert!(matches!(told[..], [Reason::Malformed { .. }]), "{told:?}");
        instance.obstacles.pop();
    }
    instance.obstacles = (0..3_000).map(|_| Obstacle::Point { at: Point2::new(200.0, 200.0), radius: 50.0 }).collect();
    ends(&instance, "three thousand in one place");
}

#[test]
fn changing_places_exactly() {
    let (a, b) = ((10.0, 10.0, 0.0), (40.0, 40.0, 0.0));
    let mut instance = cars(50.0, 50.0, &[(a, b), (b, a)]);
    for model in MODELS {
        solved(&instance, &options(model), "changing places");
    }
    // whoever may take either stays where it is
    instance.assignment = true;
    for agent in &mut instance.agents {
        agent.goals = vec![pose(a.0, a.1, a.2), pose(b.0, b.1, b.2)];
    }
    for model in MODELS {
        assert_eq!(solved(&instance, &options(model), "staying").claims.cost, Some(0.0));
    }
}
