//! Writers for graphs: TGF, list of edges and GraphML.

use std::io::Write;

use adwave::Progress;

use crate::formats::graph::{check, names_as_words};
use crate::model::grouping::column_names;
use crate::progress::report_row;
use crate::text::{escape_xml, is_blank, parse_u64, push_f64};
use crate::{Direction, Field, FieldValues, Format, ShapeFile, WriteError, WriteReport};

/// Edges with the weights of their format: if an edge represents both directions, each direction has half the weight.
struct EdgeWeights<'a> {
    shape: &'a ShapeFile,
    part: f64,
}

impl<'a> EdgeWeights<'a> {
    fn new(shape: &'a ShapeFile, report: &mut WriteReport) -> Self {
        let is_directed = shape.edges.direction == Direction::RowToColumn;
        if is_directed {
            report.report_dropped("directions of edges (half of each weight for each direction)");
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
    report.report_vertex_fields(shape, &[]);
    let is_word = |name: &str| name != "#" && !name.bytes().any(is_blank);
    let names = names_as_words(shape, is_word, report);
    let push_name = |row: usize, line: &mut Vec<u8>| match names {
        Some(names) => line.extend_from_slice(names[row].as_bytes()),
        None => line.extend_from_slice((row + 1).to_string().as_bytes()),
    };
    let weights = EdgeWeights::new(shape, report);
    let mut line = Vec::new();
    for i in 0..shape.n_vertices {
        report_row(progress, i as u64, shape.n_vertices as u64)?;
        line.clear();
        push_name(i, &mut line);
        for &x in shape.points.get(i).into_iter().flatten() {
            line.push(b' ');
            push_f64(&mut line, x);
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    out.write_all(b"#\n")?;
    for (e, [a, b]) in shape.edges.pairs.iter().enumerate() {
        report_row(progress, e as u64, shape.edges.pairs.len() as u64)?;
        line.clear();
        push_name(*a as usize, &mut line);
        line.push(b' ');
        push_name(*b as usize, &mut line);
        weights.push(e, &mut line);
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

/// Names for a list of edges, which knows vertices by their edges alone and in the order of these.
fn listed_names<'a>(shape: &'a ShapeFile, report: &mut WriteReport) -> Option<&'a [String]> {
    let mut order = Vec::new();
    let mut is_listed = vec![false; shape.n_vertices];
    for &vertex in shape.edges.pairs.as_flattened() {
        if !std::mem::replace(&mut is_listed[vertex as usize], true) {
            order.push(vertex);
        }
    }
    let names = shape.vertex_names()?;
    // Numbers are read in ascending order, words in the order of the lines.
    let numbers: Option<Vec<u64>> = names.iter().map(|name| parse_u64(name.as_bytes())).collect();
    let is_ordered = match numbers {
        Some(numbers) => numbers.is_sorted_by(|a, b| a < b),
        None => order.is_sorted(),
    };
    let is_word = |name: &str| {
        let is_mark = |b: u8| is_blank(b) || matches!(b, b',' | b';');
        is_ordered
            && order.len() == shape.n_vertices
            && !name.starts_with(['#', '%'])
            && !name.bytes().any(is_mark)
    };
    names_as_words(shape, is_word, report)
}

/// True if the field has the numbers that are the names of the vertices.
fn is_numbering(shape: &ShapeFile, field: &Field) -> bool {
    let FieldValues::U64(numbers) = &field.values else { return false };
    let names = shape.vertex_names().unwrap_or_default();
    numbers.len() == names.len()
        && numbers.iter().zip(names).all(|(number, name)| number.to_string() == *name)
}

/// Writes a list of edges after a comment with the counts, as in SNAP.
pub(crate) fn write_edge_list(
    shape: &ShapeFile,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    check(shape, Format::EDGE_LIST, report)?;
    let names = listed_names(shape, report);
    // Numbers of vertices are names and a field.
    let is_held = |name: &str| names.is_some() && shape.field(name).is_some_and(|f| is_numbering(shape, f));
    report.report_vertex_fields(shape, if is_held("id") { &["id"] } else { &[] });
    if !shape.points.is_empty() {
        report.report_dropped("coordinates");
    }
    let weights = EdgeWeights::new(shape, report);
    if names.is_none() {
        writeln!(out, "# Nodes: {} Edges: {}", shape.n_vertices, shape.edges.pairs.len())?;
    }
    let mut line = Vec::new();
    for (e, [a, b]) in shape.edges.pairs.iter().enumerate() {
        report_row(progress, e as u64, shape.edges.pairs.len() as u64)?;
        line.clear();
        match names {
            Some(names) => write!(line, "{} {}", names[*a as usize], names[*b as usize])?,
            None => write!(line, "{a} {b}")?,
        }
        weights.push(e, &mut line);
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

/// Function that appends number i.
type AppendNumber<'a> = dyn Fn(usize, &mut Vec<u8>) + 'a;

/// Vertex column: its name, its type, and a function for number i.
struct VertexColumn<'a> {
    name: String,
    kind: &'static str,
    push: Box<AppendNumber<'a>>,
}

fn columns(shape: &ShapeFile) -> Vec<VertexColumn<'_>> {
    let mut all = Vec::new();
    if !shape.points.is_empty() {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let push = Box::new(move |i: usize, out: &mut Vec<u8>| push_f64(out, shape.points[i][axis]));
            all.push(VertexColumn { name: name.into(), kind: "double", push });
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
            all.push(VertexColumn { name, kind, push });
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
    let is_kept = |name: &str| !name.chars().any(char::is_control);
    let names = names_as_words(shape, is_kept, report);
    let id = |row: usize| names.map_or_else(|| format!("n{row}"), |names| escape_xml(&names[row]));
    let direction = if edges.direction == Direction::Both { "undirected" } else { "directed" };
    writeln!(out, "<graph edgedefault=\"{direction}\">")?;
    let mut text = Vec::new();
    for i in 0..shape.n_vertices {
        report_row(progress, i as u64, shape.n_vertices as u64)?;
        text.clear();
        write!(text, "<node id=\"{}\">", id(i))?;
        for (k, column) in columns.iter().enumerate() {
            write!(text, "<data key=\"v{k}\">")?;
            (column.push)(i, &mut text);
            text.extend_from_slice(b"</data>");
        }
        text.extend_from_slice(b"</node>\n");
        out.write_all(&text)?;
    }
    for (e, [a, b]) in edges.pairs.iter().enumerate() {
        report_row(progress, e as u64, edges.pairs.len() as u64)?;
        text.clear();
        write!(text, "<edge source=\"{}\" target=\"{}\">", id(*a as usize), id(*b as usize))?;
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
