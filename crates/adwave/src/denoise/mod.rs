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
mod double_sides;
mod error;
mod filter_rounds;
mod impulses;
mod magnitudes;
mod mixture;
mod noise_kinds;
mod noise_level;
mod noise_model;
mod params;
mod places;
mod risk;
mod sample;
mod scaling;
mod series;
mod shared_noise;
mod signal;
mod smoothed_normals;
mod surface;

pub use choice::{DenoiseChoice, DenoisedPart};
pub use error::DenoiseError;
pub use noise_model::NoiseModel;
pub use params::{
    CloudDenoising, Creases, CurveDenoising, DenoiseInfo, DenoiseParams, Denoised, MeshDenoising, Outliers,
    SharedNoise, StrongNoise,
};
pub use series::{DenoisedSeries, SeriesNoise, denoise_series};
pub use signal::{DenoisedSignal, SignalNoise, denoise_signal};

use crate::shape::PreparedGeometry;
use crate::vector::{add_scaled, norm, subtract};
use crate::{Cancelled, Progress, parallel};
use double_sides::without_reverse_sides;
use filter_rounds::choose_rounds;
use mixture::{FEW_FOR_KINDS, MixtureParts, MixtureRisk, PlaceMixture};
use noise_kinds::{estimate_noise, prepared_points};
use places::PlaceKinds;
use sample::Sample;
use shared_noise::NoiseLaw;
use smoothed_normals::{GuideScales, SelectedWalks, Walks, mix_normals};
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
/// On a curve, polynomials are fitted along it in windows that end at corners; its end points stay. The noise is that
/// of each coordinate, and estimated along each axis ([`CurveDenoising`]). For surfaces:
///
/// For unit normals `n₀` of the triangles, the result has the normals `Σ_k w_k·F_k(n₀)`. The `F_k` are the identity
/// and 1, 2, 4, … 32 steps of two walks, one that hardly crosses creases and one that hardly notices them. The
/// weights are ≥ 0, sum to 1 and minimize the mean square error by Stein's estimate for Gaussian noise that is
/// independent between points, with the standard deviation estimated from the shape (or given). The points then
/// take 20 steps towards these normals, along them: open borders hardly shrink, and no vertex or face is lost. The
/// same shape gives the same bits. Places where the surface bends little, more and most have weights of their own if
/// these promise a smaller error ([`MeshDenoising::kept_by_place`]), and where the noise differs from place to place
/// ([`MeshDenoising::noise_range`]), the estimate uses that of each place.
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
    if geometry.shape().is_graph() {
        return curve::denoise_curve(geometry, params, progress);
    }
    if let Some(members) = geometry.members(progress)? {
        // Random numbers are drawn in the order of the points, which the others must not change.
        let Denoised { points, outliers, noise, info } = denoise(&members.geometry, params, progress)?;
        let (mut all, mut all_noise) = (original.to_vec(), vec![0.0; original.len()]);
        for (&vertex, (point, noise)) in members.vertices.iter().zip(points.into_iter().zip(noise)) {
            (all[vertex as usize], all_noise[vertex as usize]) = (point, noise);
        }
        let outliers = outliers.into_iter().map(|x| members.vertices[x as usize]).collect();
        return Ok(Denoised { points: all, outliers, noise: all_noise, info });
    }
    if geometry.shape().is_cloud() {
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
    let strength = params.strength.max(1.0);
    let most = surface.most_moved(repaired, law.total() * strength, progress)?;
    let is_stopped = stop_far_moves(&mut moved, repaired, &most);
    info.n_far = is_stopped.into_iter().filter(|is| *is).count();
    let moves = parallel::try_collect(moved.len(), progress, |x| subtract(&moved[x], &points[x]))?;
    let moves = geometry.vertex_map().scatter(&moves, 1);
    info.furthest = moves.iter().map(norm).fold(0.0, f64::max) * unit;
    let points =
        original.iter().zip(&moves).map(|(p, d)| std::array::from_fn(|k| p[k] + d[k] * unit)).collect();
    let noise: Vec<f64> = most.into_iter().map(|most| most / (FAR * strength) * unit).collect();
    progress.step(STAGES, STAGES)?;
    Ok(Denoised { points, outliers: Vec::new(), noise: geometry.vertex_map().scatter(&noise, 1), info })
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
    let search = |k, is_wanted: &[bool]| geometry.nearest_of(&points, k, |x| is_wanted[x], progress);
    let (near, neighbors) = cloud::rows_across_lines(&points, search, progress)?;
    progress.step(1, STAGES)?;
    let given = params.noise.map(|s| s / unit);
    let at_places = match given {
        Some(_) => None,
        None => Some(cloud::noise_at_places(&points, &near, progress)?),
    };
    let (strong, residual_ratio) =
        at_places.as_ref().map_or((None, None), |found| (found.strong, found.residual_ratio));
    let flat_share = at_places.and_then(|found| found.flat_share);
    let noise = cloud::CloudNoise::new(&points, &near, given, strong.as_ref(), progress)?;
    progress.step(2, STAGES)?;
    let mut found = cloud::denoise_points(&points, &near, &noise, noise.typical, params, progress)?;
    found.info = CloudDenoising { neighbors, strong, residual_ratio, flat_share, ..found.info };
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
        noise: noise.overall * unit,
        noise_in_edges: near.in_mean_distances(&points, noise.overall, progress)?,
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
    let noise = map.scatter(&noise.noise_at_points(unit), 1);
    progress.step(STAGES, STAGES)?;
    Ok(Denoised { points, outliers, noise, info })
}

