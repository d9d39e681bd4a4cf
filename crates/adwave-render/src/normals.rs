//! Vertex normals of a mesh, for smooth shading that keeps edges sharp.

use adwave::vector::{Vector, add_scaled, cross, dot, subtract, unit};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;
use std::collections::HashMap;

/// Normals of the corners of the triangles, stored by index.
#[derive(Debug)]
pub(crate) struct CornerNormals {
    /// Unit normals in the model's axes, oriented by the order of the triangle's corners; zero for triangles without
    /// area.
    pub(crate) normals: Vec<Vector>,
    /// Indices into `normals` for the three corners of each triangle.
    pub(crate) of: Vec<[u32; 3]>,
}

/// Number of vertices or corners processed between two checks of the progress handle.
const CHECK_INTERVAL: usize = 1 << 14;

/// Computes corner normals as angle-weighted means over the faces at a vertex. A mean includes only the faces that meet
/// the corner's own face at less than `crease_angle` (degrees). O(n), and O(Σ valence²) at creases.
///
/// Vertices at equal positions count as one, so that the seams of files with duplicated vertices are invisible.
///
/// Source: Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", 1998.
pub(crate) fn corner_normals(
    points: &[Vector],
    triangles: &[[u32; 3]],
    crease_angle: f64,
    progress: Progress<'_>,
) -> Result<CornerNormals, Cancelled> {
    let class = positions(points, progress)?;
    let scale = largest_extent(points);
    let faces: Vec<Vector> = triangles.par_iter().map(|t| face_normal(points, t, scale)).collect();
    progress.check()?;
    let (first, corners) = corners_at(&class, triangles, progress)?;
    let limit = crease_angle.to_radians().cos();
    let half = (crease_angle / 2.0).to_radians().cos();
    // (class, normals of its corners): one normal if the vertex is smooth, one per corner at a crease.
    let found: Vec<Vec<Vector>> = (0..first.len() - 1)
        .into_par_iter()
        .with_min_len(1024)
        .map(|v| {
            progress.check()?;
            let here = &corners[first[v]..first[v + 1]];
            let weighted: Vec<(Vector, f64)> = here
                .iter()
                .map(|&c| (faces[c as usize / 3], corner_angle(points, &triangles[c as usize / 3], c % 3)))
                .collect();
            // Both sides are lit equally, so a face with the opposite orientation counts with a flipped normal.
            let mean = |toward: &Vector, least: f64| {
                let kept = weighted.iter().filter(|(n, _)| dot(toward, n).abs() >= least);
                let add =
                    |sum: Vector, (n, w): &(Vector, f64)| add_scaled(&sum, w.copysign(dot(toward, n)), n);
                unit(&kept.fold([0.0; 3], add))
            };
            let first = weighted.iter().map(|(n, _)| *n).find(|n| *n != [0.0; 3]).unwrap_or([0.0; 3]);
            let all = mean(&first, 0.0).unwrap_or([0.0; 3]);
            if weighted.iter().all(|(n, _)| dot(n, &all).abs() >= half || *n == [0.0; 3]) {
                return Ok(vec![all]);
            }
            Ok(weighted.iter().map(|(own, _)| mean(own, limit).unwrap_or(*own)).collect())
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut of = vec![[0_u32; 3]; triangles.len()];
    let mut normals = Vec::with_capacity(found.len());
    for (v, list) in found.iter().enumerate() {
        if v % CHECK_INTERVAL == 0 {
            progress.check()?;
        }
        let start = normals.len();
        normals.extend_from_slice(list);
        for (k, &c) in corners[first[v]..first[v + 1]].iter().enumerate() {
            let face = c as usize / 3;
            let mut at = start + if list.len() == 1 { 0 } else { k };
            if dot(&faces[face], &normals[at]) < 0.0 {
                normals.push(normals[at].map(|c| -c));
                at = normals.len() - 1;
            }
            of[face][c as usize % 3] = at as u32;
        }
    }
    Ok(CornerNormals { normals, of })
}

fn largest_extent(points: &[Vector]) -> f64 {
    let most = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    if most > 0.0 { most } else { 1.0 }
}

fn face_normal(points: &[Vector], triangle: &[u32; 3], scale: f64) -> Vector {
    let [a, b, c] = triangle.map(|v| points[v as usize].map(|c| c / scale));
    let (ab, ac) = (subtract(&b, &a), subtract(&c, &a));
    // Edges are scaled to length 1, because the cross product of tiny ones would underflow.
    match (unit(&ab), unit(&ac)) {
        (Some(ab), Some(ac)) => unit(&cross(&ab, &ac)).unwrap_or([0.0; 3]),
        _ => [0.0; 3],
    }
}

fn corner_angle(points: &[Vector], triangle: &[u32; 3], corner: u32) -> f64 {
    let at = |k: u32| points[triangle[(k % 3) as usize] as usize];
    let p = at(corner);
    match (unit(&subtract(&at(corner + 1), &p)), unit(&subtract(&at(corner + 2), &p))) {
        (Some(a), Some(b)) => dot(&a, &b).clamp(-1.0, 1.0).acos(),
        _ => 0.0,
    }
}

/// Finds the class of each vertex, equal for vertices at equal positions.
fn positions(points: &[Vector], progress: Progress<'_>) -> Result<Vec<u32>, Cancelled> {
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::with_capacity(points.len());
    let mut class = Vec::with_capacity(points.len());
    for chunk in points.chunks(CHECK_INTERVAL) {
        progress.check()?;
        class.extend(chunk.iter().map(|p| {
            let next = numbers.len() as u32;
            // −0 and 0 are the same position.
            *numbers.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(next)
        }));
    }
    Ok(class)
}

/// Lists the corners (3 × triangle + corner) at each class of vertices, as offsets and a list.
fn corners_at(
    class: &[u32],
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<(Vec<usize>, Vec<u32>), Cancelled> {
    let n = class.iter().max().map_or(0, |m| *m as usize + 1);
    let mut first = vec![0; n + 1];
    for chunk in triangles.as_flattened().chunks(CHECK_INTERVAL) {
        progress.check()?;
        for &v in chunk {
            first[class[v as usize] as usize + 1] += 1;
        }
    }
    for v in 0..n {
        first[v + 1] += first[v];
    }
    let mut next = first.clone();
    let mut corners = vec![0; triangles.len() * 3];
    for (c, &v) in triangles.as_flattened().iter().enumerate() {
        if c % CHECK_INTERVAL == 0 {
            progress.check()?;
        }
        let at = &mut next[class[v as usize] as usize];
        corners[*at] = c as u32;
        *at += 1;
    }
    Ok((first, corners))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner_normals(points: &[Vector], triangles: &[[u32; 3]], crease_angle: f64) -> CornerNormals {
        super::corner_normals(points, triangles, crease_angle, Progress::none()).unwrap()
    }

    const CUBE_CORNER: [Vector; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const THREE_SIDES: [[u32; 3]; 3] = [[0, 1, 2], [0, 2, 3], [0, 3, 1]];

    #[test]
    fn a_crease_is_kept_and_a_wide_angle_smooths_it() {
        let sharp = corner_normals(&CUBE_CORNER, &THREE_SIDES, 50.0);
        for (t, axis) in [(0, 2), (1, 0), (2, 1)] {
            for corner in sharp.of[t] {
                assert!((sharp.normals[corner as usize][axis].abs() - 1.0).abs() < 1e-12);
            }
        }
        let smooth = corner_normals(&CUBE_CORNER, &THREE_SIDES, 180.0);
        // Three right angles at the corner: all axes have the same weight.
        let n = smooth.normals[smooth.of[0][0] as usize];
        assert!(n.iter().all(|c| (c - 1.0 / 3.0_f64.sqrt()).abs() < 1e-12), "{n:?}");
    }

    #[test]
    fn a_face_listed_the_other_way_round_is_shaded_as_its_neighbors() {
        let gentle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.2]];
        let normals = |second| {
            let found = corner_normals(&gentle, &[[0, 1, 2], second], 50.0);
            found.of[0].map(|c| found.normals[c as usize])
        };
        for (a, b) in normals([1, 3, 2]).iter().zip(&normals([3, 1, 2])) {
            assert!((dot(a, b) - 1.0).abs() < 1e-12);
        }
        let found = corner_normals(&gentle, &[[0, 1, 2], [3, 1, 2]], 50.0);
        assert!(found.of[1].iter().all(|c| found.normals[*c as usize][2] < 0.0), "on its own side");
    }

    #[test]
    fn repeated_vertices_share_their_normal() {
        let seam =
            [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.3]];
        let found = corner_normals(&seam, &[[0, 1, 2], [3, 4, 5]], 50.0);
        assert_eq!(found.of[0][1], found.of[1][1]);
        assert_eq!(found.of[0][2], found.of[1][0]);
    }
}
