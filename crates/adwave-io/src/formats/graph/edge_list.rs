//! Lists of edges as shapes.

use adwave::Progress;

use crate::formats::graph::edge_line::EdgeLines;
use crate::formats::graph::{VertexNames, names_unless_numbered};
use crate::limits::most_numbered;
use crate::progress::report_row;
use crate::text::{line_end, parse_u64};
use crate::{Direction, Edges, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Edges between numbered vertices, 8 bytes each (16 with weights).
struct NumberedEdges {
    pairs: Vec<[u32; 2]>,
    /// One weight per edge; empty if an edge has none.
    weights: Vec<f64>,
    /// Number of vertices stated in a comment.
    n_vertices: Option<u64>,
}

/// Reads a graph. Vertices named by integers are in ascending order, others in the order of the file.
pub(crate) fn read_edge_list(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let (n_vertices, pairs, names, texts, weights);
    if let Some(mut numbered) = read_numbered(bytes, progress)? {
        let limit = most_numbered(bytes.len());
        let largest = numbered.pairs.as_flattened().iter().copied().max();
        let named = numbered
            .n_vertices
            .filter(|&n| n <= limit && largest.is_none_or(|largest| u64::from(largest) < n));
        let distinct = if named.is_some() {
            Vec::new()
        } else {
            number_from_zero(&mut numbered.pairs, largest.unwrap_or(0), progress)?
        };
        n_vertices = named.unwrap_or(distinct.len() as u64);
        (texts, names) = id_names(distinct.into_iter().map(u64::from).collect());
        (pairs, weights) = (numbered.pairs, numbered.weights);
    } else {
        let (mut ends, mut given) = (Vec::new(), Some(Vec::new()));
        visit_edges(bytes, progress, |pair, weight| {
            ends.push(pair);
            push_weight(&mut given, weight);
            ControlFlow::Continue(())
        })?;
        let numbers: Option<Vec<u64>> = ends.as_flattened().iter().map(|w| parse_u64(w)).collect();
        if let Some(numbers) = numbers {
            let mut distinct = numbers.clone();
            distinct.sort_unstable();
            distinct.dedup();
            let place = |x: u64| distinct.binary_search(&x).unwrap_or(0) as u32;
            pairs = numbers.as_chunks::<2>().0.iter().map(|pair| pair.map(place)).collect();
            n_vertices = distinct.len() as u64;
            (texts, names) = id_names(distinct);
        } else {
            let mut rows = VertexNames::default();
            let mut named = Vec::with_capacity(ends.len());
            for (row, ends) in ends.iter().enumerate() {
                report_row(progress, row as u64, ends.len() as u64)?;
                named.push(ends.map(|name| rows.add(name)));
            }
            (pairs, n_vertices) = (named, rows.len() as u64);
            (texts, names) = (rows.to_texts(0), None);
        }
        weights = given.unwrap_or_default();
    }
    limits.check_points(n_vertices)?;
    let edges = Edges { pairs, weights, direction: Direction::Both };
    let mut shape = ShapeFile::from_graph(n_vertices as usize, edges);
    shape.vertex_fields.extend(names);
    shape.vertex_names = texts;
    shape.format = Some(Format::EDGE_LIST);
    Ok(shape)
}

/// Names of vertices, and the numbers that they have in the file, ascending, as a field; none if these are 0, 1, …
fn id_names(distinct: Vec<u64>) -> (Option<Arc<Vec<String>>>, Option<Field>) {
    if distinct.last().is_none_or(|&largest| largest < distinct.len() as u64) {
        return (None, None);
    }
    let texts = names_unless_numbered(distinct.iter().map(u64::to_string).collect(), "", 0);
    (texts, Some(Field::new("id", 1, FieldValues::U64(distinct))))
}

/// Adds the weight of an edge; all weights are dropped as soon as an edge has none.
fn push_weight(weights: &mut Option<Vec<f64>>, weight: Option<f64>) {
    *weights = weights.take().zip(weight).map(|(mut weights, weight)| {
        weights.push(weight);
        weights
    });
}

/// The edges, if every vertex is a number of 32 bits.
fn read_numbered(bytes: &[u8], progress: Progress<'_>) -> Result<Option<NumberedEdges>, ReadError> {
    let (mut pairs, mut weights, mut is_numbered) = (Vec::new(), Some(Vec::new()), true);
    let n_vertices = visit_edges(bytes, progress, |[a, b], weight| {
        let number = |word: &[u8]| parse_u64(word).and_then(|number| u32::try_from(number).ok());
        let (Some(a), Some(b)) = (number(a), number(b)) else {
            is_numbered = false;
            return ControlFlow::Break(());
        };
        pairs.push([a, b]);
        push_weight(&mut weights, weight);
        ControlFlow::Continue(())
    })?;
    Ok(is_numbered.then(|| NumberedEdges { pairs, weights: weights.unwrap_or_default(), n_vertices }))
}

/// Replaces the numbers in `pairs` by their ranks, and returns the different numbers in ascending order.
fn number_from_zero(
    pairs: &mut [[u32; 2]],
    largest: u32,
    progress: Progress<'_>,
) -> Result<Vec<u32>, ReadError> {
    let ends = pairs.as_flattened_mut();
    let n_ends = ends.len() as u64;
    let report = |at: usize| report_row(progress, at as u64, n_ends);
    if u64::from(largest) > 64 * n_ends {
        let mut distinct = ends.to_vec();
        distinct.sort_unstable();
        distinct.dedup();
        for (at, end) in ends.iter_mut().enumerate() {
            report(at)?;
            *end = distinct.binary_search(end).unwrap_or(0) as u32;
        }
        return Ok(distinct);
    }
    // A bit for each number, and the count of those before each word of bits.
    let mut words = vec![0_u64; if n_ends > 0 { largest as usize / 64 + 1 } else { 0 }];
    for (at, &mut end) in ends.iter_mut().enumerate() {
        report(at)?;
        words[end as usize / 64] |= 1 << (end % 64);
    }
    let (mut distinct, mut before) = (Vec::new(), Vec::with_capacity(words.len()));
    for (first, &word) in (0_u32..).step_by(64).zip(&words) {
        before.push(distinct.len() as u32);
        let mut left = word;
        while left != 0 {
            distinct.push(first + left.trailing_zeros());
            left &= left - 1;
        }
    }
    if distinct.len() as u64 <= u64::from(largest) {
        for (at, end) in ends.iter_mut().enumerate() {
            report(at)?;
            let (word, bit) = (*end as usize / 64, *end % 64);
            *end = before[word] + (words[word] & ((1 << bit) - 1)).count_ones();
        }
    }
    Ok(distinct)
}

/// Calls `visit` with the ends and the weight of each edge until it breaks. Returns the number of vertices that a
/// comment states.
fn visit_edges<'a>(
    bytes: &'a [u8],
    progress: Progress<'_>,
    mut visit: impl FnMut([&'a [u8]; 2], Option<f64>) -> ControlFlow<()>,
) -> Result<Option<u64>, ReadError> {
    let mut lines = EdgeLines::default();
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    while position < bytes.len() {
        report_row(progress, lines.n_edges, 0)?;
        let start = position;
        let end = line_end(bytes, start);
        position = end + 1;
        let edge = lines
            .parse(bytes[start..end].trim_ascii())
            .map_err(|message| ReadError::line_error(bytes, start, message))?;
        let Some(edge) = edge else { continue };
        if visit(edge.ends, edge.weight.and_then(Result::ok)).is_break() {
            return Ok(lines.n_vertices);
        }
    }
    if lines.n_edges == 0 && lines.n_vertices.is_none() {
        return Err(ReadError::line_error(bytes, bytes.len(), "the file has no edges; get the whole file"));
    }
    Ok(lines.n_vertices)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> ShapeFile {
        read_edge_list(text.as_bytes(), &ReadLimits::default(), Progress::none()).unwrap()
    }

    /// Numbers of the vertices in the file, if they are not 0, 1, …
    fn ids(shape: &ShapeFile) -> Option<Vec<u64>> {
        match &shape.vertex_fields.first()?.values {
            FieldValues::U64(ids) => Some(ids.clone()),
            _ => None,
        }
    }

    #[test]
    fn numbers_with_gaps_are_ranked_whatever_their_size() {
        let path = read("0 1\n1 2\n");
        assert_eq!((path.edges.pairs.clone(), ids(&path)), (vec![[0, 1], [1, 2]], None));
        // Few gaps (bits), large gaps (sorted), and numbers of more than 32 bits.
        for (a, b, c) in [(3_u64, 64, 200), (7, 1_000_000, 4_000_000_000), (5, 1 << 33, 1 << 60)] {
            let shape = read(&format!("source target\n{c} {a}\n{b} {c}\n{a} {a}\n"));
            assert_eq!(shape.edges.pairs, [[2, 0], [1, 2], [0, 0]]);
            assert_eq!((shape.n_vertices(), ids(&shape)), (3, Some(vec![a, b, c])));
            let texts: Vec<String> = [a, b, c].iter().map(u64::to_string).collect();
            assert_eq!(shape.vertex_names().map(<[String]>::to_vec), Some(texts));
        }
    }

    #[test]
    fn many_numbers_with_gaps_agree_with_a_search() {
        let number = |i: u64| (i * i * 31 + 7 * i) % 5000 * 3 + 2;
        let ends: Vec<u64> = (0..2000).map(number).collect();
        let text: String = ends.chunks(2).map(|pair| format!("{} {}\n", pair[0], pair[1])).collect();
        let (shape, mut distinct) = (read(&text), ends.clone());
        distinct.sort_unstable();
        distinct.dedup();
        let ranks: Vec<u32> = ends.iter().map(|x| distinct.binary_search(x).unwrap() as u32).collect();
        assert_eq!(shape.edges.pairs.as_flattened(), ranks);
        assert_eq!(ids(&shape), Some(distinct));
    }

    #[test]
    fn a_stated_number_of_vertices_and_weights_of_all_edges_are_kept() {
        let shape = read("# Nodes: 9 Edges: 2\n8 1 0.5\n1 2 3\n");
        assert_eq!((shape.n_vertices(), ids(&shape)), (9, None));
        assert_eq!(shape.edges.weights, [0.5, 3.0]);
        assert!(read("8 1 0.5\n1 2\n").edges.weights.is_empty());
        let named = read("a b 1\nb c 2\n");
        assert_eq!((named.n_vertices(), named.edges.weights), (3, vec![1.0, 2.0]));
    }
}
