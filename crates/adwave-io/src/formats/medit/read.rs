//! Medit in text: keywords, each with a count and that many rows.

use adwave::Progress;
use adwave::shape::Polygons;

use crate::formats::medit::write::MeditSource;
use crate::model::binary_rows::CoordinateRows;
use crate::model::text_rows::{DecimalMark, Separator, TextRows};
use crate::model::volume::{Cell, Cells};
use crate::progress::{all, collect, report_row};
use crate::text::tokens::Tokens;
use crate::{Edges, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Content after a keyword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum KeywordContent {
    Dimension,
    Vertices,
    /// Elements with that many nodes, the corners first.
    Edges(usize),
    Faces(u8, usize),
    Cells(Cell, usize),
    End,
}

/// Names and numbers of the supported keywords.
const KEYWORDS: &[(&str, i32, KeywordContent)] = &[
    ("Dimension", 3, KeywordContent::Dimension),
    ("Vertices", 4, KeywordContent::Vertices),
    ("Edges", 5, KeywordContent::Edges(2)),
    ("Triangles", 6, KeywordContent::Faces(3, 3)),
    ("Quadrilaterals", 7, KeywordContent::Faces(4, 4)),
    ("Tetrahedra", 8, KeywordContent::Cells(Cell::Tetrahedron, 4)),
    ("Prisms", 9, KeywordContent::Cells(Cell::Prism, 6)),
    ("Pentahedra", 9, KeywordContent::Cells(Cell::Prism, 6)),
    ("Hexahedra", 10, KeywordContent::Cells(Cell::Hexahedron, 8)),
    ("Hexaedra", 10, KeywordContent::Cells(Cell::Hexahedron, 8)),
    ("TrianglesP2", 24, KeywordContent::Faces(3, 6)),
    ("EdgesP2", 25, KeywordContent::Edges(3)),
    ("QuadrilateralsQ2", 27, KeywordContent::Faces(4, 9)),
    ("TetrahedraP2", 30, KeywordContent::Cells(Cell::Tetrahedron, 10)),
    ("HexahedraQ2", 33, KeywordContent::Cells(Cell::Hexahedron, 27)),
    ("Pyramids", 49, KeywordContent::Cells(Cell::Pyramid, 5)),
    ("End", 54, KeywordContent::End),
];

/// Content after the keyword of that number in a binary file.
pub(crate) fn content_of(number: i32) -> Option<KeywordContent> {
    KEYWORDS.iter().find(|(_, own, _)| *own == number).map(|(.., content)| *content)
}

/// Index of a vertex that does not exist.
pub(crate) const NONE: u32 = u32::MAX;

/// Content read from a file.
#[derive(Default)]
pub(crate) struct MeditContent {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) of_points: Vec<i64>,
    pub(crate) edges: Vec<u32>,
    pub(crate) sizes: Vec<u8>,
    pub(crate) corners: Vec<u32>,
    pub(crate) of_faces: Vec<i64>,
    pub(crate) cells: Cells,
    pub(crate) of_cells: Vec<i64>,
    pub(crate) has_other: bool,
}

impl MeditContent {
    /// List of corners for elements of this kind, with capacity for `n` more.
    pub(crate) fn begin(
        &mut self,
        content: KeywordContent,
        n: usize,
    ) -> (&mut Vec<u32>, Option<&mut Vec<i64>>, usize) {
        match content {
            KeywordContent::Faces(size, _) => {
                self.sizes.extend(std::iter::repeat_n(size, n));
                (&mut self.corners, Some(&mut self.of_faces), size.into())
            }
            KeywordContent::Cells(cell, _) => {
                self.cells.kinds.extend(std::iter::repeat_n(cell, n));
                (&mut self.cells.corners, Some(&mut self.of_cells), cell.n_corners())
            }
            _ => (&mut self.edges, None, 2),
        }
    }

    pub(crate) fn into_shape(self, format: Format, progress: Progress<'_>) -> Result<ShapeFile, ReadError> {
        let mut shape = ShapeFile::from_cloud(self.points);
        shape.format = Some(format);
        let mut extra = |is_there: bool, what: &str| {
            if is_there {
                shape.extras.push(what.into());
            }
        };
        extra(!self.cells.kinds.is_empty(), "volume cells");
        extra(self.has_other, "corners, ridges, required elements and similar");
        let has_faces = !self.sizes.is_empty() || !self.cells.kinds.is_empty();
        extra(has_faces && !self.edges.is_empty(), "elements of a line");
        let n_corners = self.corners.len().max(self.cells.corners.len());
        if n_corners >= NONE as usize {
            let limit = NONE.into();
            return Err(ReadError::Limit { what: "corners of elements", found: n_corners as u64, limit });
        }
        let mut references = self.of_faces;
        if !self.sizes.is_empty() {
            let mut offsets = vec![0];
            let mut end = 0;
            for (row, &size) in self.sizes.iter().enumerate() {
                report_row(progress, row as u64, self.sizes.len() as u64)?;
                end += u32::from(size);
                offsets.push(end);
            }
            let faces = Polygons::from_parts(offsets, self.corners);
            shape.faces = faces.expect("sums of the sizes of the faces").into();
        } else if has_faces {
            let (faces, owners) = self.cells.boundary(progress)?;
            references = collect(owners.len(), progress, |f| self.of_cells[owners[f] as usize])?;
            shape.faces = faces.into();
        } else {
            let (pairs, _) = self.edges.as_chunks::<2>();
            shape.edges = Edges { pairs: pairs.to_vec(), ..Edges::default() };
        }
        shape.vertex_fields.extend(reference(&self.of_points, progress)?);
        shape.face_fields.extend(reference(&references, progress)?);
        Ok(shape)
    }
}

