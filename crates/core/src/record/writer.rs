//! Writes a log.

use std::collections::BTreeMap;
use std::io::Write;

use mcap::records::MessageHeader;

use super::RecordError;
use super::cdr::Encoder;
use super::container::Container;
use super::header::{self, Header, LoadTopic, RobotTopic, Topic};
use super::marker::{self, Marker};
use super::message::Message;
use super::message::cohaul::{Decided, LoadState, Memory, Outcome, RobotState};
use super::message::standard::{self, PoseStamped, TransformStamped, TwistStamped};
use crate::control::{Command, Decision, Observation};
use crate::id::{LoadId, RobotId};
use crate::se2::{Pose2, Twist2};
use crate::time::Time;

/// Messages after which a chunk ends and the stream is flushed: what a killed process loses at most.
pub const FLUSH_EVERY: u32 = 64;

/// Frame of the world.
pub(super) const MAP: &str = "map";

/// Name of the attachment that holds the scenario text.
const SCENARIO_FILE: &str = "scenario.yaml";

/// Writes one log. The same calls give the same bytes.
///
/// The stream is flushed every [`FLUSH_EVERY`] messages and at [`LogWriter::flush`]. Bytes arrive whole chunks at a time, so
/// a buffer around a file gains nothing. A writer that is dropped still finishes the file, but tells nobody
/// when that fails.
///
/// ```
/// # use cohaul_core::{id::RobotId, record::{Header, LogReader, LogWriter, Record}, time::Time};
/// let header = Header { robots: vec!["r0".into()], ..Header::default() };
/// let mut writer = LogWriter::new(Vec::new(), &header)?;
/// writer.memory(Time::ZERO, RobotId(0), "{}")?;
/// let log = writer.finish()?;
///
/// let records: Vec<Record> = LogReader::new(log.as_slice()).collect::<Result<_, _>>()?;
/// assert_eq!(records[0], Record::Metadata(header));
/// assert!(matches!(&records[1], Record::Memory { robot: RobotId(0), json, .. } if json == "{}"));
/// # Ok::<(), cohaul_core::record::RecordError>(())
/// ```
pub struct LogWriter<W: Write> {
    file: Container<W>,
    header: Header,
    robot_frames: Vec<String>,
    load_frames: Vec<String>,
    messages: u64,
    unflushed: u32,
}

impl<W: Write> LogWriter<W> {
    /// Starts a log: header, metadata, scenario text and channels are in `output` when it returns.
    ///
    /// # Errors
    /// If names are unfit for ROS 2 topics or the stream fails.
    pub fn new(output: W, header: &Header) -> Result<Self, RecordError> {
        let topics = header.topics()?;
        let mut file = Container::new(output)?;
        write_front(&mut file, header, &topics)?;
        file.flush()?;
        Ok(Self {
            file,
            header: header.clone(),
            robot_frames: header.robots.iter().map(|name| format!("{name}/base_footprint")).collect(),
            load_frames: header.loads.iter().map(|name| format!("load_{name}")).collect(),
            messages: 0,
            unflushed: 0,
        })
    }

    /// What one robot saw and decided: its observation, its decision and the command as `cmd_vel`.
    ///
    /// # Errors
    /// If the robot is unknown or the stream fails.
    pub fn decision(&mut self, observation: &Observation, decision: &Decision) -> Result<(), RecordError> {
        let (time, robot) = (observation.time, observation.robot);
        self.message(self.header.robot_channel(robot, RobotTopic::Observation)?, time, observation)?;
        let decided = Decided { time, robot, decision: *decision };
        self.message(self.header.robot_channel(robot, RobotTopic::Decision)?, time, &decided)?;
        self.write(self.header.robot_channel(robot, RobotTopic::CmdVel)?, time, |frames, out| {
            let header = standard::Header { stamp: time.into(), frame_id: frames.robot(robot) };
            let Command { linear, lateral, angular } = decision.command;
            TwistStamped { header, linear: [linear, lateral, 0.0], angular: [0.0, 0.0, angular] }.encode(out);
        })
    }

    /// What a controller remembers, as [`crate::control::Step::memory`] gives it: at the start and at each reset.
    ///
    /// # Errors
    /// If the robot is unknown or the stream fails.
    pub fn memory(&mut self, time: Time, robot: RobotId, json: &str) -> Result<(), RecordError> {
        let channel = self.header.robot_channel(robot, RobotTopic::Memory)?;
        self.message(channel, time, &Memory { time, robot, json })
    }

    /// True state of a load; its twist is that of its centre in the world frame.
    ///
    /// # Errors
    /// If the load is unknown or the stream fails.
    pub fn load_state(
        &mut self,
        time: Time,
        load: LoadId,
        world_from_load: &Pose2,
        twist_in_world: &Twist2,
    ) -> Result<(), RecordError> {
        let state = LoadState { time, load, world_from_load: *world_from_load, twist_in_world: *twist_in_world };
        self.message(self.header.load_channel(load, LoadTopic::State)?, time, &state)?;
        self.pose(self.header.load_channel(load, LoadTopic::Pose)?, time, world_from_load)
    }

    /// True state of a robot: pose, speeds and the force of its wheels along its heading, N.
    ///
    /// # Errors
    /// If the robot is unknown or the stream fails.
    pub fn robot_state(
        &mut self,
        time: Time,
        robot: RobotId,
        world_from_robot: &Pose2,
        speeds: Command,
        traction: f64,
    ) -> Result<(), RecordError> {
        let state = RobotState { time, robot, world_from_robot: *world_from_robot, speeds, traction };
        self.message(self.header.robot_channel(robot, RobotTopic::State)?, time, &state)?;
        self.pose(self.header.robot_channel(robot, RobotTopic::Pose)?, time, world_from_robot)
    }

