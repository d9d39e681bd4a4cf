//! Reader for lists of edges: two names per line and an optional weight; `#` and `%` begin comments.

use adwave::Progress;

use crate::formats::graph::{VertexNames, edges, names_unless_numbered};
use crate::progress::report_row;
use crate::text::{is_blank, line_end, parse_f64, parse_u64, show};
use crate::{Direction, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Content of the lines.
#[derive(Default)]
struct EdgeLines<'a> {
    ends: Vec<[&'a [u8]; 2]>,
    weights: Vec<Option<f64>>,
    /// Number of vertices stated in a comment.
    n_vertices: Option<u64>,
}

/// Reads a graph. Vertices named by integers are in ascending order, others in the order of the file.
pub(crate) fn read_edge_list(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let lines = parse(bytes, progress)?;
    let numbers: Option<Vec<u64>> = lines.ends.as_flattened().iter().map(|w| parse_u64(w)).collect();
    let mut pairs = Vec::with_capacity(lines.ends.len());
    let mut names = None;
    let mut texts = None;
    let n_vertices = if let Some(numbers) = numbers {
        let mut distinct = numbers.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let largest = distinct.last().copied();
        // Vertices without edges take no bytes in the file, but memory in every later computation.
        let limit = 1_000_000 + 64 * bytes.len() as u64;
        let named = lines.n_vertices.filter(|&n| n <= limit && largest.is_none_or(|l| l < n));
        let (ends, _) = numbers.as_chunks::<2>();
        for (row, pair) in ends.iter().enumerate() {
            report_row(progress, row as u64, ends.len() as u64)?;
            let place = |x: u64| distinct.binary_search(&x).unwrap_or(0) as u32;
            pairs.push(if named.is_some() { pair.map(|x| x as u32) } else { pair.map(place) });
        }
        let is_counted = named.is_some() || largest.is_none_or(|l| l < distinct.len() as u64);
        let n = named.unwrap_or(distinct.len() as u64);
        if !is_counted {
            texts = names_unless_numbered(distinct.iter().map(u64::to_string).collect(), "", 0);
            names = Some(Field::new("id", 1, FieldValues::U64(distinct)));
        }
        limits.check_points(n)?;
        n as usize
    } else {
        let mut names = VertexNames::default();
        for (row, ends) in lines.ends.iter().enumerate() {
            report_row(progress, row as u64, lines.ends.len() as u64)?;
            pairs.push(ends.map(|name| names.add(name)));
        }
        limits.check_points(names.len() as u64)?;
        texts = names.to_texts(0);
        names.len()
    };
    let mut shape = ShapeFile::from_graph(n_vertices, edges(pairs, lines.weights, Direction::Both));
    shape.vertex_fields.extend(names);
    shape.vertex_names = texts;
    shape.format = Some(Format::EDGE_LIST);
    Ok(shape)
}

fn parse<'a>(bytes: &'a [u8], progress: Progress<'_>) -> Result<EdgeLines<'a>, ReadError> {
    let mut lines = EdgeLines::default();
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    while position < bytes.len() {
        report_row(progress, lines.ends.len() as u64, 0)?;
        let start = position;
        let end = line_end(bytes, start);
        position = end + 1;
        let line = bytes[start..end].trim_ascii();
        if line.is_empty() {
            continue;
        }
        if matches!(line[0], b'#' | b'%') {
            lines.n_vertices = lines.n_vertices.or_else(|| n_nodes(line));
            continue;
        }
        let mut parts = line.split(|&b| is_blank(b) || matches!(b, b',' | b';')).filter(|w| !w.is_empty());
        let (Some(a), Some(b)) = (parts.next(), parts.next()) else {
            let message = format!("an edge needs two vertices, got {}; add the other one", show(line));
            return Err(ReadError::line_error(bytes, start, message));
        };
        lines.ends.push([a, b]);
        if lines.ends.len() == 1 && is_header([a, b]) {
            lines.ends.clear();
            continue;
        }
        let third = parts.next();
        let weight = match third {
            // NetworkX writes a Python dictionary.
            Some(word) if word.starts_with(b"{") => in_dictionary(line),
            other => other.and_then(parse_f64),
        };
        lines.weights.push(weight);
    }
    if lines.ends.is_empty() && lines.n_vertices.is_none() {
        return Err(ReadError::line_error(bytes, bytes.len(), "the file has no edges; get the whole file"));
    }
    Ok(lines)
}

/// True for the names of the first two columns of a table of edges.
fn is_header(words: [&[u8]; 2]) -> bool {
    const NAMES: [[&str; 2]; 7] = [
        ["source", "target"],
        ["src", "dst"],
        ["from", "to"],
        ["node1", "node2"],
        ["u", "v"],
        ["i", "j"],
        ["head", "tail"],
    ];
    let plain =
        words.map(|word| word.to_ascii_lowercase().into_iter().filter(|b| *b != b'"').collect::<Vec<_>>());
    NAMES.iter().any(|names| names.map(str::as_bytes) == plain.each_ref().map(Vec::as_slice))
}

/// Number after `Nodes:` in a comment of SNAP.
fn n_nodes(line: &[u8]) -> Option<u64> {
    let lower = line.to_ascii_lowercase();
    let at = memchr::memmem::find(&lower, b"nodes:")?;
    parse_u64(crate::text::words(&line[at + 6..]).next()?)
}

/// Number after `'weight':`.
fn in_dictionary(line: &[u8]) -> Option<f64> {
    let at = memchr::memmem::find(line, b"weight")? + 7;
    let rest = line.get(at..)?;
    let colon = memchr::memchr(b':', rest)?;
    let word = rest[colon + 1..].trim_ascii_start();
    let end = word.iter().position(|b| matches!(b, b',' | b'}' | b' ')).unwrap_or(word.len());
    parse_f64(&word[..end])
}
