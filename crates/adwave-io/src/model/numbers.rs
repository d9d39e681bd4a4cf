//! Arrays of numbers in files: bytes in a byte order, or decimals.

use crate::ShapeFile;
use std::borrow::Cow;
use std::ops::Range;

use adwave::{Cancelled, Progress};
use rayon::prelude::*;

use crate::model::field::{ByteOrder, Number, with_values};
use crate::progress::{BYTES_PER_STEP, all, collect, extend};
use crate::text::{is_space, parse_f32, parse_f64, show};
use crate::{Field, FieldValues, ValueType};

/// Numbers of one type: bytes that are decoded on demand without a copy, or values.
#[derive(Clone, Debug)]
pub(crate) enum Numbers<'a> {
    /// Encoded numbers; an incomplete one at the end is ignored.
    Bytes { bytes: Cow<'a, [u8]>, kind: ValueType, order: ByteOrder },
    /// Values parsed from a text.
    Values(FieldValues),
}

/// Reasons for which numbers are not indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum IndexError {
    Cancelled,
    /// A number has a fraction.
    Fractions,
    /// The number at a position is negative or too large.
    At(usize, f64),
}

impl From<Cancelled> for IndexError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl Numbers<'_> {
    /// Number of values.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Bytes { bytes, kind, .. } => bytes.len() / kind.n_bytes(),
            Self::Values(values) => values.len(),
        }
    }

    pub(crate) fn kind(&self) -> ValueType {
        match self {
            Self::Bytes { kind, .. } => *kind,
            Self::Values(values) => values.value_type(),
        }
    }

    /// Number `i`, rounded to 64 bits.
    pub(crate) fn get(&self, i: usize) -> f64 {
        match self {
            Self::Bytes { bytes, kind, order } => {
                let mut one = kind.empty();
                one.push_bytes(&bytes[i * kind.n_bytes()..], *order);
                one.get(0)
            }
            Self::Values(values) => values.get(i),
        }
    }

    pub(crate) fn into_values(self, progress: Progress<'_>) -> Result<FieldValues, Cancelled> {
        match self {
            Self::Bytes { bytes, kind, order } => from_bytes(&bytes, kind, order, progress),
            Self::Values(values) => Ok(values),
        }
    }

    /// Converts all numbers to `f64`.
    pub(crate) fn to_f64(&self, progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        match self {
            Self::Bytes { bytes, kind: ValueType::F32, order } => {
                collect(self.len(), progress, |i| f32::from_bytes(&bytes[4 * i..], *order).into())
            }
            Self::Bytes { bytes, kind: ValueType::F64, order } => {
                collect(self.len(), progress, |i| f64::from_bytes(&bytes[8 * i..], *order))
            }
            _ => collect(self.len(), progress, |i| self.get(i)),
        }
    }

    /// Converts to triples of coordinates.
    pub(crate) fn to_points(&self, progress: Progress<'_>) -> Result<Vec<[f64; 3]>, Cancelled> {
        let n = self.len() / 3;
        match self {
            Self::Bytes { bytes, kind: ValueType::F32, order } => collect(n, progress, |i| {
                [0, 4, 8].map(|k| f32::from_bytes(&bytes[12 * i + k..], *order).into())
            }),
            Self::Bytes { bytes, kind: ValueType::F64, order } => {
                collect(n, progress, |i| [0, 8, 16].map(|k| f64::from_bytes(&bytes[24 * i + k..], *order)))
            }
            Self::Values(FieldValues::F32(v)) => {
                collect(n, progress, |i| [0, 1, 2].map(|k| v[3 * i + k].into()))
            }
            _ => collect(n, progress, |i| [0, 1, 2].map(|k| self.get(3 * i + k))),
        }
    }

    /// Converts to integers below `limit`.
    pub(crate) fn to_indices(&self, limit: u32, progress: Progress<'_>) -> Result<Vec<u32>, IndexError> {
        let indices = match self {
            Self::Bytes { bytes, kind, order } => {
                let (n, order) = (self.len(), *order);
                match kind {
                    ValueType::U32 => indices::<u32>(bytes, n, order, progress),
                    ValueType::I32 => indices::<i32>(bytes, n, order, progress),
                    ValueType::U64 => indices::<u64>(bytes, n, order, progress),
                    ValueType::I64 => indices::<i64>(bytes, n, order, progress),
                    _ if kind.is_integer() => collect(n, progress, |i| to_index(self.get(i))),
                    _ => return Err(IndexError::Fractions),
                }
            }
            Self::Values(FieldValues::F32(_) | FieldValues::F64(_)) => return Err(IndexError::Fractions),
            Self::Values(values) => collect(values.len(), progress, |i| to_index(values.get(i))),
        }?;
        // No list is long enough for the largest number as an index, so it marks invalid ones.
        let is_index = |i: usize| indices[i] < limit;
        if all(indices.len(), progress, is_index)? {
            return Ok(indices);
        }
        let at = indices.iter().position(|&i| i >= limit).unwrap_or(0);
        Err(IndexError::At(at, self.get(at)))
    }
}

