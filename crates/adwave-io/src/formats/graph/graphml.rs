//! GraphML reader: XML with nodes, edges and their attributes.

use std::collections::HashMap;

use adwave::Progress;
use roxmltree::Node;

use crate::formats::graph::{edges, names_unless_numbered};
use crate::model::grouping::group;
use crate::progress::report_row;
use crate::text::xml::{children, parse, wrong};
use crate::text::{parse_f64, show};
use crate::{Direction, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Meaning of a key.
struct AttributeKey<'a> {
    name: &'a str,
    kind: &'a str,
    default: Option<&'a str>,
}

/// Values of one node attribute read so far.
struct NodeColumn {
    name: String,
    kind: String,
    default: f64,
    values: Vec<f64>,
}

/// Reads a graph: weights from the attribute `weight`, positions from `x`, `y` and `z` or from `pos`, other numbers
/// as fields.
pub(crate) fn read_graphml(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let broken = |e: std::string::FromUtf8Error| {
        let at = e.utf8_error().valid_up_to();
        ReadError::line_error(e.as_bytes(), at, "the text must be UTF-8; save it as UTF-8")
    };
    let text = crate::text::encoding::to_utf8(bytes).map_err(broken)?;
    let document = parse(&text)?;
    let root = document.root_element();
    let mut keys = HashMap::new();
    for key in children(root, "key") {
        let Some(id) = key.attribute("id") else { continue };
        let name = key.attribute("attr.name").unwrap_or(id);
        let default = children(key, "default").next().and_then(|d| d.text()).map(str::trim);
        keys.insert(id, AttributeKey { name, kind: key.attribute("attr.type").unwrap_or("string"), default });
    }
    let Some(graph) = children(root, "graph").next() else {
        return Err(wrong(root, "the GraphML has no graph; get the whole file"));
    };
    let is_directed = graph.attribute("edgedefault") == Some("directed");
    let mut nodes = GraphNodes::default();
    for (row, node) in children(graph, "node").enumerate() {
        report_row(progress, row as u64, 0)?;
        nodes.add(node, &keys)?;
    }
    limits.check_points(nodes.n as u64)?;
    let (mut pairs, mut weights) = (Vec::new(), Vec::new());
    for (row, edge) in children(graph, "edge").enumerate() {
        report_row(progress, row as u64, 0)?;
        let mut pair = [0; 2];
        for (end, name) in pair.iter_mut().zip(["source", "target"]) {
            let id = edge.attribute(name).unwrap_or("");
            *end = nodes.rows.get(id).copied().ok_or_else(|| {
                wrong(
                    edge,
                    format!("an edge names node {}, which does not exist; add it", show(id.as_bytes())),
                )
            })?;
        }
        pairs.push(pair);
        weights.push(weight(edge, &keys));
    }
    let default = keys.values().find(|k| k.name == "weight").and_then(|k| k.default);
    if weights.iter().any(Option::is_some) {
        let default = default.and_then(|d| parse_f64(d.as_bytes())).unwrap_or(1.0);
        for weight in &mut weights {
            *weight = weight.or(Some(default));
        }
    }
    let direction = if is_directed { Direction::RowToColumn } else { Direction::Both };
    let mut shape = ShapeFile::from_graph(nodes.n, edges(pairs, weights, direction));
    shape.format = Some(Format::GRAPHML);
    let mut names = vec![String::new(); nodes.n];
    for (id, &row) in &nodes.rows {
        (*id).clone_into(&mut names[row as usize]);
    }
    shape.vertex_names = names_unless_numbered(names, "n", 0);
    nodes.attach(&mut shape, progress)?;
    if document.descendants().any(|n| n.has_tag_name("hyperedge") || n.has_tag_name("port")) {
        shape.extras.push("hyperedges and ports".into());
    }
    Ok(shape)
}

fn weight(edge: Node<'_, '_>, keys: &HashMap<&str, AttributeKey<'_>>) -> Option<f64> {
    let data = children(edge, "data")
        .find(|data| data.attribute("key").and_then(|k| keys.get(k)).is_some_and(|k| k.name == "weight"))?;
    parse_f64(data.text()?.trim().as_bytes())
}

/// Nodes read so far.
#[derive(Default)]
struct GraphNodes<'a> {
    n: usize,
    rows: HashMap<&'a str, u32>,
    columns: Vec<NodeColumn>,
    positions: Vec<[f64; 3]>,
    has_text: bool,
    /// Number of values in the file.
    n_values: usize,
}

