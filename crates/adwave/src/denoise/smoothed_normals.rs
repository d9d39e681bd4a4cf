//! Normals of a surface, smoothed by walks that keep to sites that point alike.

use super::scaling::{scaling_functions, transform};
use super::surface::Surface;
use super::{Creases, DenoiseError};
use crate::Progress;
use crate::bands::{BandsError, FixedSeries, Schedule, Transform};
use crate::operator::{site_diffusion, typical_square};
use crate::vector::unit;
use serde::{Deserialize, Serialize};

/// Levels that normals are split into: 1, 2, 4, … 32 steps.
pub(super) const LEVELS: usize = 6;

/// Levels, so that 16 steps, by which normals are smoothed for the guide of the walk that respects creases.
pub(super) const GUIDE_LEVELS: usize = 5;

/// Lazy steps by which a surface is smoothed for its first guide.
pub(super) const GUIDE_STEPS: usize = 2;

/// Steps toward the smoothed normals of the surface whose normals are the second guide.
pub(super) const GUIDE_MOVES: usize = 10;

/// How far normals may turn from one site to the next for the walk that respects creases, in root medians of their squared differences.
const CREASE_REACH: f64 = 2.5;

/// The same for the walk that all but ignores creases.
const SMOOTH_REACH: f64 = 6.0;

/// Largest relative error of a band of normals: far below what is left of the noise.
const ACCURACY: f64 = 1e-4;

/// What the walks go by that all of a surface decides: medians over neighboring sites.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Scales {
    /// Of the squared distances, in squared units of the points.
    pub(super) distance: f64,
    /// Of the squared differences of the first guide.
    pub(super) first: f64,
    /// The same of the second guide; 0 where the walk that respects creases is not wanted.
    pub(super) second: f64,
}

/// The noisy normals of a surface and the walks that smooth them.
pub(super) struct Walks {
    /// Unit normals as they are, three numbers a site.
    pub(super) normals: Vec<[f64; 3]>,
    /// What each site counts.
    pub(super) areas: Vec<f64>,
    /// The walk that respects creases.
    creases: Option<Transform>,
    /// The walk that all but ignores them.
    smooth: Option<Transform>,
    /// What they go by.
    pub(super) scales: Scales,
    /// How polynomials of them are cut.
    cut: Cut,
}

/// What decides the degree of a polynomial of a walk.
#[derive(Clone, Copy)]
enum Cut {
    /// The normals, all of them.
    BySignal,
    /// Steps and accuracy alone, so that a part of a surface has the bits of the whole.
    Fixed,
}

/// Which of the walks are wanted.
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    pub(super) creases: bool,
    /// The reach of the other walk.
    pub(super) smooth: Option<f64>,
}

impl From<Creases> for Wanted {
    fn from(creases: Creases) -> Self {
        match creases {
            Creases::Auto => Self { creases: true, smooth: Some(SMOOTH_REACH) },
            Creases::Keep => Self { creases: true, smooth: None },
            Creases::None => Self { creases: false, smooth: Some(f64::INFINITY) },
        }
    }
}

