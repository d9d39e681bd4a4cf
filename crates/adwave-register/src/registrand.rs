//! Shapes prepared for registration: search structure, features, and samples of the surface.

use crate::closest::border_vertices;
use crate::motion::PrincipalFrame;
use crate::shape_features::Landmarks;
use crate::{ClosestPoint, ClosestPointSearch, Motion, ShapeFeatures};
use adwave::vector::{add_scaled, cross, dot, norm, subtract, unit};
use adwave::{Cancelled, Decomposer, Progress};
use nalgebra::{Matrix3, Vector3};
use std::borrow::Cow;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Number of samples of a surface.
const N_SAMPLES: usize = 1200;

/// Largest number of vertices in the last alignment.
const N_VERTICES: usize = 3000;

/// A shape prepared for registration.
pub struct Registrand {
    /// Search structure.
    pub surface: ClosestPointSearch,
    /// Features with bands and normals.
    pub features: ShapeFeatures,
    /// Mean distance between neighboring vertices, in model units.
    pub spacing: f64,
    /// Diagonal of the bounding box, without stray points, in model units.
    pub extent: f64,
    /// Area of the surface, in squared model units.
    pub area: f64,
    /// Distance of each welded vertex from the border along the surface, in model units; infinite if it is far.
    border_distance: Vec<f64>,
    /// Vertices for the last alignment, evenly sampled in their order.
    pub(crate) vertices: Vec<[f64; 3]>,
    samples: Vec<SurfaceSample>,
}

/// Point of a surface that represents an equal share of its area.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceSample {
    pub(crate) point: [f64; 3],
    /// Unit normal, outward if the shape has an outside.
    pub(crate) normal: [f64; 3],
    pub(crate) corners: [u32; 3],
    pub(crate) weights: [f64; 3],
}

impl Registrand {
    /// Prepares a shape with its features; `None` for a graph or a shape without points. O(n log n).
    ///
    /// # Errors
    /// Returns [`Cancelled`] on cancellation.
    pub fn new(
        decomposer: &Decomposer,
        features: ShapeFeatures,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let Some(geometry) = decomposer.geometry() else { return Ok(None) };
        let Some(surface) = ClosestPointSearch::new(geometry, progress)? else { return Ok(None) };
        let widest = features.bands.as_ref().map_or(0.0, |b| b.sigma.iter().copied().fold(0.0, f64::max));
        progress.check()?;
        let areas = welded_areas(decomposer);
        let mut samples = if surface.is_mesh() {
            mesh_samples(geometry.points(), geometry.triangles())
        } else {
            cloud_samples(geometry.points(), &areas)
        };
        for sample in &mut samples {
            let outward = interpolate(&features.normals, &sample.corners, &sample.weights);
            if sample.normal == [0.0; 3] {
                sample.normal = surface.closest(&sample.point).normal;
            }
            if dot(&outward, &sample.normal) < 0.0 {
                sample.normal = sample.normal.map(|c| -c);
            }
        }
        Ok(Some(Self {
            surface,
            features,
            spacing: decomposer.mean_length(),
            extent: decomposer.extent(),
            area: areas.iter().sum(),
            border_distance: distance_from_border(decomposer, 2.0 * widest),
            vertices: geometry
                .points()
                .iter()
                .copied()
                .step_by(geometry.points().len().div_ceil(N_VERTICES).max(1))
                .collect(),
            samples,
        }))
    }

    /// Positions of the samples.
    pub(crate) fn sample_points(&self) -> Vec<[f64; 3]> {
        self.samples.iter().map(|sample| sample.point).collect()
    }
}

/// A shape or its mirror image at x = 0; the search on the mirror image shows the fit that chance achieves.
pub(crate) struct RegistrandView<'a> {
    pub(crate) shape: &'a Registrand,
    pub(crate) samples: Vec<SurfaceSample>,
    is_mirrored: bool,
}

impl<'a> RegistrandView<'a> {
    pub(crate) fn new(shape: &'a Registrand) -> Self {
        Self { shape, samples: shape.samples.clone(), is_mirrored: false }
    }

    pub(crate) fn mirrored(shape: &'a Registrand) -> Self {
        let reflect = |sample: &SurfaceSample| SurfaceSample {
            point: mirror(&sample.point),
            normal: mirror(&sample.normal),
            ..*sample
        };
        Self { shape, samples: shape.samples.iter().map(reflect).collect(), is_mirrored: true }
    }