impl<'a> GraphNodes<'a> {
    fn add(&mut self, node: Node<'a, '_>, keys: &HashMap<&str, AttributeKey<'_>>) -> Result<(), ReadError> {
        let id = node.attribute("id").unwrap_or("");
        if self.rows.insert(id, self.n as u32).is_some() {
            return Err(wrong(node, format!("node {} occurs twice; rename one", show(id.as_bytes()))));
        }
        let row = self.n;
        self.n += 1;
        for data in children(node, "data") {
            let Some(key) = data.attribute("key").and_then(|k| keys.get(k)) else { continue };
            let text = data.text().unwrap_or("").trim();
            if key.name == "pos"
                && let Some(point) = position(text)
            {
                if self.positions.len() == row {
                    self.positions.push(point);
                }
                continue;
            }
            let value = match (key.kind, text) {
                ("boolean", "true" | "True" | "1") => Some(1.0),
                ("boolean", _) => Some(0.0),
                ("string", _) => None,
                _ => parse_f64(text.as_bytes()),
            };
            let Some(value) = value else {
                self.has_text = true;
                continue;
            };
            let at = self.columns.iter().position(|c| c.name == key.name).unwrap_or_else(|| {
                let default = key.default.and_then(|d| parse_f64(d.as_bytes())).unwrap_or(f64::NAN);
                let (name, kind) = (key.name.to_owned(), key.kind.to_owned());
                self.columns.push(NodeColumn { name, kind, default, values: Vec::new() });
                self.columns.len() - 1
            });
            let column = &mut self.columns[at];
            if column.values.len() <= row {
                column.values.resize(row, column.default);
                column.values.push(value);
            }
            self.n_values += 1;
        }
        // A column with few values must not allocate memory at every node.
        if row.saturating_mul(self.columns.len()) > 1_000_000 + 64 * self.n_values {
            return Err(wrong(
                node,
                "an attribute must be present at most of the nodes; add it to all of them",
            ));
        }
        Ok(())
    }

    fn attach(mut self, shape: &mut ShapeFile, progress: Progress<'_>) -> Result<(), ReadError> {
        let n = self.n;
        for column in &mut self.columns {
            column.values.resize(n, column.default);
        }
        let axis = |name: &str| {
            self.columns.iter().position(|c| c.name == name && c.values.iter().all(|x| !x.is_nan()))
        };
        if n > 0 && self.positions.len() == n {
            shape.points = self.positions.into();
        } else if let (Some(x), Some(y), true) = (axis("x"), axis("y"), n > 0) {
            let z = axis("z");
            let value = |c: Option<usize>, i: usize| c.map_or(0.0, |c| self.columns[c].values[i]);
            shape.points = (0..n)
                .map(|i| [value(Some(x), i), value(Some(y), i), value(z, i)])
                .collect::<Vec<_>>()
                .into();
            let mut used = [Some(x), Some(y), z].into_iter().flatten().collect::<Vec<_>>();
            used.sort_unstable();
            used.iter().rev().for_each(|&c| drop(self.columns.remove(c)));
        }
        if self.has_text {
            shape.extras.push("texts of nodes".into());
        }
        let columns = self.columns.into_iter().map(|c| (c.name, typed(&c.kind, c.values))).collect();
        shape.vertex_fields = group(columns, progress)?.0;
        Ok(())
    }
}

/// Numbers in the type that the key names, if they fit it.
fn typed(kind: &str, values: Vec<f64>) -> FieldValues {
    let is_whole = |from: f64, to: f64| values.iter().all(|x| x.fract() == 0.0 && (from..=to).contains(x));
    match kind {
        "boolean" if is_whole(0.0, 1.0) => FieldValues::U8(values.iter().map(|&x| x as u8).collect()),
        "int" if is_whole(i32::MIN.into(), i32::MAX.into()) => {
            FieldValues::I32(values.iter().map(|&x| x as i32).collect())
        }
        "float" => FieldValues::F32(values.iter().map(|&x| x as f32).collect()),
        _ => FieldValues::F64(values),
    }
}

/// Two or three numbers, with or without brackets or quotes.
fn position(text: &str) -> Option<[f64; 3]> {
    let separators =
        |c: char| c.is_whitespace() || matches!(c, '[' | ']' | '(' | ')' | ',' | '"' | '\'' | '!');
    let numbers: Option<Vec<f64>> =
        text.split(separators).filter(|w| !w.is_empty()).map(|w| parse_f64(w.as_bytes())).collect();
    // A position that is not a number is missing.
    let numbers = numbers.filter(|numbers| !numbers.iter().any(|x| x.is_nan()));
    match numbers?[..] {
        [x, y] => Some([x, y, 0.0]),
        [x, y, z] => Some([x, y, z]),
        _ => None,
    }
}
