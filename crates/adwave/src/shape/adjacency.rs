//! Who is next to whom: the one-ring of a mesh, k rings, connected components.

use crate::sparse::with_capacity;
use rayon::prelude::*;

/// Neighbour lists in compressed rows: the neighbours of `x` are `neighbours[offsets[x]..offsets[x + 1]]`, by rising
/// index, without `x` itself and without repeats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adjacency {
    /// Where each row starts, and the end of the last: one more than there are vertices.
    pub offsets: Vec<usize>,
    /// The neighbours, row after row.
    pub neighbours: Vec<u32>,
}

/// Rows a thread builds at a time; the result does not depend on it.
const ROWS_AT_A_TIME: usize = 4096;

impl Adjacency {
    /// Builds the rows `0..n` in parallel; `row(x, out)` pushes the neighbours of `x` in any order, repeats allowed.
    pub(crate) fn from_rows<S: Send>(
        n: usize,
        scratch: impl Fn() -> S + Sync + Send,
        row: impl Fn(&mut S, usize, &mut Vec<u32>) + Sync + Send,
    ) -> Self {
        let chunks: Vec<(Vec<u32>, Vec<u32>)> = (0..n.div_ceil(ROWS_AT_A_TIME))
            .into_par_iter()
            .map_init(scratch, |scratch, chunk| {
                let (mut counts, mut neighbours, mut found) = (Vec::new(), Vec::new(), Vec::new());
                for x in chunk * ROWS_AT_A_TIME..((chunk + 1) * ROWS_AT_A_TIME).min(n) {
                    found.clear();
                    row(scratch, x, &mut found);
                    found.sort_unstable();
                    found.dedup();
                    found.retain(|&y| y as usize != x);
                    counts.push(found.len() as u32);
                    neighbours.extend_from_slice(&found);
                }
                (counts, neighbours)
            })
            .collect();
        let mut offsets = with_capacity(n + 1);
        offsets.push(0);
        let mut neighbours = with_capacity(chunks.iter().map(|(_, found)| found.len()).sum());
        for (counts, found) in chunks {
            for count in counts {
                offsets.push(offsets[offsets.len() - 1] + count as usize);
            }
            neighbours.extend_from_slice(&found);
        }
        Self { offsets, neighbours }
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The neighbours of `x`.
    pub fn of(&self, x: usize) -> &[u32] {
        &self.neighbours[self.offsets[x]..self.offsets[x + 1]]
    }

    /// The same lists without some vertices: they name nobody and are not named.
    pub(crate) fn without(&self, masked: &[bool]) -> Self {
        Self::from_rows(
            self.n_vertices(),
            || (),
            |(), x, out| {
                if !masked[x] {
                    out.extend(self.of(x).iter().filter(|&&y| !masked[y as usize]));
                }
            },
        )
    }

    /// The symmetric closure: `y` is a neighbour of `x` when either named the other.
    pub(crate) fn union_with_transpose(&self) -> Self {
        let transpose = incidence(
            self.n_vertices(),
            (0..self.n_vertices()).flat_map(|x| self.of(x).iter().map(move |&y| (y, x as u32))),
        );
        Self::from_rows(
            self.n_vertices(),
            || (),
            |(), x, out| {
                out.extend_from_slice(self.of(x));
                out.extend_from_slice(&transpose.1[transpose.0[x]..transpose.0[x + 1]]);
            },
        )
    }
}

/// Groups the values of `(key, value)` pairs by key, in the order they come: offsets and values.
pub(crate) fn incidence(
    n_keys: usize,
    pairs: impl Iterator<Item = (u32, u32)> + Clone,
) -> (Vec<usize>, Vec<u32>) {
    let mut offsets = vec![0_usize; n_keys + 1];
    for (key, _) in pairs.clone() {
        offsets[key as usize + 1] += 1;
    }
    for k in 0..n_keys {
        offsets[k + 1] += offsets[k];
    }
    let mut values = vec![0_u32; offsets[n_keys]];
    let mut next = offsets.clone();
    for (key, value) in pairs {
        values[next[key as usize]] = value;
        next[key as usize] += 1;
    }
    (offsets, values)
}

/// The triangles at each vertex: offsets and triangle indices, a triangle once for each of its corners.
pub(crate) fn triangles_at_vertices(n_vertices: usize, triangles: &[[u32; 3]]) -> (Vec<usize>, Vec<u32>) {
    incidence(
        n_vertices,
        triangles.iter().enumerate().flat_map(|(f, corners)| corners.iter().map(move |&c| (c, f as u32))),
    )
}

/// The one-ring: every vertex that shares an edge of a triangle with `x`. O(triangles).
///
/// Triangles without area count: their edges join their distinct corners.
///
/// ```
/// use adwave::shape::one_ring;
/// let ring = one_ring(4, &[[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(ring.of(0), [1, 2, 3]);
/// assert_eq!(ring.of(1), [0, 2]);
/// ```
pub fn one_ring(n_vertices: usize, triangles: &[[u32; 3]]) -> Adjacency {
    let (offsets, at_vertex) = triangles_at_vertices(n_vertices, triangles);
    Adjacency::from_rows(
        n_vertices,
        || (),
        |(), x, out| {
            for &f in &at_vertex[offsets[x]..offsets[x + 1]] {
                out.extend_from_slice(&triangles[f as usize]);
            }
        },
    )
}

/// The first `k` rings: every vertex that at most `k` edges lead to. O(neighbours found); `k = 1` copies `one_ring`.
pub fn k_rings(one_ring: &Adjacency, k: usize) -> Adjacency {
    let n = one_ring.n_vertices();
    Adjacency::from_rows(
        n,
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
    let mut seen = vec![false; adjacency.n_vertices()];
    let mut stack = Vec::new();
    let mut count = 0;
    for start in 0..seen.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        count += 1;
        stack.push(start as u32);
        while let Some(x) = stack.pop() {
            for &y in adjacency.of(x as usize) {
                if !std::mem::replace(&mut seen[y as usize], true) {
                    stack.push(y);
                }
            }
        }
    }
    count
}
