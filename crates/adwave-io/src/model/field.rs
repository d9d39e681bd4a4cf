//! Named values at the vertices or faces of a shape, in the number type of the file.

use adwave::{Cancelled, Progress};

use crate::model::label_table::LabelTable;
use crate::progress::report_row;
use std::sync::Arc;

/// Name of the coordinates as a signal.
pub const COORDS: &str = "coords";

/// Numbers of one type.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // the names are the types
pub enum FieldValues {
    U8(Vec<u8>),
    I8(Vec<i8>),
    U16(Vec<u16>),
    I16(Vec<i16>),
    U32(Vec<u32>),
    I32(Vec<i32>),
    U64(Vec<u64>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// Evaluates one expression for the type of the values.
macro_rules! with_values {
    ($values:expr, $name:ident => $body:expr) => {
        match $values {
            FieldValues::U8($name) => $body,
            FieldValues::I8($name) => $body,
            FieldValues::U16($name) => $body,
            FieldValues::I16($name) => $body,
            FieldValues::U32($name) => $body,
            FieldValues::I32($name) => $body,
            FieldValues::U64($name) => $body,
            FieldValues::I64($name) => $body,
            FieldValues::F32($name) => $body,
            FieldValues::F64($name) => $body,
        }
    };
}

pub(crate) use with_values;

/// Type of one number in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // the names are the types
#[non_exhaustive]
pub enum ValueType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl ValueType {
    /// All types.
    pub const ALL: [Self; 10] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F32,
        Self::F64,
    ];

    /// Bytes per number.
    pub fn n_bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Name of the type: `u8`, `f32`.
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "u8",
            Self::I8 => "i8",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
            Self::U64 => "u64",
            Self::I64 => "i64",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// True for integer types.
    pub fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Creates an empty list of numbers of this type.
    pub(crate) fn empty(self) -> FieldValues {
        match self {
            Self::U8 => FieldValues::U8(Vec::new()),
            Self::I8 => FieldValues::I8(Vec::new()),
            Self::U16 => FieldValues::U16(Vec::new()),
            Self::I16 => FieldValues::I16(Vec::new()),
            Self::U32 => FieldValues::U32(Vec::new()),
            Self::I32 => FieldValues::I32(Vec::new()),
            Self::U64 => FieldValues::U64(Vec::new()),
            Self::I64 => FieldValues::I64(Vec::new()),
            Self::F32 => FieldValues::F32(Vec::new()),
            Self::F64 => FieldValues::F64(Vec::new()),
        }
    }
}

/// Byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
}

impl FieldValues {
    /// Number of values.
    pub fn len(&self) -> usize {
        with_values!(self, v => v.len())
    }

    /// True if there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Type of the numbers.
    pub fn value_type(&self) -> ValueType {
        match self {
            Self::U8(_) => ValueType::U8,
            Self::I8(_) => ValueType::I8,
            Self::U16(_) => ValueType::U16,
            Self::I16(_) => ValueType::I16,
            Self::U32(_) => ValueType::U32,
            Self::I32(_) => ValueType::I32,
            Self::U64(_) => ValueType::U64,
            Self::I64(_) => ValueType::I64,
            Self::F32(_) => ValueType::F32,
            Self::F64(_) => ValueType::F64,
        }
    }

    /// Number `i` as `f64` (64-bit integers beyond 2⁵³ are rounded).
    ///
    /// # Panics
    /// If `i` is not below [`len`](Self::len).
    pub fn get(&self, i: usize) -> f64 {
        match self {
            Self::U8(v) => v[i].into(),
            Self::I8(v) => v[i].into(),
            Self::U16(v) => v[i].into(),
            Self::I16(v) => v[i].into(),
            Self::U32(v) => v[i].into(),
            Self::I32(v) => v[i].into(),
            Self::U64(v) => v[i] as f64,
            Self::I64(v) => v[i] as f64,
            Self::F32(v) => v[i].into(),
            Self::F64(v) => v[i],
        }
    }

