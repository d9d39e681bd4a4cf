//! Noise of a cloud by place.

use super::fit::{FitFrame, Heights};
use super::{NEIGHBORS, NOTHING, NearestRows};
use crate::denoise::noise_level::median;
use crate::vector::{Vector, norm, subtract};
use crate::{Cancelled, Progress, parallel};
use std::sync::LazyLock;

/// Numbers of neighbors of the three fits whose residuals are measured: a plane and two quadrics.
pub(super) const FIT_SIZES: [usize; 3] = [8, 16, 32];

/// Largest noise that the residuals of each fit measure, in distances to the last neighbor of the fit. Beyond it, the
/// nearest points of a point are those with a similar error.
const MOST_NOISE: [f64; 3] = [0.285, 0.33, f64::INFINITY];

/// Noise, in distances to the last neighbor, from which the residuals of the plane no longer grow.
const SATURATION: f64 = 0.34;

/// Factor of the 90 % quantile of the residuals, so that random deviations are seldom taken for two sheets.
const SHEETS_MARGIN: f64 = 1.15;

/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
const DEVIATION_PER_MEDIAN: f64 = 1.4826;

/// Quantile of the noise among neighbors that smooths it, and number of rounds. Few points are at edges, so the
/// quantile is hardly affected by them.
const PLACE_QUANTILE: f64 = 0.4;
const PLACE_ROUNDS: usize = 3;

/// Residual of a point from the fits to its neighbors, in standard deviations of noise of variance 1; NaN without a
/// fit.
pub(super) type Residuals = [f64; 3];

/// Residuals of all points. O(points).
pub(super) fn fit_residuals(
    points: &[Vector],
    near: &NearestRows,
    progress: Progress<'_>,
) -> Result<Vec<Residuals>, Cancelled> {
    parallel::try_collect(points.len(), progress, |x| {
        let row = near.row(x);
        let row = &row[..row.len().min(FIT_SIZES[2])];
        let radius = near.radius(points, x, FIT_SIZES[2]);
        if row.len() < FIT_SIZES[0] || radius < NOTHING {
            return [f64::NAN; 3];
        }
        let frame = FitFrame::new(points, x, row, 0.5 * radius);
        let heights = Heights::new(points, x, row, &frame, radius);
        std::array::from_fn(|c| {
            if row.len() < FIT_SIZES[c] {
                return f64::NAN;
            }
            let fit = match c {
                0 => heights.fit_without_center::<3>(FIT_SIZES[c]),
                _ => heights.fit_without_center::<6>(FIT_SIZES[c]),
            };
            fit.map_or(f64::NAN, |fit| fit.height.abs() / (1.0 + fit.variance).sqrt())
        })
    })
}

/// Standard deviation of the noise at each point: the least of three estimates from the residuals around it, smoothed.
pub(super) fn noise_by_place(
    points: &[Vector],
    near: &NearestRows,
    residuals: &[Residuals],
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let levels = parallel::try_collect(points.len(), progress, |x| {
        let estimate = |c: usize| {
            let mut own = [0.0; NEIGHBORS + 1];
            let around = near.row(x).iter().map(|&y| y as usize).chain([x]).map(|y| residuals[y][c]);
            let mut n = 0;
            for residual in around.filter(|r| r.is_finite()) {
                own[n] = residual;
                n += 1;
            }
            if n < 4 {
                return f64::INFINITY;
            }
            let deviation = one_sheet_deviation(&mut own[..n]);
            let share = deviation / near.radius(points, x, FIT_SIZES[c]);
            match c {
                _ if share >= MOST_NOISE[c] => f64::INFINITY,
                0 => deviation / (1.0 - (share / SATURATION).powi(6)),
                _ => deviation,
            }
        };
        (0..3).map(estimate).fold(f64::INFINITY, f64::min)
    })?;
    let mut smooth = parallel::try_collect(points.len(), progress, |x| {
        let known = near.row(x).iter().map(|&y| levels[y as usize]).chain([levels[x]]);
        let (sum, n) = known.filter(|s| s.is_finite()).fold((0.0, 0), |(sum, n), s| (sum + s, n + 1));
        if n > 0 { sum / f64::from(n) } else { 0.0 }
    })?;
    for _ in 0..PLACE_ROUNDS {
        smooth = parallel::try_collect(points.len(), progress, |x| {
            let row = near.row(x);
            let mut own = [0.0; NEIGHBORS + 1];
            for (slot, &y) in own.iter_mut().zip(row) {
                *slot = smooth[y as usize];
            }
            own[row.len()] = smooth[x];
            quantile(&mut own[..=row.len()], PLACE_QUANTILE)
        })?;
    }
    Ok(smooth)
}

/// Value below which a share of the values lies.
pub(super) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() as f64 * share) as usize).min(values.len() - 1);
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// Standard deviation of the noise of residuals ±a + noise, as points of two sheets have them, with a ≥ 0 from the
/// ratio of the 90 % quantile to the median.
fn one_sheet_deviation(residuals: &mut [f64]) -> f64 {
    let middle = median(residuals);
    let ratio = SHEETS_MARGIN * quantile(residuals, 0.9) / middle.max(f64::MIN_POSITIVE);
    let table = &*SHEET_TABLE;
    let k = table.partition_point(|entry| entry[0] > ratio);
    let part = match k {
        0 => table[0][1],
        _ if k == table.len() => table[k - 1][1],
        _ => {
            let ([high, of_high], [low, of_low]) = (table[k - 1], table[k]);
            of_high + (high - ratio) / (high - low) * (of_low - of_high)
        }
    };
    DEVIATION_PER_MEDIAN * middle * part
}

/// Ratios of the quantiles, falling, and the standard deviation in units of 1.4826 medians, for sheets 0, 0.2, … 7.8
/// standard deviations apart.
static SHEET_TABLE: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let entry = |k: u32| {
        let a = 0.1 * f64::from(k);
        let median = folded_quantile(a, 0.5);
        [folded_quantile(a, 0.9) / median, folded_quantile(0.0, 0.5) / median]
    };
    (0..40).map(entry).collect()
});

/// Quantile of |a + N| for a standard normal N.
fn folded_quantile(a: f64, share: f64) -> f64 {
    let (mut low, mut high) = (0.0, a + 6.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if normal_share(middle - a) - normal_share(-middle - a) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Share of a standard normal distribution below `x`, to 1e-7 (Abramowitz and Stegun 26.2.17).
fn normal_share(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let density = (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    let series = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let tail = density * series.iter().rev().fold(0.0, |sum, c| t * (c + sum));
    if x > 0.0 { 1.0 - tail } else { tail }
}

/// Distance between two points.
pub(super) fn distance(p: &Vector, q: &Vector) -> f64 {
    norm(&subtract(p, q))
}
