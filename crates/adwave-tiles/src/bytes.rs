//! Little-endian numbers in byte slices.

/// Reads numbers of fixed and variable size, one after the other. Every read is `None` past the end.
pub(crate) struct ByteCursor<'a> {
    pub(crate) bytes: &'a [u8],
}

impl ByteCursor<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.bytes.split_first_chunk::<N>()?;
        self.bytes = rest;
        Some(*head)
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    /// Reads a LEB128 number of at most 64 bits.
    pub(crate) fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let (&byte, rest) = self.bytes.split_first()?;
            self.bytes = rest;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }
}

/// Appends a LEB128 number, the counterpart of [`ByteCursor::varint`].
pub(crate) fn push_varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// The 32-bit number at byte `offset`.
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    <[u8; 4]>::try_from(&bytes[offset..][..4]).map_or(0, u32::from_le_bytes)
}
