//! Lines of a text that is read as a stream, one at a time.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::{ReadError, ReadLimits};

/// Largest number of bytes of a line of a stream, so that a stream without line ends takes no memory.
pub(crate) const LONGEST_LINE: u64 = 1 << 16;

/// Lines with their numbers.
pub(crate) struct TextStream<R> {
    reader: R,
    longest: u64,
    text: Vec<u8>,
    /// Number of lines up to the last one that was read.
    line: u64,
    n_bytes: u64,
}

impl<R: BufRead> TextStream<R> {
    /// A stream of lines of fewer than `longest` bytes.
    pub(crate) fn new(reader: R, longest: u64) -> Self {
        Self { reader, longest, text: Vec::new(), line: 0, n_bytes: 0 }
    }

    /// The next line without blanks at its ends and without a byte order mark; `None` at the end of the stream.
    pub(crate) fn next(&mut self) -> Result<Option<&[u8]>, ReadError> {
        let was_complete = self.line == 0 || self.text.last() == Some(&b'\n');
        self.text.clear();
        let read = self.reader.by_ref().take(self.longest).read_until(b'\n', &mut self.text);
        self.line += u64::from(was_complete);
        let n_bytes = read.map_err(|error| self.wrong(format!("it cannot be read: {error}")))? as u64;
        self.n_bytes += n_bytes;
        if n_bytes == self.longest && self.text.last() != Some(&b'\n') {
            return Err(self.wrong(format!("a line must have fewer than {} bytes", self.longest)));
        }
        Ok((n_bytes > 0).then(|| self.text()))
    }

    /// The last line that was read, without blanks at its ends and without a byte order mark.
    pub(crate) fn text(&self) -> &[u8] {
        let text = if self.line == 1 { self.text.strip_prefix(b"\xef\xbb\xbf") } else { None };
        text.unwrap_or(&self.text).trim_ascii()
    }

    /// Number of the last line that was read, from 1; at the end, of the line after the last line end.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }

    /// Number of bytes before the next line.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.n_bytes
    }

    /// The error of the last line that was read.
    pub(crate) fn wrong(&self, message: impl Into<String>) -> ReadError {
        ReadError::Line { line: self.line, message: message.into() }
    }
}

/// Text that ends in an error after a number of bytes.
struct LimitedText<R> {
    reader: R,
    left: u64,
}

impl<R: Read> Read for LimitedText<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n_bytes = self.reader.read(buffer)?;
        self.left = self.left.checked_sub(n_bytes as u64).ok_or_else(|| {
            io::Error::other("the file exceeds the largest size of an input (--max-input BYTES)")
        })?;
        Ok(n_bytes)
    }
}

/// Opens a text file, plain or, if its name ends in `.gz`, compressed by gzip, to be read as a stream. Reading fails
/// beyond the largest size that the limits allow.
///
/// # Errors
/// The file cannot be opened.
pub fn open_text(path: &Path, limits: &ReadLimits) -> io::Result<Box<dyn BufRead>> {
    let (file, left) = (File::open(path)?, limits.max_bytes);
    Ok(if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz")) {
        Box::new(BufReader::new(LimitedText { reader: MultiGzDecoder::new(BufReader::new(file)), left }))
    } else {
        Box::new(BufReader::new(LimitedText { reader: file, left }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbered_up_to_the_end() {
        for (text, end) in [("\u{feff} a \r\n\nb", 3), ("a\n\nb\n", 4)] {
            let mut lines = TextStream::new(text.as_bytes(), LONGEST_LINE);
            for (line, expected) in (1..).zip(["a", "", "b"]) {
                assert_eq!(lines.next().unwrap(), Some(expected.as_bytes()));
                assert_eq!(lines.line(), line);
            }
            assert_eq!(lines.next().unwrap(), None);
            assert_eq!((lines.line(), lines.n_bytes()), (end, text.len() as u64));
        }
        let mut endless = TextStream::new(&b"aaaa"[..], 3);
        assert!(endless.next().unwrap_err().to_string().contains("fewer than 3 bytes"));
    }
}
