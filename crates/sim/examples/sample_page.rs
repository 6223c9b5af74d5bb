//! Writes the page and the picture of a made-up mission: six robots move a load of 1.35 m by 0.35 m for 200 s.
//!
//! ```text
//! cargo run --release -p cohaul-sim --example sample_page -- out/sample
//! ```
//!
//! writes `out/sample.html` and `out/sample.svg` and prints the final pose of the load. A second argument is the
//! duration in seconds.

use cohaul_core::control::Phase;
use cohaul_core::transport::primitive::{Primitive, Turn};
use cohaul_core::transport::role::Role;
use cohaul_sim::page::{
    Frame, Replay, ReplayEvent, ReplayLoad, ReplayRobot, ReplayTeam, RobotFrame, TeamFrame, picture, render,
};

/// Six slots in the load's frame, clockwise from front left: x, y, yaw.
const SLOTS: [[f64; 3]; 6] = [
    [0.29, 0.5, std::f64::consts::PI],
    [0.29, -0.5, std::f64::consts::PI],
    [0.0, -0.79, std::f64::consts::FRAC_PI_2],
    [-0.29, -0.5, 0.0],
    [-0.29, 0.5, 0.0],
    [0.0, 0.79, -std::f64::consts::FRAC_PI_2],
];
const WAYPOINTS: [[f64; 2]; 3] = [[2.0, 0.5], [3.6, 2.2], [5.6, 2.6]];
const RATE: f64 = 40.0;
/// Share of the time in which the load turns towards the next waypoint, of each leg.
const TURNING: f64 = 0.35;

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let stem = arguments.next().unwrap_or_else(|| "sample".into());
    let duration = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(200.0);
    let replay = sample(duration);
    #[expect(clippy::disallowed_methods, reason = "an example writes its files itself")]
    {
        std::fs::write(format!("{stem}.html"), render(&replay))?;
        std::fs::write(format!("{stem}.svg"), picture(&replay))?;
    }
    if let Some(pose) = replay.frames.last().and_then(|frame| frame.loads.first()) {
        println!("{} {} {}", pose[0], pose[1], pose[2]);
    }
    Ok(())
}

/// A mission with all that the page can show.
fn sample(duration: f64) -> Replay {
    let frames = (0..=(duration * RATE) as u32).map(|i| frame(f64::from(i) / RATE, duration)).collect();
    let event = |share: f64, text: &str| ReplayEvent { time: share * duration, text: text.into() };
    Replay {
        title: "Six robots around a corner".into(),
        description: "A made-up mission that shows everything the page can draw; nothing in it was simulated.".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: 1,
        world: "planar".into(),
        slope_deg: 6.0,
        uphill_deg: 40.0,
        obstacles: vec![
            vec![[0.9, 1.75], [1.9, 2.05], [1.8, 2.95], [0.7, 2.75]],
            vec![[3.9, 0.0], [4.7, -0.2], [5.0, 0.8], [4.2, 1.0]],
        ],
        walls: Some([-1.2, -1.2, 6.8, 4.0]),
        workspace: None,
        loads: vec![ReplayLoad {
            id: "crate".into(),
            polygon: vec![[-0.175, -0.675], [0.175, -0.675], [0.175, 0.675], [-0.175, 0.675]],
        }],
        robots: (0..6)
            .map(|i| ReplayRobot { name: format!("robot_{}", i + 1), team: 0, radius: 0.105, slot: Some(SLOTS[i]) })
            .collect(),
        teams: vec![ReplayTeam {
            id: "team".into(),
            load: 0,
            robots: (0..6).collect(),
            waypoints: WAYPOINTS.to_vec(),
            tolerance: 0.1,
            path: Vec::new(),
        }],
        frames,
        events: vec![
            event(0.17, "robot_3 repositions itself"),
            event(1.0 / 3.0, "waypoint 1 reached"),
            event(0.55, "robot_5 repositions itself"),
            event(2.0 / 3.0, "waypoint 2 reached"),
            event(1.0, "goal reached"),
        ],
        outcome: [
            ("Outcome", "reached"),
            ("Time", "200.0 s"),
            ("Final error", "0.041 m"),
            ("Waypoints reached", "3 of 3"),
            ("Repositionings", "2 (13.6 s)"),
            ("Path length of the load", "6.52 m"),
            ("Deviation from the path", "0.021 m rms, 0.064 m max"),
            ("Smallest distance of robots", "0.402 m"),
            ("Control effort", "38.4"),
            ("Traction work", "61.7 J"),
        ]
        .map(|(label, value)| (label.to_owned(), value.to_owned()))
        .to_vec(),
        success: true,
    }
}

