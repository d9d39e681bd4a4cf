//! Diffusion time by molecular cross-validation (`batson2019`).
//!
//! The molecules of each count are split at random: a share p is diffused, the rest is compared with it. With the
//! factors c of the cells, train values a = c·A/p and test values b = c·B/(1 − p), the mean of `(Pᵗa − b)²` is the risk
//! of t plus the variance of b, which does not depend on t. All t come from one series of products.

use crate::channel_keys::mix;
use crate::count_matrix::{ChannelBlock, RowFactors};
use crate::lane_block::{LaneBlock, blocks};
use crate::{CountMatrix, GraphWalkError, Transformation, WalkPowers};
use adwave::Progress;
use adwave::rows::CompressedRows;
use rand_distr::{Binomial, Distribution};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;

/// Steps of the first attempt; the range doubles while the least error lies in its last quarter.
const FIRST_STEPS: u32 = 16;

/// Counts up to which molecules are drawn one by one.
const ONE_BY_ONE: f64 = 64.0;

/// Rows whose errors are summed together.
const ROWS_AT_A_TIME: usize = 1024;

/// Parameters of cross-validation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CrossValidationParams {
    /// Share of the molecules that are diffused, in 0.1 … 0.95.
    pub share: f64,
    /// Largest number of steps to try, at least 1.
    pub most_steps: u32,
    /// Number of channels to use, those with the largest sums.
    pub most_channels: usize,
    /// Library size of the cells, if values are compared after normalization.
    pub library_size: Option<f64>,
    /// Seed of the split.
    pub seed: u64,
}

impl CrossValidationParams {
    /// Sets [`share`](Self::share).
    #[must_use]
    pub fn with_share(self, share: f64) -> Self {
        Self { share, ..self }
    }

    /// Sets [`most_steps`](Self::most_steps).
    #[must_use]
    pub fn with_most_steps(self, most_steps: u32) -> Self {
        Self { most_steps, ..self }
    }

    /// Sets [`library_size`](Self::library_size).
    #[must_use]
    pub fn with_library_size(self, library_size: Option<f64>) -> Self {
        Self { library_size, ..self }
    }

    /// Sets [`seed`](Self::seed).
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}

impl Default for CrossValidationParams {
    fn default() -> Self {
        Self { share: 0.9, most_steps: 256, most_channels: 512, library_size: None, seed: 0 }
    }
}

/// Result of cross-validation.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossValidation {
    /// Number of steps of the least error.
    pub steps: u32,
    /// Mean squared error for 0, 1, 2, … steps.
    pub errors: Vec<f64>,
    /// Channels that were used.
    pub channels: Vec<usize>,
    /// True if the least error is that of the most steps.
    pub is_at_limit: bool,
}

/// Number of steps by molecular cross-validation of counts. O(entries·channels·steps).
///
/// # Errors
/// [`GraphWalkError`] if a value is no count (whole and ≥ 0), the matrix does not have a row per node, a parameter is
/// out of range, or the call is cancelled.
pub fn cross_validate(
    powers: &WalkPowers,
    counts: &CountMatrix<'_>,
    params: CrossValidationParams,
    progress: Progress<'_>,
) -> Result<CrossValidation, GraphWalkError> {
    counts.check(powers)?;
    if !(0.1..=0.95).contains(&params.share) {
        let (name, range) = ("the share of molecules that are diffused", "between 0.1 and 0.95");
        return Err(GraphWalkError::BadParameter { name, range, value: params.share });
    }
    if params.most_steps == 0 {
        return Err(GraphWalkError::BadParameter {
            name: "the largest number of steps",
            range: "at least 1",
            value: 0.0,
        });
    }
    if let Some((node, channel, value)) = counts.find(|v| !is_count(v)) {
        return Err(GraphWalkError::NotCount { node, channel, value });
    }
    let transformation = Transformation { library_size: params.library_size, square_root: false };
    let factors = RowFactors::new(counts, transformation)?;
    let channels = largest_channels(counts, params.most_channels);
    let mut most = FIRST_STEPS.min(params.most_steps);
    loop {
        let errors = errors(powers, counts, &channels, &factors, SplitRange { params, most }, progress)?;
        // Of equal errors the fewest steps.
        let steps = (0..errors.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0) as u32;
        if 4 * steps <= 3 * most || most == params.most_steps {
            let is_at_limit = steps == most && most == params.most_steps;
            return Ok(CrossValidation { steps, errors, channels, is_at_limit });
        }
        most = (2 * most).min(params.most_steps);
    }
}