    /// Poses of robots and loads at one instant, for tools that follow frames.
    ///
    /// # Errors
    /// If a robot or load is unknown or the stream fails.
    pub fn transforms(
        &mut self,
        time: Time,
        robots: &[(RobotId, Pose2)],
        loads: &[(LoadId, Pose2)],
    ) -> Result<(), RecordError> {
        for (robot, _) in robots {
            self.header.robot_channel(*robot, RobotTopic::Pose)?;
        }
        for (load, _) in loads {
            self.header.load_channel(*load, LoadTopic::Pose)?;
        }
        self.write(header::TF, time, |frames, out| {
            let header = standard::Header { stamp: time.into(), frame_id: MAP };
            out.sequence(robots.len() + loads.len());
            for (robot, pose) in robots {
                TransformStamped::new(header, frames.robot(*robot), pose).encode(out);
            }
            for (load, pose) in loads {
                TransformStamped::new(header, frames.load(*load), pose).encode(out);
            }
        })
    }

    /// Shapes to draw.
    ///
    /// # Errors
    /// If the stream fails.
    pub fn markers(&mut self, time: Time, markers: &[Marker<'_>]) -> Result<(), RecordError> {
        self.write(header::MARKERS, time, |_, out| marker::encode(time, markers, out))
    }

    /// How the episode ended, as JSON.
    ///
    /// # Errors
    /// If the stream fails.
    pub fn outcome(&mut self, time: Time, json: &str) -> Result<(), RecordError> {
        self.message(header::OUTCOME, time, &Outcome { time, json })
    }

    /// Messages written so far.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// Hands every message so far to the stream and flushes it: for a robot that logs slowly, on a timer.
    ///
    /// # Errors
    /// If the stream fails.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.unflushed = 0;
        self.file.flush()
    }

    /// Writes indexes, summary and footer, and gives the stream back, flushed.
    ///
    /// # Errors
    /// If the stream fails.
    pub fn finish(self) -> Result<W, RecordError> {
        self.file.finish()
    }

    /// The stream as a killed process leaves it.
    #[cfg(test)]
    pub(super) fn into_unfinished(self) -> W {
        self.file.into_unfinished().unwrap()
    }

    fn pose(&mut self, channel: u16, time: Time, pose: &Pose2) -> Result<(), RecordError> {
        let header = standard::Header { stamp: time.into(), frame_id: MAP };
        self.message(channel, time, &PoseStamped::new(header, pose))
    }

    fn message<'a>(&mut self, channel: u16, time: Time, message: &impl Message<'a>) -> Result<(), RecordError> {
        self.write(channel, time, |_, out| message.encode(out))
    }

    fn write(
        &mut self,
        channel_id: u16,
        time: Time,
        encode: impl FnOnce(Frames<'_>, &mut Encoder<'_>),
    ) -> Result<(), RecordError> {
        // MCAP has no instants before its origin
        let log_time = u64::try_from(time.nanos()).unwrap_or(0);
        // the place in the log, so that gaps tell what is missing
        let sequence = self.messages as u32;
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        let frames = Frames { robots: &self.robot_frames, loads: &self.load_frames };
        self.file.message(&header, |out| encode(frames, &mut Encoder::new(out)))?;
        self.messages += 1;
        self.unflushed += 1;
        if self.unflushed >= FLUSH_EVERY { self.flush() } else { Ok(()) }
    }
}

/// Frame names, kept so that no message allocates its own.
#[derive(Clone, Copy)]
struct Frames<'a> {
    robots: &'a [String],
    loads: &'a [String],
}

impl<'a> Frames<'a> {
    fn robot(&self, robot: RobotId) -> &'a str {
        self.robots.get(robot.index()).map_or("", String::as_str)
    }

    fn load(&self, load: LoadId) -> &'a str {
        self.loads.get(load.index()).map_or("", String::as_str)
    }
}

const SCHEMA_ENCODING: &str = "ros2msg";
pub(super) const MESSAGE_ENCODING: &str = "cdr";

/// Writes everything in front of the messages; gives the channels of `topics`.
pub(super) fn write_front<W: Write>(
    file: &mut Container<W>,
    header: &Header,
    topics: &[Topic],
) -> Result<Vec<u16>, RecordError> {
    file.metadata(header::METADATA, &header.to_metadata())?;
    file.attachment(SCENARIO_FILE, "application/yaml", header.scenario_text.as_bytes())?;
    let mut channels = Vec::with_capacity(topics.len());
    for topic in topics {
        let text = topic.schema.concatenated();
        let schema = file.schema(topic.schema.name, SCHEMA_ENCODING, text.as_bytes())?;
        channels.push(file.channel(schema, &topic.name, MESSAGE_ENCODING, &channel_metadata(topic.latched))?);
    }
    Ok(channels)
}

/// Quality of service a publisher of the topic offers, as rosbag2 keeps it: reliable, volatile or transient local.
fn channel_metadata(latched: bool) -> BTreeMap<String, String> {
    let (depth, durability) = if latched { (1, 1) } else { (10, 2) };
    let forever = "\n    sec: 9223372036\n    nsec: 854775807";
    let profile = format!(
        "- history: 1\n  depth: {depth}\n  reliability: 1\n  durability: {durability}\n  deadline:{forever}\n  \
         lifespan:{forever}\n  liveliness: 1\n  liveliness_lease_duration:{forever}\n  \
         avoid_ros_namespace_conventions: false"
    );
    BTreeMap::from([("offered_qos_profiles".to_owned(), profile)])
}
