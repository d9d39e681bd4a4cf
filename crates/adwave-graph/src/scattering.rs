//! Geometric scattering (`gao2019`): bands, their absolute values, and the bands of these.

use crate::lane_block::{AHEAD, BandRows, LaneBlock, SignalRows, blocks};
use crate::lane_rows::{LaneNumber, LaneRows};
use crate::lanes::{MAX_LANES, ROWS_AT_A_TIME, lanes};
use crate::powers::check_scales;
use crate::{GraphWalkError, Normalization, WalkAccuracy, WalkPowers};
use adwave::bands::Precision;
use adwave::pages::zeros;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Range;

/// Scales and orders of scattering.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ScatteringParams {
    /// Numbers of steps n_1 < n_2 < …; the bands are `P^{n_{j−1}} − P^{n_j}` with n_0 = 0.
    pub scales: Vec<u32>,
    /// Orders of the result, of 0, 1 and 2.
    pub orders: Vec<u32>,
    /// Number format of the products.
    pub precision: Precision,
    /// Largest memory of the result in bytes.
    pub max_bytes: Option<u64>,
}

impl Default for ScatteringParams {
    fn default() -> Self {
        Self {
            scales: vec![1, 2, 4, 8, 16],
            orders: vec![0, 1, 2],
            precision: Precision::Double,
            max_bytes: None,
        }
    }
}

/// Scattering coefficients of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Scattering {
    /// Coefficients, n_paths × n_nodes × n_channels.
    pub values: Vec<f64>,
    /// Bands of each path, from 1: none for the signal, j for `|W_j f|`, j and j′ > j for `|W_{j′}|W_j f||`.
    pub paths: Vec<Vec<u32>>,
    /// Number format of the products, and a bound of the error of the paths. The bound is relative to a norm of each
    /// channel of the signal: the largest size of a value for a walk with normalized rows, the sum of the sizes for
    /// normalized columns, and the root of the sum of the squares for the symmetric walk.
    pub accuracy: WalkAccuracy,
}

impl ScatteringParams {
    /// Sets [`scales`](Self::scales).
    #[must_use]
    pub fn with_scales(self, scales: Vec<u32>) -> Self {
        Self { scales, ..self }
    }

    /// Sets [`orders`](Self::orders).
    #[must_use]
    pub fn with_orders(self, orders: Vec<u32>) -> Self {
        Self { orders, ..self }
    }

    /// Sets [`precision`](Self::precision).
    #[must_use]
    pub fn with_precision(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }

    /// Sets [`max_bytes`](Self::max_bytes).
    #[must_use]
    pub fn with_max_bytes(self, max_bytes: Option<u64>) -> Self {
        Self { max_bytes, ..self }
    }

    /// Paths of the result: the signal, then `|W_j f|`, then `|W_{j′}|W_j f||` with j′ > j, in ascending order.
    ///
    /// ```
    /// use adwave_graph::ScatteringParams;
    /// let params = ScatteringParams::default().with_scales(vec![1, 2, 4]);
    /// assert_eq!(params.paths(), [vec![], vec![1], vec![2], vec![3], vec![1, 2], vec![1, 3], vec![2, 3]]);
    /// ```
    pub fn paths(&self) -> Vec<Vec<u32>> {
        let n = self.scales.len() as u32;
        let mut paths = Vec::new();
        if self.orders.contains(&0) {
            paths.push(Vec::new());
        }
        if self.orders.contains(&1) {
            paths.extend((1..=n).map(|j| vec![j]));
        }
        if self.orders.contains(&2) {
            paths.extend((1..=n).flat_map(|j| (j + 1..=n).map(move |k| vec![j, k])));
        }
        paths
    }
}

