//! Imputation of counts over a graph of cells: powers of its walk (`vandijk2018`), by blocks of genes.

use crate::count_matrix::{ChannelBlock, RowFactors};
use crate::lane_block::{LaneBlock, RowSource, blocks};
use crate::lane_rows::LaneNumber;
use crate::powers::MOST_STEPS;
use crate::{CountMatrix, GraphWalkError, Transformation, WalkAccuracy, WalkPowers};
use adwave::Progress;
use adwave::bands::{BandsParams, Precision, Schedule, Transform};
use adwave::operator::{Diffusion, Semigroup};
use rayon::prelude::*;

/// Relative accuracy of fractional powers.
const ACCURACY: f64 = 1e-10;

/// Channels of equal times that are processed together.
const CHANNELS_AT_A_TIME: usize = 128;

/// Values to impute: some channels of a matrix, after a transformation.
#[derive(Clone, Copy, Debug)]
pub struct ImputationInput<'a> {
    /// The matrix, nodes × channels.
    pub counts: CountMatrix<'a>,
    /// Transformation before diffusion.
    pub transformation: Transformation,
    /// Channels of the result, in its order.
    pub channels: &'a [usize],
    /// Number format of the products. A fractional number of steps takes double precision.
    pub precision: Precision,
}

/// Computes `P^steps X` of the transformed values into `out`, n_nodes × channels. Channels that are 0 everywhere
/// stay 0. O(entries·channels·steps), with two vectors of 32 channels beside the result.
///
/// A fractional number of steps needs a walk of symmetric weights that stays at least half of the time.
///
/// The error bound is relative to `P^steps |X|`, value by value. For values of at least 0, such as counts, it bounds
/// the relative error of each value, except that values below 1e-28 of the largest of their channel may vanish in
/// single precision. For a fractional number of steps it is relative to the norm of a channel.
///
/// # Errors
/// [`GraphWalkError`] if the matrix does not have a row per node or lacks a channel, a value is not finite, or negative
/// before a square root, the steps are out of range or fractional where they must be whole, or the call is cancelled.
///
/// # Panics
/// Unless `out` has n_nodes × channels values.
pub fn impute_into(
    powers: &WalkPowers,
    input: ImputationInput<'_>,
    steps: f64,
    out: &mut [f64],
    progress: Progress<'_>,
) -> Result<WalkAccuracy, GraphWalkError> {
    let ImputationInput { counts, transformation, channels, precision } = input;
    counts.check(powers)?;
    check_channels(channels, counts.n_channels)?;
    assert_eq!(out.len(), powers.n_nodes() * channels.len(), "the output has a value per node and channel");
    if !(0.0..=f64::from(MOST_STEPS)).contains(&steps) {
        return Err(GraphWalkError::BadSteps { steps, most: MOST_STEPS });
    }
    if transformation.square_root
        && let Some((node, channel, value)) = counts.find(|v| v < 0.0)
    {
        return Err(GraphWalkError::NegativeValue { node, channel, value });
    }
    let factors = RowFactors::new(&counts, transformation)?;
    if steps.fract() != 0.0 {
        let power = FractionalPower::new(powers, steps, progress)?;
        diffuse::<f64>(powers, input, &factors, |block| power.apply(block, progress), out, progress)?;
        return Ok(WalkAccuracy { precision: Precision::Double, error_bound: ACCURACY });
    }
    let steps = steps as u32;
    let accuracy = WalkAccuracy::choose(precision, |precision| powers.power_bound(precision, steps));
    if accuracy.precision == Precision::Single {
        let walk = |block: &mut LaneBlock<f32>| whole_steps(powers, block, steps, progress);
        diffuse(powers, input, &factors, walk, out, progress)?;
    } else {
        let walk = |block: &mut LaneBlock<f64>| whole_steps(powers, block, steps, progress);
        diffuse(powers, input, &factors, walk, out, progress)?;
    }
    Ok(accuracy)
}

