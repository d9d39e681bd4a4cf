//! Scratch files that bytes are distributed to, with few writes and without open files in between.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;

use crate::error::TilesError;

/// Numbered files that grow at their ends, with a shared buffer.
pub(crate) struct ScratchBuckets {
    paths: Vec<PathBuf>,
    /// Bytes of each file that are not written yet.
    buffers: Vec<Vec<u8>>,
    n_buffered: usize,
    /// Largest number of bytes in all buffers together.
    capacity: usize,
    /// Bytes written to each file.
    n_written: Vec<u64>,
}

impl ScratchBuckets {
    /// Creates the files, empty.
    pub(crate) fn create(paths: Vec<PathBuf>, capacity: usize) -> Result<Self, TilesError> {
        for path in &paths {
            File::create(path).map_err(TilesError::io(path))?;
        }
        let buffers = vec![Vec::new(); paths.len()];
        let n_written = vec![0; paths.len()];
        Ok(Self { paths, buffers, n_buffered: 0, capacity, n_written })
    }

    pub(crate) fn push(&mut self, bucket: usize, bytes: &[u8]) -> Result<(), TilesError> {
        self.buffers[bucket].extend_from_slice(bytes);
        self.n_buffered += bytes.len();
        if self.n_buffered > self.capacity { self.write() } else { Ok(()) }
    }

    fn write(&mut self) -> Result<(), TilesError> {
        let files = self.paths.iter().zip(&mut self.buffers).zip(&mut self.n_written);
        for ((path, buffer), n_written) in files.filter(|((_, buffer), _)| !buffer.is_empty()) {
            let mut file = OpenOptions::new().append(true).open(path).map_err(TilesError::io(path))?;
            file.write_all(buffer).map_err(TilesError::io(path))?;
            *n_written += buffer.len() as u64;
            buffer.clear();
        }
        self.n_buffered = 0;
        Ok(())
    }

    /// Writes the rest and syncs all files to the disk. Returns their lengths in bytes.
    pub(crate) fn finish(mut self) -> Result<Vec<u64>, TilesError> {
        self.write()?;
        for path in &self.paths {
            let file = OpenOptions::new().append(true).open(path).map_err(TilesError::io(path))?;
            file.sync_all().map_err(TilesError::io(path))?;
        }
        Ok(self.n_written)
    }
}
