//! Counts on triangles.

use std::collections::{BTreeMap, BTreeSet};

/// Number of faces of each edge.
pub(crate) fn edges(triangles: &[[u32; 3]]) -> BTreeMap<[u32; 2], usize> {
    let mut edges = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [x, y] in [[a, b], [b, c], [c, a]] {
            *edges.entry([x.min(y), x.max(y)]).or_insert(0) += 1;
        }
    }
    edges
}

/// Vertices less edges plus faces.
pub(crate) fn euler_characteristic(triangles: &[[u32; 3]]) -> i64 {
    let vertices: BTreeSet<u32> = triangles.iter().flatten().copied().collect();
    vertices.len() as i64 - edges(triangles).len() as i64 + triangles.len() as i64
}
