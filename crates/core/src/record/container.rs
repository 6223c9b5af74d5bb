//! Writes the MCAP container: chunks, indexes, summary.
//!
//! # Source
//! [MCAP], the records by their names there. Chunks are lz4 frames of one block [LZ4].
//!
//! The library that reads the files can write them too, field by field through a compressor and several calls of the
//! system per chunk. A simulation a thousand times faster than real time needs the same bytes for a fifth of the work: here
//! a chunk is built in memory, compressed once and handed over in one piece.
//!
//! [MCAP]: crate::_documentation::references
//! [LZ4]: crate::_documentation::references

use std::collections::BTreeMap;
use std::io::Write;

use lz4::block::CompressionMode;
use mcap::records::{MessageHeader, op};

use super::RecordError;

/// Magic number, version 1 with independent blocks and no checksums of its own, blocks up to 64 KiB, header checksum.
const SMALL_FRAME: [u8; 7] = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x40, 0x82];
/// The same with blocks up to 4 MiB: readers reserve that much.
const LARGE_FRAME: [u8; 7] = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x70, 0x73];
const SMALL_BLOCK: usize = 64 << 10;
const FRAME_END: [u8; 4] = [0; 4];
/// Set in the length of a block that is not compressed.
const STORED: u32 = 1 << 31;

/// Longest message or text, bytes.
const LIMIT: usize = 2 << 20;
/// Uncompressed size beyond which a chunk ends early, bytes; with one more message it still fits one block.
const CHUNK_LIMIT: usize = 256 << 10;

/// One MCAP file under construction.
pub(super) struct Container<W: Write> {
    /// Taken at the end.
    output: Option<W>,
    /// Bytes handed over.
    offset: u64,
    /// Checksum of them.
    crc: crc32fast::Hasher,
    /// What is handed over next.
    pending: Vec<u8>,
    chunk: Chunk,
    summary: Summary,
}

/// The chunk under way.
#[derive(Default)]
struct Chunk {
    /// Its records, uncompressed.
    records: Vec<u8>,
    /// Channel, log time and place of each of its messages.
    index: Vec<(u16, u64, u64)>,
    compressed: Vec<u8>,
}

/// What the end of the file repeats and counts.
#[derive(Default)]
struct Summary {
    schemas: Vec<u8>,
    channels: Vec<u8>,
    /// Ids by content.
    known: BTreeMap<(u8, Vec<u8>), u16>,
    schema_count: u16,
    channel_count: u16,
    chunk_indexes: Vec<u8>,
    attachment_indexes: Vec<u8>,
    metadata_indexes: Vec<u8>,
    chunk_count: u32,
    attachment_count: u32,
    metadata_count: u32,
    /// Messages by channel id.
    messages: Vec<u64>,
    bounds: Option<(u64, u64)>,
}

impl<W: Write> Container<W> {
    /// Starts a file of profile `ros2`.
    pub fn new(output: W) -> Result<Self, RecordError> {
        let mut container = Self {
            output: Some(output),
            offset: 0,
            crc: crc32fast::Hasher::new(),
            pending: mcap::MAGIC.to_vec(),
            chunk: Chunk::default(),
            summary: Summary::default(),
        };
        record(&mut container.pending, op::HEADER, |out| {
            string(out, "ros2");
            string(out, concat!("cohaul/", env!("CARGO_PKG_VERSION")));
        });
        container.hand_over()?;
        Ok(container)
    }

    /// Writes a metadata record.
    pub fn metadata(&mut self, name: &str, metadata: &BTreeMap<String, String>) -> Result<(), RecordError> {
        check_len("metadata", metadata.values().map(String::len).sum())?;
        self.end_chunk()?;
        record(&mut self.pending, op::METADATA, |out| {
            string(out, name);
            strings(out, metadata);
        });
        let (offset, len) = (self.offset, self.pending.len() as u64);
        record(&mut self.summary.metadata_indexes, op::METADATA_INDEX, |out| {
            numbers(out, &[offset, len]);
            string(out, name);
        });
        self.summary.metadata_count += 1;
        self.hand_over()
    }

