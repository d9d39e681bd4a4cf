//! The local operator T (eq. 1), for meshes, clouds and graphs.

use super::density::{ByLength, by_length, measure};
use super::guided::sharpness;
use super::{CloudGraph, OperatorParams};
use crate::rows::{CompressedRows, rows_at_a_time, try_for_entries};
use crate::shape::{
    Adjacency, CloudArea, Graph, PreparedGeometry, Shape, VertexMap, mean_edge_length, squared_distance,
    triangles_at_vertices, try_cloud_areas, try_k_rings, try_mesh_areas, try_nearest_neighbors, try_one_ring,
};
use crate::{Cancelled, Progress, parallel};

/// The off-diagonal entries of T, n_vertices × n_vertices, each row divided by a factor of its own so that it cannot
/// underflow.
///
/// `T(x,y) = A(y)·exp(−‖x−y‖²/4t)` for `y` in `N(x)`, `T(x,x) = Σ_{y≠x} T(x,y)` (eq. 1). All entries are ≥ 0. T is not
/// symmetric, but `A(x)·T(x,y)` is whenever neighborhood is.
///
/// It is the Laplacian L of `belkin2008` with the sign of its diagonal D_L turned: `T = 4πt²·(L − 2D_L)` (eq. 2).
#[derive(Clone, Debug)]
pub struct LocalOperator {
    pub(super) rows: CompressedRows<f64>,
    pub(super) log_factor: Vec<f64>,
    pub(super) areas: Vec<f64>,
    /// What counts in place of areas where density is taken out: m.
    pub(super) measure: Option<Vec<f64>>,
    pub(super) mean_square: Vec<f64>,
    pub(super) mean_length: f64,
    /// The standard deviation of the kernel along one axis, in model units.
    pub(super) width: f64,
    pub(super) is_reversible: bool,
}

impl LocalOperator {
    /// `T(x,y)·exp(−log_factor[x])` for `y ≠ x`, in units of an area that do not matter.
    pub fn rows(&self) -> &CompressedRows<f64> {
        &self.rows
    }

    /// Which entries there are: the neighborhoods N(x).
    pub fn neighbors(&self) -> &Adjacency {
        self.rows.pattern()
    }

    /// The logarithm of the factor that each row was divided by.
    pub fn log_factor(&self) -> &[f64] {
        &self.log_factor
    }

