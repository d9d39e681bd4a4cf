//! TIFF writer: new files, and files that were read with other values.

use super::codec;
use super::page::{Page, PageKind, sample_format};
use super::read::Stack;
use super::tags::{self, Container, Directory, width_of};
use crate::model::context::WriteContext;
use crate::model::field::{ByteOrder, Number};
use crate::model::geo_keys::KEYS;
use crate::model::grid_layout::GridLayout;
use crate::model::grid_values::{GridNumbers, written_field};
use crate::model::source_document::{SourceDocument, Update};
use crate::{CoordinateSystemKind, Format, ReadError, ShapeFile, ValueType, WriteError};

/// Rows of a strip of a new file have about this many bytes.
const STRIP_BYTES: usize = 1 << 18;
/// Tags that the writer computes.
const WRITTEN: &[u16] = &[
    tags::BITS,
    tags::COMPRESSION,
    tags::STRIP_OFFSETS,
    tags::STRIP_COUNTS,
    tags::TILE_OFFSETS,
    tags::TILE_COUNTS,
    tags::PREDICTOR,
    tags::SAMPLES,
    tags::SAMPLE_FORMAT,
    tags::ROWS_PER_STRIP,
    tags::PLANAR,
];
/// Tags that tell of the values, and change with them.
const STALE: &[u16] = &[tags::LEAST_SAMPLE, tags::GREATEST_SAMPLE, tags::S_LEAST, tags::S_GREATEST];
/// Tags that name other directories.
const POINTERS: &[u16] = &[tags::SUB_DIRECTORIES, tags::EXIF, tags::GPS];

/// A TIFF that was read.
#[derive(Debug)]
pub(super) struct TiffDocument {
    pub(super) bytes: Vec<u8>,
}

impl SourceDocument for TiffDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let field = written_field(shape, c.format, &mut c.report)?;
        if !shape.edited.contains(&field.name) && shape.value_type.is_none() {
            c.out.write_all(&self.bytes)?;
            return Ok(Update::Written);
        }
        // The file was read before.
        let Ok(original) = Original::open(&self.bytes) else { return Ok(Update::DoesNotFit) };
        let Original { container, directories, stack, numbers, old } = &original;
        let first = &stack.pages[0];
        let kind = shape.value_type.unwrap_or(numbers.kind);
        let is_same =
            kind == numbers.kind && field.n_channels == numbers.n_components && first.kind.n_bits >= 8;
        let mut new = Vec::new();
        if is_same {
            numbers.write(Some(old), field, c.format, &mut new, c.progress)?;
            if new == *old {
                c.out.write_all(&self.bytes)?;
                return Ok(Update::Written);
            }
            if let Some(bytes) = original.in_place(&new) {
                if stack.n_copies > 0 {
                    c.report.add_note(
                        "overviews in the file show the old values; build them again, such as by gdaladdo",
                    );
                }
                c.out.write_all(&bytes)?;
                return Ok(Update::Written);
            }
        } else {
            let missing = numbers.missing;
            let wide = GridNumbers {
                missing,
                ..GridNumbers::new(kind, container.order, shape.n_vertices, field.n_channels)
            };
            let old = is_bits_alone(first, kind, field.n_channels, numbers).then_some(&old[..]);
            wide.write(old, field, c.format, &mut new, c.progress)?;
        }
        if stack.n_copies > 0 {
            c.report.report_dropped("overviews and masks of the image");
        }
        if stack.n_others > 0 {
            c.report.report_dropped(format!("{} pages of another size or type", stack.n_others));
        }
        let page_bytes = new.len() / stack.pages.len();
        let mut pages = Vec::new();
        for (k, page) in stack.pages.iter().enumerate() {
            let directory = &directories[stack.indices[k]];
            if directory.entries.iter().any(|entry| POINTERS.contains(&entry.tag)) {
                c.report.report_dropped("EXIF, GPS and sub-images");
            }
            let mut entries = kept_entries(container, directory);
            let has_other_channels = field.n_channels != page.kind.n_samples;
            if has_other_channels || kind != page.kind.kind {
                entries.retain(|entry| {
                    ![tags::PHOTOMETRIC, tags::EXTRA_SAMPLES].contains(&entry.tag) || !has_other_channels
                });
                if has_other_channels {
                    entries.extend(color_entries(kind, field.n_channels, container.order));
                }
            }
            let compression =
                if page.compression == codec::UNCOMPRESSED { codec::UNCOMPRESSED } else { codec::DEFLATE };
            let page = Page {
                kind: PageKind {
                    n_samples: field.n_channels,
                    kind,
                    n_bits: 8 * kind.n_bytes(),
                    ..page.kind.clone()
                },
                compression,
                is_planar: page.is_planar && field.n_channels > 1,
                ..page.clone()
            };
            pages.push(PageOut::new(page, entries, &new[k * page_bytes..(k + 1) * page_bytes])?);
        }
        write_file(&pages, container.order, container.is_big, c)?;
        Ok(Update::Written)
    }

    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::TIFF
    }
}

