//! Plans for bodies that drive.

use std::collections::BTreeMap;

use cohaul_core::se2::{Pose2, is_finite, position, yaw};

use super::agents::{Taker, check_assignment, matched};
use super::assignment::cheapest;
use super::claims::{self, Counted};
use super::drive::{self, Fault, Tolerance};
use super::meetings::{Block, too_much, with_each_other, with_obstacles};
use super::motion::Motion;
use super::{Findings, Model, Violation, ViolationKind, Work};
use crate::instance::{CarAgent, CarInstance};
use crate::plan::{CarPlan, Route};

/// Largest number in an instance or a plan, m: up to here a micrometre is more than rounding.
const NUMBER_MAX: f64 = 1e8;
/// Looks at two discs, or as much work of other kinds, at obstacles and as many at each other: some seconds.
const WORK_MAX: u64 = 200_000_000;
/// Most work of the assignment for the weak lower bound, and most entries of its table.
const WEAK_BOUND_MAX: u64 = 1_000_000_000;
const ENTRIES_MAX: u64 = 10_000_000;

/// Whether a coordinate is one that can be computed with.
pub(super) fn is_sane(value: f64) -> bool {
    value.abs() <= NUMBER_MAX
}

fn is_sane_pose(pose: &Pose2) -> bool {
    is_finite(pose) && position(pose).iter().all(|value| is_sane(*value)) && (pose.rotation.norm() - 1.0).abs() < 1e-6
}

/// See [`super::car`](fn@super::car).
pub(super) fn check(instance: &CarInstance, plan: &CarPlan, model: Model) -> Vec<Violation> {
    let mut findings = Findings::default();
    let blocks = match understood(instance) {
        Ok(blocks) => blocks,
        Err(why) => {
            findings.add(ViolationKind::Instance, 0.0, &[], || why);
            return findings.finish();
        }
    };
    let names: Vec<&str> = instance.agents.iter().map(|agent| agent.name.as_str()).collect();
    let mut routes = matched(&names, &plan.routes, &mut findings);
    for (agent, route) in routes.iter_mut().enumerate() {
        let Some(states) = route.map(|route| &route.states) else { continue };
        if states.is_empty() {
            findings.add(ViolationKind::Start, 0.0, &[agent], || format!("the route of agent {agent} is empty"));
            *route = None;
        } else if let Some(step) = states.iter().position(|pose| !is_sane_pose(pose)) {
            findings.add(ViolationKind::Number, step as f64, &[agent], || {
                format!("agent {agent} is in {}, which makes no sense", at(&states[step]))
            });
            // nothing else can be said of this agent
            *route = None;
        }
    }
    let tolerance = Tolerance::of(&routes);
    let mut work = Work { left: WORK_MAX };
    for (agent, route) in routes.iter().enumerate() {
        if let Some(route) = route {
            check_route(instance, agent, route, model, &tolerance, &mut findings);
        }
    }
    with_obstacles(&blocks, &routes, (model, instance.free_starts), &tolerance, &mut work, &mut findings);
    let mut work = Work { left: WORK_MAX };
    with_each_other(&instance.vehicle, &routes, model, &tolerance, &mut work, &mut findings);
    let time = routes.iter().flatten().map(|route| route.states.len() - 1).max().unwrap_or(0) as f64;
    check_goals(instance, &routes, &tolerance, &mut findings);
    if instance.assignment {
        check_takers(instance, &routes, &blocks, time, &mut work, &mut findings);
    }
    let counted = counted(instance, &routes, time, &tolerance);
    claims::check(&plan.claims, &counted, || weak_bound(instance), &mut findings);
    findings.finish()
}

/// The obstacles of an instance that makes sense; what is wrong with it otherwise.
fn understood(instance: &CarInstance) -> Result<Vec<Block>, String> {
    let vehicle = &instance.vehicle;
    vehicle.validate().map_err(|error| error.to_string())?;
    let lengths = [vehicle.turning_radius, vehicle.front, vehicle.rear, vehicle.width];
    let penalties = [vehicle.turning_penalty, vehicle.reversing_penalty, vehicle.switching_penalty];
    if !lengths.iter().chain(&penalties).all(|value| is_sane(*value)) {
        return Err("the vehicle has numbers that make no sense".to_owned());
    }
    if !(is_sane(instance.width) && is_sane(instance.height)) {
        return Err(format!("the map is {} × {} m", instance.width, instance.height));
    }
    for (index, agent) in instance.agents.iter().enumerate() {
        if let Some(pose) = std::iter::once(&agent.start).chain(&agent.goals).find(|pose| !is_sane_pose(pose)) {
            return Err(format!("agent {index} has the start or goal {}", at(pose)));
        }
    }
    instance.obstacles.iter().enumerate().map(|(number, obstacle)| Block::new(vehicle, number, obstacle)).collect()
}

