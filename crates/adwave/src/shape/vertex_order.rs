//! Comparison of the order of the vertices of two meshes whose faces name the same vertex numbers.

use super::disjoint_sets::DisjointSets;
use super::{Polygons, PreparedGeometry, Shape};
use crate::vector::{add_scaled, norm, subtract};
use std::collections::{HashMap, HashSet};

/// Largest number of equal parts whose places are all compared with each other.
const MOST_PARTS: usize = 2048;

/// Start of the hash of the faces of a part (FNV-1a).
const NO_FACES: u64 = 0xcbf2_9ce4_8422_2325;

/// First vertex that shows a different order of the vertices of two meshes; `None` if none does.
///
/// Equal faces alone do not show that vertex x of one mesh is vertex x of the other: the corners of a triangle soup
/// (every STL) are 0, 1, 2, … in any order of its triangles, and equal parts have the same faces in any order of the
/// parts. Where a part of the faces occurs more than once, the vertices that are welded must be the same in both
/// meshes, except that all of them may have come apart or together. Where a whole part occurs more than once, the
/// copies must not lie nearer to each other's places than to their own. O(n), and O(p²) for up to 2048 of p equal
/// parts.
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode, first_misplaced_vertex};
/// let square = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let soup = |faces: [[usize; 3]; 2]| {
///     let points = faces.as_flattened().iter().map(|&x| square[x]).collect();
///     let mesh = Mesh::new(points, Polygons::from_triangles(&[[0, 1, 2], [3, 4, 5]])).unwrap();
///     PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none()).unwrap()
/// };
/// let (a, b) = (soup([[0, 1, 2], [0, 2, 3]]), soup([[0, 2, 3], [0, 1, 2]]));
/// assert_eq!(first_misplaced_vertex(&a, &a), None);
/// assert_eq!(first_misplaced_vertex(&a, &b), Some(4)); // at the place of vertex 2 in a, and not in b
/// ```
///
/// # Panics
/// Panics if the numbers of vertices differ.
pub fn first_misplaced_vertex(a: &PreparedGeometry, b: &PreparedGeometry) -> Option<usize> {
    let (Shape::Mesh(mesh), Some(points_a), Some(points_b)) =
        (a.shape(), a.shape().points(), b.shape().points())
    else {
        return None;
    };
    let n = points_a.len();
    assert_eq!(n, points_b.len(), "as many vertices in both meshes");
    let first_members = [a, b].map(|geometry| first_members(geometry.vertex_map().as_slice()));
    let pieces = FaceParts::new(n, mesh.faces(), |x| x);
    if let Some(vertex) = differently_welded(&pieces, &first_members) {
        return Some(vertex);
    }
    let [in_a, in_b] = &first_members;
    let parts = FaceParts::new(n, mesh.faces(), |x| if in_a[x] == in_b[x] { in_a[x] as usize } else { x });
    parts.exchanged(points_a, points_b)
}

/// Smallest vertex that is welded with each vertex.
fn first_members(welded: &[u32]) -> Vec<u32> {
    let n_classes = welded.iter().max().map_or(0, |&class| class as usize + 1);
    let mut first = vec![u32::MAX; n_classes];
    for (x, &class) in (0..).zip(welded) {
        first[class as usize] = x.min(first[class as usize]);
    }
    welded.iter().map(|&class| first[class as usize]).collect()
}

/// First vertex, in a piece that occurs more than once, that is welded with others than in the other mesh.
fn differently_welded(pieces: &FaceParts, [in_a, in_b]: &[Vec<u32>; 2]) -> Option<usize> {
    let (mut first, mut n_linked, mut n_kept, mut is_nested) = (None, 0_usize, 0_usize, true);
    for x in (0..in_a.len()).filter(|&x| !pieces.is_unique(x)) {
        let (p, q) = (in_a[x], in_b[x]);
        if p as usize != x || q as usize != x {
            n_linked += 1;
            n_kept += usize::from(p == q);
        }
        if p != q {
            first = first.or(Some(x));
            // One class is a part of the other if the representative of the finer one is in the coarser class.
            is_nested &= in_a[q as usize] == p || in_b[p as usize] == q;
        }
    }
    first.filter(|_| !is_nested || 2 * n_kept < n_linked)
}

