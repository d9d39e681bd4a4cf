//! The local operator T (eq. 1), for meshes, clouds and graphs.

use super::density::{LengthNeighbors, measure, neighbors_within_length};
use super::guided::sharpness;
use super::{CloudGraph, OperatorParams};
use crate::rows::{CompressedRows, rows_at_a_time, try_visit_entries};
use crate::shape::{
    Adjacency, CloudArea, Graph, PreparedGeometry, Shape, mean_edge_length, squared_distance,
    try_cloud_areas, try_k_rings,
};
use crate::{Cancelled, Progress, parallel};

/// Off-diagonal entries of T, n_vertices × n_vertices, each row divided by its own factor so that it cannot
/// underflow.
///
/// `T(x,y) = A(y)·exp(−‖x−y‖²/4t)` for `y` in `N(x)`, `T(x,x) = Σ_{y≠x} T(x,y)` (eq. 1). All entries are ≥ 0. T is
/// not symmetric, but `A(x)·T(x,y)` is if the neighborhoods are.
///
/// It is the Laplacian L of `belkin2008` with the sign of its diagonal D_L reversed: `T = 4πt²·(L − 2D_L)` (eq. 2).
#[derive(Clone, Debug)]
pub struct LocalOperator {
    pub(super) rows: CompressedRows<f64>,
    pub(super) log_factor: Vec<f64>,
    pub(super) areas: Vec<f64>,
    /// Measure m that replaces areas if the density is removed.
    pub(super) measure: Option<Vec<f64>>,
    pub(super) mean_square: Vec<f64>,
    pub(super) mean_length: f64,
    /// Standard deviation of the kernel along one axis, in model units.
    pub(super) width: f64,
    pub(super) is_reversible: bool,
}

impl LocalOperator {
    /// Entries `T(x,y)·exp(−log_factor[x])` for `y ≠ x`, in an arbitrary unit of area.
    pub fn rows(&self) -> &CompressedRows<f64> {
        &self.rows
    }

    /// Pattern of the entries: the neighborhoods N(x).
    pub fn neighbors(&self) -> &Adjacency {
        self.rows.pattern()
    }

    /// Logarithm of the divisor of each row.
    pub fn log_factor(&self) -> &[f64] {
        &self.log_factor
    }

    /// Area A of each vertex in squared model units (1 for a graph).
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Mean square distance of the neighbors, `Σ_y T(x,y)·‖x−y‖² / Σ_y T(x,y)` over `y ≠ x`, in squared model units
    /// (1 for a graph, 0 at a vertex without steps).
    pub fn mean_square(&self) -> &[f64] {
        &self.mean_square
    }

    /// Mean edge length E, or mean distance to the nearest neighbors, in model units (1 for a graph).
    pub fn mean_length(&self) -> f64 {
        self.mean_length
    }

    /// True if the neighborhoods are symmetric, so that the diffusion is reversible.
    pub fn is_reversible(&self) -> bool {
        self.is_reversible
    }

    /// Time t of the kernel `exp(−d²/4t)` (eq. 1), in squared model units: E²/2, or the width of neighborhoods by
    /// length ([`density_invariant`](OperatorParams::density_invariant)).
    pub fn time(&self) -> f64 {
        self.width * self.width / 2.0
    }
}

/// Reach of neighborhoods by length on a mesh, in lengths of the longest edge of a vertex; it gives about as many
/// neighbors as on a cloud.
const MESH_REACH: f64 = 1.5;

/// Number of reported stages: neighbors, areas, values.
const STAGES: u64 = 3;

