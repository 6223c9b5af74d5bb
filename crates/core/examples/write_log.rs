//! Writes a log of invented motion: `write_log FILE [TICKS] [--progress]`.
//!
//! With `--progress` it prints the number of messages written so far, once per tick, so that a test can kill it and
//! count what survived.

use std::f64::consts::TAU;
use std::io::Write as _;

use cohaul_core::control::{Command, Decision, Observation, Phase, StopFlags};
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::record::marker::Marker;
use cohaul_core::record::{Header, LogWriter, RecordError};
use cohaul_core::se2::{Twist2, pose, unit};
use cohaul_core::time::Time;
use cohaul_core::transport::primitive::Primitive;
use cohaul_core::transport::role::Role;
use nalgebra::Vector2;

/// Robots around the load.
const ROBOTS: u16 = 6;
/// Time between ticks, ns.
const TICK: i64 = 50_000_000;
const SCENARIO: &str = "schema: cohaul/1\nname: example # größer\n";

#[expect(clippy::disallowed_methods, reason = "an example opens its files itself")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: write_log FILE [TICKS] [--progress]")?;
    let ticks = arguments.next().map_or(Ok(100), |ticks| ticks.parse())?;
    let progress = arguments.next().is_some();
    let header = Header {
        scenario_name: "example".into(),
        scenario_text: SCENARIO.into(),
        seed: 7,
        world: "planar".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        revision: "unknown".into(),
        robots: (0..ROBOTS).map(|i| format!("r{i}")).collect(),
        loads: vec!["crate".into()],
    };
    let mut writer = LogWriter::new(std::fs::File::create(path)?, &header)?;
    let mut stdout = std::io::stdout().lock();
    for robot in 0..ROBOTS {
        writer.memory(Time::ZERO, RobotId(robot), r#"{"previous":null}"#)?;
    }
    for tick in 0..ticks {
        write_tick(&mut writer, tick)?;
        if progress {
            writeln!(stdout, "{}", writer.messages())?;
        }
    }
    writer.outcome(Time::from_nanos(ticks * TICK), r#"{"outcome":"reached","success":true}"#)?;
    let messages = writer.messages();
    writer.finish()?;
    writeln!(stdout, "{messages}")?;
    Ok(())
}

/// One tick: a load that circles, pushed by robots around it.
fn write_tick<W: std::io::Write>(writer: &mut LogWriter<W>, tick: i64) -> Result<(), RecordError> {
    let time = Time::from_nanos(tick * TICK);
    let seconds = time.seconds();
    let angle = 0.05 * seconds;
    let world_from_load = pose(2.0 * angle.cos(), 2.0 * angle.sin(), angle + 0.25 * TAU);
    let load_twist = Twist2::new(-0.1 * angle.sin(), 0.1 * angle.cos(), 0.05);
    let corners = [(0.5, 0.3), (-0.5, 0.3), (-0.5, -0.3), (0.5, -0.3)].map(|(x, y)| Vector2::new(x, y));
    let mut robots = Vec::new();
    let mut markers = vec![
        Marker::Load { load: LoadId(0), world_from_load, outline_in_load: &corners },
        Marker::Waypoint { index: 0, position: Vector2::new(0.0, 2.0), radius: 0.1 },
    ];
    for robot in 0..ROBOTS {
        let bearing = TAU * f64::from(robot) / f64::from(ROBOTS);
        let offset = unit(bearing) * (0.6 + 0.01 * (seconds * f64::from(robot + 1)).sin());
        let world_from_robot = world_from_load * pose(offset.x, offset.y, bearing + 0.5 * TAU);
        let role = Role::ALL[usize::from(robot % 3)];
        let observation = Observation {
            time,
            sampled: time.plus_nanos(-TICK / 10),
            robot: RobotId(robot),
            world_from_robot,
            world_from_load,
            load_twist_in_world: load_twist,
            stop_flags: StopFlags::default(),
        };
        let decision = Decision {
            command: Command::drive(0.1 + 0.01 * bearing.sin(), 0.05),
            primitive: Some(Primitive::Translate),
            role: (robot != 5).then_some(role),
            phase: Phase::Work,
            heading_error: 0.01 * seconds.sin(),
            distance: 2.0 - 0.1 * angle,
            slot_tangential: 0.01 * (3.0 * seconds).sin(),
            slot_gap: 0.001,
            ..Decision::default()
        };
        writer.decision(&observation, &decision)?;
        writer.robot_state(time, RobotId(robot), &world_from_robot, decision.command, 0.7 + bearing)?;
        robots.push((RobotId(robot), world_from_robot));
        markers.push(Marker::Robot { robot: RobotId(robot), world_from_robot, radius: 0.105, role: decision.role });
    }
    writer.load_state(time, LoadId(0), &world_from_load, &load_twist)?;
    writer.transforms(time, &robots, &[(LoadId(0), world_from_load)])?;
    if tick % 4 == 0 {
        writer.markers(time, &markers)?;
    }
    Ok(())
}
