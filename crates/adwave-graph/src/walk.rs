//! Walks: row-stochastic matrices with their diagonal, given or made from weights.

use crate::GraphWalkError;
use adwave::operator::Diffusion;
use adwave::rows::CompressedRows;
use adwave::{Progress, named_values};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Rows that a thread compares with their columns at a time, at least.
const ROWS_COMPARED: usize = 256;

/// Treatment of the diagonal of the weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum SelfLoops {
    /// The diagonal is left out.
    #[default]
    Remove,
    /// The diagonal is kept as given.
    Keep,
    /// The diagonal is replaced by this weight, ≥ 0. Kernels of the neighbors have the weight 1 at distance 0.
    Weight(f64),
}

impl SelfLoops {
    /// The treatment that a text names: `keep`, or a weight.
    pub fn from_text(text: &str) -> Option<Self> {
        if text == "keep" { Some(Self::Keep) } else { text.parse().ok().map(Self::Weight) }
    }
}

/// Rule that makes weights symmetric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Symmetrization {
    /// `½(W + Wᵀ)`.
    Mean,
    /// The larger of both directions.
    Maximum,
}

named_values!(Symmetrization, "symmetrize", {
    Mean => "mean", "The mean of both directions";
    Maximum => "maximum", "The larger of both directions";
});

/// Divisors that make a walk of weights W with the row sums D.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Normalization {
    /// `D⁻¹W`: rows sum to 1, values are averaged.
    #[default]
    Row,
    /// `WD⁻¹`: columns sum to 1 for symmetric weights, amounts are moved.
    Column,
    /// `D^(−½)WD^(−½)`, the symmetric matrix with the same eigenvalues.
    Symmetric,
}

named_values!(Normalization, "normalize", {
    Row => "row", "Rows sum to 1: values are averaged";
    Column => "column", "Columns sum to 1: amounts are moved";
    Symmetric => "symmetric", "Both by square roots";
});

/// Construction of a walk from weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WalkOptions {
    /// Diagonal of the weights.
    pub self_loops: SelfLoops,
    /// Rule that makes the weights symmetric; `None` takes them as they are. A walk on weights that are not symmetric
    /// is directed: powers and whole steps only.
    pub symmetrization: Option<Symmetrization>,
    /// Divisors.
    pub normalization: Normalization,
    /// Share of the steps that stay: the walk is `stay·I + (1 − stay)·P`, with stay in 0 … 1. At ½ the walk is that of
    /// the paper (eq. 4) and takes fractional steps.
    pub stay: f64,
}

/// A walk on the nodes of a graph, n_nodes × n_nodes, with its diagonal.
#[derive(Debug)]
pub struct WalkMatrix {
    rows: CompressedRows<f64>,
    transpose: OnceLock<CompressedRows<f64>>,
    normalization: Normalization,
    is_symmetric: bool,
    n_isolated: usize,
}

