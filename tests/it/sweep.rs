//! The certifier's sweep against looking at ten thousand instants of each step.

use cohaul_core::se2::{Pose2, pose};
use cohaul_planner::certify::{self, Model, ViolationKind};
use cohaul_planner::instance::{CarAgent, CarInstance, Obstacle, Vehicle};
use cohaul_planner::plan::{CarPlan, Claims, Route};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

const SAMPLES: u32 = 10_000;
const SEED: [u8; 32] = *b"the same cars meet in every run.";

/// An arc from a pose, by another way than the certifier's: length and turn are given, not found.
#[derive(Clone, Copy, Debug)]
struct Arc {
    from: Pose2,
    length: f64,
    turn: f64,
}

impl Arc {
    fn at(&self, share: f64) -> Pose2 {
        let (length, turn) = (share * self.length, share * self.turn);
        if self.turn.abs() < 1e-9 {
            return self.from * pose(length, 0.0, 0.0);
        }
        let radius = self.length / self.turn;
        self.from * pose(radius * turn.sin(), radius * (1.0 - turn.cos()), turn)
    }
}

fn corners(vehicle: &Vehicle, margin: f64, at: &Pose2) -> Vec<Vector2<f64>> {
    let (front, rear, side) = (vehicle.front + margin, vehicle.rear + margin, 0.5 * vehicle.width + margin);
    [(-rear, -side), (front, -side), (front, side), (-rear, side)]
        .iter()
        .map(|(x, y)| (at * Point2::new(*x, *y)).coords)
        .collect()
}

/// Depth of the overlap of two convex polygons: least over all sides of how far the other reaches in; negative apart.
fn depth(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    let mut least = f64::INFINITY;
    for (one, other) in [(a, b), (b, a)] {
        for k in 0..one.len() {
            let side = one[(k + 1) % one.len()] - one[k];
            if side.norm() == 0.0 {
                continue;
            }
            let inward = Vector2::new(-side.y, side.x).normalize();
            least = least.min(other.iter().map(|p| inward.dot(&(p - one[k]))).fold(f64::NEG_INFINITY, f64::max));
        }
    }
    least
}

fn arc() -> impl Strategy<Value = Arc> {
    let vehicle = Vehicle::default();
    // straight ones too, and waits
    let turn = prop_oneof![3 => -1.0..1.0_f64, 1 => Just(0.0)];
    let length = prop_oneof![6 => -1.0..1.0_f64, 1 => Just(1.0), 1 => Just(0.0)];
    (8.0..13.0_f64, 8.0..13.0_f64, -3.2..3.2_f64, length, turn).prop_map(move |(x, y, yaw, length, turn)| Arc {
        from: pose(x, y, yaw),
        length: length * vehicle.step_length(),
        turn: turn * length.abs() * vehicle.step_angle,
    })
}

fn body() -> impl Strategy<Value = Vehicle> {
    let size = || 0.2..2.0_f64;
    (size(), size(), size()).prop_map(|(front, rear, width)| Vehicle { front, rear, width, ..Vehicle::default() })
}

fn world(vehicle: Vehicle, arcs: &[Arc], obstacles: Vec<Obstacle>) -> (CarInstance, CarPlan) {
    let agent = |(k, arc): (usize, &Arc)| CarAgent { name: k.to_string(), start: arc.from, goals: vec![arc.at(1.0)] };
    let route =
        |(k, arc): (usize, &Arc)| Route { name: k.to_string(), goal: Some(0), states: vec![arc.from, arc.at(1.0)] };
    let agents = arcs.iter().enumerate().map(agent).collect();
    let routes = arcs.iter().enumerate().map(route).collect();
    let instance =
        CarInstance { width: 20.0, height: 20.0, obstacles, vehicle, agents, assignment: false, free_starts: false };
    (instance, CarPlan { routes, claims: Claims::default() })
}

/// Greatest depth over the step, from `overlap` at each share.
fn deepest(overlap: impl Fn(f64) -> f64) -> f64 {
    (0..=SAMPLES).map(|k| overlap(f64::from(k) / f64::from(SAMPLES))).fold(f64::NEG_INFINITY, f64::max)
}

/// How many met, how many did not.
fn compared(cases: u32, strategy: impl Strategy<Value = (CarInstance, CarPlan, f64)>, kind: ViolationKind) -> [u32; 2] {
    let mut runner = TestRunner::new_with_rng(
        Config { cases, failure_persistence: None, ..Config::default() },
        TestRng::from_seed(RngAlgorithm::ChaCha, &SEED),
    );
    let counts = std::cell::Cell::new([0, 0]);
    runner
        .run(&strategy, |(instance, plan, depth)| {
            let found = certify::car(&instance, &plan, Model::Exact);
            let met = found.iter().any(|violation| violation.kind == kind);
            let mut both = counts.get();
            both[usize::from(!met)] += 1;
            counts.set(both);
            // between samples bodies go on by at most some 8 m ÷ 10⁴, and overlaps of up to 1 µm may be passed
            prop_assert!(!met || depth > -1e-3, "found, but they stay {} m apart", -depth);
            prop_assert!(met || depth < 1e-6, "missed, {depth} m deep");
            prop_assert!(found.iter().all(|violation| violation.kind == kind), "{found:?}");
            Ok(())
        })
        .unwrap();
    counts.get()
}

