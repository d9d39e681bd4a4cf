//! Principal components of counts, by subspace iteration on sparse rows (`halko2011`).
//!
//! Counts v of a cell with the sum n become √(v/n) or ln(1 + m·v/n), m the median of n. With the means of the
//! channels subtracted, the first right singular vectors V of the matrix R give the coordinates RV. The mean is
//! subtracted within the products, so that the matrix stays sparse. Cells with equal shares of all channels have equal
//! coordinates.

use crate::channel_keys::{channel_keys, mix};
use crate::{CountMatrix, GraphWalkError};
use adwave::pages::zeros;
use adwave::rows::CompressedRows;
use adwave::{Progress, named_values};
use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

/// Columns of the subspace beyond the components that are asked for.
const SPARE: usize = 10;

/// Products with RᵀR.
const PASSES: usize = 5;

/// Most parts into which the rows are divided for sums over all rows.
const MOST_PARTS: usize = 16;

/// Rows of a part, at least.
const ROWS_OF_PART: usize = 512;

/// Variance relative to the squared mean below which a channel is constant.
const CONSTANT: f64 = 1e-20;

/// Values of the channels whose principal components are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ComponentScaling {
    /// Square roots of the shares of a cell: large channels count more where they vary more.
    #[default]
    Shares,
    /// Logarithms, each channel divided by its standard deviation: all channels count the same.
    EqualGenes,
}

named_values!(ComponentScaling, "scaling", {
    Shares => "shares", "Square roots of the shares of a cell";
    EqualGenes => "equal-genes", "Logarithms, each gene divided by its standard deviation";
});

/// Coordinates of cells, and the part of the variance that they have.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    /// Coordinates, n_nodes × n_components, by falling variance.
    pub coordinates: Vec<f64>,
    /// Number of components.
    pub n_components: usize,
}

impl Components {
    /// Coordinates in the first components alone, n_nodes × `n_components`.
    #[must_use]
    pub fn first(&self, n_components: usize) -> Vec<f64> {
        let kept = n_components.min(self.n_components);
        self.coordinates
            .chunks(self.n_components.max(1))
            .flat_map(|row| row[..kept].iter().copied())
            .collect()
    }
}

/// Coordinates of the rows of a matrix of counts in its first principal components, O(entries·components).
///
/// There are at most n_nodes − 1 and at most n_channels − 1 components, but at least one.
///
/// # Errors
/// [`GraphWalkError`] if a value is negative or not finite, or the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// use adwave_graph::{ComponentScaling, CountMatrix, CountValues, principal_components};
/// let counts = CountMatrix { values: CountValues::Dense(&[4.0, 0.0, 0.0, 4.0, 4.0, 0.0]), n_channels: 2 };
/// let found = principal_components(&counts, ComponentScaling::Shares, 1, Progress::none())?;
/// let [a, b, c] = found.coordinates[..] else { panic!() };
/// assert!(a == c && ((a - b).abs() - 2.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn principal_components(
    counts: &CountMatrix<'_>,
    scaling: ComponentScaling,
    n_components: usize,
    progress: Progress<'_>,
) -> Result<Components, GraphWalkError> {
    if let Some((node, channel, value)) = counts.find(|v| !(v >= 0.0 && v.is_finite())) {
        return Err(GraphWalkError::NoComponents { node, channel, value });
    }
    let all = vec![true; counts.n_channels];
    let keys = channel_keys(counts);
    let centered = CenteredRows::new(counts, &all, scaling);
    let n_components = n_components.min(centered.most_components());
    centered.components(n_components, &keys, progress)
}

/// Transformed values of some channels, with the means of the channels.
pub(crate) struct CenteredRows {
    rows: CompressedRows<f64>,
    means: Vec<f64>,
}

