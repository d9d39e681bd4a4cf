//! What is measured or taken off: saliency, features, noise, vertices; scores of maps and features.

use crate::arrays;
use crate::call::run;
use crate::error::{self, value};
use crate::options::named;
use crate::prepared::{Prepared, schedule};
use crate::shape::ShapeData;
use adwave::denoise::{DenoiseParams, denoise, denoise_signal};
use adwave::features::{FeatureParams, Refinement, Response, ThresholdScope, describe, features};
use adwave::measure::{agreement, center_distance};
use adwave::operator::OperatorParams;
use adwave::saliency::{MapWeighting, SaliencyParams, Sign, saliency, saliency_per_level, with_height};
use adwave::shape::PreparedGeometry;
use adwave::signal::outward_normals;
use adwave::{ClassifiedError, Progress};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(saliency_map, module)?)?;
    module.add_function(wrap_pyfunction!(find_features, module)?)?;
    module.add_function(wrap_pyfunction!(denoise_points, module)?)?;
    module.add_function(wrap_pyfunction!(denoise_values, module)?)?;
    module.add_function(wrap_pyfunction!(gaze_scores, module)?)
}

/// Work of several steps, whose errors are of several kinds.
pub(crate) type Stage<T> = Result<T, Failure>;

/// An error of any kind, already in words.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: adwave::ErrorKind,
    text: String,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for Failure {}

impl ClassifiedError for Failure {
    fn kind(&self) -> adwave::ErrorKind {
        self.kind
    }
}

pub(crate) fn stage<T, E: ClassifiedError>(result: Result<T, E>) -> Stage<T> {
    result.map_err(|e| Failure { kind: e.kind(), text: e.to_string() })
}

/// The map, the same of each level, what `SaliencyLevel` says of each, and which sides the signs stand for.
type MapAndLevels<'py> =
    (Bound<'py, PyAny>, Vec<Bound<'py, PyAny>>, Vec<(usize, f64, f64, f64, f64)>, String);

/// The map, the same of each level, a row of numbers for each level, and in words which sides the signs stand for.
#[pyfunction]
#[pyo3(signature = (prepared, signal, steps, accuracy, weighting, unsigned, skip, border, up, per_level, progress=None))]
fn saliency_map<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    signal: Option<PyReadonlyArray2<'_, f64>>,
    steps: Vec<f64>,
    accuracy: f64,
    weighting: &str,
    unsigned: bool,
    skip: Option<usize>,
    border: Option<f64>,
    up: Option<usize>,
    per_level: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<MapAndLevels<'py>> {
    let own = prepared.get();
    let is_geometry = signal.is_none() && !own.decomposer.geometry().points().is_empty();
    let signal = own.signal(signal.as_ref())?;
    let schedule = schedule(steps)?;
    let chosen: MapWeighting = named("weighting", weighting)?;
    let params = chosen.params(if unsigned { Sign::Unsigned } else { Sign::Signed });
    let params = SaliencyParams { skip: skip.unwrap_or(params.skip), border_sigmas: border, ..params };
    params.check().map_err(|e| error::of(&e))?;
    let decomposer = &own.decomposer;
    let work = |p: Progress<'_>| {
        let request = own.request(signal, &schedule, accuracy, p);
        let mut sides = "unsigned".to_owned();
        let mut along = None;
        if chosen == MapWeighting::Signed && is_geometry {
            let found = stage(outward_normals(decomposer.geometry(), own.normals.as_deref(), p))?;
            if found.info.has_outside() {
                along = Some(stage(request.along(&found.normals))?);
            }
            sides = if params.sign == Sign::Signed && along.is_some() {
                format!("+ convex, - concave; {}", found.info)
            } else {
                format!("unsigned: {}", found.info)
            };
        } else if signal.1 == 1 && params.sign == Sign::Signed && up.is_none() {
            "+ above its surroundings, - below".clone_into(&mut sides);
        }
        let wavelets = match along {
            Some(wavelets) => wavelets,
            None => stage(request.norms())?,
        };
        let found = stage(saliency(decomposer, &wavelets, &params, p))?;
        let levels = if per_level {
            stage(saliency_per_level(decomposer, &wavelets, &params, p))?
        } else {
            Vec::new()
        };
        Ok::<_, Failure>((found, levels, sides))
    };
    let (mut found, levels, sides) = run(py, decomposer.n_vertices(), progress.as_ref(), work)?;
    if let Some(axis) = up {
        let Some(points) = decomposer.geometry().shape().points() else {
            return Err(value("up: a graph has no heights"));
        };
        let heights: Vec<f64> = points.iter().map(|p| p[axis.min(2)]).collect();
        found.map = with_height(&found.map, &heights);
    }
    let rows = found.levels.iter().map(|l| (l.level, l.sigma, l.mean, l.max, l.alpha)).collect();
    let levels = levels.into_iter().map(|(_, map)| arrays::vector(py, map).into_any()).collect();
    Ok((arrays::vector(py, found.map).into_any(), levels, rows, sides))
}

