//! A shape with its diffusion operator, prepared once.

use crate::arrays;
use crate::call::run;
use crate::error::{self, value_error};
use crate::grid::{GridOptions, grid_decomposer};
use crate::options::{BandsOptions, ConstraintOptions, LevelOptions, OperatorOptions};
use crate::own_operator::OwnOperatorOptions;
use crate::region::region_weights;
use crate::shape::ShapeData;
use crate::walk::WalkData;
use adwave::bands::{BandsParams, DEFAULT_EXTENT, Precision, Schedule};
use adwave::positions::constrain_positions;
use adwave::shape::{PreparedGeometry, Shape, VertexRole, bounding_box};
use adwave::{BandsRequest, Cancelled, Decomposer, LevelSpec, Progress};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A shape with its diffusion operator.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct Prepared {
    pub(crate) decomposer: Decomposer,
    /// Normals of the file, which point outward.
    pub(crate) normals: Option<Vec<f64>>,
    /// The file, whose signals regions may name.
    pub(crate) shape: Py<ShapeData>,
}

/// Values of a signal at the vertices, and their number at each vertex.
#[derive(Clone, Copy)]
pub(crate) struct SignalValues<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) n_channels: usize,
}

impl Prepared {
    /// A signal of the interpreter; the coordinates without one.
    pub(crate) fn signal<'a>(
        &'a self,
        given: Option<&'a PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<SignalValues<'a>> {
        let Some(array) = given else {
            return match self.decomposer.points() {
                Some(points) => Ok(SignalValues { values: points.as_flattened(), n_channels: 3 }),
                None => {
                    Err(value_error("signal: a graph has no coordinates; give one value for each vertex"))
                }
            };
        };
        let [n, d] = [array.shape()[0], array.shape()[1]];
        let n_vertices = self.decomposer.n_vertices();
        if n != n_vertices || d == 0 {
            return Err(value_error(format!(
                "signal must have one row for each of {n_vertices} vertices, got shape ({n}, {d})"
            )));
        }
        Ok(SignalValues { values: arrays::rows(array, "signal")?, n_channels: d })
    }

    /// A request for the bands of a signal.
    pub(crate) fn request<'a>(
        &'a self,
        signal: SignalValues<'a>,
        schedule: &'a Schedule,
        params: &BandsParams,
        progress: Progress<'a>,
    ) -> BandsRequest<'a> {
        self.decomposer.request(signal.values, signal.n_channels, schedule).params(params).progress(progress)
    }
}

/// Levels of these numbers of steps.
pub(crate) fn schedule(steps: &[f64]) -> PyResult<Schedule> {
    Schedule::real(steps.to_vec()).map_err(|e| error::to_exception(&e))
}

#[pymethods]
impl Prepared {
    #[new]
    #[pyo3(signature = (shape, options, progress=None))]
    fn new(
        py: Python<'_>,
        shape: Py<ShapeData>,
        options: OperatorOptions,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let content = shape.get();
        let params = options.params()?.with_corrected_dispersion(content.file.is_map());
        let own = content.shape(py)?;
        let decomposer =
            run(py, own.n_vertices(), progress.as_ref(), |p| Decomposer::with_params(own, &params, p))?;
        let normals = adwave_io::file_normals(&content.file);
        Ok(Self { decomposer, normals, shape })
    }

    /// A grid with heat. The shape has a vertex for each place, and names nothing.
    #[staticmethod]
    fn from_grid(py: Python<'_>, shape: Py<ShapeData>, options: GridOptions<'_>) -> PyResult<Self> {
        Ok(Self { decomposer: grid_decomposer(py, options)?, normals: None, shape })
    }

    /// Some vertices in an order of their own, between which nothing flows where their labels differ.
    fn part(
        &self,
        py: Python<'_>,
        vertices: PyReadonlyArray1<'_, u32>,
        labels: PyReadonlyArray1<'_, u32>,
    ) -> PyResult<Self> {
        let (vertices, labels) = (vertices.as_slice()?, labels.as_slice()?);
        let decomposer = run(py, vertices.len(), None, |p| self.decomposer.part(vertices, labels, p))?;
        Ok(Self { decomposer, normals: None, shape: self.shape.clone_ref(py) })
    }

    /// Domains one after another. The shape has a vertex for each place, and names nothing.
    #[staticmethod]
    fn union(shape: Py<ShapeData>, parts: Vec<PyRef<'_, Self>>) -> PyResult<Self> {
        let parts: Vec<Decomposer> = parts.iter().map(|part| part.decomposer.clone()).collect();
        let decomposer = Decomposer::union(&parts).map_err(|e| error::to_exception(&e))?;
        Ok(Self { decomposer, normals: None, shape })
    }

    /// The shape without some vertices.
    fn with_mask(&self, py: Python<'_>, flags: PyReadonlyArray1<'_, bool>) -> PyResult<Self> {
        let flags = flags.as_slice()?;
        let decomposer = run(py, flags.len(), None, |_| self.decomposer.masked(flags))?;
        Ok(Self { decomposer, normals: self.normals.clone(), shape: self.shape.clone_ref(py) })
    }

