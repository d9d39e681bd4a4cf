//! Cells of a row of a table: numbers as different programs write them, and words.

use crate::model::text_rows::{DecimalMark, Separator, cell_length};
use crate::text::{is_blank, parse_f64};

/// Separator and decimal mark of a table, by its first row of values or names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RowStyle {
    pub(crate) separator: Separator,
    pub(crate) decimal: DecimalMark,
}

impl RowStyle {
    /// Style of a line: semicolons separate before tabs and blanks, and those before commas if every value between
    /// them has one comma between digits at most.
    pub(crate) fn from_line(line: &[u8]) -> Self {
        let plain = |separator| Self { separator, decimal: DecimalMark::Point };
        if line.contains(&b';') {
            let with_comma =
                line.split(|&b| b == b';').any(|cell| is_decimal_comma(unquoted(cell.trim_ascii())));
            let decimal = if with_comma { DecimalMark::Comma } else { DecimalMark::Point };
            return Self { separator: Separator::Byte(b';'), decimal };
        }
        if !line.contains(&b',') {
            return plain(Separator::Blanks);
        }
        let mut words = line.split(|&b| is_blank(b)).filter(|word| !word.is_empty());
        let n_words = words.clone().count();
        let is_value = |word: &[u8]| {
            let word = unquoted(word);
            is_decimal_comma(word) || parse_f64(word).is_some() || !word.contains(&b',')
        };
        let has_comma = words.clone().any(|word| is_decimal_comma(unquoted(word)));
        if n_words >= 3 && has_comma && words.all(is_value) {
            return Self { separator: Separator::Blanks, decimal: DecimalMark::Comma };
        }
        plain(Separator::Byte(b','))
    }
}

/// True for a number with one comma, and no point, between digits.
fn is_decimal_comma(cell: &[u8]) -> bool {
    let mut commas = (0..cell.len()).filter(|&k| cell[k] == b',');
    let (Some(comma), None) = (commas.next(), commas.next()) else { return false };
    let is_digit = |k: usize| cell.get(k).is_some_and(u8::is_ascii_digit);
    let is_between_digits = is_digit(comma.wrapping_sub(1)) && is_digit(comma + 1);
    is_between_digits && !cell.contains(&b'.') && parse_with_comma(cell).is_some()
}

fn parse_with_comma(cell: &[u8]) -> Option<f64> {
    let with_point: Vec<u8> = cell.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
    parse_f64(&with_point)
}

/// Content of a quoted cell, or the cell.
pub(crate) fn unquoted(cell: &[u8]) -> &[u8] {
    for quote in *b"\"'" {
        if let [first, inner @ .., last] = cell
            && *first == quote
            && *last == quote
        {
            return inner.trim_ascii();
        }
    }
    cell
}

/// Splits a row into its cells without blanks around them; quotes around a cell protect a separator that is no blank.
pub(crate) fn cells(line: &[u8], separator: Separator) -> Vec<&[u8]> {
    let Separator::Byte(separator) = separator else {
        let is_separator = |b: &u8| match separator {
            Separator::OverLines => crate::text::is_space(*b),
            _ => is_blank(*b),
        };
        return line.split(is_separator).map(<[u8]>::trim_ascii).filter(|cell| !cell.is_empty()).collect();
    };
    let (mut cells, mut start) = (Vec::new(), 0);
    loop {
        start += line[start..].iter().take_while(|&&b| is_blank(b) && b != separator).count();
        let end = start + cell_length(&line[start..], separator);
        cells.push(line[start..end].trim_ascii());
        if end == line.len() {
            return cells;
        }
        start = end + 1;
    }
}

/// Words for a missing number, in any case.
const MISSING: [&str; 6] = ["", "na", "n/a", "null", "none", "nan"];

/// Number of a cell: NaN if it is missing, `None` if it is a word.
pub(crate) fn number(cell: &[u8], decimal: DecimalMark) -> Option<f64> {
    let cell = unquoted(cell);
    if let Some(x) = parse_f64(cell) {
        return Some(x);
    }
    if MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word.as_bytes())) {
        return Some(f64::NAN);
    }
    if decimal == DecimalMark::Comma && is_decimal_comma(cell) { parse_with_comma(cell) } else { None }
}

#[cfg(test)]
mod tests {
    use super::DecimalMark::{Comma, Point};
    use super::*;

    #[test]
    fn styles_of_lines() {
        let style = |line: &str| {
            let style = RowStyle::from_line(line.as_bytes());
            (style.separator, style.decimal)
        };
        assert_eq!(style("1.5 2 3"), (Separator::Blanks, Point));
        assert_eq!(style("1,5 2 -3,25e1"), (Separator::Blanks, Comma));
        assert_eq!(style("1,5\t2,0\t3"), (Separator::Blanks, Comma));
        assert_eq!(style("1, 2, 3"), (Separator::Byte(b','), Point));
        assert_eq!(style("1,2,3"), (Separator::Byte(b','), Point));
        assert_eq!(style("1,5;2;3"), (Separator::Byte(b';'), Comma));
        assert_eq!(style("\"1,5\";2;3"), (Separator::Byte(b';'), Comma));
    }

    #[test]
    fn numbers_of_cells() {
        assert_eq!(number(b"\"1.5\"", Point), Some(1.5));
        assert_eq!(number(b"-1,5", Comma), Some(-1.5));
        assert_eq!(number(b"1,5", Point), None);
        assert_eq!(number(b"1,5,2", Comma), None);
        assert!(number(b"NA", Point).is_some_and(f64::is_nan));
        assert!(number(b"\"\"", Point).is_some_and(f64::is_nan));
        assert_eq!(number(b"tree", Point), None);
        assert_eq!(cells(b"1,\"oak, red\",2", Separator::Byte(b',')), [&b"1"[..], b"\"oak, red\"", b"2"]);
    }
}
