//! Rows of a PLY in blocks.

use adwave::Progress;
use adwave::shape::Polygons;

use super::VertexColumn;
use super::window::FileWindow;
use crate::formats::ply::body::PlyBody;
use crate::formats::ply::fixed::{FaceLayout, decode_count};
use crate::formats::ply::header::{Element, Encoding, PlyHeader, Property, PropertyKind, parse_header};
use crate::formats::ply::read::{check_axes, corner_list, strip_triangles};
use crate::model::field::{ByteOrder, Number};
use crate::model::grouping::single_columns;
use crate::{ReadError, ValueType};

/// Largest number of rows read at a time.
const MOST_ROWS: u64 = 1 << 16;

/// Whole rows at the beginning of the window.
#[derive(Clone, Copy)]
pub(super) struct RowSpan {
    pub(super) n: u64,
    pub(super) n_bytes: usize,
}

pub(in crate::mesh_stream) struct PlyStream {
    pub(super) window: FileWindow,
    pub(super) header: PlyHeader,
    /// Bytes of the header.
    pub(super) head: Vec<u8>,
    /// Index of the vertex element.
    pub(super) vertex: Option<usize>,
    /// Index of the current element, and its next row.
    element: usize,
    row: u64,
}

impl PlyStream {
    pub(super) fn new(mut window: FileWindow) -> Result<Self, ReadError> {
        let header = loop {
            match parse_header(window.rest()) {
                Ok(header) => break header,
                Err(error) if window.is_end() => return Err(error),
                // The last line may be truncated.
                Err(_) => window.more()?,
            }
        };
        let head = window.to_vec(header.body);
        window.consume(header.body);
        if header.encoding != Encoding::Ascii {
            window.without_lines();
        }
        let vertex = header.elements.iter().position(|e| e.name == "vertex");
        Ok(Self { window, header, head, vertex, element: 0, row: 0 })
    }

    pub(super) fn n_faces(&self) -> u64 {
        let are_faces = |e: &&Element| matches!(e.name.as_str(), "face" | "tristrips");
        self.header.elements.iter().filter(are_faces).map(|e| e.n_rows).sum()
    }

    /// The next rows, whole and in the window; none at the end of the element.
    pub(super) fn rows(&mut self) -> Result<RowSpan, ReadError> {
        let element = &self.header.elements[self.element];
        let most = (element.n_rows - self.row).min(MOST_ROWS);
        if most == 0 || element.properties.is_empty() {
            return Ok(RowSpan { n: most, n_bytes: 0 });
        }
        loop {
            let bytes = match self.header.encoding {
                Encoding::Ascii => self.window.words(),
                Encoding::Binary(_) => self.window.rest(),
            };
            let mut body =
                PlyBody { bytes, position: 0, encoding: self.header.encoding, progress: Progress::none() };
            let (mut n, mut end) = (0, 0);
            let failed = loop {
                if n == most {
                    break None;
                }
                match skip_row(&mut body, element, self.row + n) {
                    Ok(()) => (n, end) = (n + 1, body.position),
                    Err(error) => break Some(error),
                }
            };
            match failed {
                _ if n > 0 => return Ok(RowSpan { n, n_bytes: end }),
                None => return Ok(RowSpan { n: 0, n_bytes: 0 }),
                Some(error) => {
                    // A list may state more items than the file has.
                    let is_cut = |needed: u64| {
                        self.window.position().saturating_add(needed) > self.window.n_bytes() + 1
                    };
                    match error {
                        ReadError::Truncated { needed, .. } if !self.window.is_end() && !is_cut(needed) => {
                            self.window.more()?;
                        }
                        error => return Err(self.window.relocate_error(error)),
                    }
                }
            }
        }
    }

    /// Releases rows that were processed.
    pub(super) fn consume(&mut self, rows: RowSpan) {
        self.row += rows.n;
        self.window.consume(rows.n_bytes);
    }

    /// Moves to the first row of the next element for which `is_wanted`; `false` if there is none.
    pub(super) fn seek(&mut self, is_wanted: impl Fn(usize, &Element) -> bool) -> Result<bool, ReadError> {
        while let Some(element) = self.header.elements.get(self.element) {
            if self.row < element.n_rows && is_wanted(self.element, element) {
                return Ok(true);
            }
            match fixed_bytes(element, self.header.encoding) {
                Some(row_bytes) => {
                    let n = (element.n_rows - self.row).saturating_mul(row_bytes);
                    if !self.window.skip(n)? {
                        let left = self.window.n_bytes() - self.window.position();
                        let (element, row) = (element.name.clone(), self.row + left / row_bytes);
                        let error = ReadError::Truncated { end: 0, needed: n, element, row };
                        return Err(self.window.relocate_error(error));
                    }
                }
                None => {
                    while self.row < self.header.elements[self.element].n_rows {
                        let rows = self.rows()?;
                        self.consume(rows);
                    }
                }
            }
            (self.element, self.row) = (self.element + 1, 0);
        }
        Ok(false)
    }

