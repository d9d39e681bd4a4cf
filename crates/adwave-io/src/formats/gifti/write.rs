//! Writer for GIFTI surfaces and values, as read by Connectome Workbench, FreeSurfer and nibabel.
//!
//! Arrays have the three types of the standard: 32-bit floats, 32-bit integers and bytes, compressed by zlib in
//! Base64. Points and `f64` fields are rounded to 32-bit floats, as is common in the field.

use std::io::Write;
use std::path::Path;

use adwave::Progress;
use flate2::Compression;
use flate2::write::GzEncoder;

use super::array::STRUCTURE;
use super::numbers::{ArrayStorage, Encoding};
use crate::model::f32_limits::{check_range, is_single, triangles};
use crate::model::field::ByteOrder;
use crate::model::grouping::column_names;
use crate::model::label_table::{LabelTable, label_key};
use crate::progress::{CancellableWriter, all};
use crate::text::escape_xml;
use crate::{
    CoordinatePrecision, Field, FieldValues, Format, ShapeFile, ValueType, WriteError, WriteReport,
    atomic_write_with,
};

/// Text before the arrays, without their number.
const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <!DOCTYPE GIFTI SYSTEM \"http://gifti.projects.nitrc.org/gifti.dtd\">\n";

/// Coordinate system of the points: unknown.
const SPACE: &str = "<CoordinateSystemTransformMatrix>\n<DataSpace>NIFTI_XFORM_UNKNOWN</DataSpace>\n\
    <TransformedSpace>NIFTI_XFORM_UNKNOWN</TransformedSpace>\n\
    <MatrixData>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</MatrixData>\n</CoordinateSystemTransformMatrix>\n";

/// Type in which a GIFTI stores the values, rounded if necessary.
fn stored(values: &FieldValues) -> ValueType {
    let is_i32 = |x: f64| (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&x);
    match values {
        FieldValues::U8(_) => ValueType::U8,
        FieldValues::I8(_) | FieldValues::I16(_) | FieldValues::U16(_) | FieldValues::I32(_) => {
            ValueType::I32
        }
        FieldValues::U32(_) | FieldValues::I64(_) | FieldValues::U64(_) => {
            let all_fit = (0..values.len()).all(|i| is_i32(values.get(i)));
            if all_fit { ValueType::I32 } else { ValueType::F32 }
        }
        FieldValues::F32(_) | FieldValues::F64(_) => ValueType::F32,
    }
}

/// Type in which a GIFTI stores a field: 32-bit integers for labels.
fn stored_type(field: &Field) -> ValueType {
    if field.labels.is_some() { ValueType::I32 } else { stored(&field.values) }
}

/// Description of an array besides its numbers.
struct ArrayHeader<'a> {
    intent: &'static str,
    /// Names and values of its metadata.
    about: Vec<(&'static str, &'a str)>,
    /// Text between metadata and numbers.
    space: &'static str,
    kind: ValueType,
    rows: usize,
    columns: usize,
}

impl ArrayHeader<'_> {
    /// Writes the array; `value(i)` is number i by rows.
    fn write(
        &self,
        out: &mut dyn Write,
        progress: Progress<'_>,
        value: impl Fn(usize) -> f64,
    ) -> Result<(), WriteError> {
        let Self { intent, space, kind, rows, columns, .. } = *self;
        let dimensions = if columns == 1 {
            format!("Dimensionality=\"1\" Dim0=\"{rows}\"")
        } else {
            format!("Dimensionality=\"2\" Dim0=\"{rows}\" Dim1=\"{columns}\"")
        };
        let name = match kind {
            ValueType::U8 => "UINT8",
            ValueType::I32 => "INT32",
            _ => "FLOAT32",
        };
        write!(
            out,
            "<DataArray Intent=\"NIFTI_INTENT_{intent}\" DataType=\"NIFTI_TYPE_{name}\" \
             ArrayIndexingOrder=\"RowMajorOrder\" {dimensions} Encoding=\"GZipBase64Binary\" \
             Endian=\"LittleEndian\" ExternalFileName=\"\" ExternalFileOffset=\"\">\n{}{space}",
            metadata(&self.about),
        )?;
        let (order, encoding, by_column) = (ByteOrder::Little, Encoding::ZlibBase64, false);
        ArrayStorage { kind, order, encoding, by_column, rows, columns }.write(out, progress, value)?;
        Ok(out.write_all(b"\n</DataArray>\n")?)
    }
}

