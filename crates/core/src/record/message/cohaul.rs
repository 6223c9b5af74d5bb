//! Messages of the package `cohaul_msgs`: bit-exact, so that a replay can compare.
//!
//! Poses are (x, y, cos, sin), instants whole nanoseconds, enumerations their place in `ALL`, 255 where there is none.

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex};

use super::{Definition, Message, Schema};
use crate::control::{Command, Decision, Fault, Observation, Phase, StopFlags};
use crate::id::{LoadId, RobotId};
use crate::record::cdr::{CdrError, Decoder, Encoder};
use crate::se2::{Pose2, Twist2};
use crate::time::Time;
use crate::transport::primitive::Primitive;
use crate::transport::role::Role;

/// Number of an absent primitive or role.
const NONE: u8 = 255;

const POSE2: Definition = Definition { name: "cohaul_msgs/Pose2", text: include_str!("../../../msg/msg/Pose2.msg") };
const TWIST2: Definition = Definition { name: "cohaul_msgs/Twist2", text: include_str!("../../../msg/msg/Twist2.msg") };

/// What one robot decided at one of its control ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decided {
    /// When.
    pub time: Time,
    /// Which robot.
    pub robot: RobotId,
    /// The command and its reason.
    pub decision: Decision,
}

/// What a controller remembers, at the start and at each reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory<'a> {
    /// When.
    pub time: Time,
    /// Which robot.
    pub robot: RobotId,
    /// The memory as [`crate::control::Step::memory`] gives it.
    pub json: &'a str,
}

/// True state of a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadState {
    /// When.
    pub time: Time,
    /// Which load.
    pub load: LoadId,
    /// Its pose.
    pub world_from_load: Pose2,
    /// Velocity of its centre in the world frame, m/s and rad/s.
    pub twist_in_world: Twist2,
}

/// True state of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotState {
    /// When.
    pub time: Time,
    /// Which robot.
    pub robot: RobotId,
    /// Its pose.
    pub world_from_robot: Pose2,
    /// Its forward and sideways speed, m/s, and yaw rate, rad/s.
    pub speeds: Command,
    /// Force of its wheels along its heading, N.
    pub traction: f64,
}

/// How an episode ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome<'a> {
    /// When.
    pub time: Time,
    /// The result as `cohaul run --json` prints it.
    pub json: &'a str,
}

fn encode_pose(pose: &Pose2, out: &mut Encoder<'_>) {
    out.f64(pose.translation.x);
    out.f64(pose.translation.y);
    out.f64(pose.rotation.re);
    out.f64(pose.rotation.im);
}

fn decode_pose(input: &mut Decoder<'_>) -> Result<Pose2, CdrError> {
    let translation = Translation2::new(input.f64()?, input.f64()?);
    // unchecked: normalising would change bits
    let rotation = UnitComplex::new_unchecked(Complex::new(input.f64()?, input.f64()?));
    Ok(Isometry2::from_parts(translation, rotation))
}

fn encode_twist(twist: &Twist2, out: &mut Encoder<'_>) {
    out.f64(twist.linear.x);
    out.f64(twist.linear.y);
    out.f64(twist.angular);
}

fn decode_twist(input: &mut Decoder<'_>) -> Result<Twist2, CdrError> {
    Ok(Twist2::new(input.f64()?, input.f64()?, input.f64()?))
}

fn decode_command(input: &mut Decoder<'_>) -> Result<Command, CdrError> {
    Ok(Command { linear: input.f64()?, lateral: input.f64()?, angular: input.f64()? })
}

/// Place of `value` in `all`; [`NONE`] if it is absent.
fn number<T: PartialEq>(all: &[T], value: Option<&T>) -> u8 {
    let place = value.and_then(|value| all.iter().position(|other| other == value));
    place.and_then(|place| u8::try_from(place).ok()).unwrap_or(NONE)
}

fn decode_option<T: Copy>(all: &[T], field: &'static str, input: &mut Decoder<'_>) -> Result<Option<T>, CdrError> {
    let at = input.at();
    let value = input.u8()?;
    match all.get(usize::from(value)) {
        Some(found) => Ok(Some(*found)),
        None if value == NONE => Ok(None),
        None => Err(CdrError::Value { field, at, value: u64::from(value) }),
    }
}

fn decode_enum<T: Copy>(all: &[T], field: &'static str, input: &mut Decoder<'_>) -> Result<T, CdrError> {
    let at = input.at();
    decode_option(all, field, input)?.ok_or(CdrError::Value { field, at, value: u64::from(NONE) })
}

