//! What people read, what machines read, and where files may go.

use crate::args::LevelArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::provenance::provenance;
use adwave::Decomposer;
use adwave::bands::{BandsParams, DEFAULT_EXTENT, FWHM, Schedule};
use adwave::region::Length;
use adwave_io::{Format, ShapeFile, WriteError, WriteReport};
use adwave_report::digits;
use comfy_table::{CellAlignment, Table, presets};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Prints the result: `text` for people, or `json` for machines.
pub(crate) fn print(global: &Global<'_>, text: &str, json: &Value) -> Result<(), CliError> {
    if global.is_piped {
        // The standard output is the shape's.
        let said = if global.json { format!("{json:#}") } else { text.trim_end().to_owned() };
        if global.json || !global.quiet {
            eprintln!("{said}");
        }
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    let printed = if global.json {
        writeln!(out, "{json:#}")
    } else if global.quiet {
        Ok(())
    } else {
        writeln!(out, "{}", text.trim_end())
    };
    printed.and_then(|()| out.flush()).map_err(|e| match e.kind() {
        std::io::ErrorKind::BrokenPipe => CliError::ClosedPipe,
        _ => CliError::Environment(format!("cannot write to the standard output: {e}")),
    })
}

/// A length in % of the diagonal; a dash where there is none, as on a graph.
pub(crate) fn percent_of(length: f64, diagonal: f64) -> String {
    if diagonal > 0.0 { number(100.0 * length / diagonal) } else { "–".to_owned() }
}

/// The corners of a box in the digits that its size asks for: four of the `diagonal` of the whole.
pub(crate) fn bounds_text((low, high): ([f64; 3], [f64; 3]), diagonal: f64) -> String {
    let decimals = if diagonal > 0.0 { 3.0 - diagonal.log10().floor() } else { 3.0 };
    let coordinate = |c: f64| {
        let is_plain = c.abs() < 1e9 && decimals <= 9.0;
        if is_plain { format!("{c:.*}", decimals.max(0.0) as usize) } else { number(c) }
    };
    let corner = |p: [f64; 3]| p.map(coordinate).join(" ");
    format!("{} to {}", corner(low), corner(high))
}

/// The same for machines.
pub(crate) fn bounds_json(bounds: Option<([f64; 3], [f64; 3])>) -> Value {
    json!(bounds.map(|(min, max)| json!({"min": min, "max": max})))
}

/// Says something that is not the result, to people only.
pub(crate) fn note(global: &Global<'_>, text: &str) {
    if !global.quiet {
        eprintln!("note: {text}");
    }
}

/// A table with a line under its head, numbers to the right.
pub(crate) fn table<const N: usize>(head: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(head).add_rows(rows);
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
        column.set_padding((0, 2));
    }
    table.lines().fold(String::new(), |text, line| text + "  " + line.trim_end() + "\n")
}

/// Four significant digits, in scientific notation where the number is very large or small.
pub(crate) fn number(value: f64) -> String {
    if value.is_finite() { digits(value) } else { value.to_string() }
}

/// A number of steps: whole as it is, else four significant digits.
pub(crate) fn steps_text(steps: f64) -> String {
    if steps.fract() == 0.0 { steps.to_string() } else { number(steps) }
}

/// So many levels, in words.
pub(crate) fn levels_text(n_levels: usize) -> String {
    format!("{n_levels} level{}", if n_levels == 1 { "" } else { "s" })
}

/// Numbers of steps, the whole ones as whole numbers.
pub(crate) fn steps_json(steps: &[f64]) -> Vec<Value> {
    steps.iter().map(|&n| if n.fract() == 0.0 { json!(n as u64) } else { json!(n) }).collect()
}

