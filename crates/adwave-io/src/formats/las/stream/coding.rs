//! Unpacking one chunk of a LAZ. What it reserves is checked before, and a panic of the library becomes an error.

use std::io::{self, Cursor, Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{LazItem, LazVlr};

use crate::formats::las::laz::{Item, items_of, u32_at};

pub(in crate::formats::las) type Decompressor<'a, R> = Box<dyn RecordDecompressor<R> + Send + Sync + 'a>;

/// What all chunks have in common.
pub(in crate::formats::las) struct Coding {
    pub(in crate::formats::las) items: Vec<LazItem>,
    /// The number of layers, where chunks are in layers.
    pub(in crate::formats::las) n_layers: Option<usize>,
    pub(in crate::formats::las) record_bytes: usize,
}

/// Why unpacking stopped, after how many points.
pub(in crate::formats::las) struct Failure {
    pub(in crate::formats::las) done: usize,
    /// `None` where the library panicked.
    pub(in crate::formats::las) error: Option<io::Error>,
}

impl Coding {
    /// As the record of the compression describes it; else what is wrong with that.
    pub(in crate::formats::las) fn of(description: &[u8], record_bytes: usize) -> Result<Self, String> {
        let items = items_of(description, record_bytes)?;
        let vlr = LazVlr::from_buffer(description).map_err(|e| crate::text::one_line(&e))?;
        let is_layered = items.first().is_some_and(|item| item.version >= 3);
        let n_layers = is_layered.then(|| items.iter().map(Item::n_layers).sum());
        let coding = Self { items: vlr.items().clone(), n_layers, record_bytes };
        // Whether the library knows the parts in this version, and gives them the sizes that the file does.
        let own_bytes = catch_unwind(|| coding.decompressor(io::empty()).map(|d| d.record_size()));
        match own_bytes {
            Ok(Ok(own)) if own == record_bytes => Ok(coding),
            Ok(Err(error)) => Err(crate::text::one_line(&error)),
            _ => Err("its parts are not of the sizes that it states".into()),
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

    /// Unpacks a whole chunk.
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

/// Fills the rows; nothing of a decompressor that failed may be used again.
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

/// The number of points that a chunk in layers states, and the bytes of its layers; `None` where the head is cut.
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
