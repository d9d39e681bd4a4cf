//! The degree of a graph's nodes.

use crate::shape::Graph;

/// The sum of the weights of each node's edges, which of weights 1 is how many edges it has; 0 where it has none. An edge
/// of a node with itself does not count. O(nodes + edges).
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
