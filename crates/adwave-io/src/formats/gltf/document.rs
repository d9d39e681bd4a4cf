//! glTF document and its buffers: chunks of a GLB, data in the text, external files.

use std::ops::Range;
use std::path::Path;

use adwave::Progress;
use base64::Engine as _;

use super::json::Json;
use crate::files::read::read_file;
use crate::{ReadError, ReadLimits};

const JSON_CHUNK: u32 = 0x4e4f_534a;
const BINARY_CHUNK: u32 = 0x004e_4942;

/// Unsupported extensions that encode geometry, and their description.
const UNREAD: [(&str, &str); 2] = [
    ("KHR_draco_mesh_compression", "its meshes are compressed by Draco"),
    ("EXT_meshopt_compression", "its buffers are compressed by meshopt"),
];

/// Location of the bytes of a buffer.
#[derive(Debug)]
pub(crate) enum Buffer {
    /// Bytes in the file itself.
    Within(Range<usize>),
    /// Bytes decoded from the text, or read from an external file.
    Own(Vec<u8>),
}

/// Parsed file.
#[derive(Debug)]
pub(crate) struct Document {
    pub(crate) bytes: Vec<u8>,
    pub(crate) json: Json,
    pub(crate) buffers: Vec<Buffer>,
    /// Pictures from external files.
    pub(crate) pictures: Vec<Option<Vec<u8>>>,
    pub(crate) is_binary: bool,
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
}

fn truncated(bytes: &[u8], needed: u64, element: &str) -> ReadError {
    ReadError::Truncated { end: bytes.len() as u64, needed, element: element.into(), row: 0 }
}

impl Document {
    /// Parses a file. `folder` contains external files; none are read if it is `None`.
    pub(crate) fn parse(
        bytes: Vec<u8>,
        folder: Option<&Path>,
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<Self, ReadError> {
        let is_binary = bytes.starts_with(b"glTF");
        let (text, binary) = if is_binary { chunks(&bytes)? } else { (0..bytes.len(), None) };
        let text = &bytes[text];
        let json = Json::parse(text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text))?;
        check_version(&json)?;
        for (name, what) in UNREAD {
            let required = json.list_of("extensionsRequired").iter().any(|e| e.text() == Some(name));
            if required {
                return Err(ReadError::Whole(format!(
                    "{what} ({name}), which is not supported; export it without compression, or with \
                    KHR_mesh_quantization"
                )));
            }
        }
        let mut document = Self { bytes, json, buffers: Vec::new(), pictures: Vec::new(), is_binary };
        document.load_buffers(binary.as_ref(), folder, limits, progress)?;
        document.load_pictures(folder, limits, progress)?;
        Ok(document)
    }

    /// Bytes of buffer `k`.
    pub(crate) fn buffer(&self, k: usize) -> Option<&[u8]> {
        match self.buffers.get(k)? {
            Buffer::Within(range) => self.bytes.get(range.clone()),
            Buffer::Own(bytes) => Some(bytes),
        }
    }

