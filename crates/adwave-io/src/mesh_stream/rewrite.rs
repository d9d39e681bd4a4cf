//! Rewriting of a mesh in blocks: new coordinates, and for a PLY new properties of its vertices.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use adwave::Progress;

use super::StreamSource;
use super::obj::ObjStream;
use super::ply::PlyStream;
use crate::formats::ply::header::Element;
use crate::formats::ply::update::{RowWriter, write_header};
use crate::model::text_rows::{DecimalMark, RowEdit, Separator, TextRows};
use crate::{Field, FieldValues, Format, ReadError, ShapeFile, WriteError};

/// Callback of [`rewrite_mesh`]: sets the new coordinates of the next vertices, and their values of each new field.
pub type VertexEdit<'a, E> = dyn FnMut(&mut [[f64; 3]], &mut [Vec<f32>]) -> Result<(), E> + 'a;

/// Writes a PLY or OBJ again in its own format. Coordinates are replaced in their own type, `fields` become the last
/// properties of the vertices, as 32-bit floats, and all other bytes stay unchanged. Returns the number of vertices.
///
/// `edit` is called with the next vertices, about ten thousand. Their coordinates are NaN initially; those that are
/// still NaN afterwards stay unchanged in the file. The values of each field are 0 initially.
///
/// ```
/// use adwave::Progress;
/// use adwave_io::{WriteError, rewrite_mesh};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.obj");
/// std::fs::write(&path, "# two\nv 0 0 0\nv 1.50 0 0 # stays\n").unwrap();
/// let mut out = Vec::new();
/// let n = rewrite_mesh::<Box<dyn std::error::Error>>(&path, &[], &mut out, Progress::none(), &mut |points, _| {
///     points[0] = [0.5, f64::NAN, 0.25];
///     Ok(())
/// });
/// assert_eq!(n.unwrap(), 2);
/// assert_eq!(String::from_utf8(out).unwrap(), "# two\nv 0.5 0 0.25\nv 1.50 0 0 # stays\n");
/// ```
///
/// # Errors
/// The errors of `edit`, of reading and of writing, and fields for an OBJ, which cannot store any.
pub fn rewrite_mesh<E: From<ReadError> + From<WriteError>>(
    path: &Path,
    fields: &[String],
    out: &mut dyn Write,
    progress: Progress<'_>,
    edit: &mut VertexEdit<'_, E>,
) -> Result<u64, E> {
    match StreamSource::open(path).map_err(|e| e.in_file(path))? {
        StreamSource::Ply(ply) => Rewriter { path, fields, out, progress }.ply(*ply, edit),
        StreamSource::Obj(_) if !fields.is_empty() => {
            let what = format!("the vertex field `{}`", fields[0]);
            Err(WriteError::CannotHold { format: Format::OBJ, what }.into())
        }
        StreamSource::Obj(obj) => Rewriter { path, fields, out, progress }.obj(*obj, edit),
    }
}

struct Rewriter<'a> {
    path: &'a Path,
    fields: &'a [String],
    out: &'a mut dyn Write,
    progress: Progress<'a>,
}

