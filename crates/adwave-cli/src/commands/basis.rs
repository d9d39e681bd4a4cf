//! `adwave basis`: scaling functions and wavelets, of one vertex as fields or of all as sparse matrices.

use crate::args::{ShapeArgs, count as parse_count, number as parse_number};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::values_file::{holds_fields, unsuitable_format};
use crate::output::{
    check_writable, clone_for_output, count, number, print, table, write_file_with, write_shape,
};
use crate::resolve::operator::{operator_for_task, prepare};
use crate::resolve::shape::{load_shape, vertex_in_row};
use adwave::bands::Schedule;
use adwave::basis::{BasisParams, CompressedRows};
use adwave::operator::OperatorTask;
use adwave_io::{ArrayValues, Compression, Field, FieldValues};
use clap::Args;
use serde_json::json;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "\
With --vertex and --level the output is the shape with the fields phi and psi (.vtp or .ply).
With --levels it is one file per matrix, named after OUT: OUT.phi1.npz … OUT.psiJ.npz for scipy.sparse.load_npz, or .mtx. Row x is
the function of vertex x. If vertices were welded, rows are welded vertices, and OUT.classes.npy maps vertices to rows.

Examples:
  adwave basis bunny.obj --vertex 120 --level 5 -o wavelet.vtp
  adwave basis bunny.obj --levels 6 -o bunny.npz")]
pub(crate) struct BasisArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Vertex, counted from 0
    #[arg(long, value_name = "V", value_parser = parse_count, requires = "level", required_unless_present = "levels")]
    pub(crate) vertex: Option<usize>,
    /// Level of the vertex's functions, from 1
    #[arg(long, value_name = "J", value_parser = parse_count, requires = "vertex", conflicts_with = "levels")]
    pub(crate) level: Option<usize>,
    /// Number of dyadic levels, for the functions of all vertices
    #[arg(long, short = 'j', value_name = "J", value_parser = parse_count, conflicts_with = "vertex")]
    pub(crate) levels: Option<usize>,
    /// Entries of the matrices below this are dropped
    #[arg(long, value_name = "E", value_parser = parse_number, default_value_t = BasisParams::DROP_TOLERANCE)]
    pub(crate) drop_tolerance: f64,
    /// File for the functions
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
}

pub(crate) fn run(args: &BasisArgs, global: &Global<'_>) -> Result<(), CliError> {
    check_writable(&args.output)?;
    if args.vertex.is_some() {
        global.given.refuse(&["--drop-tolerance"], "applies to matrices (--levels)")?;
    }
    match (args.vertex, args.level, args.levels) {
        (Some(vertex), Some(level), _) => write_functions_of_vertex(args, global, vertex, level),
        (_, _, Some(levels)) => write_matrices(args, global, levels),
        _ => Err(CliError::Input(
            "no functions were asked for; give --vertex V --level J, or --levels J".to_owned(),
        )),
    }
}

fn write_functions_of_vertex(
    args: &BasisArgs,
    global: &Global<'_>,
    vertex: usize,
    level: usize,
) -> Result<(), CliError> {
    if !holds_fields(&args.output) {
        return Err(unsuitable_format(&args.output, "the functions of a vertex are", &[]));
    }
    let schedule = Schedule::dyadic(level)?;
    let input = load_shape(&args.shape, global)?;
    let n_vertices = input.shape.n_vertices();
    let (row, vertex) = (vertex, vertex_in_row(&input, vertex)?);
    let decomposer =
        prepare(global, &input, &operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?)?;
    let start = Instant::now();
    let functions = with_progress(global, "computing", |progress| {
        decomposer.basis_of_vertex(vertex, &schedule, progress)
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let mut file = clone_for_output(&input.file, &args.output);
    for (name, values) in [("phi", &functions.scaling_function), ("psi", &functions.wavelet)] {
        file.add_vertex_field(Field::new(name, 1, FieldValues::F64(values.clone())))?;
    }
    write_shape(global, &file, &args.output)?;
    let (phi, psi) = (functions.scaling_function[vertex], functions.wavelet[vertex]);
    let sigma = schedule.sigma(decomposer.operator().step_length())[level];
    let steps = 1_u64 << (level - 1);
    let text = format!(
        "vertex {row} of {}, level {level}: {}, sigma {}\n\
         phi is nonzero at {} of {n_vertices} vertices, and {} hold 99.9 % of it; phi is {} and psi {} at the vertex itself; {:.1} ms\n{}\n",
        input.name,
        count(steps, "step", "steps"),
        number(sigma),
        functions.support,
        functions.n_holding(0.999),
        number(phi),
        number(psi),
        1e3 * seconds,
        args.output.display()
    );
    let json = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "operator": decomposer.operator_kind().name(),
        "vertex": row,
        "level": level,
        "steps": steps,
        "sigma": sigma,
        "support": functions.support,
        "vertices_with_99_9_percent": functions.n_holding(0.999),
        "phi_at_vertex": phi,
        "psi_at_vertex": psi,
        "seconds": seconds,
    });
    print(global, &text, &json)
}

