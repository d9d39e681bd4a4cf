//! Numbers of images and volumes in files: decoding to physical values, and encoding without a silent loss.

use std::io::Write;

use adwave::pages::zeros;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

use crate::model::field::{ByteOrder, Number, with_values};
use crate::model::grid_layout::GRID_VALUES;
use crate::progress::collect;
use crate::{
    Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, ValueType, WriteError, WriteReport,
};

/// Places that are decoded or encoded by one thread at a time.
const BLOCK: usize = 8192;
/// Numbers of a block of places with many channels.
const BLOCK_NUMBERS: usize = 1 << 16;
/// Bytes of planes that are encoded before they are written.
const BUFFER: usize = 1 << 26;
/// Planes whose numbers at one place are a line of the cache.
const PLANES: usize = 16;

/// Layout and meaning of the numbers of a grid in a file: plane after plane, each with `n_components` adjacent numbers
/// at each place.
#[derive(Clone, Debug)]
pub(crate) struct GridNumbers {
    pub(crate) kind: ValueType,
    pub(crate) order: ByteOrder,
    pub(crate) n_places: usize,
    /// Planes, such as points in time.
    pub(crate) n_planes: usize,
    /// Adjacent numbers at a place, such as colors.
    pub(crate) n_components: usize,
    /// A value is the number times the slope, plus the intercept.
    pub(crate) slope: f64,
    pub(crate) intercept: f64,
    /// Number that means no data.
    pub(crate) missing: Option<f64>,
}

/// Values of a grid.
pub(crate) struct GridValues {
    /// Field with NaN at missing numbers.
    pub(crate) field: Field,
    /// False at places without data; `None` if all have data.
    pub(crate) kept: Option<Vec<bool>>,
    /// True if the values are the numbers of the file, in their type.
    pub(crate) are_numbers: bool,
}

impl GridNumbers {
    /// Numbers in one plane, which are the values themselves.
    pub(crate) fn new(kind: ValueType, order: ByteOrder, n_places: usize, n_components: usize) -> Self {
        let (slope, intercept) = (1.0, 0.0);
        Self { kind, order, n_places, n_planes: 1, n_components, slope, intercept, missing: None }
    }

    pub(crate) fn n_channels(&self) -> usize {
        self.n_planes.saturating_mul(self.n_components)
    }

    /// Number of bytes; `None` if that is no number.
    pub(crate) fn n_bytes(&self) -> Option<usize> {
        let n = self.n_places.checked_mul(self.n_planes)?.checked_mul(self.n_components)?;
        n.checked_mul(self.kind.n_bytes())
    }

