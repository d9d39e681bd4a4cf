//! Writer of annotations (`lh.aparc.annot`), as read by FreeSurfer and nibabel.
//!
//! A vertex has the color of its label, so that all labels of a file must differ in color. Numbers are big-endian.

use std::collections::HashMap;
use std::path::Path;

use adwave::Progress;

use super::ANNOTATION;
use crate::model::label_table::{LabelEntry, LabelTable, label_key};
use crate::{Field, WriteError, atomic_write_with};

/// Version of the table of colors, in which entries have numbers.
const NUMBERED: i32 = -2;

/// Writes the labels of a field as an annotation, with the names and colors of its table in 8 bits per channel. Vertices
/// with NaN or a negative number have no label. The number of a label is its number in the table, which nibabel counts
/// from 0 whatever it is. O(n).
///
/// ```
/// use adwave_io::{Field, FieldValues, LabelEntry, LabelTable, ReadLimits, read_surface_values, write_annotation};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("lh.areas.annot");
/// let entry = LabelEntry { key: 0, name: "V1".into(), color: [1.0, 0.2, 0.0, 1.0] };
/// let table = LabelTable::new(vec![entry]);
/// let field = Field::new("areas", 1, FieldValues::I32(vec![0, -1, 0])).with_labels(Some(table.clone().into()));
/// write_annotation(&path, &field)?;
/// let read = read_surface_values(&path, None, 3, &ReadLimits::default()).unwrap();
/// assert_eq!(read[0].to_f64(), [0.0, -1.0, 0.0]);
/// assert_eq!(*read[0].labels.clone().unwrap(), table);
/// # Ok::<(), adwave_io::WriteError>(())
/// ```
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write), and [`WriteError::CannotHold`] for fields without a table of
/// labels or of several channels, labels without a name, negative numbers in the table, and two labels of one color or
/// a black one that vertices have.
pub fn write_annotation(path: &Path, field: &Field) -> Result<(), WriteError> {
    let bytes = encode(field).map_err(|what| WriteError::CannotHold { format: ANNOTATION.format, what })?;
    atomic_write_with(path, Progress::none(), |out| Ok(out.write_all(&bytes)?))
}

/// Color in 8 bits per channel, with the transparency.
fn bytes_of(color: [f32; 4]) -> [i32; 4] {
    let [red, green, blue, alpha] = color.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as i32);
    [red, green, blue, 255 - alpha]
}

/// Color in the encoding of the vertices.
fn code(entry: &LabelEntry) -> i32 {
    let [red, green, blue, _] = bytes_of(entry.color);
    red | green << 8 | blue << 16
}

fn encode(field: &Field) -> Result<Vec<u8>, String> {
    let name = &field.name;
    let table = match &field.labels {
        Some(table) if field.n_channels == 1 => table,
        Some(_) => return Err(format!("`{name}` with {} columns; write each of them", field.n_channels)),
        None => {
            return Err(format!("`{name}` as labels, because it has no table of their names and colors"));
        }
    };
    let used = used_codes(field, table)?;
    let mut bytes = Vec::with_capacity(8 * field.len() + 64 * table.entries().len());
    let mut put = |number: i32| bytes.extend(number.to_be_bytes());
    put(i32::try_from(field.len()).map_err(|_| format!("{} vertices, which exceeds 31 bits", field.len()))?);
    for i in 0..field.len() {
        put(i as i32);
        let key = label_key(field.get(i, 0)).unwrap_or(-1);
        put(used.get(&key).copied().unwrap_or(0));
    }
    put(1);
    put(NUMBERED);
    let listed = || table.entries().iter().filter(|entry| entry.key >= 0);
    put(listed().map(|entry| entry.key + 1).max().unwrap_or(0));
    let text = |bytes: &mut Vec<u8>, text: &str| {
        bytes.extend((text.len() as i32 + 1).to_be_bytes());
        bytes.extend(text.bytes().map(|byte| if byte == 0 { b'_' } else { byte }));
        bytes.push(0);
    };
    text(&mut bytes, "adwave");
    bytes.extend((listed().count() as i32).to_be_bytes());
    for entry in listed() {
        bytes.extend(entry.key.to_be_bytes());
        text(&mut bytes, &entry.name);
        bytes.extend(bytes_of(entry.color).into_iter().flat_map(i32::to_be_bytes));
    }
    Ok(bytes)
}

/// Colors of the labels that vertices have, by number.
fn used_codes(field: &Field, table: &LabelTable) -> Result<HashMap<i32, i32>, String> {
    let (mut codes, mut owners) = (HashMap::new(), HashMap::new());
    // The first entry of a color is the one that readers find.
    for entry in table.entries().iter().filter(|entry| entry.key >= 0) {
        owners.entry(code(entry)).or_insert(entry);
    }
    for i in 0..field.len() {
        let value = field.get(i, 0);
        let key = label_key(value).ok_or_else(|| format!("{value}, which is no label"))?;
        if key < 0 || codes.contains_key(&key) {
            continue;
        }
        let entry = table
            .entry(key)
            .ok_or_else(|| format!("label {key}, which has no name in the table of labels"))?;
        let (name, code) = (&entry.name, code(entry));
        if code == 0 {
            return Err(format!(
                "label {key} (`{name}`), because it is black as are vertices without a label; give it another color"
            ));
        }
        if let Some(other) = owners.get(&code).filter(|other| other.key != key) {
            return Err(format!(
                "labels {} (`{}`) and {key} (`{name}`), because they have one color; give one of them another",
                other.key, other.name
            ));
        }
        codes.insert(key, code);
    }
    Ok(codes)
}
