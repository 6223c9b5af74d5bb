//! The certifier passes plans that are right and catches every way in which they can be wrong.

use cohaul_core::se2::{Pose2, pose, position, yaw};
use cohaul_planner::certify::{self, Model, VIOLATIONS_MAX, Violation, ViolationKind};
use cohaul_planner::instance::{CarAgent, CarInstance, Cell, Drive, GridAgent, GridInstance, Obstacle, Vehicle};
use cohaul_planner::plan::{CarPlan, Claims, GridPlan, Route};
use nalgebra::Point2;

fn kinds(violations: &[Violation]) -> Vec<&'static str> {
    violations.iter().map(|violation| violation.kind.name()).collect()
}

const fn cell(x: i32, y: i32) -> Cell {
    Cell { x, y }
}

/// ```text
/// a . . b     a goes to the right end, b to the left one,
/// # # . #     b steps aside in between
/// ```
fn corridor() -> (GridInstance, GridPlan) {
    let agent = |name: &str, start, goal| GridAgent { name: name.into(), start, goals: vec![goal] };
    let mut blocked = vec![false; 8];
    for cell in [4, 5, 7] {
        blocked[cell] = true;
    }
    let agents = vec![agent("a", cell(0, 0), cell(3, 0)), agent("b", cell(3, 0), cell(0, 0))];
    let instance = GridInstance { width: 4, height: 2, blocked, agents, assignment: false };
    let route = |name: &str, states: &[(i32, i32)]| Route {
        name: name.into(),
        goal: Some(0),
        states: states.iter().map(|(x, y)| cell(*x, *y)).collect(),
    };
    let routes = vec![
        route("a", &[(0, 0), (1, 0), (2, 0), (3, 0)]),
        route("b", &[(3, 0), (2, 0), (2, 1), (2, 0), (1, 0), (0, 0)]),
    ];
    let claims =
        Claims { cost: Some(8.0), makespan: Some(5.0), flowtime: Some(8.0), lower_bound: Some(8.0), bound: Some(1.0) };
    (instance, GridPlan { routes, claims })
}

#[test]
fn a_right_plan_on_a_grid_passes() {
    let (instance, plan) = corridor();
    assert_eq!(certify::grid(&instance, &plan), []);
}

/// Name of the change, the change, what must be found.
type Change<P> = (&'static str, fn(&mut P), &'static [ViolationKind]);

#[test]
fn every_change_of_a_plan_on_a_grid_is_caught() {
    use ViolationKind::{
        Agents, Bound, Collision, Cost, Flowtime, Goal, LowerBound, Makespan, Obstacle, Outside, Start, Step, Swap,
    };
    let changes: &[Change<GridPlan>] = &[
        ("first state dropped", |p| _ = p.routes[1].states.remove(0), &[Start, Cost]),
        ("state dropped", |p| _ = p.routes[1].states.remove(4), &[Step]),
        ("last state dropped", |p| _ = p.routes[0].states.pop(), &[Goal]),
        ("not aside", |p| p.routes[1].states[2] = cell(2, 0), &[Collision]),
        ("into a wall", |p| p.routes[1].states[2] = cell(1, 1), &[Obstacle, Step]),
        ("out of the map", |p| p.routes[0].states[1] = cell(-1, 0), &[Outside, Step]),
        ("very far out", |p| p.routes[0].states[1] = cell(i32::MIN, i32::MAX), &[Outside, Step]),
        ("routes swapped", |p| p.routes.swap(0, 1), &[Agents]),
        (
            "names swapped",
            |p| p.routes.iter_mut().for_each(|r| r.name = if r.name == "a" { "b" } else { "a" }.into()),
            &[Agents, Start],
        ),
        ("route missing", |p| _ = p.routes.pop(), &[Agents]),
        ("route twice", |p| p.routes.push(p.routes[0].clone()), &[Agents]),
        ("empty route", |p| p.routes[0].states.clear(), &[Start]),
        ("goal that is none", |p| p.routes[0].goal = Some(7), &[Goal]),
        ("straight through", |p| p.routes[1].states = (0..4).rev().map(|x| cell(x, 0)).collect(), &[Swap]),
        ("wrong cost", |p| p.claims.cost = Some(7.0), &[Cost]),
        ("cost is no number", |p| p.claims.cost = Some(f64::NAN), &[Cost]),
        ("wrong makespan", |p| p.claims.makespan = Some(6.0), &[Makespan]),
        ("wrong flowtime", |p| p.claims.flowtime = Some(9.0), &[Flowtime]),
        ("lower bound above the cost", |p| p.claims.lower_bound = Some(8.5), &[LowerBound]),
        ("not within the bound", |p| p.claims.lower_bound = Some(7.0), &[Bound]),
        ("bound below 1", |p| p.claims.bound = Some(0.5), &[Bound]),
        // the shortest ways are 3 + 3
        ("bound without a lower bound", |p| p.claims = Claims { bound: Some(1.3), ..Claims::default() }, &[Bound]),
    ];
    let (instance, plan) = corridor();
    for (name, change, expected) in changes {
        let mut changed = plan.clone();
        change(&mut changed);
        let found = certify::grid(&instance, &changed);
        for kind in *expected {
            assert!(found.iter().any(|violation| violation.kind == *kind), "{name}: {found:?}");
        }
        assert!(found.is_sorted_by(|a, b| a.time <= b.time), "{name}");
    }
}

