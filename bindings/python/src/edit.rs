//! Edits of bands.

use crate::arrays;
use crate::call::run;
use crate::error::{self, value_error};
use crate::options::{self, BandsOptions};
use crate::prepared::{Prepared, SignalValues, schedule};
use crate::recipe::RecipeData;
use crate::region::region_weights;
use crate::shape::ShapeData;
use adwave::filter::{BandsView, Edit, FilterError, Gains, WeightedLayer, filter_bands};
use adwave::region::RegionWeights;
use adwave::{Decomposer, EditBits, Editor, MANY_CHANNELS};
use adwave_io::{distinct_labels, labels_of_field};
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyReadwriteArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<EditorData>()?;
    module.add("MANY_CHANNELS", MANY_CHANNELS)?;
    module.add_function(wrap_pyfunction!(channels_by_mask, module)?)?;
    module.add_function(wrap_pyfunction!(labels_of_signal, module)?)?;
    module.add_function(wrap_pyfunction!(filter_labels, module)?)?;
    module.add_function(wrap_pyfunction!(filter_layers, module)?)?;
    module.add_function(wrap_pyfunction!(apply_bands, module)?)
}

/// A signal with its bands and the layers that change them.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct EditorData {
    editor: Mutex<Editor>,
    n_channels: usize,
    shape: Py<ShapeData>,
}

fn gains(given: &Bound<'_, PyAny>, n_levels: usize) -> PyResult<Vec<f64>> {
    if let Ok(name) = given.extract::<String>() {
        return options::preset_gains(&name, n_levels);
    }
    let gains: Vec<f64> = given.extract()?;
    Gains::Gains(gains).resolve(n_levels).map_err(|e| error::to_exception(&e))
}

/// Gains or the name of a preset, with a region's text, weights or nothing.
type PlainLayer<'py> = (Bound<'py, PyAny>, Option<Bound<'py, PyAny>>);

fn weighted_layers(
    py: Python<'_>,
    layers: &[PlainLayer<'_>],
    n_levels: usize,
    decomposer: &Decomposer,
    shape: &ShapeData,
) -> PyResult<Vec<WeightedLayer>> {
    let mut weighted = Vec::with_capacity(layers.len());
    for (given, region) in layers {
        let gains = gains(given, n_levels)?;
        let weights = match region {
            None => RegionWeights::Everywhere,
            Some(region) => {
                if let Ok(text) = region.extract::<String>() {
                    region_weights(py, decomposer, shape, &text)?
                } else {
                    let array = region.cast::<PyArray1<f64>>().map_err(PyErr::from)?;
                    RegionWeights::Vertices(PyArrayMethods::readonly(array).as_slice()?.to_vec())
                }
            }
        };
        weighted.push(WeightedLayer { gains, weights });
    }
    Ok(weighted)
}

/// The caller's array for a result.
fn writable<'py>(
    out: &Bound<'py, PyArray2<f64>>,
    n: usize,
    n_channels: usize,
) -> PyResult<PyReadwriteArray2<'py, f64>> {
    let given = out.try_readwrite().map_err(|_| value_error("out: the array cannot be written to"))?;
    if given.shape() != [n, n_channels] || !given.is_c_contiguous() {
        let told = "give a C-contiguous array of float64 like the signal";
        return Err(value_error(format!("out: shape {:?}; {told}", given.shape())));
    }
    Ok(given)
}

/// Channels and the flags of the vertices where all of them are NaN; `None` if they have no NaN.
type MaskedChannels<'py> = (Vec<usize>, Option<Bound<'py, PyArray1<bool>>>);

/// Channels that are NaN at the same vertices, and the flags of these vertices.
#[pyfunction]
fn channels_by_mask<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
) -> PyResult<Vec<MaskedChannels<'py>>> {
    let groups = adwave::mask::channels_by_mask(arrays::rows(&values, "signal")?, values.shape()[1]);
    let flags = |missing: Option<Vec<bool>>| missing.map(|flags| PyArray1::from_vec(py, flags));
    Ok(groups.into_iter().map(|group| (group.channels, flags(group.missing))).collect())
}

