//! Files that hold values and no shape: `.npy`, `.csv` and `.gii`.

use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, format_of, write_error, write_shape};
use crate::signal::COORDS;
use adwave_io::{
    ArrayValues, Field, FieldValues, Format, ShapeFile, write_csv_fields, write_gifti_fields, write_npy,
};
use std::path::Path;

/// A kind of file for values alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FieldFile {
    /// One array of 64-bit floats: a row for each vertex, or one number.
    Npy,
    /// A row of names, then one for each vertex.
    Csv,
    /// An array of 32-bit floats for each channel.
    Gifti,
}

impl FieldFile {
    /// The kind that the ending of a name asks for.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
            return Some(Self::Npy);
        }
        match Format::from_path(path) {
            Some(Format::CSV) => Some(Self::Csv),
            Some(Format::GIFTI) => Some(Self::Gifti),
            _ => None,
        }
    }

    /// The kind for what became of signal `name`, where it goes alone into `path`. Positions of a shape do so as an array only, and a
    /// field of the shape's own file goes back into a file of that format.
    pub(crate) fn for_result(path: &Path, name: &str, file: &ShapeFile) -> Option<Self> {
        let kind = Self::of(path)?;
        let goes_back = if name == COORDS {
            kind != Self::Npy
        } else {
            file.field(name).is_some() && file.format().is_some() && file.format() == Format::from_path(path)
        };
        (!goes_back).then_some(kind)
    }

    /// Writes fields of as many rows each, and for a GIFTI the part of the anatomy.
    pub(crate) fn write(
        self,
        path: &Path,
        fields: &[Field],
        structure: Option<&str>,
    ) -> Result<(), CliError> {
        match self {
            Self::Npy => write_array(path, fields),
            Self::Csv => write_csv_fields(path, fields).map_err(write_error),
            Self::Gifti => write_gifti_fields(path, fields, structure).map_err(write_error),
        }
    }
}

/// Whether a file of that name has a shape together with any fields of its vertices.
pub(crate) fn holds_fields(path: &Path) -> bool {
    Format::from_path(path).is_some_and(Format::holds_fields)
}

/// Refuses a name, with the endings that `what` can have: those of formats with fields, and `others`.
pub(crate) fn no_fields(path: &Path, what: &str, others: &[&str]) -> CliError {
    no_fields_of(path, what, |_| true, others)
}

/// The same, where only some of these formats will do.
pub(crate) fn no_fields_of(path: &Path, what: &str, does: fn(Format) -> bool, others: &[&str]) -> CliError {
    let with_fields = Format::all().filter(|&format| format.holds_fields() && does(format));
    let mut endings: Vec<String> =
        with_fields.filter_map(|f| Some(format!(".{}", f.extensions().first()?))).collect();
    endings.dedup();
    endings.extend(others.iter().map(|ending| (*ending).to_owned()));
    let last = endings.pop().unwrap_or_default();
    CliError::Input(format!("{}: {what} written as {} or {last}", path.display(), endings.join(", ")))
}

/// The channels of all fields beside each other, one row for each vertex.
fn write_array(path: &Path, fields: &[Field]) -> Result<(), CliError> {
    let n = fields.first().map_or(0, Field::len);
    let n_channels: usize = fields.iter().map(|field| field.n_channels).sum();
    let row = |i: usize| fields.iter().flat_map(move |f| (0..f.n_channels).map(move |c| f.get(i, c)));
    let values: Vec<f64> = (0..n).flat_map(row).collect();
    let shape = if n_channels == 1 { vec![n] } else { vec![n, n_channels] };
    write_npy(path, &shape, ArrayValues::F64(&values)).map_err(write_error)
}

/// Writes a shape with a new field of its vertices, or into a file for values alone the field.
pub(crate) fn write_field(
    global: &Global<'_>,
    path: &Path,
    alone: Option<FieldFile>,
    file: &mut ShapeFile,
    field: Field,
) -> Result<(), CliError> {
    if let Some(kind) = alone {
        return kind.write(path, &[field], file.structure());
    }
    file.add_vertex_field(field)?;
    write_shape(global, file, path).map(|_| ())
}

/// Writes a shape, or into a file for values alone its positions.
pub(crate) fn write_points(
    global: &Global<'_>,
    path: &Path,
    alone: Option<FieldFile>,
    file: &ShapeFile,
) -> Result<(), CliError> {
    let Some(kind) = alone else { return write_shape(global, file, path).map(|_| ()) };
    let values = FieldValues::F64(file.points().as_flattened().to_vec());
    kind.write(path, &[Field::new(COORDS, 3, values)], file.structure())
}

/// Refuses a place for a shape or for values alone that cannot be written to.
pub(crate) fn check_result(path: &Path) -> Result<(), CliError> {
    if FieldFile::of(path).is_none() {
        format_of(path)?;
    }
    check_writable(path)
}