impl CenteredRows {
    /// Transforms the channels that are kept; all others are 0.
    pub(crate) fn new(counts: &CountMatrix<'_>, is_kept: &[bool], scaling: ComponentScaling) -> Self {
        let mut rows = sparse_rows(counts, is_kept);
        let totals: Vec<f64> =
            (0..rows.n_rows()).into_par_iter().map(|x| rows.row(x).1.iter().sum()).collect();
        let mut positive: Vec<f64> = totals.iter().copied().filter(|&total| total > 0.0).collect();
        positive.sort_unstable_by(f64::total_cmp);
        let median = positive.get(positive.len() / 2).copied().unwrap_or(1.0);
        let transform = |share: f64| match scaling {
            ComponentScaling::Shares => share.sqrt(),
            ComponentScaling::EqualGenes => (median * share).ln_1p(),
        };
        // Quotients are rounded once, so that equal shares are equal numbers.
        rows.visit_rows_mut(|x, _, values| values.iter_mut().for_each(|v| *v = transform(*v / totals[x])));
        let mut means = means(&rows);
        if scaling == ComponentScaling::EqualGenes {
            let factors = inverse_deviations(&rows, &means);
            rows.visit_rows_mut(|_, columns, values| {
                values.iter_mut().zip(columns).for_each(|(v, &c)| *v *= factors[c as usize]);
            });
            means.iter_mut().zip(&factors).for_each(|(mean, factor)| *mean *= factor);
        }
        Self { rows, means }
    }

    /// Largest number of components of the matrix, at least 1.
    pub(crate) fn most_components(&self) -> usize {
        self.rows.n_rows().min(self.rows.n_columns()).saturating_sub(1).max(1)
    }

    /// The first components. Channels with equal keys start with equal values.
    pub(crate) fn components(
        &self,
        n_components: usize,
        keys: &[u64],
        progress: Progress<'_>,
    ) -> Result<Components, GraphWalkError> {
        let width = (n_components + SPARE).min(self.rows.n_columns().max(1));
        let mut basis: Vec<f64> = keys
            .iter()
            .flat_map(|&key| (0..width).map(move |c| 2.0 * unit_number(mix(key) ^ c as u64) - 1.0))
            .collect();
        orthonormalize(&mut basis, width);
        for pass in 0..PASSES {
            progress.step(pass as u64, PASSES as u64)?;
            let scores = self.forward(&basis, width);
            basis = self.backward(&scores, width);
            orthonormalize(&mut basis, width);
        }
        let scores = self.forward(&basis, width);
        let gram = DMatrix::from_fn(width, width, |i, j| {
            scores.chunks_exact(width).map(|row| row[i] * row[j]).sum::<f64>()
        });
        let eigen = SymmetricEigen::new(gram);
        let mut order: Vec<usize> = (0..width).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let kept = n_components.min(width);
        let rotate = |row: &[f64], out: &mut [f64]| {
            for (out, &c) in out.iter_mut().zip(&order[..kept]) {
                *out = row.iter().enumerate().map(|(i, v)| v * eigen.eigenvectors[(i, c)]).sum();
            }
        };
        let mut coordinates = vec![0.0; self.rows.n_rows() * kept];
        coordinates
            .par_chunks_mut(kept.max(1))
            .zip(scores.par_chunks(width))
            .for_each(|(out, row)| rotate(row, out));
        progress.step(PASSES as u64, PASSES as u64)?;
        Ok(Components { coordinates, n_components: kept })
    }

    /// `(R − 1mᵀ)V`, n_nodes × width, of V, n_channels × width.
    fn forward(&self, basis: &[f64], width: usize) -> Vec<f64> {
        let mut middle = vec![0.0; width];
        for (row, mean) in basis.chunks_exact(width).zip(&self.means) {
            middle.iter_mut().zip(row).for_each(|(sum, v)| *sum += mean * v);
        }
        let mut out = vec![0.0; self.rows.n_rows() * width];
        out.par_chunks_exact_mut(width).enumerate().for_each(|(x, out)| {
            let (columns, values) = self.rows.row(x);
            for (&c, &value) in columns.iter().zip(values) {
                let row = &basis[c as usize * width..][..width];
                out.iter_mut().zip(row).for_each(|(out, v)| *out += value * v);
            }
            out.iter_mut().zip(&middle).for_each(|(out, v)| *out -= v);
        });
        out
    }

    /// `(R − 1mᵀ)ᵀU`, n_channels × width, of U, n_nodes × width. Parts of fixed size are summed in their order.
    fn backward(&self, scores: &[f64], width: usize) -> Vec<f64> {
        let n_products = self.rows.n_columns() * width;
        let mut out = sum_over_rows(self.rows.n_rows(), n_products + width, |x, sums| {
            let (out, sums) = sums.split_at_mut(n_products);
            let score = &scores[x * width..][..width];
            sums.iter_mut().zip(score).for_each(|(sum, v)| *sum += v);
            let (columns, values) = self.rows.row(x);
            for (&c, &value) in columns.iter().zip(values) {
                let row = &mut out[c as usize * width..][..width];
                row.iter_mut().zip(score).for_each(|(out, v)| *out += value * v);
            }
        });
        let total = out.split_off(n_products);
        for (row, mean) in out.chunks_exact_mut(width).zip(&self.means) {
            row.iter_mut().zip(&total).for_each(|(out, total)| *out -= mean * total);
        }
        out
    }
}

