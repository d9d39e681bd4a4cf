//! Saliency: how much a signal stands out over all scales (eq. 17), and to which side.
//!
//! The paper's map is `Λ = Σ_{j > skip} α_j·|W_f(j)|`, with the Euclidean norm over the channels of a signal. It
//! does not distinguish a bump from a dent. The signed map keeps the sign of a scalar signal, or, for coordinates,
//! of the component along the outward normal; it is positive where the shape is convex and negative where it is
//! concave.

mod discretization;
mod drawn;
mod height;
mod params;

pub(crate) use discretization::{VARIANCE, noise_times_area, unit_length};
pub use drawn::saliency_f32;
pub use height::with_height;
pub use params::{MapWeighting, SALIENCY_EXTENT, SaliencyParams, Sign, Weighting};

use crate::bands::Wavelets;
use crate::population::Population;
use crate::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress, parallel};
use discretization::Discretization;
use std::borrow::Cow;
use thiserror::Error;

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// Error of computing saliency.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SaliencyError {
    /// No level is left.
    #[error(
        "saliency skips the {skip} finest levels, but there are only {n_levels}; use more levels or skip fewer"
    )]
    NoLevelLeft {
        /// Number of skipped levels.
        skip: usize,
        /// Number of levels.
        n_levels: usize,
    },
    /// The border distance is negative or not finite.
    #[error("the distance from the border is {sigmas}; it must be a finite number of σ of at least 0")]
    Border {
        /// The distance, in σ.
        sigmas: f64,
    },
    /// The bands belong to another shape.
    #[error("the bands are those of {n_bands} welded vertices, the shape has {n_vertices}")]
    OtherShape {
        /// Number of welded vertices of the bands.
        n_bands: usize,
        /// Number of welded vertices of the shape.
        n_vertices: usize,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for SaliencyError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}

/// Contribution of one level to a map.
#[derive(Clone, Debug, PartialEq)]
pub struct SaliencyLevel {
    /// The level j.
    pub level: usize,
    /// Width σ_j in model units.
    pub sigma: f64,
    /// Mean `mean_x|W_f(j,x)|` in units of the signal; near a faded border, weighted by the fading factor.
    pub mean: f64,
    /// Maximum `max_x|W_f(j,x)|` after fading.
    pub max: f64,
    /// Weight α_j; NaN if it differs between vertices. With ranks it multiplies the rank.
    pub alpha: f64,
}

/// A saliency map in the order of the shape; ≥ 0 without sign; NaN at masked vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Saliency {
    /// Saliency Λ at each vertex.
    pub map: Vec<f64>,
    /// Levels that the map sums over.
    pub levels: Vec<SaliencyLevel>,
}

/// Computes the saliency map of a signal on a shape from its wavelets, from their norms
/// ([`BandsRequest::norms`](crate::BandsRequest::norms)), or, for coordinates, from their components along the outward
/// normals ([`BandsRequest::normal_components`](crate::BandsRequest::normal_components)). O(n × levels × channels).
///
/// With [`Sign::Signed`] it is `Λ±(x) = Σ_{j > skip} α_j·W(j,x)`, dimensionless by default because each level is
/// divided by its mean |W|. With [`Sign::Unsigned`] it uses |W| instead of W; with [`SaliencyParams::paper`] this
/// is `Λ(x) = Σ_{j > skip} α_j·|W_f(j,x)|` (eq. 17).
///
/// Means and maxima run over the welded vertices, so a vertex that the file repeats counts once. For heat on the
/// surface, means are weighted by area.
///
/// Source: (eq. 17). Its printed α lacks a bar: read literally it would give the strongest response weight 0. The
/// sign and its weights are ours; docs/EVALUATION.md evaluates them.
///
/// # Errors
/// [`SaliencyError`] if no level is left, a parameter is out of its range, the bands belong to another shape, or
/// the call is cancelled.
///
/// ```
/// use adwave::saliency::{SaliencyParams, saliency};
/// use adwave::{Decomposer, Progress, bands::Schedule, shape::{Graph, Shape}};
/// let edges: Vec<_> = (1..60).map(|i| (i - 1, i, 1.0)).collect();
/// let path = Decomposer::new(&Shape::Graph(Graph::new(60, &edges)?));
/// let mut signal = [0.0; 60];
/// signal[30] = 1.0;
/// let wavelets = path.request(&signal, 1, &Schedule::dyadic(5)?).norms()?;
/// let map = saliency(&path, &wavelets, &SaliencyParams::default(), Progress::none())?.map;
/// assert_eq!((0..60).max_by(|&a, &b| map[a].total_cmp(&map[b])), Some(30));
/// let upside_down = signal.map(|f| -f);
/// let wavelets = path.request(&upside_down, 1, &Schedule::dyadic(5)?).norms()?;
/// let map = saliency(&path, &wavelets, &SaliencyParams::default(), Progress::none())?.map;
/// assert_eq!((0..60).min_by(|&a, &b| map[a].total_cmp(&map[b])), Some(30));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn saliency(
    decomposer: &Decomposer,
    wavelets: &Wavelets,
    params: &SaliencyParams,
    progress: Progress<'_>,
) -> Result<Saliency, SaliencyError> {
    let parts = parts(decomposer, wavelets, params, progress)?;
    let mut map = vec![0.0; decomposer.n_places()];
    parallel::try_visit_rows(&mut map, 1, VERTICES_AT_A_TIME, progress, |first, map| {
        for (x, sum) in (first..).zip(map) {
            *sum = parts.iter().map(|part| part.value(x)).sum(); // Λ(x) = Σ_j α_j·|W_f(j,x)| (eq. 17), or with the sign
        }
    })?;
    let map = decomposer.vertex_map().scatter(&map, 1);
    Ok(Saliency { map, levels: parts.into_iter().map(|part| part.level).collect() })
}