impl Rewriter<'_> {
    fn read_error(&self, error: ReadError) -> ReadError {
        error.in_file(self.path)
    }

    fn ply<E: From<ReadError> + From<WriteError>>(
        mut self,
        mut ply: PlyStream,
        edit: &mut VertexEdit<'_, E>,
    ) -> Result<u64, E> {
        let Some(vertex) = ply.vertex else {
            self.copy(0, ply.window.n_bytes()).map_err(WriteError::from)?;
            return Ok(0);
        };
        let element: Element = ply.header.elements[vertex].clone();
        let is_replaced = |name: &String| self.fields.contains(name);
        let dropped: Vec<bool> = element.properties.iter().map(|p| is_replaced(&p.name)).collect();
        let none = self.portion(0);
        let lines: Vec<&Field> = none.iter().collect();
        write_header(&ply.head, &ply.header, vertex, &dropped, &lines, self.out).map_err(WriteError::from)?;
        let mut n = 0;
        // Elements before the vertices.
        let has_rows = ply.seek(|e, _| e == vertex).map_err(|e| self.read_error(e))?;
        let start = if has_rows { ply.window.position() } else { ply.window.n_bytes() };
        self.copy(ply.head.len() as u64, start).map_err(WriteError::from)?;
        let writer = RowWriter::new(&element, ply.header.encoding, &dropped);
        let (mut text, mut points) = (Vec::new(), Vec::new());
        while n < element.n_rows {
            self.progress.step(n, element.n_rows).map_err(WriteError::from)?;
            let rows = ply.rows().map_err(|e| self.read_error(e))?;
            points.clear();
            points.resize(rows.n as usize, [f64::NAN; 3]);
            let mut values = vec![vec![0.0; points.len()]; self.fields.len()];
            edit(&mut points, &mut values)?;
            let mut portion = self.portion(0);
            for (field, values) in portion.iter_mut().zip(values) {
                field.values = FieldValues::F32(values);
            }
            let portion: Vec<&Field> = portion.iter().collect();
            let mut body = ply.body(&ply.window.rest()[..rows.n_bytes]);
            text.clear();
            for (i, point) in points.iter().enumerate() {
                let point = point.map(|x| (!x.is_nan()).then_some(x));
                let pushed = writer.push(&mut body, n + i as u64, point, &mut text);
                pushed.map_err(|e| self.read_error(e))?;
                writer.push_fields(&portion, i, &mut text);
            }
            self.out.write_all(&text).map_err(WriteError::from)?;
            ply.consume(rows);
            n += rows.n;
        }
        if has_rows {
            self.copy(ply.window.position(), ply.window.n_bytes()).map_err(WriteError::from)?;
        }
        Ok(n)
    }

    /// Creates the new fields of `n` vertices, without values.
    fn portion(&self, n: usize) -> Vec<Field> {
        let field = |name: &String| Field::new(name.clone(), 1, FieldValues::F32(vec![0.0; n]));
        self.fields.iter().map(field).collect()
    }

    fn obj<E: From<ReadError> + From<WriteError>>(
        self,
        mut obj: ObjStream,
        edit: &mut VertexEdit<'_, E>,
    ) -> Result<u64, E> {
        let mut n = 0;
        while let Some(statements) = obj.statements().map_err(|e| self.read_error(e))? {
            self.progress.step(obj.window.position(), obj.window.n_bytes()).map_err(WriteError::from)?;
            let old: Vec<[f64; 3]> =
                statements.chunks.iter().flat_map(|chunk| chunk.points.iter().copied()).collect();
            let mut points = vec![[f64::NAN; 3]; old.len()];
            edit(&mut points, &mut [])?;
            for (new, old) in points.as_flattened_mut().iter_mut().zip(old.as_flattened()) {
                *new = if new.is_nan() { *old } else { *new };
            }
            n += points.len() as u64;
            let is_flat = statements.chunks.iter().any(|chunk| chunk.n_flat > 0);
            let rows = TextRows {
                decimal: DecimalMark::Point,
                bytes: obj.window.to_vec(statements.n_bytes),
                rows: statements.chunks.iter().flat_map(|chunk| chunk.rows.iter().copied()).collect(),
                columns: [0, 1, if is_flat { usize::MAX } else { 2 }],
                separator: Separator::Blanks,
                names: None,
            };
            let shape = ShapeFile::from_cloud(points);
            rows.write_all(&shape, &RowEdit::default(), self.out, Progress::none())?;
            obj.consume(&statements);
        }
        Ok(n)
    }

    /// Copies bytes `from..to` of the file.
    fn copy(&mut self, from: u64, to: u64) -> std::io::Result<()> {
        /// Bytes copied between two checks for cancellation.
        const AT_A_TIME: u64 = 1 << 24;
        let mut file = File::open(self.path)?;
        file.seek(SeekFrom::Start(from))?;
        let mut left = to.saturating_sub(from);
        while left > 0 {
            self.progress.check().map_err(std::io::Error::other)?;
            let n = std::io::copy(&mut (&mut file).take(AT_A_TIME.min(left)), self.out)?;
            if n == 0 {
                return Err(std::io::ErrorKind::UnexpectedEof.into());
            }
            left -= n;
        }
        Ok(())
    }
}
