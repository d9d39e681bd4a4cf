//! Parser of one statement of an OBJ.

use crate::formats::obj::read::{Chunk, IndexList, NONE};
use crate::text::{is_space, parse_f64, parse_f64_at, show};

/// One line, or several lines joined by `\`.
pub(crate) struct Line<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) start: usize,
    pub(crate) end: usize,
}

type StatementError = (usize, String);

/// Within a statement, the `\` of a continued line is a blank.
pub(super) fn is_gap(byte: u8) -> bool {
    is_space(byte) || byte == b'\\'
}

/// Words of a statement, up to a comment.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&b| is_gap(b)).filter(|w| !w.is_empty()).take_while(|w| w[0] != b'#')
}

struct LineCursor<'a> {
    line: &'a [u8],
    position: usize,
}

impl<'a> LineCursor<'a> {
    fn skip_gaps(&mut self) {
        while self.line.get(self.position).is_some_and(|&b| is_gap(b)) {
            self.position += 1;
        }
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        self.skip_gaps();
        let start = self.position;
        while self.line.get(self.position).is_some_and(|&b| !is_gap(b)) {
            self.position += 1;
        }
        let word = &self.line[start..self.position];
        (!word.is_empty() && word[0] != b'#').then_some(word)
    }

    /// Parses the next word as a number; the error has the invalid word.
    fn number(&mut self) -> Result<Option<f64>, &'a [u8]> {
        self.skip_gaps();
        if let Some((x, n)) = parse_f64_at(&self.line[self.position..]) {
            self.position += n;
            return Ok(Some(x));
        }
        match self.word() {
            None => Ok(None),
            Some(word) => parse_f64(word).map(Some).ok_or(word),
        }
    }
}

/// Parses a statement into the chunk; an error has the byte position and the message.
pub(crate) fn parse_line(chunk: &mut Chunk, line: &Line<'_>) -> Result<(), StatementError> {
    let mut cursor = LineCursor { line: &line.bytes[line.start..line.end], position: 0 };
    let Some(keyword) = cursor.word() else { return Ok(()) };
    let wrong = |message: String| (line.start, message);
    match keyword {
        b"v" => {
            cursor.skip_gaps();
            chunk.rows.push((line.start + cursor.position) as u64);
            let mut point = [0.0; 3];
            let (mut n, mut is_end) = (0, false);
            while n < 3 && !is_end {
                match cursor.number() {
                    Ok(Some(x)) => {
                        point[n] = x;
                        n += 1;
                    }
                    Ok(None) => is_end = true,
                    Err(_) => break,
                }
            }
            if n == 2 && is_end {
                chunk.flat.get_or_insert(line.start);
                chunk.n_flat += 1;
            } else if n < 3 {
                let mut again = LineCursor { line: cursor.line, position: 0 };
                again.word();
                numbers(&mut again, 3, "a vertex").map_err(wrong)?;
            }
            chunk.points.push(point);
            vertex_tail(chunk, &mut cursor);
        }
        b"vn" => {
            let normal = numbers(&mut cursor, 3, "a normal").map_err(wrong)?;
            chunk.normals.push(normal);
        }
        b"vt" => {
            let mut texcoord = numbers(&mut cursor, 1, "a texture coordinate").map_err(wrong)?;
            let mut n = 1;
            while n < 3
                && let Ok(Some(x)) = cursor.number()
            {
                texcoord[n] = x;
                n += 1;
            }
            chunk.n_texcoord_channels = chunk.n_texcoord_channels.max(n);
            chunk.texcoords.push(texcoord);
        }
        b"f" => face(chunk, &mut cursor).map_err(wrong)?,
        b"l" => polyline(chunk, &mut cursor).map_err(wrong)?,
        b"p" => chunk.has_points_elements = true,
        b"g" | b"o" | b"s" | b"mg" => chunk.has_groups = true,
        b"usemtl" | b"mtllib" | b"usemap" | b"maplib" => chunk.has_materials = true,
        _ => chunk.has_other = true,
    }
    Ok(())
}

fn numbers(cursor: &mut LineCursor<'_>, n: usize, what: &str) -> Result<[f64; 3], String> {
    let mut xyz = [0.0; 3];
    for (i, x) in xyz.iter_mut().take(n).enumerate() {
        *x = match cursor.number() {
            Ok(Some(x)) => x,
            Ok(None) => return Err(format!("{what} needs {n} numbers, got {i}; add the missing ones")),
            Err(word) => return Err(format!("{what} must have numbers, got {}; correct it", show(word))),
        };
    }
    Ok(xyz)
}

