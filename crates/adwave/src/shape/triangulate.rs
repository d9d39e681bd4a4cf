//! Triangulation of polygon faces, for computation only: files keep their polygons.

use super::Polygons;
use crate::parallel::{self, expect_not_cancelled};
use crate::{Cancelled, Progress};
use nalgebra::Vector3;

/// Cuts every face of three corners or more into triangles with the corners of the face. O(corners) for convex
/// faces.
///
/// Convex faces become a fan around their first corner; faces that are not convex (in the plane of their Newell
/// normal) are cut by ear clipping. A face of n corners gives n − 2 triangles that use all corners; faces with
/// fewer than three corners give none.
///
/// ```
/// use adwave::shape::{Polygons, triangulate};
/// let mut faces = Polygons::new();
/// faces.push(&[0, 1, 2, 3]); // an arrow head, not convex at corner 1
/// let points = [[0.0, 2.0, 0.0], [0.0, 0.5, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
/// let triangles = triangulate(&points, &faces);
/// assert_eq!(triangles.len(), 2);
/// assert!(triangles.iter().all(|t| t.contains(&1)));
/// ```
pub fn triangulate(points: &[[f64; 3]], faces: &Polygons) -> Vec<[u32; 3]> {
    expect_not_cancelled(try_triangulate(points, faces, Progress::none(), |_, corners| corners))
}

/// The triangles of [`triangulate`], each with the index of its face.
///
/// ```
/// use adwave::shape::{Polygons, triangulate_with_faces};
/// let mut faces = Polygons::new();
/// faces.push(&[0, 1, 2]);
/// faces.push(&[0, 2, 3, 4]);
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 2.0, 0.0], [0.0, 1.0, 0.0]];
/// let triangles = triangulate_with_faces(&points, &faces);
/// assert_eq!(triangles, [(0, [0, 1, 2]), (1, [0, 2, 3]), (1, [0, 3, 4])]);
/// ```
pub fn triangulate_with_faces(points: &[[f64; 3]], faces: &Polygons) -> Vec<(usize, [u32; 3])> {
    expect_not_cancelled(try_triangulate(points, faces, Progress::none(), |face, corners| (face, corners)))
}

/// Number of faces that a thread cuts at a time.
const FACES_AT_A_TIME: usize = 1 << 12;

/// Values of `made` for each triangle of [`triangulate`], given its face and its corners; stops if the call is
/// cancelled.
pub(super) fn try_triangulate<T: Clone + Default + Send>(
    points: &[[f64; 3]],
    faces: &Polygons,
    progress: Progress<'_>,
    made: impl Fn(usize, [u32; 3]) -> T + Sync + Send,
) -> Result<Vec<T>, Cancelled> {
    if let Some(triangles) = faces.triangles() {
        return parallel::try_collect(triangles.len(), progress, |f| made(f, triangles[f]));
    }
    let scratch = || (earcut::Earcut::new(), Vec::new());
    let chunks =
        parallel::try_map_chunks(faces.len(), FACES_AT_A_TIME, progress, scratch, |scratch, range| {
            let (earcut, cut) = scratch;
            let mut triangles = Vec::with_capacity(2 * range.len());
            for f in range {
                let face = faces.get(f);
                match *face {
                    [_, _] | [_] | [] => {}
                    [a, b, c] => triangles.push(made(f, [a, b, c])),
                    _ => match reflex_outline(points, face) {
                        None => {
                            let fan = (2..face.len()).map(|k| [face[0], face[k - 1], face[k]]);
                            triangles.extend(fan.map(|corners| made(f, corners)));
                        }
                        Some(outline) => {
                            earcut.earcut(outline.iter().copied(), &[], cut);
                            let ears = with_flat_corners(cut.as_chunks().0.to_vec(), face.len());
                            triangles.extend(ears.iter().map(|ear| made(f, ear.map(|k| face[k as usize]))));
                        }
                    },
                }
            }
            triangles
        })?;
    let mut triangles = Vec::with_capacity(chunks.iter().map(Vec::len).sum());
    for chunk in chunks {
        progress.check()?;
        triangles.extend(chunk);
    }
    Ok(triangles)
}

