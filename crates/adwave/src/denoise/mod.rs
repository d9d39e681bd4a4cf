//! Denoising of the positions of a mesh or cloud, and of any signal.
//!
//! Positions are not smoothed directly. Walks that favor neighbors with similar normals smooth the unit normals of
//! the triangles (or of a cloud's points), so creases stay; then the points move to where the surface has those
//! normals. An estimate of the risk from the noisy shape alone decides the amount of smoothing and how strictly
//! creases are respected.
//!
//! Sources: bilateral weights on normals `zheng2011`, points from normals `sun2007`, Stein's risk estimate with
//! probes `ramani2008`, mixtures of estimates `leung2006`.

mod choice;
mod cloud;
mod curve;
mod error;
mod filter_rounds;
mod impulses;
mod noise_kinds;
mod noise_level;
mod noise_model;
mod params;
mod risk;
mod sample;
mod scaling;
mod shared_noise;
mod signal;
mod smoothed_normals;
mod surface;

pub use choice::{DenoiseChoice, DenoisedPart};
pub use error::DenoiseError;
pub use noise_model::NoiseModel;
pub use params::{
    CloudDenoising, Creases, DenoiseInfo, DenoiseParams, Denoised, MeshDenoising, Outliers, SharedNoise,
};
pub use signal::{DenoisedSignal, SignalNoise, denoise_signal};

use crate::shape::{PreparedGeometry, Shape};
use crate::vector::{add_scaled, norm, subtract};
use crate::{Cancelled, Progress, parallel};
use filter_rounds::choose_rounds;
use noise_kinds::{estimate_noise, prepared_points};
use risk::Risk;
use sample::Sample;
use shared_noise::NoiseLaw;
use smoothed_normals::{LEVELS, SelectedWalks, Walks};
use surface::NoisySurface;

/// Number of steps that move points to the smoothed normals.
const MOVES: usize = 20;

/// Standard deviation of the noise added to probe the estimates, relative to the existing noise.
///
/// More would change the guides of the walks; with less, the random part of the estimates dominates.
const SHAKE: f64 = 0.1;

/// Number of sites up to which probing noise is added twice.
const FEW_SITES: usize = 20_000;

/// Seed of the probing noise.
const SEED: u64 = 0x0ada_ade0;

/// Weight below which a part of a mixture is omitted, so that its walk need not run.
const LEAST_SHARE: f64 = 0.02;

/// Distance in standard deviations of the noise beyond which a moved vertex is counted.
const FAR: f64 = 3.0;

/// Number of reported stages.
const STAGES: u64 = 5;

