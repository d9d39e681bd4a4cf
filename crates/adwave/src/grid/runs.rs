//! The second differences of a grid over the places with data alone, in runs along the last axis.
//!
//! Vectors hold the places with data in the order of the grid and no others, so that a volume costs what its mask holds.
//! Adjacent places of a run are adjacent in memory. A [`RunLink`] joins a part of a run to as many places on one of its other
//! sides, so that no step asks whether a place has data.

// Functions that are compiled for the vectors of the machine must be inlined into the place that chooses these.
#![allow(clippy::inline_always)]

use super::{Axes, MAX_AXES};
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Most places of a run: their differences stay in the nearest cache.
const LONGEST: usize = 1024;

/// Values that a thread computes at a time, about.
const VALUES_AT_A_TIME: usize = 1 << 14;

/// Successive places with data along the last axis.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// First place on the grid.
    pub(super) place: usize,
    /// First place among those with data.
    pub(super) start: usize,
    /// Number of places.
    pub(super) len: usize,
    /// Its links.
    links: Range<usize>,
}

/// A part of a run and the places on one side of it, among those with data.
#[derive(Clone, Copy, Debug)]
struct RunLink {
    here: u32,
    there: u32,
    len: u32,
    axis: u32,
}

/// The places with data and their neighbors.
#[derive(Clone, Debug)]
pub(super) struct Runs {
    pub(super) list: Vec<Run>,
    links: Vec<RunLink>,
    /// Weight of a difference along each axis.
    weights: [f64; MAX_AXES],
    /// Number of places with data.
    pub(super) n_kept: usize,
    last_axis: usize,
}

impl Runs {
    /// The runs of a grid with data where `kept`, and the weight of a difference along each axis.
    pub(super) fn new(axes: &Axes, kept: Option<&[bool]>, weights: [f64; MAX_AXES]) -> Self {
        let last_axis = axes.sizes.len() - 1;
        let row_len = axes.sizes[last_axis];
        let is_kept = |place: usize| kept.is_none_or(|kept| kept[place]);
        let (mut runs, mut n_kept, mut of_row) = (Vec::new(), 0, vec![0]);
        for row in 0..axes.n_places() / row_len {
            let (mut at, end) = (row * row_len, (row + 1) * row_len);
            while at < end {
                let len = (at..end.min(at + LONGEST)).take_while(|&place| is_kept(place)).count();
                if len > 0 {
                    runs.push(Run { place: at, start: n_kept, len, links: 0..0 });
                    n_kept += len;
                }
                at += len.max(1);
            }
            of_row.push(runs.len());
        }
        let mut links = Vec::new();
        for k in 0..runs.len() {
            let Run { place, start, len, .. } = runs[k];
            let (first_link, row) = (links.len(), place / row_len);
            // Joins the places of this run from `from` on to those from `other` on in the row of these.
            let mut join = |axis: usize, from: usize, other: usize, len: usize| {
                for run in &runs[of_row[other / row_len]..of_row[other / row_len + 1]] {
                    let [low, high] = [run.place.max(other), (run.place + run.len).min(other + len)];
                    if low < high {
                        let (here, there) = (start + from + (low - other), run.start + (low - run.place));
                        let [here, there, len, axis] =
                            [here, there, high - low, axis].map(|value| value as u32);
                        links.push(RunLink { here, there, len, axis });
                    }
                }
            };
            let ends = [place, place + len - 1];
            for (side, place) in ends.into_iter().enumerate() {
                if let Some(other) = axes.sides(last_axis, place, place - row * row_len)[side] {
                    join(last_axis, side * (len - 1), other, 1);
                }
            }
            for axis in (0..last_axis).filter(|&axis| axes.sizes[axis] > 1) {
                for other in axes.sides(axis, place, axes.coordinate(axis, place)).into_iter().flatten() {
                    join(axis, 0, other, len);
                }
            }
            runs[k].links = first_link..links.len();
        }
        Self { list: runs, links, weights, n_kept, last_axis }
    }

