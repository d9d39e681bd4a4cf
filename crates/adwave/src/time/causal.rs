//! Smoothing by earlier frames alone: a cascade of first-order filters.
//!
//! Each filter is `y += (x − y)/(1 + μ)`, whose weights `μᵏ/(1 + μ)^{k+1}` have the sum 1, the mean delay μ and the
//! variance μ² + μ, in frames (`lindeberg2016`). Variances and delays of filters in turn add up, so the widths of a
//! schedule are reached one after another, and bands telescope as those of heat do.

/// Filters from one width to the next. More are closer to a Gaussian, and later: by √n standard deviations.
const FILTERS: usize = 2;

/// Filters from one width to another.
pub(super) struct Cascade {
    /// Mean delay μ of each filter, in frames.
    mu: f64,
}

impl Cascade {
    /// Filters that take values of the width `from` to the width `to`, in frames.
    pub(super) fn new(from: f64, to: f64) -> Self {
        // μ² + μ = v for the variance v of each filter, without loss of digits where v is small.
        let variance = 0.5 * (to - from) * (to + from) / FILTERS as f64;
        Self { mu: 2.0 * variance / (1.0 + (1.0 + 4.0 * variance).sqrt()) }
    }

    /// Mean delay, in frames.
    pub(super) fn delay(&self) -> f64 {
        FILTERS as f64 * self.mu
    }

    /// Share of the way to the next frame's value that a filter goes, for each frame but the first. `uneven` are the gaps
    /// between frames and their mean, if they differ: a filter then takes the step to the next frame in proportion.
    pub(super) fn shares(&self, n_frames: usize, uneven: Option<(&[f64], f64)>) -> Vec<f64> {
        let share = |k: usize| match uneven {
            Some((gaps, mean)) => 1.0 / (1.0 + self.mu * mean / gaps[k - 1]),
            None => 1.0 / (1.0 + self.mu),
        };
        (1..n_frames).map(share).collect()
    }
}

/// Filters a row, frames × components, in place by the shares of a [`Cascade`].
pub(super) fn filter_row(shares: &[f64], n_components: usize, row: &mut [f64]) {
    for _ in 0..FILTERS {
        for (k, share) in shares.iter().enumerate() {
            let (before, here) = row[k * n_components..].split_at_mut(n_components);
            for (x, y) in here.iter_mut().zip(before) {
                *x = *y + (*x - *y) * share;
            }
        }
    }
}
