//! Memory of rows of lanes, from the start of a cache line on and in large pages.

use adwave::pages::zeros;
use rayon::prelude::*;
use std::ops::{Deref, DerefMut};

/// Bytes of a cache line, and the number of values in one. A row of 8 lanes that begins elsewhere lies in two lines, and
/// products that gather rows in any order then take twice as long.
const LINE: usize = 64;
const VALUES_PER_LINE: usize = LINE / size_of::<f64>();

/// Values that a thread processes at a time.
const AT_A_TIME: usize = 1 << 14;

/// A vector of values whose first one begins a cache line.
#[derive(Debug)]
pub(crate) struct LaneRows {
    memory: Vec<f64>,
    start: usize,
    len: usize,
}

impl LaneRows {
    /// `len` zeros.
    pub(crate) fn zeros(len: usize) -> Self {
        let memory = zeros::<f64>(len + VALUES_PER_LINE - 1);
        let start = memory.as_ptr().align_offset(LINE).min(VALUES_PER_LINE - 1);
        Self { memory, start, len }
    }

    /// Copies all values of another vector of the same length.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let chunks = self.par_chunks_mut(AT_A_TIME).zip(other.par_chunks(AT_A_TIME));
        chunks.for_each(|(out, values)| out.copy_from_slice(values));
    }

    /// Subtracts the values of another vector of the same length.
    pub(crate) fn subtract(&mut self, other: &Self) {
        self.par_chunks_mut(AT_A_TIME).zip(other.par_chunks(AT_A_TIME)).for_each(|(out, values)| {
            out.iter_mut().zip(values).for_each(|(out, v)| *out -= v);
        });
    }
}

impl Deref for LaneRows {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.memory[self.start..][..self.len]
    }
}

impl DerefMut for LaneRows {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.memory[self.start..][..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_begin_a_cache_line_and_hold_what_is_written() {
        for len in [0, 1, 8, 100, 1 << 20] {
            let mut rows = LaneRows::zeros(len);
            assert_eq!(rows.len(), len);
            assert!(rows.as_ptr().addr().is_multiple_of(LINE) && rows.iter().all(|&v| v == 0.0));
            (0..len).for_each(|i| rows[i] = i as f64);
            let mut copy = LaneRows::zeros(len);
            copy.copy_from(&rows);
            assert_eq!(*copy, *rows);
            copy.subtract(&rows);
            assert!(copy.iter().all(|&v| v == 0.0));
        }
    }
}
