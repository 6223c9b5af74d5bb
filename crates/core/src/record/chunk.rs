//! Chunks and the records inside them, with every length checked before it is believed.

use std::io::Read;

use mcap::records::MessageHeader;
use mcap::records::op;

use super::RECORD_LIMIT;

/// Opcode and length in front of every record, bytes.
pub(super) const PREFIX: usize = 9;

/// Splits the next record off `bytes`: its opcode and body. `None` at the end, or if the body is cut off.
pub(super) fn split<'a>(bytes: &mut &'a [u8]) -> Option<(u8, &'a [u8])> {
    let (prefix, rest) = bytes.split_first_chunk::<PREFIX>()?;
    let [opcode, len @ ..] = *prefix;
    let len = usize::try_from(u64::from_le_bytes(len)).ok()?;
    let body = rest.get(..len)?;
    *bytes = rest.get(len..)?;
    Some((opcode, body))
}

/// Unpacks the body of a chunk record into `records` and compares its checksum.
pub(super) fn unpack(body: &[u8], records: &mut Vec<u8>) -> Result<(), String> {
    records.clear();
    let parsed = mcap::parse_record(op::CHUNK, body).map_err(|error| error.to_string())?;
    let mcap::records::Record::Chunk { header, data } = parsed else {
        return Err("chunk is not a chunk".into());
    };
    let size = usize::try_from(header.uncompressed_size).ok().filter(|size| *size <= RECORD_LIMIT);
    let size = size.ok_or_else(|| format!("chunk claims {} bytes", header.uncompressed_size))?;
    match header.compression.as_str() {
        "" => records.extend_from_slice(&data),
        "lz4" => {
            // one byte more than claimed is enough to notice
            lz4::Decoder::new(&data[..])
                .and_then(|decoder| decoder.take(size as u64 + 1).read_to_end(records))
                .map_err(|error| format!("chunk does not unpack: {error}"))?;
        }
        other => return Err(format!("chunk is compressed with {other:?}; only lz4 is read")),
    }
    if records.len() != size {
        return Err(format!("chunk holds {} bytes instead of {size}", records.len()));
    }
    let calculated = crc32fast::hash(records);
    // 0 means that the writer did not calculate one
    if header.uncompressed_crc != 0 && header.uncompressed_crc != calculated {
        let saved = header.uncompressed_crc;
        return Err(format!("checksum of a chunk is {calculated:08x} instead of {saved:08x}"));
    }
    Ok(())
}

/// Splits a message record into its header and payload.
pub(super) fn message(body: &[u8]) -> Option<(MessageHeader, &[u8])> {
    let (channel_id, rest) = body.split_first_chunk()?;
    let (sequence, rest) = rest.split_first_chunk()?;
    let (log_time, rest) = rest.split_first_chunk()?;
    let (publish_time, payload) = rest.split_first_chunk()?;
    let header = MessageHeader {
        channel_id: u16::from_le_bytes(*channel_id),
        sequence: u32::from_le_bytes(*sequence),
        log_time: u64::from_le_bytes(*log_time),
        publish_time: u64::from_le_bytes(*publish_time),
    };
    Some((header, payload))
}

/// A schema, metadata or channel record; attachments and others are `None`, and so is a body that does not parse.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Option<mcap::records::Record<'_>> {
    match opcode {
        op::SCHEMA | op::CHANNEL | op::METADATA => mcap::parse_record(opcode, body).ok(),
        _ => None,
    }
}
