//! Medit in binary, versions 1 to 4: 32-bit floats in version 1, 64-bit positions from version 3 on, 64-bit integers
//! in version 4.

use adwave::Progress;

use crate::bytes::cursor::Cursor;
use crate::formats::medit::read::{KeywordContent, MeditContent, NONE, content_of};
use crate::formats::medit::write::MeditSource;
use crate::model::binary_rows::CoordinateRows;
use crate::model::binary_rows::{BinaryRows, Run};
use crate::model::field::{ByteOrder, Number};
use crate::progress::{all, extend};
use crate::{CoordinatePrecision, Format, ReadError, ReadLimits, ShapeFile};

/// Byte order of a binary Medit file, or `None` if the bytes do not begin like one. The dimension has to follow
/// first, because an MGH of a few vertices begins in the same way.
pub(crate) fn begins_as_meshb(bytes: &[u8]) -> Option<ByteOrder> {
    const DIMENSION: i32 = 3;
    let head = bytes.get(..12)?;
    [ByteOrder::Little, ByteOrder::Big].into_iter().find(|&order| {
        let number = |at: usize| i32::from_bytes(&head[at..], order);
        number(0) == 1 && (1..=4).contains(&number(4)) && number(8) == DIMENSION
    })
}

/// Read position in the file, and its version.
struct MeditInput<'a> {
    cursor: Cursor<'a>,
    version: i32,
    dimension: usize,
}

impl MeditInput<'_> {
    /// Size of a reference, an index or a count in bytes.
    fn n_whole_bytes(&self) -> usize {
        if self.version >= 4 { 8 } else { 4 }
    }

    /// Reads a count or the position of the next keyword.
    fn integer(&mut self, n_bytes: usize, element: &str) -> Result<i64, ReadError> {
        if n_bytes == 8 { self.cursor.number(element, 0) } else { self.cursor.i32(element).map(i64::from) }
    }
}

fn whole_at(bytes: &[u8], n_bytes: usize, order: ByteOrder) -> i64 {
    if n_bytes == 8 { i64::from_bytes(bytes, order) } else { i32::from_bytes(bytes, order).into() }
}

/// Reads a Medit mesh in binary.
pub(crate) fn read_meshb(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let order = begins_as_meshb(&bytes).ok_or_else(|| {
        ReadError::byte_error(0, "the head of a binary Medit mesh is invalid; get the file again")
    })?;
    let version = i32::from_bytes(&bytes[4..], order);
    let mut input = MeditInput { cursor: Cursor::new(&bytes, 8, order), version, dimension: 3 };
    let mut found = MeditContent::default();
    let mut run = None;
    loop {
        progress.check()?;
        let start = input.cursor.position;
        let keyword = input.cursor.i32("keyword")?;
        let next = input.integer(if version >= 3 { 8 } else { 4 }, "keyword")?;
        match content_of(keyword) {
            Some(KeywordContent::End) => break,
            Some(KeywordContent::Dimension) => {
                let dimension = input.cursor.i32("the dimension")?;
                if !matches!(dimension, 2 | 3) {
                    let message =
                        format!("points must have dimension 2 or 3, got {dimension}; save them as 3");
                    return Err(ReadError::byte_error(start, message));
                }
                input.dimension = dimension as usize;
            }
            Some(KeywordContent::Vertices) if run.is_none() => {
                run = Some(vertices(&mut input, &mut found, limits, progress)?);
            }
            Some(content) if content != KeywordContent::Vertices => {
                elements(&mut input, &mut found, content, progress)?;
            }
            _ => found.has_other = true,
        }
        if next == 0 {
            break;
        }
        let next = usize::try_from(next).ok().filter(|&n| n >= input.cursor.position && n <= bytes.len());
        let Some(next) = next else {
            let message = "the position of the next keyword lies outside the file; get the whole file";
            return Err(ReadError::byte_error(start + 4, message));
        };
        input.cursor.position = next;
    }
    let Some(run) = run else {
        return Err(ReadError::Whole("the Medit mesh has no vertices; get the whole file".into()));
    };
    let n_axes = input.dimension;
    let is_flat = n_axes == 2;
    let mut shape = found.into_shape(Format::MEDIT_BINARY, progress)?;
    shape.precision = if version == 1 { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 };
    let rows =
        CoordinateRows::Binary(BinaryRows { bytes, runs: vec![run], is_double: version > 1, n_axes, order });
    shape.set_source(MeditSource { rows, is_flat });
    Ok(shape)
}

