//! The neighbors of a tile's vertices, and the file that stores them block by block.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;

use crate::bytes::{ByteCursor, push_varint};
use crate::error::TilesError;
use crate::files::{RandomAccessFile, write_atomic};

/// Neighbor lists of the vertices of a block, in compressed rows. In a cloud a list has the k nearest neighbors, so
/// that the relation is not symmetric; in a mesh it has the one-ring.
#[derive(Debug, PartialEq)]
pub(crate) struct NeighborLists {
    /// Distance to the k-th neighbor in a cloud, area of the vertex in a mesh; one per vertex.
    pub(crate) measures: Vec<f64>,
    /// Start of each list in `neighbors`, then the end of the last one.
    pub(crate) offsets: Vec<u32>,
    /// Vertex indices, ascending within each list.
    pub(crate) neighbors: Vec<u32>,
}

impl NeighborLists {
    pub(crate) fn new() -> Self {
        Self { measures: Vec::new(), offsets: vec![0], neighbors: Vec::new() }
    }

    /// Neighbors of the `i`-th vertex of the block.
    pub(crate) fn list(&self, i: usize) -> &[u32] {
        &self.neighbors[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// Ends a list after its neighbors have been appended to `neighbors`.
    pub(crate) fn end_list(&mut self) {
        self.offsets.push(self.neighbors.len() as u32);
    }

    /// Encodes the measures, then per vertex its number of neighbors, the first neighbor as a difference from the
    /// vertex, and each other neighbor as a difference from the one before.
    fn encode(&self, first_vertex: usize) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(8 * self.measures.len() + 2 * self.neighbors.len());
        bytes.extend(self.measures.iter().flat_map(|r| r.to_le_bytes()));
        for i in 0..self.measures.len() {
            let list = self.list(i);
            push_varint(&mut bytes, list.len() as u64);
            let Some(&first) = list.first() else { continue };
            let step = i64::from(first) - (first_vertex + i) as i64;
            push_varint(&mut bytes, (step << 1 ^ step >> 63).cast_unsigned());
            for pair in list.windows(2) {
                push_varint(&mut bytes, u64::from(pair[1] - pair[0]));
            }
        }
        bytes
    }

    /// Decodes the lists of the block with these `vertices`, of `n_vertices` in all; `None` if the bytes are invalid.
    fn decode(bytes: &[u8], vertices: &Range<usize>, n_vertices: u64) -> Option<Self> {
        let mut cursor = ByteCursor { bytes };
        let mut lists = Self { measures: decode_measures(&mut cursor, vertices.len())?, ..Self::new() };
        for vertex in vertices.clone() {
            let n_neighbors = cursor.varint()?;
            let mut neighbor = 0;
            for k in 0..n_neighbors {
                let step = cursor.varint()?;
                let step = if k == 0 {
                    (vertex as i64).checked_add((step >> 1).cast_signed() ^ -((step & 1).cast_signed()))?
                } else {
                    i64::try_from(step).ok()?
                };
                neighbor = step.checked_add(if k == 0 { 0 } else { neighbor })?;
                if !(0..n_vertices as i64).contains(&neighbor) {
                    return None;
                }
                lists.neighbors.push(neighbor as u32);
            }
            lists.end_list();
        }
        cursor.bytes.is_empty().then_some(lists)
    }
}

/// Reads `n` distances or areas, which must be finite and not negative.
fn decode_measures(cursor: &mut ByteCursor<'_>, n: usize) -> Option<Vec<f64>> {
    (0..n).map(|_| cursor.f64().filter(|r| (0.0..f64::INFINITY).contains(r))).collect()
}

/// First bytes of a neighbor file.
const MAGIC: &[u8; 8] = b"adwnear1";

/// Sums over the neighbor lists of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BlockSummary {
    /// Sum of the distances to all neighbors. In a mesh each edge counts once, at its end with the smaller index.
    pub(crate) distance_sum: f64,
    /// Number of terms of that sum.
    pub(crate) n_distances: u64,
    /// Largest distance to a k-th neighbor; 0 in a mesh.
    pub(crate) max_radius: f64,
}

/// Neighbor lists of one block with their sums.
pub(crate) struct BlockNeighbors {
    pub(crate) first_vertex: usize,
    pub(crate) lists: NeighborLists,
    pub(crate) summary: BlockSummary,
}

/// Bytes of the file before its table, and of a table row.
const HEADER_BYTES: usize = 8 + 16;
const ROW_BYTES: usize = 32;