/// Connected parts of the faces of a mesh.
struct FaceParts {
    /// Smallest vertex of the part of each vertex.
    root: Vec<u32>,
    /// Hash of the faces of each part, relative to its root, by root.
    kind: Vec<u64>,
    n_of_kind: HashMap<u64, usize>,
}

impl FaceParts {
    /// FaceParts of `faces` over the vertices `vertex(0) … vertex(n − 1)`.
    fn new(n: usize, faces: &Polygons, vertex: impl Fn(usize) -> usize) -> Self {
        let mut sets = DisjointSets::new(n);
        for face in faces.iter() {
            for &x in face {
                sets.join(face[0], x);
                sets.join(x, vertex(x as usize) as u32);
            }
        }
        let root: Vec<u32> = (0..n as u32).map(|x| sets.root(x)).collect();
        let mut kind = vec![NO_FACES; n];
        let mix =
            |hash: &mut u64, value: u32| *hash = (*hash ^ u64::from(value)).wrapping_mul(0x100_0000_01b3);
        for face in faces.iter() {
            let part = root[face[0] as usize];
            mix(&mut kind[part as usize], face.len() as u32);
            for &x in face {
                mix(&mut kind[part as usize], vertex(x as usize) as u32 - part);
            }
        }
        let mut n_of_kind = HashMap::new();
        for x in (0..n).filter(|&x| root[x] as usize == x && kind[x] != NO_FACES) {
            *n_of_kind.entry(kind[x]).or_insert(0) += 1;
        }
        // Vertices without faces are no parts.
        n_of_kind.insert(NO_FACES, 1);
        Self { root, kind, n_of_kind }
    }

    /// True if the part of a vertex occurs once.
    fn is_unique(&self, x: usize) -> bool {
        self.n_of_kind[&self.kind[self.root[x] as usize]] == 1
    }

