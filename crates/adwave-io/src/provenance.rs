//! Provenance of a result, stored in files of formats that have room for it.

use serde_json::{Value, json};

/// The program and command that made a shape, and the files it was made from.
///
/// Glb and glTF carry it in the extras of their asset, VTP and VTU as field data, LAS and LAZ as a variable-length
/// record, PLY and OBJ as a comment; other formats do not. A file whose content did not change is written byte for
/// byte, without it.
///
/// ```
/// use adwave_io::{Format, Provenance, ProvenanceInput, ReadLimits, ShapeFile, read_bytes, write_bytes};
/// let mut shape = ShapeFile::from_cloud(vec![[0.0, 0.5, 1.0]]);
/// let input = ProvenanceInput { name: "scan.laz".into(), sha256: Some("9f86d081884c7d65".repeat(4)) };
/// let made = Provenance { program: "adwave 0.1.0".into(), command: "adwave denoise scan.laz -o a.vtp".into(), inputs: vec![input] };
/// shape.set_provenance(Some(made.clone()));
/// let mut bytes = Vec::new();
/// write_bytes(&shape, Format::VTP, &mut bytes).unwrap();
/// let again = read_bytes(bytes, None, &ReadLimits::default()).unwrap();
/// assert_eq!(again.provenance(), Some(&made));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Name and version of the program.
    pub program: String,
    /// Command line, without the folders of files.
    pub command: String,
    /// Files that were read.
    pub inputs: Vec<ProvenanceInput>,
}

/// File from which a result was created.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProvenanceInput {
    /// Name without folders.
    pub name: String,
    /// SHA-256 of its bytes in hexadecimal digits; `None` for an input without bytes.
    pub sha256: Option<String>,
}

/// Key among other metadata.
pub(crate) const NAME: &str = "adwave";
/// UTF-8 byte order mark, which some editors write.
const MARK: &[u8] = b"\xef\xbb\xbf";
/// Largest size of a provenance text in bytes.
const MOST: usize = 60_000;

impl Provenance {
    /// Formats as JSON on one line, in ASCII.
    pub fn to_json(&self) -> String {
        let input = |input: &ProvenanceInput| json!({"name": input.name, "sha256": input.sha256});
        let inputs: Vec<Value> = self.inputs.iter().map(input).collect();
        let text = json!({"program": self.program, "command": self.command, "inputs": inputs}).to_string();
        let mut ascii = String::with_capacity(text.len());
        for c in text.chars() {
            if c.is_ascii() && !c.is_ascii_control() {
                ascii.push(c);
            } else {
                for unit in c.encode_utf16(&mut [0; 2]) {
                    ascii += &format!("\\u{unit:04x}");
                }
            }
        }
        ascii
    }

    /// Inverse of [`to_json`](Self::to_json); `None` for other texts.
    pub fn from_json(text: &str) -> Option<Self> {
        if text.len() > MOST {
            return None;
        }
        let value: Value = serde_json::from_str(text).ok()?;
        let plain = |value: &Value| Some(value.as_str()?.chars().filter(|c| !c.is_control()).collect());
        let input = |value: &Value| {
            let digits = value["sha256"]
                .as_str()
                .filter(|d| d.len() == 64 && d.bytes().all(|b| b.is_ascii_hexdigit()));
            Some(ProvenanceInput { name: plain(&value["name"])?, sha256: digits.map(str::to_owned) })
        };
        Some(Self {
            program: plain(&value["program"])?,
            command: plain(&value["command"])?,
            inputs: value["inputs"].as_array()?.iter().map(input).collect::<Option<_>>()?,
        })
    }
}

/// Text with an additional line after the first `lines_before`; a UTF-8 byte order mark stays first.
pub(crate) struct CommentInserter<'a> {
    out: &'a mut dyn std::io::Write,
    line: Option<Vec<u8>>,
    lines_before: usize,
}

impl<'a> CommentInserter<'a> {
    pub(crate) fn new(out: &'a mut dyn std::io::Write, line: String, lines_before: usize) -> Self {
        Self { out, line: Some(line.into_bytes()), lines_before }
    }
}

