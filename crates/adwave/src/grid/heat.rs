//! Heat on a grid: a stencil, and all steps at once where every place has data.

use super::Axes;
use super::lines::{APPROXIMATIONS, Lines};
use crate::operator::{DiffusionError, Leap, Operator, Semigroup};
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;
use std::sync::Arc;

/// Values that a thread computes at a time, about.
const VALUES_AT_A_TIME: usize = 1 << 14;

/// Heat on a grid, `exp(−n·τ·L)` after n steps, with `L = Σ_a D_a/h_a²`, the second differences D of each axis and its
/// spacing h. τ is a quarter of the square of the smallest spacing, so that σ² = 4τn, as on a surface and on a curve, and
/// the variance along each axis is 2τn. `Φ₁ = I − L/λ` with `λ = Σ_a 4/h_a²`.
///
/// Constants and sums are kept, and the maximum principle holds, to the accuracy asked. Where every place has data, n steps
/// are one solve along each axis (see [`Leap`]), which costs the same for all n.
#[derive(Clone, Debug)]
pub struct GridHeat {
    axes: Axes,
    /// Places that belong to the data; all if `None`.
    kept: Option<Kept>,
}

/// Places that belong to the data.
#[derive(Clone, Debug)]
struct Kept {
    flags: Arc<[bool]>,
    /// Range from the first to the last of them in each row along the last axis.
    ranges: Arc<[Range<usize>]>,
}

impl GridHeat {
    pub(super) fn new(axes: Axes, kept: Option<Arc<[bool]>>) -> Self {
        let kept = kept.map(|flags| {
            let range = |row: &[bool]| {
                let first = row.iter().position(|kept| *kept).unwrap_or(0);
                first..row.iter().rposition(|kept| *kept).map_or(first, |last| last + 1)
            };
            Kept { ranges: flags.chunks_exact(axes.sizes[axes.sizes.len() - 1]).map(range).collect(), flags }
        });
        Self { axes, kept }
    }

    /// Weight of a side along `axis`, 1/h² in units of the smallest spacing.
    fn side_weight(&self, axis: usize) -> f64 {
        (self.axes.finest() / self.axes.spacings[axis]).powi(2)
    }

    /// Time of a step in units of 1/λ, which is also the sum of the weights of one side along each axis.
    fn rate(&self) -> f64 {
        self.axes.long().map(|axis| self.side_weight(axis)).sum::<f64>().max(f64::MIN_POSITIVE)
    }
}

impl Operator for GridHeat {
    fn n_rows(&self) -> usize {
        self.axes.n_places()
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn semigroup(&self) -> Semigroup {
        Semigroup::Heat { rate: self.rate() }
    }

    fn step_length(&self) -> f64 {
        self.axes.finest()
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let (axes, rate) = (&self.axes, self.rate());
        let last = axes.sizes.len() - 1;
        let row_len = axes.sizes[last] * n_channels;
        let at_a_time = VALUES_AT_A_TIME.div_ceil(row_len);
        parallel::try_visit_rows(out, row_len, at_a_time, progress, |first, rows| {
            for (k, out) in rows.chunks_exact_mut(row_len).enumerate() {
                let start = (first + k) * axes.sizes[last];
                out.fill(0.0);
                let part =
                    self.kept.as_ref().map_or(0..axes.sizes[last], |kept| kept.ranges[first + k].clone());
                if part.is_empty() {
                    continue;
                }
                for axis in axes.long() {
                    let weight = self.side_weight(axis) / (4.0 * rate);
                    let pairs =
                        Pairs { x, n_channels, kept: self.kept.as_ref().map(|kept| &*kept.flags), weight };
                    let ends = [start, start + axes.sizes[last] - 1];
                    let places = start + part.start..start + part.end;
                    let out = &mut out[part.start * n_channels..part.end * n_channels];
                    if axis == last {
                        pairs.add_along(&places, axes.is_periodic[axis].then_some(ends), out);
                    } else {
                        let sides = axes.sides(axis, places.start, axes.coordinate(axis, places.start));
                        sides.into_iter().flatten().for_each(|other| pairs.add(places.clone(), other, out));
                    }
                }
            }
        })
    }

    fn masked(
        &self,
        masked: &[bool],
        _: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        _: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        if masked.len() != self.n_rows() {
            return Err(DiffusionError::RowCount { n_rows: self.n_rows(), n_vertices: masked.len() });
        }
        let was_kept = |place: usize| self.kept.as_ref().is_none_or(|kept| kept.flags[place]);
        let kept = masked.iter().enumerate().map(|(place, masked)| !masked && was_kept(place)).collect();
        Ok(Some(Arc::new(Self::new(self.axes.clone(), Some(kept)))))
    }

    fn keeps_promises(&self) -> bool {
        true
    }

    fn leap(&self) -> Option<&dyn Leap> {
        self.kept.is_none().then_some(self)
    }
}

/// Differences of a signal between places and places at a distance.
struct Pairs<'a> {
    x: &'a [f64],
    n_channels: usize,
    kept: Option<&'a [bool]>,
    weight: f64,
}

