//! Saliency, features, denoising, and scores of maps.

use crate::arrays;
use crate::call::run;
use crate::error::{self, StageError, stage, value_error};
use crate::options::{BandsOptions, WeldOption, parse_name, word};
use crate::prepared::{Prepared, SignalValues, schedule};
use crate::shape::ShapeData;
use crate::time::TimeOptions;
use adwave::Progress;
use adwave::denoise::{DenoiseParams, Outliers, SharedNoise, denoise, denoise_series, denoise_signal};
use adwave::features::{
    Feature, FeatureParams, Refinement, Response, ShapeCoordinates, ThresholdScope, coordinate_features,
    describe, features, value_step,
};
use adwave::grid::Grid;
use adwave::measure::{agreement, center_distance};
use adwave::saliency::{MapWeighting, SaliencyParams, Sign, saliency, saliency_per_level, with_height};
use adwave::shape::PreparedGeometry;
use adwave::vector::Axis;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(saliency_map, module)?)?;
    module.add_function(wrap_pyfunction!(find_features, module)?)?;
    module.add_function(wrap_pyfunction!(denoise_points, module)?)?;
    module.add_function(wrap_pyfunction!(denoise_frames, module)?)?;
    module.add_function(wrap_pyfunction!(denoise_values, module)?)?;
    module.add_function(wrap_pyfunction!(gaze_scores, module)?)
}

/// Saliency map, maps of the levels, a row of numbers for each level, and the meaning of the signs.
type MapAndLevels<'py> =
    (Bound<'py, PyAny>, Vec<Bound<'py, PyAny>>, Vec<(usize, f64, f64, f64, f64)>, String);

/// Options of a saliency map beyond its weighting.
#[derive(FromPyObject)]
struct SaliencyOptions {
    unsigned: bool,
    skip: Option<usize>,
    border: Option<f64>,
    up: Option<String>,
    per_level: bool,
}

impl SaliencyOptions {
    /// Parameters of the map.
    fn params(&self, weighting: MapWeighting) -> PyResult<SaliencyParams> {
        let params = weighting.params(if self.unsigned { Sign::Unsigned } else { Sign::Signed });
        let params = params.with_skip(self.skip.unwrap_or(params.skip)).with_border_sigmas(self.border);
        params.check().map_err(|e| error::to_exception(&e))?;
        Ok(params)
    }

    /// Index of the axis that points up.
    fn axis(&self) -> PyResult<Option<usize>> {
        self.up.as_ref().map(|up| parse_name::<Axis>("up", up).map(Axis::index)).transpose()
    }
}

/// Computes a saliency map.
#[pyfunction]
#[pyo3(signature = (prepared, request, weighting, options, progress=None))]
fn saliency_map<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    request: BandsOptions<'py>,
    weighting: &str,
    options: SaliencyOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<MapAndLevels<'py>> {
    let own = prepared.get();
    let is_geometry = request.signal.is_none() && !own.decomposer.positions().is_empty();
    let signal = own.signal(request.signal.as_ref())?;
    let (schedule, bands) = (schedule(&request.steps)?, request.params()?);
    let chosen = parse_name("weighting", weighting)?;
    let (params, up, per_level) = (options.params(chosen)?, options.axis()?, options.per_level);
    let decomposer = &own.decomposer;
    let work = |p: Progress<'_>| {
        let request = own.request(signal, &schedule, &bands, p);
        let mut sides = "unsigned".to_owned();
        let mut along = None;
        if chosen == MapWeighting::Signed && is_geometry {
            let found = stage(decomposer.outward_normals(own.normals.as_deref(), p))?;
            if found.info.has_outside() {
                along = Some(stage(request.normal_components(&found.normals))?);
            }
            sides = if params.sign == Sign::Signed && along.is_some() {
                format!("+ convex, - concave; {}", found.info)
            } else {
                format!("unsigned: {}", found.info)
            };
        } else if signal.n_channels == 1 && params.sign == Sign::Signed && up.is_none() {
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
        Ok::<_, StageError>((found, levels, sides))
    };
    let (mut found, levels, sides) = run(py, decomposer.n_vertices(), progress.as_ref(), work)?;
    if let Some(axis) = up {
        let Some(points) = decomposer.points() else {
            return Err(value_error("up: a graph has no heights"));
        };
        let heights: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        found.map = with_height(&found.map, &heights);
    }
    let rows = found.levels.iter().map(|l| (l.level, l.sigma, l.mean, l.max, l.alpha)).collect();
    let levels = levels.into_iter().map(|(_, map)| arrays::vector(py, map).into_any()).collect();
    Ok((arrays::vector(py, found.map).into_any(), levels, rows, sides))
}