impl std::io::Write for CommentInserter<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let Some(line) = self.line.take() else { return self.out.write(bytes) };
        let mut at = if bytes.starts_with(MARK) && self.lines_before == 0 { MARK.len() } else { 0 };
        while self.lines_before > 0 {
            let Some(end) = memchr::memchr(b'\n', &bytes[at..]) else {
                self.line = Some(line);
                self.out.write_all(bytes)?;
                return Ok(bytes.len());
            };
            at += end + 1;
            self.lines_before -= 1;
        }
        self.out.write_all(&bytes[..at])?;
        self.out.write_all(&line)?;
        self.out.write_all(&bytes[at..])?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

/// Content of the comment with this beginning in the first lines of a text.
pub(crate) fn in_comments(bytes: &[u8], begin: &str) -> Option<Provenance> {
    const LINES: usize = 64;
    let head = &bytes[..bytes.len().min(4 * MOST)];
    let head = head.strip_prefix(MARK).unwrap_or(head);
    let mut lines = head.split(|&b| b == b'\n').take(LINES);
    let text = lines.find_map(|line| line.strip_prefix(begin.as_bytes())?.strip_prefix(b" "))?;
    Provenance::from_json(std::str::from_utf8(text).ok()?.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_is_ascii_and_leads_back() {
        let made = Provenance {
            program: "adwave 1".into(),
            command: "adwave filter größe\u{1f600}.ply -o \"a b.ply\"".into(),
            inputs: vec![ProvenanceInput { name: "größe\u{1f600}.ply".into(), sha256: None }],
        };
        let json = made.to_json();
        assert!(json.is_ascii() && !json.contains('\n'), "{json}");
        assert_eq!(Provenance::from_json(&json), Some(made));
        for bad in ["", "{}", "[]", "{\"program\":\"a\",\"command\":1,\"inputs\":[]}", "nan"] {
            assert_eq!(Provenance::from_json(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_comment_goes_after_the_lines_before_it() {
        use std::io::Write;
        for (lines, expected) in [(0, "#c\na\nb\nc"), (1, "a\n#c\nb\nc"), (2, "a\nb\n#c\nc")] {
            for piece in 1..6 {
                let mut out = Vec::new();
                let mut writer = CommentInserter::new(&mut out, "#c\n".into(), lines);
                b"a\nb\nc".chunks(piece).for_each(|chunk| writer.write_all(chunk).unwrap());
                assert_eq!(String::from_utf8(out).unwrap(), expected);
            }
        }
    }

    #[test]
    fn what_changed_is_not_said_to_be_the_old_result() {
        use crate::{Field, FieldValues, Format, ReadLimits, ShapeFile, read_bytes, write_bytes};
        let written = |shape: &ShapeFile, format: Format| {
            let mut bytes = Vec::new();
            write_bytes(shape, format, &mut bytes).unwrap();
            bytes
        };
        let input = ProvenanceInput { name: "a.ply".into(), sha256: None };
        let made = Provenance { program: "p".into(), command: "c".into(), inputs: vec![input] };
        for format in [Format::GLB, Format::GLTF, Format::VTP, Format::VTU, Format::LAS, Format::LAZ] {
            let mut shape = ShapeFile::from_cloud(vec![[0.0, 0.5, 1.0], [1.0, 0.0, 0.25]]);
            shape.set_provenance(Some(made.clone()));
            let bytes = written(&shape, format);
            let read = |bytes: Vec<u8>| read_bytes(bytes, None, &ReadLimits::default()).unwrap();
            let same = read(bytes.clone());
            assert_eq!(same.provenance(), Some(&made), "{format}");
            assert_eq!(written(&same, format), bytes, "{format}");
            let mut moved = same.clone();
            moved.set_points(vec![[0.0, 0.5, 1.0], [1.0, 0.0, 0.5]]).unwrap();
            assert_eq!(read(written(&moved, format)).provenance(), None, "{format}");
            let mut more = same.clone();
            more.add_vertex_field(Field::new("a", 1, FieldValues::U8(vec![1, 2]))).unwrap();
            assert_eq!(read(written(&more, format)).provenance(), None, "{format}");
            more.set_provenance(Some(Provenance { command: "d".into(), ..made.clone() }));
            assert_eq!(read(written(&more, format)).provenance().unwrap().command, "d", "{format}");
        }
    }
}
