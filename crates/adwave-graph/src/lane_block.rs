//! Blocks of channels as rows of lanes: loading, steps of the walk, bands, storing.

use crate::WalkPowers;
use crate::lane_rows::{LINE, LaneNumber, LaneRows};
use crate::lanes::{MAX_LANES, ROWS_AT_A_TIME, SERIAL, lanes, multiply};
use adwave::pages::prefetch;
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Range;

/// Sizes within which values of single precision are kept as they are: neither they nor their means overflow or vanish.
const SINGLE_RANGE: Range<f64> = 1e-9..1e9;

/// Rows by which rows in another order are fetched ahead.
pub(crate) const AHEAD: usize = 16;

/// Channels as rows of lanes in the order of the products, and room for the next product.
#[derive(Debug)]
pub(crate) struct LaneBlock<T> {
    pub(crate) now: LaneRows<T>,
    next: LaneRows<T>,
    pub(crate) lanes: usize,
    pub(crate) width: usize,
    /// Powers of 2 by which the values of the channels were divided.
    units: [f64; MAX_LANES],
}

/// Rows of a block, or their differences from coarser ones: a band.
#[derive(Clone, Copy)]
pub(crate) struct BandRows<'a, T> {
    fine: &'a [T],
    coarse: Option<&'a [T]>,
    /// True if the values are sizes: absolute values.
    are_sizes: bool,
    lanes: usize,
    units: &'a [f64; MAX_LANES],
}

/// Rows of values in double precision, node by node.
pub(crate) trait RowSource: Sync {
    /// Writes the values of a node.
    fn fill(&self, node: usize, row: &mut [f64]);

    /// Prefetches the values of a node that [`fill`](Self::fill) will read.
    fn fetch(&self, _node: usize) {}
}

impl<F: Fn(usize, &mut [f64]) + Sync> RowSource for F {
    fn fill(&self, node: usize, row: &mut [f64]) {
        self(node, row);
    }
}

/// Some channels of an n_nodes × n_channels array, less a value for each.
pub(crate) struct SignalRows<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) n_channels: usize,
    pub(crate) channels: Range<usize>,
    pub(crate) middles: [f64; MAX_LANES],
}

impl<'a> SignalRows<'a> {
    /// The channels as they are.
    pub(crate) fn new(values: &'a [f64], n_channels: usize, channels: Range<usize>) -> Self {
        Self { values, n_channels, channels, middles: [0.0; MAX_LANES] }
    }
}

impl RowSource for SignalRows<'_> {
    fn fill(&self, node: usize, row: &mut [f64]) {
        let values = &self.values[node * self.n_channels..][self.channels.clone()];
        for ((out, v), middle) in row.iter_mut().zip(values).zip(self.middles) {
            *out = v - middle;
        }
    }

    fn fetch(&self, node: usize) {
        fetch_values(self.values, node * self.n_channels + self.channels.start, self.channels.len());
    }
}

/// Fetches the cache lines of some values.
pub(crate) fn fetch_values<T>(values: &[T], start: usize, n: usize) {
    let last = start + n.saturating_sub(1);
    for at in (start..last).step_by(LINE / size_of::<T>()).chain([last]) {
        prefetch(values, at);
    }
}

impl<T: LaneNumber> LaneBlock<T> {
    /// A block of given rows, with a unit per channel.
    pub(crate) fn from_rows(rows: LaneRows<T>, channel_units: impl ExactSizeIterator<Item = f64>) -> Self {
        let width = channel_units.len();
        let mut units = [1.0; MAX_LANES];
        units.iter_mut().zip(channel_units).for_each(|(unit, channel)| *unit = channel);
        let next = LaneRows::zeros(rows.len());
        Self { now: rows, next, lanes: lanes(width), width, units }
    }

    /// The values.
    pub(crate) fn rows(&self) -> BandRows<'_, T> {
        let (fine, units) = (&*self.now, &self.units);
        BandRows { fine, coarse: None, are_sizes: false, lanes: self.lanes, units }
    }

    /// Units of the values.
    pub(crate) fn units(&self) -> &[f64; MAX_LANES] {
        &self.units
    }

    /// One step of a matrix in the order of the block.
    pub(crate) fn step(
        &mut self,
        rows: &CompressedRows<f64>,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        multiply(rows, self.lanes, &self.now, &mut self.next, progress)?;
        std::mem::swap(&mut self.now, &mut self.next);
        Ok(())
    }
}

impl<T: LaneNumber> BandRows<'_, T> {
    /// The absolute values.
    pub(crate) fn sizes(self) -> Self {
        Self { are_sizes: true, ..self }
    }

    /// Writes the first values of the row at a place, as many as `out` has, and fetches a later row.
    pub(crate) fn copy_row(&self, place: u32, later: Option<&u32>, out: &mut [f64]) {
        let at = |place: u32| place as usize * self.lanes;
        if let Some(&later) = later {
            for rows in [Some(self.fine), self.coarse].into_iter().flatten() {
                fetch_values(rows, at(later), out.len());
            }
        }
        let range = at(place)..at(place) + out.len();
        match self.coarse {
            None => out.iter_mut().zip(&self.fine[range]).for_each(|(out, v)| *out = v.widened()),
            Some(coarse) => {
                let pairs = self.fine[range.clone()].iter().zip(&coarse[range]);
                out.iter_mut()
                    .zip(pairs)
                    .for_each(|(out, (fine, coarse))| *out = fine.widened() - coarse.widened());
            }
        }
        if self.are_sizes {
            for v in out.iter_mut() {
                *v = v.abs();
            }
        }
        if T::IS_SINGLE {
            out.iter_mut().zip(self.units).for_each(|(v, unit)| *v *= unit);
        }
    }

    /// Writes sizes of differences in the units of the block, of the lanes from `lane` on of the row at a place.
    pub(crate) fn copy_sizes(&self, place: usize, lane: usize, out: &mut [T]) {
        let start = place * self.lanes + lane;
        let n = out.len();
        for (i, (out, fine)) in out.iter_mut().zip(&self.fine[start..][..n]).enumerate() {
            let coarse = self.coarse.map_or(0.0, |coarse| coarse[start + i].widened());
            *out = T::rounded((fine.widened() - coarse).abs());
        }
    }
}

