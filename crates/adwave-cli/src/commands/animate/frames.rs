//! Reading and writing of the frames of a shape that moves.

use crate::args::to_path;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, has_extension, make_folder, note, output_format, write_file_with, write_shape};
use adwave::{ClassifiedError, ErrorKind};
use adwave_io::{
    ArrayValues, Format, MovedNormals, ReadError, ShapeFile, ShapeFrames, read_gltf_animation, read_npy,
    read_path_with, write_glb_animation, write_npy,
};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::path::{Path, PathBuf};

/// Frames of one connectivity.
pub(super) struct Frames {
    /// The first frame, with what its file has.
    pub(super) shape: ShapeFile,
    /// Positions, vertices × frames.
    pub(super) positions: Vec<[f64; 3]>,
    /// Number of frames.
    pub(super) length: usize,
    /// Seconds from frame to frame, if the file states them.
    pub(super) step: Option<f64>,
    /// Names of the files, if each frame has its own.
    names: Vec<PathBuf>,
}

/// Options of reading.
pub(super) struct FrameSource<'a> {
    pub(super) frames: &'a str,
    pub(super) positions: Option<&'a Path>,
    pub(super) animation: Option<&'a str>,
    pub(super) step: Option<f64>,
}

impl Frames {
    /// Reads the frames.
    pub(super) fn read(source: &FrameSource<'_>, global: &Global<'_>) -> Result<Self, CliError> {
        let path = to_path(source.frames);
        let is_gltf = has_extension(&path, &["glb", "gltf"]);
        if !is_gltf {
            global.given.refuse(&["--animation"], "applies to a glTF with several animations")?;
        }
        let frames = if let Some(positions) = source.positions {
            Self::from_array(&path, positions, global)?
        } else if is_gltf {
            Self::from_gltf(&path, source, global)?
        } else {
            Self::from_files(list(&path)?, source.frames, global)?
        };
        if frames.length < 2 {
            return Err(CliError::Input(format!(
                "{} has {}, and an animation has two or more",
                source.frames,
                count(frames.length, "frame", "frames")
            )));
        }
        if frames.shape.n_vertices() == 0 || frames.shape.points().is_empty() {
            return Err(CliError::Input(format!("{}: the frames have no points", source.frames)));
        }
        Ok(frames)
    }

    fn from_gltf(path: &Path, source: &FrameSource<'_>, global: &Global<'_>) -> Result<Self, CliError> {
        global.inputs.add_file(path);
        let read =
            read_gltf_animation(path, source.animation, source.step, &global.limits, global.progress());
        let ShapeFrames { shape, frames, step, notes } = read.map_err(read_error)?;
        for text in notes {
            note(global, &text);
        }
        let n_frames = frames.len();
        let mut positions = vec![[0.0; 3]; shape.n_vertices() * n_frames];
        positions.par_chunks_mut(n_frames.max(1)).enumerate().for_each(|(x, row)| {
            row.iter_mut().zip(&frames).for_each(|(position, frame)| *position = frame[x]);
        });
        Ok(Self { shape, positions, length: n_frames, step: Some(step), names: Vec::new() })
    }

    fn from_array(mesh: &Path, positions: &Path, global: &Global<'_>) -> Result<Self, CliError> {
        let shape = read(mesh, global)?;
        global.inputs.add_file(positions);
        let array = read_npy(positions, &global.limits).map_err(read_error)?;
        let (sizes, values) = (array.shape, array.values);
        let n = shape.n_vertices();
        let [n_rows, 3, n_frames] = sizes[..] else {
            return Err(CliError::Input(format!(
                "{}: positions over time are vertices × 3 × frames, got {sizes:?}",
                positions.display()
            )));
        };
        if n_rows != n {
            return Err(CliError::Input(format!(
                "{}: there must be positions for each of the {n} vertices of {}, got {n_rows}",
                positions.display(),
                mesh.display()
            )));
        }
        let mut positions = vec![[0.0; 3]; n * n_frames];
        let rows = positions.par_chunks_mut(n_frames.max(1)).enumerate();
        rows.for_each(|(x, row)| {
            for (t, position) in row.iter_mut().enumerate() {
                *position = std::array::from_fn(|c| values.get((3 * x + c) * n_frames + t));
            }
        });
        Ok(Self { shape, positions, length: n_frames, step: None, names: Vec::new() })
    }

