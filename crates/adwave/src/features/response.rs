//! Responses R(j) of the bands of a signal.

use super::Response;
use crate::bands::Wavelets;
use crate::population::Population;
use crate::{Cancelled, Progress};
use std::borrow::Cow;

/// R at the welded vertices on each level; NaN at masked vertices.
pub(super) struct ResponseLayer<'a> {
    /// The channel, if each channel is a layer.
    pub(super) channel: Option<usize>,
    /// R(j) at index j − 1.
    pub(super) levels: Vec<ResponseLevel<'a>>,
}

/// Values of R(j) and their divisor.
pub(super) struct ResponseLevel<'a> {
    values: Cow<'a, [f64]>,
    scale: f64,
}

impl<'a> ResponseLevel<'a> {
    /// A level as it is.
    pub(super) fn plain(values: &'a [f64]) -> Self {
        Self { values: Cow::Borrowed(values), scale: 1.0 }
    }

    /// The response R(j,x).
    #[inline]
    pub(super) fn value(&self, x: usize) -> f64 {
        self.values[x] / self.scale
    }

    pub(super) fn len(&self) -> usize {
        self.values.len()
    }
}

/// All layers of a response. Checks for cancellation before each level.
pub(super) fn layers<'a>(
    population: &Population<'_>,
    wavelets: &'a Wavelets,
    response: Response,
    progress: Progress<'_>,
) -> Result<Vec<ResponseLayer<'a>>, Cancelled> {
    let levels = |values: &dyn Fn(usize) -> Cow<'a, [f64]>, scale: &dyn Fn(usize, &[f64]) -> f64| {
        let level = |j: usize| {
            progress.check()?;
            let values = values(j);
            let scale = scale(j, &values);
            // A level without any response stays 0.
            Ok(ResponseLevel { values, scale: if scale > 0.0 { scale } else { 1.0 } })
        };
        (1..=wavelets.n_levels()).map(level).collect::<Result<Vec<_>, Cancelled>>()
    };
    if response == Response::Channels {
        let layer = |c: usize| {
            Ok(ResponseLayer { channel: Some(c), levels: levels(&|j| wavelets.channel(j, c), &|_, _| 1.0)? })
        };
        return (0..wavelets.n_channels).map(layer).collect();
    }
    let scale = |j: usize, values: &[f64]| match response {
        Response::Normalized => population.mean(values),
        Response::Sigma => wavelets.sigma[j],
        Response::Literal | Response::Channels => 1.0,
    };
    Ok(vec![ResponseLayer { channel: None, levels: levels(&|j| wavelets.level_norms(j), &scale)? }])
}