/// References as a field; `None` if all are 0.
fn reference(list: &[i64], progress: Progress<'_>) -> Result<Option<Field>, ReadError> {
    if all(list.len(), progress, |k| list[k] == 0)? {
        return Ok(None);
    }
    let values = if all(list.len(), progress, |k| i32::try_from(list[k]).is_ok())? {
        FieldValues::I32(collect(list.len(), progress, |k| list[k] as i32)?)
    } else {
        FieldValues::I64(list.to_vec())
    };
    Ok(Some(Field::new("reference", 1, values)))
}

/// Reads a Medit mesh in text.
pub(crate) fn read_medit(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let start = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut tokens = Tokens::new(&bytes, start);
    let mut found = MeditContent::default();
    let (mut dimension, mut has_vertices, mut rows) = (3, false, Vec::new());
    tokens.next();
    tokens.integer("the version", 0)?;
    while let Some((start, word)) = tokens.next() {
        let content =
            KEYWORDS.iter().find(|(name, ..)| name.as_bytes() == word).map(|(.., content)| *content);
        match content {
            Some(KeywordContent::End) => break,
            Some(KeywordContent::Dimension) => {
                dimension = tokens.integer("the dimension", 0)?;
                if !matches!(dimension, 2 | 3) {
                    let message =
                        format!("points must have dimension 2 or 3, got {dimension}; save them as 3");
                    return Err(ReadError::line_error(&bytes, start, message));
                }
            }
            Some(KeywordContent::Vertices) if !has_vertices => {
                has_vertices = true;
                vertices(&mut found, &mut tokens, &mut rows, dimension as usize, limits, progress)?;
            }
            Some(content) if content != KeywordContent::Vertices => {
                elements(&mut found, &mut tokens, content, progress)?;
            }
            _ if word[0].is_ascii_alphabetic() => {
                let is_empty = tokens.peek() == Some(b"0");
                found.has_other |= !is_empty;
                skip_numbers(&mut tokens, progress)?;
            }
            _ => {
                let word = crate::text::show(word);
                let message = format!("expected a keyword, got {word}; correct the count before it");
                return Err(ReadError::line_error(&bytes, start, message));
            }
        }
    }
    if !has_vertices {
        return Err(ReadError::line_error(
            &bytes,
            bytes.len(),
            "the keyword Vertices is missing; get the whole file",
        ));
    }
    let mut shape = found.into_shape(Format::MEDIT, progress)?;
    let columns = if dimension == 3 { [0, 1, 2] } else { [0, 1, usize::MAX] };
    let separator = Separator::OverLines;
    let rows = CoordinateRows::Text(TextRows {
        decimal: DecimalMark::Point,
        bytes,
        rows,
        columns,
        separator,
        names: None,
    });
    shape.set_source(MeditSource { rows, is_flat: dimension == 2 });
    Ok(shape)
}

fn skip_numbers(tokens: &mut Tokens<'_>, progress: Progress<'_>) -> Result<(), ReadError> {
    let mut row = 0;
    while let Some(word) = tokens.peek()
        && !word[0].is_ascii_alphabetic()
    {
        report_row(progress, row, 0)?;
        tokens.next();
        row += 1;
    }
    Ok(())
}

fn vertices(
    found: &mut MeditContent,
    tokens: &mut Tokens<'_>,
    rows: &mut Vec<u64>,
    dimension: usize,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n = tokens.count("the number of vertices", 0)?;
    limits.check_points(n)?;
    tokens.check(n, 2 * dimension as u64 + 2, "vertex")?;
    for row in 0..n {
        report_row(progress, row, n)?;
        tokens.skip();
        rows.push(tokens.position as u64);
        let mut point = [0.0; 3];
        for x in &mut point[..dimension] {
            *x = tokens.number("vertex", row)?;
        }
        found.points.push(point);
        found.of_points.push(tokens.integer("vertex", row)?);
    }
    Ok(())
}

fn elements(
    found: &mut MeditContent,
    tokens: &mut Tokens<'_>,
    content: KeywordContent,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n = tokens.count("the number of elements", 0)?;
    let (KeywordContent::Edges(n_nodes)
    | KeywordContent::Faces(_, n_nodes)
    | KeywordContent::Cells(_, n_nodes)) = content
    else {
        return Ok(());
    };
    tokens.check(n, 2 + 2 * n_nodes as u64, "element")?;
    let n_vertices = found.points.len();
    let (corners, mut references, n_corners) = found.begin(content, n as usize);
    for row in 0..n {
        report_row(progress, row, n)?;
        for k in 0..n_nodes {
            tokens.skip();
            let start = tokens.position;
            let index = tokens.integer("element", row)?;
            if index < 1 || index as u64 > n_vertices as u64 {
                return Err(ReadError::FaceIndex {
                    place: format!("line {}", crate::text::line_of(tokens.bytes, start)),
                    face: row,
                    index,
                    n_vertices: n_vertices as u64,
                });
            }
            if k < n_corners {
                corners.push(index as u32 - 1);
            }
        }
        let reference = tokens.integer("element", row)?;
        if let Some(list) = &mut references {
            list.push(reference);
        }
    }
    Ok(())
}
