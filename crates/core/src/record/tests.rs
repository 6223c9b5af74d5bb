//! Facts about whole logs.

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex, Vector2};
use proptest::prelude::*;

use super::message::cohaul::{Decided, LoadState, RobotState};
use super::*;
use crate::control::{Command, Decision, Fault, Observation, Phase, StopFlags};
use crate::id::{LoadId, RobotId};
use crate::record::marker::Marker;
use crate::se2::{Pose2, Twist2, pose};
use crate::time::Time;
use crate::transport::primitive::Primitive;
use crate::transport::role::Role;

fn header(robots: usize) -> Header {
    Header {
        scenario_name: "corridor".into(),
        scenario_text: "schema: cohaul/1\nname: corridor # größer\n".into(),
        seed: u64::MAX,
        world: "planar".into(),
        version: "0.1.0".into(),
        revision: "0123abc".into(),
        robots: (0..robots).map(|i| format!("r{i}")).collect(),
        loads: vec!["crate".into()],
    }
}

/// A log of `ticks` ticks of two robots, 12 messages each.
fn log(ticks: i64) -> Vec<u8> {
    let mut writer = LogWriter::new(Vec::new(), &header(2)).unwrap();
    writer.memory(Time::ZERO, RobotId(0), "{}").unwrap();
    for tick in 0..ticks {
        let time = Time::from_nanos(tick * 50_000_000);
        let x = (tick as f64 * 0.37).sin();
        for robot in [RobotId(0), RobotId(1)] {
            let observation = Observation {
                time,
                sampled: time,
                robot,
                world_from_robot: pose(x, f64::from(robot.0), x),
                world_from_load: pose(1.0 + x, 0.0, 0.1 * x),
                load_twist_in_world: Twist2::new(x, 0.0, 0.0),
                stop_flags: StopFlags(u64::from(robot.0)),
            };
            let decision = Decision { role: Some(Role::Push), distance: x, ..Decision::default() };
            writer.decision(&observation, &decision).unwrap();
            writer.robot_state(time, robot, &observation.world_from_robot, Command::STOP, 2.5).unwrap();
        }
        writer.load_state(time, LoadId(0), &pose(x, x, x), &Twist2::ZERO).unwrap();
    }
    writer.outcome(Time::from_nanos(ticks * 50_000_000), "{\"outcome\":\"reached\"}").unwrap();
    writer.finish().unwrap()
}

/// Records of a log up to its end or its first error.
fn read(log: &[u8]) -> (Vec<Record>, Option<RecordError>) {
    let mut records = Vec::new();
    for record in LogReader::new(log) {
        match record {
            Ok(record) => records.push(record),
            Err(error) => return (records, Some(error)),
        }
    }
    (records, None)
}

fn any_f64() -> impl Strategy<Value = f64> {
    // every bit pattern, NaN payloads included
    prop_oneof![any::<u64>().prop_map(f64::from_bits), -10.0..10.0_f64]
}

fn any_pose() -> impl Strategy<Value = Pose2> {
    [any_f64(), any_f64(), any_f64(), any_f64()].prop_map(|[x, y, cos, sin]| {
        Isometry2::from_parts(Translation2::new(x, y), UnitComplex::new_unchecked(Complex::new(cos, sin)))
    })
}

fn any_twist() -> impl Strategy<Value = Twist2> {
    [any_f64(), any_f64(), any_f64()].prop_map(|[x, y, w]| Twist2::new(x, y, w))
}

prop_compose! {
    fn any_observation()(
        time in any::<i64>(), sampled in any::<i64>(), robot in 0_u16..2, stop_flags in any::<u64>(),
        world_from_robot in any_pose(), world_from_load in any_pose(), load_twist_in_world in any_twist(),
    ) -> Observation {
        Observation {
            time: Time::from_nanos(time), sampled: Time::from_nanos(sampled), robot: RobotId(robot), world_from_robot,
            world_from_load, load_twist_in_world, stop_flags: StopFlags(stop_flags),
        }
    }
}

prop_compose! {
    fn any_decision()(
        numbers in [(); 8].map(|()| any_f64()),
        stop in any::<bool>(), waypoint in any::<u16>(),
        primitive in prop::option::of(prop::sample::select(&Primitive::ALL[..])),
        role in prop::option::of(prop::sample::select(&Role::ALL[..])),
        phase in prop::sample::select(&Phase::ALL[..]), fault in prop::sample::select(&Fault::ALL[..]),
    ) -> Decision {
        let [linear, lateral, angular, heading_error, distance, slot_tangential, slot_gap, slot_heading] = numbers;
        Decision {
            command: Command { linear, lateral, angular }, stop, primitive, role, phase, fault, waypoint, heading_error, distance,
            slot_tangential, slot_gap, slot_heading,
        }
    }
}

