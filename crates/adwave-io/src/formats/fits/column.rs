//! Columns of a binary table of FITS: their types, and the numbers in them.

use crate::ReadError;
use crate::formats::fits::UNSEEN;
use crate::formats::fits::header::{MAX_COLUMNS, Unit};
use crate::model::field::{ByteOrder, Number};
use crate::{FieldValues, ValueType};

/// Relative distance from UNSEEN within which a number is UNSEEN: rounding to 32 bits.
const ROUNDING: f64 = 1e-5;

/// A column with its place in a row.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Name, or `column 3`.
    pub(super) name: String,
    /// Unit of the values; empty if the file states none.
    pub(super) unit: String,
    /// Type of the numbers; `None` for texts, bits, complex numbers and references.
    pub(super) kind: Option<ValueType>,
    /// Number of values in a row.
    pub(super) repeat: usize,
    /// Byte of a row at which the values begin.
    pub(super) offset: usize,
    /// Values are `zero + scale·number`.
    scale: f64,
    zero: f64,
    /// Integer in place of an unknown value.
    null: Option<i64>,
    /// Number in place of an unknown value, beside UNSEEN.
    bad: Option<f64>,
}

/// Number of bytes of one value, and the type if it is a plain number; `None` for an unknown letter.
fn letter_of_type(letter: u8) -> Option<(usize, Option<ValueType>)> {
    Some(match letter {
        b'L' | b'A' => (1, None),
        b'B' => (1, Some(ValueType::U8)),
        b'I' => (2, Some(ValueType::I16)),
        b'J' => (4, Some(ValueType::I32)),
        b'K' => (8, Some(ValueType::I64)),
        b'E' => (4, Some(ValueType::F32)),
        b'D' => (8, Some(ValueType::F64)),
        b'C' | b'P' => (8, None),
        b'M' | b'Q' => (16, None),
        _ => return None,
    })
}

/// Columns of a table, whose bytes must fill its rows.
pub(super) fn columns(unit: &Unit) -> Result<Vec<Column>, ReadError> {
    let count = |key: &str, most: u64| -> Result<usize, ReadError> {
        let found = unit.integer(key)?.and_then(|n| u64::try_from(n).ok()).filter(|n| *n <= most);
        found.map(|n| n as usize).ok_or_else(|| unit.wrong(key, &format!("a whole number from 0 to {most}")))
    };
    let row_bytes = count("NAXIS1", u64::from(u32::MAX))?;
    let (mut offset, mut columns) = (0_usize, Vec::new());
    for k in 1..=count("TFIELDS", MAX_COLUMNS)? {
        let key = format!("TFORM{k}");
        let form = unit.text(&key).unwrap_or_default();
        let wrong = || unit.wrong(&key, "a number and a letter of a type, such as 1024E");
        let n_digits = form.bytes().take_while(u8::is_ascii_digit).count();
        let repeat: usize = if n_digits == 0 { 1 } else { form[..n_digits].parse().map_err(|_| wrong())? };
        let letter = *form.as_bytes().get(n_digits).ok_or_else(wrong)?;
        let (n_bytes, kind) = if letter == b'X' {
            (repeat.div_ceil(8), None)
        } else {
            let (bytes, kind) = letter_of_type(letter).ok_or_else(wrong)?;
            (bytes.saturating_mul(repeat), kind)
        };
        let named = unit.text(&format!("TTYPE{k}")).filter(|name| !name.is_empty());
        columns.push(Column {
            name: named.unwrap_or_else(|| format!("column {k}")),
            unit: unit.text(&format!("TUNIT{k}")).unwrap_or_default(),
            kind: kind.filter(|_| repeat > 0),
            repeat,
            offset,
            scale: unit.number(&format!("TSCAL{k}"))?.unwrap_or(1.0),
            zero: unit.number(&format!("TZERO{k}"))?.unwrap_or(0.0),
            null: unit.integer(&format!("TNULL{k}"))?,
            bad: unit.number("BAD_DATA")?,
        });
        offset = offset.saturating_add(n_bytes);
    }
    if offset != row_bytes {
        let message = format!("the columns of the table fill {offset} bytes of a row");
        return Err(unit.wrong("NAXIS1", &format!("{offset}, since {message}")));
    }
    Ok(columns)
}

impl Column {
    /// True if numbers are not the values themselves.
    fn is_scaled(&self) -> bool {
        self.scale != 1.0 || self.zero != 0.0
    }

    /// Number of bytes of a value of a column of numbers.
    fn n_bytes(&self) -> usize {
        self.kind.map_or(0, ValueType::n_bytes)
    }

    /// Byte of value `k` of the column, from the first row on.
    fn place(&self, k: usize, row_bytes: usize) -> usize {
        k / self.repeat * row_bytes + self.offset + k % self.repeat * self.n_bytes()
    }

