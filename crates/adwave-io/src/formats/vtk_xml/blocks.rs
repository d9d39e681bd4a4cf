//! Bytes of an array: after a count, or in compressed blocks after a table of their sizes.

use std::borrow::Cow;
use std::io::{Read, Write};

use adwave::{Cancelled, Progress};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rayon::prelude::*;

use super::document::{ArrayEncoding, Compressor, XmlFrame};
use crate::model::field::{ByteOrder, Number};
use crate::progress::BYTES_PER_STEP;
use crate::{ReadError, WriteError};

/// Uncompressed size of one written block in bytes.
const BLOCK: usize = 1 << 20;

/// Largest ratio of decompressed to compressed bytes of a zlib stream.
const MOST_PLAIN_PER_PACKED: u64 = 1040;

/// Reasons for which an array's bytes cannot be read.
pub(super) enum BlockError {
    Cancelled(Cancelled),
    /// A limit is exceeded.
    Error(ReadError),
    Message(String),
}

impl From<Cancelled> for BlockError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl From<ReadError> for BlockError {
    fn from(error: ReadError) -> Self {
        Self::Error(error)
    }
}

impl From<String> for BlockError {
    fn from(message: String) -> Self {
        Self::Message(message)
    }
}

/// Decodes Base64 with blanks in it. The table before blocks is often encoded separately, so that padding occurs
/// within the text.
pub(super) fn from_base64(text: &[u8], progress: Progress<'_>) -> Result<Vec<u8>, BlockError> {
    let mut letters = Vec::with_capacity(text.len());
    for chunk in text.chunks(BYTES_PER_STEP) {
        progress.check()?;
        letters.extend(chunk.iter().filter(|b| !b.is_ascii_whitespace()));
    }
    let mut plain = Vec::with_capacity(letters.len() / 4 * 3);
    let mut start = 0;
    while start < letters.len() {
        progress.check()?;
        let most = (start + BYTES_PER_STEP).min(letters.len());
        let padding = memchr::memchr(b'=', &letters[start..most]);
        // Groups of four letters encode three bytes; the padding ends a group.
        let end = padding.map_or(most, |n| (start + n / 4 * 4 + 4).min(letters.len()));
        STANDARD
            .decode_vec(&letters[start..end], &mut plain)
            .map_err(|e| format!("its Base64 is damaged ({e}); get the whole file"))?;
        start = end;
    }
    Ok(plain)
}

fn header(bytes: &[u8], k: usize, width: usize, order: ByteOrder) -> Option<u64> {
    let number = bytes.get(k.checked_mul(width)?..)?.get(..width)?;
    Some(if width == 8 { u64::from_bytes(number, order) } else { u32::from_bytes(number, order).into() })
}

