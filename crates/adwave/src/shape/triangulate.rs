//! Polygon faces cut into triangles, for the mathematics only: files keep their polygons.

use super::Polygons;
use crate::parallel::{self, unstopped};
use crate::{Cancelled, Progress};
use nalgebra::Vector3;

/// Cuts every face of three corners or more into triangles with the corners of the face. O(corners) for convex faces.
///
/// Convex faces become a fan round their first corner; faces that are not convex (in the plane of their Newell normal)
/// are cut by ear clipping. Faces of fewer than three corners give no triangle.
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
    unstopped(try_triangulate(points, faces, Progress::none(), |corner| corner))
}

/// Faces that a thread cuts at a time.
const FACES_AT_A_TIME: usize = 1 << 12;

/// [`triangulate`] with other names for the corners, stopped when the call is.
pub(super) fn try_triangulate(
    points: &[[f64; 3]],
    faces: &Polygons,
    progress: Progress<'_>,
    renamed: impl Fn(u32) -> u32 + Sync + Send,
) -> Result<Vec<[u32; 3]>, Cancelled> {
    if let Some(triangles) = faces.triangles() {
        return parallel::try_collect(triangles.len(), progress, |f| triangles[f].map(&renamed));
    }
    let scratch = || (earcut::Earcut::new(), Vec::new());
    let chunks =
        parallel::try_map_chunks(faces.len(), FACES_AT_A_TIME, progress, scratch, |scratch, range| {
            let (earcut, cut) = scratch;
            let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(2 * range.len());
            for face in range.map(|f| faces.get(f)) {
                match *face {
                    [_, _] | [_] | [] => {}
                    [a, b, c] => triangles.push([a, b, c]),
                    _ => match reflex_outline(points, face) {
                        None => triangles.extend((2..face.len()).map(|k| [face[0], face[k - 1], face[k]])),
                        Some(outline) => {
                            earcut.earcut(outline.iter().copied(), &[], cut);
                            let ears = cut.as_chunks().0.iter();
                            triangles.extend(ears.map(|ear: &[u32; 3]| ear.map(|k| face[k as usize])));
                        }
                    },
                }
            }
            for corner in triangles.as_flattened_mut() {
                *corner = renamed(*corner);
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

/// The face in its own plane when it has a reflex corner, `None` when it is convex or has no area.
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
