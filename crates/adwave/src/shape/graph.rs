//! Weighted undirected graphs.

use super::Adjacency;
use thiserror::Error;

/// Why a list of edges is not a graph that can be walked on.
#[derive(Debug, Error, PartialEq)]
pub enum GraphError {
    /// There is no node.
    #[error("the graph has no nodes")]
    NoNodes,
    /// More nodes than a 32-bit index can name.
    #[error("{0} nodes are more than the {max} that can be indexed", max = u32::MAX - 1)]
    TooManyNodes(usize),
    /// An edge names a node that does not exist.
    #[error("edge {edge} (counted from 0) names node {node}, but there are only {n_nodes} nodes")]
    NodeOutOfRange {
        /// Index of the edge, from 0.
        edge: usize,
        /// The node it names, from 0.
        node: u32,
        /// Number of nodes.
        n_nodes: usize,
    },
    /// A weight is negative, NaN or infinite, so it is no probability.
    #[error(
        "edge {edge} (counted from 0) has the weight {weight}; a walk needs finite weights of at least 0"
    )]
    BadWeight {
        /// Index of the edge, from 0.
        edge: usize,
        /// Its weight.
        weight: f64,
    },
}

/// An undirected graph with non-negative edge weights.
#[derive(Clone, Debug)]
pub struct Graph {
    adjacency: Adjacency,
    weights: Vec<f64>,
}

impl Graph {
    /// The graph of `n_nodes` nodes with the undirected edges `(u, v, weight)`.
    ///
    /// An edge given several times, in either direction, counts with the sum of its weights; a loop `(u, u)` is left
    /// out, because the lazy walk has its own. Weights have no unit: only their ratios at a node matter.
    ///
    /// # Errors
    /// [`GraphError`] when there is no node, an edge names a node that does not exist, or a weight is negative or not
    /// finite.
    ///
    /// ```
    /// use adwave::shape::Graph;
    /// let path = Graph::new(3, &[(0, 1, 1.0), (1, 2, 2.0), (2, 1, 0.5)])?;
    /// assert_eq!(path.neighbours(1).collect::<Vec<_>>(), [(0, 1.0), (2, 2.5)]);
    /// # Ok::<(), adwave::shape::GraphError>(())
    /// ```
    pub fn new(n_nodes: usize, edges: &[(u32, u32, f64)]) -> Result<Self, GraphError> {
        if n_nodes == 0 {
            return Err(GraphError::NoNodes);
        }
        if n_nodes >= u32::MAX as usize {
            return Err(GraphError::TooManyNodes(n_nodes));
        }
        let mut directed = Vec::with_capacity(2 * edges.len());
        for (edge, &(u, v, weight)) in edges.iter().enumerate() {
            if let Some(node) = [u, v].into_iter().find(|&node| node as usize >= n_nodes) {
                return Err(GraphError::NodeOutOfRange { edge, node, n_nodes });
            }
            if !(weight.is_finite() && weight >= 0.0) {
                return Err(GraphError::BadWeight { edge, weight });
            }
            if u != v {
                directed.push((u, v, weight));
                directed.push((v, u, weight));
            }
        }
        // A stable sort keeps repeated edges in their given order, so that both directions sum to the same bits.
        directed.sort_by_key(|&(u, v, _)| (u, v));
        let mut offsets = vec![0_usize; n_nodes + 1];
        let (mut columns, mut weights) = (Vec::new(), Vec::new());
        let mut last = None;
        for (u, v, weight) in directed {
            if last == Some((u, v)) {
                *weights.last_mut().expect("the edge before this one") += weight;
            } else {
                columns.push(v);
                weights.push(weight);
                offsets[u as usize + 1] += 1;
                last = Some((u, v));
            }
        }
        for u in 0..n_nodes {
            offsets[u + 1] += offsets[u];
        }
        Ok(Self { adjacency: Adjacency { offsets, neighbours: columns }, weights })
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.adjacency.n_vertices()
    }

    /// Who is joined with whom.
    pub fn adjacency(&self) -> &Adjacency {
        &self.adjacency
    }

    /// The weight of each entry of [`adjacency`](Self::adjacency).
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The neighbours of node `u` with the weights of the edges to them, by rising index.
    pub fn neighbours(&self, u: usize) -> impl ExactSizeIterator<Item = (u32, f64)> + '_ {
        let range = self.adjacency.offsets[u]..self.adjacency.offsets[u + 1];
        self.adjacency.neighbours[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }
}
