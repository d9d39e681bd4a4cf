//! Stereolithography, text and binary: a soup of triangles.

/// The number of triangles that a binary STL says it has.
pub(crate) fn binary_count(bytes: &[u8]) -> Option<u64> {
    let field = bytes.get(80..84)?;
    Some(u64::from(u32::from_le_bytes([field[0], field[1], field[2], field[3]])))
}