    pub(super) fn column(&self, name: &str) -> Option<VertexColumn> {
        if !self.column_names().iter().any(|own| own == name) {
            return None;
        }
        let element = &self.header.elements[self.vertex?];
        let property = element.property(name)?;
        let PropertyKind::Scalar(value_type) = element.properties[property].kind else { return None };
        Some(VertexColumn { property, value_type })
    }

    pub(super) fn has_single_precision(&self) -> bool {
        let Some(element) = self.vertex.map(|vertex| &self.header.elements[vertex]) else { return false };
        let is_single = |p: &Property| matches!(p.kind, PropertyKind::Scalar(ValueType::F32));
        element.properties.iter().filter(|p| ["x", "y", "z"].contains(&p.name.as_str())).all(is_single)
    }

    pub(super) fn column_names(&self) -> Vec<String> {
        let Some(element) = self.vertex.map(|vertex| &self.header.elements[vertex]) else {
            return Vec::new();
        };
        let own = element.properties.iter().filter(|p| matches!(p.kind, PropertyKind::Scalar(_)));
        let names = own.map(|p| p.name.as_str()).filter(|name| !["x", "y", "z"].contains(name));
        single_columns(&names.collect::<Vec<_>>())
    }

    pub(super) fn vertices(
        &mut self,
        points: &mut Vec<[f64; 3]>,
        columns: &[VertexColumn],
        values: &mut Vec<f64>,
    ) -> Result<bool, ReadError> {
        let vertex = self.vertex;
        if let Some(vertex) = vertex {
            check_axes(&self.header.elements[vertex])?;
        }
        if !self.seek(|e, _| Some(e) == vertex)? {
            return Ok(false);
        }
        let rows = self.rows()?;
        self.points(rows, points).map_err(|e| self.window.relocate_error(e))?;
        if !columns.is_empty() {
            self.values(rows, columns, values).map_err(|e| self.window.relocate_error(e))?;
        }
        self.consume(rows);
        Ok(true)
    }

    /// Reads the coordinates of vertex rows.
    fn points(&self, rows: RowSpan, points: &mut Vec<[f64; 3]>) -> Result<(), ReadError> {
        let RowSpan { n, n_bytes } = rows;
        let element = &self.header.elements[self.element];
        let axes = ["x", "y", "z"].map(|axis| element.property(axis).unwrap_or(0));
        let bytes = &self.window.rest()[..n_bytes];
        let encoding = self.header.encoding;
        if let (Encoding::Binary(order), Some(row_bytes)) = (encoding, fixed_bytes(element, encoding)) {
            let places = axes.map(|p| place_in_row(element, p));
            let point = |row: &[u8]| places.map(|(t, at)| number(&row[at..], t, order));
            points.extend(bytes.chunks_exact(row_bytes as usize).map(point));
            return Ok(());
        }
        let mut body = self.body(bytes);
        for row in self.row..self.row + n {
            let mut point = [0.0; 3];
            for (p, property) in element.properties.iter().enumerate() {
                match (axes.iter().position(|&axis| axis == p), property.kind) {
                    (Some(axis), PropertyKind::Scalar(t)) => {
                        let mut one = t.empty();
                        body.read_into(&mut one, element, row)?;
                        point[axis] = one.get(0);
                    }
                    (_, kind) => body.skip(kind, element, row)?,
                }
            }
            points.push(point);
        }
        Ok(())
    }

    /// Reads the numbers of some properties of vertex rows.
    fn values(
        &self,
        rows: RowSpan,
        columns: &[VertexColumn],
        values: &mut Vec<f64>,
    ) -> Result<(), ReadError> {
        let element = &self.header.elements[self.element];
        let mut body = self.body(&self.window.rest()[..rows.n_bytes]);
        for row in self.row..self.row + rows.n {
            let start = values.len();
            values.resize(start + columns.len(), f64::NAN);
            for (p, property) in element.properties.iter().enumerate() {
                let is_asked = columns.iter().any(|column| column.property == p);
                match property.kind {
                    PropertyKind::Scalar(t) if is_asked => {
                        let mut one = t.empty();
                        body.read_into(&mut one, element, row)?;
                        let asked = columns.iter().zip(&mut values[start..]);
                        asked.filter(|(c, _)| c.property == p).for_each(|(_, value)| *value = one.get(0));
                    }
                    kind => body.skip(kind, element, row)?,
                }
            }
        }
        Ok(())
    }

