//! Deformation by handles, and detail on other bases.

use crate::arrays;
use crate::call::run;
use crate::error::{self, Stage, stage, value_error};
use crate::options::length;
use crate::prepared::{Prepared, schedule};
use adwave::Progress;
use adwave_deform::{
    DeformInfo, DeformParams, DeformRegions, Deformer, HandleMotion, Transplant, default_base,
    morph as blend, transfer as carry, transplant as clone, with_base as rebase,
};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<DeformerData>()?;
    module.add_function(wrap_pyfunction!(base_steps, module)?)?;
    module.add_function(wrap_pyfunction!(with_base, module)?)?;
    module.add_function(wrap_pyfunction!(clone_detail, module)?)?;
    module.add_function(wrap_pyfunction!(transfer, module)?)?;
    module.add_function(wrap_pyfunction!(morph, module)?)
}

/// Regions of a deformation and its stiffness.
#[derive(FromPyObject)]
struct DeformOptions<'py> {
    fixed: Vec<u32>,
    handles: Vec<Vec<u32>>,
    stiffness: Option<Bound<'py, PyAny>>,
    keep_lengths: f64,
}

/// A shape bound to handles.
#[pyclass(frozen, module = "adwave._native")]
struct DeformerData {
    deformer: Mutex<Deformer>,
}

impl DeformerData {
    /// The deformer, unless another thread uses it.
    fn with<T>(&self, work: impl FnOnce(&mut Deformer) -> PyResult<T>) -> PyResult<T> {
        // Waiting would hold the interpreter, which the other thread needs to finish.
        match self.deformer.try_lock() {
            Ok(mut deformer) => work(&mut deformer),
            Err(_) => {
                Err(value_error("the deformer is in use by another thread; wait for its call to return"))
            }
        }
    }
}

fn info_dict<'py>(py: Python<'py>, info: &DeformInfo) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("steps", info.n_steps)?;
    found.set_item("products", info.n_products)?;
    found.set_item("length_steps", info.n_length_steps)?;
    found.set_item("energy", info.energy_after)?;
    found.set_item("converged", info.is_converged)?;
    Ok(found)
}

#[pymethods]
impl DeformerData {
    #[new]
    #[pyo3(signature = (prepared, steps, options, progress=None))]
    fn new(
        py: Python<'_>,
        prepared: &Bound<'_, Prepared>,
        steps: Vec<f64>,
        options: DeformOptions<'_>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let (decomposer, schedule) = (&prepared.get().decomposer, schedule(&steps)?);
        let given = options.stiffness.as_ref().map(length).transpose()?;
        let stiffness = given.map(|length| length.to_model_units(decomposer.extent()));
        let regions = DeformRegions { fixed: options.fixed, handles: options.handles };
        let params =
            DeformParams::default().with_stiffness(stiffness).with_keep_lengths(options.keep_lengths);
        let n = decomposer.n_vertices();
        let deformer =
            run(py, n, progress.as_ref(), |p| Deformer::bind(decomposer, &schedule, &regions, &params, p))?;
        Ok(Self { deformer: Mutex::new(deformer) })
    }

    /// Sets the motion of a handle, counted from 0, as a 4 × 4 matrix.
    fn set(&self, handle: usize, matrix: [[f64; 4]; 4]) -> PyResult<()> {
        let motion = HandleMotion::from_matrix(&matrix).map_err(|e| error::to_exception(&e))?;
        self.with(|deformer| deformer.set(handle + 1, motion).map_err(|e| error::to_exception(&e)))
    }

    /// Sets the motion of a handle, counted from 0, to a blend of 4 × 4 matrices.
    fn set_blend(&self, handle: usize, matrices: Vec<[[f64; 4]; 4]>, shares: Vec<f64>) -> PyResult<()> {
        let motions: Result<Vec<_>, _> = matrices.iter().map(HandleMotion::from_matrix).collect();
        let motions = motions.map_err(|e| error::to_exception(&e))?;
        self.with(|deformer| {
            deformer.set_blend(handle + 1, &motions, &shares).map_err(|e| error::to_exception(&e))
        })
    }

    /// Places where triangles of the deformed shape cross and did not before: rows of a vertex, a point and a number of
    /// pairs.
    fn crossings(&self, py: Python<'_>) -> PyResult<Vec<(u32, [f64; 3], usize)>> {
        let found = self.with(|deformer| run(py, usize::MAX, None, |p| deformer.new_crossings(p)))?;
        Ok(found.places.iter().map(|place| (place.vertex, place.point, place.n_pairs)).collect())
    }

