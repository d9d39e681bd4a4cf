//! Headers of classic NetCDF: CDF-1, CDF-2 (64-bit offsets) and CDF-5 (64-bit numbers).

use crate::formats::netcdf::variables::{Attribute, Content, Dimension, Place, Variable};
use crate::model::field::{ByteOrder, Number};
use crate::model::units::show;
use crate::{FieldValues, ReadError, ValueType};

/// Tags of the lists of a header.
const DIMENSIONS: u32 = 10;
const VARIABLES: u32 = 11;
const ATTRIBUTES: u32 = 12;

/// Read position in a header.
struct Header<'a> {
    bytes: &'a [u8],
    at: usize,
    /// True for CDF-5, whose counts have 64 bits.
    is_wide: bool,
    /// True if offsets have 64 bits.
    has_wide_offsets: bool,
}

/// Number type of a code, and its bytes; `None` for the type of letters.
fn type_of(code: u32) -> Option<(Option<ValueType>, usize)> {
    Some(match code {
        1 => (Some(ValueType::I8), 1),
        2 => (None, 1),
        3 => (Some(ValueType::I16), 2),
        4 => (Some(ValueType::I32), 4),
        5 => (Some(ValueType::F32), 4),
        6 => (Some(ValueType::F64), 8),
        7 => (Some(ValueType::U8), 1),
        8 => (Some(ValueType::U16), 2),
        9 => (Some(ValueType::U32), 4),
        10 => (Some(ValueType::I64), 8),
        11 => (Some(ValueType::U64), 8),
        _ => return None,
    })
}

impl<'a> Header<'a> {
    fn take(&mut self, n: u64) -> Result<&'a [u8], ReadError> {
        let end = (self.at as u64).saturating_add(n);
        if end > self.bytes.len() as u64 {
            return Err(ReadError::Truncated {
                end: self.bytes.len() as u64,
                needed: end,
                element: "header".into(),
                row: 0,
            });
        }
        let taken = &self.bytes[self.at..end as usize];
        self.at = end as usize;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, ReadError> {
        Ok(u32::from_bytes(self.take(4)?, ByteOrder::Big))
    }

    fn u64(&mut self) -> Result<u64, ReadError> {
        Ok(u64::from_bytes(self.take(8)?, ByteOrder::Big))
    }

    fn count(&mut self) -> Result<u64, ReadError> {
        if self.is_wide { self.u64() } else { Ok(self.u32()?.into()) }
    }

    /// Number of entries of a list with this tag, 0 if it is absent. Each takes 8 bytes at least.
    fn list(&mut self, tag: u32) -> Result<u64, ReadError> {
        let at = self.at;
        let (found, n) = (self.u32()?, self.count()?);
        let left = (self.bytes.len() - self.at) as u64;
        if (found == tag && n <= left / 8) || (found == 0 && n == 0) {
            return Ok(n);
        }
        Err(ReadError::byte_error(
            at,
            format!("a list of the NetCDF header is damaged (tag {found}); get the whole file"),
        ))
    }

    fn name(&mut self) -> Result<String, ReadError> {
        let n = self.count()?;
        let text = String::from_utf8_lossy(self.take(n)?).into_owned();
        self.pad(n)?;
        Ok(show(&text))
    }

    /// Skips the zeros that fill a multiple of four bytes.
    fn pad(&mut self, n: u64) -> Result<(), ReadError> {
        // At the end of the file they may be missing.
        let n = (n.next_multiple_of(4) - n).min((self.bytes.len() - self.at) as u64);
        self.take(n).map(|_| ())
    }

    fn type_code(&mut self) -> Result<(Option<ValueType>, usize), ReadError> {
        let at = self.at;
        let code = self.u32()?;
        type_of(code).ok_or_else(|| {
            ReadError::byte_error(at, format!("{code} is no type of numbers of NetCDF; get the file again"))
        })
    }

