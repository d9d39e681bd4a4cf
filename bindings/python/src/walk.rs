//! Walks on graphs and on points of any dimension: powers, imputation and scattering.

use crate::arrays;
use crate::call::run;
use crate::error::value_error;
use crate::options::parse_name;
use adwave::Cancelled;
use adwave::rows::CompressedRows;
use adwave_graph::{
    ComparedGraph, ComponentScaling, CountMatrix, CountValues, CrossValidationParams, DimensionedPoints,
    GraphChoiceParams, ImputationInput, KernelName, NearestLists, ScatteringParams, SelfLoops,
    Transformation, WalkAccuracy, WalkMatrix, WalkOptions, WalkPowers, choose_graph, cross_validate,
    impute_into, kernel_weights, nearest_lists, pool, principal_components, scatter, split_counts,
};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<WalkData>()?;
    module.add_function(wrap_pyfunction!(nearest, module)?)?;
    module.add_function(wrap_pyfunction!(neighbor_weights, module)?)?;
    module.add_function(wrap_pyfunction!(pool_graphs, module)?)?;
    module.add_function(wrap_pyfunction!(choose_cell_graph, module)?)?;
    module.add_function(wrap_pyfunction!(count_components, module)?)?;
    module.add_function(wrap_pyfunction!(split_molecules, module)?)
}

/// Values, column indices and offsets: the arguments of `scipy.sparse.csr_array`.
type WeightArrays<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<i64>>);

/// Scattering coefficients, paths × n × channels, the bands of each path, and the accuracy.
type ScatteredValues<'py> = (Bound<'py, PyArray3<f64>>, Vec<Vec<u32>>, NamedAccuracy);

/// Values, n × channels, and the accuracy.
type ImputedValues<'py> = (Bound<'py, PyArray2<f64>>, NamedAccuracy);

/// Number format by its name, and the bound of the error.
type NamedAccuracy = (&'static str, f64);

/// Offsets, indices and distances of neighbors.
type NeighborArrays<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<f64>>);

/// Options of a walk from weights; `None` for a walk as given.
#[derive(FromPyObject)]
struct WalkChoices {
    /// `"keep"`, or a weight as text.
    self_loops: String,
    symmetrize: Option<String>,
    normalize: String,
    stay: f64,
}

impl WalkChoices {
    fn options(&self) -> PyResult<WalkOptions> {
        Ok(WalkOptions {
            self_loops: SelfLoops::from_text(&self.self_loops)
                .ok_or_else(|| value_error("self_loops must be a number or 'keep'"))?,
            symmetrization: self
                .symmetrize
                .as_ref()
                .map(|rule| parse_name("symmetrize", rule))
                .transpose()?,
            normalization: parse_name("normalize", &self.normalize)?,
            stay: self.stay,
        })
    }
}

/// Numbers of a C-contiguous array of three dimensions.
fn values3<'a>(array: &'a PyReadonlyArray3<'_, f64>, name: &str) -> PyResult<&'a [f64]> {
    if !array.is_c_contiguous() {
        return Err(value_error(format!("{name} must be C-contiguous")));
    }
    array.as_slice().map_err(|e| value_error(format!("{name}: {e}")))
}

/// A walk prepared for its powers.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct WalkData {
    pub(crate) powers: WalkPowers,
}

#[pymethods]
impl WalkData {
    #[new]
    #[pyo3(signature = (offsets, columns, values, choices, progress=None))]
    fn new(
        py: Python<'_>,
        offsets: PyReadonlyArray1<'_, i64>,
        columns: PyReadonlyArray1<'_, u32>,
        values: PyReadonlyArray1<'_, f64>,
        choices: Option<WalkChoices>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let offsets: Vec<usize> = offsets.as_slice()?.iter().map(|&at| at.max(0) as usize).collect();
        let (columns, values) = (columns.as_slice()?.to_vec(), values.as_slice()?.to_vec());
        let n = offsets.len().saturating_sub(1);
        let options = choices.map(|choices| choices.options()).transpose()?;
        let powers = run(py, n, progress.as_ref(), move |p| {
            let rows = CompressedRows::new(offsets, columns, values, n)?;
            let walk = match options {
                Some(options) => WalkMatrix::from_weights(rows, options, p)?,
                None => WalkMatrix::from_probabilities(rows, p)?,
            };
            Ok::<_, adwave_graph::GraphWalkError>(WalkPowers::new(walk, p)?)
        })?;
        Ok(Self { powers })
    }

    #[getter]
    fn n_nodes(&self) -> usize {
        self.powers.n_nodes()
    }

    #[getter]
    fn n_isolated(&self) -> usize {
        self.powers.walk().n_isolated()
    }