/// True if the file differs from the numbers written only in packed bits.
fn is_bits_alone(page: &Page, kind: ValueType, n_channels: usize, numbers: &GridNumbers) -> bool {
    page.kind.n_bits < 8 && kind == numbers.kind && n_channels == numbers.n_components
}

/// Content of a file that was read.
struct Original<'a> {
    container: Container<'a>,
    directories: Vec<Directory>,
    stack: Stack,
    numbers: GridNumbers,
    /// Bytes of all numbers.
    old: Vec<u8>,
}

impl<'a> Original<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let container = Container::open(bytes)?;
        let directories = container.directories()?;
        let stack = Stack::parse(&container, &directories)?;
        let numbers = stack.numbers(&container, &directories[stack.indices[0]]);
        let old = stack.decode(&container, &numbers)?;
        Ok(Self { container, directories, stack, numbers, old })
    }

    /// The file with other numbers in the same places; `None` if its numbers are compressed, left out or overlap.
    fn in_place(&self, new: &[u8]) -> Option<Vec<u8>> {
        let n = self.container.bytes.len();
        let is_plain = |page: &Page| {
            page.compression == codec::UNCOMPRESSED
                && page.predictor == 1
                && (0..page.n_chunks()).all(|chunk| matches!(page.chunk_range(chunk, n), Ok(Some(_))))
        };
        if !self.stack.pages.iter().all(is_plain) {
            return None;
        }
        let mut bytes = self.container.bytes.to_vec();
        let page_bytes = new.len() / self.stack.pages.len();
        for (page, image) in self.stack.pages.iter().zip(new.chunks_exact(page_bytes)) {
            for chunk in 0..page.n_chunks() {
                let range = page.chunk_range(chunk, n).ok()??;
                page.take_chunk(chunk, image, &mut bytes[range]);
            }
        }
        // Strips of a damaged file may overlap each other or the tags.
        let is_intact = Original::open(&bytes).is_ok_and(|again| again.old == new);
        is_intact.then_some(bytes)
    }
}

/// Tag of a new directory.
struct EntryOut {
    tag: u16,
    kind: u16,
    bytes: Vec<u8>,
}

impl EntryOut {
    fn numbers<T: Number>(tag: u16, kind: u16, numbers: &[T], order: ByteOrder) -> Self {
        let mut bytes = Vec::new();
        for number in numbers {
            number.write_bytes(order, &mut bytes);
        }
        Self { tag, kind, bytes }
    }

    fn text(tag: u16, text: &str) -> Self {
        Self { tag, kind: tags::ASCII, bytes: [text.as_bytes(), b"\0"].concat() }
    }
}

fn kept_entries(container: &Container<'_>, directory: &Directory) -> Vec<EntryOut> {
    let is_kept = |tag: u16| !WRITTEN.contains(&tag) && !STALE.contains(&tag) && !POINTERS.contains(&tag);
    let kept = directory.entries.iter().filter(|entry| is_kept(entry.tag));
    let copy = |entry: &tags::Entry| EntryOut {
        tag: entry.tag,
        kind: entry.kind,
        bytes: container.value_bytes(entry).to_vec(),
    };
    kept.map(copy).collect()
}

