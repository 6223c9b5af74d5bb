//! Searches end when they are told to.

use std::cell::Cell;
use std::time::Duration;

use cohaul_planner::car::{Metric, Model, Options, solve};
use cohaul_planner::generate::{self, CarShape, Goals};
use cohaul_planner::instance::CarInstance;
use cohaul_planner::outcome::Outcome;
use cohaul_planner::search::Budget;
use cpu_time::ThreadTime;

use super::{MODELS, block, options, shape};

/// CPU time that may pass after the end of the time that was given.
const OVERSHOOT: Duration = Duration::from_millis(50);

/// Instances and options that keep a search busy in all of its parts.
fn busy() -> Vec<(&'static str, CarInstance, Options)> {
    let mut busy = Vec::new();
    for model in MODELS {
        let base = options(model);
        let crowd = generate::car(&shape(100, 50, 50), 501).unwrap();
        busy.push(("fast", crowd.clone(), base));
        busy.push(("improvement", crowd.clone(), Options { improvements: 1_000, ..base }));
        busy.push(("tree", crowd, Options { bound: Some(1.01), ..base }));
        busy.push(("large", generate::car(&shape(300, 100, 100), 501).unwrap(), base));
        let all = generate::car(&CarShape { goals: Goals::All, ..shape(300, 90, 100) }, 501).unwrap();
        busy.push(("assignment", all.clone(), base));
        busy.push(("tree of assignments", all.clone(), Options { bound: Some(1.01), ..base }));
        busy.push(("two steps", all, Options { metric: Metric::Manhattan, ..base }));
        // the way out is too narrow to turn, but not for a disc
        let mut walled = generate::car(&shape(300, 2, 0), 501).unwrap();
        let at = cohaul_core::se2::position(&walled.agents[0].goals[0]);
        let (low, high) = (3.2, 4.2);
        walled.obstacles = vec![
            block((at.x - high, at.x - low), (at.y - high, at.y + high)),
            block((at.x + low, at.x + high), (at.y - high, at.y + high)),
            block((at.x - high, at.x + high), (at.y - high, at.y - low)),
            block((at.x + 1.2, at.x + high), (at.y + low, at.y + high)),
            block((at.x - high, at.x - 1.2), (at.y + low, at.y + high)),
        ];
        busy.push(("walled in", walled, base));
    }
    busy
}

#[test]
fn the_caller_is_asked_again_and_again() {
    for (what, instance, options) in busy() {
        let asked = Cell::new(0_u64);
        let stop = || {
            asked.set(asked.get() + 1);
            false
        };
        let ended = solve(&instance, &options, &Budget::new(60_000, &stop));
        let expanded = ended.effort.low_level_expanded;
        assert!(asked.get() >= expanded / 256, "{what}: asked {} times for {expanded} expansions", asked.get());
        assert!(expanded <= 60_000, "{what}: {expanded}");
    }
}

#[test]
fn a_budget_is_not_overdrawn_and_no_plan_of_it_is_lost() {
    for (what, instance, options) in busy() {
        for expansions in [0, 1, 100, 1_000, 5_000, 20_000] {
            let ended = solve(&instance, &options, &Budget::new(expansions, &|| false));
            assert!(ended.effort.low_level_expanded <= expansions, "{what}: {:?} of {expansions}", ended.effort);
            match ended.outcome {
                Outcome::Solved(plan) => super::assert_right(&instance, &options, &plan, what),
                Outcome::BudgetSpent { best_bound } => assert!(best_bound >= 0.0 && best_bound.is_finite(), "{what}"),
                Outcome::Infeasible(reasons) => panic!("{what}: {reasons:?}"),
            }
        }
    }
}

/// Stops after various times, wherever that is.
#[test]
fn searches_stop_when_they_are_told_to() {
    for (what, instance, options) in busy() {
        for milliseconds in [0, 1, 3, 10, 30, 100] {
            let given = Duration::from_millis(milliseconds);
            let start = ThreadTime::now();
            let ended = solve(&instance, &options, &Budget::new(u64::MAX, &|| start.elapsed() >= given));
            let took = start.elapsed();
            assert!(took < given + OVERSHOOT, "{what}, {:?}: {took:?} instead of {given:?}", options.model);
            if let Outcome::Infeasible(reasons) = ended.outcome {
                panic!("{what}: {reasons:?}");
            }
        }
    }
}

/// What is prepared is not asked about, so it has to be quick: thousands of bodies, goals and obstacles.
#[test]
fn preparation_is_short() {
    let size = 1_200;
    let vehicle = cohaul_planner::instance::Vehicle::default();
    let made = CarShape { goals: Goals::All, obstacle_radius: 0.8, size, obstacles: 5_000, agents: 700, vehicle };
    let instance = generate::car(&made, 501).unwrap();
    for model in MODELS {
        for metric in [Metric::Curve, Metric::Manhattan] {
            for milliseconds in [0, 20, 300] {
                let given = Duration::from_millis(milliseconds);
                let start = ThreadTime::now();
                let options = Options { metric, ..options(model) };
                let ended = solve(&instance, &options, &Budget::new(u64::MAX, &|| start.elapsed() >= given));
                let took = start.elapsed();
                assert!(matches!(ended.outcome, Outcome::BudgetSpent { .. }), "{:?}", ended.effort);
                assert!(took < given + OVERSHOOT, "{metric:?}: {took:?} instead of {given:?}");
            }
        }
    }
    assert_eq!(Model::default(), Model::Clcbs);
}