/// Removes noise from the positions of a mesh, cloud or curve. O(n log n) time, O(n) memory.
///
/// On a curve, polynomials are fitted along it in windows that end at corners; its end points stay.
/// [`DenoiseInfo::noise`] is then that of each coordinate. For surfaces:
///
/// For unit normals `n₀` of the triangles, the result has the normals `Σ_k w_k·F_k(n₀)`. The `F_k` are the identity
/// and 1, 2, 4, … 32 steps of two walks, one that hardly crosses creases and one that hardly notices them. The
/// weights are ≥ 0, sum to 1 and minimize the mean square error by Stein's estimate for Gaussian noise that is
/// independent between points, with the standard deviation estimated from the shape (or given). The points then
/// take 20 steps towards these normals, along them: open borders hardly shrink, and no vertex or face is lost. The
/// same shape gives the same bits.
///
/// Two kinds of noise are treated before: vertices that impulses moved return to where the planes around them meet, and
/// noise that is strong or turns triangles over is reduced by some rounds of the linear filter of
/// `taubin1995signal` ([`MeshDenoising`]).
///
/// Noise that neighboring points share cannot be distinguished from detail, and noise beyond one mean edge length
/// hides creases.
///
/// ```
/// use adwave::denoise::{DenoiseParams, denoise};
/// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
/// use adwave::Progress;
/// let rough = |x: u32, y: u32| [f64::from(x), f64::from(y), 0.3 * f64::from((7 * x + 3 * y) % 5) / 5.0];
/// let points = (0..400).map(|i| rough(i % 20, i / 20)).collect();
/// let corners = (0..380_u32).filter(|i| i % 20 < 19);
/// let faces: Vec<_> = corners.flat_map(|i| [[i, i + 1, i + 20], [i + 1, i + 21, i + 20]]).collect();
/// let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&faces))?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
/// let denoised = denoise(&geometry, &DenoiseParams::default(), Progress::none())?;
/// let height = |points: &[[f64; 3]]| points.iter().map(|p| (p[2] - 0.12).powi(2)).sum::<f64>();
/// assert!(height(&denoised.points) < 0.2 * height(shape.points().unwrap_or_default()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DenoiseError`] for a graph without positions, a parameter out of its range, or if the call is cancelled.
pub fn denoise(
    geometry: &PreparedGeometry,
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<Denoised, DenoiseError> {
    params.check()?;
    let Some(original) = geometry.shape().points() else { return Err(DenoiseError::NoPositions) };
    if let Shape::Graph(_) = geometry.shape() {
        return curve::denoise_curve(geometry, params, progress);
    }
    if let Some(members) = geometry.members(progress)? {
        // Random numbers are drawn in the order of the points, which the others must not change.
        let Denoised { points, outliers, info } = denoise(&members.geometry, params, progress)?;
        let mut all = original.to_vec();
        for (&vertex, point) in members.vertices.iter().zip(points) {
            all[vertex as usize] = point;
        }
        let outliers = outliers.into_iter().map(|x| members.vertices[x as usize]).collect();
        return Ok(Denoised { points: all, outliers, info });
    }
    if let Shape::Cloud(_) = geometry.shape() {
        return denoise_cloud(geometry, original, params, progress);
    }
    let (points, unit) = geometry.unit_points(progress)?;
    progress.step(0, STAGES)?;
    let surface = build_surface(geometry, &points, progress)?;
    let (mut info, impulses) = estimate_noise(&surface, &points, unit, params, progress)?;
    let law = NoiseLaw::from_info(&info, unit);
    progress.step(1, STAGES)?;
    let repaired = impulses.as_ref().map_or(&points[..], |found| &found.points[..]);
    let mut moved = repaired.to_vec();
    if is_anything_to_do(&surface, &law, params) {
        choose_rounds(&surface, repaired, &law, params, &mut info, progress)?;
        let sample = surface.sample(repaired, progress)?;
        let mixture = best_mixture(&surface, repaired, sample.as_ref(), &law, params, &mut info, progress)?;
        progress.step(4, STAGES)?;
        moved = match mixture {
            Some(mixture) => mixture.into_points(&surface, progress)?,
            None => prepared_points(&surface, repaired, &info, progress)?,
        };
    }
    let most = surface.most_moved(repaired, law.total() * params.strength.max(1.0), progress)?;
    let is_stopped = stop_far_moves(&mut moved, repaired, &most);
    info.n_far = is_stopped.into_iter().filter(|is| *is).count();
    let moves = parallel::try_collect(moved.len(), progress, |x| subtract(&moved[x], &points[x]))?;
    let moves = geometry.vertex_map().scatter(&moves, 1);
    info.furthest = moves.iter().map(norm).fold(0.0, f64::max) * unit;
    let points =
        original.iter().zip(&moves).map(|(p, d)| std::array::from_fn(|k| p[k] + d[k] * unit)).collect();
    progress.step(STAGES, STAGES)?;
    Ok(Denoised { points, outliers: Vec::new(), info })
}

/// Shortens moves that are longer than `most` at their points. Returns whether each is.
fn stop_far_moves(moved: &mut [[f64; 3]], from: &[[f64; 3]], most: &[f64]) -> Vec<bool> {
    let stop = |((to, from), most): ((&mut [f64; 3], &[f64; 3]), &f64)| {
        let step = subtract(to, from);
        let length = norm(&step);
        let is_far = length > *most;
        if is_far {
            *to = add_scaled(from, most / length, &step);
        }
        is_far
    };
    moved.iter_mut().zip(from).zip(most).map(stop).collect()
}

/// [`denoise`] for a cloud whose points all take part.
fn denoise_cloud(
    geometry: &PreparedGeometry,
    original: &[[f64; 3]],
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<Denoised, DenoiseError> {
    let (points, unit) = geometry.unit_points(progress)?;
    progress.step(0, STAGES)?;
    let near = geometry.nearest(&points, cloud::NEIGHBORS, progress)?;
    let near = cloud::NearestRows::new(&points, &near.adjacency, progress)?;
    progress.step(1, STAGES)?;
    let noise = cloud::CloudNoise::new(&points, &near, params.noise.map(|s| s / unit), progress)?;
    progress.step(2, STAGES)?;
    let found = cloud::denoise_points(&points, &near, &noise, noise.typical, params, progress)?;
    progress.step(4, STAGES)?;
    let moves = parallel::try_collect(points.len(), progress, |x| subtract(&found.points[x], &points[x]))?;
    let map = geometry.vertex_map();
    let moves = map.scatter(&moves, 1);
    let mut is_outlier = vec![false; points.len()];
    for &x in &found.outliers {
        is_outlier[x as usize] = true;
    }
    let n_far = (0..points.len()).filter(|&x| {
        !is_outlier[x] && norm(&subtract(&found.points[x], &points[x])) > FAR * noise.by_point[x]
    });
    let info = DenoiseInfo {
        noise: noise.typical * unit,
        noise_in_edges: near.in_mean_distances(&points, noise.typical, progress)?,
        kept: found.kept,
        n_sampled: points.len(),
        n_far: n_far.count(),
        furthest: moves.iter().map(norm).fold(0.0, f64::max) * unit,
        cloud: Some(found.info.in_units(unit)),
        ..DenoiseInfo::default()
    };
    let points =
        original.iter().zip(&moves).map(|(p, d)| std::array::from_fn(|k| p[k] + d[k] * unit)).collect();
    let outliers = (0..original.len()).filter(|&x| is_outlier[map.welded(x)]).map(|x| x as u32).collect();
    progress.step(STAGES, STAGES)?;
    Ok(Denoised { points, outliers, info })
}

/// The surface of a shape with positions `points`.
fn build_surface(
    geometry: &PreparedGeometry,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<NoisySurface, Cancelled> {
    NoisySurface::mesh(points.len(), geometry.triangles().to_vec(), progress)
}

fn is_anything_to_do(surface: &NoisySurface, law: &NoiseLaw, params: &DenoiseParams) -> bool {
    law.total() * params.strength != 0.0 && surface.n_sites() > 0
}

/// The walks of a surface, the weights of their mixture, and the points from which these move to its normals.
struct Mixture {
    walks: Walks,
    weights: Vec<f64>,
    start: Vec<[f64; 3]>,
}

impl Mixture {
    /// The points moved to the normals of the mixture.
    fn into_points(
        self,
        surface: &NoisySurface,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let Self { walks, weights, start: mut points } = self;
        let normals = walks.mixture(&weights, progress)?;
        drop(walks);
        surface.move_to(&mut points, &normals, MOVES, progress)?;
        Ok(points)
    }
}

/// The mixture of least risk, estimated on the whole surface or on a `sample`; `None` if the normals are best unchanged.
fn best_mixture(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    sample: Option<&Sample>,
    law: &NoiseLaw,
    params: &DenoiseParams,
    info: &mut DenoiseInfo,
    progress: Progress<'_>,
) -> Result<Option<Mixture>, DenoiseError> {
    let wanted = SelectedWalks::from(params.creases).with_guides(info);
    let (part, part_points) = sample.map_or((surface, points), |(part, points)| (part, points));
    let n_times = if part.n_sites() <= FEW_SITES { 2 } else { 1 };
    let shaken = |k: u64| {
        let points = law.shaken(part, part_points, SEED + k, progress)?;
        let points = prepared_points(part, &points, info, progress)?;
        Walks::new(part, &points, wanted, None, progress)?.candidates(progress)
    };
    // In parallel: each has many short parts that only one thread works on.
    let (as_they_are, shaken) = rayon::join(
        || {
            let points = prepared_points(part, part_points, info, progress)?;
            let walks = Walks::new(part, &points, wanted, None, progress)?;
            let candidates = walks.candidates(progress)?;
            Ok::<_, DenoiseError>((walks, candidates, points))
        },
        || (0..n_times).map(shaken).collect::<Result<Vec<_>, DenoiseError>>(),
    );
    let ((walks, candidates, start), shaken) = (as_they_are?, shaken?);
    progress.step(2, STAGES)?;
    let risk = Risk::new(&candidates, &shaken, &walks.areas, SHAKE, params.strength, progress)?;
    progress.step(3, STAGES)?;
    let weights = shares(risk.best_weights());
    info.n_sampled = part.n_sites();
    info.kept = weights[0];
    let by_walk: Vec<Vec<f64>> = weights[1..].chunks(LEVELS).map(<[f64]>::to_vec).collect();
    [info.crease_weights, info.smooth_weights] = match params.creases {
        Creases::Auto => [by_walk[0].clone(), by_walk[1].clone()],
        Creases::Keep => [by_walk[0].clone(), Vec::new()],
        Creases::None => [Vec::new(), by_walk[0].clone()],
    };
    if info.kept >= 1.0 {
        return Ok(None);
    }
    if sample.is_none() {
        return Ok(Some(Mixture { walks, weights, start }));
    }
    let (used, weights) = select_walks(info, params.creases);
    let start = prepared_points(surface, points, info, progress)?;
    let walks = Walks::new(surface, &start, used, None, progress)?;
    Ok(Some(Mixture { walks, weights, start }))
}

/// The walks with positive weight, and the weights of their results.
fn select_walks(info: &DenoiseInfo, creases: Creases) -> (SelectedWalks, Vec<f64>) {
    let is_used = |weights: &[f64]| weights.iter().any(|w| *w > 0.0);
    let (crease, smooth) = (is_used(&info.crease_weights), is_used(&info.smooth_weights));
    let wanted = SelectedWalks::from(creases).with_guides(info);
    let used = SelectedWalks { creases: crease, smooth: wanted.smooth.filter(|_| smooth), ..wanted };
    let in_use = [&info.crease_weights, &info.smooth_weights].into_iter().filter(|w| is_used(w)).flatten();
    (used, std::iter::once(&info.kept).chain(in_use).copied().collect())
}

/// The weights without negligible ones.
fn shares(mut weights: Vec<f64>) -> Vec<f64> {
    for walk in weights[1..].chunks_mut(LEVELS) {
        if walk.iter().sum::<f64>() < LEAST_SHARE {
            walk.fill(0.0);
        }
    }
    let total: f64 = weights.iter().sum();
    for w in &mut weights {
        *w /= total;
    }
    weights
}