fn metadata(entries: &[(&str, &str)]) -> String {
    let mut xml = String::from("<MetaData>\n");
    for (name, value) in entries {
        xml += &format!("<MD><Name>{name}</Name><Value>{}</Value></MD>\n", escape_xml(value));
    }
    xml + "</MetaData>\n"
}

/// Writes the head with the anatomical structure, which Connectome Workbench requires.
fn write_head(
    out: &mut dyn Write,
    n_arrays: usize,
    structure: Option<&str>,
    labels: &LabelTable,
) -> Result<(), WriteError> {
    let about = metadata(&about(structure));
    write!(out, "{HEAD}<GIFTI Version=\"1.0\" NumberOfDataArrays=\"{n_arrays}\">\n{about}")?;
    let table = if labels.entries().is_empty() { "<LabelTable/>\n".to_owned() } else { labels.to_xml() };
    Ok(out.write_all(table.as_bytes())?)
}

/// The one table of labels of a GIFTI.
fn label_table(fields: &[Field]) -> Result<LabelTable, WriteError> {
    let with_labels = || fields.iter().filter(|field| field.labels.is_some());
    let values = with_labels().flat_map(|field| (0..field.values.len()).map(|i| field.values.get(i)));
    LabelTable::join(with_labels().filter_map(|field| field.labels.as_ref()))
        .and_then(|table| table.with_labels(values))
        .map_err(|what| WriteError::CannotHold { format: Format::GIFTI, what })
}

/// Number i of a field as it is stored: that of a label for NaN among labels.
fn stored_value(field: &Field, i: usize) -> f64 {
    let value = field.values.get(i);
    match field.labels {
        Some(_) => label_key(value).map_or(value, f64::from),
        None => value,
    }
}

fn about(structure: Option<&str>) -> Vec<(&'static str, &str)> {
    structure.map(|structure| (STRUCTURE, structure)).into_iter().collect()
}

/// Intent of a field.
fn intent(name: &str, n_channels: usize) -> &'static str {
    match (name, n_channels) {
        ("color", 3) => "RGB_VECTOR",
        ("color", 4) => "RGBA_VECTOR",
        (_, 1) => "SHAPE",
        (_, 3) => "VECTOR",
        _ => "NONE",
    }
}

/// Writes points, triangles and vertex fields; polygons are split into triangles.
pub(crate) fn write_gifti(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let coordinates = shape.points.as_flattened();
    check_range(Format::GIFTI, "coordinates", coordinates.len(), progress, |i| coordinates[i])?;
    if shape.precision == CoordinatePrecision::F64
        && !is_single(coordinates.len(), progress, |i| coordinates[i])?
    {
        report.report_dropped("digits of coordinates beyond 32-bit floats");
    }
    shape.vertex_fields.iter().try_for_each(|field| check_field(field, report, progress))?;
    report.report_face_fields(shape, &[]);
    if !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    }
    let triangles = triangles(shape, report);
    let n_arrays = 1 + usize::from(!triangles.is_empty()) + shape.vertex_fields.len();
    let structure = shape.structure.as_deref();
    write_head(out, n_arrays, structure, &label_table(&shape.vertex_fields)?)?;
    let (rows, about) = (shape.points.len(), about(structure));
    ArrayHeader { intent: "POINTSET", about, space: SPACE, kind: ValueType::F32, rows, columns: 3 }.write(
        out,
        progress,
        |i| coordinates[i],
    )?;
    if !triangles.is_empty() {
        let (rows, corners) = (triangles.len(), triangles.as_flattened());
        ArrayHeader {
            intent: "TRIANGLE",
            about: Vec::new(),
            space: "",
            kind: ValueType::I32,
            rows,
            columns: 3,
        }
        .write(out, progress, |i| corners[i].into())?;
    }
    shape.vertex_fields.iter().try_for_each(|field| write_field(field, out, progress))?;
    Ok(out.write_all(b"</GIFTI>\n")?)
}