fn at(pose: &Pose2) -> String {
    let place = position(pose);
    format!("({:.6}, {:.6}, {:.6} rad)", place.x, place.y, yaw(pose))
}

/// Start, steps and places of one agent, whose states are at least one.
fn check_route(
    instance: &CarInstance,
    agent: usize,
    route: &Route<Pose2>,
    model: Model,
    tolerance: &Tolerance,
    findings: &mut Findings,
) {
    let start = &instance.agents[agent].start;
    if let Some(first) = route.states.first()
        && !tolerance.is_same(first, start)
    {
        findings.add(ViolationKind::Start, 0.0, &[agent], || {
            format!("agent {agent} starts in {} instead of {}", at(first), at(start))
        });
    }
    for (step, pose) in route.states.iter().enumerate() {
        let motion = match route.states.get(step + 1) {
            Some(next) => Motion::between(pose, next),
            None => Motion::rest(pose),
        };
        match drive::fault(&instance.vehicle, &motion, tolerance) {
            None => {}
            Some(Fault::Impossible(why)) => {
                findings.add(ViolationKind::Step, step as f64, &[agent], || format!("agent {agent} {why}"));
            }
            Some(Fault::Backwards(length)) => findings.add(ViolationKind::Direction, step as f64, &[agent], || {
                format!("agent {agent} goes backwards by {length:.6} m")
            }),
        }
        let looked = if model == Model::Exact { motion } else { Motion::rest(pose) };
        for ([low, high], (axis, most)) in looked.extremes().iter().zip([("x", instance.width), ("y", instance.height)])
        {
            let out = if low.1 < -tolerance.position {
                low
            } else if high.1 > most + tolerance.position {
                high
            } else {
                continue;
            };
            findings.add(ViolationKind::Outside, step as f64 + out.0, &[agent], || {
                format!("agent {agent} is at {axis} = {:.6}, outside of the map from 0 to {most}", out.1)
            });
        }
    }
}

/// Every route ends in the goal it claims.
fn check_goals(
    instance: &CarInstance,
    routes: &[Option<&Route<Pose2>>],
    tolerance: &Tolerance,
    findings: &mut Findings,
) {
    for (agent, (given, route)) in instance.agents.iter().zip(routes).enumerate() {
        let Some((route, end)) = route.and_then(|route| Some((route, route.states.last()?))) else { continue };
        let time = (route.states.len() - 1) as f64;
        match (goal_of(instance, given, route), route.goal) {
            (Some(goal), _) if !tolerance.is_same(goal, end) => {
                findings.add(ViolationKind::Goal, time, &[agent], || {
                    format!("agent {agent} ends in {} instead of its goal {}", at(end), at(goal))
                });
            }
            (None, Some(index)) => findings.add(ViolationKind::Goal, time, &[agent], || {
                format!("agent {agent} claims its goal {index}, but has {}", given.goals.len())
            }),
            _ => {}
        }
    }
}

/// Goals are taken once, and as many as can be.
fn check_takers(
    instance: &CarInstance,
    routes: &[Option<&Route<Pose2>>],
    blocks: &[Block],
    time: f64,
    work: &mut Work,
    findings: &mut Findings,
) {
    let numbers = numbers(instance);
    // goals in which nobody can stand need not be taken
    let mut is_free: Vec<Option<bool>> = vec![None; numbers.len()];
    let look: u64 = blocks.iter().map(Block::look).sum();
    for goal in instance.agents.iter().flat_map(|agent| &agent.goals) {
        let known = &mut is_free[numbers[&key(goal)]];
        if known.is_some() {
            continue;
        }
        if !work.spend(look) {
            too_much("goals", time, findings);
            return;
        }
        let place = position(goal);
        let is_inside = place.x >= 0.0 && place.x <= instance.width && place.y >= 0.0 && place.y <= instance.height;
        *known = Some(is_inside && !blocks.iter().any(|block| block.is_touched(goal)));
    }
    let takers: Vec<Taker> = instance
        .agents
        .iter()
        .zip(routes)
        .map(|(given, route)| Taker {
            options: given
                .goals
                .iter()
                .map(|goal| numbers[&key(goal)])
                .filter(|number| is_free[*number] == Some(true))
                .collect(),
            taken: route.and_then(|route| goal_of(instance, given, route)).map(|goal| numbers[&key(goal)]),
        })
        .collect();
    check_assignment(&takers, numbers.len(), time, findings);
}

