//! Writers for graphs: TGF, list of edges and GraphML.

use std::io::Write;

use adwave::Progress;

use crate::formats::graph::check;
use crate::model::grouping::column_names;
use crate::progress::at_row;
use crate::text::{escape_xml, push_f64};
use crate::{Direction, FieldValues, Format, ShapeFile, WriteError, WriteReport};

/// Edges with the weights of their format: if an edge represents both directions, each direction has half the weight.
struct Weights<'a> {
    shape: &'a ShapeFile,
    part: f64,
}

impl<'a> Weights<'a> {
    fn of(shape: &'a ShapeFile, report: &mut WriteReport) -> Self {
        let is_directed = shape.edges.direction == Direction::RowToColumn;
        if is_directed {
            report.leave_out("directions of edges (half of each weight for each direction)");
        }
        Self { shape, part: if is_directed { 0.5 } else { 1.0 } }
    }

    /// Appends a blank and the weight if the edge has one.
    fn push(&self, edge: usize, out: &mut Vec<u8>) {
        let weight = self.shape.edges.weights.get(edge).copied();
        if weight.is_some() || self.part != 1.0 {
            out.push(b' ');
            push_f64(out, self.part * weight.unwrap_or(1.0));
        }
    }
}

/// Writes a TGF: coordinates as labels of the vertices, weights as those of the edges.
pub(crate) fn write_tgf(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    check(shape, Format::TGF, report)?;
    report.leave_vertex_fields(shape, &[]);
    let weights = Weights::of(shape, report);
    let mut line = Vec::new();
    for i in 0..shape.n_vertices {
        at_row(progress, i as u64, shape.n_vertices as u64)?;
        line.clear();
        write!(line, "{}", i + 1)?;
        for &x in shape.points.get(i).into_iter().flatten() {
            line.push(b' ');
            push_f64(&mut line, x);
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    out.write_all(b"#\n")?;
    for (e, [a, b]) in shape.edges.pairs.iter().enumerate() {
        at_row(progress, e as u64, shape.edges.pairs.len() as u64)?;
        line.clear();
        write!(line, "{} {}", u64::from(*a) + 1, u64::from(*b) + 1)?;
        weights.push(e, &mut line);
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

/// Writes a list of edges after a comment with the counts, as in SNAP.
pub(crate) fn write_edge_list(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    check(shape, Format::EDGE_LIST, report)?;
    report.leave_vertex_fields(shape, &[]);
    if !shape.points.is_empty() {
        report.leave_out("coordinates");
    }
    let weights = Weights::of(shape, report);
    writeln!(out, "# Nodes: {} Edges: {}", shape.n_vertices, shape.edges.pairs.len())?;
    let mut line = Vec::new();
    for (e, [a, b]) in shape.edges.pairs.iter().enumerate() {
        at_row(progress, e as u64, shape.edges.pairs.len() as u64)?;
        line.clear();
        write!(line, "{a} {b}")?;
        weights.push(e, &mut line);
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

/// Function that appends number i.
type Push<'a> = dyn Fn(usize, &mut Vec<u8>) + 'a;

/// Vertex column: its name, its type, and a function for number i.
struct Column<'a> {
    name: String,
    kind: &'static str,
    push: Box<Push<'a>>,
}

fn columns(shape: &ShapeFile) -> Vec<Column<'_>> {
    let mut all = Vec::new();
    if !shape.points.is_empty() {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let push = Box::new(move |i: usize, out: &mut Vec<u8>| push_f64(out, shape.points[i][axis]));
            all.push(Column { name: name.into(), kind: "double", push });
        }
    }
    for field in &shape.vertex_fields {
        let kind = match field.values {
            FieldValues::U32(_) | FieldValues::U64(_) | FieldValues::I64(_) => "long",
            FieldValues::F32(_) => "float",
            FieldValues::F64(_) => "double",
            _ => "int",
        };
        for (c, name) in column_names(field).into_iter().enumerate() {
            let push = Box::new(move |i: usize, out: &mut Vec<u8>| {
                field.values.write_text(i * field.n_channels + c, out);
            });
            all.push(Column { name, kind, push });
        }
    }
    all
}

/// Writes a GraphML with coordinates and all vertex fields.
pub(crate) fn write_graphml(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    check(shape, Format::GRAPHML, report)?;
    out.write_all(
        b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
    )?;
    let columns = columns(shape);
    for (k, column) in columns.iter().enumerate() {
        let name = escape_xml(&column.name);
        let kind = column.kind;
        writeln!(out, "<key id=\"v{k}\" for=\"node\" attr.name=\"{name}\" attr.type=\"{kind}\"/>")?;
    }
    let edges = &shape.edges;
    if !edges.weights.is_empty() {
        writeln!(out, "<key id=\"w\" for=\"edge\" attr.name=\"weight\" attr.type=\"double\"/>")?;
    }
    let direction = if edges.direction == Direction::Both { "undirected" } else { "directed" };
    writeln!(out, "<graph edgedefault=\"{direction}\">")?;
    let mut text = Vec::new();
    for i in 0..shape.n_vertices {
        at_row(progress, i as u64, shape.n_vertices as u64)?;
        text.clear();
        write!(text, "<node id=\"n{i}\">")?;
        for (k, column) in columns.iter().enumerate() {
            write!(text, "<data key=\"v{k}\">")?;
            (column.push)(i, &mut text);
            text.extend_from_slice(b"</data>");
        }
        text.extend_from_slice(b"</node>\n");
        out.write_all(&text)?;
    }
    for (e, [a, b]) in edges.pairs.iter().enumerate() {
        at_row(progress, e as u64, edges.pairs.len() as u64)?;
        text.clear();
        write!(text, "<edge source=\"n{a}\" target=\"n{b}\">")?;
        if let Some(&weight) = edges.weights.get(e) {
            text.extend_from_slice(b"<data key=\"w\">");
            push_f64(&mut text, weight);
            text.extend_from_slice(b"</data>");
        }
        text.extend_from_slice(b"</edge>\n");
        out.write_all(&text)?;
    }
    out.write_all(b"</graph>\n</graphml>\n")?;
    Ok(())
}