    /// All numbers as `f64` (64-bit integers beyond 2⁵³ are rounded).
    #[allow(clippy::cast_lossless, clippy::unnecessary_cast)] // one expression for all types
    pub fn to_f64(&self) -> Vec<f64> {
        with_values!(self, values => values.iter().map(|x| *x as f64).collect())
    }

    /// Appends `n` numbers from each of some positions on to a list.
    #[allow(clippy::cast_lossless, clippy::unnecessary_cast)] // one expression for all types
    pub(crate) fn extend_strided(&self, out: &mut Vec<f64>, starts: impl Iterator<Item = usize>, n: usize) {
        with_values!(self, values => {
            if n == 1 {
                out.extend(starts.map(|start| values[start] as f64));
            } else {
                for start in starts {
                    out.extend(values[start..start + n].iter().map(|x| *x as f64));
                }
            }
        });
    }

    /// Appends a number; returns `false`, without appending, if the type is an integer type that cannot represent the
    /// value.
    pub(crate) fn push_f64(&mut self, x: f64) -> bool {
        macro_rules! push_integer {
            ($v:expr, $t:ty) => {{
                let whole = x as $t;
                #[allow(clippy::cast_lossless)] // exact for the narrow types, checked for the wide
                let back = whole as f64;
                if back != x {
                    return false;
                }
                $v.push(whole);
            }};
        }
        match self {
            Self::U8(v) => push_integer!(v, u8),
            Self::I8(v) => push_integer!(v, i8),
            Self::U16(v) => push_integer!(v, u16),
            Self::I16(v) => push_integer!(v, i16),
            Self::U32(v) => push_integer!(v, u32),
            Self::I32(v) => push_integer!(v, i32),
            Self::U64(v) => push_integer!(v, u64),
            Self::I64(v) => push_integer!(v, i64),
            Self::F32(v) => v.push(x as f32),
            Self::F64(v) => v.push(x),
        }
        true
    }

    /// Appends the number at the start of `bytes`.
    ///
    /// # Panics
    /// If there are fewer bytes than the type needs.
    pub(crate) fn push_bytes(&mut self, bytes: &[u8], order: ByteOrder) {
        with_values!(self, v => v.push(Number::from_bytes(bytes, order)));
    }

    /// Writes number `i` in the given byte order.
    pub(crate) fn write_bytes(&self, i: usize, order: ByteOrder, out: &mut Vec<u8>) {
        with_values!(self, v => v[i].write_bytes(order, out));
    }

    /// Writes number `i` as text: the shortest decimal that reads back to the same value of its type.
    pub(crate) fn write_text(&self, i: usize, out: &mut Vec<u8>) {
        match self {
            Self::F32(v) => crate::text::push_f32(out, v[i]),
            Self::F64(v) => crate::text::push_f64(out, v[i]),
            Self::U64(v) => out.extend_from_slice(v[i].to_string().as_bytes()),
            Self::I64(v) => out.extend_from_slice(v[i].to_string().as_bytes()),
            _ => out.extend_from_slice((self.get(i) as i64).to_string().as_bytes()),
        }
    }

    /// Interleaves several lists of one type: the first number of each list, the second of each list, and so on.
    pub(crate) fn interleave(channels: &[&Self], progress: Progress<'_>) -> Result<Option<Self>, Cancelled> {
        let Some(first) = channels.first() else { return Ok(None) };
        if channels.iter().any(|c| c.len() != first.len() || c.value_type() != first.value_type()) {
            return Ok(None);
        }
        macro_rules! interleave {
            ($variant:ident) => {{
                let lists: Vec<_> = channels
                    .iter()
                    .filter_map(|c| if let Self::$variant(v) = c { Some(v.as_slice()) } else { None })
                    .collect();
                let mut all = Vec::with_capacity(first.len() * lists.len());
                for i in 0..first.len() {
                    report_row(progress, i as u64, first.len() as u64)?;
                    all.extend(lists.iter().map(|list| list[i]));
                }
                Self::$variant(all)
            }};
        }
        Ok(Some(match first {
            Self::U8(_) => interleave!(U8),
            Self::I8(_) => interleave!(I8),
            Self::U16(_) => interleave!(U16),
            Self::I16(_) => interleave!(I16),
            Self::U32(_) => interleave!(U32),
            Self::I32(_) => interleave!(I32),
            Self::U64(_) => interleave!(U64),
            Self::I64(_) => interleave!(I64),
            Self::F32(_) => interleave!(F32),
            Self::F64(_) => interleave!(F64),
        }))
    }
}

