//! The planner for cars, as its users meet it: whatever it returns is a plan, a reason or a spent budget, in time.

mod bounds;
mod budgets;
mod hostile;
mod infeasible;
mod plans;
mod puzzles;
mod study;

use std::time::Duration;

use cohaul_core::se2::pose;
use cohaul_planner::car::{Model, Options, solve};
use cohaul_planner::certify;
use cohaul_planner::generate::{CarShape, Goals};
use cohaul_planner::instance::{CarAgent, CarInstance, Drive, Obstacle, Vehicle};
use cohaul_planner::outcome::{Ended, Outcome, Reason};
use cohaul_planner::plan::CarPlan;
use cohaul_planner::search::Budget;
use cpu_time::ThreadTime;
use nalgebra::Point2;

const MODELS: [Model; 2] = [Model::Clcbs, Model::Exact];

/// Expansions that no instance here should need.
const PLENTY: u64 = 3_000_000;

fn options(model: Model) -> Options {
    Options { model, ..Options::default() }
}

fn plan(instance: &CarInstance, options: &Options) -> Ended<CarPlan> {
    solve(instance, options, &Budget::new(PLENTY, &|| false))
}

/// Plans, and how much CPU time that took.
fn timed(instance: &CarInstance, options: &Options, budget: &Budget<'_>) -> (Ended<CarPlan>, Duration) {
    let start = ThreadTime::now();
    let ended = solve(instance, options, budget);
    (ended, start.elapsed())
}

/// The plan, which has to be one.
fn solved(instance: &CarInstance, options: &Options, what: &str) -> CarPlan {
    match plan(instance, options).outcome {
        Outcome::Solved(plan) => {
            assert_right(instance, options, &plan, what);
            plan
        }
        other => panic!("{what}: {other:?}"),
    }
}

fn assert_right(instance: &CarInstance, options: &Options, plan: &CarPlan, what: &str) {
    let model = match options.model {
        Model::Clcbs => certify::Model::Clcbs,
        Model::Exact => certify::Model::Exact,
    };
    let violations = certify::car(instance, plan, model);
    assert!(violations.is_empty(), "{what}: {violations:?}");
    let (cost, lower) = (plan.claims.cost.unwrap(), plan.claims.lower_bound.unwrap());
    assert!(lower <= cost + 1e-9, "{what}: {lower} > {cost}");
    if let Some(bound) = options.bound {
        assert!(cost <= bound * lower + 1e-6, "{what}: {cost} > {bound} × {lower}");
        assert_eq!(plan.claims.bound, Some(bound), "{what}");
    }
}

fn reasons(ended: Ended<CarPlan>, what: &str) -> Vec<Reason> {
    match ended.outcome {
        Outcome::Infeasible(reasons) => reasons,
        other => panic!("{what}: {other:?}"),
    }
}

fn shape(size: i32, agents: usize, obstacles: usize) -> CarShape {
    let (vehicle, goals) = (Vehicle::default(), Goals::Own);
    CarShape { size, obstacles, obstacle_radius: 0.8, agents, goals, vehicle }
}

fn driven(drive: Drive) -> Vehicle {
    Vehicle { drive, ..Vehicle::default() }
}

type At = (f64, f64, f64);

/// Cars with a start and a goal each on a map.
fn cars(width: f64, height: f64, tasks: &[(At, At)]) -> CarInstance {
    let agents = tasks.iter().enumerate().map(|(index, (from, to))| CarAgent {
        name: format!("agent{index}"),
        start: pose(from.0, from.1, from.2),
        goals: vec![pose(to.0, to.1, to.2)],
    });
    CarInstance {
        width,
        height,
        obstacles: Vec::new(),
        vehicle: Vehicle::default(),
        agents: agents.collect(),
        assignment: false,
        free_starts: false,
    }
}

fn point(x: f64, y: f64) -> Obstacle {
    Obstacle::Point { at: Point2::new(x, y), radius: 0.8 }
}

fn block(x: (f64, f64), y: (f64, f64)) -> Obstacle {
    Obstacle::Polygon(vec![Point2::new(x.0, y.0), Point2::new(x.1, y.0), Point2::new(x.1, y.1), Point2::new(x.0, y.1)])
}

/// Numbers of [0, 1).
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (self.0 ^ (self.0 >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        (mixed >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn below(&mut self, below: usize) -> usize {
        (self.unit() * below as f64) as usize
    }
}
