//! Fields and labels carried from one sphere to another.

use super::wall::find_medial_wall;
use super::weights::SphereWeights;
use super::{Sphere, SphereError};
use adwave::{Progress, named_values};
use rayon::prelude::*;

/// Weight of sources with a value from which a target has a value, if no mask says which targets have one.
const HALF: f64 = 0.5 - ROUNDING;
/// Part of a weight that may be rounding: weights of labels that differ by less are equal.
const ROUNDING: f64 = 1e-9;
/// Values that a thread writes between checks for cancellation.
const VALUES_AT_A_TIME: usize = 1 << 14;

/// Quantity that resampling keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// Constants: each target gets a mean, for thickness, curvature, activations.
    #[default]
    Mean,
    /// The sum of the values, for amounts at the vertices: areas, volumes, counts.
    Sum,
    /// The sum of value × area, for densities.
    Integral,
    /// Labels: each target gets the one with the largest weight, of equal ones the smallest.
    Labels,
}

named_values!(Keep, "keep", {
    Mean => "mean", "constants: each vertex gets a mean, for thickness or activation";
    Sum => "sum", "the sum of the values, for amounts at the vertices such as areas and counts";
    Integral => "integral", "the sum of value × area, for densities";
    Labels => "labels", "labels: each vertex gets the one with the largest weight";
});

/// Meaning of exact zeros in a field of which means are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Zeros {
    /// A connected piece of zeros is the medial wall, which has no values.
    #[default]
    Wall,
    /// Zeros are values.
    Values,
}

named_values!(Zeros, "zeros", {
    Wall => "wall", "one connected piece of zeros is the medial wall, which has no values";
    Values => "values", "zeros are values as all others";
});

/// Values at the vertices of the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Resampled {
    /// Values, target vertices × channels. NaN where there is none; 0 if zeros mark the medial wall and the source has
    /// no NaN.
    pub values: Vec<f64>,
    /// Number of target vertices that have no value in any channel.
    pub n_missing: usize,
    /// Number of source vertices that were taken as the medial wall.
    pub n_wall: usize,
}

/// Weights from one sphere to another, prepared for many fields.
///
/// Let F be the barycentric weights of the targets in the triangles of the source, and R those of the sources in the
/// triangles of the target. The row of target t is that of Rᵀ if this has a source that the row of F has not, as where
/// the source is finer, so that all sources count; else it is that of F. With the areas A′ of the targets and A of the
/// sources
///
/// ```text
/// W = diag(A′) row,   C[t, s] = W[t, s] / Σ_t W[t, s],   M[t, s] = C[t, s] A[s] / Σ_s C[t, s] A[s]
/// mean: y = M x       sum: y = C x       integral: y = diag(1/A′) C diag(A) x
/// ```
///
/// A mean keeps constants; columns of C sum to 1, also where a mask of the targets leaves a source out. M is the rule
/// of Connectome Workbench's `ADAP_BARY_AREA`, by its documentation and its results.
#[derive(Clone, Debug)]
pub struct SphereResampler {
    weights: SphereWeights,
    from_areas: Vec<f64>,
    from_triangles: Vec<[u32; 3]>,
    to_areas: Vec<f64>,
    kept: Option<Vec<bool>>,
}

impl SphereResampler {
    /// Computes the weights; if `kept` is given, the targets where it is false get no value, and amounts go to the
    /// others. O(n) for n vertices of both.
    ///
    /// # Errors
    /// [`SphereError`] if the mask has another number of vertices or keeps none, triangles overlap too often, or the
    /// call is cancelled.
    pub fn new(
        from: &Sphere,
        to: &Sphere,
        kept: Option<&[bool]>,
        progress: Progress<'_>,
    ) -> Result<Self, SphereError> {
        if let Some(kept) = kept {
            let (expected, found) = (to.n_vertices(), kept.len());
            if found != expected {
                return Err(SphereError::Length { what: "the target's mask", expected, found });
            }
            if !kept.contains(&true) {
                return Err(SphereError::NothingKept);
            }
        }
        Ok(Self {
            weights: SphereWeights::new(from, to, kept, progress)?,
            from_areas: from.areas.clone(),
            from_triangles: from.triangles.clone(),
            to_areas: to.areas.clone(),
            kept: kept.map(<[bool]>::to_vec),
        })
    }

    /// Number of source vertices and of target vertices.
    pub fn sizes(&self) -> [usize; 2] {
        [self.from_areas.len(), self.to_areas.len()]
    }

