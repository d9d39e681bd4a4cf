//! Sequential reading of numbers from binary files.

use crate::ReadError;
use crate::model::field::{ByteOrder, Number};
use crate::text::tokens::check_rows;

/// Read position in a binary file.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) position: usize,
    pub(crate) order: ByteOrder,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a [u8], position: usize, order: ByteOrder) -> Self {
        Self { bytes, position, order }
    }

    /// Returns the bytes of `n` rows of `row_bytes` each.
    pub(crate) fn rows(&mut self, n: u64, row_bytes: u64, element: &str) -> Result<&'a [u8], ReadError> {
        check_rows(self.bytes.len(), self.position, n, row_bytes, element, 0)?;
        let start = self.position;
        self.position += (n * row_bytes) as usize;
        Ok(&self.bytes[start..self.position])
    }

    /// Reads the next number.
    pub(crate) fn number<T: Number>(&mut self, element: &str, row: u64) -> Result<T, ReadError> {
        let end = self.position.saturating_add(size_of::<T>());
        let Some(bytes) = self.bytes.get(self.position..end) else {
            return Err(ReadError::Truncated {
                end: self.bytes.len() as u64,
                needed: end as u64,
                element: element.into(),
                row,
            });
        };
        self.position = end;
        Ok(T::from_bytes(bytes, self.order))
    }

    /// Reads the next 32-bit integer.
    pub(crate) fn i32(&mut self, element: &str) -> Result<i32, ReadError> {
        self.number(element, 0)
    }
}
