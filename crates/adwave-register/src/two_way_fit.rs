//! Fit of two shapes under a motion, measured in both directions.

use crate::registrand::{RegistrandView, SurfaceSample};
use crate::{ClosestPoint, Motion};
use adwave::vector::{dot, norm, subtract};
use rayon::prelude::*;

/// Distance that counts as zero, in mean spacings.
const PRECISION: f64 = 0.1;
/// Largest precision, as a share of the extent: machined parts have vertices that are far apart.
const MAX_PRECISION: f64 = 0.001;
/// Distance at which a place is evidence against a motion, as a share of the extent.
const MISFIT: f64 = 0.01;
/// Cosine between normals below which two places are on different sheets.
const FACING: f64 = 0.3;
/// Distance from borders, in σ, beyond which places contribute to correlations of bands.
const BORDER_SIGMAS: f64 = 1.0;
/// Least standard deviation of a band, in mean spacings; finer relief, such as that of a ball, is that of the
/// triangles.
const LEAST_RELIEF: f64 = 0.01;
/// Area over which a band varies, in σ².
const PATCH: f64 = 2.0 * std::f64::consts::PI;
/// Smallest number of patches from which a correlation is computed.
const MIN_PATCHES: f64 = 8.0;

/// Fit of two shapes under a motion, over samples of both that have a partner off the borders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoWayFit {
    /// Mean of `ln(1 + d²/ε²)` over the distances d, with the precision ε; 0 if all distances are 0.
    pub cost: f64,
    /// Median distance, in units of the second shape.
    pub median: f64,
    /// Share of the samples with a partner, in [0, 1]: the larger of the shares of both shapes.
    pub overlap: f64,
    /// Share of the samples with a partner whose distance is evidence against the motion, in [0, 1].
    pub conflict: f64,
    /// Distance that 99.5 % of the samples with a partner do not exceed, in units of the second shape.
    pub tail: f64,
    /// True if the first shape fits with its other side outside, which is possible only where an outside was guessed.
    pub is_flipped: bool,
    /// Lower bound of the correlation of the bands at partners, on the level where the bound is highest.
    pub agreement: f64,
    /// Mutual information of the bands at partners, in nats.
    pub information: f64,
}

impl Default for TwoWayFit {
    fn default() -> Self {
        Self {
            cost: f64::INFINITY,
            median: f64::NAN,
            overlap: 0.0,
            conflict: 1.0,
            tail: f64::NAN,
            is_flipped: false,
            agreement: 0.0,
            information: 0.0,
        }
    }
}

/// A sample and its partner, the closest point of the other shape.
struct Partner<'a> {
    sample: &'a SurfaceSample,
    closest: ClosestPoint,
    /// Cosine between the normals.
    cosine: f64,
    /// Distance in units of the second shape.
    distance: f64,
    /// True if the sample belongs to the first shape.
    is_forward: bool,
}

