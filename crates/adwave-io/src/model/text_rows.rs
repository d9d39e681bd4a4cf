//! Texts with one row of values per vertex, kept so that they can be written again: only the coordinates that changed
//! are replaced, everything else is copied.

use std::ops::Range;

use crate::progress::report_row;
use crate::text::tokens::Tokens;
use crate::text::{is_blank, is_space, parse_f32, parse_f64, push_f32, push_f64};
use crate::{CoordinatePrecision, ShapeFile, WriteError};
use adwave::Progress;

/// Separator of the values in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    /// Any number of blanks.
    Blanks,
    /// Blanks; a `#` ends the row even directly after a value.
    BlanksUntilRemark,
    /// This byte, once; blanks may surround the values.
    Byte(u8),
    /// Blanks, line ends and comments; only the first three values are read.
    OverLines,
}

/// Character between the integer and the fraction of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum DecimalMark {
    /// `1.5`.
    #[default]
    Point,
    /// `1,5`, as many European programs write.
    Comma,
}

/// Text with a row of values for every vertex.
#[derive(Debug)]
pub(crate) struct TextRows {
    pub(crate) bytes: Vec<u8>,
    /// Start of the first value of each vertex's row, ascending.
    pub(crate) rows: Vec<u64>,
    /// Positions of x, y and z in the row.
    pub(crate) columns: [usize; 3],
    pub(crate) separator: Separator,
    /// Decimal mark of the values.
    pub(crate) decimal: DecimalMark,
    /// Range of the line of names without the line end, if new columns need a name there.
    pub(crate) names: Option<(usize, usize)>,
}

/// Function that writes values at the end of a row.
pub(crate) type Append<'a> = dyn Fn(usize, &mut Vec<u8>) + 'a;

/// Changes of the rows besides the coordinates.
#[derive(Default)]
pub(crate) struct RowEdit<'a> {
    /// Positions in the row that are dropped.
    pub(crate) dropped: &'a [usize],
    /// Writes the additions at the end of row `i`, with the separators before each value.
    pub(crate) append: Option<&'a Append<'a>>,
}

/// Formats a value for a text file of that precision.
pub(crate) fn push_coordinate(out: &mut Vec<u8>, x: f64, precision: CoordinatePrecision) {
    match precision {
        CoordinatePrecision::F32 => push_f32(out, x as f32),
        CoordinatePrecision::F64 => push_f64(out, x),
    }
}

/// Length of the first cell of a row whose cells are separated by a byte. Quotes protect separators if they enclose the
/// whole cell.
pub(crate) fn cell_length(row: &[u8], separator: u8) -> usize {
    let plain = || row.iter().position(|&b| b == separator).unwrap_or(row.len());
    if row.first() != Some(&b'"') {
        return plain();
    }
    let Some(closing) = row[1..].iter().position(|&b| b == b'"') else { return plain() };
    let after = closing + 2;
    let n_blanks = row[after..].iter().take_while(|&&b| is_blank(b) && b != separator).count();
    match row.get(after + n_blanks) {
        Some(&b) if b != separator => plain(),
        _ => after + n_blanks,
    }
}

fn is_same(word: &[u8], x: f64, precision: CoordinatePrecision) -> bool {
    let old = match precision {
        CoordinatePrecision::F32 => parse_f32(word).map(f64::from),
        CoordinatePrecision::F64 => parse_f64(word),
    };
    old.is_some_and(|old| old.to_bits() == x.to_bits() || (old.is_nan() && x.is_nan()))
}

impl TextRows {
    /// True if a word of the text is this number.
    fn is_same(&self, word: &[u8], x: f64, precision: CoordinatePrecision) -> bool {
        if is_same(word, x, precision) {
            return true;
        }
        let inner = word.trim_ascii();
        let inner = inner.strip_prefix(b"\"").and_then(|word| word.strip_suffix(b"\"")).unwrap_or(inner);
        match self.decimal {
            DecimalMark::Point => is_same(inner, x, precision),
            DecimalMark::Comma => {
                let with_point: Vec<u8> = inner.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
                is_same(&with_point, x, precision)
            }
        }
    }

    /// Writes a number with the decimal mark of the text.
    pub(crate) fn push_number(&self, out: &mut Vec<u8>, x: f64, precision: CoordinatePrecision) {
        let start = out.len();
        push_coordinate(out, x, precision);
        if self.decimal == DecimalMark::Comma {
            out[start..].iter_mut().filter(|b| **b == b'.').for_each(|b| *b = b',');
        }
    }

    /// Writes the whole original with changed rows.
    pub(crate) fn write_all(
        &self,
        shape: &ShapeFile,
        edit: &RowEdit<'_>,
        out: &mut dyn std::io::Write,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        self.write_range(0..self.bytes.len(), shape, edit, out, progress)
    }

