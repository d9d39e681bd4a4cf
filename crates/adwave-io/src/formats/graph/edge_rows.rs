//! Large lists of edges, read as a stream into sparse rows.

use std::io::BufRead;

use adwave::Progress;
use adwave::pages::zeros;
use adwave::rows::CompressedRows;

use super::edge_line::{EdgeLine, EdgeLines};
use crate::ReadError;
use crate::limits::most_numbered;
use crate::text::stream::{LONGEST_LINE, TextStream};
use crate::text::{parse_u64, show};

/// Lines between two checks for cancellation.
const LINES_AT_A_TIME: u64 = 1 << 14;

/// Rows between two checks for cancellation.
const ROWS_AT_A_TIME: usize = 4096;

/// Largest number of a node: indices have 32 bits.
const LARGEST: u64 = u32::MAX as u64 - 1;

/// A graph from a list of edges.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeRows {
    /// Symmetric weights, n_nodes × n_nodes; loops stay on the diagonal.
    pub weights: CompressedRows<f64>,
    /// Number of lines with an edge.
    pub n_edges: u64,
    /// Number of edges that repeat another, in either direction; their weights were added.
    pub n_repeated: u64,
}

/// Reads lines `u v` or `u v weight`, with nodes numbered from 0, as a stream. The graph is undirected and has as many
/// nodes as the largest number says, at least `n_nodes`. Memory: 8 bytes per edge (16 with weights) while it is read,
/// and then 24 bytes per edge of the result (56 with weights).
///
/// # Errors
/// [`ReadError`] for a line that is no edge, a weight that is negative or not finite, nodes without edges that would
/// take more memory than the file, or if the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// let list = adwave_io::read_edge_rows(&b"# a path\n0 1\n1 2 0.5\n"[..], 0, Progress::none())?;
/// assert_eq!(list.weights.row(1), ([0, 2].as_slice(), [1.0, 0.5].as_slice()));
/// # Ok::<(), adwave_io::ReadError>(())
/// ```
pub fn read_edge_rows(
    lines: impl BufRead,
    n_nodes: usize,
    progress: Progress<'_>,
) -> Result<EdgeRows, ReadError> {
    let (mut pairs, mut weights): (Vec<[u32; 2]>, Vec<f64>) = (Vec::new(), Vec::new());
    let (mut stream, mut lines, mut largest) =
        (TextStream::new(lines, LONGEST_LINE), EdgeLines::default(), 0);
    loop {
        if stream.line().is_multiple_of(LINES_AT_A_TIME) {
            progress.check()?;
        }
        let Some(text) = stream.next()? else { break };
        let parsed = lines.parse(text).and_then(|edge| edge.as_ref().map(numbered_edge).transpose());
        let Some((pair, weight)) = parsed.map_err(|message| stream.wrong(message))? else { continue };
        largest = largest.max(pair[0]).max(pair[1]);
        if weight != 1.0 && weights.is_empty() {
            weights.resize(pairs.len(), 1.0);
        }
        if weight != 1.0 || !weights.is_empty() {
            weights.push(weight);
        }
        pairs.push(pair);
    }
    let n_named = if pairs.is_empty() { 0 } else { largest as usize + 1 };
    if n_named as u64 > most_numbered(pairs.len()).max(n_nodes as u64) {
        return Err(ReadError::Whole(format!(
            "the largest number of a node is {largest}, for {} edges; number the nodes from 0 without gaps",
            pairs.len()
        )));
    }
    let n_edges = pairs.len() as u64;
    let rows = both_directions(n_nodes.max(n_named), pairs, &weights, progress)?;
    let n_repeated = n_edges - count_pairs(&rows);
    Ok(EdgeRows { weights: rows, n_edges, n_repeated })
}

/// Numbers of the ends of an edge, and its weight, 1 unless another is given.
fn numbered_edge(edge: &EdgeLine<'_>) -> Result<([u32; 2], f64), String> {
    let node = |word: &[u8]| match parse_u64(word) {
        Some(number) if number <= LARGEST => Ok(number as u32),
        _ => Err(format!("a node must be a whole number in 0..={LARGEST}, got {}; correct it", show(word))),
    };
    let weight = match edge.weight {
        None => 1.0,
        Some(Ok(weight)) if weight.is_finite() && weight >= 0.0 => weight,
        Some(other) => {
            let found = other.map_or_else(show, |weight| weight.to_string());
            return Err(format!("a weight must be a finite number of at least 0, got {found}; correct it"));
        }
    };
    Ok(([node(edge.ends[0])?, node(edge.ends[1])?], weight))
}

/// Number of different edges of a symmetric matrix: entries on and right of the diagonal.
fn count_pairs(rows: &CompressedRows<f64>) -> u64 {
    let pairs = |x: usize| {
        let columns = rows.row(x).0;
        columns.len() - columns.partition_point(|&y| (y as usize) < x)
    };
    (0..rows.n_rows()).map(|x| pairs(x) as u64).sum()
}