    /// Ranges of runs that a thread takes at a time, in a block of `width` channels.
    pub(super) fn portions(&self, width: usize) -> Vec<Range<usize>> {
        let (mut portions, mut first, mut n_values) = (Vec::new(), 0, 0);
        for (k, run) in self.list.iter().enumerate() {
            n_values += run.len * width;
            if n_values >= VALUES_AT_A_TIME || k + 1 == self.list.len() {
                portions.push(first..k + 1);
                (first, n_values) = (k + 1, 0);
            }
        }
        portions
    }

    /// Computes `(I − Φ₁)x` in a run into `out`, its places × channels; `x` has all places with data.
    #[inline(always)]
    pub(super) fn run_difference(&self, run: &Run, x: &[f64], n_channels: usize, out: &mut [f64]) {
        let (d, n) = (n_channels, run.len * n_channels);
        let (out, here) = (&mut out[..n], &x[run.start * d..][..n]);
        let weight = self.weights[self.last_axis];
        let along = |value: f64, other: f64| weight * (value - other);
        out.fill(0.0);
        for (out, (value, before)) in out[d..].iter_mut().zip(here[d..].iter().zip(here)) {
            *out = along(*value, *before);
        }
        for (out, (value, after)) in out.iter_mut().zip(here.iter().zip(&here[d..])) {
            *out += along(*value, *after);
        }
        for link in &self.links[run.links.clone()] {
            let [from, there, len] = [link.here, link.there, link.len].map(|value| value as usize * d);
            let (out, weight) = (&mut out[from - run.start * d..][..len], self.weights[link.axis as usize]);
            for (out, (value, other)) in out.iter_mut().zip(x[from..][..len].iter().zip(&x[there..][..len])) {
                *out += weight * (value - other);
            }
        }
    }

    /// Calls `work(run, values)` for the values of each run, in parallel; `values` are places with data × channels.
    pub(super) fn visit(
        &self,
        values: &mut [f64],
        n_channels: usize,
        progress: Progress<'_>,
        work: impl Fn(&Run, &mut [f64]) + Sync + Send,
    ) -> Result<(), Cancelled> {
        let (mut rest, mut items) = (values, Vec::new());
        for portion in self.portions(n_channels) {
            let runs = &self.list[portion];
            let (values, others) = rest.split_at_mut(runs.iter().map(|run| run.len * n_channels).sum());
            items.push((runs, values));
            rest = others;
        }
        parallel::try_each(items, self.n_kept, progress, |(runs, mut values)| {
            for run in runs {
                let (head, others) = values.split_at_mut(run.len * n_channels);
                work(run, head);
                values = others;
            }
            Ok(())
        })
    }

    /// The channels `channels` of the places with data of a signal of `n_channels`.
    pub(super) fn gather(
        &self,
        x: &[f64],
        n_channels: usize,
        channels: Range<usize>,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let mut values = zeros(self.n_kept * channels.len());
        self.visit(&mut values, channels.len(), progress, |run, values| {
            let places = x[run.place * n_channels..].chunks_exact(n_channels);
            for (value, place) in values.chunks_exact_mut(channels.len()).zip(places) {
                value.copy_from_slice(&place[channels.clone()]);
            }
        })?;
        Ok(values)
    }

    /// Computes `(I − Φ₁)x` at the places with data into `out`; `x` has these alone.
    pub(super) fn compact_difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        self.visit(out, n_channels, progress, |run, out| self.run_difference(run, x, n_channels, out))
    }

    /// Computes `(I − Φ₁)x` at all places, 0 without data.
    pub(super) fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let (values, mut found) =
            (self.gather(x, n_channels, 0..n_channels, progress)?, zeros(self.n_kept * n_channels));
        self.compact_difference(&values, n_channels, &mut found, progress)?;
        out.fill(0.0);
        for run in &self.list {
            let values = &found[run.start * n_channels..][..run.len * n_channels];
            out[run.place * n_channels..][..values.len()].copy_from_slice(values);
        }
        Ok(())
    }
}
