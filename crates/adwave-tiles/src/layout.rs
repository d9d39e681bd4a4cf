//! How a record says where its point is.

use serde::{Deserialize, Serialize};

/// The layout of all records of a work: those of LAS, whose first twelve bytes are the coordinates as whole numbers of a scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Layout {
    pub(crate) format: u8,
    pub(crate) record_bytes: usize,
    pub(crate) scale: [f64; 3],
    pub(crate) offset: [f64; 3],
}

/// Bytes of the three coordinates.
pub(crate) const COORDINATES: usize = 12;

/// The coordinates of a record in steps of the scale.
pub(crate) fn whole(record: &[u8]) -> [i32; 3] {
    let at = |c: usize| <[u8; 4]>::try_from(&record[4 * c..][..4]).map_or(0, i32::from_le_bytes);
    [at(0), at(1), at(2)]
}

pub(crate) fn set_whole(record: &mut [u8], whole: [i32; 3]) {
    for (bytes, c) in record.chunks_exact_mut(4).zip(whole) {
        bytes.copy_from_slice(&c.to_le_bytes());
    }
}

impl Layout {
    /// A position in model units.
    pub(crate) fn position(&self, whole: [i32; 3]) -> [f64; 3] {
        std::array::from_fn(|c| f64::from(whole[c]) * self.scale[c] + self.offset[c])
    }

    /// The nearest steps of the scale, where there are such.
    pub(crate) fn nearest(&self, position: [f64; 3]) -> Option<[i32; 3]> {
        let mut whole = [0; 3];
        for c in 0..3 {
            let steps = ((position[c] - self.offset[c]) / self.scale[c]).round();
            if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&steps) {
                return None;
            }
            whole[c] = steps as i32;
        }
        Some(whole)
    }
}
