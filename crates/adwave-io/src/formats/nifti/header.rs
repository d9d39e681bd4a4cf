//! Header of NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes).

use crate::model::field::{ByteOrder, Number};
use crate::{ReadError, ValueType};

/// Extension with the XML of a CIFTI.
const CIFTI_EXTENSION: i32 = 32;
/// Codes of intents of CIFTI.
const CIFTI_INTENTS: std::ops::Range<i64> = 3000..3100;

/// Version of the format, which decides where the numbers of the header are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    One,
    Two,
}

/// Bytes of the header where its numbers begin.
struct HeaderPlaces {
    header: usize,
    dim: usize,
    intent: usize,
    datatype: usize,
    bitpix: usize,
    pixdim: usize,
    offset: usize,
    scale: usize,
    units: usize,
    codes: usize,
    quaternion: usize,
    rows: usize,
    magic: usize,
}

impl Version {
    const fn places(self) -> HeaderPlaces {
        match self {
            Self::One => HeaderPlaces {
                header: 348,
                dim: 40,
                intent: 68,
                datatype: 70,
                bitpix: 72,
                pixdim: 76,
                offset: 108,
                scale: 112,
                units: 123,
                codes: 252,
                quaternion: 256,
                rows: 280,
                magic: 344,
            },
            Self::Two => HeaderPlaces {
                header: 540,
                dim: 16,
                intent: 504,
                datatype: 12,
                bitpix: 14,
                pixdim: 104,
                offset: 168,
                scale: 176,
                units: 500,
                codes: 344,
                quaternion: 352,
                rows: 400,
                magic: 4,
            },
        }
    }

    /// Greatest size of an axis.
    pub(super) const fn most(self) -> u64 {
        match self {
            Self::One => i16::MAX as u64,
            Self::Two => i64::MAX as u64,
        }
    }
}

/// True if the bytes are a NIfTI in one file.
pub(super) fn has_magic(bytes: &[u8]) -> bool {
    version(bytes).is_some()
}

fn version(bytes: &[u8]) -> Option<Version> {
    let magic = |at: usize, magic: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(magic));
    if magic(4, b"n+2\0") { Some(Version::Two) } else { magic(344, b"n+1\0").then_some(Version::One) }
}

/// True if the file is a CIFTI, whose values belong to the vertices of a surface.
pub(super) fn is_cifti(bytes: &[u8]) -> bool {
    if version(bytes) != Some(Version::Two) || bytes.len() < 552 {
        return false;
    }
    let order = order(bytes, Version::Two);
    let intent = i64::from(i32::from_bytes(&bytes[504..], order));
    let has_xml = bytes[540] != 0 && i32::from_bytes(&bytes[548..], order) == CIFTI_EXTENSION;
    has_xml || CIFTI_INTENTS.contains(&intent)
}

/// Byte order, by the size of the header and else by the number of axes.
fn order(bytes: &[u8], version: Version) -> ByteOrder {
    let (places, size) = (version.places(), version.places().header as i32);
    let n_axes = match version {
        Version::One => i64::from(i16::from_bytes(&bytes[places.dim..], ByteOrder::Little)),
        Version::Two => i64::from_bytes(&bytes[places.dim..], ByteOrder::Little),
    };
    if bytes[..4] == size.to_le_bytes() || (bytes[..4] != size.to_be_bytes() && (1..8).contains(&n_axes)) {
        ByteOrder::Little
    } else {
        ByteOrder::Big
    }
}

/// Numbers of the header that say how values are stored and where they are.
#[derive(Clone, Debug)]
pub(super) struct NiftiHeader {
    pub(super) version: Version,
    pub(super) order: ByteOrder,
    /// Size of each axis; the first is contiguous.
    pub(super) sizes: Vec<usize>,
    /// Code of the type of numbers.
    pub(super) datatype: i64,
    /// First byte of the values.
    pub(super) start: usize,
    pub(super) slope: f64,
    pub(super) intercept: f64,
    /// Handedness of the quaternion, then the spacing of each axis.
    pub(super) pixdim: [f64; 8],
    pub(super) units: i64,
    pub(super) qform_code: i64,
    pub(super) sform_code: i64,
    /// Parts b, c, d of the quaternion, then its offset.
    pub(super) quaternion: [f64; 6],
    pub(super) rows: [[f64; 4]; 3],
}