fn frame(time: f64, duration: f64) -> Frame {
    let share = (time / duration).min(1.0);
    let now = load_pose(share);
    let next = load_pose((share + 0.5 / duration).min(1.0));
    let before = load_pose((share - 0.5 / duration).max(0.0));
    let turn_rate = next[2] - before[2];
    let speed = (next[0] - before[0]).hypot(next[1] - before[1]);
    let leg = leg(share);
    let target = WAYPOINTS[leg];
    let bearing = (target[1] - now[1]).atan2(target[0] - now[0]);
    let heading_error =
        (bearing - now[2] + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    let turning = (share * 3.0).fract() < TURNING && share < 1.0;
    let primitive = if turning {
        Primitive::Rotate(if turn_rate >= 0.0 { Turn::Counterclockwise } else { Turn::Clockwise })
    } else {
        Primitive::Translate
    };
    let busy = [(2, 0.17), (4, 0.55)].into_iter().find(|(_, start)| (*start..start + 0.034).contains(&share));
    let robots = (0..6).map(|i| robot(i, time, share, now, primitive, [speed, turn_rate], busy)).collect();
    Frame {
        time,
        loads: vec![now],
        robots,
        teams: vec![TeamFrame {
            primitive: Some(primitive),
            heading_error,
            distance: (target[0] - now[0]).hypot(target[1] - now[1]),
            waypoint: leg,
        }],
    }
}

fn robot(
    index: usize,
    time: f64,
    share: f64,
    load: [f64; 3],
    primitive: Primitive,
    [load_speed, turn_rate]: [f64; 2],
    busy: Option<(usize, f64)>,
) -> RobotFrame {
    let slot = SLOTS[index];
    let wobble = 0.008 * (0.9 * time + 2.0 * index as f64).sin();
    let mut along = 0.012 * (0.21 * time + index as f64).sin();
    let mut away = 0.004 + wobble.abs();
    let mut yaw = slot[2] + 0.05 * (0.33 * time + 1.7 * index as f64).sin();
    let mut phase = Phase::Work;
    let mut speed = 0.0;
    match busy {
        Some((robot, start)) if robot == index => {
            let progress = (share - start) / 0.034;
            phase = match progress {
                p if p < 0.2 => Phase::Retreat,
                p if p < 0.35 => Phase::TurnParallel,
                p if p < 0.65 => Phase::Slide,
                p if p < 0.8 => Phase::TurnFacing,
                _ => Phase::Approach,
            };
            away += 0.12 * (progress * std::f64::consts::PI).sin();
            along += 0.05 * (1.0 - progress);
            yaw += 1.5 * ((progress - 0.2) / 0.15).clamp(0.0, 1.0) * ((0.8 - progress) / 0.15).clamp(0.0, 1.0);
            speed = if progress < 0.2 { -0.08 } else { 0.06 };
        }
        Some(_) => phase = Phase::Hold,
        None => {
            let arm = (slot[0].hypot(slot[1])) * turn_rate.abs() + load_speed;
            speed = if (1..=2).contains(&(index % 3)) { arm } else { 0.9 * arm } * (1.0 + 8.0 * wobble);
        }
    }
    let role = match (primitive, index) {
        (_, 2 | 5) => Role::Support,
        (Primitive::Rotate(Turn::Counterclockwise), 0 | 3) => Role::Push,
        (Primitive::Rotate(Turn::Clockwise), 1 | 4) => Role::Push,
        (Primitive::Translate, 3 | 4) => Role::Push,
        _ => Role::Prevent,
    };
    if phase == Phase::Work && role == Role::Prevent {
        speed *= -0.8;
    }
    // out of the slot: away from the edge, and along it
    let (sine, cosine) = slot[2].sin_cos();
    let in_load = [slot[0] - away * cosine + along * sine, slot[1] - away * sine - along * cosine];
    let (sine, cosine) = load[2].sin_cos();
    let done = share >= 1.0;
    RobotFrame {
        pose: [
            load[0] + cosine * in_load[0] - sine * in_load[1],
            load[1] + sine * in_load[0] + cosine * in_load[1],
            load[2] + yaw,
        ],
        command: if done { [0.0; 2] } else { [speed, turn_rate] },
        speed: if done { 0.0 } else { speed },
        role: Some(role),
        phase: if done { Phase::Done } else { phase },
        stop: phase.is_repositioning(),
    }
}

/// Leg of the way, 0 to 2.
fn leg(share: f64) -> usize {
    ((share * 3.0) as usize).min(2)
}

/// The load turns towards the next waypoint, then drives there with a little drift.
fn load_pose(share: f64) -> [f64; 3] {
    let leg = leg(share);
    let progress = if share >= 1.0 { 1.0 } else { (share * 3.0).fract() };
    let from = if leg == 0 { [0.0, 0.0] } else { WAYPOINTS[leg - 1] };
    let to = WAYPOINTS[leg];
    let heading = |leg: usize| {
        let from = if leg == 0 { [0.0, 0.0] } else { WAYPOINTS[leg - 1] };
        (WAYPOINTS[leg][1] - from[1]).atan2(WAYPOINTS[leg][0] - from[0])
    };
    let before = if leg == 0 { -0.7 } else { heading(leg - 1) };
    let turned = ease((progress / TURNING).min(1.0));
    let moved = ease(((progress - TURNING) / (1.0 - TURNING)).max(0.0));
    let swing = (moved * std::f64::consts::TAU).sin();
    let drift = 0.05 * (moved * std::f64::consts::PI).sin() * if leg == 1 { -1.0 } else { 1.0 };
    let yaw = before + turned * (heading(leg) - before) + 0.06 * swing;
    let (sine, cosine) = heading(leg).sin_cos();
    [
        from[0] + moved * (to[0] - from[0]) - drift * sine + 0.03 * swing * cosine,
        from[1] + moved * (to[1] - from[1]) + drift * cosine + 0.03 * swing * sine,
        yaw,
    ]
}

/// From 0 to 1 with speed 0 at both ends.
fn ease(x: f64) -> f64 {
    x * x * (3.0 - 2.0 * x)
}