    /// The numbers in `bytes` at `start`.
    ///
    /// # Errors
    /// There are fewer bytes, or more places than the limits allow.
    pub(crate) fn slice<'a>(
        &self,
        bytes: &'a [u8],
        start: usize,
        limits: &ReadLimits,
    ) -> Result<&'a [u8], ReadError> {
        let n = self.n_bytes();
        let found = n.and_then(|n| bytes.get(start..)?.get(..n));
        let Some(found) = found else {
            let width = self.kind.n_bytes().saturating_mul(self.n_components).max(1);
            return Err(ReadError::Truncated {
                end: bytes.len() as u64,
                needed: (start as u64).saturating_add(n.map_or(u64::MAX, |n| n as u64)),
                element: "values".into(),
                row: (bytes.len().saturating_sub(start) / width) as u64,
            });
        };
        limits.check_places(self.n_places as u64)?;
        let width = if self.is_scaled() { 8 } else { self.kind.n_bytes() };
        limits.check_bytes((found.len() / self.kind.n_bytes()) as u64 * width as u64)?;
        Ok(found)
    }

    pub(crate) fn is_scaled(&self) -> bool {
        (self.slope, self.intercept) != (1.0, 0.0)
    }

    /// Values of all numbers, which `bytes` must hold.
    pub(crate) fn read(&self, bytes: &[u8], progress: Progress<'_>) -> Result<GridValues, Cancelled> {
        let mut values = self.kind.empty();
        with_values!(&mut values, v => *v = self.gather(bytes, progress)?);
        self.decode(values, &[], progress)
    }

    /// Values of these numbers. Hidden places have no data; none is hidden if the list is empty.
    pub(crate) fn decode(
        &self,
        mut values: FieldValues,
        hidden: &[bool],
        progress: Progress<'_>,
    ) -> Result<GridValues, Cancelled> {
        let n_channels = self.n_channels();
        let is_hidden = |i: usize| hidden.get(i / n_channels).copied().unwrap_or(false);
        let is_missing = |i: usize| is_hidden(i) || self.is_missing(values.get(i));
        let n = values.len();
        let may_be_missing = self.missing.is_some() || !self.kind.is_integer() || hidden.contains(&true);
        let has_missing = may_be_missing && !crate::progress::all(n, progress, |i| !is_missing(i))?;
        let are_numbers = !self.is_scaled() && !has_missing;
        if !are_numbers {
            let value = |i: usize| {
                if is_missing(i) { f64::NAN } else { self.value(values.get(i)) }
            };
            let is_narrow = self.kind == ValueType::F32 || self.kind.n_bytes() < 4;
            values = if is_narrow && !self.is_scaled() {
                FieldValues::F32(collect(n, progress, |i| value(i) as f32)?)
            } else {
                FieldValues::F64(collect(n, progress, value)?)
            };
        }
        let field = Field::new(GRID_VALUES, n_channels, values);
        let kept = has_missing.then(|| {
            let has_data = |i: usize| (0..field.n_channels).any(|c| !field.get(i, c).is_nan());
            (0..field.len()).map(has_data).collect::<Vec<_>>()
        });
        let kept = kept.filter(|kept| kept.contains(&false));
        progress.check()?;
        Ok(GridValues { field, kept, are_numbers })
    }

    /// True if the number in the file means no data.
    fn is_missing(&self, x: f64) -> bool {
        // The number may be stated with more or fewer digits than its type has.
        let is_same =
            |missing: f64| x == missing || (self.kind == ValueType::F32 && x == f64::from(missing as f32));
        !x.is_finite() || self.missing.is_some_and(is_same)
    }

    fn value(&self, x: f64) -> f64 {
        if self.is_scaled() { self.slope * x + self.intercept } else { x }
    }

    /// Numbers of one plane, as they lie in `bytes`.
    pub(crate) fn adjacent<T: Number>(&self, bytes: &[u8]) -> Vec<T> {
        bytes.chunks_exact(size_of::<T>()).map(|bytes| T::from_bytes(bytes, self.order)).collect()
    }

    /// Values of one plane, as they lie in `bytes`; missing ones are those of their numbers.
    pub(crate) fn values(&self, bytes: &[u8]) -> Vec<f64> {
        let mut numbers = self.kind.empty();
        let mut values = with_values!(&mut numbers, v => numbers_to_f64(v, bytes, self.order));
        if self.is_scaled() {
            for x in &mut values {
                *x = self.value(*x);
            }
        }
        values
    }

    /// Numbers in the order of the places, with all channels of a place adjacent.
    fn gather<T: Number + Default + Sync>(
        &self,
        bytes: &[u8],
        progress: Progress<'_>,
    ) -> Result<Vec<T>, Cancelled> {
        let (width, order) = (size_of::<T>(), self.order);
        let (n_channels, n_components) = (self.n_channels(), self.n_components);
        if self.n_planes == 1 {
            return collect(self.n_places * n_channels, progress, |i| {
                T::from_bytes(&bytes[i * width..], order)
            });
        }
        let mut values = zeros(self.n_places * n_channels);
        let block = (BLOCK_NUMBERS / n_channels.max(1)).clamp(64, BLOCK);
        values.par_chunks_mut(block * n_channels).enumerate().try_for_each(|(b, rows)| {
            progress.check()?;
            for plane in 0..self.n_planes {
                let start = (plane * self.n_places + b * block) * n_components;
                for (k, row) in rows.chunks_exact_mut(n_channels).enumerate() {
                    for c in 0..n_components {
                        let at = (start + k * n_components + c) * width;
                        row[plane * n_components + c] = T::from_bytes(&bytes[at..], order);
                    }
                }
            }
            Ok(())
        })?;
        Ok(values)
    }

    /// Writes the numbers of the field. Where `original` has the number of the same value, its bytes stay.
    ///
    /// # Errors
    /// Writing fails, or a value does not fit the type.
    pub(crate) fn write(
        &self,
        original: Option<&[u8]>,
        field: &Field,
        format: Format,
        out: &mut dyn Write,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let mut values = self.kind.empty();
        with_values!(&mut values, v => self.write_as(v, &GridEncoding { original, field, format }, out, progress))
    }

    /// [`write`](Self::write) for the type of the (empty) list.
    fn write_as<T: GridNumber>(
        &self,
        _: &mut Vec<T>,
        encoding: &GridEncoding<'_>,
        out: &mut dyn Write,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        let width = size_of::<T>() * self.n_components;
        let n_blocks = self.n_places.div_ceil(BLOCK);
        let n_together = (BUFFER / (self.n_places * width).max(1)).clamp(1, PLANES);
        // Blocks that are encoded before they are written: all of some planes, or some of one plane.
        let n_at_once = if n_together > 1 { n_blocks } else { (BUFFER / (BLOCK * width)).max(1) };
        let mut plane = 0;
        while plane < self.n_planes {
            let planes = plane..(plane + n_together).min(self.n_planes);
            let mut first = 0;
            while first < n_blocks {
                let blocks = first..(first + n_at_once).min(n_blocks);
                let encode = |b: usize| -> Result<Vec<u8>, WriteError> {
                    progress.check()?;
                    let places = b * BLOCK..((b + 1) * BLOCK).min(self.n_places);
                    let mut bytes = Vec::with_capacity(places.len() * width * planes.len());
                    let mut values = Vec::with_capacity(places.len() * self.n_components);
                    for plane in planes.clone() {
                        let first = (plane * self.n_places + places.start) * self.n_components;
                        values.clear();
                        encoding.field.values.extend_strided(
                            &mut values,
                            places
                                .clone()
                                .map(|place| place * encoding.field.n_channels + plane * self.n_components),
                            self.n_components,
                        );
                        for (at, value) in (first..).zip(&values) {
                            self.encode::<T>(encoding, at, *value)?.write_bytes(self.order, &mut bytes);
                        }
                    }
                    Ok(bytes)
                };
                let encoded: Vec<_> = blocks.clone().into_par_iter().map(encode).collect();
                // The first misfit in the order of the places is reported.
                let encoded = encoded.into_iter().collect::<Result<Vec<_>, _>>()?;
                let n_rows = self.n_planes * n_blocks;
                for k in 0..planes.len() {
                    for (b, bytes) in encoded.iter().enumerate() {
                        let row = (planes.start + k) * n_blocks + blocks.start + b;
                        progress.step(row as u64, n_rows as u64)?;
                        let n = bytes.len() / planes.len();
                        out.write_all(&bytes[k * n..(k + 1) * n])?;
                    }
                }
                first = blocks.end;
            }
            plane = planes.end;
        }
        Ok(progress.check()?)
    }

    /// Number of a value, the one with the index `at` in the order of the file.
    #[inline]
    fn encode<T: GridNumber>(
        &self,
        encoding: &GridEncoding<'_>,
        at: usize,
        value: f64,
    ) -> Result<T, WriteError> {
        let GridEncoding { original, field, .. } = *encoding;
        if let Some(original) = original {
            let old = T::from_bytes(&original[at * size_of::<T>()..], self.order);
            let before = old.to_f64();
            if self.is_missing(before) {
                if value.is_nan() {
                    return Ok(old);
                }
            } else {
                let before = self.value(before);
                let is_single = matches!(field.values, FieldValues::F32(_));
                if value == before || (is_single && value == f64::from(before as f32)) {
                    return Ok(old);
                }
            }
        }
        let number = match self.missing {
            Some(missing) if value.is_nan() => missing,
            _ if self.is_scaled() => (value - self.intercept) / self.slope,
            _ => value,
        };
        T::from_value(number).ok_or_else(|| self.misfit(value, at, encoding.format))
    }

    #[cold]
    fn misfit(&self, value: f64, at: usize, format: Format) -> WriteError {
        let (row, component) = (at / self.n_components, at % self.n_components);
        let place = row % self.n_places;
        let channel = row / self.n_places * self.n_components + component;
        let channel = (self.n_channels() > 1).then_some(channel);
        let (low, high) = range_of(self.kind);
        let [a, b] = [self.value(low), self.value(high)];
        let channel = channel.map_or(String::new(), |c| format!(", channel {c},"));
        WriteError::Misfit {
            format,
            value,
            place: format!("{place}{channel}"),
            kind: self.kind.name(),
            low: a.min(b),
            high: a.max(b),
        }
    }
}