    /// One step toward the handles.
    fn step<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let info = self.with(|deformer| run(py, 0, None, |p| deformer.step(p)))?;
        info_dict(py, &info)
    }

    /// Steps until the shape has come to rest.
    #[pyo3(signature = (progress=None))]
    fn solve<'py>(&self, py: Python<'py>, progress: Option<Py<PyAny>>) -> PyResult<Bound<'py, PyDict>> {
        let info = self.with(|deformer| run(py, 0, progress.as_ref(), |p| deformer.solve(p)))?;
        info_dict(py, &info)
    }

    /// Positions of the deformed shape.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let points =
            self.with(|deformer| run(py, usize::MAX, None, |_: Progress<'_>| Stage::Ok(deformer.points())))?;
        Ok(arrays::point_rows(py, points)?.into_any())
    }

    /// Rotations of the frames as quaternions.
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let turns = self
            .with(|deformer| run(py, usize::MAX, None, |_: Progress<'_>| Stage::Ok(deformer.rotations())))?;
        Ok(arrays::matrix(py, turns.into_flattened(), 4)?.into_any())
    }

    /// Facts about the binding.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let info = self.with(|deformer| Ok(deformer.info()))?;
        let found = PyDict::new(py);
        found.set_item("nodes", info.n_nodes)?;
        found.set_item("rms_width", info.sigma)?;
        found.set_item("stiffness", info.stiffness)?;
        found.set_item("following_parts", info.n_following_parts)?;
        found.set_item("following_vertices", info.n_following_vertices)?;
        Ok(found)
    }
}

/// Steps of the levels whose last is the usual base.
#[pyfunction]
fn base_steps(prepared: &Bound<'_, Prepared>) -> Vec<f64> {
    default_base(&prepared.get().decomposer).steps().to_vec()
}

/// The shape on an edited base.
#[pyfunction]
#[pyo3(signature = (prepared, steps, base, progress=None))]
fn with_base<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    steps: Vec<f64>,
    base: PyReadonlyArray2<'py, f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (decomposer, schedule) = (&prepared.get().decomposer, schedule(&steps)?);
    let base = arrays::points(&base, "points")?;
    let n = decomposer.n_vertices();
    let points = run(py, n, progress.as_ref(), |p| rebase(decomposer, &schedule, base, p))?;
    Ok(arrays::point_rows(py, points)?.into_any())
}

/// Place, size and turn of a clone.
#[derive(FromPyObject)]
struct CloneOptions<'py> {
    source: u32,
    target: u32,
    radius: Bound<'py, PyAny>,
    angle: f64,
    first_level: usize,
    last_level: usize,
}

/// Detail cloned from one place to another: the points, the changed vertices, those without a source, and the
/// distortion.
#[pyfunction]
#[pyo3(signature = (prepared, steps, options, progress=None))]
fn clone_detail<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    steps: Vec<f64>,
    options: CloneOptions<'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, usize, usize, f64)> {
    let (decomposer, schedule) = (&prepared.get().decomposer, schedule(&steps)?);
    let wanted = Transplant {
        source: options.source,
        target: options.target,
        radius: length(&options.radius)?.to_model_units(decomposer.extent()),
        angle: options.angle,
        levels: options.first_level..=options.last_level,
    };
    let n = decomposer.n_vertices();
    let found = run(py, n, progress.as_ref(), |p| clone(decomposer, &schedule, &wanted, p))?;
    let points = arrays::point_rows(py, found.points)?.into_any();
    Ok((points, found.n_changed, found.n_without_source, found.distortion))
}

/// Detail of the first shape on the second: the points, the width, the largest gap and the number of far vertices.
#[pyfunction]
#[pyo3(signature = (from, onto, width, weights, progress=None))]
fn transfer<'py>(
    py: Python<'py>,
    from: &Bound<'py, Prepared>,
    onto: &Bound<'py, Prepared>,
    width: Option<Bound<'py, PyAny>>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, f64, f64, usize)> {
    let (a, b) = (&from.get().decomposer, &onto.get().decomposer);
    let width = width.as_ref().map(length).transpose()?.map(|width| width.to_model_units(b.extent()));
    let weights = weights.as_ref().map(|weights| weights.as_slice()).transpose()?;
    let found = run(py, usize::MAX, progress.as_ref(), |p| carry(a, b, width, weights, p))?;
    let points = arrays::point_rows(py, found.points)?.into_any();
    Ok((points, found.width, found.largest_gap, found.n_far))
}

/// Two shapes blended by bands.
#[pyfunction]
#[pyo3(signature = (first, second, steps, shares, progress=None))]
fn morph<'py>(
    py: Python<'py>,
    first: &Bound<'py, Prepared>,
    second: &Bound<'py, Prepared>,
    steps: Vec<f64>,
    shares: Vec<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (a, b) = (&first.get().decomposer, &second.get().decomposer);
    let schedule = schedule(&steps)?;
    let points = run(py, usize::MAX, progress.as_ref(), |p| stage(blend(a, b, &schedule, &shares, p)))?;
    Ok(arrays::point_rows(py, points)?.into_any())
}