/// The smallest response of a feature, and the largest number of features.
#[derive(FromPyObject)]
struct FeatureThreshold {
    theta: Option<f64>,
    best: Option<usize>,
}

/// Options of features beyond their threshold.
#[derive(FromPyObject)]
struct FeatureOptions {
    response: String,
    per_component: bool,
    refine: bool,
    edge_ratio: Option<f64>,
    border: Option<f64>,
    descriptors: bool,
}

impl FeatureOptions {
    fn params(&self, threshold: &FeatureThreshold) -> PyResult<FeatureParams> {
        let params = FeatureParams::default()
            .with_theta(threshold.theta)
            .with_response(parse_name("response", &self.response)?)
            .with_scope(if self.per_component { ThresholdScope::Component } else { ThresholdScope::Shape })
            .with_refinement(if self.refine { Refinement::Quadratic } else { Refinement::Off })
            .with_max_edge_ratio(self.edge_ratio)
            .with_border_sigmas(self.border)
            .with_best(threshold.best);
        params.check().map_err(|e| error::to_exception(&e))?;
        Ok(params)
    }
}

/// Finds features: a dictionary of the columns vertex, position, level, sigma, response, strength, sign, channel (−1:
/// all) and descriptor.
#[pyfunction]
#[pyo3(signature = (prepared, request, threshold, options, progress=None))]
fn find_features<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    request: BandsOptions<'py>,
    threshold: FeatureThreshold,
    options: FeatureOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let own = prepared.get();
    let signal = own.signal(request.signal.as_ref())?;
    let (schedule, bands) = (schedule(&request.steps)?, request.params()?);
    let (params, descriptors) = (options.params(&threshold)?, options.descriptors);
    let decomposer = &own.decomposer;
    let of_values = Grid::from_domain(&**decomposer.domain()).map(|_| value_step(signal.values));
    let params = params.with_value_step(of_values);
    let is_significant =
        of_values.is_none() && request.signal.is_none() && params.finds_significant(decomposer);
    let work = |p: Progress<'_>| {
        let (found, wavelets) = if is_significant {
            let coordinates = ShapeCoordinates {
                points: decomposer.points().unwrap_or_default(),
                normals: own.normals.as_deref(),
                schedule: &schedule,
                bands,
            };
            let found = stage(coordinate_features(decomposer, &coordinates, &params, p))?;
            (found.features, found.wavelets)
        } else {
            let request = own.request(signal, &schedule, &bands, p);
            let wavelets = match params.response {
                Response::Channels => stage(request.wavelets())?,
                _ => stage(request.norms())?,
            };
            (stage(features(decomposer, &wavelets, &params, p))?, wavelets)
        };
        let described = if descriptors { describe(decomposer, &wavelets, &found) } else { Vec::new() };
        Ok::<_, StageError>((found, described))
    };
    let (found, described) = run(py, decomposer.n_vertices(), progress.as_ref(), work)?;
    let columns = feature_columns(py, &found)?;
    if descriptors {
        let n_columns = adwave::features::DESCRIPTOR_LENGTH;
        let flat: Vec<f64> = described.iter().flatten().copied().collect();
        columns.set_item("descriptor", arrays::matrix(py, flat, n_columns)?)?;
    }
    Ok(columns)
}

