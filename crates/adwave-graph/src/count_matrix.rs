//! Matrices of counts, nodes × channels (cells × genes), dense or sparse, and the transformations before diffusion.

use crate::lane_block::fetch_values;
use crate::{GraphWalkError, WalkPowers};
use adwave::rows::CompressedRows;
use rayon::prelude::*;

/// Values of a matrix, n_nodes × n_channels.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum CountValues<'a> {
    /// Row after row.
    Dense(&'a [f64]),
    /// Compressed rows; a missing entry is 0.
    Sparse(&'a CompressedRows<f64>),
}

/// Channels of a block, ascending or not, at least one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChannelBlock<'a> {
    channels: &'a [usize],
    /// True if each channel follows the one before. Copies without a look-up per value have many rows under way at a
    /// time: rows lie in different pages, and waiting for one after the other takes longer than the products.
    follow: bool,
}

impl<'a> ChannelBlock<'a> {
    pub(crate) fn new(channels: &'a [usize]) -> Self {
        let follow = !channels.is_empty() && channels.windows(2).all(|pair| pair[1] == pair[0] + 1);
        Self { channels, follow }
    }
}

/// A matrix of counts or other values.
#[derive(Clone, Copy, Debug)]
pub struct CountMatrix<'a> {
    /// The values.
    pub values: CountValues<'a>,
    /// Number of channels.
    pub n_channels: usize,
}

/// Transformation of the values before diffusion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transformation {
    /// Multiplies each row so that it sums to this: the library size of a cell. Rows of sum 0 stay.
    pub library_size: Option<f64>,
    /// Takes the square root afterwards.
    pub square_root: bool,
}

impl CountMatrix<'_> {
    /// Checks the size of the matrix for a walk, and that all values are finite.
    pub(crate) fn check(&self, powers: &WalkPowers) -> Result<(), GraphWalkError> {
        let n_columns = self.n_channels;
        let wrong =
            |n_values| GraphWalkError::SignalLength { n_values, n_nodes: powers.n_nodes(), n_columns };
        match self.values {
            CountValues::Dense(values) => powers.check_signal(values, n_columns),
            CountValues::Sparse(rows) => {
                let is_inside = rows.columns().iter().all(|&y| (y as usize) < n_columns);
                if rows.n_rows() != powers.n_nodes() || !is_inside {
                    return Err(wrong(rows.n_rows() * n_columns));
                }
                match rows.values().iter().position(|v| !v.is_finite()) {
                    None => Ok(()),
                    Some(at) => {
                        let (node, channel) = place(rows, at);
                        Err(GraphWalkError::BadValue { node, channel, value: rows.values()[at] })
                    }
                }
            }
        }
    }

    /// The first value that `is_wrong`, with its node and channel.
    pub(crate) fn find(&self, is_wrong: impl Fn(f64) -> bool + Sync) -> Option<(usize, usize, f64)> {
        match self.values {
            CountValues::Dense(values) => {
                let at = values.par_iter().with_min_len(1 << 14).position_first(|&v| is_wrong(v))?;
                Some((at / self.n_channels, at % self.n_channels, values[at]))
            }
            CountValues::Sparse(rows) => {
                let at = rows.values().iter().position(|&v| is_wrong(v))?;
                let (node, channel) = place(rows, at);
                Some((node, channel, rows.values()[at]))
            }
        }
    }

    /// Sum of each row.
    pub fn row_sums(&self) -> Vec<f64> {
        match self.values {
            CountValues::Dense(values) if self.n_channels > 0 => {
                values.par_chunks_exact(self.n_channels).map(|row| row.iter().sum()).collect()
            }
            CountValues::Dense(_) => Vec::new(),
            CountValues::Sparse(rows) => (0..rows.n_rows()).map(|x| rows.row(x).1.iter().sum()).collect(),
        }
    }

    /// Sum of each channel.
    pub fn channel_sums(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.n_channels];
        match self.values {
            CountValues::Dense(values) => {
                for row in values.chunks_exact(self.n_channels.max(1)) {
                    sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += v);
                }
            }
            CountValues::Sparse(rows) => {
                for (&y, v) in rows.columns().iter().zip(rows.values()) {
                    sums[y as usize] += v;
                }
            }
        }
        sums
    }

    /// Median of the positive row sums, the usual library size; 1 if there is none.
    pub fn median_row_sum(&self) -> f64 {
        let mut sums: Vec<f64> = self.row_sums().into_iter().filter(|&sum| sum > 0.0).collect();
        if sums.is_empty() {
            return 1.0;
        }
        sums.sort_unstable_by(f64::total_cmp);
        let middle = sums.len() / 2;
        if sums.len() % 2 == 1 { sums[middle] } else { 0.5 * (sums[middle - 1] + sums[middle]) }
    }

    /// Prefetches the values of a node that [`copy_row`](Self::copy_row) will read.
    pub(crate) fn fetch_row(&self, node: usize, channels: ChannelBlock<'_>) {
        if let (CountValues::Dense(values), [first, ..]) = (self.values, channels.channels)
            && channels.follow
        {
            fetch_values(values, node * self.n_channels + first, channels.channels.len());
        }
    }

    pub(crate) fn n_rows(&self) -> usize {
        match self.values {
            CountValues::Dense(values) => values.len() / self.n_channels.max(1),
            CountValues::Sparse(rows) => rows.n_rows(),
        }
    }

    /// Channels and values of a row, in the order of the channels, without zeros.
    pub(crate) fn entries(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let (dense, (columns, values)) = match self.values {
            CountValues::Dense(values) => {
                (&values[row * self.n_channels..][..self.n_channels], Default::default())
            }
            CountValues::Sparse(rows) => (Default::default(), rows.row(row)),
        };
        let stored = columns.iter().zip(values).map(|(&c, &v)| (c as usize, v));
        dense.iter().copied().enumerate().chain(stored).filter(|&(_, v)| v != 0.0)
    }

    /// Writes some channels of a row.
    pub(crate) fn copy_row(&self, node: usize, channels: ChannelBlock<'_>, out: &mut [f64]) {
        let ChannelBlock { channels, follow } = channels;
        match self.values {
            CountValues::Dense(values) => {
                let row = &values[node * self.n_channels..][..self.n_channels];
                if follow {
                    out.copy_from_slice(&row[channels[0]..][..channels.len()]);
                } else {
                    out.iter_mut().zip(channels).for_each(|(out, &c)| *out = row[c]);
                }
            }
            CountValues::Sparse(rows) => {
                let (columns, values) = rows.row(node);
                let mut at = columns.partition_point(|&y| (y as usize) < channels[0]);
                for (out, &c) in out.iter_mut().zip(channels) {
                    let c = c as u32;
                    // Channels mostly follow one another.
                    if at < columns.len() && columns[at] < c || at > 0 && columns[at - 1] >= c {
                        at = columns.partition_point(|&y| y < c);
                    }
                    let is_there = columns.get(at) == Some(&c);
                    *out = if is_there { values[at] } else { 0.0 };
                    at += usize::from(is_there);
                }
            }
        }
    }
}