/// Columns of the features: vertex, position, level, σ, response, strength, sign, channel (−1: all), and the descriptors.
#[pyfunction]
#[pyo3(signature = (
    prepared, signal, steps, accuracy, theta, response, per_component, refine, edge_ratio, border, best, descriptors,
    progress=None
))]
fn find_features<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    signal: Option<PyReadonlyArray2<'_, f64>>,
    steps: Vec<f64>,
    accuracy: f64,
    theta: f64,
    response: &str,
    per_component: bool,
    refine: bool,
    edge_ratio: Option<f64>,
    border: Option<f64>,
    best: Option<usize>,
    descriptors: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = prepared.get();
    let signal = own.signal(signal.as_ref())?;
    let schedule = schedule(steps)?;
    let params = FeatureParams {
        theta,
        response: named("response", response)?,
        scope: if per_component { ThresholdScope::Component } else { ThresholdScope::Shape },
        refinement: if refine { Refinement::Quadratic } else { Refinement::Off },
        max_edge_ratio: edge_ratio,
        border_sigmas: border,
        best,
    };
    params.check().map_err(|e| error::of(&e))?;
    let decomposer = &own.decomposer;
    let work = |p: Progress<'_>| {
        let request = own.request(signal, &schedule, accuracy, p);
        let wavelets = match params.response {
            Response::Channels => stage(request.wavelets())?,
            _ => stage(request.norms())?,
        };
        let found = stage(features(decomposer, &wavelets, &params, p))?;
        let described = if descriptors { describe(decomposer, &wavelets, &found) } else { Vec::new() };
        Ok::<_, Failure>((found, described))
    };
    let (found, described) = run(py, decomposer.n_vertices(), progress.as_ref(), work)?;
    let columns = PyDict::new(py);
    let numbers =
        |of: &dyn Fn(&adwave::features::Feature) -> f64| arrays::vector(py, found.iter().map(of).collect());
    columns.set_item("vertex", arrays::vector(py, found.iter().map(|f| f.vertex as i64).collect()))?;
    let at = |f: &adwave::features::Feature| f.position.unwrap_or([f64::NAN; 3]);
    columns.set_item("position", arrays::point_rows(py, found.iter().map(at).collect())?)?;
    columns.set_item("level", arrays::vector(py, found.iter().map(|f| f.level as i32).collect()))?;
    columns.set_item("sigma", numbers(&|f| f.sigma))?;
    columns.set_item("response", numbers(&|f| f.response))?;
    columns.set_item("strength", numbers(&|f| f.strength))?;
    columns
        .set_item("sign", arrays::vector(py, found.iter().map(adwave::features::Feature::sign).collect()))?;
    let channel = |f: &adwave::features::Feature| f.channel.map_or(-1, |c| c as i32);
    columns.set_item("channel", arrays::vector(py, found.iter().map(channel).collect()))?;
    if descriptors {
        let n_columns = adwave::features::DESCRIPTOR_LENGTH;
        let flat: Vec<f64> = described.iter().flatten().copied().collect();
        columns.set_item("descriptor", arrays::matrix(py, flat, n_columns)?)?;
    }
    Ok(columns)
}

