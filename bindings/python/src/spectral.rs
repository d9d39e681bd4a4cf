//! Functions of the Laplacian.

use crate::arrays;
use crate::call::run;
use crate::error::value_error;
use crate::prepared::Prepared;
use adwave::SpectralSeries;
use adwave::bands::FixedSeries;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(spectral_range, module)?)?;
    module.add_function(wrap_pyfunction!(apply_spectral, module)?)
}

/// Largest eigenvalue that the Laplacian can have.
#[pyfunction]
fn spectral_range(prepared: &Bound<'_, Prepared>) -> f64 {
    prepared.get().decomposer.spectral_range()
}

/// Functions of the Laplacian of a signal, one after the other: (functions · n) × channels. Each has its gains at 0 and
/// at the largest eigenvalue, and the coefficients of its polynomial.
#[pyfunction]
#[pyo3(signature = (prepared, signal, functions, progress=None))]
fn apply_spectral<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    signal: Option<PyReadonlyArray2<'py, f64>>,
    functions: Vec<(f64, f64, PyReadonlyArray1<'py, f64>)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let own = prepared.get();
    let signal = own.signal(signal.as_ref())?;
    let mut series = Vec::with_capacity(functions.len());
    for (at_zero, at_most, coefficients) in &functions {
        let coefficients = coefficients.as_slice()?.to_vec();
        let are_finite =
            at_zero.is_finite() && at_most.is_finite() && coefficients.iter().all(|a| a.is_finite());
        if coefficients.is_empty() || !are_finite {
            return Err(value_error("kernel: its gains must be finite"));
        }
        let (at_zero, at_most) = (*at_zero, *at_most);
        series.push(SpectralSeries { at_zero, at_most, series: FixedSeries::polynomial(coefficients) });
    }
    let decomposer = &own.decomposer;
    let found = run(py, decomposer.n_vertices(), progress.as_ref(), |p| {
        decomposer.apply_spectral(signal.values, signal.n_channels, &series, p)
    })?;
    Ok(arrays::matrix(py, found, signal.n_channels)?.into_any())
}
