//! Moving window over a file.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use crate::ReadError;
use crate::text::{is_space, line_of};

/// Bytes read at a time; in tests so few that every element is split somewhere.
const STEP: u64 = if cfg!(test) { 64 } else { 1 << 22 };
/// Largest size of a row in bytes.
const MOST_IN_A_ROW: usize = 1 << 28;

/// Bytes of a file from the first one still in use.
pub(super) struct Window {
    file: File,
    bytes: Vec<u8>,
    /// Start of the bytes in use within `bytes`.
    start: usize,
    /// Number of bytes of the file before `bytes`.
    before: u64,
    /// Number of line ends before `bytes`, if lines are counted.
    lines: u64,
    counts_lines: bool,
    /// Size of the file in bytes.
    n_bytes: u64,
}

impl Window {
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(ReadError::Whole("the file must be a regular PLY or OBJ file".into()));
        }
        if metadata.len() == 0 {
            return Err(ReadError::Empty);
        }
        let n_bytes = metadata.len();
        let mut window =
            Self { file, bytes: Vec::new(), start: 0, before: 0, lines: 0, counts_lines: true, n_bytes };
        window.more()?;
        Ok(window)
    }

    /// Stops counting lines, because the following bytes are binary.
    pub(super) fn without_lines(&mut self) {
        self.counts_lines = false;
    }

    /// Bytes of the window that are in use.
    pub(super) fn rest(&self) -> &[u8] {
        &self.bytes[self.start..]
    }

    /// Copies the first `n` bytes of the rest.
    pub(super) fn to_vec(&self, n: usize) -> Vec<u8> {
        self.rest()[..n].to_vec()
    }

    /// Part of the rest that ends after a complete word.
    pub(super) fn words(&self) -> &[u8] {
        let rest = self.rest();
        if self.is_end() {
            return rest;
        }
        &rest[..rest.iter().rposition(|&b| is_space(b)).map_or(0, |last| last + 1)]
    }

    /// True if the window extends to the end of the file.
    pub(super) fn is_end(&self) -> bool {
        self.before + self.bytes.len() as u64 >= self.n_bytes
    }

    /// Number of bytes of the file before the rest.
    pub(super) fn position(&self) -> u64 {
        self.before + self.start as u64
    }

    pub(super) fn n_bytes(&self) -> u64 {
        self.n_bytes
    }

    /// Releases the first `n` bytes of the rest.
    pub(super) fn consume(&mut self, n: usize) {
        self.start += n;
    }

    /// Skips `n` bytes of the file; returns false if there are fewer.
    pub(super) fn skip(&mut self, n: u64) -> Result<bool, ReadError> {
        if n <= self.rest().len() as u64 {
            self.consume(n as usize);
            return Ok(true);
        }
        let to = self.position().saturating_add(n);
        if to > self.n_bytes {
            return Ok(false);
        }
        self.file.seek(SeekFrom::Start(to))?;
        self.bytes.clear();
        (self.start, self.before) = (0, to);
        Ok(true)
    }

    /// Extends the window and drops released bytes.
    pub(super) fn more(&mut self) -> Result<(), ReadError> {
        if self.counts_lines {
            self.lines += line_of(&self.bytes, self.start) - 1;
        }
        self.bytes.drain(..self.start);
        self.before += self.start as u64;
        self.start = 0;
        let (held, limit) = (self.bytes.len(), MOST_IN_A_ROW as u64);
        if held > MOST_IN_A_ROW {
            return Err(ReadError::Limit { what: "bytes of a row", found: held as u64, limit });
        }
        let wanted = STEP.max(held as u64);
        let n = (&self.file).take(wanted).read_to_end(&mut self.bytes)?;
        if (n as u64) < wanted {
            // The file may have become shorter or longer.
            self.n_bytes = self.before + self.bytes.len() as u64;
        }
        Ok(())
    }

    /// `line 12` or `byte 345` for an offset in the rest.
    pub(super) fn place(&self, at: usize) -> String {
        if self.counts_lines {
            format!("line {}", self.line(at))
        } else {
            format!("byte {}", self.position() + at as u64)
        }
    }

    /// Line number, from 1, of an offset in the rest.
    pub(super) fn line(&self, at: usize) -> u64 {
        self.lines + line_of(&self.bytes, self.start + at)
    }

    /// Converts lines and bytes in an error from the rest to the file.
    pub(super) fn placed(&self, error: ReadError) -> ReadError {
        let position = self.position();
        match error {
            ReadError::Line { line, message } => ReadError::Line { line: line + self.line(0) - 1, message },
            ReadError::Byte { byte, message } => ReadError::Byte { byte: byte + position, message },
            ReadError::Truncated { needed, element, row, .. } => {
                let needed = position.saturating_add(needed);
                ReadError::Truncated { end: self.n_bytes, needed, element, row }
            }
            other => other,
        }
    }
}
