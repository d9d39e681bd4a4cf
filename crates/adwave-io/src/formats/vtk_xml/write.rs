//! VTK XML writer for ParaView: points, faces as polygons, edges as lines, and all fields, as PolyData or as an
//! unstructured grid; images and volumes as ImageData.

use std::io::Write;

use adwave::Progress;

use super::document::{ArrayEncoding, Compressor};
use super::update::ImageDocument;
use crate::model::cells::frame_of;
use crate::model::context::WriteContext;
use crate::model::field::ByteOrder;
use crate::model::grid_values::{GridNumbers, grid_field};
use crate::model::numbers::cell_fields;
use crate::progress::{collect, report_row};
use crate::provenance::NAME;
use crate::text::{escape_xml, push_f64};
use crate::{CoordinatePrecision, Field, FieldValues, ShapeFile, ValueType, WriteError, WriteReport};

/// Name of a type of numbers.
pub(super) fn type_name(kind: ValueType) -> &'static str {
    match kind {
        ValueType::U8 => "UInt8",
        ValueType::I8 => "Int8",
        ValueType::U16 => "UInt16",
        ValueType::I16 => "Int16",
        ValueType::U32 => "UInt32",
        ValueType::I32 => "Int32",
        ValueType::U64 => "UInt64",
        ValueType::I64 => "Int64",
        ValueType::F32 => "Float32",
        ValueType::F64 => "Float64",
    }
}

/// Encoding of new files.
const ENCODING: ArrayEncoding =
    ArrayEncoding { order: ByteOrder::Little, header_bytes: 8, compressor: Compressor::Zlib };

/// Compressed arrays, in the order of the XML.
struct AppendedWriter<'a> {
    bytes: Vec<u8>,
    progress: Progress<'a>,
}

impl AppendedWriter<'_> {
    /// Adds an array of little-endian numbers.
    fn add(
        &mut self,
        xml: &mut String,
        name: &str,
        n_channels: usize,
        kind: ValueType,
        plain: Vec<u8>,
    ) -> Result<(), WriteError> {
        let offset = self.bytes.len();
        let encoded = ENCODING.encode(plain, self.progress)?.unwrap_or_default();
        for part in encoded {
            self.bytes.extend_from_slice(&part);
        }
        let (kind, name) = (type_name(kind), escape_xml(name));
        *xml += &format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{n_channels}\" \
             format=\"appended\" offset=\"{offset}\"/>\n"
        );
        Ok(())
    }

    fn add_numbers(
        &mut self,
        xml: &mut String,
        name: &str,
        n_channels: usize,
        values: &FieldValues,
    ) -> Result<(), WriteError> {
        let mut plain = Vec::with_capacity(values.len() * values.value_type().n_bytes());
        for i in 0..values.len() {
            report_row(self.progress, i as u64, values.len() as u64)?;
            values.write_bytes(i, ByteOrder::Little, &mut plain);
        }
        self.add(xml, name, n_channels, values.value_type(), plain)
    }

    /// Adds fields; the first normals and texture coordinates are marked for drawing.
    fn add_fields(&mut self, xml: &mut String, element: &str, fields: &[Field]) -> Result<(), WriteError> {
        let has =
            |name: &str, n: &[usize]| fields.iter().any(|f| f.name == name && n.contains(&f.n_channels));
        *xml += &format!("<{element}");
        if has("normal", &[3]) {
            *xml += " Normals=\"normal\"";
        }
        if has("texcoord", &[2]) {
            *xml += " TCoords=\"texcoord\"";
        }
        *xml += ">\n";
        for field in fields {
            self.add_numbers(xml, &field.name, field.n_channels, &field.values)?;
        }
        *xml += &format!("</{element}>\n");
        Ok(())
    }

    /// Adds a list of cells: their corners, and the end of each.
    fn add_cells(
        &mut self,
        xml: &mut String,
        element: &str,
        corners: Vec<i64>,
        ends: Vec<i64>,
        types: Option<Vec<u8>>,
    ) -> Result<(), WriteError> {
        *xml += &format!("<{element}>\n");
        self.add_numbers(xml, "connectivity", 1, &FieldValues::I64(corners))?;
        self.add_numbers(xml, "offsets", 1, &FieldValues::I64(ends))?;
        if let Some(types) = types {
            self.add_numbers(xml, "types", 1, &FieldValues::U8(types))?;
        }
        *xml += &format!("</{element}>\n");
        Ok(())
    }
}

/// Cells of a shape in the order of VTK: the points of a cloud, the edges, the faces.
struct WrittenCells {
    n_vertices: usize,
    /// Two corners per line.
    lines: Vec<i64>,
    corners: Vec<i64>,
    /// End of each face.
    ends: Vec<i64>,
}

