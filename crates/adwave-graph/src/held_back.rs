//! Channels that a graph has not seen, and how well other cells predict them.

use crate::channel_keys::mix;
use crate::count_matrix::{ChannelBlock, RowFactors};
use crate::lane_block::{LaneBlock, blocks};
use crate::lanes::MAX_LANES;
use crate::{CountMatrix, CountValues, GraphWalkError, Transformation, WalkPowers};
use adwave::Progress;
use rayon::prelude::*;

/// Random signs by which return probabilities are estimated.
const PROBES: usize = MAX_LANES;

/// Largest return probability: a cell that is always back cannot be predicted by others.
const MOST_RETURNS: f64 = 0.98;

/// Rows whose errors are summed together.
const ROWS_AT_A_TIME: usize = 256;

/// Values of some channels, nodes × channels, after a transformation.
pub(crate) struct HeldBack {
    values: Vec<f64>,
    /// Sum of the squared differences from the mean of each channel.
    spreads: Vec<f64>,
}

/// Unexplained shares of channels at 1, 2, … steps.
pub(crate) struct Curves(Vec<Vec<f64>>);

impl Curves {
    /// The shares of all channels at a number of steps.
    pub(crate) fn unexplained(&self, steps: u32) -> &[f64] {
        &self.0[steps as usize - 1]
    }

    pub(crate) fn most_steps(&self) -> u32 {
        self.0.len() as u32
    }

    /// Mean over the channels for each number of steps from 1 on.
    pub(crate) fn losses(&self) -> Vec<f64> {
        self.0.iter().map(|shares| shares.iter().sum::<f64>() / shares.len().max(1) as f64).collect()
    }

    /// Number of steps of the least loss, of equal ones the fewest.
    pub(crate) fn best_steps(&self) -> u32 {
        let losses = self.losses();
        1 + (0..losses.len()).min_by(|&a, &b| losses[a].total_cmp(&losses[b])).unwrap_or(0) as u32
    }
}

impl HeldBack {
    /// Some channels of a matrix after a transformation.
    pub(crate) fn new(
        counts: &CountMatrix<'_>,
        channels: &[usize],
        transformation: Transformation,
    ) -> Result<Self, GraphWalkError> {
        let n = match counts.values {
            CountValues::Dense(values) => values.len() / counts.n_channels.max(1),
            CountValues::Sparse(rows) => rows.n_rows(),
        };
        let factors = RowFactors::new(counts, transformation)?;
        let block = ChannelBlock::new(channels);
        let mut values = vec![0.0; n * channels.len()];
        for (x, row) in values.chunks_exact_mut(channels.len().max(1)).enumerate() {
            counts.copy_row(x, block, row);
            for v in row {
                *v *= factors.get(x);
                if transformation.square_root {
                    *v = v.sqrt();
                }
            }
        }
        let spread = |c: usize| {
            let column = || values.iter().skip(c).step_by(channels.len());
            let mean = column().sum::<f64>() / n.max(1) as f64;
            column().map(|v| (v - mean).powi(2)).sum::<f64>()
        };
        let spreads = (0..channels.len()).map(spread).collect();
        Ok(Self { values, spreads })
    }

    fn n_channels(&self) -> usize {
        self.spreads.len()
    }

    /// Unexplained shares for 1 … `most` steps. With `patience` the curve ends when the loss has not fallen for so many
    /// steps.
    pub(crate) fn curves(
        &self,
        powers: &WalkPowers,
        most: u32,
        patience: Option<u32>,
        progress: Progress<'_>,
    ) -> Result<Curves, GraphWalkError> {
        let n_channels = self.n_channels();
        let mut pairs: Vec<(usize, LaneBlock<f64>, LaneBlock<f64>)> = blocks(n_channels)
            .map(|range| {
                let (first, width) = (range.start, range.len());
                let fill = |node: usize, row: &mut [f64]| {
                    row.copy_from_slice(&self.values[node * n_channels + first..][..width]);
                };
                (first, powers.load(width, None, &fill), powers.load(width, None, &fill))
            })
            .collect();
        let mut returns = ReturnProbabilities::new(powers);
        let mut curves = Curves(Vec::new());
        for t in 1..=most {
            let factors = returns.next(powers, progress)?;
            let mut shares = vec![0.0; n_channels];
            for (first, now, given) in &mut pairs {
                powers.step(now, progress)?;
                let sums = squared_differences(now, given, &factors);
                for (c, sum) in (*first..).zip(&sums[..now.width]) {
                    let spread = self.spreads[c];
                    shares[c] = if spread > 0.0 { sum / spread } else { 1.0 };
                }
            }
            curves.0.push(shares);
            if patience.is_some_and(|patience| t >= curves.best_steps() + patience) {
                break;
            }
        }
        Ok(curves)
    }
}