    #[getter]
    fn is_reversible(&self) -> bool {
        self.powers.walk().is_reversible()
    }

    #[getter]
    fn normalization(&self) -> &'static str {
        self.powers.walk().normalization().name()
    }

    /// The matrix of the walk.
    fn matrix<'py>(&self, py: Python<'py>) -> WeightArrays<'py> {
        to_arrays(py, self.powers.walk().rows())
    }

    /// ``Pᵗ f`` of n × channels values.
    #[pyo3(signature = (signal, steps, progress=None))]
    fn apply<'py>(
        &self,
        py: Python<'py>,
        signal: PyReadonlyArray2<'_, f64>,
        steps: u32,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let n_channels = signal.shape()[1];
        let signal = arrays::rows(&signal, "signal")?;
        let out = run(py, usize::MAX, progress.as_ref(), |p| {
            let mut out = vec![0.0; signal.len()];
            self.powers.apply_into(signal, n_channels, steps, &mut out, p)?;
            Ok::<_, adwave_graph::GraphWalkError>(out)
        })?;
        arrays::matrix(py, out, n_channels)
    }

    /// Bands between scales and the remainder, (J + 1) × n × channels.
    fn bands<'py>(
        &self,
        py: Python<'py>,
        signal: PyReadonlyArray2<'_, f64>,
        scales: Vec<u32>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let [n, n_channels] = [signal.shape()[0], signal.shape()[1]];
        let signal = arrays::rows(&signal, "signal")?;
        let out = run(py, n, None, |p| {
            let mut out = vec![0.0; (scales.len() + 1) * signal.len()];
            self.powers.bands_into(signal, n_channels, &scales, &mut out, p)?;
            Ok::<_, adwave_graph::GraphWalkError>(out)
        })?;
        arrays::levels(py, out, n, n_channels)
    }

    /// Adjoint of `bands`, n × channels.
    fn adjoint<'py>(
        &self,
        py: Python<'py>,
        gradients: PyReadonlyArray3<'_, f64>,
        scales: Vec<u32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let n_channels = gradients.shape()[2];
        let gradients = values3(&gradients, "gradients")?;
        let n = self.powers.n_nodes();
        let out = run(py, n, None, |p| {
            let mut out = vec![0.0; n * n_channels];
            self.powers.adjoint_into(gradients, n_channels, &scales, &mut out, p)?;
            Ok::<_, adwave_graph::GraphWalkError>(out)
        })?;
        arrays::matrix(py, out, n_channels)
    }

    /// Scattering coefficients, paths × n × channels, the paths, and the accuracy.
    #[pyo3(signature = (signal, choices, progress=None))]
    fn scatter<'py>(
        &self,
        py: Python<'py>,
        signal: PyReadonlyArray2<'_, f64>,
        choices: ScatteringChoices,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<ScatteredValues<'py>> {
        let [n, n_channels] = [signal.shape()[0], signal.shape()[1]];
        let signal = arrays::rows(&signal, "signal")?;
        let ScatteringChoices { scales, orders, precision } = choices;
        let precision = parse_name("precision", &precision)?;
        let params = ScatteringParams::default()
            .with_scales(scales)
            .with_orders(orders)
            .with_precision(precision)
            .with_max_bytes(adwave_io::free_memory());
        let found = run(py, usize::MAX, progress.as_ref(), |p| {
            scatter(&self.powers, signal, n_channels, &params, p)
        })?;
        let n_paths = found.paths.len();
        let values = arrays::vector(py, found.values).reshape([n_paths, n, n_channels])?;
        Ok((values, found.paths, named_accuracy(found.accuracy)))
    }

    /// ``Pᵗ X`` of all channels of a block of counts, n × channels, and the accuracy.
    fn impute<'py>(
        &self,
        py: Python<'py>,
        counts: PyReadonlyArray2<'_, f64>,
        steps: f64,
        square_root: bool,
        precision: &str,
    ) -> PyResult<ImputedValues<'py>> {
        let n_channels = counts.shape()[1];
        let counts = arrays::rows(&counts, "X")?;
        let channels: Vec<usize> = (0..n_channels).collect();
        let precision = parse_name("precision", precision)?;
        let (out, accuracy) = run(py, usize::MAX, None, |p| {
            let counts = CountMatrix { values: CountValues::Dense(counts), n_channels };
            let transformation = Transformation { library_size: None, square_root };
            let mut out = vec![0.0; self.powers.n_nodes() * n_channels];
            let input = ImputationInput { counts, transformation, channels: &channels, precision };
            let accuracy = impute_into(&self.powers, input, steps, &mut out, p)?;
            Ok::<_, adwave_graph::GraphWalkError>((out, accuracy))
        })?;
        Ok((arrays::matrix(py, out, n_channels)?, named_accuracy(accuracy)))
    }

    /// Number of steps by cross-validation of counts in compressed rows, and the error of each number.
    #[pyo3(signature = (counts, split, progress=None))]
    fn cross_validate(
        &self,
        py: Python<'_>,
        counts: CountColumns<'_>,
        split: SplitChoices,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(u32, Vec<f64>, Vec<usize>, bool)> {
        let CountColumns { offsets, columns, values, n_channels } = counts;
        let offsets: Vec<usize> = offsets.as_slice()?.iter().map(|&at| at.max(0) as usize).collect();
        let (columns, values) = (columns.as_slice()?.to_vec(), values.as_slice()?.to_vec());
        let SplitChoices { share, library_size, seed, most_steps } = split;
        let params = CrossValidationParams::default()
            .with_share(share)
            .with_library_size(library_size)
            .with_seed(seed)
            .with_most_steps(most_steps);
        let found = run(py, usize::MAX, progress.as_ref(), |p| {
            let rows = CompressedRows::new(offsets, columns, values, n_channels)?;
            cross_validate(
                &self.powers,
                &CountMatrix { values: CountValues::Sparse(&rows), n_channels },
                params,
                p,
            )
        })?;
        Ok((found.steps, found.errors, found.channels, found.is_at_limit))
    }
}