#[test]
fn a_bound_without_a_lower_bound_is_held_against_the_shortest_ways() {
    let (instance, mut plan) = corridor();
    plan.claims = Claims { bound: Some(1.34), ..Claims::default() }; // 8 ≤ 1.34 · 6
    assert_eq!(certify::grid(&instance, &plan), []);
}

/// Whoever has arrived is still there.
#[test]
fn driving_over_an_agent_that_has_arrived_is_a_collision() {
    let (mut instance, mut plan) = corridor();
    instance.agents[1] = GridAgent { name: "b".into(), start: cell(1, 0), goals: vec![cell(1, 0)] };
    plan.routes[1] = Route { name: "b".into(), goal: Some(0), states: vec![cell(1, 0)] };
    plan.claims = Claims::default();
    let found = certify::grid(&instance, &plan);
    assert_eq!(kinds(&found), ["collision"]);
    assert_eq!((found[0].time, found[0].agents.as_slice()), (1.0, &[0, 1][..]));
}

#[test]
fn goals_are_taken_once_and_as_many_as_can_be() {
    let (mut instance, mut plan) = corridor();
    instance.assignment = true;
    // whoever takes the right end leaves the left one to the other
    instance.agents[0].goals = vec![cell(3, 0), cell(0, 0)];
    instance.agents[1].goals = vec![cell(0, 0), cell(3, 0)];
    let stays = |name: &str, goal, at| Route { name: name.into(), goal, states: vec![at] };
    plan.claims = Claims { cost: Some(0.0), lower_bound: Some(0.0), bound: Some(1.0), ..Claims::default() };
    plan.routes = vec![stays("a", Some(1), cell(0, 0)), stays("b", Some(1), cell(3, 0))];
    assert_eq!(certify::grid(&instance, &plan), []);
    plan.routes[1].goal = None;
    assert_eq!(kinds(&certify::grid(&instance, &plan)), ["assignment"], "b could have a goal too");
    plan.routes[1].goal = Some(0);
    let found = certify::grid(&instance, &plan);
    assert_eq!(kinds(&found), ["assignment", "goal"], "both take the left end: {found:?}");
    // nothing to take for b, behind a wall or at all
    instance.agents[1].goals = vec![];
    plan.routes[1].goal = None;
    assert_eq!(certify::grid(&instance, &plan), []);
}

/// In the programs of libMultiRobotPlanning, waits of agents without a goal cost nothing, nor do waits in goals.
#[test]
fn an_agent_without_a_goal_pays_its_moves() {
    let (mut instance, mut plan) = corridor();
    instance.assignment = true;
    instance.agents[1].goals = vec![];
    plan.routes[1].goal = None;
    plan.routes[1].states = [(3, 0), (3, 0), (2, 0), (2, 1)].map(|(x, y)| cell(x, y)).to_vec();
    plan.routes[0].states = [(0, 0), (0, 0), (1, 0), (1, 0), (2, 0), (3, 0)].map(|(x, y)| cell(x, y)).to_vec();
    plan.claims = Claims { cost: Some(5.0 + 2.0), makespan: Some(5.0), ..Claims::default() };
    assert_eq!(certify::grid(&instance, &plan), []);
}

