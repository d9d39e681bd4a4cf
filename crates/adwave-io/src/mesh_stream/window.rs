//! A file that is looked at through a window which moves on.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use crate::ReadError;
use crate::text::{is_space, line_of};

/// Bytes that are read at once; in tests so few that everything is cut somewhere.
const STEP: u64 = if cfg!(test) { 64 } else { 1 << 22 };
/// A row that is longer is none that a program has written.
const MOST_IN_A_ROW: usize = 1 << 28;

/// Some bytes of a file, from those on that are not done with.
pub(super) struct Window {
    file: File,
    bytes: Vec<u8>,
    /// Where in `bytes` begins what is not done with.
    start: usize,
    /// Bytes of the file before `bytes`.
    before: u64,
    /// Line ends among these, where lines are counted.
    lines: u64,
    counts_lines: bool,
    /// Bytes of the file.
    n_bytes: u64,
}

impl Window {
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(ReadError::Whole("is no regular file; give a PLY or OBJ".into()));
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

    /// From here on bytes are no text.
    pub(super) fn without_lines(&mut self) {
        self.counts_lines = false;
    }

    /// What is in the window and not done with.
    pub(super) fn rest(&self) -> &[u8] {
        &self.bytes[self.start..]
    }

    /// The first `n` bytes of the rest, in a list of their own.
    pub(super) fn to_vec(&self, n: usize) -> Vec<u8> {
        self.rest()[..n].to_vec()
    }

    /// As much of the rest as ends behind a whole word.
    pub(super) fn words(&self) -> &[u8] {
        let rest = self.rest();
        if self.is_end() {
            return rest;
        }
        &rest[..rest.iter().rposition(|&b| is_space(b)).map_or(0, |last| last + 1)]
    }

    /// Whether nothing of the file comes after the window.
    pub(super) fn is_end(&self) -> bool {
        self.before + self.bytes.len() as u64 >= self.n_bytes
    }

    /// Bytes of the file before the rest.
    pub(super) fn position(&self) -> u64 {
        self.before + self.start as u64
    }

    pub(super) fn n_bytes(&self) -> u64 {
        self.n_bytes
    }

    /// The first `n` bytes of the rest are done with.
    pub(super) fn consume(&mut self, n: usize) {
        self.start += n;
    }

    /// Passes over `n` bytes of the file; whether there are so many.
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

    /// Makes the window longer, at the cost of what is done with.
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
            // It may be shorter by now, or longer.
            self.n_bytes = self.before + self.bytes.len() as u64;
        }
        Ok(())
    }

    /// `line 12` or `byte 345`, of a place in the rest.
    pub(super) fn place(&self, at: usize) -> String {
        if self.counts_lines {
            format!("line {}", self.line(at))
        } else {
            format!("byte {}", self.position() + at as u64)
        }
    }

    /// The line, from 1, of a place in the rest.
    pub(super) fn line(&self, at: usize) -> u64 {
        self.lines + line_of(&self.bytes, self.start + at)
    }

    /// An error whose lines and bytes are counted in the rest, as they are counted in the file.
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
