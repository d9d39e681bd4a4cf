//! Geometric scattering (`gao2019`): bands, their absolute values, and the bands of these.

use crate::lanes::{MAX_LANES, ROWS_AT_A_TIME};
use crate::powers::{blocks, check_scales};
use crate::{GraphWalkError, WalkPowers};
use adwave::Progress;
use adwave::pages::zeros;
use rayon::prelude::*;

/// Scales and orders of scattering.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatteringParams {
    /// Numbers of steps n_1 < n_2 < …; the bands are `P^{n_{j−1}} − P^{n_j}` with n_0 = 0.
    pub scales: Vec<u32>,
    /// Orders of the result, of 0, 1 and 2.
    pub orders: Vec<u32>,
    /// Largest memory of the result in bytes.
    pub max_bytes: Option<u64>,
}

impl Default for ScatteringParams {
    fn default() -> Self {
        Self { scales: vec![1, 2, 4, 8, 16], orders: vec![0, 1, 2], max_bytes: None }
    }
}

/// Scattering coefficients of a signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Scattering {
    /// Coefficients, n_paths × n_nodes × n_channels.
    pub values: Vec<f64>,
    /// Bands of each path, from 1: none for the signal, j for `|W_j f|`, j and j′ > j for `|W_{j′}|W_j f||`.
    pub paths: Vec<Vec<u32>>,
}

impl ScatteringParams {
    /// Paths of the result: the signal, then `|W_j f|`, then `|W_{j′}|W_j f||` with j′ > j, in ascending order.
    ///
    /// ```
    /// use adwave_graph::ScatteringParams;
    /// let params = ScatteringParams { scales: vec![1, 2, 4], ..ScatteringParams::default() };
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

/// Scattering coefficients of order 0 (the signal), 1 (`|W_j f|`) and 2 (`|W_{j′}|W_j f||`, j′ > j), n_paths × n_nodes ×
/// n_channels. O(entries·channels·n_J·J).
///
/// # Errors
/// [`GraphWalkError`] if the signal has the wrong length or a value that is not finite, scales do not increase, an order does
/// not exist, the result is too large, or the call is cancelled.
///
/// ```
/// use adwave::{Progress, rows::CompressedRows};
/// use adwave_graph::{ScatteringParams, WalkMatrix, WalkPowers, scatter};
/// let swap = CompressedRows::new(vec![0, 1, 2], vec![1, 0], vec![1.0, 1.0], 2)?;
/// let powers = WalkPowers::new(WalkMatrix::from_probabilities(swap, Progress::none())?, Progress::none())?;
/// let params = ScatteringParams { scales: vec![1], orders: vec![1], max_bytes: None };
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
    if n_channels == 0 {
        return Ok(Scattering { values, paths });
    }
    let has = |order: u32| params.orders.contains(&order);
    if has(0) {
        values[..len].copy_from_slice(signal);
    }
    let first_at = usize::from(has(0));
    let second_at = first_at + if has(1) { n_scales } else { 0 };
    if !has(1) && !has(2) {
        return Ok(Scattering { values, paths });
    }
    // Channels whose first bands are computed together; their absolute values are the channels of the second bands.
    let mut sizes: Vec<f64> = Vec::new();
    for channels in blocks(n_channels) {
        progress.step(channels.start as u64, n_channels as u64)?;
        let width = channels.len();
        let n_sizes = n_scales * powers.n_nodes() * width;
        if sizes.len() != n_sizes {
            sizes = zeros(n_sizes);
        }
        let block = powers.load(width, None, |node, row| {
            row.copy_from_slice(&signal[node * n_channels..][channels.clone()]);
        });
        let per_band = powers.n_nodes() * width;
        powers.visit_bands(block, &params.scales, progress, |level, band, block| {
            if level < n_scales {
                let out = &mut sizes[level * per_band..][..per_band];
                powers.store_values(band, block, 0..width, width, out);
                out.par_iter_mut().with_min_len(1 << 14).for_each(|v| *v = v.abs());
            }
        })?;
        if has(1) {
            for level in 0..n_scales {
                let out = &mut values[(first_at + level) * len..][..len];
                let rows = sizes[level * per_band..][..per_band].par_chunks_exact(width);
                let pairs = out.par_chunks_exact_mut(n_channels).zip(rows).with_min_len(ROWS_AT_A_TIME);
                pairs.for_each(|(out, row)| out[channels.clone()].copy_from_slice(row));
            }
        }
        if has(2) {
            let first = FirstOrder { sizes: &sizes, width, channels_from: channels.start };
            let out = SecondOrder { values: &mut values[second_at * len..], n_channels };
            second_order(powers, first, &params.scales, out, progress)?;
        }
    }
    Ok(Scattering { values, paths })
}