/// Measures the fit at every `step`-th sample of both shapes. O(samples × (log n + levels)).
pub(crate) fn two_way_fit(
    first: &RegistrandView<'_>,
    second: &RegistrandView<'_>,
    motion: &Motion,
    step: usize,
) -> TwoWayFit {
    let back = motion.inverse();
    let is_signed = first.shape.features.is_signed && second.shape.features.is_signed;
    let is_guessed = first.shape.features.is_guessed || second.shape.features.is_guessed;
    let mut partners = Vec::new();
    let mut n_samples = [0, 0];
    for (from, to, motion, unit) in [(first, second, motion, 1.0), (second, first, &back, motion.scale())] {
        let samples: Vec<&SurfaceSample> = from.samples.iter().step_by(step).collect();
        let is_forward = std::ptr::eq(from, first);
        n_samples[usize::from(is_forward)] = samples.len();
        let partner = |sample: &&'_ SurfaceSample| {
            let moved = motion.apply(&sample.point);
            let closest = to.closest(&moved);
            let cosine = dot(&motion.turn(&sample.normal), &closest.normal);
            let distance = unit * norm(&subtract(&moved, &closest.point));
            (!closest.is_border).then_some((closest, cosine, distance))
        };
        let found: Vec<Option<(ClosestPoint, f64, f64)>> = samples.par_iter().map(partner).collect();
        partners.extend(samples.iter().zip(found).filter_map(|(sample, found)| {
            found.map(|(closest, cosine, distance)| Partner { sample, closest, cosine, distance, is_forward })
        }));
    }
    let is_flipped = is_signed && is_guessed && partners.iter().map(|p| p.cosine.signum()).sum::<f64>() < 0.0;
    partners.retain(|p| match (is_signed, is_flipped) {
        (true, false) => p.cosine >= FACING,
        (true, true) => p.cosine <= -FACING,
        (false, _) => p.cosine.abs() >= FACING,
    });
    let share = |is_forward: bool| {
        let n = partners.iter().filter(|p| p.is_forward == is_forward).count();
        n as f64 / n_samples[usize::from(is_forward)].max(1) as f64
    };
    let overlap = share(true).max(share(false));
    if partners.len() < 10 {
        return TwoWayFit::default();
    }
    let extent = (motion.scale() * first.shape.extent).min(second.shape.extent);
    let precision = precision(first, second, motion);
    let mut distances: Vec<f64> = partners.iter().map(|partner| partner.distance).collect();
    let n = distances.len();
    let cost = distances.iter().map(|d| (d / precision).powi(2).ln_1p()).sum::<f64>() / n as f64;
    let misfit = (MISFIT * extent).max(5.0 * precision);
    let conflict = distances.iter().filter(|d| **d > misfit).count() as f64 / n as f64;
    let tail = *distances.select_nth_unstable_by((0.995 * n as f64) as usize, f64::total_cmp).1;
    let median = *distances.select_nth_unstable_by(n / 2, f64::total_cmp).1;
    let n_samples = n_samples[0] + n_samples[1];
    let area = (motion.scale().powi(2) * first.shape.area + second.shape.area) / n_samples.max(1) as f64;
    let sign = if is_flipped { -1.0 } else { 1.0 };
    let units = BandUnits { scale: motion.scale(), area, sign };
    let (agreement, information) = band_agreement([first, second], &partners, &units);
    TwoWayFit { cost, median, overlap, conflict, tail, is_flipped, agreement, information }
}

/// Distances of samples of both shapes under an unrefined motion.
pub(crate) struct RoughFit {
    /// Distances of the samples with a partner, ascending, in units of the smaller extent.
    distances: Vec<f64>,
    /// Share of the samples with a partner: the larger of the shares of both shapes.
    overlap: f64,
}

impl RoughFit {
    /// Measures the distance of every `step`-th sample of both shapes.
    pub(crate) fn new(
        first: &RegistrandView<'_>,
        second: &RegistrandView<'_>,
        motion: &Motion,
        step: usize,
    ) -> Self {
        let back = motion.inverse();
        let extent = (motion.scale() * first.shape.extent).min(second.shape.extent);
        let (mut distances, mut overlap) = (Vec::new(), 0.0_f64);
        for (from, to, motion, unit) in [(first, second, motion, 1.0), (second, first, &back, motion.scale())]
        {
            let distance = |sample: &SurfaceSample| {
                let moved = motion.apply(&sample.point);
                let closest = to.closest(&moved);
                let cosine = dot(&motion.turn(&sample.normal), &closest.normal).abs();
                let distance = unit * norm(&subtract(&moved, &closest.point)) / extent;
                (!closest.is_border && cosine >= FACING).then_some(distance)
            };
            let before = distances.len();
            distances.extend(from.samples.iter().step_by(step).filter_map(distance));
            let n_samples = from.samples.len().div_ceil(step).max(1);
            overlap = overlap.max((distances.len() - before) as f64 / n_samples as f64);
        }
        distances.sort_by(f64::total_cmp);
        Self { distances, overlap }
    }

