//! Symmetrization of nearest-neighbor lists: x and y are neighbors if either has the other in its list.

use std::ops::Range;

use crate::index::neighbor_lists::NeighborLists;

/// `target` is in the list of `source`; both are vertex indices. Edges are ordered by target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct DirectedEdge {
    target: u32,
    source: u32,
}

/// Edges from the block with these `vertices` to other blocks, sorted by target.
pub(crate) fn cross_block_edges(vertices: &Range<usize>, lists: &NeighborLists) -> Vec<DirectedEdge> {
    let mut edges: Vec<DirectedEdge> = vertices
        .clone()
        .enumerate()
        .flat_map(|(i, source)| {
            lists.list(i).iter().map(move |&target| DirectedEdge { target, source: source as u32 })
        })
        .filter(|edge| !vertices.contains(&(edge.target as usize)))
        .collect();
    edges.sort_unstable();
    edges
}

/// Symmetric lists of the block with these `vertices`, ascending.
///
/// `lists` are its stored lists, `incoming` the cross-block edges of all blocks that may refer to it.
pub(crate) fn symmetrize(
    vertices: Range<usize>,
    lists: &NeighborLists,
    incoming: &[&[DirectedEdge]],
) -> NeighborLists {
    let (first, n) = (vertices.start, vertices.len());
    let local = |vertex: u32| (vertex as usize).checked_sub(first).filter(|&i| i < n);
    let from_other_blocks = incoming.iter().flat_map(|edges| {
        let start = edges.partition_point(|edge| (edge.target as usize) < first);
        edges[start..].iter().take_while(|edge| (edge.target as usize) < vertices.end).copied()
    });
    let from_block = (0..n).flat_map(|i| {
        let source = (first + i) as u32;
        lists.list(i).iter().map(move |&target| DirectedEdge { target, source })
    });
    let reversed = || {
        let edges = from_block.clone().chain(from_other_blocks.clone());
        edges.filter_map(|edge| local(edge.target).map(|i| (i, edge.source)))
    };
    // Counting sort of all edges by the vertex whose list they belong to.
    let mut counts: Vec<u32> = (0..n).map(|i| lists.list(i).len() as u32).collect();
    reversed().for_each(|(i, _)| counts[i] += 1);
    let mut ends = Vec::with_capacity(n);
    let mut end = 0;
    for count in &counts {
        ends.push(end);
        end += count;
    }
    let mut neighbors = vec![0; end as usize];
    let mut put = |i: usize, neighbor: u32| {
        neighbors[ends[i] as usize] = neighbor;
        ends[i] += 1;
    };
    for i in 0..n {
        lists.list(i).iter().for_each(|&target| put(i, target));
    }
    reversed().for_each(|(i, source)| put(i, source));
    let mut symmetric = NeighborLists::new();
    symmetric.neighbors.reserve(neighbors.len());
    let mut start = 0;
    for end in ends {
        let row = &mut neighbors[start..end as usize];
        row.sort_unstable();
        let before = symmetric.neighbors.len();
        for &neighbor in &*row {
            if symmetric.neighbors.len() == before || symmetric.neighbors.last() != Some(&neighbor) {
                symmetric.neighbors.push(neighbor);
            }
        }
        start = end as usize;
        symmetric.end_list();
    }
    symmetric.neighbors.shrink_to_fit();
    symmetric
}
