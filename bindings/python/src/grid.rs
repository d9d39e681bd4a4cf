//! Grids: images and volumes, prepared for bands.

use crate::call::run;
use crate::error::{Stage, stage};
use adwave::Decomposer;
use adwave::grid::Grid;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

/// Grid as the Python package passes it.
#[derive(FromPyObject)]
pub(crate) struct GridOptions<'py> {
    sizes: Vec<usize>,
    spacing: Vec<f64>,
    periodic: Vec<bool>,
    /// Flags of the places with data, in the order of the values; all without them.
    kept: Option<PyReadonlyArray1<'py, bool>>,
}

/// Heat on a grid.
pub(crate) fn grid_decomposer(py: Python<'_>, options: GridOptions<'_>) -> PyResult<Decomposer> {
    let GridOptions { sizes, spacing, periodic, kept } = options;
    let kept = kept.as_ref().map(|kept| Ok::<_, PyErr>(kept.as_slice()?.to_vec())).transpose()?;
    run(py, usize::MAX, None, move |_| -> Stage<Decomposer> {
        let mut grid = stage(stage(Grid::new(&sizes, &spacing))?.with_periodic(&periodic))?;
        if let Some(kept) = kept {
            grid = stage(grid.with_kept(kept))?;
        }
        let heat = grid.heat();
        stage(Decomposer::from_domain(grid, heat))
    })
}