    /// The shape with a walk as given.
    fn with_walk(&self, py: Python<'_>, walk: &Bound<'_, WalkData>) -> PyResult<Self> {
        let walk = walk.get().powers.walk();
        if walk.normalization() != adwave_graph::Normalization::Row {
            let error = adwave_graph::GraphWalkError::NotRowStochastic(walk.normalization().name());
            return Err(error::to_exception(&error));
        }
        let decomposer = run(py, usize::MAX, None, |p| self.decomposer.with_walk(walk.rows(), p))?;
        Ok(Self { decomposer, normals: None, shape: self.shape.clone_ref(py) })
    }

    /// The shape with an operator that a function computes.
    fn with_operator(&self, py: Python<'_>, own: OwnOperatorOptions<'_>) -> PyResult<Self> {
        self.with_own_operator(py, own)
    }

    #[getter]
    fn n_vertices(&self) -> usize {
        self.decomposer.n_vertices()
    }

    /// Default accuracy of the bands of maps and features.
    fn analysis_accuracy(&self) -> f64 {
        self.decomposer.analysis_accuracy()
    }

    /// Share of the extent that the last level for features reaches by default.
    fn feature_extent(&self) -> f64 {
        adwave::features::feature_extent(&self.decomposer)
    }

    #[getter]
    fn operator(&self) -> &'static str {
        self.decomposer.operator_kind().name()
    }

    /// Facts about the shape and its operator.
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
        facts.set_item("bounding_box", d.points().and_then(bounding_box))?;
        facts.set_item("diagonal", d.diagonal())?;
        facts.set_item("extent", d.extent())?;
        let outsiders = d.geometry().map(PreparedGeometry::outsiders).unwrap_or_default();
        for role in VertexRole::OUTSIDE {
            let rows: Vec<usize> =
                outsiders.iter().filter(|(_, own)| *own == role).map(|(row, _)| *row).collect();
            facts.set_item(role.plural(), rows)?;
        }
        facts.set_item("operator", d.operator_kind().name())?;
        facts.set_item("entries", d.n_entries())?;
        facts.set_item("mean_length", d.mean_length())?;
        facts.set_item("step_length", d.operator().step_length())?;
        facts.set_item("reversible", d.operator().is_reversible())?;
        if let Some(info) = d.surface_info() {
            facts.set_item("raised_masses", info.n_raised)?;
            facts.set_item("added_mass", info.added_mass)?;
        }
        Ok(facts)
    }

    /// Size of the largest part without strays, in model units.
    fn extent(&self) -> f64 {
        self.decomposer.extent()
    }

    /// Diagonal, mean length and step length, in model units.
    fn lengths(&self) -> (f64, f64, f64) {
        (self.decomposer.diagonal(), self.decomposer.mean_length(), self.decomposer.operator().step_length())
    }

    /// Number of vertices whose masses were raised, and the share of the area that this adds; `None` for a walk.
    fn raised_masses(&self) -> Option<(usize, f64)> {
        self.decomposer.surface_info().map(|info| (info.n_raised, info.added_mass))
    }

    /// True if the diffusion is reversible.
    fn is_reversible(&self) -> bool {
        self.decomposer.operator().is_reversible()
    }

    /// Area of each vertex.
    fn areas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let areas = run(py, self.n_vertices(), None, |_| Ok::<_, Cancelled>(self.decomposer.areas()))?;
        Ok(arrays::vector(py, areas).into_any())
    }

    /// Index of the welded vertex of each vertex, and the share of each vertex in the stationary distribution.
    fn welding<'py>(&self, py: Python<'py>) -> (Bound<'py, PyAny>, Bound<'py, PyAny>) {
        let map = self.decomposer.vertex_map();
        let shares = self.decomposer.stationary();
        (arrays::vector(py, map.as_slice().to_vec()).into_any(), arrays::vector(py, shares).into_any())
    }

    /// Steps of each level; without levels, of the default ones, up to a share of the extent.
    #[pyo3(signature = (levels=None, extent=None))]
    fn schedule(&self, levels: Option<LevelOptions<'_>>, extent: Option<f64>) -> PyResult<Vec<f64>> {
        let Some(levels) = levels else {
            let spec = LevelSpec::Default.resolve(&self.decomposer, extent.unwrap_or(DEFAULT_EXTENT));
            return Ok(spec.map_err(|e| error::to_exception(&e))?.schedule.steps().to_vec());
        };
        Ok(levels.schedule(&self.decomposer)?.steps().to_vec())
    }

    /// Width σ of the signal itself, 0, and of each level, in model units.
    fn sigma(&self, steps: Vec<f64>) -> PyResult<Vec<f64>> {
        Ok(schedule(&steps)?.sigma(self.decomposer.operator().step_length()))
    }

    /// Bytes that bands need: for the work, and for the result.
    fn bytes(&self, n_channels: usize, n_levels: usize) -> (u64, u64) {
        let values = (n_levels as u64 + 1) * self.decomposer.n_vertices() as u64 * n_channels as u64;
        (self.decomposer.transform().forecast(n_channels), 8 * values)
    }

    /// Bands in one array, W_1 … W_J and S_J, with the error bound, the degree and the memory used.
    #[pyo3(signature = (request, progress=None))]
    fn bands<'py>(
        &self,
        py: Python<'py>,
        request: BandsOptions<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let signal = self.signal(request.signal.as_ref())?;
        let (schedule, params) = (schedule(&request.steps)?, request.params()?);
        let n = self.decomposer.n_vertices();
        let bands = run(py, n, progress.as_ref(), |p| self.request(signal, &schedule, &params, p).bands())?;
        let info = PyDict::new(py);
        info.set_item("error_bound", bands.info.error_bound)?;
        info.set_item("degree", bands.info.degree)?;
        info.set_item("bytes", bands.info.bytes)?;
        info.set_item("accuracy", request.accuracy)?;
        info.set_item("bits", if bands.info.precision == Precision::Single { 32 } else { 64 })?;
        Ok((arrays::levels(py, bands.into_vec(), n, signal.n_channels)?.into_any(), info))
    }

    /// `Σ_j factors[j−1]·W_j` by one polynomial.
    #[pyo3(signature = (request, factors, progress=None))]
    fn combine_bands<'py>(
        &self,
        py: Python<'py>,
        request: BandsOptions<'py>,
        factors: Vec<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let signal = self.signal(request.signal.as_ref())?;
        let (schedule, n) = (schedule(&request.steps)?, self.decomposer.n_vertices());
        let params = request.params()?;
        let (sum, _) = run(py, n, progress.as_ref(), |p| {
            self.request(signal, &schedule, &params, p).weighted(&factors)
        })?;
        Ok(arrays::matrix(py, sum, signal.n_channels)?.into_any())
    }

    /// True if `sum_of_bands` applies to these levels.
    fn has_sum_of_bands(&self, steps: Vec<f64>) -> PyResult<bool> {
        Ok(self.decomposer.mask_flags().is_none()
            && self.decomposer.transform().has_sum_of_bands(&schedule(&steps)?))
    }

    /// `Σ_j W_{h_j}(j)` of one signal of each level: levels × n × channels.
    #[pyo3(signature = (signals, steps, progress=None))]
    fn sum_of_bands<'py>(
        &self,
        py: Python<'py>,
        signals: PyReadonlyArray3<'_, f64>,
        steps: Vec<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (schedule, n) = (schedule(&steps)?, self.decomposer.n_vertices());
        let [n_levels, n_rows, n_channels] = [0, 1, 2].map(|axis| signals.shape()[axis]);
        if n_levels != schedule.n_levels() || n_rows != n || !signals.is_c_contiguous() {
            return Err(value_error(format!(
                "signals must be C-contiguous, {} levels × {n} vertices × channels, got shape {:?}",
                schedule.n_levels(),
                signals.shape()
            )));
        }
        let values = signals.as_slice()?;
        let map = self.decomposer.vertex_map();
        let sum = run(py, n, progress.as_ref(), |p| {
            self.decomposer.transform().sum_of_bands(map, values, n_channels, &schedule, p)
        })?;
        Ok(arrays::matrix(py, sum, n_channels)?.into_any())
    }

    /// Positions after a filter, under constraints on directions, borders and volume.
    #[pyo3(signature = (after, constraints, progress=None))]
    fn constrain_positions<'py>(
        &self,
        py: Python<'py>,
        after: PyReadonlyArray2<'_, f64>,
        constraints: ConstraintOptions,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let after = arrays::points(&after, "points")?.to_vec();
        let Some(before) = self.decomposer.points().filter(|_| !self.decomposer.positions().is_empty())
        else {
            return Ok(arrays::point_rows(py, after)?.into_any());
        };
        let params = constraints.params()?;
        let n = before.len();
        let points = run(py, n, progress.as_ref(), |p| {
            constrain_positions(&self.decomposer, before, after, &params, p)
        })?;
        Ok(arrays::point_rows(py, points)?.into_any())
    }

    /// Weights of a region in its text form, one for each vertex.
    fn region<'py>(&self, py: Python<'py>, region: &str) -> PyResult<Bound<'py, PyAny>> {
        let weights = region_weights(py, &self.decomposer, self.shape.get(), region)?;
        let map = self.decomposer.vertex_map();
        let weights = run(py, self.n_vertices(), None, |_| Ok::<_, Cancelled>(weights.to_vertices(map)))?;
        Ok(arrays::vector(py, weights).into_any())
    }

    /// φ and ψ of one vertex on the last of these levels.
    #[pyo3(signature = (vertex, steps, progress=None))]
    fn vertex_functions<'py>(
        &self,
        py: Python<'py>,
        vertex: usize,
        steps: Vec<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (schedule, n) = (schedule(&steps)?, self.decomposer.n_vertices());
        let found = run(py, n, progress.as_ref(), |p| self.decomposer.basis_of_vertex(vertex, &schedule, p))?;
        let (phi, psi) = (arrays::vector(py, found.scaling_function), arrays::vector(py, found.wavelet));
        Ok((phi.into_any(), psi.into_any()))
    }

    #[getter]
    fn is_graph(&self) -> bool {
        self.decomposer.shape().is_none_or(Shape::is_graph)
    }
}
