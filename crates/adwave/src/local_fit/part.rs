//! Heights of a part of a shape smoothed about a local linear fit, by polynomials that do not depend on the heights, so
//! that the part has the values of the whole.

use super::FitDomain;
use super::gradient::{FIT_REACH, GradientFit};
use super::wavelets::{GRADIENT_ACCURACY, LEAST_WEIGHT, gradient_steps};
use crate::bands::{BandsError, FixedSeries, Schedule, Transform};
use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Polynomials that smooth one coordinate of a part of a shape about a local linear fit over the two others, and add
/// its bands with factors: `Σ_j factors[j−1]·W_f(j)`, `W_f(j) = S_f(j−1) − S_f(j)`, `S_f(j) = Φ_j f + a_j·d_j` (see
/// [`local_fit`](crate::local_fit)).
///
/// The value at a vertex depends on the vertices within [`reach`](Self::reach) rings around it, and on
/// [`sum_of_confidence`](Self::sum_of_confidence) of the whole shape.
#[derive(Clone, Debug)]
pub struct HeightSeries {
    /// Bands up to the last one whose factor is not 0.
    bands: Vec<FixedSeries>,
    factors: Vec<f64>,
    /// Bands of the gradients.
    gradient_bands: Vec<FixedSeries>,
    /// Number of gradient bands that each band takes off.
    n_gradient_bands: Vec<usize>,
}

/// A part of a shape: positions in model units, and its transform.
#[derive(Clone, Copy, Debug)]
pub struct HeightPart<'a> {
    /// Transform of the part.
    pub transform: &'a Transform,
    /// Rows of its operator.
    pub rows: &'a Diffusion,
    /// Positions, in a unit in which squares of lengths neither overflow nor underflow.
    pub points: &'a [[f64; 3]],
    /// Index of the coordinate that is smoothed.
    pub axis: usize,
}

impl HeightSeries {
    /// Number of rings that [`sum_of_confidence`](Self::sum_of_confidence) depends on.
    pub const CONFIDENCE_REACH: usize = FIT_REACH;

    /// The series of the bands of `schedule` with one factor each, for bands with the relative error `accuracy`.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// use adwave::local_fit::HeightSeries;
    /// let series = HeightSeries::new(&Schedule::dyadic(8)?, 1e-6, &[-1.0; 8])?;
    /// assert_eq!(series.reach(), 47);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BandsError`] if the accuracy is out of range or a level has a fractional number of steps.
    ///
    /// # Panics
    /// Unless there is one factor per level.
    pub fn new(schedule: &Schedule, accuracy: f64, factors: &[f64]) -> Result<Self, BandsError> {
        assert_eq!(factors.len(), schedule.n_levels(), "a factor for each level");
        let n = factors.iter().rposition(|factor| *factor != 0.0).map_or(0, |last| last + 1);
        let mut bands = FixedSeries::bands(schedule, accuracy)?;
        bands.truncate(n);
        let of_levels: Vec<f64> = schedule.steps()[..n].iter().map(|steps| gradient_steps(*steps)).collect();
        let mut steps: Vec<f64> = of_levels.iter().copied().filter(|steps| *steps > 0.0).collect();
        steps.dedup();
        let gradient_bands = if steps.is_empty() {
            Vec::new()
        } else {
            let schedule = Schedule::real(steps.clone()).expect("increasing numbers of at least one step");
            FixedSeries::bands(&schedule, accuracy.max(GRADIENT_ACCURACY))?
        };
        let n_gradient_bands = of_levels
            .iter()
            .map(|of_level| steps.iter().filter(|steps| *steps <= of_level).count())
            .collect();
        Ok(Self { bands, factors: factors[..n].to_vec(), gradient_bands, n_gradient_bands })
    }

    /// Number of rings around a vertex that its value depends on.
    pub fn reach(&self) -> usize {
        let reach = |series: &[FixedSeries]| series.iter().map(FixedSeries::reach).max().unwrap_or(0);
        reach(&self.bands).max(FIT_REACH + reach(&self.gradient_bands))
    }

    /// Number of values of a vertex that are in memory at a time.
    pub fn n_values(&self) -> usize {
        3 * (self.bands.len() + self.gradient_bands.len() + 1) + GradientFit::N_VALUES
    }

