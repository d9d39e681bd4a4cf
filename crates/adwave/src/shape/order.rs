//! An order of the nodes of a graph in which neighbors are close to each other.

use super::Adjacency;
use crate::{Cancelled, Progress, parallel};

/// Position of every node in the reverse Cuthill–McKee order: breadth-first from a node of low degree, neighbors of
/// low degree first, reversed; component after component. O(edges log degree).
///
/// Source: `cuthill1969`, with the order reversed.
///
/// Products with a matrix in this order read from the cache. Meshes and clouds have positions and are numbered
/// along a space-filling curve instead.
pub(crate) fn reverse_cuthill_mckee(
    adjacency: &Adjacency,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Cancelled> {
    let n = adjacency.n_rows();
    let degree = |x: u32| adjacency.row(x as usize).len();
    let mut starts: Vec<u32> = (0..n as u32).collect();
    parallel::sort_by(&mut starts, progress, |&x, &y| degree(x).cmp(&degree(y)))?;
    let mut seen = vec![false; n];
    let mut order: Vec<u32> = Vec::with_capacity(n);
    let mut next = Vec::new();
    for start in starts {
        if std::mem::replace(&mut seen[start as usize], true) {
            continue;
        }
        let mut read = order.len();
        order.push(start);
        while let Some(&x) = order.get(read) {
            read += 1;
            if read.is_multiple_of(NODES_AT_A_TIME) {
                progress.check()?;
            }
            next.clear();
            next.extend(
                adjacency
                    .row(x as usize)
                    .iter()
                    .copied()
                    .filter(|&y| !std::mem::replace(&mut seen[y as usize], true)),
            );
            next.sort_by_key(|&y| degree(y));
            order.extend_from_slice(&next);
        }
    }
    let mut place = vec![0; n];
    for (k, &x) in order.iter().rev().enumerate() {
        place[x as usize] = k as u32;
    }
    Ok(place)
}

/// Number of nodes between two checks for cancellation.
const NODES_AT_A_TIME: usize = 1 << 13;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Graph;

    #[test]
    fn a_shuffled_grid_gets_a_narrow_band_again() {
        let side = 40_u32;
        // 7 and 1600 are coprime, so this shuffle separates neighbors.
        let name = |i: u32, j: u32| (i * side + j) * 7 % (side * side);
        let mut edges = Vec::new();
        for i in 0..side {
            for j in 0..side {
                if i > 0 {
                    edges.push((name(i, j), name(i - 1, j), 1.0));
                }
                if j > 0 {
                    edges.push((name(i, j), name(i, j - 1), 1.0));
                }
            }
        }
        let graph = Graph::new((side * side) as usize + 1, &edges).unwrap();
        let place = reverse_cuthill_mckee(graph.adjacency(), Progress::none()).unwrap();
        let mut sorted = place.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..=side * side), "every place once");
        let widest = edges.iter().map(|&(a, b, _)| place[a as usize].abs_diff(place[b as usize])).max();
        assert!(widest.unwrap() <= 2 * side, "{widest:?}");
    }
}
