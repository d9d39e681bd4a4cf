//! Free-form texts without line structure: words separated by blanks or line ends, comments from `#` to the end of a
//! line.

use crate::ReadError;
use crate::text::{is_space, line_end, plain_f64_at, show};

/// Sequential reader of the words of a text without line structure.
#[derive(Clone)]
pub(crate) struct Tokens<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) position: usize,
}

impl<'a> Tokens<'a> {
    pub(crate) fn new(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    /// Moves to the start of the next word, or to the end.
    pub(crate) fn skip(&mut self) {
        loop {
            match self.bytes.get(self.position) {
                Some(&b) if is_space(b) => self.position += 1,
                Some(b'#') => self.position = line_end(self.bytes, self.position),
                _ => return,
            }
        }
    }

    /// Next word and its start.
    pub(crate) fn next(&mut self) -> Option<(usize, &'a [u8])> {
        self.skip();
        let start = self.position;
        while let Some(&b) = self.bytes.get(self.position)
            && !is_space(b)
            && (b != b'#' || is_special(&self.bytes[start..], self.position - start))
        {
            self.position += 1;
        }
        (start < self.position).then(|| (start, &self.bytes[start..self.position]))
    }

    /// Next word, without consuming it.
    pub(crate) fn peek(&mut self) -> Option<&'a [u8]> {
        let word = self.next().map(|(_, word)| word);
        self.position -= word.map_or(0, <[u8]>::len);
        word
    }

    /// Fails early if `n` rows of at least `row_bytes` do not fit the remaining bytes.
    pub(crate) fn check(&self, n: u64, row_bytes: u64, element: &str) -> Result<(), ReadError> {
        check_rows(self.bytes.len(), self.position, n, row_bytes, element, 1)
    }

    /// Reads the next number.
    pub(crate) fn number(&mut self, element: &str, row: u64) -> Result<f64, ReadError> {
        self.skip();
        if let Some((x, n)) = plain_f64_at(&self.bytes[self.position..]) {
            self.position += n;
            return Ok(x);
        }
        // A comment may follow without a blank, and NaN has a spelling with `#`.
        let start = self.position;
        if let Some((_, word)) = self.next()
            && let Some(x) = crate::text::parse_f64(word)
        {
            return Ok(x);
        }
        self.position = start;
        Err(self.wrong(element, row, "a number"))
    }

    /// Reads the next integer.
    pub(crate) fn integer(&mut self, element: &str, row: u64) -> Result<i64, ReadError> {
        self.skip();
        let start = self.position;
        let is_negative = self.bytes.get(start) == Some(&b'-');
        let mut at = start + usize::from(is_negative || self.bytes.get(start) == Some(&b'+'));
        let first = at;
        let mut n = 0_i64;
        while let Some(digit) = self.bytes.get(at).map(|b| b.wrapping_sub(b'0')).filter(|&d| d < 10)
            && at - first < 18
        {
            n = 10 * n + i64::from(digit);
            at += 1;
        }
        if at == first || self.bytes.get(at).is_some_and(|&b| !is_space(b) && b != b'#') {
            return Err(self.wrong(element, row, "an integer"));
        }
        self.position = at;
        Ok(if is_negative { -n } else { n })
    }

    /// Reads the next non-negative integer.
    pub(crate) fn count(&mut self, element: &str, row: u64) -> Result<u64, ReadError> {
        self.skip();
        let start = self.position;
        u64::try_from(self.integer(element, row)?).map_err(|_| {
            let message = format!("{element} {row} needs a non-negative count; correct it");
            ReadError::line_error(self.bytes, start, message)
        })
    }

    /// Creates the error for an unexpected next word.
    pub(crate) fn wrong(&mut self, element: &str, row: u64, what: &str) -> ReadError {
        let message = match self.clone().next() {
            Some((_, word)) => {
                format!("{element} {row} needs {what}, got {}; correct it", show(word))
            }
            None => format!("the file ends in {element} {row}; get the whole file"),
        };
        self.skip();
        ReadError::line_error(self.bytes, self.position, message)
    }
}

/// True if the `#` at `at` is part of NaN or infinity: `1.#IND`, `-1.#INF00`.
fn is_special(bytes: &[u8], at: usize) -> bool {
    let follows =
        |name: &&[u8]| bytes[at + 1..].get(..name.len()).is_some_and(|next| next.eq_ignore_ascii_case(name));
    matches!(&bytes[..at], b"1." | b"-1." | b"+1.")
        && [&b"IND"[..], b"INF", b"QNAN", b"SNAN"].iter().any(follows)
}

/// Fails if `n` rows of at least `row_bytes` exceed the bytes from `position` on plus `spare`.
pub(crate) fn check_rows(
    end: usize,
    position: usize,
    n: u64,
    row_bytes: u64,
    element: &str,
    spare: u64,
) -> Result<(), ReadError> {
    let remaining = end.saturating_sub(position) as u64 + spare;
    let fitting = remaining / row_bytes.max(1);
    if fitting >= n {
        return Ok(());
    }
    Err(ReadError::Truncated {
        end: end as u64,
        needed: (position as u64).saturating_add(n.saturating_mul(row_bytes)),
        element: element.into(),
        row: fitting,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_run_over_lines_and_remarks() {
        let mut tokens = Tokens::new(b" 1 -2# a\n\n#b\n+3.5 x", 0);
        assert_eq!((tokens.integer("row", 0).unwrap(), tokens.integer("row", 0).unwrap()), (1, -2));
        assert_eq!(tokens.number("row", 0).unwrap(), 3.5);
        assert_eq!(tokens.peek(), Some(&b"x"[..]));
        let message = tokens.number("row", 7).unwrap_err().to_string();
        assert_eq!(message, "line 4: row 7 needs a number, got \"x\"; correct it");
        tokens.next();
        let message = tokens.count("row", 8).unwrap_err().to_string();
        assert_eq!(message, "line 4: the file ends in row 8; get the whole file");
    }

    #[test]
    fn a_number_sign_is_a_remark_but_in_special_numbers() {
        let mut tokens = Tokens::new(b"1.#IND1 2.#IND\n-1.#inf00 1.#remark\n7", 0);
        assert!(tokens.number("row", 0).unwrap().is_nan());
        assert_eq!(tokens.number("row", 0).unwrap(), 2.0);
        assert_eq!(tokens.peek(), Some(&b"-1.#inf00"[..]));
        assert_eq!(tokens.number("row", 0).unwrap(), f64::NEG_INFINITY);
        assert_eq!(tokens.number("row", 0).unwrap(), 1.0);
        assert_eq!(tokens.number("row", 0).unwrap(), 7.0);
        assert!(tokens.next().is_none());
    }

    #[test]
    fn whole_numbers_have_at_most_eighteen_digits() {
        let read = |text: &str| Tokens::new(text.as_bytes(), 0).integer("row", 0);
        assert_eq!(read("999999999999999999").unwrap(), 999_999_999_999_999_999);
        for bad in ["9999999999999999999", "-", "1.5", "1a", ""] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