    /// Writes an attachment, dated at the origin.
    pub fn attachment(&mut self, name: &str, media_type: &str, data: &[u8]) -> Result<(), RecordError> {
        check_len("attachment", data.len())?;
        self.end_chunk()?;
        record(&mut self.pending, op::ATTACHMENT, |out| {
            let start = out.len();
            numbers(out, &[0, 0]);
            string(out, name);
            string(out, media_type);
            numbers(out, &[data.len() as u64]);
            out.extend_from_slice(data);
            let crc = crc32fast::hash(out.get(start..).unwrap_or_default());
            out.extend_from_slice(&crc.to_le_bytes());
        });
        let (offset, len) = (self.offset, self.pending.len() as u64);
        record(&mut self.summary.attachment_indexes, op::ATTACHMENT_INDEX, |out| {
            numbers(out, &[offset, len, 0, 0, data.len() as u64]);
            string(out, name);
            string(out, media_type);
        });
        self.summary.attachment_count += 1;
        self.hand_over()
    }

    /// Id of a schema, after declaring it if it is new.
    pub fn schema(&mut self, name: &str, encoding: &str, text: &[u8]) -> Result<u16, RecordError> {
        check_len("schema", text.len())?;
        let mut body = Vec::new();
        string(&mut body, name);
        string(&mut body, encoding);
        body.extend_from_slice(&(text.len() as u32).to_le_bytes());
        body.extend_from_slice(text);
        self.declare(op::SCHEMA, body)
    }

    /// Id of a channel, after declaring it if it is new; `schema` 0 stands for none.
    pub fn channel(
        &mut self,
        schema: u16,
        topic: &str,
        encoding: &str,
        metadata: &BTreeMap<String, String>,
    ) -> Result<u16, RecordError> {
        let mut body = schema.to_le_bytes().to_vec();
        string(&mut body, topic);
        string(&mut body, encoding);
        strings(&mut body, metadata);
        self.declare(op::CHANNEL, body)
    }

    /// Writes a schema or channel unless an equal one exists; `body` lacks the id.
    fn declare(&mut self, opcode: u8, body: Vec<u8>) -> Result<u16, RecordError> {
        let key = (opcode, body);
        if let Some(id) = self.summary.known.get(&key) {
            return Ok(*id);
        }
        let summary = &mut self.summary;
        let (count, copies) = match opcode {
            op::SCHEMA => (&mut summary.schema_count, &mut summary.schemas),
            _ => (&mut summary.channel_count, &mut summary.channels),
        };
        let limit = usize::from(u16::MAX);
        let id = count.checked_add(1).ok_or(RecordError::TooManyTopics { topics: limit + 1, limit })?;
        *count = id;
        for out in [copies, &mut self.chunk.records] {
            record(out, opcode, |out| {
                out.extend_from_slice(&id.to_le_bytes());
                out.extend_from_slice(&key.1);
            });
        }
        summary.known.insert(key, id);
        if self.chunk.records.len() > CHUNK_LIMIT { self.end_chunk().map(|()| id) } else { Ok(id) }
    }

    /// Writes a message of a declared channel; `payload` appends it.
    pub fn message(&mut self, header: &MessageHeader, payload: impl FnOnce(&mut Vec<u8>)) -> Result<(), RecordError> {
        let place = self.chunk.records.len();
        let mut len = 0;
        record(&mut self.chunk.records, op::MESSAGE, |out| {
            out.extend_from_slice(&header.channel_id.to_le_bytes());
            out.extend_from_slice(&header.sequence.to_le_bytes());
            numbers(out, &[header.log_time, header.publish_time]);
            let start = out.len();
            payload(out);
            len = out.len() - start;
        });
        if let Err(error) = check_len("message", len) {
            self.chunk.records.truncate(place);
            return Err(error);
        }
        self.chunk.index.push((header.channel_id, header.log_time, place as u64));
        let channel = usize::from(header.channel_id);
        if self.summary.messages.len() <= channel {
            self.summary.messages.resize(channel + 1, 0);
        }
        if let Some(count) = self.summary.messages.get_mut(channel) {
            *count += 1;
        }
        if self.chunk.records.len() > CHUNK_LIMIT { self.end_chunk() } else { Ok(()) }
    }

