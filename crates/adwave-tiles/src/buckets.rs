//! Bytes that are dealt out to files by number, with few writes and without keeping the files open.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;

use crate::TilesError;

/// Files that grow at the end, each by its number.
pub(crate) struct Buckets {
    paths: Vec<PathBuf>,
    /// What is not written yet, of each file.
    held: Vec<Vec<u8>>,
    n_held: usize,
    /// Bytes that may be held.
    most: usize,
    n_bytes: Vec<u64>,
}

impl Buckets {
    /// Begins the files, empty.
    pub(crate) fn new(paths: Vec<PathBuf>, most: usize) -> Result<Self, TilesError> {
        for path in &paths {
            File::create(path).map_err(TilesError::io(path))?;
        }
        let held = vec![Vec::new(); paths.len()];
        let n_bytes = vec![0; paths.len()];
        Ok(Self { paths, held, n_held: 0, most, n_bytes })
    }

    pub(crate) fn push(&mut self, bucket: usize, bytes: &[u8]) -> Result<(), TilesError> {
        self.held[bucket].extend_from_slice(bytes);
        self.n_held += bytes.len();
        if self.n_held > self.most { self.write() } else { Ok(()) }
    }

    fn write(&mut self) -> Result<(), TilesError> {
        let files = self.paths.iter().zip(&mut self.held).zip(&mut self.n_bytes);
        for ((path, held), n_bytes) in files.filter(|((_, held), _)| !held.is_empty()) {
            let mut file = OpenOptions::new().append(true).open(path).map_err(TilesError::io(path))?;
            file.write_all(held).map_err(TilesError::io(path))?;
            *n_bytes += held.len() as u64;
            held.clear();
        }
        self.n_held = 0;
        Ok(())
    }

    /// Writes what is left and flushes all files to the disk; their lengths.
    pub(crate) fn finish(mut self) -> Result<Vec<u64>, TilesError> {
        self.write()?;
        for path in &self.paths {
            let file = OpenOptions::new().append(true).open(path).map_err(TilesError::io(path))?;
            file.sync_all().map_err(TilesError::io(path))?;
        }
        Ok(self.n_bytes)
    }
}
