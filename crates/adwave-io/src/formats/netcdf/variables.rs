//! Variables of a NetCDF of either kind, and their values.

use hdf5_pure::File;

use crate::formats::netcdf::{classic, hdf5};
use crate::model::field::{ByteOrder, Number};
use crate::model::units::show;
use crate::{FieldValues, ReadError, ReadLimits, ValueType};

/// Value of an attribute.
#[derive(Clone, Debug)]
pub(super) enum Attribute {
    Text(String),
    Numbers(Vec<f64>),
}

/// A named axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Dimension {
    pub(super) name: String,
    pub(super) size: u64,
}

/// Place of the values of a variable.
#[derive(Clone, Debug)]
pub(super) enum Place {
    /// Bytes of a classic file: those of the first record, or of all values.
    Bytes { offset: u64, record_bytes: u64, stride: u64, is_record: bool },
    /// Dataset of an HDF5.
    Dataset,
}

/// A variable with its axes and attributes.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) axes: Vec<Dimension>,
    pub(super) attributes: Vec<(String, Attribute)>,
    /// Type of the numbers; `None` for text and others.
    pub(super) kind: Option<ValueType>,
    pub(super) place: Place,
}

/// Attributes of a file and its variables.
#[derive(Debug)]
pub(super) struct Content {
    pub(super) attributes: Vec<(String, Attribute)>,
    pub(super) variables: Vec<Variable>,
}

fn find<'a>(attributes: &'a [(String, Attribute)], name: &str) -> Option<&'a Attribute> {
    attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value)
}

impl Variable {
    /// Text of an attribute.
    pub(super) fn text(&self, name: &str) -> Option<&str> {
        if let Attribute::Text(text) = find(&self.attributes, name)? { Some(text.trim()) } else { None }
    }

    /// First number of an attribute.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        if let Attribute::Numbers(numbers) = find(&self.attributes, name)? {
            numbers.first().copied()
        } else {
            None
        }
    }

    /// Number of values.
    pub(super) fn n_values(&self) -> u64 {
        self.axes.iter().fold(1_u64, |n, axis| n.saturating_mul(axis.size))
    }

    /// Names and sizes of the axes, for messages: `(time: 3, cell: 20480)`.
    pub(super) fn show_axes(&self) -> String {
        let axes: Vec<String> =
            self.axes.iter().map(|axis| format!("{}: {}", show(&axis.name), axis.size)).collect();
        format!("({})", axes.join(", "))
    }
}

/// An open NetCDF.
#[derive(Debug)]
pub(super) struct NetCdf<'a> {
    content: Content,
    source: NetCdfFile,
    limits: &'a ReadLimits,
}

#[derive(Debug)]
enum NetCdfFile {
    Classic(Vec<u8>),
    Hdf5(File),
}

/// True for the first bytes of a classic NetCDF.
pub(super) fn is_classic(bytes: &[u8]) -> bool {
    bytes.starts_with(b"CDF") && matches!(bytes.get(3), Some(1 | 2 | 5))
}

impl<'a> NetCdf<'a> {
    /// Reads the header of a NetCDF.
    pub(super) fn open(bytes: Vec<u8>, limits: &'a ReadLimits) -> Result<Self, ReadError> {
        if is_classic(&bytes) {
            let content = classic::read_header(&bytes)?;
            return Ok(Self { content, source: NetCdfFile::Classic(bytes), limits });
        }
        check_length(&bytes)?;
        let file = File::from_bytes(bytes).map_err(|error| hdf5::unreadable("the file", &error))?;
        let content = hdf5::read_root(&file)?;
        Ok(Self { content, source: NetCdfFile::Hdf5(file), limits })
    }

    /// All variables.
    pub(super) fn variables(&self) -> &[Variable] {
        &self.content.variables
    }

    /// Variable of a name.
    pub(super) fn variable(&self, name: &str) -> Option<&Variable> {
        self.content.variables.iter().find(|variable| variable.name == name)
    }

    /// Variable of a name that must be there.
    pub(super) fn require(&self, name: &str, of: &str) -> Result<&Variable, ReadError> {
        self.variable(name).ok_or_else(|| {
            ReadError::Whole(format!(
                "{of} needs the variable {}, which the file does not have; get the grid file",
                show(name)
            ))
        })
    }

