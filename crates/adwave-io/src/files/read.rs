//! Bytes of a file, with a limit.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use adwave::pages::zeros;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

use crate::limits::decompress;
use crate::progress::BYTES_PER_STEP;
use crate::{ReadError, ReadLimits};

/// Parses the decompressed bytes of a file; errors begin with the file's name.
pub(crate) fn parse_file<T>(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
    parse: impl FnOnce(Vec<u8>) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    read_file(path, limits, progress)
        .and_then(|bytes| decompress(bytes, limits, progress))
        .and_then(parse)
        .map_err(|e| e.in_file(path))
}

/// Reads the bytes of a file, up to the limit. A pipe is read to its end.
pub(crate) fn read_file(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<u8>, ReadError> {
    let mut file = File::open(path)?;
    let metadata = file.metadata()?;
    if metadata.is_dir() {
        return Err(ReadError::Whole("the path is a folder; give a file".into()));
    }
    limits.check_bytes(metadata.len())?;
    let total = metadata.len();
    let mut bytes = read_at_once(&file, if metadata.is_file() { total } else { 0 }, progress)?;
    if bytes.is_empty() {
        bytes.reserve_exact(total as usize);
    } else {
        io::Seek::seek(&mut file, io::SeekFrom::Start(total))?;
    }
    // The remaining bytes: all of them, or those appended since the length was determined.
    let most = limits.max_bytes.saturating_add(1);
    loop {
        let before = bytes.len();
        let step = (most - before as u64).min(BYTES_PER_STEP as u64);
        (&file).take(step).read_to_end(&mut bytes)?;
        progress.step(bytes.len() as u64, total.max(bytes.len() as u64))?;
        if bytes.len() == before || bytes.len() as u64 == most {
            break;
        }
    }
    limits.check_bytes(bytes.len() as u64)?;
    Ok(bytes)
}

/// Size in bytes below which a file is read by one thread.
const LARGE: u64 = 1 << 22;

/// Reads the first `n` bytes of a large regular file in parallel, because page faults in fresh memory take longer
/// than copying. The result is empty if the file is small, has become shorter, or the system has no positioned reads.
fn read_at_once(file: &File, n: u64, progress: Progress<'_>) -> Result<Vec<u8>, ReadError> {
    if n < LARGE {
        return Ok(Vec::new());
    }
    let mut bytes = zeros(n as usize);
    let read = bytes.par_chunks_mut(BYTES_PER_STEP).enumerate().try_for_each(|(k, chunk)| {
        progress.check()?;
        read_exact_at(file, chunk, (k * BYTES_PER_STEP) as u64).map_err(ReadError::Io)
    });
    match read {
        Ok(()) => Ok(bytes),
        Err(ReadError::Cancelled(_)) => Err(Cancelled.into()),
        // The sequential read meets the same error again if there is one.
        Err(_) => Ok(Vec::new()),
    }
}

#[cfg(unix)]
fn read_exact_at(file: &File, bytes: &mut [u8], at: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, at)
}

#[cfg(not(unix))]
fn read_exact_at(_: &File, _: &mut [u8], _: u64) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
