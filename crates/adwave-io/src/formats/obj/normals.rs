//! Normals in the text of an OBJ: those of face corners, and the text with other ones.

use std::collections::HashMap;

use super::line::words;
use super::read::{NONE, logical_end};
use super::subset::ObjContent;
use crate::ShapeFile;
use crate::model::source_document::DocumentNormals;
use crate::text::{parse_f64, push_f32};

/// Normals of the face corners of a text; `None` if it has none.
pub(super) fn corner_normals(bytes: &[u8], shape: &ShapeFile) -> Option<DocumentNormals> {
    let content = ObjContent::parse(bytes);
    let of_corner: Vec<u32> = content.corners.iter().map(|corner| corner[1]).collect();
    if of_corner.len() != shape.faces.corners().len() || of_corner.iter().all(|&k| k == NONE) {
        return None;
    }
    let normals: Vec<[f64; 3]> = content.normals.iter().map(|line| normal_of(line)).collect();
    // Many files say that all faces are flat, whatever their normals: a flat face has one normal.
    let mut first = 0;
    let is_flat = shape
        .faces
        .iter()
        .map(|face| {
            let range = first..first + face.len();
            first = range.end;
            let is_off = content.state.get(range.start).is_some_and(|&state| content.is_flat(state));
            is_off && of_corner[range.clone()].iter().all(|&k| k == of_corner[range.start])
        })
        .collect();
    Some(DocumentNormals { normals, of_corner, is_flat })
}

fn normal_of(line: &[u8]) -> [f64; 3] {
    let mut numbers = words(line).skip(1).map(|word| parse_f64(word).unwrap_or(f64::NAN));
    std::array::from_fn(|_| numbers.next().unwrap_or(f64::NAN))
}

/// New normals of a text.
pub(super) enum NewNormals<'a> {
    /// One normal per corner of the faces; NaN at corners without one.
    OfCorners(&'a [[f64; 3]]),
    /// One normal per statement `vn`, in order: a cloud.
    OfStatements(&'a [[f64; 3]]),
}

/// Statements that replace each `vn` of a text.
struct NormalLines {
    /// Normals that replace each statement, in the order in which corners need them; none keeps the statement.
    variants: Vec<Vec<[f64; 3]>>,
    /// Index of the first of each, counted from 1.
    first: Vec<usize>,
    /// New index of each corner, counted from 1; 0 for a corner without normal.
    of_corner: Vec<usize>,
}

impl NormalLines {
    fn new(content: &ObjContent<'_>, normals: &NewNormals<'_>) -> Self {
        let old: Vec<[f64; 3]> = content.normals.iter().map(|line| normal_of(line)).collect();
        let mut variants: Vec<Vec<[f64; 3]>> = vec![Vec::new(); old.len()];
        let mut of_corner = Vec::new();
        match normals {
            NewNormals::OfStatements(normals) => {
                for (list, normal) in variants.iter_mut().zip(normals.iter()) {
                    list.push(*normal);
                }
            }
            NewNormals::OfCorners(normals) => {
                let mut known: HashMap<(u32, [u32; 3]), usize> = HashMap::new();
                for (corner, normal) in content.corners.iter().zip(normals.iter()) {
                    let Some(list) = variants.get_mut(corner[1] as usize) else {
                        of_corner.push(usize::MAX);
                        continue;
                    };
                    let normal =
                        if normal.iter().all(|x| x.is_finite()) { *normal } else { old[corner[1] as usize] };
                    let place = *known
                        .entry((corner[1], normal.map(|x| (x as f32).to_bits())))
                        .or_insert_with(|| {
                            list.push(normal);
                            list.len() - 1
                        });
                    of_corner.push(place);
                }
            }
        }
        let mut next = 1;
        let first: Vec<usize> = variants
            .iter()
            .map(|list| {
                let first = next;
                next += list.len().max(1);
                first
            })
            .collect();
        for (place, corner) in of_corner.iter_mut().zip(&content.corners) {
            *place = if *place == usize::MAX { 0 } else { first[corner[1] as usize] + *place };
        }
        Self { variants, first, of_corner }
    }

    /// True if all faces keep their indices.
    fn keeps_indices(&self) -> bool {
        self.variants.iter().all(|list| list.len() <= 1)
    }
}

/// Text with new normals: a statement `vn` whose corners need different ones is followed by further statements, and the
/// faces refer to these.
pub(super) fn with_normals(bytes: &[u8], normals: &NewNormals<'_>) -> Vec<u8> {
    let content = ObjContent::parse(bytes);
    let lines = NormalLines::new(&content, normals);
    let keeps_indices = lines.keeps_indices();
    let mut out = Vec::with_capacity(bytes.len() + bytes.len() / 8);
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    out.extend_from_slice(&bytes[..position]);
    let (mut n_normals, mut n_corners) = (0, 0);
    while position < bytes.len() {
        let end = logical_end(bytes, position);
        let next = (end + 1).min(bytes.len());
        let (line, with_end) = (&bytes[position..end], &bytes[position..next]);
        position = next;
        match words(line).next() {
            Some(b"vn") => {
                let (old, list) = (normal_of(line), &lines.variants[n_normals]);
                n_normals += 1;
                if list.is_empty() || (list.len() == 1 && is_same(old, list[0])) {
                    out.extend_from_slice(with_end);
                } else {
                    push_normals(&mut out, old, list, line);
                    out.extend_from_slice(&with_end[line.len()..]);
                }
            }
            Some(b"f") => {
                let n = words(line).count() - 1;
                let of_line = lines.of_corner.get(n_corners..n_corners + n).unwrap_or_default();
                n_corners += n;
                if keeps_indices {
                    out.extend_from_slice(with_end);
                } else {
                    push_face(&mut out, line, of_line);
                    out.extend_from_slice(&with_end[line.len()..]);
                }
            }
            _ => out.extend_from_slice(with_end),
        }
    }
    debug_assert_eq!(lines.first.len(), n_normals);
    out
}

fn is_same(a: [f64; 3], b: [f64; 3]) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}

