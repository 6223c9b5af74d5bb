//! Plans are right, whatever the instance; and the same every time.

use cohaul_planner::car::{Metric, Model, Options, solve};
use cohaul_planner::generate::{self, CarShape, Goals};
use cohaul_planner::instance::{CarInstance, Drive};
use cohaul_planner::outcome::{Outcome, Reason};
use cohaul_planner::search::Budget;

use super::{MODELS, block, driven, options, plan, shape, solved};

/// Seeds of instances on a map of this size.
fn generated(shape: &CarShape, seeds: std::ops::Range<u64>) -> impl Iterator<Item = (String, CarInstance)> {
    let shape = *shape;
    seeds.map(move |seed| (format!("seed {seed} of {shape:?}"), generate::car(&shape, seed).unwrap()))
}

fn all_solved(shape: &CarShape, seeds: std::ops::Range<u64>, change: impl Fn(&mut CarInstance, &mut Options)) {
    for (what, mut instance) in generated(shape, seeds) {
        for model in MODELS {
            let mut options = options(model);
            change(&mut instance, &mut options);
            solved(&instance, &options, &format!("{model:?}, {what}"));
        }
    }
}

#[test]
fn cars_on_all_maps() {
    all_solved(&shape(50, 12, 25), 501..521, |_, _| {});
    all_solved(&shape(100, 30, 50), 501..506, |_, _| {});
    all_solved(&shape(300, 40, 100), 501..503, |_, _| {});
}

#[test]
fn bodies_of_other_kinds() {
    let vehicle = driven(Drive::Differential);
    all_solved(&CarShape { vehicle, ..shape(50, 8, 15) }, 501..511, |_, _| {});
    all_solved(&CarShape { vehicle, ..shape(100, 15, 30) }, 501..504, |_, _| {});
}

/// Cars that only drive forwards may face a border that they cannot turn away from. Those are told, and the others drive.
#[test]
fn cars_that_only_drive_forwards() {
    let vehicle = driven(Drive::ForwardCar);
    let (mut driving, mut stuck) = (0, 0);
    for (what, instance) in generated(&CarShape { vehicle, ..shape(100, 15, 30) }, 501..511) {
        for model in MODELS {
            let (mut instance, options) = (instance.clone(), options(model));
            while let Outcome::Infeasible(reasons) = plan(&instance, &options).outcome {
                let [Reason::Unreachable { agent, .. }] = reasons[..] else { panic!("{what}: {reasons:?}") };
                instance.agents.remove(agent);
                stuck += 1;
            }
            driving += instance.agents.len();
            solved(&instance, &options, &format!("{model:?}, {what}"));
        }
    }
    assert!(stuck * 5 < driving, "{stuck} of {driving}");
}

#[test]
fn goals_that_are_assigned() {
    for goals in [Goals::All, Goals::Window(3)] {
        for drive in [Drive::Car, Drive::Differential] {
            let vehicle = driven(drive);
            all_solved(&CarShape { goals, vehicle, ..shape(50, 8, 20) }, 501..506, |_, _| {});
        }
        all_solved(&CarShape { goals, ..shape(100, 15, 50) }, 501..503, |_, options| {
            options.metric = Metric::Manhattan;
        });
    }
}

#[test]
fn polygons_and_walls_with_gaps() {
    all_solved(&shape(100, 16, 20), 501..507, |instance, _| {
        // what points there are become squares of the same extent
        for obstacle in &mut instance.obstacles {
            if let cohaul_planner::instance::Obstacle::Point { at, .. } = obstacle {
                *obstacle = block((at.x - 0.6, at.x + 0.6), (at.y - 0.6, at.y + 0.6));
            }
        }
    });
    // a wall down the middle, wherever nobody stands, with gaps of ten metres
    all_solved(&shape(100, 12, 0), 501..507, |instance, _| {
        let places: Vec<_> = instance
            .agents
            .iter()
            .flat_map(|agent| [agent.start, agent.goals[0]])
            .map(|pose| cohaul_core::se2::position(&pose))
            .collect();
        let wall = |k: usize| (f64::from(k as u32) * 20.0 + 5.0, f64::from(k as u32) * 20.0 + 15.0);
        instance.obstacles = (0..5)
            .map(wall)
            .filter(|y| places.iter().all(|at| (at.x - 50.5).abs() > 5.0 || at.y < y.0 - 4.0 || at.y > y.1 + 4.0))
            .map(|y| block((50.0, 51.0), y))
            .collect();
    });
}

#[test]
fn batches() {
    for batch in [1, 5, 10] {
        all_solved(&shape(100, 20, 50), 501..504, |_, options| options.batch = Some(batch));
    }
}

#[test]
fn starts_inside_obstacles_where_they_may() {
    for (what, mut instance) in generated(&shape(50, 8, 15), 501..511) {
        // an obstacle at everyone's side, within the inflated body
        let points: Vec<_> =
            instance.agents.iter().map(|agent| agent.start * nalgebra::Point2::new(0.5, 1.5)).collect();
        instance.obstacles.extend(points.into_iter().step_by(3).map(|at| super::point(at.x, at.y)));
        let clear = super::reasons(plan(&instance, &options(Model::Clcbs)), &what);
        assert!(clear.iter().all(|reason| matches!(reason, Reason::StartBlocked { .. })));
        instance.free_starts = true;
        solved(&instance, &options(Model::Clcbs), &what);
    }
}

#[test]
fn the_same_instance_gives_the_same_plan() {
    for goals in [Goals::Own, Goals::All] {
        for (what, instance) in generated(&CarShape { goals, ..shape(100, 25, 50) }, 501..504) {
            for model in MODELS {
                let text = |_| format!("{:?}", solve(&instance, &options(model), &Budget::new(3_000_000, &|| false)));
                let alone = text(0);
                let beside: Vec<String> = std::thread::scope(|scope| {
                    let threads: Vec<_> = (0..3).map(|i| scope.spawn(move || text(i))).collect();
                    threads.into_iter().map(|thread| thread.join().unwrap()).collect()
                });
                assert!(beside.iter().all(|other| *other == alone), "{what}");
            }
        }
    }
}
