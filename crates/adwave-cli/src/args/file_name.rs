//! Names of files that need not be UTF-8, as text.

use clap::builder::{OsStringValueParser, TypedValueParser};
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

/// First of the 256 characters, the last private ones of Unicode, that stand for bytes that are no UTF-8.
const FIRST: u32 = 0x0010_FF00;

/// Parser of the name of a file, `-` or `sample:NAME`. A byte that is no UTF-8 becomes a private character.
pub(crate) fn file_name() -> impl TypedValueParser<Value = String> {
    OsStringValueParser::new().map(|name: OsString| encode(&name))
}

/// A name as text, from which [`to_path`] restores it.
fn encode(name: &OsStr) -> String {
    let mut text = String::new();
    for chunk in name.as_encoded_bytes().utf8_chunks() {
        text += chunk.valid();
        text.extend(chunk.invalid().iter().filter_map(|&byte| char::from_u32(FIRST + u32::from(byte))));
    }
    text
}

/// The byte that a character stands for.
fn byte_of(c: char) -> Option<u8> {
    u32::from(c).checked_sub(FIRST).and_then(|byte| u8::try_from(byte).ok())
}

/// The path of a name that [`file_name`] has parsed.
pub(crate) fn to_path(name: &str) -> PathBuf {
    if !name.contains(|c| byte_of(c).is_some()) {
        return PathBuf::from(name);
    }
    let mut bytes = Vec::with_capacity(name.len());
    for c in name.chars() {
        match byte_of(c) {
            Some(byte) => bytes.push(byte),
            None => bytes.extend(c.encode_utf8(&mut [0; 4]).bytes()),
        }
    }
    path_from_bytes(bytes)
}

#[cfg(unix)]
fn path_from_bytes(bytes: Vec<u8>) -> PathBuf {
    let name: OsString = std::os::unix::ffi::OsStringExt::from_vec(bytes);
    PathBuf::from(name)
}

#[cfg(not(unix))]
fn path_from_bytes(bytes: Vec<u8>) -> PathBuf {
    PathBuf::from(String::from_utf8_lossy(&bytes).into_owned())
}

/// Text for people, with the replacement character for each byte that is no UTF-8.
pub(crate) fn shown_text(text: &str) -> String {
    text.chars().map(|c| if byte_of(c).is_some() { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::ffi::{OsStrExt, OsStringExt};

    #[test]
    fn every_name_comes_back() {
        for bytes in [&b"a.ply"[..], b"\xe4\xf6.ply", "ä/ö.ply".as_bytes(), b"\xff\xfe", b""] {
            let name = OsString::from_vec(bytes.to_vec());
            assert_eq!(to_path(&encode(&name)).as_os_str().as_bytes(), bytes);
        }
        assert_eq!(shown_text(&encode(OsStr::from_bytes(b"a\xe4.ply"))), "a\u{fffd}.ply");
    }
}