impl WalkMatrix {
    /// Walk on a graph with the given weights. A node without edges stays where it is. O(entries · log).
    ///
    /// # Errors
    /// [`GraphWalkError`] if the matrix is not square, a weight is negative or not finite, `stay` is out of range, a
    /// column or symmetric normalization is asked of weights that are not symmetric, or the call is cancelled.
    ///
    /// ```
    /// use adwave::{Progress, rows::CompressedRows};
    /// use adwave_graph::{WalkMatrix, WalkOptions};
    /// let path = CompressedRows::new(vec![0, 1, 3, 4], vec![1, 0, 2, 1], vec![1.0, 1.0, 3.0, 3.0], 3)?;
    /// let walk = WalkMatrix::from_weights(path, WalkOptions::default(), Progress::none())?;
    /// assert_eq!(walk.rows().row(1), ([0, 2].as_slice(), [0.25, 0.75].as_slice()));
    /// # Ok::<(), adwave_graph::GraphWalkError>(())
    /// ```
    pub fn from_weights(
        weights: CompressedRows<f64>,
        options: WalkOptions,
        progress: Progress<'_>,
    ) -> Result<Self, GraphWalkError> {
        let WalkOptions { self_loops, symmetrization, normalization, stay } = options;
        check_square(&weights)?;
        check_weights(&weights)?;
        if !(0.0..=1.0).contains(&stay) {
            let (name, range) = ("the share of steps that stay", "between 0 and 1");
            return Err(GraphWalkError::BadParameter { name, range, value: stay });
        }
        if let SelfLoops::Weight(value) = self_loops
            && !(value.is_finite() && value >= 0.0)
        {
            return Err(GraphWalkError::BadParameter {
                name: "the weight of loops",
                range: "finite and at least 0",
                value,
            });
        }
        progress.check()?;
        let weights = match symmetrization {
            None => weights,
            Some(Symmetrization::Mean) => merge(&weights, &transpose(&weights), |a, b| 0.5 * (a + b)),
            Some(Symmetrization::Maximum) => merge(&weights, &transpose(&weights), f64::max),
        };
        progress.check()?;
        let mut weights = with_loops(weights, self_loops);
        let asymmetry = first_asymmetry(&weights);
        if let Some((row, column)) = asymmetry
            && normalization != Normalization::Row
        {
            let (value, reverse) = (weights.get(row, column), weights.get(column, row));
            let purpose = if normalization == Normalization::Column {
                "column normalization"
            } else {
                "symmetric normalization"
            };
            return Err(GraphWalkError::NotSymmetric { row, column, value, reverse, purpose });
        }
        progress.check()?;
        // The largest weight of a row is taken out first, so that sums of huge or tiny weights neither overflow nor
        // vanish.
        let sums: Vec<f64> = (0..weights.n_rows()).map(|x| weights.row(x).1.iter().sum::<f64>()).collect();
        if let Some(row) = sums.iter().position(|sum| !sum.is_finite()) {
            return Err(GraphWalkError::BadWeight { row, column: row, value: sums[row] });
        }
        let n_isolated = (0..sums.len()).filter(|&x| is_isolated(&weights, x)).count();
        weights.visit_rows_mut(|x, columns, values| {
            for (w, &y) in values.iter_mut().zip(columns) {
                let there = sums[y as usize];
                *w = match normalization {
                    _ if *w == 0.0 => 0.0,
                    Normalization::Row => *w / sums[x],
                    Normalization::Column => *w / there,
                    Normalization::Symmetric => *w / (sums[x].sqrt() * there.sqrt()),
                };
            }
        });
        let rows = with_stays(weights, &sums, stay);
        let is_symmetric = asymmetry.is_none();
        Ok(Self { rows, transpose: OnceLock::new(), normalization, is_symmetric, n_isolated })
    }

    /// A walk as given: each row is ≥ 0 and sums to 1 within 1e-9, diagonal included. O(entries · log).
    ///
    /// # Errors
    /// [`GraphWalkError`] if the matrix is no walk, or the call is cancelled.
    pub fn from_probabilities(
        walk: CompressedRows<f64>,
        progress: Progress<'_>,
    ) -> Result<Self, GraphWalkError> {
        check_square(&walk)?;
        let diffusion = Diffusion::from_walk(&walk, progress)?;
        let n_isolated = (0..walk.n_rows()).filter(|&x| is_isolated(&walk, x)).count();
        let is_symmetric = diffusion.is_reversible();
        let normalization = Normalization::Row;
        Ok(Self { rows: walk, transpose: OnceLock::new(), normalization, is_symmetric, n_isolated })
    }

    /// The matrix of the walk.
    pub fn rows(&self) -> &CompressedRows<f64> {
        &self.rows
    }

    /// The transposed matrix, built on first use. O(entries).
    pub fn transposed(&self) -> &CompressedRows<f64> {
        self.transpose.get_or_init(|| transpose(&self.rows))
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.rows.n_rows()
    }

    /// Divisors of the walk.
    pub fn normalization(&self) -> Normalization {
        self.normalization
    }

    /// True if the walk is that of symmetric weights, so that its spectrum is real.
    pub fn is_reversible(&self) -> bool {
        self.is_symmetric
    }

    /// Number of nodes without an edge to another.
    pub fn n_isolated(&self) -> usize {
        self.n_isolated
    }

    /// Bytes of memory of the matrix.
    pub fn bytes(&self) -> u64 {
        self.rows.bytes() + self.transpose.get().map_or(0, CompressedRows::bytes)
    }
}

