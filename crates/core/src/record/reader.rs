//! Reads a log.

use std::collections::BTreeMap;
use std::io::Read;
use std::sync::Arc;

use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::chunk::{self, PREFIX};
use super::header::{Header, METADATA};
use super::message::Message;
use super::message::cohaul::{Decided, LoadState, Memory, Outcome, RobotState};
use super::writer::MESSAGE_ENCODING;
use super::{RECORD_LIMIT, RecordError};
use crate::control::Observation;
use crate::id::RobotId;
use crate::time::Time;

/// One record of a log.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Record {
    /// What the log says about its run; the first record.
    Metadata(Header),
    /// What a controller saw.
    Observation(Observation),
    /// What it decided.
    Decision(Decided),
    /// What it remembered, at the start and at each reset.
    Memory {
        /// When.
        time: Time,
        /// Which robot.
        robot: RobotId,
        /// The memory, for [`crate::control::Step::restore`].
        json: String,
    },
    /// True state of a load.
    LoadState(LoadState),
    /// True state of a robot.
    RobotState(RobotState),
    /// How the episode ended.
    Outcome {
        /// When.
        time: Time,
        /// The result as JSON.
        json: String,
    },
    /// A message of another type.
    Other {
        /// Its topic.
        topic: Arc<str>,
        /// Length of its payload, bytes.
        len: usize,
    },
}

/// Reads a log from its start to its end, in the order of writing.
///
/// Only what passes its checksums comes out; the first error ends the iteration. The end of the file is checked too: an
/// unfinished log gives [`RecordError::Unfinished`] after its last whole chunk.
pub struct LogReader<R> {
    input: R,
    framing: LinearReader,
    channels: Channels,
    /// Records of the chunk under way.
    records: Vec<u8>,
    /// How many bytes of them are done.
    done: usize,
    position: Position,
    started: bool,
    in_data: bool,
    ended: bool,
}

/// Where an error is.
#[derive(Clone, Copy)]
pub(super) struct Position {
    /// Start of the record under way in the file, bytes.
    pub byte: u64,
    /// Start of the next one.
    pub next: u64,
    /// Messages given so far.
    pub messages: u64,
}

impl Position {
    fn damaged(self, what: impl Into<String>) -> RecordError {
        RecordError::Damaged { byte: self.byte, messages: self.messages, what: what.into() }
    }
}

impl<R: Read> LogReader<R> {
    /// Reads from `input`; a file wants a [`std::io::BufReader`] around it.
    pub fn new(input: R) -> Self {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_record_length_limit(RECORD_LIMIT);
        let start = mcap::MAGIC.len() as u64;
        Self {
            input,
            framing: LinearReader::new_with_options(options),
            channels: Channels::default(),
            records: Vec::new(),
            done: 0,
            position: Position { byte: 0, next: start, messages: 0 },
            started: false,
            in_data: true,
            ended: false,
        }
    }

    /// The next record, or `None` after the footer.
    fn read(&mut self) -> Result<Option<Record>, RecordError> {
        loop {
            while let Some((opcode, body)) = self.next_in_chunk()? {
                let body = self.records.get(body).unwrap_or_default();
                if let Some(record) = self.channels.record(opcode, body, &mut self.position)? {
                    return Ok(Some(record));
                }
            }
            match self.framing.next_event() {
                None => return Ok(None),
                Some(Ok(LinearReadEvent::ReadRequest(need))) => {
                    let space = self.framing.insert(need);
                    let read = retry(|| self.input.read(space))?;
                    self.framing.notify_read(read);
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    self.started = true;
                    self.position.byte = self.position.next;
                    self.position.next += (PREFIX + data.len()) as u64;
                    match opcode {
                        op::DATA_END => self.in_data = false,
                        op::CHUNK if self.in_data => {
                            chunk::unpack(data, &mut self.records).map_err(|what| self.position.damaged(what))?;
                            self.done = 0;
                        }
                        // behind the data stand copies of the schemas and channels
                        _ if !self.in_data => {}
                        _ => {
                            if let Some(record) = self.channels.record(opcode, data, &mut self.position)? {
                                return Ok(Some(record));
                            }
                        }
                    }
                }
                Some(Err(error)) => return Err(self.explain(&error)),
            }
        }
    }

    /// The next record of the chunk under way: its opcode and where its body stands.
    fn next_in_chunk(&mut self) -> Result<Option<(u8, std::ops::Range<usize>)>, RecordError> {
        let mut rest = self.records.get(self.done..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(None);
        }
        let (opcode, body) = chunk::split(&mut rest).ok_or_else(|| self.position.damaged("chunk ends in a record"))?;
        self.done = self.records.len() - rest.len();
        Ok(Some((opcode, self.done - body.len()..self.done)))
    }

