//! Which format bytes have: the content decides, the name only where the content leaves it open.

use std::path::Path;

use crate::text::{is_blank, line_end, parse_f64, words};
use crate::{Format, ReadError};

/// How far into the file is looked.
const LOOK: usize = 1 << 16;

/// The format of the bytes. `name` is a file name that the content overrules.
pub(crate) fn sniff(bytes: &[u8], name: Option<&str>) -> Result<Format, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty);
    }
    let hint = name.and_then(|n| Format::from_path(Path::new(n)));
    if let Some(format) = by_magic(bytes) {
        return Ok(format);
    }
    // Their words may be anything.
    if let Some(format @ (Format::Tgf | Format::EdgeList)) = hint
        && !bytes[..bytes.len().min(LOOK)].contains(&0)
    {
        return Ok(format);
    }
    if hint == Some(Format::Dmat) || crate::formats::dmat::read::begins_as_dmat(bytes) {
        return Ok(Format::Dmat);
    }
    // An archive that was cut has lost its list of names, but the name says what it was.
    if bytes.starts_with(b"PK\x03\x04")
        && let Some(format @ (Format::ThreeMf | Format::Amf)) = hint
    {
        return Ok(format);
    }
    if let Some(found) = foreign(bytes) {
        return Err(ReadError::UnknownFormat { found: found.into() });
    }
    let head = &bytes[..bytes.len().min(LOOK)];
    if head.contains(&0) {
        return binary(bytes, hint);
    }
    let first = statements(head).next();
    if let Some(keyword) = first.and_then(|line| words(line).next()) {
        if is_obj_keyword(keyword) {
            return Ok(Format::Obj);
        }
        if off_keyword(keyword).is_some() {
            return Ok(Format::Off);
        }
    }
    let format = match hint.map(Format::family) {
        Some(Format::Obj) if first.is_none() || any_obj_statement(head) => Format::Obj,
        Some(Format::Off) if first.is_some_and(is_counts) => Format::Off,
        Some(format @ (Format::Xyz | Format::Pts | Format::Csv)) => format,
        _ if has_rows_of_numbers(head) => Format::Xyz,
        Some(format) => {
            let found = format!("named as {format}, but it does not begin as such a file");
            return Err(ReadError::UnknownFormat { found });
        }
        None => return Err(ReadError::UnknownFormat { found: "text of another kind".into() }),
    };
    Ok(format)
}

/// Formats that their first bytes tell.
fn by_magic(bytes: &[u8]) -> Option<Format> {
    if let Some(rest) = bytes.strip_prefix(b"ply")
        && rest.first().is_none_or(|&b| b.is_ascii_whitespace())
    {
        return Some(Format::Ply);
    }
    if crate::formats::off::binary::head(bytes).is_some() {
        return Some(Format::Off);
    }
    if crate::formats::medit::binary::begins_as_meshb(bytes).is_some() {
        return Some(Format::MeditBinary);
    }
    if bytes.starts_with(b"LASF") {
        return Some(Format::Las);
    }
    if bytes.len() >= 14 && bytes[..14].eq_ignore_ascii_case(b"%%MatrixMarket") {
        return Some(Format::Mtx);
    }
    if bytes.starts_with(b"ASTM-E57") {
        return Some(Format::E57);
    }
    if bytes.starts_with(b"glTF") {
        return Some(Format::Glb);
    }
    if is_gltf(bytes) {
        return Some(Format::Gltf);
    }
    if crate::formats::freesurfer::read::is_surface(bytes) {
        return Some(Format::FreeSurfer);
    }
    if bytes.starts_with(crate::formats::vtk_legacy::read::MAGIC) {
        return Some(Format::Vtk);
    }
    let is_xml = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start().starts_with(b"<");
    if bytes.starts_with(b"PK\x03\x04") {
        return crate::bytes::package::format_of_archive(bytes);
    }
    if is_xml && has_element(&bytes[..bytes.len().min(LOOK)], b"graphml") {
        return Some(Format::GraphMl);
    }
    if is_xml && has_element(&bytes[..bytes.len().min(LOOK)], b"amf") {
        return Some(Format::Amf);
    }
    if is_xml && crate::formats::gifti::read::is_gifti(&bytes[..bytes.len().min(LOOK)]) {
        return Some(Format::Gifti);
    }
    if is_xml
        && let Some(Ok(format)) = crate::formats::vtk_xml::read::kind_of(&bytes[..bytes.len().min(LOOK)])
    {
        return Some(format);
    }
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    if [&b"$MeshFormat"[..], b"$Comments", b"$NOD"].iter().any(|begin| start.starts_with(begin)) {
        return Some(Format::Msh);
    }
    // Many binary STL begin with `solid` too; only the length tells.
    if crate::formats::stl::read::binary_count(bytes).is_some_and(|n| bytes.len() as u64 == 84 + 50 * n) {
        return Some(Format::Stl);
    }
    let head = &bytes[..bytes.len().min(LOOK)];
    let start = head.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
    let text = &head[start..];
    if text.len() >= 5 && text[..5].eq_ignore_ascii_case(b"solid") && !head.contains(&0) {
        return Some(Format::StlAscii);
    }
    if text.starts_with(b"# .PCD") {
        return Some(Format::Pcd);
    }
    let keyword = statements(head).next().and_then(|line| words(line).next());
    if is_geomview(text, keyword) {
        return Some(Format::Geomview);
    }
    if keyword == Some(b"MeshVersionFormatted") {
        return Some(Format::Medit);
    }
    let is_pcd =
        |word: &[u8]| [&b"VERSION"[..], b"FIELDS", b"COLUMNS"].iter().any(|k| word.eq_ignore_ascii_case(k));
    keyword.is_some_and(is_pcd).then_some(Format::Pcd)
}

