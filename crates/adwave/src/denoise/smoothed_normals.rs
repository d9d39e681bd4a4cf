//! Normals of a surface, smoothed by walks that keep to sites that point alike.

use super::scaling::{scaling_functions, transform};
use super::surface::Surface;
use super::{Creases, DenoiseError};
use crate::Progress;
use crate::bands::{Schedule, Transform};
use crate::operator::site_diffusion;
use crate::vector::unit;

/// Levels that normals are split into: 1, 2, 4, … 32 steps.
pub(super) const LEVELS: usize = 6;

/// Levels, so that 16 steps, by which normals are smoothed for the guide of the walk that respects creases.
const GUIDE_LEVELS: usize = 5;

/// Lazy steps by which a surface is smoothed for its first guide.
const GUIDE_STEPS: usize = 2;

/// Steps towards the smoothed normals of the surface whose normals are the second guide.
const GUIDE_MOVES: usize = 10;

/// How far normals may turn from one site to the next for the walk that respects creases, in root medians of their squared differences.
const CREASE_REACH: f64 = 2.5;

/// The same for the walk that all but ignores creases.
const SMOOTH_REACH: f64 = 6.0;

/// Largest relative error of a band of normals: far below what is left of the noise.
const ACCURACY: f64 = 1e-4;

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
    pub(super) fn new(
        surface: &Surface,
        points: &[[f64; 3]],
        wanted: Wanted,
        progress: Progress<'_>,
    ) -> Result<Self, DenoiseError> {
        let normals = surface.normals(points, progress)?;
        let areas = surface.areas(points, progress)?;
        let positions = surface.positions(points, progress)?;
        let sites = surface.sites(&positions, &areas);
        let base = site_diffusion(&sites, progress)?;
        let guided = |guide: &[[f64; 3]], reach: f64| {
            // Lengths of steps are not asked for.
            let led = base.guided(guide, reach, |_, _| 0.0, progress)?;
            transform(led, ACCURACY)
        };
        let first = surface.normals(&surface.smoothed(points, GUIDE_STEPS, progress)?, progress)?;
        let smooth = || wanted.smooth.map(|reach| guided(&first, reach)).transpose();
        let creases = || {
            if !wanted.creases {
                return Ok(None);
            }
            let mut weights = [0.0; GUIDE_LEVELS];
            weights[GUIDE_LEVELS - 1] = 1.0;
            let mut guide = vec![[0.0; 3]; normals.len()];
            add_levels(&guided(&first, CREASE_REACH)?, &normals, &weights, &mut guide, progress)?;
            normalise(&mut guide);
            let mut moved = points.to_vec();
            surface.move_to(&mut moved, &guide, GUIDE_MOVES, progress)?;
            guided(&surface.normals(&moved, progress)?, CREASE_REACH).map(Some)
        };
        let (smooth, creases) = rayon::join(smooth, creases);
        let (smooth, creases) = (smooth?, creases?);
        Ok(Self { normals, areas, creases, smooth })
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
            add_levels(walk, &self.normals, weights, &mut out, progress)?;
        }
        normalise(&mut out);
        Ok(out)
    }
}

/// So many dyadic levels, few enough to be.
fn dyadic(n_levels: usize) -> Schedule {
    Schedule::dyadic(n_levels).expect("one to six levels")
}

fn normalise(vectors: &mut [[f64; 3]]) {
    for v in vectors {
        *v = unit(v).unwrap_or_default();
    }
}

/// Adds `Σ_j weights[j−1]·S(j)` of the normals to `out`: as a polynomial, with `S(j) = f − W(1) − … − W(j)`.
fn add_levels(
    walk: &Transform,
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
    let schedule = dyadic(last + 1);
    walk.weighted_into(normals.as_flattened(), 3, &schedule, &factors, &mut bands, progress.quiet())?;
    for ((o, f), w) in out.as_flattened_mut().iter_mut().zip(normals.as_flattened()).zip(&bands) {
        *o += factors[0] * f - w;
    }
    Ok(())
}
