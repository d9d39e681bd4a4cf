//! Weighted undirected graphs, with or without positions.

use super::curve::edge_lengths;
use super::{Adjacency, ShapeError, check_points};
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
    /// The number of positions differs from the number of nodes.
    #[error("a graph needs one position for each of its {n_nodes} nodes, got {found}")]
    PositionCount {
        /// Number of positions.
        found: usize,
        /// Number of nodes.
        n_nodes: usize,
    },
    /// The number of areas differs from the number of nodes.
    #[error("a graph of cells needs one area for each of its {n_nodes} nodes, got {found}")]
    AreaCount {
        /// Number of areas.
        found: usize,
        /// Number of nodes.
        n_nodes: usize,
    },
    /// An area is negative, NaN or infinite.
    #[error("node {node} (counted from 0) has the area {area}; areas are finite and at least 0")]
    BadArea {
        /// The node, from 0.
        node: usize,
        /// The area.
        area: f64,
    },
    /// A position is not finite or too far away.
    #[error(transparent)]
    Position(#[from] ShapeError),
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

/// An undirected graph with non-negative edge weights. Copies share the edges and positions.
///
/// A graph may have positions. If its weights follow from them, it is a *curve* ([`curve`](Self::curve)), on which
/// signals diffuse by arc length. Weights that are given decide the steps whether there are positions or not
/// ([`with_positions`](Self::with_positions)).
#[derive(Clone, Debug)]
pub struct Graph {
    rows: Arc<CompressedRows<f64>>,
    positions: Option<Arc<Vec<[f64; 3]>>>,
    is_curve: bool,
    cell_areas: Option<Arc<Vec<f64>>>,
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
        let Ok(rows) = CompressedRows::from_sorted(n_nodes, n_nodes, directed) else {
            unreachable!("the edges have been checked and sorted")
        };
        Ok(Self { rows: Arc::new(rows), positions: None, is_curve: false, cell_areas: None })
    }

    /// Builds the curve of nodes at `points` (model units) and the undirected `edges`, with weights 1/length.
    ///
    /// Repeated edges count once and loops not at all. Edges of length 0 have a large weight here; the analysis joins
    /// their nodes. O(edges log edges).
    ///
    /// # Errors
    /// [`GraphError`] if there are no points, one is not finite, or an edge names a node that does not exist.
    ///
    /// ```
    /// use adwave::shape::Graph;
    /// let points = vec![[0.0; 3], [2.0, 0.0, 0.0], [2.5, 0.0, 0.0]];
    /// let curve = Graph::curve(points, &[[0, 1], [1, 2], [2, 1]])?;
    /// assert_eq!(curve.neighbors(1).collect::<Vec<_>>(), [(0, 0.5), (2, 2.0)]);
    /// # Ok::<(), adwave::shape::GraphError>(())
    /// ```
    pub fn curve(points: impl Into<Arc<Vec<[f64; 3]>>>, edges: &[[u32; 2]]) -> Result<Self, GraphError> {
        let points = points.into();
        check_points(&points)?;
        let given = Self::from_edges(points.len(), edges.iter().map(|&[u, v]| (u, v, 1.0)))?;
        let lengths = edge_lengths(&points, given.adjacency());
        let pattern = given.adjacency().clone();
        let rows =
            CompressedRows::new_unchecked(pattern, lengths.iter().map(|length| 1.0 / length).collect());
        Ok(Self { rows: Arc::new(rows), positions: Some(points), is_curve: true, cell_areas: None })
    }

    /// This graph with its nodes at `points` (model units); the steps still follow the given weights.
    ///
    /// # Errors
    /// [`GraphError`] unless there is one finite position per node.
    ///
    /// ```
    /// use adwave::shape::{Graph, Shape};
    /// let pair = Graph::new(2, &[(0, 1, 5.0)])?.with_positions(vec![[0.0; 3], [3.0, 4.0, 0.0]])?;
    /// assert_eq!((pair.is_curve(), Shape::Graph(pair).diagonal()), (false, 5.0));
    /// # Ok::<(), adwave::shape::GraphError>(())
    /// ```
    pub fn with_positions(self, points: impl Into<Arc<Vec<[f64; 3]>>>) -> Result<Self, GraphError> {
        let points = points.into();
        if points.len() != self.n_nodes() {
            return Err(GraphError::PositionCount { found: points.len(), n_nodes: self.n_nodes() });
        }
        check_points(&points)?;
        Ok(Self { positions: Some(points), is_curve: false, cell_areas: None, ..self })
    }

    /// This graph with its nodes as cells of a surface: `centers` in model units, `areas` in squared model units, and
    /// weights that conduct heat between cells, of no unit ([`dual_graph`](super::dual_graph)).
    ///
    /// Signals on it diffuse by heat, with cells weighted by their areas.
    ///
    /// # Errors
    /// [`GraphError`] unless there is one finite position, and one finite area of at least 0, per node.
    ///
    /// ```
    /// use adwave::{Decomposer, shape::{Graph, Shape}};
    /// let pair = Graph::new(2, &[(0, 1, 1.0)])?.with_cells(vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![1.0, 3.0])?;
    /// let decomposer = Decomposer::new(&Shape::Graph(pair));
    /// assert_eq!(decomposer.areas(), [1.0, 3.0]);
    /// # Ok::<(), adwave::shape::GraphError>(())
    /// ```
    pub fn with_cells(
        self,
        centers: impl Into<Arc<Vec<[f64; 3]>>>,
        areas: Vec<f64>,
    ) -> Result<Self, GraphError> {
        if areas.len() != self.n_nodes() {
            return Err(GraphError::AreaCount { found: areas.len(), n_nodes: self.n_nodes() });
        }
        if let Some(node) = areas.iter().position(|area| !(area.is_finite() && *area >= 0.0)) {
            return Err(GraphError::BadArea { node, area: areas[node] });
        }
        Ok(Self { cell_areas: Some(Arc::new(areas)), ..self.with_positions(centers)? })
    }

    /// Areas of the nodes in squared model units, if they are cells of a surface.
    pub fn cell_areas(&self) -> Option<&[f64]> {
        self.cell_areas.as_ref().map(|areas| areas.as_slice())
    }

    /// Positions of the nodes in model units, if they have any.
    pub fn positions(&self) -> Option<&[[f64; 3]]> {
        self.positions.as_ref().map(|points| points.as_slice())
    }

    /// True if the weights follow from the lengths of the edges.
    pub fn is_curve(&self) -> bool {
        self.is_curve
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
