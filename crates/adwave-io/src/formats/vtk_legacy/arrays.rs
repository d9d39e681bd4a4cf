//! Values at points and cells.

use super::scanner::{ArrayType, Scanner};
use crate::model::field::unused;
use crate::text::words;
use crate::{Field, FieldValues, ReadError, ValueType};

/// Fields of the points or the cells.
pub(super) struct Values<'f> {
    pub(super) fields: &'f mut Vec<Field>,
    pub(super) n: u64,
    pub(super) extras: &'f mut Vec<String>,
}

impl Values<'_> {
    /// Reads an array with one row per point or cell.
    fn read(
        &mut self,
        file: &mut Scanner<'_>,
        name: &str,
        n_channels: u64,
        kind: ArrayType,
    ) -> Result<(), ReadError> {
        let n = self.n.saturating_mul(n_channels);
        let numbers = file.array(n, kind, &format!("array `{name}`"))?;
        let values = numbers.into_values(file.progress)?;
        self.push(name, n_channels as usize, values);
        Ok(())
    }

    fn push(&mut self, name: &str, n_channels: usize, values: FieldValues) {
        let name = unused(name, "_", |name| self.fields.iter().any(|f| f.name == name));
        self.fields.push(Field::new(name, n_channels, values));
    }

    /// Reads what an attribute's keyword announces; `false` where the keyword is none.
    pub(super) fn attribute(&mut self, file: &mut Scanner<'_>, keyword: &[u8]) -> Result<bool, ReadError> {
        let n_channels = match keyword {
            b"SCALARS" => {
                let name = file.name("the name of an array")?;
                let kind = file.array_type()?;
                // The number of components is optional.
                let before = file.at;
                let n = words(file.line()).next().and_then(crate::text::parse_u64).unwrap_or(1);
                let end_of_line = file.at;
                if file.pass("LOOKUP_TABLE") {
                    file.name("the name of a table of colors")?;
                } else {
                    // The line ends here; binary numbers follow.
                    file.at = if file.is_binary { end_of_line - 1 } else { end_of_line };
                    debug_assert!(file.at >= before);
                }
                self.read(file, &name, channels(file, n)?, kind)?;
                return Ok(true);
            }
            b"COLOR_SCALARS" => {
                let name = file.name("the name of an array")?;
                let n = file.count("the number of colors")?;
                self.colors(file, &name, channels(file, n)?)?;
                return Ok(true);
            }
            b"TEXTURE_COORDINATES" => {
                let name = file.name("the name of an array")?;
                let n = file.count("the number of texture coordinates")?;
                let kind = file.array_type()?;
                self.read(file, &name, channels(file, n)?, kind)?;
                return Ok(true);
            }
            b"VECTORS" | b"NORMALS" => 3,
            b"TENSORS" => 9,
            b"TENSORS6" => 6,
            b"GLOBAL_IDS" | b"PEDIGREE_IDS" | b"EDGE_FLAGS" => 1,
            _ => return Ok(false),
        };
        let name = file.name("the name of an array")?;
        let kind = file.array_type()?;
        if kind == ArrayType::Texts {
            skip_texts(file, self.n)?;
            self.extras.push(format!("array `{name}`, which has no numbers"));
        } else {
            self.read(file, &name, n_channels, kind)?;
        }
        Ok(true)
    }

    /// Reads colors: bytes, or in a text fractions of 255.
    fn colors(&mut self, file: &mut Scanner<'_>, name: &str, n_channels: u64) -> Result<(), ReadError> {
        if file.is_binary {
            return self.read(file, name, n_channels, ArrayType::Numbers(ValueType::U8));
        }
        let n = self.n.saturating_mul(n_channels);
        let shares = file.array(n, ArrayType::Numbers(ValueType::F64), &format!("array `{name}`"))?;
        let shares = shares.to_f64(file.progress)?;
        let values = if shares.iter().all(|x| (0.0..=1.0).contains(x)) {
            FieldValues::U8(shares.iter().map(|x| (255.0 * x).round() as u8).collect())
        } else {
            FieldValues::F64(shares)
        };
        self.push(name, n_channels as usize, values);
        Ok(())
    }

    /// Reads the arrays after `FIELD`; those without a row per point or cell are listed in the extras.
    pub(super) fn field_arrays(&mut self, file: &mut Scanner<'_>, is_of_rows: bool) -> Result<(), ReadError> {
        file.name("the name of the field")?;
        let n_arrays = file.count("the number of arrays")?;
        for _ in 0..n_arrays {
            file.progress.check()?;
            let name = file.name("the name of an array")?;
            if name == "NULL_ARRAY" {
                continue;
            }
            let n_channels = file.count("the number of components")?;
            let n_rows = file.count("the number of rows")?;
            let kind = file.array_type()?;
            if kind == ArrayType::Texts {
                skip_texts(file, n_channels.saturating_mul(n_rows))?;
                self.extras.push(format!("array `{name}`, which has no numbers"));
            } else if is_of_rows && n_rows == self.n && n_channels > 0 {
                self.read(file, &name, channels(file, n_channels)?, kind)?;
            } else {
                let n = n_channels.saturating_mul(n_rows);
                file.array(n, kind, &format!("array `{name}`"))?;
                self.extras.push(format!("field data `{name}`"));
            }
            skip_metadata(file);
        }
        Ok(())
    }
}

/// Checks the number of channels of a row.
fn channels(file: &Scanner<'_>, n: u64) -> Result<u64, ReadError> {
    if (1..=1 << 20).contains(&n) {
        return Ok(n);
    }
    Err(file.error(file.at, format!("arrays of {n} components are not supported; correct the number")))
}

/// Skips the metadata of an array in newer versions, up to the next blank line.
pub(super) fn skip_metadata(file: &mut Scanner<'_>) {
    if file.pass("METADATA") {
        file.line();
        while file.at < file.bytes.len() && !file.line().trim_ascii().is_empty() {}
    }
}

/// Skips texts: lines, or in binary files bytes after their number.
fn skip_texts(file: &mut Scanner<'_>, n: u64) -> Result<(), ReadError> {
    file.line();
    for _ in 0..n {
        file.progress.check()?;
        if file.at >= file.bytes.len() {
            return Err(file.error(file.at, "the file ends within an array of texts; get the whole file"));
        }
        if !file.is_binary {
            file.line();
            continue;
        }
        // The first two bits encode the number of bytes of the length.
        let width = match file.bytes[file.at] >> 6 {
            3 => 1,
            2 => 2,
            1 => 4,
            _ => 8,
        };
        let head = file.take(Some(width), "a text")?;
        let length = head.iter().fold(0_u64, |length, &byte| length << 8 | u64::from(byte));
        let length = length & (u64::MAX >> (64 - 8 * width + 2));
        file.take(usize::try_from(length).ok(), "a text")?;
    }
    Ok(())
}