/// Contribution of each level to the map, `α_j·|W_f(j)|` or `α_j·W_f(j)`, for the levels after the skipped ones, in
/// the order of the shape; their sum is the map of [`saliency`].
///
/// # Errors
/// As for [`saliency`].
pub fn saliency_per_level(
    decomposer: &Decomposer,
    wavelets: &Wavelets,
    params: &SaliencyParams,
    progress: Progress<'_>,
) -> Result<Vec<(SaliencyLevel, Vec<f64>)>, SaliencyError> {
    let n = decomposer.n_places();
    let scatter = |part: LevelPart<'_>| {
        let map = parallel::collect(n, |x| part.value(x));
        (part.level, decomposer.vertex_map().scatter(&map, 1))
    };
    Ok(parts(decomposer, wavelets, params, progress)?.into_iter().map(scatter).collect())
}

/// A level with W_f(j) or its norm at the welded vertices.
struct LevelPart<'a> {
    level: SaliencyLevel,
    norms: Cow<'a, [f64]>,
    sign: Sign,
}

impl LevelPart<'_> {
    /// The contribution `α_j·|W_f(j,x)|`, or its signed form.
    #[inline]
    fn value(&self, x: usize) -> f64 {
        let (w, alpha) = (self.norms[x], self.level.alpha);
        let alpha = if alpha.is_nan() { (self.level.max - w.abs()).powi(2) } else { alpha };
        alpha * if self.sign == Sign::Signed { w } else { w.abs() }
    }
}

fn parts<'a>(
    decomposer: &Decomposer,
    wavelets: &'a Wavelets,
    params: &SaliencyParams,
    progress: Progress<'_>,
) -> Result<Vec<LevelPart<'a>>, SaliencyError> {
    params.check()?;
    let (n_levels, skip) = (wavelets.n_levels(), params.skip);
    let (n_bands, n_vertices) = (wavelets.n_welded(), decomposer.n_places());
    if n_bands != n_vertices {
        return Err(SaliencyError::OtherShape { n_bands, n_vertices });
    }
    if skip >= n_levels {
        return Err(SaliencyError::NoLevelLeft { skip, n_levels });
    }
    let population = Population::new(decomposer);
    let border = match params.border_sigmas {
        Some(sigmas) => Some(BorderDistance::new(decomposer, sigmas, wavelets.sigma[n_levels], progress)?),
        None => None,
    };
    let discretization = if params.weighting == Weighting::Entropy {
        let finest: Vec<Cow<'_, [f64]>> =
            (1..=n_levels.min(2)).map(|level| wavelets.level_norms(level)).collect();
        let finest: Vec<&[f64]> = finest.iter().map(AsRef::as_ref).collect();
        Discretization::new(decomposer, &population, &finest, progress)?
    } else {
        None
    };
    let part = |level: usize| {
        progress.step((level - skip - 1) as u64, (n_levels - skip) as u64)?;
        let sigma = wavelets.sigma[level];
        let mut norms = wavelets.level_norms(level);
        let explained = discretization.as_ref().map(|d| d.level(&population, &norms, sigma));
        let left = border.as_ref().map(|border| border.fade(norms.to_mut(), sigma));
        let share = left.as_ref().map_or(1.0, |left| population.mean(left));
        let mean = if share > 0.0 { population.mean(&norms) / share } else { 0.0 };
        let max = population.max(&norms);
        let alpha = match params.weighting {
            // α_j = (max|W_f(j)| − mean|W_f(j)|)² (eq. 17)
            Weighting::PerLevel => (max - mean).powi(2),
            Weighting::AsPrinted => f64::NAN,
            // A level without any response contributes nothing.
            Weighting::Normalized | Weighting::Entropy if mean == 0.0 => 0.0,
            Weighting::Normalized => 1.0 / mean,
            Weighting::Entropy => {
                let share = explained.as_ref().map_or(1.0, |explained| explained.share);
                share * unevenness(&population, &norms, left.as_deref(), mean) / mean
            }
            Weighting::Ranks | Weighting::Uniform => 1.0,
        };
        if params.weighting == Weighting::Ranks {
            ranks(&population, norms.to_mut(), left.as_deref(), progress)?;
        }
        if let Some(explained) = explained.filter(|explained| explained.share < 1.0) {
            parallel::visit_rows(norms.to_mut(), 1, VERTICES_AT_A_TIME, |first, values| {
                for (x, value) in (first..).zip(values) {
                    *value = explained.standing_out(x, *value, left.as_ref().map_or(1.0, |left| left[x]));
                }
            });
        }
        Ok(LevelPart { level: SaliencyLevel { level, sigma, mean, max, alpha }, norms, sign: params.sign })
    };
    (skip + 1..=n_levels).map(part).collect()
}

