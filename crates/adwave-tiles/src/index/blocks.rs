//! The sorted records, in blocks of [`VERTICES_IN_A_BLOCK`] vertices with bounding boxes.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use adwave::pages::zeros;
use rayon::prelude::*;

use crate::bounds::BoundingBox;
use crate::bytes::ByteCursor;
use crate::error::TilesError;
use crate::files::{RandomAccessFile, write_atomic};
use crate::layout::RecordLayout;

/// Number of vertices of a block: that many distinct positions, consecutive along the curve.
pub const VERTICES_IN_A_BLOCK: usize = 4096;

/// The sorted records by blocks; the table is in memory, the records are on disk.
#[derive(Debug)]
pub(crate) struct Blocks {
    records: RandomAccessFile,
    layout: RecordLayout,
    /// Index of the first record of each block, then the total number of records.
    first_records: Vec<u64>,
    /// Bounding box of each block, in units of the layout.
    pub(crate) bounds: Vec<BoundingBox>,
    pub(crate) n_vertices: u64,
    /// Number of points that are flagged as withheld or classified as noise.
    pub(crate) n_flagged: u64,
}

/// First bytes of a block table.
const MAGIC: &[u8; 8] = b"adwblk02";

/// Builds the block table from records in sorted order.
pub(crate) struct BlockTableBuilder {
    layout: RecordLayout,
    first_records: Vec<u64>,
    bounds: Vec<BoundingBox>,
    n_records: u64,
    n_vertices: u64,
    n_flagged: u64,
    /// Position bytes of the last record.
    last_position: Vec<u8>,
}

impl BlockTableBuilder {
    pub(crate) fn new(layout: RecordLayout) -> Self {
        Self {
            layout,
            first_records: Vec::new(),
            bounds: Vec::new(),
            n_records: 0,
            n_vertices: 0,
            n_flagged: 0,
            last_position: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, record: &[u8]) {
        let position = &record[..self.layout.position_bytes()];
        if self.last_position != position {
            if self.n_vertices.is_multiple_of(VERTICES_IN_A_BLOCK as u64) {
                self.first_records.push(self.n_records);
                self.bounds.push(BoundingBox::EMPTY);
            }
            self.n_vertices += 1;
            self.last_position.clear();
            self.last_position.extend_from_slice(position);
            if let Some(bounds) = self.bounds.last_mut() {
                bounds.include(&BoundingBox::from_point(self.layout.position(record)));
            }
        }
        self.n_records += 1;
        self.n_flagged += u64::from(self.layout.is_flagged(record));
    }

    pub(crate) fn write(self, path: &Path) -> Result<(), TilesError> {
        write_atomic(path, |out| {
            let mut bytes = MAGIC.to_vec();
            bytes.extend(self.n_vertices.to_le_bytes());
            bytes.extend(self.n_records.to_le_bytes());
            bytes.extend(self.n_flagged.to_le_bytes());
            bytes.extend((self.first_records.len() as u64).to_le_bytes());
            for (first, bounds) in self.first_records.iter().zip(&self.bounds) {
                bytes.extend(first.to_le_bytes());
                bytes.extend(bounds.min.iter().chain(&bounds.max).flat_map(|c| c.to_le_bytes()));
            }
            out.write_all(&bytes).map_err(TilesError::io(path))
        })
    }
}

impl Blocks {
    pub(crate) fn open(table: &Path, records: &Path, layout: RecordLayout) -> Result<Self, TilesError> {
        let bytes = std::fs::read(table).map_err(TilesError::io(table))?;
        let records = RandomAccessFile::open(records)?;
        Self::parse(&bytes, records, layout).ok_or_else(|| TilesError::broken(table, "it ends early"))
    }