/// The share of the counts that cross-validation diffuses, with the split of [`cross_validate`] for the same share and
/// seed.
///
/// A graph that was made from all counts knows the molecules that are held back, and the least error is then found too
/// early. Make the graph for cross-validation from these counts.
///
/// # Errors
/// [`GraphWalkError::NotCount`] if a value is no count.
///
/// ```
/// use adwave::rows::CompressedRows;
/// use adwave_graph::split_counts;
/// let counts = CompressedRows::new(vec![0, 2], vec![0, 3], vec![5.0, 100.0], 4)?;
/// let train = split_counts(&counts, 0.5, 1)?;
/// assert!(train.row(0).1.iter().zip([5.0, 100.0]).all(|(t, all)| *t >= 0.0 && *t <= all));
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn split_counts(
    counts: &CompressedRows<f64>,
    share: f64,
    seed: u64,
) -> Result<CompressedRows<f64>, GraphWalkError> {
    let mut train = counts.clone();
    for node in 0..counts.n_rows() {
        let (channels, values) = counts.row(node);
        let start = counts.offsets()[node];
        for (k, (&channel, &value)) in channels.iter().zip(values).enumerate() {
            if !is_count(value) {
                return Err(GraphWalkError::NotCount { node, channel: channel as usize, value });
            }
            let bits = hash(seed, node as u64, u64::from(channel));
            train.values_mut()[start + k] = draw_molecules(value, share, bits);
        }
    }
    Ok(train)
}

/// True for whole numbers of at least 0 that double precision counts exactly.
fn is_count(value: f64) -> bool {
    (0.0..=1e15).contains(&value) && value.fract() == 0.0
}

/// The channels with the largest sums, ascending; those without a count are left out.
fn largest_channels(counts: &CountMatrix<'_>, most: usize) -> Vec<usize> {
    let sums = counts.channel_sums();
    let mut channels: Vec<usize> = (0..sums.len()).filter(|&c| sums[c] > 0.0).collect();
    channels.sort_by(|&a, &b| sums[b].total_cmp(&sums[a]).then(a.cmp(&b)));
    channels.truncate(most.max(1));
    channels.sort_unstable();
    channels
}

/// The split, and the number of steps to try with it.
#[derive(Clone, Copy)]
struct SplitRange {
    params: CrossValidationParams,
    most: u32,
}

/// Mean squared error for 0 … `most` steps.
fn errors(
    powers: &WalkPowers,
    counts: &CountMatrix<'_>,
    channels: &[usize],
    factors: &RowFactors,
    split: SplitRange,
    progress: Progress<'_>,
) -> Result<Vec<f64>, GraphWalkError> {
    let SplitRange { params, most } = split;
    let share = params.share;
    let mut sums = vec![0.0; most as usize + 1];
    let (mut spare_train, mut spare_test) = (None, None);
    for range in blocks(channels.len()) {
        progress.step(range.start as u64, channels.len() as u64)?;
        let these = &channels[range];
        let block = ChannelBlock::new(these);
        let half = |is_test: bool, spare| {
            powers.load(these.len(), spare, &|node: usize, row: &mut [f64]| {
                counts.copy_row(node, block, row);
                let part = if is_test { 1.0 - share } else { share };
                for (v, &channel) in row.iter_mut().zip(these) {
                    let trained = draw_molecules(*v, share, hash(params.seed, node as u64, channel as u64));
                    let own = if is_test { *v - trained } else { trained };
                    *v = own / part * factors.get(node);
                }
            })
        };
        let (mut train, test) = (half(false, spare_train.take()), half(true, spare_test.take()));
        for (t, sum) in sums.iter_mut().enumerate() {
            if t > 0 {
                powers.step(&mut train, progress)?;
            }
            *sum += squared_difference(&train, &test);
        }
        (spare_train, spare_test) = (Some(train), Some(test));
    }
    let n_values = (powers.n_nodes() * channels.len()).max(1) as f64;
    Ok(sums.into_iter().map(|sum| sum / n_values).collect())
}

/// Sum of the squared differences, in chunks of fixed size.
fn squared_difference(a: &LaneBlock<f64>, b: &LaneBlock<f64>) -> f64 {
    let len = ROWS_AT_A_TIME * a.lanes;
    let parts: Vec<f64> = a
        .now
        .par_chunks(len)
        .zip(b.now.par_chunks(len))
        .map(|(a, b)| {
            let mut sums = [0.0; 4];
            for (a, b) in a.chunks(4).zip(b.chunks(4)) {
                for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
                    *sum += (a - b) * (a - b);
                }
            }
            sums.iter().sum::<f64>()
        })
        .collect();
    parts.into_iter().sum()
}

/// Mixes a seed, a node and a channel to 64 random bits.
fn hash(seed: u64, node: u64, channel: u64) -> u64 {
    mix(mix(mix(seed).wrapping_add(node)).wrapping_add(channel))
}

