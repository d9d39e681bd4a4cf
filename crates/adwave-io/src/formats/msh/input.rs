//! Input of a Gmsh mesh: numbers in text or binary, and sections between `$Name` and `$EndName`.

use crate::ReadError;
use crate::bytes::cursor::Cursor;
use crate::formats::msh::kinds::{Kind, kind_of};
use crate::model::field::ByteOrder;
use crate::text::tokens::Tokens;
use crate::text::{is_space, line_end, show};

/// Read position in the file, whose numbers are text or binary.
pub(crate) struct Input<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) position: usize,
    pub(crate) is_binary: bool,
    pub(crate) order: ByteOrder,
    /// Version number without the point: 22 for 2.2.
    pub(crate) version: u32,
}

impl<'a> Input<'a> {
    pub(crate) fn tokens(&self) -> Tokens<'a> {
        Tokens::new(self.bytes, self.position)
    }

    pub(crate) fn cursor(&self) -> Cursor<'a> {
        Cursor::new(self.bytes, self.position, self.order)
    }

    /// Creates the error at the read position.
    pub(crate) fn wrong(&self, message: &str) -> ReadError {
        if self.is_binary {
            return ReadError::at_byte(self.position, message);
        }
        ReadError::in_line(self.bytes, self.position, message)
    }

    /// Reads a 32-bit integer.
    pub(crate) fn int(&mut self, element: &str, row: u64) -> Result<i64, ReadError> {
        if self.is_binary {
            let mut cursor = self.cursor();
            let x: i32 = cursor.number(element, row)?;
            self.position = cursor.position;
            return Ok(x.into());
        }
        let mut tokens = self.tokens();
        let x = tokens.whole(element, row)?;
        self.position = tokens.position;
        Ok(x)
    }

    /// Reads a count or a tag, which has 64 bits in a binary file.
    pub(crate) fn size(&mut self, element: &str, row: u64) -> Result<u64, ReadError> {
        if self.is_binary {
            let mut cursor = self.cursor();
            let x = cursor.number(element, row)?;
            self.position = cursor.position;
            return Ok(x);
        }
        let mut tokens = self.tokens();
        let x = tokens.count(element, row)?;
        self.position = tokens.position;
        Ok(x)
    }

    pub(crate) fn double(&mut self, element: &str) -> Result<(), ReadError> {
        if self.is_binary {
            let mut cursor = self.cursor();
            cursor.number::<f64>(element, 0)?;
            self.position = cursor.position;
            return Ok(());
        }
        let mut tokens = self.tokens();
        tokens.number(element, 0)?;
        self.position = tokens.position;
        Ok(())
    }

    /// Reads a count on a line of its own, which is text in binary files of version 2 too.
    pub(crate) fn text_count(&mut self, what: &str) -> Result<u64, ReadError> {
        let mut tokens = self.tokens();
        let n = tokens.count(what, 0)?;
        self.position = line_end(self.bytes, tokens.position).saturating_add(1).min(self.bytes.len());
        Ok(n)
    }

    pub(crate) fn kind(&self, number: i64) -> Result<(Kind, usize), ReadError> {
        kind_of(number).ok_or_else(|| {
            self.wrong(&format!("elements of kind {number} are not supported; save polygons as triangles"))
        })
    }

    /// Name of the next section, without its `$`.
    pub(crate) fn section(&mut self) -> Result<Option<&'a [u8]>, ReadError> {
        loop {
            while self.bytes.get(self.position).is_some_and(|&b| is_space(b)) {
                self.position += 1;
            }
            if self.position >= self.bytes.len() {
                return Ok(None);
            }
            let end = line_end(self.bytes, self.position);
            let line = self.bytes[self.position..end].trim_ascii();
            let Some(name) = line.strip_prefix(b"$") else {
                let message = format!("expected the start of a section, got {}; correct it", show(line));
                return Err(self.wrong(&message));
            };
            self.position = (end + 1).min(self.bytes.len());
            if !name.is_empty() {
                return Ok(Some(name));
            }
        }
    }

    /// Skips `$EndName`, and the content before it if `skips` allows.
    pub(crate) fn end(&mut self, name: &[u8], skips: Skips) -> Result<(), ReadError> {
        let end = [b"$End", name].concat();
        while skips == Skips::Blanks && self.bytes.get(self.position).is_some_and(|&b| is_space(b)) {
            self.position += 1;
        }
        let rest = &self.bytes[self.position..];
        let found = match skips {
            Skips::Blanks => rest.starts_with(&end).then_some(0),
            Skips::Anything => memchr::memmem::find(rest, &end),
        };
        let Some(found) = found else {
            let name = String::from_utf8_lossy(name);
            let cut: String = name.chars().filter(|c| !c.is_control()).take(40).collect();
            return Err(
                self.wrong(&format!("section ${cut} must end here with $End{cut}; get the whole file"))
            );
        };
        self.position += found + end.len();
        Ok(())
    }
}

/// Content allowed before the end of a section.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Skips {
    Blanks,
    Anything,
}
