//! Makes a valid log of an unfinished or damaged one.
//!
//! Records are taken in order while their framing holds. Behind damage the search goes on for the next chunk: the two
//! lengths in its header must agree and its checksum must hold, so nothing else is taken for one.

use std::collections::BTreeMap;
use std::io::{Read, Write};

use mcap::records::{MessageHeader, Metadata, Record as Raw, op};

use super::chunk::{self, PREFIX};
use super::container::Container;
use super::header::{Header, METADATA};
use super::reader::{Channels, Position};
use super::writer::{MESSAGE_ENCODING, write_front};
use super::{RECORD_LIMIT, RecordError};

/// What [`recover`] saved.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recovered {
    /// What the log says about its run, if that was readable.
    pub header: Option<Header>,
    /// Messages saved.
    pub messages: u64,
    /// Messages known to be missing between those saved. What an unfinished file lost at its end nobody knows: fewer than
    /// [`FLUSH_EVERY`](super::FLUSH_EVERY).
    pub missing: u64,
    /// Bytes passed over in search of the next chunk.
    pub skipped_bytes: u64,
    /// What was wrong first; `None` if the log was whole.
    pub lost_reason: Option<String>,
}

/// Copies all that can be read from `input` into a valid log.
///
/// Scenario, seed and topics come from the metadata at the front of the file; without them the messages still do if their
/// channel definitions survived.
///
/// # Errors
/// If a stream fails, or nothing at all can be read.
///
/// ```
/// # use cohaul_core::record::{recover, Header, LogReader, LogWriter};
/// let mut log = LogWriter::new(Vec::new(), &Header::default())?.finish()?;
/// log.truncate(log.len() - 20);
/// let mut saved = Vec::new();
/// let report = recover(log.as_slice(), &mut saved)?;
/// assert_eq!(report.header, Some(Header::default()));
/// assert!(LogReader::new(saved.as_slice()).all(|record| record.is_ok()));
/// # Ok::<(), cohaul_core::record::RecordError>(())
/// ```
pub fn recover(input: impl Read, output: impl Write) -> Result<Recovered, RecordError> {
    let mut window = Window::new(input);
    let mut copy = Copy::new(output)?;
    let mut records = Vec::new();
    if window.fill(mcap::MAGIC.len())? && window.unread().starts_with(mcap::MAGIC) {
        window.consume(mcap::MAGIC.len());
    } else {
        copy.lost(0, "the magic number at the start is wrong");
        copy.report.skipped_bytes += window.seek_chunk()?;
    }
    loop {
        copy.position.byte = window.offset;
        let what = match window.record()? {
            Framed::End => {
                copy.lost(window.offset, "the file ends without a footer");
                break;
            }
            Framed::Cut => "the file ends inside a record, or the length of a record is wrong".into(),
            Framed::Broken => "no record starts here".into(),
            Framed::Record(op::DATA_END, _) => break,
            Framed::Record(op::CHUNK, body) => match chunk::unpack(body, &mut records) {
                Ok(()) => {
                    let len = PREFIX + body.len();
                    let mut rest = records.as_slice();
                    while let Some((opcode, body)) = chunk::split(&mut rest) {
                        copy.keep(opcode, body)?;
                    }
                    // chunk by chunk: a whole log comes out as it was, byte for byte
                    copy.file.flush()?;
                    window.consume(len);
                    continue;
                }
                Err(what) => what,
            },
            Framed::Record(opcode, body) => {
                let len = PREFIX + body.len();
                copy.keep(opcode, body)?;
                window.consume(len);
                continue;
            }
        };
        copy.lost(window.offset, &what);
        copy.report.skipped_bytes += window.seek_chunk()?;
    }
    copy.finish(window.offset)
}

/// The log under construction.
struct Copy<W: Write> {
    file: Container<W>,
    definitions: Channels,
    position: Position,
    /// Name, encoding and text of the input's schemas.
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    /// Channel of the output by channel of the input.
    channels: BTreeMap<u16, u16>,
    next_sequence: u32,
    report: Recovered,
}

