//! Reader for surfaces of triangles, and for the older ones of quadrangles, which FreeSurfer itself reads as pairs of
//! triangles.
//!
//! Coordinates are not transformed and stay in the space of the surface; the volume information at the end is kept
//! for writing.

use crate::WriteError;
use crate::model::context::WriteContext;
use crate::model::source_document::SourceDocument;
use crate::model::source_document::Update;
use adwave::Progress;
use adwave::shape::Polygons;

use crate::model::field::{ByteOrder, Number};
use crate::model::numbers::{IndexError, Numbers};
use crate::progress::collect;
use crate::{CoordinatePrecision, Format, ReadError, ReadLimits, ShapeFile, ValueType};

/// Triangles, 32-bit coordinates.
pub(super) const TRIANGLES: &[u8] = b"\xff\xff\xfe";
/// Quadrangles, coordinates in hundredths. Files of values at vertices begin in the same way.
const QUADS: &[u8] = b"\xff\xff\xff";
/// Quadrangles, 32-bit coordinates.
const NEW_QUADS: &[u8] = b"\xff\xff\xfd";

/// Content of a surface besides its numbers.
#[derive(Debug)]
pub(crate) struct FreeSurferSource {
    /// Creator line, with the line ends after it.
    pub(super) creator: Vec<u8>,
    /// Content after the triangles: information on the source volume, commands.
    pub(super) tail: Vec<u8>,
}

impl SourceDocument for FreeSurferSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        super::write::write_surface(shape, &mut context.report, context.out, context.progress)?;
        Ok(Update::Written)
    }
}

/// True if the bytes are a surface.
pub(crate) fn is_surface(bytes: &[u8]) -> bool {
    bytes.starts_with(TRIANGLES)
        || bytes.starts_with(NEW_QUADS)
        || (bytes.starts_with(QUADS) && !super::overlay::is_curv(bytes))
}

/// Reads a surface.
pub(crate) fn read_surface(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut shape = if bytes.starts_with(TRIANGLES) {
        triangles(bytes, limits, progress)?
    } else {
        quads(bytes, limits, progress)?
    };
    shape.format = Some(Format::FREESURFER);
    shape.precision = CoordinatePrecision::F32;
    Ok(shape)
}

/// Returns `n` rows of `width` bytes from `at` on.
fn rows<'a>(bytes: &'a [u8], at: usize, n: u64, width: u64, element: &str) -> Result<&'a [u8], ReadError> {
    let needed = n.saturating_mul(width).saturating_add(at as u64);
    if needed > bytes.len() as u64 {
        return Err(ReadError::Truncated {
            end: bytes.len() as u64,
            needed,
            element: element.into(),
            row: (bytes.len().saturating_sub(at)) as u64 / width,
        });
    }
    Ok(&bytes[at..needed as usize])
}

fn floats(bytes: &[u8]) -> Numbers<'_> {
    Numbers::Bytes { bytes: bytes.into(), kind: ValueType::F32, order: ByteOrder::Big }
}

fn face_index(at: usize, corners: u64, width: u64, error: IndexError, n_vertices: u64) -> ReadError {
    let IndexError::At(k, index) = error else { return adwave::Cancelled.into() };
    ReadError::FaceIndex {
        place: format!("byte {}", at as u64 + k as u64 * width),
        face: k as u64 / corners,
        index: index as i64,
        n_vertices,
    }
}

fn triangles(bytes: &[u8], limits: &ReadLimits, progress: Progress<'_>) -> Result<ShapeFile, ReadError> {
    let Some(line_end) = memchr::memchr(b'\n', bytes) else {
        return Err(ReadError::byte_error(
            bytes.len(),
            "the line of the creator does not end; get the whole file",
        ));
    };
    // A blank line should follow, but some programs omit it.
    let at = line_end + 1 + usize::from(bytes.get(line_end + 1) == Some(&b'\n'));
    let counts = rows(bytes, at, 2, 4, "counts")?;
    let count = |k: usize| u64::try_from(i32::from_bytes(&counts[4 * k..], ByteOrder::Big));
    let (Ok(n_vertices), Ok(n_faces)) = (count(0), count(1)) else {
        return Err(ReadError::byte_error(
            at,
            "the counts of vertices and triangles must not be negative; get the whole file",
        ));
    };
    limits.check_points(n_vertices)?;
    let points = rows(bytes, at + 8, n_vertices, 12, "vertex")?;
    let faces_at = at + 8 + points.len();
    let faces = rows(bytes, faces_at, n_faces, 12, "triangle")?;
    let mut shape = ShapeFile::from_cloud(floats(points).to_points(progress)?);
    let corners = Numbers::Bytes { bytes: faces.into(), kind: ValueType::I32, order: ByteOrder::Big };
    let corners = corners
        .to_indices(n_vertices as u32, progress)
        .map_err(|error| face_index(faces_at, 3, 4, error, n_vertices))?;
    shape.faces = Polygons::from(corners.as_chunks().0.to_vec()).into();
    let tail = bytes[faces_at + faces.len()..].to_vec();
    if !tail.is_empty() {
        shape.extras.push("the source volume of the surface".into());
    }
    let creator = bytes[TRIANGLES.len()..at].to_vec();
    shape.set_source(FreeSurferSource { creator, tail });
    Ok(shape)
}

/// Integer of three bytes.
fn three_bytes(bytes: &[u8]) -> u32 {
    u32::from_be_bytes([0, bytes[0], bytes[1], bytes[2]])
}

fn quads(bytes: &[u8], limits: &ReadLimits, progress: Progress<'_>) -> Result<ShapeFile, ReadError> {
    let counts = rows(bytes, 3, 2, 3, "counts")?;
    let (n_vertices, n_quads) = (three_bytes(counts), three_bytes(&counts[3..]));
    limits.check_points(n_vertices.into())?;
    let is_new = bytes.starts_with(NEW_QUADS);
    let points = rows(bytes, 9, n_vertices.into(), if is_new { 12 } else { 6 }, "vertex")?;
    let at = 9 + points.len();
    let quads = rows(bytes, at, n_quads.into(), 12, "quadrangle")?;
    let points = if is_new {
        floats(points).to_points(progress)?
    } else {
        // Hundredths, converted to 32-bit floats as in FreeSurfer and in the newer kinds of file.
        let hundredths =
            |i: usize| f64::from(f32::from(i16::from_bytes(&points[2 * i..], ByteOrder::Big)) / 100.0);
        collect(n_vertices as usize, progress, |i| [0, 1, 2].map(|c| hundredths(3 * i + c)))?
    };
    let mut shape = ShapeFile::from_cloud(points);
    let mut corners = Vec::with_capacity(n_quads as usize * 2);
    for (q, quad) in quads.chunks_exact(12).enumerate() {
        crate::progress::report_row(progress, q as u64, n_quads.into())?;
        let [a, b, c, d] = [0, 3, 6, 9].map(|k| three_bytes(&quad[k..]));
        if let Some(k) = [a, b, c, d].iter().position(|&v| v >= n_vertices) {
            let index = [a, b, c, d][k].into();
            return Err(face_index(at, 4, 3, IndexError::At(4 * q + k, index), n_vertices.into()));
        }
        // Split as in FreeSurfer.
        corners.extend(if a % 2 == 0 { [[a, b, d], [c, d, b]] } else { [[a, b, c], [a, c, d]] });
    }
    shape.faces = Polygons::from(corners).into();
    Ok(shape)
}
