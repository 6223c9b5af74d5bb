//! Waypoints planned through obstacles: what is found, what is refused and why, and missions that follow them.

use std::path::Path;

use cohaul_core::scenario::document::{Plan, Scenario};
use cohaul_core::scenario::{Override, Problem, parse};
use cohaul_planner::load_path::{
    EFFORT, LoadPathError, Obstruction, check, clutter, margin, plan, resolve, resolve_with,
};
use cohaul_planner::outcome::{Outcome, Reason};
use cohaul_planner::search::Budget;
use cohaul_sim::episode::{NoRecorder, run};
use rayon::prelude::*;

/// Half the room that the six robots and the load of `clutter.yaml` take across their heading, m: half of 1.35 m, the gap, a
/// robot's diameter.
const HALF: f64 = 0.675 + 0.01 + 0.21;
/// What the planner may ask for beyond: a polygon is drawn around discs and arcs.
const ROUNDING: f64 = 0.01;

fn scenario(changes: &[&str]) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/r2p2/clutter.yaml");
    let overrides: Vec<Override> = changes.iter().map(|c| Override::parse(c).unwrap()).collect();
    parse("clutter.yaml", &std::fs::read(path).unwrap(), &overrides).unwrap().resolve(None, &mut || 0.5).unwrap()
}

fn rectangle(x_min: f64, y_min: f64, x_max: f64, y_max: f64) -> String {
    format!("[[{x_min}, {y_min}], [{x_max}, {y_min}], [{x_max}, {y_max}], [{x_min}, {y_max}]]")
}

/// The team of `clutter.yaml` between `walls` (as in a scenario) and these obstacles.
fn map(walls: &str, obstacles: &[String], more: &[&str]) -> Scenario {
    let walls = format!("terrain.walls={walls}");
    let obstacles = format!("terrain.obstacles=[{}]", obstacles.join(", "));
    scenario(&[&[&*walls, &*obstacles], more].concat())
}

/// Two boxes that leave a door of this width at x = 4, between walls that nothing passes.
fn door(width: f64, depth: f64) -> Scenario {
    let boxes = [rectangle(4.0, -4.4, 4.0 + depth, -width / 2.0), rectangle(4.0, width / 2.0, 4.0 + depth, 4.4)];
    map("[-1.8, -4.5, 11.8, 4.5]", &boxes, &[])
}

/// Planned, certified to keep the margin.
fn certified(scenario: &Scenario) -> Vec<[f64; 2]> {
    let (resolved, _, planned) = resolve_with(scenario).unwrap_or_else(|error| panic!("{error}"));
    assert!(planned[0].clearance.least >= margin(resolved.teams[0].mission.tolerance) - check::RESOLUTION);
    planned[0].path.waypoints.iter().map(|at| [at.x, at.y]).collect()
}

#[test]
fn nothing_in_the_way_needs_only_points_on_the_line() {
    let waypoints = certified(&map("null", &[], &[]));
    assert_eq!(waypoints, [[2.0, 0.0], [4.0, 0.0], [6.0, 0.0], [8.0, 0.0]]);
    assert!(certified(&map("null", &[], &["teams.0.mission.goal={x: 1.5, y: 0.5}"])).is_empty());
}

#[test]
fn doors_and_corridors_are_passed_if_they_are_wide_enough() {
    let enough = 2.0 * (HALF + margin(0.1));
    for depth in [0.2, 3.0] {
        certified(&door(enough + 2.0 * ROUNDING, depth));
        match resolve(&door(enough - 0.001, depth)) {
            Err(LoadPathError::NoPassage { in_the_way, width, .. }) => {
                assert_eq!(in_the_way, [Obstruction::Obstacle(0), Obstruction::Obstacle(1)]);
                assert!((width / 2.0 - HALF).abs() < ROUNDING);
            }
            other => panic!("{depth}: {other:?}"),
        }
    }
}