/// The surface of a shape with positions `points`.
fn build_surface(
    geometry: &PreparedGeometry,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<NoisySurface, Cancelled> {
    NoisySurface::mesh(points.len(), without_reverse_sides(geometry.triangles().to_vec()), progress)
}

fn is_anything_to_do(surface: &NoisySurface, law: &NoiseLaw, params: &DenoiseParams) -> bool {
    law.total() * params.strength != 0.0 && surface.n_sites() > 0
}

/// The mixture of least risk of a surface.
struct Mixture {
    /// Points that move to the normals.
    start: Vec<[f64; 3]>,
    /// Normals of the mixture.
    normals: Vec<[f64; 3]>,
    factors: PlaceMixture,
    scales: GuideScales,
}

impl Mixture {
    /// The points moved to the normals of the mixture.
    fn into_points(
        self,
        surface: &NoisySurface,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let Self { normals, start: mut points, .. } = self;
        surface.move_to(&mut points, &normals, MOVES, progress)?;
        Ok(points)
    }
}

/// The parts of a mixture for some positions of a surface, with the walks and points that they come from.
struct PreparedParts {
    start: Vec<[f64; 3]>,
    walks: Walks,
    parts: MixtureParts,
}

/// The parts of a mixture; `kinds` are those of the noisy points for points with more noise.
fn prepare_parts(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    kinds: Option<&PlaceKinds>,
    params: &DenoiseParams,
    info: &DenoiseInfo,
    progress: Progress<'_>,
) -> Result<PreparedParts, DenoiseError> {
    let start = prepared_points(surface, points, info, progress)?;
    let wanted = SelectedWalks::from(params.creases).with_guides(info);
    let walks = Walks::new(surface, &start, wanted, progress)?;
    let normals = walks.candidates(progress)?;
    let shares = match kinds {
        Some(kinds) => kinds.shares(surface, &start, progress)?,
        None => Vec::new(),
    };
    Ok(PreparedParts { start, walks, parts: MixtureParts { normals, shares } })
}

/// The mixture of least risk, estimated on the whole surface or on a `sample`; `None` if the normals are best
/// unchanged.
fn best_mixture(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    sample: Option<&Sample>,
    law: &NoiseLaw,
    params: &DenoiseParams,
    info: &mut DenoiseInfo,
    progress: Progress<'_>,
) -> Result<Option<Mixture>, DenoiseError> {
    let (part, part_points) = sample.map_or((surface, points), |(part, points)| (part, points));
    let n_times = if part.n_sites() <= FEW_SITES { 2 } else { 1 };
    let has_impulses = info.mesh.as_ref().is_some_and(|mesh| mesh.impulse_share > 0.0);
    // What is left of impulses is noise of a few places, which no estimate of the risk by place knows.
    let kinds = if part.n_sites() > FEW_FOR_KINDS && !has_impulses {
        Some(PlaceKinds::new(part, &prepared_points(part, part_points, info, progress)?, progress)?)
    } else {
        None
    };
    let prepare = |points: &[[f64; 3]]| prepare_parts(part, points, kinds.as_ref(), params, info, progress);
    let shaken = |k: u64| Ok(prepare(&law.shaken(part, part_points, SEED + k, progress)?)?.parts);
    // In parallel: each has many short parts that only one thread works on.
    let (as_they_are, shaken) = rayon::join(
        || prepare(part_points),
        || (0..n_times).map(shaken).collect::<Result<Vec<_>, DenoiseError>>(),
    );
    let (PreparedParts { start, walks, parts }, shaken) = (as_they_are?, shaken?);
    progress.step(2, STAGES)?;
    let risk = MixtureRisk::new(&parts, &shaken, &walks.areas, params.strength, progress)?;
    progress.step(3, STAGES)?;
    let chosen = risk.best(part.n_sites());
    info.n_sampled = part.n_sites();
    chosen.describe(params.creases, info);
    if chosen.is_nothing() {
        return Ok(None);
    }
    let factors = chosen.factors(kinds, params.creases);
    if sample.is_none() {
        let normals = chosen.normals(&parts, progress)?;
        return Ok(Some(Mixture { start, normals, factors, scales: walks.scales }));
    }
    drop((walks, parts, shaken));
    let start = prepared_points(surface, points, info, progress)?;
    let used = used_walks(&factors, params.creases, info);
    let (normals, scales) = mix_normals(surface, &start, used, None, &factors, progress)?;
    Ok(Some(Mixture { start, normals, factors, scales }))
}

/// The walks of which a mixture has a part.
fn used_walks(factors: &PlaceMixture, creases: Creases, info: &DenoiseInfo) -> SelectedWalks {
    let wanted = SelectedWalks::from(creases).with_guides(info);
    SelectedWalks {
        creases: factors.uses_creases(),
        smooth: wanted.smooth.filter(|_| factors.uses_smooth()),
        ..wanted
    }
}