/// Scattering coefficients of order 0 (the signal), 1 (`|W_j f|`) and 2 (`|W_{j′}|W_j f||`, j′ > j), n_paths × n_nodes
/// × n_channels. O(entries·channels·n_J·J).
///
/// # Errors
/// [`GraphWalkError`] if the signal has the wrong length or a value that is not finite, scales do not increase, an
/// order does not exist, the result is too large, or the call is cancelled.
///
/// ```
/// use adwave::{Progress, rows::CompressedRows};
/// use adwave_graph::{ScatteringParams, WalkMatrix, WalkPowers, scatter};
/// let swap = CompressedRows::new(vec![0, 1, 2], vec![1, 0], vec![1.0, 1.0], 2)?;
/// let powers = WalkPowers::new(WalkMatrix::from_probabilities(swap, Progress::none())?, Progress::none())?;
/// let params = ScatteringParams::default().with_scales(vec![1]).with_orders(vec![1]);
/// assert_eq!(scatter(&powers, &[1.0, 3.0], 1, &params, Progress::none())?.values, [2.0, 2.0]); // |(I − P)f|
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn scatter(
    powers: &WalkPowers,
    signal: &[f64],
    n_channels: usize,
    params: &ScatteringParams,
    progress: Progress<'_>,
) -> Result<Scattering, GraphWalkError> {
    powers.check_signal(signal, n_channels)?;
    check_scales(&params.scales)?;
    if let Some(&order) = params.orders.iter().find(|&&order| order > 2) {
        return Err(GraphWalkError::BadOrder(order));
    }
    let paths = params.paths();
    let (len, n_scales) = (signal.len(), params.scales.len());
    let needed = (paths.len() as u64).saturating_mul(8 * len as u64);
    if let Some(limit) = params.max_bytes
        && needed > limit
    {
        let advice = "scatter fewer channels at a time, or pool them graph by graph";
        return Err(GraphWalkError::TooLarge { needed, limit, advice });
    }
    let mut values = zeros::<f64>(paths.len() * len);
    let has = |order: u32| params.orders.contains(&order);
    if has(0) {
        values[..len].copy_from_slice(signal);
    }
    let bound = |precision| match (has(1), has(2)) {
        (false, false) => 0.0,
        (_, with_second) => powers.bands_bound(precision, &params.scales, with_second),
    };
    let accuracy = WalkAccuracy::choose(params.precision, bound);
    if !signal.is_empty() && (has(1) || has(2)) {
        let second_at = if has(1) { n_scales * len } else { 0 };
        let (first, second) = values[usize::from(has(0)) * len..].split_at_mut(second_at);
        let out = Outputs { first, second, n_channels };
        match accuracy.precision {
            Precision::Single => scatter_blocks::<f32>(powers, signal, &params.scales, out, progress)?,
            _ => scatter_blocks::<f64>(powers, signal, &params.scales, out, progress)?,
        }
    }
    Ok(Scattering { values, paths, accuracy })
}

/// Coefficients of the first and second order of all channels, paths × nodes × channels each; empty for none.
struct Outputs<'a> {
    first: &'a mut [f64],
    second: &'a mut [f64],
    n_channels: usize,
}

/// Computes both orders, block by block of the channels.
fn scatter_blocks<T: LaneNumber>(
    powers: &WalkPowers,
    signal: &[f64],
    scales: &[u32],
    out: Outputs<'_>,
    progress: Progress<'_>,
) -> Result<(), GraphWalkError> {
    let Outputs { first, second, n_channels } = out;
    for channels in blocks(n_channels) {
        progress.step(channels.start as u64, n_channels as u64)?;
        let middles = middles::<T>(powers, signal, channels.clone(), n_channels);
        let rows = SignalRows { middles, ..SignalRows::new(signal, n_channels, channels.clone()) };
        let block: LaneBlock<T> = powers.load(channels.len(), None, &rows);
        let units = *block.units();
        let width = channels.len();
        // The coarsest band has no second order.
        let n_lanes = if second.is_empty() { 0 } else { (scales.len() - 1) * width };
        let mut sizes = BandSizes::new(powers.n_nodes(), n_lanes);
        powers.visit_bands(block, scales, progress, |level, band| {
            if let Some(out) = first.chunks_exact_mut(signal.len()).nth(level) {
                powers.store(band.sizes(), channels.clone(), n_channels, out);
            }
            sizes.keep(level * width, width, band);
        })?;
        for (index, rows) in sizes.blocks.into_iter().enumerate() {
            let first_lane = index * MAX_LANES;
            let lanes = (first_lane..n_lanes.min(first_lane + MAX_LANES)).map(|at| BandChannel {
                level: at / width,
                channel: channels.start + at % width,
                unit: units[at % width],
            });
            let out = SecondOrder { values: second, n_channels };
            second_order(powers, rows, &lanes.collect::<Vec<_>>(), scales, out, progress)?;
        }
    }
    Ok(())
}

