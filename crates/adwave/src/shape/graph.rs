//! Weighted undirected graphs.

use super::Adjacency;
use crate::rows::CompressedRows;
use crate::{ClassifiedError, ErrorKind, Progress, parallel};
use std::sync::Arc;
use thiserror::Error;

/// Error of building a graph from a list of edges.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GraphError {
    /// The graph has no nodes.
    #[error("the graph has no nodes")]
    NoNodes,
    /// The graph has more nodes than a 32-bit index can name.
    #[error("{0} nodes are more than the {max} that can be indexed", max = u32::MAX - 1)]
    TooManyNodes(usize),
    /// An edge names a node that does not exist.
    #[error("edge {edge} (counted from 0) names node {node}, but there are only {n_nodes} nodes")]
    NodeOutOfRange {
        /// Index of the edge, from 0.
        edge: usize,
        /// The node that it names, from 0.
        node: u32,
        /// Number of nodes.
        n_nodes: usize,
    },
    /// A weight is negative, NaN or infinite.
    #[error("edge {edge} (counted from 0) has the weight {weight}; weights are finite and at least 0")]
    BadWeight {
        /// Index of the edge, from 0.
        edge: usize,
        /// The weight.
        weight: f64,
    },
    /// The lists of nodes and weights have different lengths.
    #[error(
        "the lists of first nodes, second nodes and weights must have one entry per edge, got {n_rows}, {n_columns} and {n_weights}"
    )]
    Lengths {
        /// Number of first nodes.
        n_rows: usize,
        /// Number of second nodes.
        n_columns: usize,
        /// Number of weights.
        n_weights: usize,
    },
}

impl ClassifiedError for GraphError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// An undirected graph with non-negative edge weights. Copies share the edges.
#[derive(Clone, Debug)]
pub struct Graph {
    rows: Arc<CompressedRows<f64>>,
}

impl Graph {
    /// Builds the graph of `n_nodes` nodes with the undirected edges `(u, v, weight)`.
    ///
    /// Repeated edges, in either direction, are added; a loop `(u, u)` is ignored, because the diffusion operator
    /// has its own. Weights have no unit: only their ratios at a node matter. O(edges log edges).
    ///
    /// # Errors
    /// [`GraphError`] if there is no node, an edge names a node that does not exist, or a weight is negative or not
    /// finite.
    ///
    /// ```
    /// use adwave::shape::Graph;
    /// let path = Graph::new(3, &[(0, 1, 1.0), (1, 2, 2.0), (2, 1, 0.5)])?;
    /// assert_eq!(path.neighbors(1).collect::<Vec<_>>(), [(0, 1.0), (2, 2.5)]);
    /// # Ok::<(), adwave::shape::GraphError>(())
    /// ```
    pub fn new(n_nodes: usize, edges: &[(u32, u32, f64)]) -> Result<Self, GraphError> {
        Self::from_edges(n_nodes, edges.iter().copied())
    }

    /// [`new`](Self::new) from three lists: edge `e` connects `rows[e]` and `columns[e]` with `weights[e]`.
    ///
    /// # Errors
    /// As for [`new`](Self::new), and [`GraphError::Lengths`] if the lists have different lengths.
    ///
    /// ```
    /// use adwave::shape::Graph;
    /// let path = Graph::from_columns(3, &[0, 1], &[1, 2], &[1.0, 2.5])?;
    /// assert_eq!(path.neighbors(2).collect::<Vec<_>>(), [(1, 2.5)]);
    /// # Ok::<(), adwave::shape::GraphError>(())
    /// ```
    pub fn from_columns(
        n_nodes: usize,
        rows: &[u32],
        columns: &[u32],
        weights: &[f64],
    ) -> Result<Self, GraphError> {
        if rows.len() != columns.len() || columns.len() != weights.len() {
            let (n_rows, n_columns, n_weights) = (rows.len(), columns.len(), weights.len());
            return Err(GraphError::Lengths { n_rows, n_columns, n_weights });
        }
        let edges = rows.iter().zip(columns).zip(weights);
        Self::from_edges(n_nodes, edges.map(|((&u, &v), &weight)| (u, v, weight)))
    }

    fn from_edges(
        n_nodes: usize,
        edges: impl ExactSizeIterator<Item = (u32, u32, f64)>,
    ) -> Result<Self, GraphError> {
        if n_nodes == 0 {
            return Err(GraphError::NoNodes);
        }
        if n_nodes >= u32::MAX as usize {
            return Err(GraphError::TooManyNodes(n_nodes));
        }
        let mut directed = Vec::with_capacity(2 * edges.len());
        for (edge, (u, v, weight)) in edges.enumerate() {
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
        // A stable sort keeps repeated edges in their given order, so both directions sum to the same bits.
        parallel::expect_not_cancelled(parallel::sort_by(&mut directed, Progress::none(), |a, b| {
            (a.0, a.1).cmp(&(b.0, b.1))
        }));
        let Ok(rows) = CompressedRows::from_sorted(n_nodes, directed) else {
            unreachable!("the edges have been checked and sorted")
        };
        Ok(Self { rows: Arc::new(rows) })
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.rows.n_rows()
    }

    /// Neighbor lists of the nodes.
    pub fn adjacency(&self) -> &Adjacency {
        self.rows.pattern()
    }

    /// Weight of each entry of [`adjacency`](Self::adjacency).
    pub fn weights(&self) -> &[f64] {
        self.rows.values()
    }

    /// Symmetric matrix of the weights, n_nodes × n_nodes with an empty diagonal.
    pub fn rows(&self) -> &CompressedRows<f64> {
        &self.rows
    }

    /// Neighbors of node `u` with the weights of their edges, in ascending order.
    pub fn neighbors(&self, u: usize) -> impl ExactSizeIterator<Item = (u32, f64)> + '_ {
        let (columns, weights) = self.rows.row(u);
        columns.iter().copied().zip(weights.iter().copied())
    }
}
