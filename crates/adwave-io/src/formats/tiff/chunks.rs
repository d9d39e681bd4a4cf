//! Strips and tiles: from compressed bytes to the numbers of an image, and back.

use std::ops::Range;

use super::codec::{self, Rows};
use super::page::Page;
use crate::ReadError;
use crate::model::field::ByteOrder;

/// Strip or tile, as far as it is inside the image.
#[derive(Clone, Copy, Debug)]
struct ChunkPlace {
    plane: usize,
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

impl Page {
    fn place(&self, chunk: usize) -> ChunkPlace {
        let [across, down] = self.chunk_rows();
        let (plane, rest) = (chunk / (across * down), chunk % (across * down));
        let (x, y) = (rest % across * self.chunk[0], rest / across * self.chunk[1]);
        let (width, height) =
            (self.chunk[0].min(self.kind.width - x), self.chunk[1].min(self.kind.height - y));
        ChunkPlace { plane, x, y, width, height }
    }

    /// Bytes of the file that hold a strip or tile; `None` if it was left out because all of it is empty.
    pub(super) fn chunk_range(
        &self,
        chunk: usize,
        n_bytes: usize,
    ) -> Result<Option<Range<usize>>, ReadError> {
        let (offset, count) = (self.offsets[chunk], self.counts[chunk]);
        if offset == 0 && count == 0 {
            return Ok(None);
        }
        let end = offset.checked_add(count).filter(|&end| end <= n_bytes as u64);
        let Some(end) = end else {
            return Err(ReadError::Truncated {
                end: n_bytes as u64,
                needed: offset.saturating_add(count),
                element: "strip or tile".into(),
                row: chunk as u64,
            });
        };
        Ok(Some(offset as usize..end as usize))
    }

    /// Bytes of a strip or tile without compression; `None` if it was left out.
    pub(super) fn plain_chunk(
        &self,
        bytes: &[u8],
        chunk: usize,
        order: ByteOrder,
    ) -> Result<Option<Vec<u8>>, ReadError> {
        let Some(range) = self.chunk_range(chunk, bytes.len())? else { return Ok(None) };
        let start = range.start;
        // A strip at the end of the image may have its own rows only.
        let n_rows = if self.is_tiled { self.chunk[1] } else { self.place(chunk).height };
        let n = self.chunk_row_bytes() * n_rows;
        let damaged = || {
            let message = format!("strip or tile {chunk} is damaged or too short; get the whole file");
            ReadError::byte_error(start, message)
        };
        let mut plain = codec::decompress(&bytes[range], self.compression, n)
            .filter(|plain| plain.len() == n)
            .ok_or_else(damaged)?;
        let rows = Rows {
            row_bytes: self.chunk_row_bytes(),
            n_samples: self.chunk_samples(),
            kind: self.kind.kind,
            order,
        };
        match self.predictor {
            2 => codec::undo_differences(&mut plain, rows),
            3 => codec::undo_float_differences(&mut plain, rows),
            _ => {}
        }
        Ok(Some(plain))
    }

    /// Bytes of a number in a strip or tile (packed bits are unpacked), and in the image.
    fn number_width(&self) -> usize {
        self.kind.kind.n_bytes()
    }

    /// First byte in the image of a row of a strip or tile.
    fn image_start(&self, place: ChunkPlace, row: usize) -> usize {
        let pixel = (place.y + row) * self.kind.width + place.x;
        (pixel * self.kind.n_samples + place.plane) * self.number_width()
    }

    /// Puts the numbers of a strip or tile into the image.
    pub(super) fn put_chunk(&self, chunk: usize, plain: &[u8], image: &mut [u8]) {
        let (place, width, samples) = (self.place(chunk), self.number_width(), self.chunk_samples());
        let mut unpacked = Vec::new();
        for row in 0..place.height {
            let own = &plain[row * self.chunk_row_bytes()..][..self.chunk_row_bytes()];
            let own = if self.kind.n_bits < 8 {
                unpacked.clear();
                let n_bits = self.kind.n_bits;
                let number = |i: usize| {
                    let at = i * n_bits;
                    (own[at / 8] >> (8 - n_bits - at % 8)) & ((1 << n_bits) - 1)
                };
                unpacked.extend((0..self.chunk[0] * samples).map(number));
                &unpacked[..]
            } else {
                own
            };
            let start = self.image_start(place, row);
            if self.is_planar {
                let step = self.kind.n_samples * width;
                for (i, number) in own.chunks_exact(width).take(place.width).enumerate() {
                    image[start + i * step..][..width].copy_from_slice(number);
                }
            } else {
                let n = place.width * samples * width;
                image[start..start + n].copy_from_slice(&own[..n]);
            }
        }
    }

    /// Takes the numbers of a strip or tile from the image. Places beyond the edge stay; bits are not packed.
    pub(super) fn take_chunk(&self, chunk: usize, image: &[u8], plain: &mut [u8]) {
        let (place, width, samples) = (self.place(chunk), self.number_width(), self.chunk_samples());
        let row_bytes = self.chunk[0] * samples * width;
        for (row, own) in plain.chunks_exact_mut(row_bytes).take(place.height).enumerate() {
            let start = self.image_start(place, row);
            if self.is_planar {
                let step = self.kind.n_samples * width;
                for (i, number) in own.chunks_exact_mut(width).take(place.width).enumerate() {
                    number.copy_from_slice(&image[start + i * step..][..width]);
                }
            } else {
                let n = place.width * samples * width;
                own[..n].copy_from_slice(&image[start..start + n]);
            }
        }
    }

    /// Rows that a strip or tile stores.
    pub(super) fn stored_rows(&self, chunk: usize) -> usize {
        if self.is_tiled { self.chunk[1] } else { self.place(chunk).height }
    }

    /// Numbers of the image in the byte order of the file, with `fill` where there is no strip or tile.
    pub(super) fn decode(&self, bytes: &[u8], order: ByteOrder, fill: &[u8]) -> Result<Vec<u8>, ReadError> {
        let mut image = vec![0; self.kind.n_bytes()];
        let is_sparse = (0..self.n_chunks()).any(|chunk| self.offsets[chunk] == 0 && self.counts[chunk] == 0);
        if is_sparse && fill.iter().any(|&b| b != 0) {
            image.chunks_exact_mut(fill.len()).for_each(|number| number.copy_from_slice(fill));
        }
        for chunk in 0..self.n_chunks() {
            if let Some(plain) = self.plain_chunk(bytes, chunk, order)? {
                self.put_chunk(chunk, &plain, &mut image);
            }
        }
        Ok(image)
    }
}
