//! The neighborhoods of a tile's vertices, by blocks.

use std::io::Write;
use std::path::Path;

use crate::TilesError;
use crate::files::{At, Cursor, push_varint, write_whole};

/// The neighborhoods of the vertices of a block: in a cloud who is named, not who names.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Near {
    /// What areas are made of: in a cloud the distance to the k-th neighbor, in a mesh the area itself.
    pub(crate) measures: Vec<f64>,
    /// Where the neighbors of each vertex begin, and where the last ones end.
    pub(crate) offsets: Vec<u32>,
    /// Their places along the curve, rising for each vertex.
    pub(crate) places: Vec<u32>,
}

impl Near {
    pub(crate) fn of(&self, i: usize) -> &[u32] {
        &self.places[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// Measures, then for each vertex how many neighbors, the first as a step from the vertex and each other from the one before.
    fn encode(&self, first: usize) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(8 * self.measures.len() + 2 * self.places.len());
        bytes.extend(self.measures.iter().flat_map(|r| r.to_le_bytes()));
        for i in 0..self.measures.len() {
            let near = self.of(i);
            push_varint(&mut bytes, near.len() as u64);
            let Some(&nearest) = near.first() else { continue };
            let step = i64::from(nearest) - (first + i) as i64;
            push_varint(&mut bytes, (step << 1 ^ step >> 63).cast_unsigned());
            for pair in near.windows(2) {
                push_varint(&mut bytes, u64::from(pair[1] - pair[0]));
            }
        }
        bytes
    }

    /// What [`encode`](Self::encode) wrote for the vertices from `first` on, of `n_vertices` in all.
    fn decode(bytes: &[u8], first: usize, n: usize, n_vertices: u64) -> Option<Self> {
        let mut cursor = Cursor { bytes };
        let mut near = Self { measures: measures(&mut cursor, n)?, offsets: vec![0], places: Vec::new() };
        for i in 0..n {
            let count = cursor.varint()?;
            let mut place = 0;
            for k in 0..count {
                let step = cursor.varint()?;
                let step = if k == 0 {
                    ((first + i) as i64)
                        .checked_add((step >> 1).cast_signed() ^ -((step & 1).cast_signed()))?
                } else {
                    i64::try_from(step).ok()?
                };
                place = step.checked_add(if k == 0 { 0 } else { place })?;
                if !(0..n_vertices as i64).contains(&place) {
                    return None;
                }
                near.places.push(place as u32);
            }
            near.offsets.push(near.places.len() as u32);
        }
        cursor.bytes.is_empty().then_some(near)
    }
}

/// Distances or areas, which are finite.
fn measures(cursor: &mut Cursor<'_>, n: usize) -> Option<Vec<f64>> {
    (0..n).map(|_| cursor.f64().filter(|r| (0.0..f64::INFINITY).contains(r))).collect()
}

/// What begins such a file.
const MARK: &[u8; 8] = b"adwnear1";

/// What is known of a block without its neighborhoods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BlockSummary {
    /// The sum of the distances to all neighbors, in a mesh of those later along the curve, and how many these are.
    pub(crate) sum: f64,
    pub(crate) n_neighbors: u64,
    /// The largest distance to a k-th neighbor; 0 in a mesh.
    pub(crate) radius: f64,
}

/// Bytes of the file before its table, and of the table for each block.
const HEAD: usize = 8 + 16;
const ROW: usize = 32;

