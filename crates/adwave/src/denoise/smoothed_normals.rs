//! Normals of a surface, smoothed by walks that favor sites with similar normals.

use super::mixture::PlaceMixture;
use super::places::KINDS;
use super::scaling::{scaling_functions, transform};
use super::surface::NoisySurface;
use super::{Creases, DenoiseError};
use crate::Progress;
use crate::bands::{BandsError, FixedSeries, Schedule, Transform};
use crate::operator::{site_diffusion, typical_square};
use crate::parallel;
use crate::vector::unit;
use serde::{Deserialize, Serialize};

/// Number of levels of the normals: 1, 2, 4, … 32 steps.
pub(super) const LEVELS: usize = 6;

/// Number of levels (16 steps) that smooth normals for the guide of the walk that respects creases.
pub(super) const GUIDE_LEVELS: usize = 5;

/// Number of lazy steps that smooth a surface for its first guide.
pub(super) const GUIDE_STEPS: usize = 2;

/// Number of steps towards the smoothed normals of the surface whose normals are the second guide.
pub(super) const GUIDE_MOVES: usize = 10;

/// Turn of normals between sites at which the walk that respects creases is damped, in square roots of their median
/// squared difference.
const CREASE_REACH: f64 = 2.5;

/// The corresponding turn for the walk that nearly ignores creases.
const SMOOTH_REACH: f64 = 6.0;

/// Largest number of guides of the walk that respects creases.
pub(super) const MAX_GUIDES: usize = 2;

/// Largest relative error of a band of normals, far below the remaining noise.
const ACCURACY: f64 = 1e-4;

/// Number of sites that a thread processes at a time.
const SITES_AT_A_TIME: usize = 1 << 12;

/// Scales of the walks, which depend on the whole surface: medians over neighboring sites.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct GuideScales {
    /// Median of the squared distances, in squared units of the points.
    pub(super) distance: f64,
    /// Median of the squared differences of the first guide.
    pub(super) first: f64,
    /// Medians of the squared differences of the later guides; 0 where a guide is not used.
    pub(super) later: [f64; MAX_GUIDES],
}

/// The noisy normals of a surface and the walks that smooth them.
pub(super) struct Walks {
    /// Noisy unit normals, three numbers per site.
    pub(super) normals: Vec<[f64; 3]>,
    /// Weight of each site.
    pub(super) areas: Vec<f64>,
    /// The walk that respects creases.
    creases: Option<Transform>,
    /// The walk that nearly ignores creases.
    smooth: Option<Transform>,
    /// Scales of the walks.
    pub(super) scales: GuideScales,
    /// Truncation rule of their polynomials.
    cut: PolynomialCut,
}

/// Rule that decides the degree of a polynomial of a walk.
#[derive(Clone, Copy)]
enum PolynomialCut {
    /// All normals decide.
    BySignal,
    /// Steps and accuracy alone decide, so that part of a surface has the bits of the whole.
    Fixed,
}

/// Selection of the walks.
#[derive(Clone, Copy)]
pub(super) struct SelectedWalks {
    pub(super) creases: bool,
    /// Reach of the walk that nearly ignores creases.
    pub(super) smooth: Option<f64>,
    /// Number of guides after the first of the walk that respects creases.
    pub(super) n_guides: usize,
}

impl From<Creases> for SelectedWalks {
    fn from(creases: Creases) -> Self {
        match creases {
            Creases::Auto => Self { creases: true, smooth: Some(SMOOTH_REACH), n_guides: 1 },
            Creases::Keep => Self { creases: true, smooth: None, n_guides: 1 },
            Creases::None => Self { creases: false, smooth: Some(f64::INFINITY), n_guides: 1 },
        }
    }
}

