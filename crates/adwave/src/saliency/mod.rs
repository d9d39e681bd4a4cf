//! Saliency: where a signal stands out, over all scales (eq. 17), and to which side.
//!
//! The paper's map is `Λ = Σ_{j > skip} α_j·|W_f(j)|`, a signal of several channels being measured by the Euclidean norm over
//! them. It ties a bump with a dent. The signed map keeps the sign of a scalar signal, and of coordinates that of the part along
//! the outward normal, so that it is positive where the shape is convex and negative where it is concave.

mod drawn;
mod height;
mod params;

pub use drawn::drawn_saliency;
pub use height::with_height;
pub use params::{MapWeighting, SALIENCY_EXTENT, SaliencyParams, Sign, Weighting};

use crate::bands::Wavelets;
use crate::population::Population;
use crate::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress, parallel};
use std::borrow::Cow;
use thiserror::Error;

/// Vertices that a thread treats at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// Why there is no saliency.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SaliencyError {
    /// No level is left.
    #[error(
        "saliency skips the {skip} finest levels and there are {n_levels}; take more levels or skip fewer"
    )]
    NoLevelLeft {
        /// Levels skipped.
        skip: usize,
        /// Levels there are.
        n_levels: usize,
    },
    /// A distance without meaning.
    #[error("the distance from the border is {sigmas}; it must be a finite number of σ of at least 0")]
    Border {
        /// The distance given, in σ.
        sigmas: f64,
    },
    /// The bands are those of another shape.
    #[error("the bands are those of {n_bands} welded vertices, the shape has {n_vertices}")]
    OtherShape {
        /// Welded vertices of the bands.
        n_bands: usize,
        /// Welded vertices of the shape.
        n_vertices: usize,
    },
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for SaliencyError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}

/// One level's share of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct SaliencyLevel {
    /// j.
    pub level: usize,
    /// σ_j in model units.
    pub sigma: f64,
    /// `mean_x|W_f(j,x)|`, in units of the signal; where the border is faded out, the mean weighted by what is left of each.
    pub mean: f64,
    /// `max_x|W_f(j,x)|` of what is left.
    pub max: f64,
    /// α_j; NaN where it is another number at each vertex. With ranks it stands before the rank.
    pub alpha: f64,
}

/// A saliency map in the order of the shape; ≥ 0 where the sign does not count; NaN at masked vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Saliency {
    /// Λ at each vertex.
    pub map: Vec<f64>,
    /// The levels that it sums over.
    pub levels: Vec<SaliencyLevel>,
}

/// The saliency map of a signal on a shape, from its wavelets, their norms ([`BandsRequest::norms`](crate::BandsRequest::norms)), or of
/// coordinates their parts along the outward normals ([`BandsRequest::along`](crate::BandsRequest::along)).
/// O(n × levels × channels).
///
/// With [`Sign::Signed`] `Λ±(x) = Σ_{j > skip} α_j·W(j,x)`, by default without a unit: in means of |W| over each level. With [`Sign::Unsigned`] |W| takes the place of W, which with
/// [`SaliencyParams::paper`] is `Λ(x) = Σ_{j > skip} α_j·|W_f(j,x)|` (eq. 17).
///
/// Means and maxima run over the welded vertices, so that a vertex that the file repeats counts once; where diffusion is that of the
/// surface, means are by area.
///
/// Source: (eq. 17), whose α lost a bar in print: read literally it would give the strongest response the weight 0. The sign, and the
/// weights that go with it, are ours; docs/EVALUATION.md has what they are worth.
///
/// # Errors
/// [`SaliencyError`] when no level is left, a parameter has no meaning, the bands are another shape's, or when cancelled.
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
    let mut map = vec![0.0; decomposer.geometry().n_vertices()];
    parallel::try_for_rows(&mut map, 1, VERTICES_AT_A_TIME, progress, |first, map| {
        for (x, sum) in (first..).zip(map) {
            *sum = parts.iter().map(|part| part.at(x)).sum(); // Λ(x) = Σ_j α_j·|W_f(j,x)| (eq. 17), or with the sign
        }
    })?;
    let map = decomposer.geometry().vertex_map().scatter(&map, 1);
    Ok(Saliency { map, levels: parts.into_iter().map(|part| part.level).collect() })
}

/// What each level adds to the map, `α_j·|W_f(j)|` or `α_j·W_f(j)` for the levels after the skipped ones, in the order of the shape; their
/// sum is [`saliency`]'s map.
///
/// # Errors
/// As for [`saliency`].
pub fn saliency_per_level(
    decomposer: &Decomposer,
    wavelets: &Wavelets,
    params: &SaliencyParams,
    progress: Progress<'_>,
) -> Result<Vec<(SaliencyLevel, Vec<f64>)>, SaliencyError> {
    let n = decomposer.geometry().n_vertices();
    let scatter = |part: Part<'_>| {
        let map = parallel::collect(n, |x| part.at(x));
        (part.level, decomposer.geometry().vertex_map().scatter(&map, 1))
    };
    Ok(parts(decomposer, wavelets, params, progress)?.into_iter().map(scatter).collect())
}

/// A level, and W_f(j) or its norm at the welded vertices.
struct Part<'a> {
    level: SaliencyLevel,
    norms: Cow<'a, [f64]>,
    sign: Sign,
}