fn pose_bits(pose: &Pose2) -> [u64; 4] {
    [pose.translation.x, pose.translation.y, pose.rotation.re, pose.rotation.im].map(f64::to_bits)
}

fn twist_bits(twist: &Twist2) -> [u64; 3] {
    [twist.linear.x, twist.linear.y, twist.angular].map(f64::to_bits)
}

fn same_observation(a: &Observation, b: &Observation) -> bool {
    (a.time, a.sampled, a.robot, a.stop_flags) == (b.time, b.sampled, b.robot, b.stop_flags)
        && pose_bits(&a.world_from_robot) == pose_bits(&b.world_from_robot)
        && pose_bits(&a.world_from_load) == pose_bits(&b.world_from_load)
        && twist_bits(&a.load_twist_in_world) == twist_bits(&b.load_twist_in_world)
}

fn same_decision(a: &Decision, b: &Decision) -> bool {
    let numbers = |d: &Decision| {
        [
            d.command.linear,
            d.command.lateral,
            d.command.angular,
            d.heading_error,
            d.distance,
            d.slot_tangential,
            d.slot_gap,
            d.slot_heading,
        ]
        .map(f64::to_bits)
    };
    (a.stop, a.primitive, a.role, a.phase, a.fault, a.waypoint)
        == (b.stop, b.primitive, b.role, b.phase, b.fault, b.waypoint)
        && numbers(a) == numbers(b)
}

proptest! {
    #[test]
    fn observations_and_decisions_come_back_bit_for_bit(
        ticks in prop::collection::vec((any_observation(), any_decision()), 1..40)
    ) {
        let mut writer = LogWriter::new(Vec::new(), &header(2)).unwrap();
        for (observation, decision) in &ticks {
            writer.decision(observation, decision).unwrap();
        }
        let (records, error) = read(&writer.finish().unwrap());
        prop_assert!(error.is_none(), "{error:?}");
        prop_assert_eq!(records.len(), 1 + 3 * ticks.len());
        for ((observation, decision), read) in ticks.iter().zip(records[1..].chunks(3)) {
            let [Record::Observation(seen), Record::Decision(decided), Record::Other { .. }] = read else {
                panic!("{read:?}")
            };
            prop_assert!(same_observation(observation, seen));
            prop_assert_eq!((decided.time, decided.robot), (observation.time, observation.robot));
            prop_assert!(same_decision(decision, &decided.decision));
        }
    }

    #[test]
    fn states_come_back_bit_for_bit(
        time in any::<i64>(), at in any_pose(), twist in any_twist(), speeds in [any_f64(), any_f64(), any_f64()],
        traction in any_f64(),
    ) {
        let time = Time::from_nanos(time);
        let [linear, lateral, angular] = speeds;
        let mut writer = LogWriter::new(Vec::new(), &header(2)).unwrap();
        writer.load_state(time, LoadId(0), &at, &twist).unwrap();
        writer.robot_state(time, RobotId(1), &at, Command { linear, lateral, angular }, traction).unwrap();
        let (records, error) = read(&writer.finish().unwrap());
        prop_assert!(error.is_none(), "{error:?}");
        let [_, Record::LoadState(load), _, Record::RobotState(robot), _] = records.as_slice() else {
            panic!("{records:?}")
        };
        let LoadState { world_from_load, twist_in_world, .. } = load;
        prop_assert_eq!((load.time, pose_bits(world_from_load), twist_bits(twist_in_world)),
            (time, pose_bits(&at), twist_bits(&twist)));
        let RobotState { world_from_robot, speeds, traction: force, .. } = robot;
        prop_assert_eq!((robot.time, robot.robot, pose_bits(world_from_robot)), (time, RobotId(1), pose_bits(&at)));
        prop_assert_eq!([speeds.linear, speeds.angular, *force].map(f64::to_bits),
            [linear, angular, traction].map(f64::to_bits));
    }

    #[test]
    fn no_bytes_make_a_decoder_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), framed in any::<bool>()) {
        use super::message::{Message, cohaul, standard};
        let mut payload = if framed { vec![0, 1, 0, 0] } else { Vec::new() };
        payload.extend(bytes);
        let _ = Observation::from_cdr(&payload);
        let _ = Decided::from_cdr(&payload);
        let _ = cohaul::Memory::from_cdr(&payload);
        let _ = LoadState::from_cdr(&payload);
        let _ = RobotState::from_cdr(&payload);
        let _ = cohaul::Outcome::from_cdr(&payload);
        let _ = standard::PoseStamped::from_cdr(&payload);
        let _ = standard::TwistStamped::from_cdr(&payload);
        let _ = standard::TfMessage::from_cdr(&payload);
        let _ = standard::MarkerArray::from_cdr(&payload);
    }
}