/// Whether the first word is an object of Geomview, in braces or not.
fn is_geomview(text: &[u8], keyword: Option<&[u8]>) -> bool {
    let Some(inside) = text.strip_prefix(b"{") else {
        return keyword.is_some_and(crate::formats::geomview::read::begins_object);
    };
    let mut words = words(inside).map(|w| w.strip_prefix(b"{").unwrap_or(w)).filter(|w| !w.is_empty());
    words.next().is_some_and(|w| {
        crate::formats::geomview::read::begins_object(w)
            || off_keyword(w).is_some()
            || matches!(w, b"=" | b"appearance" | b"geom" | b"define" | b"INST")
    })
}

/// Whether `<name` stands in a text, with no other letter after it.
fn has_element(text: &[u8], name: &[u8]) -> bool {
    memchr::memmem::find_iter(text, name).any(|at| {
        at > 0 && text[at - 1] == b'<' && text.get(at + name.len()).is_none_or(|b| !b.is_ascii_alphanumeric())
    })
}

/// Whether it is JSON that says `asset`, as every glTF does.
fn is_gltf(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    text.starts_with(b"{") && memchr::memmem::find(text, b"\"asset\"").is_some()
}

/// What a file of a known other kind is, for the message.
fn foreign(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let begins: &[(&[u8], &str)] = &[
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"MATLAB 5.0", "a MATLAB file"),
        (b"\x93NUMPY", "a NumPy array: give it as a field of a shape"),
        (b"<", "XML or HTML"),
        (b"{", "JSON"),
        (b"newmtl", "a material library of an OBJ"),
        (b"\x89HDF", "HDF5"),
    ];
    if let Some(found) = crate::registry::surface_values::kind_of(bytes) {
        return Some(found);
    }
    if let Some(Err(found)) = crate::formats::vtk_xml::read::kind_of(&text[..text.len().min(LOOK)]) {
        return Some(found);
    }
    begins.iter().find(|(magic, _)| text.starts_with(magic)).map(|(_, name)| *name)
}

/// Binary content without magic: only an STL that is cut, or longer than it says.
fn binary(bytes: &[u8], hint: Option<Format>) -> Result<Format, ReadError> {
    let begins_solid = bytes.starts_with(b"solid");
    if bytes.len() >= 84 && (begins_solid || hint == Some(Format::Stl)) {
        return Ok(Format::Stl);
    }
    if hint == Some(Format::Stl) {
        return Err(ReadError::Truncated {
            end: bytes.len() as u64,
            needed: 84,
            element: "header".into(),
            row: 0,
        });
    }
    Err(ReadError::UnknownFormat { found: "binary of another kind".into() })
}

/// Lines that are neither blank nor a comment, without the blanks before them.
fn statements(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut position = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    std::iter::from_fn(move || {
        while position < text.len() {
            let end = line_end(text, position);
            let line = text[position..end].trim_ascii();
            position = end + 1;
            if !line.is_empty() && line[0] != b'#' && !line.starts_with(b"//") {
                return Some(line);
            }
        }
        None
    })
}

fn is_obj_keyword(word: &[u8]) -> bool {
    const KEYWORDS: [&[u8]; 16] = [
        b"v", b"vt", b"vn", b"vp", b"f", b"fo", b"l", b"p", b"g", b"o", b"s", b"mg", b"usemtl", b"mtllib",
        b"cstype", b"deg",
    ];
    KEYWORDS.contains(&word)
}

fn any_obj_statement(head: &[u8]) -> bool {
    statements(head).any(|line| words(line).next().is_some_and(is_obj_keyword))
}

/// The letters before `OFF`, and the rest of the word: `COFF` is `(C, )`, `OFF8` is `(, 8)`.
pub(crate) fn off_keyword(word: &[u8]) -> Option<(&[u8], &[u8])> {
    let at = memchr::memmem::find(word, b"OFF")?;
    let (letters, rest) = (&word[..at], &word[at + 3..]);
    let known = letters.iter().all(|b| matches!(b, b'S' | b'T' | b'C' | b'N' | b'4' | b'n'));
    (known && rest.iter().all(u8::is_ascii_digit)).then_some((letters, rest))
}

fn is_counts(line: &[u8]) -> bool {
    let mut n = 0;
    words(line).all(|w| {
        n += 1;
        w.iter().all(u8::is_ascii_digit)
    }) && n == 3
}

/// Whether the first lines are rows of at least three numbers, but for a count or a row of names before them.
fn has_rows_of_numbers(head: &[u8]) -> bool {
    let numbers = |line: &[u8]| {
        let mut n = 0;
        let separator = |b: &u8| is_blank(*b) || matches!(b, b',' | b';');
        let all = line.split(separator).filter(|w| !w.is_empty()).all(|w| {
            n += 1;
            parse_f64(w).is_some()
        });
        all.then_some(n)
    };
    let mut lines = statements(head);
    match lines.next().map(numbers) {
        Some(Some(n)) if n >= 3 => true,
        Some(Some(1) | None) => lines.next().and_then(numbers).is_some_and(|n| n >= 3),
        _ => false,
    }
}
