//! Reader of the trivial graph format: a line with a name and a label per vertex, a line with `#`, a line with two
//! names and a label per edge.

use adwave::Progress;

use crate::formats::graph::{VertexNames, edges};
use crate::progress::report_row;
use crate::text::{line_end, parse_f64, show, words};
use crate::{Direction, Format, ReadError, ReadLimits, ShapeFile};

/// Reads a graph. Labels of three numbers at all vertices are positions, labels of one number at all edges are
/// weights.
pub(crate) fn read_tgf(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut names = VertexNames::default();
    let (mut points, mut has_labels, mut has_more) = (Some(Vec::new()), false, false);
    let (mut pairs, mut weights) = (Vec::new(), Vec::new());
    let mut part = 0;
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut row = 0;
    while position < bytes.len() {
        report_row(progress, row, 0)?;
        row += 1;
        let start = position;
        let end = line_end(bytes, start);
        position = end + 1;
        let line = bytes[start..end].trim_ascii();
        if line.is_empty() {
            continue;
        }
        if line == b"#" {
            part += 1;
            continue;
        }
        let mut parts = words(line);
        let name = parts.next().unwrap_or(b"");
        match part {
            0 => {
                let n = names.len();
                if names.add(name) as usize != n {
                    let message = format!("vertex {} occurs twice; rename one", show(name));
                    return Err(ReadError::line_error(bytes, start, message));
                }
                let label: Vec<&[u8]> = parts.collect();
                has_labels |= !label.is_empty();
                let numbers: Option<Vec<f64>> = label.iter().map(|w| parse_f64(w)).collect();
                let point = numbers.and_then(|n| <[f64; 3]>::try_from(n).ok());
                points = points.zip(point).map(|(mut all, point): (Vec<[f64; 3]>, _)| {
                    all.push(point);
                    all
                });
            }
            1 => {
                let mut pair = [0; 2];
                for (end, name) in pair.iter_mut().zip([name, parts.next().unwrap_or(b"")]) {
                    *end = names.get(name).ok_or_else(|| {
                        let message =
                            format!("an edge names vertex {}, which does not exist; add it", show(name));
                        ReadError::line_error(bytes, start, message)
                    })?;
                }
                pairs.push(pair);
                weights.push(parts.next().and_then(parse_f64));
            }
            _ => has_more = true,
        }
    }
    if part == 0 {
        let message = "the line with # between vertices and edges is missing; get the whole file";
        return Err(ReadError::line_error(bytes, bytes.len(), message));
    }
    limits.check_points(names.len() as u64)?;
    let mut shape = ShapeFile::from_graph(names.len(), edges(pairs, weights, Direction::Both));
    shape.vertex_names = names.to_texts(1);
    match points.filter(|points| !points.is_empty()) {
        Some(points) => shape.points = points.into(),
        None if has_labels => shape.extras.push("labels of vertices".into()),
        None => {}
    }
    if has_more {
        shape.extras.push("content after the edges".into());
    }
    shape.format = Some(Format::TGF);
    Ok(shape)
}
