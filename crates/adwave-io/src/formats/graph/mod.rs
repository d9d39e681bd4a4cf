//! Graphs: TGF, lists of edges as in SNAP and NetworkX, and GraphML.
//!
//! TGF and lists of edges have their own readers, as a line is only a few words; GraphML is read with `roxmltree`
//! (`petgraph` only writes it, without fields).

pub(crate) mod edge_list;
pub(crate) mod graphml;
pub(crate) mod tgf;
pub(crate) mod write;

use std::collections::HashMap;

use crate::{Direction, Edges, Format, ShapeFile, WriteError, WriteReport};

/// Rows of vertices by name.
#[derive(Default)]
pub(crate) struct Names<'a> {
    rows: HashMap<&'a [u8], u32>,
}

impl<'a> Names<'a> {
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
        report.leave_out("faces");
    }
    report.leave_face_fields(shape, &[]);
    Ok(())
}