/// 2,000 pairs of random arcs and bodies.
#[test]
fn bodies_meet_when_dense_sampling_says_so() {
    let pairs = (body(), arc(), arc()).prop_map(|(vehicle, a, b)| {
        let (instance, plan) = world(vehicle, &[a, b], vec![]);
        let depth =
            deepest(|share| depth(&corners(&vehicle, 0.0, &a.at(share)), &corners(&vehicle, 0.0, &b.at(share))));
        (instance, plan, depth)
    });
    let [met, apart] = compared(2000, pairs, ViolationKind::Collision);
    assert!(met > 400 && apart > 400, "{met} met, {apart} did not");
}

/// 1,000 random arcs and bodies, each with a triangle and a point in the plane.
#[test]
fn bodies_meet_obstacles_when_dense_sampling_says_so() {
    let place = || (6.0..15.0_f64, 6.0..15.0_f64);
    let triangle = (place(), 0.1..2.0_f64, 0.0..6.3_f64).prop_map(|((x, y), size, angle)| {
        let corner = |k: f64| Point2::new(x + size * (angle + k).cos(), y + size * (angle + k).sin());
        vec![corner(0.0), corner(1.0), corner(3.5)]
    });
    let scenes =
        (body(), arc(), triangle, place(), 0.0..1.0_f64).prop_map(|(vehicle, arc, triangle, (x, y), radius)| {
            let point = Point2::new(x, y);
            let obstacles = vec![Obstacle::Polygon(triangle.clone()), Obstacle::Point { at: point, radius }];
            let (instance, plan) = world(vehicle, &[arc], obstacles);
            let triangle: Vec<_> = triangle.iter().map(|corner| corner.coords).collect();
            let depth = deepest(|share| {
                let at = arc.at(share);
                let with_triangle = depth(&corners(&vehicle, 0.0, &at), &triangle);
                with_triangle.max(depth(&corners(&vehicle, radius, &at), &[point.coords]))
            });
            (instance, plan, depth)
        });
    let [met, apart] = compared(1000, scenes, ViolationKind::Obstacle);
    assert!(met > 200 && apart > 200, "{met} met, {apart} did not");
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -50.0..50.0_f64,
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(0.0),
        Just(-0.0),
        -1e9..1e9_f64
    ]
}

fn any_pose() -> impl Strategy<Value = Pose2> {
    (any_number(), any_number(), any_number()).prop_map(|(x, y, yaw)| pose(x, y, yaw))
}

proptest! {
    #![proptest_config(Config { cases: 500, ..Config::default() })]

    /// Whatever the numbers are, there is an answer, and a wrong plan is never passed: nothing random fits together.
    #[test]
    fn nonsense_is_answered(
        states in proptest::collection::vec(proptest::collection::vec(any_pose(), 0..6), 0..5),
        goals in proptest::collection::vec(any_pose(), 3),
        sizes in proptest::collection::vec(any_number(), 8),
        claims in proptest::collection::vec(proptest::option::of(any_number()), 5),
        triangle in proptest::collection::vec((any_number(), any_number()), 0..5),
        assignment: bool,
        exact: bool,
    ) {
        let agents = goals.iter().enumerate().map(|(k, goal)| CarAgent {
            name: k.to_string(), start: *goal, goals: goals[..k].to_vec(),
        });
        let mut vehicle = Vehicle::default();
        if sizes[0] > 0.0 {
            vehicle = Vehicle { front: sizes[1], rear: sizes[2], width: sizes[3], turning_radius: sizes[4], ..vehicle };
        }
        let obstacles = vec![
            Obstacle::Polygon(triangle.iter().map(|(x, y)| Point2::new(*x, *y)).collect()),
            Obstacle::Point { at: Point2::new(sizes[6], sizes[7]), radius: sizes[5] },
        ];
        let agents = agents.collect();
        let instance = CarInstance { width: sizes[5], height: 50.0, obstacles, vehicle, agents, assignment, free_starts: false };
        let routes = states.into_iter().enumerate().map(|(k, states)| Route {
            name: k.to_string(), goal: k.checked_sub(1), states,
        });
        let [cost, makespan, flowtime, lower_bound, bound] = claims[..] else { unreachable!() };
        let claims = Claims { cost, makespan, flowtime, lower_bound, bound };
        let plan = CarPlan { routes: routes.collect(), claims };
        let model = if exact { Model::Exact } else { Model::Clcbs };
        let found = certify::car(&instance, &plan, model);
        prop_assert!(!found.is_empty());
        prop_assert!(found.iter().all(|violation| violation.time >= 0.0 && violation.time <= 6.0));
    }
}
