//! Powers of a walk applied to many channels, and their adjoint.
//!
//! Channels go through the products in blocks of up to 32, nodes in an order in which neighbors are close to each
//! other. A block takes three vectors, whatever the number of channels.

use crate::lane_block::{LaneBlock, SignalRows, blocks};
use crate::node_order::{breadth_first, reorder};
use crate::{GraphWalkError, WalkMatrix};
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Largest number of steps: a limit against a slip of the keyboard.
pub(crate) const MOST_STEPS: u32 = 1 << 20;

/// Number of values that are checked together.
const CHECKED_AT_A_TIME: usize = 1 << 12;

/// A walk prepared for its powers.
///
/// ```
/// use adwave::{Progress, rows::CompressedRows};
/// use adwave_graph::{WalkMatrix, WalkPowers};
/// let swap = CompressedRows::new(vec![0, 1, 2], vec![1, 0], vec![1.0, 1.0], 2)?;
/// let powers = WalkPowers::new(WalkMatrix::from_probabilities(swap, Progress::none())?, Progress::none())?;
/// let mut out = [0.0; 2];
/// powers.apply_into(&[1.0, 3.0], 1, 3, &mut out, Progress::none())?;
/// assert_eq!(out, [3.0, 1.0]);
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
#[derive(Debug)]
pub struct WalkPowers {
    walk: WalkMatrix,
    /// The matrix in the order of the products.
    ordered: CompressedRows<f64>,
    ordered_transpose: OnceLock<CompressedRows<f64>>,
    /// Node at each place of that order, and place of each node.
    node_at: Vec<u32>,
    place_of: Vec<u32>,
}