/// Counts in compressed rows.
#[derive(FromPyObject)]
struct CountColumns<'py> {
    offsets: PyReadonlyArray1<'py, i64>,
    columns: PyReadonlyArray1<'py, u32>,
    values: PyReadonlyArray1<'py, f64>,
    n_channels: usize,
}

impl CountColumns<'_> {
    fn rows(&self) -> PyResult<CompressedRows<f64>> {
        let offsets: Vec<usize> = self.offsets.as_slice()?.iter().map(|&at| at.max(0) as usize).collect();
        let (columns, values) = (self.columns.as_slice()?.to_vec(), self.values.as_slice()?.to_vec());
        CompressedRows::new(offsets, columns, values, self.n_channels).map_err(|e| value_error(e.to_string()))
    }
}

/// Comparison of graphs: the transformation of the values, and the seed.
#[derive(FromPyObject)]
struct ComparisonChoices {
    library_size: Option<f64>,
    square_root: bool,
    seed: u64,
}

/// Scaling, components, neighbors, steps and loss of a graph that was compared.
type NamedGraph = (&'static str, usize, usize, u32, f64);

/// The chosen graph, steps by channel, losses of 1, 2, … steps, all graphs, numbers of cells and of held-back channels.
type NamedChoice = (NamedGraph, Vec<u32>, Vec<f64>, Vec<NamedGraph>, usize, usize);

/// Chooses the graph of cells and the times of imputation; none of few cells or channels.
#[pyfunction]
#[pyo3(signature = (counts, choices, progress=None))]
fn choose_cell_graph(
    py: Python<'_>,
    counts: CountColumns<'_>,
    choices: ComparisonChoices,
    progress: Option<Py<PyAny>>,
) -> PyResult<Option<NamedChoice>> {
    let (rows, n_channels) = (counts.rows()?, counts.n_channels);
    let ComparisonChoices { library_size, square_root, seed } = choices;
    let params = GraphChoiceParams::default()
        .with_transformation(Transformation { library_size, square_root })
        .with_seed(seed);
    let found = run(py, usize::MAX, progress.as_ref(), |p| {
        choose_graph(&CountMatrix { values: CountValues::Sparse(&rows), n_channels }, params, p)
    })?;
    let named = |graph: &ComparedGraph| {
        (graph.scaling.name(), graph.n_components, graph.n_neighbors, graph.steps, graph.loss)
    };
    Ok(found.map(|choice| {
        let compared = choice.compared.iter().map(named).collect();
        (named(&choice.best), choice.steps, choice.losses, compared, choice.n_cells, choice.n_held_back)
    }))
}

/// Coordinates of cells in the principal components of their counts, n × components.
#[pyfunction]
fn count_components<'py>(
    py: Python<'py>,
    counts: CountColumns<'_>,
    scaling: &str,
    n_components: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (rows, n_channels) = (counts.rows()?, counts.n_channels);
    let scaling: ComponentScaling = parse_name("scaling", scaling)?;
    let found = run(py, usize::MAX, None, |p| {
        let counts = CountMatrix { values: CountValues::Sparse(&rows), n_channels };
        principal_components(&counts, scaling, n_components, p)
    })?;
    arrays::matrix(py, found.coordinates, found.n_components)
}