/// Row and column of an entry.
fn place(rows: &CompressedRows<f64>, at: usize) -> (usize, usize) {
    (rows.offsets().partition_point(|&start| start <= at) - 1, rows.columns()[at] as usize)
}

/// Factors of the rows of a matrix.
#[derive(Debug)]
pub(crate) struct RowFactors(Option<Vec<f64>>);

impl RowFactors {
    pub(crate) fn new(
        counts: &CountMatrix<'_>,
        transformation: Transformation,
    ) -> Result<Self, GraphWalkError> {
        let Some(size) = transformation.library_size else { return Ok(Self(None)) };
        if !(size > 0.0 && size.is_finite()) {
            let name = "the library size";
            return Err(GraphWalkError::BadParameter {
                name,
                range: "greater than 0 and finite",
                value: size,
            });
        }
        let factor = |sum: f64| if sum > 0.0 { size / sum } else { 1.0 };
        Ok(Self(Some(counts.row_sums().into_iter().map(factor).collect())))
    }

    pub(crate) fn get(&self, node: usize) -> f64 {
        self.0.as_ref().map_or(1.0, |factors| factors[node])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparse_rows_are_read_like_dense_ones_in_any_order_of_channels() {
        let dense = [0.0, 2.0, 0.0, 5.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 4.0];
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in dense.chunks(4) {
            for (c, &v) in row.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                columns.push(c as u32);
                values.push(v);
            }
            offsets.push(columns.len());
        }
        let rows = CompressedRows::new(offsets, columns, values, 4).unwrap();
        let a = CountMatrix { values: CountValues::Dense(&dense), n_channels: 4 };
        let b = CountMatrix { values: CountValues::Sparse(&rows), n_channels: 4 };
        for channels in [vec![0, 1, 2, 3], vec![3, 0, 2], vec![1, 1], vec![2, 3, 1]] {
            for node in 0..3 {
                let (mut x, mut y) = (vec![0.0; channels.len()], vec![9.0; channels.len()]);
                a.copy_row(node, ChannelBlock::new(&channels), &mut x);
                b.copy_row(node, ChannelBlock::new(&channels), &mut y);
                assert_eq!(x, y, "{node} {channels:?}");
            }
        }
        assert_eq!(a.row_sums(), b.row_sums());
        assert_eq!(a.channel_sums(), b.channel_sums());
        assert_eq!(a.median_row_sum(), 7.0);
    }
}
