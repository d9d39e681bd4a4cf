//! The domain of a walk that is given by its rows.

use super::Domain;
use crate::Progress;
use crate::operator::{Diffusion, DiffusionError};
use crate::rows::CompressedRows;
use crate::shape::{VertexMap, reverse_cuthill_mckee};

/// The states of a walk, numbered so that neighbors are close in memory. They have no positions; their neighbors are
/// those between which the walk steps.
#[derive(Clone, Debug)]
pub struct WalkDomain {
    vertex_map: VertexMap,
}

impl WalkDomain {
    /// The states of a walk, n × n with its diagonal (see [`Diffusion::from_walk`]), and its diffusion operator in
    /// their order. O(entries · log).
    ///
    /// # Errors
    /// [`DiffusionError`] unless the matrix is square, entries are finite and ≥ 0, and rows sum to 1; or if the call is
    /// cancelled.
    pub fn new(
        walk: &CompressedRows<f64>,
        progress: Progress<'_>,
    ) -> Result<(Self, Diffusion), DiffusionError> {
        let n = walk.n_rows();
        if let Some(&y) = walk.columns().iter().find(|&&y| y as usize >= n) {
            return Err(DiffusionError::RowCount { n_rows: n, n_vertices: y as usize + 1 });
        }
        let steps = |(): &mut (), x: usize, columns: &mut Vec<u32>| {
            let (others, values) = walk.row(x);
            let steps = others.iter().zip(values).filter(|(y, w)| **y as usize != x && **w > 0.0);
            columns.extend(steps.map(|(y, _)| *y));
            columns.sort_unstable();
        };
        let steps = crate::rows::Pattern::from_rows(n, progress, || (), steps)?;
        let neighbors = steps.union_with_transpose(progress)?;
        let vertex_map = VertexMap::from_places(reverse_cuthill_mckee(&neighbors, progress)?);
        let diffusion = Diffusion::from_walk(&walk.permute(vertex_map.as_slice()), progress)?;
        Ok((Self { vertex_map }, diffusion))
    }
}

impl Domain for WalkDomain {
    fn vertex_map(&self) -> &VertexMap {
        &self.vertex_map
    }

    fn has_neighbors(&self) -> bool {
        false
    }
}
