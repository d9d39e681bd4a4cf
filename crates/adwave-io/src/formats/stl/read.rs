//! Reader of stereolithography, text and binary: a soup of triangles, each with its own three vertices.

use std::sync::Arc;

use crate::model::source_document::SourceDocument;
use crate::progress::{all, collect, report_row};
use crate::text::lines::{Statement, Statements};
use crate::text::{parse_f64, show, words};
use crate::{CoordinatePrecision, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};
use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

const HEADER: usize = 84;
const RECORD: usize = 50;

/// Content kept from an STL.
#[derive(Debug)]
pub(crate) struct StlSource {
    /// The 80 bytes before a binary STL's triangles.
    pub(crate) header: Vec<u8>,
    /// Lines that begin the solids of a text.
    pub(crate) solids: Vec<Vec<u8>>,
    /// Original points, which the normals belong to.
    pub(crate) points: Arc<Vec<[f64; 3]>>,
}

impl SourceDocument for StlSource {
    /// The header and the solids; the normals of triangles are those of other vertices.
    fn computes_face_normals(&self) -> bool {
        true
    }

    fn with_turned_faces(&self, _: &[bool]) -> Option<Arc<dyn SourceDocument>> {
        let (header, solids, points) = (self.header.clone(), self.solids.clone(), Arc::clone(&self.points));
        Some(Arc::new(Self { header, solids, points }))
    }

    fn subset(&self, _: &[u32]) -> Option<Arc<dyn SourceDocument>> {
        let (header, solids) = (self.header.clone(), self.solids.clone());
        Some(Arc::new(Self { header, solids, points: Arc::default() }))
    }
}

/// Number of triangles stated in a binary STL.
pub(crate) fn binary_count(bytes: &[u8]) -> Option<u64> {
    let field = bytes.get(80..HEADER)?;
    Some(u64::from(u32::from_le_bytes([field[0], field[1], field[2], field[3]])))
}

/// Creates triangles with three vertices each, in order.
fn soup(points: Vec<[f64; 3]>, progress: Progress<'_>) -> Result<ShapeFile, Cancelled> {
    let corners: Vec<u32> = collect(points.len(), progress, |v| v as u32)?;
    let offsets = collect(points.len() / 3 + 1, progress, |f| 3 * f as u32)?;
    let faces = Polygons::from_parts(offsets, corners).expect("triangles have three corners");
    Ok(ShapeFile::from_mesh(points, faces))
}

/// Reads a binary STL.
pub(crate) fn read_stl(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let Some(n) = binary_count(bytes) else {
        return Err(ReadError::Truncated {
            end: bytes.len() as u64,
            needed: HEADER as u64,
            element: "header".into(),
            row: 0,
        });
    };
    let needed = HEADER as u64 + RECORD as u64 * n;
    if (bytes.len() as u64) < needed {
        let row = ((bytes.len() - HEADER) / RECORD) as u64;
        return Err(ReadError::Truncated {
            end: bytes.len() as u64,
            needed,
            element: "triangle".into(),
            row,
        });
    }
    limits.check_points(3 * n)?;
    let (records, _) = bytes[HEADER..needed as usize].as_chunks::<RECORD>();
    let n = records.len();
    // Each record has the normal, then three corners.
    let triple = |f: usize, part: usize| -> [f32; 3] {
        let at = |c: usize| 12 * part + 4 * c;
        std::array::from_fn(|c| f32::from_le_bytes(std::array::from_fn(|b| records[f][at(c) + b])))
    };
    let attribute = |f: usize| u16::from_le_bytes([records[f][48], records[f][49]]);
    let points = collect(3 * n, progress, |v| triple(v / 3, 1 + v % 3).map(f64::from))?;
    let normals = collect(n, progress, |f| triple(f, 0))?.into_flattened();
    let mut shape = soup(points, progress)?;
    shape.format = Some(Format::STL);
    shape.precision = CoordinatePrecision::F32;
    shape.face_fields.push(Field::new("normal", 3, FieldValues::F32(normals)));
    if !all(n, progress, |f| attribute(f) == 0)? {
        let attributes = collect(n, progress, attribute)?;
        shape.face_fields.push(Field::new("attribute", 1, FieldValues::U16(attributes)));
    }
    if bytes.len() as u64 > needed {
        shape.extras.push("bytes after the last triangle".into());
    }
    let (header, points) = (bytes[..80].to_vec(), shape.shared_points());
    shape.set_source(StlSource { header, solids: Vec::new(), points });
    Ok(shape)
}

/// Reads a text STL. Only the first word of a line counts, because names of solids are arbitrary.
pub(crate) fn read_stl_ascii(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut points = Vec::new();
    let mut normals = Vec::new();
    let mut solids: Vec<u32> = Vec::new();
    let mut n_solids = 0_u32;
    let mut in_facet = 0;
    let mut names: Vec<Vec<u8>> = Vec::new();
    let mut ended = true;
    for (row, line) in Statements::new(bytes).enumerate() {
        report_row(progress, row as u64, 0)?;
        let mut values = words(line.text);
        let keyword = values.next().unwrap_or(b"").to_ascii_lowercase();
        match keyword.as_slice() {
            b"solid" => {
                names.push(line.text.to_vec());
                n_solids += 1;
                ended = false;
            }
            b"facet" => {
                let normal = if values.next().is_some() { numbers(bytes, &line, values)? } else { [0.0; 3] };
                normals.extend(normal);
                solids.push(n_solids.saturating_sub(1));
                in_facet = 0;
            }
            b"vertex" => {
                in_facet += 1;
                if in_facet > 3 || normals.is_empty() {
                    let message = "a facet must have three vertices; remove the additional one";
                    return Err(ReadError::line_error(bytes, line.start, message));
                }
                points.push(numbers(bytes, &line, values)?);
            }
            b"endfacet" => {
                if in_facet != 3 {
                    let message =
                        format!("a facet needs three vertices, got {in_facet}; add the missing ones");
                    return Err(ReadError::line_error(bytes, line.start, message));
                }
                in_facet = 0;
            }
            b"endsolid" => ended = true,
            b"outer" | b"endloop" | b"color" => {}
            other => {
                let message = format!("{} is not a keyword of a text STL; correct it", show(other));
                return Err(ReadError::line_error(bytes, line.start, message));
            }
        }
    }
    if points.len() != normals.len() || (!ended && in_facet > 0) {
        let message =
            format!("the file ends inside facet {}; get the whole file", solids.len().saturating_sub(1));
        return Err(ReadError::line_error(bytes, bytes.len(), message));
    }
    limits.check_points(points.len() as u64)?;
    let mut shape = soup(points, progress)?;
    shape.format = Some(Format::STL_ASCII);
    shape.face_fields.push(Field::new("normal", 3, FieldValues::F64(normals)));
    if n_solids > 1 {
        shape.face_fields.push(Field::new("solid", 1, FieldValues::U32(solids)));
        shape.extras.push("names of solids".into());
    }
    let points = shape.shared_points();
    shape.set_source(StlSource { header: Vec::new(), solids: names, points });
    Ok(shape)
}

fn numbers<'a>(
    bytes: &[u8],
    line: &Statement<'_>,
    mut values: impl Iterator<Item = &'a [u8]>,
) -> Result<[f64; 3], ReadError> {
    let mut xyz = [0.0; 3];
    for x in &mut xyz {
        let word = values.next().unwrap_or(b"");
        *x = parse_f64(word).ok_or_else(|| {
            let message = format!("expected three numbers, got {}; correct it", show(word));
            ReadError::line_error(bytes, line.start, message)
        })?;
    }
    Ok(xyz)
}