impl<W: Write> Copy<W> {
    fn new(output: W) -> Result<Self, RecordError> {
        Ok(Self {
            file: Container::new(output)?,
            definitions: Channels::default(),
            position: Position { byte: 0, next: 0, messages: 0 },
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            next_sequence: 0,
            report: Recovered::default(),
        })
    }

    fn lost(&mut self, byte: u64, what: &str) {
        self.report.lost_reason.get_or_insert_with(|| format!("at byte {byte}: {what}"));
    }

    /// Copies a record; one that cannot be copied is lost, unless it is the stream that fails.
    fn keep(&mut self, opcode: u8, body: &[u8]) -> Result<(), RecordError> {
        match self.record(opcode, body) {
            Ok(()) => Ok(()),
            Err(RecordError::Io(error)) => Err(error.into()),
            Err(error) => {
                self.lost(self.position.byte, &error.to_string());
                Ok(())
            }
        }
    }

    fn record(&mut self, opcode: u8, body: &[u8]) -> Result<(), RecordError> {
        if opcode == op::MESSAGE {
            return self.message(body);
        }
        match chunk::parse(opcode, body) {
            Some(Raw::Metadata(metadata)) => self.metadata(metadata),
            Some(Raw::Schema { header, data }) => {
                self.definitions.record(opcode, body, &mut self.position)?;
                self.schemas.insert(header.id, (header.name, header.encoding, data.into_owned()));
                Ok(())
            }
            Some(Raw::Channel(channel)) => {
                let schema = match self.schemas.get(&channel.schema_id) {
                    Some((name, encoding, text)) => self.file.schema(name, encoding, text)?,
                    None => 0,
                };
                self.definitions.record(opcode, body, &mut self.position)?;
                let id = self.file.channel(schema, &channel.topic, &channel.message_encoding, &channel.metadata)?;
                self.channels.insert(channel.id, id);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn metadata(&mut self, metadata: Metadata) -> Result<(), RecordError> {
        if metadata.name != METADATA {
            return self.file.metadata(&metadata.name, &metadata.metadata);
        }
        let header = Header::from_metadata(metadata.metadata)?;
        if self.report.header.is_some() {
            return Ok(());
        }
        // the definitions too, in case the chunk with them is lost
        let topics = header.topics()?;
        let channels = write_front(&mut self.file, &header, &topics)?;
        for ((id, topic), channel) in (1..).zip(topics).zip(channels) {
            self.channels.insert(id, channel);
            self.definitions.declare(id, topic.name.into(), topic.schema.name, MESSAGE_ENCODING);
        }
        self.report.header = Some(header);
        Ok(())
    }

    fn message(&mut self, body: &[u8]) -> Result<(), RecordError> {
        // only what the reader will understand
        self.definitions.record(op::MESSAGE, body, &mut self.position)?;
        let Some((header, payload)) = chunk::message(body) else { return Ok(()) };
        let Some(channel_id) = self.channels.get(&header.channel_id).copied() else { return Ok(()) };
        if self.report.header.is_some() {
            // our logs number their messages; a gap is a loss
            let gap = header.sequence.wrapping_sub(self.next_sequence);
            if gap < u32::MAX / 2 {
                self.report.missing += u64::from(gap);
                self.next_sequence = header.sequence.wrapping_add(1);
            }
        }
        self.file.message(&MessageHeader { channel_id, ..header }, |out| out.extend_from_slice(payload))?;
        self.report.messages += 1;
        Ok(())
    }

    fn finish(self, bytes: u64) -> Result<Recovered, RecordError> {
        if self.report.messages == 0 && self.report.header.is_none() {
            return Err(RecordError::NothingLeft { bytes });
        }
        let Self { file, report, .. } = self;
        file.finish()?;
        Ok(report)
    }
}

/// What stands at the front of the window.
enum Framed<'a> {
    /// A record: its opcode and body.
    Record(u8, &'a [u8]),
    /// Its length reaches beyond the input.
    Cut,
    /// Not a record.
    Broken,
    /// The end of the input.
    End,
}

/// The unread part of the input, of which never more than one record is held.
struct Window<R> {
    input: R,
    buffer: Vec<u8>,
    start: usize,
    /// Bytes consumed.
    offset: u64,
}

/// Bytes asked for at a time.
const STEP: usize = 64 << 10;

/// Fixed part of the header of a chunk compressed with lz4, and where its parts stand behind the opcode, bytes.
const CHUNK_HEADER: usize = 43;
const COMPRESSION: &[u8] = b"\x03\0\0\0lz4";
const COMPRESSION_AT: usize = PREFIX + 28;

/// Length of the body of the record that ends the data, bytes.
const DATA_END_LEN: usize = 4;

impl<R: Read> Window<R> {
    fn new(input: R) -> Self {
        Self { input, buffer: Vec::new(), start: 0, offset: 0 }
    }

    fn unread(&self) -> &[u8] {
        self.buffer.get(self.start..).unwrap_or_default()
    }

    fn consume(&mut self, len: usize) {
        let len = len.min(self.unread().len());
        self.start += len;
        self.offset += len as u64;
    }

    /// Whether at least `len` bytes are unread, after reading as many as it takes.
    fn fill(&mut self, len: usize) -> Result<bool, RecordError> {
        if self.start >= STEP {
            self.buffer.drain(..self.start);
            self.start = 0;
        }
        while self.unread().len() < len {
            let wanted = (len - self.unread().len()).max(STEP) as u64;
            if self.input.by_ref().take(wanted).read_to_end(&mut self.buffer)? == 0 {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// What stands at the front.
    fn record(&mut self) -> Result<Framed<'_>, RecordError> {
        if !self.fill(PREFIX)? {
            return Ok(if self.unread().is_empty() { Framed::End } else { Framed::Cut });
        }
        let Some((opcode, len)) = prefix(self.unread()) else { return Ok(Framed::Broken) };
        if !self.fill(PREFIX + len)? {
            return Ok(Framed::Cut);
        }
        // A chunk has a checksum. The length of any other record is believed if another one follows: a wrong length that
        // swallows chunks must not pass.
        if opcode != op::CHUNK && self.fill(PREFIX + len + PREFIX)? {
            let follows = self.unread().get(PREFIX + len..).and_then(prefix);
            if follows.is_none() || (opcode == op::DATA_END && len != DATA_END_LEN) {
                return Ok(Framed::Broken);
            }
        }
        Ok(match self.unread().get(PREFIX..PREFIX + len) {
            Some(body) => Framed::Record(opcode, body),
            None => Framed::Cut,
        })
    }

    /// Goes to the next header of a chunk behind the present place, or to the end; how many bytes that is.
    fn seek_chunk(&mut self) -> Result<u64, RecordError> {
        let from = self.offset;
        self.consume(1);
        while self.fill(PREFIX + CHUNK_HEADER)? {
            let unread = self.unread();
            let candidates = unread.windows(PREFIX + CHUNK_HEADER);
            let last = candidates.len();
            match candidates.into_iter().position(is_chunk_header) {
                Some(place) => {
                    self.consume(place);
                    return Ok(self.offset - from);
                }
                None => self.consume(last),
            }
        }
        self.consume(usize::MAX);
        Ok(self.offset - from)
    }
}

/// Opcode and length of the body, if `bytes` start like a record.
fn prefix(bytes: &[u8]) -> Option<(u8, usize)> {
    let ([opcode, len @ ..], _) = bytes.split_first_chunk::<PREFIX>()?;
    let len = usize::try_from(u64::from_le_bytes(*len)).ok()?;
    let known = matches!(*opcode, op::HEADER..=op::DATA_END | 0x80..);
    (known && len <= RECORD_LIMIT).then_some((*opcode, len))
}

/// Whether both lengths in what may be the header of a chunk agree.
fn is_chunk_header(bytes: &[u8]) -> bool {
    let number = |at: usize| bytes.get(at..).and_then(|rest| rest.first_chunk()).map(|b| u64::from_le_bytes(*b));
    bytes.first() == Some(&op::CHUNK)
        && bytes.get(COMPRESSION_AT..).is_some_and(|rest| rest.starts_with(COMPRESSION))
        && match (number(1), number(COMPRESSION_AT + COMPRESSION.len())) {
            (Some(record), Some(data)) => record == data.saturating_add(CHUNK_HEADER as u64),
            _ => false,
        }
}
