//! Disjoint sets of vertices, such as the connected parts of a shape.

use crate::Progress;
use crate::parallel;
use crate::rows::Pattern;

/// Number of vertices that a thread joins at a time.
const VERTICES_AT_A_TIME: usize = 1 << 14;

/// Disjoint sets of a range of vertices.
struct RangeSets<'a> {
    first: usize,
    parent: &'a mut [u32],
}

impl RangeSets<'_> {
    fn root(&mut self, mut x: u32) -> u32 {
        let at = |x: u32| x as usize - self.first;
        while self.parent[at(x)] != x {
            let next = self.parent[at(self.parent[at(x)])];
            self.parent[at(x)] = next;
            x = next;
        }
        x
    }

    /// Joins two vertices; returns false and joins nothing if one of them is outside the range.
    fn join(&mut self, x: u32, y: u32) -> bool {
        let range = self.first..self.first + self.parent.len();
        if !range.contains(&(x as usize)) || !range.contains(&(y as usize)) {
            return false;
        }
        let (a, b) = (self.root(x), self.root(y));
        self.parent[a.max(b) as usize - self.first] = a.min(b);
        true
    }
}

/// Disjoint sets of vertices; the smallest vertex of a set is its root.
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// Sets of the vertices that triangles connect, given those at each vertex. Each thread joins the vertices of a
    /// range among themselves; few triangles of a shape that is numbered along a curve remain.
    pub(super) fn from_triangles(triangles: &[[u32; 3]], at_vertex: &Pattern) -> Self {
        let mut sets = Self::new(at_vertex.n_rows());
        let across = parallel::try_map_rows(
            &mut sets.parent,
            1,
            VERTICES_AT_A_TIME,
            Progress::none(),
            |first, parent| {
                let mut own = RangeSets { first, parent };
                let mut across = Vec::new();
                for x in first..first + own.parent.len() {
                    for &f in at_vertex.row(x) {
                        let [a, b, c] = triangles[f as usize];
                        if a as usize == x {
                            across.extend([b, c].into_iter().filter(|&y| !own.join(a, y)).map(|y| (a, y)));
                        }
                    }
                }
                across
            },
        );
        for (x, y) in parallel::expect_not_cancelled(across).into_iter().flatten() {
            sets.join(x, y);
        }
        sets
    }

    /// True if there are vertices and all of them are in one set.
    pub(super) fn is_one(&self) -> bool {
        let is_root = |x: usize| f64::from(u8::from(self.parent[x] as usize == x));
        parallel::sum(self.parent.len(), is_root) == 1.0
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.parent.len()
    }

    /// Root of the set of `x`, with path halving.
    pub(crate) fn root(&mut self, mut x: u32) -> u32 {
        while self.parent[x as usize] != x {
            let next = self.parent[self.parent[x as usize] as usize];
            self.parent[x as usize] = next;
            x = next;
        }
        x
    }

    pub(crate) fn join(&mut self, x: u32, y: u32) {
        let (a, b) = (self.root(x), self.root(y));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::super::adjacency::triangles_at_vertices;
    use super::*;

    #[test]
    fn sets_joined_by_ranges_are_those_joined_one_by_one() {
        // Strips of triangles between vertices that are far apart in their numbering, and some that are alone.
        let n = 100_000_u32;
        for (step, n_triangles) in [(1, n - 2), (n / 3 + 1, 5000), (33_331, 60_000), (7, 20_000)] {
            let triangle =
                |k: u32| [0, 1, 2].map(|c| ((u64::from(k + c) * u64::from(step)) % u64::from(n)) as u32);
            let triangles: Vec<[u32; 3]> = (0..n_triangles).map(triangle).collect();
            let at_vertex = triangles_at_vertices(n as usize, &triangles, Progress::none());
            let mut found = DisjointSets::from_triangles(&triangles, &at_vertex.expect("nobody stops it"));
            let mut expected = DisjointSets::new(n as usize);
            for &[a, b, c] in &triangles {
                expected.join(a, b);
                expected.join(a, c);
            }
            assert_eq!(found.is_one(), (0..n).all(|x| expected.root(x) == 0), "{step}");
            assert!((0..n).all(|x| found.root(x) == expected.root(x)), "{step}");
        }
    }
}
