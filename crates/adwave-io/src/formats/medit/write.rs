//! Medit writer: the original with new coordinates, or a new file.

use crate::model::context::WriteContext;
use crate::model::source_document::SourceDocument;
use crate::model::source_document::Update;
use std::io::Write;

use adwave::Progress;

use crate::model::binary_rows::CoordinateRows;
use crate::progress::report_row;
use crate::text::push_f64;
use crate::{CoordinatePrecision, Field, Format, ShapeFile, WriteError, WriteReport};

/// Content kept from a Medit mesh for its update.
#[derive(Debug)]
pub(crate) struct MeditSource {
    pub(crate) rows: CoordinateRows,
    /// True if points have two coordinates.
    pub(crate) is_flat: bool,
}

impl SourceDocument for MeditSource {
    /// Writes the original with other coordinates, if it can store the changes.
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let is_new = |name: &String| name == "reference";
        let left_the_plane = self.is_flat && shape.points.iter().any(|p| p[2] != 0.0);
        if left_the_plane || shape.edited.iter().any(is_new) {
            return Ok(Update::DoesNotFit);
        }
        for name in &shape.edited {
            context.report.report_dropped(format!("vertex field `{name}`"));
        }
        self.rows.write_all(shape, context)?;
        Ok(Update::Written)
    }
}

/// A keyword of the text and its number in a binary file.
#[derive(Clone, Copy)]
struct Keyword {
    name: &'static str,
    number: i32,
}

/// Field of 32-bit integers that becomes the references.
fn references(fields: &[Field]) -> Option<&Field> {
    fields.iter().find(|f| {
        let fits = |i: usize| i32::try_from(f.values.get(i) as i64).is_ok();
        let is_whole = f.values.value_type().is_integer() && (0..f.values.len()).all(fits);
        f.name == "reference" && f.n_channels == 1 && is_whole
    })
}

/// Writes a new file: vertices, then triangles, then quadrilaterals.
pub(crate) fn write_medit(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let of_points = references(&shape.vertex_fields);
    let is_whole = shape.faces.iter().all(|f| matches!(f.len(), 3 | 4));
    let of_faces = references(&shape.face_fields).filter(|_| is_whole);
    report.report_vertex_fields(shape, of_points.map(|_| "reference").as_slice());
    report.report_face_fields(shape, of_faces.map(|_| "reference").as_slice());
    if !shape.faces.is_empty() && !shape.edges.pairs.is_empty() {
        report.report_dropped("edges");
    } else if !shape.edges.weights.is_empty() {
        report.report_dropped("weights of edges");
    }
    let reference = |field: Option<&Field>, i: usize| field.map_or(0, |f| f.values.get(i) as i32);
    let (mut triangles, mut quadrilaterals) = (Vec::new(), Vec::new());
    for (f, face) in shape.faces.iter().enumerate() {
        report_row(progress, f as u64, shape.faces.len() as u64)?;
        match *face {
            [a, b, c] => {
                if !quadrilaterals.is_empty() {
                    report.report_dropped("the order of faces (triangles come first)");
                }
                triangles.push(([a, b, c], reference(of_faces, f)));
            }
            [a, b, c, d] => quadrilaterals.push(([a, b, c, d], reference(of_faces, f))),
            [first, .., _] if face.len() > 4 => {
                report.report_dropped("polygons (as triangles)");
                triangles.extend(face.windows(2).skip(1).map(|w| ([first, w[0], w[1]], 0)));
            }
            _ => report.report_dropped("faces of fewer than three corners"),
        }
    }
    let edges: Vec<([u32; 2], i32)> = if shape.faces.is_empty() {
        shape.edges.pairs.iter().map(|&pair| (pair, 0)).collect()
    } else {
        Vec::new()
    };
    let n = shape.points.len().max(triangles.len()).max(quadrilaterals.len()).max(edges.len());
    if i32::try_from(n).is_err() {
        return Err(WriteError::CannotHold { format, what: "2^31 vertices or faces".into() });
    }
    let n_bytes =
        40 * shape.points.len() + 16 * triangles.len() + 20 * quadrilaterals.len() + 12 * edges.len();
    let is_single = shape.precision == CoordinatePrecision::F32;
    let version = if n_bytes > 1 << 30 { 3 } else { 2 - i32::from(is_single) };
    let mut writer =
        MeditWriter { is_binary: format == Format::MEDIT_BINARY, version, position: 0, out, progress };
    writer.head()?;
    writer.vertices(shape, |i| reference(of_points, i))?;
    writer.elements(Keyword { name: "Edges", number: 5 }, &edges)?;
    writer.elements(Keyword { name: "Triangles", number: 6 }, &triangles)?;
    writer.elements(Keyword { name: "Quadrilaterals", number: 7 }, &quadrilaterals)?;
    writer.end()
}

