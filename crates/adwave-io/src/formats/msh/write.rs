//! Gmsh MSH: the original with what changed, or a new file of version 2.2.
//!
//! 2.2 and not 4.1, because it has physical and elementary tags for each element, where 4.1 has them for whole entities only, and
//! because everything that reads MSH reads it.

use crate::model::binary_rows::CoordinateRows;
use crate::model::context::WriteContext;
use crate::model::source_document::SourceDocument;
use crate::model::source_document::Update;
use std::io::Write;

use adwave::Progress;

use crate::model::field::ByteOrder;
use crate::model::text_rows::RowEdit;
use crate::progress::at_row;
use crate::text::push_f64;
use crate::{Field, FieldValues, Format, ShapeFile, WriteError, WriteReport};

/// What is kept of an MSH to update it.
#[derive(Debug)]
pub(crate) struct MshSource {
    pub(crate) rows: CoordinateRows,
    /// The tag of each vertex; empty where they count from 1.
    pub(crate) tags: Vec<u64>,
    /// Fields of vertices by name, and where their sections are.
    pub(crate) sections: Vec<(String, usize, usize)>,
}

/// Writes the original with other coordinates and with the fields that are new, if it holds them.
fn update_msh(
    original: &MshSource,
    shape: &ShapeFile,
    context: &mut WriteContext<'_>,
) -> Result<Update, WriteError> {
    let (out, progress) = (&mut *context.out, context.progress);
    if original.tags.iter().any(|&tag| tag > i32::MAX as u64) && !shape.edited.is_empty() {
        return Ok(Update::DoesNotFit);
    }
    let (bytes, first) = match &original.rows {
        CoordinateRows::Text(rows) => {
            (&rows.bytes, rows.rows.first().map_or(rows.bytes.len(), |&row| row as usize))
        }
        CoordinateRows::Binary(rows) => (&rows.bytes, rows.first()),
    };
    let mut from = 0;
    let mut piece = |to: usize, next: usize, out: &mut dyn Write| -> Result<(), WriteError> {
        if (from..to).contains(&first) {
            match &original.rows {
                CoordinateRows::Text(rows) => {
                    rows.write_range(from..to, shape, &RowEdit::default(), out, progress)?;
                }
                CoordinateRows::Binary(rows) => rows.write_range(from..to, shape, out, progress)?,
            }
        } else {
            out.write_all(&bytes[from..to])?;
        }
        from = next;
        Ok(())
    };
    for (_, start, end) in original.sections.iter().filter(|(name, ..)| shape.edited.contains(name)) {
        piece(*start, *end, out)?;
    }
    piece(bytes.len(), bytes.len(), out)?;
    let order = match &original.rows {
        CoordinateRows::Text(_) => None,
        CoordinateRows::Binary(rows) => Some(rows.order),
    };
    if !shape.edited.is_empty() && !bytes.ends_with(b"\n") {
        out.write_all(b"\n")?;
    }
    let tag = |i: usize| original.tags.get(i).map_or(i as u32 + 1, |&tag| tag as u32);
    for field in shape.vertex_fields.iter().filter(|f| shape.edited.contains(&f.name)) {
        write_values("NodeData", field, &tag, order, out, progress)?;
    }
    Ok(Update::Written)
}

impl SourceDocument for MshSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        update_msh(self, shape, context)
    }
}

/// Writes a new file.
pub(crate) fn write_msh(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let is_binary = format == Format::MSH;
    let n = i32::try_from(shape.n_vertices.max(shape.faces.len()).max(shape.edges.pairs.len()));
    if n.is_err() {
        return Err(WriteError::CannotHold { format, what: "2^31 vertices or faces".into() });
    }
    writeln!(out, "$MeshFormat\n2.2 {} 8", i32::from(is_binary))?;
    if is_binary {
        out.write_all(&1_i32.to_le_bytes())?;
        writeln!(out)?;
    }
    writeln!(out, "$EndMeshFormat\n$Nodes\n{}", shape.points.len())?;
    let mut row = Vec::new();
    for (i, point) in shape.points.iter().enumerate() {
        at_row(progress, i as u64, shape.points.len() as u64)?;
        row.clear();
        let tag = i as i32 + 1;
        if is_binary {
            row.extend_from_slice(&tag.to_le_bytes());
            row.extend(point.iter().flat_map(|x| x.to_le_bytes()));
        } else {
            write!(row, "{tag}")?;
            for &x in point {
                row.push(b' ');
                push_f64(&mut row, x);
            }
            row.push(b'\n');
        }
        out.write_all(&row)?;
    }
    writeln!(out, "{}$EndNodes", if is_binary { "\n" } else { "" })?;
    write_elements(shape, is_binary, report, out, progress)?;
    let encoding = is_binary.then_some(ByteOrder::Little);
    for field in &shape.vertex_fields {
        write_values("NodeData", field, &|i| i as u32 + 1, encoding, out, progress)?;
    }
    // If faces are split or dropped, rows of fields are not rows of elements.
    let is_whole = shape.faces.iter().all(|f| matches!(f.len(), 3 | 4));
    let held: Vec<&Field> = shape.face_fields.iter().filter(|_| is_whole).collect();
    report.leave_face_fields(shape, &held.iter().map(|f| f.name.as_str()).collect::<Vec<_>>());
    for field in held.iter().filter(|f| tags(shape, &f.name).is_none()) {
        write_values("ElementData", field, &|i| i as u32 + 1, encoding, out, progress)?;
    }
    Ok(())
}