    fn from_files(paths: Vec<PathBuf>, name: &str, global: &Global<'_>) -> Result<Self, CliError> {
        let (Some(first), true) = (paths.first(), paths.len() > 1) else {
            return Err(CliError::Input(format!(
                "{name} names {}; give a folder or a pattern in quotes such as 'walk/*.obj', a GLB with morph targets, or a \
                 mesh with --positions",
                count(paths.len(), "file", "files")
            )));
        };
        let shape = read(first, global)?;
        let n_frames = paths.len();
        let mut positions = vec![[0.0; 3]; shape.n_vertices() * n_frames];
        let mut place = |t: usize, points: &[[f64; 3]]| {
            positions.chunks_exact_mut(n_frames).zip(points).for_each(|(row, point)| row[t] = *point);
        };
        place(0, shape.points());
        with_progress(global, "reading", |progress| {
            for (k, path) in paths.iter().enumerate().skip(1) {
                progress.step(k as u64, paths.len() as u64).map_err(|_| CliError::Cancelled)?;
                let frame = read(path, global)?;
                let (n, found) = (shape.n_vertices(), frame.n_vertices());
                let differs = |what: String| {
                    Err(CliError::Input(format!(
                        "{}: all frames have the same vertices and faces, and {what}; leave that frame out or save it again",
                        path.display()
                    )))
                };
                if found != n {
                    return differs(format!("it has {found} vertices where {} has {n}", first.display()));
                }
                if frame.faces() != shape.faces() || frame.edges() != shape.edges() {
                    return differs(format!("its faces are others than those of {}", first.display()));
                }
                place(k, frame.points());
            }
            Ok(())
        })?;
        Ok(Self { shape, positions, length: n_frames, step: None, names: paths })
    }

    /// The positions of a frame.
    pub(super) fn frame(&self, t: usize) -> Vec<[f64; 3]> {
        self.positions.iter().skip(t).step_by(self.length).copied().collect()
    }

    /// Refuses a result that cannot be written, before any work.
    pub(super) fn check_output(&self, output: &Path) -> Result<(), CliError> {
        match Output::new(output) {
            Output::Array | Output::Glb => Ok(()),
            Output::Pattern => output_format(output).map(|_| ()),
            Output::Folder => {
                if Format::from_path(output).is_some() {
                    return Err(CliError::Input(format!(
                        "{}: there are {} frames, and this is the name of one file; name a folder, a pattern such as \
                         'out/*.ply', a .glb or a .npy",
                        output.display(),
                        self.length
                    )));
                }
                let Some(first) = self.names.first() else {
                    return Err(CliError::Input(format!(
                        "{}: a folder gets the names of the files that were read, and the frames are in one; write \
                         '{}/*.ply', a .glb or a .npy",
                        output.display(),
                        output.display()
                    )));
                };
                let same = |a: &Path, b: &Path| {
                    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
                };
                if first.parent().is_some_and(|folder| same(folder, output)) {
                    return Err(CliError::Input(format!(
                        "{} is the folder of the frames, which would be replaced; name another one",
                        output.display()
                    )));
                }
                output_format(first).map(|_| ())
            }
        }
    }

    /// Writes the frames, and returns what was written.
    pub(super) fn write(mut self, output: &Path, step: f64, global: &Global<'_>) -> Result<String, CliError> {
        let n_frames = self.length;
        match Output::new(output) {
            Output::Array => {
                // In place: frames × 3 becomes 3 × frames at each vertex.
                self.positions.par_chunks_exact_mut(n_frames).for_each_init(Vec::new, |row, own| {
                    row.clear();
                    row.extend_from_slice(own);
                    for (k, value) in own.as_flattened_mut().iter_mut().enumerate() {
                        *value = row[k % n_frames][k / n_frames];
                    }
                });
                let (sizes, values) = ([self.shape.n_vertices(), 3, n_frames], self.positions.as_flattened());
                write_file_with(global, output, |path| write_npy(path, &sizes, ArrayValues::F64(values)))?;
                return Ok(output.display().to_string());
            }
            Output::Glb => {
                let frames: Vec<_> = (0..n_frames).into_par_iter().map(|t| self.frame(t)).collect();
                let report = write_file_with(global, output, |path| {
                    write_glb_animation(path, &self.shape, &frames, step, global.progress())
                })?;
                for text in report.notes {
                    note(global, &format!("{}: {text}", output.display()));
                }
                return Ok(output.display().to_string());
            }
            Output::Pattern | Output::Folder => {}
        }
        let paths = self.paths(output);
        if let Some(folder) = paths.first().and_then(|path| path.parent()) {
            make_folder(folder)?;
        }
        let mut file = self.shape.clone();
        for (t, path) in paths.iter().enumerate() {
            file.move_points(self.frame(t), MovedNormals::Follow, global.progress())?;
            write_shape(global, &file, path)?;
        }
        let (first, last) = (paths[0].display(), paths[paths.len() - 1].display());
        Ok(format!("{first} … {last}"))
    }