/// Labels of a signal of that name, in ascending order; `None` if it has numbers.
#[pyfunction]
fn labels_of_signal(name: &str, values: PyReadonlyArray2<'_, f64>) -> PyResult<Option<Vec<f64>>> {
    let n_channels = values.shape()[1];
    Ok(labels_of_field(name, n_channels, arrays::rows(&values, "signal")?))
}

/// Labels after layers that change the share of each label.
#[pyfunction]
#[pyo3(signature = (prepared, request, layers, progress=None))]
fn filter_labels<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    request: BandsOptions<'py>,
    layers: Vec<PlainLayer<'py>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let own = prepared.get();
    let signal = own.signal(request.signal.as_ref())?;
    let labels = if signal.n_channels == 1 { distinct_labels(signal.values) } else { None };
    let labels = labels
        .ok_or_else(|| value_error("labels: give one label for each vertex, at most 65536 different ones"))?;
    let (schedule, n) = (schedule(&request.steps)?, own.decomposer.n_vertices());
    let layers = weighted_layers(py, &layers, schedule.n_levels(), &own.decomposer, own.shape.get())?;
    let params = request.params()?;
    let filtered = run(py, n, progress.as_ref(), |p| {
        own.request(signal, &schedule, &params, p).filter_labels(&labels, &layers)
    })?;
    Ok(arrays::matrix(py, filtered, 1)?.into_any())
}

/// The signal with layers, edited once by the cheapest way.
#[pyfunction]
#[pyo3(signature = (prepared, request, layers, progress=None))]
fn filter_layers<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    request: BandsOptions<'py>,
    layers: Vec<PlainLayer<'py>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let own = prepared.get();
    let signal = own.signal(request.signal.as_ref())?;
    let (schedule, n) = (schedule(&request.steps)?, own.decomposer.n_vertices());
    let layers = weighted_layers(py, &layers, schedule.n_levels(), &own.decomposer, own.shape.get())?;
    let fit = options::parse_name("local_fit", &request.local_fit)?;
    let params = request.params()?;
    let (edited, _) = run(py, n, progress.as_ref(), |p| {
        own.request(signal, &schedule, &params, p).local_fit(fit).edit(layers, EditBits::Accuracy)
    })?;
    Ok(arrays::matrix(py, edited, signal.n_channels)?.into_any())
}

/// The signal with layers, from its bands: levels × n × channels, of a shape without welded or masked vertices. Written
/// to `out`, if given.
#[pyfunction]
#[pyo3(signature = (prepared, signal, bands, layers, out=None))]
fn apply_bands<'py>(
    py: Python<'py>,
    prepared: &Bound<'py, Prepared>,
    signal: Option<PyReadonlyArray2<'py, f64>>,
    bands: PyReadonlyArray3<'py, f64>,
    layers: Vec<PlainLayer<'py>>,
    out: Option<Bound<'py, PyArray2<f64>>>,
) -> PyResult<Bound<'py, PyAny>> {
    let own = prepared.get();
    let SignalValues { values: signal, n_channels } = own.signal(signal.as_ref())?;
    let map = own.decomposer.vertex_map();
    let n = map.n_vertices();
    let n_levels = bands.shape()[0].saturating_sub(1);
    if !bands.is_c_contiguous() || bands.shape()[1..] != [n, n_channels] || map.n_welded() < n {
        return Err(value_error(format!(
            "bands: shape {:?} is not that of the signal's bands",
            bands.shape()
        )));
    }
    let layers = weighted_layers(py, &layers, n_levels, &own.decomposer, own.shape.get())?;
    let bands = BandsView { coefficients: bands.as_slice()?, n_levels, n_channels };
    if let Some(out) = out {
        let mut given = writable(&out, n, n_channels)?;
        let rows = given.as_slice_mut()?;
        run(py, n, None, |_| filter_bands(signal, bands, &layers, map, rows))?;
        return Ok(out.into_any());
    }
    let edited = run(py, n, None, |_| {
        let mut edited = vec![0.0; signal.len()];
        filter_bands(signal, bands, &layers, map, &mut edited)?;
        Ok::<_, FilterError>(edited)
    })?;
    Ok(arrays::matrix(py, edited, n_channels)?.into_any())
}

