//! Files that hold values and no shape: `.npy`, `.csv`, `.gii`, `.annot`, `.dscalar.nii`, `.dtseries.nii` and
//! `.dlabel.nii`, and images and volumes for values on the places of another one.

use super::{clone_for_output, has_extension, note, write_file, write_file_with, write_shape};
use crate::error::CliError;
use crate::global::Global;
use adwave::pages::zeros;
use adwave_io::{
    ArrayValues, BRAIN_VALUES, COORDS, CiftiColumns, Field, FieldValues, Format, GRID_VALUES, ShapeFile,
    ValueType, WriteError, rewrite_values, write_annotation, write_cifti_fields, write_csv_fields_with,
    write_gifti_fields_with, write_npy,
};
use rayon::prelude::*;
use std::path::Path;

/// A kind of file for values alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ValuesFile {
    /// One array of 64-bit floats: a row for each vertex, or one number.
    Npy,
    /// A row of names, then one for each vertex.
    Csv,
    /// An array of 32-bit floats for each channel.
    Gifti,
    /// Dense scalars or series of one structure.
    Cifti(CiftiColumns),
    /// Labels of one structure with their names and colors.
    Annotation,
    /// An image or a volume with the places of the one that was read.
    Grid,
}

impl ValuesFile {
    /// The kind that the extension of a path asks for.
    pub(crate) fn from_path(path: &Path) -> Option<Self> {
        if has_extension(path, &["npy"]) {
            return Some(Self::Npy);
        }
        if has_extension(path, &["annot"]) {
            return Some(Self::Annotation);
        }
        if let Some(columns) = CiftiColumns::from_path(path) {
            return Some(Self::Cifti(columns));
        }
        match Format::from_path(path) {
            Some(Format::CSV) => Some(Self::Csv),
            Some(Format::GIFTI) => Some(Self::Gifti),
            Some(format) if format.holds_grids() => Some(Self::Grid),
            _ => None,
        }
    }

    /// True if the extension of a path asks for a CIFTI.
    pub(crate) fn is_cifti(path: &Path) -> bool {
        matches!(Self::from_path(path), Some(Self::Cifti(_)))
    }

    /// The kind that the extension of a path asks for, for values on the places of `file`: some endings are those of
    /// images too.
    pub(crate) fn choose(path: &Path, file: &ShapeFile) -> Option<Self> {
        let kind = Self::from_path(path);
        let is_image = file.grid().is_some() && Format::grid_from_path(path).is_some();
        if is_image && kind != Some(Self::Npy) { Some(Self::Grid) } else { kind }
    }

    /// The kind for an edited signal, if it goes alone into `path`. Positions of a shape do so as an array only, and a
    /// field of the shape's own file goes back into a file of that format.
    pub(crate) fn choose_for_edited_signal(path: &Path, signal: &str, file: &ShapeFile) -> Option<Self> {
        let kind = Self::choose(path, file)?;
        let format = if kind == Self::Grid { Format::grid_from_path(path) } else { Format::from_path(path) };
        let goes_back = if signal == COORDS {
            kind != Self::Npy
        } else {
            file.field(signal).is_some() && file.format().is_some() && file.format() == format
        };
        (!goes_back).then_some(kind)
    }

