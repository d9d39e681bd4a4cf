//! `adwave scatter`: geometric scattering of fields on a graph.

use crate::args::{WalkArgs, parse_named};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::{check_writable, count, has_extension, print, write_file_with};
use crate::resolve::walk::{
    WalkDefaults, accuracy_json, in_file, load_walk, read_table, single_precision_line,
};
use adwave::bands::Precision;
use adwave_graph::{Normalization, Pooling, ScatteringParams, pool, scatter};
use adwave_io::{ArrayValues, write_npy};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
The bands are differences of powers of the walk, at the scales 0, 1, 2, 4, … by default. Order 0 is the field, order 1 the size of each
band, order 2 the size of the coarser bands of each of these.
The result is .npy: paths × nodes × channels, or graphs × paths × channels × statistics with --pool. The paths are printed.

Examples:
  adwave scatter --graph graph.mtx --field x.npy -o features.npy
  adwave scatter --graph edges.txt --field x.npy -o features.npy --pool moments
  adwave scatter --points cells.npy --field genes.npy -o features.npy --scales 1,2,4 --orders 1")]
pub(crate) struct ScatterArgs {
    /// Field with a row for each node (.npy or .csv)
    #[arg(long, value_name = "FILE")]
    pub(crate) field: PathBuf,
    /// File for the coefficients (.npy)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Numbers of steps between which the bands lie, increasing from at least 1
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "1,2,4,8,16")]
    pub(crate) scales: Vec<u32>,
    /// Orders, of 0, 1 and 2
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "0,1,2")]
    pub(crate) orders: Vec<u32>,
    /// Statistics over the nodes of each graph
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Pooling>())]
    pub(crate) pool: Option<Pooling>,
    /// Graph of each node, counted from 0, for --pool of several graphs (.npy or .csv) [default: one graph]
    #[arg(long, value_name = "FILE", requires = "pool")]
    pub(crate) batch: Option<PathBuf>,
    /// Number format of the products
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Precision>(), default_value_t = Precision::Double)]
    pub(crate) precision: Precision,
    #[command(flatten)]
    pub(crate) walk: WalkArgs,
}

pub(crate) fn run(args: &ScatterArgs, global: &Global<'_>) -> Result<(), CliError> {
    if !has_extension(&args.output, &["npy"]) {
        return Err(CliError::Input(format!("{}: coefficients are written as .npy", args.output.display())));
    }
    check_writable(&args.output)?;
    let (field, n_channels) = read_table(&args.field, global)?;
    let labels = args.batch.as_ref().map(|path| read_table(path, global)).transpose()?;
    let walk = load_walk(&args.walk, WalkDefaults { self_loops: 0.0, stay: 0.5 }, global)?;
    let params = ScatteringParams::default()
        .with_scales(args.scales.clone())
        .with_orders(args.orders.clone())
        .with_precision(args.precision)
        .with_max_bytes(adwave_io::free_memory());
    let found = with_progress(global, "scattering", |progress| {
        scatter(&walk.powers, &field, n_channels, &params, progress).map_err(|e| in_file(&args.field, &e))
    })?;
    let n = walk.powers.n_nodes();
    let n_paths = found.paths.len();
    let (shape, values, n_graphs) = match args.pool {
        None => (vec![n_paths, n, n_channels], found.values, 1),
        Some(pooling) => {
            let graph_of = match labels {
                Some((labels, 1)) => graph_labels(&labels)?,
                Some(_) => return Err(CliError::Input("--batch needs one number per node".to_owned())),
                None => vec![0; n],
            };
            let n_graphs = graph_of.iter().max().map_or(0, |&most| most as usize + 1);
            let values = pool(&found.values, n_channels, &graph_of, n_graphs, pooling)?;
            (vec![n_graphs, n_paths, n_channels, pooling.n_statistics()], values, n_graphs)
        }
    };
    with_spinner(global, "writing", || {
        write_file_with(global, &args.output, |path| write_npy(path, &shape, ArrayValues::F64(&values)))
    })?;
    let name = |path: &Vec<u32>| match path[..] {
        [] => "f".to_owned(),
        [j] => format!("|W{j}|"),
        _ => format!("|W{}|W{}||", path[1], path[0]),
    };
    let names: Vec<String> = found.paths.iter().map(name).collect();
    let relative_to = match walk.powers.walk().normalization() {
        Normalization::Column => "sums of absolute values over the nodes, relative to that of the field",
        Normalization::Symmetric => "roots of sums of squares over the nodes, relative to that of the field",
        _ => "relative to the largest value of the field",
    };
    let text = format!(
        "{}\n{}, {}: {}\n{}{}, {}\n",
        walk.text,
        count(n_channels, "channel", "channels"),
        count(n_paths, "path", "paths"),
        names.join(" "),
        single_precision_line(found.accuracy, "coefficients", relative_to),
        shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" × "),
        args.output.display(),
    );
    let json = json!({
        "field": args.field.display().to_string(),
        "output": args.output.display().to_string(),
        "graph": walk.json,
        "scales": args.scales,
        "paths": found.paths,
        "graphs": n_graphs,
        "shape": shape,
        "products": accuracy_json(found.accuracy),
    });
    print(global, &text, &json)
}

/// Labels of graphs from numbers.
fn graph_labels(values: &[f64]) -> Result<Vec<u32>, CliError> {
    let most = values.len() as f64;
    let label = |&v: &f64| if v >= 0.0 && v.fract() == 0.0 && v < most { Ok(v as u32) } else { Err(v) };
    values.iter().map(label).collect::<Result<_, f64>>().map_err(|v| {
        CliError::Input(format!(
            "--batch: labels of graphs are whole numbers from 0, fewer than nodes, got {v}"
        ))
    })
}
