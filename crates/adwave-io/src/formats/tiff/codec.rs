//! Compression of strips and tiles.

use std::io::{Read, Write};

use crate::ValueType;
use crate::model::field::ByteOrder;

/// Compression without a change.
pub(super) const UNCOMPRESSED: u64 = 1;
/// Deflate.
pub(super) const DEFLATE: u64 = 8;
const LZW: u64 = 5;
const OLD_DEFLATE: u64 = 32946;
const PACK_BITS: u64 = 32773;

/// Name of a compression that is not read.
pub(super) fn name_of(compression: u64) -> Option<&'static str> {
    Some(match compression {
        UNCOMPRESSED | LZW | DEFLATE | OLD_DEFLATE | PACK_BITS => return None,
        2..=4 => "of fax machines",
        6 | 7 => "JPEG",
        34887 => "LERC",
        34925 => "LZMA",
        50000 => "Zstandard",
        50001 => "WebP",
        33003 | 33005 | 34712 => "JPEG 2000",
        _ => "of an unknown kind",
    })
}

/// At most `n` decompressed bytes; `None` if the content is damaged before.
pub(super) fn decompress(bytes: &[u8], compression: u64, n: usize) -> Option<Vec<u8>> {
    let mut plain = Vec::new();
    match compression {
        UNCOMPRESSED => plain.extend_from_slice(&bytes[..bytes.len().min(n)]),
        DEFLATE | OLD_DEFLATE => {
            flate2::read::ZlibDecoder::new(bytes).take(n as u64).read_to_end(&mut plain).ok()?;
        }
        LZW => lzw(bytes, n, &mut plain)?,
        _ => pack_bits(bytes, n, &mut plain)?,
    }
    Some(plain)
}

/// Bytes compressed by Deflate.
pub(super) fn deflate(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    zlib.write_all(bytes)?;
    zlib.finish()
}

fn pack_bits(bytes: &[u8], n: usize, plain: &mut Vec<u8>) -> Option<()> {
    let mut at = 0;
    while plain.len() < n && at < bytes.len() {
        let head = bytes[at] as i8;
        at += 1;
        if head >= 0 {
            let end = at + head as usize + 1;
            plain.extend_from_slice(bytes.get(at..end)?);
            at = end;
        } else if head != -128 {
            let n_times = 1 + usize::from(head.unsigned_abs());
            plain.resize(plain.len() + n_times, *bytes.get(at)?);
            at += 1;
        }
    }
    plain.truncate(n);
    Some(())
}

/// LZW with codes of 9 to 12 bits, the greatest bit first.
fn lzw(bytes: &[u8], n: usize, plain: &mut Vec<u8>) -> Option<()> {
    const CLEAR: usize = 256;
    const END: usize = 257;
    // Place and length in `plain` of the text of each code from 258 on: that of the code before it and one more byte.
    let mut texts: Vec<(usize, usize)> = Vec::with_capacity(1 << 12);
    let (mut bits, mut n_bits, mut at) = (0_u32, 0_u32, 0);
    let mut width = 9;
    let mut before: Option<(usize, usize)> = None;
    while plain.len() < n {
        while n_bits < width {
            let Some(&byte) = bytes.get(at) else { return Some(()) };
            bits = bits << 8 | u32::from(byte);
            n_bits += 8;
            at += 1;
        }
        n_bits -= width;
        let code = (bits >> n_bits) as usize & ((1 << width) - 1);
        bits &= (1 << n_bits) - 1;
        match code {
            CLEAR => {
                texts.clear();
                (width, before) = (9, None);
                continue;
            }
            END => return Some(()),
            _ => {}
        }
        let start = plain.len();
        if code < CLEAR {
            plain.push(code as u8);
        } else if let Some(&(first, length)) = texts.get(code - 258) {
            plain.extend_from_within(first..first + length);
        } else {
            // The code that is being defined: the text before and its first byte.
            let (first, length) = before.filter(|_| code - 258 == texts.len())?;
            plain.extend_from_within(first..first + length);
            plain.push(plain[first]);
        }
        if let Some((first, length)) = before
            && texts.len() < (1 << 12) - 258
        {
            texts.push((first, length + 1));
        }
        before = Some((start, plain.len() - start));
        width = match texts.len() + 258 + 1 {
            0..512 => 9,
            512..1024 => 10,
            1024..2048 => 11,
            _ => 12,
        };
    }
    plain.truncate(n);
    Some(())
}

/// Layout of the rows that a predictor works on.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    /// Bytes of a row.
    pub(super) row_bytes: usize,
    /// Numbers from one to the next of the same channel.
    pub(super) n_samples: usize,
    pub(super) kind: ValueType,
    pub(super) order: ByteOrder,
}

/// Adds the differences along each row up again.
pub(super) fn undo_differences(bytes: &mut [u8], rows: Rows) {
    let width = rows.kind.n_bytes();
    let step = rows.n_samples * width;
    for row in bytes.chunks_exact_mut(rows.row_bytes) {
        for at in (step..row.len()).step_by(width) {
            let mut carry = 0_u16;
            for k in 0..width.min(row.len() - at) {
                let k = if rows.order == ByteOrder::Little { k } else { width - 1 - k };
                let sum = u16::from(row[at + k]) + u16::from(row[at + k - step]) + carry;
                row[at + k] = sum as u8;
                carry = sum >> 8;
            }
        }
    }
}

/// Adds the differences of bytes along each row up again, and puts the bytes of each float together, which lie apart
/// from the greatest to the least.
pub(super) fn undo_float_differences(bytes: &mut [u8], rows: Rows) {
    let width = rows.kind.n_bytes();
    for row in bytes.chunks_exact_mut(rows.row_bytes) {
        for at in rows.n_samples..row.len() {
            row[at] = row[at].wrapping_add(row[at - rows.n_samples]);
        }
        let apart = row.to_vec();
        let n = row.len() / width;
        for i in 0..n {
            for k in 0..width {
                let to = if rows.order == ByteOrder::Big { k } else { width - 1 - k };
                row[i * width + to] = apart[k * n + i];
            }
        }
    }
}
