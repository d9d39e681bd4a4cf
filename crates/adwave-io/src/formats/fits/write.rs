//! Writer of HEALPix maps: numbers replaced in the file that was read, or a new table behind its header.

use std::sync::Arc;

use crate::formats::fits::UNSEEN;
use crate::formats::fits::header::{BLOCK, CARD, card, quoted};
use crate::formats::fits::healpix::{Ordering, PixelNumbers};
use crate::formats::fits::read::FitsSource;
use crate::model::context::WriteContext;
use crate::model::field::{ByteOrder, Number, with_values};
use crate::model::grouping::column_names;
use crate::model::source_document::{SourceDocument, Update};
use crate::progress::{all, report_row};
use crate::{Field, FieldValues, ShapeFile, WriteError};

/// Keywords of the structure of a table, and of sums over its bytes, which are written anew.
const STRUCTURE: [&str; 19] = [
    "XTENSION", "BITPIX", "NAXIS", "NAXIS1", "NAXIS2", "PCOUNT", "GCOUNT", "TFIELDS", "THEAP", "CHECKSUM",
    "DATASUM", "PIXTYPE", "ORDERING", "NSIDE", "FIRSTPIX", "LASTPIX", "INDXSCHM", "OBJECT", "BAD_DATA",
];

/// Beginnings of keywords that end in the number of a column.
const OF_COLUMN: [&str; 11] =
    ["TTYPE", "TFORM", "TUNIT", "TSCAL", "TZERO", "TNULL", "TDISP", "TDIM", "TDMIN", "TDMAX", "TCOMM"];

/// Values in a row of a new table of all pixels, as healpy writes them.
const USUAL_REPEAT: usize = 1024;

impl SourceDocument for FitsSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        self.check_places(shape, context)?;
        if !self.is_whole {
            return Ok(Update::DoesNotFit);
        }
        let mut bytes = self.bytes.clone();
        let (start, end) = (self.table.data, self.table.data + self.table.n_bytes);
        for field in shape.vertex_fields.iter().filter(|field| shape.edited.contains(&field.name)) {
            let own = self.fields.iter().find(|(name, _)| *name == field.name);
            let Some((_, column)) = own.filter(|_| field.n_channels == 1) else {
                return Ok(Update::DoesNotFit);
            };
            let column = &self.columns[*column];
            for k in 0..field.len() {
                report_row(context.progress, k as u64, field.len() as u64)?;
                let value = field.get(k, 0);
                if !column.put(&mut bytes[start..end], self.row_bytes, k, value) {
                    return Ok(Update::DoesNotFit);
                }
            }
        }
        if !shape.edited.is_empty() {
            blank_sums(&mut bytes[self.table.start..start]);
        }
        context.out.write_all(&bytes)?;
        Ok(Update::Written)
    }

    fn keeps_extras(&self, format: crate::Format) -> bool {
        format == crate::Format::FITS && self.is_whole
    }

    fn subset(&self, vertices: &[u32]) -> Option<Arc<dyn SourceDocument>> {
        Some(Arc::new(Self { numbers: self.numbers.subset(vertices), is_whole: false, ..self.clone() }))
    }
}

/// Replaces sums over the bytes of the table, which have changed, by blank cards.
fn blank_sums(header: &mut [u8]) {
    for card in header.chunks_exact_mut(CARD) {
        if card.starts_with(b"CHECKSUM") || card.starts_with(b"DATASUM ") {
            card.fill(b' ');
        }
    }
}

/// Distance from the center of a pixel within which a point is there: rounding of steps of a computation.
const ROUNDING: f64 = 1e-9;

/// Writes all vertex fields as columns behind the header of the map that the shape was read from.
pub(super) fn write_fits(shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let Some(source) = shape.source::<FitsSource>() else {
        let what = "points that are no pixels of a HEALPix map that was read from FITS".to_owned();
        return Err(WriteError::CannotHold { format: context.format, what });
    };
    source.check_places(shape, context)?;
    context.report.report_face_fields(shape, &[]);
    // Columns that are no numbers are in the old table alone.
    for extra in shape.extras.iter().filter(|extra| extra.starts_with("column ")) {
        context.report.report_dropped(extra.clone());
    }
    let n = shape.n_vertices;
    let (pixels, repeat) = match &source.numbers {
        PixelNumbers::All if n.is_multiple_of(USUAL_REPEAT) => (None, USUAL_REPEAT),
        PixelNumbers::All => (None, 1),
        PixelNumbers::Some { of_vertex, .. } => {
            let numbers = of_vertex.iter().map(|number| *number as i64).collect();
            (Some(Field::new("PIXEL", 1, FieldValues::I64(numbers))), 1)
        }
    };
    let fields: Vec<&Field> = pixels.iter().chain(&shape.vertex_fields).collect();
    let columns: Vec<WrittenColumn<'_>> = fields.iter().flat_map(|field| field_columns(field)).collect();
    let mut header = table_header(source, &columns, n, repeat);
    header.extend_from_slice(&kept_cards(source));
    header.extend_from_slice(b"END");
    header.resize(header.len() - 3 + CARD, b' ');
    header.resize(header.len().next_multiple_of(BLOCK), b' ');
    let out = &mut *context.out;
    out.write_all(&source.bytes[..source.table.start])?;
    out.write_all(&header)?;
    let (mut row, mut n_written) = (Vec::new(), 0);
    for first in (0..n).step_by(repeat) {
        report_row(context.progress, first as u64, n as u64)?;
        row.clear();
        for column in &columns {
            (first..first + repeat).for_each(|k| column.push(k, &mut row));
        }
        out.write_all(&row)?;
        n_written += row.len();
    }
    out.write_all(&vec![0; n_written.next_multiple_of(BLOCK) - n_written])?;
    Ok(out.write_all(&source.bytes[source.table.end..])?)
}

