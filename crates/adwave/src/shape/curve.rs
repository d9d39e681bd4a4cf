//! Curves: graphs whose nodes have positions and whose edges are segments.
//!
//! Files repeat positions: a closed track ends where it began, a centerline has its points once for each branch, a
//! recorder writes the same place twice. [`weld_curve`] joins vertices that an edge of length 0 connects, and the end
//! of a piece with what lies at its place. Two pieces that only cross at a vertex stay apart.

use super::disjoint_sets::DisjointSets;
use super::order::reverse_cuthill_mckee;
use super::{Adjacency, Graph, VertexMap, WeldMode, distance};
use crate::rows::CompressedRows;
use crate::{Cancelled, Progress};

/// Length of an edge, relative to the mean, below which its weight no longer grows.
const LEAST_LENGTH: f64 = 1e-9;

/// Largest weight of an edge, so that sums of weights stay finite.
const MAX_WEIGHT: f64 = 1e280;

/// A curve after welding.
pub(super) struct WeldedCurve {
    pub(super) vertex_map: VertexMap,
    /// Neighbors of each welded vertex.
    pub(super) edges: Adjacency,
}

/// Joins vertices of a curve at equal positions and numbers them along its pieces. O(n log n).
pub(super) fn weld_curve(
    graph: &Graph,
    points: &[[f64; 3]],
    mode: WeldMode,
    progress: Progress<'_>,
) -> Result<WeldedCurve, Cancelled> {
    let n = points.len();
    let mut sets = DisjointSets::new(n);
    if mode == WeldMode::EqualPositions {
        let position = VertexMap::try_new(points, mode, progress)?;
        let is_same = |x: u32, y: u32| position.welded(x as usize) == position.welded(y as usize);
        for x in 0..n as u32 {
            for &y in graph.adjacency().row(x as usize) {
                if is_same(x, y) {
                    sets.join(x, y);
                }
            }
        }
        join_ends(graph, &position, &mut sets);
    }
    let mut class = vec![u32::MAX; n];
    let mut n_classes = 0;
    for x in 0..n as u32 {
        let root = sets.root(x) as usize;
        if class[root] == u32::MAX {
            class[root] = n_classes;
            n_classes += 1;
        }
        class[x as usize] = class[root];
    }
    let unordered = edges_between(graph, &class, n_classes as usize);
    let place = reverse_cuthill_mckee(&unordered, progress)?;
    let class: Vec<u32> = class.iter().map(|&class| place[class as usize]).collect();
    let edges = edges_between(graph, &class, n_classes as usize);
    Ok(WeldedCurve { vertex_map: VertexMap::from_classes(class, n_classes as usize), edges })
}

/// Joins each end of a piece with another vertex at its position. Of several that are no ends, it is the first.
fn join_ends(graph: &Graph, position: &VertexMap, sets: &mut DisjointSets) {
    let n = graph.n_nodes();
    // The one neighbor outside of what edges of length 0 join; vertices with several are no ends.
    let mut outer: Vec<Option<u32>> = vec![None; n];
    let mut is_inner = vec![false; n];
    for x in 0..n as u32 {
        let root = sets.root(x) as usize;
        for &y in graph.adjacency().row(x as usize) {
            let other = sets.root(y);
            match outer[root] {
                _ if other as usize == root => {}
                Some(known) if known != other => is_inner[root] = true,
                _ => outer[root] = Some(other),
            }
        }
    }
    let roots: Vec<usize> = (0..n as u32).map(|x| sets.root(x) as usize).collect();
    let is_end = |x: u32| outer[roots[x as usize]].is_some() && !is_inner[roots[x as usize]];
    let has_edges = |x: u32| outer[roots[x as usize]].is_some();
    let members = position.members();
    for p in 0..position.n_welded() {
        let mut here = members.row(p).iter().copied().filter(|&x| has_edges(x));
        let Some(first) = here.next() else { continue };
        let mut is_joined = false;
        for x in here {
            if is_end(x) || (is_end(first) && !is_joined) {
                sets.join(first, x);
                is_joined = true;
            }
        }
    }
}

/// Neighbor lists of classes of vertices, without loops.
fn edges_between(graph: &Graph, class: &[u32], n_classes: usize) -> Adjacency {
    let mut pairs: Vec<(u32, u32, f64)> = Vec::with_capacity(graph.adjacency().nnz());
    for (x, &own) in class.iter().enumerate() {
        let row = graph.adjacency().row(x).iter().map(|&y| class[y as usize]);
        pairs.extend(row.filter(|&other| other != own).map(|other| (own, other, 1.0)));
    }
    pairs.sort_unstable_by_key(|&(x, y, _)| (x, y));
    match CompressedRows::from_sorted(n_classes, n_classes, pairs) {
        Ok(rows) => rows.into_parts().0,
        Err(error) => unreachable!("the edges are sorted: {error}"),
    }
}

/// Lengths of the edges of `edges` between vertices at `points`, at least [`LEAST_LENGTH`] of their mean; 1 if all
/// vertices coincide. In the unit of the points.
pub(crate) fn edge_lengths(points: &[[f64; 3]], edges: &Adjacency) -> Vec<f64> {
    let length = |x: usize| edges.row(x).iter().map(move |&y| distance(&points[x], &points[y as usize]));
    let mut lengths: Vec<f64> = (0..points.len()).flat_map(length).collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
    let least = if mean > 0.0 { (LEAST_LENGTH * mean).max(1.0 / MAX_WEIGHT) } else { 1.0 };
    for length in &mut lengths {
        *length = length.max(least);
    }
    lengths
}

/// Total length of the distinct edges of a graph whose nodes are at `points`, in their unit. Loops have length 0.
/// O(edges).
///
/// ```
/// use adwave::shape::{Graph, curve_length};
/// let corner = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]];
/// let curve = Graph::curve(corner.to_vec(), &[[0, 1], [1, 2], [2, 1]])?;
/// assert_eq!(curve_length(&curve, &corner), 7.0);
/// # Ok::<(), adwave::shape::GraphError>(())
/// ```
///
/// # Panics
/// If there are fewer points than nodes.
pub fn curve_length(graph: &Graph, points: &[[f64; 3]]) -> f64 {
    let later = |x: usize| graph.adjacency().row(x).iter().map(|&y| y as usize).filter(move |&y| y > x);
    (0..graph.n_nodes())
        .flat_map(|x| later(x).map(move |y| (x, y)))
        .map(|(x, y)| distance(&points[x], &points[y]))
        .sum()
}
