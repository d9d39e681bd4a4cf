//! Reader of the object file format and its variants: `[ST][C][N][4][n]OFF`, text.
//!
//! Files are read line by line, as most programs write them; if that fails, word by word.

use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

use crate::formats::off::OffSource;
use crate::formats::off::split_keyword;
use crate::model::binary_rows::CoordinateRows;
use crate::model::text_rows::{DecimalMark, Separator, TextRows};
use crate::progress::report_row;
use crate::text::lines::{Statement, Statements};
use crate::text::{parse_f64, parse_u64, show, words};
use crate::{Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Attributes of a vertex according to the letters before `OFF`.
#[allow(clippy::struct_excessive_bools)] // one for each letter
pub(crate) struct OffLayout {
    pub(crate) has_w: bool,
    pub(crate) has_normal: bool,
    pub(crate) has_color: bool,
    pub(crate) has_texcoord: bool,
}

impl OffLayout {
    /// Parses the letters before `OFF`.
    pub(crate) fn from_letters(letters: &[u8]) -> Self {
        Self {
            has_w: letters.contains(&b'4'),
            has_normal: letters.contains(&b'N'),
            has_color: letters.contains(&b'C'),
            has_texcoord: letters.starts_with(b"ST"),
        }
    }

    /// Count of the numbers of a vertex in a binary file.
    pub(crate) fn n_numbers(&self) -> usize {
        let parts =
            [(true, 3), (self.has_w, 1), (self.has_normal, 3), (self.has_color, 4), (self.has_texcoord, 2)];
        parts.iter().filter(|(is_there, _)| *is_there).map(|(_, n)| n).sum()
    }
}

/// Content of the rows of vertices and faces.
#[derive(Default)]
pub(crate) struct OffValues {
    pub(crate) points: Vec<[f64; 3]>,
    /// Start of the coordinates of each vertex.
    pub(crate) rows: Vec<u64>,
    pub(crate) tails: TrailingColumns,
    pub(crate) faces: Polygons,
    pub(crate) face_tails: TrailingColumns,
}

/// Reads an OFF.
pub(crate) fn read_off(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    if crate::formats::off::binary::head(&bytes).is_some() {
        return crate::formats::off::binary::read_off_binary(bytes, limits, progress);
    }
    let error = match read_lines(&bytes, limits, progress) {
        Ok((layout, values)) => {
            return finish(bytes, &layout, values, Separator::BlanksUntilRemark, progress);
        }
        Err(error @ (ReadError::Line { .. } | ReadError::Truncated { .. })) => error,
        Err(error) => return Err(error),
    };
    // The first error is more helpful if the lines are meant as rows.
    crate::formats::off::tokens::read_by_tokens(bytes, limits, progress).map_err(|other| match other {
        ReadError::Cancelled(_) => other,
        _ => error,
    })
}

fn read_lines(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<(OffLayout, OffValues), ReadError> {
    let mut lines = Statements::new(bytes);
    let (layout, [n_vertices, n_faces]) = header(bytes, &mut lines)?;
    limits.check_points(n_vertices)?;
    // `0 0 0` and a line end.
    check_size(bytes, lines.position, n_vertices, 6, "vertex")?;
    let mut found = OffValues::default();
    for row in 0..n_vertices {
        report_row(progress, row, n_vertices)?;
        let Some(line) = lines.next() else { return Err(ends(bytes, "vertex", row, n_vertices)) };
        found.rows.push(line.start as u64);
        let mut values = words(line.text);
        let mut xyz = [0.0; 3];
        for (i, x) in xyz.iter_mut().enumerate() {
            let word = values.next().ok_or_else(|| {
                let message = format!("vertex {row} needs 3 numbers, got {i}; add the missing ones");
                ReadError::line_error(bytes, line.start, message)
            })?;
            *x = number(bytes, &line, word, "vertex", row)?;
        }
        found.points.push(xyz);
        for word in values {
            let x = number(bytes, &line, word, "vertex", row)?;
            found.tails.push(x, word);
        }
        found.tails.end_row();
    }
    check_size(bytes, lines.position, n_faces, 2, "face")?;
    read_faces(bytes, &mut lines, n_faces, &mut found, progress)?;
    Ok((layout, found))
}

/// Builds the shape with its fields and with its text for rewriting.
pub(crate) fn finish(
    bytes: Vec<u8>,
    layout: &OffLayout,
    values: OffValues,
    separator: Separator,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let OffValues { points, rows, tails, faces, face_tails } = values;
    let mut shape = ShapeFile::from_mesh(points, faces);
    shape.format = Some(Format::OFF);
    vertex_fields(&mut shape, layout, &tails, progress)?;
    match face_tails.longest {
        0 => {}
        // A single value is an index into a table of colors.
        1 => shape.face_fields.push(face_tails.field("color_index", 0, 1, progress)?),
        n => shape.face_fields.push(face_tails.field("color", 0, n, progress)?),
    }
    if memchr::memchr(b'#', &bytes).is_some() {
        shape.extras.push("comments".into());
    }
    if !divide(&mut shape) {
        let names = None;
        let rows =
            TextRows { decimal: DecimalMark::Point, bytes, rows, columns: [0, 1, 2], separator, names };
        shape.set_source(OffSource(CoordinateRows::Text(rows)));
    }
    Ok(shape)
}

/// Divides by the fourth, homogeneous coordinate, as in Geomview, and drops it; returns true if anything was divided.
/// Points at infinity have no position: if there is one, the points are treated as four-dimensional and projected
/// along the last axis.
pub(crate) fn divide(shape: &mut ShapeFile) -> bool {
    let Some(at) = shape.vertex_fields.iter().position(|f| f.name == "w" && f.n_channels == 1) else {
        return false;
    };
    let w = shape.vertex_fields[at].to_f64();
    if w.iter().all(|&w| w == 1.0) || w.iter().any(|&w| w == 0.0 || !w.is_finite()) {
        return false;
    }
    let points = shape.points.iter().zip(&w).map(|(p, w)| p.map(|x| x / w)).collect::<Vec<_>>();
    if points.as_flattened().iter().zip(shape.points.as_flattened()).any(|(x, old)| {
        // A tiny divisor may give infinity.
        old.is_finite() && !x.is_finite()
    }) {
        return false;
    }
    shape.points = points.into();
    shape.vertex_fields.remove(at);
    shape.precision = crate::CoordinatePrecision::F64;
    true
}

pub(crate) fn header(bytes: &[u8], lines: &mut Statements<'_>) -> Result<(OffLayout, [u64; 2]), ReadError> {
    let Some(first) = lines.next() else { return Err(ReadError::Empty) };
    let wrong = |message: &str| Err(ReadError::line_error(bytes, first.start, message));
    let mut first_words = words(first.text).peekable();
    let mut letters: &[u8] = b"";
    let mut counts: Vec<u64> = Vec::new();
    // The keyword may be missing, and the counts may follow it on its line or even in its word.
    if let Some((before, after)) = first_words.peek().and_then(|w| split_keyword(w)) {
        letters = before;
        counts.extend(parse_u64(after));
        first_words.next();
    }
    let is_n = letters.contains(&b'n');
    if is_n && letters.contains(&b'4') {
        return wrong("4nOFF is not supported; write plain OFF");
    }
    // In files without line structure, vertices may follow.
    for word in first_words.take(if is_n { 4 } else { 3 }) {
        match parse_u64(word) {
            Some(n) => counts.push(n),
            None if word == b"BINARY" => return wrong("BINARY must end the first line; get the file again"),
            None => {
                return wrong(&format!(
                    "the count of vertices or faces must be a number, got {}",
                    show(word)
                ));
            }
        }
    }
    // The dimension may be on a line of its own.
    while counts.len() < if is_n { 3 } else { 1 } {
        let Some(line) = lines.next() else { return wrong("the numbers of vertices and faces are missing") };
        for word in words(line.text) {
            let count = parse_u64(word).ok_or_else(|| {
                let message = format!(
                    "the count of vertices or faces must be a number, got {}; correct it",
                    show(word)
                );
                ReadError::line_error(bytes, line.start, message)
            })?;
            counts.push(count);
        }
    }
    if is_n {
        let dimension = counts.remove(0);
        if dimension != 3 {
            return wrong("nOFF needs points of three dimensions; write plain OFF");
        }
    }
    let [n_vertices, n_faces, ..] = counts[..] else {
        return wrong("two counts, of vertices and of faces, are needed; add them");
    };
    let layout = OffLayout::from_letters(letters);
    Ok((layout, [n_vertices, n_faces]))
}

fn ends(bytes: &[u8], element: &str, row: u64, n: u64) -> ReadError {
    let message = format!("the file ends at {element} {row} of {n}; get the whole file");
    ReadError::line_error(bytes, bytes.len(), message)
}

/// Fails early if rows of at least `row_bytes` each do not fit the remaining bytes.
fn check_size(bytes: &[u8], position: usize, n: u64, row_bytes: u64, element: &str) -> Result<(), ReadError> {
    let remaining = bytes.len().saturating_sub(position) as u64 + 1;
    if remaining / row_bytes >= n {
        return Ok(());
    }
    Err(ReadError::Truncated {
        end: bytes.len() as u64,
        needed: (position as u64).saturating_add(n.saturating_mul(row_bytes)),
        element: element.into(),
        row: remaining / row_bytes,
    })
}

fn number(
    bytes: &[u8],
    line: &Statement<'_>,
    word: &[u8],
    element: &str,
    row: u64,
) -> Result<f64, ReadError> {
    parse_f64(word).ok_or_else(|| {
        let message = format!("{element} {row} must have numbers, got {}; correct it", show(word));
        ReadError::line_error(bytes, line.start, message)
    })
}

/// Values after the coordinates or corners, any number in each row.
#[derive(Default)]
pub(crate) struct TrailingColumns {
    values: Vec<f64>,
    ends: Vec<usize>,
    pub(crate) longest: usize,
    /// True for each column with a value that is more than digits.
    has_fraction: Vec<bool>,
}

impl TrailingColumns {
    pub(crate) fn push(&mut self, x: f64, word: &[u8]) {
        let column = self.values.len() - self.ends.last().copied().unwrap_or(0);
        if self.has_fraction.len() <= column {
            self.has_fraction.push(false);
        }
        self.values.push(x);
        self.has_fraction[column] |= word.iter().any(|b| !b.is_ascii_digit());
    }

    pub(crate) fn n_values(&self) -> usize {
        self.values.len()
    }

    pub(crate) fn end_row(&mut self) {
        let start = self.ends.last().copied().unwrap_or(0);
        self.longest = self.longest.max(self.values.len() - start);
        self.ends.push(self.values.len());
    }

    /// Field of the values `from..from + n` of every row, NaN if a row is shorter; bytes if `color` and all are 0 …
    /// 255.
    fn field(&self, name: &str, from: usize, n: usize, progress: Progress<'_>) -> Result<Field, Cancelled> {
        let mut values = Vec::with_capacity(self.ends.len() * n);
        let mut start = 0;
        for (i, &end) in self.ends.iter().enumerate() {
            report_row(progress, i as u64, self.ends.len() as u64)?;
            let row = &self.values[start..end];
            values.extend((from..from + n).map(|c| row.get(c).copied().unwrap_or(f64::NAN)));
            start = end;
        }
        let has_fraction = self.has_fraction.iter().skip(from).take(n).any(|&f| f);
        if name == "color" && !has_fraction && values.iter().all(|x| (0.0..=255.0).contains(x)) {
            let bytes = values.iter().map(|&x| x as u8).collect();
            return Ok(Field::new(name, n, FieldValues::U8(bytes)));
        }
        Ok(Field::new(name, n, FieldValues::F64(values)))
    }
}

fn vertex_fields(
    shape: &mut ShapeFile,
    layout: &OffLayout,
    tails: &TrailingColumns,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let mut from = 0;
    let mut left = tails.longest;
    let mut add = |name: &str, n: usize, shape: &mut ShapeFile| {
        // Some programs write letters before `OFF` without the values.
        if n > 0 && left >= n {
            shape.vertex_fields.push(tails.field(name, from, n, progress)?);
            from += n;
            left -= n;
        }
        Ok(())
    };
    if layout.has_w {
        add("w", 1, shape)?;
    }
    if layout.has_normal {
        add("normal", 3, shape)?;
    }
    let after_w_and_normal =
        tails.longest.saturating_sub(usize::from(layout.has_w) + 3 * usize::from(layout.has_normal));
    let for_color = after_w_and_normal.saturating_sub(2 * usize::from(layout.has_texcoord));
    // Other programs write colors without the letter.
    if layout.has_color || matches!(for_color, 3 | 4) {
        add("color", if for_color >= 4 { 4 } else { 3 }, shape)?;
    }
    if layout.has_texcoord {
        add("texcoord", 2, shape)?;
    }
    if left > 0 {
        shape.vertex_fields.push(tails.field("extra", from, left, progress)?);
    }
    Ok(())
}

fn read_faces(
    bytes: &[u8],
    lines: &mut Statements<'_>,
    n_faces: u64,
    found: &mut OffValues,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n_vertices = found.points.len();
    let mut face = Vec::new();
    for row in 0..n_faces {
        report_row(progress, row, n_faces)?;
        let Some(line) = lines.next() else { return Err(ends(bytes, "face", row, n_faces)) };
        let mut values = words(line.text);
        let first = values.next().unwrap_or(b"");
        let n_corners = parse_u64(first).ok_or_else(|| {
            let message = format!("face {row} must begin with a number of corners, got {}", show(first));
            ReadError::line_error(bytes, line.start, message)
        })?;
        face.clear();
        for corner in 0..n_corners {
            let word = values.next().ok_or_else(|| {
                let message = format!(
                    "face {row} needs {n_corners} corners, got {corner}; add the missing \
                                      ones"
                );
                ReadError::line_error(bytes, line.start, message)
            })?;
            let index: i64 =
                std::str::from_utf8(word).ok().and_then(|t| t.parse().ok()).ok_or_else(|| {
                    let message = format!("face {row} must name vertices, got {}", show(word));
                    ReadError::line_error(bytes, line.start, message)
                })?;
            let vertex = u32::try_from(index).ok().filter(|&v| (v as usize) < n_vertices);
            face.push(vertex.ok_or_else(|| ReadError::FaceIndex {
                place: format!("line {}", crate::text::line_of(bytes, line.start)),
                face: row,
                index,
                n_vertices: n_vertices as u64,
            })?);
        }
        found.faces.push(&face);
        for word in values {
            found.face_tails.push(number(bytes, &line, word, "face", row)?, word);
        }
        found.face_tails.end_row();
    }
    Ok(())
}
