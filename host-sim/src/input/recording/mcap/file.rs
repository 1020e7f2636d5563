//! The records of an MCAP file, one in memory at a time.

use std::borrow::Cow;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use mcap::read::parse_record;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::input::image_file::guarded;

/// No chunk or message may take more, packed or unpacked; a header can claim anything.
const MAX_RECORD_BYTES: u64 = 1 << 29;
/// Opcode and length before each record.
const HEAD_BYTES: u64 = 9;

/// A file that begins as MCAP does.
#[derive(Debug)]
pub(super) struct McapFile {
    path: PathBuf,
}

/// Where a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    /// Offset of the chunk's record, or of the message's own.
    pub(super) record: u64,
    /// Its number among the chunk's messages.
    pub(super) message: usize,
}

/// How far to trust a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trust {
    /// The checksum of its chunk is right.
    Checked,
    /// Nothing guards it.
    Unchecked,
    /// Its chunk is damaged somewhere.
    Damaged,
}

/// A record on the way through the file.
struct Head {
    op: u8,
    at: u64,
    length: u64,
}

impl McapFile {
    /// The file in `path`.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let mut magic = Vec::new();
        let read = File::open(path).and_then(|file| file.take(mcap::MAGIC.len() as u64).read_to_end(&mut magic));
        read.map_err(|error| anyhow!("{}: cannot be read: {error}", path.display()))?;
        ensure!(!magic.is_empty(), "{}: the file is empty, where an MCAP recording is expected", path.display());
        ensure!(magic == mcap::MAGIC, "{}: does not begin as an MCAP file does", path.display());
        Ok(Self { path: path.to_owned() })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Shows all records in their order, those of chunks with the offset of the chunk and the number of messages in it
    /// before, and how far to trust each. Whether the file is whole: one that is cut off or damaged is shown as far as
    /// it goes.
    pub(super) fn visit(&self, mut show: impl FnMut(Place, Trust, Record<'_>) -> Result<()>) -> Result<bool> {
        let mut file = BufReader::new(File::open(&self.path)?);
        let end = file.get_ref().metadata()?.len();
        let (mut at, mut is_whole, mut is_summary) = (mcap::MAGIC.len() as u64, true, false);
        while let Some(head) = read_head(&mut file, at, end)? {
            at = head.at + HEAD_BYTES + head.length;
            match head.op {
                op::FOOTER => return Ok(is_whole),
                // The summary after it tells schemas and channels once more.
                op::DATA_END => is_summary = true,
                op::CHUNK | op::MESSAGE if is_summary => {}
                op::CHUNK | op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                    let body = read_body(&mut file, &head)?;
                    let mut records = Vec::new();
                    let shown = visit_record(&head, &body, |message, record| records.push((message, record)));
                    is_whole &= shown.is_ok();
                    let trust = shown.unwrap_or(Trust::Damaged);
                    for (message, record) in records {
                        show(Place { record: head.at, message }, trust, record)?;
                    }
                }
                _ => {}
            }
        }
        Ok(false)
    }

    /// Shows the data of the chunk's messages, or of the one message, whose record begins there, each with its number.
    pub(super) fn visit_messages(&self, at: u64, mut show: impl FnMut(usize, Cow<'_, [u8]>)) -> Result<()> {
        let mut file = BufReader::new(File::open(&self.path)?);
        let end = file.get_ref().metadata()?.len();
        let head = read_head(&mut file, at, end)?.context("the file became shorter")?;
        let body = read_body(&mut file, &head)?;
        visit_record(&head, &body, |index, record| {
            if let Record::Message { data, .. } = record {
                show(index, data);
            }
        })?;
        Ok(())
    }
}

/// The next record that is whole, if there is one.
fn read_head(file: &mut BufReader<File>, at: u64, end: u64) -> Result<Option<Head>> {
    if end.saturating_sub(at) < HEAD_BYTES {
        return Ok(None);
    }
    file.seek(SeekFrom::Start(at))?;
    let (mut op, mut length) = ([0], [0; 8]);
    file.read_exact(&mut op)?;
    file.read_exact(&mut length)?;
    let (op, length) = (op[0], u64::from_le_bytes(length));
    Ok((length <= end - at - HEAD_BYTES).then_some(Head { op, at, length }))
}

fn read_body(file: &mut BufReader<File>, head: &Head) -> Result<Vec<u8>> {
    let Head { length, .. } = head;
    ensure!(*length <= MAX_RECORD_BYTES, "a record has {length} bytes, more than this tool reads");
    let mut body = vec![0; *length as usize];
    file.read_exact(&mut body)?;
    Ok(body)
}

/// Shows a record, or those in it, each with the number of messages before it.
fn visit_record(head: &Head, body: &[u8], mut show: impl FnMut(usize, Record<'static>)) -> Result<Trust> {
    let damaged = |error: &dyn std::fmt::Display| anyhow!("a chunk is damaged: {error}");
    let record = guarded(|| parse_record(head.op, body)).map_err(|error| damaged(&error))?;
    let record = record.map_err(|error| damaged(&error))?;
    let Record::Chunk { header, .. } = record else {
        show(0, record.into_owned());
        return Ok(Trust::Unchecked);
    };
    let size = header.uncompressed_size;
    let trust = if header.uncompressed_crc == 0 { Trust::Unchecked } else { Trust::Checked };
    ensure!(size <= MAX_RECORD_BYTES, "a chunk claims to have {size} bytes, more than this tool reads");
    // No record in a chunk is longer than the chunk, whatever it claims.
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit((size as usize).max(body.len()));
    let mut reader = LinearReader::new_with_options(options);
    let head = [&[head.op][..], &head.length.to_le_bytes()].concat();
    let (mut from, mut messages) = (head.as_slice().chain(body), 0);
    while let Some(record) = guarded(|| next_record(&mut reader, &mut from)).map_err(|error| damaged(&error))? {
        let record = record.map_err(|error| damaged(&error))?;
        let is_message = matches!(record, Record::Message { .. });
        show(messages, record);
        messages += usize::from(is_message);
    }
    Ok(trust)
}

/// The next record of a chunk that is read from there.
fn next_record(reader: &mut LinearReader, from: &mut impl Read) -> Option<Result<Record<'static>>> {
    loop {
        match reader.next_event()? {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let read = from.read(reader.insert(wanted));
                match read {
                    Ok(count) => reader.notify_read(count),
                    Err(error) => return Some(Err(error.into())),
                }
            }
            Ok(LinearReadEvent::Record { data, opcode }) => {
                return Some(parse_record(opcode, data).map(Record::into_owned).map_err(Into::into));
            }
            Err(error) => return Some(Err(error.into())),
        }
    }
}