struct MeditWriter<'a, 'p> {
    is_binary: bool,
    version: i32,
    /// Bytes written to a binary file so far.
    position: u64,
    out: &'a mut dyn Write,
    progress: Progress<'p>,
}

impl MeditWriter<'_, '_> {
    fn head(&mut self) -> Result<(), WriteError> {
        if !self.is_binary {
            return Ok(writeln!(self.out, "MeshVersionFormatted 2\nDimension 3")?);
        }
        self.put(&[1_i32.to_le_bytes(), self.version.to_le_bytes()].concat())?;
        let after = self.position + 4 + self.n_place_bytes() + 4;
        self.put(&3_i32.to_le_bytes())?;
        self.place(after)?;
        self.put(&3_i32.to_le_bytes())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        self.position += bytes.len() as u64;
        Ok(self.out.write_all(bytes)?)
    }

    fn n_place_bytes(&self) -> u64 {
        if self.version >= 3 { 8 } else { 4 }
    }

    fn place(&mut self, position: u64) -> Result<(), WriteError> {
        if self.version >= 3 {
            return self.put(&position.to_le_bytes());
        }
        self.put(&(position as u32).to_le_bytes())
    }

    /// Begins `n` rows of `row_bytes` each.
    fn begin(&mut self, keyword: Keyword, n: usize, row_bytes: usize) -> Result<(), WriteError> {
        if !self.is_binary {
            return Ok(writeln!(self.out, "\n{}\n{n}", keyword.name)?);
        }
        let after = self.position + 4 + self.n_place_bytes() + 4 + (n * row_bytes) as u64;
        self.put(&keyword.number.to_le_bytes())?;
        self.place(after)?;
        self.put(&(n as i32).to_le_bytes())
    }

    fn vertices(&mut self, shape: &ShapeFile, reference: impl Fn(usize) -> i32) -> Result<(), WriteError> {
        let is_single = self.version == 1;
        self.begin(
            Keyword { name: "Vertices", number: 4 },
            shape.points.len(),
            if is_single { 16 } else { 28 },
        )?;
        let mut row = Vec::new();
        for (i, point) in shape.points.iter().enumerate() {
            report_row(self.progress, i as u64, shape.points.len() as u64)?;
            row.clear();
            if self.is_binary {
                for &x in point {
                    if is_single {
                        row.extend_from_slice(&(x as f32).to_le_bytes());
                    } else {
                        row.extend_from_slice(&x.to_le_bytes());
                    }
                }
                row.extend_from_slice(&reference(i).to_le_bytes());
            } else {
                for &x in point {
                    push_f64(&mut row, x);
                    row.push(b' ');
                }
                writeln!(row, "{}", reference(i))?;
            }
            self.put(&row)?;
        }
        Ok(())
    }

    fn elements<const N: usize>(
        &mut self,
        keyword: Keyword,
        rows: &[([u32; N], i32)],
    ) -> Result<(), WriteError> {
        if rows.is_empty() {
            return Ok(());
        }
        self.begin(keyword, rows.len(), 4 * (N + 1))?;
        let mut row = Vec::new();
        for (i, (corners, reference)) in rows.iter().enumerate() {
            report_row(self.progress, i as u64, rows.len() as u64)?;
            row.clear();
            if self.is_binary {
                row.extend(corners.iter().flat_map(|v| (v + 1).to_le_bytes()));
                row.extend_from_slice(&reference.to_le_bytes());
            } else {
                for v in corners {
                    write!(row, "{} ", v + 1)?;
                }
                writeln!(row, "{reference}")?;
            }
            self.put(&row)?;
        }
        Ok(())
    }

    fn end(&mut self) -> Result<(), WriteError> {
        if !self.is_binary {
            return Ok(writeln!(self.out, "\nEnd")?);
        }
        self.put(&54_i32.to_le_bytes())?;
        self.place(0)
    }
}