impl WalkPowers {
    /// Prepares a walk. O(entries · log of the entries per row).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn new(walk: WalkMatrix, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let node_at = breadth_first(walk.rows(), progress)?;
        let mut place_of = vec![0; node_at.len()];
        for (place, &node) in (0..).zip(&node_at) {
            place_of[node as usize] = place;
        }
        let ordered = reorder(walk.rows(), &node_at, &place_of);
        Ok(Self { walk, ordered, ordered_transpose: OnceLock::new(), node_at, place_of })
    }

    /// The walk.
    pub fn walk(&self) -> &WalkMatrix {
        &self.walk
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.node_at.len()
    }

    /// Computes `P^steps x` for `n_channels` channels into `out`; both are n_nodes × n_channels.
    /// O(entries·channels·steps).
    ///
    /// # Errors
    /// [`GraphWalkError`] if the signal has the wrong length, a value is not finite, there are too many steps, or the
    /// call is cancelled.
    ///
    /// # Panics
    /// Unless `out` is as long as the signal.
    pub fn apply_into(
        &self,
        signal: &[f64],
        n_channels: usize,
        steps: u32,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), GraphWalkError> {
        self.check_signal(signal, n_channels)?;
        assert_eq!(out.len(), signal.len(), "the output is as long as the signal");
        if steps > MOST_STEPS {
            return Err(GraphWalkError::BadSteps { steps: f64::from(steps), most: MOST_STEPS });
        }
        let mut spare = None;
        for channels in blocks(n_channels) {
            progress.step(channels.start as u64, n_channels as u64)?;
            let rows = SignalRows::new(signal, n_channels, channels.clone());
            let mut block: LaneBlock<f64> = self.load(channels.len(), spare.take(), &rows);
            for _ in 0..steps {
                self.step(&mut block, progress)?;
            }
            self.store(block.rows(), channels, n_channels, out);
            spare = Some(block);
        }
        Ok(progress.step(n_channels as u64, n_channels as u64)?)
    }

    /// Computes the bands `(P^{n_{j−1}} − P^{n_j})x`, n_0 = 0, and the remainder `P^{n_J}x`, one after the other into
    /// `out`: (J + 1) × n_nodes × n_channels. Their sum is the signal. O(entries·channels·n_J).
    ///
    /// # Errors
    /// As for [`apply_into`](Self::apply_into), and if the scales do not increase from 1 or more.
    ///
    /// # Panics
    /// Unless `out` has the right length.
    pub fn bands_into(
        &self,
        signal: &[f64],
        n_channels: usize,
        scales: &[u32],
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), GraphWalkError> {
        self.check_signal(signal, n_channels)?;
        check_scales(scales)?;
        assert_eq!(out.len(), (scales.len() + 1) * signal.len(), "a signal for each band and the remainder");
        for channels in blocks(n_channels) {
            progress.step(channels.start as u64, n_channels as u64)?;
            let rows = SignalRows::new(signal, n_channels, channels.clone());
            let block: LaneBlock<f64> = self.load(channels.len(), None, &rows);
            self.visit_bands(block, scales, progress, |level, band| {
                let out = &mut out[level * signal.len()..][..signal.len()];
                self.store(band, channels.clone(), n_channels, out);
            })?;
        }
        Ok(())
    }

    /// Computes the adjoint of [`bands_into`](Self::bands_into):
    /// `Σ_j (P^{n_{j−1}} − P^{n_j})ᵀ g_j + (P^{n_J})ᵀ g_{J+1}` for the gradients g, (J + 1) × n_nodes × n_channels. It
    /// costs the products of the bands.
    ///
    /// # Errors
    /// As for [`bands_into`](Self::bands_into).
    ///
    /// # Panics
    /// Unless `out` is n_nodes × n_channels.
    pub fn adjoint_into(
        &self,
        gradients: &[f64],
        n_channels: usize,
        scales: &[u32],
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), GraphWalkError> {
        check_scales(scales)?;
        let len = self.n_nodes() * n_channels;
        assert_eq!(out.len(), len, "the output has a value per node and channel");
        if gradients.len() != (scales.len() + 1) * len {
            return Err(self.wrong_length(gradients.len(), n_channels));
        }
        let transpose = self
            .ordered_transpose
            .get_or_init(|| reorder(self.walk.transposed(), &self.node_at, &self.place_of));
        for channels in blocks(n_channels) {
            // The gradient of P^{n_j} x is g_{j+1} − g_j.
            let fill = |level: usize| {
                let channels = channels.clone();
                move |node: usize, row: &mut [f64]| {
                    row.copy_from_slice(&gradients[level * len + node * n_channels..][channels.clone()]);
                    if level > 0 {
                        let before = &gradients[(level - 1) * len + node * n_channels..][channels.clone()];
                        row.iter_mut().zip(before).for_each(|(g, before)| *g -= before);
                    }
                }
            };
            let mut block: LaneBlock<f64> = self.load(channels.len(), None, &fill(scales.len()));
            for level in (0..scales.len()).rev() {
                let until = if level == 0 { 0 } else { scales[level - 1] };
                for _ in until..scales[level] {
                    block.step(transpose, progress)?;
                }
                let added: LaneBlock<f64> = self.load(channels.len(), None, &fill(level));
                block.now.iter_mut().zip(added.now.iter()).for_each(|(now, g)| *now += g);
            }
            self.store(block.rows(), channels, n_channels, out);
        }
        Ok(())
    }

    /// The matrix in the order of the rows of a block.
    pub(crate) fn ordered_rows(&self) -> &CompressedRows<f64> {
        &self.ordered
    }

    /// Nodes in the order of the rows of a block.
    pub(crate) fn node_at(&self) -> &[u32] {
        &self.node_at
    }

    /// Row of each node in a block.
    pub(crate) fn place_of(&self) -> &[u32] {
        &self.place_of
    }

    pub(crate) fn check_signal(&self, signal: &[f64], n_channels: usize) -> Result<(), GraphWalkError> {
        if self.n_nodes().checked_mul(n_channels) != Some(signal.len()) {
            return Err(self.wrong_length(signal.len(), n_channels));
        }
        // Without a branch per value the loop takes half of the time.
        let is_good = |values: &[f64]| values.iter().fold(true, |good, v| good & v.is_finite());
        let part = signal.par_chunks(CHECKED_AT_A_TIME).position_first(|values| !is_good(values));
        let start = part.map_or(signal.len(), |part| part * CHECKED_AT_A_TIME);
        match signal[start..].iter().position(|v| !v.is_finite()).map(|at| start + at) {
            None => Ok(()),
            Some(at) => Err(GraphWalkError::BadValue {
                node: at / n_channels,
                channel: at % n_channels,
                value: signal[at],
            }),
        }
    }

    fn wrong_length(&self, n_values: usize, n_columns: usize) -> GraphWalkError {
        GraphWalkError::SignalLength { n_values, n_nodes: self.n_nodes(), n_columns }
    }
}

