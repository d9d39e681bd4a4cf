//! Wavefront OBJ reader.
//!
//! The parser is our own: the libraries either drop unknown statements or allocate a string for every line, so that
//! 90 MB would take many seconds. Here the bytes are split at line ends into chunks that are parsed in parallel and
//! joined in order.

use adwave::{Cancelled, Progress};
use rayon::prelude::*;

use crate::formats::obj::attributes::{CornerIndices, attach};
use crate::formats::obj::line::{Line, parse_line};
use crate::formats::obj::source::ObjSource;
use crate::model::text_rows::{DecimalMark, Separator, TextRows};
use crate::progress::all;
use crate::provenance::in_comments;
use crate::text::{is_blank, line_of};
use crate::{Direction, Edges, Format, ReadError, ReadLimits, ShapeFile};
use adwave::shape::Polygons;
use std::sync::Arc;

/// Stands for "no index" in the lists of corners.
pub(crate) const NONE: u32 = u32::MAX;

/// List that an index refers to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum IndexList {
    Vertex,
    Texcoord,
    Normal,
    EdgeEnd,
}

/// Content of one chunk of the file.
#[derive(Default)]
#[allow(clippy::struct_excessive_bools)] // one for each kind of statement that is only kept as text
pub(crate) struct Chunk {
    pub(crate) points: Vec<[f64; 3]>,
    /// Number of `points`, also after they have been moved out.
    pub(crate) n_points: usize,
    /// Start of the values of each vertex.
    pub(crate) rows: Vec<u64>,
    /// Number of vertices without z, and the position of the first.
    pub(crate) n_flat: usize,
    pub(crate) flat: Option<usize>,
    /// Values after z, for all vertices as soon as one has any.
    pub(crate) tails: Vec<[f64; 4]>,
    pub(crate) tail_len: usize,
    pub(crate) texcoords: Vec<[f64; 3]>,
    pub(crate) n_texcoord_channels: usize,
    pub(crate) normals: Vec<[f64; 3]>,
    pub(crate) face_sizes: Vec<u32>,
    pub(crate) corners: Vec<u32>,
    /// Texture coordinate of each corner: as long as `corners` as soon as one corner has an index of this kind, else
    /// empty.
    pub(crate) corner_texcoords: Vec<u32>,
    pub(crate) corner_normals: Vec<u32>,
    pub(crate) edges: Vec<u32>,
    /// Negative indices: their list, their position, and the index counted from the start of this chunk.
    pub(crate) relative: Vec<(IndexList, usize, i64)>,
    pub(crate) has_points_elements: bool,
    pub(crate) has_groups: bool,
    pub(crate) has_materials: bool,
    pub(crate) has_other: bool,
}

/// Reads an OBJ.
pub(crate) fn read_obj(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let chunks = cut(&bytes);
    let mut parsed = Vec::with_capacity(chunks.len());
    for together in chunks.chunks(CHUNKS_AT_ONCE) {
        let parse =
            |&(start, end): &(usize, usize)| progress.check().map(|()| parse_chunk(&bytes, start, end));
        let some: Result<Vec<_>, Cancelled> = match together {
            // A small file is parsed without threads.
            [one] => parse(one).map(|chunk| vec![chunk]),
            _ => together.par_iter().map(parse).collect(),
        };
        for chunk in some? {
            parsed
                .push(chunk.map_err(|(position, message)| ReadError::line_error(&bytes, position, message))?);
        }
        progress.step(together.last().map_or(0, |c| c.1) as u64, bytes.len() as u64)?;
    }
    let made = in_comments(&bytes, "# adwave");
    let mut shape = join(bytes, parsed, limits, progress)?;
    shape.provenance = made.map(Arc::new);
    Ok(shape)
}

/// Chunks parsed between two progress reports.
const CHUNKS_AT_ONCE: usize = 128;

/// Splits the file at ends of lines that are not continued.
pub(crate) fn cut(bytes: &[u8]) -> Vec<(usize, usize)> {
    const BYTES: usize = 1 << 18;
    let mut chunks = Vec::new();
    let mut start = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    while start < bytes.len() {
        // From the start of a line, where a comment can be recognized.
        let middle = (start + BYTES).min(bytes.len());
        let line = memchr::memrchr(b'\n', &bytes[start..middle]).map_or(start, |n| start + n + 1);
        let mut end = logical_end(bytes, line);
        end = (end + 1).min(bytes.len());
        chunks.push((start, end));
        start = end;
    }
    chunks
}

/// Position of the line feed that ends the line at `position`, including lines continued by `\`; or the end of the
/// bytes. A comment is not continued: comments that end in `\` end in the name of a folder.
pub(crate) fn logical_end(bytes: &[u8], mut position: usize) -> usize {
    let first = bytes[position..].iter().find(|&&b| !is_blank(b));
    if first == Some(&b'#') {
        return crate::text::line_end(bytes, position);
    }
    loop {
        let end = crate::text::line_end(bytes, position);
        let mut last = end;
        while last > 0 && is_blank(bytes[last - 1]) {
            last -= 1;
        }
        if end == bytes.len() || last == 0 || bytes[last - 1] != b'\\' {
            return end;
        }
        position = end + 1;
    }
}

