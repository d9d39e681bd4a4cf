//! `adwave transform`: all bands of a signal.

use super::result_file::check_places;
use crate::args::{
    GivenWalkArgs, LabelArgs, LevelArgs, QUAD_OPTIONS, QuadArgs, QuantityArgs, ShapeArgs, SignalArgs,
    TimeArgs, number as parse_number, parse_named,
};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::provenance::provenance;
use crate::output::stopwatch::Stopwatch;
use crate::output::values_file::{ValuesFile, grid_type, holds_fields, unsuitable_format, write_grid};
use crate::output::{
    check_writable, clone_for_output, count, fwhm_json, fwhm_text, has_extension, note_report, number,
    peak_memory, percent_of, print, steps_json, steps_text, table, write_file_with, write_shape,
};
use crate::resolve::levels::{check_levels, resolve_levels};
use crate::resolve::operator::{
    mask_missing, operator_for_levels, operator_with_default, prepare, prepare_for_signal,
};
use crate::resolve::quantity::Carried;
use crate::resolve::shape::{Input, load_shape, row_words};
use crate::resolve::signal::{Signal, load_signal, refuse_labels, smooth_labels_hint};
use crate::resolve::time::TimeBands;
use crate::resolve::walk::with_given_walk;
use adwave::bands::{Bands, BandsInfo, BandsParams, Schedule, mean_square};
use adwave::operator::{OperatorKind, RowWeights};
use adwave::{Decomposer, Progress};
use adwave_io::{
    ArrayValues, CiftiColumns, Compression, Field, FieldValues, Format, ShapeFile, VolumeSeriesWriter,
    WriteError, write_npy,
};
use adwave_subdivision::Family;
use clap::Args;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension:
  .npz        points (n,3), scaling (J+1,n,d), wavelet (J,n,d), steps (J+1), sigma (J+1), for
              numpy; along time band (J+1,I+1,n,T) instead of the first two, whose sum is the
              signal, and time_sigma (I+1)
  .npy        W1 … WJ and SJ, which sum to the signal: (J+1,n,d), or (J+1,n) for d = 1
  .vtp .ply   the shape with the fields S0 … SJ and W1 … WJ, for ParaView
  .csv .gii   the fields W1 … WJ and SJ, .gii and CIFTI as 32-bit floats
  .nii .tif   of an image or a volume, the same as J+1 channels

Examples:
  adwave transform bunny.obj -o bands.npz --levels 8
  adwave transform brain.ply -o bands.vtp --signal thickness
  adwave transform pial.gii.gz -o bands.func.gii --signal thick.gii.gz --fwhm 4,8,16
  adwave transform scan.laz -o bands.vtp --lengths 0.1,0.2,0.5,1 --signal intensity
  adwave transform volume.nii.gz -o bands.nii.gz --fwhm 4,8,16
  adwave transform bold.nii.gz -o bands.npz --fwhm 6,12 --time-fwhm 4s,16s
  adwave transform flow.ply -o bands.vtp --signal wind --directions vectors --fwhm 2%,5%
  adwave transform fsaverage5.gii -o c.npz --basis butterfly --signal sulc5.gii --keep 0.1

With --directions and --tensors bands are vectors and tensors in space; in a volume they are bands of the tensors' logarithms.
Those of lines and crosses are one of the directions that are the same, so that they do not add up.

With --basis: coefficient (n,d), level (n) and norm (n), 1 for the finest level; as fields of a shape, --inverse reads them back.")]
pub(crate) struct TransformArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// File for the bands (.npz, .npy, .vtp, .ply, .las, .gii and others)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) walk: GivenWalkArgs,
    #[command(flatten)]
    pub(crate) signal: SignalArgs,
    #[command(flatten)]
    pub(crate) quantity: QuantityArgs,
    #[command(flatten)]
    pub(crate) labels: LabelArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) time: TimeArgs,
    /// Coefficients of wavelets by lifting instead of bands: as many as the signal has values. All families but
    /// irregular need a mesh that was made by cutting triangles into four, or polygons into quadrilaterals (linear,
    /// catmull-clark)
    #[arg(long, value_name = "FAMILY", value_parser = parse_named::<Family>(), help_heading = "Basis")]
    pub(crate) basis: Option<Family>,
    /// Share of the coefficients that stay, those that contribute most; the others become 0
    #[arg(long, value_name = "R", value_parser = parse_number, allow_negative_numbers = true, help_heading = "Basis")]
    pub(crate) keep: Option<f64>,
    /// Take the signal as coefficients, and write the field that they stand for
    #[arg(long, help_heading = "Basis")]
    pub(crate) inverse: bool,
    #[command(flatten)]
    pub(crate) quads: QuadArgs,
}

