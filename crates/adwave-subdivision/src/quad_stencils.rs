//! Subdivision rules on quadrilaterals: weights of the coarse vertices at midpoints and face points, and
//! Catmull–Clark's rule for coarse vertices (`catmull1978`; on borders and sharp edges `derose1998`).

use crate::BorderCorners;
use crate::even_solve::EvenRule;
use crate::hierarchy::HierarchyLevel;
use crate::rows::{Entry, RowBuilder};
use crate::topology::{NONE, Topology};
use adwave::rows::CompressedRows;

/// Largest number of vertices of a part of which an alternating field is lost (see [`add_lost_fields`]).
const MAX_LOST: usize = 1000;

/// Weights at midpoints, one half for each end of the edge, and at face points, equal for all corners.
pub(crate) fn linear(level: &HierarchyLevel) -> CompressedRows<f64> {
    new_rows(level, |topology, half_edge, entries| {
        entries.extend(topology.ends(half_edge).map(|column| Entry { column, value: 0.5 }));
    })
}

/// Weights of Catmull–Clark subdivision: at midpoints the mean of the ends and of both face points, on borders and
/// sharp edges the mean of the ends; at face points equal for all corners.
pub(crate) fn catmull_clark(level: &HierarchyLevel) -> CompressedRows<f64> {
    new_rows(level, |topology, half_edge, entries| {
        let ends = topology.ends(half_edge);
        if topology.is_crease(half_edge) {
            entries.extend(ends.map(|column| Entry { column, value: 0.5 }));
            return;
        }
        entries.extend(ends.map(|column| Entry { column, value: 0.25 }));
        for side in [half_edge, topology.twins[half_edge as usize]] {
            push_mean(topology, topology.face(side), 0.25, entries);
        }
    })
}

/// Appends the mean of the corners of a face, times a factor.
fn push_mean(topology: &Topology, face: u32, factor: f64, entries: &mut Vec<Entry>) {
    let corners = topology.faces.get(face as usize);
    let value = factor / corners.len() as f64;
    entries.extend(corners.iter().map(|&column| Entry { column, value }));
}

/// Builds the rows of the midpoints by a rule, then those of the face points.
fn new_rows(level: &HierarchyLevel, push: impl Fn(&Topology, u32, &mut Vec<Entry>)) -> CompressedRows<f64> {
    let topology = &level.topology;
    let (mut rows, mut entries) = (RowBuilder::new(), Vec::new());
    for half_edge in level.half_edges() {
        push(topology, half_edge, &mut entries);
        rows.push_row(&mut entries);
    }
    for (face, &center) in (0..).zip(&level.face_points) {
        if center != NONE {
            push_mean(topology, face, 1.0, &mut entries);
            rows.push_row(&mut entries);
        }
    }
    rows.finish(topology.n_vertices)
}

/// Catmull–Clark's rule for coarse vertices of n faces and edges: `(F̄ + 2R̄ + (n − 3)·v)/n`, with the means F̄ of the
/// face points and R̄ of the midpoints; `(a + 6v + b)/8` with two sharp edges to a and b, and v itself with more. Rows
/// of vertices in parts without a coarser level are empty.
pub(crate) fn even_rule(level: &HierarchyLevel, corners: BorderCorners) -> EvenRule {
    let topology = &level.topology;
    let mut is_active = vec![false; topology.n_vertices];
    for pair in &level.parents {
        is_active[pair[0] as usize] = true;
        is_active[pair[1] as usize] = true;
    }
    let mut all: Vec<Vec<Entry>> = Vec::with_capacity(topology.n_vertices);
    for v in 0..topology.n_vertices as u32 {
        let mut entries = Vec::new();
        let is_corner = corners == BorderCorners::Sharp && topology.n_faces_at[v as usize] == 1;
        if is_active[v as usize] && !is_corner {
            push_even(topology, v, &mut entries);
        }
        all.push(entries);
    }
    add_lost_fields(topology, &is_active, &mut all);
    let mut rows = RowBuilder::new();
    for (v, mut entries) in (0..).zip(all) {
        entries.retain(|entry| entry.column != v);
        rows.push_row(&mut entries);
    }
    EvenRule::from_rows(rows.finish(topology.n_vertices))
}

/// Appends the weights of the other vertices in the rule of a coarse vertex.
fn push_even(topology: &Topology, v: u32, entries: &mut Vec<Entry>) {
    let sharp = || topology.ring(v).filter(|spoke| topology.is_crease(spoke.half_edge));
    match sharp().count() {
        0 | 1 => {
            let square = (topology.n_neighbors(v) as f64).powi(2);
            entries
                .extend(topology.ring(v).map(|spoke| Entry { column: spoke.neighbor, value: 1.0 / square }));
            for face in topology.faces_at(v) {
                push_mean(topology, face, 1.0 / square, entries);
            }
        }
        2 => entries.extend(sharp().map(|spoke| Entry { column: spoke.neighbor, value: 0.125 })),
        _ => {}
    }
}

/// Changes the rule where it loses a field. On a closed part of vertices with three faces each, whose faces have even
/// numbers of corners (a cube), a field that alternates between 1 and −1 along all edges becomes 0 by subdivision. One
/// vertex of such a part gets the mean product with this field in addition, so that the rule has an inverse; meshes
/// without this field stay as they are.
fn add_lost_fields(topology: &Topology, is_active: &[bool], rows: &mut [Vec<Entry>]) {
    let is_smooth = |v: u32| {
        is_active[v as usize]
            && topology.n_neighbors(v) == 3
            && topology.ring(v).filter(|spoke| topology.is_crease(spoke.half_edge)).count() < 2
    };
    let mut signs = vec![0.0; topology.n_vertices];
    for first in 0..topology.n_vertices as u32 {
        if signs[first as usize] != 0.0 || !is_smooth(first) {
            continue;
        }
        let (mut reached, mut alternates) = (vec![first], true);
        signs[first as usize] = 1.0;
        let mut k = 0;
        while k < reached.len() {
            let v = reached[k];
            k += 1;
            for spoke in topology.ring(v) {
                let w = spoke.neighbor;
                if signs[w as usize] == 0.0 {
                    alternates &= is_smooth(w);
                    if is_smooth(w) {
                        signs[w as usize] = -signs[v as usize];
                        reached.push(w);
                    }
                }
                alternates &= signs[w as usize] == -signs[v as usize];
            }
        }
        if alternates && reached.len() <= MAX_LOST {
            let share = 1.0 / reached.len() as f64;
            let entry = |&column: &u32| Entry { column, value: share * signs[column as usize] };
            rows[first as usize].extend(reached.iter().map(entry));
        }
    }
}
