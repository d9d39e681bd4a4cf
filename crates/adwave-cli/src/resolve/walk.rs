//! From the flags of a walk to its powers.

use super::shape::{Carrier, Input, ShapeSource};
use crate::args::{GivenWalkArgs, OPERATOR_OPTIONS, SCALE_NEIGHBOR, WalkArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, has_extension, note, number};
use adwave::bands::Precision;
use adwave::operator::{Diffusion, Semigroup};
use adwave::rows::CompressedRows;
use adwave_graph::{
    DimensionedPoints, GraphWalkError, KernelName, SelfLoops, WalkAccuracy, WalkMatrix, WalkOptions,
    WalkPowers, kernel_weights, nearest_lists,
};
use adwave_io::{
    Direction, Edges, ShapeFile, ShapeKind, open_text, read_csv_matrix, read_edge_rows, read_matrix_market,
    read_npy,
};
use serde_json::{Value, json};
use std::io::BufRead;
use std::path::{Path, PathBuf};

/// Number of nearest neighbors of a point.
const NEIGHBORS: usize = 15;

/// Options of a walk that a command takes unless others are given.
#[derive(Clone, Copy)]
pub(crate) struct WalkDefaults {
    /// Weight of the loops.
    pub(crate) self_loops: f64,
    /// Share of the steps that stay.
    pub(crate) stay: f64,
}

/// A walk with its description.
pub(crate) struct ResolvedWalk {
    pub(crate) powers: WalkPowers,
    /// Construction of the walk in words.
    pub(crate) text: String,
    pub(crate) json: Value,
}

/// Reads or builds the walk.
pub(crate) fn load_walk(
    args: &WalkArgs,
    defaults: WalkDefaults,
    global: &Global<'_>,
) -> Result<ResolvedWalk, CliError> {
    let source = match (&args.graph, &args.walk, &args.points) {
        (Some(path), _, _) => WalkSource { path, content: WalkContent::Graph(None) },
        (_, Some(path), _) => WalkSource { path, content: WalkContent::Walk },
        (_, _, Some(path)) => WalkSource { path, content: WalkContent::Points(None) },
        _ => return Err(CliError::Input("give --graph, --walk or --points".to_owned())),
    };
    load_walk_from(source, args, defaults, global)
}

/// File of a walk, and its content.
pub(crate) struct WalkSource<'a> {
    pub(crate) path: &'a Path,
    pub(crate) content: WalkContent,
}

/// Content of the file of a walk; `None` if it is still to be read.
pub(crate) enum WalkContent {
    /// Weights of a graph.
    Graph(Option<CompressedRows<f64>>),
    /// Probabilities.
    Walk,
    /// Coordinates and their number of dimensions.
    Points(Option<(Vec<f64>, usize)>),
}

/// Builds the walk of a source.
pub(crate) fn load_walk_from(
    source: WalkSource<'_>,
    args: &WalkArgs,
    defaults: WalkDefaults,
    global: &Global<'_>,
) -> Result<ResolvedWalk, CliError> {
    if !matches!(source.content, WalkContent::Points(_)) {
        global.given.refuse(&["--neighbors", "--kernel"], "applies to points (--points)")?;
    }
    if !matches!(source.content, WalkContent::Graph(_)) {
        global.given.refuse(&["--symmetrize"], "applies to a graph (--graph); kernels are symmetric")?;
    }
    let (walk, source) = if matches!(source.content, WalkContent::Walk) {
        let path = source.path;
        let options = ["--self-loops", "--normalize", "--stay"];
        global
            .given
            .refuse(&options, "applies to weights (--graph, --points); a given walk is taken as it is")?;
        let matrix = read_matrix(path, global)?;
        let built =
            with_progress(global, "preparing", |progress| WalkMatrix::from_probabilities(matrix, progress));
        (built.map_err(|e| in_file(path, &e))?, "as given".to_owned())
    } else {
        build_walk(source, args, defaults, global)?
    };
    let n_isolated = walk.n_isolated();
    if n_isolated > 0 {
        let text = format!(
            "{} without neighbors: values stay there as they are",
            count(n_isolated, "node is", "nodes are")
        );
        note(global, &text);
    }
    if !walk.is_reversible() {
        note(
            global,
            "the walk is directed: it is applied power by power, in whole steps (--symmetrize makes weights symmetric)",
        );
    }
    let (n, n_entries) = (walk.n_nodes(), walk.rows().nnz());
    let text =
        format!("{}, {}; walk {source}", count(n, "node", "nodes"), count(n_entries, "entry", "entries"));
    let json = json!({
        "nodes": n,
        "entries": n_entries,
        "isolated": n_isolated,
        "reversible": walk.is_reversible(),
        "normalization": walk.normalization().name(),
        "walk": source,
    });
    let powers = with_progress(global, "preparing", |progress| {
        WalkPowers::new(walk, progress).map_err(GraphWalkError::from)
    })?;
    Ok(ResolvedWalk { powers, text, json })
}