/// `Rotate(Clockwise)` is `ROTATE_CLOCKWISE`.
fn constant(value: &impl std::fmt::Debug) -> String {
    let mut name = String::new();
    for c in format!("{value:?}").chars().filter(|c| *c != ')').map(|c| if c == '(' { '_' } else { c }) {
        if c.is_uppercase() && !name.is_empty() && !name.ends_with('_') {
            name.push('_');
        }
        name.push(c.to_ascii_uppercase());
    }
    name
}

#[test]
fn numbers_in_the_log_are_those_of_the_message_definition() {
    use super::message::Message;
    let text = Decided::SCHEMA.text;
    let mut lines = 0;
    let mut check = |prefix: &str, names: Vec<String>| {
        for (number, name) in names.iter().enumerate() {
            let line = format!("uint8 {prefix}_{name}={number}\n");
            assert!(text.contains(&line), "{line}");
            lines += 1;
        }
    };
    check("PRIMITIVE", Primitive::ALL.iter().map(constant).collect());
    check("ROLE", Role::ALL.iter().map(constant).collect());
    check("PHASE", Phase::ALL.iter().map(constant).collect());
    check("FAULT", Fault::ALL.iter().map(constant).collect());
    assert_eq!(text.matches('=').count(), lines + 1, "a constant too many");
}

#[test]
fn the_same_calls_give_the_same_bytes() {
    assert_eq!(log(40), log(40));
}

#[test]
fn a_log_starts_with_its_header_and_keeps_the_order_of_writing() {
    let (records, error) = read(&log(1));
    assert!(error.is_none(), "{error:?}");
    assert_eq!(records.first(), Some(&Record::Metadata(header(2))));
    let kinds: Vec<&str> = records
        .iter()
        .map(|record| match record {
            Record::Metadata(_) => "metadata",
            Record::Observation(_) => "observation",
            Record::Decision(_) => "decision",
            Record::Memory { .. } => "memory",
            Record::LoadState(_) => "load",
            Record::RobotState(_) => "robot",
            Record::Outcome { .. } => "outcome",
            Record::Other { topic, .. } => topic,
        })
        .collect();
    assert_eq!(
        kinds,
        [
            "metadata",
            "memory",
            "observation",
            "decision",
            "/r0/cmd_vel",
            "robot",
            "/r0/pose",
            "observation",
            "decision",
            "/r1/cmd_vel",
            "robot",
            "/r1/pose",
            "load",
            "/loads/crate/pose",
            "outcome"
        ]
    );
}

#[test]
fn names_that_no_topic_can_carry_are_refused() {
    for name in ["", "1st", "a b", "a/b", "ü"] {
        let header = Header { robots: vec![name.into()], ..Header::default() };
        assert!(matches!(LogWriter::new(Vec::new(), &header), Err(RecordError::Name { .. })), "{name:?}");
    }
    let header = Header { robots: vec!["a".into(), "a".into()], ..Header::default() };
    assert!(matches!(LogWriter::new(Vec::new(), &header), Err(RecordError::DuplicateTopic { .. })));
}

#[test]
fn unknown_robots_and_loads_are_refused() {
    let mut writer = LogWriter::new(Vec::new(), &header(2)).unwrap();
    assert!(matches!(
        writer.memory(Time::ZERO, RobotId(2), "{}"),
        Err(RecordError::UnknownRobot { robot: RobotId(2), known: 2 })
    ));
    let unknown = [(LoadId(1), Pose2::identity())];
    assert!(matches!(
        writer.transforms(Time::ZERO, &[], &unknown),
        Err(RecordError::UnknownLoad { load: LoadId(1), known: 1 })
    ));
    assert_eq!(writer.messages(), 0);
}

/// A stream that remembers how much of it was flushed.
#[derive(Default)]
struct Flushed {
    written: Vec<u8>,
    safe: usize,
}

impl std::io::Write for Flushed {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.written.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.safe = self.written.len();
        Ok(())
    }
}