/// What is equal for equal poses only.
fn key(pose: &Pose2) -> [u64; 4] {
    // adding zero makes both zeros one
    let bits = |value: f64| (value + 0.0).to_bits();
    let place = position(pose);
    [bits(place.x), bits(place.y), bits(pose.rotation.re), bits(pose.rotation.im)]
}

/// A number for every goal there is.
fn numbers(instance: &CarInstance) -> BTreeMap<[u64; 4], usize> {
    let mut numbers = BTreeMap::new();
    for goal in instance.agents.iter().flat_map(|agent| &agent.goals) {
        let next = numbers.len();
        numbers.entry(key(goal)).or_insert(next);
    }
    numbers
}

/// The goal that a route takes. Without assignment that is the agent's own, whether or not the route says so.
fn goal_of<'a>(instance: &CarInstance, given: &'a CarAgent, route: &Route<Pose2>) -> Option<&'a Pose2> {
    match route.goal {
        Some(index) => given.goals.get(index),
        None if !instance.assignment => given.goals.first(),
        None => None,
    }
}

/// Cost, makespan and flowtime.
fn counted(instance: &CarInstance, routes: &[Option<&Route<Pose2>>], time: f64, tolerance: &Tolerance) -> Counted {
    let (mut flowtime, mut makespan, mut cost) = ((0.0, 0.0), (0.0_f64, 0.0_f64), (0.0, 0.0));
    let mut steps = 0;
    for route in routes.iter().flatten() {
        let (way, costs) = drive::way_and_cost(&instance.vehicle, &route.states, tolerance);
        flowtime = (flowtime.0 + way.0, flowtime.1 + way.1);
        makespan = (makespan.0.max(way.0), makespan.1.max(way.1));
        cost = (cost.0 + costs.0, cost.1 + costs.1);
        steps += route.states.len();
    }
    let vehicle = &instance.vehicle;
    let factor = vehicle.turning_penalty * vehicle.reversing_penalty * vehicle.switching_penalty;
    let digits = if tolerance.is_printed { 2.0 * steps as f64 * tolerance.position * factor } else { 0.0 };
    Counted {
        cost: vec![cost],
        makespan: vec![makespan],
        flowtime: vec![flowtime],
        // sums of ways that are off by as much as their poses; printed ones are rounded themselves
        tolerance: 1e-6 + digits,
        relative: if tolerance.is_printed { 1e-5 } else { 1e-6 },
        time,
    }
}

/// Sum of the straight distances, under the cheapest assignment; nothing where that takes too much work.
fn weak_bound(instance: &CarInstance) -> Option<f64> {
    let distance = |agent: &CarAgent, goal: &Pose2| (position(&agent.start) - position(goal)).norm();
    if !instance.assignment {
        let nearest =
            |agent: &CarAgent| agent.goals.iter().map(|goal| distance(agent, goal)).fold(f64::INFINITY, f64::min);
        return Some(instance.agents.iter().map(nearest).filter(|length| length.is_finite()).sum());
    }
    let numbers = numbers(instance);
    let (rows, goals) = (instance.agents.len() as u64, numbers.len() as u64);
    let work = rows.checked_mul(rows)?.checked_mul(rows + goals)?;
    if work > WEAK_BOUND_MAX || rows.checked_mul(goals)? > ENTRIES_MAX {
        return None;
    }
    let costs: Vec<Vec<Option<f64>>> = instance
        .agents
        .iter()
        .map(|agent| {
            let mut row = vec![None; numbers.len()];
            for goal in &agent.goals {
                row[numbers[&key(goal)]] = Some(distance(agent, goal));
            }
            row
        })
        .collect();
    Some(cheapest(&costs))
}