/// Symmetric rows of the edges. Weights of repeated edges are added in the order of the list.
fn both_directions(
    n: usize,
    pairs: Vec<[u32; 2]>,
    weights: &[f64],
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, ReadError> {
    let mut offsets = vec![0_usize; n + 1];
    for [u, v] in &pairs {
        offsets[*u as usize + 1] += 1;
        if u != v {
            offsets[*v as usize + 1] += 1;
        }
    }
    for x in 0..n {
        offsets[x + 1] += offsets[x];
    }
    progress.check()?;
    if weights.is_empty() {
        let entries = fill_rows(&offsets, &pairs, |_, y| y);
        drop(pairs);
        return unweighted_rows(offsets, entries, progress);
    }
    let entries = fill_rows(&offsets, &pairs, |edge, y| (y, weights[edge]));
    drop(pairs);
    weighted_rows(&offsets, entries, progress)
}

/// Entries of both directions of all edges, row after row, in the order of the list.
fn fill_rows<T: Copy + Default>(
    offsets: &[usize],
    pairs: &[[u32; 2]],
    entry: impl Fn(usize, u32) -> T,
) -> Vec<T> {
    let mut next = offsets.to_vec();
    let mut entries = zeros::<T>(offsets[offsets.len() - 1]);
    let mut push = |x: u32, entry: T| {
        entries[next[x as usize]] = entry;
        next[x as usize] += 1;
    };
    for (edge, &[u, v]) in pairs.iter().enumerate() {
        push(u, entry(edge, v));
        if u != v {
            push(v, entry(edge, u));
        }
    }
    entries
}

/// Rows of edges of weight 1. Columns are sorted and repeated ones removed in place, so that a large list takes 8 bytes
/// an edge and 12 bytes an entry of the result.
fn unweighted_rows(
    mut offsets: Vec<usize>,
    mut columns: Vec<u32>,
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, ReadError> {
    let n = offsets.len() - 1;
    let mut values: Vec<f64> = Vec::with_capacity(columns.len());
    let mut start = 0;
    for x in 0..n {
        if x % ROWS_AT_A_TIME == 0 {
            progress.check()?;
        }
        let row = start..offsets[x + 1];
        start = row.end;
        columns[row.clone()].sort_unstable();
        let first = values.len();
        for at in row {
            let (column, end) = (columns[at], values.len());
            match values.last_mut() {
                Some(last) if end > first && columns[end - 1] == column => *last += 1.0,
                _ => {
                    columns[end] = column;
                    values.push(1.0);
                }
            }
        }
        offsets[x + 1] = values.len();
    }
    columns.truncate(values.len());
    finish(offsets, columns, values)
}

/// Rows of weighted edges.
fn weighted_rows(
    offsets: &[usize],
    mut entries: Vec<(u32, f64)>,
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, ReadError> {
    let n = offsets.len() - 1;
    let (mut starts, mut columns) = (vec![0], Vec::with_capacity(entries.len()));
    let mut values: Vec<f64> = Vec::with_capacity(entries.len());
    for x in 0..n {
        if x % ROWS_AT_A_TIME == 0 {
            progress.check()?;
        }
        let row = &mut entries[offsets[x]..offsets[x + 1]];
        row.sort_by_key(|entry| entry.0);
        let first = columns.len();
        for &(y, w) in &*row {
            match values.last_mut() {
                Some(last) if columns.len() > first && columns.last() == Some(&y) => *last += w,
                _ => {
                    columns.push(y);
                    values.push(w);
                }
            }
        }
        starts.push(columns.len());
    }
    finish(starts, columns, values)
}

/// The square matrix of the arrays.
fn finish(
    offsets: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
) -> Result<CompressedRows<f64>, ReadError> {
    let n = offsets.len() - 1;
    CompressedRows::new(offsets, columns, values, n).map_err(|error| ReadError::Whole(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<EdgeRows, ReadError> {
        read_edge_rows(text.as_bytes(), 0, Progress::none())
    }

    #[test]
    fn edges_go_both_ways_and_repeated_ones_are_added() {
        let list = read("source target\n% a graph\n0,1\n\n2\t1 0.25\r\n1 0\n2 2 3\n").unwrap();
        assert_eq!((list.n_edges, list.n_repeated), (4, 1));
        assert_eq!(list.weights.row(0), ([1].as_slice(), [2.0].as_slice()));
        assert_eq!(list.weights.row(1), ([0, 2].as_slice(), [2.0, 0.25].as_slice()));
        assert_eq!(list.weights.row(2), ([1, 2].as_slice(), [0.25, 3.0].as_slice()));
        assert_eq!(read("").unwrap().weights.n_rows(), 0);
        for weight in ["1.2345678901234567e-05", "0.00000000000000000000000012345e20"] {
            let list = read(&format!("0 1 {weight}\n")).unwrap();
            assert_eq!(list.weights.get(0, 1), weight.parse::<f64>().unwrap());
        }
        assert_eq!(read_edge_rows(&b"0 1"[..], 5, Progress::none()).unwrap().weights.n_rows(), 5);
    }

    #[test]
    fn lines_that_are_no_edges_are_named() {
        let cases =
            ["0 1\n2", "0 1\n-1 2", "0 1\na b", "0 1\n1 2 -3", "0 1\n1 2 nan", "0 1\n1 99999999999999999999"];
        let endless = "1".repeat(1 << 17);
        for text in cases.into_iter().chain([&format!("0 1\n{endless}") as &str]) {
            let error = read(text).unwrap_err().to_string();
            assert!(error.starts_with("line 2"), "{error}");
        }
        assert!(read("0 4000000000").unwrap_err().to_string().contains("without gaps"));
    }
}
