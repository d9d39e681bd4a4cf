//! `adwave transform`: all bands of a signal.

use crate::args::{FieldArgs, LevelArgs, ShapeArgs};
use crate::error::CliError;
use crate::field_file::{FieldFile, holds_fields, no_fields};
use crate::global::Global;
use crate::output::{
    bands_params, check_writable, fwhm_json, fwhm_text, number, peak_memory, percent_of, print, schedule,
    steps_json, steps_text, table, write_error, write_shape,
};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::provenance::provenance;
use crate::shape_input::{Input, load};
use crate::signal::{self, Signal};
use crate::stopwatch::Stopwatch;
use adwave::bands::Bands;
use adwave_io::{ArrayValues, Compression, Field, FieldValues, Format, ShapeFile};
use clap::Args;
use serde_json::json;
use std::path::Path;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension:
  .npz        points (n,3), scaling (J+1,n,d), wavelet (J,n,d), steps (J+1), sigma (J+1), for numpy
  .vtp .ply   the shape with the fields S0 … SJ and W1 … WJ, for ParaView
  .gii        the fields W1 … WJ and SJ, which sum to the signal, as 32-bit floats

Examples:
  adwave transform bunny.obj -o bands.npz --levels 8
  adwave transform brain.ply -o bands.vtp --field thickness
  adwave transform pial.gii.gz -o bands.func.gii --field thick.gii.gz --fwhm 4,8,16
  adwave transform scan.laz -o bands.vtp --lengths 0.1,0.2,0.5,1 --field intensity")]
pub(crate) struct TransformArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the bands go (.npz, .vtp, .ply, .las, .gii and others)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
}

pub(crate) fn run(args: &TransformArgs, global: &Global<'_>) -> Result<(), CliError> {
    let npz = args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz"));
    let format = Format::from_path(&args.output);
    if !npz && format != Some(Format::GIFTI) && !holds_fields(&args.output) {
        return Err(no_fields(&args.output, "bands are", &[".npz", ".gii"]));
    }
    check_writable(&args.output)?;
    let params = bands_params(&args.levels)?;
    let mut watch = Stopwatch::start();
    let input = with_spinner(global, "reading", || load(&args.shape, global))?;
    let field = args.field.name();
    let signal = signal::load(global, &input, field, args.field.texture.as_deref())?;
    let read = watch.lap();
    let decomposer = prepare(global, &input.shape, &args.shape.operator_for(&args.levels)?)?;
    let decomposer = signal::mask(decomposer, &signal, field, global)?;
    let (schedule, why) = schedule(&args.levels, &decomposer, global)?;
    let prepared = watch.lap();
    let bands = with_progress(global, "splitting", |progress| {
        decomposer
            .request(&signal.values, signal.n_channels, &schedule)
            .params(&params)
            .progress(progress)
            .bands()
    })?;
    let split = watch.lap();
    with_spinner(global, "writing", || {
        if npz {
            write_npz(global, &args.output, &input, &signal, &bands)
        } else if format == Some(Format::GIFTI) {
            write_gifti(&args.output, &input, &bands)
        } else {
            write_fields(global, &args.output, &input, &signal, &bands)
        }
    })?;
    let written = watch.lap();

    let energy = bands.energy(&decomposer.areas())?;
    let diagonal = decomposer.diagonal();
    let mut text = format!(
        "{}: {} vertices, {} channel{} of {}\n{why}\n\n",
        input.name,
        bands.n_vertices,
        bands.n_channels,
        if bands.n_channels == 1 { "" } else { "s" },
        field,
    );
    text += &table(
        ["level", "steps", "sigma", "FWHM", "% of diagonal", "rms of W by area"],
        (1..=bands.n_levels()).map(|j| {
            let rms = energy[j - 1].sqrt();
            [
                j.to_string(),
                steps_text(bands.steps[j]),
                number(bands.sigma[j]),
                fwhm_text(bands.sigma[j], diagonal),
                percent_of(bands.sigma[j], diagonal),
                number(rms),
            ]
        }),
    );
    text += &format!(
        "\nread {read:.3} s, diffusion {prepared:.3} s, bands {split:.3} s, written {written:.3} s{}\n{}\n",
        peak_memory().map_or(String::new(), |bytes| format!(", peak memory {} MB", bytes / 1_000_000)),
        args.output.display(),
    );
    let json = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "field": field,
        "operator": decomposer.operator_kind().name(),
        "vertices": bands.n_vertices,
        "channels": bands.n_channels,
        "levels": bands.n_levels(),
        "levels_reason": why,
        "steps": steps_json(&bands.steps),
        "sigma": bands.sigma,
        "fwhm": fwhm_json(&bands.sigma, diagonal),
        "energy": energy,
        "products": bands.info.products,
        "error_bound": bands.info.error_bound,
        "diagonal": diagonal,
        "seconds": {"read": read, "diffusion": prepared, "bands": split, "write": written},
        "peak_memory_bytes": peak_memory(),
    });
    print(global, &text, &json)
}

