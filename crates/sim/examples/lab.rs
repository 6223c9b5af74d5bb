use cohaul_core::scenario::document::*;
use cohaul_sim::episode::{NoRecorder, run};
use rayon::prelude::*;

fn scenario(
    terrain: &str,
    world: WorldKind,
    mass: f64,
    mu: f64,
    seed: u64,
    long: bool,
    keys: R2p2,
    half: bool,
) -> Scenario {
    let slope = match terrain {
        "flat" => 0.0,
        "down" => -5.0,
        _ => 5.0,
    };
    let p = |x, y| Point { x, y };
    let (waypoints, goal) =
        if long { (vec![p(1.0, 0.4), p(2.0, 0.0)], p(3.0, 0.5)) } else { (vec![], p(0.5f64.sqrt(), 0.5f64.sqrt())) };
    Scenario {
        format: Format::V1,
        name: "x".into(),
        description: String::new(),
        world,
        terrain: Terrain {
            slope_deg: slope,
            friction: Friction { dynamic: mu, breakaway: None, wheel: 0.9 },
            ..Terrain::default()
        },
        loads: vec![Load {
            id: "load".into(),
            shape: Shape::Rectangle { length: 1.35, width: 0.35 },
            height: 0.1,
            mass,
            contact_friction: 0.3,
            pose: Pose::default(),
        }],
        teams: vec![Team {
            id: "team".into(),
            load: "load".into(),
            robots: Robots {
                model: RobotKind::Turtlebot3Burger,
                count: 6,
                ballast: None,
                rates_hz: half.then(|| vec![20.0, 20.0, 10.0, 20.0, 20.0, 20.0]),
                acceleration: 1.0,
                angular_acceleration: 6.0,
                command_step: 0.01,
            },
            formation: Formation { slots: Slots::Six, contact_placement: 0.175, gap: 0.01, caging: None },
            mission: Mission { waypoints, goal, tolerance: 0.1, time_limit: 300.0 },
            controller: Controller::R2p2(keys),
        }],
        sensors: Sensors::default(),
        physics: Physics::default(),
        start: Start { position_jitter: 0.002, yaw_jitter_deg: 0.5 },
        randomize: Default::default(),
        seed,
    }
}

fn main() {
    main2();
}
fn main2() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let get = |k: &str| args.iter().find_map(|a| a.strip_prefix(&format!("{k}=")).map(String::from));
    let n: u64 = get("n").map_or(20, |v| v.parse().unwrap());
    let from: u64 = get("from").map_or(1, |v| v.parse().unwrap());
    let keys: R2p2 = get("keys").map_or(R2p2::default(), |v| serde_json::from_str(&v).unwrap());
    let table = get("table").is_some();
    let half = get("half").is_some();
    let verbose = get("v").is_some();
    let worlds = match get("world").as_deref() {
        Some("planar") => vec![WorldKind::Planar],
        Some("spatial") => vec![WorldKind::Spatial],
        _ => vec![WorldKind::Planar, WorldKind::Spatial],
    };
    for world in worlds {
        for terrain in ["flat", "down", "up"] {
            if get("terrain").is_some_and(|t| t != terrain) {
                continue;
            }
            let cells: Vec<(f64, f64)> = if table {
                [0.5, 2.0, 6.0].iter().flat_map(|m| [0.001, 0.01, 0.1].map(|u| (*m, u))).collect()
            } else {
                vec![(2.0, 0.01)]
            };
            let jobs: Vec<(f64, f64, u64)> =
                cells.iter().flat_map(|(m, u)| (from..from + n).map(|s| (*m, *u, s))).collect();
            let mut out: Vec<_> = jobs
                .par_iter()
                .map(|(m, u, s)| {
                    let o =
                        run(&scenario(terrain, world, *m, *u, *s, !table, keys, half), &mut NoRecorder, &mut |_, _| {
                            false
                        })
                        .unwrap();
                    (*m, *u, *s, o)
                })
                .collect();
            if verbose {
                for (m, u, s, o) in &out {
                    if !o.success {
                        println!(
                            "   {m} {u} seed {s}: {:?} t {:.1} err {:.2} wp {} rep {} {:.1}",
                            o.outcome,
                            o.time_s,
                            o.final_error_m,
                            o.waypoints_reached,
                            o.repositions,
                            o.reposition_time_s
                        );
                    }
                }
            }
            let ok = out.iter().filter(|o| o.3.success).count();
            let total = out.len();
            out.retain(|o| o.3.success);
            let mut t: Vec<f64> = out.iter().map(|o| o.3.time_s).collect();
            t.sort_by(f64::total_cmp);
            let q = |p: f64| if t.is_empty() { 0.0 } else { t[((t.len() - 1) as f64 * p) as usize] };
            let share = out.iter().map(|o| o.3.reposition_time_s / o.3.time_s).sum::<f64>() / t.len().max(1) as f64;
            let dev = out.iter().map(|o| o.3.path_deviation_max_m).sum::<f64>() / t.len().max(1) as f64;
            println!(
                "{world:?} {terrain}: {ok}/{total} median {:.0} [{:.0}, {:.0}] rep share {share:.2} dev {dev:.2}",
                q(0.5),
                q(0.1),
                q(0.9)
            );
        }
    }
}
