//! Limits on the resources of a file, and decompression within them.

use std::io::Read;
use std::path::Path;
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

/// Memory in bytes that a program may take without displacing others, if the system reports it: what is available, but no
/// more than is left of its address space and of the limits of its control group, by which containers and batch systems
/// bound it.
pub fn free_memory() -> Option<u64> {
    let available = kilobytes("/proc/meminfo", "MemAvailable:")?;
    let limits = [free_address_space(), free_in_control_group(Path::new("/sys/fs/cgroup"))];
    Some(limits.into_iter().flatten().fold(available, u64::min))
}

/// Bytes after a word at the beginning of a line, which states them in kB.
fn kilobytes(path: &str, word: &str) -> Option<u64> {
    let text = std::fs::read_to_string(path).ok()?;
    let found = text.lines().find_map(|line| line.strip_prefix(word))?;
    found.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

/// Bytes that are left of the address space; `None` if it has no limit.
fn free_address_space() -> Option<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let limit = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kilobytes("/proc/self/status", "VmSize:").unwrap_or(0)))
}

/// Bytes that are left of the limits of the control group and those above it; `None` if there are none. `root` is where the
/// groups are mounted.
fn free_in_control_group(root: &Path) -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let of_line = |line: &str| {
        let mut parts = line.splitn(3, ':');
        let (number, controllers, path) = (parts.next()?, parts.next()?, parts.next()?);
        let (root, names) = match (number, controllers) {
            ("0", "") => (root.to_owned(), &UNIFIED_GROUP),
            _ if controllers.split(',').any(|name| name == "memory") => (root.join("memory"), &MEMORY_GROUP),
            _ => return None,
        };
        // Inside a container the path may be that outside, and its own group is the root.
        let own = root.join(path.trim_start_matches('/'));
        let folders = own.ancestors().take_while(|folder| folder.starts_with(&root));
        folders.filter_map(|folder| left_in_group(folder, names)).min()
    };
    groups.lines().filter_map(of_line).min()
}

/// Names of the files with the limit and the use of a control group, and of the lines of its statistics whose sum is the part
/// of the use that the system gives back: pages of files.
struct GroupFiles {
    limit: &'static str,
    used: &'static str,
    given_back: [&'static str; 2],
}

const UNIFIED_GROUP: GroupFiles =
    GroupFiles { limit: "memory.max", used: "memory.current", given_back: ["inactive_file", "active_file"] };

const MEMORY_GROUP: GroupFiles = GroupFiles {
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    given_back: ["total_inactive_file", "total_active_file"],
};

/// Bytes that are left of the limit of a control group; `None` if it has none.
fn left_in_group(folder: &Path, files: &GroupFiles) -> Option<u64> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    let statistics = read("memory.stat").unwrap_or_default();
    let given_back: u64 = (statistics.lines())
        .filter_map(|line| line.split_once(' '))
        .filter(|(name, _)| files.given_back.contains(name))
        .filter_map(|(_, bytes)| bytes.trim().parse::<u64>().ok())
        .sum();
    let used = number(files.used).unwrap_or(0).saturating_sub(given_back);
    Some(number(files.limit)?.saturating_sub(used))
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
    fn limits_of_control_groups_count_without_the_pages_of_files() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        assert_eq!(left_in_group(folder.path(), &UNIFIED_GROUP), None);
        write("memory.max", "max\n");
        assert_eq!(left_in_group(folder.path(), &UNIFIED_GROUP), None);
        write("memory.max", "1000\n");
        assert_eq!(left_in_group(folder.path(), &UNIFIED_GROUP), Some(1000));
        write("memory.current", "900\n");
        assert_eq!(left_in_group(folder.path(), &UNIFIED_GROUP), Some(100));
        write("memory.stat", "anon 300\ninactive_file 350\nactive_file 250\nshmem 40\n");
        assert_eq!(left_in_group(folder.path(), &UNIFIED_GROUP), Some(700));
        write("memory.current", "9000\n");
        assert_eq!(left_in_group(folder.path(), &UNIFIED_GROUP), Some(0));
        assert_eq!(left_in_group(folder.path(), &MEMORY_GROUP), None);
        // This process has some memory left wherever the system reports it.
        assert!(free_memory().is_none_or(|bytes| bytes > 1 << 20));
    }

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
