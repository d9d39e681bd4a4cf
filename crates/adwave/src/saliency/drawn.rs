//! The signed map in single precision, for pictures that follow an edit.

use super::{SaliencyError, SaliencyParams, VERTICES_AT_A_TIME, saliency};
use crate::bands::Wavelets;
use crate::population::Population;
use crate::{Decomposer, Progress, parallel};

/// Number of values summed side by side.
const LANES: usize = 8;
/// Number of rows of [`LANES`] values that are summed in single precision.
const ROWS: usize = 32;
/// Number of vertices from which the mean of a level is estimated before it is known.
const GUESSED_BY: usize = 1000;

/// The map of [`saliency`] for [`SaliencyParams::default`] with values and logarithms in single precision, in the
/// order of the shape, for pictures. The error is below 1e-5 of the largest value. O(n × levels).
///
/// If vertices are weighted by area or masked, the result is that of [`saliency`] itself.
///
/// # Errors
/// As for [`saliency`].
///
/// ```
/// use adwave::saliency::{SaliencyParams, saliency_f32, saliency};
/// use adwave::{Decomposer, Progress, bands::Schedule, shape::{Graph, Shape}};
/// let edges: Vec<_> = (1..60).map(|i| (i - 1, i, 1.0)).collect();
/// let path = Decomposer::new(&Shape::Graph(Graph::new(60, &edges)?));
/// let mut signal = [0.0; 60];
/// signal[30] = 1.0;
/// let wavelets = path.request(&signal, 1, &Schedule::dyadic(5)?).norms()?;
/// let exact = saliency(&path, &wavelets, &SaliencyParams::default(), Progress::none())?.map;
/// let drawn = saliency_f32(&path, &wavelets, Progress::none())?;
/// assert!((f64::from(drawn[30]) / exact[30] - 1.0).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn saliency_f32(
    decomposer: &Decomposer,
    wavelets: &Wavelets,
    progress: Progress<'_>,
) -> Result<Vec<f32>, SaliencyError> {
    let n = decomposer.n_places();
    let is_plain = Population::new(decomposer).is_even() && wavelets.n_channels == 1;
    let factors = (is_plain && wavelets.n_welded() == n).then(|| factors(wavelets)).flatten();
    let Some(factors) = factors else {
        let map = saliency(decomposer, wavelets, &SaliencyParams::default(), progress)?.map;
        return Ok(parallel::collect(map.len(), |x| map[x] as f32));
    };
    let mut map = vec![0.0_f32; n];
    parallel::try_visit_rows(&mut map, 1, VERTICES_AT_A_TIME, progress, |first, map| {
        for (factor, level) in factors.iter().zip(&wavelets.levels) {
            for (sum, w) in map.iter_mut().zip(&level[first..]) {
                *sum += (factor * w) as f32; // Λ±(x) = Σ_j α_j·W_f(j,x)
            }
        }
    })?;
    Ok(decomposer.vertex_map().scatter(&map, 1))
}

/// Weights α_j of [`Weighting::Entropy`](super::Weighting::Entropy); `None` if the magnitude of a level could not
/// be estimated.
fn factors(wavelets: &Wavelets) -> Option<Vec<f64>> {
    let n = wavelets.n_welded();
    let guessed: Vec<f64> = wavelets.levels.iter().map(|level| guessed_mean(level)).collect();
    if !guessed.iter().all(|mean| mean.is_normal() && mean.recip().is_normal()) {
        return None;
    }
    let chunk = |range: std::ops::Range<usize>| {
        let sums = |(level, mean): (&Vec<f64>, &f64)| sums(&level[range.clone()], mean.recip());
        wavelets.levels.iter().zip(&guessed).map(sums).collect::<Vec<_>>()
    };
    let chunks = parallel::map_chunks(n, VERTICES_AT_A_TIME, chunk);
    let factor = |(j, guessed): (usize, &f64)| {
        let [r, uneven] = [0, 1].map(|i| chunks.iter().map(|sums| sums[j][i]).sum::<f64>() / n as f64);
        // For s = |W|/mean, which is r/mean(r), mean(s·ln s) follows from the mean of r·ln r − r + 1.
        let entropy = (uneven + r - 1.0) / r - r.ln();
        entropy.max(0.0) / (r * guessed)
    };
    let factors: Vec<f64> = guessed.iter().enumerate().map(factor).collect();
    factors.iter().all(|factor| factor.is_finite()).then_some(factors)
}

fn guessed_mean(level: &[f64]) -> f64 {
    let every = (level.len() / GUESSED_BY).max(1);
    let sum: f64 = level.iter().step_by(every).map(|w| w.abs()).sum();
    sum / level.len().div_ceil(every) as f64
}

/// Sums of r and of (r·ln r − r + 1) for r = |value|·scale.
fn sums(values: &[f64], scale: f64) -> [f64; 2] {
    let (rows, rest) = values.as_chunks::<LANES>();
    let mut total = [0.0; 2];
    for rows in rows.chunks(ROWS) {
        let (mut all, mut uneven) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for row in rows {
            for i in 0..LANES {
                let r = (row[i] * scale).abs() as f32;
                all[i] += r;
                uneven[i] += unevenness(r);
            }
        }
        for i in 0..LANES {
            total[0] += f64::from(all[i]);
            total[1] += f64::from(uneven[i]);
        }
    }
    for value in rest {
        let r = (value * scale).abs() as f32;
        total[0] += f64::from(r);
        total[1] += f64::from(unevenness(r));
    }
    total
}

/// The function `r·ln r − r + 1` for r ≥ 0, to within about 1e-7 of 1 or of the value.
#[inline]
fn unevenness(r: f32) -> f32 {
    // r = 2^e·(1 + t) with 1 + t between √½ and √2; ln(1 + t) by the minimax polynomial of the Cephes library.
    const SQRT_HALF: i32 = 0x3f35_04f3;
    let bits = r.to_bits() as i32;
    let e = (bits - SQRT_HALF) >> 23;
    let t = f32::from_bits((bits - (e << 23)) as u32) - 1.0;
    let mut p = 7.037_683_6e-2_f32;
    for c in [
        -1.151_461e-1,
        1.167_699_9e-1,
        -1.242_014_1e-1,
        1.424_932_3e-1,
        -1.666_805_8e-1,
        2.000_071_5e-1,
        -2.499_999_4e-1,
        3.333_333e-1,
    ] {
        p = p * t + c;
    }
    // ln 2 in two parts, of which the first is exact times e.
    let e = e as f32;
    let ln = t + (p * t * t * t - 0.5 * t * t - 2.121_944_4e-4 * e) + 0.693_359_4 * e;
    r * ln - r + 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_are_those_of_single_precision() {
        for k in 0..20_000 {
            let r = 1e-6 * 1.0015_f64.powi(k);
            let exact = r * r.ln() - r + 1.0;
            let off = (f64::from(unevenness(r as f32)) - exact).abs();
            assert!(off < 4e-7 * exact.max(1.0), "{r}: {off:e}");
        }
        assert_eq!(unevenness(0.0), 1.0);
        assert_eq!(unevenness(1.0), 0.0);
    }
}
