//! Files of results: checks before long work, and writing.

use super::note;
use super::progress::with_spinner;
use super::provenance::provenance;
use crate::error::CliError;
use crate::global::Global;
use adwave_io::{Format, ShapeFile, WriteError, WriteReport, atomic_write};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// The path that stands for the standard output.
const PIPE: &str = "-";

/// True if a path ends in one of these extensions, in either case.
pub(crate) fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|e| extensions.iter().any(|extension| e.eq_ignore_ascii_case(extension)))
}

/// A path without a final `.gz`, which names the compression of a table and not its format.
pub(crate) fn without_gzip(path: &Path) -> PathBuf {
    if has_extension(path, &["gz"]) { path.with_extension("") } else { path.to_owned() }
}

/// The format that the extension of a path asks for. The standard output gets that of the input, or PLY.
pub(crate) fn output_format(path: &Path) -> Result<Format, CliError> {
    if path == Path::new(PIPE) {
        return Ok(Format::PLY);
    }
    Format::from_output_path(path).map_err(|e| write_error(e.in_file(path)))
}

/// Number of files that tested a folder: two runs in one process may ask about the same folder.
static N_PROBES: AtomicU64 = AtomicU64::new(0);

/// Fails before any long work if nothing can be written to `path`.
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
    // A link is written through, and a pipe or a device needs no new name in its folder.
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

/// Makes a folder and those above it.
pub(crate) fn make_folder(path: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(path)
        .map_err(|e| CliError::Environment(format!("cannot make the folder {}: {e}", path.display())))
}

/// Writes one file of the result by `write`, which gets the path to write to.
pub(crate) fn write_file_with<T>(
    global: &Global<'_>,
    path: &Path,
    write: impl FnOnce(&Path) -> Result<T, WriteError>,
) -> Result<T, CliError> {
    global.files.write(path, write).map_err(write_error)
}

/// Writes one file of the result, compressed by gzip if its name ends in `.gz`.
pub(crate) fn write_file(global: &Global<'_>, path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    write_file_with(global, path, |path| {
        atomic_write(path, |out| {
            if !has_extension(path, &["gz"]) {
                return Ok(out.write_all(bytes)?);
            }
            let mut gzip = GzEncoder::new(out, Compression::default());
            gzip.write_all(bytes)?;
            gzip.finish()?;
            Ok(())
        })
    })
}

/// Writes a shape, with a note on the content that its format cannot store.
pub(crate) fn write_shape(
    global: &Global<'_>,
    file: &ShapeFile,
    path: &Path,
) -> Result<WriteReport, CliError> {
    with_spinner(global, "writing", || {
        let copy;
        let file = if carries_provenance(global, file, path) {
            let mut with_provenance = file.clone();
            with_provenance.set_provenance(Some(provenance(global)?));
            copy = with_provenance;
            &copy
        } else {
            file
        };
        let report = if path == Path::new(PIPE) {
            write_to_pipe(global, file)?
        } else {
            write_file_with(global, path, |path| {
                adwave_io::write_path_with(file, path, None, global.progress())
            })?
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let missing = Format::from_path(path).map(|format| file.missing_references(format, folder));
        if let Some(missing) = missing.filter(|missing| !missing.is_empty()) {
            let names = missing.join(", ");
            note(
                global,
                &format!("{} refers to {names}, which is not in its folder; copy it there", path.display()),
            );
        }
        note_report(global, path, &report);
        Ok(report)
    })
}

/// Notes the content that the format of a file cannot store.
pub(crate) fn note_report(global: &Global<'_>, path: &Path, report: &WriteReport) {
    if !report.not_written.is_empty() {
        note(global, &format!("{} cannot store {}", path.display(), report.not_written.join(", ")));
    }
    for text in &report.notes {
        note(global, &format!("{}: {text}", path.display()));
    }
}

/// True if the file carries its provenance: always in formats with a place for it, in comments of PLY and OBJ if that
/// is asked for or the file had a provenance, which would otherwise state what the shape was before.
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

/// A failed write: the fault of the machine or of the input, or the wish to stop.
pub(crate) fn write_error(error: WriteError) -> CliError {
    error.into()
}

/// A copy of a shape for a file of that name, to which further fields can be added.
pub(crate) fn clone_for_output(file: &ShapeFile, path: &Path) -> ShapeFile {
    let mut file = file.clone();
    release_source(&mut file, path);
    file
}

/// Frees the bytes that a shape was read from before long work. A scan that is written as a scan, and an image, a
/// volume, a brain or a map that is written in its format, keep them, because coordinate systems and similar records
/// are stored nowhere else.
pub(crate) fn release_source(file: &mut ShapeFile, path: &Path) {
    let is_scan = |format: Option<Format>| matches!(format, Some(Format::LAS | Format::LAZ | Format::EPT));
    let is_grid = file.grid().is_some() && file.format() == Format::grid_from_path(path);
    let is_brain = file.brain().is_some() && file.format() == Format::from_path(path);
    let is_map = file.is_map() && file.format() == Format::from_path(path);
    if !(is_grid || is_brain || is_map || is_scan(file.format()) && is_scan(Format::from_path(path))) {
        file.forget_original();
    }
}
