//! Vectors, lines and crosses in tangent planes, and symmetric tensors.

use crate::arrays;
use crate::call::run;
use crate::error::{self, value_error};
use crate::prepared::Prepared;
use adwave::Progress;
use adwave::directions::{Directions, DirectionsError, Symmetry, exp_tensors, log_tensors};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<DirectionsData>()?;
    module.add_function(wrap_pyfunction!(tensor_logarithms, module)?)?;
    module.add_function(wrap_pyfunction!(tensor_exponentials, module)?)
}

/// A surface prepared for directions of one kind.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct DirectionsData {
    directions: Directions,
}

/// Complex numbers (n × 2), parts along the normals and their share of the squares.
type Split<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, f64);

/// Traces, lines (n × 2) and the share of the squares outside the planes.
type SplitTensors<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, f64);

/// Numbers of triangles, their centers (n × 3) and indices.
type Singularities<'py> = (Vec<usize>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl DirectionsData {
    #[new]
    #[pyo3(signature = (prepared, order, progress=None))]
    fn new(
        py: Python<'_>,
        prepared: &Bound<'_, Prepared>,
        order: u32,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let symmetry = Symmetry::from_order(order).ok_or_else(|| {
            value_error(format!("symmetry must be 1 (vectors), 2 (lines) or 4 (crosses), got {order}"))
        })?;
        let decomposer = &prepared.get().decomposer;
        let directions = run(py, usize::MAX, progress.as_ref(), |p: Progress<'_>| {
            Directions::new(decomposer, symmetry, p)
        })?;
        Ok(Self { directions })
    }

    /// The surface with the operator of directions.
    fn to_prepared(&self, py: Python<'_>, scalars: &Bound<'_, Prepared>) -> Prepared {
        let shape = scalars.get().shape.clone_ref(py);
        Prepared { decomposer: self.directions.decomposer().clone(), normals: None, shape }
    }

    /// First and second directions of the tangent planes, n × 6.
    fn planes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let n = self.directions.decomposer().n_vertices();
        let planes = (0..n).flat_map(|vertex| {
            let plane = self.directions.plane(vertex);
            plane.first.into_iter().chain(plane.second)
        });
        arrays::matrix(py, planes.collect(), 6)
    }

    fn split<'py>(&self, py: Python<'py>, vectors: PyReadonlyArray2<'py, f64>) -> PyResult<Split<'py>> {
        let vectors = arrays::rows(&vectors, "vectors")?;
        let split = self.directions.split(vectors).map_err(|e| error::to_exception(&e))?;
        Ok((arrays::matrix(py, split.channels, 2)?, arrays::vector(py, split.normal), split.normal_share))
    }

    fn join<'py>(
        &self,
        py: Python<'py>,
        channels: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let channels = arrays::rows(&channels, "directions")?;
        let vectors = self.directions.join(channels).map_err(|e| error::to_exception(&e))?;
        arrays::matrix(py, vectors, 3)
    }

    /// Traces and lines of tensors (n × 6) and the share of the squares outside the planes.
    fn split_tensors<'py>(
        &self,
        py: Python<'py>,
        tensors: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<SplitTensors<'py>> {
        let tensors = arrays::rows(&tensors, "tensors")?;
        let split = self.directions.split_tensors(tensors).map_err(|e| error::to_exception(&e))?;
        Ok((arrays::vector(py, split.trace), arrays::matrix(py, split.channels, 2)?, split.normal_share))
    }

    fn join_tensors<'py>(
        &self,
        py: Python<'py>,
        trace: Vec<f64>,
        channels: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let channels = arrays::rows(&channels, "lines")?;
        let tensors = self.directions.join_tensors(&trace, channels).map_err(|e| error::to_exception(&e))?;
        arrays::matrix(py, tensors, 6)
    }

    /// Numbers of triangles, their centers (n × 3), and the indices of their singularities.
    #[pyo3(signature = (channels, progress=None))]
    fn singularities<'py>(
        &self,
        py: Python<'py>,
        channels: PyReadonlyArray2<'py, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Singularities<'py>> {
        let channels = arrays::rows(&channels, "directions")?;
        let found = run(py, usize::MAX, progress.as_ref(), |p: Progress<'_>| {
            self.directions.singularities(channels, p)
        })?;
        let centers = found.iter().map(|f| f.center).collect();
        Ok((
            found.iter().map(|f| f.triangle).collect(),
            arrays::point_rows(py, centers)?,
            arrays::vector(py, found.iter().map(|f| f.index).collect()),
        ))
    }
}

/// Matrix logarithms of symmetric tensors (n × 6), NaN where one is not positive definite, and the number of these.
#[pyfunction]
fn tensor_logarithms<'py>(
    py: Python<'py>,
    tensors: PyReadonlyArray2<'py, f64>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, usize)> {
    let tensors = arrays::rows(&tensors, "tensors")?;
    let found = run(py, tensors.len(), None, |p: Progress<'_>| log_tensors(tensors, p))?;
    Ok((arrays::matrix(py, found.logarithms, 6)?, found.n_not_positive))
}

/// Matrix exponentials of symmetric tensors (n × 6).
#[pyfunction]
fn tensor_exponentials<'py>(
    py: Python<'py>,
    logarithms: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let logarithms = arrays::rows(&logarithms, "logarithms")?;
    let tensors = run(py, logarithms.len(), None, |p: Progress<'_>| {
        exp_tensors(logarithms, p).map_err(DirectionsError::from)
    })?;
    arrays::matrix(py, tensors, 6)
}