/// The middle of the range of each channel, which in single precision is subtracted: bands of a walk with normalized
/// rows do not change, and their error is relative to the range instead of the values.
fn middles<T: LaneNumber>(
    powers: &WalkPowers,
    signal: &[f64],
    channels: Range<usize>,
    n_channels: usize,
) -> [f64; MAX_LANES] {
    const NOTHING: [[f64; MAX_LANES]; 2] = [[f64::INFINITY; MAX_LANES], [f64::NEG_INFINITY; MAX_LANES]];
    let mut middles = [0.0; MAX_LANES];
    if !T::IS_SINGLE || powers.walk().normalization() != Normalization::Row {
        return middles;
    }
    let rows = signal.par_chunks(ROWS_AT_A_TIME * n_channels).map(|rows| {
        let [mut least, mut most] = NOTHING;
        for row in rows.chunks_exact(n_channels) {
            for ((least, most), &v) in least.iter_mut().zip(&mut most).zip(&row[channels.clone()]) {
                (*least, *most) = (least.min(v), most.max(v));
            }
        }
        [least, most]
    });
    let [least, most] = rows.reduce(
        || NOTHING,
        |a, b| {
            [
                std::array::from_fn(|c| f64::min(a[0][c], b[0][c])),
                std::array::from_fn(|c| f64::max(a[1][c], b[1][c])),
            ]
        },
    );
    for c in 0..channels.len() {
        middles[c] = 0.5 * least[c] + 0.5 * most[c];
    }
    middles
}

/// Sizes of bands as lanes of blocks.
struct BandSizes<T> {
    blocks: Vec<LaneRows<T>>,
    n_lanes: usize,
}

impl<T: LaneNumber> BandSizes<T> {
    /// Zeros of a number of lanes.
    fn new(n_nodes: usize, n_lanes: usize) -> Self {
        let width = |first: usize| lanes((n_lanes - first).min(MAX_LANES));
        let blocks = (0..n_lanes).step_by(MAX_LANES).map(|first| LaneRows::zeros(n_nodes * width(first)));
        Self { blocks: blocks.collect(), n_lanes }
    }

    /// Takes the sizes of a band as `width` lanes from `first_lane` on, if there are such lanes.
    fn keep(&mut self, first_lane: usize, width: usize, band: BandRows<'_, T>) {
        let end = self.n_lanes.min(first_lane + width);
        for (rows, start) in self.blocks.iter_mut().zip((0..).step_by(MAX_LANES)) {
            let stride = lanes((self.n_lanes - start).min(MAX_LANES));
            let inside = first_lane.max(start)..end.min(start + MAX_LANES);
            if inside.is_empty() {
                continue;
            }
            rows.par_chunks_mut(ROWS_AT_A_TIME * stride).enumerate().for_each(|(part, rows)| {
                for (place, row) in (part * ROWS_AT_A_TIME..).zip(rows.chunks_exact_mut(stride)) {
                    let out = &mut row[inside.start - start..inside.end - start];
                    band.copy_sizes(place, inside.start - first_lane, out);
                }
            });
        }
    }
}