impl WrittenCells {
    fn new(shape: &ShapeFile, progress: Progress<'_>) -> Result<Self, WriteError> {
        let is_cloud = shape.faces.is_empty() && shape.edges.pairs.is_empty();
        let corners = shape.faces.corners();
        Ok(Self {
            n_vertices: if is_cloud { shape.points.len() } else { 0 },
            lines: shape.edges.pairs.as_flattened().iter().map(|&v| v.into()).collect(),
            corners: collect(corners.len(), progress, |k| corners[k].into())?,
            ends: collect(shape.faces.len(), progress, |f| shape.faces.end(f) as i64)?,
        })
    }

    fn n_lines(&self) -> usize {
        self.lines.len() / 2
    }
}

/// Writes a VTP.
pub(crate) fn write_vtp(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let mut appended = AppendedWriter { bytes: Vec::new(), progress };
    let cells = WrittenCells::new(shape, progress)?;
    let mut body = values_and_points(shape, &mut appended, report, progress)?;
    let (n_vertices, n_lines, n_faces) = (cells.n_vertices, cells.n_lines(), cells.ends.len());
    let verts = collect(n_vertices, progress, |i| i as i64)?;
    let vert_ends = collect(n_vertices, progress, |i| i as i64 + 1)?;
    appended.add_cells(&mut body, "Verts", verts, vert_ends, None)?;
    let line_ends = (1..=n_lines as i64).map(|e| 2 * e).collect();
    appended.add_cells(&mut body, "Lines", cells.lines, line_ends, None)?;
    appended.add_cells(&mut body, "Polys", cells.corners, cells.ends, None)?;
    let n = shape.points.len();
    let piece = format!(
        "NumberOfPoints=\"{n}\" NumberOfVerts=\"{n_vertices}\" NumberOfLines=\"{n_lines}\" NumberOfStrips=\"0\" \
         NumberOfPolys=\"{n_faces}\""
    );
    let dataset = Dataset { element: "PolyData", attributes: "", piece: &piece, body: &body };
    dataset.write(shape, &appended.bytes, out)
}

/// Writes a VTU.
pub(crate) fn write_vtu(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let mut appended = AppendedWriter { bytes: Vec::new(), progress };
    let cells = WrittenCells::new(shape, progress)?;
    let mut body = values_and_points(shape, &mut appended, report, progress)?;
    let (n_vertices, n_lines, n_faces) = (cells.n_vertices, cells.n_lines(), cells.ends.len());
    let mut types = vec![1; n_vertices];
    types.resize(n_vertices + n_lines, 3);
    for (f, face) in shape.faces.iter().enumerate() {
        report_row(progress, f as u64, n_faces as u64)?;
        types.push(match face.len() {
            3 => 5,
            4 => 9,
            _ => 7,
        });
    }
    let mut corners: Vec<i64> = (0..n_vertices as i64).collect();
    corners.extend(cells.lines);
    let first = corners.len() as i64;
    let mut ends: Vec<i64> = (1..=n_vertices as i64).collect();
    ends.extend((1..=n_lines as i64).map(|e| n_vertices as i64 + 2 * e));
    corners.extend(cells.corners);
    ends.extend(cells.ends.iter().map(|end| first + end));
    let n_cells = ends.len();
    appended.add_cells(&mut body, "Cells", corners, ends, Some(types))?;
    let n = shape.points.len();
    let piece = format!("NumberOfPoints=\"{n}\" NumberOfCells=\"{n_cells}\"");
    let dataset = Dataset { element: "UnstructuredGrid", attributes: "", piece: &piece, body: &body };
    dataset.write(shape, &appended.bytes, out)
}

