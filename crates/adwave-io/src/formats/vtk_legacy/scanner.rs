//! Sequential reading of words and arrays.

use std::borrow::Cow;

use adwave::Progress;

use crate::model::field::ByteOrder;
use crate::model::numbers::{NoNumber, Numbers, end_of_words, from_text};
use crate::text::{is_space, line_end, parse_f64, parse_u64, show};
use crate::{FieldValues, ReadError, ValueType};

pub(super) struct Scanner<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) is_binary: bool,
    pub(super) progress: Progress<'a>,
}

/// Type of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ArrayType {
    Numbers(ValueType),
    /// Bits, eight per byte.
    Bits,
    /// VTK's own type of indices, which has 32 bits in binary files.
    Ids,
    Texts,
}

impl<'a> Scanner<'a> {
    /// Creates the error at a position of the file.
    pub(super) fn error(&self, at: usize, message: impl Into<String>) -> ReadError {
        if self.is_binary {
            ReadError::at_byte(at, message)
        } else {
            ReadError::in_line(self.bytes, at, message)
        }
    }

    /// Next word and its start.
    pub(super) fn word(&mut self) -> Option<(usize, &'a [u8])> {
        while self.bytes.get(self.at).is_some_and(|&b| is_space(b)) {
            self.at += 1;
        }
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(|&b| !is_space(b)) {
            self.at += 1;
        }
        (start < self.at).then(|| (start, &self.bytes[start..self.at]))
    }

    /// Consumes the next word if it is the expected one; returns true then.
    pub(super) fn pass(&mut self, expected: &str) -> bool {
        let before = self.at;
        let is_next = self.word().is_some_and(|(_, word)| word.eq_ignore_ascii_case(expected.as_bytes()));
        if !is_next {
            self.at = before;
        }
        is_next
    }

    /// Consumes and returns the rest of the line.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let start = self.at.min(self.bytes.len());
        let end = line_end(self.bytes, start);
        self.at = (end + 1).min(self.bytes.len());
        &self.bytes[start..end]
    }

    fn missing(&self, what: &str) -> ReadError {
        self.error(self.bytes.len(), format!("the file ends before {what}; get the whole file"))
    }

    pub(super) fn name(&mut self, what: &str) -> Result<String, ReadError> {
        let (_, word) = self.word().ok_or_else(|| self.missing(what))?;
        Ok(decoded(word))
    }

    pub(super) fn count(&mut self, what: &str) -> Result<u64, ReadError> {
        let (at, word) = self.word().ok_or_else(|| self.missing(what))?;
        parse_u64(word)
            .ok_or_else(|| self.error(at, format!("expected {what}, got {}; correct it", show(word))))
    }

    pub(super) fn number(&mut self, what: &str) -> Result<f64, ReadError> {
        let (at, word) = self.word().ok_or_else(|| self.missing(what))?;
        parse_f64(word)
            .ok_or_else(|| self.error(at, format!("expected {what}, got {}; correct it", show(word))))
    }

    pub(super) fn array_type(&mut self) -> Result<ArrayType, ReadError> {
        let (at, word) = self.word().ok_or_else(|| self.missing("a type of numbers"))?;
        array_type(word).ok_or_else(|| {
            self.error(at, format!("{} is not a supported type of numbers; correct it", show(word)))
        })
    }

    /// Consumes `n` bytes, which must exist.
    pub(super) fn take(&mut self, n: Option<usize>, what: &str) -> Result<&'a [u8], ReadError> {
        let (start, found) = (self.at, self.bytes.len() - self.at);
        let Some(n) = n.filter(|&n| n <= found) else {
            let message = format!("{what} needs more than the remaining {found} bytes; get the whole file");
            return Err(self.error(start, message));
        };
        self.at += n;
        Ok(&self.bytes[start..start + n])
    }

    /// Reads an array of numbers. A binary one begins after the end of the line that names it.
    pub(super) fn array(&mut self, n: u64, kind: ArrayType, what: &str) -> Result<Numbers<'a>, ReadError> {
        let n = usize::try_from(n)
            .map_err(|_| self.error(self.at, format!("{n} numbers are too many for {what}")))?;
        let value_type = match kind {
            ArrayType::Numbers(kind) => kind,
            ArrayType::Bits => ValueType::U8,
            ArrayType::Ids if self.is_binary => ValueType::I32,
            ArrayType::Ids => ValueType::I64,
            ArrayType::Texts => {
                return Err(self.error(self.at, format!("{what} are texts instead of numbers")));
            }
        };
        if self.is_binary {
            self.line();
            if kind == ArrayType::Bits {
                let bytes = self.take(Some(n.div_ceil(8)), what)?;
                let bits = (0..n).map(|i| bytes[i / 8] >> (7 - i % 8) & 1).collect();
                return Ok(Numbers::Values(FieldValues::U8(bits)));
            }
            let bytes = self.take(n.checked_mul(value_type.n_bytes()), what)?;
            return Ok(Numbers::Bytes {
                bytes: Cow::Borrowed(bytes),
                kind: value_type,
                order: ByteOrder::Big,
            });
        }
        let start = self.at;
        match end_of_words(self.bytes, start, n, self.progress)? {
            Ok(end) => self.at = end,
            Err(found) => {
                let message = format!("{what} needs {n} numbers, got {found}; get the whole file");
                return Err(self.error(self.bytes.len(), message));
            }
        }
        match from_text(&self.bytes[start..self.at], value_type, self.progress) {
            Ok(values) => Ok(Numbers::Values(values)),
            Err(NoNumber::Cancelled(cancelled)) => Err(cancelled.into()),
            Err(NoNumber::At(at, message)) => {
                Err(self.error(start + at, format!("{what}: {message}; correct it")))
            }
        }
    }
}

