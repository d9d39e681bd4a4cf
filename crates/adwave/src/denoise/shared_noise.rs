//! Noise that neighbors share, as scanners make it: the level that a mesh admits, and random noise of that kind.
//!
//! Such noise looks like detail of the same size, so the mesh alone only bounds it: quadrics are fitted to
//! neighborhoods of several sizes, and the residuals of the quietest tenth are hardly more than noise.

use super::noise_level::{point_normals, quantile};
use super::surface::NoisySurface;
use super::{DenoiseInfo, SEED, SHAKE};
use crate::vector::{Vector, add_scaled, cross, dot, subtract, unit};
use crate::{Cancelled, Progress, parallel};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use std::ops::Range;

/// Numbers of means over a vertex and its neighbors that may turn white noise into shared noise; one of them is chosen.
const STEPS: [usize; 4] = [2, 4, 8, 16];

/// Rings of the neighborhoods to which quadrics are fitted.
const RINGS: [usize; 4] = [2, 3, 4, 6];

/// Number of neighborhoods of each size.
const NEIGHBORHOODS: usize = 1_000;

/// Neighborhoods that a thread takes at a time.
const AT_A_TIME: usize = 32;

/// Quantile of the residuals over neighborhoods of one size: curvature and creases hardly reach it.
const QUIET: f64 = 0.1;

/// Factor by which more steps must explain more of the residuals: curvature looks like noise of many steps.
const MORE: f64 = 1.2;

/// Number of coefficients of a quadric.
const COEFFICIENTS: usize = 6;

/// Part of a monomial, relative to its length, below which it depends on the others.
const LEAST_PART: f64 = 1e-6;

/// Largest factor of the noise of the noisiest places that the noise at a place counts as; the smallest factor is its
/// inverse.
const MOST_VARIATION: f64 = 3.0;

/// Number of lazy steps that smooth a surface for the normals along which noise acts.
const STEPS_BEFORE: usize = 4;

/// Noise along the normals of points: independent between points, and shared by neighbors. Lengths are in the unit of
/// the points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct NoiseLaw {
    /// Standard deviation of the independent noise.
    pub(super) white: f64,
    /// Standard deviation of the shared noise.
    pub(super) shared: f64,
    /// Number of means over a vertex and its neighbors that turn white noise into the shared noise.
    pub(super) steps: usize,
    /// True if the independent noise differs from place to place; `white` is then that of the noisiest places.
    pub(super) varies: bool,
}

impl NoiseLaw {
    /// The assumed noise. The points are in units of `unit` model units.
    pub(super) fn from_info(info: &DenoiseInfo, unit: f64) -> Self {
        let (shared, steps) = info.mesh.as_ref().map_or((0.0, 0), |mesh| (mesh.shared, mesh.shared_steps));
        let varies = info.mesh.as_ref().is_some_and(|mesh| mesh.noise_range[0] < mesh.noise_range[1]);
        Self { white: info.noise / unit, shared: shared / unit, steps, varies }
    }

    /// Standard deviation of the independent and the shared noise together.
    pub(super) fn total(&self) -> f64 {
        self.white.hypot(self.shared)
    }

    /// Points with added noise of [`SHAKE`] times this law; white noise acts along each axis.
    pub(super) fn shaken(
        &self,
        surface: &NoisySurface,
        points: &[Vector],
        seed: u64,
        progress: Progress<'_>,
    ) -> Result<Vec<Vector>, Cancelled> {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut moved = |c: f64| -> f64 {
            let deviate: f64 = StandardNormal.sample(&mut random);
            c + SHAKE * self.white * deviate
        };
        let mut out: Vec<Vector> = points.iter().map(|p| p.map(&mut moved)).collect();
        if self.varies {
            let (levels, _) = surface.noise_by_place(points, progress)?;
            for ((out, p), level) in out.iter_mut().zip(points).zip(levels) {
                let factor = (level / self.white).clamp(MOST_VARIATION.recip(), MOST_VARIATION);
                *out = add_scaled(p, factor, &subtract(out, p));
            }
        }
        if self.shared == 0.0 {
            return Ok(out);
        }
        let normals = smooth_normals(surface, points, progress)?;
        let heights = shared_heights(surface, self.steps, &mut random, progress)?;
        parallel::try_collect(out.len(), progress, |x| {
            add_scaled(&out[x], SHAKE * self.shared * heights[x], &normals[x])
        })
    }
}

