//! Header of an MRC: 1024 bytes.

use crate::model::field::{ByteOrder, Number};
use crate::{ReadError, ValueType};

/// Length of the header.
pub(super) const BYTES: usize = 1024;
/// Byte of the word `MAP`.
pub(super) const MAGIC: usize = 208;
pub(super) const SIZES: usize = 0;
pub(super) const MODE: usize = 12;
pub(super) const STARTS: usize = 16;
pub(super) const INTERVALS: usize = 28;
pub(super) const CELL: usize = 40;
pub(super) const AXES: usize = 64;
pub(super) const STATISTICS: usize = 76;
pub(super) const SPACE_GROUP: usize = 88;
pub(super) const EXTENSION: usize = 92;
pub(super) const VERSION: usize = 108;
pub(super) const ORIGIN: usize = 196;
pub(super) const STAMP: usize = 212;
pub(super) const DEVIATION: usize = 216;

/// Numbers of the header.
#[derive(Clone, Debug)]
pub(super) struct MrcHeader {
    pub(super) order: ByteOrder,
    /// Columns, rows and sections.
    pub(super) sizes: [usize; 3],
    pub(super) kind: ValueType,
    /// First byte of the numbers.
    pub(super) start: usize,
    pub(super) starts: [f64; 3],
    pub(super) intervals: [f64; 3],
    /// Lengths of the cell, then its angles in degrees.
    pub(super) cell: [f64; 6],
    /// Axis of columns, rows and sections, from 0 for x.
    pub(super) axes: [usize; 3],
    pub(super) space_group: i32,
    pub(super) origin: [f64; 3],
}

/// Byte order, by the stamp of the machine and else by the type of numbers.
fn order(bytes: &[u8]) -> ByteOrder {
    let mode = i32::from_bytes(&bytes[MODE..], ByteOrder::Little);
    match bytes[STAMP] {
        0x44 => ByteOrder::Little,
        0x11 => ByteOrder::Big,
        _ if (0..=101).contains(&mode) => ByteOrder::Little,
        _ => ByteOrder::Big,
    }
}

/// True if sizes and type can be those of a map.
pub(super) fn is_plausible(bytes: &[u8]) -> bool {
    let order = order(bytes);
    let number = |at: usize| i32::from_bytes(&bytes[at..], order);
    (0..=101).contains(&number(MODE)) && (0..3).all(|k| number(SIZES + 4 * k) > 0)
}

impl MrcHeader {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        if bytes.len() < BYTES {
            return Err(ReadError::byte_error(bytes.len(), "the header is truncated; get the whole file"));
        }
        let order = order(bytes);
        let number = |at: usize, k: usize| i32::from_bytes(&bytes[at + 4 * k..], order);
        let float = |at: usize, k: usize| f64::from(f32::from_bytes(&bytes[at + 4 * k..], order));
        let kind = match number(MODE, 0) {
            0 => ValueType::I8,
            1 => ValueType::I16,
            2 => ValueType::F32,
            6 => ValueType::U16,
            mode => {
                let name = match mode {
                    3 | 4 => "complex numbers",
                    12 => "floats of 16 bits",
                    101 => "integers of 4 bits",
                    _ => "numbers of an unknown type",
                };
                let message = format!("{name} (mode {mode}) are not supported; convert them to mode 2");
                return Err(ReadError::byte_error(MODE, message));
            }
        };
        let size = |k: usize| {
            usize::try_from(number(SIZES, k)).ok().filter(|&size| size > 0).ok_or_else(|| {
                let message =
                    format!("each axis must have a place, got {}; get an intact file", number(SIZES, k));
                ReadError::byte_error(SIZES + 4 * k, message)
            })
        };
        let extension = usize::try_from(number(EXTENSION, 0)).map_err(|_| {
            ReadError::byte_error(EXTENSION, "the extension has a negative length; get an intact file")
        })?;
        let axis = |k: usize| usize::try_from(number(AXES, k)).ok()?.checked_sub(1);
        let axes = [axis(0), axis(1), axis(2)];
        let is_permutation = (0..3).all(|k| axes.contains(&Some(k)));
        let axes = if is_permutation { axes.map(Option::unwrap_or_default) } else { [0, 1, 2] };
        Ok(Self {
            order,
            sizes: [size(0)?, size(1)?, size(2)?],
            kind,
            start: BYTES + extension,
            starts: std::array::from_fn(|k| number(STARTS, k).into()),
            intervals: std::array::from_fn(|k| number(INTERVALS, k).into()),
            cell: std::array::from_fn(|k| float(CELL, k)),
            axes,
            space_group: number(SPACE_GROUP, 0),
            origin: std::array::from_fn(|k| float(ORIGIN, k)),
        })
    }
}

/// Code of a type of numbers; `None` for types that a map cannot have.
pub(super) fn mode_of(kind: ValueType) -> Option<i32> {
    Some(match kind {
        ValueType::I8 => 0,
        ValueType::I16 => 1,
        ValueType::F32 => 2,
        ValueType::U16 => 6,
        _ => return None,
    })
}
