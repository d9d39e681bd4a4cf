//! What comes out for a stretch of vertices: changes of coordinates, bands, and the fields that are made of these.

use crate::plan::Params;

/// What comes out for some vertices, one after the other along the curve. Positions and bands are in units of the layout.
pub(crate) struct Outputs<'a> {
    /// What is added to the positions, where any gain is not 1.
    pub(crate) change: Option<&'a [[f64; 3]]>,
    /// The bands that are computed ([`Params::wanted`]).
    pub(crate) bands: Vec<&'a [[f64; 3]]>,
    lengths: Vec<&'a [[f64; 3]]>,
    vectors: Vec<&'a [[f64; 3]]>,
    has_map: bool,
    unit: f64,
}

impl<'a> Outputs<'a> {
    /// `outs` are the values of [`Params::series`]; `unit` is that of the layout.
    pub(crate) fn new(params: &Params, unit: f64, outs: Vec<&'a [[f64; 3]]>) -> Self {
        let mut bands = outs;
        let change = params.moves().then(|| bands.remove(0));
        let wanted = params.wanted();
        let of = |asked: &[usize]| {
            asked.iter().filter_map(|band| wanted.binary_search(band).ok()).map(|at| bands[at]).collect()
        };
        let (lengths, vectors) = (of(&params.magnitudes), of(&params.vectors));
        Self { change, lengths, vectors, has_map: params.saliency.is_some(), unit, bands }
    }

    /// Appends the fields of a vertex ([`Params::fields`]); the map, which comes last, is 0 as yet.
    pub(crate) fn push_fields(&self, vertex: usize, out: &mut Vec<u8>) {
        for band in &self.lengths {
            out.extend(((length(band[vertex]) * self.unit) as f32).to_le_bytes());
        }
        for band in &self.vectors {
            out.extend(band[vertex].iter().flat_map(|c| ((c * self.unit) as f32).to_le_bytes()));
        }
        if self.has_map {
            out.extend(0_f32.to_le_bytes());
        }
    }

    /// The lengths of all bands of each vertex, in units of the layout: in model units those of a tiny or huge shape are no 32-bit floats.
    pub(crate) fn lengths(&self) -> Vec<u8> {
        let n = self.bands.first().map_or(0, |band| band.len());
        let mut bytes = Vec::with_capacity(4 * n * self.bands.len());
        for vertex in 0..n {
            for band in &self.bands {
                bytes.extend((length(band[vertex]) as f32).to_le_bytes());
            }
        }
        bytes
    }
}

/// The length of a vector.
pub(crate) fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}