/// Number with a fixed size in bytes.
pub(crate) trait Number: Copy + Send {
    fn from_f64(x: f64) -> Self;
    fn from_bytes(bytes: &[u8], order: ByteOrder) -> Self;
    fn write_bytes(self, order: ByteOrder, out: &mut Vec<u8>);
}

macro_rules! number {
    ($($t:ty: $from_f64:expr),*) => {$(
        impl Number for $t {
            fn from_f64(x: f64) -> Self {
                ($from_f64)(x)
            }
            fn from_bytes(bytes: &[u8], order: ByteOrder) -> Self {
                let mut own = [0; size_of::<$t>()];
                own.copy_from_slice(&bytes[..size_of::<$t>()]);
                match order {
                    ByteOrder::Little => Self::from_le_bytes(own),
                    ByteOrder::Big => Self::from_be_bytes(own),
                }
            }
            fn write_bytes(self, order: ByteOrder, out: &mut Vec<u8>) {
                match order {
                    ByteOrder::Little => out.extend_from_slice(&self.to_le_bytes()),
                    ByteOrder::Big => out.extend_from_slice(&self.to_be_bytes()),
                }
            }
        }
    )*};
}
// Casts to integers saturate.
number!(
    u8: |x: f64| x.round() as u8, i8: |x: f64| x.round() as i8, u16: |x: f64| x.round() as u16,
    i16: |x: f64| x.round() as i16, u32: |x: f64| x.round() as u32, i32: |x: f64| x.round() as i32,
    u64: |x: f64| x.round() as u64, i64: |x: f64| x.round() as i64, f32: |x: f64| x as f32, f64: |x: f64| x
);

/// Values at the vertices (or faces) of a shape: `values[i * n_channels + c]` is channel `c` at vertex `i`.
///
/// ```
/// use adwave_io::{Field, FieldValues};
/// let gaze = Field::new("gaze", 1, FieldValues::F32(vec![0.5, 2.0]));
/// assert_eq!(gaze.len(), 2);
/// assert_eq!(gaze.to_f64(), [0.5, 2.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name of the values in the file; `normal`, `color` and `texcoord` are the same in every format.
    pub name: String,
    /// Number of channels per vertex, at least 1.
    pub n_channels: usize,
    /// Numbers, with all channels of one vertex adjacent.
    pub values: FieldValues,
    /// Seconds from one channel to the next, if the file says that the channels are frames.
    pub frame_step: Option<f64>,
    /// Names and colors of the labels that the values are, if the file has them.
    pub labels: Option<Arc<LabelTable>>,
}

impl Field {
    /// Creates a field of `values.len() / n_channels` vertices.
    ///
    /// # Panics
    /// If `n_channels` is 0 or does not divide the number of values.
    pub fn new(name: impl Into<String>, n_channels: usize, values: FieldValues) -> Self {
        assert!(
            n_channels > 0 && values.len().is_multiple_of(n_channels),
            "values must form complete rows of at least one channel"
        );
        Self { name: name.into(), n_channels, values, frame_step: None, labels: None }
    }

    /// This field with channels that are frames, one every `frame_step` seconds; a step that is no positive number is
    /// none.
    #[must_use]
    pub fn with_frame_step(self, frame_step: Option<f64>) -> Self {
        let frame_step = frame_step.filter(|step| step.is_normal() && *step > 0.0 && self.n_channels > 1);
        Self { frame_step, ..self }
    }

    /// This field with names and colors of its labels.
    #[must_use]
    pub fn with_labels(self, labels: Option<Arc<LabelTable>>) -> Self {
        Self { labels, ..self }
    }