    /// Landmarks of the shape, mirrored if the view is.
    pub(crate) fn landmarks(&self) -> Cow<'a, Landmarks> {
        let landmarks = &self.shape.features.landmarks;
        if self.is_mirrored { Cow::Owned(landmarks.mirrored()) } else { Cow::Borrowed(landmarks) }
    }

    /// Finds the closest point, with the normal outward if the shape has an outside.
    pub(crate) fn closest(&self, point: &[f64; 3]) -> ClosestPoint {
        if self.is_mirrored {
            let closest = self.closest_of_shape(&mirror(point));
            ClosestPoint { point: mirror(&closest.point), normal: mirror(&closest.normal), ..closest }
        } else {
            self.closest_of_shape(point)
        }
    }

    fn closest_of_shape(&self, point: &[f64; 3]) -> ClosestPoint {
        let closest = self.shape.surface.closest(point);
        let outward = interpolate(&self.shape.features.normals, &closest.corners, &closest.weights);
        let is_inward = dot(&outward, &closest.normal) < 0.0;
        ClosestPoint { normal: closest.normal.map(|c| if is_inward { -c } else { c }), ..closest }
    }

    /// Distance of a point with the given corners from the border along the surface, in model units.
    pub(crate) fn border_distance(&self, corners: &[u32; 3]) -> f64 {
        corners.iter().map(|&x| self.shape.border_distance[x as usize]).fold(f64::INFINITY, f64::min)
    }

    /// Mean of the samples and the axes of their second moments, the axis of the largest moment first.
    pub(crate) fn principal_frame(&self) -> Option<PrincipalFrame> {
        let n = self.samples.len() as f64;
        let sum = self.samples.iter().fold([0.0; 3], |sum, s| add_scaled(&sum, 1.0, &s.point));
        let origin = sum.map(|c| c / n);
        let mut moments = Matrix3::zeros();
        for sample in &self.samples {
            let p = Vector3::from(subtract(&sample.point, &origin));
            moments += p * p.transpose();
        }
        let eigen = moments.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let axis = |k: usize| -> [f64; 3] { eigen.eigenvectors.column(order[k]).into_owned().into() };
        let (x, y) = (unit(&axis(0))?, unit(&axis(1))?);
        let axes = [x, y, unit(&cross(&x, &y))?];
        Some(PrincipalFrame { origin, axes })
    }
}

/// Areas of the welded vertices, in squared model units.
fn welded_areas(decomposer: &Decomposer) -> Vec<f64> {
    let map = decomposer.vertex_map().as_slice();
    let mut areas = vec![0.0; decomposer.n_places()];
    for (&x, area) in map.iter().zip(decomposer.areas()) {
        areas[x as usize] += area;
    }
    areas
}

/// Distance of each welded vertex from the border along edges, in model units; infinite beyond `radius` and without a
/// border.
fn distance_from_border(decomposer: &Decomposer, radius: f64) -> Vec<f64> {
    let (points, neighbors) = (decomposer.positions(), decomposer.neighbors());
    let mut distance = vec![f64::INFINITY; points.len()];
    // Nonnegative numbers have the order of their bits.
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
    for x in border_vertices(decomposer.geometry().map_or(&[], |geometry| geometry.triangles())) {
        distance[x as usize] = 0.0;
        queue.push(Reverse((0, x)));
    }
    while let Some(Reverse((bits, x))) = queue.pop() {
        if f64::from_bits(bits) > distance[x as usize] {
            continue;
        }
        for &y in neighbors.row(x as usize) {
            let length = norm(&subtract(&points[x as usize], &points[y as usize]));
            let through = distance[x as usize] + length;
            if through <= radius && through < distance[y as usize] {
                distance[y as usize] = through;
                queue.push(Reverse((through.to_bits(), y)));
            }
        }
    }
    distance
}

/// Reflects a point or direction at x = 0.
pub(crate) fn mirror(p: &[f64; 3]) -> [f64; 3] {
    [-p[0], p[1], p[2]]
}

/// Interpolates a field of vectors at a point with barycentric weights.
fn interpolate(field: &[[f64; 3]], corners: &[u32; 3], weights: &[f64; 3]) -> [f64; 3] {
    let add = |sum: [f64; 3], (&x, &w): (&u32, &f64)| add_scaled(&sum, w, &field[x as usize]);
    corners.iter().zip(weights).fold([0.0; 3], add)
}