#[test]
fn a_map_whose_cells_are_missing_is_said() {
    let (mut instance, plan) = corridor();
    instance.blocked.pop();
    assert_eq!(kinds(&certify::grid(&instance, &plan)), ["instance"]);
    instance.width = i32::MAX;
    instance.height = i32::MAX;
    assert_eq!(kinds(&certify::grid(&instance, &plan)), ["instance"]);
}

/// A thousand agents in one cell for a thousand steps.
#[test]
fn however_much_is_wrong_the_report_is_short() {
    let agent = |k: usize| GridAgent { name: k.to_string(), start: cell(0, 0), goals: vec![cell(0, 0)] };
    let route = |k: usize| Route { name: k.to_string(), goal: Some(0), states: vec![cell(0, 0); 1000] };
    let agents = (0..1000).map(agent).collect();
    let instance = GridInstance { width: 1, height: 1, blocked: vec![false], agents, assignment: false };
    let plan = GridPlan { routes: (0..1000).map(route).collect(), claims: Claims::default() };
    assert_eq!(certify::grid(&instance, &plan).len(), VIOLATIONS_MAX);
}

/// A car of the CL-CBS benchmark: steps of 2.118 m, radius 3 m, 3 × 2 m.
fn car(start: Pose2, goal: Pose2) -> CarAgent {
    CarAgent { name: format!("car{}", position(&start).x), start, goals: vec![goal] }
}

fn route(agent: &CarAgent, states: Vec<Pose2>) -> Route<Pose2> {
    Route { name: agent.name.clone(), goal: Some(0), states }
}

fn world(agents: Vec<CarAgent>) -> CarInstance {
    let vehicle = Vehicle::default();
    CarInstance { width: 50.0, height: 50.0, obstacles: vec![], vehicle, agents, assignment: false, free_starts: false }
}

/// The pose after an arc of this length that turns by `turn`.
fn onward(from: &Pose2, length: f64, turn: f64) -> Pose2 {
    let gone = if turn == 0.0 {
        pose(length, 0.0, 0.0)
    } else {
        let radius = length / turn;
        pose(radius * turn.sin(), radius * (1.0 - turn.cos()), turn)
    };
    from * gone
}

/// Forwards to the left, straight, a wait, backwards to the right, half a step on; and another that stands.
fn drive() -> (CarInstance, CarPlan) {
    let step = Vehicle::default().step_length();
    let mut states = vec![pose(20.1, 20.2, 0.3)];
    for (length, turn) in [(step, 0.706), (step, 0.0), (0.0, 0.0), (-step, 0.706), (-0.5 * step, 0.0)] {
        states.push(onward(&states[states.len() - 1], length, turn));
    }
    let agents = vec![car(states[0], states[5]), car(pose(40.0, 40.0, 1.0), pose(40.0, 40.0, 1.0))];
    let routes = vec![route(&agents[0], states), route(&agents[1], vec![pose(40.0, 40.0, 1.0)])];
    let claims = Claims {
        // turning; plain; a wait; turning, reversing, switching; reversing
        cost: Some(step * (1.5 + 1.0 + 1.0 + 1.5 * 2.0 * 2.0 + 0.5 * 2.0)),
        makespan: Some(4.5 * step),
        flowtime: Some(4.5 * step),
        lower_bound: Some(10.0 * step),
        bound: Some(1.1),
    };
    (world(agents), CarPlan { routes, claims })
}

#[test]
fn a_right_drive_passes() {
    let (instance, plan) = drive();
    for model in [Model::Clcbs, Model::Exact] {
        assert_eq!(certify::car(&instance, &plan, model), []);
    }
}

/// As C++ streams print it.
fn printed(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap()
}

/// Foreign plans come with six digits, and CL-CBS forgets penalties on the last curve.
#[test]
fn a_right_drive_of_six_digits_passes() {
    let (instance, mut plan) = drive();
    for state in plan.routes.iter_mut().flat_map(|route| &mut route.states) {
        let place = position(state);
        *state = pose(printed(place.x), printed(place.y), printed(yaw(state)));
    }
    let step = instance.vehicle.step_length();
    plan.claims = Claims {
        cost: Some(printed(9.5 * step)),
        makespan: Some(printed(4.5 * step)),
        flowtime: Some(printed(4.5 * step)),
        ..Claims::default()
    };
    assert_eq!(certify::car(&instance, &plan, Model::Exact), []);
    plan.claims.cost = Some(11.0 * step);
    assert_eq!(kinds(&certify::car(&instance, &plan, Model::Exact)), ["cost"]);
    // a thousandth is more than the sixth digit of 20
    plan.claims.cost = None;
    plan.routes[0].states[2] = pose(printed(position(&plan.routes[0].states[2]).x + 2e-3), 21.0, 0.0);
    assert!(!certify::car(&instance, &plan, Model::Exact).is_empty());
}