    /// True if a number stands for an unknown value.
    fn is_unknown(&self, number: f64) -> bool {
        let is = |bad: f64| (number - bad).abs() <= ROUNDING * bad.abs();
        is(UNSEEN) || self.bad.is_some_and(is)
    }

    /// All values of a column of numbers, in the number type of the file; unknown ones are NaN, for which integers
    /// become 64-bit floats, as do scaled numbers.
    pub(super) fn values(&self, data: &[u8], row_bytes: usize, n: usize) -> FieldValues {
        let kind = self.kind.unwrap_or(ValueType::F64);
        let is_null = |number: i64| self.null == Some(number);
        if kind.is_integer() {
            let has_null =
                self.null.is_some() && (0..n).any(|k| is_null(self.integer(data, self.place(k, row_bytes))));
            if !has_null && !self.is_scaled() {
                return self.plain_values(kind, data, row_bytes, n);
            }
            let value = |k: usize| match self.integer(data, self.place(k, row_bytes)) {
                number if is_null(number) => f64::NAN,
                number => self.zero + self.scale * number as f64,
            };
            return FieldValues::F64((0..n).map(value).collect());
        }
        match self.plain_values(kind, data, row_bytes, n) {
            FieldValues::F32(mut values) if !self.is_scaled() => {
                for value in values.iter_mut().filter(|value| self.is_unknown(f64::from(**value))) {
                    *value = f32::NAN;
                }
                FieldValues::F32(values)
            }
            values => {
                let value = |x: f64| if self.is_unknown(x) { f64::NAN } else { self.zero + self.scale * x };
                FieldValues::F64(values.to_f64().into_iter().map(value).collect())
            }
        }
    }

    fn plain_values(&self, kind: ValueType, data: &[u8], row_bytes: usize, n: usize) -> FieldValues {
        let mut values = kind.empty();
        let bytes = |k: usize| &data[self.place(k, row_bytes)..];
        crate::model::field::with_values!(&mut values, v => {
            for k in 0..n {
                v.push(Number::from_bytes(bytes(k), ByteOrder::Big));
            }
        });
        values
    }

    /// Whole number at a byte of a column of integers.
    fn integer(&self, data: &[u8], at: usize) -> i64 {
        match self.kind {
            Some(ValueType::U8) => data[at].into(),
            Some(ValueType::I16) => i16::from_bytes(&data[at..], ByteOrder::Big).into(),
            Some(ValueType::I32) => i32::from_bytes(&data[at..], ByteOrder::Big).into(),
            _ => i64::from_bytes(&data[at..], ByteOrder::Big),
        }
    }

    /// Numbers of pixels of a column of integers; negative ones are beyond every map.
    pub(super) fn pixel_numbers(&self, data: &[u8], row_bytes: usize, n: usize) -> Vec<u64> {
        let number = |k: usize| self.integer(data, self.place(k, row_bytes));
        (0..n).map(|k| u64::try_from(number(k)).unwrap_or(u64::MAX)).collect()
    }

    /// Replaces value `k` of the column. A NaN keeps a number that stands for an unknown value already.
    ///
    /// Returns false if the number type cannot hold the value: a fraction or a NaN among integers.
    pub(super) fn put(&self, data: &mut [u8], row_bytes: usize, k: usize, value: f64) -> bool {
        let Some(kind) = self.kind else { return false };
        let at = self.place(k, row_bytes);
        let mut number = (value - self.zero) / self.scale;
        if value.is_nan() {
            let is_unknown_already = if kind.is_integer() {
                self.null == Some(self.integer(data, at))
            } else {
                let old = self.float(data, at);
                old.is_nan() || self.is_unknown(old)
            };
            if is_unknown_already {
                return true;
            }
            match (kind.is_integer(), self.null) {
                (true, None) => return false,
                (true, Some(null)) => number = null as f64,
                (false, _) => number = UNSEEN,
            }
        }
        let mut bytes = Vec::with_capacity(8);
        let mut own = kind.empty();
        let is_held = crate::model::field::with_values!(&mut own, v => {
            v.push(Number::from_f64(number));
            v[0].write_bytes(ByteOrder::Big, &mut bytes);
            !kind.is_integer() || own.get(0) == number
        });
        if is_held {
            data[at..at + bytes.len()].copy_from_slice(&bytes);
        }
        is_held
    }

    /// Number at a byte of a column of floats.
    fn float(&self, data: &[u8], at: usize) -> f64 {
        match self.kind {
            Some(ValueType::F32) => f32::from_bytes(&data[at..], ByteOrder::Big).into(),
            _ => f64::from_bytes(&data[at..], ByteOrder::Big),
        }
    }
}