/// Converts a number to an index; the largest index if it is invalid.
fn to_index(x: f64) -> u32 {
    if (0.0..f64::from(u32::MAX)).contains(&x) { x as u32 } else { u32::MAX }
}

fn indices<T: Number + TryInto<u32>>(
    bytes: &[u8],
    n: usize,
    order: ByteOrder,
    progress: Progress<'_>,
) -> Result<Vec<u32>, Cancelled> {
    let index = |i: usize| T::from_bytes(&bytes[i * size_of::<T>()..], order).try_into().unwrap_or(u32::MAX);
    collect(n, progress, index)
}

/// Decodes all complete numbers in the bytes.
pub(crate) fn from_bytes(
    bytes: &[u8],
    kind: ValueType,
    order: ByteOrder,
    progress: Progress<'_>,
) -> Result<FieldValues, Cancelled> {
    let (mut values, width) = (kind.empty(), kind.n_bytes());
    with_values!(&mut values, v => extend(v, bytes.len() / width, progress, |i| {
        Number::from_bytes(&bytes[i * width..], order)
    }))?;
    Ok(values)
}

/// Collects rows of `values`, which have `n_channels` numbers each: row `i` of the result is row `row(i)`. (`row` is
/// a `dyn` function, so that the code is not compiled for each caller and type.)
pub(crate) fn collect_rows(
    field: &Field,
    n: usize,
    progress: Progress<'_>,
    row: &(dyn Fn(usize) -> usize + Sync),
) -> Result<Field, Cancelled> {
    let k = field.n_channels;
    let mut values = field.values.value_type().empty();
    macro_rules! gather {
        ($($variant:ident)*) => {
            match (&field.values, &mut values) {
                $((FieldValues::$variant(old), FieldValues::$variant(new)) => {
                    extend(new, n * k, progress, |i| old[row(i / k) * k + i % k])?;
                })*
                _ => {}
            }
        };
    }
    gather!(U8 I8 U16 I16 U32 I32 U64 I64 F32 F64);
    Ok(Field::new(field.name.clone(), k, values))
}

/// Shifts the rows of a field behind `n` rows without a value: NaN, or zero for integers.
pub(crate) fn filled(field: &Field, n: usize) -> Field {
    let n = n * field.n_channels;
    macro_rules! fill {
        ($($variant:ident: $nothing:expr),*) => {
            match &field.values {
                $(FieldValues::$variant(values) => {
                    let mut all = vec![$nothing; n];
                    all.extend_from_slice(values);
                    FieldValues::$variant(all)
                })*
            }
        };
    }
    let values =
        fill!(U8: 0, I8: 0, U16: 0, I16: 0, U32: 0, I32: 0, U64: 0, I64: 0, F32: f32::NAN, F64: f64::NAN);
    Field { name: field.name.clone(), values, labels: field.labels.clone(), ..*field }
}

/// Appends a list of the same type; returns `false` if the types differ.
pub(crate) fn append(values: &mut FieldValues, more: FieldValues) -> bool {
    macro_rules! append {
        ($($variant:ident)*) => {
            match (values, more) {
                $((FieldValues::$variant(values), FieldValues::$variant(more)) => {
                    values.extend(more);
                    true
                })*
                _ => false,
            }
        };
    }
    append!(U8 I8 U16 I16 U32 I32 U64 I64 F32 F64)
}

/// Reasons for which a text has no numbers.
#[derive(Debug)]
pub(crate) enum NumberError {
    Cancelled(Cancelled),
    /// The word at this byte of the text is not a number of the type.
    At(usize, String),
}

impl From<Cancelled> for NumberError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

/// End of the text with `n` words from `start`; the error has the number of words found.
pub(crate) fn end_of_words(
    text: &[u8],
    start: usize,
    n: usize,
    progress: Progress<'_>,
) -> Result<Result<usize, usize>, Cancelled> {
    let (mut at, mut found) = (start, 0);
    while found < n {
        if found.is_multiple_of(1 << 16) {
            progress.check()?;
        }
        while text.get(at).is_some_and(|&b| is_space(b)) {
            at += 1;
        }
        if at >= text.len() {
            return Ok(Err(found));
        }
        while text.get(at).is_some_and(|&b| !is_space(b)) {
            at += 1;
        }
        found += 1;
    }
    Ok(Ok(at))
}

