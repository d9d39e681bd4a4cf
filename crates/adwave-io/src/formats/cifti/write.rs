//! CIFTI writer: dense scalars and series of one surface, as read by Connectome Workbench and nibabel.
//!
//! Library: none. The crate `nifti` 0.17 writes NIfTI-1 headers without the extension that holds the XML.

use std::fmt::Write as _;
use std::path::Path;

use adwave::Progress;

use super::CIFTI;
use super::read::HEADER;
use crate::model::f32_limits::check_range;
use crate::model::grouping::column_names;
use crate::model::label_table::{LabelTable, label_key};
use crate::text::escape_xml;
use crate::{Field, WriteError, atomic_write_with};

/// Meaning of the columns of a CIFTI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CiftiColumns {
    /// Named maps: `.dscalar.nii`.
    Scalars,
    /// Samples of a series: `.dtseries.nii`. They are one second apart unless the first field states its time step.
    Series,
    /// Named maps of labels with names and colors: `.dlabel.nii`. Each field has its table of labels.
    Labels,
}

impl CiftiColumns {
    /// Meaning that the ending of a file's name asks for; `None` for another ending.
    ///
    /// ```
    /// use adwave_io::CiftiColumns;
    /// let columns = |name: &str| CiftiColumns::from_path(name.as_ref());
    /// assert_eq!(columns("rest.dtseries.nii"), Some(CiftiColumns::Series));
    /// assert_eq!(columns("brain.nii"), None);
    /// ```
    pub fn from_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        match () {
            () if name.ends_with(".dscalar.nii") => Some(Self::Scalars),
            () if name.ends_with(".dtseries.nii") => Some(Self::Series),
            () if name.ends_with(".dlabel.nii") => Some(Self::Labels),
            () => None,
        }
    }

    /// Code and name of the intent in the header.
    pub(super) fn intent(self) -> (i32, &'static str) {
        match self {
            Self::Scalars => (3006, "ConnDenseScalar"),
            Self::Series => (3002, "ConnDenseSeries"),
            Self::Labels => (3007, "ConnDenseLabel"),
        }
    }
}

/// Name of a structure in a CIFTI: `CortexLeft` is `CIFTI_STRUCTURE_CORTEX_LEFT`.
fn structure_name(structure: &str) -> String {
    let mut name = String::from("CIFTI_STRUCTURE");
    let mut was_lower = false;
    for c in structure.chars() {
        if name == "CIFTI_STRUCTURE" || (c.is_uppercase() && was_lower) {
            name.push('_');
        }
        was_lower = c.is_lowercase();
        name.extend(c.to_uppercase());
    }
    name
}

/// Values of one surface of a CIFTI.
#[derive(Clone, Copy, Debug)]
pub struct CiftiPart<'a> {
    /// Structure of the surface, such as `CortexLeft`.
    pub structure: &'a str,
    /// Fields with a row per vertex, whose channels are the columns.
    pub fields: &'a [Field],
}

/// Writes values of a surface as a CIFTI-2 with the structure, such as `CortexLeft`: the columns are the channels of
/// all fields, each with a row per vertex. Vertices where all are NaN, such as the medial wall, are no part of the
/// file. Numbers are rounded to 32-bit floats. O(n × columns).
///
/// ```
/// use adwave_io::{CiftiColumns, Field, FieldValues, ReadLimits, read_surface_values, write_cifti_fields};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("map.dscalar.nii");
/// let field = Field::new("thickness", 1, FieldValues::F64(vec![2.5, f64::NAN, 3.0]));
/// write_cifti_fields(&path, &[field], "CortexLeft", CiftiColumns::Scalars)?;
/// let read = read_surface_values(&path, Some("CortexLeft"), 3, &ReadLimits::default()).unwrap();
/// assert_eq!((read[0].name.as_str(), read[0].get(2, 0)), ("thickness", 3.0));
/// assert!(read[0].get(1, 0).is_nan());
/// # Ok::<(), adwave_io::WriteError>(())
/// ```
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write), and [`WriteError::CannotHold`] for fields with different
/// numbers of rows, without values, or with finite numbers beyond the range of 32-bit floats.
pub fn write_cifti_fields(
    path: &Path,
    fields: &[Field],
    structure: &str,
    columns: CiftiColumns,
) -> Result<(), WriteError> {
    write_cifti_parts(path, &[CiftiPart { structure, fields }], columns)
}

