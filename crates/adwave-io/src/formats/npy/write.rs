//! Writer of NumPy's `.npy` and `.npz`, and of sparse matrices for SciPy.

use std::io::{Seek, Write};
use std::path::Path;

use zip::write::{SimpleFileOptions, StreamWriter, ZipWriter};

use adwave::rows::CompressedRows;

use crate::text::{push_f32, push_f64};
use crate::{WriteError, atomic_write};

/// Compression of arrays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Compression {
    /// Uncompressed.
    #[default]
    Stored,
    /// Compressed by deflate.
    Deflated,
}

/// Borrowed numbers of an array.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // the names are the types
#[non_exhaustive]
pub enum ArrayValues<'a> {
    U8(&'a [u8]),
    U32(&'a [u32]),
    I32(&'a [i32]),
    U64(&'a [u64]),
    I64(&'a [i64]),
    F32(&'a [f32]),
    F64(&'a [f64]),
    /// Array in several consecutive parts.
    F64Parts(&'a [&'a [f64]]),
    /// Offsets and counts, written as 64-bit integers.
    Usize(&'a [usize]),
    /// ASCII text, written as a byte string without a shape.
    Text(&'a str),
}

impl ArrayValues<'_> {
    fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U32(v) => v.len(),
            Self::I32(v) => v.len(),
            Self::U64(v) => v.len(),
            Self::I64(v) => v.len(),
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
            Self::Usize(v) => v.len(),
            Self::F64Parts(parts) => parts.iter().map(|part| part.len()).sum(),
            Self::Text(_) => 1,
        }
    }

    fn descr(&self) -> String {
        match self {
            Self::U8(_) => "|u1".into(),
            Self::U32(_) => "<u4".into(),
            Self::I32(_) => "<i4".into(),
            Self::U64(_) => "<u8".into(),
            Self::I64(_) | Self::Usize(_) => "<i8".into(),
            Self::F32(_) => "<f4".into(),
            Self::F64(_) | Self::F64Parts(_) => "<f8".into(),
            Self::Text(t) => format!("|S{}", t.len().max(1)),
        }
    }

    /// Writes the numbers chunk by chunk, without a copy of the array.
    fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        fn write_chunks<T: Copy, const N: usize>(
            values: &[T],
            bytes: impl Fn(T) -> [u8; N],
            out: &mut dyn Write,
        ) -> std::io::Result<()> {
            let mut buffer = Vec::with_capacity(8192 * N);
            for chunk in values.chunks(8192) {
                buffer.clear();
                buffer.extend(chunk.iter().flat_map(|&x| bytes(x)));
                out.write_all(&buffer)?;
            }
            Ok(())
        }
        match self {
            Self::U8(v) => out.write_all(v),
            Self::U32(v) => write_chunks(v, u32::to_le_bytes, out),
            Self::I32(v) => write_chunks(v, i32::to_le_bytes, out),
            Self::U64(v) => write_chunks(v, u64::to_le_bytes, out),
            Self::I64(v) => write_chunks(v, i64::to_le_bytes, out),
            Self::F32(v) => write_chunks(v, f32::to_le_bytes, out),
            Self::F64(v) => write_chunks(v, f64::to_le_bytes, out),
            Self::F64Parts(parts) => {
                parts.iter().try_for_each(|part| write_chunks(part, f64::to_le_bytes, out))
            }
            Self::Usize(v) => write_chunks(v, |x| (x as i64).to_le_bytes(), out),
            Self::Text(t) => out.write_all(if t.is_empty() { b"\0" } else { t.as_bytes() }),
        }
    }
}

/// Writes an array in `.npy` form; `shape` has its lengths, last index fastest.
fn write_array(
    out: &mut dyn Write,
    name: &str,
    shape: &[usize],
    values: ArrayValues<'_>,
) -> Result<(), WriteError> {
    if shape.iter().product::<usize>() != values.len() {
        let (name, found) = (name.to_string(), values.len() as u64);
        return Err(WriteError::ArrayShape { name, found, shape: shape.to_vec() });
    }
    out.write_all(&header(&values.descr(), shape))?;
    Ok(values.write(out)?)
}

/// The bytes before the numbers of an array of the given shape, last index fastest.
pub(super) fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let lengths: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let lengths = if shape.len() == 1 { lengths.trim_end() } else { lengths.trim_end_matches([',', ' ']) };
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({lengths}), }}");
    // Magic, version and length take ten bytes; the numbers begin at a multiple of 64.
    header.extend(std::iter::repeat_n(' ', (64 - (10 + header.len() + 1) % 64) % 64));
    header.push('\n');
    [&b"\x93NUMPY\x01\x00"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat()
}

/// Writes a `.npy` of one array of the given shape, last index fastest.
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write), and values that do not match the shape.
pub fn write_npy(path: &Path, shape: &[usize], values: ArrayValues<'_>) -> Result<(), WriteError> {
    atomic_write(path, |out| write_array(out, "", shape, values))
}

