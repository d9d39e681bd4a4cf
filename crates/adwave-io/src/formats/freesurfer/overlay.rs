//! Values at the vertices of a surface: curv files (`lh.thickness`), annotations (`lh.aparc.annot`), MGH and MGZ.

use std::sync::Arc;

use adwave::Progress;

use crate::model::field::{ByteOrder, Number};
use crate::model::label_table::{LabelEntry, LabelTable};
use crate::model::numbers::{collect_rows, from_bytes};
use crate::progress::collect;
use crate::{Field, FieldValues, ReadError, ValueType};

/// Size of the header of a curv file in bytes.
const CURV_HEADER: u64 = 15;
/// Size of the header of an MGH in bytes.
const MGH_HEADER: usize = 284;

/// 32-bit integer at an offset.
fn int(bytes: &[u8], at: usize) -> Option<i32> {
    bytes.get(at..)?.get(..4).map(|four| i32::from_bytes(four, ByteOrder::Big))
}

fn cut(bytes: &[u8]) -> ReadError {
    ReadError::byte_error(bytes.len(), "the file ends within its values; get the whole file")
}

/// True if the bytes are a curv file: vertices, triangles, values per vertex, and as many numbers.
pub(crate) fn is_curv(bytes: &[u8]) -> bool {
    let count = |at: usize| int(bytes, at).and_then(|n| u64::try_from(n).ok());
    let (Some(n), Some(_), Some(k)) = (count(3), count(7), count(11)) else { return false };
    bytes.starts_with(b"\xff\xff\xff") && n * k.min(1 << 20) * 4 + CURV_HEADER == bytes.len() as u64
}

/// True if the bytes are an MGH: its version, and a known type of numbers.
pub(crate) fn is_mgh(bytes: &[u8]) -> bool {
    bytes.len() >= MGH_HEADER
        && int(bytes, 0) == Some(1)
        && int(bytes, 20).is_some_and(|kind| matches!(kind, 0 | 1 | 3 | 4 | 10))
        && (4..20).step_by(4).all(|at| int(bytes, at).is_some_and(|n| n > 0))
}

/// True if the bytes may be an annotation: pairs of a vertex and its color, followed by a table of colors.
pub(crate) fn is_annotation(bytes: &[u8]) -> bool {
    let Some(n) = int(bytes, 0).and_then(|n| usize::try_from(n).ok()).filter(|&n| n > 0) else {
        return false;
    };
    let end = n.saturating_mul(8).saturating_add(4);
    end == bytes.len() || int(bytes, end) == Some(1)
}

/// Reads a curv file.
pub(crate) fn read_curv(bytes: &[u8], progress: Progress<'_>) -> Result<Field, ReadError> {
    let k =
        int(bytes, 11).and_then(|k| usize::try_from(k).ok()).filter(|&k| k > 0).ok_or_else(|| cut(bytes))?;
    let values = from_bytes(&bytes[CURV_HEADER as usize..], ValueType::F32, ByteOrder::Big, progress)?;
    Ok(Field::new("curv", k, values))
}

/// Reads an MGH with one column per frame.
pub(crate) fn read_mgh(bytes: &[u8], progress: Progress<'_>) -> Result<Field, ReadError> {
    let count = |at: usize| int(bytes, at).and_then(|n| usize::try_from(n).ok()).ok_or_else(|| cut(bytes));
    let n = [count(4)?, count(8)?, count(12)?].into_iter().try_fold(1_usize, usize::checked_mul);
    let frames = count(16)?;
    let kind = match count(20)? {
        0 => ValueType::U8,
        1 => ValueType::I32,
        3 => ValueType::F32,
        4 => ValueType::I16,
        10 => ValueType::U16,
        other => {
            return Err(ReadError::byte_error(
                20,
                format!("values of type {other} are not supported; save them as floats"),
            ));
        }
    };
    let n_bytes = n.and_then(|n| n.checked_mul(frames)?.checked_mul(kind.n_bytes()));
    let (Some(n), Some(n_bytes)) = (n, n_bytes) else { return Err(cut(bytes)) };
    let data = bytes.get(MGH_HEADER..).and_then(|data| data.get(..n_bytes)).ok_or_else(|| cut(bytes))?;
    if frames == 0 || n == 0 {
        return Err(ReadError::byte_error(4, "the file has no values; use a file with values"));
    }
    let by_frame = Field::new("overlay", 1, from_bytes(data, kind, ByteOrder::Big, progress)?);
    let by_vertex = collect_rows(&by_frame, n * frames, progress, &|i| i % frames * n + i / frames)?;
    Ok(Field::new("overlay", frames, by_vertex.values))
}

