//! Bands along time.

use crate::arrays;
use crate::call::run;
use crate::options::parse_name;
use adwave::Progress;
use adwave::time::{TimeAxis, TimeError};
use numpy::{PyArray2, PyArray3, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(time_bands, module)?)?;
    module.add_function(wrap_pyfunction!(time_delay, module)?)?;
    module.add_function(wrap_pyfunction!(time_filter, module)?)
}

/// Frames and widths as the Python package passes them.
#[derive(FromPyObject)]
pub(crate) struct TimeOptions {
    /// Time from frame to frame, or the times of all frames.
    step: Option<f64>,
    times: Option<Vec<f64>>,
    ends: String,
    widths: Vec<f64>,
}

impl TimeOptions {
    pub(crate) fn axis(&self, n_frames: usize) -> PyResult<TimeAxis> {
        let ends = parse_name("ends", &self.ends)?;
        let axis = match (&self.times, self.step) {
            (Some(times), _) => TimeAxis::from_times(times),
            (None, step) => TimeAxis::new(n_frames, step.unwrap_or(1.0)),
        };
        axis.and_then(|axis| axis.with_ends(ends)).map_err(|e| crate::error::to_exception(&e))
    }
}

/// The bands of `values`, places × frames, and the rest.
#[pyfunction]
#[pyo3(signature = (values, options, progress=None))]
fn time_bands<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    options: TimeOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let [n_places, n_frames] = [values.shape()[0], values.shape()[1]];
    let (axis, values) = (options.axis(n_frames)?, arrays::rows(&values, "values")?);
    let found = run(py, values.len(), progress.as_ref(), |progress: Progress<'_>| {
        let bands = axis.bands(values, 1, &options.widths, progress)?;
        Ok::<_, TimeError>(bands.concat())
    })?;
    arrays::levels(py, found, n_places, n_frames)
}

/// Time by which values lag behind.
#[pyfunction]
fn time_delay(n_frames: usize, options: TimeOptions) -> PyResult<f64> {
    Ok(options.axis(n_frames)?.delay(&options.widths))
}

/// `values`, places × frames, with their bands multiplied by gains.
#[pyfunction]
#[pyo3(signature = (values, options, gains, progress=None))]
fn time_filter<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    options: TimeOptions,
    gains: Vec<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let n_frames = values.shape()[1];
    let (axis, values) = (options.axis(n_frames)?, arrays::rows(&values, "values")?);
    let found = run(py, values.len(), progress.as_ref(), |progress: Progress<'_>| {
        let mut found = values.to_vec();
        axis.filter(&mut found, 1, &options.widths, &gains, progress)?;
        Ok::<_, TimeError>(found)
    })?;
    arrays::matrix(py, found, n_frames)
}
