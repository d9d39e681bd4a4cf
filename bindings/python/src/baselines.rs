//! Other methods for comparison: harmonics, signatures, Lee's saliency, Taubin smoothing, critical points, differential
//! coordinates.

use crate::arrays;
use crate::call::run;
use crate::error::{Stage, stage};
use crate::shape::ShapeData;
use adwave::Progress;
use adwave_baselines::differential::{Anchor, Differential, Reconstruction, Weights};
use adwave_baselines::feature_map::{CriticalKind, FeatureLevel, feature_map as critical_levels};
use adwave_baselines::harmonics::Harmonics;
use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
use adwave_baselines::lee::lee_saliency;
use adwave_baselines::linalg::EigenParams;
use adwave_baselines::signature::{heat_kernel_signature, heat_times, wave_kernel_signature};
use adwave_baselines::taubin::{LambdaMu, lambda_mu};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(harmonics, module)?)?;
    module.add_function(wrap_pyfunction!(signature, module)?)?;
    module.add_function(wrap_pyfunction!(lee, module)?)?;
    module.add_function(wrap_pyfunction!(taubin, module)?)?;
    module.add_function(wrap_pyfunction!(feature_map, module)?)?;
    module.add_function(wrap_pyfunction!(differential_coordinates, module)?)?;
    module.add_function(wrap_pyfunction!(from_differential, module)?)
}

/// Size that makes a call use the pool for shapes of any size.
const ALWAYS_ON_POOL: usize = usize::MAX;

fn compute_harmonics(
    own: &adwave::shape::Shape,
    k: usize,
    p: Progress<'_>,
) -> Result<Harmonics, adwave_baselines::harmonics::HarmonicsError> {
    let laplacian = LaplacianMatrices::new(own, &LaplacianParams::default())?;
    Harmonics::new(&laplacian, k, &EigenParams::default(), p)
}

/// Eigenvalues λ_1 … λ_k, and the eigenfunctions as columns at the vertices of the shape.
#[pyfunction]
#[pyo3(signature = (shape, k, progress=None))]
fn harmonics<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    k: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let own = shape.get().shape(py)?;
    let (values, functions) = run(py, ALWAYS_ON_POOL, progress.as_ref(), |p| {
        let found = compute_harmonics(own, k, p)?;
        let n = own.n_vertices();
        let mut columns = vec![0.0; n * found.len()];
        for f in 0..found.len() {
            for (row, value) in columns.chunks_exact_mut(found.len()).zip(found.scatter(found.function(f), 1))
            {
                row[f] = value;
            }
        }
        Ok::<_, adwave_baselines::harmonics::HarmonicsError>((found.values, columns))
    })?;
    let n_functions = values.len();
    let functions = arrays::matrix(py, functions, n_functions)?;
    Ok((arrays::vector(py, values).into_any(), functions.into_any()))
}

/// Heat or wave kernel signature: the scales, and n × scales values.
#[pyfunction]
#[pyo3(signature = (shape, kind, k, n_scales, progress=None))]
fn signature<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    kind: &str,
    k: usize,
    n_scales: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let is_heat = crate::options::word("kind", kind, &[("heat", true), ("wave", false)])?;
    let own = shape.get().shape(py)?;
    let signature = run(py, ALWAYS_ON_POOL, progress.as_ref(), |p| {
        let found = compute_harmonics(own, k, p)?;
        Ok::<_, adwave_baselines::harmonics::HarmonicsError>(if is_heat {
            heat_kernel_signature(&found, &heat_times(&found, n_scales))
        } else {
            wave_kernel_signature(&found, n_scales)
        })
    })?;
    let n_columns = signature.scales.len().max(1);
    let values = arrays::matrix(py, signature.values, n_columns)?;
    Ok((arrays::vector(py, signature.scales).into_any(), values.into_any()))
}

/// Lee's saliency, and the mean curvature that it is computed from.
#[pyfunction]
#[pyo3(signature = (shape, progress=None))]
fn lee<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let own = shape.get().shape(py)?;
    let found = run(py, ALWAYS_ON_POOL, progress.as_ref(), |p| lee_saliency(own, p))?;
    Ok((arrays::vector(py, found.saliency).into_any(), arrays::vector(py, found.curvature).into_any()))
}

