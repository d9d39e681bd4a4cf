//! The sorted records, in blocks of [`VERTICES_IN_A_BLOCK`] vertices with bounding boxes.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use adwave::pages::zeros;
use adwave::shape::KnownRange;
use rayon::prelude::*;

use crate::bounds::BoundingBox;
use crate::bytes::ByteCursor;
use crate::error::TilesError;
use crate::files::{RandomAccessFile, write_atomic};
use crate::layout::{FLAGGED, MemberRule, RecordLayout, SUSPECT, UNSELECTED};

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
    pub(crate) rule: MemberRule,
    /// Numbers of the records that take no part.
    pub(crate) outsiders: OutsiderCounts,
}

/// Numbers of the records that take no part, by the first reason.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OutsiderCounts {
    /// Number left out by conditions or a mask.
    pub(crate) unselected: u64,
    /// Number flagged as withheld or classified as noise.
    pub(crate) flagged: u64,
    /// Number of placeholders without a real position.
    pub(crate) placeholders: u64,
}

/// First bytes of a block table.
const MAGIC: &[u8; 8] = b"adwblk03";

/// Builds the block table from records in sorted order.
pub(crate) struct BlockTableBuilder {
    layout: RecordLayout,
    pub(crate) rule: MemberRule,
    first_records: Vec<u64>,
    bounds: Vec<BoundingBox>,
    n_records: u64,
    pub(crate) n_vertices: u64,
    /// Number of records that take part, and may be placeholders.
    pub(crate) n_suspects: u64,
    pub(crate) outsiders: OutsiderCounts,
    /// Position bytes of the last record that takes part.
    last_position: Vec<u8>,
}

impl BlockTableBuilder {
    pub(crate) fn new(layout: RecordLayout, rule: MemberRule) -> Self {
        Self {
            layout,
            rule,
            first_records: Vec::new(),
            bounds: Vec::new(),
            n_records: 0,
            n_vertices: 0,
            n_suspects: 0,
            outsiders: OutsiderCounts::default(),
            last_position: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, record: &[u8]) {
        if self.rule.takes_part(&self.layout, record) {
            self.push_member(record);
        } else {
            let counts = &mut self.outsiders;
            let marks = self.layout.marks(record);
            if marks & UNSELECTED != 0 {
                counts.unselected += 1;
            } else if marks & FLAGGED != 0 && !self.rule.includes_flagged {
                counts.flagged += 1;
            } else {
                counts.placeholders += 1;
            }
        }
        self.n_records += 1;
    }

    fn push_member(&mut self, record: &[u8]) {
        self.n_suspects += u64::from(self.layout.marks(record) & SUSPECT != 0);
        let position = &record[..self.layout.position_bytes()];
        if self.last_position == position {
            return;
        }
        if self.n_vertices.is_multiple_of(VERTICES_IN_A_BLOCK as u64) {
            // Records that take no part belong to the block before them, at the beginning to the first.
            self.first_records.push(if self.n_vertices == 0 { 0 } else { self.n_records });
            self.bounds.push(BoundingBox::EMPTY);
        }
        self.n_vertices += 1;
        self.last_position.clear();
        self.last_position.extend_from_slice(position);
        if let Some(bounds) = self.bounds.last_mut() {
            bounds.include(&BoundingBox::from_point(self.layout.position(record)));
        }
    }

    pub(crate) fn write(self, path: &Path) -> Result<(), TilesError> {
        write_atomic(path, |out| {
            let OutsiderCounts { unselected, flagged, placeholders } = self.outsiders;
            let n_blocks = self.first_records.len() as u64;
            let mut bytes = MAGIC.to_vec();
            let numbers = [self.n_vertices, self.n_records, unselected, flagged, placeholders, n_blocks];
            bytes.extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
            let MemberRule { includes_flagged, known } = self.rule;
            bytes.extend([u8::from(includes_flagged), u8::from(known.is_some())]);
            let known = known.unwrap_or(KnownRange { low: [0.0; 3], high: [0.0; 3] });
            bytes.extend(known.low.iter().chain(&known.high).flat_map(|c| c.to_le_bytes()));
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
        let outsiders =
            OutsiderCounts { unselected: cursor.u64()?, flagged: cursor.u64()?, placeholders: cursor.u64()? };
        let n_blocks = cursor.u64()?;
        let (includes_flagged, has_range) = (cursor.u8()? != 0, cursor.u8()? != 0);
        let mut known = KnownRange { low: [0.0; 3], high: [0.0; 3] };
        for c in known.low.iter_mut().chain(&mut known.high) {
            *c = cursor.f64()?;
        }
        let rule = MemberRule { includes_flagged, known: has_range.then_some(known) };
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
            rule,
            outsiders,
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

    /// Value of the fields of a record that takes no part.
    pub(crate) fn outsider_value(&self, record: &[u8]) -> f32 {
        self.rule.outsider_value(&self.layout, record)
    }

    /// Reads the positions of the vertices of a block, in units of the layout.
    pub(crate) fn read_positions(&self, block: usize) -> Result<Vec<[f64; 3]>, TilesError> {
        let mut positions = Vec::with_capacity(VERTICES_IN_A_BLOCK);
        let records = self.read_records(block)?;
        for (vertex, record) in self.with_vertices(&records) {
            if vertex == Some(positions.len()) {
                positions.push(self.layout.position(record));
            }
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

    /// The records of a block, each with the index of its vertex in the block; `None` for one that takes no part.
    /// Consecutive records with equal positions are one vertex.
    pub(crate) fn with_vertices<'a>(
        &'a self,
        records: &'a [u8],
    ) -> impl Iterator<Item = (Option<usize>, &'a [u8])> + 'a {
        let (record_bytes, position_bytes) = (self.layout.record_bytes(), self.layout.position_bytes());
        let (mut last, mut n) = (None, 0);
        records.chunks_exact(record_bytes).map(move |record| {
            if !self.rule.takes_part(&self.layout, record) {
                return (None, record);
            }
            let position = &record[..position_bytes];
            if last != Some(position) {
                last = Some(position);
                n += 1;
            }
            (Some(n - 1), record)
        })
    }
}