/// Computes `P^t X` as [`impute_into`] with a number of steps of its own for each channel of the input, in its order.
///
/// The accuracy is that of the most steps.
///
/// # Errors
/// As for [`impute_into`].
///
/// # Panics
/// Unless there is a number of steps per channel, and `out` has n_nodes × channels values.
///
/// ```
/// use adwave::{Progress, bands::Precision, rows::CompressedRows};
/// use adwave_graph::{
///     CountMatrix, CountValues, ImputationInput, Transformation, WalkMatrix, WalkPowers, impute_by_channel_into,
/// };
/// let swap = CompressedRows::new(vec![0, 1, 2], vec![1, 0], vec![1.0, 1.0], 2)?;
/// let powers = WalkPowers::new(WalkMatrix::from_probabilities(swap, Progress::none())?, Progress::none())?;
/// let counts = CountMatrix { values: CountValues::Dense(&[1.0, 2.0, 3.0, 4.0]), n_channels: 2 };
/// let transformation = Transformation::default();
/// let input = ImputationInput { counts, transformation, channels: &[0, 1], precision: Precision::Double };
/// let mut out = [0.0; 4];
/// impute_by_channel_into(&powers, input, &[2, 1], &mut out, Progress::none())?;
/// assert_eq!(out, [1.0, 4.0, 3.0, 2.0]);
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn impute_by_channel_into(
    powers: &WalkPowers,
    input: ImputationInput<'_>,
    steps: &[u32],
    out: &mut [f64],
    progress: Progress<'_>,
) -> Result<WalkAccuracy, GraphWalkError> {
    let n_channels = input.channels.len();
    assert_eq!(steps.len(), n_channels, "a number of steps per channel");
    assert_eq!(out.len(), powers.n_nodes() * n_channels, "the output has a value per node and channel");
    let mut order: Vec<usize> = (0..n_channels).collect();
    order.sort_by_key(|&i| (steps[i], i));
    let most = order.last().map_or(0, |&i| steps[i]);
    let (mut channels, mut values, mut n_done) = (Vec::new(), Vec::new(), 0);
    for group in order.chunk_by(|&a, &b| steps[a] == steps[b]) {
        for places in group.chunks(CHANNELS_AT_A_TIME) {
            progress.step(n_done as u64, n_channels as u64)?;
            channels.clear();
            channels.extend(places.iter().map(|&i| input.channels[i]));
            values.resize(powers.n_nodes() * places.len(), 0.0);
            let part = ImputationInput { channels: &channels, ..input };
            impute_into(powers, part, f64::from(steps[places[0]]), &mut values, progress.quiet())?;
            out.par_chunks_mut(n_channels).zip(values.par_chunks(places.len())).for_each(|(out, row)| {
                places.iter().zip(row).for_each(|(&i, v)| out[i] = *v);
            });
            n_done += places.len();
        }
    }
    progress.step(n_channels as u64, n_channels as u64)?;
    Ok(WalkAccuracy::choose(input.precision, |precision| powers.power_bound(precision, most)))
}

fn whole_steps<T: LaneNumber>(
    powers: &WalkPowers,
    block: &mut LaneBlock<T>,
    steps: u32,
    progress: Progress<'_>,
) -> Result<(), GraphWalkError> {
    for _ in 0..steps {
        powers.step(block, progress)?;
    }
    Ok(())
}

/// Applies `walk` to all channels, block by block.
fn diffuse<T: LaneNumber>(
    powers: &WalkPowers,
    input: ImputationInput<'_>,
    factors: &RowFactors,
    walk: impl Fn(&mut LaneBlock<T>) -> Result<(), GraphWalkError>,
    out: &mut [f64],
    progress: Progress<'_>,
) -> Result<(), GraphWalkError> {
    let ImputationInput { counts, transformation, channels, .. } = input;
    let mut spare = None;
    for range in blocks(channels.len()) {
        progress.step(range.start as u64, channels.len() as u64)?;
        let these = ChannelBlock::new(&channels[range.clone()]);
        let rows = TransformedRows { counts, channels: these, transformation, factors };
        let mut block: LaneBlock<T> = powers.load(range.len(), spare.take(), &rows);
        walk(&mut block)?;
        powers.store(block.rows(), range, channels.len(), out);
        spare = Some(block);
    }
    Ok(progress.step(channels.len() as u64, channels.len() as u64)?)
}