/// Kind of the file of bands.
#[derive(Clone, Copy)]
enum BandsFile {
    Npz,
    /// Values alone.
    Alone(ValuesFile),
    Fields,
}

/// A signal on a shape, ready to be split.
struct TransformJob {
    file: BandsFile,
    input: Input,
    signal: Signal,
    /// Bands along time.
    time: Option<TimeBands>,
    decomposer: Decomposer,
    quantity: QuantityArgs,
    schedule: Schedule,
    levels_reason: String,
    params: BandsParams,
}

/// The bands of a job, and the values that they are the bands of.
struct SplitSignal<'a> {
    bands: Bands,
    /// The domain without the places where the signal is unknown.
    decomposer: Cow<'a, Decomposer>,
    /// The signal; of directions and tensors what takes part, of tensors in a volume their logarithms.
    values: Cow<'a, [f64]>,
}

/// Levels of a signal that was split, for the report.
struct SplitSummary {
    n_vertices: usize,
    n_channels: usize,
    steps: Vec<f64>,
    sigma: Vec<f64>,
    info: BandsInfo,
    /// Mean square of each band by area.
    energy: Vec<f64>,
}

impl SplitSummary {
    fn new(split_signal: &SplitSignal<'_>) -> Result<Self, CliError> {
        let Bands { n_vertices, n_channels, steps, sigma, info, .. } = &split_signal.bands;
        let energy = split_signal.bands.energy(&split_signal.decomposer.areas())?;
        let (steps, sigma, info) = (steps.clone(), sigma.clone(), info.clone());
        Ok(Self { n_vertices: *n_vertices, n_channels: *n_channels, steps, sigma, info, energy })
    }
}

/// Name, shape and values of an array.
type NamedArray<'a> = (&'static str, Vec<usize>, Cow<'a, [f64]>);

/// Seconds that each part took.
struct TransformSeconds {
    read: f64,
    prepare: f64,
    split: f64,
    write: f64,
}

pub(crate) fn run(args: &TransformArgs, global: &Global<'_>) -> Result<(), CliError> {
    if let Some(family) = args.basis {
        return super::basis_transform::run(args, family, global);
    }
    global.given.refuse(&["--keep", "--inverse"], "applies to coefficients (--basis)")?;
    global.given.refuse(&QUAD_OPTIONS, "applies to coefficients (--basis)")?;
    let mut watch = Stopwatch::start();
    let (job, read) = resolve(args, &mut watch, global)?;
    let prepare = watch.lap();
    if job.goes_band_by_band(&args.output) {
        let (summary, write) = write_volumes(args, &job, global)?;
        let seconds = TransformSeconds { read, prepare, split: watch.lap() - write, write };
        return report(args, &job, &summary, &seconds, global);
    }
    let split_signal = split(&job, args.signal.name_on(&job.input.file), global)?;
    let split = watch.lap();
    write(args, &job, &split_signal, global)?;
    let seconds = TransformSeconds { read, prepare, split, write: watch.lap() };
    report(args, &job, &SplitSummary::new(&split_signal)?, &seconds, global)
}

impl TransformJob {
    /// True if each band goes into the file before the next one is computed, and none is kept.
    fn goes_band_by_band(&self, output: &Path) -> bool {
        matches!(self.file, BandsFile::Alone(ValuesFile::Grid))
            && Format::grid_from_path(output) == Some(Format::NIFTI)
            && (output.is_file() || !output.exists())
            && self.quantity.are_numbers()
            && self.input.file.file_rows().is_none()
    }
}