/// A number in 0 … 1 of 64 random bits.
fn unit_number(bits: u64) -> f64 {
    (mix(bits) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The entries of the channels that are kept, without zeros.
fn sparse_rows(counts: &CountMatrix<'_>, is_kept: &[bool]) -> CompressedRows<f64> {
    let n = counts.n_rows();
    let kept = |x: usize| counts.entries(x).filter(|&(c, _)| is_kept[c]);
    let n_entries: Vec<usize> = (0..n).into_par_iter().map(|x| kept(x).count()).collect();
    let mut offsets = vec![0; n + 1];
    for x in 0..n {
        offsets[x + 1] = offsets[x] + n_entries[x];
    }
    // Each thread fills its own rows, whose places are known: growing lists would take twice the memory.
    let mut columns: Vec<u32> = zeros(offsets[n]);
    let mut free = columns.as_mut_slice();
    let mut places = Vec::with_capacity(n);
    for n_entries in n_entries {
        let (row, after) = std::mem::take(&mut free).split_at_mut(n_entries);
        places.push(row);
        free = after;
    }
    let fill =
        |(x, row): (usize, &mut [u32])| row.iter_mut().zip(kept(x)).for_each(|(to, (c, _))| *to = c as u32);
    places.into_par_iter().enumerate().for_each(fill);
    let values = zeros(columns.len());
    let mut rows = CompressedRows::new(offsets, columns, values, counts.n_channels).expect("rows in order");
    rows.visit_rows_mut(|x, _, values| values.iter_mut().zip(kept(x)).for_each(|(to, (_, v))| *to = v));
    rows
}

/// Sums over all rows of what `add(x, sums)` adds to `n_sums` of them, part after part of a fixed size.
fn sum_over_rows(n_rows: usize, n_sums: usize, add: impl Fn(usize, &mut [f64]) + Sync) -> Vec<f64> {
    let length = n_rows.div_ceil(MOST_PARTS).max(ROWS_OF_PART);
    let part = |first: usize| {
        let mut sums = vec![0.0; n_sums];
        (first..(first + length).min(n_rows)).for_each(|x| add(x, &mut sums));
        sums
    };
    let parts: Vec<Vec<f64>> = (0..n_rows).into_par_iter().step_by(length).map(part).collect();
    let mut total = vec![0.0; n_sums];
    for part in &parts {
        total.iter_mut().zip(part).for_each(|(total, v)| *total += v);
    }
    total
}

/// Mean of each column.
fn means(rows: &CompressedRows<f64>) -> Vec<f64> {
    let sums = sum_over_rows(rows.n_rows(), rows.n_columns(), |x, sums| {
        let (columns, values) = rows.row(x);
        columns.iter().zip(values).for_each(|(&c, v)| sums[c as usize] += v);
    });
    let n = rows.n_rows().max(1) as f64;
    sums.iter().map(|sum| sum / n).collect()
}

/// Inverse of the standard deviation of each column; 0 for a constant one.
fn inverse_deviations(rows: &CompressedRows<f64>, means: &[f64]) -> Vec<f64> {
    let n = rows.n_rows() as f64;
    let mut squares = sum_over_rows(rows.n_rows(), 2 * means.len(), |x, sums| {
        let (squares, n_entries) = sums.split_at_mut(means.len());
        let (columns, values) = rows.row(x);
        for (&c, v) in columns.iter().zip(values) {
            squares[c as usize] += (v - means[c as usize]).powi(2);
            n_entries[c as usize] += 1.0;
        }
    });
    let n_entries = squares.split_off(means.len());
    let inverse = |c: usize| {
        let mean: f64 = means[c];
        let variance = (squares[c] + (n - n_entries[c]) * mean * mean) / n;
        if variance > CONSTANT * mean * mean { 1.0 / variance.sqrt() } else { 0.0 }
    };
    (0..means.len()).map(inverse).collect()
}

/// Makes the columns of an n × width array orthonormal by modified Gram–Schmidt, twice; dependent columns become 0.
fn orthonormalize(basis: &mut [f64], width: usize) {
    let n = basis.len() / width.max(1);
    let mut columns: Vec<Vec<f64>> =
        (0..width).map(|c| basis.iter().skip(c).step_by(width).copied().collect()).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for c in 0..width {
        let (before, rest) = columns.split_at_mut(c);
        let column = &mut rest[0];
        let size = dot(column, column).sqrt();
        for _ in 0..2 {
            for other in before.iter() {
                let along = dot(other, column);
                column.iter_mut().zip(other).for_each(|(v, o)| *v -= along * o);
            }
        }
        let left = dot(column, column).sqrt();
        let factor = if left > 1e-12 * size { 1.0 / left } else { 0.0 };
        for v in column {
            *v *= factor;
        }
    }
    for x in 0..n {
        for (c, column) in columns.iter().enumerate() {
            basis[x * width + c] = column[x];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CountValues;

    /// Counts of three kinds of cells, with a constant channel and one without a count.
    fn counts(n: usize, n_channels: usize) -> Vec<f64> {
        let value = |x: usize, c: usize| match c {
            0 => 0.0,
            _ => ((mix((x * n_channels + c) as u64) % 5) * u64::from(c % 3 == x % 3)) as f64 + (c % 4) as f64,
        };
        (0..n).flat_map(|x| (0..n_channels).map(move |c| value(x, c))).collect()
    }

    #[test]
    fn components_are_those_of_the_dense_singular_values() {
        let (n, n_channels, k) = (60, 25, 4);
        let values = counts(n, n_channels);
        let matrix = CountMatrix { values: CountValues::Dense(&values), n_channels };
        for scaling in ComponentScaling::ALL {
            let found = principal_components(&matrix, *scaling, k, Progress::none()).unwrap();
            let mut dense = DMatrix::from_row_slice(n, n_channels, &values);
            let totals: Vec<f64> = dense.row_iter().map(|row| row.sum()).collect();
            let mut sorted = totals.clone();
            sorted.sort_unstable_by(f64::total_cmp);
            for (mut row, total) in dense.row_iter_mut().zip(&totals) {
                row.apply(|v| {
                    *v = match scaling {
                        ComponentScaling::Shares => (*v / total).sqrt(),
                        ComponentScaling::EqualGenes => (*v / total * sorted[n / 2] + 1.0).ln(),
                    }
                });
            }
            for mut column in dense.column_iter_mut() {
                let mean = column.mean();
                column.add_scalar_mut(-mean);
                let deviation = (column.norm_squared() / n as f64).sqrt();
                if *scaling == ComponentScaling::EqualGenes && deviation > 1e-9 {
                    column /= deviation;
                }
            }
            let svd = dense.svd(true, false);
            let u = svd.u.unwrap();
            let largest = svd.singular_values[0];
            for a in 0..n {
                for b in 0..n {
                    let ours: f64 =
                        (0..k).map(|c| found.coordinates[a * k + c] * found.coordinates[b * k + c]).sum();
                    let exact: f64 =
                        (0..k).map(|c| u[(a, c)] * u[(b, c)] * svd.singular_values[c].powi(2)).sum();
                    // Subspace iteration separates the last component from the next by their ratio to the power 10.
                    assert!((ours - exact).abs() < 0.02 * largest, "{scaling:?} {ours} {exact}");
                }
            }
        }
    }

    #[test]
    fn equal_shares_have_equal_coordinates_and_constant_counts_none() {
        let (n, n_channels) = (30, 12);
        let mut values = counts(n, n_channels);
        for c in 0..n_channels {
            values[7 * n_channels + c] = 3.0 * values[2 * n_channels + c];
        }
        for scaling in ComponentScaling::ALL {
            let matrix = CountMatrix { values: CountValues::Dense(&values), n_channels };
            let found = principal_components(&matrix, *scaling, 5, Progress::none()).unwrap();
            assert_eq!(found.coordinates[2 * 5..3 * 5], found.coordinates[7 * 5..8 * 5]);
            for same in [0.0, 2.0] {
                let same = vec![same; n * n_channels];
                let matrix = CountMatrix { values: CountValues::Dense(&same), n_channels };
                let found = principal_components(&matrix, *scaling, 3, Progress::none()).unwrap();
                assert!(found.coordinates.iter().all(|v| v.abs() < 1e-12), "{scaling:?}");
            }
        }
        let bad = CountMatrix { values: CountValues::Dense(&[1.0, -1.0]), n_channels: 1 };
        assert!(principal_components(&bad, ComponentScaling::Shares, 1, Progress::none()).is_err());
    }
}