    /// Writes fields with the same number of rows, in the rows of the file. A GIFTI gets the anatomical structure of
    /// `file` too.
    pub(crate) fn write(
        self,
        global: &Global<'_>,
        path: &Path,
        fields: &[Field],
        file: &ShapeFile,
    ) -> Result<(), CliError> {
        if self == Self::Grid {
            return write_grid(global, path, count_channels(fields), |i, row| copy_row(fields, i, row), file);
        }
        if let (Self::Cifti(_), Some(_)) = (self, file.brain()) {
            let mut brain = clone_for_output(file, path);
            let values = FieldValues::F64(join(fields));
            brain.add_vertex_field(Field::new(BRAIN_VALUES, count_channels(fields), values))?;
            return write_shape(global, &brain, path).map(|_| ());
        }
        let fields: Vec<Field> = fields.iter().map(|field| file.in_file_rows(field.clone())).collect();
        if let Self::Cifti(columns) = self {
            let Some(structure) = file.structure() else {
                return Err(CliError::Input(format!(
                    "{}: a CIFTI names the structure of its surface, and the surface does not state it; use a GIFTI that \
                     does (AnatomicalStructurePrimary), or name its file with lh. or rh. at the beginning",
                    path.display()
                )));
            };
            if columns == CiftiColumns::Series {
                note(
                    global,
                    &format!(
                        "{}: the samples of the series are written as 1 s apart; a series of the same length that is \
                         edited keeps its time step",
                        path.display()
                    ),
                );
            }
            return write_file_with(global, path, |path| {
                write_cifti_fields(path, &fields, structure, columns)
            });
        }
        write_file_with(global, path, |path| match self {
            Self::Npy => write_array(path, &fields, file),
            Self::Csv => write_csv_fields_with(path, &fields, global.progress()),
            Self::Annotation => write_one_annotation(path, &fields),
            Self::Gifti | Self::Cifti(_) | Self::Grid => {
                write_gifti_fields_with(path, &fields, file.structure(), global.progress())
            }
        })
    }

    /// Writes new values of a signal that came from a file: into a copy of it if that is a GIFTI or CIFTI with these
    /// columns, so that its names, intents and other structures stay; else into a new file.
    pub(crate) fn write_edited(
        self,
        global: &Global<'_>,
        path: &Path,
        signal: &str,
        field: Field,
        file: &ShapeFile,
    ) -> Result<(), CliError> {
        let source = Path::new(signal);
        if matches!(self, Self::Gifti | Self::Cifti(_)) && source.is_file() {
            let rows = file.in_file_rows(field.clone());
            if let Some(bytes) = rewrite_values(source, file.structure(), &rows, path)? {
                return write_file(global, path, &bytes);
            }
            if matches!(self, Self::Cifti(_)) && is_cifti(source) {
                note(
                    global,
                    &format!(
                        "{}: a new CIFTI with the values of this surface alone; a result with as many columns and the \
                         ending of {signal} keeps its other structures, names and time step",
                        path.display()
                    ),
                );
            }
        }
        self.write(global, path, &[field], file)
    }
}

/// Writes the labels of the one field as an annotation.
fn write_one_annotation(path: &Path, fields: &[Field]) -> Result<(), WriteError> {
    match fields {
        [field] => write_annotation(path, field),
        _ => write_annotation(
            path,
            &Field::new("values", count_channels(fields), FieldValues::F64(join(fields))),
        ),
    }
}

/// True if the name is that of a CIFTI of any kind: `.dlabel.nii`.
fn is_cifti(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    [".nii", ".nii.gz"].iter().any(|extension| name.ends_with(extension))
}

/// True if a file of that name stores a shape together with any fields of its vertices.
pub(crate) fn holds_fields(path: &Path) -> bool {
    Format::from_path(path).is_some_and(Format::holds_fields)
}

/// Refuses a path for `what` ("bands are"), with the extensions that would do: those of formats with fields, and
/// `others`.
pub(crate) fn unsuitable_format(path: &Path, what: &str, others: &[&str]) -> CliError {
    unsuitable_format_among(path, what, |_| true, others)
}

/// Refuses a path as [`unsuitable_format`] does, if only formats that are `suitable` would do.
pub(crate) fn unsuitable_format_among(
    path: &Path,
    what: &str,
    suitable: fn(Format) -> bool,
    others: &[&str],
) -> CliError {
    let with_fields = Format::all().filter(|&format| format.holds_fields() && suitable(format));
    let mut extensions: Vec<String> =
        with_fields.filter_map(|f| Some(format!(".{}", f.extensions().first()?))).collect();
    extensions.dedup();
    extensions.extend(others.iter().map(|extension| (*extension).to_owned()));
    let last = extensions.pop().unwrap_or_default();
    CliError::Input(format!("{}: {what} written as {} or {last}", path.display(), extensions.join(", ")))
}

/// Writes a shape with a new field of its vertices, or the field alone.
pub(crate) fn write_field(
    global: &Global<'_>,
    path: &Path,
    alone: Option<ValuesFile>,
    file: &mut ShapeFile,
    field: Field,
) -> Result<(), CliError> {
    if let Some(kind) = alone {
        return kind.write(global, path, &[field], file);
    }
    file.add_vertex_field(field)?;
    write_shape(global, file, path).map(|_| ())
}