/// Explained share of each channel of a matrix after a number of steps; `None` for channels that do not vary.
pub(crate) fn explained_shares(
    powers: &WalkPowers,
    counts: &CountMatrix<'_>,
    transformation: Transformation,
    steps: u32,
    progress: Progress<'_>,
) -> Result<Vec<Option<f64>>, GraphWalkError> {
    let mut returns = ReturnProbabilities::new(powers);
    let mut factors = Vec::new();
    for _ in 0..steps {
        factors = returns.next(powers, progress)?;
    }
    let mut found = Vec::with_capacity(counts.n_channels);
    for range in blocks(counts.n_channels) {
        let values = HeldBack::new(counts, &range.clone().collect::<Vec<_>>(), transformation)?;
        let width = range.len();
        let fill = |node: usize, row: &mut [f64]| {
            row.copy_from_slice(&values.values[node * width..][..width]);
        };
        let (mut now, given) = (powers.load(width, None, &fill), powers.load(width, None, &fill));
        for _ in 0..steps {
            powers.step(&mut now, progress)?;
        }
        let sums = squared_differences(&now, &given, &factors);
        let share = |(sum, spread): (&f64, &f64)| (*spread > 0.0).then(|| 1.0 - sum / spread);
        found.extend(sums.iter().zip(&values.spreads).map(share));
    }
    Ok(found)
}

/// Sum over the rows of the squared differences of each lane times the factor of the row, in chunks of fixed size.
fn squared_differences(a: &LaneBlock<f64>, b: &LaneBlock<f64>, factors: &[f64]) -> [f64; MAX_LANES] {
    let len = ROWS_AT_A_TIME * a.lanes;
    let parts: Vec<[f64; MAX_LANES]> = a
        .now
        .par_chunks(len)
        .zip(b.now.par_chunks(len))
        .zip(factors.par_chunks(ROWS_AT_A_TIME))
        .map(|((a_rows, b_rows), factors)| {
            let mut sums = [0.0; MAX_LANES];
            let rows = a_rows.chunks_exact(a.lanes).zip(b_rows.chunks_exact(a.lanes));
            for ((a, b), factor) in rows.zip(factors) {
                for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
                    *sum += factor * (a - b) * (a - b);
                }
            }
            sums
        })
        .collect();
    let mut total = [0.0; MAX_LANES];
    for part in &parts {
        total.iter_mut().zip(part).for_each(|(total, sum)| *total += sum);
    }
    total
}

/// Probabilities h of being back after 1, 2, … steps of a reversible walk, by the place of a node.
///
/// With the symmetric walk S = D^½PD^(−½) and random signs z, `h_{2s} = E(Sˢz)²` and `h_{2s+1} = E(Sˢz)(Sˢ⁺¹z)`; the
/// first is read from the diagonal.
struct ReturnProbabilities {
    signs: LaneBlock<f64>,
    /// Roots of the row sums of the weights, D^½.
    roots: Vec<f64>,
    before: Vec<f64>,
    steps: u32,
}

impl ReturnProbabilities {
    /// Signs by the numbers of the nodes. Loops must have the weight 1.
    fn new(powers: &WalkPowers) -> Self {
        let rows = powers.ordered_rows();
        let roots: Vec<f64> = (0..rows.n_rows()).map(|x| rows.get(x, x).sqrt().recip()).collect();
        let place_of = powers.place_of();
        let signs = powers.load(PROBES, None, &|node: usize, row: &mut [f64]| {
            let (bits, root) = (mix(node as u64), roots[place_of[node] as usize]);
            for (c, v) in row.iter_mut().enumerate() {
                *v = if bits >> c & 1 == 1 { 1.0 / root } else { -1.0 / root };
            }
        });
        Self { before: signs.now.to_vec(), signs, roots, steps: 0 }
    }