/// Writes values of several surfaces, such as both hemispheres, as one CIFTI-2; see [`write_cifti_fields`]. The names
/// of the columns are those of the first part.
///
/// # Errors
/// The errors of [`write_cifti_fields`], and [`WriteError::CannotHold`] for parts with different numbers of columns.
pub fn write_cifti_parts(
    path: &Path,
    parts: &[CiftiPart<'_>],
    columns: CiftiColumns,
) -> Result<(), WriteError> {
    let bytes = encode(parts, columns)?;
    atomic_write_with(path, Progress::none(), |out| Ok(out.write_all(&bytes)?))
}

/// Vertices of a part that have a value in a column.
struct PartRows<'a> {
    part: CiftiPart<'a>,
    n_vertices: usize,
    vertices: Vec<usize>,
}

impl<'a> PartRows<'a> {
    fn new(part: CiftiPart<'a>) -> Result<Self, WriteError> {
        let n_vertices = part.fields.first().map_or(0, Field::len);
        if part.fields.iter().any(|field| field.len() != n_vertices) {
            return Err(cannot_hold("fields with different numbers of rows"));
        }
        for field in part.fields {
            let name = format!("values of `{}`", field.name);
            check_range(CIFTI.format, &name, field.values.len(), Progress::none(), |i| field.values.get(i))?;
        }
        let vertices: Vec<usize> =
            (0..n_vertices).filter(|&i| row(part.fields, i).any(|x| !x.is_nan())).collect();
        if vertices.is_empty() {
            return Err(cannot_hold("a field that is NaN everywhere"));
        }
        Ok(Self { part, n_vertices, vertices })
    }
}

fn cannot_hold(what: &str) -> WriteError {
    WriteError::CannotHold { format: CIFTI.format, what: what.into() }
}

/// Values of all channels at a vertex.
fn row(fields: &[Field], i: usize) -> impl Iterator<Item = f64> + '_ {
    fields.iter().flat_map(move |f| (0..f.n_channels).map(move |c| f.get(i, c)))
}

fn encode(parts: &[CiftiPart<'_>], columns: CiftiColumns) -> Result<Vec<u8>, WriteError> {
    let names = |part: &CiftiPart<'_>| -> Vec<String> {
        let of_field = |field: &Field| {
            if field.n_channels == 1 { vec![field.name.clone()] } else { column_names(field) }
        };
        part.fields.iter().flat_map(of_field).collect()
    };
    let own = parts.first().map(names).unwrap_or_default();
    if parts.iter().any(|part| names(part).len() != own.len()) {
        return Err(cannot_hold("parts with different numbers of columns"));
    }
    let rows = parts.iter().map(|part| PartRows::new(*part)).collect::<Result<Vec<_>, _>>()?;
    let tables = if columns == CiftiColumns::Labels { label_tables(&own, &rows)? } else { Vec::new() };
    let xml = matrix_xml(&own, columns, &rows, &tables);
    let n_rows = rows.iter().map(|part| part.vertices.len()).sum();
    let mut bytes = head(own.len(), n_rows, columns, xml.len());
    bytes.extend_from_slice(xml.as_bytes());
    bytes.resize(data_start(xml.len()), 0);
    for part in &rows {
        for &i in &part.vertices {
            let stored = |x: f64| match columns {
                CiftiColumns::Labels => label_key(x).map_or(x, f64::from),
                CiftiColumns::Scalars | CiftiColumns::Series => x,
            };
            bytes.extend(row(part.part.fields, i).flat_map(|x| (stored(x) as f32).to_le_bytes()));
        }
    }
    Ok(bytes)
}

