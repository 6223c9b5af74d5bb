//! Frames as columns of small integers.
//!
//! Each quantity is a column: its values are divided by a quantum and rounded, the differences from one frame to the next
//! are written as variable-length integers (zigzag, seven bits per byte, low bits first), the bytes as base64. What changes
//! rarely (roles, phases) is written as runs instead: length, value, length, value, …

use std::f64::consts::TAU;

use cohaul_core::control::Phase;
use cohaul_core::transport::primitive::{Primitive, Turn};
use cohaul_core::transport::role::Role;
use serde_json::{Value, json};

use super::{Frame, Kind, Replay, RobotFrame, TeamFrame};

/// Shortest time between two frames that are kept, s.
const INTERVAL_MIN: f64 = 0.05;
/// Frames times bodies that are kept; some 12 bytes each.
const BODY_FRAMES_MAX: f64 = 100_000.0;
/// The same for plans: between two states that are not neighbours a straight line would be wrong.
const PLAN_BODY_FRAMES_MAX: f64 = 1_000_000.0;
/// Largest quantised value; differences of two still fit 32 bits in JavaScript.
const INTEGER_MAX: f64 = (1_i64 << 29) as f64;

const TIME: f64 = 1e-3;
const POSITION: f64 = 1e-4;
const ANGLE: f64 = 1e-4;
const RATE: f64 = 1e-3;

/// The frames that are kept, column by column.
pub(super) fn frames(replay: &Replay) -> Value {
    let most = match replay.kind {
        Kind::Mission => BODY_FRAMES_MAX,
        Kind::Plan => PLAN_BODY_FRAMES_MAX,
    };
    let frames = thinned(&replay.frames, replay.loads.len() + replay.robots.len(), most);
    let loads: Vec<Value> = (0..replay.loads.len())
        .map(|load| {
            let poses: Vec<[f64; 3]> =
                frames.iter().map(|f| f.loads.get(load).copied().unwrap_or([f64::NAN; 3])).collect();
            pose_columns(&poses)
        })
        .collect();
    let robots: Vec<Value> = (0..replay.robots.len()).map(|robot| robot_columns(replay.kind, &frames, robot)).collect();
    let teams: Vec<Value> = (0..replay.teams.len()).map(|team| team_columns(&frames, team)).collect();
    json!({
        "time": deltas(TIME, frames.iter().map(|f| f.time)),
        "loads": loads,
        "robots": robots,
        "teams": teams,
    })
}

/// The frames that are kept: the first, the last, and what lies far enough apart between them.
fn thinned(frames: &[Frame], bodies: usize, most: f64) -> Vec<&Frame> {
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else {
        return Vec::new();
    };
    let interval = ((last.time - first.time) * bodies as f64 / most).max(INTERVAL_MIN);
    let mut kept = vec![first];
    let mut due = first.time + interval;
    for frame in frames.iter().skip(1) {
        // a thousandth of the interval, so that rounding does not skip a frame that is due
        if frame.time >= due - 1e-3 * interval {
            kept.push(frame);
            due = (due + interval).max(frame.time);
        }
    }
    if frames.len() > 1 && kept.last().is_none_or(|frame| frame.time < last.time) {
        kept.push(last);
    }
    kept
}

/// Robots of a plan have poses only.
fn robot_columns(kind: Kind, frames: &[&Frame], robot: usize) -> Value {
    let lost = RobotFrame { pose: [f64::NAN; 3], ..RobotFrame::default() };
    let robot: Vec<RobotFrame> = frames.iter().map(|f| f.robots.get(robot).copied().unwrap_or(lost)).collect();
    let poses: Vec<[f64; 3]> = robot.iter().map(|r| r.pose).collect();
    let mut columns = pose_columns(&poses);
    if kind == Kind::Plan {
        return columns;
    }
    columns["linear"] = deltas(RATE, robot.iter().map(|r| r.command[0]));
    columns["angular"] = deltas(RATE, robot.iter().map(|r| r.command[1]));
    columns["speed"] = deltas(RATE, robot.iter().map(|r| r.speed));
    columns["role"] = runs(robot.iter().map(|r| r.role.map_or(0, role_number)));
    columns["phase"] = runs(robot.iter().map(|r| phase_number(r.phase)));
    columns["stop"] = runs(robot.iter().map(|r| u64::from(r.stop)));
    columns
}

fn team_columns(frames: &[&Frame], team: usize) -> Value {
    let lost = TeamFrame { heading_error: f64::NAN, distance: f64::NAN, ..TeamFrame::default() };
    let team: Vec<TeamFrame> = frames.iter().map(|f| f.teams.get(team).copied().unwrap_or(lost)).collect();
    json!({
        "primitive": runs(team.iter().map(|t| primitive_number(t.primitive))),
        "waypoint": runs(team.iter().map(|t| t.waypoint as u64)),
        "heading_error": deltas(ANGLE, team.iter().map(|t| t.heading_error)),
        "distance": deltas(RATE, team.iter().map(|t| t.distance)),
    })
}