/// A team that is long and narrow goes through lengthwise where it could not turn.
#[test]
fn a_narrow_team_passes_where_it_cannot_turn() {
    let long = [
        "loads.0.shape={rectangle: {length: 0.6, width: 1.8}}",
        "teams.0.formation={slots: {custom: [{edge: 1, at: 0.2}, {edge: 1, at: 0.8}, {edge: 3, at: 0.2}, {edge: 3, at: 0.8}]}}",
        "teams.0.robots.count=4",
        "loads.0.pose={x: -0.5, y: 0, yaw_deg: 0}",
    ];
    let corridor = |more: &[&str]| {
        let boxes = [rectangle(2.0, -4.4, 8.0, -1.05), rectangle(2.0, 1.05, 8.0, 4.4)];
        map("[-4, -4.5, 14, 4.5]", &boxes, &[&long[..], more].concat())
    };
    certified(&corridor(&[]));
    // along the corridor it may stop in it, across it may not
    certified(&corridor(&["teams.0.mission.goal={x: 5, y: 0}", "teams.0.mission.goal_yaw_deg=0"]));
    let across = corridor(&["teams.0.mission.goal={x: 5, y: 0}", "teams.0.mission.goal_yaw_deg=90"]);
    assert!(matches!(resolve(&across), Err(LoadPathError::Goal { .. })), "{:?}", resolve(&across));
    // it comes out at the other end, turns there, and comes back for a goal that looks the other way
    let back = corridor(&["teams.0.mission.goal={x: 5, y: 0}", "teams.0.mission.goal_yaw_deg=180"]);
    let waypoints = certified(&back);
    assert!(waypoints.iter().any(|at| at[0] > 8.0), "{waypoints:?}");
    // a load that may travel backwards need not turn at all
    let backwards = ["teams.0.mission.goal={x: -2, y: 0}", "teams.0.controller={r2p2: {drive: nearest}}"];
    let (_, _, planned) = resolve_with(&corridor(&backwards)).unwrap();
    assert!(planned[0].path.turning < 1e-9);
}

#[test]
fn what_is_in_the_way_is_said() {
    let walls = "[-1.8, -4.5, 11.8, 4.5]";
    let reason = |scenario: &Scenario| {
        let ended = plan(scenario, 0, &Budget::new(EFFORT, &|| false)).unwrap();
        let Outcome::Infeasible(reasons) = ended.outcome else { panic!("{ended:?}") };
        (reasons[0].clone(), resolve(scenario).unwrap_err().to_string())
    };
    // 5 cm in front of the robots at the start
    let start = map(walls, &[rectangle(3.0, 3.0, 3.5, 3.5), rectangle(0.45, -0.2, 0.8, 0.2)], &[]);
    let (why, text) = reason(&start);
    assert_eq!(why, Reason::StartBlocked { agent: 0, obstacle: Some(1) });
    assert!(text.contains("nearer to obstacle 1"), "{text}");
    let narrow = map("[-1.8, -1.02, 11.8, 1.02]", &[], &[]);
    let (why, text) = reason(&narrow);
    assert_eq!(why, Reason::StartBlocked { agent: 0, obstacle: None });
    assert!(text.contains("a wall"), "{text}");
    let goal = map(walls, &[rectangle(10.3, -0.2, 10.8, 0.2)], &[]);
    let (why, text) = reason(&goal);
    assert_eq!(why, Reason::GoalBlocked { agent: 0, goal: 0, obstacle: Some(0) });
    assert!(text.contains("(10.00, 0.00)") && text.contains("obstacle 0"), "{text}");
    // a goal with room around it, but none to get there
    let room = [
        rectangle(8.0, -2.0, 8.2, 2.0),
        rectangle(11.5, -2.0, 11.7, 2.0),
        rectangle(8.2, 1.8, 11.5, 2.0),
        rectangle(8.2, -2.0, 11.5, -1.8),
    ];
    let (why, text) = reason(&map(walls, &room, &[]));
    assert_eq!(why, Reason::Unreachable { agent: 0, goal: 0 });
    assert!(!text.contains("not exhaustive"), "proven: {text}");
    // a bar from wall to wall
    let (why, text) = reason(&map(walls, &[rectangle(3.0, 3.0, 3.5, 3.5), rectangle(5.0, -4.5, 5.5, 4.5)], &[]));
    assert_eq!(why, Reason::Unreachable { agent: 0, goal: 0 });
    assert!(text.contains("obstacle 1 is in the way"), "{text}");
}