/// Writes each band of a signal of numbers into a NIfTI when it is known, and returns the seconds that writing took.
fn write_volumes(
    args: &TransformArgs,
    job: &TransformJob,
    global: &Global<'_>,
) -> Result<(SplitSummary, f64), CliError> {
    // Errors name the file that the staged one will replace.
    let failed = |error: WriteError| CliError::from(error.about_file(&args.output));
    let TransformJob { input, signal, decomposer, schedule, params, .. } = job;
    let (d, n_levels) = (signal.n_channels, schedule.n_levels());
    let areas = (!decomposer.has_even_areas()).then(|| decomposer.areas());
    let weights = areas.as_deref().map_or(RowWeights::Uniform, RowWeights::Each);
    let (mut energy, mut seconds) = (vec![0.0; n_levels], 0.0);
    let info = with_progress(global, "splitting", |progress| {
        global.files.write_with(&args.output, |path| {
            let kind = grid_type(&input.file);
            let begun = VolumeSeriesWriter::begin_channels(path, &input.file, kind, (n_levels + 1) * d);
            let (writer, written) = begun.map_err(failed)?;
            note_report(global, &args.output, &written);
            let request = decomposer.request(&signal.values, d, schedule).params(params).progress(progress);
            let info = request.visit_bands(|level, band| {
                if let Some(energy) = energy.get_mut(level) {
                    *energy = mean_square(band, d, weights)?;
                }
                let mut watch = Stopwatch::start();
                for channel in 0..d {
                    let plane: Cow<'_, [f64]> = match d {
                        1 => Cow::Borrowed(band),
                        _ => band.iter().skip(channel).step_by(d).copied().collect(),
                    };
                    writer.write(level * d + channel, None, &plane, progress.quiet()).map_err(failed)?;
                }
                seconds += watch.lap();
                Ok::<(), CliError>(())
            })?;
            let mut watch = Stopwatch::start();
            writer.finish(progress.quiet()).map_err(failed)?;
            seconds += watch.lap();
            Ok::<BandsInfo, CliError>(info)
        })
    })?;
    let (steps, sigma) = (schedule.steps_from_zero(), schedule.sigma(decomposer.operator().step_length()));
    let n_vertices = signal.values.len() / d;
    Ok((SplitSummary { n_vertices, n_channels: d, steps, sigma, info, energy }, seconds))
}

/// Splits the signal of a job.
fn split<'a>(job: &'a TransformJob, name: &str, global: &Global<'_>) -> Result<SplitSignal<'a>, CliError> {
    with_progress(global, "splitting", |progress| {
        let bands = |decomposer: &Decomposer, signal: &Signal, progress: Progress<'_>| {
            let request = decomposer.request(&signal.values, signal.n_channels, &job.schedule);
            request.params(&job.params).progress(progress).bands()
        };
        if job.quantity.are_numbers() {
            let values = Cow::Borrowed(&job.signal.values[..]);
            let bands = bands(&job.decomposer, &job.signal, progress)?;
            return Ok(SplitSignal { bands, decomposer: Cow::Borrowed(&job.decomposer), values });
        }
        let carried =
            Carried::new(job.quantity, &job.decomposer, &job.signal, name, global, progress.quiet())?;
        let mut masked = Vec::with_capacity(carried.signals.len());
        for own in &carried.signals {
            masked.push(mask_missing(own.decomposer.clone(), &own.signal, name, global)?);
        }
        let own = carried.signals.iter().zip(&masked);
        let own = own.map(|(own, masked)| bands(masked, &own.signal, progress));
        let own = own.collect::<Result<Vec<Bands>, _>>()?;
        let level = |k: usize| -> Result<Vec<f64>, CliError> {
            let of_level = |bands: &'_ Bands| {
                let len = bands.n_vertices * bands.n_channels;
                k * len..(k + 1) * len
            };
            let parts: Vec<&[f64]> = own.iter().map(|bands| &bands.as_slice()[of_level(bands)]).collect();
            carried.join_band(&parts)
        };
        let levels = (0..=own[0].n_levels()).map(level).collect::<Result<Vec<_>, _>>()?;
        let given: Vec<&[f64]> = carried.signals.iter().map(|own| &own.signal.values[..]).collect();
        let values = carried.join_band(&given)?;
        let bands = own[0].with_levels(job.signal.n_channels, &levels);
        Ok(SplitSignal { bands, decomposer: Cow::Owned(masked.swap_remove(0)), values: Cow::Owned(values) })
    })
}