impl WalkPowers {
    /// A block of `width` channels, filled node by node, in the memory of `spare` if there is one. Of some values in
    /// single precision rows are filled twice.
    pub(crate) fn load<T: LaneNumber>(
        &self,
        width: usize,
        spare: Option<LaneBlock<T>>,
        source: &impl RowSource,
    ) -> LaneBlock<T> {
        let lanes = lanes(width);
        let n = self.n_nodes();
        let mut block = match spare {
            Some(block) if block.lanes == lanes => block,
            _ => {
                let [now, next] = [LaneRows::zeros(n * lanes), LaneRows::zeros(n * lanes)];
                LaneBlock { now, next, lanes, width, units: [1.0; MAX_LANES] }
            }
        };
        if block.width != width {
            block.now.fill(T::default());
            block.width = width;
        }
        block.units = [1.0; MAX_LANES];
        let sizes = self.fill_rows(&mut block, source);
        if T::IS_SINGLE && sizes.iter().any(|&size| size > 0.0 && !SINGLE_RANGE.contains(&size)) {
            block.units = sizes.map(power_of_two);
            self.fill_rows(&mut block, source);
        }
        block
    }

    /// Fills the rows of a block; returns the largest size of a value of each channel in single precision.
    fn fill_rows<T: LaneNumber>(
        &self,
        block: &mut LaneBlock<T>,
        source: &impl RowSource,
    ) -> [f64; MAX_LANES] {
        let (lanes, width) = (block.lanes, block.width);
        let factors = block.units.map(|unit| 1.0 / unit);
        let fill_part = |first: usize, rows: &mut [T]| {
            let mut sizes = [0.0; MAX_LANES];
            let nodes = &self.node_at()[first..];
            for ((i, &node), out) in nodes.iter().enumerate().zip(rows.chunks_exact_mut(lanes)) {
                if let Some(&later) = nodes.get(i + AHEAD) {
                    source.fetch(later as usize);
                }
                T::fill_row(&mut out[..width], &factors, &mut sizes, |row| source.fill(node as usize, row));
            }
            sizes
        };
        if self.n_nodes() <= SERIAL {
            return fill_part(0, &mut block.now);
        }
        let parts = block.now.par_chunks_mut(ROWS_AT_A_TIME * lanes).enumerate();
        parts.map(|(part, rows)| fill_part(part * ROWS_AT_A_TIME, rows)).reduce(
            || [0.0; MAX_LANES],
            |mut a, b| {
                a.iter_mut().zip(b).for_each(|(a, b)| *a = a.max(b));
                a
            },
        )
    }

    /// One step of the walk.
    pub(crate) fn step<T: LaneNumber>(
        &self,
        block: &mut LaneBlock<T>,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        block.step(self.ordered_rows(), progress)
    }

    /// Calls `each(level, band)` for the bands of a block, from fine to coarse, and for the remainder.
    pub(crate) fn visit_bands<T: LaneNumber>(
        &self,
        mut block: LaneBlock<T>,
        scales: &[u32],
        progress: Progress<'_>,
        mut each: impl FnMut(usize, BandRows<'_, T>),
    ) -> Result<(), Cancelled> {
        let mut fine = LaneRows::zeros(block.now.len());
        let mut done = 0;
        for (level, &scale) in scales.iter().enumerate() {
            for step in done..scale {
                self.step(&mut block, progress)?;
                if step == done {
                    // The step left its input, the end of the level before, in the memory of the next one.
                    std::mem::swap(&mut block.next, &mut fine);
                }
            }
            done = scale;
            each(level, BandRows { coarse: Some(&block.now), fine: &fine, ..block.rows() });
        }
        each(scales.len(), block.rows());
        Ok(())
    }

    /// Writes a block to its channels of an n_nodes × n_channels array.
    pub(crate) fn store<T: LaneNumber>(
        &self,
        rows: BandRows<'_, T>,
        channels: Range<usize>,
        n_channels: usize,
        out: &mut [f64],
    ) {
        let copy = |(part, out): (usize, &mut [f64])| {
            let places = &self.place_of()[part * ROWS_AT_A_TIME..];
            for (i, out) in out.chunks_mut(n_channels).enumerate() {
                rows.copy_row(places[i], places.get(i + AHEAD), &mut out[channels.clone()]);
            }
        };
        let length = ROWS_AT_A_TIME * n_channels;
        if self.n_nodes() <= SERIAL {
            out.chunks_mut(length).enumerate().for_each(copy);
        } else {
            out.par_chunks_mut(length).enumerate().for_each(copy);
        }
    }
}

/// The power of 2 next below a positive finite number; 1 for 0.
fn power_of_two(size: f64) -> f64 {
    if size == 0.0 { 1.0 } else { size.log2().floor().clamp(-1000.0, 1000.0).exp2() }
}

/// Blocks of nearly equal width in which `n_channels` are processed.
pub(crate) fn blocks(n_channels: usize) -> impl Iterator<Item = Range<usize>> {
    let n_blocks = n_channels.div_ceil(MAX_LANES).max(1);
    let most = n_channels.div_ceil(n_blocks).next_multiple_of(8).min(MAX_LANES);
    (0..n_channels).step_by(most).map(move |at| at..(at + most).min(n_channels))
}