/// Reads an annotation: for each vertex the index of its label in the table of colors, −1 without a label; without a
/// table the colors as numbers.
pub(crate) fn read_annotation(bytes: &[u8], progress: Progress<'_>) -> Result<Field, ReadError> {
    Ok(read_regions(bytes, progress)?.labels)
}

/// Content of an annotation.
pub(crate) struct Regions {
    /// Index of the region of each vertex in the table of colors, −1 without a region; without a table its color.
    pub(crate) labels: Field,
    /// Index and name of each region of the table.
    pub(crate) names: Vec<(i32, String)>,
}

/// Reads an annotation with the names of its regions.
pub(crate) fn read_regions(bytes: &[u8], progress: Progress<'_>) -> Result<Regions, ReadError> {
    let n = int(bytes, 0).and_then(|n| usize::try_from(n).ok()).ok_or_else(|| cut(bytes))?;
    let pairs =
        n.checked_mul(8).and_then(|length| bytes.get(4..)?.get(..length)).ok_or_else(|| cut(bytes))?;
    let mut colors = vec![0; n];
    for (i, pair) in pairs.chunks_exact(8).enumerate() {
        crate::progress::report_row(progress, i as u64, n as u64)?;
        let vertex = i32::from_bytes(pair, ByteOrder::Big);
        let place = usize::try_from(vertex).ok().and_then(|v| colors.get_mut(v)).ok_or_else(|| {
            let message = format!("vertex {vertex} does not exist, as there are {n}; correct it");
            ReadError::byte_error(4 + 8 * i, message)
        })?;
        *place = i32::from_bytes(&pair[4..], ByteOrder::Big);
    }
    let mut table = ColorTable { bytes, at: 4 + pairs.len() };
    let (labels, names, of_labels) = if table.at == bytes.len() {
        (colors, Vec::new(), None)
    } else {
        let mut entries = table.entries().ok_or_else(|| {
            ReadError::byte_error(table.at, "the table of colors is truncated; get the whole file")
        })?;
        let names = entries.iter().map(|entry| (entry.number, entry.name.clone())).collect();
        let of_labels = LabelTable::new(entries.iter().map(ColorEntry::to_label).collect());
        entries.sort_by_key(|entry| entry.color);
        let label = |color: i32| {
            let at = entries.partition_point(|entry| entry.color < color);
            entries
                .get(at)
                .filter(|entry| entry.color == color && color != 0)
                .map_or(-1, |entry| entry.number)
        };
        (collect(n, progress, |v| label(colors[v]))?, names, Some(Arc::new(of_labels)))
    };
    Ok(Regions { labels: Field::new("label", 1, FieldValues::I32(labels)).with_labels(of_labels), names })
}

/// Table of colors at the end of an annotation.
struct ColorTable<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl ColorTable<'_> {
    fn int(&mut self) -> Option<i32> {
        let value = int(self.bytes, self.at)?;
        self.at += 4;
        Some(value)
    }

    /// Reads a text after its length, without the zero byte that ends it.
    fn text(&mut self) -> Option<String> {
        let length = usize::try_from(self.int()?).ok()?;
        let end = self.at.checked_add(length).filter(|&end| end <= self.bytes.len())?;
        let text = &self.bytes[self.at..end];
        self.at = end;
        let text = text.split(|&byte| byte == 0).next().unwrap_or_default();
        Some(String::from_utf8_lossy(text).into_owned())
    }

    /// Entries of the table.
    fn entries(&mut self) -> Option<Vec<ColorEntry>> {
        if self.int()? != 1 {
            return None;
        }
        let first = self.int()?;
        // The second version starts with a negative number and has explicit entry numbers.
        let is_numbered = first < 0;
        if is_numbered {
            self.int()?;
        }
        self.text()?;
        let n = if is_numbered { self.int()? } else { first };
        let mut entries = Vec::new();
        for k in 0..n {
            let number = if is_numbered { self.int()? } else { k };
            let name = self.text()?;
            let [r, g, b, transparency] = [self.int()?, self.int()?, self.int()?, self.int()?];
            let color = (r & 255) | (g & 255) << 8 | (b & 255) << 16;
            entries.push(ColorEntry { color, transparency: transparency as u8, number, name });
        }
        Some(entries)
    }
}

/// Region of an annotation.
struct ColorEntry {
    /// Color in the encoding of the vertices.
    color: i32,
    /// 0 if the color is opaque.
    transparency: u8,
    number: i32,
    name: String,
}

impl ColorEntry {
    fn to_label(&self) -> LabelEntry {
        let [red, green, blue, _] = self.color.to_le_bytes();
        let color = [red, green, blue, 255 - self.transparency].map(|c| f32::from(c) / 255.0);
        LabelEntry { key: self.number, name: self.name.clone(), color }
    }
}