/// A channel of a field as a column.
struct WrittenColumn<'a> {
    name: String,
    field: &'a Field,
    channel: usize,
}

fn field_columns(field: &Field) -> impl Iterator<Item = WrittenColumn<'_>> {
    let names = if field.n_channels == 1 { vec![field.name.clone()] } else { column_names(field) };
    names.into_iter().enumerate().map(move |(channel, name)| WrittenColumn { name, field, channel })
}

impl WrittenColumn<'_> {
    /// Letter of the type: the integers of FITS have signs, except for bytes, so others become wider.
    fn letter(&self) -> char {
        match self.field.values {
            FieldValues::U8(_) => 'B',
            FieldValues::I8(_) | FieldValues::I16(_) => 'I',
            FieldValues::U16(_) | FieldValues::I32(_) => 'J',
            FieldValues::U32(_) | FieldValues::I64(_) => 'K',
            FieldValues::F32(_) => 'E',
            FieldValues::U64(_) | FieldValues::F64(_) => 'D',
        }
    }

    fn n_bytes(&self) -> usize {
        match self.letter() {
            'B' => 1,
            'I' => 2,
            'J' | 'E' => 4,
            _ => 8,
        }
    }

    /// Appends the value of a vertex; NaN becomes UNSEEN.
    fn push(&self, vertex: usize, out: &mut Vec<u8>) {
        let k = vertex * self.field.n_channels + self.channel;
        let known = |x: f64| if x.is_nan() { UNSEEN } else { x };
        let big = ByteOrder::Big;
        match &self.field.values {
            FieldValues::I8(v) => i16::from(v[k]).write_bytes(big, out),
            FieldValues::U16(v) => i32::from(v[k]).write_bytes(big, out),
            FieldValues::U32(v) => i64::from(v[k]).write_bytes(big, out),
            FieldValues::U64(v) => (v[k] as f64).write_bytes(big, out),
            FieldValues::F32(v) => (known(v[k].into()) as f32).write_bytes(big, out),
            FieldValues::F64(v) => known(v[k]).write_bytes(big, out),
            values => with_values!(values, v => v[k].write_bytes(big, out)),
        }
    }
}

/// Cards of the structure of the table and of the pixelization.
fn table_header(source: &FitsSource, columns: &[WrittenColumn<'_>], n: usize, repeat: usize) -> Vec<u8> {
    let row_bytes: usize = columns.iter().map(|column| repeat * column.n_bytes()).sum();
    let mut header = Vec::new();
    let mut add = |keyword: &str, value: String| header.extend_from_slice(&card(keyword, &value, ""));
    add("XTENSION", quoted("BINTABLE"));
    add("BITPIX", "8".into());
    add("NAXIS", "2".into());
    add("NAXIS1", row_bytes.to_string());
    add("NAXIS2", (n / repeat).to_string());
    add("PCOUNT", "0".into());
    add("GCOUNT", "1".into());
    add("TFIELDS", columns.len().to_string());
    for (k, column) in columns.iter().enumerate() {
        add(&format!("TTYPE{}", k + 1), quoted(&column.name));
        add(&format!("TFORM{}", k + 1), quoted(&format!("{repeat}{}", column.letter())));
        let own = source.fields.iter().find(|(name, _)| *name == column.name);
        let unit = own.map_or("", |(_, k)| source.columns[*k].unit.as_str());
        if !unit.is_empty() {
            add(&format!("TUNIT{}", k + 1), quoted(unit));
        }
    }
    let is_ring = source.pixelization.ordering == Ordering::Ring;
    add("PIXTYPE", quoted("HEALPIX"));
    add("ORDERING", quoted(if is_ring { "RING" } else { "NESTED" }));
    add("NSIDE", source.pixelization.n_side.to_string());
    if matches!(source.numbers, PixelNumbers::All) {
        add("FIRSTPIX", "0".into());
        add("LASTPIX", (n - 1).to_string());
        add("INDXSCHM", quoted("IMPLICIT"));
        add("OBJECT", quoted("FULLSKY"));
    } else {
        add("INDXSCHM", quoted("EXPLICIT"));
        add("OBJECT", quoted("PARTIAL"));
    }
    header
}

/// Cards of the old table that do not describe its structure, as they are.
fn kept_cards(source: &FitsSource) -> Vec<u8> {
    let header = &source.bytes[source.table.start..source.table.data];
    let mut kept = Vec::new();
    for card in header.chunks_exact(CARD) {
        let keyword = String::from_utf8_lossy(&card[..8]).trim().to_owned();
        if keyword == "END" {
            break;
        }
        let is_of_column = OF_COLUMN.iter().any(|begin| {
            keyword
                .strip_prefix(begin)
                .is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit()))
        });
        if !STRUCTURE.contains(&keyword.as_str()) && !is_of_column && !keyword.is_empty() {
            kept.extend_from_slice(card);
        }
    }
    kept
}

impl FitsSource {
    /// Refuses points that are no centers of pixels any more.
    fn check_places(&self, shape: &ShapeFile, context: &WriteContext<'_>) -> Result<(), WriteError> {
        let is_center = |vertex: usize| {
            let center = self.pixelization.center(self.pixelization.pixel(self.numbers.number(vertex)));
            (0..3).all(|c| (shape.points[vertex][c] - center[c]).abs() <= ROUNDING)
        };
        if !shape.moved || all(shape.n_vertices, context.progress, is_center)? {
            return Ok(());
        }
        let what = "moved points: its places are the centers of pixels".to_owned();
        Err(WriteError::CannotHold { format: context.format, what })
    }
}