    fn parse(bytes: &[u8], records: RandomAccessFile, layout: RecordLayout) -> Option<Self> {
        let mut cursor = ByteCursor { bytes: bytes.strip_prefix(MAGIC)? };
        let (n_vertices, n_records) = (cursor.u64()?, cursor.u64()?);
        let (n_flagged, n_blocks) = (cursor.u64()?, cursor.u64()?);
        let (mut first_records, mut all_bounds) = (Vec::new(), Vec::new());
        for _ in 0..n_blocks {
            first_records.push(cursor.u64()?);
            let mut bounds = BoundingBox::EMPTY;
            for side in bounds.min.iter_mut().chain(&mut bounds.max) {
                *side = cursor.f64()?;
            }
            all_bounds.push(bounds);
        }
        first_records.push(n_records);
        (n_vertices.div_ceil(VERTICES_IN_A_BLOCK as u64) == n_blocks).then_some(Self {
            records,
            layout,
            first_records,
            bounds: all_bounds,
            n_vertices,
            n_flagged,
        })
    }

    /// Number of blocks.
    pub(crate) fn len(&self) -> usize {
        self.bounds.len()
    }

    /// Vertex indices of a block.
    pub(crate) fn vertices(&self, block: usize) -> Range<usize> {
        let first = block * VERTICES_IN_A_BLOCK;
        first..(first + VERTICES_IN_A_BLOCK).min(self.n_vertices as usize)
    }

    /// Vertex indices of a nonempty range of blocks.
    pub(crate) fn vertices_of_range(&self, blocks: &Range<usize>) -> Range<usize> {
        self.vertices(blocks.start).start..self.vertices(blocks.end - 1).end
    }

    /// Number of records before a block. The block after the last one gives the number of all records.
    pub(crate) fn first_record(&self, block: usize) -> u64 {
        self.first_records[block]
    }

    /// Reads all records of a block.
    pub(crate) fn read_records(&self, block: usize) -> Result<Vec<u8>, TilesError> {
        let (first, end) = (self.first_records[block], self.first_records[block + 1]);
        let Some(n) = end.checked_sub(first) else {
            return Err(TilesError::broken(self.records.path(), "its table is not sorted"));
        };
        let record_bytes = self.layout.record_bytes();
        self.records.read(first * record_bytes as u64, n as usize * record_bytes)
    }

    /// Reads the positions of the vertices of a block, in units of the layout.
    pub(crate) fn read_positions(&self, block: usize) -> Result<Vec<[f64; 3]>, TilesError> {
        let mut positions = Vec::with_capacity(VERTICES_IN_A_BLOCK);
        let records = self.read_records(block)?;
        for group in self.group_by_vertex(&records) {
            positions.push(self.layout.position(group));
        }
        if positions.len() != self.vertices(block).len() {
            return Err(TilesError::broken(self.records.path(), "its points do not match its table"));
        }
        Ok(positions)
    }

    /// Reads the positions of the vertices of a nonempty range of blocks, in units of the layout.
    pub(crate) fn read_positions_of_range(&self, blocks: &Range<usize>) -> Result<Vec<[f64; 3]>, TilesError> {
        let mut points: Vec<[f64; 3]> = zeros(self.vertices_of_range(blocks).len());
        points.par_chunks_mut(VERTICES_IN_A_BLOCK).zip(blocks.clone()).try_for_each(|(points, block)| {
            points.copy_from_slice(&self.read_positions(block)?);
            Ok::<(), TilesError>(())
        })?;
        Ok(points)
    }

    /// Splits the records of a block into one slice per vertex: the consecutive records with equal positions.
    pub(crate) fn group_by_vertex<'a>(&self, records: &'a [u8]) -> impl Iterator<Item = &'a [u8]> {
        let (record_bytes, position_bytes) = (self.layout.record_bytes(), self.layout.position_bytes());
        let mut rest = records;
        std::iter::from_fn(move || {
            let position = rest.get(..position_bytes)?;
            let is_same = |record: &&[u8]| &record[..position_bytes] == position;
            let n = rest.chunks_exact(record_bytes).take_while(is_same).count();
            let (group, after) = rest.split_at(n * record_bytes);
            rest = after;
            (n > 0).then_some(group)
        })
    }
}
