//! Why a log could not be written or read.

use super::cdr::CdrError;
use crate::id::{LoadId, RobotId};

/// Why a log could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A robot or load has a name that no ROS 2 topic can carry.
    #[error("{kind} name {name:?} is not a letter or underscore followed by letters, digits and underscores")]
    Name {
        /// `robot` or `load`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Two topics would have the same name.
    #[error("two channels of the log would be named {topic}")]
    DuplicateTopic {
        /// The topic.
        topic: String,
    },
    /// More robots and loads than a log has channels for.
    #[error("{topics} topics exceed the {limit} of a log")]
    TooManyTopics {
        /// Topics needed.
        topics: usize,
        /// Topics possible.
        limit: usize,
    },
    /// The header names fewer robots.
    #[error("robot {robot} is not among the {known} robots of the log")]
    UnknownRobot {
        /// The robot.
        robot: RobotId,
        /// Robots in the header.
        known: usize,
    },
    /// The header names fewer loads.
    #[error("load {load} is not among the {known} loads of the log")]
    UnknownLoad {
        /// The load.
        load: LoadId,
        /// Loads in the header.
        known: usize,
    },
    /// A text or message is longer than a reader would accept.
    #[error("{what} of {len} bytes exceeds the limit of {limit} bytes")]
    TooLong {
        /// What it is.
        what: &'static str,
        /// Its length, bytes.
        len: usize,
        /// Longest allowed, bytes.
        limit: usize,
    },
    /// The stream failed.
    #[error("log could not be read or written")]
    Io(#[from] std::io::Error),
    /// The file is not MCAP, or its first bytes are damaged.
    #[error("not an MCAP file: its first 8 bytes are not the magic number")]
    NotALog,
    /// The file ends before its footer: its writer did not finish.
    #[error(
        "log is unfinished: it ends at byte {byte} inside a record, after {messages} messages; `cohaul recover` makes a \
         valid file of them"
    )]
    Unfinished {
        /// Where the unfinished record starts.
        byte: u64,
        /// Messages read before.
        messages: u64,
    },
    /// The bytes are not what they were when written.
    #[error(
        "log is damaged at byte {byte}, after {messages} messages: {what}; `cohaul recover` makes a valid file of the rest"
    )]
    Damaged {
        /// Where the damaged record starts.
        byte: u64,
        /// Messages read before.
        messages: u64,
        /// What is wrong.
        what: String,
    },
    /// A message does not match its type.
    #[error(
        "message {message} of the log, on {topic}, in the chunk at byte {byte}, is not valid; `cohaul recover` leaves it out"
    )]
    Message {
        /// Its place among the messages of the log, counted from 0.
        message: u64,
        /// Its topic.
        topic: String,
        /// Where its chunk starts.
        byte: u64,
        /// What is wrong.
        source: CdrError,
    },
    /// The metadata record `cohaul` is absent or misses a field.
    #[error("metadata record `cohaul` of the log {problem}")]
    Metadata {
        /// What is wrong with it.
        problem: String,
    },
    /// Nothing before the damage could be read.
    #[error("nothing can be recovered: no chunk of the {bytes} bytes is whole")]
    NothingLeft {
        /// Length of the input.
        bytes: u64,
    },
}