/// Checks that scales increase from at least 1.
pub(crate) fn check_scales(scales: &[u32]) -> Result<(), GraphWalkError> {
    let increases = scales.windows(2).all(|pair| pair[0] < pair[1]);
    match (scales.first(), scales.last()) {
        (Some(&first), Some(&last)) if first >= 1 && increases && last <= MOST_STEPS => Ok(()),
        _ => Err(GraphWalkError::BadScales(scales.to_vec())),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::WalkOptions;

    /// A number in −1 … 1 for each index.
    pub(crate) fn noise(i: usize) -> f64 {
        let mixed = (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5851_F42D_4C95_7F2D;
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A graph of random weights with a hub.
    pub(crate) fn powers(n: usize, stay: f64) -> WalkPowers {
        let mut entries = Vec::new();
        for x in 1..n as u32 {
            for (salt, y) in [(1, x / 2), (2, 0), (3, (x * 7 + 3) % n as u32)] {
                if y != x {
                    let w = 1.5 + noise(x as usize * 5 + salt);
                    entries.extend([(x, y, w), (y, x, w)]);
                }
            }
        }
        entries.sort_by_key(|e| (e.0, e.1));
        let weights = CompressedRows::from_sorted(n, n, entries).unwrap();
        let options = WalkOptions { stay, ..WalkOptions::default() };
        let walk = WalkMatrix::from_weights(weights, options, Progress::none()).unwrap();
        WalkPowers::new(walk, Progress::none()).unwrap()
    }

    fn dense_power(powers: &WalkPowers, signal: &[f64], n_channels: usize, steps: u32) -> Vec<f64> {
        let rows = powers.walk().rows();
        let mut now = signal.to_vec();
        for _ in 0..steps {
            let mut next = vec![0.0; now.len()];
            for x in 0..rows.n_rows() {
                for (&y, w) in rows.row(x).0.iter().zip(rows.row(x).1) {
                    for c in 0..n_channels {
                        next[x * n_channels + c] += w * now[y as usize * n_channels + c];
                    }
                }
            }
            now = next;
        }
        now
    }

    #[test]
    fn powers_are_those_of_the_matrix_for_any_number_of_channels() {
        for (n, n_channels) in [(40, 1), (50, 3), (3000, 7), (200, 33), (60, 70)] {
            let powers = powers(n, 0.0);
            let signal: Vec<f64> = (0..n * n_channels).map(noise).collect();
            let mut out = vec![0.0; signal.len()];
            powers.apply_into(&signal, n_channels, 5, &mut out, Progress::none()).unwrap();
            let exact = dense_power(&powers, &signal, n_channels, 5);
            let off = out.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-13, "{n} × {n_channels}: {off:e}");
        }
    }

    #[test]
    fn bands_sum_to_the_signal_and_channels_do_not_affect_each_other() {
        let (n, n_channels) = (300, 35);
        let powers = powers(n, 0.5);
        let signal: Vec<f64> = (0..n * n_channels).map(noise).collect();
        let scales = [1, 2, 4, 8];
        let mut out = vec![0.0; 5 * signal.len()];
        powers.bands_into(&signal, n_channels, &scales, &mut out, Progress::none()).unwrap();
        for (i, f) in signal.iter().enumerate() {
            let sum: f64 = (0..5).map(|j| out[j * signal.len() + i]).sum();
            assert!((sum - f).abs() < 1e-14);
        }
        let single: Vec<f64> = signal.iter().skip(17).step_by(n_channels).copied().collect();
        let mut alone = vec![0.0; 5 * n];
        powers.bands_into(&single, 1, &scales, &mut alone, Progress::none()).unwrap();
        for j in 0..5 {
            for x in 0..n {
                assert_eq!(alone[j * n + x], out[j * signal.len() + x * n_channels + 17]);
            }
        }
    }

    #[test]
    fn the_adjoint_is_the_adjoint() {
        let (n, n_channels) = (120, 9);
        let powers = powers(n, 0.0);
        let scales = [1, 3, 6];
        let signal: Vec<f64> = (0..n * n_channels).map(noise).collect();
        let gradients: Vec<f64> = (0..4 * n * n_channels).map(|i| noise(i + 77_777)).collect();
        let (mut bands, mut back) = (vec![0.0; gradients.len()], vec![0.0; signal.len()]);
        powers.bands_into(&signal, n_channels, &scales, &mut bands, Progress::none()).unwrap();
        powers.adjoint_into(&gradients, n_channels, &scales, &mut back, Progress::none()).unwrap();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (left, right) = (dot(&bands, &gradients), dot(&signal, &back));
        assert!((left - right).abs() < 1e-11, "{left} {right}");
    }

    #[test]
    fn wrong_signals_and_scales_are_refused() {
        let powers = powers(10, 0.0);
        let mut out = vec![0.0; 10];
        let mut nan = vec![1.0; 10];
        nan[3] = f64::NAN;
        assert!(powers.apply_into(&nan, 1, 1, &mut out, Progress::none()).is_err());
        let transposed = powers.apply_into(&[0.0; 30], 10, 1, &mut [0.0; 30], Progress::none()).unwrap_err();
        assert!(transposed.to_string().contains("transpose"), "{transposed}");
        for scales in [vec![], vec![0], vec![2, 2], vec![4, 1], vec![u32::MAX]] {
            assert!(check_scales(&scales).is_err(), "{scales:?}");
        }
        let stopped = std::sync::atomic::AtomicBool::new(true);
        let progress = Progress::none().with_cancel(&stopped);
        let cancelled = powers.apply_into(&[0.0; 10], 1, 1, &mut out, progress);
        assert_eq!(cancelled, Err(GraphWalkError::Cancelled(Cancelled)));
    }

    #[test]
    fn another_order_of_nodes_permutes_the_result() {
        // Rows sum their entries in the order of the products, which follows the numbers of the nodes; values agree to
        // rounding.
        let n = 64;
        let powers = powers(n, 0.5);
        let place_of: Vec<u32> = (0..n as u32).map(|x| (x * 5 + 3) % n as u32).collect();
        let moved = WalkMatrix::from_probabilities(powers.walk().rows().permute(&place_of), Progress::none());
        let moved = WalkPowers::new(moved.unwrap(), Progress::none()).unwrap();
        let signal: Vec<f64> = (0..n).map(noise).collect();
        let mut there = vec![0.0; n];
        for (x, &place) in place_of.iter().enumerate() {
            there[place as usize] = signal[x];
        }
        let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
        powers.apply_into(&signal, 1, 6, &mut a, Progress::none()).unwrap();
        moved.apply_into(&there, 1, 6, &mut b, Progress::none()).unwrap();
        for (x, &place) in place_of.iter().enumerate() {
            assert!((a[x] - b[place as usize]).abs() < 1e-15);
        }
    }
}
