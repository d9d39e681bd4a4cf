//! Imputation of counts over a graph of cells: powers of its walk (`vandijk2018`), by blocks of genes.

use crate::count_matrix::{ChannelBlock, RowFactors};
use crate::powers::{LaneBlock, MOST_STEPS, blocks};
use crate::{CountMatrix, GraphWalkError, Transformation, WalkPowers};
use adwave::Progress;
use adwave::bands::{BandsParams, Schedule, Transform};
use adwave::operator::{Diffusion, Semigroup};

/// Relative accuracy of fractional powers.
const ACCURACY: f64 = 1e-10;

/// Values to impute: some channels of a matrix, after a transformation.
#[derive(Clone, Copy, Debug)]
pub struct ImputationInput<'a> {
    /// The matrix, nodes × channels.
    pub counts: CountMatrix<'a>,
    /// Transformation before diffusion.
    pub transformation: Transformation,
    /// Channels of the result, in its order.
    pub channels: &'a [usize],
}

/// Computes `P^steps X` of the transformed values into `out`, n_nodes × channels. Channels that are 0 everywhere stay 0.
/// O(entries·channels·steps), with three vectors of 32 channels beside the result.
///
/// A fractional number of steps needs a walk of symmetric weights that stays at least half of the time.
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
) -> Result<(), GraphWalkError> {
    let ImputationInput { counts, transformation, channels } = input;
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
    let fractional =
        if steps.fract() == 0.0 { None } else { Some(FractionalPower::new(powers, steps, progress)?) };
    let mut spare = None;
    for range in blocks(channels.len()) {
        progress.step(range.start as u64, channels.len() as u64)?;
        let these = ChannelBlock::new(&channels[range.clone()]);
        let mut block = powers.load(range.len(), spare.take(), |node, row| {
            counts.copy_row(node, these, row);
            let factor = factors.get(node);
            for v in row {
                *v *= factor;
                if transformation.square_root {
                    *v = v.sqrt();
                }
            }
        });
        match &fractional {
            Some(power) => power.apply(&mut block, progress)?,
            None => {
                for _ in 0..steps as u32 {
                    powers.step(&mut block, progress)?;
                }
            }
        }
        powers.store(&block, range, channels.len(), out);
        spare = Some(block);
    }
    Ok(progress.step(channels.len() as u64, channels.len() as u64)?)
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
    fn apply(&self, block: &mut LaneBlock, progress: Progress<'_>) -> Result<(), GraphWalkError> {
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
    fn fractional_steps_compose_and_are_refused_of_walks_that_need_not_stay() {
        let n = 60;
        let values: Vec<f64> = (0..n).map(noise).collect();
        let input = |values| ImputationInput {
            counts: CountMatrix { values: CountValues::Dense(values), n_channels: 1 },
            transformation: Transformation::default(),
            channels: &[0],
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
            impute(&powers, ImputationInput { counts, transformation, channels }, steps)
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