/// The job, and the seconds that reading took.
fn resolve(
    args: &TransformArgs,
    watch: &mut Stopwatch,
    global: &Global<'_>,
) -> Result<(TransformJob, f64), CliError> {
    let file = bands_file(&args.output)?;
    check_writable(&args.output)?;
    let params = check_levels(&args.levels)?;
    watch.lap();
    let input = with_given_walk(load_shape(&args.shape, global)?, &args.walk, global)?;
    input.check_lengths(&args.levels.given_lengths())?;
    let name = args.signal.name_on(&input.file);
    let mut signal = load_signal(global, &input, name, args.signal.texture.as_deref())?;
    refuse_labels(name, &signal, args.labels, &smooth_labels_hint(name))?;
    args.quantity.check_signal(name)?;
    if !args.quantity.are_numbers() {
        let applies = "applies to numbers, and the signal holds directions or tensors";
        global.given.refuse(&["--time-fwhm", "--time-lengths", "--as-numbers"], applies)?;
    }
    let time = TimeBands::resolve(&args.time, name, &mut signal, global)?;
    if time.is_some() && !matches!(file, BandsFile::Npz) {
        return Err(CliError::Input(format!(
            "bands in space and time have two indices, which .npz alone holds; write to .npz instead of {}",
            args.output.display()
        )));
    }
    let file = if matches!(file, BandsFile::Npz) {
        file
    } else {
        check_places(&args.output, &input)?;
        match ValuesFile::choose(&args.output, &input.file) {
            Some(ValuesFile::Npy | ValuesFile::Grid) if input.file.grid().is_some() => {
                BandsFile::Alone(ValuesFile::Grid)
            }
            _ => file,
        }
    };
    let read = watch.lap();
    let quantity = args.quantity;
    let decomposer = if quantity.are_numbers() {
        let operator = operator_for_levels(&args.shape.operator, &args.levels)?;
        prepare_for_signal(global, &input, &operator, &signal, name)?
    } else {
        let operator = operator_with_default(&args.shape.operator, OperatorKind::Surface)?;
        prepare(global, &input, &operator)?
    };
    let levels = resolve_levels(&args.levels, &decomposer, global)?;
    let (schedule, levels_reason) = (levels.schedule, levels.reason);
    let job =
        TransformJob { file, input, signal, time, decomposer, quantity, schedule, levels_reason, params };
    Ok((job, read))
}

fn bands_file(path: &Path) -> Result<BandsFile, CliError> {
    match ValuesFile::from_path(path) {
        _ if has_extension(path, &["npz"]) => Ok(BandsFile::Npz),
        Some(ValuesFile::Annotation | ValuesFile::Cifti(CiftiColumns::Labels)) => Err(CliError::Input(
            format!("{}: the format holds labels, and bands are numbers", path.display()),
        )),
        Some(kind) => Ok(BandsFile::Alone(kind)),
        None if holds_fields(path) => Ok(BandsFile::Fields),
        None => Err(unsuitable_format(path, "bands are", &[".npz", ".npy", ".csv", ".gii"])),
    }
}

