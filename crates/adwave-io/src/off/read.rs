//! Object file format and its variants: `[ST][C][N][4]OFF`, text.

use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

use crate::lines::{Statement, Statements};
use crate::original::{Original, Separator, TextRows};
use crate::progress::at_row;
use crate::sniff::off_keyword;
use crate::text::{parse_f64, parse_u64, show, words};
use crate::{Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// What the letters before `OFF` say that a vertex has.
#[allow(clippy::struct_excessive_bools)] // one for each letter
struct Layout {
    has_w: bool,
    has_normal: bool,
    has_color: bool,
    has_texcoord: bool,
}

/// Reads an OFF.
pub(crate) fn read_off(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut lines = Statements::new(&bytes);
    let (layout, [n_vertices, n_faces]) = header(&bytes, &mut lines)?;
    limits.check_points(n_vertices)?;
    // `0 0 0` and a line end.
    check_size(&bytes, lines.position, n_vertices, 6, "vertex")?;
    let mut shape = ShapeFile::empty();
    shape.n_vertices = n_vertices as usize;
    shape.format = Some(Format::Off);
    let mut rows = Vec::with_capacity(shape.n_vertices);
    let (mut points, mut tails) = (Vec::new(), Tails::default());
    for row in 0..n_vertices {
        at_row(progress, row, n_vertices)?;
        let Some(line) = lines.next() else { return Err(ends(&bytes, "vertex", row, n_vertices)) };
        rows.push(line.start as u64);
        let mut values = words(line.text);
        let mut xyz = [0.0; 3];
        for (i, x) in xyz.iter_mut().enumerate() {
            let word = values.next().ok_or_else(|| {
                let message = format!("vertex {row} has {i} numbers and needs 3; add the missing ones");
                ReadError::in_line(&bytes, line.start, message)
            })?;
            *x = number(&bytes, &line, word, "vertex", row)?;
        }
        points.push(xyz);
        for word in values {
            let x = number(&bytes, &line, word, "vertex", row)?;
            tails.push(x, word);
        }
        tails.end_row();
    }
    shape.points = points.into();
    vertex_fields(&mut shape, &layout, &tails, progress)?;
    check_size(&bytes, lines.position, n_faces, 2, "face")?;
    read_faces(&bytes, &mut lines, n_faces, &mut shape, progress)?;
    if memchr::memchr(b'#', &bytes).is_some() {
        shape.extras.push("comments".into());
    }
    shape.original = Some(std::sync::Arc::new(Original::Rows(TextRows {
        bytes,
        rows,
        columns: [0, 1, 2],
        separator: Separator::BlanksUntilRemark,
        names: None,
    })));
    Ok(shape)
}

fn header(bytes: &[u8], lines: &mut Statements<'_>) -> Result<(Layout, [u64; 2]), ReadError> {
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
    if letters.contains(&b'n') {
        return wrong("nOFF with points of other than three dimensions cannot be read; write plain OFF");
    }
    for word in first_words {
        match parse_u64(word) {
            Some(n) => counts.push(n),
            None if word == b"BINARY" => return wrong("binary OFF cannot be read; write it as text"),
            None => return wrong(&format!("{} is no count of vertices or faces", show(word))),
        }
    }
    if counts.is_empty() {
        let Some(line) = lines.next() else { return wrong("the numbers of vertices and faces are missing") };
        for word in words(line.text) {
            let count = parse_u64(word).ok_or_else(|| {
                let message = format!("{} is no count of vertices or faces; correct it", show(word));
                ReadError::in_line(bytes, line.start, message)
            })?;
            counts.push(count);
        }
    }
    let [n_vertices, n_faces, ..] = counts[..] else {
        return wrong("there must be two counts, of vertices and of faces; add them");
    };
    let layout = Layout {
        has_w: letters.contains(&b'4'),
        has_normal: letters.contains(&b'N'),
        has_color: letters.contains(&b'C'),
        has_texcoord: letters.starts_with(b"ST"),
    };
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
struct Tails {
    values: Vec<f64>,
    ends: Vec<usize>,
    longest: usize,
    /// For each column whether a value in it is anything but digits.
    has_fraction: Vec<bool>,
}

impl Tails {
    fn push(&mut self, x: f64, word: &[u8]) {
        let column = self.values.len() - self.ends.last().copied().unwrap_or(0);
        if self.has_fraction.len() <= column {
            self.has_fraction.push(false);
        }
        self.values.push(x);
        self.has_fraction[column] |= word.iter().any(|b| !b.is_ascii_digit());
    }

    fn end_row(&mut self) {
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
    // Others write colours without the letter.
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
    shape: &mut ShapeFile,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let (mut faces, mut tails) = (Polygons::new(), Tails::default());
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
            let vertex = u32::try_from(index).ok().filter(|&v| (v as usize) < shape.n_vertices);
            face.push(vertex.ok_or_else(|| ReadError::FaceIndex {
                place: format!("line {}", crate::text::line_of(bytes, line.start)),
                face: row,
                index,
                n_vertices: shape.n_vertices as u64,
            })?);
        }
        faces.push(&face);
        for word in values {
            tails.push(number(bytes, &line, word, "face", row)?, word);
        }
        tails.end_row();
    }
    shape.faces = faces.into();
    match tails.longest {
        0 => {}
        // One value is an index into a table of colours.
        1 => shape.face_fields.push(tails.field("color_index", 0, 1, progress)?),
        n => shape.face_fields.push(tails.field("color", 0, n, progress)?),
    }
    Ok(())
}
