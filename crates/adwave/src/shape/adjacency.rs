//! Neighborhoods: the one-ring of a mesh, k rings, connected components.

use crate::parallel::expect_not_cancelled;
use crate::rows::{Pattern, incidence};
use crate::{Cancelled, Progress};

/// Neighbor lists: the neighbors of `x` in ascending order, without `x` itself and without repetitions.
pub type Adjacency = Pattern;

/// Number of vertices between two checks for cancellation.
const VERTICES_AT_A_TIME: usize = 1 << 14;

/// The triangles at each vertex, in ascending order, once for each of its corners there.
pub(crate) fn triangles_at_vertices(
    n_vertices: usize,
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Pattern, Cancelled> {
    incidence(n_vertices, triangles.len(), progress, |f| &triangles[f])
}

/// The one-ring: all vertices that share a triangle edge with `x`. O(triangles).
///
/// Triangles without area count too: their edges connect their distinct corners.
///
/// # Panics
/// If a triangle names a vertex that does not exist.
///
/// ```
/// use adwave::shape::one_ring;
/// let ring = one_ring(4, &[[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(ring.row(0), [1, 2, 3]);
/// assert_eq!(ring.row(1), [0, 2]);
/// ```
pub fn one_ring(n_vertices: usize, triangles: &[[u32; 3]]) -> Adjacency {
    let none = Progress::none();
    let at_vertex = expect_not_cancelled(triangles_at_vertices(n_vertices, triangles, none));
    expect_not_cancelled(try_one_ring(triangles, &at_vertex, none))
}

/// [`one_ring`] from the triangles at each vertex; stops if the call is cancelled.
pub(crate) fn try_one_ring(
    triangles: &[[u32; 3]],
    at_vertex: &Pattern,
    progress: Progress<'_>,
) -> Result<Adjacency, Cancelled> {
    Adjacency::from_rows(at_vertex.n_rows(), progress, Vec::new, |found: &mut Vec<u32>, x, out| {
        // Skipping the corner at `x` itself leaves a third less to sort.
        let others = |&f: &u32| match triangles[f as usize] {
            [a, b, c] if a as usize == x => [b, c],
            [a, b, c] if b as usize == x => [c, a],
            [a, b, _] => [a, b],
        };
        let around = at_vertex.row(x);
        if let Some((ring, len)) = closed_ring(x as u32, around.iter().map(others)) {
            out.extend_from_slice(&ring[..len]);
            return;
        }
        found.clear();
        found.extend(around.iter().flat_map(others));
        found.sort_unstable();
        found.dedup();
        out.extend(found.iter().copied().filter(|&y| y as usize != x));
    })
}

/// Number of triangles around a vertex up to which [`closed_ring`] applies: all that fit into a vector of the
/// processor.
const SMALL_RING: usize = 8;

/// Neighbors of `x` in ascending order and their number, if its triangles form one closed fan; `None` if that was not
/// established. In a closed fan each triangle begins at a different neighbor and ends where another one begins.
fn closed_ring(x: u32, sides: impl ExactSizeIterator<Item = [u32; 2]>) -> Option<([u32; SMALL_RING], usize)> {
    let n = sides.len();
    if n > SMALL_RING {
        return None;
    }
    let (mut starts, mut ends) = ([u32::MAX; SMALL_RING], [u32::MAX; SMALL_RING]);
    for (k, [start, end]) in sides.enumerate() {
        (starts[k], ends[k]) = (start, end);
    }
    // The place of each start is the number of smaller ones; there are no branches for the processor to guess.
    let mut ring = [u32::MAX; SMALL_RING];
    let mut is_closed = true;
    for &start in &starts[..n] {
        let n_smaller: u32 = starts.iter().map(|&other| u32::from(other < start)).sum();
        ring[n_smaller as usize] = start;
        is_closed &= start != x;
    }
    for &end in &ends[..n] {
        let n_equal: u32 = starts.iter().map(|&start| u32::from(start == end)).sum();
        is_closed &= n_equal == 1;
    }
    // Two equal starts leave a place free.
    is_closed &= !ring[..n].contains(&u32::MAX);
    is_closed.then_some((ring, n))
}

/// The first `k` rings: all vertices within `k` edges. O(neighbors found); `k = 1` copies `one_ring`.
pub fn k_rings(one_ring: &Adjacency, k: usize) -> Adjacency {
    expect_not_cancelled(try_k_rings(one_ring, k, Progress::none()))
}

/// [`k_rings`]; stops if the call is cancelled.
pub(crate) fn try_k_rings(
    one_ring: &Adjacency,
    k: usize,
    progress: Progress<'_>,
) -> Result<Adjacency, Cancelled> {
    let n = one_ring.n_rows();
    Adjacency::from_neighbors(
        n,
        progress,
        || (vec![u32::MAX; n], Vec::new(), Vec::new()),
        |(seen_from, front, next), x, out| {
            // `seen_from[y] == x` marks y as found from x, so the array never needs clearing.
            seen_from[x] = x as u32;
            front.clear();
            front.push(x as u32);
            for _ in 0..k {
                next.clear();
                for &y in &*front {
                    for &z in one_ring.row(y as usize) {
                        if seen_from[z as usize] != x as u32 {
                            seen_from[z as usize] = x as u32;
                            next.push(z);
                        }
                    }
                }
                if next.is_empty() {
                    break;
                }
                out.extend_from_slice(next);
                std::mem::swap(front, next);
            }
        },
    )
}

/// Component of each vertex of a symmetric adjacency, numbered by the first vertex of each component, and the number of
/// components. O(neighbors).
///
/// ```
/// use adwave::shape::{Adjacency, label_components};
/// let edge_and_vertex = Adjacency::new(vec![0, 1, 2, 2], vec![1, 0], 3)?;
/// assert_eq!(label_components(&edge_and_vertex), (vec![0, 0, 1], 2));
/// # Ok::<(), adwave::rows::RowsError>(())
/// ```
pub fn label_components(adjacency: &Adjacency) -> (Vec<u32>, usize) {
    const NONE: u32 = u32::MAX;
    let mut component = vec![NONE; adjacency.n_rows()];
    let mut stack = Vec::new();
    let mut count = 0;
    for start in 0..component.len() {
        if component[start] != NONE {
            continue;
        }
        component[start] = count;
        stack.push(start as u32);
        while let Some(x) = stack.pop() {
            for &y in adjacency.row(x as usize) {
                if component[y as usize] == NONE {
                    component[y as usize] = count;
                    stack.push(y);
                }
            }
        }
        count += 1;
    }
    (component, count as usize)
}

/// Number of connected components, ignoring the direction of edges; a vertex without edges is a component.
/// O(neighbors log n).
///
/// ```
/// use adwave::shape::{Adjacency, n_components};
/// // 1 → 0 and 2 → 0; 3 has no edges.
/// let toward_0 = Adjacency::new(vec![0, 0, 1, 2, 2], vec![0, 0], 4)?;
/// assert_eq!(n_components(&toward_0), 2);
/// # Ok::<(), adwave::rows::RowsError>(())
/// ```
pub fn n_components(adjacency: &Adjacency) -> usize {
    expect_not_cancelled(try_n_components(adjacency, Progress::none()))
}

/// [`n_components`]; stops if the call is cancelled.
pub(crate) fn try_n_components(adjacency: &Adjacency, progress: Progress<'_>) -> Result<usize, Cancelled> {
    let n = adjacency.n_rows();
    // Points to the smallest vertex of the component so far.
    let mut parent: Vec<u32> = (0..n as u32).collect();
    let mut count = n;
    for x in 0..n {
        if x.is_multiple_of(VERTICES_AT_A_TIME) {
            progress.check()?;
        }
        for &y in adjacency.row(x) {
            let (a, b) = (root(&mut parent, x as u32), root(&mut parent, y));
            if a != b {
                parent[a.max(b) as usize] = a.min(b);
                count -= 1;
            }
        }
    }
    Ok(count)
}

/// The root of `x`, with path halving.
fn root(parent: &mut [u32], mut x: u32) -> u32 {
    while parent[x as usize] != x {
        let next = parent[parent[x as usize] as usize];
        parent[x as usize] = next;
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_hang_together_whichever_way_edges_point_and_vertices_are_numbered() {
        // 1 → 0 ← 2 ← 3 and 4 → 5; 6 has no edges.
        const EDGES: [(usize, usize); 4] = [(1, 0), (2, 0), (3, 2), (4, 5)];
        const N: usize = 7;
        for step in 1..N {
            for first in 0..N {
                let number = |x: usize| (first + step * x) % N;
                let mut rows = vec![Vec::new(); N];
                for (x, y) in EDGES {
                    rows[number(x)].push(number(y) as u32);
                }
                let offsets = (0..=N).map(|x| rows[..x].iter().map(Vec::len).sum()).collect();
                let edges = Adjacency::new(offsets, rows.concat(), N).unwrap();
                assert_eq!(n_components(&edges), 3, "{first} + {step}x");
            }
        }
    }
}
