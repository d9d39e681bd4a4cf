//! Fields that a region may refer to: those of the file, and those computed from the shape.

use crate::{ShapeFile, file_normals};
use adwave::bands::Schedule;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::signal::{SurfaceSignal, surface_signal};
use adwave::{Decomposer, Progress};

/// Finds the vertex field of a name for a region: `(n_channels, values)`. Fields of the file come first, then those
/// computed from the shape as it was opened, with the decomposer's diffusion:
///
/// | name | field |
/// |---|---|
/// | `mean-curvature`, `gaussian-curvature`, `shape-index`, … | a [`SurfaceSignal`] |
/// | `saliency` | signed saliency over the default dyadic levels of the shape |
/// | `band-J` | the norm of the wavelet coefficients of the coordinates at dyadic level J |
///
/// Returns `None` for any other name, and if the shape does not have that field.
///
/// ```
/// use adwave::{Decomposer, shape::{PointCloud, Shape}};
/// use adwave_io::{ShapeFile, region_field};
/// let points: Vec<[f64; 3]> = (0..50).map(|k| [f64::from(k % 7), f64::from(k / 7), 0.0]).collect();
/// let file = ShapeFile::from_cloud(points.clone());
/// let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points)?));
/// let (n_channels, sizes) = region_field(&file, &decomposer, "band-1").unwrap();
/// assert_eq!((n_channels, sizes.len()), (1, 50));
/// assert!(region_field(&file, &decomposer, "band-0").is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn region_field(file: &ShapeFile, decomposer: &Decomposer, name: &str) -> Option<(usize, Vec<f64>)> {
    if let Some(field) = file.field(name) {
        return Some((field.n_channels, field.to_f64()));
    }
    let values = if let Some(kind) = SurfaceSignal::from_name(name) {
        let values = surface_signal(decomposer.geometry()?, kind, Progress::none()).ok()?;
        return Some((kind.n_channels(), values));
    } else if name == "saliency" {
        shape_saliency(file, decomposer)?
    } else {
        band_sizes(decomposer, name.strip_prefix("band-")?.parse().ok()?)?
    };
    Some((1, values))
}

fn shape_saliency(file: &ShapeFile, decomposer: &Decomposer) -> Option<Vec<f64>> {
    let points = decomposer.points()?;
    let schedule = Schedule::dyadic(decomposer.default_levels().0).ok()?;
    let request = decomposer.request(points.as_flattened(), 3, &schedule);
    let normals = file_normals(file);
    let found = decomposer.outward_normals(normals.as_deref(), Progress::none()).ok()?;
    let wavelets =
        if found.info.has_outside() { request.normal_components(&found.normals) } else { request.norms() };
    Some(saliency(decomposer, &wavelets.ok()?, &SaliencyParams::default(), Progress::none()).ok()?.map)
}

fn band_sizes(decomposer: &Decomposer, level: usize) -> Option<Vec<f64>> {
    let points = decomposer.points()?;
    let schedule = Schedule::dyadic(level).ok()?;
    let wavelets = decomposer.request(points.as_flattened(), 3, &schedule).norms().ok()?;
    Some(decomposer.vertex_map().scatter(wavelets.levels.get(level.checked_sub(1)?)?, 1))
}