impl NiftiHeader {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let cut = || ReadError::byte_error(bytes.len(), "the header is truncated; get the whole file");
        let version = version(bytes).ok_or_else(cut)?;
        let places = version.places();
        if bytes.len() < places.header {
            return Err(cut());
        }
        let order = order(bytes, version);
        let is_one = version == Version::One;
        let short = |at: usize| i64::from(i16::from_bytes(&bytes[at..], order));
        let long = |at: usize| if is_one { short(at) } else { i64::from_bytes(&bytes[at..], order) };
        let code =
            |at: usize| if is_one { short(at) } else { i64::from(i32::from_bytes(&bytes[at..], order)) };
        let float_width = if is_one { 4 } else { 8 };
        let float = |at: usize, k: usize| {
            let at = at + k * float_width;
            if is_one {
                f64::from(f32::from_bytes(&bytes[at..], order))
            } else {
                f64::from_bytes(&bytes[at..], order)
            }
        };
        let dim = |k: usize| long(places.dim + k * if is_one { 2 } else { 8 });
        let n_axes = dim(0);
        if !(1..8).contains(&n_axes) {
            let message = format!("the number of axes must be 1 to 7, got {n_axes}; get an intact file");
            return Err(ReadError::byte_error(places.dim, message));
        }
        let sizes = (1..=n_axes as usize).map(|k| {
            let size = dim(k);
            usize::try_from(size).ok().filter(|&size| size > 0).ok_or_else(|| {
                let message =
                    format!("each axis must have a place, but axis {k} has {size}; get an intact file");
                ReadError::byte_error(places.dim, message)
            })
        });
        let sizes = sizes.collect::<Result<_, _>>()?;
        let offset = if is_one { float(places.offset, 0) } else { long(places.offset) as f64 };
        // Files of one part whose offset is missing begin after the header and the four bytes of its extension.
        let offset = if offset == 0.0 { (places.header + 4) as f64 } else { offset };
        if !(offset >= places.header as f64 && offset <= bytes.len() as f64) {
            let message = format!("the values begin at byte {offset}, outside the file; get the whole file");
            return Err(ReadError::byte_error(places.offset, message));
        }
        let units = if is_one { i64::from(bytes[places.units]) } else { code(places.units) };
        let code_width = if is_one { 2 } else { 4 };
        Ok(Self {
            version,
            order,
            sizes,
            datatype: short(places.datatype),
            start: offset as usize,
            slope: float(places.scale, 0),
            intercept: float(places.scale, 1),
            pixdim: std::array::from_fn(|k| float(places.pixdim, k)),
            units,
            qform_code: code(places.codes),
            sform_code: code(places.codes + code_width),
            quaternion: std::array::from_fn(|k| float(places.quaternion, k)),
            rows: std::array::from_fn(|row| std::array::from_fn(|k| float(places.rows, 4 * row + k))),
        })
    }

    /// Empty header of a new file, in little-endian order.
    pub(super) fn new_bytes(version: Version) -> Vec<u8> {
        let places = version.places();
        let mut bytes = vec![0; places.header + 4];
        bytes[..4].copy_from_slice(&(places.header as i32).to_le_bytes());
        let magic: &[u8] = if version == Version::One { b"n+1\0" } else { b"n+2\0\r\n\x1a\n" };
        bytes[places.magic..places.magic + magic.len()].copy_from_slice(magic);
        let mut editor = HeaderEditor { bytes: &mut bytes, version, order: ByteOrder::Little };
        match version {
            Version::One => editor.put(places.offset, (places.header + 4) as f32),
            Version::Two => editor.put(places.offset, (places.header + 4) as i64),
        }
        editor.put_float(places.pixdim, 0, 1.0);
        bytes
    }

    /// Slope and intercept of the values.
    pub(super) fn scaling(&self) -> (f64, f64) {
        let is_scaled = self.slope.is_finite() && self.slope != 0.0 && self.intercept.is_finite();
        // Colors are not scaled.
        let is_color = matches!(self.datatype, 128 | 2304);
        if is_scaled && !is_color { (self.slope, self.intercept) } else { (1.0, 0.0) }
    }

    /// Type of the numbers, and how many of them make up an item; `None` for types that are no numbers here.
    pub(super) fn value_type(&self) -> Option<(ValueType, usize)> {
        Some(match self.datatype {
            2 => (ValueType::U8, 1),
            4 => (ValueType::I16, 1),
            8 => (ValueType::I32, 1),
            16 => (ValueType::F32, 1),
            32 => (ValueType::F32, 2),
            64 => (ValueType::F64, 1),
            128 => (ValueType::U8, 3),
            256 => (ValueType::I8, 1),
            512 => (ValueType::U16, 1),
            768 => (ValueType::U32, 1),
            1024 => (ValueType::I64, 1),
            1280 => (ValueType::U64, 1),
            1792 => (ValueType::F64, 2),
            2304 => (ValueType::U8, 4),
            _ => return None,
        })
    }
}

