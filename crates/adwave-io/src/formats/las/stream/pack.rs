//! Packing points into the chunks of a LAZ, several at a time.

use std::io::{Seek, SeekFrom, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use laz::laszip::{ChunkTable, ChunkTableEntry};
use laz::record::{LayeredPointRecordCompressor, RecordCompressor, SequentialPointRecordCompressor};
use laz::{LazItem, LazVlr};
use rayon::prelude::*;

use crate::formats::las::write::{CHUNK, compression};
use crate::{Format, WriteError};

/// Most bytes of points in a chunk; only where records are very long it has fewer points than [`CHUNK`].
const MOST_CHUNK: usize = 1 << 25;
/// Most bytes of points that wait to be packed, but for one chunk more.
const MOST_WAITING: usize = 1 << 26;
/// Chunks for each thread that are packed in one go, so that all end at about the same time.
const CHUNKS_PER_THREAD: usize = 4;

/// Packs points and keeps the table of chunks.
pub(super) struct Packer {
    vlr: LazVlr,
    table: ChunkTable,
    record_bytes: usize,
    waiting: Vec<u8>,
    /// Waiting bytes that are packed in one go: some whole chunks.
    enough: usize,
}

impl Packer {
    /// For records of that point format and size.
    pub(super) fn new(format: u8, record_bytes: usize) -> Result<Self, WriteError> {
        let chunk = (CHUNK as usize).min(MOST_CHUNK / record_bytes).max(1);
        let vlr = compression(format, record_bytes, chunk as u32).map_err(cannot)?;
        let chunk_bytes = chunk * record_bytes;
        let n_chunks = CHUNKS_PER_THREAD * rayon::current_num_threads().max(1);
        let enough = chunk_bytes * n_chunks.min(MOST_WAITING / chunk_bytes).max(1);
        Ok(Self { vlr, table: ChunkTable::default(), record_bytes, waiting: Vec::new(), enough })
    }

    /// The description of the compression.
    pub(super) fn description(&self) -> &LazVlr {
        &self.vlr
    }

    /// Room for the position of the table, which stands before the first chunk.
    pub(super) fn begin(out: &mut impl Write) -> Result<(), WriteError> {
        Ok(out.write_all(&(-1_i64).to_le_bytes())?)
    }

    /// Adds points and writes the chunks that are full.
    pub(super) fn add(&mut self, mut records: &[u8], out: &mut impl Write) -> Result<(), WriteError> {
        while !records.is_empty() {
            let (own, rest) = records.split_at(records.len().min(self.enough - self.waiting.len()));
            self.waiting.extend_from_slice(own);
            records = rest;
            if self.waiting.len() == self.enough {
                self.pack(out)?;
            }
        }
        Ok(())
    }

    /// Writes the last chunk and the table; `start` is where the points began.
    pub(super) fn end(&mut self, start: u64, out: &mut (impl Write + Seek)) -> Result<(), WriteError> {
        self.pack(out)?;
        let position = out.stream_position()?;
        out.seek(SeekFrom::Start(start))?;
        out.write_all(&position.to_le_bytes())?;
        out.seek(SeekFrom::Start(position))?;
        Ok(self.table.write_to(out, &self.vlr)?)
    }

    /// Packs and writes all that waits.
    fn pack(&mut self, out: &mut impl Write) -> Result<(), WriteError> {
        let chunk_bytes = self.vlr.chunk_size() as usize * self.record_bytes;
        let items = self.vlr.items();
        // Nothing of the library outlives this, so what a panic leaves half done is never seen.
        let packed: Vec<_> = self
            .waiting
            .par_chunks(chunk_bytes)
            .map(|rows| catch_unwind(AssertUnwindSafe(|| packed(items, rows, self.record_bytes))))
            .collect();
        for chunk in packed {
            let chunk = match chunk {
                Ok(Ok(chunk)) => chunk,
                Ok(Err(error)) => {
                    return Err(cannot(format!("these points: {}", crate::text::one_line(&error))));
                }
                // The library subtracts times as whole numbers, which may overflow.
                Err(_) => return Err(cannot("these points; write a LAS instead")),
            };
            out.write_all(&chunk)?;
            let point_count = u64::from(self.vlr.chunk_size());
            self.table.push(ChunkTableEntry { point_count, byte_count: chunk.len() as u64 });
        }
        self.waiting.clear();
        Ok(())
    }
}

/// A chunk of these points.
fn packed(items: &Vec<LazItem>, rows: &[u8], record_bytes: usize) -> laz::Result<Vec<u8>> {
    let is_layered = items.first().is_some_and(|item| item.version() >= 3);
    let mut compressor: Box<dyn RecordCompressor<Vec<u8>>> = if is_layered {
        Box::new(LayeredPointRecordCompressor::new(Vec::new()))
    } else {
        Box::new(SequentialPointRecordCompressor::new(Vec::new()))
    };
    compressor.set_fields_from(items)?;
    for row in rows.chunks_exact(record_bytes) {
        compressor.compress_next(row)?;
    }
    compressor.done()?;
    Ok(compressor.box_into_inner())
}

fn cannot(what: impl Into<String>) -> WriteError {
    WriteError::CannotHold { format: Format::LAZ, what: what.into() }
}
