//! Lists of vertices (`lh.cortex.label`), and masks by labels and annotations.
//!
//! A label is text: a comment, the number of rows, and a row per vertex with its number from 0, its position and a
//! value.

use adwave::Progress;

use crate::formats::freesurfer::overlay::{Regions, read_regions};
use crate::model::format_descriptor::{MaskRequest, VertexMask};
use crate::progress::report_row;
use crate::text::line_end;
use crate::{Field, FieldValues, ReadError};

/// Names of regions that are no cortex, in small letters: of `aparc`, `aparc.a2009s`, and the annotations of Yeo and
/// Schaefer.
const NO_CORTEX: [&str; 8] = [
    "unknown",
    "???",
    "corpuscallosum",
    "medial_wall",
    "medialwall",
    "background+freesurfer_defined_medial_wall",
    "freesurfer_defined_medial_wall",
    "none",
];

/// Number of names that a message lists.
const MAX_NAMES: usize = 8;

/// Lines of a text with the byte at which each begins.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

/// Line of a text.
#[derive(Clone, Copy)]
struct Line<'a> {
    start: usize,
    text: &'a str,
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let start = self.at;
        if start >= self.bytes.len() {
            return None;
        }
        let end = line_end(self.bytes, start);
        self.at = end + 1;
        let text = std::str::from_utf8(&self.bytes[start..end]).unwrap_or_default().trim();
        Some(Line { start, text })
    }
}

/// Number of the vertex in a row of a label; `None` unless the row has a vertex, a position and a value.
fn vertex_of_row(row: &str) -> Option<i64> {
    let mut words = row.split_ascii_whitespace();
    let vertex = words.next()?.parse().ok()?;
    let n_numbers = words.clone().filter(|word| word.parse::<f64>().is_ok()).count();
    (n_numbers == 4 && words.count() == 4).then_some(vertex)
}

/// True if the bytes are a label: a comment, a count, and a row of a vertex unless the count is 0.
pub(crate) fn is_label(bytes: &[u8]) -> bool {
    let mut lines = Lines { bytes, at: 0 };
    let (Some(comment), Some(count)) = (lines.next(), lines.next()) else { return false };
    let Ok(n) = count.text.parse::<usize>() else { return false };
    let is_row = lines.next().is_some_and(|line| vertex_of_row(line.text).is_some());
    comment.text.starts_with('#') && (is_row || (n == 0 && comment.text.contains("label")))
}

/// Reads a label for a surface of `n_vertices`: 1 at the vertices that it lists, 0 elsewhere.
pub(crate) fn read_label(
    bytes: &[u8],
    n_vertices: usize,
    progress: Progress<'_>,
) -> Result<Field, ReadError> {
    let mut values = vec![0; n_vertices];
    let mut lines = Lines { bytes, at: 0 }.skip(1);
    let Some(count) = lines.next() else {
        return Err(ReadError::byte_error(bytes.len(), "the file ends before its rows; get the whole file"));
    };
    let error = |line: Line<'_>, message: String| ReadError::line_error(bytes, line.start, message);
    let n_rows = count.text.parse::<usize>().map_err(|_| {
        error(count, format!("the second line must be the number of rows, got '{}'; correct it", count.text))
    })?;
    let mut n_found = 0;
    for line in lines.filter(|line| !line.text.is_empty()).take(n_rows) {
        report_row(progress, n_found as u64, n_rows as u64)?;
        let vertex = vertex_of_row(line.text).ok_or_else(|| {
            let text = line.text;
            error(line, format!("a row must be a vertex, its position and a value, got '{text}'; correct it"))
        })?;
        let value =
            usize::try_from(vertex).ok().and_then(|vertex| values.get_mut(vertex)).ok_or_else(|| {
                let message =
                    format!("vertex {vertex} must be in 0..{n_vertices}; use the label of this surface");
                error(line, message)
            })?;
        *value = 1;
        n_found += 1;
    }
    if n_found < n_rows {
        let message = format!("the label must have {n_rows} rows, got {n_found}; get the whole file");
        return Err(ReadError::byte_error(bytes.len(), message));
    }
    Ok(Field::new("label", 1, FieldValues::U8(values)))
}

/// True if a text speaks of the medial wall.
fn names_medial_wall(text: &str) -> bool {
    let letters = text.chars().filter(char::is_ascii_alphabetic).collect::<String>().to_ascii_lowercase();
    letters.contains("medialwall")
}

/// Reads a label as a mask: the listed vertices take part, unless the label is that of the medial wall.
pub(crate) fn mask_of_label(
    bytes: &[u8],
    request: &MaskRequest<'_>,
    progress: Progress<'_>,
) -> Result<VertexMask, ReadError> {
    if let Some(regions) = request.regions {
        let message = format!("a label has no names of regions; leave out ':{regions}'");
        return Err(ReadError::Whole(message));
    }
    let listed = read_label(bytes, request.n_vertices, progress)?;
    let is_wall = names_medial_wall(request.name);
    let takes_part = (0..request.n_vertices).map(|i| (listed.get(i, 0) == 1.0) != is_wall).collect();
    let meaning = if is_wall {
        "the label lists the medial wall, which takes no part"
    } else {
        "the vertices that the label lists take part"
    };
    Ok(VertexMask { takes_part, meaning: meaning.to_owned() })
}

/// Reads an annotation as a mask: vertices of the regions that are asked for take part, else those with a region of the
/// cortex.
pub(crate) fn mask_of_annotation(
    bytes: &[u8],
    request: &MaskRequest<'_>,
    progress: Progress<'_>,
) -> Result<VertexMask, ReadError> {
    let Regions { labels, names } = read_regions(bytes, progress)?;
    let (numbers, meaning) = match request.regions {
        Some(regions) => numbers_of_regions(regions, &names)?,
        None => numbers_of_cortex(&names),
    };
    let takes_part = |i: usize| {
        let number = labels.get(i, 0);
        // Without a table the labels are colors, and 0 is none.
        if names.is_empty() { number != 0.0 } else { numbers.iter().any(|&own| f64::from(own) == number) }
    };
    Ok(VertexMask { takes_part: (0..labels.len()).map(takes_part).collect(), meaning })
}

/// Numbers of the regions with these names, and the clause that names them.
fn numbers_of_regions(regions: &str, names: &[(i32, String)]) -> Result<(Vec<i32>, String), ReadError> {
    let mut numbers = Vec::new();
    for region in regions.split(',').map(str::trim) {
        let Some((number, _)) = names.iter().find(|(_, name)| name.eq_ignore_ascii_case(region)) else {
            let known: Vec<&str> = names.iter().map(|(_, name)| name.as_str()).collect();
            return Err(ReadError::Whole(format!("there is no region '{region}'; use {}", known.join(", "))));
        };
        numbers.push(*number);
    }
    Ok((numbers, format!("the regions {regions} take part")))
}

/// Numbers of the regions of the cortex, and the clause that says which regions are left out.
fn numbers_of_cortex(names: &[(i32, String)]) -> (Vec<i32>, String) {
    let is_cortex = |name: &str| !NO_CORTEX.contains(&name.to_ascii_lowercase().as_str());
    let numbers = names.iter().filter(|(_, name)| is_cortex(name)).map(|(number, _)| *number).collect();
    let others = names.iter().map(|(_, name)| name.as_str()).filter(|name| !is_cortex(name));
    let others: Vec<&str> = others.take(MAX_NAMES).collect();
    let without =
        if others.is_empty() { String::new() } else { format!(" and those of {}", others.join(", ")) };
    (numbers, format!("vertices without a region{without} take no part"))
}