#[test]
fn a_spent_budget_ends_the_search() {
    let cluttered = scenario(&[]);
    for work in [0, 1, 10, 100, 1000] {
        let ended = plan(&cluttered, 0, &Budget::new(work, &|| false)).unwrap();
        assert!(matches!(ended.outcome, Outcome::BudgetSpent { best_bound } if best_bound == 10.0), "{work}");
    }
    let ended = plan(&cluttered, 0, &Budget::new(EFFORT, &|| true)).unwrap();
    assert!(matches!(ended.outcome, Outcome::BudgetSpent { .. }));
}

#[test]
fn a_scenario_is_planned_before_it_is_run() {
    let open = scenario(&[]);
    assert!(matches!(open.instance(), Err(Problem::Unplanned { .. })));
    let resolved = resolve(&open).unwrap();
    assert_eq!(resolved, resolve(&open).unwrap());
    assert!(resolved.teams[0].mission.plan == Plan::Given && !resolved.teams[0].mission.waypoints.is_empty());
    let text = resolved.to_yaml().unwrap();
    assert!(!text.contains("plan:"), "{text}");
    assert_eq!(resolve(&resolved).unwrap(), resolved);
}

/// The certificate does not depend on the planner: a waypoint moved towards an obstacle spoils it.
#[test]
fn the_check_finds_ways_that_come_too_near() {
    let mut resolved = resolve(&scenario(&[])).unwrap();
    let good = check::clearance(&resolved, 0).unwrap();
    assert!(good.at_least(margin(0.1)).is_ok());
    let waypoints = &mut resolved.teams[0].mission.waypoints;
    waypoints[1].y -= 0.15;
    let near = check::clearance(&resolved, 0).unwrap();
    assert!(near.least < good.least - 0.05 && near.at_least(margin(0.1)).is_err(), "{near}");
    resolved.teams[0].mission.waypoints.clear();
    assert!(check::clearance(&resolved, 0).unwrap().least <= 0.0);
}

/// Some maps for each of several teams: what is planned passes the check, which `resolve` asks for.
#[test]
fn what_is_planned_is_certified() {
    let teams: [&[&str]; 5] = [
        &[],
        &["loads.0.shape={rectangle: {length: 0.8, width: 0.8}}", "teams.0.formation={slots: auto, caging: none}"],
        &[
            "loads.0.shape={polygon: {vertices: [[-0.346, -0.6], [0.693, 0], [-0.346, 0.6]]}}",
            "teams.0.formation={slots: auto, caging: none, contact_placement: 0.12}",
            "teams.0.robots.count=5",
        ],
        &["teams.0.controller={r2p2: {drive: nearest}}", "teams.0.mission.goal_yaw_deg=90"],
        &["teams.0.mission.tolerance=0.2", "teams.0.mission.goal_yaw_deg=-135"],
    ];
    let cases: Vec<_> = teams.iter().flat_map(|team| (501..=503).map(move |seed| (team, seed))).collect();
    cases.into_par_iter().for_each(|(team, seed)| {
        let cluttered = clutter::scenario(&scenario(team), seed).unwrap_or_else(|error| panic!("{seed}: {error}"));
        certified(&cluttered);
    });
}

#[test]
fn missions_follow_what_was_planned() {
    let turned = ["teams.0.formation={slots: auto}", "teams.0.mission.goal_yaw_deg=90"];
    let cases: [(u64, &[&str]); 5] =
        [(501, &[]), (502, &[]), (503, &["world=spatial"]), (504, &["terrain.slope_deg=-5"]), (505, &turned)];
    cases.into_par_iter().for_each(|(seed, changes)| {
        let cluttered = clutter::scenario(&scenario(changes), seed).unwrap();
        let outcome = run(&resolve(&cluttered).unwrap(), &mut NoRecorder, &mut |_, _| false).unwrap();
        assert!(outcome.success, "map {seed}: {:?}", outcome.outcome);
        assert!(outcome.min_clearance_m > 0.0, "map {seed}");
    });
}
