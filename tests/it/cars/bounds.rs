//! Lower bounds are bounds: no plan of whatever origin costs less.

use cohaul_core::se2::Pose2;
use cohaul_planner::car::{Metric, Model, Options, solve};
use cohaul_planner::certify;
use cohaul_planner::generate::{self, CarShape, Goals};
use cohaul_planner::instance::{CarAgent, CarInstance, Drive, Vehicle};
use cohaul_planner::outcome::Outcome;
use cohaul_planner::plan::{Claims, Plan, Route};
use cohaul_planner::search::Budget;

use super::{Draw, MODELS, assert_right, cars, driven, shape};

/// What a solver says: a plan's cost, and a bound.
fn said(instance: &CarInstance, options: &Options, expansions: u64, what: &str) -> (Option<f64>, f64) {
    match solve(instance, options, &Budget::new(expansions, &|| false)).outcome {
        Outcome::Solved(plan) => {
            assert_right(instance, options, &plan, what);
            (plan.claims.cost, plan.claims.lower_bound.unwrap())
        }
        Outcome::BudgetSpent { best_bound } => (None, best_bound),
        Outcome::Infeasible(reasons) => panic!("{what}: {reasons:?}"),
    }
}

/// No bound of any mode is above the cost of any mode's plan.
#[test]
fn no_mode_finds_what_another_calls_impossible() {
    let (mut instances, mut tight) = (0, 0);
    for seed in 501..581 {
        let drive = [Drive::Car, Drive::ForwardCar, Drive::Differential][seed as usize % 3];
        let goals = [Goals::Own, Goals::All, Goals::Own, Goals::Window(2)][seed as usize % 4];
        let shape = CarShape { goals, vehicle: driven(drive), ..shape(30, 2 + seed as usize % 4, seed as usize % 9) };
        let Ok(instance) = generate::car(&shape, seed) else { continue };
        for model in MODELS {
            let what = format!("{model:?}, seed {seed}, {shape:?}");
            let base = Options { model, ..Options::default() };
            let mut modes = vec![base, Options { improvements: 0, ..base }, Options { batch: Some(1), ..base }];
            modes.push(Options { metric: Metric::Manhattan, ..base });
            modes.extend([1.0, 1.1, 1.5, 3.0].map(|bound| Options { bound: Some(bound), ..base }));
            // cars that only drive forwards may face a border
            if matches!(solve(&instance, &base, &Budget::new(20_000, &|| false)).outcome, Outcome::Infeasible(_)) {
                assert_eq!(drive, Drive::ForwardCar, "{what}");
                continue;
            }
            instances += 1;
            let said: Vec<_> = modes.iter().map(|mode| (mode, said(&instance, mode, 4_000, &what))).collect();
            for (mode, (_, bound)) in &said {
                for (other, (cost, _)) in &said {
                    let Some(cost) = cost else { continue };
                    // in two steps the assignment is fixed: its tree bounds the cost of that one only
                    let same = goals == Goals::Own || (mode.metric == other.metric);
                    assert!(
                        !same || *bound <= cost * (1.0 + 1e-6) + 1e-6,
                        "{what}: {mode:?} says {bound}, {other:?} costs {cost}"
                    );
                }
            }
            tight += usize::from(said[4].1.0.is_some());
        }
    }
    println!("{instances} instances, {tight} solved with the bound 1");
    assert!(instances >= 100, "{instances}");
}

/// A step: how it turns (as a factor on the largest turn) and how it drives.
type Step = (f64, f64);

