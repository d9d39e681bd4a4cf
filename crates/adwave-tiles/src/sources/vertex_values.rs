//! Results of consecutive vertices: changes of positions, bands, and the fields that are derived from them.

use crate::params::Params;
use crate::vector::length;

/// Results of consecutive vertices, in units of the layout; every slice has one entry per vertex.
pub(crate) struct VertexValues<'a> {
    /// Change of the positions, if the job changes positions.
    pub(crate) change: Option<&'a [[f64; 3]]>,
    /// The computed bands ([`Params::computed_bands`]).
    pub(crate) bands: Vec<&'a [[f64; 3]]>,
    /// Bands whose norms are fields.
    norm_fields: Vec<&'a [[f64; 3]]>,
    /// Bands whose vectors are fields.
    vector_fields: Vec<&'a [[f64; 3]]>,
    has_saliency: bool,
    unit: f64,
}

impl<'a> VertexValues<'a> {
    /// Takes the values of [`Params::output_series`]; `unit` is the unit of the layout.
    pub(crate) fn new(params: &Params, unit: f64, series_values: Vec<&'a [[f64; 3]]>) -> Self {
        let mut bands = series_values;
        let change = params.changes_positions().then(|| bands.remove(0));
        let computed = params.computed_bands();
        let select = |requested: &[usize]| {
            let positions = requested.iter().filter_map(|band| computed.binary_search(band).ok());
            positions.map(|at| bands[at]).collect()
        };
        let (norm_fields, vector_fields) = (select(&params.magnitudes), select(&params.vectors));
        Self { change, norm_fields, vector_fields, has_saliency: params.saliency.is_some(), unit, bands }
    }

    /// Appends the fields of a vertex ([`Params::field_names`]) as 32-bit floats in model units. The saliency, which
    /// comes last, is 0 until the maps stage.
    pub(crate) fn push_fields(&self, vertex: usize, out: &mut Vec<u8>) {
        for band in &self.norm_fields {
            out.extend(((length(band[vertex]) * self.unit) as f32).to_le_bytes());
        }
        for band in &self.vector_fields {
            out.extend(band[vertex].iter().flat_map(|c| ((c * self.unit) as f32).to_le_bytes()));
        }
        if self.has_saliency {
            out.extend(0_f32.to_le_bytes());
        }
    }

    /// Appends the fields of a record that takes no part, all with the same `value`.
    pub(crate) fn push_outsider_fields(&self, value: f32, out: &mut Vec<u8>) {
        let n = self.norm_fields.len() + 3 * self.vector_fields.len() + usize::from(self.has_saliency);
        out.extend((0..n).flat_map(|_| value.to_le_bytes()));
    }

    /// Norms of all bands as 32-bit floats, a row per vertex. They are in units of the layout, since model units of a
    /// tiny or huge shape may not fit into 32-bit floats.
    pub(crate) fn encode_norms(&self) -> Vec<u8> {
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
