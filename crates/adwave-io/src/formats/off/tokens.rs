//! Reader of OFF as words without lines: faces over several lines, or several of them on one, as Geomview allows.

use adwave::Progress;
use adwave::shape::Polygons;

use crate::formats::off::read::{Layout, Tails, Values, finish, header};
use crate::model::text_rows::Separator;
use crate::progress::at_row;
use crate::text::lines::Statements;
use crate::text::tokens::Tokens;
use crate::text::{is_blank, parse_f64};
use crate::{ReadError, ReadLimits, ShapeFile};

/// Reads an OFF whose line ends are meaningless, except after colors of faces.
pub(crate) fn read_by_tokens(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut lines = Statements::new(&bytes);
    let (layout, [n_vertices, n_faces]) = header(&bytes, &mut lines)?;
    limits.check_points(n_vertices)?;
    let start = after_counts(&bytes).unwrap_or(lines.position);
    let mut tokens = Tokens::new(&bytes, start.min(bytes.len()));
    tokens.check(n_vertices, 6, "vertex")?;
    let mut values = Values::default();
    for row in 0..n_vertices {
        at_row(progress, row, n_vertices)?;
        tokens.skip();
        values.rows.push(tokens.position as u64);
        let mut point = [0.0; 3];
        for x in &mut point {
            *x = tokens.number("vertex", row)?;
        }
        values.points.push(point);
        for _ in 0..layout.n_tail() {
            tokens.skip();
            let start = tokens.position;
            let x = tokens.number("vertex", row)?;
            values.tails.push(x, &bytes[start..tokens.position]);
        }
        values.tails.end_row();
    }
    tokens.check(n_faces, 2, "face")?;
    // Without colors all words are used exactly; with colors the rest of a line belongs to its face.
    let plain = faces(&mut tokens.clone(), n_faces, n_vertices, Colors::None, progress);
    let is_whole = |(_, end): &(Faces, usize)| Tokens::new(&bytes, *end).next().is_none();
    (values.faces, values.face_tails) = match plain {
        Ok(found) if is_whole(&found) => found.0,
        Err(ReadError::Cancelled(e)) => return Err(e.into()),
        _ => {
            let found = faces(&mut tokens, n_faces, n_vertices, Colors::ToEndOfLine, progress)?;
            if !is_whole(&found) {
                return Err(tokens.wrong("the face after", n_faces, "the end of the file"));
            }
            found.0
        }
    };
    finish(bytes, &layout, values, Separator::OverLines, progress)
}

/// End of the counts if vertices follow them on the line of the keyword.
fn after_counts(bytes: &[u8]) -> Option<usize> {
    let mut tokens = Tokens::new(bytes, if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 });
    let (start, keyword) = tokens.next()?;
    let (letters, rest) = crate::formats::off::off_keyword(keyword)?;
    let end = crate::text::line_end(bytes, start);
    for _ in 0..if letters.contains(&b'n') { 4 } else { 3 } {
        tokens.count("the counts", 0).ok()?;
    }
    let has_more = Tokens::new(&bytes[..end], tokens.position.min(end)).next().is_some();
    (rest.is_empty() && tokens.position < end && has_more).then_some(tokens.position)
}

/// Faces and the content after their corners.
type Faces = (Polygons, Tails);

#[derive(Clone, Copy, PartialEq)]
enum Colors {
    None,
    ToEndOfLine,
}

fn faces(
    tokens: &mut Tokens<'_>,
    n: u64,
    n_vertices: u64,
    colors: Colors,
    progress: Progress<'_>,
) -> Result<(Faces, usize), ReadError> {
    let (mut faces, mut tails) = (Polygons::new(), Tails::default());
    let mut face = Vec::new();
    for row in 0..n {
        at_row(progress, row, n)?;
        tokens.skip();
        let start = tokens.position;
        let n_corners = tokens.count("face", row)?;
        // Words shifted by a missing one must not be taken for faces.
        if n_corners < 2 {
            let message = format!("face {row} has the invalid number of {n_corners} corners; correct it");
            return Err(ReadError::in_line(tokens.bytes, start, message));
        }
        face.clear();
        for _ in 0..n_corners {
            tokens.skip();
            let start = tokens.position;
            let index = tokens.whole("face", row)?;
            if index < 0 || index as u64 >= n_vertices {
                let place = format!("line {}", crate::text::line_of(tokens.bytes, start));
                return Err(ReadError::FaceIndex { place, face: row, index, n_vertices });
            }
            face.push(index as u32);
        }
        faces.push(&face);
        let first = tails.n_values();
        loop {
            if colors == Colors::None {
                break;
            }
            while tokens.bytes.get(tokens.position).is_some_and(|&b| is_blank(b)) {
                tokens.position += 1;
            }
            if matches!(tokens.bytes.get(tokens.position), None | Some(b'\n' | b'#')) {
                break;
            }
            let Some((start, word)) = tokens.next() else { break };
            let Some(x) = parse_f64(word) else {
                tokens.position = start;
                return Err(tokens.wrong("face", row, "a number"));
            };
            tails.push(x, word);
        }
        if !matches!(tails.n_values() - first, 0 | 1 | 3 | 4) {
            return Err(tokens.wrong("face", row, "a color of 1, 3 or 4 numbers"));
        }
        tails.end_row();
    }
    Ok(((faces, tails), tokens.position))
}

impl Layout {
    /// Number of values of a vertex after its coordinates.
    fn n_tail(&self) -> usize {
        usize::from(self.has_w)
            + 3 * usize::from(self.has_normal)
            + 4 * usize::from(self.has_color)
            + 2 * usize::from(self.has_texcoord)
    }
}
