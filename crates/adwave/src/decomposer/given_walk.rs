//! A shape with a given walk or operator instead of its own.

use super::{Decomposer, transform};
use crate::Progress;
use crate::bands::{BandsError, BandsParams, Transform};
use crate::operator::{Diffusion, DiffusionError, Operator};
use crate::rows::CompressedRows;

impl Decomposer {
    /// This shape with the given walk as its diffusion operator (see [`Diffusion::from_walk`]): row x of `walk` holds
    /// the probabilities of a step from vertex x, with its diagonal, in the order of the shape. O(entries).
    ///
    /// Bands, filters, saliency and features are then those of the walk. Regions still measure along the edges of the
    /// shape.
    ///
    /// # Errors
    /// [`DiffusionError`] unless the matrix has a row for each vertex, no two vertices of the shape are welded, entries
    /// are finite and ≥ 0, and rows sum to 1; or if the call is cancelled.
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
        let map = self.vertex_map();
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
        Ok(self.with_transform(transform(diffusion)))
    }

    /// This shape with any operator that can be multiplied (see [`Operator`]), whose row x belongs to the welded vertex
    /// x of [`vertex_map`](Self::vertex_map), not to vertex x of the shape:
    /// [`VertexMap::welded`](crate::shape::VertexMap::welded) maps one to the other. O(one product).
    ///
    /// Bands, filters, saliency and features are those of the operator. Regions, and the neighbors of features, follow
    /// the edges of the shape unless the operator has rows. A mask needs an operator that can leave places out
    /// ([`Operator::masked`]).
    ///
    /// # Errors
    /// As for [`Transform::from_operator`], and [`BandsError::WrongNumber`] unless the operator has a row for each
    /// welded vertex.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// use adwave::operator::RowFunction;
    /// use adwave::shape::{PointCloud, Shape};
    /// use adwave::Decomposer;
    /// // Points on a circle. A step leads to the point on the other side, or stays.
    /// let angle = |i: u32| std::f64::consts::PI * f64::from(i) / 4.0;
    /// let points: Vec<_> = (0..8).map(|i| [angle(i).cos(), angle(i).sin(), 0.0]).collect();
    /// let circle = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone())?));
    /// let map = circle.vertex_map().clone();
    /// let vertex: Vec<usize> = (0..8).map(|x| (0..8).find(|&v| map.welded(v) == x).unwrap()).collect();
    /// let across = RowFunction::new(8, move |x| [(map.welded((vertex[x] + 4) % 8), 0.5)])?;
    /// let across = circle.with_operator(across)?;
    /// let bands = across.decompose(points.as_flattened(), 3, &Schedule::dyadic(1)?)?;
    /// assert!(bands.coarsest().iter().all(|v| v.abs() < 1e-12)); // the mean of opposite points
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_operator(&self, operator: impl Operator + 'static) -> Result<Self, BandsError> {
        let (n_given, expected) = (operator.n_rows(), self.n_places());
        if n_given != expected {
            return Err(BandsError::WrongNumber { what: "rows of the operator", n_given, expected });
        }
        Ok(self.with_transform(Transform::from_operator(operator, &BandsParams::default())?))
    }
}