/// Meaning of the channels: colors for three or four integers, else gray levels with further ones.
fn color_entries(kind: ValueType, n_channels: usize, order: ByteOrder) -> Vec<EntryOut> {
    let is_color = matches!(kind, ValueType::U8 | ValueType::U16) && (3..=4).contains(&n_channels);
    let n_colors = if is_color { 3 } else { 1 };
    let mut entries =
        vec![EntryOut::numbers(tags::PHOTOMETRIC, tags::SHORT, &[if is_color { 2_u16 } else { 1 }], order)];
    if n_channels > n_colors {
        let meaning = if is_color { 2_u16 } else { 0 };
        entries.push(EntryOut::numbers(
            tags::EXTRA_SAMPLES,
            tags::SHORT,
            &vec![meaning; n_channels - n_colors],
            order,
        ));
    }
    entries
}

/// Page with its strips or tiles, ready to be written.
struct PageOut {
    page: Page,
    entries: Vec<EntryOut>,
    chunks: Vec<Vec<u8>>,
}

impl PageOut {
    fn new(page: Page, entries: Vec<EntryOut>, image: &[u8]) -> Result<Self, WriteError> {
        let mut chunks = Vec::with_capacity(page.n_chunks());
        for chunk in 0..page.n_chunks() {
            let mut plain = vec![0; page.chunk_row_bytes() * page.stored_rows(chunk)];
            page.take_chunk(chunk, image, &mut plain);
            chunks.push(if page.compression == codec::UNCOMPRESSED {
                plain
            } else {
                codec::deflate(&plain)?
            });
        }
        Ok(Self { page, entries, chunks })
    }

    /// All tags in ascending order, with the strips or tiles from `start` on.
    fn all_entries(&self, start: u64, order: ByteOrder, is_big: bool) -> Vec<EntryOut> {
        let Page { kind, compression, is_planar, is_tiled, chunk, .. } = &self.page;
        let short = |tag: u16, number: u16| EntryOut::numbers(tag, tags::SHORT, &[number], order);
        let longs = |tag: u16, numbers: &[u64]| {
            if is_big {
                EntryOut::numbers(tag, tags::LONG8, numbers, order)
            } else {
                let numbers: Vec<u32> = numbers.iter().map(|number| *number as u32).collect();
                EntryOut::numbers(tag, tags::LONG, &numbers, order)
            }
        };
        let copy =
            |entry: &EntryOut| EntryOut { tag: entry.tag, kind: entry.kind, bytes: entry.bytes.clone() };
        let mut entries: Vec<EntryOut> = self.entries.iter().map(copy).collect();
        let counts: Vec<u64> = self.chunks.iter().map(|chunk| chunk.len() as u64).collect();
        let mut at = start;
        let offsets: Vec<u64> = counts
            .iter()
            .map(|count| {
                let own = at;
                at += count;
                own
            })
            .collect();
        let n = kind.n_samples;
        entries.push(EntryOut::numbers(tags::BITS, tags::SHORT, &vec![kind.n_bits as u16; n], order));
        entries.push(EntryOut::numbers(
            tags::SAMPLE_FORMAT,
            tags::SHORT,
            &vec![sample_format(kind.kind); n],
            order,
        ));
        entries.push(short(tags::COMPRESSION, *compression as u16));
        entries.push(short(tags::SAMPLES, n as u16));
        entries.push(short(tags::PLANAR, if *is_planar { 2 } else { 1 }));
        if *is_tiled {
            entries.push(longs(tags::TILE_OFFSETS, &offsets));
            entries.push(longs(tags::TILE_COUNTS, &counts));
        } else {
            entries.push(longs(tags::STRIP_OFFSETS, &offsets));
            entries.push(longs(tags::STRIP_COUNTS, &counts));
            entries.push(EntryOut::numbers(tags::ROWS_PER_STRIP, tags::LONG, &[chunk[1] as u32], order));
        }
        entries.sort_by_key(|entry| entry.tag);
        entries
    }
}

