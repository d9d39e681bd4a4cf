//! Features of whole graphs: statistics of node values, graph by graph.

use crate::GraphWalkError;
use adwave::named_values;

/// Statistics of the values of a graph.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Pooling {
    /// The mean.
    #[default]
    Mean,
    /// The maximum.
    Max,
    /// `Σ|v|^q` for q = 1 … 4, as in `gao2019`.
    Norms,
    /// Mean, variance, skewness and excess kurtosis; the last two are 0 where all values are equal.
    Moments,
}

named_values!(Pooling, "pool", {
    Mean => "mean", "The mean";
    Max => "max", "The maximum";
    Norms => "norms", "Sums of the powers 1 to 4 of the sizes";
    Moments => "moments", "Mean, variance, skewness and excess kurtosis";
});

impl Pooling {
    /// Number of statistics per path and channel.
    pub fn n_statistics(self) -> usize {
        match self {
            Self::Mean | Self::Max => 1,
            Self::Norms | Self::Moments => 4,
        }
    }
}

/// Statistics of `values`, n_paths × n_nodes × n_channels, over the nodes of each graph: n_graphs × n_paths ×
/// n_channels × statistics. `graph_of[x]` is the graph of node x, from 0. A graph without nodes has zeros. O(values).
///
/// # Errors
/// [`GraphWalkError::LabelsLength`] unless there is a label per node, below `n_graphs`.
///
/// ```
/// use adwave_graph::{Pooling, pool};
/// let found = pool(&[1.0, 3.0, 5.0], 1, &[0, 0, 2], 3, Pooling::Mean)?;
/// assert_eq!(found, [2.0, 0.0, 5.0]);
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn pool(
    values: &[f64],
    n_channels: usize,
    graph_of: &[u32],
    n_graphs: usize,
    pooling: Pooling,
) -> Result<Vec<f64>, GraphWalkError> {
    let per_path = graph_of.len() * n_channels;
    let is_whole = if per_path == 0 { values.is_empty() } else { values.len().is_multiple_of(per_path) };
    if !is_whole {
        let n_nodes = values.len() / n_channels.max(1);
        return Err(GraphWalkError::LabelsLength { n_labels: graph_of.len(), n_nodes });
    }
    if let Some(&label) = graph_of.iter().find(|&&graph| graph as usize >= n_graphs) {
        let (name, range) = ("the label of a graph", "below the number of graphs");
        return Err(GraphWalkError::BadParameter { name, range, value: f64::from(label) });
    }
    let n_paths = values.len() / per_path.max(1);
    let n_statistics = pooling.n_statistics();
    let mut counts = vec![0.0; n_graphs];
    for &graph in graph_of {
        counts[graph as usize] += 1.0;
    }
    let mut out = vec![0.0; n_graphs * n_paths * n_channels * n_statistics];
    let mut means = vec![0.0; n_graphs * n_channels];
    let mut sums = vec![[0.0; 4]; n_graphs * n_channels];
    for (path, values) in values.chunks_exact(per_path.max(1)).enumerate() {
        let rows = || values.chunks_exact(n_channels).zip(graph_of.iter().map(|&graph| graph as usize));
        means.fill(0.0);
        for (row, graph) in rows() {
            for (mean, v) in means[graph * n_channels..].iter_mut().zip(row) {
                *mean += v / counts[graph];
            }
        }
        sums.fill([if pooling == Pooling::Max { f64::NEG_INFINITY } else { 0.0 }; 4]);
        for (row, graph) in rows() {
            let means = &means[graph * n_channels..];
            for ((sums, &v), mean) in sums[graph * n_channels..].iter_mut().zip(row).zip(means) {
                add(pooling, sums, v, v - mean);
            }
        }
        for (graph, &count) in counts.iter().enumerate() {
            for channel in 0..n_channels {
                let at = graph * n_channels + channel;
                let start = ((graph * n_paths + path) * n_channels + channel) * n_statistics;
                let found =
                    if count == 0.0 { [0.0; 4] } else { statistics(pooling, means[at], sums[at], count) };
                out[start..start + n_statistics].copy_from_slice(&found[..n_statistics]);
            }
        }
    }
    Ok(out)
}

fn add(pooling: Pooling, sums: &mut [f64; 4], v: f64, off: f64) {
    match pooling {
        Pooling::Mean => {}
        Pooling::Max => sums[0] = sums[0].max(v),
        Pooling::Norms => {
            let size = v.abs();
            let powers = [size, size * size, size * size * size, (size * size) * (size * size)];
            sums.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
        }
        Pooling::Moments => {
            let powers = [0.0, off * off, off * off * off, (off * off) * (off * off)];
            sums.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
        }
    }
}

fn statistics(pooling: Pooling, mean: f64, sums: [f64; 4], count: f64) -> [f64; 4] {
    match pooling {
        Pooling::Mean => [mean, 0.0, 0.0, 0.0],
        Pooling::Max | Pooling::Norms => sums,
        Pooling::Moments => {
            let [_, second, third, fourth] = sums.map(|sum| sum / count);
            // Below this the deviations are rounding.
            if second.sqrt() <= 1e-12 * mean.abs() || second == 0.0 {
                return [mean, 0.0, 0.0, 0.0];
            }
            [mean, second, third / second.powf(1.5), fourth / (second * second) - 3.0]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_those_of_the_formulas() {
        // Two paths, four nodes in graphs 0, 0, 2, 0 of three, one channel.
        let values = [1.0, -2.0, 7.0, 4.0, 0.5, 0.5, -1.0, 0.5];
        let graphs = [0, 0, 2, 0];
        let moments = pool(&values, 1, &graphs, 3, Pooling::Moments).unwrap();
        assert_eq!(moments.len(), 3 * 2 * 4);
        assert!((moments[0] - 1.0).abs() < 1e-15 && (moments[1] - 6.0).abs() < 1e-14);
        assert!(moments[2].abs() < 1e-15 && (moments[3] + 1.5).abs() < 1e-14);
        assert_eq!(moments[4..8], [0.5, 0.0, 0.0, 0.0]);
        assert_eq!(moments[8..16], [0.0; 8]);
        assert_eq!(moments[16..18], [7.0, 0.0]);
        let norms = pool(&values, 1, &graphs, 3, Pooling::Norms).unwrap();
        assert_eq!(norms[..4], [7.0, 21.0, 73.0, 273.0]);
        assert_eq!(pool(&values, 1, &graphs, 3, Pooling::Max).unwrap(), [4.0, 0.5, 0.0, 0.0, 7.0, -1.0]);
    }

    #[test]
    fn wrong_labels_are_refused() {
        assert!(pool(&[1.0, 2.0], 1, &[0], 1, Pooling::Mean).is_ok());
        assert!(pool(&[1.0, 2.0, 3.0], 1, &[0, 0], 1, Pooling::Mean).is_err());
        assert!(pool(&[1.0, 2.0], 1, &[0, 5], 2, Pooling::Mean).is_err());
        assert_eq!(pool(&[], 1, &[], 2, Pooling::Mean).unwrap(), []);
    }
}
