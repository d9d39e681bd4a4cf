//! Normals at the corners of triangles, smooth over faces that meet gently and sharp at creases.

use crate::surface::Surface;
use crate::vector::{Vec3, add_scaled, cross, dot, sub, unit};
use adwave::shape::nearest_neighbours;
use adwave::signal::cloud_normals;
use rayon::prelude::*;

/// Neighbours for the normals of a cloud.
const K: usize = 10;

/// The unit normal of each corner, three a triangle: the mean over the faces at its vertex that meet this face at less than
/// `crease_angle` degrees, weighted by area. O(sum over the vertices of their squared numbers of faces).
///
/// Faces on the other side of a fold count by their nearer orientation, so a mesh whose faces are not oriented alike is
/// shaded smoothly too.
pub(crate) fn corner_normals(surface: &Surface, crease_angle: f64) -> Vec<[Vec3; 3]> {
    let n = surface.points.len();
    let face_vectors: Vec<Vec3> = surface
        .triangles
        .par_iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| &surface.points[v as usize]);
            cross(&sub(b, a), &sub(c, a))
        })
        .collect();
    let (starts, faces) = faces_of_vertices(n, surface.triangles);
    let least = crease_angle.to_radians().cos();
    surface
        .triangles
        .par_iter()
        .enumerate()
        .map(|(f, triangle)| {
            let Some(own) = unit(&face_vectors[f]) else { return [[0.0; 3]; 3] };
            triangle.map(|v| {
                let round = &faces[starts[v as usize] as usize..starts[v as usize + 1] as usize];
                let sum = round.iter().fold([0.0; 3], |sum, &other| {
                    let vector = &face_vectors[other as usize];
                    let size = dot(vector, vector).sqrt();
                    let along = dot(vector, &own);
                    if size > 0.0 && along.abs() >= least * size {
                        add_scaled(&sum, along.signum(), vector)
                    } else {
                        sum
                    }
                });
                unit(&sum).unwrap_or(own)
            })
        })
        .collect()
}

/// For each vertex the triangles at it: where they start in the list, and the list.
fn faces_of_vertices(n: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; n + 1];
    triangles.iter().flatten().for_each(|&v| starts[v as usize + 1] += 1);
    (0..n).for_each(|v| starts[v + 1] += starts[v]);
    let mut at = starts.clone();
    let mut faces = vec![0; 3 * triangles.len()];
    for (f, triangle) in triangles.iter().enumerate() {
        for &v in triangle {
            faces[at[v as usize] as usize] = f as u32;
            at[v as usize] += 1;
        }
    }
    (starts, faces)
}

/// For each point of a cloud the unit normal of the plane through its neighbours, and the mean distance to the nearest of
/// them, model units. O(n log n).
pub(crate) fn discs(points: &[Vec3]) -> (Vec<Vec3>, Vec<f64>) {
    let near = nearest_neighbours(points, K);
    let spacing = (0..points.len())
        .into_par_iter()
        .map(|i| {
            let mut squares: Vec<f64> = near
                .adjacency
                .of(i)
                .iter()
                .map(|&j| {
                    let d = sub(&points[j as usize], &points[i]);
                    dot(&d, &d)
                })
                .filter(|&d| d > 0.0)
                .collect();
            squares.sort_unstable_by(f64::total_cmp);
            squares.truncate(4);
            squares.iter().map(|d| d.sqrt()).sum::<f64>() / squares.len().max(1) as f64
        })
        .collect();
    (cloud_normals(points, &near), spacing)
}
