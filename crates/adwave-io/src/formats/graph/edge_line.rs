//! Lines of a list of edges: two names per line and an optional weight; `#` and `%` begin comments.

use crate::text::{is_blank, parse_f64, parse_u64, show};

/// An edge as it stands in a line.
pub(super) struct EdgeLine<'a> {
    /// Names of the ends of the edge.
    pub(super) ends: [&'a [u8]; 2],
    /// Weight of the edge, or the word in the place of one; `None` without such a word.
    pub(super) weight: Option<Result<f64, &'a [u8]>>,
}

/// Parser of the lines of a list, one after another.
#[derive(Default)]
pub(super) struct EdgeLines {
    /// Number of edges so far.
    pub(super) n_edges: u64,
    /// Number of vertices stated in a comment.
    pub(super) n_vertices: Option<u64>,
}

impl EdgeLines {
    /// The edge of the next line, which has no blanks at its ends; `None` for comments, headers and empty lines.
    pub(super) fn parse<'a>(&mut self, line: &'a [u8]) -> Result<Option<EdgeLine<'a>>, String> {
        if line.is_empty() {
            return Ok(None);
        }
        if matches!(line[0], b'#' | b'%') {
            self.n_vertices = self.n_vertices.or_else(|| n_nodes(line));
            return Ok(None);
        }
        let mut parts = line.split(|&b| is_blank(b) || matches!(b, b',' | b';')).filter(|w| !w.is_empty());
        let (Some(a), Some(b)) = (parts.next(), parts.next()) else {
            return Err(format!("an edge needs two vertices, got {}; add the other one", show(line)));
        };
        let ends = [a, b];
        if self.n_edges == 0 && is_header(ends) {
            return Ok(None);
        }
        self.n_edges += 1;
        let weight = match parts.next() {
            // NetworkX writes a Python dictionary.
            Some(word) if word.starts_with(b"{") => in_dictionary(line).map(Ok),
            other => other.map(|word| parse_f64(word).ok_or(word)),
        };
        Ok(Some(EdgeLine { ends, weight }))
    }
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