/// Mean of `r·ln r` with r = |value|/mean: the difference in nats, ≥ 0, between the entropy of equal shares and
/// that of the values' shares.
///
/// Source: `shannon1948`.
fn unevenness(population: &Population<'_>, values: &[f64], left: Option<&[f64]>, mean: f64) -> f64 {
    let left = |x: usize| left.map_or(1.0, |left| left[x]);
    let term = |x: usize| {
        let (left, value) = (left(x), values[x].abs());
        let r = if left > 0.0 { value / (left * mean) } else { 0.0 };
        // r·ln r − r + 1 has the same mean, is never negative, and does not cancel near 1.
        left * if r > 0.0 { (r * r.ln() - r + 1.0).max(0.0) } else { 1.0 }
    };
    let n = values.len();
    population.mean_over(n, term) / population.mean_over(n, left)
}

/// Distance of the welded vertices from the border.
struct BorderDistance {
    distance: Vec<f64>,
    sigmas: f64,
}

impl BorderDistance {
    fn new(
        decomposer: &Decomposer,
        sigmas: f64,
        widest: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        Ok(Self { distance: decomposer.distance_from_border(2.0 * sigmas * widest, progress)?, sigmas })
    }

    /// Multiplies a level of width σ by the fading factors in [0, 1], and returns them.
    fn fade(&self, norms: &mut [f64], sigma: f64) -> Vec<f64> {
        let none = self.sigmas * sigma;
        let factor = |d: f64| {
            if d <= none {
                return 0.0;
            }
            let t = (d / none - 1.0).min(1.0);
            t * t * (3.0 - 2.0 * t)
        };
        let left = parallel::collect(self.distance.len(), |x| factor(self.distance[x]));
        parallel::visit_rows(norms, 1, VERTICES_AT_A_TIME, |first, norms| {
            for (w, left) in norms.iter_mut().zip(&left[first..]) {
                *w *= left;
            }
        });
        left
    }
}

/// Replaces each value by the share of the others that are smaller in magnitude, equal ones counting half, with the
/// sign of the value. NaN stays; values that are faded out completely become 0 and do not count as others.
fn ranks(
    population: &Population<'_>,
    values: &mut [f64],
    left: Option<&[f64]>,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let gone = |x: usize| population.is_masked(x) || left.is_some_and(|left| left[x] == 0.0);
    let ranked = |x: &u32| !values[*x as usize].is_nan() && !gone(*x as usize);
    let mut order: Vec<u32> = (0..values.len() as u32).filter(ranked).collect();
    parallel::sort_unstable_by(&mut order, progress, |&a, &b| {
        values[a as usize].abs().total_cmp(&values[b as usize].abs())
    })?;
    // A single vertex does not stand out from any other.
    let others = order.len().saturating_sub(1).max(1) as f64;
    let mut share = vec![f64::NAN; values.len()];
    let mut smaller = 0;
    for equal in order.chunk_by(|&a, &b| values[a as usize].abs() == values[b as usize].abs()) {
        for &x in equal {
            share[x as usize] = (smaller as f64 + 0.5 * (equal.len() - 1) as f64) / others;
        }
        smaller += equal.len();
    }
    // A value of 0 does not stand out, however many equal it.
    for (value, share) in values.iter_mut().zip(share) {
        *value = if *value == 0.0 { 0.0 } else { share.copysign(*value) };
    }
    Ok(())
}
