//! Numbers and words in text formats.

pub(crate) mod csv;
pub(crate) mod encoding;
pub(crate) mod lines;
pub(crate) mod stream;
pub(crate) mod tokens;
#[cfg(any(feature = "vtk", feature = "neuro", feature = "graph", feature = "print3d"))]
pub(crate) mod xml;

/// True if the byte separates words on a line.
pub(crate) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}

/// True if the byte separates words.
pub(crate) fn is_space(byte: u8) -> bool {
    is_blank(byte) || byte == b'\n'
}

/// Number of the line, from 1, that contains byte `position`.
pub(crate) fn line_of(bytes: &[u8], position: usize) -> u64 {
    1 + memchr::memchr_iter(b'\n', &bytes[..position.min(bytes.len())]).count() as u64
}

/// End of the line that begins at `start`: the position of its line feed, or the end of the bytes.
pub(crate) fn line_end(bytes: &[u8], start: usize) -> usize {
    memchr::memchr(b'\n', &bytes[start..]).map_or(bytes.len(), |n| start + n)
}

/// Text of another library's error without line breaks and other control characters.
pub(crate) fn one_line(error: &dyn std::fmt::Display) -> String {
    error.to_string().chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Formats a word for a message: quoted, control bytes escaped, at most 40 characters.
pub(crate) fn show(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(160)]);
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() || word.len() > 160 {
        short.push('…');
    }
    format!("{short:?}")
}

/// Parses a decimal number, including the spellings of NaN and infinity that programs have written (`-nan(ind)`,
/// `1.#IND`, `1.#INF`, `inf`, …).
pub(crate) fn parse_f64(word: &[u8]) -> Option<f64> {
    fast_float2::parse(word).ok().or_else(|| parse_special(word))
}

/// Parses the number at the start of `bytes`, and returns its length in bytes; it ends at a blank or the end.
pub(crate) fn parse_f64_at(bytes: &[u8]) -> Option<(f64, usize)> {
    plain_f64_at(bytes).or_else(|| {
        let n = bytes.iter().position(|&b| is_space(b)).unwrap_or(bytes.len());
        parse_f64(&bytes[..n]).map(|x| (x, n))
    })
}

/// [`parse_f64_at`] for decimal numbers only.
pub(crate) fn plain_f64_at(bytes: &[u8]) -> Option<(f64, usize)> {
    let (x, n) = fast_float2::parse_partial::<f64, _>(bytes).ok()?;
    (n > 0 && bytes.get(n).is_none_or(|&b| is_space(b))).then_some((x, n))
}

/// [`parse_f64`] rounded once to 32 bits.
pub(crate) fn parse_f32(word: &[u8]) -> Option<f32> {
    fast_float2::parse(word).ok().or_else(|| parse_special(word).map(|x| x as f32))
}

fn parse_special(word: &[u8]) -> Option<f64> {
    let (negative, rest) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    let lower = rest.to_ascii_lowercase();
    let magnitude = match lower.as_slice() {
        b"inf" | b"infinity" | b"1.#inf" => f64::INFINITY,
        // MSVC prints the requested number of digits: 1.#INF00, 1.#QNAN0. The payload of a NaN is in parentheses:
        // nan(ind).
        w if !w.iter().all(|b| b.is_ascii_alphanumeric() || b"+-.#()_".contains(b)) => return None,
        w if w.starts_with(b"1.#inf") => f64::INFINITY,
        w if w.starts_with(b"nan") || w.starts_with(b"1.#") => f64::NAN,
        // A second sign is invalid; a plain `+1.5` is a number.
        w if word.first() == Some(&b'+') && w.first().is_some_and(|b| b.is_ascii_digit() || *b == b'.') => {
            fast_float2::parse(w).ok()?
        }
        _ => return None,
    };
    Some(if negative { -magnitude } else { magnitude })
}

/// Parses an unsigned integer.
pub(crate) fn parse_u64(word: &[u8]) -> Option<u64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Escapes a text for XML tags and attributes; control characters, which XML cannot represent, become `_`.
pub(crate) fn escape_xml(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('_'),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Writes the shortest decimal that reads back to the same value.
pub(crate) fn push_f64(out: &mut Vec<u8>, x: f64) {
    push_shortest(out, ryu::Buffer::new().format(x));
}

/// Writes the shortest decimal that reads back to the same 32-bit value.
pub(crate) fn push_f32(out: &mut Vec<u8>, x: f32) {
    push_shortest(out, ryu::Buffer::new().format(x));
}

fn push_shortest(out: &mut Vec<u8>, digits: &str) {
    // Readers in C accept `nan` and `inf`; not all accept `NaN`.
    match digits {
        "NaN" => out.extend_from_slice(b"nan"),
        _ => out.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes()),
    }
}

/// Iterator over the words of a text across line ends.
pub(crate) struct Words<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) position: usize,
}

impl<'a> Words<'a> {
    pub(crate) fn new(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    /// Next word and its start.
    pub(crate) fn next(&mut self) -> Option<(usize, &'a [u8])> {
        while self.bytes.get(self.position).is_some_and(|&b| is_space(b)) {
            self.position += 1;
        }
        let start = self.position;
        while self.bytes.get(self.position).is_some_and(|&b| !is_space(b)) {
            self.position += 1;
        }
        (start < self.position).then(|| (start, &self.bytes[start..self.position]))
    }
}

/// Words of one line, split at blanks.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&b| is_space(b)).filter(|w| !w.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_programs_write() {
        for (word, x) in [("1", 1.0), ("-.7e+02", -70.0), (".8e-001", 0.08), ("+2.5", 2.5), ("5.", 5.0)] {
            assert_eq!(parse_f64(word.as_bytes()), Some(x), "{word}");
        }
        for word in ["nan", "-nan", "NaN", "1.#IND", "-1.#IND00", "1.#QNAN", "-nan(ind)"] {
            assert!(parse_f64(word.as_bytes()).is_some_and(f64::is_nan), "{word}");
        }
        for word in ["inf", "1.#INF", "Infinity"] {
            assert_eq!(parse_f64(word.as_bytes()), Some(f64::INFINITY), "{word}");
        }
        assert_eq!(parse_f64(b"-1.#INF00"), Some(f64::NEG_INFINITY));
        for word in ["", "-", "abc", "1.2.3", "1,5", "--1", "0x10", "1e", "+-1", "1.#IND0}a=0"] {
            assert_eq!(parse_f64(word.as_bytes()), None, "{word}");
        }
    }

    proptest::proptest! {
        #[test]
        fn shortest_decimals_read_back(bits: u64) {
            let x = f64::from_bits(bits);
            let mut text = Vec::new();
            push_f64(&mut text, x);
            let back = parse_f64(&text).unwrap();
            assert!(back.to_bits() == x.to_bits() || (back.is_nan() && x.is_nan()));
        }
    }
}
