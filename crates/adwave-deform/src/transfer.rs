//! Detail of one shape carried onto another mesh or cloud of the same surface.

use crate::DeformError;
use crate::coarse_base::{smooth_positions, smooth_rise};
use crate::rotation::turn_change;
use crate::surface_frames::{base_normals, smallest_turn};
use adwave::bands::Schedule;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::shape::{Mesh, PointCloud, PreparedGeometry, Shape, WeldMode};
use adwave::vector::{Vector, add_scaled, dot, norm, subtract, unit};
use adwave::{Decomposer, Progress};
use adwave_register::ClosestPointSearch;
use rayon::prelude::*;

/// Width of the coarse shapes, as a share of the diagonal, if none is given.
const DEFAULT_WIDTH: f64 = 0.02;

/// Distance between the coarse shapes, in widths, beyond which a vertex counts as far.
const FAR: f64 = 1.0;

/// Distance between the coarse shapes, in widths, up to which they are one surface that two meshes smooth a little
/// differently. Detail then stands on the first as it is, since their normals differ by the meshes alone.
const SAME_BASE: f64 = 0.05;

/// Distance between the coarse shapes, in widths, from which detail stands on the second alone.
const OTHER_BASE: f64 = 0.25;

/// Detail carried from one shape onto another.
#[derive(Clone, Debug, PartialEq)]
pub struct Transferred {
    /// New positions of the second shape, in its order.
    pub points: Vec<[f64; 3]>,
    /// Width σ of both coarse shapes in model units.
    pub width: f64,
    /// Largest distance between the coarse shapes in model units, over the vertices that may change.
    pub largest_gap: f64,
    /// Number of vertices whose coarse position is farther than a width from the other coarse shape; they keep their
    /// own detail.
    pub n_far: usize,
}

/// Prepares a shape for a transfer: with the heat operator, whose widths mean the same on every mesh.
///
/// # Errors
/// [`DeformError::Cancelled`] if the call is cancelled.
pub fn transfer_decomposer(shape: &Shape, progress: Progress<'_>) -> Result<Decomposer, DeformError> {
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    Ok(Decomposer::with_params(shape, &params, progress)?)
}