#[test]
fn every_change_of_a_drive_is_caught() {
    use ViolationKind::{Agents, Bound, Cost, Flowtime, Goal, LowerBound, Makespan, Number, Outside, Start, Step};
    fn moved(state: &mut Pose2, x: f64, y: f64, turn: f64) {
        *state *= pose(x, y, turn);
    }
    let changes: &[Change<CarPlan>] = &[
        ("first state dropped", |p| _ = p.routes[0].states.remove(0), &[Start, Cost]),
        ("state dropped", |p| _ = p.routes[0].states.remove(1), &[Step]),
        ("last state dropped", |p| _ = p.routes[0].states.pop(), &[Goal, Flowtime]),
        ("wait dropped", |p| _ = p.routes[0].states.remove(3), &[Cost, Flowtime, Makespan]),
        ("a millimetre sideways", |p| moved(&mut p.routes[0].states[2], 0.0, 1e-3, 0.0), &[Step]),
        ("a millimetre too far", |p| moved(&mut p.routes[0].states[2], 1e-3, 0.0, 0.0), &[Step]),
        ("a milliradian", |p| moved(&mut p.routes[0].states[2], 0.0, 0.0, 1e-3), &[Step]),
        ("start a millimetre off", |p| moved(&mut p.routes[0].states[0], 1e-3, 0.0, 0.0), &[Start]),
        ("goal a millimetre off", |p| moved(&mut p.routes[0].states[5], 1e-3, 0.0, 0.0), &[Goal]),
        ("goal turned", |p| moved(&mut p.routes[0].states[5], 0.0, 0.0, 1e-3), &[Goal]),
        ("states swapped", |p| p.routes[0].states.swap(1, 2), &[Step]),
        ("out of the map", |p| p.routes[0].states[2] = pose(-1.0, 20.0, 0.0), &[Outside, Step]),
        ("names swapped", |p| p.routes.swap(0, 1), &[Agents]),
        ("route missing", |p| _ = p.routes.pop(), &[Agents]),
        ("empty route", |p| p.routes[0].states.clear(), &[Start]),
        ("not a number", |p| p.routes[0].states[2] = pose(f64::NAN, 0.0, 0.0), &[Number]),
        ("infinite", |p| p.routes[0].states[2] = pose(0.0, f64::INFINITY, 0.0), &[Number]),
        ("huge", |p| p.routes[0].states[2] = pose(1e300, -1e300, 0.0), &[Number]),
        ("goal that is none", |p| p.routes[0].goal = Some(1), &[Goal]),
        ("wrong cost", |p| *p.claims.cost.as_mut().unwrap() -= 1e-3, &[Cost]),
        ("wrong makespan", |p| *p.claims.makespan.as_mut().unwrap() -= 1e-3, &[Makespan]),
        ("wrong flowtime", |p| *p.claims.flowtime.as_mut().unwrap() += 1e-3, &[Flowtime]),
        ("lower bound above the cost", |p| p.claims.lower_bound = Some(25.0), &[LowerBound]),
        ("not within the bound", |p| p.claims.lower_bound = Some(10.0), &[Bound]),
        ("no bound to check", |p| p.claims.lower_bound = None, &[Bound]),
    ];
    let (instance, plan) = drive();
    for (name, change, expected) in changes {
        let mut changed = plan.clone();
        change(&mut changed);
        for model in [Model::Clcbs, Model::Exact] {
            let found = certify::car(&instance, &changed, model);
            for kind in *expected {
                assert!(found.iter().any(|violation| violation.kind == *kind), "{name}: {found:?}");
            }
        }
    }
}

#[test]
fn a_vehicle_that_only_drives_forwards_does_not_reverse() {
    let (mut instance, plan) = drive();
    instance.vehicle.drive = Drive::ForwardCar;
    let found = certify::car(&instance, &plan, Model::Exact);
    assert_eq!(kinds(&found), ["direction"]);
    assert_eq!(found[0].time, 3.0);
}