    fn explain(&self, error: &McapError) -> RecordError {
        let Position { next: byte, messages, .. } = self.position;
        match error {
            McapError::BadMagic if !self.started => RecordError::NotALog,
            McapError::UnexpectedEof if !self.started => RecordError::NotALog,
            McapError::UnexpectedEof => RecordError::Unfinished { byte, messages },
            error => RecordError::Damaged { byte, messages, what: describe(error) },
        }
    }
}

/// Error texts of the library start with a capital and hide their cause.
fn describe(error: &McapError) -> String {
    match error {
        McapError::BadMagic => "the magic number at the end is wrong".into(),
        McapError::BadDataCrc { saved, calculated } => {
            format!("checksum of the data is {calculated:08x} instead of {saved:08x}")
        }
        McapError::BadSummaryCrc { saved, calculated } => {
            format!("checksum of the summary is {calculated:08x} instead of {saved:08x}")
        }
        McapError::RecordTooLarge { len, .. } | McapError::ChunkTooLarge(len) => {
            format!("a record claims {len} bytes")
        }
        other => other.to_string().to_lowercase(),
    }
}

fn retry(mut read: impl FnMut() -> std::io::Result<usize>) -> std::io::Result<usize> {
    loop {
        match read() {
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            other => return other,
        }
    }
}

impl<R: Read> Iterator for LogReader<R> {
    type Item = Result<Record, RecordError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let item = self.read().transpose();
        self.ended = !matches!(item, Some(Ok(_)));
        item
    }
}

/// What the payloads of a channel are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Observation,
    Decision,
    Memory,
    LoadState,
    RobotState,
    Outcome,
    Other,
}

impl Kind {
    fn of(schema: &str, encoding: &str) -> Self {
        if encoding != MESSAGE_ENCODING {
            return Self::Other;
        }
        match schema {
            name if name == Observation::SCHEMA.name => Self::Observation,
            name if name == Decided::SCHEMA.name => Self::Decision,
            name if name == Memory::SCHEMA.name => Self::Memory,
            name if name == LoadState::SCHEMA.name => Self::LoadState,
            name if name == RobotState::SCHEMA.name => Self::RobotState,
            name if name == Outcome::SCHEMA.name => Self::Outcome,
            _ => Self::Other,
        }
    }
}

/// Schemas and channels met so far.
#[derive(Default)]
pub(super) struct Channels {
    schemas: BTreeMap<u16, String>,
    topics: BTreeMap<u16, (Arc<str>, Kind)>,
}

impl Channels {
    /// Notes a channel.
    pub fn declare(&mut self, id: u16, topic: Arc<str>, schema: &str, encoding: &str) {
        self.topics.insert(id, (topic, Kind::of(schema, encoding)));
    }

    /// What a record says, if it is for the caller.
    pub fn record(&mut self, opcode: u8, body: &[u8], position: &mut Position) -> Result<Option<Record>, RecordError> {
        match opcode {
            op::MESSAGE => return self.message(body, position).map(Some),
            op::SCHEMA | op::CHANNEL | op::METADATA => {}
            _ => return Ok(None),
        }
        match chunk::parse(opcode, body).ok_or_else(|| position.damaged("a definition does not parse"))? {
            mcap::records::Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            mcap::records::Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                self.declare(channel.id, channel.topic.into(), &schema, &channel.message_encoding);
            }
            mcap::records::Record::Metadata(record) if record.name == METADATA => {
                return Header::from_metadata(record.metadata).map(|header| Some(Record::Metadata(header)));
            }
            _ => {}
        }
        Ok(None)
    }

    fn message(&self, body: &[u8], position: &mut Position) -> Result<Record, RecordError> {
        let (header, payload) = chunk::message(body).ok_or_else(|| position.damaged("a message ends in its header"))?;
        let (topic, kind) = self
            .topics
            .get(&header.channel_id)
            .ok_or_else(|| position.damaged(format!("channel {} is not declared", header.channel_id)))?;
        let decoded = match kind {
            Kind::Observation => Observation::from_cdr(payload).map(Record::Observation),
            Kind::Decision => Decided::from_cdr(payload).map(Record::Decision),
            Kind::Memory => Memory::from_cdr(payload).map(|Memory { time, robot, json }| Record::Memory {
                time,
                robot,
                json: json.to_owned(),
            }),
            Kind::LoadState => LoadState::from_cdr(payload).map(Record::LoadState),
            Kind::RobotState => RobotState::from_cdr(payload).map(Record::RobotState),
            Kind::Outcome => {
                Outcome::from_cdr(payload).map(|Outcome { time, json }| Record::Outcome { time, json: json.to_owned() })
            }
            Kind::Other => Ok(Record::Other { topic: topic.clone(), len: payload.len() }),
        };
        let record = decoded.map_err(|source| RecordError::Message {
            message: position.messages,
            topic: topic.as_ref().to_owned(),
            byte: position.byte,
            source,
        })?;
        position.messages += 1;
        Ok(record)
    }
}
