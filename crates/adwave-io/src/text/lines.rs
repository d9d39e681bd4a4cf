//! Nonempty lines of a text.

use crate::text::line_end;

/// Line without surrounding blanks and without a comment after `#`.
pub(crate) struct Statement<'a> {
    /// Start in the file.
    pub(crate) start: usize,
    pub(crate) text: &'a [u8],
}

/// Iterator that skips blank lines and comments.
pub(crate) struct Statements<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) position: usize,
}

impl<'a> Statements<'a> {
    /// Starts at the beginning, after a byte order mark.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 } }
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        while self.position < self.bytes.len() {
            let start = self.position;
            let end = line_end(self.bytes, start);
            self.position = end + 1;
            let line = &self.bytes[start..end];
            let line = memchr::memchr(b'#', line).map_or(line, |n| &line[..n]);
            let leading = line.iter().take_while(|b| b.is_ascii_whitespace()).count();
            let text = line.trim_ascii();
            if !text.is_empty() {
                return Some(Statement { start: start + leading, text });
            }
        }
        None
    }
}
