//! Accessor: location, storage and sparse replacement of numbers.

use std::borrow::Cow;

use adwave::Progress;

use super::document::Document;
use super::json::Json;
use crate::model::field::{ByteOrder, Number};
use crate::progress::{collect, extend};
use crate::{FieldValues, ReadError, ReadLimits, ValueType};

/// Description of an accessor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Accessor {
    /// Index in the file.
    pub(crate) index: usize,
    pub(crate) value_type: ValueType,
    pub(crate) n_channels: usize,
    pub(crate) count: usize,
    /// True if integers represent fractions of their largest value.
    pub(crate) is_normalized: bool,
    /// Location of the numbers; `None` if all are 0.
    pub(crate) place: Option<AccessorLayout>,
    pub(crate) is_sparse: bool,
}

/// Location of numbers in a buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AccessorLayout {
    pub(crate) buffer: usize,
    pub(crate) offset: usize,
    pub(crate) stride: usize,
}

fn wrong(index: usize, what: impl std::fmt::Display) -> ReadError {
    ReadError::Whole(format!("accessor {index} {what}; get the whole file, or export it again"))
}

fn value_type(code: usize) -> Option<ValueType> {
    Some(match code {
        5120 => ValueType::I8,
        5121 => ValueType::U8,
        5122 => ValueType::I16,
        5123 => ValueType::U16,
        5125 => ValueType::U32,
        5126 => ValueType::F32,
        _ => return None,
    })
}

/// Code of a component type.
pub(crate) fn code(value_type: ValueType) -> usize {
    match value_type {
        ValueType::I8 => 5120,
        ValueType::U8 => 5121,
        ValueType::I16 => 5122,
        ValueType::U16 => 5123,
        ValueType::U32 => 5125,
        _ => 5126,
    }
}

impl Accessor {
    /// Reads accessor `index` of a file and checks its statements against the existing bytes.
    pub(crate) fn read(document: &Document, index: usize, limits: &ReadLimits) -> Result<Self, ReadError> {
        let Some(json) = document.json.list_of("accessors").get(index) else {
            return Err(wrong(index, "is referenced but does not exist"));
        };
        let kind = json.index_of("componentType").and_then(value_type);
        let value_type = kind.ok_or_else(|| wrong(index, "has no known type of component"))?;
        let n_channels = match json.text_of("type") {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            Some("MAT2") if value_type.n_bytes() == 4 => 4,
            Some("MAT3") if value_type.n_bytes() == 4 => 9,
            Some("MAT4") => 16,
            _ => return Err(wrong(index, "has no known type")),
        };
        let count = json.index_of("count").ok_or_else(|| wrong(index, "has no count"))?;
        limits.check_points(count as u64)?;
        let row = n_channels * value_type.n_bytes();
        let place = match json.index_of("bufferView") {
            None => {
                // Numbers without bytes of their own take memory as well.
                limits.check_bytes((count as u64).saturating_mul(row as u64))?;
                None
            }
            Some(view) => Some(place(document, index, json, view, count, row)?),
        };
        let is_normalized = json.get("normalized") == Some(&Json::Bool(true)) && value_type.is_integer();
        let is_sparse = json.get("sparse").is_some();
        Ok(Self { index, value_type, n_channels, count, is_normalized, place, is_sparse })
    }