/// True if a row has no entry off its diagonal.
fn is_isolated(rows: &CompressedRows<f64>, x: usize) -> bool {
    let (columns, values) = rows.row(x);
    columns.iter().zip(values).all(|(&y, &w)| y as usize == x || w == 0.0)
}

fn check_square(rows: &CompressedRows<f64>) -> Result<(), GraphWalkError> {
    let n_rows = rows.n_rows();
    match rows.columns().iter().find(|&&y| y as usize >= n_rows) {
        Some(&column) => Err(GraphWalkError::NotSquare { n_rows, column: column as usize }),
        None => Ok(()),
    }
}

fn check_weights(rows: &CompressedRows<f64>) -> Result<(), GraphWalkError> {
    let Some(at) = rows.values().iter().position(|w| !(w.is_finite() && *w >= 0.0)) else { return Ok(()) };
    let row = rows.offsets().partition_point(|&start| start <= at) - 1;
    Err(GraphWalkError::BadWeight { row, column: rows.columns()[at] as usize, value: rows.values()[at] })
}

/// The transposed matrix, n × n. O(entries).
fn transpose(rows: &CompressedRows<f64>) -> CompressedRows<f64> {
    let n = rows.n_rows();
    let mut offsets = vec![0_usize; n + 1];
    for &y in rows.columns() {
        offsets[y as usize + 1] += 1;
    }
    for x in 0..n {
        offsets[x + 1] += offsets[x];
    }
    let mut next = offsets.clone();
    let (mut columns, mut values) = (vec![0; rows.nnz()], vec![0.0; rows.nnz()]);
    for x in 0..n {
        let (others, weights) = rows.row(x);
        for (&y, &w) in others.iter().zip(weights) {
            let at = &mut next[y as usize];
            (columns[*at], values[*at]) = (x as u32, w);
            *at += 1;
        }
    }
    CompressedRows::new(offsets, columns, values, n).expect("columns of a transposed matrix ascend")
}

/// Entry by entry `combine(a, b)` of two matrices, a missing entry counting as 0.
fn merge(
    a: &CompressedRows<f64>,
    b: &CompressedRows<f64>,
    combine: impl Fn(f64, f64) -> f64,
) -> CompressedRows<f64> {
    let n = a.n_rows();
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for x in 0..n {
        let ((left, left_values), (right, right_values)) = (a.row(x), b.row(x));
        let (mut i, mut k) = (0, 0);
        while let Some(column) = left.get(i).into_iter().chain(right.get(k)).copied().min() {
            let mut pair = [0.0; 2];
            if left.get(i) == Some(&column) {
                pair[0] = left_values[i];
                i += 1;
            }
            if right.get(k) == Some(&column) {
                pair[1] = right_values[k];
                k += 1;
            }
            columns.push(column);
            values.push(combine(pair[0], pair[1]));
        }
        offsets.push(columns.len());
    }
    CompressedRows::new(offsets, columns, values, n).expect("merged columns ascend")
}

/// The matrix with another diagonal.
fn with_loops(weights: CompressedRows<f64>, loops: SelfLoops) -> CompressedRows<f64> {
    let n = weights.n_rows();
    let diagonal = |value: f64| {
        let offsets = (0..=n).collect();
        CompressedRows::new(offsets, (0..n as u32).collect(), vec![value; n], n).expect("a diagonal")
    };
    match loops {
        SelfLoops::Keep => weights,
        SelfLoops::Remove if (0..n).all(|x| weights.get(x, x) == 0.0) => weights,
        SelfLoops::Remove | SelfLoops::Weight(0.0) => {
            let mut weights = weights;
            let at: Vec<usize> = (0..n)
                .filter_map(|x| {
                    let found = weights.row(x).0.binary_search(&(x as u32)).ok()?;
                    Some(weights.offsets()[x] + found)
                })
                .collect();
            for at in at {
                weights.values_mut()[at] = 0.0;
            }
            weights
        }
        SelfLoops::Weight(value) => {
            let removed = with_loops(weights, SelfLoops::Weight(0.0));
            merge(&removed, &diagonal(value), |a, b| a + b)
        }
    }
}