/// Options of Taubin's smoothing.
#[derive(FromPyObject)]
struct TaubinOptions {
    lam: f64,
    mu: f64,
    iterations: usize,
    weights: String,
}

/// Taubin's λ|μ smoothing.
#[pyfunction]
#[pyo3(signature = (shape, signal, options))]
fn taubin<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    signal: PyReadonlyArray2<'py, f64>,
    options: TaubinOptions,
) -> PyResult<Bound<'py, PyAny>> {
    let weights = parse_weights(&options.weights)?;
    let own = shape.get().shape(py)?;
    let n_channels = signal.shape()[1];
    let values = arrays::rows(&signal, "signal")?;
    let smoothed = run(py, ALWAYS_ON_POOL, None, |_| -> Stage<Vec<f64>> {
        let k = stage(Differential::new(own, weights))?;
        stage(lambda_mu(
            &k,
            values,
            n_channels,
            LambdaMu { lambda: options.lam, mu: options.mu },
            options.iterations,
        ))
    })?;
    Ok(arrays::matrix(py, smoothed, n_channels)?.into_any())
}

/// Time, smoothed function, critical points (vertex; kind: 1 maximum, −1 minimum, 0 saddle; multiplicity; value), and
/// the sum of the indices.
type CriticalLevel<'py> = (f64, Bound<'py, PyAny>, Vec<(usize, i8, usize, f64)>, i64);

/// Critical points of a function at several scales.
#[pyfunction]
#[pyo3(signature = (shape, signal, times, progress=None))]
fn feature_map<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    signal: Vec<f64>,
    times: Vec<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<CriticalLevel<'py>>> {
    let own = shape.get().shape(py)?;
    let found = run(py, ALWAYS_ON_POOL, progress.as_ref(), |p| critical_levels(own, &signal, &times, p))?;
    let one = |level: FeatureLevel| {
        let points = level.points.iter().map(|p| {
            let kind = match p.kind {
                CriticalKind::Maximum => 1,
                CriticalKind::Minimum => -1,
                CriticalKind::Saddle => 0,
            };
            (p.vertex, kind, p.multiplicity, p.value)
        });
        let points = points.collect();
        (level.time, arrays::vector(py, level.smoothed).into_any(), points, level.index_sum)
    };
    Ok(found.into_iter().map(one).collect())
}

fn parse_weights(name: &str) -> PyResult<Weights> {
    let known = [("uniform", Weights::Uniform), ("cotangent", Weights::Cotangent)];
    crate::options::word("weights", name, &known)
}

/// Differential coordinates `L f`.
#[pyfunction]
#[pyo3(signature = (shape, signal, weights))]
fn differential_coordinates<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    signal: PyReadonlyArray2<'py, f64>,
    weights: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let weights = parse_weights(weights)?;
    let own = shape.get().shape(py)?;
    let n_channels = signal.shape()[1];
    let values = arrays::rows(&signal, "signal")?;
    let delta =
        run(py, ALWAYS_ON_POOL, None, |_| Differential::new(own, weights)?.coordinates(values, n_channels))?;
    Ok(arrays::matrix(py, delta, n_channels)?.into_any())
}

/// Vertices with targets.
#[derive(FromPyObject)]
struct AnchorOptions<'py> {
    vertices: Vec<usize>,
    targets: PyReadonlyArray2<'py, f64>,
    weight: f64,
}

/// The signal that has these differential coordinates, with some vertices at targets.
#[pyfunction]
#[pyo3(signature = (shape, coordinates, anchors, weights))]
fn from_differential<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    coordinates: PyReadonlyArray2<'py, f64>,
    anchors: AnchorOptions<'py>,
    weights: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let weights = parse_weights(weights)?;
    let own = shape.get().shape(py)?;
    let n_channels = coordinates.shape()[1];
    let delta = arrays::rows(&coordinates, "coordinates")?;
    let targets = arrays::rows(&anchors.targets, "targets")?;
    let weight = anchors.weight;
    let anchors: Vec<Anchor> = anchors.vertices.iter().map(|&vertex| Anchor { vertex, weight }).collect();
    let solved = run(py, ALWAYS_ON_POOL, None, |_| {
        let differential = Differential::new(own, weights)?;
        Reconstruction::new(&differential, &anchors)?.solve(delta, targets, n_channels)
    })?;
    Ok(arrays::matrix(py, solved, n_channels)?.into_any())
}