/// Bytes of a directory and its values.
fn directory_bytes(entries: &[EntryOut], is_big: bool) -> usize {
    let (head, row, next) = if is_big { (8, 20, 8) } else { (2, 12, 4) };
    let width = if is_big { 8 } else { 4 };
    let outside = entries.iter().map(|entry| entry.bytes.len()).filter(|&n| n > width);
    head + row * entries.len() + next + outside.map(|n| n.next_multiple_of(8)).sum::<usize>()
}

/// Writes a file of these pages, in BigTIFF if it is larger than 4 GiB.
fn write_file(
    pages: &[PageOut],
    order: ByteOrder,
    is_big: bool,
    c: &mut WriteContext<'_>,
) -> Result<(), WriteError> {
    let n_bytes: usize = pages.iter().flat_map(|page| page.chunks.iter().map(Vec::len)).sum();
    let is_big = is_big || n_bytes as u64 + (1 << 24) > u64::from(u32::MAX);
    let mut head = Vec::new();
    head.extend_from_slice(if order == ByteOrder::Little { b"II" } else { b"MM" });
    let offset = |x: u64, out: &mut Vec<u8>| {
        if is_big { x.write_bytes(order, out) } else { (x as u32).write_bytes(order, out) }
    };
    if is_big {
        for x in [43_u16, 8, 0] {
            x.write_bytes(order, &mut head);
        }
    } else {
        42_u16.write_bytes(order, &mut head);
    }
    let mut at = if is_big { 16 } else { 8 };
    offset(at, &mut head);
    c.out.write_all(&head)?;
    for (k, page) in pages.iter().enumerate() {
        c.progress.check()?;
        // The numbers of bytes do not depend on the offsets.
        let n = directory_bytes(&page.all_entries(0, order, is_big), is_big) as u64;
        let start = (at + n).next_multiple_of(16);
        let entries = page.all_entries(start, order, is_big);
        let n_chunks: u64 = page.chunks.iter().map(|chunk| chunk.len() as u64).sum();
        let next = if k + 1 < pages.len() { (start + n_chunks).next_multiple_of(16) } else { 0 };
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        let (row, width) = if is_big { (20, 8) } else { (12, 4) };
        let values_at = at + if is_big { 16 } else { 6 } + row * entries.len() as u64;
        if is_big {
            (entries.len() as u64).write_bytes(order, &mut rows);
        } else {
            (entries.len() as u16).write_bytes(order, &mut rows);
        }
        for entry in &entries {
            entry.tag.write_bytes(order, &mut rows);
            entry.kind.write_bytes(order, &mut rows);
            offset((entry.bytes.len() / width_of(entry.kind)) as u64, &mut rows);
            if entry.bytes.len() <= width {
                rows.extend_from_slice(&entry.bytes);
                rows.resize(rows.len() + width - entry.bytes.len(), 0);
            } else {
                offset(values_at + values.len() as u64, &mut rows);
                values.extend_from_slice(&entry.bytes);
                values.resize(values.len().next_multiple_of(8), 0);
            }
        }
        offset(next, &mut rows);
        rows.append(&mut values);
        rows.resize((start - at) as usize, 0);
        c.out.write_all(&rows)?;
        for chunk in &page.chunks {
            c.out.write_all(chunk)?;
        }
        if next > 0 {
            c.out.write_all(&vec![0; (next - start - n_chunks) as usize])?;
            at = next;
        }
    }
    Ok(())
}

