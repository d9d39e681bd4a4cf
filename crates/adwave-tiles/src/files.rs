//! Files of the work folder: random access for reading, atomic replacement for writing.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::TilesError;

/// A file that several threads read at any offset.
#[derive(Debug)]
pub(crate) struct RandomAccessFile {
    file: File,
    path: PathBuf,
    len: u64,
}

impl RandomAccessFile {
    pub(crate) fn open(path: &Path) -> Result<Self, TilesError> {
        let file = File::open(path).map_err(TilesError::io(path))?;
        let len = file.metadata().map_err(TilesError::io(path))?.len();
        Ok(Self { file, path: path.to_owned(), len })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads `len` bytes from byte `offset` on.
    pub(crate) fn read(&self, offset: u64, len: usize) -> Result<Vec<u8>, TilesError> {
        if offset.checked_add(len as u64).is_none_or(|end| end > self.len) {
            return Err(TilesError::broken(&self.path, "the file is too short"));
        }
        let mut bytes = vec![0; len];
        self.fill(offset, &mut bytes).map_err(TilesError::io(&self.path))?;
        Ok(bytes)
    }

    #[cfg(unix)]
    fn fill(&self, offset: u64, bytes: &mut [u8]) -> std::io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(&self.file, bytes, offset)
    }

    #[cfg(windows)]
    fn fill(&self, mut offset: u64, mut bytes: &mut [u8]) -> std::io::Result<()> {
        while !bytes.is_empty() {
            let n = std::os::windows::fs::FileExt::seek_read(&self.file, bytes, offset)?;
            if n == 0 {
                return Err(std::io::ErrorKind::UnexpectedEof.into());
            }
            bytes = &mut bytes[n..];
            offset += n as u64;
        }
        Ok(())
    }
}

/// Bytes of a writer's buffer.
const BUFFER_BYTES: usize = 1 << 20;

const TEMPORARY_PREFIX: &str = ".adwave-";
const TEMPORARY_SUFFIX: &str = ".tmp";

/// Returns true for the name of a file that is being written, or was left behind by a process that was killed.
pub(crate) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY_PREFIX) && name.ends_with(TEMPORARY_SUFFIX)
}

/// Writes a file under a temporary name, syncs it to the disk and renames it, so that `path` is either absent or
/// complete.
pub(crate) fn write_atomic<T>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> Result<T, TilesError>,
) -> Result<T, TilesError> {
    let mut temporary = create_temporary(path).map_err(TilesError::io(path))?;
    let mut writer = BufWriter::with_capacity(BUFFER_BYTES, temporary.as_file_mut());
    let result = write(&mut writer)?;
    writer.flush().map_err(TilesError::io(path))?;
    drop(writer);
    temporary.as_file().sync_all().map_err(TilesError::io(path))?;
    temporary
        .persist(path)
        .map_err(|e| TilesError::Io { path: path.display().to_string(), source: e.error })?;
    Ok(result)
}

/// Writes a file as [`write_atomic`] does, but without syncing it: after a power failure the file may exist and be
/// incomplete.
pub(crate) fn write_unsynced(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
) -> Result<(), TilesError> {
    let replace = || {
        let mut temporary = create_temporary(path)?;
        let mut writer = BufWriter::with_capacity(BUFFER_BYTES, temporary.as_file_mut());
        write(&mut writer)?;
        writer.flush()?;
        drop(writer);
        temporary.persist(path).map_err(|e| e.error)?;
        Ok(())
    };
    replace().map_err(TilesError::io(path))
}

fn create_temporary(path: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    tempfile::Builder::new().prefix(TEMPORARY_PREFIX).suffix(TEMPORARY_SUFFIX).tempfile_in(folder)
}

pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), TilesError> {
    let json = serde_json::to_vec(value).map_err(std::io::Error::from).map_err(TilesError::io(path))?;
    write_atomic(path, |out| out.write_all(&json).map_err(TilesError::io(path)))
}

pub(crate) fn read_json<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, TilesError> {
    let json = std::fs::read(path).map_err(TilesError::io(path))?;
    serde_json::from_slice(&json).map_err(|e| TilesError::broken(path, e.to_string()))
}

/// File names that differ in a number alone, such as `near-00012.bin`.
pub(crate) struct NumberedName {
    pub(crate) prefix: &'static str,
    /// Digits that the number is padded to.
    pub(crate) n_digits: usize,
    pub(crate) suffix: &'static str,
}

impl NumberedName {
    pub(crate) fn path(&self, folder: &Path, number: u64) -> PathBuf {
        let Self { prefix, n_digits, suffix } = *self;
        folder.join(format!("{prefix}{number:0n_digits$}{suffix}"))
    }

    pub(crate) fn matches(&self, name: &str) -> bool {
        let number = name.strip_prefix(self.prefix).and_then(|rest| rest.strip_suffix(self.suffix));
        number.is_some_and(|n| !n.is_empty() && n.bytes().all(|c| c.is_ascii_digit()))
    }
}
