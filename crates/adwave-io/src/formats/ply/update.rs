//! Update of a PLY: header, elements and properties stay unchanged, coordinates are replaced, and added or replaced
//! vertex fields become the last properties of the vertices.

use std::io::Write;
use std::sync::Arc;

use adwave::Progress;

use crate::formats::ply::body::PlyBody;
use crate::formats::ply::header::{Element, Encoding, PlyHeader, PlySource, PropertyKind};
use crate::formats::ply::read::{corner_list, texcoord_list};
use crate::formats::ply::turn::turned_bytes;
use crate::formats::ply::write::{ValueStyle, note_rounding, property_lines, push_fields};
use crate::model::context::WriteContext;
use crate::model::source_document::{SourceDocument, Update};
use crate::progress::report_row;
use crate::text::{is_space, parse_f32, parse_f64};
use crate::{Field, FieldValues, ReadError, ShapeFile, ValueType, WriteError};

impl SourceDocument for PlySource {
    /// Writes the original with new coordinates and fields.
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let is_edited = |f: &&Field| shape.edited.contains(&f.name);
        let fields: Vec<&Field> = shape.vertex_fields.iter().filter(is_edited).collect();
        note_rounding(&fields, &mut context.report);
        let element = &self.header.elements[self.vertex];
        let replaced = |p: usize| {
            let mut members = self.field_properties.iter();
            members.any(|(name, members)| members.contains(&p) && shape.edited.contains(name))
        };
        let dropped: Vec<bool> = (0..element.properties.len()).map(replaced).collect();
        let out = &mut *context.out;
        write_header(&self.bytes, &self.header, self.vertex, &dropped, &fields, out)?;
        out.write_all(&self.bytes[self.header.body..self.rows.0])?;
        write_rows(shape, self, &dropped, &fields, out, context.progress)?;
        out.write_all(&self.bytes[self.rows.1..])?;
        Ok(Update::Written)
    }

    fn with_turned_faces(&self, is_turned: &[bool]) -> Option<Arc<dyn SourceDocument>> {
        let bytes = turned_bytes(self, is_turned)?;
        Some(Arc::new(Self { bytes, ..self.without_bytes() }))
    }

    fn corner_texcoords(&self, shape: &ShapeFile) -> Option<Vec<f64>> {
        self.read_texcoords().ok().flatten().filter(|values| values.len() == 2 * shape.faces.corners().len())
    }
}

impl PlySource {
    /// Copy of all but the bytes.
    fn without_bytes(&self) -> Self {
        Self {
            bytes: Vec::new(),
            header: self.header.clone(),
            vertex: self.vertex,
            rows: self.rows,
            field_properties: self.field_properties.clone(),
        }
    }

    /// Texture coordinates of the corners of all faces, NaN at faces without; `None` if there is no list of them.
    fn read_texcoords(&self) -> Result<Option<Vec<f64>>, ReadError> {
        let (encoding, progress) = (self.header.encoding, Progress::none());
        let mut body = PlyBody { bytes: &self.bytes, position: self.header.body, encoding, progress };
        let mut texcoords = None;
        let (mut face, mut values) = (Vec::new(), Vec::new());
        for element in &self.header.elements {
            let lists = corner_list(element).zip(texcoord_list(element));
            let Some((corners, list)) = lists else {
                (0..element.n_rows).try_for_each(|row| body.skip_row(element, row))?;
                continue;
            };
            let all = texcoords.get_or_insert_with(Vec::new);
            for row in 0..element.n_rows {
                for (p, property) in element.properties.iter().enumerate() {
                    if p == corners {
                        body.read_list(property.kind, element, row, &mut face)?;
                    } else if p == list {
                        body.read_floats(property.kind, element, row, &mut values)?;
                    } else {
                        body.skip(property.kind, element, row)?;
                    }
                }
                if values.len() != 2 * face.len() {
                    values = vec![f64::NAN; 2 * face.len()];
                }
                all.extend_from_slice(&values);
            }
        }
        Ok(texcoords)
    }
}

/// Writes the header with the properties of new fields; `bytes` are those it was parsed from.
pub(crate) fn write_header(
    bytes: &[u8],
    header: &PlyHeader,
    vertex: usize,
    dropped: &[bool],
    fields: &[&Field],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let element = &header.elements[vertex];
    let last = element.properties.last().map_or(element.line, |p| p.line);
    let has_return = |&(start, end): &(usize, usize)| bytes[start..end].ends_with(b"\r\n");
    // Readers take the end of one line for that of all.
    let is_mixed = header.lines.iter().any(has_return) && !header.lines.iter().all(has_return);
    for (number, &(start, end)) in header.lines.iter().enumerate() {
        let line = &bytes[start..end];
        let is_dropped =
            element.properties.iter().zip(dropped).any(|(p, &dropped)| dropped && p.line == number);
        if !is_dropped && is_mixed {
            out.write_all(line.trim_ascii_end())?;
            out.write_all(b"\n")?;
        } else if !is_dropped {
            out.write_all(line)?;
        }
        if number == last {
            let line_end = if line.ends_with(b"\r\n") && !is_mixed { "\r\n" } else { "\n" };
            out.write_all(property_lines(fields, line_end).as_bytes())?;
        }
    }
    Ok(())
}

