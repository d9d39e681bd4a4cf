//! Files of the work folder: read at an offset, written under another name and renamed when whole.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::TilesError;

/// A file that is read at any offset, by several threads.
#[derive(Debug)]
pub(crate) struct At {
    file: File,
    path: std::path::PathBuf,
    len: u64,
}

impl At {
    pub(crate) fn open(path: &Path) -> Result<Self, TilesError> {
        let file = File::open(path).map_err(TilesError::io(path))?;
        let len = file.metadata().map_err(TilesError::io(path))?.len();
        Ok(Self { file, path: path.to_owned(), len })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn len(&self) -> u64 {
        self.len
    }

    /// `len` bytes from `offset` on.
    pub(crate) fn read(&self, offset: u64, len: usize) -> Result<Vec<u8>, TilesError> {
        if offset.checked_add(len as u64).is_none_or(|end| end > self.len) {
            return Err(TilesError::broken(&self.path, "it is too short"));
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

/// Bytes that a writer gathers before it asks the system.
const GATHERED: usize = 1 << 20;

/// How names of files that are being written begin and end.
pub(crate) const TEMPORARY: (&str, &str) = (".adwave-", ".tmp");

/// Writes a file under another name, flushes it to the disk and renames it: it is whole where it is.
pub(crate) fn write_whole<T>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> Result<T, TilesError>,
) -> Result<T, TilesError> {
    let mut temporary = temporary(path).map_err(TilesError::io(path))?;
    let mut writer = BufWriter::with_capacity(GATHERED, temporary.as_file_mut());
    let result = write(&mut writer)?;
    writer.flush().map_err(TilesError::io(path))?;
    drop(writer);
    temporary.as_file().sync_all().map_err(TilesError::io(path))?;
    temporary
        .persist(path)
        .map_err(|e| TilesError::Io { path: path.display().to_string(), source: e.error })?;
    Ok(result)
}

/// The same without waiting for the disk: where the machine fails, the file may be there and not be whole.
pub(crate) fn write_unflushed(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
) -> Result<(), TilesError> {
    let written = || {
        let mut temporary = temporary(path)?;
        let mut writer = BufWriter::with_capacity(GATHERED, temporary.as_file_mut());
        write(&mut writer)?;
        writer.flush()?;
        drop(writer);
        temporary.persist(path).map_err(|e| e.error)?;
        Ok(())
    };
    written().map_err(TilesError::io(path))
}

fn temporary(path: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    tempfile::Builder::new().prefix(TEMPORARY.0).suffix(TEMPORARY.1).tempfile_in(folder)
}

/// Numbers of fixed size, one after the other.
pub(crate) struct Cursor<'a> {
    pub(crate) bytes: &'a [u8],
}

impl Cursor<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.bytes.split_first_chunk::<N>()?;
        self.bytes = rest;
        Some(*head)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    /// A number of at most 64 bits, seven of them to a byte, the lowest first.
    pub(crate) fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let (&byte, rest) = self.bytes.split_first()?;
            self.bytes = rest;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }
}

/// What [`Cursor::varint`] reads.
pub(crate) fn push_varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}