pub(crate) fn parse_chunk(bytes: &[u8], start: usize, end: usize) -> Result<Chunk, (usize, String)> {
    let mut chunk = Chunk::default();
    let mut position = start;
    while position < end {
        let stop = logical_end(bytes, position);
        parse_line(&mut chunk, &Line { bytes, start: position, end: stop })?;
        position = stop + 1;
    }
    chunk.n_points = chunk.points.len();
    Ok(chunk)
}

fn join(
    bytes: Vec<u8>,
    mut chunks: Vec<Chunk>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let sum = |count: &dyn Fn(&Chunk) -> usize| chunks.iter().map(count).sum::<usize>();
    let n_vertices = sum(&|p| p.n_points);
    let n_corners = sum(&|p| p.corners.len());
    let n_faces = sum(&|p| p.face_sizes.len());
    limits.check_points(n_vertices as u64)?;
    // A planar shape has no z at all; a single missing z is an error.
    let n_flat = sum(&|p| p.n_flat);
    if let Some(start) = chunks.iter().find_map(|p| p.flat).filter(|_| n_flat < n_vertices) {
        let message = "a vertex needs 3 numbers, got 2; add the missing ones";
        return Err(ReadError::line_error(&bytes, start, message));
    }
    if n_corners >= NONE as usize {
        return Err(ReadError::Limit {
            what: "corners of faces",
            found: n_corners as u64,
            limit: NONE.into(),
        });
    }
    resolve_relative(&mut chunks, [0; 3]);

    let mut shape = ShapeFile::empty();
    shape.n_vertices = n_vertices;
    shape.format = Some(Format::OBJ);
    let edges: Vec<u32> = chunks.iter_mut().flat_map(|p| std::mem::take(&mut p.edges)).collect();
    let (points, rows, faces) = lists(&mut chunks, [n_vertices, n_faces, n_corners], progress)?;
    (shape.points, shape.faces) = (points.into(), faces.into());
    check_faces(&bytes, &shape.faces, n_vertices, progress)?;
    check_edges(&bytes, &edges, n_vertices)?;
    let (pairs, _) = edges.as_chunks::<2>();
    shape.edges = Edges { pairs: pairs.to_vec(), weights: Vec::new(), direction: Direction::Both };
    let indices = CornerIndices::join(&mut chunks, n_corners, progress)?;
    attach(&mut shape, &mut chunks, &indices, progress)?;
    for (has, what) in [
        (chunks.iter().any(|p| p.has_groups), "groups, objects and smoothing groups"),
        (chunks.iter().any(|p| p.has_materials), "materials"),
        (chunks.iter().any(|p| p.has_points_elements), "point elements"),
        (chunks.iter().any(|p| p.has_other), "statements of other kinds"),
    ] {
        if has {
            shape.extras.push(what.into());
        }
    }
    shape.set_source(ObjSource(TextRows {
        decimal: DecimalMark::Point,
        bytes,
        rows,
        columns: [0, 1, if n_flat > 0 { usize::MAX } else { 2 }],
        separator: Separator::Blanks,
        names: None,
    }));
    Ok(shape)
}

/// Converts negative indices to indices from the start of the file; those before the start become [`NONE`], which
/// exceeds any list. `before` and the result are the numbers of vertices, texture coordinates and normals before the
/// chunks and up to their end.
pub(crate) fn resolve_relative(chunks: &mut [Chunk], before: [i64; 3]) -> [i64; 3] {
    let [mut n_points, mut n_texcoords, mut n_normals] = before;
    for chunk in chunks {
        for (kind, at, local) in std::mem::take(&mut chunk.relative) {
            let (base, list) = match kind {
                IndexList::Vertex => (n_points, &mut chunk.corners),
                IndexList::Texcoord => (n_texcoords, &mut chunk.corner_texcoords),
                IndexList::Normal => (n_normals, &mut chunk.corner_normals),
                IndexList::EdgeEnd => (n_points, &mut chunk.edges),
            };
            list[at] = u32::try_from(base + local).unwrap_or(NONE);
        }
        n_points += chunk.n_points as i64;
        n_texcoords += chunk.texcoords.len() as i64;
        n_normals += chunk.normals.len() as i64;
    }
    [n_points, n_texcoords, n_normals]
}

/// Points, positions of their rows, and faces.
type JoinedLists = (Vec<[f64; 3]>, Vec<u64>, Polygons);

/// Destination of one chunk's part of each list.
struct ChunkDestination<'a> {
    /// Number of corners before the chunk.
    first: u32,
    points: &'a mut [[f64; 3]],
    rows: &'a mut [u64],
    corners: &'a mut [u32],
    ends: &'a mut [u32],
    chunk: &'a mut Chunk,
}

impl ChunkDestination<'_> {
    fn fill(self) {
        self.points.copy_from_slice(&std::mem::take(&mut self.chunk.points));
        self.rows.copy_from_slice(&std::mem::take(&mut self.chunk.rows));
        self.corners.copy_from_slice(&self.chunk.corners);
        let mut end = self.first;
        for (slot, size) in self.ends.iter_mut().zip(&self.chunk.face_sizes) {
            end += size;
            *slot = end;
        }
    }
}

