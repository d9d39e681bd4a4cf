//! The bands of a signal, in the order of the shape.

use super::{BandsError, BandsInfo};
use crate::operator::RowWeights;
use crate::parallel;
use std::borrow::Cow;

/// Number of vertices that a thread processes at a time.
pub(super) const VERTICES_AT_A_TIME: usize = 1 << 12;

/// The bands of a signal: W_f(1), …, W_f(J) and S_f(J), each n_vertices × n_channels, row-major, in the order of the
/// shape.
///
/// The bands are stored one after another in one buffer, and their sum is the signal (eq. 15). Finer scaling
/// coefficients are sums of coarser ones, `S_f(j−1) = S_f(j) + W_f(j)`, and are computed on request.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// Number of vertices.
    pub n_vertices: usize,
    /// Number of channels of the signal.
    pub n_channels: usize,
    /// Number of diffusion steps n_j on each level, n_0 = 0 … n_J; may be fractional.
    pub steps: Vec<f64>,
    /// Widths σ_j = s·√n_j in model units (hops on a graph), σ_0 = 0.
    pub sigma: Vec<f64>,
    /// Method, cost and error bound of the computation.
    pub info: BandsInfo,
    /// W_f(1) … W_f(J), S_f(J).
    coefficients: Vec<f64>,
}

impl Bands {
    /// Wraps `coefficients`, laid out as W_f(1), …, W_f(J), S_f(J).
    pub(super) fn new(
        n_vertices: usize,
        n_channels: usize,
        steps: Vec<f64>,
        sigma: Vec<f64>,
        coefficients: Vec<f64>,
        info: BandsInfo,
    ) -> Self {
        debug_assert_eq!(coefficients.len(), steps.len() * n_vertices * n_channels);
        Self { n_vertices, n_channels, steps, sigma, info, coefficients }
    }

    /// Number of levels J.
    pub fn n_levels(&self) -> usize {
        self.steps.len() - 1
    }

    /// Number of values per band, n_vertices × n_channels.
    fn len(&self) -> usize {
        self.n_vertices * self.n_channels
    }

    /// Wavelet coefficients `W_f(j) = S_f(j−1) − S_f(j)` of level j = 1 … J (eq. 11), n_vertices × n_channels.
    ///
    /// # Panics
    /// If level `j` does not exist.
    pub fn wavelet(&self, j: usize) -> &[f64] {
        assert!((1..=self.n_levels()).contains(&j), "levels are 1 to {}, not {j}", self.n_levels());
        &self.coefficients[(j - 1) * self.len()..][..self.len()]
    }

    /// The bands W_f(1), …, W_f(J), from fine to coarse.
    pub fn wavelets(&self) -> impl DoubleEndedIterator<Item = &[f64]> + ExactSizeIterator {
        (0..self.n_levels()).map(|k| self.wavelet(k + 1))
    }

    /// Coarsest scaling coefficients S_f(J): the signal without its bands, n_vertices × n_channels.
    pub fn coarsest(&self) -> &[f64] {
        &self.coefficients[self.n_levels() * self.len()..]
    }