#[test]
fn a_writer_killed_after_any_message_loses_fewer_than_64() {
    let corners = [Vector2::new(0.5, 0.5), Vector2::new(-0.5, 0.5), Vector2::new(0.0, -0.5)];
    for total in 0..200_u64 {
        let mut writer = LogWriter::new(Flushed::default(), &header(2)).unwrap();
        for index in 0..total {
            let outline =
                Marker::Load { load: LoadId(0), world_from_load: pose(0.0, 0.0, 1.0), outline_in_load: &corners };
            writer.markers(Time::from_nanos(index as i64), &[outline]).unwrap();
        }
        let stream = writer.into_unfinished();
        let mut saved = Vec::new();
        let report = recover(&stream.written[..stream.safe], &mut saved).unwrap();
        assert_eq!(report.header, Some(header(2)));
        assert!(total - report.messages < u64::from(FLUSH_EVERY), "{total} {report:?}");
    }
}

/// Messages in whole chunks before each place of a log: (end of the chunk, messages up to there).
fn whole_chunks(log: &[u8]) -> Vec<(usize, u64)> {
    let mut rest = &log[8..];
    let (mut messages, mut ends) = (0, Vec::new());
    while let Some((opcode, body)) = chunk::split(&mut rest) {
        if opcode == mcap::records::op::CHUNK {
            let mut records = Vec::new();
            chunk::unpack(body, &mut records).unwrap();
            let mut inner = records.as_slice();
            while let Some((opcode, _)) = chunk::split(&mut inner) {
                messages += u64::from(opcode == mcap::records::op::MESSAGE);
            }
            ends.push((log.len() - rest.len(), messages));
        }
    }
    ends
}

/// A small generator: the positions of damage need no quality, only repeatability.
fn next(state: &mut u64) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize
}

#[test]
fn every_truncation_is_noticed_and_keeps_all_whole_chunks() {
    let log = log(80);
    let chunks = whole_chunks(&log);
    let mut state = 1;
    for _ in 0..2_000 {
        let cut = next(&mut state) % log.len();
        let part = &log[..cut];
        let (records, error) = read(part);
        let error = error.expect("a cut file is never whole");
        assert!(matches!(error, RecordError::Unfinished { .. } | RecordError::NotALog), "{cut}: {error:?}");
        let before = chunks.iter().rev().find(|(end, _)| *end <= cut).map_or(0, |(_, messages)| *messages);
        let read = records.iter().filter(|record| !matches!(record, Record::Metadata(_))).count() as u64;
        assert_eq!(read, before, "{cut}");
        let mut saved = Vec::new();
        match recover(part, &mut saved) {
            Ok(report) => {
                assert_eq!(report.messages, before, "{cut} {report:?}");
                // behind the last byte of data nothing is lost
                assert!(report.lost_reason.is_some() || before == chunks.last().unwrap().1);
                assert!(tests::read(&saved).1.is_none());
            }
            Err(error) => assert!(matches!(error, RecordError::NothingLeft { .. }) && before == 0, "{cut}: {error:?}"),
        }
    }
}

#[test]
fn every_flipped_bit_is_noticed_or_harmless() {
    let log = log(80);
    let (whole, _) = read(&log);
    let total = whole_chunks(&log).last().unwrap().1;
    let mut state = 2;
    for _ in 0..2_000 {
        // half of the flips in the first 1000 bytes, where the lengths of many records stand
        let range = if next(&mut state).is_multiple_of(2) { 1_000 } else { log.len() };
        let place = next(&mut state) % range;
        let bit = next(&mut state) % 8;
        let mut damaged = log.clone();
        damaged[place] ^= 1 << bit;
        let (records, error) = read(&damaged);
        // without its name the metadata is nothing to us; the checksum of the data tells at the end
        let skipped = usize::from(error.is_some() && !matches!(records.first(), Some(Record::Metadata(_))));
        assert!(whole[skipped..].starts_with(&records), "byte {place} bit {bit}");
        assert!(error.is_some() || records.len() == whole.len(), "byte {place} bit {bit}");
        let mut saved = Vec::new();
        let report = recover(damaged.as_slice(), &mut saved).unwrap();
        // one bit spoils one chunk at most
        assert!(report.messages + u64::from(FLUSH_EVERY) >= total, "byte {place} bit {bit}: {report:?}");
        let (saved, error) = read(&saved);
        assert!(error.is_none(), "byte {place} bit {bit}: {error:?}");
        if report.messages == total && report.header.is_some() {
            assert!(saved == whole, "byte {place} bit {bit}");
        }
    }
}