fn vertices(
    input: &mut MeditInput<'_>,
    found: &mut MeditContent,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Run, ReadError> {
    let n_whole = input.n_whole_bytes();
    let n = count(input, n_whole, "the number of vertices")?;
    limits.check_points(n)?;
    let n_float = if input.version == 1 { 4 } else { 8 };
    let (dimension, order) = (input.dimension, input.cursor.order);
    let stride = n_float * dimension + n_whole;
    let start = input.cursor.position;
    let rows = input.cursor.rows(n, stride as u64, "vertex")?;
    extend(&mut found.points, n as usize, progress, |i| {
        let mut point = [0.0; 3];
        for (axis, x) in point[..dimension].iter_mut().enumerate() {
            let bytes = &rows[stride * i + n_float * axis..];
            *x = if n_float == 4 {
                f32::from_bytes(bytes, order).into()
            } else {
                f64::from_bytes(bytes, order)
            };
        }
        point
    })?;
    let reference = |i: usize| whole_at(&rows[stride * i + n_float * dimension..], n_whole, order);
    extend(&mut found.of_points, n as usize, progress, reference)?;
    Ok(Run { start, n: n as usize, stride })
}

fn count(input: &mut MeditInput<'_>, n_bytes: usize, what: &str) -> Result<u64, ReadError> {
    let start = input.cursor.position;
    let n = input.integer(n_bytes, what)?;
    u64::try_from(n).map_err(|_| {
        ReadError::byte_error(start, format!("{what} must not be negative; get an undamaged file"))
    })
}

fn elements(
    input: &mut MeditInput<'_>,
    found: &mut MeditContent,
    content: KeywordContent,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n_whole = input.n_whole_bytes();
    let n = count(input, n_whole, "the number of elements")?;
    let (KeywordContent::Edges(n_nodes)
    | KeywordContent::Faces(_, n_nodes)
    | KeywordContent::Cells(_, n_nodes)) = content
    else {
        return Ok(());
    };
    let stride = n_whole * (n_nodes + 1);
    let (start, order) = (input.cursor.position, input.cursor.order);
    let rows = input.cursor.rows(n, stride as u64, "element")?;
    let n_vertices = found.points.len();
    let (corners, references, n_corners) = found.begin(content, n as usize);
    let place = |k: usize| stride * (k / n_corners) + n_whole * (k % n_corners);
    let first = corners.len();
    extend(corners, n as usize * n_corners, progress, |k| {
        let index = whole_at(&rows[place(k)..], n_whole, order);
        let is_there = index >= 1 && index as u64 <= n_vertices as u64;
        if is_there { index as u32 - 1 } else { NONE }
    })?;
    let own = &corners[first..];
    if !all(own.len(), progress, |k| own[k] != NONE)? {
        let k = own.iter().position(|&v| v == NONE).unwrap_or(0);
        return Err(ReadError::FaceIndex {
            place: format!("byte {}", start + place(k)),
            face: (k / n_corners) as u64,
            index: whole_at(&rows[place(k)..], n_whole, order),
            n_vertices: n_vertices as u64,
        });
    }
    if let Some(list) = references {
        extend(list, n as usize, progress, |i| {
            whole_at(&rows[stride * i + n_whole * n_nodes..], n_whole, order)
        })?;
    }
    Ok(())
}
