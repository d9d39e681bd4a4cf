//! Arrays of two axes and more as images and volumes.

use std::io::Read as _;
use std::sync::Arc;

use adwave::Progress;
use zip::ZipArchive;

use super::read::NpyHeader;
use super::write::header;
use crate::model::context::{ReadContext, WriteContext};
use crate::model::field::ByteOrder;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};
use crate::model::grid_layout::{GridLayout, note_on_missing};
use crate::model::grid_values::{GridNumbers, GridValues, written_field};
use crate::model::source_document::{SourceDocument, Update};
use crate::progress::BYTES_PER_STEP;
use crate::text::one_line;
use crate::{Format, ReadError, ReadLimits, ShapeFile, ValueType, WriteError, read_npy_bytes};

/// Columns of a table of points, which is no image: `points:FILE.npy` reads it.
const MOST_COORDINATES: usize = 3;
/// Channels of colors with opacity: a last axis up to this length has channels.
const MOST_CHANNELS: usize = 4;
/// Arrays of an archive that a message names.
const MOST_NAMES: usize = 5;

impl Format {
    /// NumPy array of two axes and more.
    pub const NPY: Self = Self::new("npy");
    /// Archive of NumPy arrays, one of which has two axes or more; read only.
    pub const NPZ: Self = Self::new("npz");
}

pub(crate) static NPY: FormatDescriptor = FormatDescriptor {
    format: Format::NPY,
    title: "NumPy array",
    extensions: &["npy"],
    content: ContentKind::Grid,
    reads: "arrays of two axes (images) and three (volumes), and a last axis of 2 to 4 channels beside them; tables of \
            up to three columns are points or fields",
    writes: "the values in their type, further channels along the last axis",
    keeps: "type and byte order",
    loses: "spacings and position, fields other than `values`",
    recognize: |file| file.bytes.starts_with(b"\x93NUMPY").then_some(Evidence::Signature),
    read: Some(read_array),
    write: Some(write_array),
    samples: &[SampleFile { name: "a.npy", bytes: include_bytes!("samples/a.npy") }],
    ..FormatDescriptor::NEW
};

pub(crate) static NPZ: FormatDescriptor = FormatDescriptor {
    format: Format::NPZ,
    title: "archive of NumPy arrays",
    extensions: &["npz"],
    content: ContentKind::Grid,
    reads: "the array of two axes or more, if there is one",
    loses: "other arrays",
    recognize: |file| {
        let n = file.bytes.get(26..28).map(|n| usize::from(u16::from_le_bytes([n[0], n[1]])));
        let name = n.and_then(|n| file.bytes.get(30..30 + n));
        (file.is_archive() && name.is_some_and(|name| name.ends_with(b".npy"))).then_some(Evidence::Signature)
    },
    read: Some(|bytes, c| read_archive(&bytes, c)),
    samples: &[SampleFile { name: "a.npz", bytes: include_bytes!("samples/a.npz") }],
    ..FormatDescriptor::NEW
};

/// An array that was read.
#[derive(Debug)]
struct ArrayDocument {
    bytes: Vec<u8>,
    header: NpyHeader,
    numbers: GridNumbers,
}

impl SourceDocument for ArrayDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let Self { bytes, header, numbers } = self;
        let field = written_field(shape, c.format, &mut c.report)?;
        if !shape.edited.contains(&field.name) && shape.value_type.is_none() {
            c.out.write_all(bytes)?;
            return Ok(Update::Written);
        }
        let kind = shape.value_type.unwrap_or(numbers.kind);
        if header.is_fortran || kind != numbers.kind || field.n_channels != numbers.n_components {
            return Ok(Update::DoesNotFit);
        }
        let end = header.start + numbers.n_bytes().unwrap_or(0);
        c.out.write_all(&bytes[..header.start])?;
        numbers.write(Some(&bytes[header.start..end]), field, c.format, c.out, c.progress)?;
        c.out.write_all(&bytes[end..])?;
        Ok(Update::Written)
    }

    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::NPY
    }
}

/// Axes of the places and number of channels of an array; `None` if it is no image or volume.
fn axes_of(shape: &[usize]) -> Option<(&[usize], usize)> {
    if shape.contains(&0) {
        return None;
    }
    match shape {
        [_, columns] => (*columns > MOST_COORDINATES).then_some((shape, 1)),
        [a, b, c] if (2..=MOST_CHANNELS).contains(c) && *a > MOST_CHANNELS && *b > MOST_CHANNELS => {
            Some((&shape[..2], *c))
        }
        [_, _, _] => Some((shape, 1)),
        [.., c] if shape.len() == 4 && (1..=MOST_CHANNELS).contains(c) => Some((&shape[..3], *c)),
        _ => None,
    }
}

fn refused(shape: &[usize]) -> ReadError {
    let what = match shape.len() {
        0 | 1 => "use it as a field of a shape",
        2 => "use it as a field of a shape, or as points:FILE.npy; an image has more than three columns",
        _ => {
            "images have two axes, volumes three, and a last axis may have up to four channels; save a part of it"
        }
    };
    ReadError::Whole(format!("a NumPy array of the shape {shape:?} is no image or volume: {what}"))
}

fn read_array(bytes: Vec<u8>, c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let header = NpyHeader::parse(&bytes, bytes.len() as u64)?;
    let (mut shape, numbers) = array_shape(&bytes, &header, c)?;
    shape.format = Some(Format::NPY);
    shape.original = Some(Arc::new(ArrayDocument { bytes, header, numbers }));
    Ok(shape)
}