    /// The path of each frame in a folder or by a pattern.
    fn paths(&self, output: &Path) -> Vec<PathBuf> {
        let n = self.length;
        if Output::new(output) == Output::Folder {
            return self.names.iter().map(|name| output.join(name.file_name().unwrap_or_default())).collect();
        }
        let (width, text) = (n.to_string().len().max(4), output.to_string_lossy());
        (1..=n).map(|k| PathBuf::from(text.replacen('*', &format!("{k:0width$}"), 1))).collect()
    }
}

/// Kind of a result.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Output {
    Folder,
    Pattern,
    Glb,
    Array,
}

impl Output {
    fn new(path: &Path) -> Self {
        if path.to_string_lossy().contains('*') {
            Self::Pattern
        } else if Format::from_path(path) == Some(Format::GLB) {
            Self::Glb
        } else if has_extension(path, &["npy"]) {
            Self::Array
        } else {
            Self::Folder
        }
    }
}

/// The files of a folder or of a pattern with a `*` in the name of the file, in the order of the numbers in their names.
fn list(path: &Path) -> Result<Vec<PathBuf>, CliError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (folder, pattern) = match name.split_once('*') {
        Some(parts) => (path.parent().filter(|folder| *folder != Path::new("")), Some(parts)),
        None if path.is_dir() => (Some(path), None),
        None if path.exists() => return Ok(vec![path.to_owned()]),
        None => return Err(CliError::Input(format!("{}: no such file or folder", path.display()))),
    };
    let folder = folder.unwrap_or(Path::new("."));
    let failed = |e: std::io::Error| CliError::Input(format!("{}: {e}", folder.display()));
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let own = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let fits = pattern.is_none_or(|(before, after)| {
            own.len() >= before.len() + after.len() && own.starts_with(before) && own.ends_with(after)
        });
        if fits && path.is_file() && !own.starts_with('.') {
            found.push(path);
        }
    }
    found.sort_by(|a, b| compare_numbered(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(found)
}

/// The order of names in which numbers count by their value: `frame9` stands before `frame10`.
fn compare_numbered(a: &str, b: &str) -> Ordering {
    let digits = |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (mut x, mut y) = (a, b);
    loop {
        let (n, m) = (digits(x), digits(y));
        if n > 0 && m > 0 {
            let (number, other) = (x[..n].trim_start_matches('0'), y[..m].trim_start_matches('0'));
            let order = number.len().cmp(&other.len()).then_with(|| number.cmp(other));
            if order != Ordering::Equal {
                return order;
            }
            (x, y) = (&x[n..], &y[m..]);
            continue;
        }
        match (x.chars().next(), y.chars().next()) {
            (Some(c), Some(d)) if c == d => (x, y) = (&x[c.len_utf8()..], &y[d.len_utf8()..]),
            (None, None) => return a.cmp(b),
            (c, d) => return c.cmp(&d),
        }
    }
}

fn read(path: &Path, global: &Global<'_>) -> Result<ShapeFile, CliError> {
    global.inputs.add_file(path);
    let file = read_path_with(path, &global.limits, global.progress()).map_err(read_error)?;
    let (n_rows, n_vertices) = (file.n_file_rows(), file.n_vertices());
    if n_rows > n_vertices {
        return Err(CliError::Input(format!(
            "{}: {} no position; a frame has a position for each vertex",
            path.display(),
            count(n_rows - n_vertices, "vertex has", "vertices have")
        )));
    }
    if file.carries_values() {
        return Err(CliError::Input(format!("{}: a frame is a mesh, a cloud or a curve", path.display())));
    }
    Ok(file)
}

fn read_error(error: ReadError) -> CliError {
    match error.kind() {
        ErrorKind::Cancelled => CliError::Cancelled,
        _ => CliError::input(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count_by_value() {
        let mut names =
            ["walk10.obj", "walk9.obj", "walk010b.obj", "a", "walk", "walk1.obj", "b2c10", "b2c9"];
        names.sort_by(|a, b| compare_numbered(a, b));
        assert_eq!(
            names,
            ["a", "b2c9", "b2c10", "walk", "walk1.obj", "walk9.obj", "walk10.obj", "walk010b.obj"]
        );
    }
}
