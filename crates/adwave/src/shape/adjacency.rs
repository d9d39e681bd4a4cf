//! Who is next to whom: the one-ring of a mesh, k rings, connected components.

use crate::parallel::unstopped;
use crate::rows::{Pattern, incidence};
use crate::{Cancelled, Progress};

/// Lists of neighbours: those of `x` by rising index, without `x` itself and without repeats.
pub type Adjacency = Pattern;

/// Vertices between two looks at whether to go on.
const VERTICES_AT_A_TIME: usize = 1 << 14;

/// The triangles at each vertex, by rising index, a triangle once for each of its corners there.
pub(crate) fn triangles_at_vertices(
    n_vertices: usize,
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Pattern, Cancelled> {
    incidence(n_vertices, triangles.len(), progress, |f| &triangles[f])
}

/// The one-ring: every vertex that shares an edge of a triangle with `x`. O(triangles).
///
/// Triangles without area count: their edges join their distinct corners.
///
/// # Panics
/// Where a triangle names a vertex that does not exist.
///
/// ```
/// use adwave::shape::one_ring;
/// let ring = one_ring(4, &[[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(ring.of(0), [1, 2, 3]);
/// assert_eq!(ring.of(1), [0, 2]);
/// ```
pub fn one_ring(n_vertices: usize, triangles: &[[u32; 3]]) -> Adjacency {
    let none = Progress::none();
    let at_vertex = unstopped(triangles_at_vertices(n_vertices, triangles, none));
    unstopped(try_one_ring(triangles, &at_vertex, none))
}

/// [`one_ring`] from the triangles at each vertex, stopped when the call is.
pub(crate) fn try_one_ring(
    triangles: &[[u32; 3]],
    at_vertex: &Pattern,
    progress: Progress<'_>,
) -> Result<Adjacency, Cancelled> {
    Adjacency::from_neighbours(
        at_vertex.n_rows(),
        progress,
        || (),
        |(), x, out| out.extend(at_vertex.of(x).iter().flat_map(|&f| triangles[f as usize])),
    )
}

/// The first `k` rings: every vertex that at most `k` edges lead to. O(neighbours found); `k = 1` copies `one_ring`.
pub fn k_rings(one_ring: &Adjacency, k: usize) -> Adjacency {
    unstopped(try_k_rings(one_ring, k, Progress::none()))
}

/// [`k_rings`], stopped when the call is.
pub(crate) fn try_k_rings(
    one_ring: &Adjacency,
    k: usize,
    progress: Progress<'_>,
) -> Result<Adjacency, Cancelled> {
    let n = one_ring.n_rows();
    Adjacency::from_neighbours(
        n,
        progress,
        || (vec![u32::MAX; n], Vec::new(), Vec::new()),
        |(seen_from, front, next), x, out| {
            // `seen_from[y] == x` marks y as found from x, so the array is never cleared.
            seen_from[x] = x as u32;
            front.clear();
            front.push(x as u32);
            for _ in 0..k {
                next.clear();
                for &y in &*front {
                    for &z in one_ring.of(y as usize) {
                        if seen_from[z as usize] != x as u32 {
                            seen_from[z as usize] = x as u32;
                            next.push(z);
                        }
                    }
                }
                out.extend_from_slice(next);
                std::mem::swap(front, next);
            }
        },
    )
}

/// Number of connected components, a vertex without neighbours being one by itself. O(neighbours).
pub fn n_components(adjacency: &Adjacency) -> usize {
    unstopped(try_n_components(adjacency, Progress::none()))
}

/// [`n_components`], stopped when the call is.
pub(crate) fn try_n_components(adjacency: &Adjacency, progress: Progress<'_>) -> Result<usize, Cancelled> {
    let mut seen = vec![false; adjacency.n_rows()];
    let mut stack = Vec::new();
    let (mut count, mut n_visited) = (0, 0_usize);
    for start in 0..seen.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        count += 1;
        stack.push(start as u32);
        while let Some(x) = stack.pop() {
            n_visited += 1;
            if n_visited.is_multiple_of(VERTICES_AT_A_TIME) {
                progress.check()?;
            }
            for &y in adjacency.of(x as usize) {
                if !std::mem::replace(&mut seen[y as usize], true) {
                    stack.push(y);
                }
            }
        }
    }
    Ok(count)
}