/// Builds a walk from weights, with its description.
fn build_walk(
    source: WalkSource<'_>,
    args: &WalkArgs,
    defaults: WalkDefaults,
    global: &Global<'_>,
) -> Result<(WalkMatrix, String), CliError> {
    let self_loops = match args.self_loops.as_deref() {
        None => SelfLoops::Weight(defaults.self_loops),
        Some(text) => SelfLoops::from_text(text).ok_or_else(|| {
            CliError::Input(format!("--self-loops must be a weight or \"keep\", got {text}"))
        })?,
    };
    let options = WalkOptions {
        self_loops,
        symmetrization: args.symmetrize,
        normalization: args.normalize.unwrap_or_default(),
        stay: args.stay.unwrap_or(defaults.stay),
    };
    let path = source.path;
    let (weights, source) = match source.content {
        WalkContent::Graph(Some(rows)) => (rows, "on the graph of the file".to_owned()),
        WalkContent::Graph(None) | WalkContent::Walk => {
            (read_graph(path, global)?, "on the graph".to_owned())
        }
        WalkContent::Points(points) => {
            let (k, kernel) =
                (args.neighbors.map_or(NEIGHBORS, Into::into), args.kernel.unwrap_or(KernelName::Adaptive));
            let (values, n_dimensions) = match points {
                Some(points) => points,
                None => read_table(path, global)?,
            };
            let weights = with_progress(global, "finding neighbors", |progress| {
                let lists = nearest_lists(DimensionedPoints { values: &values, n_dimensions }, k, progress)?;
                kernel_weights(&lists, kernel.with_scale(1.0, SCALE_NEIGHBOR), progress)
            });
            let source = format!("to the {k} nearest neighbors of points in {n_dimensions} dimensions");
            (weights.map_err(|e| in_file(path, &e))?, source)
        }
    };
    let walk = with_progress(global, "preparing", |progress| {
        WalkMatrix::from_weights(weights, options, progress).map_err(|e| in_file(path, &e))
    })?;
    let loops = match self_loops {
        SelfLoops::Weight(weight) => format!("loops of weight {weight}"),
        _ => "loops as in the file".to_owned(),
    };
    let text = format!(
        "{source}, {loops}, {} normalization, {} of the steps stay",
        walk.normalization().name(),
        options.stay
    );
    Ok((walk, text))
}

/// A line about the error of single precision; empty for double.
pub(crate) fn single_precision_line(accuracy: WalkAccuracy, values: &str, relative_to: &str) -> String {
    match accuracy.precision {
        Precision::Single => {
            let bound = number(accuracy.error_bound);
            format!("single precision: {values} are off by at most {bound}, {relative_to}\n")
        }
        _ => String::new(),
    }
}

/// Number format of the products, and the bound of their errors.
pub(crate) fn accuracy_json(accuracy: WalkAccuracy) -> Value {
    json!({"precision": accuracy.precision.name(), "error_bound": accuracy.error_bound})
}

/// An error about a file.
pub(crate) fn in_file(path: &Path, error: &impl adwave::ClassifiedError) -> CliError {
    match CliError::classify(error) {
        CliError::Input(text) => CliError::Input(format!("{}: {text}", path.display())),
        other => other,
    }
}

/// A matrix of probabilities from a file.
pub(crate) struct GivenWalk {
    pub(crate) path: PathBuf,
    pub(crate) rows: CompressedRows<f64>,
}

/// A shape with the walk that the arguments give, if they do, and notes on its kind.
pub(crate) fn with_given_walk(
    mut input: Input,
    args: &GivenWalkArgs,
    global: &Global<'_>,
) -> Result<Input, CliError> {
    let Some(path) = &args.walk else { return Ok(input) };
    global.given.refuse(&OPERATOR_OPTIONS, "applies to the shape's own walk (not with --walk)")?;
    let rows = read_matrix(path, global)?;
    let n = input.shape.n_vertices();
    if rows.n_rows() != n {
        let rows = count(rows.n_rows(), "row", "rows");
        return Err(CliError::Input(format!(
            "{}: a walk needs a row for each of {}, got {rows}",
            path.display(),
            input.count_rows()
        )));
    }
    let walk = with_progress(global, "preparing", |progress| Diffusion::from_walk(&rows, progress))
        .map_err(|e| in_file(path, &e))?;
    if !walk.is_reversible() {
        note(
            global,
            "the walk is directed: it takes whole steps, power by power; one with symmetric weights would not",
        );
    } else if walk.semigroup() == Semigroup::PlainSteps {
        note(
            global,
            "the walk need not stay where it is: it takes whole steps; half of P and half of I would not",
        );
    }
    input.carrier = Carrier::Walk(GivenWalk { path: path.clone(), rows });
    Ok(input)
}