/// Tags of the position and the coordinate system of an image.
fn map_entries(shape: &ShapeFile, layout: &GridLayout, c: &mut WriteContext<'_>) -> Vec<EntryOut> {
    let order = ByteOrder::Little;
    let n = layout.sizes.len();
    let plain = GridLayout::new(&layout.sizes, &vec![1.0; n]);
    let is_plain = (&plain.steps, plain.origin) == (&layout.steps, layout.origin);
    if is_plain && shape.coordinate_system().is_none() {
        return Vec::new();
    }
    let (row, column) = (layout.steps[n - 2], layout.steps[n - 1]);
    if n == 3 || row[2] != 0.0 || column[2] != 0.0 {
        c.report.report_dropped("spacings and position along the third axis");
    }
    let corner = [0, 1].map(|k| layout.origin[k] - 0.5 * (row[k] + column[k]));
    let mut entries = Vec::new();
    if row[0] == 0.0 && column[1] == 0.0 && row[1] < 0.0 && column[0] > 0.0 {
        entries.push(EntryOut::numbers(tags::PIXEL_SCALE, tags::DOUBLE, &[column[0], -row[1], 0.0], order));
        let tie = [0.0, 0.0, 0.0, corner[0], corner[1], 0.0];
        entries.push(EntryOut::numbers(tags::TIEPOINTS, tags::DOUBLE, &tie, order));
    } else {
        let mut matrix = [0.0; 16];
        (matrix[0], matrix[1], matrix[3]) = (column[0], row[0], corner[0]);
        (matrix[4], matrix[5], matrix[7]) = (column[1], row[1], corner[1]);
        matrix[15] = 1.0;
        entries.push(EntryOut::numbers(tags::TRANSFORMATION, tags::DOUBLE, &matrix, order));
    }
    let mut keys = vec![[1025_u16, 0, 1, 1]];
    if let Some(system) = shape.coordinate_system() {
        let code = system.name.rsplit_once("EPSG:").and_then(|(_, code)| code.trim().parse::<u16>().ok());
        let kind = match system.kind {
            CoordinateSystemKind::Projected => Some((1, 3072)),
            CoordinateSystemKind::Geographic => Some((2, 2048)),
            _ => None,
        };
        if let (Some(code), Some((model, key))) = (code, kind) {
            keys.insert(0, [1024, 0, 1, model]);
            keys.push([key, 0, 1, code]);
        } else {
            c.report.report_dropped(format!("the coordinate system {}", system.name));
        }
    }
    let head = [1, 1, 0, keys.len() as u16];
    let keys: Vec<u16> = std::iter::once(head).chain(keys).flatten().collect();
    entries.push(EntryOut::numbers(KEYS, tags::SHORT, &keys, order));
    entries
}

/// Writes a new file without compression.
pub(super) fn write_tiff(shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let field = written_field(shape, c.format, &mut c.report)?;
    let cannot = |what: String| WriteError::CannotHold { format: c.format, what };
    let Some(layout) = shape.grid() else { return Err(cannot("a shape".into())) };
    let [.., height, width] = layout.sizes[..] else {
        return Err(cannot("a grid of one axis".into()));
    };
    let n_pages = if layout.sizes.len() == 3 { layout.sizes[0] } else { 1 };
    let n_channels = field.n_channels;
    if n_channels > usize::from(u16::MAX) || width.max(height) > u32::MAX as usize {
        return Err(cannot(format!("{n_channels} channels of {width} × {height} pixels")));
    }
    let kind = shape.value_type.unwrap_or(field.values.value_type());
    let order = ByteOrder::Little;
    let numbers = GridNumbers::new(kind, order, shape.n_vertices, n_channels);
    let mut image = Vec::new();
    numbers.write(None, field, c.format, &mut image, c.progress)?;
    let row_bytes = width * n_channels * kind.n_bytes();
    let page = Page {
        kind: PageKind { width, height, n_samples: n_channels, kind, n_bits: 8 * kind.n_bytes() },
        compression: codec::UNCOMPRESSED,
        predictor: 1,
        is_planar: false,
        chunk: [width, (STRIP_BYTES / row_bytes).clamp(1, height)],
        is_tiled: false,
        offsets: Vec::new(),
        counts: Vec::new(),
    };
    let mut pages = Vec::new();
    for k in 0..n_pages {
        let long = |tag: u16, number: usize| EntryOut::numbers(tag, tags::LONG, &[number as u32], order);
        let mut entries = vec![long(tags::WIDTH, width), long(tags::HEIGHT, height)];
        entries.extend(color_entries(kind, n_channels, order));
        entries.extend(map_entries(shape, layout, c));
        if !kind.is_integer() && layout.kept.is_some() {
            entries.push(EntryOut::text(tags::NODATA, "nan"));
        }
        let n = image.len() / n_pages;
        pages.push(PageOut::new(page.clone(), entries, &image[k * n..(k + 1) * n])?);
    }
    write_file(&pages, order, false, c)
}
