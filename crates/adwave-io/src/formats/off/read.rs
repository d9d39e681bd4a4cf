//! Object file format and its variants: `[ST][C][N][4][n]OFF`, text.
//!
//! Read line by line, as all write it; where that does not come out, word by word.

use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

use crate::formats::off::OffSource;
use crate::formats::off::off_keyword;
use crate::model::binary_rows::CoordinateRows;
use crate::model::text_rows::{Separator, TextRows};
use crate::progress::at_row;
use crate::text::lines::{Statement, Statements};
use crate::text::{parse_f64, parse_u64, show, words};
use crate::{Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// What the letters before `OFF` say that a vertex has.
#[allow(clippy::struct_excessive_bools)] // one for each letter
pub(crate) struct Layout {
    pub(crate) has_w: bool,
    pub(crate) has_normal: bool,
    pub(crate) has_color: bool,
    pub(crate) has_texcoord: bool,
}

impl Layout {
    /// What the letters before `OFF` say.
    pub(crate) fn of(letters: &[u8]) -> Self {
        Self {
            has_w: letters.contains(&b'4'),
            has_normal: letters.contains(&b'N'),
            has_color: letters.contains(&b'C'),
            has_texcoord: letters.starts_with(b"ST"),
        }
    }
}

/// What the rows of vertices and faces say.
#[derive(Default)]
pub(crate) struct Values {
    pub(crate) points: Vec<[f64; 3]>,
    /// Where the coordinates of each vertex begin.
    pub(crate) rows: Vec<u64>,
    pub(crate) tails: Tails,
    pub(crate) faces: Polygons,
    pub(crate) face_tails: Tails,
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
    // The first error says more to those whose lines are meant as lines.
    crate::formats::off::tokens::read_by_tokens(bytes, limits, progress).map_err(|other| match other {
        ReadError::Cancelled(_) => other,
        _ => error,
    })
}

fn read_lines(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<(Layout, Values), ReadError> {
    let mut lines = Statements::new(bytes);
    let (layout, [n_vertices, n_faces]) = header(bytes, &mut lines)?;
    limits.check_points(n_vertices)?;
    // `0 0 0` and a line end.
    check_size(bytes, lines.position, n_vertices, 6, "vertex")?;
    let mut found = Values::default();
    for row in 0..n_vertices {
        at_row(progress, row, n_vertices)?;
        let Some(line) = lines.next() else { return Err(ends(bytes, "vertex", row, n_vertices)) };
        found.rows.push(line.start as u64);
        let mut values = words(line.text);
        let mut xyz = [0.0; 3];
        for (i, x) in xyz.iter_mut().enumerate() {
            let word = values.next().ok_or_else(|| {
                let message = format!("vertex {row} has {i} numbers and needs 3; add the missing ones");
                ReadError::in_line(bytes, line.start, message)
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

/// The shape with its fields, and its text to be written again.
pub(crate) fn finish(
    bytes: Vec<u8>,
    layout: &Layout,
    values: Values,
    separator: Separator,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let Values { points, rows, tails, faces, face_tails } = values;
    let mut shape = ShapeFile::from_mesh(points, faces);
    shape.format = Some(Format::OFF);
    vertex_fields(&mut shape, layout, &tails, progress)?;
    match face_tails.longest {
        0 => {}
        // One value is an index into a table of colors.
        1 => shape.face_fields.push(face_tails.field("color_index", 0, 1, progress)?),
        n => shape.face_fields.push(face_tails.field("color", 0, n, progress)?),
    }
    if memchr::memchr(b'#', &bytes).is_some() {
        shape.extras.push("comments".into());
    }
    if !divide(&mut shape) {
        let names = None;
        let rows = TextRows { bytes, rows, columns: [0, 1, 2], separator, names };
        shape.set_source(OffSource(CoordinateRows::Text(rows)));
    }
    Ok(shape)
}

/// Divides by the fourth, homogeneous coordinate, as Geomview means it, and drops it; whether there was anything to divide. Points at
/// infinity have no place: where there is one, the points are taken as of four dimensions and seen along the last.
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
        // A tiny divisor may lead beyond all numbers.
        old.is_finite() && !x.is_finite()
    }) {
        return false;
    }
    shape.points = points.into();
    shape.vertex_fields.remove(at);
    shape.precision = crate::Precision::F64;
    true
}

pub(crate) fn header(bytes: &[u8], lines: &mut Statements<'_>) -> Result<(Layout, [u64; 2]), ReadError> {
    let Some(first) = lines.next() else { return Err(ReadError::Empty) };
    let wrong = |message: &str| Err(ReadError::in_line(bytes, first.start, message));
    let mut first_words = words(first.text).peekable();
    let mut letters: &[u8] = b"";
    let mut counts: Vec<u64> = Vec::new();
    // The keyword may be left out, and the counts may follow it on its line or even in its word.
    if let Some((before, after)) = first_words.peek().and_then(|w| off_keyword(w)) {
        letters = before;
        counts.extend(parse_u64(after));
        first_words.next();
    }
    let is_n = letters.contains(&b'n');
    if is_n && letters.contains(&b'4') {
        return wrong("4nOFF cannot be read; write plain OFF");
    }
    // Where words count and not lines, vertices may follow.
    for word in first_words.take(if is_n { 4 } else { 3 }) {
        match parse_u64(word) {
            Some(n) => counts.push(n),
            None if word == b"BINARY" => return wrong("BINARY must end the first line; get it anew"),
            None => return wrong(&format!("{} is no count of vertices or faces", show(word))),
        }
    }
    // The dimension may have a line of its own.
    while counts.len() < if is_n { 3 } else { 1 } {
        let Some(line) = lines.next() else { return wrong("the numbers of vertices and faces are missing") };
        for word in words(line.text) {
            let count = parse_u64(word).ok_or_else(|| {
                let message = format!("{} is no count of vertices or faces; correct it", show(word));
                ReadError::in_line(bytes, line.start, message)
            })?;
            counts.push(count);
        }
    }
    if is_n {
        let dimension = counts.remove(0);
        if dimension != 3 {
            return wrong("nOFF with points of other than three dimensions cannot be read; write plain OFF");
        }
    }
    let [n_vertices, n_faces, ..] = counts[..] else {
        return wrong("there must be two counts, of vertices and of faces; add them");
    };
    let layout = Layout::of(letters);
    Ok((layout, [n_vertices, n_faces]))
}

fn ends(bytes: &[u8], element: &str, row: u64, n: u64) -> ReadError {
    let message = format!("the file ends at {element} {row} of {n}; get the whole file");
    ReadError::in_line(bytes, bytes.len(), message)
}

/// Fails at once when the rows, each of at least `row_bytes`, cannot be in the bytes that remain.
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
        let message = format!("{element} {row} has {} where a number belongs; correct it", show(word));
        ReadError::in_line(bytes, line.start, message)
    })
}

/// The values after the coordinates or corners, any number in each row.
#[derive(Default)]
pub(crate) struct Tails {
    values: Vec<f64>,
    ends: Vec<usize>,
    pub(crate) longest: usize,
    /// For each column whether a value in it is anything but digits.
    has_fraction: Vec<bool>,
}

impl Tails {
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

    /// Values `from..from + n` of every row, NaN where a row is shorter; bytes when `color` and all are 0 … 255.
    fn field(&self, name: &str, from: usize, n: usize, progress: Progress<'_>) -> Result<Field, Cancelled> {
        let mut values = Vec::with_capacity(self.ends.len() * n);
        let mut start = 0;
        for (i, &end) in self.ends.iter().enumerate() {
            at_row(progress, i as u64, self.ends.len() as u64)?;
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
    layout: &Layout,
    tails: &Tails,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let mut from = 0;
    let mut left = tails.longest;
    let mut add = |name: &str, n: usize, shape: &mut ShapeFile| {
        // Some writers put letters before `OFF` without writing the values.
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
    // Others write colors without the letter.
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
    found: &mut Values,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n_vertices = found.points.len();
    let mut face = Vec::new();
    for row in 0..n_faces {
        at_row(progress, row, n_faces)?;
        let Some(line) = lines.next() else { return Err(ends(bytes, "face", row, n_faces)) };
        let mut values = words(line.text);
        let first = values.next().unwrap_or(b"");
        let n_corners = parse_u64(first).ok_or_else(|| {
            let message = format!("face {row} begins with {}, which is no number of corners", show(first));
            ReadError::in_line(bytes, line.start, message)
        })?;
        face.clear();
        for corner in 0..n_corners {
            let word = values.next().ok_or_else(|| {
                let message = format!("face {row} has {corner} of {n_corners} corners; add the missing ones");
                ReadError::in_line(bytes, line.start, message)
            })?;
            let index: i64 =
                std::str::from_utf8(word).ok().and_then(|t| t.parse().ok()).ok_or_else(|| {
                    let message = format!("face {row} has {} where a vertex belongs", show(word));
                    ReadError::in_line(bytes, line.start, message)
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
