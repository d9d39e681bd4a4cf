//! Coordinate system of a LAS, as text or as GeoTIFF keys in its records.

use crate::CoordinateSystem;
use crate::formats::las::read::{LasHeader, VariableRecord, u32_at, u64_at};
use crate::formats::las::wkt::parse_wkt;
use crate::model::geo_keys::{GeoKeys, KEYS, NUMBERS, TEXTS, text_of};

/// Number of the record with a text.
const WKT: u16 = 2112;

/// Largest number of extended records that are searched.
const MOST_EXTENDED: u32 = 1 << 10;
/// Size of the head of an extended record in bytes.
const EXTENDED_HEAD: usize = 60;

/// Coordinate system in the records of a file.
pub(crate) fn coordinate_system(
    bytes: &[u8],
    header: &LasHeader,
    records: &[VariableRecord<'_>],
) -> Option<CoordinateSystem> {
    let content = |id: u16| {
        let own = records.iter().find(|r| r.id == id && is_projection(r.user));
        own.map(|r| r.content).or_else(|| extended(bytes, header, id))
    };
    let text = || parse_wkt(&text_of(content(WKT)?));
    let keys = || GeoKeys { keys: content(KEYS)?, numbers: content(NUMBERS), texts: content(TEXTS) }.system();
    // A flag of the header says which of the two holds.
    let prefers_text = bytes.get(6).is_some_and(|flags| flags & 16 != 0);
    if prefers_text { text().or_else(keys) } else { keys().or_else(text) }
}

fn is_projection(user: &[u8]) -> bool {
    user.starts_with(b"LASF_Projection")
}

/// Content of an extended record after the points.
fn extended<'a>(bytes: &'a [u8], header: &LasHeader, id: u16) -> Option<&'a [u8]> {
    if bytes.get(25)? < &4 || header.bytes < 375 {
        return None;
    }
    let mut at = usize::try_from(u64_at(bytes, 235)?).ok()?;
    for _ in 0..u32_at(bytes, 243)?.min(MOST_EXTENDED) {
        let head = bytes.get(at..at.checked_add(EXTENDED_HEAD)?)?;
        let start = at + EXTENDED_HEAD;
        let end = start.checked_add(usize::try_from(u64_at(head, 20)?).ok()?)?;
        let content = bytes.get(start..end)?;
        if is_projection(&head[2..18]) && head[18..20] == id.to_le_bytes() {
            return Some(content);
        }
        at = end;
    }
    None
}