impl Pairs<'_> {
    /// Adds the weighted differences of a row of places and the places from `other` on to `out`; none where one of the
    /// two is left out.
    fn add(&self, row: Range<usize>, other: usize, out: &mut [f64]) {
        let (n, d) = (row.len(), self.n_channels);
        let here = &self.x[row.start * d..][..n * d];
        let there = &self.x[other * d..][..n * d];
        let weight = self.weight;
        let Some(kept) = self.kept else {
            for ((out, here), there) in out.iter_mut().zip(here).zip(there) {
                *out += weight * (here - there);
            }
            return;
        };
        let both = kept[row].iter().zip(&kept[other..][..n]).map(|(a, b)| a & b);
        if d == 1 {
            for (((out, here), there), both) in out.iter_mut().zip(here).zip(there).zip(both) {
                let difference = weight * (here - there);
                *out += if both { difference } else { 0.0 };
            }
            return;
        }
        let values = out.chunks_exact_mut(d).zip(here.chunks_exact(d)).zip(there.chunks_exact(d));
        for (((out, here), there), _) in values.zip(both).filter(|(_, both)| *both) {
            for ((out, here), there) in out.iter_mut().zip(here).zip(there) {
                *out += weight * (here - there);
            }
        }
    }

    /// Adds the differences between adjacent places of a part of a row, which others do not adjoin, and between the ends
    /// of the row if it is a ring.
    fn add_along(&self, part: &Range<usize>, ring: Option<[usize; 2]>, out: &mut [f64]) {
        let (Range { start, end }, d) = (part.clone(), self.n_channels);
        if let Some([first, last]) = ring.filter(|[first, _]| *first == start) {
            self.add(first..first + 1, last, &mut out[..d]);
        }
        self.add(start + 1..end, start, &mut out[d..]);
        self.add(start..end - 1, start + 1, &mut out[..(end - 1 - start) * d]);
        if let Some([first, last]) = ring.filter(|[_, last]| *last + 1 == end) {
            self.add(last..last + 1, first, &mut out[(end - 1 - start) * d..]);
        }
    }
}

impl Leap for GridHeat {
    /// Each axis by the fewest poles that keep to `accuracy` together, 8 or 14. O(n · channels) for any number of steps.
    /// The bound grows with the number of steps by rounding, up to the time at which nothing but the mean is left.
    fn take_steps(
        &self,
        n_steps: f64,
        x: &[f64],
        n_channels: usize,
        accuracy: f64,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        out.copy_from_slice(x);
        let n_axes = self.axes.long().count() as f64;
        let keeps = |error: f64| n_axes * error <= accuracy;
        let [few, many] = &APPROXIMATIONS;
        let approximation = if keeps(few.error) { few } else { many };
        let mut bound = 0.0;
        for axis in self.axes.long() {
            let time = 0.25 * n_steps * self.side_weight(axis);
            let lines = Lines::new(&self.axes, axis, n_channels);
            lines.diffuse(out, time, approximation, progress)?;
            // Heat never increases the norm, so that the errors add up to their product.
            let error = lines.error(time, approximation);
            bound += error + bound * error;
        }
        Ok(bound)
    }
}
