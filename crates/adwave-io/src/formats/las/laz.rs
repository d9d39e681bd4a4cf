//! Decompression of LAZ records with the crate `laz`. The crate allocates sizes stated in the file and panics on some
//! damaged files, so the sizes are checked here first, and a panic becomes an error.

use std::io::{Cursor, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

use adwave::{Cancelled, Progress};

use crate::ReadError;
use crate::formats::las::read::Header;

/// Chunk size in the description that stands for chunks of different sizes.
pub(crate) const VARIABLE: u64 = u32::MAX as u64;

/// Part of a record that is compressed separately.
pub(crate) struct Item {
    kind: u16,
    size: u16,
    pub(crate) version: u16,
}

impl Item {
    /// Number of layers per chunk; 0 for parts without layers.
    pub(crate) fn n_layers(&self) -> usize {
        match self.kind {
            10 => 9,
            12 => 2,
            14 => usize::from(self.size),
            _ => 1,
        }
    }
}

pub(crate) fn u16_at(bytes: &[u8], at: usize) -> u64 {
    bytes.get(at..at + 2).map_or(0, |b| u64::from(u16::from_le_bytes([b[0], b[1]])))
}

pub(crate) fn u32_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..at + 4).map(|b| u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])))
}

pub(crate) fn i64_at(bytes: &[u8], at: usize) -> Option<i64> {
    Some(i64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}

fn broken(header: &Header, what: &str) -> ReadError {
    ReadError::at_byte(
        header.points_start,
        format!("the LAZ compression is damaged ({what}); get an undamaged file"),
    )
}

/// Decompresses all point records, one after the other.
///
/// A panic of the library on a damaged file is caught and becomes an error. The panic hook of the program is not
/// changed: the default one prints the panic's message to the standard error; a program can install its own.
pub(crate) fn unpack(
    bytes: &[u8],
    header: &Header,
    description: &[u8],
    progress: Progress<'_>,
) -> Result<Vec<u8>, ReadError> {
    if header.n_points == 0 {
        return Ok(Vec::new());
    }
    check(bytes, header, description).map_err(|what| broken(header, what))?;
    // No object of the library survives, so a state left inconsistent by a panic is never used.
    let unpacked = catch_unwind(AssertUnwindSafe(|| unpack_checked(bytes, header, description, progress)));
    match unpacked {
        Ok(Ok(points)) => Ok(points),
        Ok(Err(Stop::Cancelled(cancelled))) => Err(cancelled.into()),
        Ok(Err(Stop::Broken(what))) => Err(broken(header, &what)),
        Err(_) => Err(broken(header, "its parts contradict each other")),
    }
}

/// Points decompressed between two checks for cancellation.
const STEP: u64 = 1 << 15;

/// Reasons for an early end of the decompression.
enum Stop {
    Cancelled(Cancelled),
    Broken(String),
}

fn unpack_checked(
    bytes: &[u8],
    header: &Header,
    description: &[u8],
    progress: Progress<'_>,
) -> Result<Vec<u8>, Stop> {
    let one_line = |e: &dyn std::fmt::Display| Stop::Broken(crate::text::one_line(e));
    let description = laz::LazVlr::from_buffer(description).map_err(|e| one_line(&e))?;
    let mut source = Cursor::new(bytes);
    source.seek(SeekFrom::Start(header.points_start as u64)).map_err(|e| one_line(&e))?;
    let mut decompressor = laz::LasZipDecompressor::new(source, description).map_err(|e| one_line(&e))?;
    // Grown step by step, because the stated number of points may be wrong.
    let mut points = Vec::new();
    let mut left = header.n_points;
    while left > 0 {
        progress.step(header.n_points - left, header.n_points).map_err(Stop::Cancelled)?;
        let n = left.min(STEP);
        let start = points.len();
        points.resize(start + n as usize * header.record_bytes, 0);
        decompressor.decompress_many(&mut points[start..]).map_err(|e| one_line(&e))?;
        left -= n;
    }
    Ok(points)
}

/// Parts of a record of that many bytes.
pub(crate) fn items_of(description: &[u8], record_bytes: usize) -> Result<Vec<Item>, &'static str> {
    let items = items(description)?;
    let total: usize = items.iter().map(|i| usize::from(i.size)).sum();
    if total != record_bytes {
        return Err("its parts do not add up to a record");
    }
    Ok(items)
}

