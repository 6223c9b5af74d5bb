//! throw-away
#![allow(clippy::disallowed_methods, clippy::allow_attributes, clippy::disallowed_types, missing_docs)]
use cohaul_core::se2::Pose2;
use cohaul_planner::car;
use cohaul_planner::instance::*;
use cohaul_planner::outcome::Outcome;
use cohaul_planner::search::Budget;
use nalgebra::{Point2, Vector2};
use std::collections::BTreeMap;

fn nums(s: &str) -> Vec<f64> {
    let mut out = vec![];
    let mut cur = String::new();
    for c in s.chars() {
        if c.is_ascii_digit() || c == '-' || c == '.' || c == 'e' {
            cur.push(c)
        } else {
            if let Ok(v) = cur.parse() {
                out.push(v)
            }
            cur.clear();
        }
    }
    if let Ok(v) = cur.parse() {
        out.push(v)
    }
    out
}
fn read(path: &str) -> CarInstance {
    let text = std::fs::read_to_string(path).unwrap();
    let (mut starts, mut goals, mut obs, mut dims) = (vec![], vec![], vec![], vec![]);
    let mut in_obs = false;
    for line in text.lines() {
        if let Some(i) = line.find("start:") {
            starts.push(nums(&line[i + 6..]))
        } else if let Some(i) = line.find("goal:") {
            goals.push(nums(&line[i + 5..]))
        } else if let Some(i) = line.find("dimensions:") {
            dims = nums(&line[i + 11..]);
            in_obs = false
        } else if line.contains("obstacles:") {
            in_obs = true;
            let n = nums(&line[line.find("obstacles:").unwrap() + 10..]);
            if n.len() == 2 {
                obs.push(n)
            }
        } else if line.contains("name:") {
        } else if in_obs {
            let n = nums(line);
            if n.len() == 2 {
                obs.push(n)
            }
        }
    }
    let pose = |v: &Vec<f64>| Pose2::new(Vector2::new(v[0], v[1]), -v[2]);
    CarInstance {
        width: dims[0],
        height: dims[1],
        obstacles: obs.iter().map(|o| Obstacle::Point { at: Point2::new(o[0], o[1]), radius: 0.8 }).collect(),
        vehicle: Vehicle::default(),
        agents: starts
            .iter()
            .zip(&goals)
            .enumerate()
            .map(|(i, (s, g))| CarAgent { name: format!("agent{i}"), start: pose(s), goals: vec![pose(g)] })
            .collect(),
        assignment: false,
    }
}
fn generate(n: usize, size: i32, obst: usize, seed: u64) -> CarInstance {
    let mut st = seed.wrapping_mul(0x9E3779B97F4A7C15) ^ 0x1234567;
    let mut next = move || {
        st = st.wrapping_add(0x9E3779B97F4A7C15);
        let mut z = st;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let dmin = match size {
        50 => 5.65,
        100 => 7.8,
        _ => 10.0,
    };
    let yaws = [0.0, 1.57, -1.57, 3.14];
    let obstacles: Vec<(f64, f64)> = (0..obst).map(|_| (next() * size as f64, next() * size as f64)).collect();
    let clear = |x: f64, y: f64, yaw: f64| {
        obstacles.iter().all(|o| {
            let (dx, dy) = (o.0 - x, o.1 - y);
            let (c, s) = (yaw.cos(), yaw.sin());
            let (a, b) = (c * dx + s * dy, c * dy - s * dx);
            !(a > -1.8 && a < 2.8 && b.abs() < 1.8)
        })
    };
    let mut draw = |taken: &Vec<(f64, f64, f64)>| loop {
        let m = 2;
        let x = (m + (next() * (size - 2 * m + 1) as f64) as i32) as f64;
        let y = (m + (next() * (size - 2 * m + 1) as f64) as i32) as f64;
        let yaw = yaws[(next() * 4.0) as usize];
        if clear(x, y, yaw) && taken.iter().all(|t| (t.0 - x).hypot(t.1 - y) >= dmin) {
            return (x, y, yaw);
        }
    };
    let (mut starts, mut goals) = (vec![], vec![]);
    if std::env::var("HARD").is_ok() {
        for _ in 0..n {
            let p = draw(&starts);
            starts.push(p);
        }
    }
    let easy = std::env::var("HARD").is_err();
    if easy {
        'all: loop {
            starts.clear();
            goals.clear();
            for _ in 0..n {
                let both: Vec<_> = starts.iter().chain(&goals).copied().collect();
                let s = draw(&both);
                let mut both2 = both.clone();
                both2.push(s);
                let mut tries = 0;
                let g = loop {
                    tries += 1;
                    if tries > 2000 {
                        continue 'all;
                    }
                    let g = draw(&both2);
                    let d = (g.0 - s.0).hypot(g.1 - s.1);
                    if d >= size as f64 / 4.0 && d <= size as f64 / 2.0 {
                        break g;
                    }
                };
                starts.push(s);
                goals.push(g);
            }
            break;
        }
    } else {
        for _ in 0..n {
            let p = draw(&goals);
            goals.push(p);
        }
    }
    let pose = |v: &(f64, f64, f64)| Pose2::new(Vector2::new(v.0, v.1), v.2);
    CarInstance {
        width: size as f64,
        height: size as f64,
        obstacles: obstacles.iter().map(|o| Obstacle::Point { at: Point2::new(o.0, o.1), radius: 0.8 }).collect(),
        vehicle: Vehicle::default(),
        agents: starts
            .iter()
            .zip(&goals)
            .enumerate()
            .map(|(i, (s, g))| CarAgent { name: format!("agent{i}"), start: pose(s), goals: vec![pose(g)] })
            .collect(),
        assignment: false,
    }
}
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    s.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let pattern = args.get(1).cloned().unwrap_or_default();
    let improvements: usize = args.get(2).map_or(3, |s| s.parse().unwrap());
    let exact = args.get(3).map_or(false, |s| s == "exact");
    if let Some(spec) = pattern.strip_prefix("gen:") {
        let f: Vec<usize> = spec.split(':').map(|v| v.parse().unwrap()).collect();
        let (mut times, mut bad) = (vec![], 0);
        for k in 0..f[3] {
            let inst = generate(f[0], f[1] as i32, f[2], 1000 * f.get(4).copied().unwrap_or(1) as u64 + k as u64);
            let t = std::time::Instant::now();
            let c0 = cpu();
            let dl = || t.elapsed().as_secs_f64() > 10.0;
            let e = car::solve(
                &inst,
                &car::Options {
                    model: if exact { car::Model::Exact } else { car::Model::Clcbs },
                    improvements,
                    ..Default::default()
                },
                &Budget::new(u64::MAX, &dl),
            );
            let dt = cpu() - c0;
            if !matches!(e.outcome, Outcome::Solved(_)) {
                bad += 1;
                println!("{k} BAD {dt:.2}");
            } else {
                times.push(dt);
                if dt > 0.5 {
                    println!("{k} slow {dt:.3} {:?}", e.effort);
                }
            }
        }
        times.sort_by(f64::total_cmp);
        println!(
            "bad {bad} median {:.1} p95 {:.1} max {:.1} ms",
            times[times.len() / 2] * 1e3,
            times[times.len() * 95 / 100] * 1e3,
            times.last().unwrap() * 1e3
        );
        return;
    }
    let dir = "/work/shared/bench/cl_cbs";
    let csv = std::fs::read_to_string("/work/shared/bench/peers_results.csv").unwrap();
    let mut peers = BTreeMap::new();
    for l in csv.lines() {
        let f: Vec<&str> = l.split(',').collect();
        if f[0].starts_with("clcbs/") && f[4] == "b10" && f[5] == "1" {
            peers.insert(
                f[2].to_string(),
                (
                    f[7].parse::<f64>().unwrap(),
                    f[8].parse::<f64>().unwrap(),
                    f[11].parse::<f64>().unwrap(),
                    f[12].parse::<f64>().unwrap(),
                ),
            );
        }
    }
    let mut files: Vec<_> = std::fs::read_dir(dir)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .filter(|n| n.starts_with("map_") && n.contains(&pattern))
        .collect();
    files.sort();
    let (mut logs, mut flow, mut make, mut n) = (0.0, 0.0, 0.0, 0);
    let mut times = vec![];
    for f in files {
        let inst = read(&format!("{dir}/{f}"));
        let t = cpu();
        let ended = car::solve(
            &inst,
            &car::Options {
                model: if exact { car::Model::Exact } else { car::Model::Clcbs },
                improvements,
                ..Default::default()
            },
            &Budget::new(50_000_000, &|| false),
        );
        let dt = cpu() - t;
        match ended.outcome {
            Outcome::Solved(plan) => {
                let c = plan.claims;
                times.push(dt);
                print!(
                    "{f} {:.1} ms flow {:.1} make {:.1} lb {:.1} exp {} hl {} us/exp {:.1}",
                    dt * 1e3,
                    c.flowtime.unwrap(),
                    c.makespan.unwrap(),
                    c.lower_bound.unwrap(),
                    ended.effort.low_level_expanded,
                    ended.effort.high_level_expanded,
                    dt * 1e6 / ended.effort.low_level_expanded as f64
                );
                if let Some(p) = peers.get(&f) {
                    print!(
                        "  peer {:.3} s flow {:.1} make {:.1} | x{:.0} flow {:.4} make {:.4}",
                        p.1,
                        p.2 * 0.0 + p.3,
                        p.2,
                        p.1 / (dt + 0.0015),
                        c.flowtime.unwrap() / p.3,
                        c.makespan.unwrap() / p.2
                    );
                    flow += (c.flowtime.unwrap() / p.3).ln();
                    make += (c.makespan.unwrap() / p.2).ln();
                    n += 1;
                    if p.0 >= 0.02 {
                        logs += (p.1 / (dt + 0.0015)).ln();
                    }
                }
                println!();
            }
            Outcome::Infeasible(r) => println!("{f} infeasible {:?}", r),
            Outcome::BudgetSpent { .. } => {
                println!("{f} SPENT {:.1} ms exp {}", dt * 1e3, ended.effort.low_level_expanded)
            }
        }
    }
    times.sort_by(f64::total_cmp);
    println!(
        "n {n} speed x{:.1} flow {:.4} make {:.4} median {:.1} ms max {:.1}",
        (logs / n as f64).exp(),
        (flow / n as f64).exp(),
        (make / n as f64).exp(),
        times[times.len() / 2] * 1e3,
        times.last().unwrap() * 1e3
    );
}
