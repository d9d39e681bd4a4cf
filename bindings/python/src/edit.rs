//! Bands that are kept, for edit after edit.

use crate::arrays;
use crate::call::run;
use crate::command::RecipeData;
use crate::error::{self, value};
use crate::prepared::{Prepared, schedule, weights};
use crate::shape::ShapeData;
use adwave::Editor;
use adwave::bands::{BandsInfo, Engine, Wavelets};
use adwave::filter::{Edit, FilterError, Gains, Preset, WeightedLayer};
use adwave::region::RegionWeights;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// A signal with its bands and the layers that change them.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct EditorData {
    editor: Mutex<Editor>,
    n_channels: usize,
    shape: Py<ShapeData>,
}

impl EditorData {
    pub(crate) fn new(editor: Editor, n_channels: usize, shape: Py<ShapeData>) -> Self {
        Self { editor: Mutex::new(editor), n_channels, shape }
    }
}

/// The gains of a preset by its name.
pub(crate) fn preset(name: &str, n_levels: usize) -> PyResult<Vec<f64>> {
    let known = [&[("smooth", Preset::Suppress)], &Preset::ALL[..]].concat();
    let found = crate::options::word("preset", name, &known)?;
    Ok(found.gains(n_levels))
}

fn gains(given: &Bound<'_, PyAny>, n_levels: usize) -> PyResult<Vec<f64>> {
    if let Ok(name) = given.extract::<String>() {
        return preset(&name, n_levels);
    }
    let gains: Vec<f64> = given.extract()?;
    Gains::Gains(gains).resolve(n_levels).map_err(|e| error::of(&e))
}

/// Values that a thread copies at a time: a page of 2 MiB is touched by few.
const COPIED_AT_A_TIME: usize = 1 << 17;

/// A copy by all threads: what takes the time is the first touch of each page.
fn copy(from: &[f64], to: &mut [f64]) {
    if from.len() <= COPIED_AT_A_TIME {
        to.copy_from_slice(from);
        return;
    }
    let parts = to.par_chunks_mut(COPIED_AT_A_TIME).zip(from.par_chunks(COPIED_AT_A_TIME));
    parts.for_each(|(to, from)| to.copy_from_slice(from));
}

fn copied(from: &[f64]) -> Vec<f64> {
    let mut to = vec![0.0; from.len()];
    copy(from, &mut to);
    to
}

#[pymethods]
impl EditorData {
    /// From bands that are there: levels × n × channels, W_1 … W_J and S_J, of a shape none of whose vertices are welded or masked.
    #[staticmethod]
    #[pyo3(signature = (prepared, signal, bands, steps))]
    fn of_bands(
        py: Python<'_>,
        prepared: &Bound<'_, Prepared>,
        signal: Option<PyReadonlyArray2<'_, f64>>,
        bands: PyReadonlyArray3<'_, f64>,
        steps: Vec<f64>,
    ) -> PyResult<Self> {
        let own = prepared.get();
        let signal = own.signal(signal.as_ref())?;
        let schedule = schedule(steps)?;
        let (n, n_channels) = (own.decomposer.n_vertices(), signal.1);
        if !bands.is_c_contiguous() || bands.shape() != [schedule.n_levels() + 1, n, n_channels] {
            return Err(value(format!("bands: shape {:?} is not that of the signal's bands", bands.shape())));
        }
        let bands = bands.as_slice()?;
        let map = own.decomposer.geometry().vertex_map().as_slice();
        let editor = run(py, n, None, |progress| {
            let gathered = |band: &[f64]| {
                let mut level = vec![0.0; band.len()];
                for (row, &x) in band.chunks_exact(n_channels).zip(map) {
                    level[x as usize * n_channels..][..n_channels].copy_from_slice(row);
                }
                level
            };
            let levels = bands.chunks_exact(n * n_channels).take(schedule.n_levels()).map(gathered).collect();
            let info = BandsInfo {
                engine: Engine::Auto,
                degree: 0,
                products: 0,
                terms: 0,
                error_bound: 0.0,
                bytes: 0,
            };
            let sigma = schedule.sigma(own.decomposer.diffusion().step_length());
            let wavelets = Wavelets { n_channels, steps: schedule.steps_from_zero(), sigma, levels, info };
            own.request(signal, &schedule, 1e-10, progress).editor_of(wavelets)
        })?;
        Ok(Self::new(editor, n_channels, own.shape.clone_ref(py)))
    }

    /// The signal with these layers: gains, or the name of a preset, each with nothing, a region's text or weights. Into `out` where
    /// there is one.
    #[pyo3(signature = (layers, out=None))]
    fn apply<'py>(
        &self,
        py: Python<'py>,
        layers: Vec<(Bound<'py, PyAny>, Option<Bound<'py, PyAny>>)>,
        out: Option<Bound<'py, PyArray2<f64>>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut editor = self.editor.lock().unwrap_or_else(PoisonError::into_inner);
        let n_levels = editor.wavelets().n_levels();
        let mut weighted = Vec::with_capacity(layers.len());
        for (given, region) in &layers {
            let gains = gains(given, n_levels)?;
            let weights = match region {
                None => RegionWeights::Everywhere,
                Some(region) => {
                    if let Ok(text) = region.extract::<String>() {
                        weights(py, editor.decomposer(), self.shape.get(), &text)?
                    } else {
                        let array = region.cast::<PyArray1<f64>>().map_err(PyErr::from)?;
                        RegionWeights::Vertices(PyArrayMethods::readonly(array).as_slice()?.to_vec())
                    }
                }
            };
            weighted.push(WeightedLayer { gains, weights });
        }
        let n = editor.decomposer().n_vertices();
        let editor = &mut *editor;
        if let Some(out) = out {
            let mut given = out.try_readwrite().map_err(|_| value("out: the array cannot be written to"))?;
            if given.shape() != [n, self.n_channels] || !given.is_c_contiguous() {
                let told = "give a C-contiguous array of float64 like the signal";
                return Err(value(format!("out: shape {:?}; {told}", given.shape())));
            }
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
            Ok::<_, FilterError>(copied(editor.edited()))
        })?;
        Ok(arrays::matrix(py, edited, self.n_channels)?.into_any())
    }

    /// The signal with the layers of a recipe.
    fn apply_recipe<'py>(
        &self,
        py: Python<'py>,
        recipe: &Bound<'py, RecipeData>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut editor = self.editor.lock().unwrap_or_else(PoisonError::into_inner);
        let (editor, shape) = (&mut *editor, self.shape.get());
        let names = shape.field_names();
        let layers = &recipe.get().recipe.layers;
        let edited = run(py, editor.decomposer().n_vertices(), None, |progress| {
            let lookup = |name: &str| shape.numbers(name);
            let edit = Edit::new(layers).with_fields(&lookup, &names);
            let (n_levels, decomposer) = (editor.wavelets().n_levels(), editor.decomposer().clone());
            let layers = edit.resolve(n_levels, decomposer.metric(), progress)?;
            editor.set_layers(layers)?;
            Ok::<_, FilterError>(copied(editor.edited()))
        })?;
        Ok(arrays::matrix(py, edited, self.n_channels)?.into_any())
    }
}