    fn attributes(&mut self) -> Result<Vec<(String, Attribute)>, ReadError> {
        let mut attributes = Vec::new();
        for _ in 0..self.list(ATTRIBUTES)? {
            let name = self.name()?;
            let (kind, size) = self.type_code()?;
            let n = self.count()?;
            let n_bytes = n.saturating_mul(size as u64);
            let bytes = self.take(n_bytes)?;
            let value = match kind {
                None => Attribute::Text(String::from_utf8_lossy(bytes).trim_end_matches('\0').to_owned()),
                Some(kind) => Attribute::Numbers(numbers(bytes, kind, n as usize)),
            };
            self.pad(n_bytes)?;
            attributes.push((name, value));
        }
        Ok(attributes)
    }
}

/// Numbers of a type from their bytes.
fn numbers(bytes: &[u8], kind: ValueType, n: usize) -> Vec<f64> {
    let mut values = kind.empty();
    crate::model::field::with_values!(&mut values, v => {
        for k in 0..n {
            v.push(Number::from_bytes(&bytes[k * kind.n_bytes()..], ByteOrder::Big));
        }
    });
    values.to_f64()
}

/// Dimensions, attributes and variables of a classic NetCDF.
pub(super) fn read_header(bytes: &[u8]) -> Result<Content, ReadError> {
    let version = bytes.get(3).copied().unwrap_or(0);
    let mut header = Header { bytes, at: 4, is_wide: version == 5, has_wide_offsets: version != 1 };
    let n_records = header.count()?;
    let is_streaming = n_records == if header.is_wide { u64::MAX } else { u64::from(u32::MAX) };
    let mut dimensions = Vec::new();
    for _ in 0..header.list(DIMENSIONS)? {
        let name = header.name()?;
        dimensions.push(Dimension { name, size: header.count()? });
    }
    let attributes = header.attributes()?;
    let mut variables: Vec<(Variable, bool, u64)> = Vec::new();
    for _ in 0..header.list(VARIABLES)? {
        let at = header.at;
        let name = header.name()?;
        let n_axes = header.count()?;
        if n_axes > 1024 {
            return Err(ReadError::byte_error(
                at,
                format!("a variable of {n_axes} axes is damaged; get the file again"),
            ));
        }
        let mut axes = Vec::new();
        for _ in 0..n_axes {
            let id = header.count()?;
            let axis = usize::try_from(id).ok().and_then(|id| dimensions.get(id)).ok_or_else(|| {
                ReadError::byte_error(
                    at,
                    format!(
                        "variable {name} has the dimension {id}, but there are {}; get the file again",
                        dimensions.len()
                    ),
                )
            })?;
            axes.push(axis.clone());
        }
        let attributes = header.attributes()?;
        let (kind, size) = header.type_code()?;
        header.count()?;
        let offset = if header.has_wide_offsets { header.u64()? } else { header.u32()?.into() };
        let is_record = axes.first().is_some_and(|axis| axis.size == 0);
        let inner =
            axes.iter().skip(usize::from(is_record)).fold(1_u64, |n, axis| n.saturating_mul(axis.size));
        let record_bytes = inner.saturating_mul(size as u64);
        let place = Place::Bytes { offset, record_bytes, stride: 0, is_record };
        variables.push((Variable { name, axes, attributes, kind, place }, is_record, record_bytes));
    }
    let n_record_variables = variables.iter().filter(|(_, is_record, _)| *is_record).count();
    // A single record variable is not padded.
    let padded = |bytes: u64| if n_record_variables == 1 { bytes } else { bytes.saturating_add(3) / 4 * 4 };
    let stride = variables.iter().filter(|v| v.1).fold(0_u64, |sum, v| sum.saturating_add(padded(v.2)));
    let first_record = variables.iter().filter(|v| v.1).map(|v| match v.0.place {
        Place::Bytes { offset, .. } => offset,
        Place::Dataset => 0,
    });
    let n_records = if is_streaming {
        let left = (bytes.len() as u64).saturating_sub(first_record.min().unwrap_or(0));
        left.checked_div(stride).unwrap_or(0)
    } else {
        n_records
    };
    let variables = variables.into_iter().map(|(mut variable, is_record, _)| {
        if let (true, Place::Bytes { stride: own, .. }) = (is_record, &mut variable.place) {
            *own = stride;
            variable.axes[0].size = n_records;
        }
        variable
    });
    Ok(Content { attributes, variables: variables.collect() })
}
