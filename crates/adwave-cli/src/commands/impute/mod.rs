//! `adwave impute`: counts averaged over similar cells.

mod anndata;
mod chosen_graph;

use crate::args::{WalkArgs, parse_named, seed as parse_seed};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::{
    check_writable, count, has_extension, note, number, print, table, without_gzip, write_file,
    write_file_with,
};
use crate::resolve::walk::{
    NamedTable, ResolvedWalk, WalkDefaults, accuracy_json, in_file, load_walk, read_matrix, read_named_table,
    single_precision_line,
};
use adwave::bands::Precision;
use adwave::pages::zeros;
use adwave::rows::CompressedRows;
use adwave_graph::{
    AnnDataMatrix, CountMatrix, CountValues, CrossValidation, CrossValidationParams, GraphChoice,
    GraphWalkError, ImputationInput, Transformation, WalkAccuracy, cross_validate, impute_by_channel_into,
    impute_into,
};
use adwave_io::{ArrayValues, write_npy};
use anndata::CellsFile;
use chosen_graph::ChosenGraph;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Rows of the printed curve.
const PRINTED_TIMES: usize = 12;

#[derive(Debug, Args)]
#[command(after_help = "\
COUNTS is a matrix of cells × genes: .npy (numpy.save), .csv with or without names of the cells and genes, a sparse
.mtx, or the X or a layer of an .h5ad (AnnData).
The result is .npy, cells × genes, 64-bit floats; of an .h5ad also a copy of it, .h5ad, with the result as X.
Without --graph, --walk or --points, an .h5ad is walked by its obsp/connectivities, or else by its obsm/X_pca.
Without these, and of other files, the graph is chosen: some genes are held back, and graphs of several numbers of
principal components and neighbors are compared by how well other cells predict these genes. Genes that are mostly
noise take more steps than others.

The time is a number of steps of the walk. On a given graph 'auto' chooses it by molecular cross-validation: a tenth
of the molecules is held back, the others are diffused, and the time whose result predicts the held-back molecules
best is taken. This needs raw counts.

Examples:
  adwave impute counts.mtx -o imputed.npy
  adwave impute cells.h5ad -o imputed.h5ad --layer counts
  adwave impute cells.h5ad -o imputed.h5ad --genes CD4,CD8A --time 3
  adwave impute counts.npy -o imputed.npy --points pca.npy
  adwave impute counts.mtx -o imputed.npy --graph neighbors.mtx --library-size median --sqrt
  adwave impute counts.mtx -o imputed.npy --walk walk.mtx --time 3 --genes 0,17,42")]
pub(crate) struct ImputeArgs {
    /// Matrix of cells × genes (.npy, .csv, .h5ad or .mtx, also .mtx.gz)
    #[arg(value_name = "COUNTS")]
    pub(crate) counts: PathBuf,
    /// File for the result (.npy, or .h5ad of an .h5ad)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Number of steps, or auto
    #[arg(long, value_name = "T", default_value = "auto")]
    pub(crate) time: String,
    /// Genes of the result, columns counted from 0, of an .h5ad or .csv also names [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true)]
    pub(crate) genes: Option<Vec<String>>,
    /// Layer of an .h5ad that has the counts [default: X]
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
    /// Multiply the counts of each cell so that they sum to this number, or to the median
    #[arg(long, value_name = "SIZE")]
    pub(crate) library_size: Option<String>,
    /// Take square roots before diffusion
    #[arg(long)]
    pub(crate) sqrt: bool,
    /// Seed of the molecules, or of the cells and genes, by which is chosen
    #[arg(long, value_name = "K", value_parser = parse_seed, default_value_t = 0)]
    pub(crate) seed: u64,
    /// File for the errors of all times that were tried (.csv)
    #[arg(long, value_name = "FILE")]
    pub(crate) curve: Option<PathBuf>,
    /// Number format of the products; fractional steps take double
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Precision>(), default_value_t = Precision::Double)]
    pub(crate) precision: Precision,
    #[command(flatten)]
    pub(crate) walk: WalkArgs,
}