fn write_matrices(args: &BasisArgs, global: &Global<'_>, levels: usize) -> Result<(), CliError> {
    let ending = args.output.extension().map(OsStr::to_ascii_lowercase);
    let format = match ending.as_ref().and_then(|e| e.to_str()) {
        Some("npz") => MatrixFormat::Npz,
        Some("mtx") => MatrixFormat::MatrixMarket,
        _ => {
            let path = args.output.display();
            return Err(CliError::Input(format!("{path}: matrices are written as .npz or .mtx")));
        }
    };
    let mut params = BasisParams::new(Schedule::dyadic(levels)?).with_drop_tolerance(args.drop_tolerance);
    if let Some(bytes) = adwave_io::free_memory() {
        params = params.with_memory_limit(bytes);
    }
    let input = load_shape(&args.shape, global)?;
    let decomposer =
        prepare(global, &input, &operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?)?;
    let vertex_map = decomposer.vertex_map();
    let start = Instant::now();
    let mut basis = with_progress(global, "computing", |progress| {
        adwave::basis::basis(decomposer.rows("a basis")?, &params, progress)
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let welded = vertex_map.n_welded() < vertex_map.n_vertices();
    let mut files = Vec::new();
    if welded {
        let path = matrix_path(&args.output, "classes", "npy");
        let classes = ArrayValues::U32(vertex_map.as_slice());
        write_file_with(global, &path, |path| {
            adwave_io::write_npy(path, &[vertex_map.n_vertices()], classes)
        })?;
        files.push(path);
    } else {
        basis = basis.to_shape_order(vertex_map)?;
    }
    let extension = match format {
        MatrixFormat::Npz => "npz",
        MatrixFormat::MatrixMarket => "mtx",
    };
    for level in 1..=levels {
        for (name, matrix) in [("phi", None), ("psi", Some(basis.wavelet(level)))] {
            let path = matrix_path(&args.output, &format!("{name}{level}"), extension);
            let matrix = matrix.as_ref().unwrap_or(&basis.scaling[level - 1]);
            with_spinner(global, "writing", || {
                write_file_with(global, &path, |path| write_matrix(path, matrix, format))
            })?;
            files.push(path);
        }
    }
    let mut text = format!(
        "{}: functions of {} on {} in {seconds:.3} s\n\n",
        input.name,
        count(vertex_map.n_welded(), "vertex", "vertices"),
        count(levels, "level", "levels")
    );
    text += &table(
        ["level", "entries", "per vertex", "MB"],
        (0..levels).map(|j| {
            let nnz = basis.info.nnz[j];
            [
                (j + 1).to_string(),
                nnz.to_string(),
                number(nnz as f64 / vertex_map.n_welded() as f64),
                number(basis.info.bytes[j] as f64 / 1e6),
            ]
        }),
    );
    let largest = basis.info.largest_dropped.iter().copied().fold(0.0, f64::max);
    text += &format!(
        "\nentries below {} were dropped, at most {} of a row, and rows were scaled back to the sum 1\n\n",
        number(args.drop_tolerance),
        number(largest)
    );
    for path in &files {
        text += &format!("{}\n", path.display());
    }
    let json = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "rows": vertex_map.n_welded(),
        "levels": levels,
        "entries": basis.info.nnz,
        "bytes": basis.info.bytes,
        "drop_tolerance": args.drop_tolerance,
        "largest_dropped": basis.info.largest_dropped,
        "seconds": seconds,
        "files": files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>(),
    });
    print(global, &text, &json)
}

/// `OUT.npz` → `OUT.phi1.npz`.
fn matrix_path(output: &Path, part: &str, extension: &str) -> PathBuf {
    output.with_extension(format!("{part}.{extension}"))
}

/// Format of the matrices.
#[derive(Clone, Copy)]
enum MatrixFormat {
    Npz,
    MatrixMarket,
}

fn write_matrix(
    path: &Path,
    matrix: &CompressedRows<f32>,
    format: MatrixFormat,
) -> Result<(), adwave_io::WriteError> {
    match format {
        MatrixFormat::MatrixMarket => adwave_io::write_matrix_market(path, matrix),
        MatrixFormat::Npz => adwave_io::write_sparse_npz(path, matrix, Compression::Stored),
    }
}
