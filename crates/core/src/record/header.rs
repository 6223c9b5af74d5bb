//! What a log says about its run, and the topics that follow from it.

use std::collections::{BTreeMap, BTreeSet};

use super::RecordError;
use super::message::{Message, Schema, cohaul, standard};
use crate::control::Observation;
use crate::id::{LoadId, RobotId};

/// Name of the metadata record.
pub(super) const METADATA: &str = "cohaul";

/// What alone reproduces a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Header {
    /// Name of the scenario.
    pub scenario_name: String,
    /// Its full text.
    pub scenario_text: String,
    /// Seed of every generator.
    pub seed: u64,
    /// World simulated: `kinematic`, `planar`, `spatial`; `real` for robots.
    pub world: String,
    /// Version of cohaul.
    pub version: String,
    /// Its git revision.
    pub revision: String,
    /// Names of the robots, in the order of their ids: they head the robots' topics and frames.
    pub robots: Vec<String>,
    /// Names of the loads, in the order of their ids.
    pub loads: Vec<String>,
}

/// One topic of a log; its channel id is its place in the list, counted from 1.
pub(super) struct Topic {
    pub name: String,
    pub schema: Schema,
    /// Depth and durability offered, as a ROS 2 publisher of it would.
    pub latched: bool,
}

pub(super) const TF: u16 = 1;
pub(super) const MARKERS: u16 = 2;
pub(super) const OUTCOME: u16 = 3;
const FIRST_ROBOT: u16 = 4;

/// Topics of one robot, in the order of their channels.
#[derive(Clone, Copy)]
pub(super) enum RobotTopic {
    Observation,
    Decision,
    CmdVel,
    Memory,
    State,
    Pose,
}
const ROBOT_TOPICS: u16 = 6;

/// Topics of one load, in the order of their channels.
#[derive(Clone, Copy)]
pub(super) enum LoadTopic {
    State,
    Pose,
}
const LOAD_TOPICS: u16 = 2;

impl Header {
    /// Channel of a robot's topic.
    pub(super) fn robot_channel(&self, robot: RobotId, topic: RobotTopic) -> Result<u16, RecordError> {
        if robot.index() < self.robots.len() {
            Ok(FIRST_ROBOT + ROBOT_TOPICS * robot.0 + topic as u16)
        } else {
            Err(RecordError::UnknownRobot { robot, known: self.robots.len() })
        }
    }

    /// Channel of a load's topic.
    pub(super) fn load_channel(&self, load: LoadId, topic: LoadTopic) -> Result<u16, RecordError> {
        if load.index() < self.loads.len() {
            Ok(FIRST_ROBOT + ROBOT_TOPICS * self.robots.len() as u16 + LOAD_TOPICS * load.0 + topic as u16)
        } else {
            Err(RecordError::UnknownLoad { load, known: self.loads.len() })
        }
    }

    /// Every topic of the log, in the order of the channel ids.
    pub(super) fn topics(&self) -> Result<Vec<Topic>, RecordError> {
        let count = usize::from(FIRST_ROBOT - 1)
            + usize::from(ROBOT_TOPICS) * self.robots.len()
            + usize::from(LOAD_TOPICS) * self.loads.len();
        if count > usize::from(u16::MAX) {
            return Err(RecordError::TooManyTopics { topics: count, limit: usize::from(u16::MAX) });
        }
        let mut topics = Vec::with_capacity(count);
        let mut add = |name: String, schema, latched| topics.push(Topic { name, schema, latched });
        add("/tf".into(), standard::TfMessage::SCHEMA, false);
        add("/cohaul/markers".into(), standard::MarkerArray::SCHEMA, false);
        add("/cohaul/outcome".into(), cohaul::Outcome::SCHEMA, true);
        for robot in &self.robots {
            check_name("robot", robot)?;
            add(format!("/{robot}/observation"), Observation::SCHEMA, false);
            add(format!("/{robot}/decision"), cohaul::Decided::SCHEMA, false);
            add(format!("/{robot}/cmd_vel"), standard::TwistStamped::SCHEMA, false);
            add(format!("/{robot}/memory"), cohaul::Memory::SCHEMA, true);
            add(format!("/{robot}/state"), cohaul::RobotState::SCHEMA, false);
            add(format!("/{robot}/pose"), standard::PoseStamped::SCHEMA, false);
        }
        for load in &self.loads {
            check_name("load", load)?;
            add(format!("/loads/{load}/state"), cohaul::LoadState::SCHEMA, false);
            add(format!("/loads/{load}/pose"), standard::PoseStamped::SCHEMA, false);
        }
        let mut seen = BTreeSet::new();
        match topics.iter().find(|topic| !seen.insert(&topic.name)) {
            Some(topic) => Err(RecordError::DuplicateTopic { topic: topic.name.clone() }),
            None => Ok(topics),
        }
    }

    /// As a metadata record.
    pub(super) fn to_metadata(&self) -> BTreeMap<String, String> {
        let mut metadata: BTreeMap<String, String> = [
            ("scenario_name", self.scenario_name.clone()),
            ("scenario_text", self.scenario_text.clone()),
            ("seed", self.seed.to_string()),
            ("world", self.world.clone()),
            ("version", self.version.clone()),
            ("revision", self.revision.clone()),
            ("robots", self.robots.join(" ")),
            ("loads", self.loads.join(" ")),
        ]
        .map(|(key, value)| (key.to_owned(), value))
        .into();
        metadata.insert(DIGEST.into(), digest(&metadata));
        metadata
    }

    /// From a metadata record.
    pub(super) fn from_metadata(mut metadata: BTreeMap<String, String>) -> Result<Self, RecordError> {
        let mut take =
            |key: &str| metadata.remove(key).ok_or_else(|| RecordError::Metadata { problem: format!("lacks {key}") });
        let saved = take(DIGEST)?;
        let header = Self {
            scenario_name: take("scenario_name")?,
            scenario_text: take("scenario_text")?,
            seed: {
                let seed = take("seed")?;
                seed.parse().map_err(|_| RecordError::Metadata { problem: format!("has the seed {seed:?}") })?
            },
            world: take("world")?,
            version: take("version")?,
            revision: take("revision")?,
            robots: take("robots")?.split_whitespace().map(str::to_owned).collect(),
            loads: take("loads")?.split_whitespace().map(str::to_owned).collect(),
        };
        let calculated = header.to_metadata().remove(DIGEST);
        if calculated.as_ref() == Some(&saved) {
            Ok(header)
        } else {
            Err(RecordError::Metadata { problem: "does not match its checksum".into() })
        }
    }
}

const DIGEST: &str = "crc32";

/// Checksum of keys and values: MCAP has none for metadata.
fn digest(metadata: &BTreeMap<String, String>) -> String {
    let mut hasher = crc32fast::Hasher::new();
    for (key, value) in metadata {
        hasher.update(key.as_bytes());
        hasher.update(&(value.len() as u64).to_le_bytes());
        hasher.update(value.as_bytes());
    }
    format!("{:08x}", hasher.finalize())
}

fn check_name(kind: &'static str, name: &str) -> Result<(), RecordError> {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    if name.starts_with(letter) && name.chars().all(|c| letter(c) || c.is_ascii_digit()) {
        Ok(())
    } else {
        Err(RecordError::Name { kind, name: name.to_owned() })
    }
}