/// Values of the matrix as read.
enum LoadedCounts {
    Dense(NamedTable),
    Sparse(CompressedRows<f64>),
    InFile(CellsFile, AnnDataMatrix),
}

impl LoadedCounts {
    fn matrix(&self) -> CountMatrix<'_> {
        match self {
            Self::Dense(table) => {
                CountMatrix { values: CountValues::Dense(&table.values), n_channels: table.n_columns }
            }
            Self::Sparse(matrix) => {
                CountMatrix { values: CountValues::Sparse(matrix), n_channels: matrix.n_columns() }
            }
            Self::InFile(_, matrix) => matrix.counts(),
        }
    }

    /// Columns of the genes that are asked for; `None` for all.
    fn genes(&self, args: &ImputeArgs) -> Result<Option<Vec<usize>>, CliError> {
        if let Self::InFile(cells, _) = self {
            return cells.genes(args);
        }
        let Some(genes) = &args.genes else { return Ok(None) };
        let names: &[String] = if let Self::Dense(table) = self { &table.names } else { &[] };
        let column = |gene: &String| {
            let named = names.iter().position(|name| name == gene.trim());
            named.or_else(|| gene.trim().parse().ok()).ok_or_else(|| {
                let known = if names.is_empty() {
                    "columns counted from 0 (names need an .h5ad, or a .csv with a row of names)"
                } else {
                    "the names of its columns, or columns counted from 0"
                };
                let path = args.counts.display();
                CliError::Input(format!("--genes: genes of {path} are {known}, got {gene}"))
            })
        };
        Ok(Some(genes.iter().map(column).collect::<Result<_, _>>()?))
    }
}

pub(crate) fn run(args: &ImputeArgs, global: &Global<'_>) -> Result<(), CliError> {
    check_files(args, global)?;
    let given_time = parse_time(&args.time)?;
    if given_time.is_some() {
        global.given.refuse(&["--seed", "--curve"], "applies to cross-validation (--time auto)")?;
    }
    let counts = load_counts(args, global)?;
    let genes = counts.genes(args)?;
    let matrix = counts.matrix();
    let library_size = library_size(args, &matrix)?;
    let transformation = Transformation { library_size, square_root: args.sqrt };
    let defaults = WalkDefaults { self_loops: 1.0, stay: 0.0 };
    let names_walk = args.walk.graph.is_some() || args.walk.walk.is_some() || args.walk.points.is_some();
    let given = match &counts {
        LoadedCounts::InFile(cells, _) => cells.walk(args, defaults, global)?,
        _ if names_walk => Some(load_walk(&args.walk, defaults, global)?),
        _ => None,
    };
    let (walk, times) = match (given, given_time) {
        (Some(walk), Some(steps)) => (walk, Times::Given(steps)),
        (Some(walk), None) => {
            let found = choose_time(args, &walk, &matrix, library_size, global)?;
            (walk, Times::Molecules(found))
        }
        (None, None) => {
            let ChosenGraph { walk, choice } = chosen_graph::choose(args, &matrix, transformation, global)?;
            (walk, Times::Genes(choice))
        }
        (None, Some(_)) => {
            return Err(CliError::Input(format!(
                "{}: a number of steps needs a walk: give --graph, --walk or --points, or leave out --time",
                args.counts.display()
            )));
        }
    };
    let powers = &walk.powers;
    check_memory(powers.n_nodes(), genes.as_ref().map_or(matrix.n_channels, Vec::len))?;
    let channels = genes.clone().unwrap_or_else(|| (0..matrix.n_channels).collect());
    let mut out = zeros::<f64>(powers.n_nodes() * channels.len());
    let accuracy = with_progress(global, "imputing", |progress| {
        let input = ImputationInput {
            counts: matrix,
            transformation,
            channels: &channels,
            precision: args.precision,
        };
        let done = match &times {
            Times::Genes(choice) => {
                let steps: Vec<u32> = channels.iter().map(|&c| choice.steps[c]).collect();
                impute_by_channel_into(powers, input, &steps, &mut out, progress)
            }
            _ => impute_into(powers, input, times.common(), &mut out, progress),
        };
        done.map_err(|e| in_file(&args.counts, &e))
    })?;
    match &counts {
        LoadedCounts::InFile(cells, _) if has_extension(&args.output, &["h5ad"]) => {
            cells.write(&args.output, &out, genes.as_deref(), global)?;
        }
        _ => with_spinner(global, "writing", || {
            write_file_with(global, &args.output, |path| {
                write_npy(path, &[powers.n_nodes(), channels.len()], ArrayValues::F64(&out))
            })
        })?,
    }
    if let (Some(path), Some(curve)) = (&args.curve, times.curve()) {
        write_file(global, path, curve_csv(&curve).as_bytes())?;
    }
    report(args, &walk, &ImputationOutcome { times, n_genes: channels.len(), accuracy }, global)
}