/// Builds T (eq. 1) for a prepared shape. O(entries), for clouds O(n log n).
///
/// A vertex without a neighbor of positive area gets an empty row, so that a walk that starts there stays there.
/// Choices that the paper leaves open: the neighborhood is the one-ring on a mesh and the union of both directions on a
/// cloud; each row is shifted by its smallest d² before `exp`, which does not change the normalized row.
///
/// With [`density_invariant`](OperatorParams::density_invariant) the neighbors are those within one length that is
/// the same everywhere, t follows from that length, and `T(x,y) = m(y)·exp(−‖x−y‖²/4t)`. Here m is A divided by the
/// density estimate `q(x) = A(x) + Σ_{y≠x} A(y)·exp(−‖x−y‖²/4t)` of the kernel (`coifmanlafon2006`, α = 1), and
/// three more times by the remaining density. On a graph the neighbors stay and `T(x,y) = w(x,y)/(q(x)·q(y))`,
/// `q(x) = Σ_y w(x,y)`.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub fn local_operator(
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    progress.step(0, STAGES)?;
    let operator = match geometry.shape() {
        Shape::Mesh(_) => mesh_operator(geometry, params, progress),
        Shape::Cloud(_) => cloud_operator(geometry, params, progress),
        Shape::Graph(graph) => graph_operator(graph, geometry, params, progress),
    }?;
    progress.step(STAGES, STAGES)?;
    Ok(operator)
}

/// Builds T (eq. 1) for a cloud, or a part of one, with known neighborhoods, areas and E:
/// `T(x,y) = A(y)·exp(−‖x−y‖²/2E²)` for y in row x of `neighbors`. `points` and `mean_length` (E) are in model
/// units, `areas` in squared model units. O(entries).
///
/// A row depends on its own entries only: rows of a part of a cloud have the bits of the whole if all their
/// neighbors are present. `neighbors` is taken as symmetric.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// Unless `neighbors` has one row and one column, and `areas` one value, per point.
pub fn local_operator_of_neighbors(
    points: &[[f64; 3]],
    neighbors: Adjacency,
    areas: Vec<f64>,
    mean_length: f64,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    assert_eq!(neighbors.n_rows(), points.len(), "a row of neighbors for each point");
    assert_eq!(areas.len(), points.len(), "an area for each point");
    OperatorKernel { points, unit: 1.0, area_unit: 1.0, areas, mean_length }
        .operator(neighbors, true, progress)
}

fn mesh_operator(
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    let (points, unit) = geometry.unit_points(progress)?;
    let at_vertex = geometry.incidence(progress)?;
    let ring = at_vertex.ring(progress)?;
    progress.step(1, STAGES)?;
    let mean_length = mean_edge_length(&points, &ring, progress)?;
    let areas = at_vertex.areas(&points, params.mesh_area, progress)?;
    drop(at_vertex);
    progress.step(2, STAGES)?;
    let neighbors = if params.rings > 1 { try_k_rings(&ring, params.rings, progress)? } else { ring };
    let kernel =
        OperatorKernel { points: &points, unit, area_unit: geometry.size_unit(), areas, mean_length };
    if !params.density_invariant {
        return kernel.operator(neighbors, true, progress);
    }
    let farthest = parallel::try_collect(points.len(), progress, |x| {
        let squares = neighbors.row(x).iter().map(|&y| squared_distance(&points[x], &points[y as usize]));
        MESH_REACH * squares.fold(0.0, f64::max).sqrt()
    })?;
    kernel.density_invariant(neighbors_within_length(&points, &neighbors, &farthest, progress)?, progress)
}

fn cloud_operator(
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    let (points, unit) = geometry.unit_points(progress)?;
    let near = geometry.nearest(&points, params.neighbors, progress)?;
    progress.step(1, STAGES)?;
    let total = parallel::try_sum(points.len(), progress, |x| {
        let lengths =
            near.adjacency.row(x).iter().map(|&y| squared_distance(&points[x], &points[y as usize]).sqrt());
        lengths.sum()
    })?;
    let mean_length = total / near.adjacency.nnz().max(1) as f64;
    let areas = try_cloud_areas(&points, &near, params.cloud_area, progress)?;
    progress.step(2, STAGES)?;
    let kernel =
        OperatorKernel { points: &points, unit, area_unit: geometry.size_unit(), areas, mean_length };
    let mut operator = match (params.cloud_graph, params.density_invariant) {
        (_, true) => {
            let next = near.adjacency.union_with_transpose(progress)?;
            kernel
                .density_invariant(neighbors_within_length(&points, &next, &near.radius, progress)?, progress)
        }
        (CloudGraph::Union, _) => {
            kernel.operator(near.adjacency.union_with_transpose(progress)?, true, progress)
        }
        (CloudGraph::Directed, _) => kernel.operator(near.adjacency, false, progress),
    }?;
    if params.cloud_area == CloudArea::Unit {
        operator.areas.fill(1.0); // an area of 1 has no unit to be scaled by
    }
    Ok(operator)
}

