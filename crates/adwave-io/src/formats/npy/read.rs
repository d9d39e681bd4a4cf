//! Reader of NumPy's `.npy`: one array.
//!
//! The parser is our own: the header is one line, and the libraries allocate its sizes before they check them against
//! the file.

use crate::files::read::parse_file;
use std::path::Path;

use adwave::Progress;

use crate::model::field::{ByteOrder, Number, with_values};
use crate::progress::extend;
use crate::{Field, FieldValues, ReadError, ReadLimits, ValueType};

/// Array of numbers, last index fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct NpyArray {
    /// Length in each dimension.
    pub shape: Vec<usize>,
    /// Numbers; their count is the product of `shape`.
    pub values: FieldValues,
}

impl NpyArray {
    /// Converts the array to a field: each row is a vertex, and the remaining dimensions are its channels.
    pub fn into_field(self, name: &str) -> Field {
        // The other lengths of an array without rows are arbitrary.
        let product = self.shape.iter().skip(1).try_fold(1_usize, |product, &n| product.checked_mul(n));
        let n_channels = product.unwrap_or(1).max(1);
        Field::new(name, n_channels, self.values)
    }
}

/// Reads a `.npy` of integers or floats, in C or Fortran order and either byte order.
///
/// # Errors
/// The file cannot be read, is not a `.npy`, is truncated, or has values that are not numbers. The message is one
/// line with the file's name.
pub fn read_npy(path: &Path, limits: &ReadLimits) -> Result<NpyArray, ReadError> {
    read_npy_with(path, limits, Progress::none())
}

/// [`read_npy`] with progress and cancellation.
///
/// # Errors
/// The errors of [`read_npy`], and [`ReadError::Cancelled`].
pub fn read_npy_with(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<NpyArray, ReadError> {
    parse_file(path, limits, progress, |bytes| parse(&bytes, progress))
}

/// [`read_npy`] from bytes.
///
/// # Errors
/// The errors of [`read_npy`], without the file's name.
pub fn read_npy_bytes(bytes: &[u8]) -> Result<NpyArray, ReadError> {
    parse(bytes, Progress::none())
}

/// Bytes that hold every header of ordinary length: longer ones are described by the data types of structures.
pub(super) const HEADER_BYTES: usize = 1 << 16;

/// Shape, type and place of the numbers of an array.
#[derive(Clone, Debug)]
pub(super) struct NpyHeader {
    /// Bytes before the numbers.
    pub(super) start: usize,
    pub(super) value_type: ValueType,
    pub(super) order: ByteOrder,
    pub(super) shape: Vec<usize>,
    pub(super) n_values: usize,
    /// True if the first index runs fastest.
    pub(super) is_fortran: bool,
}

impl NpyHeader {
    /// Parses the first bytes of a file of `n_bytes`.
    pub(super) fn parse(bytes: &[u8], n_bytes: u64) -> Result<Self, ReadError> {
        let wrong = |at: usize, message: &str| ReadError::byte_error(at, message);
        if !bytes.starts_with(b"\x93NUMPY") {
            return Err(wrong(0, "the file is not a NumPy array; save it with numpy.save"));
        }
        let (start, n): (usize, usize) = match (bytes.get(6), bytes.get(8..10), bytes.get(8..12)) {
            (Some(1), Some(n), _) => (10, usize::from(u16::from_le_bytes([n[0], n[1]]))),
            (Some(2 | 3), _, Some(n)) => (12, u32::from_le_bytes([n[0], n[1], n[2], n[3]]) as usize),
            _ => return Err(wrong(6, "the version of the NumPy array must be 1, 2 or 3")),
        };
        let text = bytes.get(start..start.saturating_add(n)).map(String::from_utf8_lossy);
        let Some(text) = text else {
            return Err(wrong(bytes.len(), "the header is truncated; get the whole file"));
        };
        let (value_type, order) = value_type(&text).ok_or_else(|| {
            wrong(start, "the array must have integers or floats of 1 to 8 bytes; convert it with astype")
        })?;
        let shape =
            shape(&text).ok_or_else(|| wrong(start, "the header has no shape; save the array again"))?;
        let body = n_bytes.saturating_sub((start + n) as u64);
        let product = shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
        let needed = product.and_then(|p| p.checked_mul(value_type.n_bytes()));
        let (Some(n_values), Some(_)) = (product, needed.filter(|&needed| needed as u64 <= body)) else {
            return Err(ReadError::Truncated {
                end: n_bytes,
                needed: ((start + n) as u64).saturating_add(needed.unwrap_or(usize::MAX) as u64),
                element: "array".into(),
                row: body / value_type.n_bytes() as u64,
            });
        };
        let is_fortran = text.contains("'fortran_order': True") && shape.len() > 1;
        Ok(Self { start: start + n, value_type, order, shape, n_values, is_fortran })
    }
}

fn parse(bytes: &[u8], progress: Progress<'_>) -> Result<NpyArray, ReadError> {
    let header = NpyHeader::parse(bytes, bytes.len() as u64)?;
    let NpyHeader { start, value_type, order, shape, n_values, is_fortran } = header;
    let body = &bytes[start..];
    let mut values = value_type.empty();
    let width = value_type.n_bytes();
    let place = |i: usize| if is_fortran { fortran_position(i, &shape) } else { i };
    with_values!(&mut values, v => extend(v, n_values, progress, |i| {
        Number::from_bytes(&body[place(i) * width..], order)
    }))?;
    Ok(NpyArray { shape, values })
}

/// Position of C index `i` when the first index runs fastest.
fn fortran_position(mut i: usize, shape: &[usize]) -> usize {
    let mut stride: usize = shape.iter().product();
    let mut position = 0;
    for &n in shape.iter().rev() {
        stride /= n;
        position += (i % n) * stride;
        i /= n;
    }
    position
}

/// Text after a key of the header's dictionary.
fn after<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let at = text.find(key)? + key.len();
    Some(text[at..].trim_start().strip_prefix(':')?.trim_start())
}