/// The numbers in `bytes`, of the type of the (empty) list.
fn numbers_to_f64<T: GridNumber>(_: &mut Vec<T>, bytes: &[u8], order: ByteOrder) -> Vec<f64> {
    bytes.chunks_exact(size_of::<T>()).map(|bytes| T::from_bytes(bytes, order).to_f64()).collect()
}

/// Values to be encoded.
#[derive(Clone, Copy)]
struct GridEncoding<'a> {
    /// Numbers of the original file.
    original: Option<&'a [u8]>,
    field: &'a Field,
    format: Format,
}

/// Least and greatest number of a type.
fn range_of(kind: ValueType) -> (f64, f64) {
    match kind {
        ValueType::U8 => (0.0, u8::MAX.into()),
        ValueType::I8 => (i8::MIN.into(), i8::MAX.into()),
        ValueType::U16 => (0.0, u16::MAX.into()),
        ValueType::I16 => (i16::MIN.into(), i16::MAX.into()),
        ValueType::U32 => (0.0, u32::MAX.into()),
        ValueType::I32 => (i32::MIN.into(), i32::MAX.into()),
        ValueType::U64 => (0.0, u64::MAX as f64),
        ValueType::I64 => (i64::MIN as f64, i64::MAX as f64),
        ValueType::F32 => (f32::MIN.into(), f32::MAX.into()),
        ValueType::F64 => (f64::MIN, f64::MAX),
    }
}

