//! Kernels as Chebyshev polynomials of the Laplacian.

use super::{Kernels, SgwtError};
use crate::linalg::SymmetricMatrix;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Largest degree that is tried.
const MAX_DEGREE: usize = 16384;

/// Polynomial `p(λ) = Σ_k c_k T_k(2λ/λ_max − 1)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    /// Coefficients c_k; the constant term is not halved.
    pub coefficients: Vec<f64>,
    /// Upper end λ_max of the spectrum.
    pub lambda_max: f64,
    /// Largest `|p − g|` found on [0, λ_max], sampled at four points per degree.
    pub error: f64,
}

impl Polynomial {
    /// Interpolates `g` at the `degree + 1` Chebyshev points. O(degree²).
    pub fn interpolate(g: impl Fn(f64) -> f64 + Sync, lambda_max: f64, degree: usize) -> Self {
        let n = degree + 1;
        // cos(k·π(2j + 1)/2n) for all j and k is one of 4n values.
        let cosine: Vec<f64> = (0..4 * n).map(|i| (PI * i as f64 / (2 * n) as f64).cos()).collect();
        let values: Vec<f64> = (0..n).map(|j| g(0.5 * lambda_max * (cosine[2 * j + 1] + 1.0))).collect();
        let coefficients: Vec<f64> = (0..n)
            .into_par_iter()
            .map(|k| {
                let sum: f64 =
                    values.iter().enumerate().map(|(j, v)| v * cosine[(2 * j + 1) * k % (4 * n)]).sum();
                sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
            })
            .collect();
        let mut polynomial = Self { coefficients, lambda_max, error: 0.0 };
        let points = 4 * n.max(64);
        polynomial.error = (0..=points)
            .into_par_iter()
            .map(|i| {
                let lambda = lambda_max * i as f64 / points as f64;
                (polynomial.value(lambda) - g(lambda)).abs()
            })
            .reduce(|| 0.0, f64::max);
        polynomial
    }

    /// Evaluates `p(λ)` by Clenshaw's recurrence.
    pub fn value(&self, lambda: f64) -> f64 {
        let y = 2.0 * lambda / self.lambda_max - 1.0;
        let (mut b1, mut b2) = (0.0, 0.0);
        for &c in self.coefficients[1..].iter().rev() {
            (b1, b2) = (c + 2.0 * y * b1 - b2, b1);
        }
        self.coefficients[0] + y * b1 - b2
    }
}

/// Approximates the kernels by polynomials within `accuracy`; the degree is doubled until it suffices.
///
/// # Errors
/// [`SgwtError::Accuracy`].
pub fn fit(kernels: &Kernels, accuracy: f64) -> Result<Vec<Polynomial>, SgwtError> {
    (0..kernels.len())
        .map(|i| {
            let mut degree = 16;
            loop {
                let p = Polynomial::interpolate(|l| kernels.value(i, l), kernels.lambda_max, degree);
                if p.error <= accuracy {
                    return Ok(p);
                }
                if degree >= MAX_DEGREE {
                    return Err(SgwtError::Accuracy { kernel: i, degree, error: p.error, accuracy });
                }
                degree *= 2;
            }
        })
        .collect()
}

/// Computes `p_i(L) f` for all polynomials by one recurrence.
pub(crate) fn apply(
    laplacian: &SymmetricMatrix,
    polynomials: &[Polynomial],
    signal: &[f64],
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, Cancelled> {
    let Some(first) = polynomials.first() else { return Ok(Vec::new()) };
    let scale = 2.0 / first.lambda_max;
    let degree = polynomials.iter().map(|p| p.coefficients.len()).max().unwrap_or(1) - 1;
    let mut sums: Vec<Vec<f64>> =
        polynomials.iter().map(|p| signal.iter().map(|v| p.coefficients[0] * v).collect()).collect();
    let mut before = signal.to_vec();
    let mut now = apply_shifted(laplacian, &before, scale);
    for k in 1..=degree {
        progress.step(k as u64, degree as u64)?;
        for (sum, c) in sums.iter_mut().zip(polynomials.iter().map(|p| p.coefficients.get(k))) {
            if let Some(c) = c {
                sum.iter_mut().zip(&now).for_each(|(s, v)| *s += c * v);
            }
        }
        if k < degree {
            let moved = apply_shifted(laplacian, &now, scale);
            before.iter_mut().zip(&moved).for_each(|(b, m)| *b = 2.0 * m - *b);
            std::mem::swap(&mut before, &mut now);
        }
    }
    Ok(sums)
}

/// Computes `Σ_i p_i(L) c_i` by Clenshaw's recurrence, one recurrence for all polynomials.
pub(super) fn apply_adjoint(
    laplacian: &SymmetricMatrix,
    polynomials: &[Polynomial],
    coefficients: &[Vec<f64>],
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let n = laplacian.n();
    let Some(first) = polynomials.first() else { return Ok(vec![0.0; n]) };
    let scale = 2.0 / first.lambda_max;
    let degree = polynomials.iter().map(|p| p.coefficients.len()).max().unwrap_or(1) - 1;
    let (mut b1, mut b2) = (vec![0.0; n], vec![0.0; n]);
    for k in (0..=degree).rev() {
        progress.step((degree - k) as u64, degree as u64)?;
        // b_k = a_k + 2y b_{k+1} − b_{k+2}; the last step takes y b_1 once.
        let moved = apply_shifted(laplacian, &b1, scale);
        let twice = if k == 0 { 1.0 } else { 2.0 };
        b2.iter_mut().zip(&moved).for_each(|(b2, m)| *b2 = twice * m - *b2);
        for (p, c) in polynomials.iter().zip(coefficients) {
            if let Some(&a) = p.coefficients.get(k) {
                b2.iter_mut().zip(c).for_each(|(b, c)| *b += a * c);
            }
        }
        std::mem::swap(&mut b1, &mut b2);
    }
    Ok(b1)
}

/// Computes `(2L/λ_max − 1) x`, with `scale` = 2/λ_max.
fn apply_shifted(laplacian: &SymmetricMatrix, x: &[f64], scale: f64) -> Vec<f64> {
    let mut y = laplacian.product(x);
    y.iter_mut().zip(x).for_each(|(y, x)| *y = scale * *y - x);
    y
}
