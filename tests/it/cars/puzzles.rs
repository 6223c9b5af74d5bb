//! Small puzzles in which everyone has to make way for somebody.

use std::f64::consts::{FRAC_PI_2, PI};

use cohaul_core::se2::{pose, position};
use cohaul_planner::car::{Model, Options};
use cohaul_planner::instance::{CarAgent, Drive};
use cohaul_planner::outcome::Outcome;

use super::{MODELS, block, cars, driven, options, plan, solved};

/// Two cars meet in a corridor with a bay for one of them.
#[test]
fn a_corridor_with_a_passing_bay() {
    let tasks = [((6.0, 6.0, 0.0), (54.0, 6.0, 0.0)), ((54.0, 6.0, PI), (6.0, 6.0, PI))];
    let mut instance = cars(60.0, 20.0, &tasks);
    instance.obstacles =
        vec![block((-1.0, 61.0), (0.0, 3.5)), block((-1.0, 22.0), (8.5, 21.0)), block((38.0, 61.0), (8.5, 21.0))];
    for model in MODELS {
        solved(&instance, &options(model), &format!("{model:?}"));
    }
}

#[test]
fn two_change_places() {
    for drive in [Drive::Car, Drive::Differential] {
        let mut instance =
            cars(40.0, 40.0, &[((12.0, 20.0, 0.0), (28.0, 20.0, 0.0)), ((28.0, 20.0, 0.0), (12.0, 20.0, 0.0))]);
        instance.vehicle = driven(drive);
        for model in MODELS {
            solved(&instance, &options(model), &format!("{drive:?}, {model:?}"));
        }
    }
}

/// Four cars from four sides, all through one crossing.
#[test]
fn a_crossing() {
    let tasks = [
        ((5.0, 25.0, 0.0), (45.0, 25.0, 0.0)),
        ((45.0, 25.0, PI), (5.0, 25.0, PI)),
        ((25.0, 5.0, FRAC_PI_2), (25.0, 45.0, FRAC_PI_2)),
        ((25.0, 45.0, -FRAC_PI_2), (25.0, 5.0, -FRAC_PI_2)),
    ];
    let mut instance = cars(50.0, 50.0, &tasks);
    // roads of nine metres
    for x in [(-1.0, 16.5), (33.5, 51.0)] {
        for y in [(-1.0, 16.5), (33.5, 51.0)] {
            instance.obstacles.push(block(x, y));
        }
    }
    for model in MODELS {
        solved(&instance, &options(model), &format!("{model:?}"));
    }
}

#[test]
fn four_rotate_places() {
    let places = [(15.0, 15.0, 0.0), (25.0, 15.0, FRAC_PI_2), (25.0, 25.0, PI), (15.0, 25.0, -FRAC_PI_2)];
    for turns in 1..4 {
        let tasks: Vec<_> = (0..4).map(|k| (places[k], places[(k + turns) % 4])).collect();
        for model in MODELS {
            solved(&cars(40.0, 40.0, &tasks), &options(model), &format!("{turns} places on, {model:?}"));
        }
    }
}

/// The first is soon at its goal, in the only way that the second has.
#[test]
fn who_parks_early_waits_for_those_behind() {
    let tasks = [((10.0, 24.0, -FRAC_PI_2), (30.0, 6.0, 0.0)), ((5.0, 6.0, 0.0), (54.0, 6.0, 0.0))];
    let mut instance = cars(60.0, 30.0, &tasks);
    instance.obstacles = vec![block((-1.0, 61.0), (-1.0, 3.0)), block((20.0, 61.0), (9.0, 31.0))];
    for model in MODELS {
        solved(&instance, &options(model), &format!("{model:?}"));
    }
}

/// Agents without a goal get out of the way, and only then.
#[test]
fn those_without_a_goal_only_make_way() {
    let mut instance = cars(40.0, 40.0, &[((8.0, 20.0, 0.0), (30.0, 20.0, 0.0))]);
    instance.assignment = true;
    let idle = |name: &str, x, y| CarAgent { name: name.into(), start: pose(x, y, 0.3), goals: Vec::new() };
    instance.agents.push(idle("in the way", 31.0, 21.0));
    instance.agents.push(idle("elsewhere", 8.0, 35.0));
    for model in MODELS {
        let made = solved(&instance, &options(model), &format!("{model:?}"));
        assert_eq!(made.routes[2].states.len(), 1);
        let end = made.routes[1].states.last().unwrap();
        assert!((position(end) - position(&instance.agents[1].start)).norm() > 0.5);
        assert_eq!(made.routes[1].goal, None);
    }
}

/// A corridor in which nobody can pass: no plan, and none is claimed.
#[test]
fn a_corridor_in_which_nobody_passes() {
    let tasks = [((6.0, 4.0, 0.0), (30.0, 4.0, 0.0)), ((30.0, 4.0, 0.0), (6.0, 4.0, 0.0))];
    let mut instance = cars(36.0, 8.0, &tasks);
    instance.obstacles = vec![block((-1.0, 37.0), (-1.0, 2.4)), block((-1.0, 37.0), (5.6, 9.0))];
    for model in MODELS {
        let ended = super::timed(&instance, &options(model), &cohaul_planner::search::Budget::new(30_000, &|| false)).0;
        assert!(!matches!(ended.outcome, Outcome::Solved(_)), "{model:?}");
    }
}

/// Bounds as small as they can be, for few cars.
#[test]
fn two_cross_at_the_least_cost() {
    let tasks = [((5.0, 15.0, 0.0), (25.0, 15.0, 0.0)), ((15.0, 5.0, FRAC_PI_2), (15.0, 25.0, FRAC_PI_2))];
    let instance = cars(30.0, 30.0, &tasks);
    let options = Options { bound: Some(1.0), ..options(Model::Exact) };
    let ended = plan(&instance, &options);
    let Outcome::Solved(best) = ended.outcome else { panic!("{ended:?}") };
    super::assert_right(&instance, &options, &best, "crossing");
    // straight on is 40 m; that one waits three steps of 2.118 m is a plan, a detour a cheaper one
    let cost = best.claims.cost.unwrap();
    assert!(cost > 40.0 && cost <= 40.0 + 3.0 * 2.118 + 1e-6, "{cost}");
}
