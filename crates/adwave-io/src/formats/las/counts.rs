//! Point counts in the header of a LAS.

use crate::formats::las::read::u32_at;
use crate::formats::las::write::{LONG_HEADER, put};

/// Number of points, and number of points of each return.
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

    /// Stores the counts in the header. 32-bit counts that are 0 stay 0, and become 0 if they overflow.
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

/// True if the header has 64-bit counts.
pub(crate) fn has_long_counts(header: &[u8]) -> bool {
    header[25] >= 4 && header.len() >= LONG_HEADER
}
