//! Taubin's low-pass filters: λ|μ and the windowed sinc, the smoothing that everyone uses.
//!
//! Source: `taubin1995signal`, `taubin1996`. Both are polynomials of `K = I − P` (spectrum in [0, 2]) that are 1 at the
//! frequency 0. Where they win: nothing is prepared, a handful of products does it. Where they do not: one cut, no bands,
//! and the frequency is that of the mesh, not of the shape.

use crate::differential::{Differential, DifferentialError};
use std::f64::consts::PI;
use thiserror::Error;

/// Why a filter is none.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TaubinError {
    /// A pass band outside the spectrum.
    #[error("the pass band is {0}; it lies between 0 and 2, both excluded")]
    PassBand(f64),
    /// No steps, or too many.
    #[error("{got} iterations; take 1 to {most}")]
    Iterations {
        /// Asked for.
        got: usize,
        /// The most.
        most: usize,
    },
    /// λ or μ out of range.
    #[error("λ = {lambda} and μ = {mu}; it takes 0 < λ < 1 and μ < −λ")]
    Factors {
        /// λ.
        lambda: f64,
        /// μ.
        mu: f64,
    },
    /// The signal does not fit.
    #[error(transparent)]
    Signal(#[from] DifferentialError),
}

/// The gain asked for at the edge of the pass band: the window's ripple is 0.002, so that 1 itself may never be reached.
const PASSED: f64 = 0.995;
/// Cap on the products.
const MAX_ITERATIONS: usize = 100_000;

fn check_iterations(got: usize) -> Result<(), TaubinError> {
    if got == 0 || got > MAX_ITERATIONS {
        return Err(TaubinError::Iterations { got, most: MAX_ITERATIONS });
    }
    Ok(())
}

/// `((1 − μK)(1 − λK))^iterations f`, which keeps frequencies below about `1/λ + 1/μ`. In the order of the shape.
///
/// # Errors
/// [`TaubinError`].
pub fn lambda_mu(
    k: &Differential,
    signal: &[f64],
    n_channels: usize,
    (lambda, mu): (f64, f64),
    iterations: usize,
) -> Result<Vec<f64>, TaubinError> {
    if !(lambda > 0.0 && lambda < 1.0 && mu < -lambda && mu.is_finite()) {
        return Err(TaubinError::Factors { lambda, mu });
    }
    check_iterations(iterations)?;
    let before = k.welded(signal, n_channels)?;
    let mut f = before.clone();
    for _ in 0..iterations {
        for step in [lambda, mu] {
            let kf = k.apply(&f, n_channels);
            f.iter_mut().zip(&kf).for_each(|(f, kf)| *f -= step * kf);
        }
    }
    Ok(k.scattered(&f, n_channels))
}

/// The low-pass filter of `taubin1996`: the ideal one cut after `degree` Chebyshev terms and windowed after
/// Hamming, its edge moved until the gain at the pass band is 1 again but for the ripple, as VTK has it.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowedSinc {
    /// Coefficients of `T_k(1 − K/2)`.
    pub coefficients: Vec<f64>,
}

impl WindowedSinc {
    /// The filter that passes frequencies below `pass_band`, in (0, 2), by a polynomial of `degree`.
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
        let make = |shift: f64| {
            let theta = (edge + shift).min(PI);
            let coefficients = (0..=degree)
                .map(|k| {
                    let kf = k as f64;
                    let ideal = if k == 0 { theta / PI } else { 2.0 * (kf * theta).sin() / (kf * PI) };
                    ideal * (0.54 + 0.46 * (kf * PI / (degree + 1) as f64).cos())
                })
                .collect();
            Self { coefficients }
        };
        // Bisection for the shift; the gain at the pass band rises with it, through the width of the window's main lobe.
        let (mut low, mut high) = (0.0, (PI - edge).min(4.0 * PI / (degree + 1) as f64));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if make(middle).gain(pass_band) < PASSED { low = middle } else { high = middle }
        }
        let mut filter = make(low);
        // Constants are kept exactly, or a shape far from the origin would move.
        let at_zero: f64 = filter.coefficients.iter().sum();
        filter.coefficients.iter_mut().for_each(|c| *c /= at_zero);
        Ok(filter)
    }

    /// The gain at `frequency`, an eigenvalue of K.
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

    /// The filtered signal, n_vertices × n_channels, in the order of the shape. One product a degree.
    ///
    /// # Errors
    /// [`TaubinError::Signal`].
    pub fn apply(
        &self,
        k: &Differential,
        signal: &[f64],
        n_channels: usize,
    ) -> Result<Vec<f64>, TaubinError> {
        let f = k.welded(signal, n_channels)?;
        // As differences from f, so that a constant stays the same to the last bit: p(K)f = f + Σ c_k (T_k f − f).
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
        Ok(k.scattered(&out, n_channels))
    }
}

#[cfg(test)]
mod tests;