    pub(super) fn body<'a>(&self, bytes: &'a [u8]) -> PlyBody<'a> {
        PlyBody { bytes, position: 0, encoding: self.header.encoding, progress: Progress::none() }
    }

    pub(super) fn faces(&mut self, n_vertices: u64, faces: &mut Polygons) -> Result<bool, ReadError> {
        let are_faces =
            |_: usize, e: &Element| e.name == "face" || e.name == "tristrips" && !e.properties.is_empty();
        if !self.seek(are_faces)? {
            return Ok(false);
        }
        let element = &self.header.elements[self.element];
        if corner_list(element).is_none() && element.name == "face" {
            let message = "element `face` has no list `vertex_indices`; its faces cannot be read".to_string();
            return Err(ReadError::Line { line: element.line as u64 + 1, message });
        }
        let rows = self.rows()?;
        self.corners(rows, n_vertices, faces)?;
        self.consume(rows);
        Ok(true)
    }

    /// Reads the corners of rows of faces or strips.
    fn corners(&self, rows: RowSpan, n_vertices: u64, faces: &mut Polygons) -> Result<(), ReadError> {
        let RowSpan { n, n_bytes } = rows;
        let element = &self.header.elements[self.element];
        let (corners, are_strips) = (corner_list(element), element.name == "tristrips");
        let layout = corners
            .filter(|_| !are_strips)
            .and_then(|corners| FaceLayout::new(element, self.header.encoding, corners));
        let mut body = self.body(&self.window.rest()[..n_bytes]);
        let (mut list, mut face) = (Vec::new(), Vec::new());
        for row in self.row..self.row + n {
            let start = body.position;
            if let Some(layout) = &layout
                && let Some(row_bytes) = read_fixed(&body.bytes[start..], layout, n_vertices, &mut face)
            {
                faces.push(&face);
                body.position += row_bytes;
                continue;
            }
            for (p, property) in element.properties.iter().enumerate() {
                let read = if Some(p) == corners {
                    body.read_list(property.kind, element, row, &mut list)
                } else {
                    body.skip(property.kind, element, row)
                };
                read.map_err(|e| self.window.relocate_error(e))?;
            }
            let mut push = |corners: &[i64]| {
                let is_none = |v: &&i64| !u64::try_from(**v).is_ok_and(|v| v < n_vertices);
                if let Some(&index) = corners.iter().find(is_none) {
                    let place = self.window.place(self.first_byte(start));
                    return Err(ReadError::FaceIndex { place, face: row, index, n_vertices });
                }
                face.clear();
                face.extend(corners.iter().map(|&v| v as u32));
                faces.push(&face);
                Ok(())
            };
            if are_strips {
                strip_triangles(&list, |triangle| push(&triangle))?;
            } else {
                push(&list)?;
            }
        }
        Ok(())
    }

    /// Start of a row whose predecessor ends at `start` in the window.
    fn first_byte(&self, start: usize) -> usize {
        let blanks = self.window.rest()[start..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        if self.header.encoding == Encoding::Ascii { start + blanks } else { start }
    }
}

/// Skips a row: at once if it has only numbers, else by its content.
fn skip_row(body: &mut PlyBody<'_>, element: &Element, row: u64) -> Result<(), ReadError> {
    if let Some(row_bytes) = fixed_bytes(element, body.encoding)
        && (body.bytes.len() - body.position) as u64 >= row_bytes
    {
        body.position += row_bytes as usize;
        return Ok(());
    }
    body.skip_row(element, row)
}

/// Size of each row in bytes, if it is the same for all rows.
fn fixed_bytes(element: &Element, encoding: Encoding) -> Option<u64> {
    let is_number = |kind| matches!(kind, PropertyKind::Scalar(_));
    let is_fixed = element.properties.is_empty()
        || encoding != Encoding::Ascii && element.properties.iter().all(|p| is_number(p.kind));
    is_fixed.then(|| element.min_row_bytes(encoding))
}

/// Type of a property and its offset in a row of numbers.
fn place_in_row(element: &Element, property: usize) -> (ValueType, usize) {
    let kind = |p: usize| match element.properties[p].kind {
        PropertyKind::Scalar(t) | PropertyKind::List { item: t, .. } => t,
    };
    (kind(property), (0..property).map(|p| kind(p).n_bytes()).sum())
}

fn number(bytes: &[u8], t: ValueType, order: ByteOrder) -> f64 {
    match t {
        ValueType::F32 => f32::from_bytes(bytes, order).into(),
        ValueType::F64 => f64::from_bytes(bytes, order),
        _ => {
            let mut one = t.empty();
            one.push_bytes(bytes, order);
            one.get(0)
        }
    }
}

/// Reads the corners of the face at the start of `bytes` and returns the size of its row; `None` if a corner is not a
/// vertex.
fn read_fixed(bytes: &[u8], layout: &FaceLayout, n_vertices: u64, face: &mut Vec<u32>) -> Option<usize> {
    let n_corners = layout.n_corners(bytes)?;
    let row_bytes = layout.row_bytes(n_corners)?;
    if bytes.len() < row_bytes {
        return None;
    }
    let (first, item) = (layout.count_at + layout.count.n_bytes(), layout.item.n_bytes());
    face.clear();
    for corner in bytes[first..first + n_corners * item].chunks_exact(item) {
        face.push(decode_count(corner, layout.item, layout.order).filter(|&v| u64::from(v) < n_vertices)?);
    }
    Some(row_bytes)
}