fn items(description: &[u8]) -> Result<Vec<Item>, &'static str> {
    let n = u16_at(description, 32) as usize;
    if n == 0 || n > 16 || description.len() < 34 + 6 * n {
        return Err("its description contains no parts of a record");
    }
    let item = |i: usize| {
        let at = 34 + 6 * i;
        let part = |k: usize| u16_at(description, at + k) as u16;
        Item { kind: part(0), size: part(2), version: part(4) }
    };
    Ok((0..n).map(item).collect())
}

fn check(bytes: &[u8], header: &Header, description: &[u8]) -> Result<(), &'static str> {
    let items = items_of(description, header.record_bytes)?;
    if u16_at(description, 0) < 2 {
        return Ok(());
    }
    let table = check_chunk_table(bytes, header.points_start)?;
    if items.iter().all(|i| i.version < 3) {
        return Ok(());
    }
    let n_chunks = match u32_at(description, 12) {
        // Chunks of different sizes; the table contains their number.
        None | Some(0 | VARIABLE) => table.and_then(|table| u32_at(bytes, table + 4)).unwrap_or(0),
        Some(size) => header.n_points.div_ceil(size),
    };
    check_layers(bytes, header, &items, table, n_chunks)
}

/// Checks that the chunk table has no more entries than the file has bytes. Returns its position, if stated.
fn check_chunk_table(bytes: &[u8], start: usize) -> Result<Option<usize>, &'static str> {
    let end = bytes.len();
    let mut found = None;
    for at in [Some(start), end.checked_sub(8)].into_iter().flatten() {
        let Some(table) = i64_at(bytes, at).and_then(|t| usize::try_from(t).ok()) else { continue };
        if table <= start {
            continue;
        }
        if table < end && u32_at(bytes, table + 4).is_some_and(|n| n > (end - start) as u64) {
            return Err("its table has more chunks than the file has bytes");
        }
        found = found.or(Some(table));
    }
    Ok(found)
}

/// Checks the sizes of layers: in formats 6 to 10 each chunk states them, and the library would allocate buffers of
/// these sizes.
///
/// It checks the chunks up to the table, as many as the description or the table states. Their numbers of points are
/// ignored, as the library does not use them.
fn check_layers(
    bytes: &[u8],
    header: &Header,
    items: &[Item],
    table: Option<usize>,
    n_chunks: u64,
) -> Result<(), &'static str> {
    let n_layers: usize = items.iter().map(Item::n_layers).sum();
    let mut at = header.points_start + 8;
    let (mut n_points, mut k) = (0, 0);
    loop {
        let is_needed = n_points < header.n_points || table.is_some_and(|table| at < table);
        if !is_needed && k >= n_chunks {
            return Ok(());
        }
        at += header.record_bytes;
        let count = u32_at(bytes, at).unwrap_or(0);
        if is_needed && count == 0 {
            return Err("a chunk is missing or empty");
        }
        at += 4;
        let mut size = 0;
        for layer in 0..n_layers {
            match u32_at(bytes, at + 4 * layer) {
                Some(own) => size += own,
                None if is_needed => return Err("a chunk is truncated"),
                // The library reaches the end of the file here.
                None => return Ok(()),
            }
        }
        at += 4 * n_layers;
        if size > (bytes.len() - at) as u64 {
            return Err("a layer is larger than the file");
        }
        at += size as usize;
        n_points += count;
        k += 1;
    }
}