fn array_shape(
    bytes: &[u8],
    header: &NpyHeader,
    c: &ReadContext<'_>,
) -> Result<(ShapeFile, GridNumbers), ReadError> {
    let (sizes, n_channels) = axes_of(&header.shape).ok_or_else(|| refused(&header.shape))?;
    let n_places = header.n_values / n_channels;
    let numbers = GridNumbers::new(header.value_type, header.order, n_places, n_channels);
    let found = numbers.slice(bytes, header.start, c.limits)?;
    let GridValues { field, kept, .. } = if header.is_fortran {
        let array = read_npy_bytes(bytes)?;
        let mut plain = Vec::new();
        (0..array.values.len()).for_each(|i| array.values.write_bytes(i, header.order, &mut plain));
        numbers.read(&plain, c.progress)?
    } else {
        numbers.read(found, c.progress)?
    };
    let layout = GridLayout { kept, ..GridLayout::new(sizes, &vec![1.0; sizes.len()]) };
    let mut notes = vec![format!(
        "the array is {} of {:?} places{}; spacings are 1",
        if sizes.len() == 2 { "an image" } else { "a volume" },
        sizes,
        if n_channels > 1 { format!(" with {n_channels} channels") } else { String::new() }
    )];
    note_on_missing(&layout, None, &mut notes);
    let mut shape = ShapeFile::from_grid(layout).map_err(|e| ReadError::Whole(e.to_string()))?;
    shape.vertex_fields.push(field);
    shape.notes = notes;
    Ok((shape, numbers))
}

/// Reads the file `index` of an archive, within the limits.
fn content(
    archive: &mut ZipArchive<std::io::Cursor<&[u8]>>,
    index: usize,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<(String, Vec<u8>), ReadError> {
    let broken = |e: &dyn std::fmt::Display| {
        ReadError::Whole(format!("the archive is damaged ({}); get the whole file", one_line(e)))
    };
    let file = archive.by_index(index).map_err(|e| broken(&e))?;
    let name = file.name().to_owned();
    let mut bytes = Vec::new();
    let mut reader = file.take(limits.max_bytes.saturating_add(1));
    loop {
        progress.check()?;
        let before = bytes.len();
        { reader.by_ref().take(BYTES_PER_STEP as u64) }.read_to_end(&mut bytes).map_err(|e| broken(&e))?;
        if bytes.len() == before {
            break;
        }
    }
    limits.check_bytes(bytes.len() as u64)?;
    Ok((name, bytes))
}

fn read_archive(bytes: &[u8], c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let mut archive = ZipArchive::new(std::io::Cursor::new(bytes)).map_err(|e| {
        ReadError::Whole(format!("the archive is damaged ({}); get the whole file", one_line(&e)))
    })?;
    let mut grids = Vec::new();
    for index in 0..archive.len() {
        let (name, array) = content(&mut archive, index, c.limits, c.progress)?;
        let Ok(header) = NpyHeader::parse(&array, array.len() as u64) else { continue };
        if axes_of(&header.shape).is_some() {
            grids.push((name, array, header));
        }
        if grids.len() > 1 {
            let names = grids.iter().map(|(name, ..)| name.trim_end_matches(".npy")).take(MOST_NAMES);
            let names: Vec<String> = names.map(|name| crate::text::show(name.as_bytes())).collect();
            let message =
                format!("the archive has several arrays ({}, …); save one of them as .npy", names.join(", "));
            return Err(ReadError::Whole(message));
        }
    }
    let Some((name, array, header)) = grids.pop() else {
        let message =
            "the archive has no array that is an image or a volume; save one of two or three axes as .npy";
        return Err(ReadError::Whole(message.into()));
    };
    let (mut shape, _) = array_shape(&array, &header, c)?;
    shape.notes.insert(
        0,
        format!("the values are the array {}", crate::text::show(name.trim_end_matches(".npy").as_bytes())),
    );
    shape.format = Some(Format::NPZ);
    Ok(shape)
}

/// Type of the numbers as NumPy names it.
fn descr(kind: ValueType) -> &'static str {
    match kind {
        ValueType::U8 => "|u1",
        ValueType::I8 => "|i1",
        ValueType::U16 => "<u2",
        ValueType::I16 => "<i2",
        ValueType::U32 => "<u4",
        ValueType::I32 => "<i4",
        ValueType::U64 => "<u8",
        ValueType::I64 => "<i8",
        ValueType::F32 => "<f4",
        ValueType::F64 => "<f8",
    }
}

fn write_array(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    let Some(layout) = shape.grid() else {
        return Err(WriteError::CannotHold { format: c.format, what: "a shape".into() });
    };
    let plain = GridLayout::new(&layout.sizes, &vec![1.0; layout.sizes.len()]);
    if (&plain.spacings, &plain.steps, plain.origin) != (&layout.spacings, &layout.steps, layout.origin) {
        c.report.report_dropped("spacings and position of the grid");
    }
    let kind = shape.value_type.unwrap_or(field.values.value_type());
    let mut sizes = layout.sizes.clone();
    if field.n_channels > 1 {
        sizes.push(field.n_channels);
    }
    c.out.write_all(&header(descr(kind), &sizes))?;
    let numbers = GridNumbers::new(kind, ByteOrder::Little, shape.n_vertices, field.n_channels);
    numbers.write(None, field, c.format, c.out, c.progress)
}