fn write(
    args: &TransformArgs,
    job: &TransformJob,
    split_signal: &SplitSignal<'_>,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let SplitSignal { bands, values, .. } = split_signal;
    match job.file {
        BandsFile::Npz => with_spinner(global, "writing", || {
            let extra = job.time.as_ref();
            write_arrays(global, &args.output, &job.input, values, bands, extra)
        }),
        BandsFile::Alone(ValuesFile::Grid) => with_spinner(global, "writing", || {
            let (levels, d) = (bands.as_slice(), bands.n_channels);
            let len = bands.n_vertices * d;
            let copy = |i: usize, row: &mut [f64]| {
                let levels = levels.chunks_exact(len);
                row.chunks_exact_mut(d)
                    .zip(levels)
                    .for_each(|(row, level)| row.copy_from_slice(&level[i * d..][..d]));
            };
            write_grid(global, &args.output, (bands.n_levels() + 1) * d, copy, &job.input.file)
        }),
        BandsFile::Alone(ValuesFile::Npy) => with_spinner(global, "writing", || {
            let (file, d) = (&job.input.file, bands.n_channels);
            let shape = [bands.n_levels() + 1, file.n_file_rows(), d];
            let levels = in_rows(file, Cow::Borrowed(bands.as_slice()), d);
            let shape = if d == 1 { &shape[..2] } else { &shape };
            write_file_with(global, &args.output, |path| write_npy(path, shape, ArrayValues::F64(&levels)))
        }),
        BandsFile::Alone(kind) => {
            let write = || kind.write(global, &args.output, &band_fields(bands), &job.input.file);
            with_spinner(global, "writing", write)
        }
        BandsFile::Fields => write_fields(global, &args.output, job, split_signal),
    }
}

fn report(
    args: &TransformArgs,
    job: &TransformJob,
    summary: &SplitSummary,
    seconds: &TransformSeconds,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let SplitSummary { n_vertices, n_channels, steps, sigma, info, energy } = summary;
    let diagonal = job.decomposer.extent();
    let name = args.signal.name_on(&job.input.file);
    let [one, many] = job.input.row_words();
    let mut text = format!(
        "{}: {}, {} of {name}\n{}\n\n",
        job.input.name,
        count(*n_vertices, one, many),
        count(*n_channels, "channel", "channels"),
        job.levels_reason,
    );
    text += &table(
        ["level", "steps", "sigma", "FWHM", "% of diagonal", "rms of W by area"],
        (1..=energy.len()).map(|j| {
            [
                j.to_string(),
                steps_text(steps[j]),
                number(sigma[j]),
                fwhm_text(sigma[j], diagonal),
                percent_of(sigma[j], diagonal),
                number(energy[j - 1].sqrt()),
            ]
        }),
    );
    if let Some(time) = &job.time {
        text.push('\n');
        time.describe(&mut text, None);
    }
    let TransformSeconds { read, prepare, split, write } = seconds;
    text += &format!(
        "\nread {read:.3} s, diffusion {prepare:.3} s, bands {split:.3} s, written {write:.3} s{}\n{}\n",
        peak_memory().map_or(String::new(), |bytes| format!(", peak memory {} MB", bytes / 1_000_000)),
        args.output.display(),
    );
    let mut json: Value = json!({
        "shape": job.input.name,
        "output": args.output.display().to_string(),
        "field": name,
        "operator": job.decomposer.operator_kind().name(),
        row_words(&job.input.file)[1]: n_vertices,
        "channels": n_channels,
        "levels": energy.len(),
        "levels_reason": job.levels_reason,
        "steps": steps_json(steps),
        "sigma": sigma,
        "fwhm": fwhm_json(sigma, diagonal),
        "energy": energy,
        "products": info.products,
        "error_bound": info.error_bound,
        "diagonal": diagonal,
        "seconds": {"read": read, "diffusion": prepare, "bands": split, "write": write},
        "peak_memory_bytes": peak_memory(),
    });
    if let Some(time) = &job.time {
        json["time"] = time.to_json(None);
    }
    print(global, &text, &json)
}

/// Writes the arrays points, scaling, wavelet, steps and sigma of a signal.
pub(crate) fn write_npz(
    global: &Global<'_>,
    path: &Path,
    input: &Input,
    signal: &[f64],
    bands: &Bands,
) -> Result<(), CliError> {
    write_arrays(global, path, input, signal, bands, None)
}