#[test]
fn tighter_than_the_turning_radius_is_caught() {
    let (instance, mut plan) = drive();
    let step = instance.vehicle.step_length();
    plan.routes[0].states[1] = onward(&plan.routes[0].states[0], step, 0.71);
    let found = certify::car(&instance, &plan, Model::Exact);
    assert!(found[0].kind == ViolationKind::Step && found[0].detail.contains("radius of 2.98"), "{found:?}");
}

/// A turn in place by 0.353 rad is half a step; turning while driving is none.
#[test]
fn differential_drives_turn_in_place_and_drive_straight() {
    let start = pose(10.0, 10.0, 0.1);
    let step = Vehicle::default().step_length();
    let mut states = vec![start];
    for (length, turn) in [(0.0, 0.706), (0.0, 0.353), (-step, 0.0)] {
        let last = states[states.len() - 1];
        states.push(if length == 0.0 { last * pose(0.0, 0.0, turn) } else { onward(&last, length, 0.0) });
    }
    let mut instance = world(vec![car(start, states[3])]);
    instance.vehicle.drive = Drive::Differential;
    let claims = Claims {
        cost: Some(step * (1.5 * 1.5 + 2.0)),
        makespan: Some(2.5 * step),
        flowtime: Some(2.5 * step),
        ..Claims::default()
    };
    let mut plan = CarPlan { routes: vec![route(&instance.agents[0], states)], claims };
    assert_eq!(certify::car(&instance, &plan, Model::Exact), []);
    let too_far = plan.routes[0].states[0] * pose(0.0, 0.0, 0.8);
    plan.routes[0].states[1] = too_far;
    assert!(kinds(&certify::car(&instance, &plan, Model::Exact)).contains(&"step"));
    plan.routes[0].states[1] = onward(&start, step, 0.1);
    assert!(kinds(&certify::car(&instance, &plan, Model::Exact)).contains(&"step"));
}

/// Two cars that pass through each other within a step: apart enough at both ends, in the middle of it they overlap.
#[test]
fn tunnelling_is_seen_between_the_steps_only() {
    let step = Vehicle::default().step_length();
    // crossing at a right angle: (±0.5 step, 0) and (0, ±0.5 step), with cars so small that the ends are far apart
    let (a, b) = (pose(20.0 - 0.5 * step, 20.0, 0.0), pose(20.0, 20.0 - 0.5 * step, std::f64::consts::FRAC_PI_2));
    let (ends_a, ends_b) = (onward(&a, step, 0.0), onward(&b, step, 0.0));
    let mut instance = world(vec![car(a, ends_a), car(b, ends_b)]);
    instance.vehicle = Vehicle { front: 0.2, rear: 0.2, width: 0.3, ..Vehicle::default() };
    let routes = vec![route(&instance.agents[0], vec![a, ends_a]), route(&instance.agents[1], vec![b, ends_b])];
    let plan = CarPlan { routes, claims: Claims::default() };
    assert_eq!(certify::car(&instance, &plan, Model::Clcbs), []);
    let found = certify::car(&instance, &plan, Model::Exact);
    assert_eq!(kinds(&found), ["collision"]);
    assert!(found[0].time > 0.0 && found[0].time < 0.5 && found[0].detail.contains("overlap"), "{found:?}");
}

/// The error of CL-CBS in batches: a car of a later batch is parked where one of an earlier batch drives.
#[test]
fn a_parked_car_that_is_driven_over_is_seen_in_both_models() {
    let step = Vehicle::default().step_length();
    let start = pose(10.0, 20.0, 0.0);
    let mut states = vec![start];
    for _ in 0..8 {
        states.push(onward(&states[states.len() - 1], step, 0.0));
    }
    let parked = pose(19.0, 20.0, 1.57);
    let instance = world(vec![car(start, states[8]), car(parked, parked)]);
    let routes = vec![route(&instance.agents[0], states), route(&instance.agents[1], vec![parked])];
    let plan = CarPlan { routes, claims: Claims::default() };
    for model in [Model::Clcbs, Model::Exact] {
        let found = certify::car(&instance, &plan, model);
        assert_eq!(kinds(&found), ["collision"], "{model:?}");
        assert!(found[0].time > 1.0, "not before they meet");
    }
}

