//! Distance along a surface, over the edges of the mesh or the neighbour graph.

use crate::shape::{Adjacency, distance};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A distance with a total order, for the queue.
#[derive(PartialEq)]
struct Reached(f64);

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// The distance of every vertex from the nearest of `sources` (vertex, distance it starts with), up to `reach`; infinite
/// beyond. In units of `points`; without points every edge has length 1. O(m log m) for m vertices within reach.
///
/// Dijkstra's shortest paths over the edges, in which two edges in a row may be replaced by the straight line between
/// their ends: that halves the error of plain edge paths (on an even triangulation of the plane from 15 % to below 4 %)
/// and cannot jump to a sheet that is not connected.
///
/// ```
/// use adwave::region::surface_distance;
/// use adwave::shape::one_ring;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [5.0, 0.0, 0.0]];
/// let ring = one_ring(4, &[[0, 1, 2]]);
/// let d = surface_distance(&ring, &points, &[(1, 0.5)], 10.0);
/// assert_eq!(d, [1.5, 0.5, 1.5, f64::INFINITY]);
/// ```
pub fn surface_distance(
    neighbours: &Adjacency,
    points: &[[f64; 3]],
    sources: &[(usize, f64)],
    reach: f64,
) -> Vec<f64> {
    let n = neighbours.n_rows();
    let length = |x: usize, y: usize| if points.is_empty() { 1.0 } else { distance(&points[x], &points[y]) };
    let mut shortest = vec![f64::INFINITY; n];
    let mut reached_from = vec![u32::MAX; n];
    let mut queue = BinaryHeap::new();
    for &(source, start) in sources {
        if start < shortest[source] && start <= reach {
            shortest[source] = start;
            queue.push(Reverse((Reached(start), source as u32)));
        }
    }
    while let Some(Reverse((Reached(here), x))) = queue.pop() {
        let x = x as usize;
        if here > shortest[x] {
            continue; // reached on a shorter way since it was put in
        }
        let before = reached_from[x];
        for &y in neighbours.of(x) {
            let y = y as usize;
            let mut there = here + length(x, y);
            if before != u32::MAX && !points.is_empty() {
                there = there.min(shortest[before as usize] + length(before as usize, y));
            }
            if there < shortest[y] && there <= reach {
                shortest[y] = there;
                reached_from[y] = x as u32;
                queue.push(Reverse((Reached(there), y as u32)));
            }
        }
    }
    shortest
}