    /// Text of an attribute of the file.
    pub(super) fn text(&self, name: &str) -> Option<&str> {
        if let Attribute::Text(text) = find(&self.content.attributes, name)? {
            Some(text.trim())
        } else {
            None
        }
    }

    /// First number of an attribute of the file.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        match find(&self.content.attributes, name)? {
            Attribute::Numbers(numbers) => numbers.first().copied(),
            Attribute::Text(text) => text.trim().parse().ok(),
        }
    }

    /// All values of a variable of numbers as they are stored.
    pub(super) fn raw_values(&self, variable: &Variable) -> Result<Vec<f64>, ReadError> {
        let Some(kind) = variable.kind else {
            return Err(ReadError::Whole(format!(
                "the variable {} must hold numbers; choose another file",
                show(&variable.name)
            )));
        };
        let n = variable.n_values();
        self.limits.check_bytes(n.saturating_mul(8))?;
        let bytes = match (&self.source, &variable.place) {
            (NetCdfFile::Hdf5(file), _) => return hdf5::read_values(file, &variable.name, n),
            (NetCdfFile::Classic(bytes), &Place::Bytes { offset, record_bytes, stride, is_record }) => {
                let n_records = if is_record { variable.axes[0].size } else { 1 };
                let end = n_records.saturating_sub(1).saturating_mul(stride).saturating_add(record_bytes);
                let needed = offset.saturating_add(if n_records == 0 { 0 } else { end });
                if needed > bytes.len() as u64 {
                    return Err(ReadError::Truncated {
                        end: bytes.len() as u64,
                        needed,
                        element: show(&variable.name),
                        row: 0,
                    });
                }
                (0..n_records).map(move |k| {
                    let start = (offset + k * stride) as usize;
                    &bytes[start..start + record_bytes as usize]
                })
            }
            (NetCdfFile::Classic(_), Place::Dataset) => return Ok(Vec::new()),
        };
        let mut values = kind.empty();
        crate::model::field::with_values!(&mut values, v => {
            for record in bytes {
                for number in record.chunks_exact(kind.n_bytes()) {
                    v.push(Number::from_bytes(number, ByteOrder::Big));
                }
            }
        });
        Ok(values.to_f64())
    }

    /// All values of a variable of numbers, scaled as its attributes say; NaN in place of fill values.
    pub(super) fn values(&self, variable: &Variable) -> Result<Vec<f64>, ReadError> {
        let mut values = self.raw_values(variable)?;
        let kind = variable.kind.unwrap_or(ValueType::F64);
        // Numbers of 32 bits are compared as they were rounded.
        let usual = if kind.is_integer() { None } else { Some(USUAL_FILL) };
        let fills: Vec<f64> = [variable.number("_FillValue").or(usual), variable.number("missing_value")]
            .into_iter()
            .flatten()
            .map(|fill| if kind == ValueType::F32 { f64::from(fill as f32) } else { fill })
            .collect();
        let scale = variable.number("scale_factor").unwrap_or(1.0);
        let offset = variable.number("add_offset").unwrap_or(0.0);
        for value in &mut values {
            *value = if fills.contains(value) { f64::NAN } else { offset + scale * *value };
        }
        Ok(values)
    }
}

/// Fill value of floats that state none.
const USUAL_FILL: f64 = 9.969_209_968_386_869e36;

/// Checks that an HDF5 is as long as its header says: the library would read the rest of a cut file without an error.
///
/// The superblock of versions 0 and 1 has four addresses behind 24 and 28 bytes, that of versions 2 and 3 behind 12;
/// the third is the end of the file.
fn check_length(bytes: &[u8]) -> Result<(), ReadError> {
    let (size_at, first) = match bytes.get(8) {
        Some(0) => (13, 24),
        Some(1) => (13, 28),
        Some(2..=3) => (9, 12),
        _ => return Ok(()),
    };
    let size = bytes.get(size_at).map_or(0, |size| usize::from(*size).min(8));
    let mut end = [0; 8];
    let at = first + 2 * size;
    if let Some(address) = bytes.get(at..at + size) {
        end[..size].copy_from_slice(address);
    }
    let needed = u64::from_le_bytes(end);
    if needed > bytes.len() as u64 && needed != u64::MAX {
        return Err(ReadError::Truncated { end: bytes.len() as u64, needed, element: "HDF5".into(), row: 0 });
    }
    Ok(())
}
