//! A shape with a given walk instead of its own.

use super::{Decomposer, transform};
use crate::Progress;
use crate::operator::{Diffusion, DiffusionError};
use crate::rows::CompressedRows;
use std::sync::Arc;

impl Decomposer {
    /// This shape with the given walk as its diffusion operator (see [`Diffusion::from_walk`]): row x of `walk` holds the
    /// probabilities of a step from vertex x, with its diagonal, in the order of the shape. O(entries).
    ///
    /// Bands, filters, saliency and features are then those of the walk. Regions still measure along the edges of the shape.
    ///
    /// # Errors
    /// [`DiffusionError`] unless the matrix has a row for each vertex, no two vertices of the shape are welded, entries are
    /// finite and ≥ 0, and rows sum to 1; or if the call is cancelled.
    ///
    /// ```
    /// use adwave::{Decomposer, Progress, bands::Schedule, rows::CompressedRows, shape::{Graph, Shape}};
    /// let pair = Decomposer::new(&Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?));
    /// let swap = CompressedRows::new(vec![0, 1, 2], vec![1, 0], vec![1.0, 1.0], 2)?;
    /// let bands = pair.with_walk(&swap, Progress::none())?.decompose(&[1.0, 3.0], 1, &Schedule::dyadic(1)?)?;
    /// assert_eq!(bands.coarsest(), [3.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_walk(
        &self,
        walk: &CompressedRows<f64>,
        progress: Progress<'_>,
    ) -> Result<Self, DiffusionError> {
        let map = self.geometry.vertex_map();
        let (n_rows, n_vertices) = (walk.n_rows(), map.n_vertices());
        if n_rows != n_vertices || map.n_welded() != n_vertices {
            return Err(DiffusionError::RowCount { n_rows, n_vertices: map.n_welded() });
        }
        let is_square = walk.columns().iter().all(|&y| (y as usize) < n_rows);
        let diffusion = if is_square {
            Diffusion::from_walk(&walk.permute(map.as_slice()), progress)?
        } else {
            Diffusion::from_walk(walk, progress)?
        };
        Ok(Self {
            transform: transform(diffusion),
            surface_info: None,
            ring: Arc::default(),
            metric: Arc::default(),
            ..self.clone()
        })
    }
}
