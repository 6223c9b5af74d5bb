//! What cannot be planned is told, with the reason, and soon.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::time::Duration;

use cohaul_core::se2::pose;
use cohaul_planner::car::{Model, Options};
use cohaul_planner::instance::{CarAgent, CarInstance, Drive, Obstacle};
use cohaul_planner::outcome::Reason;
use cohaul_planner::search::Budget;

use super::{MODELS, block, cars, driven, options, point, reasons, solved, timed};

/// Reasons that come within a second of CPU time.
fn told(instance: &CarInstance, options: &Options, what: &str) -> Vec<Reason> {
    let (ended, took) = timed(instance, options, &Budget::new(u64::MAX, &|| false));
    assert!(took < Duration::from_secs(1), "{what}: {took:?}");
    reasons(ended, what)
}

fn told_in_both(instance: &CarInstance, expected: &[Reason]) {
    for model in MODELS {
        assert_eq!(told(instance, &options(model), &format!("{model:?}")), expected, "{model:?}");
    }
}

fn two() -> CarInstance {
    cars(50.0, 50.0, &[((10.0, 10.0, 0.0), (40.0, 10.0, 0.0)), ((10.0, 30.0, 0.0), (40.0, 30.0, 0.0))])
}

#[test]
fn places_outside() {
    let mut instance = two();
    instance.agents[1].start = pose(-0.1, 30.0, 0.0);
    told_in_both(&instance, &[Reason::StartOutside { agent: 1 }]);
    let mut instance = two();
    instance.agents[0].goals[0] = pose(40.0, 50.5, 0.0);
    told_in_both(&instance, &[Reason::GoalOutside { agent: 0, goal: 0 }]);
}

#[test]
fn places_in_obstacles() {
    // 0.7 m beside the body: within its rectangle grown by 0.8 m
    let mut instance = two();
    instance.obstacles = vec![point(25.0, 20.0), point(41.0, 31.7)];
    told_in_both(&instance, &[Reason::GoalBlocked { agent: 1, goal: 0, obstacle: Some(1) }]);
    instance.obstacles[1] = point(41.0, 31.81);
    for model in MODELS {
        solved(&instance, &options(model), "0.01 m further");
    }
    let mut instance = two();
    instance.obstacles = vec![block((38.0, 44.0), (8.0, 12.0)), block((9.0, 11.0), (30.5, 33.0))];
    let expected = [
        Reason::StartBlocked { agent: 1, obstacle: Some(1) },
        Reason::GoalBlocked { agent: 0, goal: 0, obstacle: Some(0) },
    ];
    told_in_both(&instance, &expected);
}

#[test]
fn places_too_close() {
    let mut instance = two();
    instance.agents[1].goals[0] = instance.agents[0].goals[0];
    told_in_both(&instance, &[Reason::GoalsCollide { first: 0, second: 1 }]);
    // side by side 3 m apart: bodies pass, discs of CL-CBS do not
    instance.agents[1].goals[0] = pose(40.0, 13.0, 0.0);
    assert_eq!(told(&instance, &options(Model::Clcbs), "side by side"), [Reason::GoalsCollide { first: 0, second: 1 }]);
    solved(&instance, &options(Model::Exact), "side by side");
    let mut instance = two();
    instance.agents[1].start = pose(11.0, 10.5, 1.0);
    told_in_both(&instance, &[Reason::StartsCollide { first: 0, second: 1 }]);
}

#[test]
fn nowhere_to_go() {
    let mut instance = two();
    instance.agents[1].goals.clear();
    told_in_both(&instance, &[Reason::NoGoal { agent: 1 }]);
}

/// Points on a circle, so close that no body passes.
fn ring(x: f64, y: f64, radius: f64) -> Vec<Obstacle> {
    let points = (TAU * radius / 1.5).ceil() as u32;
    (0..points)
        .map(|k| f64::from(k) / f64::from(points) * TAU)
        .map(|angle| point(x + radius * angle.cos(), y + radius * angle.sin()))
        .collect()
}

/// Four walls around a place.
fn box_around(x: f64, y: f64, half: f64, thick: f64) -> Vec<Obstacle> {
    let (low, high) = (half, half + thick);
    vec![
        block((x - high, x - low), (y - high, y + high)),
        block((x + low, x + high), (y - high, y + high)),
        block((x - high, x + high), (y - high, y - low)),
        block((x - high, x + high), (y + low, y + high)),
    ]
}

#[test]
fn places_that_are_walled_in() {
    for side in [50.0, 100.0, 300.0] {
        let tasks =
            [((5.0, 5.0, 0.0), (5.0, side - 5.0, FRAC_PI_2)), ((0.5 * side, 0.5 * side, 0.0), (side - 6.0, 12.0, 1.0))];
        for obstacles in [ring(0.5 * side, 0.5 * side, 6.0), box_around(0.5 * side, 0.5 * side, 6.0, 2.5)] {
            for drive in [Drive::Car, Drive::ForwardCar, Drive::Differential] {
                let mut instance = cars(side, side, &tasks);
                instance.vehicle = driven(drive);
                instance.obstacles.clone_from(&obstacles);
                told_in_both(&instance, &[Reason::Unreachable { agent: 1, goal: 0 }]);
                // the same the other way round
                let agent = &mut instance.agents[1];
                (agent.start, agent.goals[0]) = (agent.goals[0], agent.start);
                told_in_both(&instance, &[Reason::Unreachable { agent: 1, goal: 0 }]);
            }
        }
    }
}

/// A goal that nobody reaches is no reason to be content with fewer goals: it is told.
#[test]
fn assigned_goals_that_are_walled_in() {
    let mut instance = cars(60.0, 60.0, &[((5.0, 5.0, 0.0), (30.0, 30.0, 0.0)), ((5.0, 50.0, 0.0), (50.0, 50.0, 0.0))]);
    let goals: Vec<_> = instance.agents.iter().map(|agent| agent.goals[0]).collect();
    instance.assignment = true;
    instance.obstacles = ring(30.0, 30.0, 6.0);
    for agent in &mut instance.agents {
        agent.goals.clone_from(&goals);
    }
    for model in MODELS {
        let told = told(&instance, &options(model), &format!("{model:?}"));
        let walled = |agent| Reason::Unreachable { agent, goal: 0 };
        assert!(told.contains(&walled(0)) && told.contains(&walled(1)) && told.len() == 2, "{told:?}");
    }
    // a goal nobody can stand in is not taken; the other one is
    instance.obstacles = vec![point(30.0, 30.0)];
    for model in MODELS {
        solved(&instance, &options(model), "one goal is blocked");
    }
    let idle = CarAgent { name: "idle".into(), start: pose(20.0, 50.0, 0.0), goals: Vec::new() };
    instance.agents.push(idle);
    for model in MODELS {
        solved(&instance, &options(model), "one has no goal");
    }
}