/// Decodes the array at the start of `bytes`.
pub(super) fn plain<'a>(
    frame: &XmlFrame<'_>,
    bytes: Cow<'a, [u8]>,
    progress: Progress<'_>,
) -> Result<Cow<'a, [u8]>, BlockError> {
    let cut = || BlockError::Message("its data end too early; get the whole file".into());
    let ArrayEncoding { order, header_bytes: width, compressor } = frame.encoding;
    let number = |k: usize| header(&bytes, k, width, order);
    let first = number(0).ok_or_else(cut)?;
    if compressor == Compressor::None {
        let end = usize::try_from(first).ok().and_then(|n| n.checked_add(width)).ok_or_else(cut)?;
        if end > bytes.len() {
            return Err(cut());
        }
        // Arrays may share their bytes.
        frame.spend(first)?;
        return Ok(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[width..end]),
            Cow::Owned(mut bytes) => {
                bytes.truncate(end);
                bytes.drain(..width);
                Cow::Owned(bytes)
            }
        });
    }
    if first == 0 {
        return Ok(Cow::Borrowed(&[]));
    }
    let (size, last) = (number(1).ok_or_else(cut)?, number(2).ok_or_else(cut)?);
    let n =
        usize::try_from(first).ok().filter(|n| n.checked_add(3).is_some_and(|n| n <= bytes.len() / width));
    let n = n.ok_or_else(cut)?;
    let mut packed = Vec::with_capacity(n);
    let mut at = (3 + n) * width;
    for k in 0..n {
        let length = number(3 + k).and_then(|n| usize::try_from(n).ok()).ok_or_else(cut)?;
        let end = at.checked_add(length).filter(|&end| end <= bytes.len()).ok_or_else(cut)?;
        packed.push(&bytes[at..end]);
        at = end;
    }
    let last = if last == 0 { size } else { last };
    let total = (first - 1).checked_mul(size).and_then(|n| n.checked_add(last)).ok_or_else(cut)?;
    let n_packed: u64 = packed.iter().map(|block| block.len() as u64 + 8).sum();
    if last > size || size == 0 || total / MOST_PLAIN_PER_PACKED > n_packed {
        return Err("its table of compressed blocks is damaged; get the whole file".to_owned().into());
    }
    frame.spend(total)?;
    let mut all = vec![0; total as usize];
    let size = size as usize;
    all.par_chunks_mut(size).zip(&packed).try_for_each(|(plain, packed)| -> Result<(), BlockError> {
        progress.check()?;
        inflate(packed, plain, progress)
    })?;
    Ok(Cow::Owned(all))
}

impl ArrayEncoding {
    /// Bytes before the data of an array, and the data; `None` if a size is too large for the numbers before the data.
    /// These are the number of bytes, or of compressed arrays the number of blocks, the size of a block, the size of the
    /// last one if it is smaller, and the compressed size of each.
    pub(super) fn encode(
        &self,
        plain: Vec<u8>,
        progress: Progress<'_>,
    ) -> Result<Option<[Vec<u8>; 2]>, WriteError> {
        let (mut sizes, mut data) = (Vec::new(), Vec::new());
        if self.compressor == Compressor::None {
            sizes.push(plain.len() as u64);
            data = plain;
        } else {
            sizes.extend([plain.len().div_ceil(BLOCK), BLOCK, plain.len() % BLOCK].map(|n| n as u64));
            for block in plain.chunks(BLOCK) {
                progress.check()?;
                let start = data.len();
                let mut zlib = flate2::write::ZlibEncoder::new(&mut data, flate2::Compression::fast());
                zlib.write_all(block)?;
                zlib.finish()?;
                sizes.push((data.len() - start) as u64);
            }
        }
        let mut head = Vec::with_capacity(sizes.len() * self.header_bytes);
        for size in sizes {
            if self.header_bytes == 8 {
                size.write_bytes(self.order, &mut head);
            } else if let Ok(size) = u32::try_from(size) {
                size.write_bytes(self.order, &mut head);
            } else {
                return Ok(None);
            }
        }
        Ok(Some([head, data]))
    }

    /// [`encode`](Self::encode) as Base64, in which the head of a compressed array is a text of its own.
    pub(super) fn encode_text(
        &self,
        plain: Vec<u8>,
        progress: Progress<'_>,
    ) -> Result<Option<String>, WriteError> {
        let Some([mut head, data]) = self.encode(plain, progress)? else { return Ok(None) };
        if self.compressor == Compressor::None {
            head.extend(data);
            return Ok(Some(STANDARD.encode(head)));
        }
        Ok(Some(STANDARD.encode(head) + &STANDARD.encode(data)))
    }
}

/// Decompresses a zlib stream into `plain`.
fn inflate(packed: &[u8], plain: &mut [u8], progress: Progress<'_>) -> Result<(), BlockError> {
    let mut stream = flate2::read::ZlibDecoder::new(packed);
    for part in plain.chunks_mut(BYTES_PER_STEP) {
        progress.check()?;
        stream
            .read_exact(part)
            .map_err(|e| format!("one of its compressed blocks is damaged ({e}); get the whole file"))?;
    }
    Ok(())
}
