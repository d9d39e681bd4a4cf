//! Φ₁ᵀ in single precision: for each vertex, where a step that arrives there came from.

use crate::operator::Diffusion;

/// The columns of Φ₁: the entries of column `y` are at `offsets[y]..offsets[y + 1]`, by rising row, without diagonal.
#[derive(Debug)]
pub(super) struct Arriving {
    offsets: Vec<usize>,
    sources: Vec<u32>,
    weights: Vec<f32>,
    diagonal: Vec<f32>,
}

impl Arriving {
    /// Transposes Φ₁. O(entries).
    pub(super) fn new(diffusion: &Diffusion) -> Self {
        let n = diffusion.n_vertices();
        let mut offsets = vec![0_usize; n + 1];
        for &y in &diffusion.neighbours().neighbours {
            offsets[y as usize + 1] += 1;
        }
        for y in 0..n {
            offsets[y + 1] += offsets[y];
        }
        let mut next = offsets.clone();
        let mut sources = vec![0; offsets[n]];
        let mut weights = vec![0.0; offsets[n]];
        for x in 0..n {
            let (columns, values) = diffusion.row(x);
            for (&y, &w) in columns.iter().zip(values) {
                let at = &mut next[y as usize];
                sources[*at] = x as u32;
                weights[*at] = w as f32;
                *at += 1;
            }
        }
        let diagonal = (0..n).map(|x| diffusion.diagonal(x) as f32).collect();
        Self { offsets, sources, weights, diagonal }
    }

    /// The off-diagonal entries of column `y`: rows and weights.
    pub(super) fn column(&self, y: u32) -> impl Iterator<Item = (u32, f32)> + '_ {
        let range = self.offsets[y as usize]..self.offsets[y as usize + 1];
        self.sources[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }

    /// `Φ₁(y,y)`.
    pub(super) fn diagonal(&self, y: u32) -> f32 {
        self.diagonal[y as usize]
    }

    /// Bytes that this takes for a walk of `nnz` entries over `n` vertices.
    pub(super) fn bytes(n: usize, nnz: usize) -> u64 {
        8 * nnz as u64 + 20 * n as u64
    }
}