impl Walks {
    /// Builds the walks of a surface with positions `points`.
    ///
    /// The first guide is the normals of the surface after [`GUIDE_STEPS`] steps. The walk that respects creases uses a
    /// second guide: the normals of the surface after it has been moved to the normals that 16 steps with the first
    /// guide give. If the noise is strong, a third guide is made from the second in this way.
    ///
    /// For part of a surface, `known` holds the scales of the whole.
    pub(super) fn new(
        surface: &NoisySurface,
        points: &[[f64; 3]],
        wanted: SelectedWalks,
        known: Option<&GuideScales>,
        progress: Progress<'_>,
    ) -> Result<Self, DenoiseError> {
        let cut = if known.is_some() { PolynomialCut::Fixed } else { PolynomialCut::BySignal };
        let normals = surface.normals(points, progress)?;
        let areas = surface.areas(points, progress)?;
        let positions = surface.positions(points, progress)?;
        let sites = surface.sites(&positions, &areas);
        let distance = known.map_or_else(|| typical_square(surface.graph(), &positions), |s| s.distance);
        let base = site_diffusion(&sites, distance, progress)?;
        let typical = |guide: &[[f64; 3]], known: Option<f64>| {
            known.map_or_else(|| base.typical_difference(guide, progress), Ok)
        };
        let guided = |guide: &[[f64; 3]], reach: f64, typical: f64| {
            // The lengths of steps are not needed.
            let led = base.weigh_by_guide_within(guide, reach * reach * typical, |_, _| 0.0, progress)?;
            transform(led, ACCURACY)
        };
        let guide = surface.normals(&surface.smoothed(points, GUIDE_STEPS, progress)?, progress)?;
        let first = typical(&guide, known.map(|scales| scales.first))?;
        let smooth = || wanted.smooth.map(|reach| guided(&guide, reach, first)).transpose();
        let creases = || {
            let mut later = [0.0; MAX_GUIDES];
            if !wanted.creases {
                return Ok::<_, DenoiseError>((None, later));
            }
            let mut weights = [0.0; GUIDE_LEVELS];
            weights[GUIDE_LEVELS - 1] = 1.0;
            let mut walk = guided(&guide, CREASE_REACH, first)?;
            for (k, scale) in later.iter_mut().enumerate().take(wanted.n_guides) {
                let mut smoothed = vec![[0.0; 3]; normals.len()];
                add_levels(&walk, cut, &normals, &weights, &mut smoothed, progress)?;
                drop(walk);
                normalize(&mut smoothed);
                let mut moved = points.to_vec();
                surface.move_to(&mut moved, &smoothed, GUIDE_MOVES, progress)?;
                let guide = surface.normals(&moved, progress)?;
                *scale = typical(&guide, known.map(|scales| scales.later[k]))?;
                walk = guided(&guide, CREASE_REACH, *scale)?;
            }
            Ok((Some(walk), later))
        };
        let (smooth, creases) = rayon::join(smooth, creases);
        let (smooth, (creases, later)) = (smooth?, creases?);
        let scales = GuideScales { distance, first, later };
        Ok(Self { normals, areas, creases, smooth, scales, cut })
    }

    /// Components of the mixture, three numbers per site each: the normals unchanged, then `S(1) … S(LEVELS)` by
    /// each walk.
    pub(super) fn candidates(&self, progress: Progress<'_>) -> Result<Vec<Vec<f64>>, DenoiseError> {
        let normals = self.normals.as_flattened();
        let mut all = vec![normals.to_vec()];
        for walk in self.creases.iter().chain(&self.smooth) {
            all.extend(scaling_functions(walk, normals, 3, &dyadic(LEVELS), progress)?);
        }
        Ok(all)
    }

    /// Mixture of the [`candidates`](Self::candidates) with factors by kind of place, of unit length or zero at each
    /// site; `points` are those of the walks.
    pub(super) fn mixture(
        &self,
        surface: &NoisySurface,
        points: &[[f64; 3]],
        mixture: &PlaceMixture,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let shares = match &mixture.kinds {
            Some(kinds) => kinds.shares(surface, points, progress)?,
            None => Vec::new(),
        };
        let mut out = self.normals.clone();
        parallel::try_visit_rows(&mut out, 1, SITES_AT_A_TIME, progress, |first, out| {
            for (x, n) in (first..).zip(out) {
                let factor = match shares.get(x) {
                    Some(shares) => mixture.factors.iter().zip(shares).map(|(f, share)| f.kept * share).sum(),
                    None => mixture.factors[0].kept,
                };
                *n = n.map(|c| factor * c);
            }
        })?;
        let of_creases: Vec<&[f64]> = mixture.factors.iter().map(|f| &f.creases[..]).collect();
        let of_smooth: Vec<&[f64]> = mixture.factors.iter().map(|f| &f.smooth[..]).collect();
        for (walk, weights) in [(&self.creases, of_creases), (&self.smooth, of_smooth)] {
            let Some(walk) = walk else { continue };
            if let [weights] = weights[..] {
                add_levels(walk, self.cut, &self.normals, weights, &mut out, progress)?;
            } else {
                add_levels_by_place(walk, &self.normals, &weights, &shares, &mut out, progress)?;
            }
        }
        normalize(&mut out);
        Ok(out)
    }
}