fn denoise_params(strength: f64, creases: &str, noise: Option<f64>) -> PyResult<DenoiseParams> {
    let params =
        DenoiseParams::default().with_strength(strength).with_creases(named("creases", creases)?);
    Ok(match noise {
        Some(noise) => params.with_noise(noise),
        None => params,
    })
}

/// Positions without noise, and what was found out about it.
#[pyfunction]
#[pyo3(signature = (shape, strength, creases, noise, weld, progress=None))]
fn denoise_points<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    strength: f64,
    creases: &str,
    noise: Option<f64>,
    weld: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
    let params = denoise_params(strength, creases, noise)?;
    let own = shape.get().shape(py)?;
    let default = OperatorParams::default().weld;
    let weld = if weld { default } else { adwave::shape::WeldMode::Off };
    let work = |p: Progress<'_>| {
        let geometry = stage(PreparedGeometry::new(own, weld, p))?;
        stage(denoise(&geometry, &params, p))
    };
    let denoised = run(py, own.n_vertices(), progress.as_ref(), work)?;
    let (info, found) = (&denoised.info, PyDict::new(py));
    found.set_item("noise", info.noise)?;
    found.set_item("noise_in_edges", info.noise_in_edges)?;
    found.set_item("kept", info.kept)?;
    found.set_item("crease_weights", info.crease_weights.clone())?;
    found.set_item("smooth_weights", info.smooth_weights.clone())?;
    found.set_item("n_far", info.n_far)?;
    found.set_item("furthest", info.furthest)?;
    Ok((arrays::point_rows(py, denoised.points)?.into_any(), found))
}

/// Values of a signal without noise, and what was found out about it, for each group of channels.
#[pyfunction]
#[pyo3(signature = (prepared, signal, strength, creases, noise, progress=None))]
fn denoise_values<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    signal: Option<PyReadonlyArray2<'_, f64>>,
    strength: f64,
    creases: &str,
    noise: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Vec<Bound<'py, PyDict>>)> {
    let params = denoise_params(strength, creases, noise)?;
    let own = prepared.get();
    let (values, n_channels) = own.signal(signal.as_ref())?;
    let work = |p: Progress<'_>| denoise_signal(&own.decomposer, values, n_channels, &params, p);
    let denoised = run(py, own.decomposer.n_vertices(), progress.as_ref(), work)?;
    let mut found = Vec::new();
    for info in &denoised.info {
        let own = PyDict::new(py);
        own.set_item("channels", info.channels.clone())?;
        own.set_item("noise", info.noise)?;
        own.set_item("kept", info.kept)?;
        own.set_item("plain_weights", info.plain_weights.clone())?;
        own.set_item("step_weights", info.step_weights.clone())?;
        own.set_item("risk", info.risk)?;
        found.push(own);
    }
    Ok((arrays::matrix(py, denoised.values, n_channels)?.into_any(), found))
}

/// Agreement of a map with fixations: AUC, normalized scanpath saliency, correlation; the same with a control of distance.
#[pyfunction]
#[pyo3(signature = (map, fixations, threshold, points=None))]
fn gaze_scores<'py>(
    py: Python<'py>,
    map: PyReadonlyArray1<'_, f64>,
    fixations: PyReadonlyArray1<'_, f64>,
    threshold: f64,
    points: Option<PyReadonlyArray2<'_, f64>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (map, fixations) = (map.as_slice()?, fixations.as_slice()?);
    let points = points.as_ref().map(|p| arrays::points(p, "points")).transpose()?;
    let control = points.map(center_distance);
    let work = |_: Progress<'_>| agreement(map, fixations, threshold, control.as_deref());
    let found = run(py, map.len(), None, work)?;
    let scores = PyDict::new(py);
    scores.set_item("n_vertices", found.n_vertices)?;
    scores.set_item("n_positive", found.n_positive)?;
    scores.set_item("auc", found.auc)?;
    scores.set_item("nss", found.nss)?;
    scores.set_item("correlation", found.correlation)?;
    Ok(scores)
}
