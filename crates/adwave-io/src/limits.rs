//! Limits on the resources of a file, and decompression within them.

use std::io::Read;
use std::sync::OnceLock;

use adwave::Progress;

use crate::ReadError;
use crate::progress::BYTES_PER_STEP;

/// Limits for reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadLimits {
    /// Largest size of a file in bytes, after decompression.
    pub max_bytes: u64,
    /// Largest number of vertices, at most 2³² − 1.
    pub max_points: u64,
}

impl Default for ReadLimits {
    /// A quarter of the memory that is free at the first call, at least 256 MiB (4 GiB if the system does not report
    /// it), because a shape takes up to about four times the bytes of its file; and 2³² − 1 vertices.
    fn default() -> Self {
        static MAX_BYTES: OnceLock<u64> = OnceLock::new();
        let max_bytes =
            *MAX_BYTES.get_or_init(|| free_memory().map_or(1 << 32, |free| (free / 4).max(1 << 28)));
        Self { max_bytes, max_points: u64::from(u32::MAX) }
    }
}

/// Memory in bytes that a program may take without displacing others, if the system reports it.
pub fn free_memory() -> Option<u64> {
    let info = std::fs::read_to_string("/proc/meminfo").ok()?;
    let free = info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    free.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

/// Largest number of vertices, rows or columns of a file with `n_items` bytes or entries: empty ones take no bytes in
/// the file, but memory in every later computation.
pub(crate) fn most_numbered(n_items: usize) -> u64 {
    1_000_000 + 64 * n_items as u64
}

impl ReadLimits {
    /// Checks a number of vertices.
    pub(crate) fn check_points(&self, n_points: u64) -> Result<(), ReadError> {
        self.check_rows("vertices", n_points)
    }

    /// Checks a number of places of a grid.
    pub(crate) fn check_places(&self, n_places: u64) -> Result<(), ReadError> {
        self.check_rows("places", n_places)
    }

    fn check_rows(&self, what: &'static str, found: u64) -> Result<(), ReadError> {
        let limit = self.max_points.min(u64::from(u32::MAX));
        if found > limit { Err(ReadError::Limit { what, found, limit }) } else { Ok(()) }
    }

    /// Checks a number of bytes.
    pub(crate) fn check_bytes(&self, n_bytes: u64) -> Result<(), ReadError> {
        if n_bytes > self.max_bytes {
            return Err(ReadError::Limit { what: "bytes", found: n_bytes, limit: self.max_bytes });
        }
        Ok(())
    }
}

/// Returns the bytes unchanged, or the decompressed content of their gzip members.
pub(crate) fn decompress(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<u8>, ReadError> {
    limits.check_bytes(bytes.len() as u64)?;
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    let mut reader =
        flate2::read::MultiGzDecoder::new(bytes.as_slice()).take(limits.max_bytes.saturating_add(1));
    loop {
        progress.check()?;
        let before = plain.len();
        if let Err(error) = reader.by_ref().take(BYTES_PER_STEP as u64).read_to_end(&mut plain) {
            let n = plain.len();
            let message = format!(
                "the gzip stream is damaged after {n} decompressed bytes ({error}); get the \
                        complete file"
            );
            return Err(ReadError::byte_error(bytes.len(), message));
        }
        if plain.len() == before {
            break;
        }
    }
    limits.check_bytes(plain.len() as u64)?;
    Ok(plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn a_bomb_stops_at_the_limit() {
        let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        for _ in 0..64 {
            gz.write_all(&vec![b' '; 1 << 16]).unwrap();
        }
        let bomb = gz.finish().unwrap();
        let limits = ReadLimits { max_bytes: 1 << 20, ..ReadLimits::default() };
        assert!(matches!(decompress(bomb.clone(), &limits, Progress::none()), Err(ReadError::Limit { .. })));
        assert_eq!(decompress(bomb, &ReadLimits::default(), Progress::none()).unwrap().len(), 64 << 16);
    }

    #[test]
    fn a_cut_stream_is_an_error() {
        let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gz.write_all(b"OFF\n0 0 0\n").unwrap();
        let whole = gz.finish().unwrap();
        for end in 2..whole.len() {
            assert!(
                decompress(whole[..end].to_vec(), &ReadLimits::default(), Progress::none()).is_err(),
                "{end}"
            );
        }
    }
}