    /// Ends the chunk and flushes the stream.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.end_chunk()?;
        self.try_output(Write::flush)
    }

    /// Writes the summary and flushes the stream.
    pub fn finish(mut self) -> Result<W, RecordError> {
        self.end()?;
        self.output.take().ok_or_else(closed)
    }

    /// The stream as a killed process leaves it.
    #[cfg(test)]
    pub fn into_unfinished(mut self) -> Option<W> {
        self.output.take()
    }

    /// After a failure the stream is let go: a file is cut at one place at most.
    fn try_output(&mut self, action: impl FnOnce(&mut W) -> std::io::Result<()>) -> Result<(), RecordError> {
        let result = action(self.output.as_mut().ok_or_else(closed)?);
        if result.is_err() {
            self.output = None;
        }
        Ok(result?)
    }

    /// Hands the pending bytes over.
    fn hand_over(&mut self) -> Result<(), RecordError> {
        self.crc.update(&self.pending);
        self.offset += self.pending.len() as u64;
        let pending = std::mem::take(&mut self.pending);
        let result = self.try_output(|output| output.write_all(&pending));
        self.pending = pending;
        self.pending.clear();
        result
    }

    fn end_chunk(&mut self) -> Result<(), RecordError> {
        let Self { chunk, summary, pending, offset, .. } = self;
        if chunk.records.is_empty() {
            return Ok(());
        }
        chunk.compress()?;
        let times = || chunk.index.iter().map(|(_, time, _)| *time);
        let (first, last) = (times().min().unwrap_or(0), times().max().unwrap_or(0));
        let (size, compressed) = (chunk.records.len() as u64, chunk.compressed.len() as u64);
        record(pending, op::CHUNK, |out| {
            numbers(out, &[first, last, size]);
            out.extend_from_slice(&crc32fast::hash(&chunk.records).to_le_bytes());
            string(out, "lz4");
            numbers(out, &[compressed]);
            out.extend_from_slice(&chunk.compressed);
        });
        let len = pending.len() as u64;
        // places are unique: the order of equal channels is that of writing
        chunk.index.sort_unstable_by_key(|(channel, _, place)| (*channel, *place));
        let indexes = || chunk.index.chunk_by(|a, b| a.0 == b.0);
        let channel_of = |messages: &[(u16, u64, u64)]| messages.first().map_or(0, |(channel, ..)| *channel);
        record(&mut summary.chunk_indexes, op::CHUNK_INDEX, |out| {
            numbers(out, &[first, last, *offset, len]);
            sized(out, |out| {
                for messages in indexes() {
                    let channel = channel_of(messages);
                    out.extend_from_slice(&channel.to_le_bytes());
                    numbers(out, &[*offset + pending.len() as u64]);
                    record(pending, op::MESSAGE_INDEX, |out| {
                        out.extend_from_slice(&channel.to_le_bytes());
                        sized(out, |out| messages.iter().for_each(|(_, time, place)| numbers(out, &[*time, *place])));
                    });
                }
            });
            numbers(out, &[pending.len() as u64 - len]);
            string(out, "lz4");
            numbers(out, &[compressed, size]);
        });
        if !chunk.index.is_empty() {
            let (start, end) = summary.bounds.unwrap_or((first, last));
            summary.bounds = Some((start.min(first), end.max(last)));
        }
        summary.chunk_count += 1;
        chunk.records.clear();
        chunk.index.clear();
        self.hand_over()
    }

    fn end(&mut self) -> Result<(), RecordError> {
        self.end_chunk()?;
        let crc = std::mem::take(&mut self.crc).finalize();
        record(&mut self.pending, op::DATA_END, |out| out.extend_from_slice(&crc.to_le_bytes()));
        self.hand_over()?;
        let start = self.offset;
        self.summary.write(start, &mut self.pending);
        self.hand_over()?;
        self.try_output(Write::flush)
    }
}

impl<W: Write> Drop for Container<W> {
    fn drop(&mut self) {
        if self.output.is_some() {
            // nobody is left to hear of a failure; `finish` tells
            let _ = self.end();
        }
    }
}

impl Chunk {
    /// One frame of one block.
    fn compress(&mut self) -> Result<(), RecordError> {
        let bound = lz4::block::compress_bound(self.records.len())?;
        let frame = if self.records.len() <= SMALL_BLOCK { SMALL_FRAME } else { LARGE_FRAME };
        let start = frame.len() + size_of::<u32>();
        self.compressed.clear();
        self.compressed.extend_from_slice(&frame);
        self.compressed.resize(start + bound, 0);
        let block = self.compressed.get_mut(start..).unwrap_or_default();
        let packed = lz4::block::compress_to_buffer(&self.records, Some(CompressionMode::DEFAULT), false, block)?;
        let len = if packed < self.records.len() {
            self.compressed.truncate(start + packed);
            packed as u32
        } else {
            self.compressed.truncate(start);
            self.compressed.extend_from_slice(&self.records);
            self.records.len() as u32 | STORED
        };
        if let Some(place) = self.compressed.get_mut(frame.len()..start) {
            place.copy_from_slice(&len.to_le_bytes());
        }
        self.compressed.extend_from_slice(&FRAME_END);
        Ok(())
    }
}