fn moves(drive: Drive) -> &'static [Step] {
    match drive {
        Drive::Car => &[(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (-1.0, 1.0), (0.0, -1.0), (1.0, -1.0), (-1.0, -1.0)],
        Drive::ForwardCar => &[(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (-1.0, 1.0)],
        Drive::Differential => &[(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0)],
    }
}

/// Where `step` leads from `from`, computed on its own.
fn moved(vehicle: &Vehicle, from: &Pose2, (steer, gear): Step) -> Pose2 {
    let (angle, radius) = (vehicle.step_angle, vehicle.turning_radius);
    let turn = if gear == 0.0 { steer } else { steer * gear } * angle;
    let ahead = if gear == 0.0 {
        (0.0, 0.0)
    } else if steer == 0.0 {
        (gear * vehicle.step_length(), 0.0)
    } else {
        (radius * (gear * angle).sin(), steer * radius * (1.0 - angle.cos()))
    };
    from * cohaul_core::se2::pose(ahead.0, ahead.1, turn)
}

/// Cost of steps, the waits at the end left out.
fn cost(vehicle: &Vehicle, steps: &[Step]) -> f64 {
    let (mut cost, mut last) = (0.0, 0.0);
    let moving = steps.iter().rposition(|step| *step != (0.0, 0.0)).map_or(0, |at| at + 1);
    for (steer, gear) in &steps[..moving] {
        let mut price = vehicle.step_length();
        if *steer != 0.0 {
            price *= vehicle.turning_penalty;
        }
        if *gear < 0.0 {
            price *= vehicle.reversing_penalty;
        }
        if *gear != 0.0 {
            if last != 0.0 && last != *gear {
                price *= vehicle.switching_penalty;
            }
            last = *gear;
        }
        cost += price;
    }
    cost
}

/// Bodies drive at random, close to each other; where they come to be are their goals. What they drove is a plan of a
/// known cost, if the certifier passes it: no bound may exceed it, and a plan that claims to be the best may not cost more.
#[test]
fn no_bound_is_above_what_was_driven() {
    let mut draw = Draw(7);
    let (mut plans, mut best, mut spent) = (0, 0, 0);
    for round in 0..1_200 {
        let drive = [Drive::Car, Drive::ForwardCar, Drive::Differential][round % 3];
        let model = MODELS[round % 2];
        let vehicle = driven(drive);
        let bodies = 2 + draw.below(2);
        let mut instance = cars(20.0, 20.0, &[]);
        instance.vehicle = vehicle;
        let mut routes = Vec::new();
        let mut driven_cost = 0.0;
        for body in 0..bodies {
            let start =
                cohaul_core::se2::pose(draw.between(6.0, 14.0), draw.between(6.0, 14.0), draw.between(-3.0, 3.0));
            let steps: Vec<Step> =
                (0..2 + draw.below(4)).map(|_| moves(drive)[draw.below(moves(drive).len())]).collect();
            let mut states = vec![start];
            for step in &steps {
                states.push(moved(&vehicle, states.last().unwrap(), *step));
            }
            driven_cost += cost(&vehicle, &steps);
            let name = format!("agent{body}");
            instance.agents.push(CarAgent { name: name.clone(), start, goals: vec![*states.last().unwrap()] });
            routes.push(Route { name, goal: Some(0), states });
        }
        // every fourth time goals are for everyone
        if round % 4 == 3 {
            instance.assignment = true;
            let goals: Vec<Pose2> = instance.agents.iter().map(|agent| agent.goals[0]).collect();
            for (index, (agent, route)) in instance.agents.iter_mut().zip(&mut routes).enumerate() {
                agent.goals.clone_from(&goals);
                route.goal = Some(index);
            }
        }
        let touching = if model == Model::Exact { certify::Model::Exact } else { certify::Model::Clcbs };
        let claims = Claims { cost: Some(driven_cost), ..Claims::default() };
        if !certify::car(&instance, &Plan { routes, claims }, touching).is_empty() {
            continue;
        }
        plans += 1;
        let what = format!("{model:?}, round {round}, {instance:?}");
        for bound in [None, Some(1.0), Some(1.2)] {
            let options = Options { model, bound, ..Options::default() };
            let (cost, lower) = said(&instance, &options, 3_000, &what);
            assert!(
                lower <= driven_cost * (1.0 + 1e-6) + 1e-6,
                "{what}: {bound:?} says {lower}, {driven_cost} was driven"
            );
            if bound == Some(1.0) {
                match cost {
                    Some(cost) => {
                        best += 1;
                        assert!(cost <= driven_cost * (1.0 + 1e-6) + 1e-6, "{what}: {cost}, {driven_cost} was driven");
                    }
                    None => spent += 1,
                }
            }
        }
    }
    println!("{plans} plans; the best found for {best}, not within the budget for {spent}");
    assert!(plans >= 200, "{plans}");
}
