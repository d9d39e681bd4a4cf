//! The beginning of a file, by which its format is recognized.

use std::path::Path;

use crate::model::format_descriptor::FormatDescriptor;
use crate::text;
use crate::text::line_end;

/// Number of bytes examined.
const LOOK: usize = 1 << 16;
/// Bytes that some editors put before a text in UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Bytes of a file, its beginning and its name.
pub(crate) struct FileHead<'a> {
    /// All bytes.
    pub(crate) bytes: &'a [u8],
    /// The first 64 KiB.
    pub(crate) head: &'a [u8],
    /// The bytes without a byte order mark and without blanks before them.
    pub(crate) text: &'a [u8],
    name: Option<&'a Path>,
}

impl<'a> FileHead<'a> {
    pub(crate) fn new(bytes: &'a [u8], name: Option<&'a str>) -> Self {
        Self {
            bytes,
            head: first(bytes),
            text: bytes.strip_prefix(MARK).unwrap_or(bytes).trim_ascii_start(),
            name: name.map(Path::new),
        }
    }

    /// True if the ending of the name means that format.
    pub(crate) fn is_named(&self, descriptor: &FormatDescriptor) -> bool {
        self.name.is_some_and(|name| descriptor.matches_name(name))
    }

    /// True if the first 64 KiB can be text.
    pub(crate) fn is_text(&self) -> bool {
        !self.head.contains(&0)
    }

    /// True if the file begins as a ZIP archive.
    pub(crate) fn is_archive(&self) -> bool {
        self.bytes.starts_with(b"PK\x03\x04")
    }

    /// True if the file is XML with an element `<name`.
    pub(crate) fn has_element(&self, name: &str) -> bool {
        self.text.starts_with(b"<")
            && memchr::memmem::find_iter(self.head, name).any(|at| {
                at > 0
                    && self.head[at - 1] == b'<'
                    && self.head.get(at + name.len()).is_none_or(|b| !b.is_ascii_alphanumeric())
            })
    }

    /// The first 64 KiB of the text.
    pub(crate) fn text_head(&self) -> &'a [u8] {
        first(self.text)
    }

    /// Lines that are neither blank nor a comment, without leading blanks.
    pub(crate) fn statements(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let text = self.head;
        let mut position = if text.starts_with(MARK) { MARK.len() } else { 0 };
        std::iter::from_fn(move || {
            while position < text.len() {
                let end = line_end(text, position);
                let line = text[position..end].trim_ascii();
                position = end + 1;
                if !line.is_empty() && line[0] != b'#' && !line.starts_with(b"//") {
                    return Some(line);
                }
            }
            None
        })
    }

    /// The first word of the first statement.
    pub(crate) fn keyword(&self) -> Option<&'a [u8]> {
        self.statements().next().and_then(|line| text::words(line).next())
    }
}

fn first(bytes: &[u8]) -> &[u8] {
    &bytes[..bytes.len().min(LOOK)]
}
