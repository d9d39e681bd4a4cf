//! Finding the format of bytes: the content decides, the name only if the content leaves it open.

use crate::formats::TABLE;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::{ContentKind, Evidence};
use crate::registry::names::unknown_content;
use crate::{Format, ReadError};

/// Beginnings of files of other kinds, for the message.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\x93NUMPY", "a NumPy array: give it as a field of a shape"),
    (b"<", "XML or HTML"),
    (b"{", "JSON"),
    (b"\x89HDF", "HDF5"),
];

/// The format of the bytes. `name` is a file name that the content overrules.
pub(crate) fn sniff(bytes: &[u8], name: Option<&str>) -> Result<Format, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    let file = FileHead::new(bytes, name);
    let mut best: Option<(Evidence, Format)> = None;
    for descriptor in TABLE.iter().filter(|format| format.content != ContentKind::Values) {
        let evidence = (descriptor.recognize)(&file);
        // Among equals the first in the table.
        if let Some(evidence) = evidence.filter(|&found| best.is_none_or(|(most, _)| found > most)) {
            best = Some((evidence, descriptor.format));
        }
    }
    if let Some((_, format)) = best.filter(|&(evidence, _)| evidence >= Evidence::Layout) {
        return Ok(format);
    }
    if let Some(found) = foreign(&file) {
        return Err(unknown_content(found));
    }
    match (best, name.and_then(|name| Format::from_path(name.as_ref()))) {
        (Some((_, format)), _) => Ok(format),
        (None, _) if !file.is_text() => Err(unknown_content("binary of another kind")),
        (None, Some(format)) => {
            Err(unknown_content(format!("named as {format}, but it does not begin as such a file")))
        }
        (None, None) => Err(unknown_content("text of another kind")),
    }
}

/// Name of a kind of file that is known and not read as a shape, for the message.
fn foreign(file: &FileHead<'_>) -> Option<&'static str> {
    let known = TABLE.iter().find_map(|format| (format.name_foreign)(file));
    known.or_else(|| FOREIGN.iter().find(|(magic, _)| file.text.starts_with(magic)).map(|&(_, name)| name))
}
