//! The sorted records, by blocks of vertices.

use std::io::Write;
use std::path::Path;

use crate::TilesError;
use crate::box_tree::Bounds;
use crate::files::{At, Cursor, write_whole};
use crate::layout::Layout;

/// Vertices of a block: positions of so many different points, one after the other along the curve.
pub const VERTICES_IN_A_BLOCK: usize = 4096;

/// The blocks of the sorted records.
#[derive(Debug)]
pub(crate) struct Blocks {
    records: At,
    layout: Layout,
    /// The first record of each block, and how many there are in total.
    firsts: Vec<u64>,
    pub(crate) boxes: Vec<Bounds>,
    pub(crate) n_vertices: u64,
}

/// What begins a table of blocks.
const MARK: &[u8; 8] = b"adwblk01";

/// Builds the table while the sorted records go by.
pub(crate) struct TableBuilder {
    layout: Layout,
    firsts: Vec<u64>,
    boxes: Vec<Bounds>,
    n_records: u64,
    n_vertices: u64,
    /// What the last record began with.
    last: Vec<u8>,
}

impl TableBuilder {
    pub(crate) fn new(layout: Layout) -> Self {
        Self { layout, firsts: Vec::new(), boxes: Vec::new(), n_records: 0, n_vertices: 0, last: Vec::new() }
    }

    pub(crate) fn add(&mut self, record: &[u8]) {
        let here = &record[..self.layout.position_bytes()];
        if self.last != here {
            if self.n_vertices.is_multiple_of(VERTICES_IN_A_BLOCK as u64) {
                self.firsts.push(self.n_records);
                self.boxes.push(Bounds::NONE);
            }
            self.n_vertices += 1;
            self.last.clear();
            self.last.extend_from_slice(here);
            if let Some(bounds) = self.boxes.last_mut() {
                bounds.include(&Bounds::of(self.layout.position(record)));
            }
        }
        self.n_records += 1;
    }

    pub(crate) fn write(self, path: &Path) -> Result<(), TilesError> {
        write_whole(path, |out| {
            let mut bytes = MARK.to_vec();
            bytes.extend(self.n_vertices.to_le_bytes());
            bytes.extend(self.n_records.to_le_bytes());
            bytes.extend((self.firsts.len() as u64).to_le_bytes());
            for (first, bounds) in self.firsts.iter().zip(&self.boxes) {
                bytes.extend(first.to_le_bytes());
                bytes.extend(bounds.lo.iter().chain(&bounds.hi).flat_map(|c| c.to_le_bytes()));
            }
            out.write_all(&bytes).map_err(TilesError::io(path))
        })
    }
}

impl Blocks {
    pub(crate) fn open(table: &Path, records: &Path, layout: Layout) -> Result<Self, TilesError> {
        let bytes = std::fs::read(table).map_err(TilesError::io(table))?;
        Self::parse(&bytes, records, layout)?.ok_or_else(|| TilesError::broken(table, "it ends early"))
    }

    fn parse(bytes: &[u8], records: &Path, layout: Layout) -> Result<Option<Self>, TilesError> {
        let records = At::open(records)?;
        let parsed = || {
            let mut cursor = Cursor { bytes: bytes.strip_prefix(MARK)? };
            let (n_vertices, n_records, n_blocks) = (cursor.u64()?, cursor.u64()?, cursor.u64()?);
            let (mut firsts, mut boxes) = (Vec::new(), Vec::new());
            for _ in 0..n_blocks {
                firsts.push(cursor.u64()?);
                let mut bounds = Bounds::NONE;
                for side in bounds.lo.iter_mut().chain(&mut bounds.hi) {
                    *side = cursor.f64()?;
                }
                boxes.push(bounds);
            }
            firsts.push(n_records);
            (n_vertices.div_ceil(VERTICES_IN_A_BLOCK as u64) == n_blocks)
                .then_some((firsts, boxes, n_vertices))
        };
        Ok(parsed().map(|(firsts, boxes, n_vertices)| Self { records, layout, firsts, boxes, n_vertices }))
    }

    pub(crate) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// The vertices of a block, by their number along the curve.
    pub(crate) fn vertices(&self, block: usize) -> std::ops::Range<usize> {
        let first = block * VERTICES_IN_A_BLOCK;
        first..(first + VERTICES_IN_A_BLOCK).min(self.n_vertices as usize)
    }

    /// How many records are before a block; of the block after the last, how many there are.
    pub(crate) fn first_record(&self, block: usize) -> u64 {
        self.firsts[block]
    }

    /// The records of a block, whole.
    pub(crate) fn records(&self, block: usize) -> Result<Vec<u8>, TilesError> {
        let (first, end) = (self.firsts[block], self.firsts[block + 1]);
        let Some(n) = end.checked_sub(first) else {
            return Err(TilesError::broken(self.records.path(), "its table is not sorted"));
        };
        let record_bytes = self.layout.record_bytes();
        self.records.read(first * record_bytes as u64, n as usize * record_bytes)
    }

    /// The positions of the vertices of a block, in model units.
    pub(crate) fn positions(&self, block: usize) -> Result<Vec<[f64; 3]>, TilesError> {
        let mut positions = Vec::with_capacity(VERTICES_IN_A_BLOCK);
        let records = self.records(block)?;
        for same in self.of_one_vertex(&records) {
            positions.push(self.layout.position(same));
        }
        if positions.len() != self.vertices(block).len() {
            return Err(TilesError::broken(self.records.path(), "its points are not those of its table"));
        }
        Ok(positions)
    }

    /// The records of a block, taken together where they are of one vertex.
    pub(crate) fn of_one_vertex<'a>(&self, records: &'a [u8]) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, position_bytes) = (self.layout.record_bytes(), self.layout.position_bytes());
        let mut rest = records;
        std::iter::from_fn(move || {
            let here = rest.get(..position_bytes)?;
            let n = rest.chunks_exact(bytes).take_while(|record| &record[..position_bytes] == here).count();
            let (same, after) = rest.split_at(n * bytes);
            rest = after;
            (n > 0).then_some(same)
        })
    }
}
