//! Texts in encodings other than UTF-8.

/// Converts UTF-16 text, identified by its byte order mark, to UTF-8; `None` without such a mark.
pub(crate) fn from_utf16(bytes: &[u8]) -> Option<Vec<u8>> {
    let is_big = match bytes {
        [0xff, 0xfe, ..] => false,
        [0xfe, 0xff, ..] => true,
        _ => return None,
    };
    let (pairs, _) = bytes[2..].as_chunks::<2>();
    let units =
        pairs.iter().map(|&pair| if is_big { u16::from_be_bytes(pair) } else { u16::from_le_bytes(pair) });
    let mut text = String::with_capacity(bytes.len() / 2);
    text.extend(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
    Some(text.into_bytes())
}

/// Converts bytes to text and drops the byte order mark.
///
/// # Errors
/// The bytes are not text.
pub(crate) fn to_utf8(bytes: Vec<u8>) -> Result<String, std::string::FromUtf8Error> {
    let mut text = String::from_utf8(from_utf16(&bytes).unwrap_or(bytes))?;
    if text.starts_with('\u{feff}') {
        text.drain(..3);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_orders_of_bytes_become_utf_8() {
        let text = "v 1 2 ä\u{1f600}\n";
        let little: Vec<u8> =
            [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> =
            [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect();
        for bytes in [little, big] {
            assert_eq!(from_utf16(&bytes).unwrap(), text.as_bytes());
            assert_eq!(to_utf8(bytes).unwrap(), text);
        }
        assert_eq!(from_utf16(text.as_bytes()), None);
        assert_eq!(to_utf8(b"\xef\xbb\xbfa".to_vec()).unwrap(), "a");
    }
}