fn pose_columns(poses: &[[f64; 3]]) -> Value {
    json!({
        "x": deltas(POSITION, poses.iter().map(|p| p[0])),
        "y": deltas(POSITION, poses.iter().map(|p| p[1])),
        "yaw": deltas(ANGLE, unwrapped(poses.iter().map(|p| p[2]))),
    })
}

/// Number of a role in the page: 1 for the first, 0 for none.
fn role_number(role: Role) -> u64 {
    Role::ALL.iter().position(|r| *r == role).map_or(0, |place| place as u64 + 1)
}

fn phase_number(phase: Phase) -> u64 {
    Phase::ALL.iter().position(|p| *p == phase).map_or(0, |place| place as u64)
}

/// 0 for none, 1 and 2 for turns to the left and to the right, 3 for a translation.
fn primitive_number(primitive: Option<Primitive>) -> u64 {
    match primitive {
        None => 0,
        Some(Primitive::Rotate(Turn::Counterclockwise)) => 1,
        Some(Primitive::Rotate(Turn::Clockwise)) => 2,
        Some(Primitive::Translate) => 3,
    }
}

/// Angles without jumps by a full turn, rad, so that the page may interpolate between them.
fn unwrapped(angles: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
    let mut last = 0.0;
    angles.map(move |angle| {
        if !angle.is_finite() {
            return f64::NAN;
        }
        last = angle - ((angle - last) / TAU).round() * TAU;
        last
    })
}

/// A column of differences; a value that is not finite repeats the one before.
fn deltas(quantum: f64, values: impl Iterator<Item = f64>) -> Value {
    let mut bytes = Vec::new();
    let mut last = 0_i64;
    for value in values {
        let quantised = (value / quantum).round();
        let integer = if quantised.is_nan() { last } else { quantised.clamp(-INTEGER_MAX, INTEGER_MAX) as i64 };
        let difference = integer - last;
        push_varint(&mut bytes, ((difference << 1) ^ (difference >> 63)).cast_unsigned());
        last = integer;
    }
    json!({"quantum": quantum, "deltas": base64(&bytes)})
}

/// A column of runs.
fn runs(values: impl Iterator<Item = u64>) -> Value {
    let mut bytes = Vec::new();
    let mut run = None;
    for value in values {
        run = match run {
            Some((length, same)) if same == value => Some((length + 1, same)),
            Some((length, other)) => {
                push_varint(&mut bytes, length);
                push_varint(&mut bytes, other);
                Some((1, value))
            }
            None => Some((1, value)),
        };
    }
    if let Some((length, value)) = run {
        push_varint(&mut bytes, length);
        push_varint(&mut bytes, value);
    }
    json!({"runs": base64(&bytes)})
}

fn push_varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let group = chunk.iter().enumerate().fold(0_u32, |sum, (i, byte)| sum | u32::from(*byte) << (16 - 8 * i));
        for digit in 0..4 {
            if digit <= chunk.len() {
                text.push(ALPHABET[(group >> (18 - 6 * digit) & 63) as usize] as char);
            } else {
                text.push('=');
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of RFC 4648 §10.
    #[test]
    fn base64_agrees_with_the_rfc() {
        for (plain, coded) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn angles_unwrap_across_pi() {
        let angles: Vec<f64> = unwrapped([3.0, -3.0, 3.0].into_iter()).collect();
        assert!((angles[1] - (TAU - 3.0)).abs() < 1e-12 && (angles[2] - 3.0).abs() < 1e-12); // rounding only
    }

    #[test]
    fn values_that_are_not_finite_repeat_the_one_before() {
        let lossy = deltas(1.0, [1.0, f64::NAN, 2.0].into_iter());
        assert_eq!(lossy, deltas(1.0, [1.0, 1.0, 2.0].into_iter()));
    }

    #[test]
    fn thinning_keeps_the_ends_and_the_budget() {
        let frames: Vec<Frame> =
            (0..=60_000).map(|i| Frame { time: f64::from(i) * 0.025, ..Frame::default() }).collect();
        let kept = thinned(&frames, 14, BODY_FRAMES_MAX);
        assert!((kept.len() as f64) * 14.0 < 1.01 * BODY_FRAMES_MAX, "{}", kept.len()); // the last frame may exceed
        assert_eq!((kept[0].time, kept[kept.len() - 1].time), (0.0, 1500.0));
    }
}
