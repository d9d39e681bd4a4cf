//! Taubin's low-pass filters: λ|μ and the windowed sinc, the most widely used smoothing methods.
//!
//! Source: `taubin1995signal`, `taubin1996`. Both are polynomials of `K = I − P` (spectrum in [0, 2]) that are 1 at the
//! frequency 0. Strength: they need no preparation and only a handful of products. Weaknesses: there is one cutoff and
//! no bands, and the frequency depends on the meshing, not on the shape.

use crate::differential::{Differential, DifferentialError};
use std::f64::consts::PI;
use thiserror::Error;

/// Reason for which a filter cannot be built or applied.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum TaubinError {
    /// The pass band lies outside the spectrum.
    #[error("the pass band must lie between 0 and 2 (exclusive), got {0}")]
    PassBand(f64),
    /// The number of iterations is out of range.
    #[error("the number of iterations must be in 1..={most}, got {got}")]
    Iterations {
        /// Number of iterations requested.
        got: usize,
        /// Largest number of iterations.
        most: usize,
    },
    /// The factor λ or μ is out of range.
    #[error("λ and μ must satisfy 0 < λ < 1 and μ < −λ, got λ = {lambda} and μ = {mu}")]
    Factors {
        /// Shrinking factor λ.
        lambda: f64,
        /// Inflating factor μ.
        mu: f64,
    },
    /// The signal has the wrong length.
    #[error(transparent)]
    Signal(#[from] DifferentialError),
}

/// Gain at the edge of the pass band, within the 1 ± 0.001 at which VTK's search for the shift ends.
const PASSED: f64 = 0.9995;
/// Largest number of products.
const MAX_ITERATIONS: usize = 100_000;

fn check_iterations(got: usize) -> Result<(), TaubinError> {
    if got == 0 || got > MAX_ITERATIONS {
        return Err(TaubinError::Iterations { got, most: MAX_ITERATIONS });
    }
    Ok(())
}

/// Factors of the two alternating steps of [`lambda_mu`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LambdaMu {
    /// Shrinking factor λ, in (0, 1).
    pub lambda: f64,
    /// Inflating factor μ, below −λ.
    pub mu: f64,
}

/// Computes `((1 − μK)(1 − λK))^iterations f`, which keeps frequencies below about `1/λ + 1/μ`; the result is in the
/// order of the shape.
///
/// # Errors
/// [`TaubinError`].
pub fn lambda_mu(
    k: &Differential,
    signal: &[f64],
    n_channels: usize,
    factors: LambdaMu,
    iterations: usize,
) -> Result<Vec<f64>, TaubinError> {
    let LambdaMu { lambda, mu } = factors;
    if !(lambda > 0.0 && lambda < 1.0 && mu < -lambda && mu.is_finite()) {
        return Err(TaubinError::Factors { lambda, mu });
    }
    check_iterations(iterations)?;
    let before = k.weld_signal(signal, n_channels)?;
    let mut f = before.clone();
    for _ in 0..iterations {
        for step in [lambda, mu] {
            let kf = k.apply(&f, n_channels);
            f.iter_mut().zip(&kf).for_each(|(f, kf)| *f -= step * kf);
        }
    }
    Ok(k.scatter(&f, n_channels))
}

/// Low-pass filter of `taubin1996`. The ideal filter is truncated after `degree` Chebyshev terms and multiplied by
/// Hamming's window; its edge is shifted until the gain at a given frequency has a given value. The windows of
/// Blackman, Hann and Nuttall, which some programs use, give wider transitions at the same degree.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowedSinc {
    /// Coefficients of `T_k(1 − K/2)`.
    pub coefficients: Vec<f64>,
}

impl WindowedSinc {
    /// Builds the filter that passes frequencies below `pass_band`, in (0, 2), by a polynomial of `degree`: the gain
    /// is 1 at 0 and 0.9995 at the edge.
    ///
    /// # Errors
    /// [`TaubinError`].
    ///
    /// ```
    /// let filter = adwave_baselines::taubin::WindowedSinc::new(0.1, 20)?;
    /// assert!((filter.gain(0.0) - 1.0).abs() < 1e-14 && filter.gain(1.5).abs() < 0.01);
    /// # Ok::<(), adwave_baselines::taubin::TaubinError>(())
    /// ```
    pub fn new(pass_band: f64, degree: usize) -> Result<Self, TaubinError> {
        if !(pass_band > 0.0 && pass_band < 2.0) {
            return Err(TaubinError::PassBand(pass_band));
        }
        check_iterations(degree)?;
        let edge = (1.0 - pass_band / 2.0).acos();
        // The gain at the pass band rises with the shift across the main lobe of the window, then ripples around 1.
        let most = (PI - edge).min(4.0 * PI / (degree + 1) as f64);
        let make = |shift: f64| Self::with_edge(edge + shift, degree).normalize_gain_at_zero();
        let shift = find_threshold(|shift| make(shift).gain(pass_band) >= PASSED, most);
        Ok(make(shift))
    }

    /// Builds the filter whose gain is ½ at `frequency`, in (0, 2), by a polynomial of `degree`, for comparisons with
    /// other filters. If the degree is too low for the band, the gain at `frequency` remains above ½.
    ///
    /// # Errors
    /// [`TaubinError`].
    ///
    /// ```
    /// let filter = adwave_baselines::taubin::WindowedSinc::half_gain(0.04, 60)?;
    /// assert!((filter.gain(0.04) - 0.5).abs() < 1e-12 && (filter.gain(0.0) - 1.0).abs() < 1e-14);
    /// # Ok::<(), adwave_baselines::taubin::TaubinError>(())
    /// ```
    pub fn half_gain(frequency: f64, degree: usize) -> Result<Self, TaubinError> {
        if !(frequency > 0.0 && frequency < 2.0) {
            return Err(TaubinError::PassBand(frequency));
        }
        check_iterations(degree)?;
        let make = |theta: f64| Self::with_edge(theta, degree).normalize_gain_at_zero();
        let theta = find_threshold(|theta| theta > 0.0 && make(theta).gain(frequency) >= 0.5, PI);
        Ok(make(theta.max(1e-9)))
    }