/// [`write_npz`], with bands in space and time instead of scaling and wavelet where `time` is given.
fn write_arrays(
    global: &Global<'_>,
    path: &Path,
    input: &Input,
    signal: &[f64],
    bands: &Bands,
    time: Option<&TimeBands>,
) -> Result<(), CliError> {
    let provenance = provenance(global)?.to_json();
    let (d, levels) = (bands.n_channels, bands.n_levels());
    let file = &input.file;
    let n = file.n_file_rows();
    // Of an image or a volume, an axis for each of its axes.
    let sizes = file.grid().map_or_else(|| vec![n], |grid| grid.sizes.clone());
    let shape = |n_arrays: &[usize]| [n_arrays, &sizes, &[d]].concat();
    let parts: Vec<NamedArray<'_>> = if let Some(time) = time {
        let n_bands = time.widths.len() + 1;
        let mut all = Vec::with_capacity((levels + 1) * n_bands * signal.len());
        for band in bands.as_slice().chunks_exact(bands.n_vertices * d) {
            all.extend(time.bands(band, global.progress())?.concat());
        }
        let time_sigma = [&[0.0][..], &time.widths].concat();
        vec![
            ("band", shape(&[levels + 1, n_bands]), in_rows(file, Cow::Owned(all), d)),
            ("time_sigma", vec![n_bands], Cow::Owned(time_sigma)),
            ("time_step", Vec::new(), Cow::Owned(vec![time.axis.step()])),
        ]
    } else {
        let wavelet = &bands.as_slice()[..levels * bands.n_vertices * d];
        vec![
            ("scaling", shape(&[levels + 1]), in_rows(file, Cow::Owned(all_scaling(signal, bands)), d)),
            ("wavelet", shape(&[levels]), in_rows(file, Cow::Borrowed(wavelet), d)),
        ]
    };
    let (points_shape, levels_shape) = ([n, 3], [levels + 1]);
    let mut arrays: Vec<(&str, &[usize], ArrayValues<'_>)> =
        parts.iter().map(|(name, shape, values)| (*name, &shape[..], ArrayValues::F64(values))).collect();
    arrays.push(("steps", &levels_shape, ArrayValues::F64(&bands.steps)));
    arrays.push(("sigma", &levels_shape, ArrayValues::F64(&bands.sigma)));
    let points = input.shape.points().map(|points| in_rows(file, Cow::Borrowed(points.as_flattened()), 3));
    if let Some(points) = &points {
        arrays.push(("points", &points_shape, ArrayValues::F64(points)));
    }
    arrays.push(("provenance", &[], ArrayValues::Text(&provenance)));
    write_file_with(global, path, |path| adwave_io::write_npz(path, &arrays, Compression::Stored))
}

/// Values with a row for each row of the file.
fn in_rows<'a>(file: &ShapeFile, values: Cow<'a, [f64]>, n_channels: usize) -> Cow<'a, [f64]> {
    match file.file_rows() {
        Some(rows) => Cow::Owned(rows.spread_values(&values, n_channels)),
        None => values,
    }
}

/// The fields W1 … WJ and SJ.
pub(crate) fn band_fields(bands: &Bands) -> Vec<Field> {
    let n_levels = bands.n_levels();
    let name = |j: usize| if j < n_levels { format!("W{}", j + 1) } else { format!("S{n_levels}") };
    let size = bands.n_vertices * bands.n_channels;
    let field = |(j, values): (usize, &[f64])| {
        Field::new(name(j), bands.n_channels, FieldValues::F64(values.to_vec()))
    };
    bands.as_slice().chunks_exact(size).enumerate().map(field).collect()
}

/// Writes the shape with the fields S0 … SJ and W1 … WJ.
fn write_fields(
    global: &Global<'_>,
    path: &Path,
    job: &TransformJob,
    split_signal: &SplitSignal<'_>,
) -> Result<(), CliError> {
    let SplitSignal { bands, values, .. } = split_signal;
    let mut file = clone_for_output(&job.input.file, path);
    let field =
        |name: String, values: &[f64]| Field::new(name, bands.n_channels, FieldValues::F64(values.to_vec()));
    for (j, level) in all_scaling(values, bands).chunks_exact(values.len()).enumerate() {
        file.add_vertex_field(field(format!("S{j}"), level))?;
    }
    for (j, level) in bands.wavelets().enumerate() {
        file.add_vertex_field(field(format!("W{}", j + 1), level))?;
    }
    write_shape(global, &file, path).map(|_| ())
}

/// S_f(0) … S_f(J), where S_f(0) is the signal itself.
fn all_scaling(signal: &[f64], bands: &Bands) -> Vec<f64> {
    let mut scaling = bands.all_scaling();
    scaling[..signal.len()].copy_from_slice(signal);
    scaling
}