/// Band and channel of a lane, and the unit of its values.
#[derive(Clone, Copy)]
struct BandChannel {
    level: usize,
    channel: usize,
    unit: f64,
}

/// Coefficients of the second order of all channels.
struct SecondOrder<'a> {
    values: &'a mut [f64],
    n_channels: usize,
}

/// Computes `|W_{j′}|W_j f||` for all j′ > j of some lanes.
fn second_order<T: LaneNumber>(
    powers: &WalkPowers,
    rows: LaneRows<T>,
    lanes: &[BandChannel],
    scales: &[u32],
    out: SecondOrder<'_>,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let SecondOrder { values, n_channels } = out;
    let n_scales = scales.len();
    let len = powers.n_nodes() * n_channels;
    let finest = lanes[0].level;
    let block = LaneBlock::from_rows(rows, lanes.iter().map(|lane| lane.unit));
    powers.visit_bands(block, scales, progress, |level, band| {
        if level == n_scales || level <= finest {
            return;
        }
        let paths = (finest..level).map(|j| pair_index(n_scales, j, level)).collect::<Vec<_>>();
        let outs = values.chunks_exact_mut(len).enumerate().filter(|(path, _)| paths.contains(path));
        let parts = node_parts(outs.map(|(_, out)| out).collect(), ROWS_AT_A_TIME * n_channels);
        let n_finer = lanes.iter().take_while(|lane| lane.level < level).count();
        parts.into_par_iter().enumerate().for_each(|(part, mut outs)| {
            let places = &powers.place_of()[part * ROWS_AT_A_TIME..];
            let mut sizes = [0.0; MAX_LANES];
            let n_rows = outs[0].len() / n_channels;
            for (row, &place) in places[..n_rows].iter().enumerate() {
                band.sizes().copy_row(place, places.get(row + AHEAD), &mut sizes[..n_finer]);
                for (lane, v) in lanes.iter().zip(&sizes[..n_finer]) {
                    outs[lane.level - finest][row * n_channels + lane.channel] = *v;
                }
            }
        });
    })
}

/// Parts of several arrays: the first `length` values of all, the next ones of all, and so on.
fn node_parts(arrays: Vec<&mut [f64]>, length: usize) -> Vec<Vec<&mut [f64]>> {
    let mut parts: Vec<Vec<&mut [f64]>> = Vec::new();
    for array in arrays {
        for (part, values) in array.chunks_mut(length).enumerate() {
            if part == parts.len() {
                parts.push(Vec::new());
            }
            parts[part].push(values);
        }
    }
    parts
}