/// Cars side by side whose sides touch along the whole way, one driving each way: no overlap, and no endless creeping.
#[test]
fn touching_is_no_collision() {
    let step = Vehicle::default().step_length();
    let (a, b) = (pose(20.0, 20.0, 0.0), pose(23.0, 22.0, std::f64::consts::PI));
    let (end_a, end_b) = (onward(&a, step, 0.0), onward(&b, step, 0.0));
    let instance = world(vec![car(a, end_a), car(b, end_b)]);
    let routes = vec![route(&instance.agents[0], vec![a, end_a]), route(&instance.agents[1], vec![b, end_b])];
    let plan = CarPlan { routes, claims: Claims::default() };
    assert_eq!(certify::car(&instance, &plan, Model::Exact), []);
}

#[test]
fn obstacles_are_met_between_steps_in_the_exact_model_only() {
    let step = Vehicle::default().step_length();
    let start = pose(20.0, 20.0, 0.0);
    let end = onward(&start, step, 0.0);
    let mut instance = world(vec![car(start, end)]);
    instance.vehicle = Vehicle { front: 0.2, rear: 0.2, width: 0.4, ..Vehicle::default() };
    let plan = CarPlan { routes: vec![route(&instance.agents[0], vec![start, end])], claims: Claims::default() };
    let corners = |points: &[(f64, f64)]| points.iter().map(|(x, y)| Point2::new(*x, *y)).collect::<Vec<_>>();
    let in_the_way = [
        Obstacle::Point { at: Point2::new(21.0, 20.45), radius: 0.3 },
        Obstacle::Polygon(corners(&[(21.0, 20.1), (21.2, 20.9), (20.8, 20.9)])),
    ];
    for obstacle in in_the_way {
        instance.obstacles = vec![obstacle];
        assert_eq!(certify::car(&instance, &plan, Model::Clcbs), []);
        let found = certify::car(&instance, &plan, Model::Exact);
        assert_eq!(kinds(&found), ["obstacle"]);
        assert!(found[0].time > 0.2 && found[0].time < 0.6, "{found:?}");
    }
    // in the corner of the grown rectangle, 0.41 m from the body: CL-CBS does not round corners
    instance.obstacles = vec![Obstacle::Point { at: Point2::new(19.51, 20.49), radius: 0.3 }];
    assert_eq!(kinds(&certify::car(&instance, &plan, Model::Clcbs)), ["obstacle"]);
    instance.obstacles = vec![Obstacle::Point { at: Point2::new(19.49, 20.49), radius: 0.3 }];
    assert_eq!(certify::car(&instance, &plan, Model::Exact), []);
}

#[test]
fn an_instance_that_makes_no_sense_is_said() {
    let (instance, plan) = drive();
    let triangle = |points: [(f64, f64); 3]| Obstacle::Polygon(points.map(|(x, y)| Point2::new(x, y)).to_vec());
    let changes: [&dyn Fn(&mut CarInstance); 7] = [
        &|i| i.vehicle.width = 0.0,
        &|i| i.vehicle.turning_radius = f64::NAN,
        &|i| i.width = f64::INFINITY,
        &|i| i.agents[0].start = pose(f64::NAN, 0.0, 0.0),
        &|i| i.obstacles.push(Obstacle::Polygon(vec![])),
        &|i| i.obstacles.push(triangle([(0.0, 0.0), (0.0, 1.0), (1.0, 0.0)])), // clockwise
        &|i| i.obstacles.push(Obstacle::Point { at: Point2::new(1.0, 1.0), radius: f64::NAN }),
    ];
    for change in changes {
        let mut changed = instance.clone();
        change(&mut changed);
        assert_eq!(kinds(&certify::car(&changed, &plan, Model::Exact)), ["instance"]);
    }
}

#[test]
fn cars_take_as_many_goals_as_there_are() {
    let places = [pose(10.0, 10.0, 0.0), pose(30.0, 30.0, 0.0)];
    let mut instance = world(places.iter().map(|place| car(*place, *place)).collect());
    instance.assignment = true;
    instance.agents.iter_mut().for_each(|agent| agent.goals = places.to_vec());
    let mut plan = CarPlan {
        routes: instance.agents.iter().map(|agent| route(agent, vec![agent.start])).collect(),
        claims: Claims { cost: Some(0.0), bound: Some(1.0), ..Claims::default() },
    };
    plan.routes[1].goal = Some(1);
    assert_eq!(certify::car(&instance, &plan, Model::Exact), []);
    plan.routes[1].goal = None;
    assert_eq!(kinds(&certify::car(&instance, &plan, Model::Exact)), ["assignment"]);
    // unless nobody can stand there
    instance.obstacles = vec![Obstacle::Point { at: Point2::new(31.0, 32.0), radius: 0.8 }];
    instance.agents[1].start = pose(30.0, 40.0, 0.0);
    plan.routes[1].states = vec![pose(30.0, 40.0, 0.0)];
    instance.obstacles = vec![Obstacle::Point { at: Point2::new(30.0, 31.0), radius: 0.8 }];
    assert_eq!(certify::car(&instance, &plan, Model::Exact), []);
}