/// Points, positions of their rows, and faces of all chunks, copied in parallel.
fn lists(
    chunks: &mut [Chunk],
    [n_vertices, n_faces, n_corners]: [usize; 3],
    progress: Progress<'_>,
) -> Result<JoinedLists, ReadError> {
    let mut points = vec![[0.0; 3]; n_vertices];
    let mut rows = vec![0; n_vertices];
    let mut corners = vec![0; n_corners];
    let mut offsets = vec![0; n_faces + 1];
    {
        let (mut points, mut rows) = (points.as_mut_slice(), rows.as_mut_slice());
        let (mut corners, mut ends) = (corners.as_mut_slice(), &mut offsets[1..]);
        let mut places = Vec::with_capacity(chunks.len());
        let mut first = 0;
        for chunk in chunks.iter_mut() {
            let (n, n_faces, n_corners) = (chunk.n_points, chunk.face_sizes.len(), chunk.corners.len());
            places.push(ChunkDestination {
                first,
                points: take_front(&mut points, n),
                rows: take_front(&mut rows, n),
                corners: take_front(&mut corners, n_corners),
                ends: take_front(&mut ends, n_faces),
                chunk,
            });
            first += n_corners as u32;
        }
        let copy = |place: ChunkDestination<'_>| progress.check().map(|()| place.fill());
        if places.len() == 1 {
            places.into_iter().try_for_each(copy)?;
        } else {
            places.into_par_iter().try_for_each(copy)?;
        }
    }
    let faces = Polygons::from_parts(offsets, corners).expect("sums of the sizes of the faces");
    Ok((points, rows, faces))
}

/// Splits off the first `n` items of a slice.
#[expect(clippy::mut_mut, reason = "the slice has `n` items")]
fn take_front<'a, T>(slice: &mut &'a mut [T], n: usize) -> &'a mut [T] {
    let (front, rest) = std::mem::take(slice).split_at_mut(n);
    *slice = rest;
    front
}

fn check_faces(
    bytes: &[u8],
    faces: &Polygons,
    n_vertices: usize,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let corners = faces.corners();
    if all(corners.len(), progress, |k| (corners[k] as usize) < n_vertices)? {
        return Ok(());
    }
    let face = faces.iter().position(|f| f.iter().any(|&c| c as usize >= n_vertices)).unwrap_or(0);
    let corner = faces.get(face).iter().position(|&c| c as usize >= n_vertices).unwrap_or(0);
    Err(face_index_error(bytes, face, corner, n_vertices))
}

/// Position of a face, and the index written for its corner. Both are searched only for an error, so that reading
/// need not keep them.
pub(crate) fn corner_as_written(bytes: &[u8], face: usize, corner: usize) -> (usize, i64) {
    let (position, line) = statements(bytes, b"f").nth(face).unwrap_or((0, b""));
    let word = crate::formats::obj::line::words(line).nth(corner + 1).unwrap_or(b"");
    let number = word.split(|&b| b == b'/').next().unwrap_or(b"");
    (position, std::str::from_utf8(number).ok().and_then(|t| t.parse().ok()).unwrap_or(0))
}

/// Creates the error for a corner's index.
fn face_index_error(bytes: &[u8], face: usize, corner: usize, n_vertices: usize) -> ReadError {
    let (position, index) = corner_as_written(bytes, face, corner);
    ReadError::FaceIndex {
        place: format!("line {}", line_of(bytes, position)),
        face: face as u64,
        index,
        n_vertices: n_vertices as u64,
    }
}

fn check_edges(bytes: &[u8], edges: &[u32], n_vertices: usize) -> Result<(), ReadError> {
    if edges.iter().all(|&v| (v as usize) < n_vertices) {
        return Ok(());
    }
    let bad = |line: &[u8]| {
        crate::formats::obj::line::words(line).skip(1).any(|w| {
            let number = w.split(|&b| b == b'/').next().unwrap_or(b"");
            let index: i64 = std::str::from_utf8(number).ok().and_then(|t| t.parse().ok()).unwrap_or(0);
            index.unsigned_abs() > n_vertices as u64
        })
    };
    let position = statements(bytes, b"l").find(|(_, line)| bad(line)).map_or(0, |(position, _)| position);
    Err(ReadError::line_error(
        bytes,
        position,
        format!("a line element must name one of the {n_vertices} vertices; correct it"),
    ))
}

/// Statements that begin with a keyword: their positions and whole lines.
fn statements<'a>(bytes: &'a [u8], keyword: &'a [u8]) -> impl Iterator<Item = (usize, &'a [u8])> {
    let mut position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    std::iter::from_fn(move || {
        while position < bytes.len() {
            let start = position;
            let end = logical_end(bytes, start);
            position = end + 1;
            let line = &bytes[start..end];
            if crate::formats::obj::line::words(line).next() == Some(keyword) {
                return Some((start, line));
            }
        }
        None
    })
}