    /// Builds the ideal low pass of the frequencies up to `2 − 2 cos θ`, truncated and windowed.
    fn with_edge(theta: f64, degree: usize) -> Self {
        let theta = theta.min(PI);
        let coefficients = (0..=degree)
            .map(|k| {
                let kf = k as f64;
                let ideal = if k == 0 { theta / PI } else { 2.0 * (kf * theta).sin() / (kf * PI) };
                ideal * (0.54 + 0.46 * (kf * PI / (degree + 1) as f64).cos())
            })
            .collect();
        Self { coefficients }
    }

    /// Sets the gain at 0 to 1; without this a shape far from the origin would move.
    fn normalize_gain_at_zero(mut self) -> Self {
        let at_zero: f64 = self.coefficients.iter().sum();
        self.coefficients.iter_mut().for_each(|c| *c /= at_zero);
        self
    }

    /// Gain at `frequency`, an eigenvalue of K.
    pub fn gain(&self, frequency: f64) -> f64 {
        let x = 1.0 - frequency / 2.0;
        let (mut before, mut now, mut sum) = (1.0, x, 0.0);
        for (k, c) in self.coefficients.iter().enumerate() {
            sum += c * before;
            let next = if k == 0 { 2.0 * x * x - 1.0 } else { 2.0 * x * now - before };
            (before, now) = (now, next);
            if k == 0 {
                (before, now) = (x, 2.0 * x * x - 1.0);
            }
        }
        sum
    }

    /// Filters a signal, n_vertices × n_channels, in the order of the shape. Costs one product per degree.
    ///
    /// # Errors
    /// [`TaubinError::Signal`].
    pub fn apply(
        &self,
        k: &Differential,
        signal: &[f64],
        n_channels: usize,
    ) -> Result<Vec<f64>, TaubinError> {
        let f = k.weld_signal(signal, n_channels)?;
        // As differences from f, so that a constant stays bit-identical: p(K)f = f + Σ c_k (T_k f − f).
        let mut before = vec![0.0; f.len()];
        let mut now: Vec<f64> = k.apply(&f, n_channels).iter().map(|v| -0.5 * v).collect();
        let mut sum: Vec<f64> = vec![0.0; f.len()];
        for &c in &self.coefficients[1..] {
            sum.iter_mut().zip(&now).for_each(|(s, d)| *s += c * d);
            // T_{k+1} f − f = 2x(T_k f − f) − (T_{k−1} f − f) + 2(x − 1) f
            let total: Vec<f64> = now.iter().zip(&f).map(|(d, f)| d + f).collect();
            let moved = k.apply(&total, n_channels);
            for ((b, n), m) in before.iter_mut().zip(&now).zip(&moved) {
                *b = 2.0 * n - m - *b;
            }
            std::mem::swap(&mut before, &mut now);
        }
        let out: Vec<f64> = f.iter().zip(&sum).map(|(f, s)| f + s).collect();
        Ok(k.scatter(&out, n_channels))
    }
}

/// Finds the smallest value up to `most` at which a condition holds, up to rounding; `most` if it holds nowhere. The
/// condition is evaluated at steps that are short enough not to miss a ripple of the filter.
fn find_threshold(holds: impl Fn(f64) -> bool, most: f64) -> f64 {
    const STEPS: u32 = 64;
    let place = |k: u32| most * f64::from(k) / f64::from(STEPS);
    let Some(k) = (0..=STEPS).find(|&k| holds(place(k))) else { return most };
    let (mut low, mut high) = (place(k.saturating_sub(1)), place(k));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) { high = middle } else { low = middle }
    }
    high
}

/// Returns the factors and the smallest number of iterations for which [`lambda_mu`] has the gain ½ at `frequency`
/// exactly, for comparisons with other filters. λ is 0.5, and frequencies below about a quarter of `frequency` are
/// kept; `1/λ + 1/μ` is the frequency at which the gain is 1 again. O(1).
///
/// ```
/// let (factors, iterations) = adwave_baselines::taubin::lambda_mu_with_half_gain(0.1);
/// let gain = ((1.0 - 0.1 * factors.lambda) * (1.0 - 0.1 * factors.mu)).powi(iterations as i32);
/// assert!((gain - 0.5).abs() < 1e-9 && iterations > 300);
/// ```
pub fn lambda_mu_with_half_gain(frequency: f64) -> (LambdaMu, usize) {
    const LAMBDA: f64 = 0.5;
    let mu = |kept: f64| 1.0 / (kept - 1.0 / LAMBDA);
    let once = |kept: f64| (1.0 - LAMBDA * frequency) * (1.0 - mu(kept) * frequency);
    let iterations = (-std::f64::consts::LN_2 / once(frequency / 4.0).abs().ln()).ceil().max(1.0);
    // More iterations move the kept frequencies up to the frequency itself, where the gain is 1.
    let reaches = |kept: f64| once(kept).abs().powf(iterations) >= 0.5;
    let kept = find_threshold(reaches, frequency);
    (LambdaMu { lambda: LAMBDA, mu: mu(kept) }, iterations as usize)
}

#[cfg(test)]
mod tests;