/// The schedule that the arguments ask for, and why it has as many levels.
pub(crate) fn schedule(
    args: &LevelArgs,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<(Schedule, String), CliError> {
    schedule_reaching(DEFAULT_EXTENT, args, decomposer, global)
}

/// The same, with levels up to a share of the diagonal where no number is asked for.
pub(crate) fn schedule_reaching(
    reach: f64,
    args: &LevelArgs,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<(Schedule, String), CliError> {
    check_levels(args)?;
    if let Some(steps) = &args.steps {
        let schedule = Schedule::real(steps.clone())?;
        let why = format!("{}, of the steps asked for", levels_text(schedule.n_levels()));
        return Ok((schedule, why));
    }
    if let Some(widths) = args.widths() {
        let schedule = schedule_of(&widths, decomposer, global)?;
        let why = format!("{}, of the widths asked for", levels_text(schedule.n_levels()));
        return Ok((schedule, why));
    }
    let (levels, why) = match args.levels {
        Some(levels) => (levels, format!("{}, the number asked for", levels_text(levels))),
        None => decomposer.levels_reaching(reach),
    };
    match args.voices {
        Some(voices) => {
            let schedule = Schedule::voices(levels, voices)?;
            let why =
                format!("{}, {voices} for each doubling of the steps", levels_text(schedule.n_levels()));
            Ok((schedule, why))
        }
        None => Ok((Schedule::dyadic(levels)?, why)),
    }
}

/// Levels of these widths σ, with a note where one is finer than the edges or wider than the shape.
pub(crate) fn schedule_of(
    widths: &[Length],
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Schedule, CliError> {
    let diagonal = decomposer.diagonal();
    let sigma: Vec<f64> = widths.iter().map(|width| width.to_model_units(diagonal)).collect();
    let schedule = Schedule::lengths(&sigma, decomposer.diffusion().step_length())?;
    let edge = decomposer.mean_length();
    if diagonal > 0.0 && sigma[0] < edge {
        let said = format!(
            "σ = {} is below the mean edge of {}: such a band shows the mesh",
            number(sigma[0]),
            number(edge)
        );
        note(global, &said);
    }
    if let Some(widest) = sigma.last().filter(|widest| diagonal > 0.0 && **widest > diagonal) {
        let said =
            format!("σ = {} is beyond the shape, whose diagonal is {}", number(*widest), number(diagonal));
        note(global, &said);
    }
    Ok(schedule)
}

/// The full width at half maximum of each width σ; none of a graph, which has no lengths.
pub(crate) fn fwhm_text(sigma: f64, diagonal: f64) -> String {
    if diagonal > 0.0 { number(FWHM * sigma) } else { "–".to_owned() }
}

/// The same for machines.
pub(crate) fn fwhm_json(sigma: &[f64], diagonal: f64) -> Value {
    if diagonal > 0.0 { sigma.iter().map(|sigma| FWHM * sigma).collect() } else { Value::Null }
}

/// Refuses levels that no shape can have, before any shape is read.
pub(crate) fn check_levels(args: &LevelArgs) -> Result<(), CliError> {
    if let Some(steps) = &args.steps {
        Schedule::real(steps.clone())?;
    }
    if let Some(widths) = args.lengths.as_ref().or(args.fwhm.as_ref()) {
        // Those of different units can be compared only when the shape is known.
        let rises = |k: usize| match (widths[k], if k == 0 { Length::Units(0.0) } else { widths[k - 1] }) {
            (Length::Units(width), Length::Units(before))
            | (Length::PercentOfDiagonal(width), Length::PercentOfDiagonal(before)) => width > before,
            (Length::Units(width) | Length::PercentOfDiagonal(width), _) => width > 0.0,
        };
        let is_finite =
            |k: usize| matches!(widths[k], Length::Units(w) | Length::PercentOfDiagonal(w) if w.is_finite());
        if let Some(bad) = (0..widths.len()).find(|&k| !(rises(k) && is_finite(k))) {
            let (Length::Units(width) | Length::PercentOfDiagonal(width)) = widths[bad];
            return Err(CliError::Input(format!(
                "{}: {width:?} is number {} of the widths; they must be positive, finite and increasing",
                if args.fwhm.is_some() { "--fwhm" } else { "--lengths" },
                bad + 1
            )));
        }
    }
    if let Some(levels) = args.levels {
        Schedule::dyadic(levels)?;
    }
    if let Some(voices) = args.voices {
        Schedule::voices(1, voices)?;
    }
    Ok(())
}

/// What stands for the standard output.
const PIPE: &str = "-";

/// The format that a path asks for by its extension; the standard output gets that of the input, or PLY.
pub(crate) fn format_of(path: &Path) -> Result<Format, CliError> {
    if path == Path::new(PIPE) {
        return Ok(Format::PLY);
    }
    Format::from_output_path(path).map_err(|e| write_error(e.in_file(path)))
}

/// Files that were tried: two runs in one process may ask about the same folder.
static N_PROBES: AtomicU64 = AtomicU64::new(0);

/// Fails before any long work when nothing can be written to `path`.
pub(crate) fn check_writable(path: &Path) -> Result<(), CliError> {
    if path == Path::new(PIPE) {
        return Ok(());
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(CliError::Input(format!(
            "{}: the folder '{}' does not exist; make it first",
            path.display(),
            folder.display()
        )));
    }
    if path.is_dir() {
        return Err(CliError::Input(format!("{} is a folder; name a file in it", path.display())));
    }
    // A link is written through, and what is no regular file (a pipe, /dev/null) needs no new name in its folder.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    if target.exists() && !target.is_file() {
        return Ok(());
    }
    let nth = N_PROBES.fetch_add(1, Ordering::Relaxed);
    let probe = target.with_file_name(format!(".adwave-probe-{}-{nth}.tmp", std::process::id()));
    std::fs::File::create(&probe)
        .and_then(|_| std::fs::remove_file(&probe))
        .map_err(|e| CliError::Environment(format!("cannot write {}: {e}", path.display())))
}

/// Writes a shape and says what its format could not hold.
pub(crate) fn write_shape(
    global: &Global<'_>,
    file: &ShapeFile,
    path: &Path,
) -> Result<WriteReport, CliError> {
    let own;
    let file = if carries_provenance(global, file, path) {
        let mut copy = file.clone();
        copy.set_provenance(Some(provenance(global)?));
        own = copy;
        &own
    } else {
        file
    };
    let report = if path == Path::new(PIPE) {
        write_to_pipe(global, file)?
    } else {
        adwave_io::write_path_with(file, path, None, global.progress()).map_err(write_error)?
    };
    if !report.not_written.is_empty() {
        note(global, &format!("{} cannot hold {}", path.display(), report.not_written.join(", ")));
    }
    Ok(report)
}

/// Comments say it where that is asked for, and where they would go on saying what the shape was before.
fn carries_provenance(global: &Global<'_>, file: &ShapeFile, path: &Path) -> bool {
    let Some(format) = Format::from_path(path) else { return false };
    let is_asked_for = global.inputs.in_comments || file.provenance().is_some();
    format.holds_provenance() || (format.holds_provenance_comment() && is_asked_for)
}

/// Writes a shape to the standard output, in the format that it came in or as PLY.
fn write_to_pipe(global: &Global<'_>, file: &ShapeFile) -> Result<WriteReport, CliError> {
    let format = file.format().filter(|format| format.can_write()).unwrap_or(Format::PLY);
    let mut out = std::io::BufWriter::with_capacity(1 << 18, std::io::stdout().lock());
    let written = adwave_io::write_bytes_with(file, format, &mut out, global.progress());
    let written = written.and_then(|report| out.flush().map(|()| report).map_err(WriteError::from));
    written.map_err(|error| match error {
        WriteError::Io(e) if e.kind() == std::io::ErrorKind::BrokenPipe => CliError::ClosedPipe,
        error => write_error(error),
    })
}

/// The command of these words, so that it can be typed.
pub(crate) fn command_line<'a>(words: impl Iterator<Item = &'a OsString>) -> String {
    let safe = |c: char| c.is_alphanumeric() || "-_./:,=+@%".contains(c);
    let quoted = |word: String| {
        if !word.is_empty() && word.chars().all(safe) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = words.map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("adwave".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// A failed write: the disk's fault or the user's, or the user's wish.
pub(crate) fn write_error(error: WriteError) -> CliError {
    error.into()
}

/// How the bands are computed, within the memory that the machine has left.
pub(crate) fn bands_params(args: &LevelArgs) -> Result<BandsParams, CliError> {
    let params = BandsParams::default().with_accuracy(args.accuracy);
    params.check()?;
    Ok(available_memory().map_or(params, |bytes| params.with_max_bytes(bytes)))
}

/// The memory that a new program may take without pushing others out, in bytes, where the system tells.
pub(crate) fn available_memory() -> Option<u64> {
    let info = std::fs::read_to_string("/proc/meminfo").ok()?;
    kib(info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?)
}

fn kib(text: &str) -> Option<u64> {
    text.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

/// The most memory that this process has held, in bytes, where the system tells.
pub(crate) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    kib(status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?)
}
