//! Streaming of LAS and LAZ: encoded point records in blocks, for clouds that do not fit in memory.
//!
//! [`LasReader`] reads records in the order of the file, [`LasWriter`] appends records to a new file. The memory does
//! not depend on the number of points, nor on numbers in the header. A LAZ is decompressed and compressed chunk by
//! chunk on all threads of the pool; the bytes do not depend on their number.

pub(in crate::formats::las) mod coding;
mod column;
mod pack;
mod read;
#[cfg(test)]
mod tests;
mod unpack;
mod write;

pub use column::LasColumn;
pub use read::LasReader;
pub use write::LasWriter;

use crate::formats::las::read::{LasHeader, f64_at};

/// Storage of the points in a LAS or LAZ.
///
/// A coordinate is `scale * whole + offset`, where `whole` is the signed little-endian 32-bit number at byte 0 (x), 4
/// (y) or 8 (z) of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct LasLayout {
    /// Point data record format, 0 to 10.
    pub format: u8,
    /// Size of a record in bytes, including extra bytes.
    pub record_bytes: usize,
    /// Size of one step in each coordinate.
    pub scale: [f64; 3],
    /// Coordinate of step 0.
    pub offset: [f64; 3],
    /// Number of points stated in the header.
    pub n_points: u64,
    /// Smallest and largest coordinates stated in the header; `None` unless they are finite and in order.
    pub bounds: Option<([f64; 3], [f64; 3])>,
}

impl LasLayout {
    fn from_header(bytes: &[u8], header: &LasHeader) -> Self {
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