    /// First vertex of a part that lies at the place of an equal part, if most of its kind do.
    fn exchanged(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> Option<usize> {
        let mut centers = vec![([0.0; 3], [0.0; 3], 0.0); self.root.len()];
        for (x, &root) in self.root.iter().enumerate() {
            let (in_a, in_b, count) = &mut centers[root as usize];
            (*in_a, *in_b) = (add_scaled(in_a, 1.0, &a[x]), add_scaled(in_b, 1.0, &b[x]));
            *count += 1.0;
        }
        let mut kinds: HashMap<u64, Vec<usize>> = HashMap::new();
        for x in (0..self.root.len()).filter(|&x| self.root[x] as usize == x && !self.is_unique(x)) {
            let (in_a, in_b, count) = &mut centers[x];
            (*in_a, *in_b) = (in_a.map(|c| c / *count), in_b.map(|c| c / *count));
            kinds.entry(self.kind[x]).or_default().push(x);
        }
        kinds.values().filter_map(|parts| exchanged_part(parts, &centers)).min()
    }
}

/// First of `parts` that lies at the place of another part in the second mesh. `None` unless each part is nearest to a
/// different place and these distances sum to less than half of the distances from the places of the same numbers.
fn exchanged_part(parts: &[usize], centers: &[([f64; 3], [f64; 3], f64)]) -> Option<usize> {
    let (mut own, mut nearest, mut first, mut places) = (0.0, 0.0, None, HashSet::new());
    for &x in parts.iter().step_by(parts.len().div_ceil(MOST_PARTS)) {
        let distance = |y: usize| norm(&subtract(&centers[x].1, &centers[y].0));
        let near = parts.iter().copied().min_by(|&p, &q| distance(p).total_cmp(&distance(q)))?;
        own += distance(x);
        nearest += distance(near);
        if distance(near) < distance(x) {
            first = first.or(Some(x));
        }
        if !places.insert(near) {
            return None;
        }
    }
    first.filter(|_| nearest < 0.5 * own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Progress;
    use crate::shape::{Mesh, WeldMode};

    fn prepared(points: &[[f64; 3]], faces: &[[u32; 3]]) -> PreparedGeometry {
        let mesh = Mesh::new(points.to_vec(), Polygons::from_triangles(faces)).unwrap();
        PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none()).unwrap()
    }

    /// Corners of the triangles of a terrain of n × n squares, triangle by triangle, and the faces of these corners.
    fn soup(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let point = |(i, j): (u32, u32)| [f64::from(i), f64::from(j), f64::from(i * 7 % 5 + j * j % 3)];
        let squares = (0..n * n).map(|k| (k / n, k % n));
        let corners = squares.flat_map(|(i, j)| {
            [(i, j), (i + 1, j), (i + 1, j + 1), (i, j), (i + 1, j + 1), (i, j + 1)].map(point)
        });
        (corners.collect(), (0..2 * n * n).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
    }

    #[test]
    fn a_soup_in_another_order_is_told_from_a_soup_that_moved() {
        for n in [1, 2, 5, 12] {
            let (points, faces) = soup(n);
            let first = prepared(&points, &faces);
            let moved: Vec<_> = points.iter().map(|p| [3.0 * p[1], p[0], p[2] * p[2] + p[0]]).collect();
            assert_eq!(first_misplaced_vertex(&first, &prepared(&moved, &faces)), None, "{n}");
            let triangles: Vec<&[[f64; 3]]> = points.chunks(3).collect();
            let reversed: Vec<[f64; 3]> = triangles.iter().rev().copied().flatten().copied().collect();
            let mut exchanged = points.clone();
            exchanged.rotate_right(3);
            let mut turned = points.clone();
            turned[..3].rotate_left(1);
            for other in [reversed, exchanged, turned] {
                assert!(first_misplaced_vertex(&first, &prepared(&other, &faces)).is_some(), "{n}");
            }
        }
    }

    #[test]
    fn equal_parts_in_another_order_are_told_from_parts_that_moved() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let places: [[f64; 3]; 4] = [[0.0; 3], [5.0, 0.0, 0.0], [9.0, 7.0, 0.0], [2.0, 3.0, 8.0]];
        let parts = |order: [usize; 4], by: f64| -> Vec<[f64; 3]> {
            let part = |k: usize| corners.iter().map(move |p| [0, 1, 2].map(|c| p[c] + places[k][c] + by));
            order.into_iter().flat_map(part).collect()
        };
        let faces: Vec<[u32; 3]> = (0..4)
            .flat_map(|k| [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|f| f.map(|x| x + 4 * k)))
            .collect();
        let first = prepared(&parts([0, 1, 2, 3], 0.0), &faces);
        for by in [0.0, 0.1, 2.0, 30.0] {
            assert_eq!(
                first_misplaced_vertex(&first, &prepared(&parts([0, 1, 2, 3], by), &faces)),
                None,
                "{by}"
            );
        }
        for by in [0.0, 0.1] {
            let other = prepared(&parts([0, 3, 1, 2], by), &faces);
            assert_eq!(first_misplaced_vertex(&first, &other), Some(4), "{by}");
        }
    }

    #[test]
    fn a_seam_that_came_apart_leaves_the_order() {
        // Two charts of different faces, welded along a side, and the second one moved away.
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
        ];
        let faces = [[0, 1, 2], [0, 2, 3], [4, 5, 6]];
        let apart = [&points[..4], &points[4..].iter().map(|p| [p[0] + 0.5, p[1], p[2]]).collect::<Vec<_>>()]
            .concat();
        assert_eq!(first_misplaced_vertex(&prepared(&points, &faces), &prepared(&apart, &faces)), None);
    }
}