/// Writes a VTI with the values and further fields of an image or a volume at its points.
pub(crate) fn write_vti(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let Some(layout) = shape.grid() else {
        return Err(WriteError::CannotHold { format: c.format, what: "a shape".into() });
    };
    let (image, dims) = frame_of(layout);
    if let Some(unit) = &layout.unit {
        c.report.report_dropped(format!("the unit of length, {}", unit.plural()));
    }
    let field = grid_field(shape, c.format)?;
    let arrays = shape.source::<ImageDocument>().map(|document| &document.arrays);
    if arrays.is_some() {
        // The original, which has them, cannot hold the changes.
        shape.extras.iter().for_each(|extra| c.report.report_dropped(extra.clone()));
    }
    let array_name = |field: &Field| arrays.map_or(field.name.clone(), |a| a.name_of(&field.name).to_owned());
    let name = array_name(field);
    let mut body = format!("<PointData Scalars=\"{}\">\n", escape_xml(&name));
    let mut appended = AppendedWriter { bytes: Vec::new(), progress: c.progress };
    let kind = shape.value_type.unwrap_or(field.values.value_type());
    let numbers = GridNumbers::new(kind, ByteOrder::Little, shape.n_vertices, field.n_channels);
    let mut plain = Vec::new();
    numbers.write(None, field, c.format, &mut plain, c.progress)?;
    appended.add(&mut body, &name, field.n_channels, kind, plain)?;
    for other in shape.vertex_fields.iter().filter(|other| other.name != field.name) {
        appended.add_numbers(&mut body, &array_name(other), other.n_channels, &other.values)?;
    }
    body += "</PointData>\n";
    let words = |numbers: &mut dyn Iterator<Item = f64>| {
        let mut text = Vec::new();
        for x in numbers {
            push_f64(&mut text, x);
            text.push(b' ');
        }
        String::from_utf8_lossy(text.trim_ascii_end()).into_owned()
    };
    let extent = dims.map(|n| format!("0 {}", n - 1)).join(" ");
    let directions = image.directions;
    let attributes = format!(
        " WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\" Direction=\"{}\"",
        words(&mut image.origin.into_iter()),
        words(&mut image.spacings.into_iter()),
        words(&mut (0..9).map(|k| directions[k % 3][k / 3]))
    );
    let piece = format!("Extent=\"{extent}\"");
    let dataset = Dataset { element: "ImageData", attributes: &attributes, piece: &piece, body: &body };
    dataset.write(shape, &appended.bytes, c.out)
}

/// Content before the cells in both formats.
fn values_and_points(
    shape: &ShapeFile,
    appended: &mut AppendedWriter<'_>,
    report: &mut WriteReport,
    progress: Progress<'_>,
) -> Result<String, WriteError> {
    let mut body = String::new();
    appended.add_fields(&mut body, "PointData", &shape.vertex_fields)?;
    appended.add_fields(&mut body, "CellData", &cell_fields(shape))?;
    body += "<Points>\n";
    let flat = shape.points.as_flattened();
    let points = match shape.precision {
        CoordinatePrecision::F32 => FieldValues::F32(collect(flat.len(), progress, |i| flat[i] as f32)?),
        CoordinatePrecision::F64 => FieldValues::F64(collect(flat.len(), progress, |i| flat[i])?),
    };
    appended.add_numbers(&mut body, "Points", 3, &points)?;
    body += "</Points>\n";
    if !shape.edges.weights.is_empty() {
        report.report_dropped("weights of edges");
    }
    Ok(body)
}

/// Element of an array of field data, in text.
fn field_data(field: &Field) -> String {
    let mut numbers = Vec::new();
    for k in 0..field.values.len() {
        field.values.write_text(k, &mut numbers);
        numbers.push(b' ');
    }
    format!(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfTuples=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n{}\n\
         </DataArray>\n",
        type_name(field.values.value_type()),
        escape_xml(&field.name),
        field.len(),
        field.n_channels,
        String::from_utf8_lossy(numbers.trim_ascii_end())
    )
}

/// Elements of a file with one piece.
struct Dataset<'a> {
    element: &'a str,
    attributes: &'a str,
    /// Attributes of the piece.
    piece: &'a str,
    /// Elements of the piece.
    body: &'a str,
}

impl Dataset<'_> {
    fn write(&self, shape: &ShapeFile, appended: &[u8], out: &mut dyn Write) -> Result<(), WriteError> {
        let Self { element, attributes, piece, body } = *self;
        let made = shape.valid_provenance().map_or(String::new(), |made| {
            let mut letters = made.to_json().into_bytes();
            // ParaView shows texts, which end with a zero; other readers of unstructured grids accept only numbers.
            let head = if element == "UnstructuredGrid" {
                format!("DataArray type=\"UInt8\" Name=\"{NAME}\" NumberOfTuples=\"{}\"", letters.len())
            } else {
                letters.push(0);
                format!("Array type=\"String\" Name=\"{NAME}\" NumberOfTuples=\"1\"")
            };
            let numbers = letters.iter().map(u8::to_string).collect::<Vec<_>>().join(" ");
            let element = head.split(' ').next().unwrap_or_default();
            format!("<{head} format=\"ascii\">\n{numbers}\n</{element}>\n")
        });
        let own = shape.field_data.iter().map(field_data).collect::<String>();
        let field_data = made + &own;
        let field_data = if field_data.is_empty() {
            field_data
        } else {
            format!("<FieldData>\n{field_data}</FieldData>\n")
        };
        write!(
            out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{element}\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<{element}{attributes}>\n\
         {field_data}<Piece {piece}>\n{body}</Piece>\n</{element}>\n<AppendedData encoding=\"raw\">\n_",
        )?;
        out.write_all(appended)?;
        Ok(out.write_all(b"\n</AppendedData>\n</VTKFile>\n")?)
    }
}