/// The names in files are those of the program.
#[test]
fn kinds_are_written_as_they_are_called() {
    for kind in [ViolationKind::LowerBound, ViolationKind::Collision, ViolationKind::Unchecked] {
        assert_eq!(serde_json::to_value(kind).unwrap(), kind.name());
    }
    let violation = Violation { kind: ViolationKind::Swap, time: 1.5, agents: vec![0, 2], detail: "x".into() };
    let expected = serde_json::json!({"kind": "swap", "time": 1.5, "agents": [0, 2], "detail": "x"});
    assert_eq!(serde_json::to_value(violation).unwrap(), expected);
}

/// Whatever is in a plan, the work is bounded: bodies in one heap, steps without number, obstacles with many corners.
#[test]
fn too_much_to_look_at_is_said() {
    let heap = pose(25.0, 25.0, 0.0);
    let agents: Vec<CarAgent> =
        (0..200).map(|k| CarAgent { name: k.to_string(), start: heap, goals: vec![heap] }).collect();
    let mut instance = world(agents);
    let routes = instance.agents.iter().map(|agent| route(agent, vec![heap; 2000])).collect();
    let plan = CarPlan { routes, claims: Claims::default() };
    for model in [Model::Clcbs, Model::Exact] {
        let found = certify::car(&instance, &plan, model);
        assert_eq!(found.len(), VIOLATIONS_MAX);
    }
    let corner = |k: u32| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 1001.0).sin_cos();
        Point2::new(10.0 + cos, 10.0 + sin)
    };
    instance.obstacles = vec![Obstacle::Polygon((0..1001).map(corner).collect())];
    assert_eq!(kinds(&certify::car(&instance, &plan, Model::Exact)), ["instance"]);
    instance.obstacles = vec![Obstacle::Point { at: Point2::new(1.0, 1.0), radius: 0.8 }; 2000];
    let found = certify::car(&instance, &plan, Model::Exact);
    assert_eq!(found.len(), VIOLATIONS_MAX);
    // one that drives in circles for ever, past a thousand obstacles
    let step = instance.vehicle.step_length();
    let mut states = vec![heap];
    for _ in 0..120_000 {
        states.push(onward(&states[states.len() - 1], step, 0.706));
    }
    instance.agents.truncate(1);
    instance.agents[0].goals = vec![states[states.len() - 1]];
    let plan = CarPlan { routes: vec![route(&instance.agents[0], states)], claims: Claims::default() };
    let found = certify::car(&instance, &plan, Model::Exact);
    assert_eq!(kinds(&found), ["unchecked"], "{found:?}");
}

/// A hundred cars on random drives for 150 steps: who meets is looked for in every step.
#[test]
fn the_models_agree_where_nobody_comes_near() {
    // rows of cars that drive to and fro, each within its own strip of 5 m
    let step = Vehicle::default().step_length();
    let mut agents = Vec::new();
    let mut routes = Vec::new();
    for row in 0..50 {
        for side in 0..2 {
            let start = pose(20.0 + 150.0 * f64::from(side), 5.0 + 5.0 * f64::from(row), 0.0);
            let mut states = vec![start];
            for number in 0..150 {
                let way = if number / 10 % 2 == 0 { step } else { -step };
                states.push(onward(&states[states.len() - 1], way, 0.0));
            }
            let name = format!("{row}-{side}");
            agents.push(CarAgent { name: name.clone(), start, goals: vec![states[150]] });
            routes.push(Route { name, goal: Some(0), states });
        }
    }
    let mut instance = world(agents);
    (instance.width, instance.height) = (300.0, 300.0);
    let plan = CarPlan { routes, claims: Claims { flowtime: Some(15_000.0 * step), ..Claims::default() } };
    for model in [Model::Clcbs, Model::Exact] {
        assert_eq!(certify::car(&instance, &plan, model), []);
    }
}
