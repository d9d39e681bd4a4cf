//! Normals of a surface, smoothed by walks that favor sites with similar normals.

use super::mixture::PlaceMixture;
use super::places::KINDS;
use super::scaling::{scaling_functions, transform};
use super::surface::NoisySurface;
use super::{Creases, DenoiseError};
use crate::bands::{BandsError, FixedSeries, Schedule, Transform};
use crate::operator::{site_diffusion, typical_difference, typical_square};
use crate::parallel;
use crate::vector::unit;
use crate::{Cancelled, Progress};
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
}

/// The sites of a surface with what both walks need.
struct GuidedSites<'a> {
    surface: &'a NoisySurface,
    points: &'a [[f64; 3]],
    normals: Vec<[f64; 3]>,
    areas: Vec<f64>,
    /// The first guide: normals of the surface after [`GUIDE_STEPS`] steps.
    guide: Vec<[f64; 3]>,
    /// Scales of the whole, if the surface is a part of one.
    known: Option<&'a GuideScales>,
    distance: f64,
    first: f64,
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

impl<'a> GuidedSites<'a> {
    fn new(
        surface: &'a NoisySurface,
        points: &'a [[f64; 3]],
        known: Option<&'a GuideScales>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let normals = surface.normals(points, progress)?;
        let areas = surface.areas(points, progress)?;
        let distance = match known {
            Some(scales) => scales.distance,
            None => typical_square(surface.graph(), &surface.positions(points, progress)?),
        };
        let guide = surface.normals(&surface.smoothed(points, GUIDE_STEPS, progress)?, progress)?;
        let first = match known {
            Some(scales) => scales.first,
            None => typical_difference(surface.graph(), &guide, progress)?,
        };
        Ok(Self { surface, points, normals, areas, guide, known, distance, first })
    }

    fn cut(&self) -> PolynomialCut {
        if self.known.is_some() { PolynomialCut::Fixed } else { PolynomialCut::BySignal }
    }

    /// A walk led by `guide`. The weights without a guide are computed anew for each, so that no second array of them
    /// is held.
    fn walk(
        &self,
        guide: &[[f64; 3]],
        reach: f64,
        typical: f64,
        progress: Progress<'_>,
    ) -> Result<Transform, DenoiseError> {
        let positions = self.surface.positions(self.points, progress)?;
        let base = site_diffusion(&self.surface.sites(&positions, &self.areas), self.distance, progress)?;
        drop(positions);
        // The lengths of steps are not needed.
        let led = base.weigh_by_guide_within(guide, reach * reach * typical, |_, _| 0.0, progress)?;
        transform(led, ACCURACY)
    }

    /// The walk that nearly ignores creases, by the first guide.
    fn smooth(&self, reach: f64, progress: Progress<'_>) -> Result<Transform, DenoiseError> {
        self.walk(&self.guide, reach, self.first, progress)
    }

    /// The walk that respects creases, and the medians of its later guides.
    ///
    /// It uses a second guide: the normals of the surface after it has been moved to the normals that 16 steps with the
    /// first guide give. If the noise is strong, a third guide is made from the second in this way.
    fn creases(
        &self,
        n_guides: usize,
        progress: Progress<'_>,
    ) -> Result<(Transform, [f64; MAX_GUIDES]), DenoiseError> {
        let mut later = [0.0; MAX_GUIDES];
        let mut weights = [0.0; GUIDE_LEVELS];
        weights[GUIDE_LEVELS - 1] = 1.0;
        let mut walk = self.walk(&self.guide, CREASE_REACH, self.first, progress)?;
        for (k, scale) in later.iter_mut().enumerate().take(n_guides) {
            let mut smoothed = vec![[0.0; 3]; self.normals.len()];
            add_levels(&walk, self.cut(), &self.normals, &weights, &mut smoothed, progress)?;
            drop(walk);
            normalize(&mut smoothed);
            let mut moved = self.points.to_vec();
            self.surface.move_to(&mut moved, &smoothed, GUIDE_MOVES, progress)?;
            drop(smoothed);
            let guide = self.surface.normals(&moved, progress)?;
            drop(moved);
            *scale = match self.known {
                Some(scales) => scales.later[k],
                None => typical_difference(self.surface.graph(), &guide, progress)?,
            };
            walk = self.walk(&guide, CREASE_REACH, *scale, progress)?;
        }
        Ok((walk, later))
    }
}

impl Walks {
    /// Builds the walks of a surface with positions `points`.
    pub(super) fn new(
        surface: &NoisySurface,
        points: &[[f64; 3]],
        wanted: SelectedWalks,
        progress: Progress<'_>,
    ) -> Result<Self, DenoiseError> {
        let sites = GuidedSites::new(surface, points, None, progress)?;
        let (smooth, creases) = rayon::join(
            || wanted.smooth.map(|reach| sites.smooth(reach, progress)).transpose(),
            || wanted.creases.then(|| sites.creases(wanted.n_guides, progress)).transpose(),
        );
        let (smooth, (creases, later)) = (smooth?, creases?.unzip());
        let GuidedSites { normals, areas, distance, first, .. } = sites;
        let scales = GuideScales { distance, first, later: later.unwrap_or_default() };
        Ok(Self { normals, areas, creases, smooth, scales })
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
}

/// Mixture of the [`candidates`](Walks::candidates) of a surface with factors by kind of place, of unit length or zero
/// at each site, and the scales of the walks `wanted`. Only one walk is held at a time.
///
/// For part of a surface, `known` holds the scales of the whole.
pub(super) fn mix_normals(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    wanted: SelectedWalks,
    known: Option<&GuideScales>,
    mixture: &PlaceMixture,
    progress: Progress<'_>,
) -> Result<(Vec<[f64; 3]>, GuideScales), DenoiseError> {
    let shares = match &mixture.kinds {
        Some(kinds) => kinds.shares(surface, points, progress)?,
        None => Vec::new(),
    };
    let sites = GuidedSites::new(surface, points, known, progress)?;
    let mut out = sites.normals.clone();
    parallel::try_visit_rows(&mut out, 1, SITES_AT_A_TIME, progress, |first, out| {
        for (x, n) in (first..).zip(out) {
            let factor = match shares.get(x) {
                Some(shares) => mixture.factors.iter().zip(shares).map(|(f, share)| f.kept * share).sum(),
                None => mixture.factors[0].kept,
            };
            *n = n.map(|c| factor * c);
        }
    })?;
    let mut add = |walk: &Transform, weights: &[&[f64]]| match weights {
        [weights] => add_levels(walk, sites.cut(), &sites.normals, weights, &mut out, progress),
        _ => add_levels_by_place(walk, &sites.normals, weights, &shares, &mut out, progress),
    };
    let mut scales = GuideScales { distance: sites.distance, first: sites.first, ..GuideScales::default() };
    if wanted.creases {
        let (walk, later) = sites.creases(wanted.n_guides, progress)?;
        scales.later = later;
        add(&walk, &mixture.factors.iter().map(|f| &f.creases[..]).collect::<Vec<_>>())?;
    }
    if let Some(reach) = wanted.smooth {
        let walk = sites.smooth(reach, progress)?;
        add(&walk, &mixture.factors.iter().map(|f| &f.smooth[..]).collect::<Vec<_>>())?;
    }
    normalize(&mut out);
    Ok((out, scales))
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
