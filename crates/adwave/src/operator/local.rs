//! The local operator T of eq. 1, for meshes, clouds and graphs.

use super::{CloudGraph, OperatorParams};
use crate::shape::{
    Adjacency, CloudArea, Graph, PreparedGeometry, Shape, VertexMap, cloud_areas, k_rings, mesh_areas,
    nearest_neighbours, one_ring, squared_distance,
};
use rayon::prelude::*;

/// The off-diagonal entries of T, each row divided by a factor of its own so that it cannot underflow.
///
/// `T(x,y) = A(y)·exp(−‖x−y‖²/4t)` for `y` in `N(x)`, `T(x,x) = Σ_{y≠x} T(x,y)`. All entries are ≥ 0. T is not
/// symmetric, but `A(x)·T(x,y)` is whenever neighbourhood is.
#[derive(Clone, Debug)]
pub struct LocalOperator {
    /// Which entries there are: the neighbourhoods N(x).
    pub neighbours: Adjacency,
    /// `T(x,y)·exp(−log_factor[x])` for each entry, in units of an area that do not matter.
    pub values: Vec<f64>,
    /// The logarithm of the factor that each row was divided by.
    pub log_factor: Vec<f64>,
    /// `A`, the area of each vertex in squared model units (1 for a graph).
    pub areas: Vec<f64>,
    /// Mean square distance of the neighbours, `Σ_y T(x,y)·‖x−y‖² / Σ_y T(x,y)` over `y ≠ x`, in squared model units (1
    /// for a graph, 0 at a vertex that no step leaves).
    pub mean_square: Vec<f64>,
    /// `E`, the mean length of edges or the mean distance to the nearest neighbours, in model units (1 for a graph).
    pub mean_length: f64,
    /// Whether the walk is reversible: neighbourhood is symmetric.
    pub is_reversible: bool,
}

impl LocalOperator {
    /// `t = E²/2` of the kernel `exp(−d²/4t)`, in squared model units.
    pub fn time(&self) -> f64 {
        self.mean_length * self.mean_length / 2.0
    }
}

/// Builds T for `shape` and its `geometry`. O(entries), for clouds O(n log n).
///
/// Vertices without a neighbour that has an area get an empty row: a walk that starts there stays there.
///
/// Source: eq. 1. Where the paper is silent: neighbourhood on a mesh is the one-ring, on a cloud the union of both
/// directions, and each row is shifted by its smallest d² before `exp`, which leaves the normalised row the same.
pub fn local_operator(shape: &Shape, geometry: &PreparedGeometry, params: &OperatorParams) -> LocalOperator {
    let (points, unit) = geometry.unit_points();
    match shape {
        Shape::Mesh(_) => {
            let ring = one_ring(points.len(), &geometry.triangles);
            let mean_length = crate::shape::mean_edge_length(&points, &ring);
            let areas = mesh_areas(&points, &geometry.triangles, params.mesh_area);
            let neighbours = if params.rings > 1 { k_rings(&ring, params.rings) } else { ring };
            gaussian(&points, unit, neighbours, areas, mean_length, true)
        }
        Shape::Cloud(_) => {
            let near = nearest_neighbours(&points, params.neighbours);
            let total = crate::parallel::sum(points.len(), |x| {
                near.adjacency
                    .of(x)
                    .iter()
                    .map(|&y| squared_distance(&points[x], &points[y as usize]).sqrt())
                    .sum()
            });
            let mean_length = total / near.adjacency.neighbours.len().max(1) as f64;
            let areas = cloud_areas(&points, &near, params.cloud_area);
            let mut operator = match params.cloud_graph {
                CloudGraph::Union => {
                    let union = near.adjacency.union_with_transpose();
                    gaussian(&points, unit, union, areas, mean_length, true)
                }
                CloudGraph::Directed => gaussian(&points, unit, near.adjacency, areas, mean_length, false),
            };
            if params.cloud_area == CloudArea::Unit {
                operator.areas.fill(1.0); // an area of 1 has no unit to be scaled by
            }
            operator
        }
        Shape::Graph(graph) => weighted(graph, &geometry.vertex_map),
    }
}

/// Kernel of a mesh or cloud. `points`, `areas` and `mean_length` are in units of `unit` model units.
fn gaussian(
    points: &[[f64; 3]],
    unit: f64,
    neighbours: Adjacency,
    areas: Vec<f64>,
    mean_length: f64,
    is_reversible: bool,
) -> LocalOperator {
    let n = points.len();
    // 1/4t = 1/2E². All neighbours coincide where E is 0; the kernel is 1 then.
    let sharpness = if mean_length > 0.0 { 0.5 / (mean_length * mean_length) } else { 0.0 };
    let mut values = crate::sparse::zeros(neighbours.neighbours.len());
    let mut rows: Vec<(usize, &mut [f64])> = Vec::with_capacity(n);
    let mut rest = values.as_mut_slice();
    for x in 0..n {
        let (row, after) = rest.split_at_mut(neighbours.of(x).len());
        rows.push((x, row));
        rest = after;
    }
    let per_row: Vec<(f64, f64)> = rows
        .into_par_iter()
        .with_min_len(1024)
        .map(|(x, row)| {
            let near = neighbours.of(x);
            // The shift leaves out neighbours without area: they do not keep the row from underflowing.
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
                *value = areas[y as usize] * (-(d2 - nearest).max(0.0) * sharpness).exp();
                sum += *value;
                square += *value * d2;
            }
            (-nearest * sharpness, square / sum * unit * unit)
        })
        .collect();
    let (log_factor, mean_square) = per_row.into_iter().unzip();
    LocalOperator {
        neighbours,
        values,
        log_factor,
        areas: areas.into_iter().map(|a| a * unit * unit).collect(),
        mean_square,
        mean_length: mean_length * unit,
        is_reversible,
    }
}

/// Kernel of a graph: the weights themselves, every node of area 1, every edge of length 1. Rows and columns are in the
/// numbering of `vertex_map`.
fn weighted(graph: &Graph, vertex_map: &VertexMap) -> LocalOperator {
    let n = graph.n_nodes();
    let mut node_at = vec![0; n];
    for (x, &place) in vertex_map.as_slice().iter().enumerate() {
        node_at[place as usize] = x;
    }
    let mut neighbours =
        Adjacency { offsets: vec![0], neighbours: Vec::with_capacity(graph.weights().len()) };
    let mut values = Vec::with_capacity(graph.weights().len());
    let mut log_factor = vec![0.0; n];
    let mut mean_square = vec![0.0; n];
    let mut row: Vec<(u32, f64)> = Vec::new();
    for place in 0..n {
        row.clear();
        row.extend(graph.neighbours(node_at[place]).map(|(y, w)| (vertex_map.welded(y as usize) as u32, w)));
        row.sort_by_key(|entry| entry.0);
        // Rows are divided by their largest weight: sums of very large weights would overflow.
        let largest = row.iter().map(|entry| entry.1).fold(0.0, f64::max);
        if largest > 0.0 {
            for entry in &mut row {
                entry.1 /= largest;
            }
            log_factor[place] = largest.ln();
            mean_square[place] = 1.0;
        }
        neighbours.neighbours.extend(row.iter().map(|entry| entry.0));
        neighbours.offsets.push(neighbours.neighbours.len());
        values.extend(row.iter().map(|entry| entry.1));
    }
    LocalOperator {
        neighbours,
        values,
        log_factor,
        areas: vec![1.0; n],
        mean_square,
        mean_length: 1.0,
        is_reversible: true,
    }
}
