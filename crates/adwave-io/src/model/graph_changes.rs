//! Differences between the matrix in a file and the weights of the graph that the walk needs.

use std::collections::BTreeMap;

use crate::{Direction, ShapeFile};

/// Relative difference below which two weights are equal.
const EQUAL: f64 = 1e-12;
/// Difference from 1 below which the sum of a row is 1.
const STOCHASTIC: f64 = 1e-6;

/// Changes to the matrix M of a file that its graph needs: weights are (M + Mᵀ)/2 without the diagonal.
///
/// ```
/// use adwave_io::{ReadLimits, read_bytes};
/// let text = b"%%MatrixMarket matrix coordinate real general\n2 2 3\n1 2 3\n2 1 4\n1 1 5\n";
/// let file = read_bytes(text.to_vec(), Some("a.mtx"), &ReadLimits::default()).unwrap();
/// let changes = file.graph_changes();
/// assert_eq!((changes.n_loops, changes.n_asymmetric), (1, 1));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct GraphChanges {
    /// Number of entries on the diagonal, which are dropped.
    pub n_loops: usize,
    /// Number of pairs of nodes with different weights in the two directions, which become their mean.
    pub n_asymmetric: usize,
    /// Number of pairs of nodes with a weight in any direction.
    pub n_pairs: usize,
    /// True if the rows of M that have entries sum to 1, as those of a transition matrix.
    pub is_stochastic: bool,
}

impl GraphChanges {
    /// Remark in one sentence; `None` if the graph has the weights of the file.
    pub fn note(&self) -> Option<String> {
        let mut changes = Vec::new();
        if self.n_asymmetric > 0 {
            let (n, all) = (self.n_asymmetric, self.n_pairs);
            changes.push(format!(
                "the matrix M is not symmetric at {n} of {all} pairs of nodes, and (M + Mᵀ)/2 is used"
            ));
        }
        if self.n_loops > 0 {
            let loops = if self.n_loops == 1 { "self-loop is" } else { "self-loops are" };
            changes.push(format!("{} {loops} dropped", self.n_loops));
        }
        if self.is_stochastic {
            changes.push("the rows of M sum to 1, but M itself is not the walk".to_owned());
        }
        if changes.is_empty() {
            return None;
        }
        Some(format!("{}; the diffusion is the lazy walk of the symmetric weights", changes.join("; ")))
    }
}

impl ShapeFile {
    /// Compares the edges of the file with the weights of its graph, which is undirected and has no self-loops. An
    /// edge list without directions has a symmetric matrix. O(edges log edges).
    pub fn graph_changes(&self) -> GraphChanges {
        let edges = self.edges();
        let weight = |k: usize| edges.weights.get(k).copied().unwrap_or(1.0);
        let mut sums: BTreeMap<[u32; 2], [f64; 2]> = BTreeMap::new();
        let mut of_rows: BTreeMap<u32, f64> = BTreeMap::new();
        let is_directed = edges.direction == Direction::RowToColumn;
        let mut n_loops = 0;
        for (k, &[a, b]) in edges.pairs.iter().enumerate() {
            *of_rows.entry(a).or_default() += weight(k);
            if a == b {
                n_loops += 1;
                continue;
            }
            if !is_directed {
                *of_rows.entry(b).or_default() += weight(k);
            }
            let sum = sums.entry([a.min(b), a.max(b)]).or_default();
            sum[usize::from(a > b)] += weight(k);
        }
        let is_equal = |[x, y]: &[f64; 2]| (x - y).abs() <= EQUAL * x.abs().max(y.abs());
        let n_asymmetric = if is_directed { sums.values().filter(|sum| !is_equal(sum)).count() } else { 0 };
        let is_one = |sum: &f64| (sum - 1.0).abs() <= STOCHASTIC;
        let is_stochastic = !edges.weights.is_empty() && !of_rows.is_empty() && of_rows.values().all(is_one);
        GraphChanges { n_loops, n_asymmetric, n_pairs: sums.len(), is_stochastic }
    }
}
