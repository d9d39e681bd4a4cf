//! LAS and LAZ in portions: point records as they stand in the file, for clouds that do not fit in memory.
//!
//! [`LasReader`] gives records in the order of the file, [`LasWriter`] appends records to a new one. What is in memory at a time
//! does not depend on the number of points, nor on what a header says about it. A LAZ is unpacked and packed chunk by chunk, by
//! all threads of the pool; the bytes do not depend on how many there are.

pub(in crate::formats::las) mod coding;
mod pack;
mod read;
#[cfg(test)]
mod tests;
mod unpack;
mod write;

pub use read::LasReader;
pub use write::LasWriter;

use crate::formats::las::read::{Header, f64_at};

/// How the points of a LAS or LAZ are stored.
///
/// A coordinate is `scale * whole + offset`, where `whole` is the signed 32-bit number, least byte first, at byte 0 (x), 4 (y) or
/// 8 (z) of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct LasLayout {
    /// The point data record format, 0 to 10.
    pub format: u8,
    /// Bytes of a record, extra bytes included.
    pub record_bytes: usize,
    /// The size of a step in each coordinate.
    pub scale: [f64; 3],
    /// What step 0 stands for.
    pub offset: [f64; 3],
    /// How many points the header promises.
    pub n_points: u64,
    /// The least and the greatest coordinates that the header states, where they are finite and in order.
    pub bounds: Option<([f64; 3], [f64; 3])>,
}

impl LasLayout {
    fn of(bytes: &[u8], header: &Header) -> Self {
        let triple = |at: usize| {
            let own = [0, 1, 2].map(|axis| f64_at(bytes, at + 16 * axis).unwrap_or(f64::NAN));
            own.iter().all(|x| x.is_finite()).then_some(own)
        };
        let is_ordered =
            |(low, high): &([f64; 3], [f64; 3])| low.iter().zip(high).all(|(low, high)| low <= high);
        Self {
            format: header.format,
            record_bytes: header.record_bytes,
            scale: header.scale,
            offset: header.offset,
            n_points: header.n_points,
            bounds: triple(187).zip(triple(179)).filter(is_ordered),
        }
    }
}