/// Kernel (eq. 1) of a mesh or cloud.
struct OperatorKernel<'a> {
    /// Positions, in units of `unit` model units.
    points: &'a [[f64; 3]],
    unit: f64,
    /// Unit of the areas in the entries, of the order of the shape, so that their sums neither overflow nor
    /// underflow.
    area_unit: f64,
    /// Areas A, in squares of `unit`.
    areas: Vec<f64>,
    /// Mean length E, in units of `unit`.
    mean_length: f64,
}

impl OperatorKernel<'_> {
    fn operator(
        self,
        neighbors: Adjacency,
        is_reversible: bool,
        progress: Progress<'_>,
    ) -> Result<LocalOperator, Cancelled> {
        let width = self.mean_length; // t = E²/2 (eq. 1)
        self.with_width(neighbors, width, is_reversible, progress)
    }

    /// Kernel over neighborhoods by length, divided by its density estimate.
    fn density_invariant(
        mut self,
        within: LengthNeighbors,
        progress: Progress<'_>,
    ) -> Result<LocalOperator, Cancelled> {
        let measure = measure(self.points, &self.areas, &within, progress)?;
        let areas = std::mem::replace(&mut self.areas, measure);
        let operator = self.with_width(within.neighbors, within.width, true, progress)?;
        Ok(LocalOperator { measure: Some(operator.areas), areas, ..operator })
    }

    fn with_width(
        mut self,
        neighbors: Adjacency,
        width: f64,
        is_reversible: bool,
        progress: Progress<'_>,
    ) -> Result<LocalOperator, Cancelled> {
        let (n, unit, area_unit) = (self.points.len(), self.unit, self.area_unit);
        // Both units are powers of two, so nothing is rounded.
        let scaled = |areas: &mut [f64], factor: f64| {
            parallel::try_visit_rows(areas, 1, 1 << 14, progress, |_, areas| {
                for a in areas {
                    *a = *a * factor * factor;
                }
            })
        };
        scaled(&mut self.areas, unit / area_unit)?;
        let mut values = crate::pages::zeros(neighbors.nnz());
        let mut per_row = vec![(0.0, 0.0); n];
        try_visit_entries(&neighbors, &mut values, &mut per_row, progress, |range, mut values, per_row| {
            for (x, kept) in range.zip(per_row) {
                let (row, after) = std::mem::take(&mut values).split_at_mut(neighbors.row(x).len());
                values = after;
                *kept = self.fill_row(x, neighbors.row(x), width, row);
            }
        })?;
        scaled(&mut self.areas, area_unit)?;
        Ok(LocalOperator {
            rows: CompressedRows::new_unchecked(neighbors, values),
            log_factor: parallel::try_collect(n, progress, |x| per_row[x].0)?,
            areas: self.areas,
            measure: None,
            mean_square: parallel::try_collect(n, progress, |x| per_row[x].1)?,
            mean_length: self.mean_length * unit,
            width: width * unit,
            is_reversible,
        })
    }

    /// Fills the row of `x` with neighbors `near`; returns the logarithm of the row's divisor and the mean square
    /// distance in squared model units.
    fn fill_row(&self, x: usize, near: &[u32], width: f64, row: &mut [f64]) -> (f64, f64) {
        let Self { points, unit, areas, .. } = self;
        // 1/4t = 1/2w² (eq. 1). If w is 0 all neighbors coincide, and the kernel is 1.
        let sharpness = sharpness(width * width);
        // Neighbors without area do not count for the shift, because they do not keep the row from underflowing.
        let mut nearest = f64::INFINITY;
        for (value, &y) in row.iter_mut().zip(near) {
            *value = squared_distance(&points[x], &points[y as usize]);
            if areas[y as usize] > 0.0 {
                nearest = nearest.min(*value);
            }
        }
        if nearest.is_infinite() {
            row.fill(0.0);
            return (0.0, 0.0);
        }
        let (mut sum, mut square) = (0.0, 0.0);
        for (value, &y) in row.iter_mut().zip(near) {
            let d2 = *value;
            // T(x,y) = A(y)·exp(−‖x−y‖²/4t) (eq. 1), the row divided by its largest kernel value.
            *value = areas[y as usize] * (-(d2 - nearest).max(0.0) * sharpness).exp();
            sum += *value;
            square += *value * d2;
        }
        (-nearest * sharpness, square / sum * unit * unit)
    }
}