impl Part<'_> {
    /// `α_j·|W_f(j,x)|`, or with the sign.
    #[inline]
    fn at(&self, x: usize) -> f64 {
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
) -> Result<Vec<Part<'a>>, SaliencyError> {
    params.check()?;
    let (n_levels, skip) = (wavelets.n_levels(), params.skip);
    let (n_bands, n_vertices) = (wavelets.n_welded(), decomposer.geometry().n_vertices());
    if n_bands != n_vertices {
        return Err(SaliencyError::OtherShape { n_bands, n_vertices });
    }
    if skip >= n_levels {
        return Err(SaliencyError::NoLevelLeft { skip, n_levels });
    }
    let population = Population::new(decomposer);
    let border = match params.border_sigmas {
        Some(sigmas) => Some(Border::new(decomposer, sigmas, wavelets.sigma[n_levels], progress)?),
        None => None,
    };
    let part = |level: usize| {
        progress.step((level - skip - 1) as u64, (n_levels - skip) as u64)?;
        let sigma = wavelets.sigma[level];
        let mut norms = wavelets.norms_of(level);
        let left = border.as_ref().map(|border| border.fade(norms.to_mut(), sigma));
        let share = left.as_ref().map_or(1.0, |left| population.mean(left));
        let mean = if share > 0.0 { population.mean(&norms) / share } else { 0.0 };
        let max = population.max(&norms);
        let alpha = match params.weighting {
            // α_j = (max|W_f(j)| − mean|W_f(j)|)² (eq. 17)
            Weighting::PerLevel => (max - mean).powi(2),
            Weighting::AsPrinted => f64::NAN,
            // A level without any response adds nothing.
            Weighting::Normalized | Weighting::Entropy if mean == 0.0 => 0.0,
            Weighting::Normalized => 1.0 / mean,
            Weighting::Entropy => unevenness(&population, &norms, left.as_deref(), mean) / mean,
            Weighting::Ranks | Weighting::Uniform => 1.0,
        };
        if params.weighting == Weighting::Ranks {
            ranks(norms.to_mut(), left.as_deref(), progress)?;
        }
        Ok(Part { level: SaliencyLevel { level, sigma, mean, max, alpha }, norms, sign: params.sign })
    };
    (skip + 1..=n_levels).map(part).collect()
}

/// `mean(r·ln r)`, r = |value|/mean: by how much the entropy of the values' shares is below that of equal ones, in nats; ≥ 0.
///
/// Source: `shannon1948`.
fn unevenness(population: &Population<'_>, values: &[f64], left: Option<&[f64]>, mean: f64) -> f64 {
    let left = |x: usize| left.map_or(1.0, |left| left[x]);
    let term = |x: usize| {
        let (left, value) = (left(x), values[x].abs());
        let r = if left > 0.0 { value / (left * mean) } else { 0.0 };
        // r·ln r − r + 1 has the same mean, is nowhere negative, and does not cancel near 1.
        left * if r > 0.0 { (r * r.ln() - r + 1.0).max(0.0) } else { 1.0 }
    };
    let n = values.len();
    population.mean_of(n, term) / population.mean_of(n, left)
}

/// How far the welded vertices are from the border.
struct Border {
    distance: Vec<f64>,
    sigmas: f64,
}

impl Border {
    fn new(
        decomposer: &Decomposer,
        sigmas: f64,
        widest: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        Ok(Self { distance: decomposer.distance_from_border(2.0 * sigmas * widest, progress)?, sigmas })
    }

    /// Multiplies a level of width σ by what is left of it, and returns the factors in [0, 1].
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
        parallel::for_rows(norms, 1, VERTICES_AT_A_TIME, |first, norms| {
            for (w, left) in norms.iter_mut().zip(&left[first..]) {
                *w *= left;
            }
        });
        left
    }
}

/// Replaces each value by the share of the others that are smaller in magnitude, equal ones counting half, with the sign of the
/// value; NaN stays, and what is faded out wholly is 0 and nobody's other.
fn ranks(values: &mut [f64], left: Option<&[f64]>, progress: Progress<'_>) -> Result<(), Cancelled> {
    let gone = |x: usize| left.is_some_and(|left| left[x] == 0.0);
    let ranked = |x: &u32| !values[*x as usize].is_nan() && !gone(*x as usize);
    let mut order: Vec<u32> = (0..values.len() as u32).filter(ranked).collect();
    parallel::sort_unstable_by(&mut order, progress, |&a, &b| {
        values[a as usize].abs().total_cmp(&values[b as usize].abs())
    })?;
    // One vertex alone stands out from nobody.
    let others = order.len().saturating_sub(1).max(1) as f64;
    let mut share = vec![f64::NAN; values.len()];
    let mut smaller = 0;
    for equal in order.chunk_by(|&a, &b| values[a as usize].abs() == values[b as usize].abs()) {
        for &x in equal {
            share[x as usize] = (smaller as f64 + 0.5 * (equal.len() - 1) as f64) / others;
        }
        smaller += equal.len();
    }
    // What does not respond at all does not stand out either, however many are like it.
    for (value, share) in values.iter_mut().zip(share) {
        *value = if *value == 0.0 { 0.0 } else { share.copysign(*value) };
    }
    Ok(())
}
