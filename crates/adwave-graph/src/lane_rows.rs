//! Memory of rows of lanes, from the start of a cache line on and in large pages.

use crate::lanes::MAX_LANES;
use adwave::pages::zeros;
use std::ops::{Deref, DerefMut};

/// Number format of lanes. Sums over the entries of a row are in double precision, whatever the format.
pub(crate) trait LaneNumber: Copy + Default + Send + Sync + std::fmt::Debug + 'static {
    /// True for single precision, whose values must be scaled to fit its range.
    const IS_SINGLE: bool;

    /// The nearest number of this format.
    fn rounded(value: f64) -> Self;

    /// Value in double precision.
    fn widened(self) -> f64;

    /// Lets `fill` write a row, and in single precision multiplies it by the factors and raises the sizes to those of
    /// its values.
    fn fill_row(
        out: &mut [Self],
        factors: &[f64; MAX_LANES],
        sizes: &mut [f64; MAX_LANES],
        fill: impl FnOnce(&mut [f64]),
    );
}

impl LaneNumber for f64 {
    const IS_SINGLE: bool = false;

    fn rounded(value: f64) -> Self {
        value
    }

    fn widened(self) -> f64 {
        self
    }

    #[inline]
    fn fill_row(
        out: &mut [Self],
        _: &[f64; MAX_LANES],
        _: &mut [f64; MAX_LANES],
        fill: impl FnOnce(&mut [f64]),
    ) {
        fill(out);
    }
}

impl LaneNumber for f32 {
    const IS_SINGLE: bool = true;

    fn rounded(value: f64) -> Self {
        value as Self
    }

    fn widened(self) -> f64 {
        self.into()
    }

    #[inline]
    fn fill_row(
        out: &mut [Self],
        factors: &[f64; MAX_LANES],
        sizes: &mut [f64; MAX_LANES],
        fill: impl FnOnce(&mut [f64]),
    ) {
        let mut row = [0.0; MAX_LANES];
        let row = &mut row[..out.len()];
        fill(row);
        for (((out, v), factor), size) in out.iter_mut().zip(row).zip(factors).zip(sizes) {
            *v *= factor;
            *size = if v.abs() > *size { v.abs() } else { *size };
            *out = Self::rounded(*v);
        }
    }
}

/// Bytes of a cache line. A row of 64 bytes that begins elsewhere lies in two lines, and products that gather rows in
/// any order then take twice as long.
pub(crate) const LINE: usize = 64;

/// A vector of values whose first one begins a cache line.
#[derive(Debug)]
pub(crate) struct LaneRows<T> {
    memory: Vec<T>,
    start: usize,
    len: usize,
}

impl<T: LaneNumber> LaneRows<T> {
    /// `len` zeros.
    pub(crate) fn zeros(len: usize) -> Self {
        let more = LINE / size_of::<T>() - 1;
        let memory = zeros::<T>(len + more);
        let start = memory.as_ptr().align_offset(LINE).min(more);
        Self { memory, start, len }
    }
}

impl<T> Deref for LaneRows<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.memory[self.start..][..self.len]
    }
}

impl<T> DerefMut for LaneRows<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.memory[self.start..][..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<T: LaneNumber + PartialEq>() {
        for len in [0, 1, 8, 100, 1 << 20] {
            let mut rows = LaneRows::<T>::zeros(len);
            assert_eq!(rows.len(), len);
            let is_zero = rows.iter().all(|&v| v == T::default());
            assert!(rows.as_ptr().addr().is_multiple_of(LINE) && is_zero);
            (0..len).for_each(|i| rows[i] = T::rounded(i as f64));
            assert!((0..len).all(|i| rows[i].widened() == i as f64));
        }
    }

    #[test]
    fn rows_begin_a_cache_line_and_hold_what_is_written() {
        check::<f64>();
        check::<f32>();
    }
}