/// Values that a thread copies in one piece: few threads touch the same page of 2 MiB.
const COPIED_AT_A_TIME: usize = 1 << 17;

/// Copies values with all threads, since the first touch of each page takes the time.
fn copy(from: &[f64], to: &mut [f64]) {
    if from.len() <= COPIED_AT_A_TIME {
        to.copy_from_slice(from);
        return;
    }
    let parts = to.par_chunks_mut(COPIED_AT_A_TIME).zip(from.par_chunks(COPIED_AT_A_TIME));
    parts.for_each(|(to, from)| to.copy_from_slice(from));
}

fn copy_of(from: &[f64]) -> Vec<f64> {
    let mut to = vec![0.0; from.len()];
    copy(from, &mut to);
    to
}

#[pymethods]
impl EditorData {
    /// The bands of a signal, kept for edits.
    #[new]
    #[pyo3(signature = (prepared, request, progress=None))]
    fn new(
        py: Python<'_>,
        prepared: &Bound<'_, Prepared>,
        request: BandsOptions<'_>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let own = prepared.get();
        let signal = own.signal(request.signal.as_ref())?;
        let (schedule, n) = (schedule(&request.steps)?, own.decomposer.n_vertices());
        let fit = options::parse_name("local_fit", &request.local_fit)?;
        let params = request.params()?;
        let editor = run(py, n, progress.as_ref(), |p| {
            own.request(signal, &schedule, &params, p).local_fit(fit).editor()
        })?;
        Ok(Self { editor: Mutex::new(editor), n_channels: signal.n_channels, shape: own.shape.clone_ref(py) })
    }

    /// The signal with these layers: gains or the name of a preset, with a region's text, weights or nothing. Written
    /// to `out`, if given.
    #[pyo3(signature = (layers, out=None))]
    fn apply<'py>(
        &self,
        py: Python<'py>,
        layers: Vec<PlainLayer<'py>>,
        out: Option<Bound<'py, PyArray2<f64>>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut editor = self.editor.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let n_levels = editor.wavelets().n_levels();
        let weighted = weighted_layers(py, &layers, n_levels, editor.decomposer(), self.shape.get())?;
        let n = editor.decomposer().n_vertices();
        let editor = &mut *editor;
        if let Some(out) = out {
            let mut given = writable(&out, n, self.n_channels)?;
            let rows = given.as_slice_mut()?;
            run(py, n, None, |_| {
                editor.set_layers(weighted)?;
                copy(editor.edited(), rows);
                Ok::<_, FilterError>(())
            })?;
            return Ok(out.into_any());
        }
        let edited = run(py, n, None, |_| {
            editor.set_layers(weighted)?;
            Ok::<_, FilterError>(copy_of(editor.edited()))
        })?;
        Ok(arrays::matrix(py, edited, self.n_channels)?.into_any())
    }

    /// The signal with the layers of a recipe; [`RecipeData::reshape`] applies its clones and its pose.
    fn apply_recipe<'py>(
        &self,
        py: Python<'py>,
        recipe: &Bound<'py, RecipeData>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut editor = self.editor.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
        let (editor, shape) = (&mut *editor, self.shape.get());
        let names = shape.field_names();
        let layers = &recipe.get().recipe.layers;
        let edited = run(py, editor.decomposer().n_vertices(), None, |progress| {
            let (n_levels, decomposer) = (editor.wavelets().n_levels(), editor.decomposer().clone());
            let lookup = |name: &str| shape.region_field(&decomposer, name);
            let edit = Edit::new(layers).with_fields(&lookup, &names);
            let layers = edit.resolve(n_levels, decomposer.metric(), progress)?;
            editor.set_layers(layers)?;
            Ok::<_, FilterError>(copy_of(editor.edited()))
        })?;
        Ok(arrays::matrix(py, edited, self.n_channels)?.into_any())
    }
}