    /// Value of a color channel at full intensity: the largest number of 8 or 16 bits, where words that are all at most
    /// 255 are bytes, as many scanners write them into LAS files; for other types 1 for fractions, and the least of 255,
    /// 65535 and the greatest value that no value exceeds. O(values).
    ///
    /// ```
    /// use adwave_io::{Field, FieldValues};
    /// assert_eq!(Field::new("color", 3, FieldValues::U8(vec![1, 0, 1])).full_intensity(), 255.0);
    /// assert_eq!(Field::new("color", 3, FieldValues::U16(vec![300, 0, 1])).full_intensity(), 65535.0);
    /// assert_eq!(Field::new("color", 3, FieldValues::U16(vec![255, 0, 1])).full_intensity(), 255.0);
    /// assert_eq!(Field::new("color", 3, FieldValues::F64(vec![1.0, 0.0, 0.5])).full_intensity(), 1.0);
    /// assert_eq!(Field::new("color", 3, FieldValues::F64(vec![128.0, 0.0, 64.0])).full_intensity(), 255.0);
    /// ```
    pub fn full_intensity(&self) -> f64 {
        match &self.values {
            FieldValues::U16(words) if words.iter().any(|word| *word > 255) => f64::from(u16::MAX),
            FieldValues::U8(_) | FieldValues::U16(_) => f64::from(u8::MAX),
            _ => {
                let values = (0..self.len()).flat_map(|x| (0..self.n_channels).map(move |c| self.get(x, c)));
                let greatest = values.filter(|v| v.is_finite()).fold(0.0, f64::max);
                let usual = [1.0, f64::from(u8::MAX), f64::from(u16::MAX)];
                usual.into_iter().find(|most| greatest <= *most).unwrap_or(greatest)
            }
        }
    }

    /// [`new`](Self::new) for values whose number has not been checked.
    ///
    /// # Errors
    /// [`ShapeFileError::FieldValues`](crate::ShapeFileError::FieldValues) if `n_channels` is 0 or does not divide
    /// the number of values.
    pub fn try_new(
        name: impl Into<String>,
        n_channels: usize,
        values: FieldValues,
    ) -> Result<Self, crate::ShapeFileError> {
        let (name, found) = (name.into(), values.len());
        if n_channels == 0 || !found.is_multiple_of(n_channels) {
            return Err(crate::ShapeFileError::FieldValues { name, found, n_channels });
        }
        Ok(Self { name, n_channels, values, frame_step: None, labels: None })
    }

    /// Replaces the numbers and keeps the type: integer types round and saturate.
    ///
    /// ```
    /// use adwave_io::{Field, FieldValues};
    /// let color = Field::new("color", 1, FieldValues::U8(vec![0, 0]));
    /// assert_eq!(color.with_values_rounded(&[12.6, 300.0]).values, FieldValues::U8(vec![13, 255]));
    /// ```
    ///
    /// # Panics
    /// If the number of values differs from that of the field.
    #[must_use]
    pub fn with_values_rounded(&self, numbers: &[f64]) -> Self {
        assert_eq!(numbers.len(), self.values.len(), "the number of values must not change");
        let mut values = self.values.value_type().empty();
        with_values!(&mut values, v => for &x in numbers {
            v.push(Number::from_f64(x));
        });
        Self { name: self.name.clone(), values, labels: self.labels.clone(), ..*self }
    }

    /// Number of vertices (or faces).
    pub fn len(&self) -> usize {
        self.values.len().checked_div(self.n_channels).unwrap_or(0)
    }

    /// True if the field has no vertices.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Channel `c` at vertex `i` as `f64`.
    ///
    /// # Panics
    /// If there is no such vertex or channel.
    pub fn get(&self, i: usize, c: usize) -> f64 {
        self.values.get(i * self.n_channels + c)
    }

    /// All numbers as `f64`, with all channels of one vertex adjacent.
    pub fn to_f64(&self) -> Vec<f64> {
        self.values.to_f64()
    }
}

/// A name that is not taken: with the separator and a number after it if it is.
pub(crate) fn unused(name: &str, separator: &str, taken: impl Fn(&str) -> bool) -> String {
    let mut free = name.to_string();
    let mut k = 2;
    while taken(&free) {
        free = format!("{name}{separator}{k}");
        k += 1;
    }
    free
}