/// The channels of all fields beside each other, one row for each vertex; of an image or a volume, an axis for each of
/// its axes.
fn write_array(path: &Path, fields: &[Field], file: &ShapeFile) -> Result<(), WriteError> {
    let n = fields.first().map_or(0, Field::len);
    let n_channels = count_channels(fields);
    let mut shape = file.grid().map_or_else(|| vec![n], |grid| grid.sizes.clone());
    if n_channels != 1 {
        shape.push(n_channels);
    }
    write_npy(path, &shape, ArrayValues::F64(&join(fields)))
}

fn count_channels(fields: &[Field]) -> usize {
    fields.iter().map(|field| field.n_channels).sum()
}

/// Rows that a thread joins at a time.
const JOINED_AT_A_TIME: usize = 1 << 12;

/// The channels of all fields beside each other.
fn join(fields: &[Field]) -> Vec<f64> {
    if let [Field { values: FieldValues::F64(values), .. }] = fields {
        return values.clone();
    }
    join_rows(
        fields.first().map_or(0, Field::len),
        count_channels(fields),
        |v| v,
        |i, row| copy_row(fields, i, row),
    )
}

/// Copies the channels of all fields at row `i`.
fn copy_row(fields: &[Field], i: usize, row: &mut [f64]) {
    let mut rest = row;
    for field in fields {
        let (own, after) = rest.split_at_mut(field.n_channels);
        own.iter_mut().enumerate().for_each(|(c, v)| *v = field.get(i, c));
        rest = after;
    }
}

/// The rows that `copy(i, row)` fills, n × `n_channels`, with each number converted.
fn join_rows<T: Copy + Default + Send>(
    n: usize,
    n_channels: usize,
    convert: fn(f64) -> T,
    copy: impl Fn(usize, &mut [f64]) + Sync,
) -> Vec<T> {
    let mut joined = zeros(n * n_channels);
    joined.par_chunks_mut((JOINED_AT_A_TIME * n_channels).max(1)).enumerate().for_each(|(chunk, rows)| {
        let mut values = vec![0.0; n_channels];
        for (k, row) in rows.chunks_exact_mut(n_channels).enumerate() {
            copy(chunk * JOINED_AT_A_TIME + k, &mut values);
            row.iter_mut().zip(&values).for_each(|(to, from)| *to = convert(*from));
        }
    });
    joined
}

/// Writes values as the channels of an image or a volume, in the type that is asked for, else as floats of 32 bits, or of
/// 64 if the one that was read has these; `copy(i, row)` fills the row of place i.
pub(crate) fn write_grid(
    global: &Global<'_>,
    path: &Path,
    n_channels: usize,
    copy: impl Fn(usize, &mut [f64]) + Sync,
    file: &ShapeFile,
) -> Result<(), CliError> {
    if file.grid().is_none() {
        return Err(CliError::Input(format!(
            "{}: an image or a volume is written for values of an image or a volume alone; use .npy",
            path.display()
        )));
    }
    let mut grid = clone_for_output(file, path);
    let (kind, n) = (grid_type(file), file.n_vertices());
    let singles = (kind == ValueType::F32).then(|| join_rows(n, n_channels, |v| v as f32, &copy));
    // A value beyond the range of 32 bits is refused when it is written.
    let values = match singles.filter(|values| !values.iter().any(|value| value.is_infinite())) {
        Some(values) => FieldValues::F32(values),
        None => FieldValues::F64(join_rows(n, n_channels, |v| v, &copy)),
    };
    grid.set_value_type(Some(kind));
    grid.add_vertex_field(Field::new(GRID_VALUES, n_channels, values))?;
    write_shape(global, &grid, path).map(|_| ())
}

/// Type of values that are computed from those of an image or a volume: the one that is asked for, else floats of 64 bits
/// if it has these, else of 32 bits.
pub(crate) fn grid_type(file: &ShapeFile) -> ValueType {
    let is_double = file.field(GRID_VALUES).is_some_and(|field| field.values.value_type() == ValueType::F64);
    file.value_type().unwrap_or(if is_double { ValueType::F64 } else { ValueType::F32 })
}