/// The arrays points, scaling, wavelet, steps and sigma.
fn write_npz(
    global: &Global<'_>,
    path: &Path,
    input: &Input,
    signal: &Signal,
    bands: &Bands,
) -> Result<(), CliError> {
    let made = provenance(global)?.to_json();
    let (n, d, levels) = (bands.n_vertices, bands.n_channels, bands.n_levels());
    let scaling = all_scaling(signal, bands);
    let wavelet = &bands.as_slice()[..levels * n * d];
    let (scaling_shape, wavelet_shape) = ([levels + 1, n, d], [levels, n, d]);
    let (points_shape, levels_shape) = ([n, 3], [levels + 1]);
    let mut arrays: Vec<(&str, &[usize], ArrayValues<'_>)> = vec![
        ("scaling", &scaling_shape, ArrayValues::F64(&scaling)),
        ("wavelet", &wavelet_shape, ArrayValues::F64(wavelet)),
        ("steps", &levels_shape, ArrayValues::F64(&bands.steps)),
        ("sigma", &levels_shape, ArrayValues::F64(&bands.sigma)),
    ];
    if let Some(points) = input.shape.points() {
        arrays.push(("points", &points_shape, ArrayValues::F64(points.as_flattened())));
    }
    arrays.push(("provenance", &[], ArrayValues::Text(&made)));
    adwave_io::write_npz(path, &arrays, Compression::Stored).map_err(write_error)
}

/// The fields W1 … WJ and SJ without the shape.
fn write_gifti(path: &Path, input: &Input, bands: &Bands) -> Result<(), CliError> {
    let n_levels = bands.n_levels();
    let name = |j: usize| if j < n_levels { format!("W{}", j + 1) } else { format!("S{n_levels}") };
    let size = bands.n_vertices * bands.n_channels;
    let field = |(j, values): (usize, &[f64])| {
        Field::new(name(j), bands.n_channels, FieldValues::F64(values.to_vec()))
    };
    let fields: Vec<Field> = bands.as_slice().chunks_exact(size).enumerate().map(field).collect();
    FieldFile::Gifti.write(path, &fields, input.file.structure())
}

/// The shape with the fields S0 … SJ and W1 … WJ.
fn write_fields(
    global: &Global<'_>,
    path: &Path,
    input: &Input,
    signal: &Signal,
    bands: &Bands,
) -> Result<(), CliError> {
    let mut file = fresh(&input.file, path);
    let field =
        |name: String, values: &[f64]| Field::new(name, bands.n_channels, FieldValues::F64(values.to_vec()));
    for (j, level) in all_scaling(signal, bands).chunks_exact(signal.values.len()).enumerate() {
        file.add_vertex_field(field(format!("S{j}"), level))?;
    }
    for (j, level) in bands.wavelets().enumerate() {
        file.add_vertex_field(field(format!("W{}", j + 1), level))?;
    }
    write_shape(global, &file, path).map(|_| ())
}

/// S_f(0) … S_f(J), S_f(0) being the signal itself.
fn all_scaling(signal: &Signal, bands: &Bands) -> Vec<f64> {
    let mut scaling = bands.all_scaling();
    scaling[..signal.values.len()].copy_from_slice(&signal.values);
    scaling
}

/// A copy of a shape that further fields can be added to, for a file of that name.
pub(crate) fn fresh(file: &ShapeFile, path: &Path) -> ShapeFile {
    let mut file = file.clone();
    forget_original(&mut file, path);
    file
}

/// Frees the bytes that a shape was read from before long work, but for a scan that becomes one again: its coordinate system and
/// the like are nowhere else.
pub(crate) fn forget_original(file: &mut ShapeFile, path: &Path) {
    let is_scan = |format: Option<Format>| matches!(format, Some(Format::LAS | Format::LAZ | Format::EPT));
    if !(is_scan(file.format()) && is_scan(Format::from_path(path))) {
        file.forget_original();
    }
}