impl NoisySurface {
    /// The largest shared noise that the surface admits, for the number of steps that explains most of the residuals;
    /// `white` is the standard deviation of the independent noise. O(points).
    pub(super) fn shared_noise(
        &self,
        points: &[Vector],
        white: f64,
        progress: Progress<'_>,
    ) -> Result<NoiseLaw, Cancelled> {
        let n = points.len();
        let mut random = Pcg64Mcg::seed_from_u64(SEED);
        let mut columns = vec![(0..n).map(|_| StandardNormal.sample(&mut random)).collect::<Vec<f64>>()];
        for steps in STEPS {
            columns.push(shared_heights(self, steps, &mut random, progress)?);
        }
        let normals = smooth_normals(self, points, progress)?;
        let mut law = NoiseLaw { white, shared: 0.0, steps: STEPS[0], varies: false };
        let mut quiet = Vec::with_capacity(RINGS.len());
        for rings in RINGS {
            let every = n.div_ceil(NEIGHBORHOODS).max(1);
            let residuals = |k: usize| {
                let x = k * every + every / 2;
                self.residuals(points, &normals[x], &columns, x, rings)
            };
            let chunk = |(): &mut (), range: Range<usize>| range.filter_map(residuals).collect::<Vec<_>>();
            let known = parallel::try_map_chunks(n / every, AT_A_TIME, progress, || (), chunk)?.concat();
            if known.is_empty() {
                return Ok(law);
            }
            let level = |c: usize| quantile(&mut known.iter().map(|r| r[c]).collect::<Vec<_>>(), QUIET);
            quiet.push((0..=columns.len()).map(level).collect::<Vec<f64>>());
        }
        let mut most_explained = 0.0;
        for (k, &steps) in STEPS.iter().enumerate() {
            let squares: Vec<[f64; 3]> =
                quiet.iter().map(|row| [row[0], row[1], row[2 + k]].map(|level| level * level)).collect();
            let (shared, explained) = largest_share(&squares);
            if explained > MORE * most_explained {
                most_explained = explained;
                law = NoiseLaw { white, shared: shared.sqrt(), steps, varies: false };
            }
        }
        Ok(law)
    }

    /// Root mean square residuals of quadrics over the points within some rings of a vertex, per degree of freedom: of
    /// their heights along `normal`, and of each column. `None` for too few points.
    fn residuals(
        &self,
        points: &[Vector],
        normal: &Vector,
        columns: &[Vec<f64>],
        x: usize,
        rings: usize,
    ) -> Option<Vec<f64>> {
        let mut near = vec![x as u32];
        let mut first_of_ring = 0;
        for _ in 0..rings {
            let ring: Vec<u32> =
                near[first_of_ring..].iter().flat_map(|&y| self.ring.row(y as usize)).copied().collect();
            first_of_ring = near.len();
            for y in ring {
                if !near.contains(&y) {
                    near.push(y);
                }
            }
        }
        let freedom = near.len().checked_sub(COEFFICIENTS + 1)? as f64;
        let least = if normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let first = unit(&cross(normal, &least))?;
        let second = cross(normal, &first);
        let offsets: Vec<Vector> = near.iter().map(|&y| subtract(&points[y as usize], &points[x])).collect();
        let [u, v, heights] =
            [&first, &second, normal].map(|axis| offsets.iter().map(|d| dot(d, axis)).collect::<Vec<f64>>());
        let products = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
        let monomials = [
            vec![1.0; near.len()],
            u.clone(),
            v.clone(),
            products(&u, &u),
            products(&u, &v),
            products(&v, &v),
        ];
        let mut basis: Vec<Vec<f64>> = Vec::with_capacity(COEFFICIENTS);
        for mut monomial in monomials {
            let before = length(&monomial);
            remove(&basis, &mut monomial);
            let after = length(&monomial);
            if after > LEAST_PART * before {
                for c in &mut monomial {
                    *c /= after;
                }
                basis.push(monomial);
            }
        }
        let of_column = |column: &Vec<f64>| near.iter().map(|&y| column[y as usize]).collect::<Vec<f64>>();
        let values = std::iter::once(heights).chain(columns.iter().map(of_column));
        let residual = |mut values: Vec<f64>| {
            remove(&basis, &mut values);
            length(&values) / (freedom + 1.0).sqrt()
        };
        Some(values.map(residual).collect())
    }
}