/// Some channels of a matrix after a transformation.
struct TransformedRows<'a> {
    counts: CountMatrix<'a>,
    channels: ChannelBlock<'a>,
    transformation: Transformation,
    factors: &'a RowFactors,
}

impl RowSource for TransformedRows<'_> {
    fn fill(&self, node: usize, row: &mut [f64]) {
        self.counts.copy_row(node, self.channels, row);
        let factor = self.factors.get(node);
        for v in row {
            *v *= factor;
            if self.transformation.square_root {
                *v = v.sqrt();
            }
        }
    }

    fn fetch(&self, node: usize) {
        self.counts.fetch_row(node, self.channels);
    }
}

fn check_channels(channels: &[usize], n_channels: usize) -> Result<(), GraphWalkError> {
    match channels.iter().find(|&&c| c >= n_channels) {
        None => Ok(()),
        Some(&c) => Err(GraphWalkError::BadParameter {
            name: "a channel",
            range: "one of the columns, counted from 0",
            value: c as f64,
        }),
    }
}

/// A fractional power of a lazy walk, by Chebyshev series with a bound of the error.
struct FractionalPower {
    transform: Transform,
    schedule: Schedule,
}

impl FractionalPower {
    fn new(powers: &WalkPowers, steps: f64, progress: Progress<'_>) -> Result<Self, GraphWalkError> {
        let diffusion = Diffusion::from_walk(powers.ordered_rows(), progress)?;
        let reason = match (diffusion.is_reversible(), diffusion.semigroup()) {
            (false, _) => "is directed",
            (true, Semigroup::Steps) => {
                let transform = Transform::new(diffusion, &BandsParams::default().with_accuracy(ACCURACY))?;
                return Ok(Self { transform, schedule: Schedule::real(vec![steps])? });
            }
            (true, _) => "need not stay where it is",
        };
        Err(GraphWalkError::WholeSteps { steps, reason })
    }

    /// Replaces the values of a block by their power.
    fn apply(&self, block: &mut LaneBlock<f64>, progress: Progress<'_>) -> Result<(), GraphWalkError> {
        let mut change = vec![0.0; block.now.len()];
        self.transform.weighted_into(
            &block.now,
            block.lanes,
            &self.schedule,
            &[1.0],
            &mut change,
            progress,
        )?;
        block.now.iter_mut().zip(&change).for_each(|(now, w)| *now -= w);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CountValues;
    use crate::powers::tests::{noise, powers};
    use adwave::rows::CompressedRows;

    fn impute(
        powers: &WalkPowers,
        input: ImputationInput<'_>,
        steps: f64,
    ) -> Result<Vec<f64>, GraphWalkError> {
        let mut out = vec![0.0; powers.n_nodes() * input.channels.len()];
        impute_into(powers, input, steps, &mut out, Progress::none())?;
        Ok(out)
    }

    fn counts(n: usize, n_channels: usize) -> Vec<f64> {
        // Channel 2 is expressed nowhere.
        (0..n * n_channels)
            .map(|i| if i % n_channels == 2 { 0.0 } else { (4.0 * noise(i)).max(0.0).floor() })
            .collect()
    }

    #[test]
    fn sparse_and_dense_counts_give_the_same_bits_and_selected_genes_those_of_all() {
        let (n, n_channels) = (90, 41);
        let powers = powers(n, 0.0);
        let values = counts(n, n_channels);
        let (mut offsets, mut columns, mut entries) = (vec![0], Vec::new(), Vec::new());
        for row in values.chunks(n_channels) {
            for (c, &v) in row.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                columns.push(c as u32);
                entries.push(v);
            }
            offsets.push(columns.len());
        }
        let sparse = CompressedRows::new(offsets, columns, entries, n_channels).unwrap();
        let all: Vec<usize> = (0..n_channels).collect();
        let transformation = Transformation { library_size: Some(100.0), square_root: true };
        let input = |values| ImputationInput {
            counts: CountMatrix { values, n_channels },
            transformation,
            channels: &all,
            precision: Precision::Double,
        };
        let dense = impute(&powers, input(CountValues::Dense(&values)), 3.0).unwrap();
        assert_eq!(impute(&powers, input(CountValues::Sparse(&sparse)), 3.0).unwrap(), dense);
        assert!(dense.iter().skip(2).step_by(n_channels).all(|&v| v == 0.0));
        let some = ImputationInput { channels: &[40, 3], ..input(CountValues::Dense(&values)) };
        let selected = impute(&powers, some, 3.0).unwrap();
        for x in 0..n {
            assert_eq!(selected[2 * x..][..2], [dense[x * n_channels + 40], dense[x * n_channels + 3]]);
        }
        assert_eq!(impute(&powers, some, 0.0).unwrap()[0], {
            let sum: f64 = values[..n_channels].iter().sum();
            (values[40] * (100.0 / sum)).sqrt()
        });
    }