/// The walk `stay·I + (1 − stay)·P` without entries of 0; nodes of no weight stay.
fn with_stays(walk: CompressedRows<f64>, sums: &[f64], stay: f64) -> CompressedRows<f64> {
    let n = walk.n_rows();
    let is_complete = stay == 0.0 && sums.iter().all(|&sum| sum > 0.0) && !walk.values().contains(&0.0);
    if is_complete {
        return walk;
    }
    // Vectors that grow would need twice the memory for a moment.
    let most = walk.nnz() + n;
    let (mut offsets, mut columns, mut values) =
        (vec![0], Vec::with_capacity(most), Vec::with_capacity(most));
    for (x, &sum) in sums.iter().enumerate() {
        let (others, weights) = walk.row(x);
        let own = walk.get(x, x);
        let diagonal = if sum > 0.0 { stay + (1.0 - stay) * own } else { 1.0 };
        let before = others.partition_point(|&y| (y as usize) < x);
        let after = others.partition_point(|&y| y as usize <= x);
        let mut push = |y: u32, w: f64| {
            if w > 0.0 {
                columns.push(y);
                values.push(w);
            }
        };
        for (&y, &w) in others[..before].iter().zip(&weights[..before]) {
            push(y, (1.0 - stay) * w);
        }
        push(x as u32, diagonal);
        for (&y, &w) in others[after..].iter().zip(&weights[after..]) {
            push(y, (1.0 - stay) * w);
        }
        offsets.push(columns.len());
    }
    CompressedRows::new(offsets, columns, values, n).expect("columns stay in order")
}

/// Relative difference of two directions that counts as rounding.
const SYMMETRY_TOLERANCE: f64 = 1e-12;

