//! VTK XML PolyData for ParaView: points, faces as polygons, edges as lines, and all fields.

use std::io::Write;

use adwave::Progress;

use crate::field::ByteOrder;
use crate::progress::{at_row, collect};
use crate::text::escape_xml;
use crate::{Field, FieldValues, Precision, ShapeFile, WriteError, WriteReport};

/// Uncompressed bytes of one block.
const BLOCK: usize = 1 << 20;

/// The arrays, compressed, in the order in which the XML names them.
struct Appended<'a> {
    bytes: Vec<u8>,
    progress: Progress<'a>,
}

impl Appended<'_> {
    /// Compresses an array and gives where it begins. Its head is the number of blocks, the size of a block, the
    /// size of the last if it is smaller, and the compressed size of each.
    fn add(&mut self, plain: &[u8]) -> Result<usize, WriteError> {
        let at = self.bytes.len();
        let mut sizes = Vec::new();
        let mut blocks = Vec::new();
        for block in plain.chunks(BLOCK) {
            self.progress.check()?;
            let start = blocks.len();
            let mut zlib = flate2::write::ZlibEncoder::new(&mut blocks, flate2::Compression::fast());
            zlib.write_all(block)?;
            zlib.finish()?;
            sizes.push((blocks.len() - start) as u64);
        }
        let last = plain.len() % BLOCK;
        for number in [sizes.len() as u64, BLOCK as u64, last as u64].into_iter().chain(sizes) {
            self.bytes.extend_from_slice(&number.to_le_bytes());
        }
        self.bytes.append(&mut blocks);
        Ok(at)
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
            at_row(self.progress, i as u64, values.len() as u64)?;
            values.write_bytes(i, ByteOrder::Little, &mut plain);
        }
        let offset = self.add(&plain)?;
        let kind = match values {
            FieldValues::U8(_) => "UInt8",
            FieldValues::I8(_) => "Int8",
            FieldValues::U16(_) => "UInt16",
            FieldValues::I16(_) => "Int16",
            FieldValues::U32(_) => "UInt32",
            FieldValues::I32(_) => "Int32",
            FieldValues::U64(_) => "UInt64",
            FieldValues::I64(_) => "Int64",
            FieldValues::F32(_) => "Float32",
            FieldValues::F64(_) => "Float64",
        };
        let name = escape_xml(name);
        *xml += &format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{n_channels}\" \
             format=\"appended\" offset=\"{offset}\"/>\n"
        );
        Ok(())
    }

    fn add_fields(&mut self, xml: &mut String, element: &str, fields: &[Field]) -> Result<(), WriteError> {
        *xml += &format!("<{element}>\n");
        for field in fields {
            self.add_numbers(xml, &field.name, field.n_channels, &field.values)?;
        }
        *xml += &format!("</{element}>\n");
        Ok(())
    }

    /// A list of cells: their corners, and where each ends.
    fn add_cells(
        &mut self,
        xml: &mut String,
        element: &str,
        corners: Vec<i64>,
        ends: Vec<i64>,
    ) -> Result<(), WriteError> {
        *xml += &format!("<{element}>\n");
        self.add_numbers(xml, "connectivity", 1, &FieldValues::I64(corners))?;
        self.add_numbers(xml, "offsets", 1, &FieldValues::I64(ends))?;
        *xml += &format!("</{element}>\n");
        Ok(())
    }
}

/// Writes a VTP. The cells are points (of a cloud), lines, then polygons, so face fields need a value for each.
pub(crate) fn write_vtp(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let mut appended = Appended { bytes: Vec::new(), progress };
    let n = shape.points.len();
    let is_cloud = shape.faces.is_empty() && shape.edges.pairs.is_empty();
    let mut body = String::new();
    appended.add_fields(&mut body, "PointData", &shape.vertex_fields)?;
    // Lines come before polygons among the cells and have none of the faces' values.
    let has_lines = !shape.edges.pairs.is_empty();
    if has_lines {
        report.leave_face_fields(shape, &[]);
    }
    appended.add_fields(&mut body, "CellData", if has_lines { &[] } else { &shape.face_fields })?;
    body += "<Points>\n";
    let flat = shape.points.as_flattened();
    let points = match shape.precision {
        Precision::F32 => FieldValues::F32(collect(flat.len(), progress, |i| flat[i] as f32)?),
        Precision::F64 => FieldValues::F64(collect(flat.len(), progress, |i| flat[i])?),
    };
    appended.add_numbers(&mut body, "Points", 3, &points)?;
    body += "</Points>\n";
    let n_verts = if is_cloud { n } else { 0 };
    let verts = collect(n_verts, progress, |i| i as i64)?;
    let vert_ends = collect(n_verts, progress, |i| i as i64 + 1)?;
    appended.add_cells(&mut body, "Verts", verts, vert_ends)?;
    let lines = shape.edges.pairs.as_flattened().iter().map(|&v| v.into()).collect();
    let line_ends = (1..=shape.edges.pairs.len() as i64).map(|e| 2 * e).collect();
    appended.add_cells(&mut body, "Lines", lines, line_ends)?;
    let corners = shape.faces.corners();
    let corners = collect(corners.len(), progress, |k| corners[k].into())?;
    let ends = collect(shape.faces.len(), progress, |f| shape.faces.end(f) as i64)?;
    appended.add_cells(&mut body, "Polys", corners, ends)?;
    if !shape.edges.weights.is_empty() {
        report.leave_out("weights of edges");
    }
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"{n}\" NumberOfVerts=\"{n_verts}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" \
         NumberOfPolys=\"{}\">\n{body}</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_",
        shape.edges.pairs.len(),
        shape.faces.len(),
    )?;
    out.write_all(&appended.bytes)?;
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")?;
    Ok(())
}
