//! Slots chosen by the planner: for every shape and size of team, and in the simulator.

use std::path::Path;

use cohaul_core::scenario::document::{Caging, Scenario, Slots};
use cohaul_core::scenario::{Override, Problem, parse};
use cohaul_core::se2::cross;
use cohaul_core::transport::formation::FormationError;
use cohaul_planner::formation::{FormationPlanError, resolve, resolve_with};
use cohaul_sim::episode::{NoRecorder, run};
use rayon::prelude::*;

const SHAPES: [(&str, &str); 7] = [
    ("rectangle", "rectangle: {length: 1.35, width: 0.35}"),
    ("square", "rectangle: {length: 0.8, width: 0.8}"),
    ("triangle", "polygon: {vertices: [[-0.346, -0.6], [0.693, 0], [-0.346, 0.6]]}"),
    ("pentagon", "polygon: {vertices: [[0.5, 0], [0.155, 0.476], [-0.405, 0.294], [-0.405, -0.294], [0.155, -0.476]]}"),
    ("hexagon", "polygon: {vertices: [[-0.52, -0.3], [0, -0.6], [0.52, -0.3], [0.52, 0.3], [0, 0.6], [-0.52, 0.3]]}"),
    ("trapezoid", "polygon: {vertices: [[-0.2, -0.7], [0.25, -0.45], [0.25, 0.45], [-0.2, 0.7]]}"),
    ("plank", "rectangle: {length: 3.0, width: 0.12}"),
];

fn scenario(file: &str, changes: &[&str]) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(file);
    let overrides: Vec<Override> = changes.iter().map(|c| Override::parse(c).unwrap()).collect();
    parse(file, &std::fs::read(path).unwrap(), &overrides).unwrap().resolve(None, &mut || 0.5).unwrap()
}

fn team(shape: &str, robots: usize, more: &[&str]) -> Scenario {
    let shape = format!("loads.0.shape={{{shape}}}");
    let count = format!("teams.0.robots.count={robots}");
    let slots = "teams.0.formation={slots: auto, contact_placement: 0.12}";
    scenario("r2p2/flat.yaml", &[&[&*shape, &*count, slots, "terrain.friction.dynamic=0.1"], more].concat())
}

/// 2 cm between bodies and 12 cm from every corner, or the middle of an edge shorter than 24 cm.
#[test]
fn every_team_that_fits_stands_apart_and_off_the_corners() {
    let cases: Vec<_> = SHAPES.iter().flat_map(|shape| (3..=12).map(move |robots| (shape, robots))).collect();
    let stood: Vec<(&str, usize)> = cases
        .into_par_iter()
        .filter_map(|((name, shape), robots)| match resolve_with(&team(shape, robots, &[])) {
            Ok((resolved, chosen)) => {
                assert!(chosen[0].margin > 0.0, "{name} {robots}");
                let instance = resolved.instance().unwrap();
                let (load, formation) = (instance.load_polygon(0), instance.formation(0));
                let centers: Vec<_> = formation.slots().iter().map(|slot| slot.center(0.105, 0.01)).collect();
                for (i, slot) in formation.slots().iter().enumerate() {
                    let edge = load.edge(slot.edge);
                    let inset = 0.12_f64.min(edge.length() / 2.0) - 1e-9;
                    for corner in [edge.start, edge.end] {
                        assert!((slot.contact - corner).norm() >= inset, "{name} {robots} {slot:?}");
                    }
                    for other in &centers[..i] {
                        assert!((centers[i] - other).norm() >= 0.21 + 0.02 - 1e-9, "{name} {robots}");
                    }
                }
                // robots behind push, and some turn the load either way
                let arms = formation.slots().iter().map(|slot| cross(&slot.contact, &slot.facing));
                let (most, least) = arms.fold((0.0, 0.0), |(a, b), arm| (f64::max(a, arm), f64::min(b, arm)));
                assert!(most > 0.05 && least < -0.05, "{name} {robots}: {most} {least}");
                assert!(formation.slots().iter().any(|slot| slot.facing.x > 0.3), "{name} {robots}");
                assert_eq!(chosen[0].gaps, formation.caging_gaps(load));
                Some((*name, robots))
            }
            Err(FormationPlanError::Room { fit, robots: asked, .. }) => {
                assert!(fit < asked && asked == robots, "{name} {robots}: {fit}");
                None
            }
            Err(FormationPlanError::Powerless { .. }) if robots <= 4 => None,
            Err(error) => panic!("{name} {robots}: {error}"),
        })
        .collect();
    for (name, _) in SHAPES {
        let sizes: Vec<usize> = stood.iter().filter(|(shape, _)| *shape == name).map(|(_, robots)| *robots).collect();
        println!("{name}: {sizes:?}");
        assert!([5, 6, 8].iter().all(|robots| sizes.contains(robots)), "{name}: {sizes:?}");
    }
}