/// Writes the neighborhoods of the blocks from `first_block` on; each with the number of its first vertex.
pub(crate) fn write(
    path: &Path,
    first_block: usize,
    blocks: &[(usize, Near, BlockSummary)],
) -> Result<(), TilesError> {
    use rayon::prelude::*;
    write_whole(path, |out| {
        let encoded: Vec<Vec<u8>> = blocks.par_iter().map(|(first, near, _)| near.encode(*first)).collect();
        let mut head = MARK.to_vec();
        head.extend((first_block as u64).to_le_bytes());
        head.extend((blocks.len() as u64).to_le_bytes());
        let mut end = (HEAD + ROW * blocks.len()) as u64;
        for ((_, _, summary), bytes) in blocks.iter().zip(&encoded) {
            end += bytes.len() as u64;
            head.extend(end.to_le_bytes());
            head.extend(summary.sum.to_le_bytes());
            head.extend(summary.n_neighbors.to_le_bytes());
            head.extend(summary.radius.to_le_bytes());
        }
        out.write_all(&head).map_err(TilesError::io(path))?;
        encoded.iter().try_for_each(|bytes| out.write_all(bytes)).map_err(TilesError::io(path))
    })
}

/// A file of neighborhoods, its table in memory.
#[derive(Debug)]
pub(crate) struct NearFile {
    file: At,
    first_block: usize,
    /// Where each block begins, and where the last one ends.
    offsets: Vec<u64>,
    pub(crate) summaries: Vec<BlockSummary>,
}

impl NearFile {
    /// That of the blocks `range`.
    pub(crate) fn open(path: &Path, range: &std::ops::Range<usize>) -> Result<Self, TilesError> {
        let file = At::open(path)?;
        let head = file.read(0, HEAD)?;
        let broken = |what: &str| TilesError::broken(path, what);
        let mut cursor =
            Cursor { bytes: head.strip_prefix(MARK).ok_or_else(|| broken("it is another file"))? };
        let (Some(first_block), Some(n_blocks)) = (cursor.u64(), cursor.u64()) else {
            return Err(broken("it ends early"));
        };
        if (first_block, n_blocks) != (range.start as u64, range.len() as u64) {
            return Err(broken("it is of other blocks"));
        }
        let table = file.read(HEAD as u64, ROW * range.len())?;
        let mut cursor = Cursor { bytes: &table };
        let (mut offsets, mut summaries) = (vec![HEAD as u64 + table.len() as u64], Vec::new());
        let mut row = || {
            let end = cursor.u64()?;
            Some((
                end,
                BlockSummary { sum: cursor.f64()?, n_neighbors: cursor.u64()?, radius: cursor.f64()? },
            ))
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

    /// The measures of a block of `n` vertices.
    pub(crate) fn measures(&self, block: usize, n: usize) -> Result<Vec<f64>, TilesError> {
        let bytes = self.file.read(self.offsets[block - self.first_block], size_of::<f64>() * n)?;
        measures(&mut Cursor { bytes: &bytes }, n)
            .ok_or_else(|| TilesError::broken(self.file.path(), "its neighborhoods are not whole"))
    }

    /// The neighborhoods of a block, whose vertices are `vertices`, of `n_vertices` in all.
    pub(crate) fn near(
        &self,
        block: usize,
        vertices: &std::ops::Range<usize>,
        n_vertices: u64,
    ) -> Result<Near, TilesError> {
        let i = block - self.first_block;
        let bytes = self.file.read(self.offsets[i], (self.offsets[i + 1] - self.offsets[i]) as usize)?;
        Near::decode(&bytes, vertices.start, vertices.len(), n_vertices)
            .ok_or_else(|| TilesError::broken(self.file.path(), "its neighborhoods are not whole"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighborhoods_come_back_and_broken_ones_do_not() {
        let near = Near {
            measures: vec![0.5, 1e-300, 0.0],
            offsets: vec![0, 3, 3, 5],
            places: vec![0, 7, 900_000, 101, 103],
        };
        let bytes = near.encode(100);
        assert_eq!(Near::decode(&bytes, 100, 3, 1_000_000), Some(near));
        assert_eq!(Near::decode(&bytes, 100, 3, 900_000), None);
        for cut in 0..bytes.len() {
            assert_eq!(Near::decode(&bytes[..cut], 100, 3, 1_000_000), None);
        }
        assert_eq!(Near::decode(&[0xff; 64], 0, 1, 10), None);
    }
}
