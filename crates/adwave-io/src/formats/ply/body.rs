//! Value-by-value parser of the rows of a PLY.

use adwave::Progress;

use crate::formats::ply::header::{Element, Encoding, PropertyKind};
use crate::model::field::ByteOrder;
use crate::text::{Words, parse_f32, parse_f64, show};
use crate::{FieldValues, ReadError, ValueType};

/// Read position in the body.
pub(crate) struct PlyBody<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) position: usize,
    pub(crate) encoding: Encoding,
    /// Handle checked by the loops over rows.
    pub(crate) progress: Progress<'a>,
}

impl<'a> PlyBody<'a> {
    /// Fails early if the element's rows do not fit the remaining bytes.
    pub(crate) fn check_size(&self, element: &Element) -> Result<(), ReadError> {
        let row_bytes = element.min_row_bytes(self.encoding);
        if row_bytes == 0 {
            return Ok(());
        }
        let mut remaining = (self.bytes.len() - self.position) as u64;
        if self.encoding == Encoding::Ascii {
            // The last value needs no separator.
            remaining += 1;
        }
        if remaining / row_bytes >= element.n_rows {
            return Ok(());
        }
        Err(ReadError::Truncated {
            end: self.bytes.len() as u64,
            needed: (self.position as u64).saturating_add(element.n_rows.saturating_mul(row_bytes)),
            element: element.name.clone(),
            row: remaining / row_bytes,
        })
    }

    fn truncated(&self, element: &Element, row: u64, n: u64) -> ReadError {
        ReadError::Truncated {
            end: self.bytes.len() as u64,
            needed: (self.position as u64).saturating_add(n),
            element: element.name.clone(),
            row,
        }
    }

    fn take(&mut self, n: usize, element: &Element, row: u64) -> Result<&'a [u8], ReadError> {
        if self.bytes.len() - self.position < n {
            return Err(self.truncated(element, row, n as u64));
        }
        let taken = &self.bytes[self.position..self.position + n];
        self.position += n;
        Ok(taken)
    }

    fn word(&mut self, element: &Element, row: u64) -> Result<(usize, &'a [u8]), ReadError> {
        let mut words = Words::new(self.bytes, self.position);
        let word = words.next();
        self.position = words.position;
        word.ok_or_else(|| self.truncated(element, row, 1))
    }

    /// Reads one number into a list of its type.
    pub(crate) fn read_into(
        &mut self,
        column: &mut FieldValues,
        element: &Element,
        row: u64,
    ) -> Result<(), ReadError> {
        match self.encoding {
            Encoding::Binary(order) => {
                let n = column.value_type().n_bytes();
                let bytes = self.take(n, element, row)?;
                column.push_bytes(bytes, order);
            }
            Encoding::Ascii => {
                let (position, word) = self.word(element, row)?;
                let value_type = column.value_type();
                let fits = match column {
                    FieldValues::F32(v) => parse_f32(word).map(|x| v.push(x)).is_some(),
                    other => parse_f64(word).is_some_and(|x| other.push_f64(x)),
                };
                if !fits {
                    return Err(self.not_a(value_type, position, word, element, row));
                }
            }
        }
        Ok(())
    }

    fn not_a(&self, t: ValueType, position: usize, word: &[u8], element: &Element, row: u64) -> ReadError {
        let kind = crate::formats::ply::header::type_name(t);
        let name = &element.name;
        let message =
            format!("expected a {kind}, got {} (element `{name}`, row {row}); correct it", show(word));
        ReadError::line_error(self.bytes, position, message)
    }

    /// Reads one integer.
    pub(crate) fn read_integer(
        &mut self,
        t: ValueType,
        element: &Element,
        row: u64,
    ) -> Result<i64, ReadError> {
        match self.encoding {
            Encoding::Binary(order) => {
                let bytes = self.take(t.n_bytes(), element, row)?;
                Ok(integer(t, bytes, order).unwrap_or(i64::MAX))
            }
            Encoding::Ascii => {
                let (position, word) = self.word(element, row)?;
                let whole = |x: f64| (x.fract() == 0.0 && x.abs() < 9e15).then_some(x as i64);
                parse_f64(word).and_then(whole).ok_or_else(|| self.not_a(t, position, word, element, row))
            }
        }
    }

    /// Reads the length of a list and checks its size against the remaining bytes.
    fn read_count(
        &mut self,
        kind: PropertyKind,
        element: &Element,
        row: u64,
    ) -> Result<(usize, ValueType), ReadError> {
        let PropertyKind::List { count, item } = kind else { return Ok((1, ValueType::F64)) };
        let start = self.position;
        let n = self.read_integer(count, element, row)?;
        let Ok(n) = u64::try_from(n) else {
            let name = &element.name;
            let message = format!(
                "the length of a list is invalid: {n} (element `{name}`, row {row}); \
                                  correct it"
            );
            return Err(match self.encoding {
                Encoding::Ascii => ReadError::line_error(self.bytes, start, message),
                Encoding::Binary(_) => ReadError::byte_error(start, message),
            });
        };
        let size = if self.encoding == Encoding::Ascii { 2 } else { item.n_bytes() as u64 };
        let needed = n.saturating_mul(size);
        let slack = u64::from(self.encoding == Encoding::Ascii);
        if needed > (self.bytes.len() - self.position) as u64 + slack {
            return Err(self.truncated(element, row, needed));
        }
        Ok((n as usize, item))
    }

    /// Reads a list of integers.
    pub(crate) fn read_list(
        &mut self,
        kind: PropertyKind,
        element: &Element,
        row: u64,
        list: &mut Vec<i64>,
    ) -> Result<(), ReadError> {
        list.clear();
        if let PropertyKind::Scalar(_) = kind {
            return self.skip(kind, element, row);
        }
        let (n, item) = self.read_count(kind, element, row)?;
        for _ in 0..n {
            list.push(self.read_integer(item, element, row)?);
        }
        Ok(())
    }

    /// Reads a list of floats into `list`.
    pub(crate) fn read_floats(
        &mut self,
        kind: PropertyKind,
        element: &Element,
        row: u64,
        list: &mut Vec<f64>,
    ) -> Result<(), ReadError> {
        let (n, item) = self.read_count(kind, element, row)?;
        let mut values = item.empty();
        for _ in 0..n {
            self.read_into(&mut values, element, row)?;
        }
        list.clear();
        list.extend(values.to_f64());
        Ok(())
    }

    /// Skips one value or list.
    pub(crate) fn skip(&mut self, kind: PropertyKind, element: &Element, row: u64) -> Result<(), ReadError> {
        let (n, item) = match kind {
            PropertyKind::Scalar(t) => (1, t),
            PropertyKind::List { .. } => self.read_count(kind, element, row)?,
        };
        if let Encoding::Binary(_) = self.encoding {
            self.take(n * item.n_bytes(), element, row)?;
        } else {
            for _ in 0..n {
                self.word(element, row)?;
            }
        }
        Ok(())
    }

    /// Skips one row.
    pub(crate) fn skip_row(&mut self, element: &Element, row: u64) -> Result<(), ReadError> {
        element.properties.iter().try_for_each(|p| self.skip(p.kind, element, row))
    }
}

/// Decodes an integer; `None` for a number with a fraction.
fn integer(t: ValueType, bytes: &[u8], order: ByteOrder) -> Option<i64> {
    let mut one = t.empty();
    one.push_bytes(bytes, order);
    let x = one.get(0);
    (x.fract() == 0.0 && x.abs() < 9e15).then_some(x as i64)
}