/// Ears that use all of `n` corners. Ear clipping omits corners on straight edges, where other faces may meet, so
/// the triangle at such an edge is cut once more for each. Falls back to a fan if that does not give n − 2
/// triangles, as for crossing edges.
fn with_flat_corners(mut ears: Vec<[u32; 3]>, n: usize) -> Vec<[u32; 3]> {
    let n_corners = n as u32;
    if ears.len() + 2 != n {
        let mut is_used = vec![false; n];
        ears.as_flattened().iter().for_each(|&k| is_used[k as usize] = true);
        // The next used corner, for each corner.
        let mut next = vec![0; n];
        let mut following = is_used.iter().position(|&used| used).unwrap_or(0);
        for k in (0..n).rev() {
            next[k] = following as u32;
            following = if is_used[k] { k } else { following };
        }
        for e in 0..ears.len() {
            for side in 0..3 {
                let [start, mut end, apex] = [0, 1, 2].map(|c| ears[e][(side + c) % 3]);
                if end != next[start as usize] {
                    continue;
                }
                // The triangle keeps the first part of its edge.
                while end != (start + 1) % n_corners {
                    let corner = (end + n_corners - 1) % n_corners;
                    ears.push([corner, end, apex]);
                    end = corner;
                }
                ears[e][(side + 1) % 3] = end;
            }
        }
    }
    if ears.len() + 2 == n { ears } else { (2..n_corners).map(|k| [0, k - 1, k]).collect() }
}

/// The face in its own plane if it has a reflex corner, `None` if it is convex or has no area.
fn reflex_outline(points: &[[f64; 3]], face: &[u32]) -> Option<Vec<[f64; 2]>> {
    let corner = |k: usize| Vector3::from(points[face[k % face.len()] as usize]);
    let origin = corner(0);
    let newell: Vector3<f64> =
        (0..face.len()).map(|k| (corner(k) - origin).cross(&(corner(k + 1) - origin))).sum();
    let normal = newell.try_normalize(0.0)?;
    let helper = if normal.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let u = normal.cross(&helper).normalize();
    let v = normal.cross(&u);
    let outline: Vec<[f64; 2]> = (0..face.len())
        .map(|k| {
            let d = corner(k) - origin;
            [d.dot(&u), d.dot(&v)]
        })
        .collect();
    // A corner counts as reflex only beyond rounding, so that a flat corner does not turn a fan into ears.
    let tolerance = 1e-9 * newell.norm();
    let turns = |k: usize| {
        let [p, q, r] = [k, k + 1, k + 2].map(|i| outline[i % outline.len()]);
        (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0])
    };
    (0..outline.len()).any(|k| turns(k) < -tolerance).then_some(outline)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }

    /// Checks the n − 2 triangles of one face: they use all corners, have its orientation and its area.
    fn check(outline: &[[f64; 2]]) {
        for rotation in 0..outline.len() {
            let n = outline.len();
            let points: Vec<[f64; 3]> =
                (0..n).map(|k| outline[(k + rotation) % n]).map(|[x, y]| [x, y, 0.0]).collect();
            let mut faces = Polygons::new();
            faces.push(&(0..n as u32).collect::<Vec<_>>());
            let triangles = triangulate(&points, &faces);
            assert_eq!(triangles.len(), n - 2);
            let areas: Vec<f64> = triangles.iter().map(|t| area(t.map(|k| points[k as usize]))).collect();
            assert!(areas.iter().all(|&a| a >= 0.0), "{areas:?}");
            let of_face: f64 = (0..n).map(|k| area([[0.0; 3], points[k], points[(k + 1) % n]])).sum();
            assert!((areas.iter().sum::<f64>() - of_face).abs() < 1e-12);
            for k in 0..n as u32 {
                // Each edge of the face is an edge of a triangle, in its direction.
                let edge = [k, (k + 1) % n as u32];
                let has = |t: &[u32; 3]| (0..3).any(|c| [t[c], t[(c + 1) % 3]] == edge);
                assert!(triangles.iter().any(has), "{edge:?} of {triangles:?}");
            }
        }
    }

    #[test]
    fn corners_on_straight_edges_stay() {
        // An L with one and with three corners on its edges.
        check(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
        check(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
        check(&[
            [0.0, 0.0],
            [0.5, 0.0],
            [0.75, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ]);
    }

    #[test]
    fn a_face_that_crosses_itself_is_a_fan() {
        let points = [[0.0; 3], [0.0, -3e199, 0.0], [502.0, 0.0, 0.0], [0.0, 680.0, 0.0]];
        let mut faces = Polygons::new();
        faces.push(&[2, 3, 0, 2, 1]);
        assert_eq!(triangulate(&points, &faces).len(), 3);
    }
}