    /// Writes these bytes of the original with the rows in it changed.
    pub(crate) fn write_range(
        &self,
        range: Range<usize>,
        shape: &ShapeFile,
        edit: &RowEdit<'_>,
        out: &mut dyn std::io::Write,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        const FLUSH: usize = 1 << 18;
        let mut buffer = Vec::with_capacity(FLUSH + 1024);
        let mut copied = range.start;
        for (i, &row) in self.rows.iter().enumerate() {
            report_row(progress, i as u64, self.rows.len() as u64)?;
            let row = row as usize;
            self.copy(copied, row, &mut buffer, out)?;
            copied = self.write_row(row, i, shape, edit, &mut buffer);
            if buffer.len() > FLUSH {
                out.write_all(&buffer)?;
                buffer.clear();
            }
        }
        self.copy(copied, range.end, &mut buffer, out)?;
        Ok(out.write_all(&buffer)?)
    }

    /// Copies original bytes: short ranges through the buffer, long ones directly.
    fn copy(
        &self,
        from: usize,
        to: usize,
        buffer: &mut Vec<u8>,
        out: &mut dyn std::io::Write,
    ) -> std::io::Result<()> {
        let part = &self.bytes[from..to.max(from)];
        if part.len() > 1 << 16 {
            out.write_all(buffer)?;
            buffer.clear();
            out.write_all(part)
        } else {
            buffer.extend_from_slice(part);
            Ok(())
        }
    }

    /// Writes row `i`, which begins at `start`, and returns the position after its last value.
    fn write_row(
        &self,
        start: usize,
        i: usize,
        shape: &ShapeFile,
        edit: &RowEdit<'_>,
        out: &mut Vec<u8>,
    ) -> usize {
        let mut copied = start;
        let mut position = start;
        let mut column = 0;
        while let Some((begin, end)) = self.next_value(position, column) {
            if let Some(axis) = self.columns.iter().position(|&c| c == column) {
                let x = shape.points[i][axis];
                out.extend_from_slice(&self.bytes[copied..begin]);
                if self.is_same(&self.bytes[begin..end], x, shape.precision) {
                    out.extend_from_slice(&self.bytes[begin..end]);
                } else {
                    self.push_number(out, x, shape.precision);
                }
            } else if !edit.dropped.contains(&column) {
                out.extend_from_slice(&self.bytes[copied..end]);
            }
            copied = end;
            position = end;
            column += 1;
        }
        if let Some(append) = edit.append {
            append(i, out);
        }
        copied
    }

    /// Range of the value at or after `position`, or `None` at the end of the row.
    fn next_value(&self, position: usize, column: usize) -> Option<(usize, usize)> {
        let bytes = &self.bytes;
        let mut begin = position;
        match self.separator {
            Separator::OverLines => {
                if column > 2 {
                    return None;
                }
                let mut tokens = Tokens::new(bytes, begin);
                tokens.next().map(|(begin, word)| (begin, begin + word.len()))
            }
            Separator::Byte(separator) => {
                if column > 0 {
                    if bytes.get(begin) != Some(&separator) {
                        return None;
                    }
                    begin += 1;
                }
                while bytes.get(begin).is_some_and(|&b| is_blank(b) && b != separator) {
                    begin += 1;
                }
                let is_end = |b: u8| b == b'\n' || b == b'\r';
                let line = bytes[begin..].iter().position(|&b| is_end(b)).map_or(bytes.len(), |n| begin + n);
                let end = begin + cell_length(&bytes[begin..line], separator);
                if column > 0 || end > begin { Some((begin, end)) } else { None }
            }
            Separator::Blanks | Separator::BlanksUntilRemark => {
                loop {
                    match bytes.get(begin) {
                        Some(b'\\') => {
                            // The end of a continued line counts as a blank.
                            begin += 1;
                            while bytes.get(begin) == Some(&b'\r') {
                                begin += 1;
                            }
                            begin += usize::from(bytes.get(begin) == Some(&b'\n'));
                        }
                        Some(&b) if is_blank(b) => begin += 1,
                        Some(b'\n' | b'#') | None => return None,
                        Some(_) => break,
                    }
                }
                // In other formats the sign may be part of a number: `1.#INF`.
                let is_remark = |b: u8| b == b'#' && self.separator == Separator::BlanksUntilRemark;
                let stop = |b: u8| is_space(b) || b == b'\\' || is_remark(b);
                let end = bytes[begin..].iter().position(|&b| stop(b)).map_or(bytes.len(), |n| begin + n);
                Some((begin, end))
            }
        }
    }
}