/// Field that becomes tags of the elements.
fn tags<'a>(shape: &'a ShapeFile, name: &str) -> Option<&'a [i32]> {
    shape.face_fields.iter().find_map(|field| match &field.values {
        FieldValues::I32(values)
            if field.name == name && field.n_channels == 1 && matches!(name, "physical" | "elementary") =>
        {
            Some(values.as_slice())
        }
        _ => None,
    })
}

/// Largest number of elements in one block, all with the same number of corners.
const RUN: usize = 1 << 16;

fn write_elements(
    shape: &ShapeFile,
    is_binary: bool,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let (physical, elementary) = (tags(shape, "physical"), tags(shape, "elementary"));
    let of_face = |f: usize| [physical.map_or(0, |t| t[f]), elementary.map_or(1, |t| t[f])];
    let mut writer = Elements { is_binary, n: 0, run: Vec::new(), run_size: 0, n_run: 0, out };
    let n_faces = shape.faces.len() as u64;
    let mut count = 0_u64;
    for face in shape.faces.iter() {
        count += match face.len() {
            0..=2 => 0,
            3 | 4 => 1,
            n => n as u64 - 2,
        };
    }
    let has_faces = !shape.faces.is_empty();
    if has_faces && !shape.edges.pairs.is_empty() {
        report.leave_out("edges");
    } else if !shape.edges.weights.is_empty() {
        report.leave_out("weights of edges");
    }
    if !has_faces {
        count = shape.edges.pairs.len() as u64;
    }
    writeln!(writer.out, "$Elements\n{count}")?;
    for (f, face) in shape.faces.iter().enumerate() {
        at_row(progress, f as u64, n_faces)?;
        match face.len() {
            0..=2 => report.leave_out("faces of fewer than three corners"),
            3 | 4 => writer.push(face, of_face(f))?,
            _ => {
                report.leave_out("polygons (as triangles)");
                for w in face.windows(2).skip(1) {
                    writer.push(&[face[0], w[0], w[1]], of_face(f))?;
                }
            }
        }
        if writer.n_run >= RUN {
            writer.flush()?;
        }
    }
    for (e, pair) in shape.edges.pairs.iter().enumerate().filter(|_| !has_faces) {
        at_row(progress, e as u64, shape.edges.pairs.len() as u64)?;
        writer.push(pair, [0, 1])?;
        if writer.n_run >= RUN {
            writer.flush()?;
        }
    }
    writer.flush()?;
    writeln!(writer.out, "{}$EndElements", if is_binary { "\n" } else { "" })?;
    Ok(())
}

/// Writer of elements: in a binary file, elements of one kind follow their number.
struct Elements<'a> {
    is_binary: bool,
    n: i32,
    run: Vec<u8>,
    run_size: usize,
    n_run: usize,
    out: &'a mut dyn Write,
}

impl Elements<'_> {
    fn push(&mut self, corners: &[u32], tags: [i32; 2]) -> Result<(), WriteError> {
        if corners.len() != self.run_size {
            self.flush()?;
            self.run_size = corners.len();
        }
        // Splitting polygons may make more elements than there are numbers.
        let beyond = || WriteError::CannotHold { format: Format::MSH, what: "2^31 elements".into() };
        self.n = self.n.checked_add(1).ok_or_else(beyond)?;
        self.n_run += 1;
        if self.is_binary {
            self.run.extend_from_slice(&self.n.to_le_bytes());
            self.run.extend(tags.iter().flat_map(|t| t.to_le_bytes()));
            self.run.extend(corners.iter().flat_map(|v| (v + 1).to_le_bytes()));
        } else {
            let [physical, elementary] = tags;
            write!(self.run, "{} {} 2 {physical} {elementary}", self.n, kind(corners.len()))?;
            for v in corners {
                write!(self.run, " {}", v + 1)?;
            }
            self.run.push(b'\n');
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        if self.is_binary && self.n_run > 0 {
            for number in [kind(self.run_size), self.n_run as i32, 2] {
                self.out.write_all(&number.to_le_bytes())?;
            }
        }
        self.out.write_all(&self.run)?;
        self.run.clear();
        self.n_run = 0;
        Ok(())
    }
}

/// Gmsh's number for elements with that many corners.
fn kind(n_corners: usize) -> i32 {
    n_corners as i32 - 1
}

/// Writes a field, as text or as binary in a byte order; a row of it belongs to the node or element of that tag.
fn write_values(
    section: &str,
    field: &Field,
    tag: &dyn Fn(usize) -> u32,
    order: Option<ByteOrder>,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let name: String = field.name.chars().map(|c| if c.is_control() || c == '"' { '_' } else { c }).collect();
    let n = field.len();
    writeln!(out, "${section}\n1\n\"{name}\"\n1\n0\n3\n0\n{}\n{n}", field.n_channels)?;
    let mut row = Vec::new();
    for i in 0..n {
        at_row(progress, i as u64, n as u64)?;
        row.clear();
        let values = (0..field.n_channels).map(|c| field.get(i, c));
        if let Some(order) = order {
            crate::model::field::Number::write_bytes(tag(i), order, &mut row);
            values.for_each(|x| crate::model::field::Number::write_bytes(x, order, &mut row));
        } else {
            write!(row, "{}", tag(i))?;
            for x in values {
                row.push(b' ');
                push_f64(&mut row, x);
            }
            row.push(b'\n');
        }
        out.write_all(&row)?;
    }
    writeln!(out, "{}$End{section}", if order.is_some() { "\n" } else { "" })?;
    Ok(())
}