/// Writer of several arrays to a `.npz`.
///
/// ```
/// use adwave_io::{ArrayValues, Compression, NpzWriter};
/// let mut npz = NpzWriter::new(std::io::Cursor::new(Vec::new()), Compression::Stored);
/// npz.add("saliency", &[3], ArrayValues::F64(&[0.0, 0.5, 1.0])).unwrap();
/// let bytes = npz.finish().unwrap().into_inner();
/// assert!(bytes.starts_with(b"PK"));
/// ```
pub struct NpzWriter<W: Write + Seek> {
    zip: ZipWriter<W>,
    options: SimpleFileOptions,
}

impl<W: Write + Seek> NpzWriter<W> {
    /// Creates an archive without arrays.
    pub fn new(out: W, compression: Compression) -> Self {
        Self::with_zip(ZipWriter::new(out), compression)
    }

    fn with_zip(zip: ZipWriter<W>, compression: Compression) -> Self {
        let method = match compression {
            Compression::Stored => zip::CompressionMethod::Stored,
            Compression::Deflated => zip::CompressionMethod::Deflated,
        };
        // Arrays may exceed 4 GiB, and equal arrays give equal bytes at any time.
        let options = SimpleFileOptions::default()
            .compression_method(method)
            .large_file(true)
            .last_modified_time(zip::DateTime::default());
        Self { zip, options }
    }

    /// Adds an array of the given shape, last index fastest.
    ///
    /// # Errors
    /// Writing fails, or the values do not match the shape.
    pub fn add(&mut self, name: &str, shape: &[usize], values: ArrayValues<'_>) -> Result<(), WriteError> {
        self.zip.start_file(format!("{name}.npy"), self.options).map_err(std::io::Error::other)?;
        write_array(&mut self.zip, name, shape, values)
    }

    /// Completes the archive.
    ///
    /// # Errors
    /// Writing fails.
    pub fn finish(self) -> Result<W, WriteError> {
        Ok(self.zip.finish().map_err(std::io::Error::other)?)
    }
}

/// Writes a `.npz` of several arrays: name, shape and numbers of each.
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write), and values that do not match their shape.
pub fn write_npz(
    path: &Path,
    arrays: &[(&str, &[usize], ArrayValues<'_>)],
    compression: Compression,
) -> Result<(), WriteError> {
    write_archive(path, compression, |npz| {
        arrays.iter().try_for_each(|(name, shape, values)| npz.add(name, shape, *values))
    })
}

/// Type of the values of a matrix that is written.
pub trait MatrixValue: adwave::rows::Value {
    /// The values as those of an array.
    fn array(values: &[Self]) -> ArrayValues<'_>;

    /// Appends the shortest decimal that reads back to the same value of this type.
    fn push_text(self, out: &mut Vec<u8>);
}

impl MatrixValue for f32 {
    fn array(values: &[Self]) -> ArrayValues<'_> {
        ArrayValues::F32(values)
    }

    fn push_text(self, out: &mut Vec<u8>) {
        push_f32(out, self);
    }
}

impl MatrixValue for f64 {
    fn array(values: &[Self]) -> ArrayValues<'_> {
        ArrayValues::F64(values)
    }

    fn push_text(self, out: &mut Vec<u8>) {
        push_f64(out, self);
    }
}

/// Writes a matrix for `scipy.sparse.load_npz`.
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write).
pub fn write_sparse_npz<V: MatrixValue>(
    path: &Path,
    matrix: &CompressedRows<V>,
    compression: Compression,
) -> Result<(), WriteError> {
    let shape = [matrix.n_rows(), matrix.n_columns()];
    let (n, indices, offsets) = (matrix.nnz(), matrix.columns(), matrix.offsets());
    // SciPy expects both index arrays in one type, and 32 bits as long as they suffice.
    let narrow = i32::try_from(n.max(matrix.n_columns())).is_ok();
    write_archive(path, compression, |npz| {
        if narrow {
            let indices: Vec<i32> = indices.iter().map(|&i| i as i32).collect();
            npz.add("indices", &[n], ArrayValues::I32(&indices))?;
            let offsets: Vec<i32> = offsets.iter().map(|&o| o as i32).collect();
            npz.add("indptr", &[offsets.len()], ArrayValues::I32(&offsets))?;
        } else {
            let indices: Vec<i64> = indices.iter().map(|&i| i.into()).collect();
            npz.add("indices", &[n], ArrayValues::I64(&indices))?;
            npz.add("indptr", &[offsets.len()], ArrayValues::Usize(offsets))?;
        }
        npz.add("format", &[], ArrayValues::Text("csr"))?;
        npz.add("shape", &[2], ArrayValues::Usize(&shape))?;
        npz.add("data", &[n], V::array(matrix.values()))
    })
}

/// Writes a stream without seeking, because the target may be a pipe.
fn write_archive(
    path: &Path,
    compression: Compression,
    add: impl FnOnce(&mut NpzWriter<StreamWriter<&mut dyn Write>>) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    atomic_write(path, |out| {
        let mut npz = NpzWriter::with_zip(ZipWriter::new_stream(out), compression);
        add(&mut npz)?;
        npz.finish()?.into_inner().flush()?;
        Ok(())
    })
}