    /// Scaling coefficients `S_f(j) = S_f(J) + Σ_{i>j} W_f(i)`, j = 0 … J, n_vertices × n_channels. S_f(0) equals
    /// the signal up to rounding. O((J − j)·n).
    ///
    /// # Panics
    /// If level `j` does not exist.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// use adwave::shape::{Graph, Shape};
    /// use adwave::Decomposer;
    /// let pair = Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?);
    /// let bands = Decomposer::new(&pair).decompose(&[1.0, 3.0], 1, &Schedule::dyadic(2)?)?;
    /// assert_eq!((bands.wavelet(1), bands.wavelet(2)), (&[-1.0, 1.0][..], &[0.0, 0.0][..]));
    /// assert_eq!((&*bands.scaling(0), &*bands.scaling(1)), (&[1.0, 3.0][..], &[2.0, 2.0][..]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn scaling(&self, j: usize) -> Cow<'_, [f64]> {
        assert!(j <= self.n_levels(), "levels are 0 to {}, not {j}", self.n_levels());
        if j == self.n_levels() {
            return Cow::Borrowed(self.coarsest());
        }
        let mut sum = self.coarsest().to_vec();
        // S_f(j) = S_f(J) + Σ_{i>j} W_f(i); j = 0 gives the signal (eq. 15). Summing from coarse to fine adds the
        // small bands last, so the sum passes through S_f(J−1), S_f(J−2), ….
        for i in (j + 1..=self.n_levels()).rev() {
            add(&mut sum, self.wavelet(i), self.n_channels);
        }
        Cow::Owned(sum)
    }

    /// S_f(0) … S_f(J) one after another, (J + 1)·n_vertices·n_channels values. O(J·n).
    pub fn all_scaling(&self) -> Vec<f64> {
        let len = self.len();
        let mut all = vec![0.0; (self.n_levels() + 1) * len];
        all[self.n_levels() * len..].copy_from_slice(self.coarsest());
        for j in (1..=self.n_levels()).rev() {
            let (finer, coarser) = all.split_at_mut(j * len);
            let finer = &mut finer[(j - 1) * len..];
            finer.copy_from_slice(&coarser[..len]);
            add(finer, self.wavelet(j), self.n_channels);
        }
        all
    }

    /// The signal `f = S_f(J) + Σ_j W_f(j)` (eq. 15). Exact up to rounding, whatever method computed the bands,
    /// because the sum telescopes.
    pub fn reconstruct(&self) -> Vec<f64> {
        self.scaling(0).into_owned()
    }

    /// W_f(1), …, W_f(J), S_f(J) one after another: (J + 1)·n_vertices·n_channels values.
    pub fn as_slice(&self) -> &[f64] {
        &self.coefficients
    }

    /// The values of [`as_slice`](Self::as_slice), without copying them.
    pub fn into_vec(self) -> Vec<f64> {
        self.coefficients
    }

    /// The same levels of another signal of `n_channels` channels whose bands are known, such as the vectors in space of
    /// bands of directions: `levels` are its W_f(1), …, W_f(J), S_f(J).
    ///
    /// # Panics
    /// Unless there are n_vertices × n_channels values for each level.
    #[must_use]
    pub fn with_levels(&self, n_channels: usize, levels: &[Vec<f64>]) -> Self {
        let len = self.n_vertices * n_channels;
        assert!(
            levels.len() == self.steps.len() && levels.iter().all(|level| level.len() == len),
            "a value for each vertex and channel of each level"
        );
        Self {
            n_vertices: self.n_vertices,
            n_channels,
            steps: self.steps.clone(),
            sigma: self.sigma.clone(),
            info: self.info.clone(),
            coefficients: levels.concat(),
        }
    }

    /// Calls `treat` on W_f(1), …, W_f(J), S_f(J) in turn.
    pub(crate) fn visit_levels(&mut self, treat: impl FnMut(&mut [f64])) {
        let len = self.len();
        self.coefficients.chunks_exact_mut(len).for_each(treat);
    }

    /// Calls `treat(level, band)` in turn, with levels counted from 0, up to its first error.
    pub(crate) fn try_visit_levels<E>(
        &mut self,
        mut treat: impl FnMut(usize, &mut [f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        let len = self.len();
        self.coefficients.chunks_exact_mut(len).enumerate().try_for_each(|(level, band)| treat(level, band))
    }

    /// Gradient `⟨W_f(j), ḡ⟩` of a function of `f + Σ_j (g_j − 1)·W_f(j)` with respect to the gains g_j, j = 1 … J,
    /// from its gradient ḡ with respect to that signal (n_vertices × n_channels).
    ///
    /// # Errors
    /// [`BandsError::WrongBuffer`] unless the gradient is as long as the signal.
    pub fn gradient_of_gains(&self, gradient: &[f64]) -> Result<Vec<f64>, BandsError> {
        super::check_buffer(gradient.len(), self.len())?;
        let d = self.n_channels;
        let product = |band: &[f64]| {
            parallel::sum(self.n_vertices, |x| {
                band[x * d..][..d].iter().zip(&gradient[x * d..]).map(|(w, g)| w * g).sum::<f64>()
            })
        };
        Ok(self.wavelets().map(product).collect())
    }

    /// Mean square `Σ_x μ(x)‖W_f(j,x)‖² / Σ_x μ(x)` of each band j = 1 … J for vertex weights μ ≥ 0 (for example
    /// areas), in squared units of the signal.
    ///
    /// # Errors
    /// [`BandsError::WrongNumber`] unless there is one weight per vertex.
    pub fn energy(&self, weights: &[f64]) -> Result<Vec<f64>, BandsError> {
        let weights = RowWeights::Each(weights);
        self.wavelets().map(|band| mean_square(band, self.n_channels, weights)).collect()
    }

    /// Shares of W_f(1), …, W_f(J), S_f(J) in the variance of the signal, J + 1 numbers that sum to 1:
    /// `(‖S_f(j−1)‖² − ‖S_f(j)‖²)/‖f‖² = ⟨W_f(j), S_f(j−1) + S_f(j)⟩/‖f‖²` and `‖S_f(J)‖²/‖f‖²`, all less the mean of
    /// the signal, for vertex weights μ ≥ 0.
    ///
    /// Unlike [`energy`](Self::energy), which counts what neighboring bands have in common twice or not at all, they
    /// are a partition. With the weights of [`Decomposer::stationary`](crate::Decomposer::stationary) no share is
    /// negative if the operator is reversible and the bands are about the local mean; with other weights, and with
    /// bands about a local fit, small negative shares are possible. All shares of a constant signal are 0.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// use adwave::shape::{Graph, Shape};
    /// use adwave::Decomposer;
    /// let path = Decomposer::new(&Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)])?));
    /// let bands = path.decompose(&[1.0, 5.0, 3.0], 1, &Schedule::dyadic(2)?)?;
    /// let shares = bands.shares(&path.stationary())?;
    /// assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12 && shares.iter().all(|share| *share >= 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BandsError::WrongNumber`] unless there is one weight per vertex.
    pub fn shares(&self, weights: &[f64]) -> Result<Vec<f64>, BandsError> {
        let (n_given, expected, d) = (weights.len(), self.n_vertices, self.n_channels);
        if n_given != expected {
            return Err(BandsError::WrongNumber { what: "weights of the vertices", n_given, expected });
        }
        let total = parallel::sum(expected, |x| weights[x]);
        let weight = |x: usize| if total > 0.0 { weights[x] / total } else { 1.0 / expected as f64 };
        let mean: Vec<f64> = (0..d)
            .map(|c| {
                let term =
                    |x: usize| if weight(x) == 0.0 { 0.0 } else { weight(x) * self.coarsest()[x * d + c] };
                parallel::sum(expected, term)
            })
            .collect();
        // S_f(j) less the mean, from coarse to fine. Masked vertices have weight 0 and NaN in the bands.
        let mut scaling: Vec<f64> =
            self.coarsest().iter().enumerate().map(|(i, s)| s - mean[i % d]).collect();
        let square = |x: usize, row: &[f64]| weight(x) * row.iter().map(|s| s * s).sum::<f64>();
        let coarsest = |x: usize| if weight(x) == 0.0 { 0.0 } else { square(x, &scaling[x * d..][..d]) };
        let mut shares = vec![0.0; self.n_levels() + 1];
        shares[self.n_levels()] = parallel::sum(expected, coarsest);
        for (share, band) in shares[..self.n_levels()].iter_mut().zip(self.wavelets()).rev() {
            let product = |x: usize| {
                let (band, coarse) = (&band[x * d..][..d], &scaling[x * d..][..d]);
                let terms = band.iter().zip(coarse).map(|(w, s)| w * (s + (s + w)));
                if weight(x) == 0.0 { 0.0 } else { weight(x) * terms.sum::<f64>() }
            };
            *share = parallel::sum(expected, product);
            add(&mut scaling, band, d);
        }
        let variance: f64 = shares.iter().sum();
        let scale = if variance > 0.0 { 1.0 / variance } else { 0.0 };
        Ok(shares.into_iter().map(|share| share * scale).collect())
    }
}

/// Mean square `Σ_x μ(x)‖W(x)‖² / Σ_x μ(x)` of a band, n_vertices × n_channels, for vertex weights μ ≥ 0, as
/// [`Bands::energy`] has them. Where the weight is 0 the band may be NaN.
///
/// # Errors
/// [`BandsError::WrongNumber`] unless there is one weight per vertex.
///
/// ```
/// use adwave::{bands::mean_square, operator::RowWeights};
/// let band = [1.0, 2.0, 0.0, 3.0]; // two channels of two vertices
/// assert_eq!(mean_square(&band, 2, RowWeights::Each(&[3.0, 1.0]))?, (3.0 * 5.0 + 9.0) / 4.0);
/// assert_eq!(mean_square(&band, 2, RowWeights::Uniform)?, (5.0 + 9.0) / 2.0);
/// # Ok::<(), adwave::bands::BandsError>(())
/// ```
pub fn mean_square(band: &[f64], n_channels: usize, weights: RowWeights<'_>) -> Result<f64, BandsError> {
    let expected = band.len() / n_channels.max(1);
    let total = match weights {
        RowWeights::Uniform => 1.0,
        RowWeights::Each(weights) if weights.len() != expected => {
            let n_given = weights.len();
            return Err(BandsError::WrongNumber { what: "weights of the vertices", n_given, expected });
        }
        RowWeights::Each(weights) => parallel::sum(expected, |x| weights[x]),
    };
    let weight =
        |x: usize| if total > 0.0 { weights.weight(x, expected) / total } else { 1.0 / expected as f64 };
    Ok(parallel::sum(expected, |x| {
        let square = || band[x * n_channels..][..n_channels].iter().map(|w| w * w).sum::<f64>();
        // Masked vertices have area 0 and NaN in the bands.
        if weight(x) == 0.0 { 0.0 } else { weight(x) * square() }
    }))
}

/// Computes `sum += band`.
fn add(sum: &mut [f64], band: &[f64], n_channels: usize) {
    parallel::visit_rows(sum, n_channels, VERTICES_AT_A_TIME, |first, sum| {
        for (s, w) in sum.iter_mut().zip(&band[first * n_channels..]) {
            *s += w;
        }
    });
}