/// Sizes `|W_j f|` of some channels, n_scales × n_nodes × width.
#[derive(Clone, Copy)]
struct FirstOrder<'a> {
    sizes: &'a [f64],
    width: usize,
    channels_from: usize,
}

/// Coefficients of the second order of all channels.
struct SecondOrder<'a> {
    values: &'a mut [f64],
    n_channels: usize,
}

/// Computes `|W_{j′}|W_j f||` for all j′ > j. The coarsest band has none.
fn second_order(
    powers: &WalkPowers,
    first: FirstOrder<'_>,
    scales: &[u32],
    out: SecondOrder<'_>,
    progress: Progress<'_>,
) -> Result<(), GraphWalkError> {
    let FirstOrder { sizes, width, channels_from } = first;
    let SecondOrder { values, n_channels } = out;
    let (n_scales, per_band) = (scales.len(), powers.n_nodes() * width);
    let len = powers.n_nodes() * n_channels;
    // Lanes of a block: band j of channel c, for all j but the last.
    let lanes: Vec<(usize, usize)> =
        (0..n_scales - 1).flat_map(|j| (0..width).map(move |c| (j, c))).collect();
    for lanes in lanes.chunks(MAX_LANES) {
        let block = powers.load(lanes.len(), None, |node, row| {
            for (v, &(j, c)) in row.iter_mut().zip(lanes) {
                *v = sizes[j * per_band + node * width + c];
            }
        });
        powers.visit_bands(block, scales, progress, |level, band, block| {
            if level == n_scales {
                return;
            }
            let finest = lanes[0].0;
            let paths = (finest..level).map(|j| pair_index(n_scales, j, level)).collect::<Vec<_>>();
            let outs = values.chunks_exact_mut(len).enumerate().filter(|(path, _)| paths.contains(path));
            let parts = node_parts(outs.map(|(_, out)| out).collect(), ROWS_AT_A_TIME * n_channels);
            parts.into_par_iter().enumerate().for_each(|(part, mut outs)| {
                let places = powers.place_of().iter().skip(part * ROWS_AT_A_TIME).take(ROWS_AT_A_TIME);
                for (row, &place) in places.enumerate() {
                    let band = &band[place as usize * block.lanes..][..block.lanes];
                    for (&(j, c), v) in lanes.iter().zip(band).take_while(|((j, _), _)| *j < level) {
                        outs[j - finest][row * n_channels + channels_from + c] = v.abs();
                    }
                }
            });
        })?;
    }
    Ok(())
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

    #[test]
    fn orders_and_scales_are_checked_and_memory_is_limited() {
        let powers = powers(10, 0.5);
        let signal = [1.0; 10];
        let with = |scales: Vec<u32>, orders: Vec<u32>, max_bytes| {
            scatter(&powers, &signal, 1, &ScatteringParams { scales, orders, max_bytes }, Progress::none())
        };
        assert_eq!(with(vec![1, 2], vec![3], None), Err(GraphWalkError::BadOrder(3)));
        assert!(with(vec![2, 1], vec![1], None).is_err());
        assert!(matches!(with(vec![1, 2], vec![1], Some(10)), Err(GraphWalkError::TooLarge { .. })));
        let constant = with(vec![1, 2, 4], vec![1, 2], None).unwrap();
        assert!(constant.values.iter().all(|v| v.abs() < 1e-15));
        assert_eq!(with(vec![1], vec![], None).unwrap().values, []);
        assert!(
            scatter(&powers, &[], 0, &ScatteringParams::default(), Progress::none())
                .unwrap()
                .values
                .is_empty()
        );
    }
}
