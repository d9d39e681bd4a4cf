//! Lines of a MatrixMarket coordinate matrix: banner, sizes and entries.

use std::io::BufRead;

use adwave::Progress;

use crate::progress::report_row;
use crate::text::stream::TextStream;
use crate::text::{parse_f64, parse_u64, show, words};
use crate::{Direction, ReadError};

/// An entry of a file.
pub(super) struct MatrixEntry {
    /// Row and column, from 0.
    pub(super) place: [u32; 2],
    /// Value; `None` in a pattern.
    pub(super) value: Option<f64>,
}

/// A matrix whose entries are to be read.
pub(super) struct MatrixLines<R> {
    pub(super) stream: TextStream<R>,
    /// True if entries have no values.
    pub(super) is_pattern: bool,
    /// Direction of the entries: both, if the matrix is symmetric and has one half in the file.
    pub(super) direction: Direction,
    pub(super) n_rows: u64,
    pub(super) n_columns: u64,
    /// Number of entries in the file.
    pub(super) n_entries: u64,
    /// Number of entries that were read.
    n_read: u64,
}

impl<R: BufRead> MatrixLines<R> {
    /// Reads the banner and the sizes.
    pub(super) fn new(mut stream: TextStream<R>) -> Result<Self, ReadError> {
        let banner = stream.next()?.unwrap_or_default().to_ascii_lowercase();
        let (is_pattern, direction) = parse_banner(&banner).map_err(|message| stream.wrong(message))?;
        let Some(line) = next_line(&mut stream)? else {
            return Err(stream.wrong("the line of sizes is missing; get the whole file"));
        };
        let sizes: Option<Vec<u64>> = words(line).map(parse_u64).collect();
        let Some([n_rows, n_columns, n_entries]) = sizes.and_then(|s| <[u64; 3]>::try_from(s).ok()) else {
            return Err(stream.wrong("the line of sizes must be: rows columns entries"));
        };
        Ok(Self { stream, is_pattern, direction, n_rows, n_columns, n_entries, n_read: 0 })
    }

    /// The next entry; `None` after the last.
    pub(super) fn next_entry(&mut self, progress: Progress<'_>) -> Result<Option<MatrixEntry>, ReadError> {
        let (entry, n_entries) = (self.n_read, self.n_entries);
        if entry == n_entries {
            return Ok(None);
        }
        report_row(progress, entry, n_entries)?;
        let Some(line) = next_line(&mut self.stream)? else {
            let message = format!("the file ends at entry {entry} of {n_entries}; get the whole file");
            return Err(self.stream.wrong(message));
        };
        self.n_read += 1;
        let parsed = parse_entry(line, [self.n_rows, self.n_columns], self.is_pattern);
        parsed.map(Some).map_err(|message| self.stream.wrong(message))
    }
}

/// True for a pattern, and the direction of entries, of a banner in lower case.
fn parse_banner(banner: &[u8]) -> Result<(bool, Direction), String> {
    let parts: Vec<&[u8]> = words(banner).collect();
    let [b"%%matrixmarket", b"matrix", b"coordinate", value, symmetry] = parts[..] else {
        return Err(
            "a matrix must begin with `%%MatrixMarket matrix coordinate`, then `real` or `pattern`, and \
                    `general` or `symmetric`; write it in coordinate form"
                .into(),
        );
    };
    let is_pattern = match value {
        b"pattern" => true,
        b"real" | b"integer" | b"double" => false,
        other => {
            return Err(format!("entries of kind {} cannot be weights; use real or pattern", show(other)));
        }
    };
    let direction = match symmetry {
        b"symmetric" => Direction::Both,
        b"general" => Direction::RowToColumn,
        other => return Err(format!("symmetry {} is not supported; use general or symmetric", show(other))),
    };
    Ok((is_pattern, direction))
}

/// Next line that is neither blank nor a comment.
fn next_line<R: BufRead>(stream: &mut TextStream<R>) -> Result<Option<&[u8]>, ReadError> {
    while let Some(line) = stream.next()? {
        if !line.is_empty() && line[0] != b'%' {
            return Ok(Some(stream.text()));
        }
    }
    Ok(None)
}

/// The entry of a line.
fn parse_entry(line: &[u8], sizes: [u64; 2], is_pattern: bool) -> Result<MatrixEntry, String> {
    let mut words = words(line);
    let mut place = [0; 2];
    for ((end, n), what) in place.iter_mut().zip(sizes).zip(["rows", "columns"]) {
        let word = words.next().unwrap_or(b"");
        let index = parse_u64(word).filter(|i| (1..=n).contains(i)).and_then(|i| u32::try_from(i - 1).ok());
        *end = index.ok_or_else(|| {
            let what = if sizes[0] == sizes[1] { "rows and columns" } else { what };
            format!("{what} must be in 1..={n}, got {}; correct it", show(word))
        })?;
    }
    if is_pattern {
        return Ok(MatrixEntry { place, value: None });
    }
    let word = words.next().unwrap_or(b"");
    match parse_f64(word) {
        Some(value) => Ok(MatrixEntry { place, value: Some(value) }),
        None => Err(format!("a weight must be a number, got {}; correct it", show(word))),
    }
}