/// Writer of vertex rows.
pub(crate) struct RowWriter<'a> {
    element: &'a Element,
    /// Coordinate that each property stores.
    axes: Vec<Option<usize>>,
    /// True for each property that is dropped.
    dropped: &'a [bool],
    style: ValueStyle,
}

impl<'a> RowWriter<'a> {
    pub(crate) fn new(element: &'a Element, encoding: Encoding, dropped: &'a [bool]) -> Self {
        let axes = element.properties.iter().enumerate().map(|(p, property)| {
            let axis = ["x", "y", "z"].iter().position(|axis| *axis == property.name)?;
            // Of two properties with the same name the first one counts.
            (element.property(&property.name) == Some(p)).then_some(axis)
        });
        let style = match encoding {
            Encoding::Ascii => ValueStyle::Text,
            Encoding::Binary(order) => ValueStyle::Bytes(order),
        };
        Self { element, axes: axes.collect(), dropped, style }
    }

    /// Appends the row at the body's position, its number being `at`, with the coordinates that are not `None`.
    pub(crate) fn push(
        &self,
        body: &mut PlyBody<'_>,
        at: u64,
        point: [Option<f64>; 3],
        row: &mut Vec<u8>,
    ) -> Result<(), ReadError> {
        for (p, property) in self.element.properties.iter().enumerate() {
            let start = body.position;
            body.skip(property.kind, self.element, at)?;
            let old = &body.bytes[start..body.position];
            match (self.axes[p].and_then(|axis| point[axis]), property.kind) {
                (Some(x), PropertyKind::Scalar(t)) => push_coordinate(old, t, x, self.style, row),
                _ if self.dropped[p] => {}
                _ => row.extend_from_slice(old),
            }
        }
        Ok(())
    }

    /// Appends row `i` of the fields.
    pub(crate) fn push_fields(&self, fields: &[&Field], i: usize, row: &mut Vec<u8>) {
        push_fields(fields, i, self.style, row);
    }
}

fn write_rows(
    shape: &ShapeFile,
    ply: &PlySource,
    dropped: &[bool],
    fields: &[&Field],
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let element = &ply.header.elements[ply.vertex];
    let writer = RowWriter::new(element, ply.header.encoding, dropped);
    let mut body =
        PlyBody { bytes: &ply.bytes, position: ply.rows.0, encoding: ply.header.encoding, progress };
    let mut row = Vec::new();
    for i in 0..shape.n_vertices {
        report_row(progress, i as u64, element.n_rows)?;
        row.clear();
        // The same bytes were read before, so this cannot fail; otherwise the error is reported.
        let point = shape.points[i].map(Some);
        writer.push(&mut body, i as u64, point, &mut row).map_err(std::io::Error::other)?;
        writer.push_fields(fields, i, &mut row);
        out.write_all(&row)?;
    }
    Ok(())
}

/// Writes a coordinate in the file's type; bytes of equal value stay unchanged.
fn push_coordinate(old: &[u8], t: ValueType, x: f64, style: ValueStyle, row: &mut Vec<u8>) {
    let mut value = t.empty();
    // Coordinates of an integer type are rounded.
    if !value.push_f64(x) {
        value.push_f64(x.round().clamp(-9e15, 9e15));
    }
    if value.is_empty() {
        row.extend_from_slice(old);
        return;
    }
    let ValueStyle::Bytes(order) = style else {
        let blanks = old.iter().take_while(|&&b| is_space(b)).count();
        let word = &old[blanks..];
        let before = if t == ValueType::F32 { parse_f32(word).map(f64::from) } else { parse_f64(word) };
        let same =
            before.is_some_and(|b| b.to_bits() == value.get(0).to_bits() || (b.is_nan() && x.is_nan()));
        if same {
            row.extend_from_slice(old);
        } else {
            row.extend_from_slice(&old[..blanks]);
            value.write_text(0, row);
        }
        return;
    };
    let mut before = t.empty();
    before.push_bytes(old, order);
    if is_nan(&before) && x.is_nan() {
        row.extend_from_slice(old);
    } else {
        value.write_bytes(0, order, row);
    }
}

fn is_nan(values: &FieldValues) -> bool {
    values.get(0).is_nan()
}
