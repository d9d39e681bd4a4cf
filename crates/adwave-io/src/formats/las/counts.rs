//! The counts of points in the header of a LAS.

use crate::formats::las::read::u32_at;
use crate::formats::las::write::{LONG_HEADER, put};

/// How many points there are, and how many of each return.
#[derive(Default)]
pub(crate) struct Counts {
    pub(crate) n: u64,
    by_return: [u64; 16],
}

impl Counts {
    /// Counts one point record.
    pub(crate) fn add(&mut self, row: &[u8], format: u8) {
        let mask = if format < 6 { 7 } else { 15 };
        self.n += 1;
        self.by_return[usize::from(row[14] & mask)] += 1;
    }

    /// Puts the counts where the header has a place for them. The 32-bit ones stay 0 where they are 0, and become 0 where there are
    /// more points than they count.
    pub(crate) fn put_into(&self, header: &mut [u8]) {
        if u32_at(header, 107).is_some_and(|legacy| legacy > 0) {
            let fits = u32::try_from(self.n).is_ok();
            let legacy = |n: u64| if fits { n as u32 } else { 0 };
            put(header, 107, legacy(self.n).to_le_bytes());
            for k in 0..5 {
                put(header, 111 + 4 * k, legacy(self.by_return[k + 1]).to_le_bytes());
            }
        }
        if has_long_counts(header) {
            put(header, 247, self.n.to_le_bytes());
            for k in 0..15 {
                put(header, 255 + 8 * k, self.by_return[k + 1].to_le_bytes());
            }
        }
    }
}

/// Whether the header has 64-bit counts.
pub(crate) fn has_long_counts(header: &[u8]) -> bool {
    header[25] >= 4 && header.len() >= LONG_HEADER
}
