//! Denoising of the coordinates by filtered face normals, with the default parameters of each method.

use super::shared::{row, smoothing};
use super::{CompareError, Comparison, ComparisonInput, Method};
use crate::normal_filter::{BilateralParams, GuidedParams, bilateral_normals, guided_normals};
use adwave::Progress;
use adwave::bands::Bands;
use adwave::shape::{PreparedGeometry, enclosed_volume, face_normals};
use std::time::Instant;

/// Number of finest levels that adwave removes: enough for noise of a fraction of an edge; larger details remain.
pub(super) const LEVELS: usize = 4;

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
    method: Method,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    if input.shape.points().is_none_or(|points| points.as_flattened() != input.signal) {
        return Err(CompareError::NotCoordinates);
    }
    let geometry = input.decomposer.geometry_for("a normal filter")?;
    let start = Instant::now();
    let theirs = match method {
        Method::Guided => guided_normals(geometry, &GuidedParams::default(), progress)?,
        _ => bilateral_normals(geometry, &BilateralParams::default(), progress)?,
    };
    let filtered = start.elapsed().as_secs_f64();
    let level = LEVELS.min(bands.n_levels());
    let ours = bands.scaling(level);
    let theirs = theirs.into_flattened();
    let [before, after, other] =
        [input.signal, &ours, &theirs].map(|positions| FilteredSurface::new(geometry, positions));
    let change = |surface: &FilteredSurface| {
        (before.volume != 0.0).then(|| 100.0 * (surface.volume / before.volume - 1.0))
    };
    let rows = vec![
        row("denoise, s", seconds, filtered),
        row("change of the volume, %", change(&after), change(&other)),
        row(
            "mean rotation of the normals, degrees",
            after.mean_rotation(&before),
            other.mean_rotation(&before),
        ),
        row(
            "faces rotated by more than 90°",
            after.count_flipped_faces(&before),
            other.count_flipped_faces(&before),
        ),
    ];
    let task = format!("denoise the shape; adwave removes the first {level} levels");
    Ok(smoothing(input, task, &ours, theirs, rows))
}

/// Volume and face normals of the shape at some vertex positions.
struct FilteredSurface {
    normals: Vec<[f64; 3]>,
    volume: f64,
}

impl FilteredSurface {
    /// Measures the surface for `positions`, three coordinates per vertex of the shape.
    fn new(geometry: &PreparedGeometry, positions: &[f64]) -> Self {
        let points = geometry.vertex_map().positions(positions.as_chunks().0);
        let triangles = geometry.triangles();
        Self { normals: face_normals(&points, triangles), volume: enclosed_volume(&points, triangles) }
    }

    /// Cosines of the angles to the normals of `other`, for the faces that have a normal on both surfaces.
    fn cosines<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = f64> + 'a {
        let pairs = self.normals.iter().zip(&other.normals);
        let pairs = pairs.filter(|(a, b)| **a != [0.0; 3] && **b != [0.0; 3]);
        pairs.map(|(a, b)| adwave::vector::dot(a, b).clamp(-1.0, 1.0))
    }

    fn mean_rotation(&self, other: &Self) -> f64 {
        let (sum, count) =
            self.cosines(other).fold((0.0, 0.0), |(s, n), c| (s + c.acos().to_degrees(), n + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    fn count_flipped_faces(&self, other: &Self) -> f64 {
        self.cosines(other).filter(|&c| c < 0.0).count() as f64
    }
}