/// Parses a text of numbers on all threads.
pub(crate) fn from_text(
    text: &[u8],
    kind: ValueType,
    progress: Progress<'_>,
) -> Result<FieldValues, NumberError> {
    let parts = parts(text);
    let parse = |part: &Range<usize>| -> Result<FieldValues, NumberError> {
        progress.check()?;
        let mut values = kind.empty();
        with_values!(&mut values, v => parse_words(&text[part.clone()], v))
            .map_err(|(at, message)| NumberError::At(part.start + at, message))?;
        Ok(values)
    };
    if let [one] = &parts[..] {
        progress.step(0, text.len() as u64)?;
        return parse(one);
    }
    let mut values = kind.empty();
    // The first failure in the order of the text is reported.
    for some in parts.chunks(8) {
        progress.step(some[0].start as u64, text.len() as u64)?;
        let lists: Vec<_> = some.par_iter().map(parse).collect();
        for list in lists {
            append(&mut values, list?);
        }
    }
    Ok(values)
}

/// Parses the numbers of a text; the error has the position and the text of the invalid word.
fn parse_words<T: TextNumber>(text: &[u8], values: &mut Vec<T>) -> Result<(), (usize, String)> {
    for word in text.split(|&b| is_space(b)).filter(|word| !word.is_empty()) {
        values.push(T::from_word(word).ok_or_else(|| {
            let at = word.as_ptr() as usize - text.as_ptr() as usize;
            (at, format!("expected a number, got {}", show(word)))
        })?);
    }
    Ok(())
}

/// Splits a text into parts between words.
fn parts(text: &[u8]) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = 0;
    while start < text.len() {
        let mut end = (start + BYTES_PER_STEP).min(text.len());
        end += text[end..].iter().position(|&b| is_space(b)).unwrap_or(text.len() - end);
        parts.push(start..end);
        start = end;
    }
    if parts.is_empty() {
        parts.push(0..0);
    }
    parts
}

/// Number with a decimal representation.
pub(crate) trait TextNumber: Sized + Send {
    fn from_word(word: &[u8]) -> Option<Self>;
}

macro_rules! whole_numbers {
    ($($t:ty)*) => {$(
        impl TextNumber for $t {
            fn from_word(word: &[u8]) -> Option<Self> {
                let digits = std::str::from_utf8(word).ok()?;
                digits.parse().ok().or_else(|| {
                    // Some programs write integers with a decimal point.
                    let x = parse_f64(word)?;
                    #[allow(clippy::cast_lossless)]
                    (x as $t as f64 == x && x.abs() < (1_u64 << 53) as f64).then_some(x as $t)
                })
            }
        }
    )*};
}
whole_numbers!(u8 i8 u16 i16 u32 i32 u64 i64);

impl TextNumber for f32 {
    fn from_word(word: &[u8]) -> Option<Self> {
        parse_f32(word)
    }
}

impl TextNumber for f64 {
    fn from_word(word: &[u8]) -> Option<Self> {
        parse_f64(word)
    }
}

/// Converts face fields to cell fields. Edges precede faces among the cells and have no values: NaN, or zero for
/// integers.
pub(crate) fn cell_fields(shape: &ShapeFile) -> Vec<Field> {
    let n_lines = shape.edges.pairs.len();
    shape.face_fields.iter().map(|field| filled(field, n_lines)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_many_parts_are_the_same_numbers() {
        let text: String = (0..400_000).map(|i| format!("{i}\n ")).collect();
        assert!(text.len() > 2 * BYTES_PER_STEP);
        let FieldValues::I64(values) = from_text(text.as_bytes(), ValueType::I64, Progress::none()).unwrap()
        else {
            panic!("another type")
        };
        assert!(values.iter().copied().eq(0..400_000));
        let broken = text.replace("250000", "25x");
        match from_text(broken.as_bytes(), ValueType::I64, Progress::none()) {
            Err(NumberError::At(at, message)) => {
                assert_eq!((at, message.contains("\"25x\"")), (broken.find("25x").unwrap(), true));
            }
            _ => panic!("no number"),
        }
    }

    #[test]
    fn indices_are_whole_and_below_the_limit() {
        let numbers = |values: Vec<i16>| Numbers::Bytes {
            bytes: values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>().into(),
            kind: ValueType::I16,
            order: ByteOrder::Big,
        };
        assert_eq!(numbers(vec![3, 0, 5]).to_indices(6, Progress::none()), Ok(vec![3, 0, 5]));
        assert_eq!(numbers(vec![3, 6]).to_indices(6, Progress::none()), Err(IndexError::At(1, 6.0)));
        assert_eq!(numbers(vec![3, -1]).to_indices(6, Progress::none()), Err(IndexError::At(1, -1.0)));
        let floats = Numbers::Values(FieldValues::F32(vec![0.0]));
        assert_eq!(floats.to_indices(6, Progress::none()), Err(IndexError::Fractions));
    }
}
