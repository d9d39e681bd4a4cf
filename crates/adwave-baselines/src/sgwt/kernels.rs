//! Kernels on the spectrum [0, λ_max].

use super::SgwtError;
use std::f64::consts::PI;

/// Ratio λ_max / λ_min; the scaling function replaces the wavelets below λ_min.
const LOW_PASS_FACTOR: f64 = 20.0;
/// Ends of the cubic part of the spline.
const SPLINE: (f64, f64) = (1.0, 2.0);
/// Largest number of kernels.
const MAX_KERNELS: usize = 256;

/// Family of kernels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum KernelFamily {
    /// Kernel `g(sλ) = sλ·e^(−sλ)` and a low pass; smooth, so that a low degree suffices.
    MexicanHat,
    /// Spline of `hammond2011`: λ² up to 1, λ⁻² from 2, cubic between, and a low pass.
    Abspline,
    /// Kernel `sin(½π cos²(πλ))` on overlapping halves; a tight frame, A = B = 1.
    Itersine,
    /// Meyer kernels in octaves (`leonardi2013`); a tight frame, A = B = 1.
    #[default]
    Meyer,
}

/// Kernels of one family for a spectrum, the low pass first.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernels {
    /// Family of the kernels.
    pub family: KernelFamily,
    /// Upper end λ_max of the spectrum.
    pub lambda_max: f64,
    /// Scale s of each wavelet kernel in descending order; for itersine the index of the kernel.
    pub scales: Vec<f64>,
}

impl Kernels {
    /// Builds `n_kernels` kernels, including the low pass, for a spectrum in [0, `lambda_max`].
    ///
    /// # Errors
    /// [`SgwtError::Kernels`].
    ///
    /// ```
    /// use adwave_baselines::sgwt::{KernelFamily, Kernels};
    /// let meyer = Kernels::new(KernelFamily::Meyer, 5, 8.0)?;
    /// let sum: f64 = (0..5).map(|i| meyer.value(i, 1.7).powi(2)).sum();
    /// assert!((sum - 1.0).abs() < 1e-14);
    /// # Ok::<(), adwave_baselines::sgwt::SgwtError>(())
    /// ```
    pub fn new(family: KernelFamily, n_kernels: usize, lambda_max: f64) -> Result<Self, SgwtError> {
        let least = if family == KernelFamily::Itersine { 2 } else { 3 };
        if n_kernels < least || n_kernels > MAX_KERNELS {
            return Err(SgwtError::Kernels { got: n_kernels, least, most: MAX_KERNELS });
        }
        // A graph without edges has the spectrum {0}; any interval is valid then.
        let lambda_max = if lambda_max > 0.0 { lambda_max } else { 1.0 };
        let wavelets = n_kernels - 1;
        let scales = match family {
            KernelFamily::MexicanHat | KernelFamily::Abspline => {
                let (from, to) =
                    ((SPLINE.1 * LOW_PASS_FACTOR / lambda_max).ln(), (SPLINE.0 / lambda_max).ln());
                let step = (to - from) / (wavelets - 1) as f64;
                (0..wavelets).map(|i| (from + step * i as f64).exp()).collect()
            }
            KernelFamily::Meyer => {
                (0..wavelets).map(|i| 4.0 / (3.0 * lambda_max) * ((wavelets - 1 - i) as f64).exp2()).collect()
            }
            KernelFamily::Itersine => (0..wavelets).map(|i| (i + 1) as f64).collect(),
        };
        Ok(Self { family, lambda_max, scales })
    }

    /// Number of kernels.
    pub fn len(&self) -> usize {
        self.scales.len() + 1
    }

    /// Returns false, because there is always a kernel.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Evaluates `g_i(λ)`; i = 0 is the low pass.
    pub fn value(&self, i: usize, lambda: f64) -> f64 {
        let lambda_min = self.lambda_max / LOW_PASS_FACTOR;
        let low = |part: f64| (-(lambda / (part * lambda_min)).powi(4)).exp();
        match self.family {
            KernelFamily::MexicanHat if i == 0 => 1.2 * (-1.0_f64).exp() * low(0.4),
            KernelFamily::MexicanHat => {
                let x = self.scales[i - 1] * lambda;
                x * (-x).exp()
            }
            KernelFamily::Abspline if i == 0 => abspline_maximum() * low(0.6),
            KernelFamily::Abspline => abspline(self.scales[i - 1] * lambda),
            KernelFamily::Meyer if i == 0 => meyer_low(self.scales[0] * lambda),
            KernelFamily::Meyer => meyer_band(self.scales[i - 1] * lambda, i == self.scales.len()),
            KernelFamily::Itersine => {
                let n = self.len() as f64;
                let scale = self.lambda_max * 2.0 / (n - 1.0);
                let x = lambda / scale - i as f64 / 2.0;
                if x.abs() <= 0.5 { (0.5 * PI * (PI * x).cos().powi(2)).sin() } else { 0.0 }
            }
        }
    }
}

/// Coefficients of the cubic polynomial between 1 and 2 that joins x² and 4x⁻² with equal slopes.
const CUBIC: [f64; 4] = [-5.0, 11.0, -6.0, 1.0];

fn abspline(x: f64) -> f64 {
    if x < SPLINE.0 {
        x * x
    } else if x < SPLINE.1 {
        CUBIC[0] + x * (CUBIC[1] + x * (CUBIC[2] + x * CUBIC[3]))
    } else {
        (SPLINE.1 / x).powi(2)
    }
}

/// Largest value of the spline, where the slope of the cubic polynomial is 0: 11 − 12x + 3x² = 0.
fn abspline_maximum() -> f64 {
    abspline(2.0 - 1.0 / 3.0_f64.sqrt())
}

/// Meyer's auxiliary function ν, from 0 at 0 to 1 at 1, with `ν(x) + ν(1 − x) = 1`.
fn nu(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x.powi(4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x.powi(3))
}

fn meyer_low(x: f64) -> f64 {
    // Falls from 1 at 2/3 to 0 at 4/3.
    (0.5 * PI * nu(3.0 * x / 2.0 - 1.0)).cos()
}

fn meyer_band(x: f64, is_last: bool) -> f64 {
    // Rises from 2/3 to 4/3 and falls to 8/3; the last stays at 1.
    if x < 4.0 / 3.0 {
        (0.5 * PI * nu(3.0 * x / 2.0 - 1.0)).sin()
    } else if is_last {
        1.0
    } else {
        (0.5 * PI * nu(3.0 * x / 4.0 - 1.0)).cos()
    }
}
