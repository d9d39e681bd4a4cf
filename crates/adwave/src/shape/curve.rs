//! Curves: graphs whose nodes have positions and whose edges are segments.
//!
//! Files repeat positions: a closed track ends where it began, a centerline has its points once for each branch, a
//! recorder writes the same place twice. [`weld_curve`] joins vertices that an edge of length 0 connects, and the end
//! of a piece with a vertex at its position. Two pieces that only cross at a vertex stay apart.

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

/// Joins each end of a piece with another vertex at its position; with the first one if none of them is an end.
fn join_ends(graph: &Graph, position: &VertexMap, sets: &mut DisjointSets) {
    let n = graph.n_nodes();
    // The only neighbor outside the set that edges of length 0 join; sets with several such neighbors are no ends.
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

/// Share of noise in the mean squared edge length from which the lengths are mostly noise.
const NOISY: f64 = 0.6;

/// Share of noise in the mean squared edge length up to which it hardly changes the length.
const SLIGHT: f64 = 0.05;

/// Length of a curve relative to that without noise, above which noise stretches it. Uneven spacing along a curve looks
/// like noise, but does not stretch it.
const STRETCHED: f64 = 1.03;

/// Range of the ratio of the noise that fourth differences suggest to the noise that second differences suggest, for
/// independent noise; a regular zigzag has 1.37.
const INDEPENDENT: std::ops::RangeInclusive<f64> = 0.88..=1.2;

/// Smallest number of fourth differences from which noise is estimated.
const FEWEST: usize = 16;

/// Share of noise in the mean squared edge length that may be left after smoothing.
const LEFT: f64 = 0.05;

/// Largest number of passes of smoothing.
const MOST_PASSES: usize = 1 << 12;

/// Positions of a curve without the noise that stretches its edges; `None` if noise does not. If the positions of a
/// track scatter by half the way between them, its length is a third longer than the way; if they scatter by more, it
/// measures the noise.
///
/// The noise is that of the second and fourth differences along the curve, which agree if it is independent between
/// vertices. Passes with weights ¼, ½, ¼ leave `σ²/(2√π(m/2)^1.5)` of the squared difference of the noise between
/// neighbors after m passes. O(n) for each pass.
pub(crate) fn places_without_noise(points: &[[f64; 3]], edges: &Adjacency) -> Option<Vec<[f64; 3]>> {
    let bend = |points: &[[f64; 3]], x: usize| -> Option<[f64; 3]> {
        let [a, b] = *edges.row(x) else { return None };
        let (p, a, b) = (&points[x], &points[a as usize], &points[b as usize]);
        Some(std::array::from_fn(|c| a[c] + b[c] - 2.0 * p[c]))
    };
    let square = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
    let second: Vec<Option<[f64; 3]>> = (0..points.len()).map(|x| bend(points, x)).collect();
    let (mut squares, mut n) = ([0.0; 2], 0_usize);
    for x in 0..points.len() {
        let [a, b] = *edges.row(x) else { continue };
        if let (Some(d), Some(a), Some(b)) = (second[x], second[a as usize], second[b as usize]) {
            squares[0] += square(&d) / 6.0;
            squares[1] += square(&std::array::from_fn(|c| a[c] + b[c] - 2.0 * d[c])) / 70.0;
            n += 1;
        }
    }
    let mean_square = |points: &[[f64; 3]]| {
        let of_row = |x: usize| edges.row(x).iter().map(move |&y| (x, y as usize));
        let sum: f64 =
            (0..points.len()).flat_map(of_row).map(|(x, y)| distance(&points[x], &points[y]).powi(2)).sum();
        sum / edges.nnz().max(1) as f64
    };
    let variance = squares[1] / n.max(1) as f64;
    let share = 2.0 * variance / mean_square(points);
    if n < FEWEST || share.is_nan() || share <= SLIGHT || !INDEPENDENT.contains(&(squares[1] / squares[0])) {
        return None;
    }
    let mut places = points.to_vec();
    let (mut n_passes, mut next) = (0_usize, 4_usize);
    while n_passes < MOST_PASSES {
        while n_passes < next {
            places = (0..places.len())
                .map(|x| match bend(&places, x) {
                    Some(d) => std::array::from_fn(|c| places[x][c] + 0.25 * d[c]),
                    None => places[x],
                })
                .collect();
            n_passes += 1;
        }
        let left = variance / (2.0 * std::f64::consts::PI.sqrt() * (0.5 * n_passes as f64).powf(1.5));
        if left <= LEFT * mean_square(&places) {
            break;
        }
        next *= 2;
    }
    let length = |points: &[[f64; 3]]| {
        let of_row = |x: usize| edges.row(x).iter().map(move |&y| (x, y as usize));
        (0..points.len()).flat_map(of_row).map(|(x, y)| distance(&points[x], &points[y])).sum::<f64>()
    };
    (share > NOISY || length(points) > STRETCHED * length(&places)).then_some(places)
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