/// Writes the normals that replace one statement; the old one keeps its text.
fn push_normals(out: &mut Vec<u8>, old: [f64; 3], list: &[[f64; 3]], line: &[u8]) {
    let end = if line.ends_with(b"\r") { "\r" } else { "" };
    for (k, normal) in list.iter().enumerate() {
        if k > 0 {
            out.extend_from_slice(end.as_bytes());
            out.push(b'\n');
        }
        if is_same(old, *normal) {
            out.extend_from_slice(line.strip_suffix(b"\r").unwrap_or(line));
            continue;
        }
        out.extend_from_slice(b"vn");
        for x in normal {
            out.push(b' ');
            // As many digits as viewers use.
            push_f32(out, *x as f32);
        }
    }
    out.extend_from_slice(end.as_bytes());
}

/// Writes a face with other indices of normals; everything else keeps its text.
fn push_face(out: &mut Vec<u8>, line: &[u8], indices: &[usize]) {
    let is_gap = |b: u8| crate::text::is_space(b) || b == b'\\' || b == b'\n';
    let (mut position, mut n_words) = (0, 0);
    while position < line.len() {
        let gap = line[position..].iter().take_while(|&&b| is_gap(b)).count();
        out.extend_from_slice(&line[position..position + gap]);
        position += gap;
        let length = line[position..].iter().take_while(|&&b| !is_gap(b)).count();
        let word = &line[position..position + length];
        if word.starts_with(b"#") {
            out.extend_from_slice(&line[position..]);
            return;
        }
        position += length;
        let index =
            if n_words == 0 || word.is_empty() { 0 } else { indices.get(n_words - 1).copied().unwrap_or(0) };
        n_words += usize::from(!word.is_empty());
        let slash = word.iter().enumerate().filter(|(_, b)| **b == b'/').map(|(k, _)| k).nth(1);
        match slash.filter(|_| index > 0) {
            Some(slash) => {
                out.extend_from_slice(&word[..=slash]);
                out.extend_from_slice(index.to_string().as_bytes());
            }
            None => out.extend_from_slice(word),
        }
    }
}