/// Kernel of a graph: the weights themselves, with area 1 per node, and length 1 per edge unless there are positions.
/// Rows and columns are in the numbering of the prepared graph.
fn graph_operator(
    graph: &Graph,
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    let n = graph.n_nodes();
    let vertex_map = geometry.vertex_map();
    let (node_at, place) = (vertex_map.last_members(), vertex_map.as_slice());
    let largest_weight = |x: usize| {
        let weights = graph.rows().row(node_at[x] as usize).1;
        weights.iter().copied().fold(0.0, f64::max)
    };
    // Logarithm of the divisor of a row; sums of very large weights would overflow.
    let log_degree = |x: usize| {
        let (weights, largest) = (graph.rows().row(node_at[x] as usize).1, largest_weight(x));
        if largest > 0.0 { largest.ln() + weights.iter().map(|w| w / largest).sum::<f64>().ln() } else { 0.0 }
    };
    let log_degree =
        parallel::try_collect(if params.density_invariant { n } else { 0 }, progress, log_degree)?;
    let row = |row: &mut Vec<(u32, f64)>, x: usize, columns: &mut Vec<u32>, values: &mut Vec<f64>| {
        row.clear();
        row.extend(graph.neighbors(node_at[x] as usize).map(|(y, w)| (place[y as usize], w)));
        row.sort_unstable_by_key(|entry| entry.0);
        columns.extend(row.iter().map(|entry| entry.0));
        if params.density_invariant {
            let log = |(y, w): &(u32, f64)| w.ln() - log_degree[*y as usize];
            let largest = row.iter().map(log).fold(f64::NEG_INFINITY, f64::max);
            values.extend(row.iter().map(|entry| (log(entry) - largest).exp()));
        } else {
            let largest = largest_weight(x);
            let scale = if largest > 0.0 { largest } else { 1.0 };
            values.extend(row.iter().map(|entry| entry.1 / scale));
        }
    };
    let rows = CompressedRows::from_rows(n, rows_at_a_time(n), progress, Vec::new, row)?;
    progress.step(2, STAGES)?;
    let has_edges = |x: usize| largest_weight(x) > 0.0;
    let log_factor = parallel::try_collect(n, progress, |x| {
        if !has_edges(x) {
            return 0.0;
        }
        if !params.density_invariant {
            return largest_weight(x).ln();
        }
        let log = |(y, w): (u32, f64)| w.ln() - log_degree[place[y as usize] as usize];
        graph.neighbors(node_at[x] as usize).map(log).fold(f64::NEG_INFINITY, f64::max) - log_degree[x]
    })?;
    let points = geometry.points();
    let mean_square = |x: usize| {
        let (columns, weights) = rows.row(x);
        if points.is_empty() || !has_edges(x) {
            return if has_edges(x) { 1.0 } else { 0.0 };
        }
        let square = |y: u32| squared_distance(&points[x], &points[y as usize]);
        let sum: f64 = columns.iter().zip(weights).map(|(&y, w)| w * square(y)).sum();
        sum / weights.iter().sum::<f64>()
    };
    let mean_square = parallel::try_collect(n, progress, mean_square)?;
    let mean_length =
        if points.is_empty() { 1.0 } else { mean_edge_length(points, rows.pattern(), progress)? };
    Ok(LocalOperator {
        rows,
        log_factor,
        areas: vec![1.0; n],
        measure: None,
        mean_square,
        mean_length,
        width: mean_length,
        is_reversible: true,
    })
}