/// The search finds the paper's formation by itself: two on each long side, as far out as allowed, one at each end.
#[test]
fn six_robots_find_the_papers_slots() {
    let resolved = resolve(&scenario("r2p2/flat.yaml", &["teams.0.formation={slots: auto}"])).unwrap();
    let paper = scenario("r2p2/flat.yaml", &[]);
    let centers = |scenario: &Scenario| {
        let instance = scenario.instance().unwrap();
        let mut centers: Vec<_> =
            instance.formation(0).slots().iter().map(|slot| (slot.contact.x, slot.contact.y)).collect();
        centers.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        centers
    };
    for (found, expected) in centers(&resolved).iter().zip(centers(&paper)) {
        assert!((found.0 - expected.0).abs() < 1e-9 && (found.1 - expected.1).abs() < 1e-9, "{found:?} {expected:?}");
    }
    assert_eq!(resolved.teams[0].formation.caging, Some(Caging::Required));
}

#[test]
fn too_many_robots_and_open_cages_are_refused_with_numbers() {
    let crowd = resolve(&team("rectangle: {length: 0.5, width: 0.5}", 12, &[])).unwrap_err();
    assert!(matches!(crowd, FormationPlanError::Room { robots: 12, fit: 8, .. }), "{crowd}");
    assert!(crowd.to_string().contains("12 robots do not fit around the load: there is room for 8"), "{crowd}");
    assert!(crowd.remedy().contains("at most 8 robots"), "{}", crowd.remedy());
    let open = resolve(&team(SHAPES[0].1, 4, &["teams.0.formation.caging=required"])).unwrap_err();
    assert!(matches!(open, FormationPlanError::Caging { robots: 4, .. }), "{open}");
    assert!(open.to_string().contains("no robot stands at edge"), "{open}");
}

#[test]
fn open_slots_are_refused_by_those_who_need_them() {
    let scenario = team(SHAPES[0].1, 6, &[]);
    assert_eq!(scenario.teams[0].formation.slots, Slots::Auto);
    let problem = scenario.instance().unwrap_err();
    assert!(matches!(&problem, Problem::Formation { error: FormationError::Unresolved, .. }), "{problem}");
    // what is resolved stays as it is
    let resolved = resolve(&scenario).unwrap();
    assert_eq!(resolve(&resolved).unwrap(), resolved);
}

#[test]
fn chosen_slots_pass_the_checks_of_ones_own() {
    // a wall half a metre in front of the load leaves no room for a robot there
    let cramped =
        resolve(&team(SHAPES[0].1, 6, &["terrain.walls=[-5, -5, 0.3, 5]", "teams.0.mission={goal: {x: 0, y: 1}}"]));
    let error = cramped.unwrap_err();
    assert!(matches!(error, FormationPlanError::Refused(_)) && error.to_string().contains("overlap"), "{error}");
}

#[test]
fn the_same_scenario_gets_the_same_slots() {
    let choose = || resolve(&team(SHAPES[4].1, 7, &["terrain.slope_deg=3"])).unwrap();
    assert_eq!(choose(), choose());
}

#[test]
fn loads_of_any_shape_reach_their_goals() {
    let runs: Vec<_> = ["triangle", "hexagon", "trapezoid"].iter().flat_map(|n| (1..=5).map(move |s| (n, s))).collect();
    runs.into_par_iter().for_each(|(name, seed)| {
        let scenario = scenario(&format!("formation/{name}.yaml"), &[&format!("seed={seed}")]);
        let outcome = run(&resolve(&scenario).unwrap(), &mut NoRecorder, &mut |_, _| false).unwrap();
        assert!(outcome.success, "{name} {seed}: {outcome:?}");
    });
}

/// A slanted edge holds the load sideways on a slope, although its robot gives way ahead: such teams once counted as powerless.
#[test]
fn loads_of_any_shape_reach_their_goals_on_slopes() {
    let shapes = ["triangle", "hexagon", "trapezoid"];
    let runs: Vec<_> = shapes.iter().flat_map(|name| [-5, 5].map(|slope| (name, slope))).collect();
    runs.into_par_iter().for_each(|(name, slope)| {
        let changes = [format!("terrain.slope_deg={slope}"), "teams.0.mission.time_limit=600".to_owned()];
        let scenario = scenario(&format!("formation/{name}.yaml"), &changes.each_ref().map(String::as_str));
        let resolved = resolve(&scenario).unwrap();
        for seed in 1..=2 {
            let outcome = run(&Scenario { seed, ..resolved.clone() }, &mut NoRecorder, &mut |_, _| false).unwrap();
            assert!(outcome.success, "{name} {slope} {seed}: {outcome:?}");
        }
    });
}