fn array_type(word: &[u8]) -> Option<ArrayType> {
    let word = word.to_ascii_lowercase();
    Some(ArrayType::Numbers(match word.as_slice() {
        b"bit" => return Some(ArrayType::Bits),
        b"vtkidtype" => return Some(ArrayType::Ids),
        b"string" | b"utf8_string" => return Some(ArrayType::Texts),
        b"char" | b"signed_char" | b"vtktypeint8" => ValueType::I8,
        b"unsigned_char" | b"vtktypeuint8" => ValueType::U8,
        b"short" | b"vtktypeint16" => ValueType::I16,
        b"unsigned_short" | b"vtktypeuint16" => ValueType::U16,
        b"int" | b"vtktypeint32" => ValueType::I32,
        b"unsigned_int" | b"vtktypeuint32" => ValueType::U32,
        // 64 bits on all systems except Windows, where newer files state the width.
        b"long" | b"vtktypeint64" => ValueType::I64,
        b"unsigned_long" | b"vtktypeuint64" => ValueType::U64,
        b"float" | b"vtktypefloat32" => ValueType::F32,
        b"double" | b"vtktypefloat64" => ValueType::F64,
        _ => return None,
    }))
}

/// Decodes a name, in which bytes other than letters and digits may be encoded as `%20`.
fn decoded(word: &[u8]) -> String {
    let mut bytes = Vec::with_capacity(word.len());
    let mut at = 0;
    while at < word.len() {
        let hexadecimal = word.get(at + 1..at + 3).filter(|_| word[at] == b'%');
        let byte = hexadecimal
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(byte.unwrap_or(word[at]));
        at += if byte.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Encodes a name for a file.
pub(super) fn encoded(name: &str) -> String {
    let mut word = String::new();
    for byte in name.bytes() {
        if (33..127).contains(&byte) && !matches!(byte, b'"' | b'%') {
            word.push(char::from(byte));
        } else {
            word += &format!("%{byte:02X}");
        }
    }
    if word.is_empty() { "_".into() } else { word }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for name in ["Spatial Cell Data", "a%20b", "ä\"\n", "plain"] {
            assert_eq!(decoded(encoded(name).as_bytes()), name);
        }
        assert_eq!(encoded("Spatial Cell Data"), "Spatial%20Cell%20Data");
        assert_eq!(decoded(b"100%"), "100%");
    }
}
