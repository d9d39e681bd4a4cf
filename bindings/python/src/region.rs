//! Regions from their text form.

use crate::call::run;
use crate::error::value_error;
use crate::shape::ShapeData;
use adwave::Decomposer;
use adwave::region::{RegionWeights, parse_region};
use pyo3::prelude::*;

/// Weights of a region in its text form.
pub(crate) fn region_weights(
    py: Python<'_>,
    decomposer: &Decomposer,
    shape: &ShapeData,
    region: &str,
) -> PyResult<RegionWeights> {
    let region = parse_region(region).map_err(|e| value_error(format!("region: {e}")))?;
    let names = shape.field_names();
    run(py, decomposer.n_vertices(), None, |progress| {
        let lookup = |name: &str| shape.region_field(decomposer, name);
        region.weights(decomposer.metric(), &lookup, &names, progress)
    })
}