    /// Bytes of the numbers, from the first row on.
    fn bytes<'a>(&self, document: &'a Document) -> &'a [u8] {
        let within =
            |place: AccessorLayout| document.buffer(place.buffer).and_then(|bytes| bytes.get(place.offset..));
        self.place.and_then(within).unwrap_or_default()
    }

    fn stride(&self) -> usize {
        self.place.map_or(0, |place| place.stride)
    }

    /// Reads the numbers in their own type.
    pub(crate) fn values(
        &self,
        document: &Document,
        progress: Progress<'_>,
    ) -> Result<FieldValues, ReadError> {
        macro_rules! read {
            ($($variant:ident: $t:ty),*) => {
                match self.value_type {
                    $(ValueType::$variant => {
                        let mut values = self.plain::<$t>(document, progress)?;
                        self.replace::<$t>(document, &mut values)?;
                        Ok(FieldValues::$variant(values))
                    })*
                    _ => Err(wrong(self.index, "has no known type of component")),
                }
            };
        }
        read!(I8: i8, U8: u8, I16: i16, U16: u16, U32: u32, F32: f32)
    }

    fn plain<T: Number + Default>(
        &self,
        document: &Document,
        progress: Progress<'_>,
    ) -> Result<Vec<T>, ReadError> {
        let (bytes, stride, n, size) = (self.bytes(document), self.stride(), self.n_channels, size_of::<T>());
        if self.place.is_none() {
            return Ok(vec![T::default(); self.count * n]);
        }
        Ok(collect(self.count * n, progress, |k| {
            T::from_bytes(&bytes[k / n * stride + k % n * size..], ByteOrder::Little)
        })?)
    }

    /// Appends its rows as positions; integers that represent fractions are converted.
    pub(crate) fn append_points(
        &self,
        document: &Document,
        points: &mut Vec<[f64; 3]>,
        moved: impl Fn([f64; 3]) -> [f64; 3] + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<(), ReadError> {
        if self.n_channels != 3 {
            return Err(wrong(
                self.index,
                format!("needs 3 numbers for a position, got {}", self.n_channels),
            ));
        }
        if self.value_type == ValueType::F32 && !self.is_sparse && self.place.is_some() {
            let (bytes, stride) = (self.bytes(document), self.stride());
            let number = |row: &[u8], c: usize| f64::from(f32::from_bytes(&row[4 * c..], ByteOrder::Little));
            extend(points, self.count, progress, |i| {
                let row = &bytes[i * stride..][..12];
                moved([number(row, 0), number(row, 1), number(row, 2)])
            })?;
            return Ok(());
        }
        let values = self.fractions(&self.values(document, progress)?).into_owned();
        let number = |k: usize| values.get(k);
        extend(points, self.count, progress, |i| {
            moved([number(3 * i), number(3 * i + 1), number(3 * i + 2)])
        })?;
        Ok(())
    }

    /// Converts integers that represent fractions to fractions.
    pub(crate) fn fractions<'a>(&self, values: &'a FieldValues) -> Cow<'a, FieldValues> {
        let largest = match self.value_type {
            ValueType::I8 => 127.0,
            ValueType::U8 => 255.0,
            ValueType::I16 => 32_767.0,
            ValueType::U16 => 65_535.0,
            ValueType::U32 => 4_294_967_295.0,
            _ => return Cow::Borrowed(values),
        };
        if !self.is_normalized {
            return Cow::Borrowed(values);
        }
        Cow::Owned(FieldValues::F64((0..values.len()).map(|k| (values.get(k) / largest).max(-1.0)).collect()))
    }

    /// Replaces the rows listed by a sparse accessor.
    fn replace<T: Number>(&self, document: &Document, values: &mut [T]) -> Result<(), ReadError> {
        let Some(sparse) = document.json.list_of("accessors").get(self.index).and_then(|a| a.get("sparse"))
        else {
            return Ok(());
        };
        let (Some(n), Some(at), Some(by)) =
            (sparse.index_of("count"), sparse.get("indices"), sparse.get("values"))
        else {
            return Err(wrong(self.index, "replaces numbers without naming their rows"));
        };
        let is_unsigned = |t: &ValueType| matches!(t, ValueType::U8 | ValueType::U16 | ValueType::U32);
        let kind = at.index_of("componentType").and_then(value_type).filter(is_unsigned);
        let kind =
            kind.ok_or_else(|| wrong(self.index, "replaces rows whose indices are not unsigned integers"))?;
        let row = self.n_channels * size_of::<T>();
        let view = |json: &Json, size: usize| {
            let view = json.index_of("bufferView").ok_or_else(|| wrong(self.index, "replaces nothing"))?;
            let place = place(document, self.index, json, view, n, size)?;
            Ok::<_, ReadError>((place, document.buffer(place.buffer).unwrap_or_default()))
        };
        let ((rows, row_bytes), (news, new_bytes)) = (view(at, kind.n_bytes())?, view(by, row)?);
        for k in 0..n {
            let from = &row_bytes[rows.offset + k * kind.n_bytes()..];
            let i = match kind {
                ValueType::U8 => usize::from(from[0]),
                ValueType::U16 => usize::from(u16::from_bytes(from, ByteOrder::Little)),
                _ => u32::from_bytes(from, ByteOrder::Little) as usize,
            };
            if i >= self.count {
                return Err(wrong(self.index, format!("replaces row {i}, but has {} rows", self.count)));
            }
            for c in 0..self.n_channels {
                let at = news.offset + k * row + c * size_of::<T>();
                values[i * self.n_channels + c] = T::from_bytes(&new_bytes[at..], ByteOrder::Little);
            }
        }
        Ok(())
    }

    /// Reads the numbers as indices of vertices.
    pub(crate) fn indices(&self, document: &Document, progress: Progress<'_>) -> Result<Vec<u32>, ReadError> {
        if self.n_channels != 1 {
            return Err(wrong(self.index, "has more than one number per corner"));
        }
        match self.values(document, progress)? {
            FieldValues::U8(values) => Ok(values.into_iter().map(u32::from).collect()),
            FieldValues::U16(values) => Ok(collect(values.len(), progress, |k| values[k].into())?),
            FieldValues::U32(values) => Ok(values),
            _ => Err(wrong(self.index, "has corners that are not integers")),
        }
    }
}

/// Location of `count` rows of `row` bytes that `json` describes in a buffer view.
fn place(
    document: &Document,
    index: usize,
    json: &Json,
    view: usize,
    count: usize,
    row: usize,
) -> Result<AccessorLayout, ReadError> {
    let Some(view_json) = document.json.list_of("bufferViews").get(view) else {
        return Err(wrong(index, format!("names buffer view {view}, which does not exist")));
    };
    let of = |json: &Json, key: &str| json.index_of(key).unwrap_or(0);
    let buffer = of(view_json, "buffer");
    let Some(bytes) = document.buffer(buffer) else {
        return Err(wrong(index, format!("names buffer {buffer}, which does not exist")));
    };
    let stride = match of(view_json, "byteStride") {
        0 => row,
        stride => stride,
    };
    let (start, within) = (of(view_json, "byteOffset"), of(json, "byteOffset"));
    let length = of(view_json, "byteLength");
    let needed = if count == 0 { 0 } else { stride.saturating_mul(count - 1).saturating_add(row) };
    let needed_in_view = needed.saturating_add(within);
    if stride < row && count > 1 {
        return Err(wrong(index, format!("has rows of {row} bytes with a stride of {stride} bytes")));
    }
    if needed_in_view > length {
        return Err(wrong(index, format!("needs {needed_in_view} bytes, but its buffer view has {length}")));
    }
    let end = start.saturating_add(needed_in_view);
    if end > bytes.len() {
        return Err(ReadError::Truncated {
            end: bytes.len() as u64,
            needed: end as u64,
            element: format!("buffer {buffer}"),
            row: 0,
        });
    }
    Ok(AccessorLayout { buffer, offset: start + within, stride })
}
