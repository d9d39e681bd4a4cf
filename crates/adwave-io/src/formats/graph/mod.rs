//! Graphs: TGF, lists of edges as of SNAP and NetworkX, and GraphML.
//!
//! Own readers of TGF and lists, which are a few words a line; GraphML by `roxmltree` (`petgraph` only writes it, and knows no fields).

pub(crate) mod edge_list;
pub(crate) mod graphml;
pub(crate) mod tgf;
pub(crate) mod write;

use std::collections::HashMap;

use crate::{Direction, Edges, Format, ShapeFile, WriteError, WriteReport};

/// Names of vertices and their rows.
#[derive(Default)]
pub(crate) struct Names<'a> {
    rows: HashMap<&'a [u8], u32>,
}

impl<'a> Names<'a> {
    /// The row of a name, which is a new one where it was not there.
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

/// Edges with their weights where every one has one.
pub(crate) fn edges(pairs: Vec<[u32; 2]>, weights: Vec<Option<f64>>, direction: Direction) -> Edges {
    let weights: Option<Vec<f64>> = weights.into_iter().collect();
    Edges { pairs, weights: weights.unwrap_or_default(), direction }
}

/// Refuses what has no edges to write, and names what a graph is without.
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
