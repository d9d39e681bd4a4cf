//! Vertex update: moves vertices so that the faces follow given normals.

use super::faces::Faces;
use super::{NormalFilterError, check_iterations, to_shape_order, unit_points};
use adwave::Progress;
use adwave::shape::PreparedGeometry;
use adwave::vector::{Vector, add_scaled, dot, subtract};
use rayon::prelude::*;

/// Movement of vertices at edges with a single face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Border {
    /// Border vertices move like all others.
    #[default]
    Free,
    /// Border vertices do not move.
    Fixed,
}

/// Moves the vertices so that the faces take the given normals: `v ← v + mean over its faces of n·(n·(c − v))`, where c
/// is the face's centroid and n its entry of `normals`. Faces whose normal is zero are skipped. The step is repeated
/// `iterations` times, each from all positions of the previous round (`sun2007`).
///
/// `normals` are of unit length or zero, one per triangle of the geometry. The returned positions are in model units
/// and in the order of the shape; vertices at equal positions stay together. O(iterations · triangles).
///
/// # Errors
/// [`NormalFilterError`].
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{Mesh, PreparedGeometry, Shape, WeldMode};
/// use adwave_baselines::normal_filter::{Border, update_vertices};
/// let tilted = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.3]];
/// let shape = Shape::Mesh(Mesh::new(tilted, vec![[0, 1, 2]].into())?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none())?;
/// let flat = update_vertices(&geometry, &[[0.0, 0.0, 1.0]], 1, Border::Free, Progress::none())?;
/// assert!(flat.iter().all(|p| (p[2] - 0.1).abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn update_vertices(
    geometry: &PreparedGeometry,
    normals: &[Vector],
    iterations: usize,
    border: Border,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, NormalFilterError> {
    let faces = Faces::new(geometry)?;
    check_iterations("vertex iterations", iterations)?;
    if normals.len() != faces.len() {
        return Err(NormalFilterError::Normals { got: normals.len(), wanted: faces.len() });
    }
    let (mut points, unit) = unit_points(geometry);
    let stays = fixed_vertices(&faces, points.len(), border);
    for _ in 0..iterations {
        progress.check()?;
        points = move_vertices(&faces, &points, normals, &stays);
    }
    Ok(to_shape_order(geometry, &points, unit))
}

/// Marks the vertices that do not move; empty if all may move.
pub(super) fn fixed_vertices(faces: &Faces<'_>, n_vertices: usize, border: Border) -> Vec<bool> {
    match border {
        Border::Free => Vec::new(),
        Border::Fixed => faces.border_vertices(n_vertices),
    }
}

/// Performs one round of [`update_vertices`].
pub(super) fn move_vertices(
    faces: &Faces<'_>,
    points: &[Vector],
    normals: &[Vector],
    stays: &[bool],
) -> Vec<Vector> {
    let moved = |x: usize| {
        let p = points[x];
        if stays.get(x) == Some(&true) {
            return p;
        }
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for &f in faces.at_vertex.list(x) {
            let n = &normals[f as usize];
            if *n == [0.0; 3] {
                continue;
            }
            let [a, b, c] = faces.triangles[f as usize].map(|v| points[v as usize]);
            let centroid: Vector = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
            sum = add_scaled(&sum, dot(n, &subtract(&centroid, &p)), n);
            count += 1.0;
        }
        if count > 0.0 { add_scaled(&p, 1.0 / count, &sum) } else { p }
    };
    (0..points.len()).into_par_iter().map(moved).collect()
}