impl Walks {
    /// The walks of a surface whose points are at `points`.
    ///
    /// The first guide is the normals of the surface after [`GUIDE_STEPS`] steps; the walk that respects creases takes a second one:
    /// those of the surface that has been moved to the normals which the first guide gives after 16 steps.
    ///
    /// A part of a surface is given the `known` scales of the whole.
    pub(super) fn new(
        surface: &Surface,
        points: &[[f64; 3]],
        wanted: Wanted,
        known: Option<&Scales>,
        progress: Progress<'_>,
    ) -> Result<Self, DenoiseError> {
        let cut = if known.is_some() { Cut::Fixed } else { Cut::BySignal };
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
            // Lengths of steps are not asked for.
            let led = base.guided_within(guide, reach * reach * typical, |_, _| 0.0, progress)?;
            transform(led, ACCURACY)
        };
        let guide = surface.normals(&surface.smoothed(points, GUIDE_STEPS, progress)?, progress)?;
        let first = typical(&guide, known.map(|scales| scales.first))?;
        let smooth = || wanted.smooth.map(|reach| guided(&guide, reach, first)).transpose();
        let creases = || {
            if !wanted.creases {
                return Ok::<_, DenoiseError>((None, 0.0));
            }
            let mut weights = [0.0; GUIDE_LEVELS];
            weights[GUIDE_LEVELS - 1] = 1.0;
            let mut smoothed = vec![[0.0; 3]; normals.len()];
            let walk = guided(&guide, CREASE_REACH, first)?;
            add_levels(&walk, cut, &normals, &weights, &mut smoothed, progress)?;
            drop(walk);
            normalize(&mut smoothed);
            let mut moved = points.to_vec();
            surface.move_to(&mut moved, &smoothed, GUIDE_MOVES, progress)?;
            let guide = surface.normals(&moved, progress)?;
            let second = typical(&guide, known.map(|scales| scales.second))?;
            Ok((Some(guided(&guide, CREASE_REACH, second)?), second))
        };
        let (smooth, creases) = rayon::join(smooth, creases);
        let (smooth, (creases, second)) = (smooth?, creases?);
        Ok(Self { normals, areas, creases, smooth, scales: Scales { distance, first, second }, cut })
    }

    /// All that the normals of the result are mixed from, three numbers each: the normals as they are, then `S(1) … S(LEVELS)` by
    /// each walk.
    pub(super) fn candidates(&self, progress: Progress<'_>) -> Result<Vec<Vec<f64>>, DenoiseError> {
        let normals = self.normals.as_flattened();
        let mut all = vec![normals.to_vec()];
        for walk in self.creases.iter().chain(&self.smooth) {
            all.extend(scaling_functions(walk, normals, 3, &dyadic(LEVELS), progress)?);
        }
        Ok(all)
    }

    /// The mixture of the [`candidates`](Self::candidates) by their weights, each of unit length or zero.
    pub(super) fn mixture(
        &self,
        weights: &[f64],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let mut out: Vec<[f64; 3]> = self.normals.iter().map(|n| n.map(|c| weights[0] * c)).collect();
        for (walk, weights) in self.creases.iter().chain(&self.smooth).zip(weights[1..].chunks(LEVELS)) {
            add_levels(walk, self.cut, &self.normals, weights, &mut out, progress)?;
        }
        normalize(&mut out);
        Ok(out)
    }
}

/// So many dyadic levels, few enough to be.
fn dyadic(n_levels: usize) -> Schedule {
    Schedule::dyadic(n_levels).expect("one to six levels")
}

/// The bands of so many levels with degrees that steps and accuracy decide alone.
pub(super) fn fixed(n_levels: usize) -> Result<Vec<FixedSeries>, BandsError> {
    FixedSeries::bands(&dyadic(n_levels), ACCURACY)
}

fn normalize(vectors: &mut [[f64; 3]]) {
    for v in vectors {
        *v = unit(v).unwrap_or_default();
    }
}

/// Adds `Σ_j weights[j−1]·S(j)` of the normals to `out`: as a polynomial, with `S(j) = f − W(1) − … − W(j)`.
fn add_levels(
    walk: &Transform,
    cut: Cut,
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
        Cut::BySignal => {
            walk.weighted_into(data, 3, &schedule, &factors, &mut bands, progress.quiet())?;
        }
        Cut::Fixed => {
            let series = FixedSeries::weighted(&fixed(last + 1)?, &factors);
            walk.fixed_into(data, 3, &[series], &mut [&mut bands], progress.quiet())?;
        }
    }
    for ((o, f), w) in out.as_flattened_mut().iter_mut().zip(normals.as_flattened()).zip(&bands) {
        *o += factors[0] * f - w;
    }
    Ok(())
}
