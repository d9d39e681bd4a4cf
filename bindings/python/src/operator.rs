//! The diffusion operator and the functions of all vertices as sparse matrices.

use crate::arrays;
use crate::call::run;
use crate::error::{self, StageError, stage, value_error};
use crate::prepared::Prepared;
use adwave::bands::Schedule;
use adwave::basis::{BasisParams, CompressedRows, Value, basis};
use adwave::shape::VertexMap;
use numpy::Element;
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(diffusion_matrix, module)?)?;
    module.add_function(wrap_pyfunction!(basis_matrices, module)?)
}

/// Values, column indices and offsets: the arguments of `scipy.sparse.csr_array`.
type Csr<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>);

fn csr<V: Element + Value>(py: Python<'_>, rows: CompressedRows<V>) -> PyResult<Csr<'_>> {
    let (indptr, indices, data) = rows.into_scipy().map_err(|e| value_error(e.to_string()))?;
    let indices = arrays::vector(py, indices).into_any();
    Ok((arrays::vector(py, data).into_any(), indices, arrays::vector(py, indptr).into_any()))
}

/// Vertex of the shape of each welded vertex; `None` if some vertices were welded.
pub(crate) fn shape_order(map: &VertexMap) -> Option<Vec<u32>> {
    if map.n_welded() < map.n_vertices() {
        return None;
    }
    let mut vertex_of = vec![0_u32; map.n_welded()];
    for (vertex, &x) in map.as_slice().iter().enumerate() {
        vertex_of[x as usize] = vertex as u32;
    }
    Some(vertex_of)
}

/// Φ₁ in the order of the shape, or over the welded vertices if some were welded.
#[pyfunction]
fn diffusion_matrix<'py>(py: Python<'py>, prepared: &Bound<'py, Prepared>) -> PyResult<Csr<'py>> {
    let decomposer = &prepared.get().decomposer;
    let rows = run(py, decomposer.n_vertices(), None, |p| {
        let rows = stage(stage(decomposer.rows("a matrix of the operator"))?.to_rows(p))?;
        Ok::<_, StageError>(match shape_order(decomposer.vertex_map()) {
            Some(order) => rows.permute(&order),
            None => rows,
        })
    })?;
    csr(py, rows)
}

/// Matrices Φ_j and Ψ_j of all levels.
#[pyfunction]
#[pyo3(signature = (prepared, n_levels, drop_tolerance, max_bytes, progress=None))]
fn basis_matrices<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    n_levels: usize,
    drop_tolerance: Option<f64>,
    max_bytes: Option<u64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<Csr<'py>>, Vec<Csr<'py>>)> {
    let decomposer = &prepared.get().decomposer;
    let schedule = Schedule::dyadic(n_levels).map_err(|e| error::to_exception(&e))?;
    let mut params = BasisParams::new(schedule);
    if let Some(tolerance) = drop_tolerance {
        params = params.with_drop_tolerance(tolerance);
    }
    if let Some(bytes) = max_bytes {
        params = params.with_memory_limit(bytes);
    }
    let map = decomposer.vertex_map();
    let found = run(py, usize::MAX, progress.as_ref(), |p| {
        let found = stage(basis(stage(decomposer.rows("a basis"))?, &params, p))?;
        if map.n_welded() < map.n_vertices() { Ok(found) } else { stage(found.to_shape_order(map)) }
    })?;
    let wavelets = (1..=n_levels).map(|j| csr(py, found.wavelet(j))).collect::<PyResult<_>>()?;
    let scaling = found.scaling.into_iter().map(|rows| csr(py, rows)).collect::<PyResult<_>>()?;
    Ok((scaling, wavelets))
}