/// Variance of the shared noise that explains squared residuals best together with white noise, and the share of the
/// residuals that both explain; no residual is smaller than its shared noise. Rows hold the residuals of the surface,
/// of white noise and of shared noise.
fn largest_share(squares: &[[f64; 3]]) -> (f64, f64) {
    // Least squares of `w·white/own + s·shared/own − 1` for variances w, s ≥ 0.
    let known = || squares.iter().filter(|[own, ..]| *own > 0.0);
    let sum = |term: &dyn Fn(f64, f64) -> f64| known().map(|[own, w, s]| term(w / own, s / own)).sum::<f64>();
    let [ww, ws, ss] = [sum(&|w, _| w * w), sum(&|w, s| w * s), sum(&|_, s| s * s)];
    let [w, s] = [sum(&|w, _| w), sum(&|_, s| s)];
    let bend = ww * ss - ws * ws;
    let both = [(w * ss - s * ws) / bend, (s * ww - w * ws) / bend];
    let mut variances = if both.iter().all(|v| *v >= 0.0) {
        both
    } else if s * s * ww > w * w * ss {
        [0.0, s / ss]
    } else {
        [w / ww, 0.0]
    };
    let admitted = known().map(|[own, _, s]| own / s).fold(f64::INFINITY, f64::min);
    variances[1] = variances[1].min(admitted);
    let explained = sum(&|w, s| (variances[0] * w + variances[1] * s).min(1.0));
    if variances.iter().chain([&explained]).all(|v| v.is_finite()) {
        (variances[1], explained)
    } else {
        (0.0, 0.0)
    }
}

/// Removes from `values` their parts along orthonormal vectors.
fn remove(basis: &[Vec<f64>], values: &mut [f64]) {
    for vector in basis {
        let part: f64 = vector.iter().zip(&*values).map(|(a, b)| a * b).sum();
        for (value, b) in values.iter_mut().zip(vector) {
            *value -= part * b;
        }
    }
}

fn length(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// White noise after `steps` means over a vertex and its neighbors, with a mean square of 1.
fn shared_heights(
    surface: &NoisySurface,
    steps: usize,
    random: &mut Pcg64Mcg,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let n = surface.at_vertex.n_rows();
    let mut heights: Vec<f64> = (0..n).map(|_| StandardNormal.sample(random)).collect();
    for _ in 0..steps {
        heights = surface.means(&heights, progress)?;
    }
    let square = heights.iter().map(|h| h * h).sum::<f64>() / n.max(1) as f64;
    let scale = 1.0 / square.sqrt().max(f64::MIN_POSITIVE);
    Ok(heights.into_iter().map(|h| h * scale).collect())
}

/// Normals of the points of the smoothed surface.
fn smooth_normals(
    surface: &NoisySurface,
    points: &[Vector],
    progress: Progress<'_>,
) -> Result<Vec<Vector>, Cancelled> {
    point_normals(surface, &surface.smoothed(points, STEPS_BEFORE, progress)?, progress)
}
