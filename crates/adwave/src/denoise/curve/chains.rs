//! Pieces of a curve between its ends and branches.

use crate::shape::Adjacency;

/// Vertices of a curve in their order. Inner vertices have two neighbors.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    pub(super) vertices: Vec<u32>,
    /// True if the last vertex is joined to the first, and all have two neighbors.
    pub(super) is_closed: bool,
}

/// The chains of the edges of a curve: each edge is in one chain. O(edges).
pub(super) fn chains(edges: &Adjacency) -> Vec<Chain> {
    let n = edges.n_rows();
    let is_inner = |x: u32| edges.row(x as usize).len() == 2;
    let mut is_visited = vec![false; n];
    let mut found = Vec::new();
    // From each end or branch along each edge, to the next end or branch; the same chain is met from both sides.
    for start in (0..n as u32).filter(|&x| !is_inner(x)) {
        for &next in edges.row(start as usize) {
            if is_inner(next) && is_visited[next as usize] || !is_inner(next) && next < start {
                continue;
            }
            let mut vertices = vec![start];
            let mut at = next;
            while is_inner(at) {
                is_visited[at as usize] = true;
                vertices.push(at);
                at = other_neighbor(edges, at, vertices[vertices.len() - 2]);
            }
            vertices.push(at);
            found.push(Chain { vertices, is_closed: false });
        }
    }
    for start in 0..n as u32 {
        if !is_inner(start) || is_visited[start as usize] {
            continue;
        }
        let mut vertices = vec![start];
        is_visited[start as usize] = true;
        let mut at = edges.row(start as usize)[0];
        while at != start {
            is_visited[at as usize] = true;
            vertices.push(at);
            at = other_neighbor(edges, at, vertices[vertices.len() - 2]);
        }
        found.push(Chain { vertices, is_closed: true });
    }
    found
}

/// The neighbor of an inner vertex that is not `from`.
fn other_neighbor(edges: &Adjacency, x: u32, from: u32) -> u32 {
    let row = edges.row(x as usize);
    if row[0] == from { row[1] } else { row[0] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Graph;

    fn chains_of(n: usize, pairs: &[(u32, u32)]) -> Vec<Chain> {
        let edges: Vec<_> = pairs.iter().map(|&(a, b)| (a, b, 1.0)).collect();
        chains(Graph::new(n, &edges).unwrap().adjacency())
    }

    #[test]
    fn each_edge_is_in_one_chain() {
        // A loop at a branch with a tail, a cycle, a pair and a vertex without edges.
        let pairs = [(0, 1), (1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (7, 8), (3, 9), (9, 3)];
        let found = chains_of(11, &pairs);
        let n_edges: usize = found.iter().map(|c| c.vertices.len() - usize::from(!c.is_closed)).sum();
        assert_eq!(n_edges, 9, "{found:?}");
        assert_eq!(found.iter().filter(|c| c.is_closed).count(), 1);
    }
}