/// Checks that the values can be stored, and reports digits that are dropped.
pub(super) fn check_field(
    field: &Field,
    report: &mut WriteReport,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let (n, value) = (field.values.len(), |i: usize| field.values.get(i));
    check_range(Format::GIFTI, &format!("values of `{}`", field.name), n, progress, value)?;
    // Larger integers have more digits than even a 64-bit float.
    let has_more = |x: f64| field.values.value_type().is_integer() && x.abs() >= (1_u64 << 53) as f64;
    let keeps_all = is_single(n, progress, value)? && all(n, progress, |i| !has_more(value(i)))?;
    if stored_type(field) == ValueType::F32 && !keeps_all {
        report.report_dropped(format!("digits of `{}` beyond 32-bit floats", field.name));
    }
    Ok(())
}

/// Writes a vertex field as one array.
pub(super) fn write_field(
    field: &Field,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let is_label = field.labels.is_some();
    let intent = if is_label { "LABEL" } else { intent(&field.name, field.n_channels) };
    let about = vec![("Name", field.name.as_str())];
    let (kind, rows, columns) = (stored_type(field), field.len(), field.n_channels);
    ArrayHeader { intent, about, space: "", kind, rows, columns }
        .write(out, progress, |i| stored_value(field, i))
}

/// Writes fields without a surface: one array per channel, like the columns of functional and metric files, named as
/// in a table (`flow_x` or `hks_0`). Numbers other than bytes and 32-bit integers are rounded to 32-bit floats.
/// `structure` is the anatomical structure, such as `CortexLeft`. `.gz` after the extension compresses.
///
/// ```
/// use adwave_io::{Field, FieldValues, ReadLimits, read_gifti_fields, write_gifti_fields};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("map.shape.gii");
/// let field = Field::new("saliency", 1, FieldValues::F64(vec![0.5, -2.0, f64::NAN]));
/// write_gifti_fields(&path, &[field], Some("CortexLeft")).unwrap();
/// let read = read_gifti_fields(&path, &ReadLimits::default()).unwrap();
/// assert_eq!((read[0].name.as_str(), read[0].get(1, 0)), ("saliency", -2.0));
/// ```
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write), and [`WriteError::CannotHold`] for finite numbers beyond the
/// range of 32-bit floats.
pub fn write_gifti_fields(path: &Path, fields: &[Field], structure: Option<&str>) -> Result<(), WriteError> {
    write_gifti_fields_with(path, fields, structure, Progress::none())
}

/// [`write_gifti_fields`] with cancellation.
///
/// # Errors
/// The errors of [`write_gifti_fields`], and [`WriteError::Cancelled`].
pub fn write_gifti_fields_with(
    path: &Path,
    fields: &[Field],
    structure: Option<&str>,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    atomic_write_with(path, progress, |out| {
        if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz")) {
            return write_fields(fields, structure, out, progress);
        }
        let mut gz = GzEncoder::new(out, Compression::default());
        write_fields(fields, structure, &mut gz, progress)?;
        gz.finish()?;
        Ok(())
    })
}

fn write_fields(
    fields: &[Field],
    structure: Option<&str>,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let out = &mut CancellableWriter::new(out, progress);
    for field in fields {
        let value = |i: usize| field.values.get(i);
        check_range(
            Format::GIFTI,
            &format!("values of `{}`", field.name),
            field.values.len(),
            progress,
            value,
        )?;
    }
    write_head(out, fields.iter().map(|field| field.n_channels).sum(), structure, &label_table(fields)?)?;
    for field in fields {
        let (kind, rows, n) = (stored_type(field), field.len(), field.n_channels);
        let intent = if field.labels.is_some() { "LABEL" } else { "SHAPE" };
        let names = if n == 1 { vec![field.name.clone()] } else { column_names(field) };
        for (c, name) in names.iter().enumerate() {
            let about = vec![("Name", name.as_str())];
            ArrayHeader { intent, about, space: "", kind, rows, columns: 1 }
                .write(out, progress, |i| stored_value(field, i * n + c))?;
        }
    }
    Ok(out.write_all(b"</GIFTI>\n")?)
}