/// Number of a type in files of grids.
trait GridNumber: Number + Sync {
    fn to_f64(self) -> f64;
    /// The nearest number of the type; `None` beyond its range, and for NaN as an integer.
    fn from_value(x: f64) -> Option<Self>;
}

macro_rules! integers {
    ($($t:ty)*) => {$(
        impl GridNumber for $t {
            #[allow(clippy::cast_lossless)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[allow(clippy::cast_lossless)]
            fn from_value(x: f64) -> Option<Self> {
                let x = x.round_ties_even();
                // The greatest numbers of 64 bits are no floats: the next one above is beyond the range.
                let most = <$t>::MAX as f64;
                let is_below = if size_of::<$t>() == 8 { x < most } else { x <= most };
                (x >= <$t>::MIN as f64 && is_below).then_some(x as $t)
            }
        }
    )*};
}
integers!(u8 i8 u16 i16 u32 i32 u64 i64);

impl GridNumber for f32 {
    fn to_f64(self) -> f64 {
        self.into()
    }
    fn from_value(x: f64) -> Option<Self> {
        ((x as f32).is_finite() || !x.is_finite()).then_some(x as f32)
    }
}

impl GridNumber for f64 {
    fn to_f64(self) -> f64 {
        self
    }
    fn from_value(x: f64) -> Option<Self> {
        Some(x)
    }
}