/// Numbers of steps, and what they were chosen by.
enum Times {
    Given(f64),
    Molecules(CrossValidation),
    Genes(GraphChoice),
}

impl Times {
    /// The number of steps, where genes have their own the common one.
    fn common(&self) -> f64 {
        match self {
            Self::Given(steps) => *steps,
            Self::Molecules(found) => f64::from(found.steps),
            Self::Genes(choice) => f64::from(choice.best.steps),
        }
    }

    /// Errors with their numbers of steps.
    fn curve(&self) -> Option<Vec<(usize, f64)>> {
        match self {
            Self::Given(_) => None,
            Self::Molecules(found) => Some(found.errors.iter().copied().enumerate().collect()),
            Self::Genes(choice) => Some((1..).zip(choice.losses.iter().copied()).collect()),
        }
    }
}

/// Checks that a dense result fits the free memory.
fn check_memory(n_nodes: usize, n_genes: usize) -> Result<(), CliError> {
    let needed = 8 * (n_nodes as u64).saturating_mul(n_genes as u64).min(u64::MAX / 8);
    match adwave_io::free_memory() {
        Some(limit) if needed > limit => {
            let advice = "take some of the genes (--genes)";
            Err(GraphWalkError::TooLarge { needed, limit, advice }.into())
        }
        _ => Ok(()),
    }
}

/// The time by cross-validation.
fn choose_time(
    args: &ImputeArgs,
    walk: &ResolvedWalk,
    matrix: &CountMatrix<'_>,
    library_size: Option<f64>,
    global: &Global<'_>,
) -> Result<CrossValidation, CliError> {
    let params = CrossValidationParams::default().with_library_size(library_size).with_seed(args.seed);
    let found = with_progress(global, "choosing the time", |progress| {
        cross_validate(&walk.powers, matrix, params, progress).map_err(|e| in_file(&args.counts, &e))
    })?;
    note(
        global,
        "a graph that was made from these counts knows the molecules that are held back, and then too few steps are \
         chosen; aw.impute(counts) in Python makes a graph of its own for this",
    );
    if found.is_at_limit {
        note(global, "the error still falls at the largest number of steps that was tried");
    }
    Ok(found)
}

fn check_files(args: &ImputeArgs, global: &Global<'_>) -> Result<(), CliError> {
    let is_anndata = has_extension(&args.counts, &["h5ad"]);
    if has_extension(&args.counts, &["h5", "loom"]) {
        return Err(CliError::Input(format!(
            "{}: counts are read from .npy, .csv, .mtx and .h5ad; convert it by anndata (read_loom, read_10x_h5, write_h5ad)",
            args.counts.display()
        )));
    }
    let can_write = has_extension(&args.output, if is_anndata { &["npy", "h5ad"] } else { &["npy"] });
    if !can_write {
        let also = if is_anndata { " or .h5ad" } else { "" };
        let text = format!("{}: the result is written as .npy{also}", args.output.display());
        return Err(CliError::Input(text));
    }
    if !is_anndata {
        global.given.refuse(&["--layer"], "applies to .h5ad files")?;
    }
    if let Some(curve) = &args.curve {
        check_writable(curve)?;
    }
    check_writable(&args.output)
}