/// Scales and orders of scattering, and the number format by its name.
#[derive(FromPyObject)]
struct ScatteringChoices {
    scales: Vec<u32>,
    orders: Vec<u32>,
    precision: String,
}

fn named_accuracy(accuracy: WalkAccuracy) -> NamedAccuracy {
    (accuracy.precision.name(), accuracy.error_bound)
}

/// Split of the molecules.
#[derive(FromPyObject)]
struct SplitChoices {
    share: f64,
    library_size: Option<f64>,
    seed: u64,
    most_steps: u32,
}

/// Kernel by its name.
#[derive(FromPyObject)]
struct KernelChoice {
    name: String,
    decay: f64,
    scale_neighbor: usize,
}

fn to_arrays<'py>(py: Python<'py>, rows: &CompressedRows<f64>) -> WeightArrays<'py> {
    let offsets: Vec<i64> = rows.offsets().iter().map(|&at| at as i64).collect();
    (
        arrays::vector(py, rows.values().to_vec()),
        arrays::vector(py, rows.columns().to_vec()),
        arrays::vector(py, offsets),
    )
}

/// Exact nearest neighbors: offsets, indices and distances.
#[pyfunction]
#[pyo3(signature = (points, k, progress=None))]
fn nearest<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'_, f64>,
    k: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<NeighborArrays<'py>> {
    let n_dimensions = points.shape()[1];
    let values = arrays::rows(&points, "points")?;
    let lists = run(py, usize::MAX, progress.as_ref(), |p| {
        nearest_lists(DimensionedPoints { values, n_dimensions }, k, p)
    })?;
    let offsets = lists.offsets.iter().map(|&at| at as i64).collect();
    Ok((arrays::vector(py, offsets), arrays::vector(py, lists.indices), arrays::vector(py, lists.distances)))
}

/// Symmetric weights of neighbors, given as n × k indices with distances, or as lists with offsets.
#[pyfunction]
fn neighbor_weights<'py>(
    py: Python<'py>,
    offsets: PyReadonlyArray1<'_, i64>,
    indices: PyReadonlyArray1<'_, i64>,
    distances: PyReadonlyArray1<'_, f64>,
    kernel: KernelChoice,
) -> PyResult<WeightArrays<'py>> {
    let KernelChoice { name, decay, scale_neighbor } = kernel;
    let kernel = parse_name::<KernelName>("kernel", &name)?.with_scale(decay, scale_neighbor);
    let (offsets, indices, distances) = (offsets.as_slice()?, indices.as_slice()?, distances.as_slice()?);
    let rows = run(py, usize::MAX, None, |p| {
        let lists = if offsets.len() == 1 {
            NearestLists::from_arrays(offsets[0].max(0) as usize, indices, distances)?
        } else {
            NearestLists {
                offsets: offsets.iter().map(|&at| at as usize).collect(),
                indices: indices.iter().map(|&y| y as u32).collect(),
                distances: distances.to_vec(),
            }
        };
        kernel_weights(&lists, kernel, p)
    })?;
    Ok(to_arrays(py, &rows))
}

/// The molecules that cross-validation diffuses, as values of the same compressed rows.
#[pyfunction]
fn split_molecules<'py>(
    py: Python<'py>,
    counts: CountColumns<'_>,
    share: f64,
    seed: u64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let CountColumns { offsets, columns, values, n_channels } = counts;
    let offsets: Vec<usize> = offsets.as_slice()?.iter().map(|&at| at.max(0) as usize).collect();
    let (columns, values) = (columns.as_slice()?.to_vec(), values.as_slice()?.to_vec());
    let train = run(py, usize::MAX, None, |_| {
        let rows = CompressedRows::new(offsets, columns, values, n_channels)?;
        split_counts(&rows, share, seed)
    })?;
    Ok(arrays::vector(py, train.values().to_vec()))
}

/// Statistics over the nodes of each graph: graphs × paths × channels × statistics, flat.
#[pyfunction]
fn pool_graphs<'py>(
    py: Python<'py>,
    values: PyReadonlyArray3<'_, f64>,
    graph_of: PyReadonlyArray1<'_, u32>,
    n_graphs: usize,
    pooling: &str,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let n_channels = values.shape()[2];
    let values = values3(&values, "values")?;
    let graph_of = graph_of.as_slice()?;
    let pooling = parse_name("pool", pooling)?;
    let out = run(py, usize::MAX, None, |_| {
        Ok::<_, Cancelled>(pool(values, n_channels, graph_of, n_graphs, pooling))
    })?;
    Ok(arrays::vector(py, out.map_err(|e| value_error(e.to_string()))?))
}
