//! Statements of an OBJ in blocks.

use adwave::shape::Polygons;
use rayon::prelude::*;

use super::window::Window;
use crate::ReadError;
use crate::formats::obj::read::{Chunk, corner_as_written, cut, logical_end, parse_chunk, resolve_relative};

pub(in crate::mesh_stream) struct ObjStream {
    pub(super) window: Window,
    /// Numbers of vertices, texture coordinates and normals read so far: the base of negative indices.
    before: [i64; 3],
    n_faces: u64,
    n_flat: u64,
    /// Line of the first vertex without z.
    flat: Option<u64>,
}

/// Statements in the window.
pub(super) struct Statements {
    pub(super) chunks: Vec<Chunk>,
    /// Size of the statements in bytes.
    pub(super) n_bytes: usize,
}

impl ObjStream {
    pub(super) fn new(window: Window) -> Self {
        Self { window, before: [0; 3], n_faces: 0, n_flat: 0, flat: None }
    }

    pub(super) fn n_faces(&self) -> u64 {
        self.n_faces
    }

    /// Reads the next complete statements; `None` at the end, where it is known whether all vertices have a z or
    /// none.
    pub(super) fn statements(&mut self) -> Result<Option<Statements>, ReadError> {
        let n_bytes = loop {
            let n_bytes = whole_statements(&self.window);
            if n_bytes > 0 {
                break n_bytes;
            }
            if self.window.is_end() {
                return match self.flat.filter(|_| self.n_flat < self.before[0].unsigned_abs()) {
                    Some(line) => {
                        let message = "a vertex needs 3 numbers, got 2; add the missing ones".to_string();
                        Err(ReadError::Line { line, message })
                    }
                    None => Ok(None),
                };
            }
            self.window.more()?;
        };
        let bytes = &self.window.rest()[..n_bytes];
        let parsed: Vec<_> =
            cut(bytes).into_par_iter().map(|(start, end)| parse_chunk(bytes, start, end)).collect();
        let wrong = |(at, message)| self.window.placed(ReadError::in_line(bytes, at, message));
        let mut chunks = parsed.into_iter().collect::<Result<Vec<_>, _>>().map_err(wrong)?;
        self.before = resolve_relative(&mut chunks, self.before);
        if self.flat.is_none() {
            self.flat = chunks.iter().find_map(|chunk| chunk.flat).map(|at| self.window.line(at));
        }
        self.n_flat += chunks.iter().map(|chunk| chunk.n_flat as u64).sum::<u64>();
        Ok(Some(Statements { chunks, n_bytes }))
    }

    pub(super) fn consume(&mut self, statements: &Statements) {
        self.n_faces += statements.chunks.iter().map(|chunk| chunk.face_sizes.len() as u64).sum::<u64>();
        self.window.consume(statements.n_bytes);
    }

    pub(super) fn vertices(&mut self, points: &mut Vec<[f64; 3]>) -> Result<bool, ReadError> {
        let Some(statements) = self.statements()? else { return Ok(false) };
        statements.chunks.iter().for_each(|chunk| points.extend(&chunk.points));
        self.consume(&statements);
        Ok(true)
    }

    pub(super) fn faces(&mut self, n_vertices: u64, faces: &mut Polygons) -> Result<bool, ReadError> {
        let Some(statements) = self.statements()? else { return Ok(false) };
        let mut face = 0;
        for chunk in &statements.chunks {
            let mut corners = &chunk.corners[..];
            for &size in &chunk.face_sizes {
                let (own, rest) = corners.split_at(size as usize);
                corners = rest;
                if let Some(corner) = own.iter().position(|&v| u64::from(v) >= n_vertices) {
                    let bytes = &self.window.rest()[..statements.n_bytes];
                    let (at, index) = corner_as_written(bytes, face, corner);
                    let (place, face) = (self.window.place(at), self.n_faces + face as u64);
                    return Err(ReadError::FaceIndex { place, face, index, n_vertices });
                }
                faces.push(own);
                face += 1;
            }
        }
        self.consume(&statements);
        Ok(true)
    }
}

/// Size of the window up to the end of its last line without a continuation, in bytes.
fn whole_statements(window: &Window) -> usize {
    let bytes = window.rest();
    if window.is_end() {
        return bytes.len();
    }
    for end in memchr::memrchr_iter(b'\n', bytes) {
        let line = memchr::memrchr(b'\n', &bytes[..end]).map_or(0, |before| before + 1);
        if logical_end(bytes, line) == end {
            return end + 1;
        }
    }
    0
}