    #[test]
    fn single_precision_keeps_to_its_bound_at_each_value() {
        for (n, n_channels) in [(90, 41), (2500, 5)] {
            let powers = powers(n, 0.0);
            let values = counts(n, n_channels);
            let all: Vec<usize> = (0..n_channels).collect();
            for steps in [0.0, 1.0, 8.0] {
                let with = |precision| {
                    let counts = CountMatrix { values: CountValues::Dense(&values), n_channels };
                    let transformation = Transformation { library_size: Some(1e4), square_root: true };
                    let input = ImputationInput { counts, transformation, channels: &all, precision };
                    let mut out = vec![0.0; values.len()];
                    (impute_into(&powers, input, steps, &mut out, Progress::none()).unwrap(), out)
                };
                let ((accuracy, double), (single_accuracy, single)) =
                    (with(Precision::Double), with(Precision::Single));
                let bound = single_accuracy.error_bound;
                assert!(accuracy.error_bound < 1e-11 && bound < 6e-8 * (steps + 1.0), "{bound:e}");
                let errors = double.iter().zip(&single).map(|(a, b)| ((a - b).abs(), bound * a));
                let largest = errors.fold(0.0, |most: f64, (error, allowed)| {
                    assert!(error <= allowed, "{error:e} {allowed:e}");
                    most.max(error)
                });
                assert!(largest > 0.0);
            }
        }
    }

    #[test]
    fn fractional_steps_compose_and_are_refused_of_walks_that_need_not_stay() {
        let n = 60;
        let values: Vec<f64> = (0..n).map(noise).collect();
        let input = |values| ImputationInput {
            counts: CountMatrix { values: CountValues::Dense(values), n_channels: 1 },
            transformation: Transformation::default(),
            channels: &[0],
            precision: Precision::Double,
        };
        let lazy = powers(n, 0.5);
        let half = impute(&lazy, input(&values), 0.5).unwrap();
        let once = impute(&lazy, input(&half), 0.5).unwrap();
        for (a, b) in once.iter().zip(impute(&lazy, input(&values), 1.0).unwrap()) {
            assert!((a - b).abs() < 1e-8, "{a} {b}");
        }
        let plain = powers(n, 0.0);
        let error = impute(&plain, input(&values), 0.5).unwrap_err().to_string();
        assert!(error.contains("whole steps"), "{error}");
    }

    #[test]
    fn wrong_values_are_refused() {
        let powers = powers(4, 0.0);
        let refused = |values: &[f64], square_root, steps: f64, channels: &[usize]| {
            let counts = CountMatrix { values: CountValues::Dense(values), n_channels: 2 };
            let transformation = Transformation { library_size: None, square_root };
            let precision = Precision::Double;
            impute(&powers, ImputationInput { counts, transformation, channels, precision }, steps)
                .unwrap_err()
                .to_string()
        };
        let good = [1.0; 8];
        let negative = [1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0, 1.0];
        assert!(refused(&negative, true, 1.0, &[0]).contains("node 1"));
        assert!(refused(&good[..6], false, 1.0, &[0]).contains("one row per node"));
        assert!(refused(&good, false, -1.0, &[0]).contains("between 0"));
        assert!(refused(&good, false, f64::NAN, &[0]).contains("between 0"));
        assert!(refused(&good, false, 1.0, &[2]).contains("channel"));
    }
}