    fn load_buffers(
        &mut self,
        binary: Option<&Range<usize>>,
        folder: Option<&Path>,
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<(), ReadError> {
        let mut n_bytes = self.bytes.len() as u64;
        for (k, buffer) in self.json.list_of("buffers").iter().enumerate() {
            progress.check()?;
            let whole = match buffer.text_of("uri") {
                None if k == 0 && binary.is_some() => Buffer::Within(binary.cloned().unwrap_or_default()),
                // The fallback of a compressed buffer may have no bytes at all.
                None => Buffer::Own(Vec::new()),
                Some(uri) => Buffer::Own(resource(uri, folder, limits, progress)?),
            };
            let n = match &whole {
                Buffer::Within(range) => range.len(),
                Buffer::Own(bytes) => {
                    n_bytes += bytes.len() as u64;
                    limits.check_bytes(n_bytes)?;
                    bytes.len()
                }
            };
            let claimed = buffer.index_of("byteLength").unwrap_or(n);
            let is_there = buffer.text_of("uri").is_some() || k == 0 && binary.is_some();
            if claimed > n && is_there {
                return Err(ReadError::Truncated {
                    end: n as u64,
                    needed: claimed as u64,
                    element: format!("buffer {k}"),
                    row: 0,
                });
            }
            self.buffers.push(whole);
        }
        Ok(())
    }

    /// Loads external pictures, which are written together with the file; a missing one stays a name.
    fn load_pictures(
        &mut self,
        folder: Option<&Path>,
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<(), ReadError> {
        let mut n_bytes = 0;
        for image in self.json.list_of("images") {
            let beside = image.text_of("uri").filter(|uri| !uri.starts_with("data:"));
            let read = match beside.map(|uri| resource(uri, folder, limits, progress)) {
                Some(Ok(bytes)) => {
                    n_bytes += bytes.len() as u64;
                    limits.check_bytes(n_bytes)?;
                    Some(bytes)
                }
                Some(Err(ReadError::Cancelled(e))) => return Err(e.into()),
                Some(Err(_)) | None => None,
            };
            self.pictures.push(read);
        }
        Ok(())
    }
}

/// Ranges of the text and the numbers in a GLB.
fn chunks(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), ReadError> {
    let (Some(version), Some(length)) = (u32_at(bytes, 4), u32_at(bytes, 8)) else {
        return Err(truncated(bytes, 20, "header"));
    };
    if version != 2 {
        let message = format!("the file is glTF {version}; convert it to glTF 2.0");
        return Err(ReadError::byte_error(4, message));
    }
    if (length as usize) > bytes.len() {
        return Err(truncated(bytes, length.into(), "file"));
    }
    let (mut text, mut binary) = (None, None);
    let mut at = 12;
    while at + 8 <= length as usize {
        let (Some(n), Some(kind)) = (u32_at(bytes, at), u32_at(bytes, at + 4)) else { break };
        let range = at + 8..(at + 8).saturating_add(n as usize);
        if range.end > bytes.len() {
            return Err(truncated(bytes, range.end as u64, "chunk"));
        }
        at = range.end;
        match kind {
            JSON_CHUNK if text.is_none() => text = Some(range),
            BINARY_CHUNK if binary.is_none() => binary = Some(range),
            _ => {}
        }
    }
    let text =
        text.ok_or_else(|| ReadError::byte_error(12, "the first chunk must be JSON; get the whole file"))?;
    Ok((text, binary))
}

fn check_version(json: &Json) -> Result<(), ReadError> {
    let version = json.get("asset").and_then(|asset| asset.text_of("version"));
    match version {
        Some(version) if version.starts_with("2.") => Ok(()),
        Some(version) => {
            let shown: String = version.chars().filter(|c| !c.is_control()).take(20).collect();
            Err(ReadError::Whole(format!("the file is glTF {shown}; convert it to glTF 2.0")))
        }
        None => Err(ReadError::UnknownFormat {
            found: "JSON without the `asset` of a glTF 2.0".into(),
            readable: "glb, gltf".into(),
        }),
    }
}

/// Reads the bytes that a URI refers to.
fn resource(
    uri: &str,
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<u8>, ReadError> {
    let shown: String = uri.chars().filter(|c| !c.is_control()).take(80).collect();
    if let Some(rest) = uri.strip_prefix("data:") {
        let encoded = rest.split_once(";base64,").map(|(_, encoded)| encoded);
        let encoded = encoded.ok_or_else(|| ReadError::Whole(format!("`{shown}` is not base64 data")))?;
        return base64::engine::general_purpose::STANDARD
            .decode(encoded.trim_end())
            .map_err(|e| ReadError::Whole(format!("the base64 data is damaged ({e}); get the whole file")));
    }
    let name = decoded(uri);
    let path = Path::new(&name);
    // No file in another folder is opened because of the content of a file.
    let is_inside = path
        .components()
        .all(|part| matches!(part, std::path::Component::Normal(_) | std::path::Component::CurDir));
    if uri.contains("://") || !is_inside || name.is_empty() || name.contains(['\0', '\\']) {
        return Err(ReadError::Whole(format!(
            "`{shown}` must be in the folder of the file; move it there, or convert the file to GLB"
        )));
    }
    let Some(folder) = folder else {
        return Err(ReadError::Whole(format!(
            "the numbers are in the external file `{shown}`; open the file by its path, or convert it to GLB"
        )));
    };
    let path = folder.join(path);
    read_file(&path, limits, progress).map_err(|e| e.in_file(&path))
}

/// Decodes `%20` and similar escapes.
fn decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut plain = Vec::with_capacity(bytes.len());
    let mut k = 0;
    while k < bytes.len() {
        let hex = (bytes[k] == b'%').then(|| uri.get(k + 1..k + 3)).flatten();
        if let Some(byte) = hex.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            plain.push(byte);
            k += 3;
        } else {
            plain.push(bytes[k]);
            k += 1;
        }
    }
    String::from_utf8_lossy(&plain).into_owned()
}

/// Creates the head of a GLB from a text and the size of its first buffer.
pub(crate) fn glb_head(text: &[u8], n_binary: usize) -> Option<(Vec<u8>, usize)> {
    let (n_text, n_padded) = (text.len().next_multiple_of(4), n_binary.next_multiple_of(4));
    let has_binary = n_binary > 0;
    let total = 12 + 8 + n_text + if has_binary { 8 + n_padded } else { 0 };
    let total = u32::try_from(total).ok()?;
    let mut head = Vec::with_capacity(28 + n_text);
    head.extend_from_slice(b"glTF");
    for number in [2, total, n_text as u32, JSON_CHUNK] {
        head.extend_from_slice(&number.to_le_bytes());
    }
    head.extend_from_slice(text);
    head.resize(20 + n_text, b' ');
    if has_binary {
        head.extend_from_slice(&(n_padded as u32).to_le_bytes());
        head.extend_from_slice(&BINARY_CHUNK.to_le_bytes());
    }
    Some((head, n_padded - n_binary))
}