/// Index of the pair j < k among all pairs of `n`, in ascending order.
fn pair_index(n: usize, j: usize, k: usize) -> usize {
    j * (2 * n - j - 1) / 2 + (k - j - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::powers::tests::{noise, powers};
    use crate::{WalkMatrix, WalkOptions};
    use adwave::rows::CompressedRows;

    #[test]
    fn coefficients_are_those_of_the_definition() {
        for (n, n_channels) in [(50, 1), (70, 11), (2500, 3)] {
            let powers = powers(n, 0.5);
            let signal: Vec<f64> = (0..n * n_channels).map(noise).collect();
            let params = ScatteringParams::default();
            let found = scatter(&powers, &signal, n_channels, &params, Progress::none()).unwrap();
            assert_eq!(found.paths.len(), 1 + 5 + 10);
            let band = |f: &[f64], j: u32| {
                let mut bands = vec![0.0; 6 * f.len()];
                powers.bands_into(f, n_channels, &params.scales, &mut bands, Progress::none()).unwrap();
                bands[(j as usize - 1) * f.len()..][..f.len()].iter().map(|v| v.abs()).collect::<Vec<f64>>()
            };
            for (values, path) in found.values.chunks(signal.len()).zip(&found.paths) {
                let exact = path.iter().fold(signal.clone(), |f, &j| band(&f, j));
                assert_eq!(values, exact, "{path:?}");
            }
        }
    }

    /// Largest error of single precision relative to the largest value of a channel, and its bound.
    fn single_error(powers: &WalkPowers, signal: &[f64], n_channels: usize) -> (f64, f64) {
        let with = |precision| {
            let params = ScatteringParams { precision, ..ScatteringParams::default() };
            scatter(powers, signal, n_channels, &params, Progress::none()).unwrap()
        };
        let (double, single) = (with(Precision::Double), with(Precision::Single));
        assert_eq!(double.accuracy.precision, Precision::Double);
        assert_eq!(single.accuracy.precision, Precision::Single);
        assert!(double.accuracy.error_bound < 1e-10 && double.values.len() == single.values.len());
        let largest = |values: &[f64], c: usize| {
            values.iter().skip(c).step_by(n_channels).fold(0.0, |most: f64, v| most.max(v.abs()))
        };
        let off: Vec<f64> = double.values.iter().zip(&single.values).map(|(a, b)| a - b).collect();
        let errors = (0..n_channels).map(|c| largest(&off, c) / largest(signal, c));
        (errors.fold(0.0, f64::max), single.accuracy.error_bound)
    }

    #[test]
    fn single_precision_keeps_to_its_bound_for_values_of_any_size() {
        for (n, n_channels) in [(50, 1), (70, 11), (2500, 3)] {
            let powers = powers(n, 0.5);
            let sizes = [1.0, 1e-300, 1e30, 1e-20, 1e300];
            let signal: Vec<f64> =
                (0..n * n_channels).map(|i| noise(i) * sizes[i % n_channels % 5]).collect();
            let (error, bound) = single_error(&powers, &signal, n_channels);
            assert!(error > 1e-9 && error < bound && bound < 1e-5, "{error:e} {bound:e}");
        }
    }

    #[test]
    fn single_precision_does_not_suffer_from_a_large_mean() {
        let powers = powers(300, 0.5);
        let signal: Vec<f64> = (0..300).map(|i| 1e6 + noise(i)).collect();
        let (error, bound) = single_error(&powers, &signal, 1);
        assert!(error < 1e-6 * bound, "{error:e} {bound:e}");
    }

    #[test]
    fn orders_and_scales_are_checked_and_memory_is_limited() {
        let powers = powers(10, 0.5);
        let signal = [1.0; 10];
        let with = |scales: Vec<u32>, orders: Vec<u32>, max_bytes| {
            let params = ScatteringParams { scales, orders, max_bytes, ..ScatteringParams::default() };
            scatter(&powers, &signal, 1, &params, Progress::none())
        };
        assert_eq!(with(vec![1, 2], vec![3], None), Err(GraphWalkError::BadOrder(3)));
        assert!(with(vec![2, 1], vec![1], None).is_err());
        assert!(matches!(with(vec![1, 2], vec![1], Some(10)), Err(GraphWalkError::TooLarge { .. })));
        let constant = with(vec![1, 2, 4], vec![1, 2], None).unwrap();
        assert!(constant.values.iter().all(|v| v.abs() < 1e-15));
        assert_eq!(with(vec![1], vec![], None).unwrap().values, []);
        let weights = CompressedRows::new(vec![0], Vec::new(), Vec::new(), 0).unwrap();
        let nothing = WalkMatrix::from_weights(weights, WalkOptions::default(), Progress::none()).unwrap();
        let nothing = WalkPowers::new(nothing, Progress::none()).unwrap();
        for precision in [Precision::Double, Precision::Single] {
            let params = ScatteringParams { precision, ..ScatteringParams::default() };
            assert_eq!(scatter(&nothing, &[], 1, &params, Progress::none()).unwrap().values, []);
        }
        assert!(
            scatter(&powers, &[], 0, &ScatteringParams::default(), Progress::none())
                .unwrap()
                .values
                .is_empty()
        );
    }
}
