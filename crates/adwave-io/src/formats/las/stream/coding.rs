//! Decompression of single LAZ chunks. Allocations are checked before, and a panic of the library becomes an error.

use std::io::{self, Cursor, Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{LazItem, LazVlr};

use crate::formats::las::laz::{Item, items_of, u32_at};

pub(in crate::formats::las) type Decompressor<'a, R> = Box<dyn RecordDecompressor<R> + Send + Sync + 'a>;

/// Properties common to all chunks.
pub(in crate::formats::las) struct Coding {
    pub(in crate::formats::las) items: Vec<LazItem>,
    /// Number of layers; `None` for chunks without layers.
    pub(in crate::formats::las) n_layers: Option<usize>,
    pub(in crate::formats::las) record_bytes: usize,
}

/// Reason for which the decompression stopped, and the number of points before it.
pub(in crate::formats::las) struct Failure {
    pub(in crate::formats::las) done: usize,
    /// Error of the library; `None` if it panicked.
    pub(in crate::formats::las) error: Option<io::Error>,
}

impl Coding {
    /// Parses the record of the compression; the error describes its fault.
    pub(in crate::formats::las) fn of(description: &[u8], record_bytes: usize) -> Result<Self, String> {
        let items = items_of(description, record_bytes)?;
        let vlr = LazVlr::from_buffer(description).map_err(|e| crate::text::one_line(&e))?;
        let is_layered = items.first().is_some_and(|item| item.version >= 3);
        let n_layers = is_layered.then(|| items.iter().map(Item::n_layers).sum());
        let coding = Self { items: vlr.items().clone(), n_layers, record_bytes };
        // Checks that the library supports the parts in this version with the sizes of the file.
        let own_bytes = catch_unwind(|| coding.decompressor(io::empty()).map(|d| d.record_size()));
        match own_bytes {
            Ok(Ok(own)) if own == record_bytes => Ok(coding),
            Ok(Err(error)) => Err(crate::text::one_line(&error)),
            _ => Err("its parts do not have the stated sizes".into()),
        }
    }

    pub(in crate::formats::las) fn decompressor<'a, R: Read + Seek + Send + Sync + 'a>(
        &self,
        input: R,
    ) -> laz::Result<Decompressor<'a, R>> {
        let mut own: Decompressor<'a, R> = if self.n_layers.is_some() {
            Box::new(LayeredPointRecordDecompressor::new(input))
        } else {
            Box::new(SequentialPointRecordDecompressor::new(input))
        };
        own.set_fields_from(&self.items)?;
        Ok(own)
    }

    /// Decompresses a whole chunk.
    pub(in crate::formats::las) fn unpack(&self, packed: &[u8], rows: &mut [u8]) -> Result<(), Failure> {
        if let Some(n_layers) = self.n_layers
            && !rows.is_empty()
        {
            let head = (self.record_bytes + 4 + 4 * n_layers) as u64;
            let sizes = layer_sizes(packed, self.record_bytes, n_layers);
            if sizes.is_none_or(|(_, n_bytes)| head + n_bytes > packed.len() as u64) {
                let error = io::Error::other("a layer is larger than its chunk");
                return Err(Failure { done: 0, error: Some(error) });
            }
        }
        let mut decompressor = self
            .decompressor(Cursor::new(packed))
            .map_err(|e| Failure { done: 0, error: Some(io::Error::other(crate::text::one_line(&e))) })?;
        unpack_rows(&mut decompressor, rows, self.record_bytes)
    }
}

/// Fills the rows; a decompressor that failed must not be used again.
pub(in crate::formats::las) fn unpack_rows<R>(
    decompressor: &mut Decompressor<'_, R>,
    rows: &mut [u8],
    record_bytes: usize,
) -> Result<(), Failure> {
    let mut done = 0;
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        rows.chunks_exact_mut(record_bytes).try_for_each(|row| {
            decompressor.decompress_next(row)?;
            done += 1;
            Ok(())
        })
    }));
    match outcome {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(Failure { done, error: Some(error) }),
        Err(_) => Err(Failure { done, error: None }),
    }
}

/// Number of points that a layered chunk states, and the total size of its layers; `None` if its head is truncated.
pub(in crate::formats::las) fn layer_sizes(
    chunk: &[u8],
    record_bytes: usize,
    n_layers: usize,
) -> Option<(u64, u64)> {
    let n_points = u32_at(chunk, record_bytes)?;
    let sizes = (0..n_layers).map(|layer| u32_at(chunk, record_bytes + 4 + 4 * layer));
    Some((n_points, sizes.sum::<Option<u64>>()?))
}

impl Failure {
    pub(in crate::formats::las) fn what(&self) -> String {
        match &self.error {
            Some(error) => crate::text::one_line(error),
            None => "its parts contradict each other".into(),
        }
    }
}
