//! Subdivision rules: weights of the coarse vertices at midpoints, and weights of the neighbors at Loop's coarse
//! vertices.

use crate::hierarchy::HierarchyLevel;
use crate::rows::{Entry, RowBuilder};
use crate::topology::{NONE, Topology};
use adwave::rows::CompressedRows;
use std::f64::consts::TAU;

/// Number of neighbors above which butterfly subdivision treats a vertex as regular, and updates do not extend over its
/// ring: each of its edges would have as many weights as the vertex has neighbors.
const MAX_RING: usize = 32;

/// Weights of the coarse vertices at each midpoint for linear subdivision: one half for each end of the edge.
pub(crate) fn linear(level: &HierarchyLevel) -> CompressedRows<f64> {
    let mut rows = RowBuilder::new();
    let mut entries = Vec::new();
    for pair in &level.parents {
        entries.extend(pair.map(|column| Entry { column, value: 0.5 }));
        rows.push_row(&mut entries);
    }
    rows.finish(level.topology.n_vertices)
}

/// Weights of the coarse vertices at each midpoint for Loop subdivision (`loop1987`): 3/8 for the ends of the edge and
/// 1/8 for the corners opposite the edge; on a border one half for each end.
pub(crate) fn loop_midpoints(level: &HierarchyLevel) -> CompressedRows<f64> {
    midpoint_rows(level, |topology, half_edge, entries| {
        let ends = topology.ends(half_edge);
        let Some(across) = topology.apex_across(half_edge) else {
            entries.extend(ends.map(|column| Entry { column, value: 0.5 }));
            return;
        };
        entries.extend(ends.map(|column| Entry { column, value: 0.375 }));
        let apexes = [topology.apex(half_edge), across];
        entries.extend(apexes.map(|column| Entry { column, value: 0.125 }));
    })
}

/// Weights of the neighbors at each coarse vertex after Loop subdivision. The weight of the vertex itself is 1 minus
/// their sum. Rows of vertices in parts without a coarser level are empty.
///
/// Inside: β = (5/8 − (3/8 + cos(2π/n)/4)²)/n for each of the n neighbors (`loop1987`); on a border 1/8 for each
/// neighbor along the border.
pub(crate) fn loop_neighbors(level: &HierarchyLevel) -> CompressedRows<f64> {
    let topology = &level.topology;
    let mut is_active = vec![false; topology.n_vertices];
    for pair in &level.parents {
        is_active[pair[0] as usize] = true;
        is_active[pair[1] as usize] = true;
    }
    let mut rows = RowBuilder::new();
    let mut entries = Vec::new();
    for v in 0..topology.n_vertices as u32 {
        if is_active[v as usize] {
            let is_border = topology.is_border(v);
            let n = topology.n_neighbors(v) as f64;
            let inner = 0.375 + 0.25 * (TAU / n).cos();
            let value = if is_border { 0.125 } else { (0.625 - inner * inner) / n };
            let along = |half_edge: u32| topology.twins[half_edge as usize] == NONE;
            let ring = topology.ring(v).filter(|spoke| !is_border || along(spoke.half_edge));
            entries.extend(ring.map(|spoke| Entry { column: spoke.neighbor, value }));
        }
        rows.push_row(&mut entries);
    }
    rows.finish(level.topology.n_vertices)
}

/// Weights of the coarse vertices at each midpoint for modified butterfly subdivision (`zorin1996`).
///
/// - Both ends regular: 1/2 for the ends, 1/8 for the opposite corners, −1/16 for the corners of the four faces beyond.
///   A corner that is missing beyond a border is replaced by the reflection of the corner opposite it.
/// - An irregular end inside the surface: the weights of its ring; with two irregular ends, the mean of both.
/// - On a border: 9/16 for the ends and −1/16 for the next vertices along the border. Beyond an end without four
///   neighbors, a corner, the next vertex is replaced by the reflection of the other end.
pub(crate) fn butterfly(level: &HierarchyLevel) -> CompressedRows<f64> {
    midpoint_rows(level, |topology, half_edge, entries| {
        let ends = topology.ends(half_edge);
        if topology.twins[half_edge as usize] == NONE {
            for end in ends {
                entries.push(Entry { column: end, value: 0.5625 });
                let other = if end == ends[0] { ends[1] } else { ends[0] };
                let along = |spoke: &crate::topology::Spoke| {
                    topology.twins[spoke.half_edge as usize] == NONE && spoke.neighbor != other
                };
                match topology.ring(end).find(along) {
                    Some(spoke) if topology.n_neighbors(end) == 4 => {
                        entries.push(Entry { column: spoke.neighbor, value: -0.0625 });
                    }
                    // At a corner the border goes on straight.
                    _ => entries.extend([
                        Entry { column: end, value: -0.125 },
                        Entry { column: other, value: 0.0625 },
                    ]),
                }
            }
            return;
        }
        let is_irregular = |v: u32| {
            let n = topology.n_neighbors(v);
            !topology.is_border(v) && n != 6 && n <= MAX_RING
        };
        let n_irregular = ends.iter().filter(|&&end| is_irregular(end)).count();
        if n_irregular == 0 {
            push_regular(topology, half_edge, entries);
            return;
        }
        for end in ends.into_iter().filter(|&end| is_irregular(end)) {
            push_irregular(topology, half_edge, end, entries);
        }
        if n_irregular == 2 {
            for entry in entries {
                entry.value *= 0.5;
            }
        }
    })
}