/// Detail of `from` carried onto `onto`, another mesh or cloud of the same surface in the same place: `f′ = S + R d`
/// with the coarse shape S of `onto` and the detail d of `from` at the nearest place of its coarse shape, turned by R
/// between the normals. Both coarse shapes have the same `width` σ in model units, 2 % of the diagonal of `onto` if
/// `None`. A vertex keeps the share 1 − `weights` of its own position. Prepare both by [`transfer_decomposer`].
///
/// # Errors
/// [`DeformError`] if a shape has no positions, the width is no length, weights do not match, or the call is cancelled.
pub fn transfer(
    from: &Decomposer,
    onto: &Decomposer,
    width: Option<f64>,
    weights: Option<&[f64]>,
    progress: Progress<'_>,
) -> Result<Transferred, DeformError> {
    let width = width.unwrap_or(DEFAULT_WIDTH * onto.extent());
    if !(width > 0.0 && width.is_finite()) {
        return Err(DeformError::BadLength { what: "the width of a transfer", value: width });
    }
    let expected = onto.n_vertices();
    if let Some(found) = weights.map(<[f64]>::len).filter(|found| *found != expected) {
        return Err(DeformError::WrongWeights { expected, found });
    }
    let coarse = |d: &Decomposer| -> Result<Vec<Vector>, DeformError> {
        let lengths = Schedule::lengths(&[width], d.operator().step_length());
        let schedule =
            lengths.map_err(|_| DeformError::BadLength { what: "the width of a transfer", value: width })?;
        smooth_positions(d, &schedule, progress)
    };
    let (source, target) = (coarse(from)?, coarse(onto)?);
    let place = CoarsePlaces::new(from, &source, progress)?;
    let (source_normals, target_normals) =
        (base_normals(from, &source, progress)?, base_normals(onto, &target, progress)?);
    let details: Vec<Vector> = from.positions().iter().zip(&source).map(|(p, s)| subtract(p, s)).collect();
    let carried = |x: usize| -> (Vector, f64) {
        if progress.is_cancelled() {
            return ([0.0; 3], 0.0);
        }
        let found = place.nearest(&target[x]);
        let offset = subtract(&target[x], &found.point);
        let gap = norm(&offset);
        let own_share = smooth_rise((gap / width - SAME_BASE) / (OTHER_BASE - SAME_BASE));
        let (mut detail, mut normal) = ([0.0; 3], [0.0; 3]);
        for (&corner, &weight) in found.corners.iter().zip(&found.weights) {
            detail = add_scaled(&detail, weight, &details[corner as usize]);
            normal = add_scaled(&normal, weight, &source_normals[corner as usize]);
        }
        let own = &target_normals[x];
        if let Some(normal) = unit(&normal).filter(|_| norm(own) > 0.0) {
            // The two may be oriented to different sides.
            let same = if dot(&normal, own) < 0.0 { normal.map(|c| -c) } else { normal };
            detail = add_scaled(&detail, own_share, &turn_change(&smallest_turn(&same, own), &detail));
        }
        (add_scaled(&add_scaled(&found.point, own_share, &offset), 1.0, &detail), gap)
    };
    let carried: Vec<(Vector, f64)> = (0..target.len()).into_par_iter().map(carried).collect();
    progress.check()?;
    let map = onto.vertex_map();
    let own = onto.points().unwrap_or_default();
    let (mut largest_gap, mut n_far) = (0.0_f64, 0);
    let mut points = own.to_vec();
    for (v, point) in points.iter_mut().enumerate() {
        let weight = weights.map_or(1.0, |weights| weights[v]);
        if !weight.is_finite() {
            return Err(DeformError::BadLength { what: "a weight", value: weight });
        }
        if weight == 0.0 {
            continue;
        }
        let (p, gap) = &carried[map.welded(v)];
        largest_gap = largest_gap.max(*gap);
        if *gap > FAR * width {
            n_far += 1;
            continue;
        }
        *point = if weight == 1.0 { *p } else { [0, 1, 2].map(|c| point[c] + weight * (p[c] - point[c])) };
    }
    Ok(Transferred { points, width, largest_gap, n_far })
}

/// Nearest places on a coarse shape.
struct CoarsePlaces {
    surface: ClosestPointSearch,
    /// Welded vertex of the shape of each vertex of the search structure.
    number: Vec<u32>,
}

/// Place on a coarse shape: corners are welded vertices of the shape.
struct CoarsePlace {
    point: Vector,
    corners: [u32; 3],
    weights: [f64; 3],
}

impl CoarsePlaces {
    fn new(decomposer: &Decomposer, base: &[Vector], progress: Progress<'_>) -> Result<Self, DeformError> {
        let faces = decomposer.geometry_for("a transfer of detail")?.faces();
        let shape = if faces.is_empty() {
            PointCloud::new(base.to_vec()).map(Shape::Cloud)
        } else {
            Mesh::new(base.to_vec(), faces.clone()).map(Shape::Mesh)
        };
        let shape = shape.map_err(|e| DeformError::Singular(e.to_string()))?;
        let geometry = PreparedGeometry::new(&shape, WeldMode::Off, progress)?;
        let mut number = vec![0; geometry.n_vertices()];
        for (x, &y) in geometry.vertex_map().as_slice().iter().enumerate() {
            number[y as usize] = x as u32;
        }
        let surface = ClosestPointSearch::new(&geometry, progress)?.ok_or(DeformError::NoPositions)?;
        Ok(Self { surface, number })
    }

    fn nearest(&self, p: &Vector) -> CoarsePlace {
        let found = self.surface.closest(p);
        let corners = found.corners.map(|corner| self.number[corner as usize]);
        CoarsePlace { point: found.point, corners, weights: found.weights }
    }
}
