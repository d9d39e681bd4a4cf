//! Graphs: TGF, lists of edges as in SNAP and NetworkX, and GraphML.
//!
//! Library: `roxmltree` for GraphML (`petgraph` only writes it, and knows no fields); TGF and lists are a few words a
//! line.

mod edge_line;
pub(crate) mod edge_list;
pub(crate) mod edge_rows;
pub(crate) mod graphml;
pub(crate) mod tgf;
pub(crate) mod write;

use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

use std::collections::HashMap;
use std::sync::Arc;

use crate::{Direction, Edges, Format, ShapeFile, WriteError, WriteReport};

/// Rows of vertices by name.
#[derive(Default)]
pub(crate) struct VertexNames<'a> {
    rows: HashMap<&'a [u8], u32>,
}

impl<'a> VertexNames<'a> {
    /// Row of a name; a new name gets the next row.
    pub(crate) fn add(&mut self, name: &'a [u8]) -> u32 {
        let next = self.rows.len() as u32;
        *self.rows.entry(name).or_insert(next)
    }

    pub(crate) fn get(&self, name: &[u8]) -> Option<u32> {
        self.rows.get(name).copied()
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// All names in the order of their rows; `None` if they are the numbers of the rows from `first` on, or not all are
    /// UTF-8.
    pub(crate) fn to_texts(&self, first: usize) -> Option<Arc<Vec<String>>> {
        let mut texts = vec![String::new(); self.rows.len()];
        for (name, &row) in &self.rows {
            std::str::from_utf8(name).ok()?.clone_into(&mut texts[row as usize]);
        }
        names_unless_numbered(texts, "", first)
    }
}

/// Names of vertices; `None` if they only number the rows: `prefix` and a number from `first` on.
pub(crate) fn names_unless_numbered(
    names: Vec<String>,
    prefix: &str,
    first: usize,
) -> Option<Arc<Vec<String>>> {
    let is_number = |(row, name): (usize, &String)| *name == format!("{prefix}{}", first + row);
    let is_numbered = names.iter().enumerate().all(is_number);
    (!is_numbered).then(|| Arc::new(names))
}

/// Names of the vertices, if all can stand in a line of words and none is empty or repeated; others are reported.
pub(crate) fn names_as_words<'a>(
    shape: &'a ShapeFile,
    is_word: impl Fn(&str) -> bool,
    report: &mut WriteReport,
) -> Option<&'a [String]> {
    let names = shape.vertex_names()?;
    let is_usable =
        names.len() == shape.n_vertices && names.iter().all(|name| !name.is_empty() && is_word(name));
    if !is_usable {
        report.report_dropped("names of vertices");
    }
    is_usable.then_some(names)
}

/// Builds edges; they have weights if every edge has one.
pub(crate) fn edges(pairs: Vec<[u32; 2]>, weights: Vec<Option<f64>>, direction: Direction) -> Edges {
    let weights: Option<Vec<f64>> = weights.into_iter().collect();
    Edges { pairs, weights: weights.unwrap_or_default(), direction }
}

/// Checks that there are edges to write, and reports content that a graph cannot store.
pub(crate) fn check(shape: &ShapeFile, format: Format, report: &mut WriteReport) -> Result<(), WriteError> {
    if shape.edges.pairs.is_empty() && !shape.points.is_empty() {
        let what = "a shape without edges of its own".into();
        return Err(WriteError::CannotHold { format, what });
    }
    if !shape.faces.is_empty() {
        report.report_dropped("faces");
    }
    report.report_face_fields(shape, &[]);
    Ok(())
}

impl Format {
    /// Trivial graph format.
    pub const TGF: Self = Self::new("tgf");
    /// List of edges as written by SNAP and NetworkX.
    pub const EDGE_LIST: Self = Self::new("edgelist");
    /// GraphML.
    pub const GRAPHML: Self = Self::new("graphml");
}

pub(crate) static TGF: FormatDescriptor = FormatDescriptor {
    format: Format::TGF,
    title: "Trivial graph format",
    extensions: &["tgf"],
    reads: "graphs; labels of three numbers as points, labels of edges as weights; names of vertices",
    writes: "points, edges with weights, names of vertices",
    loses: "faces, fields, other labels",
    content: ContentKind::Graph,
    holds_names: true,
    recognize: |file| (file.is_named(&TGF) && file.is_text()).then_some(Evidence::NameAlone),
    has_lines: |_| true,
    read: Some(|bytes, c| tgf::read_tgf(&bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_tgf(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.tgf", bytes: include_bytes!("samples/a.tgf") }],
    ..FormatDescriptor::NEW
};

pub(crate) static EDGE_LIST: FormatDescriptor = FormatDescriptor {
    format: Format::EDGE_LIST,
    title: "list of edges",
    extensions: &["edgelist", "edges", "el"],
    reads: "graphs, as SNAP and NetworkX write them; weights; names of vertices",
    writes: "edges with weights, names of vertices unless some have no edge",
    loses: "points, faces, fields",
    content: ContentKind::Graph,
    holds_names: true,
    recognize: |file| (file.is_named(&EDGE_LIST) && file.is_text()).then_some(Evidence::NameAlone),
    has_lines: |_| true,
    read: Some(|bytes, c| edge_list::read_edge_list(&bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_edge_list(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.edges", bytes: include_bytes!("samples/a.edges") }],
    ..FormatDescriptor::NEW
};

pub(crate) static GRAPHML: FormatDescriptor = FormatDescriptor {
    format: Format::GRAPHML,
    title: "GraphML",
    extensions: &["graphml"],
    reads: "graphs; points from `x`, `y`, `z` or `pos`, weights, ids, numeric node attributes as \
            fields",
    writes: "points, edges with weights, ids of nodes, vertex fields",
    loses: "faces, text attributes of nodes, other attributes of edges",
    content: ContentKind::Graph,
    holds_fields: true,
    holds_names: true,
    recognize: |file| file.has_element("graphml").then_some(Evidence::Signature),
    read: Some(|bytes, c| graphml::read_graphml(bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_graphml(shape, &mut c.report, c.out, c.progress)),
    samples: &[SampleFile { name: "a.graphml", bytes: include_bytes!("samples/a.graphml") }],
    ..FormatDescriptor::NEW
};
