//! The responses R(j) of a signal's bands.

use super::Response;
use crate::band_norms::BandNorms;
use crate::bands::Bands;
use rayon::prelude::*;

/// R at the vertices of the analysis, for each level; NaN at what is left out of the walk.
pub(super) struct Layer {
    /// The channel, where each is a layer by itself.
    pub(super) channel: Option<usize>,
    /// R(j) at index j − 1.
    pub(super) levels: Vec<Vec<f64>>,
}

/// All layers of a response.
pub(super) fn layers(reader: &BandNorms<'_>, bands: &Bands, response: Response) -> Vec<Layer> {
    let d = bands.n_channels;
    if response == Response::Channels {
        return (0..d)
            .map(|c| Layer {
                channel: Some(c),
                levels: bands.wavelet.iter().map(|band| reader.channel(band, d, c)).collect(),
            })
            .collect();
    }
    let level = |j: usize| {
        let band = &bands.wavelet[j - 1];
        let mut r = if d == 1 { reader.channel(band, 1, 0) } else { reader.norms(band, d) };
        let scale = match response {
            Response::Normalised => reader.mean(&r),
            Response::Sigma => bands.sigma[j],
            Response::Literal | Response::Channels => 1.0,
        };
        // A level without any response stays 0.
        if scale > 0.0 && scale != 1.0 {
            r.par_iter_mut().with_min_len(1 << 13).for_each(|r| *r /= scale);
        }
        r
    };
    vec![Layer { channel: None, levels: (1..=bands.n_levels()).map(level).collect() }]
}