/// Points of a table: in the plane or in space a cloud, unless a graph is asked for; in more dimensions the graph of
/// the nearest neighbors, with the weights of the adaptive kernel.
pub(crate) fn read_points(
    path: &Path,
    source: &ShapeSource<'_>,
    global: &Global<'_>,
) -> Result<ShapeFile, CliError> {
    let (values, n_dimensions) = read_table(path, global)?;
    let is_in_space = matches!(n_dimensions, 2 | 3);
    match source.kind {
        Some(ShapeKind::Cloud) if !is_in_space => {
            return Err(CliError::Input(format!(
                "{}: a cloud has two or three columns, got {n_dimensions}; leave out --as to take the graph of the nearest \
                 neighbors",
                path.display()
            )));
        }
        Some(ShapeKind::Cloud) | None if is_in_space => {
            let points = values.chunks_exact(n_dimensions);
            let points = points.map(|p| [p[0], p[1], p.get(2).copied().unwrap_or(0.0)]).collect();
            global.inputs.add_remark(format!(
                "{}: a cloud of points in {n_dimensions} dimensions; --as graph takes the graph of their nearest neighbors, \
                 without lengths",
                path.display()
            ));
            return Ok(ShapeFile::from_cloud(points));
        }
        _ => {}
    }
    let k = source.neighbors.unwrap_or(NEIGHBORS);
    let points = DimensionedPoints { values: &values, n_dimensions };
    let kernel = KernelName::Adaptive.with_scale(1.0, SCALE_NEIGHBOR);
    let weights = nearest_lists(points, k, global.progress())
        .and_then(|lists| kernel_weights(&lists, kernel, global.progress()))
        .map_err(|e| in_file(path, &e))?;
    global.inputs.add_remark(format!(
        "{}: a graph of the {k} nearest neighbors of points in {n_dimensions} dimensions (--neighbors), without lengths",
        path.display()
    ));
    let mut edges = Edges { direction: Direction::Both, ..Edges::default() };
    for x in 0..weights.n_rows() {
        let (others, values) = weights.row(x);
        for (&y, &w) in others.iter().zip(values).filter(|(y, _)| **y as usize > x) {
            edges.pairs.push([x as u32, y]);
            edges.weights.push(w);
        }
    }
    Ok(ShapeFile::from_graph(weights.n_rows(), edges))
}

/// Opens a text file, plain or gzip.
fn open(path: &Path, global: &Global<'_>) -> Result<Box<dyn BufRead>, CliError> {
    global.inputs.add_file(path);
    open_text(path, &global.limits)
        .map_err(|e| CliError::Input(format!("cannot read {}: {e}", path.display())))
}

/// Reads a sparse matrix.
pub(crate) fn read_matrix(path: &Path, global: &Global<'_>) -> Result<CompressedRows<f64>, CliError> {
    let lines = open(path, global)?;
    with_progress(global, "reading", |progress| {
        read_matrix_market(lines, progress).map_err(|e| in_file(path, &e))
    })
}

/// Reads the weights of a graph, as a matrix or as a list of edges.
fn read_graph(path: &Path, global: &Global<'_>) -> Result<CompressedRows<f64>, CliError> {
    let name = crate::output::without_gzip(path);
    if has_extension(&name, &["mtx"]) {
        return read_matrix(path, global);
    }
    let lines = open(path, global)?;
    let list = with_progress(global, "reading", |progress| {
        read_edge_rows(lines, 0, progress).map_err(|e| in_file(path, &e))
    })?;
    if list.n_repeated > 0 {
        let text = format!(
            "{} another; their weights were added",
            count(list.n_repeated, "edge repeats", "edges repeat")
        );
        note(global, &text);
    }
    Ok(list.weights)
}

/// Numbers of a table, row after row.
pub(crate) struct NamedTable {
    pub(crate) values: Vec<f64>,
    pub(crate) n_columns: usize,
    /// Names of the columns; empty if the file has none.
    pub(crate) names: Vec<String>,
}

/// Reads a table of numbers with its number of columns.
pub(crate) fn read_table(path: &Path, global: &Global<'_>) -> Result<(Vec<f64>, usize), CliError> {
    read_named_table(path, global).map(|table| (table.values, table.n_columns))
}

/// Reads a table of numbers with the names of its columns.
pub(crate) fn read_named_table(path: &Path, global: &Global<'_>) -> Result<NamedTable, CliError> {
    if has_extension(&crate::output::without_gzip(path), &["csv", "tsv"]) {
        global.inputs.add_file(path);
        let table =
            with_progress(global, "reading", |progress| read_csv_matrix(path, &global.limits, progress))
                .map_err(CliError::input)?;
        return Ok(NamedTable { values: table.values, n_columns: table.n_columns, names: table.names });
    }
    if !has_extension(path, &["npy"]) {
        return Err(CliError::Input(format!(
            "{}: tables of numbers are read from .npy (numpy.save) and .csv, with a row for each node",
            path.display()
        )));
    }
    global.inputs.add_file(path);
    let array = read_npy(path, &global.limits).map_err(CliError::input)?;
    if array.shape.len() > 2 || array.shape.is_empty() {
        let text = format!("{}: a table has one or two dimensions, got {:?}", path.display(), array.shape);
        return Err(CliError::Input(text));
    }
    let n_columns = array.shape.get(1).copied().unwrap_or(1);
    Ok(NamedTable { values: array.values.to_f64(), n_columns, names: Vec::new() })
}