impl Message<'_> for Observation {
    const SCHEMA: Schema = Schema {
        name: "cohaul_msgs/msg/Observation",
        text: include_str!("../../../msg/msg/Observation.msg"),
        dependencies: &[POSE2, TWIST2],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.i64(self.time.nanos());
        out.i64(self.sampled.nanos());
        out.u16(self.robot.0);
        encode_pose(&self.world_from_robot, out);
        encode_pose(&self.world_from_load, out);
        encode_twist(&self.load_twist_in_world, out);
        out.u64(self.stop_flags.0);
    }

    fn decode(input: &mut Decoder<'_>) -> Result<Self, CdrError> {
        Ok(Self {
            time: Time::from_nanos(input.i64()?),
            sampled: Time::from_nanos(input.i64()?),
            robot: RobotId(input.u16()?),
            world_from_robot: decode_pose(input)?,
            world_from_load: decode_pose(input)?,
            load_twist_in_world: decode_twist(input)?,
            stop_flags: StopFlags(input.u64()?),
        })
    }
}

impl Message<'_> for Decided {
    const SCHEMA: Schema = Schema {
        name: "cohaul_msgs/msg/Decision",
        text: include_str!("../../../msg/msg/Decision.msg"),
        dependencies: &[],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        let decision = &self.decision;
        out.i64(self.time.nanos());
        out.u16(self.robot.0);
        out.f64(decision.command.linear);
        out.f64(decision.command.lateral);
        out.f64(decision.command.angular);
        out.bool(decision.stop);
        out.u8(number(&Primitive::ALL, decision.primitive.as_ref()));
        out.u8(number(&Role::ALL, decision.role.as_ref()));
        out.u8(number(&Phase::ALL, Some(&decision.phase)));
        out.u8(number(&Fault::ALL, Some(&decision.fault)));
        out.u16(decision.waypoint);
        out.f64(decision.heading_error);
        out.f64(decision.distance);
        out.f64(decision.slot_tangential);
        out.f64(decision.slot_gap);
        out.f64(decision.slot_heading);
    }

    fn decode(input: &mut Decoder<'_>) -> Result<Self, CdrError> {
        Ok(Self {
            time: Time::from_nanos(input.i64()?),
            robot: RobotId(input.u16()?),
            decision: Decision {
                command: decode_command(input)?,
                stop: input.bool("stop")?,
                primitive: decode_option(&Primitive::ALL, "primitive", input)?,
                role: decode_option(&Role::ALL, "role", input)?,
                phase: decode_enum(&Phase::ALL, "phase", input)?,
                fault: decode_enum(&Fault::ALL, "fault", input)?,
                waypoint: input.u16()?,
                heading_error: input.f64()?,
                distance: input.f64()?,
                slot_tangential: input.f64()?,
                slot_gap: input.f64()?,
                slot_heading: input.f64()?,
            },
        })
    }
}

impl<'a> Message<'a> for Memory<'a> {
    const SCHEMA: Schema =
        Schema { name: "cohaul_msgs/msg/Memory", text: include_str!("../../../msg/msg/Memory.msg"), dependencies: &[] };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.i64(self.time.nanos());
        out.u16(self.robot.0);
        out.string(self.json);
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        Ok(Self { time: Time::from_nanos(input.i64()?), robot: RobotId(input.u16()?), json: input.string()? })
    }
}

impl Message<'_> for LoadState {
    const SCHEMA: Schema = Schema {
        name: "cohaul_msgs/msg/LoadState",
        text: include_str!("../../../msg/msg/LoadState.msg"),
        dependencies: &[POSE2, TWIST2],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.i64(self.time.nanos());
        out.u16(self.load.0);
        encode_pose(&self.world_from_load, out);
        encode_twist(&self.twist_in_world, out);
    }

    fn decode(input: &mut Decoder<'_>) -> Result<Self, CdrError> {
        Ok(Self {
            time: Time::from_nanos(input.i64()?),
            load: LoadId(input.u16()?),
            world_from_load: decode_pose(input)?,
            twist_in_world: decode_twist(input)?,
        })
    }
}

impl Message<'_> for RobotState {
    const SCHEMA: Schema = Schema {
        name: "cohaul_msgs/msg/RobotState",
        text: include_str!("../../../msg/msg/RobotState.msg"),
        dependencies: &[POSE2],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.i64(self.time.nanos());
        out.u16(self.robot.0);
        encode_pose(&self.world_from_robot, out);
        out.f64(self.speeds.linear);
        out.f64(self.speeds.lateral);
        out.f64(self.speeds.angular);
        out.f64(self.traction);
    }

    fn decode(input: &mut Decoder<'_>) -> Result<Self, CdrError> {
        Ok(Self {
            time: Time::from_nanos(input.i64()?),
            robot: RobotId(input.u16()?),
            world_from_robot: decode_pose(input)?,
            speeds: decode_command(input)?,
            traction: input.f64()?,
        })
    }
}

impl<'a> Message<'a> for Outcome<'a> {
    const SCHEMA: Schema = Schema {
        name: "cohaul_msgs/msg/Outcome",
        text: include_str!("../../../msg/msg/Outcome.msg"),
        dependencies: &[],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.i64(self.time.nanos());
        out.string(self.json);
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        Ok(Self { time: Time::from_nanos(input.i64()?), json: input.string()? })
    }
}