/// Samples the triangles at equal steps of the area.
fn mesh_samples(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<SurfaceSample> {
    let edges = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|x| points[x as usize]);
        (subtract(&b, &a), subtract(&c, &a))
    };
    let normal = |t: &[u32; 3]| {
        let (u, v) = edges(t);
        cross(&u, &v)
    };
    let areas = triangles.iter().map(|t| norm(&normal(t)));
    let places = equal_steps(areas);
    let sample = |(k, t): (usize, usize)| {
        // Two numbers of a sequence that fills the unit square evenly, folded to a triangle.
        let (mut u, mut v) = ((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let (weights, corners) = ([1.0 - u - v, u, v], triangles[t]);
        let point = interpolate(points, &corners, &weights);
        SurfaceSample { point, normal: unit(&normal(&corners)).unwrap_or_default(), corners, weights }
    };
    places.into_iter().enumerate().map(sample).collect()
}

/// Samples the points of a cloud at equal steps of the area.
fn cloud_samples(points: &[[f64; 3]], areas: &[f64]) -> Vec<SurfaceSample> {
    let sample = |x: usize| SurfaceSample {
        point: points[x],
        normal: [0.0; 3],
        corners: [x as u32; 3],
        weights: [1.0, 0.0, 0.0],
    };
    equal_steps(areas.iter().copied()).into_iter().map(sample).collect()
}

/// Indices at which the running sum of `shares` passes [`N_SAMPLES`] equal steps.
fn equal_steps(shares: impl Iterator<Item = f64> + Clone) -> Vec<usize> {
    let total: f64 = shares.clone().sum();
    let mut places = Vec::with_capacity(N_SAMPLES);
    let mut sum = 0.0;
    for (k, share) in shares.enumerate() {
        sum += share;
        while places.len() < N_SAMPLES && sum > total * (places.len() as f64 + 0.5) / N_SAMPLES as f64 {
            places.push(k);
        }
    }
    places
}

/// Motions that take the center and the principal axes of one shape to those of the other, scaled by `scale`.
pub(crate) fn principal_motions(
    from: &RegistrandView<'_>,
    to: &RegistrandView<'_>,
    scale: f64,
) -> Vec<Motion> {
    let (Some(first), Some(second)) = (from.principal_frame(), to.principal_frame()) else {
        return Vec::new();
    };
    let axes = |frame: &PrincipalFrame| PrincipalFrame { origin: [0.0; 3], ..*frame };
    let turn =
        |turn: &[(usize, f64); 3]| Motion::from_frames(&turn_axes(&axes(&first), turn), &axes(&second));
    let motion = |axes| about_centers(&first, &second, turn(axes).scaled_by(scale));
    axis_turns().iter().map(motion).collect()
}

/// Motions that take the center of one shape to that of the other, one for each rotation vector in `turns`.
pub(crate) fn centered_motions(
    from: &RegistrandView<'_>,
    to: &RegistrandView<'_>,
    turns: &[[f64; 3]],
) -> Vec<Motion> {
    let (Some(first), Some(second)) = (from.principal_frame(), to.principal_frame()) else {
        return Vec::new();
    };
    turns.iter().map(|turn| about_centers(&first, &second, Motion::new(*turn, [0.0; 3]))).collect()
}

/// Motion that takes the origin of the first frame to that of the second and rotates by `turn` about it.
fn about_centers(first: &PrincipalFrame, second: &PrincipalFrame, turn: Motion) -> Motion {
    let to_origin = Motion::new([0.0; 3], first.origin.map(|c| -c));
    to_origin.then(&turn).then(&Motion::new([0.0; 3], second.origin))
}

/// Permutes and reverses the axes of a frame.
fn turn_axes(frame: &PrincipalFrame, axes: &[(usize, f64); 3]) -> PrincipalFrame {
    PrincipalFrame { origin: frame.origin, axes: axes.map(|(k, sign)| frame.axes[k].map(|c| sign * c)) }
}

/// The 24 permutations and reversals of the axes that are rotations; each axis is an index and a sign.
fn axis_turns() -> Vec<[(usize, f64); 3]> {
    let mut turns = Vec::new();
    for x in 0..3 {
        for y in (0..3).filter(|&y| y != x) {
            for signs in 0..4 {
                let (sx, sy) = ([1.0, -1.0][signs & 1], [1.0, -1.0][signs >> 1]);
                let parity = if (x + 1) % 3 == y { 1.0 } else { -1.0 };
                turns.push([(x, sx), (y, sy), (3 - x - y, sx * sy * parity)]);
            }
        }
    }
    turns
}