/// Code of a type of numbers.
fn datatype_of(kind: ValueType) -> i16 {
    match kind {
        ValueType::U8 => 2,
        ValueType::I16 => 4,
        ValueType::I32 => 8,
        ValueType::F32 => 16,
        ValueType::F64 => 64,
        ValueType::I8 => 256,
        ValueType::U16 => 512,
        ValueType::U32 => 768,
        ValueType::I64 => 1024,
        ValueType::U64 => 1280,
    }
}

/// Editor of the numbers of a header.
pub(super) struct HeaderEditor<'a> {
    pub(super) bytes: &'a mut [u8],
    pub(super) version: Version,
    pub(super) order: ByteOrder,
}

impl HeaderEditor<'_> {
    fn put<T: Number>(&mut self, at: usize, number: T) {
        let mut bytes = Vec::with_capacity(8);
        number.write_bytes(self.order, &mut bytes);
        self.bytes[at..at + bytes.len()].copy_from_slice(&bytes);
    }

    fn put_float(&mut self, at: usize, k: usize, x: f64) {
        match self.version {
            Version::One => self.put(at + 4 * k, x as f32),
            Version::Two => self.put(at + 8 * k, x),
        }
    }

    fn put_code(&mut self, at: usize, k: usize, code: i32) {
        match self.version {
            Version::One => self.put(at + 2 * k, code as i16),
            Version::Two => self.put(at + 4 * k, code),
        }
    }

    /// Sets the type of the numbers, which are the values themselves.
    pub(super) fn set_value_type(&mut self, kind: ValueType) {
        let places = self.version.places();
        self.put(places.datatype, datatype_of(kind));
        self.put(places.bitpix, 8 * kind.n_bytes() as i16);
        self.put_float(places.scale, 0, 1.0);
        self.put_float(places.scale, 1, 0.0);
    }

    /// Sets the sizes of the axes, the contiguous one first.
    pub(super) fn set_sizes(&mut self, sizes: &[usize]) {
        let dim = self.version.places().dim;
        for k in 0..8 {
            let size = if k == 0 { sizes.len() } else { sizes.get(k - 1).copied().unwrap_or(1) };
            match self.version {
                Version::One => self.put(dim + 2 * k, size as i16),
                Version::Two => self.put(dim + 8 * k, size as i64),
            }
        }
        // The numbers along the further axes are no intent of the old ones.
        self.put_code(self.version.places().intent, 0, 0);
    }

    /// Sets the spacing of axis `k`, from 0.
    pub(super) fn set_spacing(&mut self, k: usize, spacing: f64) {
        self.put_float(self.version.places().pixdim, k + 1, spacing);
    }

    /// Sets the seconds from frame to frame, or that the channels are no frames, beside the unit of length among `units`.
    pub(super) fn set_frame_step(&mut self, step: Option<f64>, units: u8) {
        let length = units & 7;
        self.set_units(if step.is_some() { length | 8 } else { length });
        if let Some(step) = step {
            self.set_spacing(3, step);
        }
    }

    /// Sets the sum of the codes of the units of length and of time.
    fn set_units(&mut self, code: u8) {
        let units = self.version.places().units;
        match self.version {
            Version::One => self.bytes[units] = code,
            Version::Two => self.put(units, i32::from(code)),
        }
    }

    /// Sets the affine matrix as sform, in coordinates of a scanner.
    pub(super) fn set_affine(&mut self, rows: &[[f64; 4]; 3]) {
        let places = self.version.places();
        self.put_code(places.codes, 1, 1);
        for (k, x) in rows.as_flattened().iter().enumerate() {
            self.put_float(places.rows, k, *x);
        }
    }
}
