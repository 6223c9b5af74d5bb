//! What the paper lacks: any bearing, any slope, oriented goals, driving either way round, poses with noise, teleports, the
//! baseline and its omnidirectional robots.

use std::path::Path;

use cohaul_core::control::Phase;
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::scenario::document::Scenario;
use cohaul_core::scenario::{Override, parse};
use cohaul_core::se2::{wrap_angle, yaw};
use cohaul_sim::episode::{Episode, NoRecorder, run};
use cohaul_sim::mission::Mission;
use cohaul_sim::outcome::{End, Outcome};
use rayon::prelude::*;

fn scenario(name: &str, changes: &[String]) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    let overrides: Vec<Override> = changes.iter().map(|c| Override::parse(c).unwrap()).collect();
    parse(name, &std::fs::read(path).unwrap(), &overrides).unwrap().resolve(None, &mut || 0.5).unwrap()
}

fn outcome(name: &str, changes: &[String]) -> Outcome {
    run(&scenario(name, changes), &mut NoRecorder, &mut |_, _| false).unwrap()
}

fn goal(bearing_deg: f64) -> String {
    let (sin, cos) = bearing_deg.to_radians().sin_cos();
    format!("teams.0.mission.goal={{x: {cos}, y: {sin}}}")
}

/// Runs every case for seeds 1 to 3 and asserts that all of them arrive.
fn all_arrive(name: &str, cases: Vec<Vec<String>>) {
    let failed: Vec<String> = cases
        .into_par_iter()
        .flat_map_iter(|case| {
            (1..=3).filter_map(move |seed| {
                let changes = [case.clone(), vec![format!("seed={seed}")]].concat();
                let outcome = outcome(name, &changes);
                (!outcome.success).then(|| format!("{changes:?}: {:?} after {} s", outcome.outcome, outcome.time_s))
            })
        })
        .collect();
    assert!(failed.is_empty(), "{name}: {failed:#?}");
}

#[test]
fn scenarios_beyond_the_paper_arrive_in_both_worlds() {
    for name in ["about_face", "either_way", "oriented", "cross_slope"] {
        let worlds = ["planar", "spatial"].map(|world| vec![format!("world={world}")]);
        all_arrive(&format!("beyond/{name}.yaml"), worlds.to_vec());
    }
}

#[test]
fn every_bearing_is_reached() {
    let bearings = (-11..=12).map(|k| 15.0 * f64::from(k));
    let cases = bearings.flat_map(|bearing| {
        ["forward", "nearest"].map(|drive| vec![goal(bearing), format!("teams.0.controller.r2p2.drive={drive}")])
    });
    all_arrive("r2p2/single.yaml", cases.collect());
}

/// Going back needs no turn: the load ends with the heading that it started with.
#[test]
fn driving_either_way_saves_the_turn() {
    let straight_back = |drive: &str| {
        let scenario = scenario("r2p2/single.yaml", &[goal(180.0), format!("teams.0.controller.r2p2.drive={drive}")]);
        let mut episode = Episode::new(&scenario).unwrap();
        let end = loop {
            if let Some(end) = episode.advance(&mut NoRecorder).unwrap() {
                break end;
            }
        };
        assert_eq!(end, End::Reached);
        (episode.outcome(end).time_s, yaw(&episode.world().load_pose(LoadId(0))).abs())
    };
    let (forward_time, forward_yaw) = straight_back("forward");
    let (nearest_time, nearest_yaw) = straight_back("nearest");
    assert!(forward_yaw > 2.9 && nearest_yaw < 0.2, "{forward_yaw} {nearest_yaw}");
    assert!(nearest_time < 0.7 * forward_time, "{nearest_time} {forward_time}");
}

#[test]
fn slopes_up_to_ten_degrees_are_crossed_in_any_direction() {
    let cases = [-10.0, -5.0, 5.0, 10.0].into_iter().flat_map(|slope| {
        (0..8).map(move |k| vec![format!("terrain.slope_deg={slope}"), format!("terrain.uphill_deg={}", 45 * k)])
    });
    all_arrive("r2p2/single.yaml", cases.collect());
}

#[test]
fn an_oriented_goal_ends_with_its_heading() {
    for (wanted, slope) in [(90.0, 0.0), (-45.0, 5.0), (180.0, -5.0), (0.0, 10.0)] {
        let changes = [
            format!("teams.0.mission.goal_yaw_deg={wanted}"),
            format!("terrain.slope_deg={slope}"),
            "seed=2".to_owned(),
        ];
        let mission = Mission::run(scenario("beyond/oriented.yaml", &changes), None, &mut |_, _| false).unwrap();
        assert!(mission.outcome.success, "{changes:?} {:?}", mission.outcome);
        let [_, _, heading] = mission.frames.last().unwrap().loads[0];
        let error = wrap_angle(heading - f64::to_radians(wanted)).abs();
        assert!(error < 5.0_f64.to_radians(), "{changes:?} {error}");
        assert!((error - mission.outcome.final_yaw_error_rad).abs() < 1e-9);
    }
}

