//! The transpose Φ₁ᵀ in single precision: the columns of Φ₁.

use crate::operator::Diffusion;

/// Number of entries per group of a column, so that the length of a column is easy to predict for a processor.
pub(super) const GROUP: usize = 4;

/// Rows and weights of some entries of a column; padding entries name the column itself with weight 0.
pub(super) type Group = [(u32, f32); GROUP];

/// The columns of Φ₁: the entries of column `y`, its diagonal first, are the groups `starts[y]..starts[y + 1]`.
#[derive(Debug)]
pub(super) struct Transpose {
    starts: Vec<usize>,
    groups: Vec<Group>,
}

impl Transpose {
    /// Transposes Φ₁. O(entries).
    pub(super) fn new(diffusion: &Diffusion) -> Self {
        let n = diffusion.n_vertices();
        let mut filled = vec![1_usize; n]; // the diagonal
        for &y in diffusion.neighbors().columns() {
            filled[y as usize] += 1;
        }
        let mut starts = vec![0_usize; n + 1];
        for y in 0..n {
            starts[y + 1] = starts[y] + filled[y].div_ceil(GROUP);
        }
        let mut groups = Vec::with_capacity(starts[n]);
        for y in 0..n {
            groups.resize(starts[y + 1], [(y as u32, 0.0); GROUP]);
            groups[starts[y]][0].1 = diffusion.diagonal(y) as f32;
        }
        filled.fill(1);
        for x in 0..n {
            let (columns, values) = diffusion.row(x);
            for (&y, &w) in columns.iter().zip(values) {
                let at = &mut filled[y as usize];
                groups[starts[y as usize] + *at / GROUP][*at % GROUP] = (x as u32, w as f32);
                *at += 1;
            }
        }
        Self { starts, groups }
    }

    /// The entries of column `y`.
    #[inline]
    pub(super) fn column(&self, y: u32) -> &[Group] {
        &self.groups[self.starts[y as usize]..self.starts[y as usize + 1]]
    }

    /// Bytes that this takes for an operator of `nnz` entries over `n` vertices.
    pub(super) fn bytes(n: usize, nnz: usize) -> u64 {
        (size_of::<(u32, f32)>() * (nnz + n * (GROUP - 1)) + 16 * n) as u64
    }
}