/// Values that files of grids store: the field `values`, or the first one.
pub(crate) fn grid_field(shape: &ShapeFile, format: Format) -> Result<&Field, WriteError> {
    let field = shape.field(GRID_VALUES).or_else(|| shape.vertex_fields.first());
    field.ok_or_else(|| WriteError::CannotHold { format, what: "a grid without values".into() })
}

/// [`grid_field`] for files that store no other field: these are reported as dropped.
pub(crate) fn written_field<'a>(
    shape: &'a ShapeFile,
    format: Format,
    report: &mut WriteReport,
) -> Result<&'a Field, WriteError> {
    let field = grid_field(shape, format)?;
    report.report_vertex_fields(shape, &[&field.name]);
    Ok(field)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(kind: ValueType, n_places: usize, n_planes: usize, n_components: usize) -> GridNumbers {
        GridNumbers { n_planes, ..GridNumbers::new(kind, ByteOrder::Big, n_places, n_components) }
    }

    #[test]
    fn planes_and_components_come_back() {
        for (n_places, n_planes, n_components) in
            [(5, 1, 3), (3 * BLOCK + 7, 21, 1), (BLOCK + 1, 2, 3), (1, 40, 1)]
        {
            let numbers = numbers(ValueType::I16, n_places, n_planes, n_components);
            let n = n_places * n_planes * n_components;
            let bytes: Vec<u8> = (0..n).flat_map(|i| ((i % 30_011) as i16).to_be_bytes()).collect();
            let read = numbers.read(&bytes, Progress::none()).unwrap();
            let (place, plane, component) = (n_places - 1, n_planes - 1, n_components - 1);
            let at = (plane * n_places + place) * n_components + component;
            let channel = plane * n_components + component;
            assert_eq!(read.field.get(place, channel), (at % 30_011) as f64);
            let mut out = Vec::new();
            numbers.write(None, &read.field, Format::OBJ, &mut out, Progress::none()).unwrap();
            assert!(out == bytes);
        }
    }

    #[test]
    fn integers_round_to_the_nearest_and_never_clip() {
        assert_eq!(u8::from_value(255.4), Some(255));
        assert_eq!(u8::from_value(255.6), None);
        assert_eq!(u8::from_value(-0.4), Some(0));
        assert_eq!(i16::from_value(f64::NAN), None);
        assert_eq!(u64::from_value(u64::MAX as f64), None);
        assert_eq!(i64::from_value(i64::MIN as f64), Some(i64::MIN));
        assert_eq!(i32::from_value(i32::MAX.into()), Some(i32::MAX));
        assert_eq!(f32::from_value(1e39), None);
        assert!(f32::from_value(f64::NAN).unwrap().is_nan());
    }

    #[test]
    fn missing_numbers_are_nan_and_keep_their_bytes() {
        let numbers = GridNumbers { missing: Some(-9999.0), ..numbers(ValueType::I16, 3, 1, 1) };
        let bytes = [0, 7, 0xd8, 0xf1, 0, 9];
        let GridValues { mut field, kept, .. } = numbers.read(&bytes, Progress::none()).unwrap();
        assert_eq!(kept, Some(vec![true, false, true]));
        assert!(field.get(1, 0).is_nan());
        field.values = FieldValues::F64(vec![f64::NAN, f64::NAN, 8.7]);
        let mut out = Vec::new();
        numbers.write(Some(&bytes), &field, Format::OBJ, &mut out, Progress::none()).unwrap();
        assert_eq!(out, [0xd8, 0xf1, 0xd8, 0xf1, 0, 9]);
    }
}