#[test]
fn holes_and_noise_cost_only_what_they_hit() {
    let log = log(80);
    let chunks = whole_chunks(&log);
    let total = chunks.last().unwrap().1;
    let mut state = 3;
    for round in 0..500 {
        // behind the metadata and definitions; those at the front have their own tests
        let from = chunks[0].0 + next(&mut state) % (chunks.last().unwrap().0 - chunks[0].0);
        let to = log.len().min(from + 1 + next(&mut state) % 2_000);
        let noise: Vec<u8> = (from..to).map(|_| next(&mut state) as u8).collect();
        let middle = match round % 3 {
            0 => Vec::new(),
            1 => vec![0; to - from],
            _ => noise,
        };
        let damaged = [&log[..from], &middle, &log[to..]].concat();
        assert!(read(&damaged).1.is_some(), "{from}..{to}");
        let mut saved = Vec::new();
        let report = recover(damaged.as_slice(), &mut saved).unwrap();
        let hit = 1 + chunks.iter().filter(|(end, _)| (from..to).contains(end)).count() as u64;
        assert!(report.messages + hit * u64::from(FLUSH_EVERY) >= total, "{from}..{to}: {report:?}");
        assert!(read(&saved).1.is_none(), "{from}..{to}");
    }
}

#[test]
fn long_messages_come_back_and_longer_ones_are_refused() {
    let mut writer = LogWriter::new(Vec::new(), &header(1)).unwrap();
    // does not compress, spans blocks
    let mut state = 4;
    let json: String = (0..1_500_000).map(|_| char::from(b' ' + (next(&mut state) % 90) as u8)).collect();
    writer.memory(Time::ZERO, RobotId(0), &json).unwrap();
    let longer = json.repeat(2);
    assert!(matches!(writer.memory(Time::ZERO, RobotId(0), &longer), Err(RecordError::TooLong { .. })));
    writer.memory(Time::ZERO, RobotId(0), "{}").unwrap();
    let (records, error) = read(&writer.finish().unwrap());
    assert!(error.is_none(), "{error:?}");
    assert!(matches!(&records[1], Record::Memory { json: read, .. } if *read == json));
    assert!(matches!(&records[2], Record::Memory { json, .. } if json == "{}"));
    assert_eq!(records.len(), 3);
}

#[test]
fn a_stream_that_fails_once_is_left_alone() {
    /// Takes a number of bytes, then fails once.
    struct Full<'a>(usize, &'a mut Vec<u8>);
    impl std::io::Write for Full<'_> {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            if self.0 < bytes.len() {
                self.0 = usize::MAX;
                return Err(std::io::Error::other("disk is full"));
            }
            self.0 -= bytes.len();
            self.1.extend_from_slice(bytes);
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut file = Vec::new();
    let mut writer = LogWriter::new(Full(20_000, &mut file), &header(1)).unwrap();
    let mut failures = 0;
    for tick in 0..1_000 {
        let state =
            writer.robot_state(Time::from_nanos(tick), RobotId(0), &pose(0.0, 0.0, tick as f64), Command::STOP, 0.0);
        failures += usize::from(matches!(state, Err(RecordError::Io(_))));
    }
    assert!(failures > 1, "every later flush fails too");
    assert!(writer.finish().is_err());
    let report = recover(file.as_slice(), std::io::sink()).unwrap();
    assert!(report.messages > 0 && report.messages.is_multiple_of(u64::from(FLUSH_EVERY)));
    assert_eq!(report.missing, 0);
}

#[test]
fn errors_say_where_and_what_to_do() {
    let log = log(20);
    let cut = read(&log[..log.len() / 2]).1.unwrap().to_string();
    assert!(cut.contains("unfinished") && cut.contains("cohaul recover"), "{cut}");
    let (end, _) = whole_chunks(&log)[1];
    let mut damaged = log.clone();
    damaged[end - 20] ^= 1;
    let (records, error) = read(&damaged);
    let error = error.unwrap();
    let RecordError::Damaged { byte, messages, .. } = &error else { panic!("{error}") };
    assert!((*byte as usize) < end);
    assert_eq!(*messages, records.len() as u64 - 1);
    assert!(error.to_string().contains("cohaul recover"), "{error}");
    assert!(matches!(read(b"name: corridor\n").1, Some(RecordError::NotALog)));
    assert!(matches!(read(b"").1, Some(RecordError::NotALog)));
}

#[test]
fn a_whole_log_is_recovered_byte_for_byte() {
    let log = log(20);
    let mut saved = Vec::new();
    let report = recover(log.as_slice(), &mut saved).unwrap();
    assert_eq!(report.lost_reason, None);
    assert_eq!((report.missing, report.skipped_bytes), (0, 0));
    assert!(saved == log);
}