/// First entry that differs from its reverse.
fn first_asymmetry(weights: &CompressedRows<f64>) -> Option<(usize, usize)> {
    let rows = (0..weights.n_rows()).into_par_iter().with_min_len(ROWS_COMPARED);
    rows.find_map_first(|x| {
        let (columns, values) = weights.row(x);
        let wrong = columns.iter().zip(values).find(|(y, w)| {
            let reverse = weights.get(**y as usize, x);
            (**w - reverse).abs() > SYMMETRY_TOLERANCE * w.max(reverse)
        })?;
        Some((x, *wrong.0 as usize))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[f64]]) -> CompressedRows<f64> {
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in rows {
            for (y, &w) in row.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                columns.push(y as u32);
                values.push(w);
            }
            offsets.push(columns.len());
        }
        CompressedRows::new(offsets, columns, values, rows.len()).unwrap()
    }

    fn walk(rows: &[&[f64]], options: WalkOptions) -> Result<WalkMatrix, GraphWalkError> {
        WalkMatrix::from_weights(matrix(rows), options, Progress::none())
    }

    const WEIGHTS: [&[f64]; 4] =
        [&[2.0, 1.0, 0.0, 0.0], &[1.0, 0.0, 3.0, 0.0], &[0.0, 3.0, 0.0, 0.0], &[0.0, 0.0, 0.0, 0.0]];

    #[test]
    fn normalizations_divide_by_the_row_sums_and_isolated_nodes_stay() {
        for normalization in [Normalization::Row, Normalization::Column, Normalization::Symmetric] {
            let options =
                WalkOptions { normalization, self_loops: SelfLoops::Keep, ..WalkOptions::default() };
            let walk = walk(&WEIGHTS, options).unwrap();
            let sums: [f64; 3] = [3.0, 4.0, 3.0];
            for (x, row) in WEIGHTS[..3].iter().enumerate() {
                for (y, w) in row[..3].iter().enumerate() {
                    let divisor = match normalization {
                        Normalization::Row => sums[x],
                        Normalization::Column => sums[y],
                        Normalization::Symmetric => (sums[x] * sums[y]).sqrt(),
                    };
                    assert!((walk.rows().get(x, y) - w / divisor).abs() < 1e-15);
                }
            }
            assert_eq!((walk.rows().get(3, 3), walk.n_isolated()), (1.0, 1));
        }
    }

    #[test]
    fn loops_are_removed_kept_or_replaced_and_stays_added() {
        let with = |self_loops, stay| {
            let options = WalkOptions { self_loops, stay, ..WalkOptions::default() };
            walk(&WEIGHTS, options).unwrap().rows().get(0, 0)
        };
        assert_eq!(with(SelfLoops::Remove, 0.0), 0.0);
        assert_eq!(with(SelfLoops::Keep, 0.0), 2.0 / 3.0);
        assert_eq!(with(SelfLoops::Weight(3.0), 0.0), 0.75);
        assert_eq!(with(SelfLoops::Remove, 0.5), 0.5);
    }

    #[test]
    fn directed_weights_are_found_and_symmetrized_on_request() {
        let one_way: [&[f64]; 2] = [&[1.0, 1.0], &[0.0, 1.0]];
        let options = WalkOptions { self_loops: SelfLoops::Keep, ..WalkOptions::default() };
        assert!(!walk(&one_way, options).unwrap().is_reversible());
        let column = WalkOptions { normalization: Normalization::Column, ..options };
        assert!(matches!(
            walk(&one_way, column),
            Err(GraphWalkError::NotSymmetric { row: 0, column: 1, .. })
        ));
        let mean =
            walk(&one_way, WalkOptions { symmetrization: Some(Symmetrization::Mean), ..options }).unwrap();
        assert!(mean.is_reversible());
        assert_eq!(mean.rows().get(1, 0), 0.5 / 1.5);
        let most = WalkOptions { symmetrization: Some(Symmetrization::Maximum), ..options };
        assert_eq!(walk(&one_way, most).unwrap().rows().get(1, 0), 0.5);
    }

    #[test]
    fn wrong_weights_are_refused() {
        let options = WalkOptions::default();
        assert!(matches!(
            walk(&[&[0.0, -1.0], &[-1.0, 0.0]], options),
            Err(GraphWalkError::BadWeight { row: 0, column: 1, value: -1.0 })
        ));
        assert!(walk(&[&[0.0, f64::NAN], &[1.0, 0.0]], options).is_err());
        assert!(walk(&[&[0.0, 1e308, 1e308], &[1e308, 0.0, 0.0], &[1e308, 0.0, 0.0]], options).is_err());
        let rectangle = CompressedRows::new(vec![0, 1], vec![1], vec![1.0], 2).unwrap();
        assert!(WalkMatrix::from_weights(rectangle, options, Progress::none()).is_err());
        for stay in [-0.1, 1.5, f64::NAN] {
            assert!(walk(&WEIGHTS, WalkOptions { stay, ..options }).is_err());
        }
        let short = matrix(&[&[0.5, 0.4], &[0.0, 1.0]]);
        let error = WalkMatrix::from_probabilities(short, Progress::none()).unwrap_err().to_string();
        assert!(error.contains("row 0") && error.contains("divide it by its sum"), "{error}");
    }

    #[test]
    fn bands_of_a_complete_graph_are_those_of_its_eigenvalue() {
        // The walk on K_n without stays has the eigenvalues 1 and −1/(n − 1).
        let n = 6;
        let rows: Vec<Vec<f64>> =
            (0..n).map(|x| (0..n).map(|y| if x == y { 0.0 } else { 1.0 }).collect()).collect();
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        for (stay, eigenvalue) in [(0.0, -0.2), (0.5, 0.4)] {
            let walk = walk(&rows, WalkOptions { stay, ..WalkOptions::default() }).unwrap();
            let decomposer = adwave::Decomposer::from_walk(walk.rows(), Progress::none()).unwrap();
            let signal = [3.0, -1.0, 4.0, 1.0, -5.0, 9.0];
            let mean = signal.iter().sum::<f64>() / 6.0;
            let schedule = adwave::bands::Schedule::new(vec![1, 2, 4, 7]).unwrap();
            let bands = decomposer.decompose(&signal, 1, &schedule).unwrap();
            for (j, pair) in [0.0, 1.0, 2.0, 4.0, 7.0].windows(2).enumerate() {
                let power = |t: f64| f64::powi(eigenvalue, t as i32);
                let exact = power(pair[0]) - power(pair[1]);
                for (found, f) in bands.wavelet(j + 1).iter().zip(signal) {
                    assert!((found - exact * (f - mean)).abs() < 1e-12, "{stay} {j}");
                }
            }
        }
    }
}
