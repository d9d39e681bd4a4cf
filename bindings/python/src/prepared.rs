//! A shape prepared once, to be asked often.

use crate::arrays;
use crate::call::run;
use crate::edit::EditorData;
use crate::error::{self, value};
use crate::options::{length, named, operator};
use crate::shape::ShapeData;
use adwave::LevelSpec;
use adwave::bands::{BandsParams, Schedule, Transform};
use adwave::positions::{PositionParams, settle};
use adwave::region::{Length, RegionWeights, parse_region};
use adwave::shape::{Shape, bounding_box};
use adwave::{BandsRequest, Cancelled, Decomposer, Progress};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A shape with its diffusion operator.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct Prepared {
    pub(crate) decomposer: Decomposer,
    /// The file's normals, which way is outside.
    pub(crate) normals: Option<Vec<f64>>,
    /// Signals of the file, that regions may name.
    pub(crate) shape: Py<ShapeData>,
}

/// A signal from the interpreter: its own numbers, or the coordinates.
pub(crate) enum Signal<'a> {
    Given(&'a [f64], usize),
    Coordinates,
}

impl Prepared {
    /// A signal, and how many numbers it has at each vertex.
    pub(crate) fn signal<'a>(
        &'a self,
        given: Option<&'a PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<(&'a [f64], usize)> {
        match self.given(given)? {
            Signal::Given(values, n_channels) => Ok((values, n_channels)),
            Signal::Coordinates => match self.decomposer.geometry().shape().points() {
                Some(points) => Ok((points.as_flattened(), 3)),
                None => Err(value("signal: a graph has no coordinates; give one value for each vertex")),
            },
        }
    }

    fn given<'a>(&self, given: Option<&'a PyReadonlyArray2<'_, f64>>) -> PyResult<Signal<'a>> {
        let Some(array) = given else { return Ok(Signal::Coordinates) };
        let [n, d] = [array.shape()[0], array.shape()[1]];
        if n != self.decomposer.n_vertices() || d == 0 {
            let n_vertices = self.decomposer.n_vertices();
            return Err(value(format!(
                "signal: shape ({n}, {d}) for {n_vertices} vertices; give one row for each"
            )));
        }
        Ok(Signal::Given(arrays::rows(array, "signal")?, d))
    }

    pub(crate) fn request<'a>(
        &'a self,
        (signal, n_channels): (&'a [f64], usize),
        schedule: &'a Schedule,
        accuracy: f64,
        progress: Progress<'a>,
    ) -> BandsRequest<'a> {
        let params = BandsParams::default().with_accuracy(accuracy);
        self.decomposer.request(signal, n_channels, schedule).params(&params).progress(progress)
    }
}

/// Levels of these numbers of steps.
pub(crate) fn schedule(steps: Vec<f64>) -> PyResult<Schedule> {
    Schedule::real(steps).map_err(|e| error::of(&e))
}

#[pymethods]
impl Prepared {
    #[new]
    #[pyo3(signature = (shape, options, progress=None))]
    fn new(
        py: Python<'_>,
        shape: Py<ShapeData>,
        options: &Bound<'_, PyDict>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let params = operator(options)?;
        let content = shape.get();
        let own = content.shape(py)?;
        let decomposer =
            run(py, own.n_vertices(), progress.as_ref(), |p| Decomposer::with_params(own, &params, p))?;
        let normals = adwave_io::file_normals(&content.file);
        Ok(Self { decomposer, normals, shape })
    }

    /// The same with these vertices left out.
    fn masked(&self, py: Python<'_>, flags: PyReadonlyArray1<'_, bool>) -> PyResult<Self> {
        let flags = flags.as_slice()?;
        let decomposer = run(py, flags.len(), None, |_| self.decomposer.masked(flags))?;
        Ok(Self { decomposer, normals: self.normals.clone(), shape: self.shape.clone_ref(py) })
    }

    #[getter]
    fn n_vertices(&self) -> usize {
        self.decomposer.n_vertices()
    }