/// Noise of 2 cm and 4° in every pose once stopped most missions: robots that believed to have arrived stayed so, and
/// velocities were differentiated noise.
#[test]
fn noisy_poses_do_not_stop_a_mission() {
    let cases = [-5.0, 0.0, 5.0].map(|slope| {
        let mut case: Vec<String> =
            ["sensors.position_sd=0.02", "sensors.yaw_sd_deg=4", "terrain.friction.dynamic=0.01"]
                .map(String::from)
                .to_vec();
        case.push(format!("terrain.slope_deg={slope}"));
        case
    });
    all_arrive("r2p2/single.yaml", cases.to_vec());
}

/// With 1 cm of noise robots once passed a waypoint that the load had missed by a few millimetres, and went on to rest at the
/// goal of a mission that could not end (seed 5022).
#[test]
fn noise_passes_no_waypoint_for_a_load_that_missed_it() {
    let failed: Vec<u64> = (5010..5030)
        .into_par_iter()
        .filter(|seed| {
            let noise = ["sensors.position_sd=0.01", "sensors.yaw_sd_deg=2", "teams.0.mission.time_limit=400"];
            let changes = [&noise.map(String::from)[..], &[format!("seed={seed}")]].concat();
            !outcome("beyond/either_way.yaml", &changes).success
        })
        .collect();
    assert!(failed.is_empty(), "{failed:?}");
}

/// Robots knocked out of their slots are put back at once, and pay for it outside the mission's time.
#[test]
fn teleports_cost_their_penalty_and_nothing_else() {
    let changes: Vec<String> = [
        "teams.0.controller.r2p2={stance: square, reposition: teleport, reposition_tangential: 0.02}",
        "physics.teleport_penalty=7",
        "terrain.friction.dynamic=0.01",
    ]
    .map(String::from)
    .to_vec();
    let mission = Mission::run(scenario("r2p2/flat.yaml", &changes), None, &mut |_, _| false).unwrap();
    let outcome = &mission.outcome;
    assert!(outcome.success, "{outcome:?}");
    assert!(outcome.penalty_s > 0.0 && (outcome.penalty_s / 7.0).fract() == 0.0, "{outcome:?}");
    assert!((mission.frames.last().unwrap().time - outcome.time_s).abs() < 1e-9);
    assert!(mission.frames.iter().any(|f| f.robots.iter().any(|r| r.phase == Phase::Teleport)));
    assert!(!mission.frames.iter().any(|f| f.robots.iter().any(|r| r.phase == Phase::Slide)));
}

#[test]
fn followers_of_a_virtual_leader_arrive_with_either_base() {
    let cases = ["turtlebot3_burger", "omnidirectional"].iter().flat_map(|model| {
        [-5.0, 0.0, 5.0].map(|slope| {
            vec![
                "teams.0.controller={vlf: {}}".to_owned(),
                format!("teams.0.robots.model={model}"),
                format!("terrain.slope_deg={slope}"),
                "loads.0.mass=0.05".to_owned(),
                "teams.0.mission.tolerance=0.2".to_owned(),
                "teams.0.mission.time_limit=400".to_owned(),
            ]
        })
    });
    all_arrive("r2p2/single.yaml", cases.collect());
}

/// Facing the load's end, the robot follows its turn sideways: about 0.46 m for 45° at a lever of 0.79 m, less what the turn
/// is ended early.
#[test]
fn an_omnidirectional_base_moves_sideways() {
    let changes = ["teams.0.controller={vlf: {}}", "teams.0.robots.model=omnidirectional"].map(String::from);
    let scenario = scenario("r2p2/single.yaml", &changes);
    let mut episode = Episode::new(&scenario).unwrap();
    let mut moved = 0.0;
    while episode.time().seconds() < 5.0 {
        episode.advance(&mut NoRecorder).unwrap();
        moved += episode.world().robot_speeds(RobotId(2)).lateral.abs() * scenario.physics.step;
    }
    assert!((0.3..0.7).contains(&moved), "{moved} m");
}

#[test]
fn teams_of_the_papers_missions_arrive_in_both_worlds() {
    for name in ["hardware", "ten", "two_teams"] {
        let worlds = ["planar", "spatial"].map(|world| vec![format!("world={world}")]);
        all_arrive(&format!("r2p2/{name}.yaml"), worlds.to_vec());
    }
}
