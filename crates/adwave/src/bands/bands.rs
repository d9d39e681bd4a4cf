//! The bands of a signal, in the order of the shape.

use super::{BandsError, BandsInfo};
use crate::parallel;
use std::borrow::Cow;

/// Vertices that a thread treats at a time.
pub(super) const VERTICES_AT_A_TIME: usize = 1 << 12;

/// The bands of a signal: W_f(1), …, W_f(J) and S_f(J), each n_vertices × n_channels, row-major, in the order of the shape.
///
/// They lie one after the other in one buffer, and their sum is the signal (eq. 15). The finer scaling coefficients are
/// sums of the coarser ones, `S_f(j−1) = S_f(j) + W_f(j)`, and made when asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// Number of vertices.
    pub n_vertices: usize,
    /// Number of channels of the signal.
    pub n_channels: usize,
    /// Steps of the diffusion on level j, n_0 = 0 … n_J, whole or not.
    pub steps: Vec<f64>,
    /// Widths σ_j = s·√n_j in model units (hops on a graph), σ_0 = 0.
    pub sigma: Vec<f64>,
    /// How they were computed.
    pub info: BandsInfo,
    /// W_f(1) … W_f(J), S_f(J).
    coefficients: Vec<f64>,
}

impl Bands {
    /// The bands that stand in `coefficients`.
    pub(super) fn new(
        (n_vertices, n_channels): (usize, usize),
        (steps, sigma): (Vec<f64>, Vec<f64>),
        coefficients: Vec<f64>,
        info: BandsInfo,
    ) -> Self {
        debug_assert_eq!(coefficients.len(), steps.len() * n_vertices * n_channels);
        Self { n_vertices, n_channels, steps, sigma, info, coefficients }
    }

    /// J, the number of levels.
    pub fn n_levels(&self) -> usize {
        self.steps.len() - 1
    }

    /// n_vertices × n_channels.
    fn len(&self) -> usize {
        self.n_vertices * self.n_channels
    }

    /// `W_f(j) = S_f(j−1) − S_f(j)`, j = 1 … J (eq. 11).
    ///
    /// # Panics
    /// When there is no level `j`.
    pub fn wavelet(&self, j: usize) -> &[f64] {
        assert!((1..=self.n_levels()).contains(&j), "levels are 1 to {}, not {j}", self.n_levels());
        &self.coefficients[(j - 1) * self.len()..][..self.len()]
    }

    /// W_f(1), …, W_f(J), fine to coarse.
    pub fn wavelets(&self) -> impl DoubleEndedIterator<Item = &[f64]> + ExactSizeIterator {
        (0..self.n_levels()).map(|k| self.wavelet(k + 1))
    }

    /// S_f(J), what is left when all bands are taken off.
    pub fn coarsest(&self) -> &[f64] {
        &self.coefficients[self.n_levels() * self.len()..]
    }

    /// `S_f(j) = S_f(J) + Σ_{i>j} W_f(i)`, j = 0 … J; S_f(0) is the signal but for rounding. O((J − j)·n).
    ///
    /// # Panics
    /// When there is no level `j`.
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
        // S_f(j) = S_f(J) + Σ_{i>j} W_f(i), of j = 0 the signal (eq. 15). From coarse to fine: the small bands are added last,
        // so that the sum retraces S_f(j) step by step.
        for i in (j + 1..=self.n_levels()).rev() {
            add(&mut sum, self.wavelet(i), self.n_channels);
        }
        Cow::Owned(sum)
    }

    /// S_f(0) … S_f(J) one after the other, (J + 1)·n_vertices·n_channels values. O(J·n).
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

    /// `f = S_f(J) + Σ_j W_f(j)` (eq. 15). Exact but for rounding, by whatever method the bands were computed: the sum
    /// telescopes.
    pub fn reconstruct(&self) -> Vec<f64> {
        self.scaling(0).into_owned()
    }

    /// W_f(1), …, W_f(J), S_f(J) one after the other: (J + 1)·n_vertices·n_channels values.
    pub fn as_slice(&self) -> &[f64] {
        &self.coefficients
    }

    /// [`as_slice`](Self::as_slice), given away.
    pub fn into_vec(self) -> Vec<f64> {
        self.coefficients
    }

    /// Treats W_f(1), …, W_f(J), S_f(J) one after the other.
    pub(crate) fn for_each_level(&mut self, treat: impl FnMut(&mut [f64])) {
        let len = self.len();
        self.coefficients.chunks_exact_mut(len).for_each(treat);
    }

    /// Mean square `Σ_x μ(x)‖W_f(j,x)‖² / Σ_x μ(x)` of each band j = 1 … J under a weight μ ≥ 0 of the vertices (their
    /// areas, say), in squared units of the signal.
    ///
    /// # Errors
    /// [`BandsError::WrongNumber`] when there is not one weight per vertex.
    pub fn energy(&self, weights: &[f64]) -> Result<Vec<f64>, BandsError> {
        let (n_given, expected) = (weights.len(), self.n_vertices);
        if n_given != expected {
            return Err(BandsError::WrongNumber { what: "weights of the vertices", n_given, expected });
        }
        let total = parallel::sum(weights.len(), |x| weights[x]);
        let weight = |x: usize| if total > 0.0 { weights[x] / total } else { 1.0 / self.n_vertices as f64 };
        let energy = self
            .wavelets()
            .map(|band| {
                parallel::sum(self.n_vertices, |x| {
                    let row = &band[x * self.n_channels..][..self.n_channels];
                    // Masked vertices have no area, and NaN in the bands.
                    let square = || row.iter().map(|w| w * w).sum::<f64>();
                    if weight(x) == 0.0 { 0.0 } else { weight(x) * square() }
                })
            })
            .collect();
        Ok(energy)
    }
}

/// `sum += band`.
fn add(sum: &mut [f64], band: &[f64], n_channels: usize) {
    parallel::for_rows(sum, n_channels, VERTICES_AT_A_TIME, |first, sum| {
        for (s, w) in sum.iter_mut().zip(&band[first * n_channels..]) {
            *s += w;
        }
    });
}