    #[getter]
    fn operator(&self) -> &'static str {
        self.decomposer.operator_kind().name()
    }

    /// Numbers about the shape and its operator.
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (facts, d) = (PyDict::new(py), &self.decomposer);
        let health = run(py, d.n_vertices(), None, |_| Ok::<_, Cancelled>(d.health()))?;
        let counts = [
            ("vertices", health.n_vertices),
            ("faces", health.n_faces),
            ("polygons", health.n_polygons),
            ("edges", health.n_edges),
            ("components", health.n_components),
            ("boundary_edges", health.n_boundary_edges),
            ("non_manifold_edges", health.n_non_manifold_edges),
            ("misoriented_edges", health.n_misoriented_edges),
            ("zero_area_faces", health.n_zero_area_faces),
            ("repeated_faces", health.n_repeated_faces),
            ("welded_vertices", health.n_welded),
            ("isolated_vertices", health.n_isolated),
            ("unreferenced_vertices", health.n_unreferenced),
        ];
        for (name, count) in counts {
            facts.set_item(name, count)?;
        }
        facts.set_item("closed", health.is_closed())?;
        facts.set_item("area", health.area)?;
        facts.set_item("volume", health.volume)?;
        facts.set_item("euler_characteristic", health.euler_characteristic)?;
        facts.set_item("bounding_box", d.geometry().shape().points().and_then(bounding_box))?;
        facts.set_item("diagonal", d.diagonal())?;
        facts.set_item("operator", d.operator_kind().name())?;
        facts.set_item("entries", d.diffusion().nnz())?;
        facts.set_item("mean_length", d.mean_length())?;
        facts.set_item("step_length", d.diffusion().step_length())?;
        facts.set_item("reversible", d.diffusion().is_reversible())?;
        Ok(facts)
    }

    fn lengths(&self) -> (f64, f64, f64) {
        (self.decomposer.diagonal(), self.decomposer.mean_length(), self.decomposer.diffusion().step_length())
    }

    fn is_reversible(&self) -> bool {
        self.decomposer.diffusion().is_reversible()
    }

    fn areas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let areas = run(py, self.n_vertices(), None, |_| Ok::<_, Cancelled>(self.decomposer.areas()))?;
        Ok(arrays::vector(py, areas).into_any())
    }

    /// Which welded vertex each vertex is, and the share of the stationary distribution that each vertex has.
    fn welding<'py>(&self, py: Python<'py>) -> (Bound<'py, PyAny>, Bound<'py, PyAny>) {
        let map = self.decomposer.geometry().vertex_map();
        let stationary = self.decomposer.diffusion().stationary();
        let mut members = vec![0_u32; map.n_welded()];
        for &x in map.as_slice() {
            members[x as usize] += 1;
        }
        let share = |&x: &u32| stationary[x as usize] / f64::from(members[x as usize]);
        let shares: Vec<f64> = map.as_slice().iter().map(share).collect();
        (arrays::vector(py, map.as_slice().to_vec()).into_any(), arrays::vector(py, shares).into_any())
    }

    /// Steps of the levels that are asked for, and why there are as many.
    #[pyo3(signature = (levels=None, voices=None, lengths=None, fwhm=None, reach=None))]
    fn levels(
        &self,
        levels: Option<usize>,
        voices: Option<usize>,
        lengths: Option<Vec<Bound<'_, PyAny>>>,
        fwhm: Option<Vec<Bound<'_, PyAny>>>,
        reach: Option<f64>,
    ) -> PyResult<(Vec<f64>, String)> {
        let widths = |given: Vec<Bound<'_, PyAny>>| given.iter().map(length).collect::<PyResult<Vec<Length>>>();
        let spec = match (lengths, fwhm, levels, voices) {
            (Some(lengths), ..) => LevelSpec::Widths(widths(lengths)?),
            (None, Some(fwhm), ..) => LevelSpec::from_fwhm(&widths(fwhm)?),
            (None, None, levels, Some(voices)) => LevelSpec::Voices { levels, voices },
            (None, None, Some(levels), None) => LevelSpec::Dyadic(levels),
            (None, None, None, None) => LevelSpec::Default,
        };
        let extent = reach.unwrap_or(adwave::bands::DEFAULT_EXTENT);
        let resolved = spec.resolve(&self.decomposer, extent).map_err(|e| error::of(&e))?;
        Ok((resolved.schedule.steps().to_vec(), resolved.reason))
    }

    /// σ of the signal itself, 0, and of each level.
    fn sigma(&self, steps: Vec<f64>) -> PyResult<Vec<f64>> {
        Ok(schedule(steps)?.sigma(self.decomposer.diffusion().step_length()))
    }

    /// Bytes that bands take: the work, and the result.
    fn bytes(&self, n_channels: usize, n_levels: usize) -> (u64, u64) {
        let values = (n_levels as u64 + 1) * self.decomposer.n_vertices() as u64 * n_channels as u64;
        (Transform::forecast_bytes(self.decomposer.diffusion(), n_channels), 8 * values)
    }

    /// Bands in one array, W_1 … W_J and S_J; the bound of their errors, the degree, the bytes it took.
    #[pyo3(signature = (signal, steps, accuracy, progress=None))]
    fn bands<'py>(
        &self,
        py: Python<'py>,
        signal: Option<PyReadonlyArray2<'_, f64>>,
        steps: Vec<f64>,
        accuracy: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, f64, u64, u64)> {
        let signal = self.signal(signal.as_ref())?;
        let schedule = schedule(steps)?;
        let n = self.decomposer.n_vertices();
        let bands = run(py, n, progress.as_ref(), |p| self.request(signal, &schedule, accuracy, p).bands())?;
        let info = &bands.info;
        let (error, degree, bytes) = (info.error_bound, info.degree, info.bytes);
        Ok((arrays::levels(py, bands.into_vec(), n, signal.1)?.into_any(), error, degree, bytes))
    }

    /// `Σ_j factors[j−1]·W_j` by one polynomial.
    #[pyo3(signature = (signal, steps, factors, accuracy, progress=None))]
    fn weighted<'py>(
        &self,
        py: Python<'py>,
        signal: Option<PyReadonlyArray2<'_, f64>>,
        steps: Vec<f64>,
        factors: Vec<f64>,
        accuracy: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let signal = self.signal(signal.as_ref())?;
        let (schedule, n) = (schedule(steps)?, self.decomposer.n_vertices());
        let (sum, _) = run(py, n, progress.as_ref(), |p| {
            self.request(signal, &schedule, accuracy, p).weighted(&factors)
        })?;
        Ok(arrays::matrix(py, sum, signal.1)?.into_any())
    }

    /// Bands that are kept for edit after edit.
    #[pyo3(signature = (signal, steps, accuracy, progress=None))]
    fn editor(
        &self,
        py: Python<'_>,
        signal: Option<PyReadonlyArray2<'_, f64>>,
        steps: Vec<f64>,
        accuracy: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<EditorData> {
        let signal = self.signal(signal.as_ref())?;
        let schedule = schedule(steps)?;
        let n = self.decomposer.n_vertices();
        let editor =
            run(py, n, progress.as_ref(), |p| self.request(signal, &schedule, accuracy, p).editor())?;
        Ok(EditorData::new(editor, signal.1, self.shape.clone_ref(py)))
    }

    /// Positions after a filter, with what is asked of directions, borders and volume.
    #[pyo3(signature = (after, along=None, border="natural", volume="free", progress=None))]
    fn settled<'py>(
        &self,
        py: Python<'py>,
        after: PyReadonlyArray2<'_, f64>,
        along: Option<&str>,
        border: &str,
        volume: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let after = arrays::points(&after, "points")?.to_vec();
        let geometry = self.decomposer.geometry();
        let Some(before) = geometry.shape().points().filter(|_| !geometry.points().is_empty()) else {
            return Ok(arrays::point_rows(py, after)?.into_any());
        };
        let params = PositionParams {
            along: along.map(|along| named("along", along)).transpose()?,
            borders: named("border", border)?,
            volume: named("volume", volume)?,
        };
        let n = before.len();
        let points = run(py, n, progress.as_ref(), |p| settle(&self.decomposer, before, after, &params, p))?;
        Ok(arrays::point_rows(py, points)?.into_any())
    }

    /// The weights of a region in its text form, one for each vertex.
    fn region<'py>(&self, py: Python<'py>, region: &str) -> PyResult<Bound<'py, PyAny>> {
        let weights = weights(py, &self.decomposer, self.shape.get(), region)?;
        let map = self.decomposer.geometry().vertex_map();
        let weights = run(py, self.n_vertices(), None, |_| Ok::<_, Cancelled>(weights.to_vertices(map)))?;
        Ok(arrays::vector(py, weights).into_any())
    }

    /// φ and ψ of one vertex on the last of these levels, and at how many vertices φ is not 0.
    #[pyo3(signature = (vertex, steps, progress=None))]
    fn vertex_functions<'py>(
        &self,
        py: Python<'py>,
        vertex: usize,
        steps: Vec<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, usize)> {
        let (schedule, n) = (schedule(steps)?, self.decomposer.n_vertices());
        let found = run(py, n, progress.as_ref(), |p| self.decomposer.basis_of_vertex(vertex, &schedule, p))?;
        let (phi, psi) = (arrays::vector(py, found.scaling_function), arrays::vector(py, found.wavelet));
        Ok((phi.into_any(), psi.into_any(), found.support))
    }

    #[getter]
    fn is_graph(&self) -> bool {
        matches!(self.decomposer.geometry().shape(), Shape::Graph(_))
    }
}

/// The weights of a region's text.
pub(crate) fn weights(
    py: Python<'_>,
    decomposer: &Decomposer,
    shape: &ShapeData,
    region: &str,
) -> PyResult<RegionWeights> {
    let region = parse_region(region).map_err(|e| value(format!("region: {e}")))?;
    let names = shape.field_names();
    run(py, decomposer.n_vertices(), None, |progress| {
        let lookup = |name: &str| shape.region_field(decomposer, name);
        region.weights(decomposer.metric(), &lookup, &names, progress)
    })
}
