//! NRRD writer.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::header::{NrrdEncoding, NrrdHeader, field_of, lines, type_name};
use crate::model::context::WriteContext;
use crate::model::field::ByteOrder;
use crate::model::grid_values::{GridNumbers, written_field};
use crate::model::numbers::from_bytes;
use crate::model::source_document::{SourceDocument, Update};
use crate::text::push_f64;
use crate::{Format, ShapeFile, WriteError};

/// Fields of the header that say where the values are.
const PLACE_FIELDS: [&str; 6] = ["data file", "datafile", "byte skip", "byteskip", "line skip", "lineskip"];

/// A NRRD that was read.
#[derive(Debug)]
pub(super) struct NrrdDocument {
    pub(super) bytes: Vec<u8>,
    /// Numbers without compression.
    pub(super) raw: Vec<u8>,
    pub(super) header: NrrdHeader,
    pub(super) numbers: GridNumbers,
}

impl SourceDocument for NrrdDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let Self { bytes, raw, header, numbers } = self;
        let field = written_field(shape, c.format, &mut c.report)?;
        if !shape.edited.contains(&field.name) && shape.value_type.is_none() {
            c.out.write_all(bytes)?;
            return Ok(Update::Written);
        }
        if field.n_channels != numbers.n_channels() {
            return Ok(Update::DoesNotFit);
        }
        let old = &raw[..numbers.n_bytes().unwrap_or(0)];
        let own = GridNumbers { kind: shape.value_type.unwrap_or(numbers.kind), ..numbers.clone() };
        let mut new = Vec::new();
        own.write((own.kind == numbers.kind).then_some(old), field, c.format, &mut new, c.progress)?;
        if new == old && own.kind == numbers.kind {
            c.out.write_all(bytes)?;
            return Ok(Update::Written);
        }
        if let Some(name) = &header.data_file {
            c.report.add_note(format!("the values are in the file itself, no longer in {name}"));
        }
        c.out.write_all(&self.head(&own))?;
        match header.encoding {
            NrrdEncoding::Raw => c.out.write_all(&new)?,
            NrrdEncoding::Gzip => {
                let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
                gzip.write_all(&new)?;
                c.out.write_all(&gzip.finish()?)?;
            }
            NrrdEncoding::Text => {
                let values = from_bytes(&new, own.kind, own.order, c.progress)?;
                let mut text = Vec::new();
                for i in 0..values.len() {
                    values.write_text(i, &mut text);
                    text.push(if (i + 1).is_multiple_of(header.sizes[0]) { b'\n' } else { b' ' });
                }
                c.out.write_all(&text)?;
            }
        }
        Ok(Update::Written)
    }

    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::NRRD
    }

    fn references(&self) -> Vec<String> {
        self.header.data_file.iter().cloned().collect()
    }
}

impl NrrdDocument {
    /// Lines of the header for these numbers in the same file.
    fn head(&self, numbers: &GridNumbers) -> Vec<u8> {
        let mut head = Vec::new();
        for (line, after) in lines(&self.bytes) {
            if line.is_empty() || after > self.header.start {
                break;
            }
            let field = std::str::from_utf8(line).ok().and_then(field_of);
            let key = field.map(|(key, _)| key).unwrap_or_default();
            if key == "type" && numbers.kind != self.numbers.kind {
                head.extend_from_slice(format!("type: {}\n", type_name(numbers.kind)).as_bytes());
                if self.numbers.kind.n_bytes() == 1 {
                    head.extend_from_slice(b"endian: little\n");
                }
            } else if !(PLACE_FIELDS.contains(&key.as_str())
                || key == "endian" && self.numbers.kind.n_bytes() == 1 && numbers.kind != self.numbers.kind)
            {
                head.extend_from_slice(line);
                head.push(b'\n');
            }
        }
        head.push(b'\n');
        head
    }
}

/// Text `(x,y,z)` of a vector.
fn push_vector(vector: [f64; 3], out: &mut Vec<u8>) {
    for (k, x) in vector.into_iter().enumerate() {
        out.push(if k == 0 { b'(' } else { b',' });
        push_f64(out, x);
    }
    out.push(b')');
}

/// Writes a new file without compression.
pub(super) fn write_nrrd(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    let Some(layout) = shape.grid() else {
        return Err(WriteError::CannotHold { format: c.format, what: "a shape".into() });
    };
    let kind = shape.value_type.unwrap_or(field.values.value_type());
    let has_channels = field.n_channels > 1;
    let channels = has_channels.then(|| field.n_channels.to_string());
    let sizes = channels.into_iter().chain(layout.sizes.iter().rev().map(usize::to_string));
    let sizes: Vec<String> = sizes.collect();
    let mut head = format!(
        "NRRD0004\ntype: {}\ndimension: {}\nspace dimension: 3\nsizes: {}\nspace directions:",
        type_name(kind),
        sizes.len(),
        sizes.join(" ")
    )
    .into_bytes();
    if has_channels {
        head.extend_from_slice(b" none");
    }
    for step in layout.steps.iter().rev() {
        head.push(b' ');
        push_vector(*step, &mut head);
    }
    head.extend_from_slice(b"\nkinds:");
    if has_channels {
        head.extend_from_slice(b" list");
    }
    head.extend_from_slice(" domain".repeat(layout.sizes.len()).as_bytes());
    head.extend_from_slice(b"\nendian: little\nencoding: raw\nspace origin: ");
    push_vector(layout.origin, &mut head);
    if let Some(unit) = &layout.unit {
        let unit = format!("\nspace units: \"{unit}\" \"{unit}\" \"{unit}\"");
        head.extend_from_slice(unit.as_bytes());
    }
    head.extend_from_slice(b"\n\n");
    c.out.write_all(&head)?;
    let numbers = GridNumbers::new(kind, ByteOrder::Little, shape.n_vertices, field.n_channels);
    numbers.write(None, field, c.format, c.out, c.progress)
}
