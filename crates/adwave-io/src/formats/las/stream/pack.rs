//! Parallel compression of points into the chunks of a LAZ.

use std::io::{Seek, SeekFrom, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use laz::laszip::{ChunkTable, ChunkTableEntry};
use laz::record::{LayeredPointRecordCompressor, RecordCompressor, SequentialPointRecordCompressor};
use laz::{LazItem, LazVlr};
use rayon::prelude::*;

use crate::formats::las::write::{CHUNK, compression};
use crate::{Format, WriteError};

/// Largest size of the points of a chunk in bytes; only very long records have fewer points than [`CHUNK`] per chunk.
const MOST_CHUNK: usize = 1 << 25;
/// Largest size of the points waiting for compression in bytes; one more chunk may exceed it.
const MOST_WAITING: usize = 1 << 26;
/// Chunks per thread in one batch, so that all threads end at about the same time.
const CHUNKS_PER_THREAD: usize = 4;

/// Compressor that keeps the table of chunks.
pub(super) struct Packer {
    vlr: LazVlr,
    table: ChunkTable,
    record_bytes: usize,
    waiting: Vec<u8>,
    /// Number of waiting bytes that are compressed in one batch: several whole chunks.
    enough: usize,
}

impl Packer {
    /// Creates a compressor for records of that point format and size.
    pub(super) fn new(format: u8, record_bytes: usize) -> Result<Self, WriteError> {
        let chunk = (CHUNK as usize).min(MOST_CHUNK / record_bytes).max(1);
        let vlr = compression(format, record_bytes, chunk as u32).map_err(cannot)?;
        let chunk_bytes = chunk * record_bytes;
        let n_chunks = CHUNKS_PER_THREAD * rayon::current_num_threads().max(1);
        let enough = chunk_bytes * n_chunks.min(MOST_WAITING / chunk_bytes).max(1);
        Ok(Self { vlr, table: ChunkTable::default(), record_bytes, waiting: Vec::new(), enough })
    }

    /// Description of the compression.
    pub(super) fn description(&self) -> &LazVlr {
        &self.vlr
    }

    /// Reserves the position of the table, which precedes the first chunk.
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

    /// Writes the last chunk and the table; `start` is the start of the points.
    pub(super) fn end(&mut self, start: u64, out: &mut (impl Write + Seek)) -> Result<(), WriteError> {
        self.pack(out)?;
        let position = out.stream_position()?;
        out.seek(SeekFrom::Start(start))?;
        out.write_all(&position.to_le_bytes())?;
        out.seek(SeekFrom::Start(position))?;
        Ok(self.table.write_to(out, &self.vlr)?)
    }

    /// Compresses and writes all waiting points.
    fn pack(&mut self, out: &mut impl Write) -> Result<(), WriteError> {
        let chunk_bytes = self.vlr.chunk_size() as usize * self.record_bytes;
        let items = self.vlr.items();
        // No object of the library survives, so a state left inconsistent by a panic is never used.
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
                // The library subtracts times as integers, which may overflow.
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

/// Compresses these points to a chunk.
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