    /// Sum of the weights of the gradients at the vertices `range`, each in [0, 1]; the mean over a shape decides where
    /// gradients are not smoothed. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn sum_of_confidence(
        part: HeightPart<'_>,
        range: Range<usize>,
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        Ok(part.fit(progress)?.confidence[range].iter().sum())
    }

    /// Change of the coordinate at the vertices `range`, in the unit of the positions. `mean_confidence` is that of the
    /// whole shape, by [`sum_of_confidence`](Self::sum_of_confidence).
    ///
    /// # Errors
    /// [`BandsError`] if a value is not finite, or the call is cancelled.
    ///
    /// # Panics
    /// Unless there is one position per vertex of the transform.
    pub fn change(
        &self,
        part: HeightPart<'_>,
        range: Range<usize>,
        mean_confidence: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, BandsError> {
        let HeightPart { transform, rows, points, axis } = part;
        let n = points.len();
        let axes = FitDomain::Plane { height: axis }.axes();
        let fit = part.fit(progress)?;
        let field = parallel::try_collect(n, progress, |x| points[x][axis])?;
        let gradients = fit.gradients(rows, &field, progress)?;
        // Gradients times their weights, and the weights.
        let first = parallel::try_collect(n, progress, |x| {
            let (weight, a) = (fit.confidence[x], &gradients[x]);
            [weight * a[axes[0]], weight * a[axes[1]], weight]
        })?;
        drop(gradients);
        let gradient_bands = apply(transform, first.as_flattened(), &self.gradient_bands, progress)?;
        let bands = apply(transform, points.as_flattened(), &self.bands, progress)?;
        let least = LEAST_WEIGHT * mean_confidence;
        let start = range.start;
        Ok(parallel::try_collect(range.len(), progress, |i| {
            let x = start + i;
            let (mut change, mut product, mut n_taken) = (0.0, 0.0, 0);
            let (mut drift, mut smoothed) = ([0.0; 3], first[x]);
            for (level, band) in bands.iter().enumerate() {
                while n_taken < self.n_gradient_bands[level] {
                    for (s, w) in smoothed.iter_mut().zip(&gradient_bands[n_taken][3 * x..]) {
                        *s -= w;
                    }
                    n_taken += 1;
                }
                let row = if smoothed[2] > least { &smoothed } else { &first[x] };
                let band = &band[3 * x..][..3];
                for &axis in axes {
                    drift[axis] += band[axis]; // d_j = p − S_p(j)
                }
                let d = fit.tangential(x, drift);
                let next = if row[2] > 0.0 {
                    axes.iter().zip(row).map(|(&axis, a)| a / row[2] * d[axis]).sum::<f64>()
                } else {
                    0.0
                };
                // W_f(j) + a_(j−1)·d_(j−1) − a_j·d_j
                change += self.factors[level] * (band[axis] + product - next);
                product = next;
            }
            change
        })?)
    }
}

impl HeightPart<'_> {
    fn fit(&self, progress: Progress<'_>) -> Result<GradientFit, Cancelled> {
        let domain = FitDomain::Plane { height: self.axis };
        GradientFit::new(self.rows, self.points, domain, true, progress)
    }
}

/// Values of each series of a signal of three channels.
fn apply(
    transform: &Transform,
    signal: &[f64],
    series: &[FixedSeries],
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, BandsError> {
    let mut values: Vec<Vec<f64>> = series.iter().map(|_| zeros(signal.len())).collect();
    if !series.is_empty() {
        let mut outs: Vec<&mut [f64]> = values.iter_mut().map(|values| &mut values[..]).collect();
        transform.apply_fixed_series_into(signal, 3, series, &mut outs, progress)?;
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Decomposer;
    use crate::local_fit::LocalFit;
    use crate::shape::{PointCloud, Shape};

    fn random(i: u32, salt: u32) -> f64 {
        let mixed = (i ^ salt.wrapping_mul(0x9e37_79b9)).wrapping_mul(2_654_435_761).rotate_left(13);
        f64::from(mixed.wrapping_mul(2_246_822_519)) / 4_294_967_296.0
    }

    /// Largest difference of the heights that the series give from those in memory.
    fn largest_difference(height: impl Fn(f64, f64, u32) -> f64) -> f64 {
        let at = |i: u32| [40.0 * random(i, 1), 30.0 * random(i, 2)];
        let points: Vec<[f64; 3]> =
            (0..3000).map(|i| [at(i)[0], at(i)[1], height(at(i)[0], at(i)[1], i)]).collect();
        let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone()).unwrap()));
        let (schedule, factors) = (Schedule::dyadic(5).unwrap(), [-1.0, -0.5, 0.0, -1.0, 0.0]);
        let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
        let request = decomposer.request(&heights, 1, &schedule).accuracy(1e-9).local_fit(LocalFit::Linear);
        let exact = request.weighted(&factors).unwrap().0;
        let series = HeightSeries::new(&schedule, 1e-9, &factors).unwrap();
        let welded = decomposer.positions();
        let rows = decomposer.rows("a part").unwrap();
        let part = HeightPart { transform: decomposer.transform(), rows, points: welded, axis: 2 };
        let (n, none) = (welded.len(), Progress::none());
        let mean = HeightSeries::sum_of_confidence(part, 0..n, none).unwrap() / n as f64;
        let found = series.change(part, 0..n, mean, none).unwrap();
        let found = decomposer.vertex_map().scatter(&found, 1);
        found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn heights_are_those_in_memory_and_a_plane_stays() {
        let bumps = |x: f64, y: f64, i: u32| 0.5 * x + (x / 5.0).sin() * (y / 4.0).cos() + 0.1 * random(i, 3);
        assert!(largest_difference(bumps) < 1e-6);
        assert!(largest_difference(|x, y, _| 0.7 * x - 0.2 * y) < 1e-11);
    }
}