/// The schedule of `n_levels` dyadic levels, a number small enough to be valid.
fn dyadic(n_levels: usize) -> Schedule {
    Schedule::dyadic(n_levels).expect("one to six levels")
}

/// The bands of `n_levels` levels with degrees that depend only on steps and accuracy.
pub(super) fn fixed(n_levels: usize) -> Result<Vec<FixedSeries>, BandsError> {
    FixedSeries::bands(&dyadic(n_levels), ACCURACY)
}

fn normalize(vectors: &mut [[f64; 3]]) {
    for v in vectors {
        *v = unit(v).unwrap_or_default();
    }
}

/// Adds `Σ_j weights[j−1]·S(j)` of the normals to `out` as a polynomial, with `S(j) = f − W(1) − … − W(j)`.
fn add_levels(
    walk: &Transform,
    cut: PolynomialCut,
    normals: &[[f64; 3]],
    weights: &[f64],
    out: &mut [[f64; 3]],
    progress: Progress<'_>,
) -> Result<(), DenoiseError> {
    let Some(last) = weights.iter().rposition(|w| *w > 0.0) else { return Ok(()) };
    let mut factors = weights[..=last].to_vec();
    for j in (0..last).rev() {
        factors[j] += factors[j + 1];
    }
    let mut bands = vec![0.0; 3 * normals.len()];
    let (schedule, data) = (dyadic(last + 1), normals.as_flattened());
    match cut {
        PolynomialCut::BySignal => {
            walk.weighted_into(data, 3, &schedule, &factors, &mut bands, progress.quiet())?;
        }
        PolynomialCut::Fixed => {
            let series = FixedSeries::weighted(&fixed(last + 1)?, &factors);
            walk.apply_fixed_series_into(data, 3, &[series], &mut [&mut bands], progress.quiet())?;
        }
    }
    for ((o, f), w) in out.as_flattened_mut().iter_mut().zip(normals.as_flattened()).zip(&bands) {
        *o += factors[0] * f - w;
    }
    Ok(())
}

/// [`add_levels`] with weights for each kind of place and the shares of the kinds at each site.
fn add_levels_by_place(
    walk: &Transform,
    normals: &[[f64; 3]],
    weights: &[&[f64]],
    shares: &[[f64; KINDS]],
    out: &mut [[f64; 3]],
    progress: Progress<'_>,
) -> Result<(), DenoiseError> {
    let last_used = |weights: &&[f64]| weights.iter().rposition(|w| *w > 0.0);
    let Some(last) = weights.iter().filter_map(last_used).max() else { return Ok(()) };
    let bands = fixed(last + 1)?;
    // The weight of S(j) and of all coarser ones is that of −W(j).
    let sums =
        |weights: &&[f64]| -> Vec<f64> { (0..=last).map(|j| weights[j..=last].iter().sum()).collect() };
    let factors: Vec<Vec<f64>> = weights.iter().map(sums).collect();
    let series: Vec<FixedSeries> = factors.iter().map(|f| FixedSeries::weighted(&bands, f)).collect();
    let data = normals.as_flattened();
    let mut parts = vec![vec![0.0; data.len()]; series.len()];
    let mut outs: Vec<&mut [f64]> = parts.iter_mut().map(Vec::as_mut_slice).collect();
    walk.apply_fixed_series_into(data, 3, &series, &mut outs, progress.quiet())?;
    parallel::try_visit_rows(out, 1, SITES_AT_A_TIME, progress, |first, out| {
        for (x, out) in (first..).zip(out) {
            for ((part, factors), share) in parts.iter().zip(&factors).zip(&shares[x]) {
                for ((o, n), w) in out.iter_mut().zip(&normals[x]).zip(&part[3 * x..]) {
                    *o += share * (factors[0] * n - w);
                }
            }
        }
    })?;
    Ok(())
}
