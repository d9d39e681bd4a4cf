//! The text of an OBJ with some of its faces turned over.

use super::line::{is_gap, words};
use super::read::logical_end;
use crate::model::turned_faces::turn_list;

/// The text with the corners of the flagged faces in their new order; `None` if it has another number of faces. All
/// statements keep their lengths and places.
pub(super) fn turned_text(bytes: &[u8], is_turned: &[bool]) -> Option<Vec<u8>> {
    let mut text = bytes.to_vec();
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut face = 0;
    while position < bytes.len() {
        let end = logical_end(bytes, position);
        let line = &bytes[position..end];
        if words(line).next() == Some(b"f") {
            if *is_turned.get(face)? {
                turn_statement(line, &mut text[position..end]);
            }
            face += 1;
        }
        position = (end + 1).min(bytes.len());
    }
    (face == is_turned.len()).then_some(text)
}

/// Writes a face with the first corner and then the others backward, between the same gaps.
fn turn_statement(line: &[u8], out: &mut [u8]) {
    let mut places = Vec::new();
    let mut position = 0;
    while position < line.len() {
        let length = line[position..].iter().take_while(|&&b| !is_gap(b)).count();
        if line[position] == b'#' {
            break;
        }
        if length > 0 {
            places.push(position..position + length);
        }
        position += length.max(1);
    }
    // The first word is the keyword.
    let Some(corners) = places.get(1..).filter(|corners| !corners.is_empty()) else { return };
    let mut turned = corners.to_vec();
    turn_list(&mut turned);
    let (mut next, mut copied) = (corners[0].start, corners[0].start);
    let mut push = |part: &[u8]| {
        out[next..next + part.len()].copy_from_slice(part);
        next += part.len();
    };
    for (place, word) in corners.iter().zip(turned) {
        push(&line[copied..place.start]);
        push(&line[word]);
        copied = place.end;
    }
}