/// Number of `count` molecules that are drawn with probability `share`.
fn draw_molecules(count: f64, share: f64, bits: u64) -> f64 {
    if count == 0.0 {
        return 0.0;
    }
    if count <= ONE_BY_ONE {
        let mut state = bits;
        let mut found = 0;
        for _ in 0..count as u32 {
            state = mix(state);
            found += u32::from((state >> 11) as f64 * (1.0 / (1_u64 << 53) as f64) < share);
        }
        return f64::from(found);
    }
    let mut random = Pcg64Mcg::seed_from_u64(bits);
    let law = Binomial::new(count as u64, share).expect("the share is a probability");
    law.sample(&mut random) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::powers::tests::noise;
    use crate::{CountValues, WalkMatrix, WalkOptions};

    #[test]
    fn the_split_has_the_mean_and_variance_of_a_binomial() {
        for (count, share) in [(7.0, 0.9), (60.0, 0.5), (500.0, 0.3)] {
            let n = 20_000;
            let found: Vec<f64> = (0..n).map(|i| draw_molecules(count, share, hash(5, i, 3))).collect();
            let mean = found.iter().sum::<f64>() / n as f64;
            let variance = found.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64;
            let exact = count * share * (1.0 - share);
            assert!((mean - count * share).abs() < 4.0 * (exact / n as f64).sqrt(), "{mean}");
            assert!((variance / exact - 1.0).abs() < 0.06, "{variance} for {exact}");
            assert!(found.iter().all(|&v| (0.0..=count).contains(&v)));
        }
    }

    /// Smooth expression on a ring of cells, and Poisson counts of a mean depth.
    fn ring(n: usize, n_genes: usize, depth: f64) -> (WalkPowers, Vec<f64>, Vec<f64>) {
        let mut entries = Vec::new();
        for x in 0..n as u32 {
            for step in 1..=3 {
                let y = (x + step) % n as u32;
                entries.extend([(x, y, 1.0), (y, x, 1.0)]);
            }
        }
        entries.sort_by_key(|e| (e.0, e.1));
        let weights = CompressedRows::from_sorted(n, n, entries).unwrap();
        let options = WalkOptions { stay: 0.25, ..WalkOptions::default() };
        let walk = WalkMatrix::from_weights(weights, options, Progress::none()).unwrap();
        let mut random = Pcg64Mcg::seed_from_u64(9);
        let (mut truth, mut counts) = (Vec::new(), Vec::new());
        for x in 0..n {
            for g in 0..n_genes {
                let turns = f64::from(1 + g as u32 % 5);
                let angle = std::f64::consts::TAU * (turns * x as f64 / n as f64 + noise(g));
                let mean = depth * (1.0 + 0.8 * angle.sin()) * (1.1 + noise(g + 99));
                truth.push(mean);
                counts.push(rand_distr::Poisson::new(mean.max(1e-9)).unwrap().sample(&mut random));
            }
        }
        (WalkPowers::new(walk, Progress::none()).unwrap(), truth, counts)
    }

    #[test]
    fn the_chosen_time_is_within_two_percent_of_the_least_error_at_three_depths() {
        for depth in [0.3, 2.0, 20.0] {
            let (n, n_genes) = (1200, 60);
            let (powers, truth, counts) = ring(n, n_genes, depth);
            let matrix = CountMatrix { values: CountValues::Dense(&counts), n_channels: n_genes };
            let params = CrossValidationParams { most_steps: 512, ..CrossValidationParams::default() };
            let found = cross_validate(&powers, &matrix, params, Progress::none()).unwrap();
            let mut now: LaneBlock<f64> = powers.load(1, None, &|_: usize, _: &mut [f64]| ());
            let mut oracle = vec![0.0; found.errors.len()];
            for g in 0..n_genes {
                now =
                    powers.load(1, None, &|node: usize, row: &mut [f64]| row[0] = counts[node * n_genes + g]);
                for (t, error) in oracle.iter_mut().enumerate() {
                    if t > 0 {
                        powers.step(&mut now, Progress::none()).unwrap();
                    }
                    for (v, &node) in now.now.iter().zip(powers.node_at()) {
                        *error += (v - truth[node as usize * n_genes + g]).powi(2);
                    }
                }
            }
            drop(now);
            let least = oracle.iter().copied().fold(f64::INFINITY, f64::min);
            let excess = oracle[found.steps as usize] / least - 1.0;
            assert!(excess < 0.02, "depth {depth}: {} steps, {excess}", found.steps);
            assert!(!found.is_at_limit);
        }
    }

    #[test]
    fn values_that_are_no_counts_are_refused() {
        let (powers, _, counts) = ring(10, 3, 1.0);
        let refused = |change: f64, params| {
            let mut wrong = counts.clone();
            wrong[4] += change;
            let matrix = CountMatrix { values: CountValues::Dense(&wrong), n_channels: 3 };
            cross_validate(&powers, &matrix, params, Progress::none()).unwrap_err().to_string()
        };
        let params = CrossValidationParams::default();
        assert!(refused(0.5, params).contains("raw counts"));
        assert!(refused(-1e6, params).contains("value 1 of node 1"));
        assert!(refused(0.0, CrossValidationParams { share: 1.0, ..params }).contains("share"));
        assert!(refused(0.0, CrossValidationParams { most_steps: 0, ..params }).contains("steps"));
    }
}
