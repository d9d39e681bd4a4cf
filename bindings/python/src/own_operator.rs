//! Operators that a Python function computes, without stored rows.

use crate::arrays;
use crate::call::{keep_raised, run};
use crate::error::value_error;
use crate::operator::shape_order;
use crate::prepared::Prepared;
use adwave::operator::{DiffusionError, Operator, RowWeights};
use adwave::{Cancelled, Progress};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use std::fmt;
use std::sync::Arc;

/// Operator as the Python package passes it.
#[derive(FromPyObject)]
pub(crate) struct OwnOperatorOptions<'py> {
    /// Function of an n × d array x that returns (I − Φ₁)x, C-contiguous, of 64-bit floats.
    difference: Py<PyAny>,
    /// Function of n flags that returns the `difference` of the operator without these vertices.
    masked: Option<Py<PyAny>>,
    reversible: bool,
    step_length: f64,
    /// Stationary distribution in the order of the shape, > 0; uniform without it.
    weights: Option<PyReadonlyArray1<'py, f64>>,
}

/// An operator that calls a Python function for each product.
struct OwnOperator {
    difference: Py<PyAny>,
    masked: Option<Py<PyAny>>,
    is_reversible: bool,
    step_length: f64,
    weights: Option<Vec<f64>>,
    /// Vertex of the shape of each row.
    vertex_of_row: Arc<[u32]>,
}

impl fmt::Debug for OwnOperator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OwnOperator").field("n_rows", &self.vertex_of_row.len()).finish_non_exhaustive()
    }
}

impl OwnOperator {
    /// Keeps an exception of the function for the call that waits for it, which is stopped.
    fn call<T>(call: impl FnOnce(Python<'_>) -> PyResult<T>) -> Result<T, Cancelled> {
        Python::attach(|py| call(py).map_err(keep_raised))
    }
}

impl Operator for OwnOperator {
    fn n_rows(&self) -> usize {
        self.vertex_of_row.len()
    }

    fn is_reversible(&self) -> bool {
        self.is_reversible
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        progress.check()?;
        let place = |row: usize| self.vertex_of_row[row] as usize * n_channels;
        let mut given = vec![0.0; x.len()];
        for (row, x) in x.chunks_exact(n_channels).enumerate() {
            given[place(row)..][..n_channels].copy_from_slice(x);
        }
        Self::call(|py| {
            let given = arrays::matrix(py, given, n_channels)?;
            let found: PyReadonlyArray2<'_, f64> = self.difference.call1(py, (given,))?.extract(py)?;
            let found = arrays::rows(&found, "the result of the operator")?;
            for (row, out) in out.chunks_exact_mut(n_channels).enumerate() {
                out.copy_from_slice(&found[place(row)..][..n_channels]);
            }
            Ok(())
        })
    }

    fn weights(&self) -> RowWeights<'_> {
        self.weights.as_deref().map_or(RowWeights::Uniform, RowWeights::Each)
    }

    fn step_length(&self) -> f64 {
        self.step_length
    }

    fn masked(
        &self,
        masked: &[bool],
        _: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        _: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        let Some(without) = &self.masked else { return Ok(None) };
        let mut flags = vec![false; masked.len()];
        for (&vertex, &is_masked) in self.vertex_of_row.iter().zip(masked) {
            flags[vertex as usize] = is_masked;
        }
        let (difference, again) = Self::call(|py| {
            let difference = without.call1(py, (arrays::vector(py, flags),))?;
            Ok((difference, without.clone_ref(py)))
        })?;
        Ok(Some(Arc::new(Self {
            difference,
            masked: Some(again),
            weights: self.weights.clone(),
            vertex_of_row: Arc::clone(&self.vertex_of_row),
            ..*self
        })))
    }
}

impl Prepared {
    /// The shape with an operator that a Python function computes.
    pub(crate) fn with_own_operator(&self, py: Python<'_>, own: OwnOperatorOptions<'_>) -> PyResult<Self> {
        let map = self.decomposer.vertex_map();
        let Some(vertex_of_row) = shape_order(map) else {
            return Err(value_error(format!(
                "an operator has a row for each vertex, but {} of {} vertices are welded to others at the same place; \
                 leave them out of the shape",
                map.n_vertices() - map.n_welded(),
                map.n_vertices()
            )));
        };
        let weights = own.weights.as_ref().map(|weights| {
            let given = weights.as_slice()?;
            let sum: f64 = given.iter().sum();
            if given.len() != vertex_of_row.len() || !given.iter().all(|w| *w > 0.0 && (w / sum).is_normal())
            {
                return Err(value_error(format!(
                    "weights must be one positive number for each of {} vertices",
                    vertex_of_row.len()
                )));
            }
            Ok(vertex_of_row.iter().map(|&vertex| given[vertex as usize] / sum).collect())
        });
        let operator = OwnOperator {
            difference: own.difference,
            masked: own.masked,
            is_reversible: own.reversible,
            step_length: own.step_length,
            weights: weights.transpose()?,
            vertex_of_row: vertex_of_row.into(),
        };
        let decomposer = run(py, usize::MAX, None, |_| self.decomposer.with_operator(operator))?;
        Ok(Self { decomposer, normals: None, shape: self.shape.clone_ref(py) })
    }
}