/// Parses the weight or color after z. A word that is not a number ends it, because some programs add comments.
fn vertex_tail(chunk: &mut Chunk, cursor: &mut LineCursor<'_>) {
    let mut tail = [f64::NAN; 4];
    let mut n = 0;
    while n < 4
        && let Ok(Some(x)) = cursor.number()
    {
        tail[n] = x;
        n += 1;
    }
    if n > 0 && chunk.tail_len == 0 {
        chunk.tails = vec![[f64::NAN; 4]; chunk.points.len() - 1];
    }
    chunk.tail_len = chunk.tail_len.max(n);
    if chunk.tail_len > 0 {
        chunk.tails.push(tail);
    }
}

fn face(chunk: &mut Chunk, cursor: &mut LineCursor<'_>) -> Result<(), String> {
    let first = chunk.corners.len();
    while let Some(word) = cursor.word() {
        corner(chunk, word)?;
    }
    let n = chunk.corners.len() - first;
    if n == 0 {
        return Err("a face needs corners; name its vertices".into());
    }
    chunk.face_sizes.push(n as u32);
    Ok(())
}

fn corner(chunk: &mut Chunk, word: &[u8]) -> Result<(), String> {
    let bad = || format!("the corner {} must have the form v, v/vt, v//vn or v/vt/vn", show(word));
    let at = chunk.corners.len();
    let mut parts = word.split(|&b| b == b'/');
    let index = index(parts.next().unwrap_or(b"")).ok_or_else(bad)?;
    let vertex = absolute(chunk, IndexList::Vertex, at, index).map_err(|()| zero(word))?;
    chunk.corners.push(vertex);
    for (kind, part) in [(IndexList::Texcoord, parts.next()), (IndexList::Normal, parts.next())] {
        let value = match part {
            None | Some(b"") => NONE,
            Some(part) => {
                let index = self::index(part).ok_or_else(bad)?;
                absolute(chunk, kind, at, index).map_err(|()| zero(word))?
            }
        };
        let list =
            if kind == IndexList::Texcoord { &mut chunk.corner_texcoords } else { &mut chunk.corner_normals };
        if value != NONE || part.is_some_and(|p| !p.is_empty()) {
            list.resize(at, NONE);
            list.push(value);
        }
    }
    if parts.next().is_some() { Err(bad()) } else { Ok(()) }
}

fn zero(word: &[u8]) -> String {
    format!("the index in {} must not be 0 or too large; OBJ counts from 1, or backwards from -1", show(word))
}

fn polyline(chunk: &mut Chunk, cursor: &mut LineCursor<'_>) -> Result<(), String> {
    let mut previous: Option<i64> = None;
    while let Some(word) = cursor.word() {
        let bad = || format!("a line element must name vertices, got {}; correct it", show(word));
        let number = word.split(|&b| b == b'/').next().unwrap_or(b"");
        let next = index(number).ok_or_else(bad)?;
        if let Some(previous) = previous {
            for end in [previous, next] {
                let at = chunk.edges.len();
                let vertex = absolute(chunk, IndexList::EdgeEnd, at, end).map_err(|()| zero(word))?;
                chunk.edges.push(vertex);
            }
        }
        previous = Some(next);
    }
    Ok(())
}

/// Parses an integer with an optional sign and at most 18 digits.
fn index(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut n = 0_i64;
    for &b in digits {
        if !b.is_ascii_digit() {
            return None;
        }
        n = n * 10 + i64::from(b - b'0');
    }
    Some(if negative { -n } else { n })
}

/// Converts an index to count from 0; a negative one is recorded and resolved when the preceding chunks are known.
fn absolute(chunk: &mut Chunk, kind: IndexList, at: usize, index: i64) -> Result<u32, ()> {
    if index > 0 {
        return u32::try_from(index - 1).ok().filter(|&i| i < NONE - 1).ok_or(());
    }
    if index == 0 {
        return Err(());
    }
    let n = match kind {
        IndexList::Vertex | IndexList::EdgeEnd => chunk.points.len(),
        IndexList::Texcoord => chunk.texcoords.len(),
        IndexList::Normal => chunk.normals.len(),
    };
    chunk.relative.push((kind, at, n as i64 + index));
    Ok(0)
}