fn feature_columns<'py>(py: Python<'py>, found: &[Feature]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let numbers = |column: &dyn Fn(&Feature) -> f64| arrays::vector(py, found.iter().map(column).collect());
    columns.set_item("vertex", arrays::vector(py, found.iter().map(|f| f.vertex as i64).collect()))?;
    let position = |f: &Feature| f.position.unwrap_or([f64::NAN; 3]);
    columns.set_item("position", arrays::point_rows(py, found.iter().map(position).collect())?)?;
    columns.set_item("level", arrays::vector(py, found.iter().map(|f| f.level as i32).collect()))?;
    columns.set_item("sigma", numbers(&|f| f.sigma))?;
    columns.set_item("response", numbers(&|f| f.response))?;
    columns.set_item("strength", numbers(&|f| f.strength))?;
    columns.set_item("sign", arrays::vector(py, found.iter().map(Feature::sign).collect()))?;
    let channel = |f: &Feature| f.channel.map_or(-1, |c| c as i32);
    columns.set_item("channel", arrays::vector(py, found.iter().map(channel).collect()))?;
    Ok(columns)
}

/// Options of denoising.
#[derive(FromPyObject)]
struct DenoiseOptions {
    strength: f64,
    creases: String,
    noise: Option<f64>,
    noise_model: String,
    local_fit: String,
    outliers: String,
    shared_noise: SharedNoiseOption,
}

/// `'detail'`, `'auto'` or a standard deviation.
#[derive(FromPyObject)]
enum SharedNoiseOption {
    Deviation(f64),
    Word(String),
}

impl DenoiseOptions {
    fn params(&self) -> PyResult<DenoiseParams> {
        let creases = parse_name("creases", &self.creases)?;
        let fit = parse_name("local_fit", &self.local_fit)?;
        let params = DenoiseParams::default().with_strength(self.strength).with_creases(creases);
        // An array of points stays as long as it is, so none are dropped.
        let outliers = [Outliers::Keep, Outliers::Pull].map(|treatment| (treatment.name(), treatment));
        let params = params.with_local_fit(fit).with_outliers(word("outliers", &self.outliers, &outliers)?);
        let params = params.with_noise_model(parse_name("noise", &self.noise_model)?);
        let params = params.with_shared(match &self.shared_noise {
            SharedNoiseOption::Deviation(deviation) => SharedNoise::Deviation(*deviation),
            SharedNoiseOption::Word(name) => SharedNoise::from_word(name)
                .ok_or_else(|| value_error(format!("noise must be one of 'detail', 'auto', got '{name}'")))?,
        });
        Ok(match self.noise {
            Some(noise) => params.with_noise(noise),
            None => params,
        })
    }
}

/// Positions without noise, and the estimates that they are based on.
#[pyfunction]
#[pyo3(signature = (shape, options, weld, progress=None))]
fn denoise_points<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    options: DenoiseOptions,
    weld: WeldOption,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
    let params = options.params()?;
    let own = shape.get().shape(py)?;
    if params.shared != SharedNoise::Detail && !own.is_mesh() {
        return Err(PyValueError::new_err(
            "noise: 'shared' applies to meshes; pass a number or leave it out",
        ));
    }
    let weld = weld.mode()?;
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
    found.set_item("noise_map", arrays::vector(py, denoised.noise))?;
    if let Some(mesh) = &info.mesh {
        found.set_item("impulse_share", mesh.impulse_share)?;
        found.set_item("impulse_size", mesh.impulse_size)?;
        found.set_item("turned_share", mesh.turned_share)?;
        found.set_item("linear_rounds", mesh.linear_rounds)?;
        found.set_item("noise_range", mesh.noise_range)?;
        found.set_item("kept_by_place", mesh.kept_by_place.clone())?;
        found.set_item("shared_noise", mesh.shared)?;
        found.set_item("shared_noise_at_most", mesh.shared_at_most)?;
    }
    if let Some(cloud) = &info.cloud {
        found.set_item("noise_range", cloud.noise_range)?;
        found.set_item("noise_interval", cloud.noise_interval)?;
        found.set_item("neighbors", cloud.neighbors)?;
        found.set_item("residual_ratio", cloud.residual_ratio)?;
        found.set_item("two_surfaces", cloud.has_two_surfaces())?;
        found.set_item("flat_share", cloud.flat_share)?;
        found.set_item("noise_is_doubtful", cloud.is_noise_doubtful())?;
        found.set_item("n_outliers", cloud.n_outliers)?;
        found.set_item("strong_noise", cloud.strong.as_ref().map(|strong| strong.noise))?;
        found.set_item("n_left", cloud.n_left)?;
        found.set_item("rounding", cloud.rounding)?;
        found.set_item("nearest_distance", cloud.nearest_distance)?;
        found.set_item("outliers", denoised.outliers.clone())?;
    }
    if let Some(curve) = &info.curve {
        found.set_item("noise_by_axis", curve.noise_by_axis)?;
        found.set_item("rounding", curve.rounding)?;
        found.set_item("length", curve.length)?;
    }
    Ok((arrays::point_rows(py, denoised.points)?.into_any(), found))
}