/// Tables of the labels of each column in all parts.
fn label_tables(names: &[String], parts: &[PartRows<'_>]) -> Result<Vec<LabelTable>, WriteError> {
    let mut tables = Vec::with_capacity(names.len());
    for (column, name) in names.iter().enumerate() {
        let (mut own, mut values) = (Vec::new(), Vec::new());
        for PartRows { part, vertices, .. } in parts {
            let mut first = 0;
            for field in part.fields {
                if (first..first + field.n_channels).contains(&column) {
                    own.extend(field.labels.as_ref());
                    values.extend(vertices.iter().map(|&i| field.get(i, column - first)));
                }
                first += field.n_channels;
            }
        }
        if own.len() < parts.len() {
            let what = format!("`{name}` as labels, because it has no table of their names and colors");
            return Err(cannot_hold(&what));
        }
        let table = LabelTable::join(own.into_iter()).and_then(|table| table.with_labels(values.into_iter()));
        let table = table.map_err(|what| cannot_hold(&what))?;
        // The file has 32-bit floats.
        if let Some(entry) = table.entries().iter().find(|entry| entry.key.unsigned_abs() > 1 << 24) {
            return Err(cannot_hold(&format!("label {}, which is beyond 2^24", entry.key)));
        }
        tables.push(table);
    }
    Ok(tables)
}

fn matrix_xml(
    names: &[String],
    columns: CiftiColumns,
    parts: &[PartRows<'_>],
    tables: &[LabelTable],
) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CIFTI Version=\"2\">\n<Matrix>\n\
         <MatrixIndicesMap AppliesToMatrixDimension=\"0\" IndicesMapToDataType=\"CIFTI_INDEX_TYPE_",
    );
    match columns {
        CiftiColumns::Scalars => {
            xml += "SCALARS\">\n";
            for name in names {
                let _ = writeln!(xml, "<NamedMap>\n<MapName>{}</MapName>\n</NamedMap>", escape_xml(name));
            }
            xml += "</MatrixIndicesMap>\n";
        }
        CiftiColumns::Labels => {
            xml += "LABELS\">\n";
            for (name, table) in names.iter().zip(tables) {
                let (name, table) = (escape_xml(name), table.to_xml());
                let _ = writeln!(xml, "<NamedMap>\n<MapName>{name}</MapName>\n{table}</NamedMap>");
            }
            xml += "</MatrixIndicesMap>\n";
        }
        CiftiColumns::Series => {
            let stated = parts.first().and_then(|rows| rows.part.fields.first()?.frame_step);
            let step = stated.unwrap_or(1.0);
            let _ = writeln!(
                xml,
                "SERIES\" NumberOfSeriesPoints=\"{}\" SeriesExponent=\"0\" SeriesStart=\"0\" SeriesStep=\"{step}\" \
                 SeriesUnit=\"SECOND\"/>",
                names.len()
            );
        }
    }
    xml += "<MatrixIndicesMap AppliesToMatrixDimension=\"1\" IndicesMapToDataType=\"CIFTI_INDEX_TYPE_BRAIN_MODELS\">\n";
    let mut first = 0;
    for PartRows { part, n_vertices, vertices } in parts {
        let _ = write!(
            xml,
            "<BrainModel IndexOffset=\"{first}\" IndexCount=\"{}\" ModelType=\"CIFTI_MODEL_TYPE_SURFACE\" \
             BrainStructure=\"{}\" SurfaceNumberOfVertices=\"{n_vertices}\">\n<VertexIndices>",
            vertices.len(),
            escape_xml(&structure_name(part.structure))
        );
        for (k, vertex) in vertices.iter().enumerate() {
            if k > 0 {
                xml.push(' ');
            }
            let _ = write!(xml, "{vertex}");
        }
        xml += "</VertexIndices>\n</BrainModel>\n";
        first += vertices.len();
    }
    xml + "</MatrixIndicesMap>\n</Matrix>\n</CIFTI>\n"
}

/// First byte of the numbers after an XML of this length.
fn data_start(xml_length: usize) -> usize {
    HEADER + 4 + (8 + xml_length).next_multiple_of(16)
}

/// NIfTI-2 header in little-endian order, with the beginning of the extension.
fn head(n_columns: usize, n_rows: usize, columns: CiftiColumns, xml_length: usize) -> Vec<u8> {
    let mut bytes = vec![0_u8; HEADER];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, &(HEADER as i32).to_le_bytes());
    put(4, b"n+2\0\r\n\x1a\n");
    // 32-bit floats.
    put(12, &16_i16.to_le_bytes());
    put(14, &32_i16.to_le_bytes());
    let sizes = [6, 1, 1, 1, 1, n_columns as i64, n_rows as i64, 1];
    for (k, size) in sizes.into_iter().enumerate() {
        put(16 + 8 * k, &size.to_le_bytes());
        put(104 + 8 * k, &1_f64.to_le_bytes());
    }
    put(168, &(data_start(xml_length) as i64).to_le_bytes());
    put(176, &1_f64.to_le_bytes());
    let (code, name) = columns.intent();
    if columns == CiftiColumns::Series {
        // Seconds.
        put(500, &8_i32.to_le_bytes());
    }
    put(504, &code.to_le_bytes());
    put(508, name.as_bytes());
    bytes.extend([1, 0, 0, 0]);
    let size = data_start(xml_length) - HEADER - 4;
    bytes.extend((size as i32).to_le_bytes());
    bytes.extend(32_i32.to_le_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structures_have_the_names_of_the_standard() {
        assert_eq!(structure_name("CortexLeft"), "CIFTI_STRUCTURE_CORTEX_LEFT");
        assert_eq!(structure_name("Cerebellum"), "CIFTI_STRUCTURE_CEREBELLUM");
        assert_eq!(structure_name("CORTEX_RIGHT"), "CIFTI_STRUCTURE_CORTEX_RIGHT");
    }
}