impl Summary {
    /// Appends everything behind the data; `start` is where in the file that is.
    fn write(&self, start: u64, out: &mut Vec<u8>) {
        let from = out.len();
        let mut statistics = Vec::new();
        let (first, last) = self.bounds.unwrap_or((0, 0));
        record(&mut statistics, op::STATISTICS, |out| {
            numbers(out, &[self.messages.iter().sum()]);
            out.extend_from_slice(&self.schema_count.to_le_bytes());
            for count in [u32::from(self.channel_count), self.attachment_count, self.metadata_count, self.chunk_count] {
                out.extend_from_slice(&count.to_le_bytes());
            }
            numbers(out, &[first, last]);
            sized(out, |out| {
                for (channel, count) in (0_u16..).zip(&self.messages).filter(|(_, count)| **count > 0) {
                    out.extend_from_slice(&channel.to_le_bytes());
                    numbers(out, &[*count]);
                }
            });
        });
        let groups = [
            (op::SCHEMA, &self.schemas),
            (op::CHANNEL, &self.channels),
            (op::STATISTICS, &statistics),
            (op::CHUNK_INDEX, &self.chunk_indexes),
            (op::ATTACHMENT_INDEX, &self.attachment_indexes),
            (op::METADATA_INDEX, &self.metadata_indexes),
        ];
        let mut offsets = Vec::new();
        for (opcode, group) in groups.into_iter().filter(|(_, group)| !group.is_empty()) {
            record(&mut offsets, op::SUMMARY_OFFSET, |offsets| {
                offsets.push(opcode);
                numbers(offsets, &[start + (out.len() - from) as u64, group.len() as u64]);
            });
            out.extend_from_slice(group);
        }
        let offsets_start = start + (out.len() - from) as u64;
        out.extend_from_slice(&offsets);
        record(out, op::FOOTER, |out| {
            numbers(out, &[start, offsets_start]);
            // as in the file: the length is known but not yet in place
            if let Some(place) = out.len().checked_sub(24).and_then(|at| out.get_mut(at..at + 8)) {
                place.copy_from_slice(&20_u64.to_le_bytes());
            }
            let crc = crc32fast::hash(out.get(from..).unwrap_or_default());
            out.extend_from_slice(&crc.to_le_bytes());
        });
        out.extend_from_slice(mcap::MAGIC);
    }
}

fn check_len(what: &'static str, len: usize) -> Result<(), RecordError> {
    if len > LIMIT { Err(RecordError::TooLong { what, len, limit: LIMIT }) } else { Ok(()) }
}

fn closed() -> RecordError {
    std::io::Error::other("an earlier write to the log failed").into()
}

/// Appends a record whose body `body` appends.
fn record(out: &mut Vec<u8>, opcode: u8, body: impl FnOnce(&mut Vec<u8>)) {
    out.push(opcode);
    let at = out.len();
    out.extend_from_slice(&[0; 8]);
    body(out);
    let len = (out.len() - at - 8) as u64;
    if let Some(place) = out.get_mut(at..at + 8) {
        place.copy_from_slice(&len.to_le_bytes());
    }
}

/// Appends what `content` appends behind its length, 32 bits.
fn sized(out: &mut Vec<u8>, content: impl FnOnce(&mut Vec<u8>)) {
    let at = out.len();
    out.extend_from_slice(&[0; 4]);
    content(out);
    let len = (out.len() - at - 4) as u32;
    if let Some(place) = out.get_mut(at..at + 4) {
        place.copy_from_slice(&len.to_le_bytes());
    }
}

fn numbers(out: &mut Vec<u8>, values: &[u64]) {
    for value in values {
        out.extend_from_slice(&value.to_le_bytes());
    }
}

fn string(out: &mut Vec<u8>, value: &str) {
    out.extend_from_slice(&(value.len() as u32).to_le_bytes());
    out.extend_from_slice(value.as_bytes());
}

fn strings(out: &mut Vec<u8>, map: &BTreeMap<String, String>) {
    sized(out, |out| {
        for (key, value) in map {
            string(out, key);
            string(out, value);
        }
    });
}