    /// Carries `n_channels` values per source vertex to the targets.
    ///
    /// NaN is no value. A mean and a label are of the sources that have one; a target gets none if these have less than
    /// half of its weight, or, if it is kept by a mask, no weight at all. Amounts of all sources that have one arrive.
    /// `zeros` applies to means. The result has the same bits on any number of threads. O(weights × channels).
    ///
    /// # Errors
    /// [`SphereError`] for another number of values, an infinite one, or if the call is cancelled.
    ///
    /// ```
    /// use adwave::Progress;
    /// use adwave_register::{Keep, Sphere, SphereResampler, Zeros};
    /// let far = [-1.0, -1.0, -1.0].map(|c: f64| c / 3_f64.sqrt());
    /// let points = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], far];
    /// let sphere = Sphere::new(&points, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])?;
    /// let resampler = SphereResampler::new(&sphere, &sphere, None, Progress::none())?;
    /// let values = [3.0, 1.0, f64::NAN, 2.0];
    /// let same = resampler.apply(&values, 1, Keep::Mean, Zeros::Wall, Progress::none())?;
    /// assert_eq!((same.values[0], same.values[3], same.n_missing), (3.0, 2.0, 1));
    /// # Ok::<(), adwave_register::SphereError>(())
    /// ```
    pub fn apply(
        &self,
        values: &[f64],
        n_channels: usize,
        keep: Keep,
        zeros: Zeros,
        progress: Progress<'_>,
    ) -> Result<Resampled, SphereError> {
        let expected = self.sizes()[0];
        if n_channels == 0 || values.len() != expected * n_channels {
            let found = values.len() / n_channels.max(1);
            return Err(SphereError::Length { what: "the values", expected, found });
        }
        if let Some(at) = values.par_iter().position_first(|v| v.is_infinite()) {
            return Err(SphereError::Infinite { vertex: at / n_channels, value: values[at] });
        }
        let looks = keep == Keep::Mean && zeros == Zeros::Wall;
        let wall = looks.then(|| find_medial_wall(values, n_channels, &self.from_triangles)).flatten();
        let Some(wall) = wall else {
            return self.carry(values, n_channels, keep, progress);
        };
        let mut known = values.to_vec();
        for (row, _) in known.chunks_exact_mut(n_channels).zip(&wall).filter(|(_, is_wall)| **is_wall) {
            row.fill(f64::NAN);
        }
        let mut found = self.carry(&known, n_channels, keep, progress)?;
        if !values.par_iter().any(|v| v.is_nan()) {
            found.values.par_iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = 0.0);
        }
        found.n_wall = wall.iter().filter(|is_wall| **is_wall).count();
        Ok(found)
    }

    /// Values of all targets, NaN where there is none.
    fn carry(
        &self,
        values: &[f64],
        n_channels: usize,
        keep: Keep,
        progress: Progress<'_>,
    ) -> Result<Resampled, SphereError> {
        let mut found = adwave::pages::zeros(self.sizes()[1] * n_channels);
        let rows_at_a_time = (VALUES_AT_A_TIME / n_channels).max(1);
        let chunk = |(chunk, rows): (usize, &mut [f64])| {
            progress.check()?;
            let mut row = WeightRow::default();
            for (k, target) in rows.chunks_exact_mut(n_channels).enumerate() {
                let t = chunk * rows_at_a_time + k;
                match keep {
                    Keep::Labels => self.write_labels(t, values, target, &mut row.labels),
                    _ => self.write_means(t, values, target, keep, &mut row.weights),
                }
            }
            Ok::<(), SphereError>(())
        };
        found.par_chunks_mut(rows_at_a_time * n_channels).enumerate().try_for_each(chunk)?;
        let n_missing = found.chunks_exact(n_channels).filter(|row| row.iter().all(|v| v.is_nan())).count();
        Ok(Resampled { values: found, n_missing, n_wall: 0 })
    }

    /// Entries of the row of a target.
    fn entries(&self, t: usize) -> std::ops::Range<usize> {
        self.weights.starts[t] as usize..self.weights.starts[t + 1] as usize
    }

    /// Weight of sources with a value above which a target has a value.
    fn least_weight(&self) -> f64 {
        if self.kept.is_some() { ROUNDING } else { HALF }
    }

    fn write_means(&self, t: usize, values: &[f64], target: &mut [f64], keep: Keep, totals: &mut Vec<f64>) {
        let n_channels = target.len();
        totals.clear();
        totals.resize(n_channels, 0.0);
        for k in self.entries(t) {
            let s = self.weights.sources[k] as usize;
            let weight = match keep {
                Keep::Mean | Keep::Labels => self.weights.means[k],
                Keep::Sum => self.weights.shares[k],
                Keep::Integral => self.weights.shares[k] * self.from_areas[s] / self.to_areas[t],
            };
            if weight == 0.0 {
                continue;
            }
            let row = &values[s * n_channels..][..n_channels];
            for ((value, total), v) in target.iter_mut().zip(totals.iter_mut()).zip(row) {
                if !v.is_nan() {
                    *value += weight * v;
                    *total += weight;
                }
            }
        }
        for (value, total) in target.iter_mut().zip(totals.iter()) {
            let is_missing = if keep == Keep::Mean { *total < self.least_weight() } else { *total == 0.0 };
            if is_missing {
                *value = f64::NAN;
            } else if keep == Keep::Mean {
                *value /= total;
            }
        }
    }

    fn write_labels(&self, t: usize, values: &[f64], target: &mut [f64], found: &mut Vec<(f64, f64)>) {
        let n_channels = target.len();
        for (c, value) in target.iter_mut().enumerate() {
            found.clear();
            for k in self.entries(t) {
                let label = values[self.weights.sources[k] as usize * n_channels + c];
                if !label.is_nan() && self.weights.means[k] > 0.0 {
                    found.push((label, self.weights.means[k]));
                }
            }
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            let total: f64 = found.iter().map(|(_, weight)| weight).sum();
            let mut best = (f64::NAN, 0.0);
            for same in found.chunk_by(|a, b| a.0 == b.0) {
                let weight: f64 = same.iter().map(|(_, weight)| weight).sum();
                if weight > best.1 + ROUNDING {
                    best = (same[0].0, weight);
                }
            }
            *value = if total < self.least_weight() { f64::NAN } else { best.0 };
        }
    }
}

/// Memory that the rows of a thread share.
#[derive(Default)]
struct WeightRow {
    weights: Vec<f64>,
    labels: Vec<(f64, f64)>,
}