fn value_type(text: &str) -> Option<(ValueType, ByteOrder)> {
    let descr = after(text, "'descr'")?.strip_prefix('\'')?.split('\'').next()?;
    let order = if descr.starts_with('>') { ByteOrder::Big } else { ByteOrder::Little };
    let value_type = match descr.trim_start_matches(['<', '>', '|', '=']) {
        "u1" | "b1" => ValueType::U8,
        "i1" => ValueType::I8,
        "u2" => ValueType::U16,
        "i2" => ValueType::I16,
        "u4" => ValueType::U32,
        "i4" => ValueType::I32,
        "u8" => ValueType::U64,
        "i8" => ValueType::I64,
        "f4" => ValueType::F32,
        "f8" => ValueType::F64,
        _ => return None,
    };
    Some((value_type, order))
}

fn shape(text: &str) -> Option<Vec<usize>> {
    let inside = after(text, "'shape'")?.strip_prefix('(')?.split(')').next()?;
    let numbers = inside.split(',').map(str::trim).filter(|t| !t.is_empty());
    let shape: Vec<usize> = numbers.map(|t| t.parse().ok()).collect::<Option<_>>()?;
    (shape.len() <= 32).then_some(shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(header: &str, body: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(body);
        bytes
    }

    #[test]
    fn both_orders_give_the_same_array() {
        let c = npy("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }\n", &[0, 1, 2, 3, 4, 5]);
        let fortran =
            npy("{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3), }\n", &[0, 3, 1, 4, 2, 5]);
        let array = read_npy_bytes(&c).unwrap();
        assert_eq!(array, read_npy_bytes(&fortran).unwrap());
        assert_eq!(array.values, FieldValues::U8(vec![0, 1, 2, 3, 4, 5]));
        assert_eq!(array.into_field("a").n_channels, 3);
    }

    #[test]
    fn a_promise_larger_than_the_file_fails_at_once() {
        let huge =
            npy("{'descr': '<f8', 'fortran_order': False, 'shape': (4000000000, 4000000000), }\n", &[0; 8]);
        assert!(matches!(read_npy_bytes(&huge), Err(ReadError::Truncated { .. })));
        let overflowing =
            npy("{'descr': '|u1', 'fortran_order': False, 'shape': (18446744073709551615,), }\n", &[0; 8]);
        assert!(matches!(read_npy_bytes(&overflowing), Err(ReadError::Truncated { .. })));
        let empty = npy("{'descr': '<f8', 'fortran_order': True, 'shape': (0, 3), }\n", &[]);
        assert_eq!(read_npy_bytes(&empty).unwrap().values.len(), 0);
    }
}