    /// Median distance; infinite without a partner.
    pub(crate) fn median(&self) -> f64 {
        self.distances.get(self.distances.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    /// Evidence for the motion, relative to the distance `typical` of wrong ones: the mean of
    /// `−ln((d/typical)² + 0.01)`, each term at least −1, times the root of the overlap in excess of 3 %.
    pub(crate) fn gain(&self, typical: f64) -> f64 {
        let gain = |d: &f64| (-((d / typical).powi(2) + 0.01).ln()).max(-1.0);
        let mean = self.distances.iter().map(gain).sum::<f64>() / self.distances.len().max(1) as f64;
        // Few partners are no evidence.
        mean * (self.overlap - 0.03).max(0.0).sqrt()
    }
}

/// Distance that counts as zero, in units of the second shape.
pub(crate) fn precision(first: &RegistrandView<'_>, second: &RegistrandView<'_>, motion: &Motion) -> f64 {
    let spacing = (motion.scale() * first.shape.spacing).max(second.shape.spacing);
    let extent = (motion.scale() * first.shape.extent).min(second.shape.extent);
    (PRECISION * spacing).min(MAX_PRECISION * extent)
}

/// Factors by which the bands of two shapes become comparable.
struct BandUnits {
    /// Scale of the motion.
    scale: f64,
    /// Area of a sample, in squared units of the second shape.
    area: f64,
    /// Sign by which the first shape's bands are multiplied.
    sign: f64,
}

/// Correlations of the bands at partners: the highest lower bound over the levels, and the information of all levels in
/// nats.
///
/// A sample counts on a level if it lies within σ of its partner and both are farther than σ from borders. With the
/// correlation ρ over N independent patches, the information of a level is `−sign(ρ)·N/4·ln(1 − ρ²)`: half of that of
/// independent levels, because neighboring levels share half of their content.
fn band_agreement(
    shapes: [&RegistrandView<'_>; 2],
    partners: &[Partner<'_>],
    &BandUnits { scale, area, sign }: &BandUnits,
) -> (f64, f64) {
    let [Some(own_bands), Some(other_bands)] = shapes.map(|view| view.shape.features.bands.as_ref()) else {
        return (0.0, 0.0);
    };
    let bands = [own_bands, other_bands];
    let n_levels = bands[0].n_levels().min(bands[1].n_levels());
    // With a change of size the same width may be another level.
    let offset = (2.0 * (scale * bands[0].sigma[1] / bands[1].sigma[1]).log2()).round() as i64;
    let borders: Vec<f64> = partners
        .iter()
        .map(|p| {
            let [own, other] = if p.is_forward { shapes } else { [shapes[1], shapes[0]] };
            let units = if p.is_forward { [scale, 1.0] } else { [1.0, scale] };
            (units[0] * own.border_distance(&p.sample.corners))
                .min(units[1] * other.border_distance(&p.closest.corners))
        })
        .collect();
    let (mut agreement, mut information) = (0.0_f64, 0.0);
    for j in 1..=n_levels as i64 {
        let k = j + offset;
        if k < 1 || k > bands[1].n_levels() as i64 {
            continue;
        }
        let (j, k) = (j as usize, k as usize);
        let sigma = bands[1].sigma[k];
        let (first, second) = (bands[0].wavelet(j), bands[1].wavelet(k));
        let mut sums = PearsonSums::default();
        for (p, border) in partners.iter().zip(&borders) {
            if p.distance > sigma || *border < BORDER_SIGMAS * sigma {
                continue;
            }
            let own = ClosestPoint { corners: p.sample.corners, weights: p.sample.weights, ..p.closest };
            let [x, y] = if p.is_forward {
                [own.value(first), p.closest.value(second)]
            } else {
                [p.closest.value(first), own.value(second)]
            };
            sums.add(sign * x, y);
        }
        // Both directions see the same places.
        let n_patches = 0.5 * (sums.n * area / (PATCH * sigma * sigma)).min(sums.n / 2.0);
        if n_patches < MIN_PATCHES {
            continue;
        }
        let least = shapes.map(|view| LEAST_RELIEF * view.shape.spacing);
        if sums.deviations().into_iter().zip(least).any(|(deviation, least)| deviation < least) {
            continue;
        }
        let correlation = sums.correlation();
        let bound = (correlation.min(0.999_999).atanh() - 2.0 / (n_patches - 3.0).sqrt()).tanh();
        agreement = agreement.max(bound);
        // Levels are half an octave apart and share half of their content.
        information -=
            0.25 * n_patches * (1.0 - correlation.abs().min(0.999_999).powi(2)).ln() * correlation.signum();
    }
    (agreement, information)
}

/// Sums from which the correlation of two values is computed.
#[derive(Default)]
struct PearsonSums {
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    yy: f64,
    xy: f64,
}

impl PearsonSums {
    fn add(&mut self, x: f64, y: f64) {
        if x.is_finite() && y.is_finite() {
            self.n += 1.0;
            self.x += x;
            self.y += y;
            self.xx += x * x;
            self.yy += y * y;
            self.xy += x * y;
        }
    }

    /// Standard deviations of both values.
    fn deviations(&self) -> [f64; 2] {
        let deviation = |sum: f64, squares: f64| ((squares - sum * sum / self.n).max(0.0) / self.n).sqrt();
        [deviation(self.x, self.xx), deviation(self.y, self.yy)]
    }

    /// Correlation in [−1, 1]; 0 if one of the values does not vary.
    fn correlation(&self) -> f64 {
        let variance = (self.xx - self.x * self.x / self.n) * (self.yy - self.y * self.y / self.n);
        let covariance = self.xy - self.x * self.y / self.n;
        if variance > 0.0 { (covariance / variance.sqrt()).clamp(-1.0, 1.0) } else { 0.0 }
    }
}