    /// `A`, the area of each vertex in squared model units (1 for a graph).
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Mean square distance of the neighbors, `Σ_y T(x,y)·‖x−y‖² / Σ_y T(x,y)` over `y ≠ x`, in squared model units (1
    /// for a graph, 0 at a vertex that no step leaves).
    pub fn mean_square(&self) -> &[f64] {
        &self.mean_square
    }

    /// `E`, the mean length of edges or the mean distance to the nearest neighbors, in model units (1 for a graph).
    pub fn mean_length(&self) -> f64 {
        self.mean_length
    }

    /// Whether diffusion is reversible: neighborhood is symmetric.
    pub fn is_reversible(&self) -> bool {
        self.is_reversible
    }

    /// `t` of the kernel `exp(−d²/4t)` (eq. 1), in squared model units: E²/2, or as long as neighborhoods by length are wide
    /// ([`density_invariant`](OperatorParams::density_invariant)).
    pub fn time(&self) -> f64 {
        self.width * self.width / 2.0
    }
}

/// How far neighbors by length go on a mesh, in lengths of the longest edge of a vertex: about as many as a cloud's.
const MESH_REACH: f64 = 1.5;

/// Stages that are reported: neighbors, areas, values.
const STAGES: u64 = 3;

/// Builds T (eq. 1) for a prepared shape. O(entries), for clouds O(n log n).
///
/// Vertices without a neighbor that has an area get an empty row: what starts there stays there. Where the paper is
/// silent: neighborhood on a mesh is the one-ring, on a cloud the union of both directions, and each row is shifted by its
/// smallest d² before `exp`, which leaves the normalized row the same.
///
/// With [`density_invariant`](OperatorParams::density_invariant) neighbors are those within one length that is the same everywhere, t goes
/// with it, and `T(x,y) = m(y)·exp(−‖x−y‖²/4t)` with m = A divided by the density `q(x) = A(x) + Σ_{y≠x} A(y)·exp(−‖x−y‖²/4t)` that the kernel
/// finds (`coifmanlafon2006`, α = 1), and three times more by what is left of that; on a graph neighbors stay and
/// `T(x,y) = w(x,y)/(q(x)·q(y))`, `q(x) = Σ_y w(x,y)`.
///
/// # Errors
/// [`Cancelled`].
pub fn local_operator(
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    progress.step(0, STAGES)?;
    let operator = match geometry.shape() {
        Shape::Mesh(_) => of_mesh(geometry, params, progress),
        Shape::Cloud(_) => of_cloud(geometry, params, progress),
        Shape::Graph(graph) => of_graph(graph, geometry.vertex_map(), params, progress),
    }?;
    progress.step(STAGES, STAGES)?;
    Ok(operator)
}

/// T (eq. 1) of a cloud, or of a part of one, whose neighborhoods, areas and E are known: `T(x,y) = A(y)·exp(−‖x−y‖²/2E²)` for y in
/// `neighbors` of x. `points` and `mean_length` (E) are in model units, `areas` in squared ones. O(entries).
///
/// A row depends on its own entries alone: those of a part of a cloud have the bits of the whole where all their neighbors are there.
/// `neighbors` count as symmetric.
///
/// # Errors
/// [`Cancelled`].
///
/// # Panics
/// Unless `neighbors` has a row and a column, and `areas` a value, for each point.
pub fn local_operator_of_neighbors(
    points: &[[f64; 3]],
    neighbors: Adjacency,
    areas: Vec<f64>,
    mean_length: f64,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    assert_eq!(neighbors.n_rows(), points.len(), "a row of neighbors for each point");
    assert_eq!(areas.len(), points.len(), "an area for each point");
    Kernel { points, unit: 1.0, area_unit: 1.0, areas, mean_length }.operator(neighbors, true, progress)
}

fn of_mesh(
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    let (points, unit) = geometry.unit_points(progress)?;
    let triangles = geometry.triangles();
    let at_vertex = triangles_at_vertices(points.len(), triangles, progress)?;
    let ring = try_one_ring(triangles, &at_vertex, progress)?;
    progress.step(1, STAGES)?;
    let mean_length = mean_edge_length(&points, &ring, progress)?;
    let areas = try_mesh_areas(&points, triangles, &at_vertex, params.mesh_area, progress)?;
    drop(at_vertex);
    progress.step(2, STAGES)?;
    let neighbors = if params.rings > 1 { try_k_rings(&ring, params.rings, progress)? } else { ring };
    let kernel = Kernel { points: &points, unit, area_unit: geometry.size_unit(), areas, mean_length };
    if !params.density_invariant {
        return kernel.operator(neighbors, true, progress);
    }
    let farthest = parallel::try_collect(points.len(), progress, |x| {
        let squares = neighbors.of(x).iter().map(|&y| squared_distance(&points[x], &points[y as usize]));
        MESH_REACH * squares.fold(0.0, f64::max).sqrt()
    })?;
    kernel.density_invariant(by_length(&points, &neighbors, &farthest, progress)?, progress)
}

fn of_cloud(
    geometry: &PreparedGeometry,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    let (points, unit) = geometry.unit_points(progress)?;
    let near = try_nearest_neighbors(&points, params.neighbors, progress)?;
    progress.step(1, STAGES)?;
    let total = parallel::try_sum(points.len(), progress, |x| {
        let lengths =
            near.adjacency.of(x).iter().map(|&y| squared_distance(&points[x], &points[y as usize]).sqrt());
        lengths.sum()
    })?;
    let mean_length = total / near.adjacency.nnz().max(1) as f64;
    let areas = try_cloud_areas(&points, &near, params.cloud_area, progress)?;
    progress.step(2, STAGES)?;
    let kernel = Kernel { points: &points, unit, area_unit: geometry.size_unit(), areas, mean_length };
    let mut operator = match (params.cloud_graph, params.density_invariant) {
        (_, true) => {
            let next = near.adjacency.union_with_transpose(progress)?;
            kernel.density_invariant(by_length(&points, &next, &near.radius, progress)?, progress)
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

/// The kernel (eq. 1) of a mesh or cloud.
struct Kernel<'a> {
    /// Positions, in units of `unit` model units.
    points: &'a [[f64; 3]],
    unit: f64,
    /// The unit of length in which entries count areas: of the order of the shape, so that their sums neither overflow nor
    /// vanish.
    area_unit: f64,
    /// A, in squares of `unit`.
    areas: Vec<f64>,
    /// E, in units of `unit`.
    mean_length: f64,
}

impl Kernel<'_> {
    fn operator(
        self,
        neighbors: Adjacency,
        is_reversible: bool,
        progress: Progress<'_>,
    ) -> Result<LocalOperator, Cancelled> {
        let width = self.mean_length; // t = E²/2 (eq. 1)
        self.with_width(neighbors, width, is_reversible, progress)
    }

    /// The kernel over neighborhoods by length, divided by the density that it finds.
    fn density_invariant(
        mut self,
        within: ByLength,
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
        // Both units are powers of two: nothing is rounded.
        let scaled = |areas: &mut [f64], factor: f64| {
            parallel::try_for_rows(areas, 1, 1 << 14, progress, |_, areas| {
                for a in areas {
                    *a = *a * factor * factor;
                }
            })
        };
        scaled(&mut self.areas, unit / area_unit)?;
        let mut values = crate::pages::zeros(neighbors.nnz());
        let mut per_row = vec![(0.0, 0.0); n];
        try_for_entries(&neighbors, &mut values, &mut per_row, progress, |range, mut values, per_row| {
            for (x, kept) in range.zip(per_row) {
                let (row, after) = std::mem::take(&mut values).split_at_mut(neighbors.of(x).len());
                values = after;
                *kept = self.fill_row(x, neighbors.of(x), width, row);
            }
        })?;
        scaled(&mut self.areas, area_unit)?;
        Ok(LocalOperator {
            rows: CompressedRows::trusted(neighbors, values),
            log_factor: parallel::try_collect(n, progress, |x| per_row[x].0)?,
            areas: self.areas,
            measure: None,
            mean_square: parallel::try_collect(n, progress, |x| per_row[x].1)?,
            mean_length: self.mean_length * unit,
            width: width * unit,
            is_reversible,
        })
    }

    /// Fills the row of `x`, whose neighbors are `near`: the logarithm of the row's factor, and the mean square of its
    /// distances in squared model units.
    fn fill_row(&self, x: usize, near: &[u32], width: f64, row: &mut [f64]) -> (f64, f64) {
        let Self { points, unit, areas, .. } = self;
        // 1/4t = 1/2w² (eq. 1). All neighbors coincide where w is 0; the kernel is 1 then.
        let sharpness = sharpness(width * width);
        // Neighbors without area do not count for the shift: they do not keep the row from underflowing.
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

/// Kernel of a graph: the weights themselves, every node of area 1, every edge of length 1. Rows and columns are in the
/// numbering of `vertex_map`.
fn of_graph(
    graph: &Graph,
    vertex_map: &VertexMap,
    params: &OperatorParams,
    progress: Progress<'_>,
) -> Result<LocalOperator, Cancelled> {
    let n = graph.n_nodes();
    let (node_at, place) = (vertex_map.last_members(), vertex_map.as_slice());
    let largest_weight = |x: usize| {
        let weights = graph.rows().row(node_at[x] as usize).1;
        weights.iter().copied().fold(0.0, f64::max)
    };
    // The logarithm of what a row is divided by: sums of very large weights would overflow.
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
    Ok(LocalOperator {
        rows,
        log_factor,
        areas: vec![1.0; n],
        measure: None,
        mean_square: parallel::try_collect(n, progress, |x| if has_edges(x) { 1.0 } else { 0.0 })?,
        mean_length: 1.0,
        width: 1.0,
        is_reversible: true,
    })
}