/// Appends the eight weights of the butterfly (`dyn1990`).
fn push_regular(topology: &Topology, half_edge: u32, entries: &mut Vec<Entry>) {
    let ends = topology.ends(half_edge);
    entries.extend(ends.map(|column| Entry { column, value: 0.5 }));
    for side in [half_edge, topology.twins[half_edge as usize]] {
        let apex = topology.apex(side);
        entries.push(Entry { column: apex, value: 0.125 });
        for end in ends {
            let other = if end == ends[0] { ends[1] } else { ends[0] };
            let wing = topology.turn(side, end).half_edge;
            match topology.apex_across(wing) {
                Some(column) => entries.push(Entry { column, value: -0.0625 }),
                None => entries.extend([
                    Entry { column: end, value: -0.0625 },
                    Entry { column: apex, value: -0.0625 },
                    Entry { column: other, value: 0.0625 },
                ]),
            }
        }
    }
}

/// Appends the weights of the ring of an irregular end.
fn push_irregular(topology: &Topology, half_edge: u32, end: u32, entries: &mut Vec<Entry>) {
    let n = topology.n_neighbors(end);
    entries.push(Entry { column: end, value: 0.75 });
    for (j, spoke) in topology.ring_from(end, half_edge).enumerate() {
        let angle = TAU * j as f64 / n as f64;
        let value = match (n, j) {
            (3, 0) => 5.0 / 12.0,
            (3, _) => -1.0 / 12.0,
            (4, 0) => 0.375,
            (4, 2) => -0.125,
            (4, _) => 0.0,
            _ => (0.25 + angle.cos() + 0.5 * (2.0 * angle).cos()) / n as f64,
        };
        entries.push(Entry { column: spoke.neighbor, value });
    }
}

impl HierarchyLevel {
    /// First half-edge of the coarse mesh at each midpoint.
    pub(crate) fn half_edges(&self) -> Vec<u32> {
        let mut half_edges = vec![NONE; self.parents.len()];
        for (h, &midpoint) in (0..).zip(&self.midpoint_of) {
            if midpoint != NONE {
                let slot = &mut half_edges[midpoint as usize - self.topology.n_vertices];
                *slot = h.min(*slot);
            }
        }
        half_edges
    }

    /// Corners of the faces with face points.
    fn cut_faces(&self) -> impl Iterator<Item = &[u32]> {
        let centers = self.topology.faces.iter().zip(&self.face_points);
        centers.filter(|(_, center)| **center != NONE).map(|(corners, _)| corners)
    }
}

/// Builds the rows of the midpoints in their order, each from a half-edge of the coarse mesh.
fn midpoint_rows(
    level: &HierarchyLevel,
    push: impl Fn(&Topology, u32, &mut Vec<Entry>),
) -> CompressedRows<f64> {
    let mut rows = RowBuilder::new();
    let mut entries = Vec::new();
    for half_edge in level.half_edges() {
        push(&level.topology, half_edge, &mut entries);
        rows.push_row(&mut entries);
    }
    rows.finish(level.topology.n_vertices)
}

/// Coarse vertices within `n_rings` edges of a parent of each midpoint or face point, or within as many faces on
/// quadrilaterals: the support of its update.
pub(crate) fn parent_rings(level: &HierarchyLevel, n_rings: usize) -> CompressedRows<f64> {
    let topology = &level.topology;
    let mut rows = RowBuilder::new();
    let (mut entries, mut support) = (Vec::new(), Vec::new());
    for parents in level.parents.iter().map(<[u32; 2]>::as_slice).chain(level.cut_faces()) {
        support.clear();
        support.extend(parents);
        let mut first = 0;
        for _ in 0..n_rings {
            let end = support.len();
            for k in first..end {
                if topology.n_neighbors(support[k]) > MAX_RING {
                    continue;
                }
                let mut new: Vec<u32> = topology.ring(support[k]).map(|spoke| spoke.neighbor).collect();
                if !level.face_points.is_empty() {
                    let faces = topology.faces_at(support[k]).into_iter();
                    let corners = faces.map(|face| topology.faces.get(face as usize));
                    new.extend(corners.filter(|corners| corners.len() <= MAX_RING).flatten());
                    new.sort_unstable();
                    new.dedup();
                }
                new.retain(|w| !support.contains(w));
                support.extend(new);
            }
            first = end;
        }
        entries.extend(support.iter().map(|&column| Entry { column, value: 0.0 }));
        rows.push_row(&mut entries);
    }
    rows.finish(level.topology.n_vertices)
}
