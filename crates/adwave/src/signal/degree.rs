//! Degree of the nodes of a graph.

use crate::shape::Graph;

/// Sum of the weights of each node's edges; with weights 1 it is the number of edges. 0 for a node without edges.
/// Loops do not count. O(nodes + edges).
///
/// ```
/// use adwave::shape::Graph;
/// use adwave::signal::degree;
/// let path = Graph::new(4, &[(0, 1, 1.0), (1, 2, 2.5), (2, 2, 7.0)])?;
/// assert_eq!(degree(&path), [1.0, 3.5, 2.5, 0.0]);
/// # Ok::<(), adwave::shape::GraphError>(())
/// ```
pub fn degree(graph: &Graph) -> Vec<f64> {
    crate::parallel::collect(graph.n_nodes(), |u| graph.neighbors(u).map(|(_, weight)| weight).sum())
}