/// Values of a signal without noise, and the estimates for each group of channels.
#[pyfunction]
#[pyo3(signature = (prepared, signal, options, progress=None))]
fn denoise_values<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    signal: Option<PyReadonlyArray2<'_, f64>>,
    options: DenoiseOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Vec<Bound<'py, PyDict>>)> {
    let params = options.params()?;
    let own = prepared.get();
    let SignalValues { values, n_channels } = own.signal(signal.as_ref())?;
    let work = |p: Progress<'_>| denoise_signal(&own.decomposer, values, n_channels, &params, p);
    let denoised = run(py, own.decomposer.n_vertices(), progress.as_ref(), work)?;
    let mut found = Vec::new();
    for info in &denoised.info {
        let own = PyDict::new(py);
        own.set_item("channels", info.channels.clone())?;
        own.set_item("noise", info.noise)?;
        own.set_item("noise_model", info.model.name())?;
        own.set_item("remaining", info.remaining)?;
        own.set_item("kept", info.kept)?;
        own.set_item("plain_weights", info.plain_weights.clone())?;
        own.set_item("step_weights", info.step_weights.clone())?;
        own.set_item("risk", info.risk)?;
        found.push(own);
    }
    Ok((arrays::matrix(py, denoised.values, n_channels)?.into_any(), found))
}

/// Values of a series without noise, vertices × (frames · components), and the estimates.
#[pyfunction]
#[pyo3(signature = (prepared, series, n_components, time, options, progress=None))]
fn denoise_frames<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    series: PyReadonlyArray2<'_, f64>,
    n_components: usize,
    time: TimeOptions,
    options: DenoiseOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
    let params = options.params()?;
    let own = prepared.get();
    let SignalValues { values, n_channels } = own.signal(Some(&series))?;
    let axis = time.axis(n_channels / n_components.max(1))?;
    let work = |p: Progress<'_>| denoise_series(&own.decomposer, &axis, values, n_components, &params, p);
    let denoised = run(py, values.len(), progress.as_ref(), work)?;
    let info = PyDict::new(py);
    info.set_item("noise", denoised.info.noise)?;
    info.set_item("widths", denoised.info.widths)?;
    info.set_item("steps", denoised.info.steps)?;
    info.set_item("mean_steps", denoised.info.mean_steps)?;
    info.set_item("weights", denoised.info.weights)?;
    info.set_item("risk", denoised.info.risk)?;
    Ok((arrays::matrix(py, denoised.values, n_channels)?.into_any(), info))
}

/// Agreement of a map with fixations: AUC, normalized scanpath saliency, correlation, and correlation given the
/// distance from the center.
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
    scores.set_item("partial_correlation", found.partial_correlation)?;
    Ok(scores)
}