/// A number of steps; `None` for auto.
fn parse_time(text: &str) -> Result<Option<f64>, CliError> {
    match (text, text.parse::<f64>()) {
        ("auto", _) => Ok(None),
        (_, Ok(steps)) if steps.is_finite() && steps >= 0.0 => Ok(Some(steps)),
        _ => Err(CliError::Input(format!(
            "--time must be auto or a number of steps of at least 0, got {text}"
        ))),
    }
}

fn load_counts(args: &ImputeArgs, global: &Global<'_>) -> Result<LoadedCounts, CliError> {
    let path = &args.counts;
    if has_extension(path, &["h5ad"]) {
        let cells = CellsFile::open(path, global)?;
        let counts = cells.counts(args.layer.as_deref(), global)?;
        return Ok(LoadedCounts::InFile(cells, counts));
    }
    if has_extension(&without_gzip(path), &["mtx"]) {
        return Ok(LoadedCounts::Sparse(read_matrix(path, global)?));
    }
    Ok(LoadedCounts::Dense(read_named_table(path, global)?))
}

fn library_size(args: &ImputeArgs, matrix: &CountMatrix<'_>) -> Result<Option<f64>, CliError> {
    match args.library_size.as_deref() {
        None => Ok(None),
        Some("median") => Ok(Some(matrix.median_row_sum())),
        Some(text) => match text.parse::<f64>() {
            Ok(size) if size > 0.0 && size.is_finite() => Ok(Some(size)),
            _ => Err(CliError::Input(format!(
                "--library-size must be median or a number greater than 0, got {text}"
            ))),
        },
    }
}

fn curve_csv(curve: &[(usize, f64)]) -> String {
    let mut text = "steps,error\n".to_owned();
    for (steps, error) in curve {
        text += &format!("{steps},{error}\n");
    }
    text
}

/// Numbers of the report.
struct ImputationOutcome {
    times: Times,
    n_genes: usize,
    accuracy: WalkAccuracy,
}

fn report(
    args: &ImputeArgs,
    walk: &ResolvedWalk,
    outcome: &ImputationOutcome,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let &ImputationOutcome { ref times, n_genes, accuracy } = outcome;
    let mut text = format!("{}\n{}\n", args.counts.display(), walk.text);
    text += &match times {
        Times::Given(steps) => format!("{steps} steps\n"),
        Times::Molecules(found) => molecules_text(found),
        Times::Genes(choice) => chosen_graph::text(choice),
    };
    let relative_to = "relative to the same average of absolute values";
    text += &single_precision_line(accuracy, "values", relative_to);
    text += &format!("{}, {}\n", count(n_genes, "gene", "genes"), args.output.display());
    let json = json!({
        "counts": args.counts.display().to_string(),
        "output": args.output.display().to_string(),
        "graph": walk.json,
        "steps": times.common(),
        "time_is_chosen": !matches!(times, Times::Given(_)),
        "errors": match times {
            Times::Molecules(found) => json!(found.errors),
            _ => Value::Null,
        },
        "choice": match times {
            Times::Genes(choice) => chosen_graph::json(choice),
            _ => Value::Null,
        },
        "genes": n_genes,
        "products": accuracy_json(accuracy),
    });
    print(global, &text, &json)
}

/// The errors by molecules that were held back, some of them.
fn molecules_text(found: &CrossValidation) -> String {
    let mut text = format!(
        "{} by molecular cross-validation over {}\n\n",
        count(found.steps, "step", "steps"),
        count(found.channels.len(), "gene", "genes")
    );
    let apart = found.errors.len().div_ceil(PRINTED_TIMES);
    let shown = (0..found.errors.len()).filter(|t| t % apart == 0 || *t == found.steps as usize);
    text += &table(
        ["steps", "mean squared error", ""],
        shown.map(|t| {
            let mark = if t == found.steps as usize { "least" } else { "" };
            [t.to_string(), number(found.errors[t]), mark.to_owned()]
        }),
    );
    text.push('\n');
    text
}