/// Writes the neighbor lists of consecutive blocks, of which `first_block` is the first.
pub(crate) fn write_neighbor_file(
    path: &Path,
    first_block: usize,
    blocks: &[BlockNeighbors],
) -> Result<(), TilesError> {
    write_atomic(path, |out| {
        let encoded: Vec<Vec<u8>> =
            blocks.par_iter().map(|block| block.lists.encode(block.first_vertex)).collect();
        let mut head = MAGIC.to_vec();
        head.extend((first_block as u64).to_le_bytes());
        head.extend((blocks.len() as u64).to_le_bytes());
        let mut end = (HEADER_BYTES + ROW_BYTES * blocks.len()) as u64;
        for (block, bytes) in blocks.iter().zip(&encoded) {
            let BlockSummary { distance_sum, n_distances, max_radius } = block.summary;
            end += bytes.len() as u64;
            head.extend(end.to_le_bytes());
            head.extend(distance_sum.to_le_bytes());
            head.extend(n_distances.to_le_bytes());
            head.extend(max_radius.to_le_bytes());
        }
        out.write_all(&head).map_err(TilesError::io(path))?;
        encoded.iter().try_for_each(|bytes| out.write_all(bytes)).map_err(TilesError::io(path))
    })
}

/// A neighbor file of a tile; the table is in memory.
#[derive(Debug)]
pub(crate) struct NeighborFile {
    file: RandomAccessFile,
    first_block: usize,
    /// Start of each block in the file, then the end of the last one.
    offsets: Vec<u64>,
    pub(crate) summaries: Vec<BlockSummary>,
}

impl NeighborFile {
    /// Opens the file of the blocks `range`.
    pub(crate) fn open(path: &Path, range: &Range<usize>) -> Result<Self, TilesError> {
        let file = RandomAccessFile::open(path)?;
        let head = file.read(0, HEADER_BYTES)?;
        let broken = |reason: &str| TilesError::broken(path, reason);
        let mut cursor = ByteCursor {
            bytes: head.strip_prefix(MAGIC).ok_or_else(|| broken("it is not a neighbor file"))?,
        };
        let (Some(first_block), Some(n_blocks)) = (cursor.u64(), cursor.u64()) else {
            return Err(broken("it ends early"));
        };
        if (first_block, n_blocks) != (range.start as u64, range.len() as u64) {
            return Err(broken("it belongs to other blocks"));
        }
        let table = file.read(HEADER_BYTES as u64, ROW_BYTES * range.len())?;
        let mut cursor = ByteCursor { bytes: &table };
        let (mut offsets, mut summaries) = (vec![HEADER_BYTES as u64 + table.len() as u64], Vec::new());
        let mut row = || {
            let end = cursor.u64()?;
            let (distance_sum, n_distances, max_radius) = (cursor.f64()?, cursor.u64()?, cursor.f64()?);
            Some((end, BlockSummary { distance_sum, n_distances, max_radius }))
        };
        for _ in 0..n_blocks {
            let (end, summary) = row().ok_or_else(|| broken("it ends early"))?;
            offsets.push(end);
            summaries.push(summary);
        }
        if !offsets.is_sorted() {
            return Err(broken("its table is not sorted"));
        }
        Ok(Self { file, first_block: range.start, offsets, summaries })
    }

    /// Reads the measures of a block of `n` vertices.
    pub(crate) fn read_measures(&self, block: usize, n: usize) -> Result<Vec<f64>, TilesError> {
        let bytes = self.file.read(self.offsets[block - self.first_block], size_of::<f64>() * n)?;
        decode_measures(&mut ByteCursor { bytes: &bytes }, n).ok_or_else(|| self.invalid_lists())
    }

    /// Reads the neighbor lists of the block with these `vertices`, of `n_vertices` in all.
    pub(crate) fn read_lists(
        &self,
        block: usize,
        vertices: &Range<usize>,
        n_vertices: u64,
    ) -> Result<NeighborLists, TilesError> {
        let i = block - self.first_block;
        let bytes = self.file.read(self.offsets[i], (self.offsets[i + 1] - self.offsets[i]) as usize)?;
        NeighborLists::decode(&bytes, vertices, n_vertices).ok_or_else(|| self.invalid_lists())
    }

    fn invalid_lists(&self) -> TilesError {
        TilesError::broken(self.file.path(), "its neighbor lists are incomplete")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoded_lists_decode_and_broken_ones_do_not() {
        let lists = NeighborLists {
            measures: vec![0.5, 1e-300, 0.0],
            offsets: vec![0, 3, 3, 5],
            neighbors: vec![0, 7, 900_000, 101, 103],
        };
        let bytes = lists.encode(100);
        assert_eq!(NeighborLists::decode(&bytes, &(100..103), 1_000_000), Some(lists));
        assert_eq!(NeighborLists::decode(&bytes, &(100..103), 900_000), None);
        for cut in 0..bytes.len() {
            assert_eq!(NeighborLists::decode(&bytes[..cut], &(100..103), 1_000_000), None);
        }
        assert_eq!(NeighborLists::decode(&[0xff; 64], &(0..1), 10), None);
    }
}
