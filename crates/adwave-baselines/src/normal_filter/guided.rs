//! Guided normal filtering (`zhang2015`).

use super::faces::{BilateralWidths, FaceGeometry, FaceLists, Faces, filter_normals, mean_distance};
use super::vertex_update::{Border, fixed_vertices, move_vertices};
use super::{
    FaceNeighbors, NormalFilterError, check_iterations, check_positive, to_shape_order, unit_points,
};
use adwave::Progress;
use adwave::shape::PreparedGeometry;
use adwave::vector::{Vector, add_scaled, norm, subtract, unit};
use rayon::prelude::*;

/// Parameters of [`guided_normals`]; the defaults are those in the program of its authors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GuidedParams {
    /// Radius of the averaged neighborhood, in mean distances of the centroids of faces that share an edge; 2 by
    /// default.
    pub radius: f64,
    /// Width σ_s for the distance of centroids, in the same unit; 1 by default.
    pub sigma_s: f64,
    /// Width σ_r, a distance of the guidance's unit normals, which is 2 sin of half the angle between them; 0.35 by
    /// default.
    pub sigma_r: f64,
    /// Number of rounds of normal filtering, each followed by a vertex update; 20 by default.
    pub normal_iterations: usize,
    /// Number of steps of the vertex update in each round; 10 by default.
    pub vertex_iterations: usize,
    /// Movement of the vertices at the border; free by default.
    pub border: Border,
}

impl Default for GuidedParams {
    fn default() -> Self {
        Self {
            radius: 2.0,
            sigma_s: 1.0,
            sigma_r: 0.35,
            normal_iterations: 20,
            vertex_iterations: 10,
            border: Border::Free,
        }
    }
}

impl GuidedParams {
    /// Sets the width of the range weight.
    #[must_use]
    pub fn with_sigma_r(self, sigma_r: f64) -> Self {
        Self { sigma_r, ..self }
    }

    /// Sets the number of rounds.
    #[must_use]
    pub fn with_normal_iterations(self, normal_iterations: usize) -> Self {
        Self { normal_iterations, ..self }
    }

    /// Sets the number of steps of the vertex update in each round.
    #[must_use]
    pub fn with_vertex_iterations(self, vertex_iterations: usize) -> Self {
        Self { vertex_iterations, ..self }
    }

    fn check(&self) -> Result<(), NormalFilterError> {
        check_positive("radius", self.radius)?;
        check_positive("sigma_s", self.sigma_s)?;
        check_positive("sigma_r", self.sigma_r)?;
        check_iterations("normal iterations", self.normal_iterations)?;
        check_iterations("vertex iterations", self.vertex_iterations)
    }
}

/// Summand that keeps the consistency of a flat patch finite.
const EPSILON: f64 = 1e-9;

/// Denoises a mesh by filtering its normals with a guidance; returns positions in model units, in the order of the
/// shape.
///
/// A patch is a face with all faces that share a vertex with it. Its consistency is
/// `max ‖n_f − n_g‖ · max_e d_e / Σ_e d_e`, where d_e is the distance of the normals across an inner edge. The guidance
/// u_f is the mean normal of the most consistent patch that contains f. The normals are filtered by
/// `n_f ← unit(Σ_g A_g · e^(−‖c_f − c_g‖²/2σ_s²) · e^(−‖u_f − u_g‖²/2σ_r²) · n_g)` over the faces g within the radius
/// on the noisy mesh, f included, at most 500. Then [`update_vertices`](super::update_vertices) moves the vertices.
/// Every round starts from the normals of the current faces. A corner of the shape is rounded off if one of its sides
/// is a single triangle there, because all patches of that triangle contain an edge of the shape. O(rounds · (pairs of
/// neighbors + pairs of faces in patches)).
///
/// # Errors
/// [`NormalFilterError`].
pub fn guided_normals(
    geometry: &PreparedGeometry,
    params: &GuidedParams,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, NormalFilterError> {
    params.check()?;
    let faces = Faces::new(geometry)?;
    let (mut points, unit) = unit_points(geometry);
    let across = faces.pairs_across_edges();
    let around = faces.neighbors(FaceNeighbors::ByVertex);
    let centroids = faces.measure(&points).centroids;
    let neighbors =
        faces.faces_within_radius(params.radius * mean_distance(&across, &centroids), &centroids, &around);
    let patches = Patches::new(around, &across);
    let stays = fixed_vertices(&faces, points.len(), params.border);
    for round in 0..params.normal_iterations {
        progress.step(round as u64, params.normal_iterations as u64)?;
        let measures = faces.measure(&points);
        let space = params.sigma_s * mean_distance(&across, &measures.centroids);
        let widths = BilateralWidths { space, range: params.sigma_r };
        let guidance = patches.guidance(&measures);
        let normals = filter_normals(&measures, &measures.normals, &guidance, &neighbors, widths);
        for _ in 0..params.vertex_iterations {
            progress.check()?;
            points = move_vertices(&faces, &points, &normals, &stays);
        }
    }
    Ok(to_shape_order(geometry, &points, unit))
}

/// Patches of all faces.
struct Patches {
    /// Faces that share a vertex with each face, in ascending order; the face itself belongs to its patch too.
    around: FaceLists,
    /// Faces across the edges of each face that have a larger index.
    beyond: Vec<Vec<u32>>,
}

impl Patches {
    fn new(around: FaceLists, across: &[[u32; 2]]) -> Self {
        let mut beyond = vec![Vec::new(); around.len()];
        for &[f, g] in across {
            beyond[f.min(g) as usize].push(f.max(g));
        }
        Self { around, beyond }
    }

    /// Computes the consistency of a face's patch (smaller is better) and its mean normal.
    fn measure(&self, f: usize, measures: &FaceGeometry) -> (f64, Vector) {
        let around = self.around.list(f);
        let distance =
            |g: u32, h: u32| norm(&subtract(&measures.normals[g as usize], &measures.normals[h as usize]));
        let members = || around.iter().copied().chain([f as u32]);
        let (mut mean, mut widest, mut steepest, mut sum) = ([0.0; 3], 0.0_f64, 0.0_f64, 0.0);
        for (k, g) in members().enumerate() {
            mean = add_scaled(&mean, measures.areas[g as usize], &measures.normals[g as usize]);
            widest = members().skip(k + 1).map(|h| distance(g, h)).fold(widest, f64::max);
            for &h in &self.beyond[g as usize] {
                if h as usize == f || around.binary_search(&h).is_ok() {
                    let step = distance(g, h);
                    steepest = steepest.max(step);
                    sum += step;
                }
            }
        }
        (widest * steepest / (sum + EPSILON), unit(&mean).unwrap_or(measures.normals[f]))
    }

    /// Finds, for each face, the mean normal of the most consistent patch that contains it; among equals, the patch of
    /// the face with the smallest index.
    fn guidance(&self, measures: &FaceGeometry) -> Vec<Vector> {
        let all: Vec<(f64, Vector)> =
            (0..self.around.len()).into_par_iter().map(|f| self.measure(f, measures)).collect();
        let best = |f: usize| {
            let patches = self.around.list(f).iter().copied().chain([f as u32]);
            let order = |&g: &u32, &h: &u32| all[g as usize].0.total_cmp(&all[h as usize].0).then(g.cmp(&h));
            patches.min_by(order).map_or(measures.normals[f], |g| all[g as usize].1)
        };
        (0..self.around.len()).into_par_iter().map(best).collect()
    }
}
