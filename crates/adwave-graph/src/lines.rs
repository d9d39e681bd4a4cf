//! Lines of a stream of text, one at a time.

use std::io::{BufRead, Read};

/// Largest number of bytes of a line, so that a stream without line ends takes no memory.
const LONGEST: u64 = 1 << 16;

/// Lines with their numbers, from 1.
pub(crate) struct Lines<R> {
    reader: R,
    text: Vec<u8>,
    /// Number of the last line that was read.
    pub(crate) number: u64,
}

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(reader: R) -> Self {
        Self { reader, text: Vec::new(), number: 0 }
    }

    /// The next line without blanks at its ends; `None` at the end of the stream.
    pub(crate) fn next(&mut self) -> Result<Option<&[u8]>, String> {
        self.text.clear();
        self.number += 1;
        let read = self.reader.by_ref().take(LONGEST).read_until(b'\n', &mut self.text);
        let n_bytes = read.map_err(|error| format!("it cannot be read: {error}"))?;
        if n_bytes as u64 == LONGEST && self.text.last() != Some(&b'\n') {
            return Err(format!("a line must have fewer than {LONGEST} bytes"));
        }
        Ok((n_bytes > 0).then(|| self.text.trim_ascii()))
    }
}
