//! Fields that a region may name: those of the file, and what the shape gives itself.

use crate::{ShapeFile, file_normals};
use adwave::bands::Schedule;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::signal::{SurfaceSignal, outward_normals, surface_signal};
use adwave::{Decomposer, Progress};

/// The vertex field of a name, as regions have it: `(n_channels, values)`. The file's own first; then, of the shape as it was
/// opened, with the decomposer's diffusion:
///
/// | name | what |
/// |---|---|
/// | `mean-curvature`, `gaussian-curvature`, `shape-index`, … | a [`SurfaceSignal`] |
/// | `saliency` | signed saliency over as many dyadic levels as the shape has by default |
/// | `band-J` | the length of the wavelet coefficients of the coordinates at dyadic level J |
///
/// None for a name that is none of these, and where the shape has no such thing.
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
        let values = surface_signal(decomposer.geometry(), kind, Progress::none()).ok()?;
        return Some((kind.n_channels(), values));
    } else if name == "saliency" {
        shape_saliency(file, decomposer)?
    } else {
        band_sizes(decomposer, name.strip_prefix("band-")?.parse().ok()?)?
    };
    Some((1, values))
}

fn shape_saliency(file: &ShapeFile, decomposer: &Decomposer) -> Option<Vec<f64>> {
    let points = decomposer.geometry().shape().points()?;
    let schedule = Schedule::dyadic(decomposer.default_levels().0).ok()?;
    let request = decomposer.request(points.as_flattened(), 3, &schedule);
    let normals = file_normals(file);
    let found = outward_normals(decomposer.geometry(), normals.as_deref(), Progress::none()).ok()?;
    let wavelets =
        if found.info.has_outside() { request.along_normals(&found.normals) } else { request.norms() };
    Some(saliency(decomposer, &wavelets.ok()?, &SaliencyParams::default(), Progress::none()).ok()?.map)
}

fn band_sizes(decomposer: &Decomposer, level: usize) -> Option<Vec<f64>> {
    let points = decomposer.geometry().shape().points()?;
    let schedule = Schedule::dyadic(level).ok()?;
    let wavelets = decomposer.request(points.as_flattened(), 3, &schedule).norms().ok()?;
    Some(decomposer.geometry().vertex_map().scatter(wavelets.levels.get(level.checked_sub(1)?)?, 1))
}