    /// `1/(1 − h)²` of the next number of steps.
    fn next(&mut self, powers: &WalkPowers, progress: Progress<'_>) -> Result<Vec<f64>, GraphWalkError> {
        self.steps += 1;
        if self.steps % 2 == 1 {
            // From S^s to S^{s+1}: the product of both is the odd power.
            self.before.copy_from_slice(&self.signs.now);
            powers.step(&mut self.signs, progress)?;
        }
        let lanes = self.signs.lanes;
        let other = if self.steps % 2 == 1 { &self.before[..] } else { &self.signs.now[..] };
        let rows = self.signs.now.par_chunks_exact(lanes).zip(other.par_chunks_exact(lanes));
        let is_first = self.steps == 1;
        Ok(rows
            .zip(&self.roots)
            .map(|((a, b), root)| {
                let mean = a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / PROBES as f64;
                let h = if is_first { (root * root).recip() } else { root * root * mean };
                (1.0 - h.clamp(0.0, MOST_RETURNS)).powi(-2)
            })
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SelfLoops, WalkMatrix, WalkOptions};
    use adwave::rows::CompressedRows;

    /// A path with loops and a few chords.
    fn path(n: usize) -> WalkPowers {
        let mut entries = Vec::new();
        for x in 0..n as u32 {
            for (y, w) in [(x + 1, 1.0), (x + 7, 0.5)] {
                if (y as usize) < n {
                    entries.extend([(x, y, w), (y, x, w)]);
                }
            }
        }
        entries.sort_by_key(|e| (e.0, e.1));
        let weights = CompressedRows::from_sorted(n, n, entries).unwrap();
        let options = WalkOptions { self_loops: SelfLoops::Weight(1.0), ..WalkOptions::default() };
        let walk = WalkMatrix::from_weights(weights, options, Progress::none()).unwrap();
        WalkPowers::new(walk, Progress::none()).unwrap()
    }

    #[test]
    fn return_probabilities_are_the_diagonal_of_the_powers_on_average() {
        let n = 400;
        let powers = path(n);
        let mut returns = ReturnProbabilities::new(&powers);
        let mut exact = vec![0.0; n * n];
        (0..n).for_each(|x| exact[x * n + x] = 1.0);
        for t in 1..=6 {
            let before = exact.clone();
            powers.apply_into(&before, n, 1, &mut exact, Progress::none()).unwrap();
            let factors = returns.next(&powers, Progress::none()).unwrap();
            let (mut sum, mut sum_exact, mut worst) = (0.0, 0.0, 0.0_f64);
            for (place, factor) in factors.iter().enumerate() {
                let node = powers.node_at()[place] as usize;
                let (h, e) = (1.0 - factor.sqrt().recip(), exact[node * n + node]);
                sum += h;
                sum_exact += e;
                worst = worst.max((h - e).abs());
            }
            // 32 signs: a relative deviation of √(2/32) for a node, of 1/√(32·400) for the sum.
            let allowed = if t == 1 { 1e-12 } else { 0.05 };
            assert!((sum / sum_exact - 1.0).abs() < allowed, "{t}: {sum} {sum_exact}");
            assert!(worst < if t == 1 { 1e-12 } else { 0.45 }, "{t}: {worst}");
        }
    }

    #[test]
    fn one_step_predicts_a_value_by_its_neighbors_alone() {
        let n = 60;
        let powers = path(n);
        let values: Vec<f64> = (0..n).map(|x| (mix(x as u64) % 7) as f64).collect();
        let counts = CountMatrix { values: CountValues::Dense(&values), n_channels: 1 };
        let held = HeldBack::new(&counts, &[0], Transformation::default()).unwrap();
        let curves = held.curves(&powers, 1, None, Progress::none()).unwrap();
        let rows = powers.walk().rows();
        let mean = values.iter().sum::<f64>() / n as f64;
        let spread: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let mut error = 0.0;
        for x in 0..n {
            let others = rows.row(x).0.iter().zip(rows.row(x).1).filter(|(y, _)| **y as usize != x);
            let (sum, weight) =
                others.fold((0.0, 0.0), |(s, w), (&y, p)| (s + p * values[y as usize], w + p));
            error += (values[x] - sum / weight).powi(2);
        }
        assert!((curves.unexplained(1)[0] - error / spread).abs() < 1e-10);
        let shares =
            explained_shares(&powers, &counts, Transformation::default(), 1, Progress::none()).unwrap();
        assert!((shares[0].unwrap() - (1.0 - error / spread)).abs() < 1e-10);
    }
}
