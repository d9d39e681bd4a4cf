//! Coordinate systems as GeoTIFF keys, in records of a LAS or tags of a TIFF.

use crate::model::units::show;
use crate::{CoordinateSystem, CoordinateSystemKind, LengthUnit};

/// Directory of the keys: number of its record or tag.
pub(crate) const KEYS: u16 = 34735;
/// Numbers that the directory refers to.
pub(crate) const NUMBERS: u16 = 34736;
/// Texts that the directory refers to.
pub(crate) const TEXTS: u16 = 34737;

/// GeoTIFF keys.
const MODEL_TYPE: u16 = 1024;
const CITATION: u16 = 1026;
const GEOGRAPHIC_CODE: u16 = 2048;
const GEOGRAPHIC_CITATION: u16 = 2049;
const PROJECTED_CODE: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const LINEAR_UNIT: u16 = 3076;
const LINEAR_UNIT_SIZE: u16 = 3077;

/// Text up to its first zero.
pub(crate) fn text_of(content: &[u8]) -> String {
    String::from_utf8_lossy(content.split(|&b| b == 0).next().unwrap_or_default()).into_owned()
}

/// Keys of GeoTIFF with the numbers and texts that they refer to.
pub(crate) struct GeoKeys<'a> {
    /// Directory, in little-endian order as the numbers.
    pub(crate) keys: &'a [u8],
    pub(crate) numbers: Option<&'a [u8]>,
    pub(crate) texts: Option<&'a [u8]>,
}

/// Entry of the directory: its value, or the place of the value.
struct GeoKey {
    location: u16,
    count: u16,
    value: u16,
}

impl GeoKeys<'_> {
    fn key(&self, id: u16) -> Option<GeoKey> {
        let rows = self.keys.chunks_exact(8).skip(1);
        let number = |row: &[u8], k: usize| u16::from_le_bytes([row[2 * k], row[2 * k + 1]]);
        let row = rows.into_iter().find(|row| number(row, 0) == id)?;
        Some(GeoKey { location: number(row, 1), count: number(row, 2), value: number(row, 3) })
    }

    /// Number in the directory itself; `None` for the codes of systems that the user defines.
    pub(crate) fn code(&self, id: u16) -> Option<u16> {
        let key = self.key(id).filter(|key| key.location == 0)?;
        (key.value != 0 && key.value != 32767).then_some(key.value)
    }

    fn number(&self, id: u16) -> Option<f64> {
        let key = self.key(id).filter(|key| key.location == NUMBERS)?;
        let own = self.numbers?.get(8 * usize::from(key.value)..)?.get(..8)?;
        Some(f64::from_le_bytes(own.try_into().ok()?))
    }

    fn text(&self, id: u16) -> Option<String> {
        let key = self.key(id).filter(|key| key.location == TEXTS)?;
        let own = self.texts?.get(usize::from(key.value)..)?;
        let own = &own[..own.len().min(usize::from(key.count))];
        let text = show(text_of(own).trim_end_matches('|'));
        (!text.is_empty()).then_some(text)
    }

    /// Coordinate system that the keys describe.
    pub(crate) fn system(&self) -> Option<CoordinateSystem> {
        let (projected, geographic) = (self.code(PROJECTED_CODE), self.code(GEOGRAPHIC_CODE));
        let kind = match self.code(MODEL_TYPE) {
            Some(1) => CoordinateSystemKind::Projected,
            Some(2) => CoordinateSystemKind::Geographic,
            Some(3) => CoordinateSystemKind::Geocentric,
            _ if projected.is_some() => CoordinateSystemKind::Projected,
            _ if geographic.is_some() => CoordinateSystemKind::Geographic,
            _ => return None,
        };
        let is_geographic = kind == CoordinateSystemKind::Geographic;
        let (code, citation) = match kind {
            CoordinateSystemKind::Projected => (projected, PROJECTED_CITATION),
            _ => (geographic, GEOGRAPHIC_CITATION),
        };
        let name = self.text(citation).or_else(|| self.text(CITATION));
        let code = code.map(|code| format!("EPSG:{code}"));
        let name = match (name, code) {
            (Some(name), Some(code)) => format!("{name}, {code}"),
            (name, code) => name.or(code).unwrap_or_else(|| "without a name".into()),
        };
        let unit = || match self.code(LINEAR_UNIT) {
            Some(9001) => Some(LengthUnit::METER),
            Some(9002) => Some(LengthUnit::FOOT),
            Some(9003) => Some(LengthUnit::US_SURVEY_FOOT),
            _ => LengthUnit::from_meters("unit of the projection", self.number(LINEAR_UNIT_SIZE)?),
        };
        Some(CoordinateSystem { name, kind, unit: if is_geographic { None } else { unit() } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directory(entries: &[[u16; 4]]) -> Vec<u8> {
        let head = [1, 1, 0, entries.len() as u16];
        std::iter::once(&head).chain(entries).flatten().flat_map(|x| x.to_le_bytes()).collect()
    }

    fn system(entries: &[[u16; 4]]) -> Option<CoordinateSystem> {
        let keys = directory(entries);
        let numbers = 0.5_f64.to_le_bytes();
        GeoKeys { keys: &keys, numbers: Some(&numbers), texts: Some(b"UTM 10 N|NAD83|") }.system()
    }

    #[test]
    fn keys_name_the_kind_the_unit_and_the_system() {
        let utm =
            system(&[[1024, 0, 1, 1], [3072, 0, 1, 26910], [3073, TEXTS, 9, 0], [3076, 0, 1, 9001]]).unwrap();
        assert_eq!(utm.name, "UTM 10 N, EPSG:26910");
        assert_eq!((utm.kind, utm.unit), (CoordinateSystemKind::Projected, Some(LengthUnit::METER)));
        let feet = system(&[[3072, 0, 1, 2286], [3076, 0, 1, 9003]]).unwrap();
        assert_eq!((feet.name.as_str(), feet.unit), ("EPSG:2286", Some(LengthUnit::US_SURVEY_FOOT)));
        let degrees = system(&[[1024, 0, 1, 2], [2048, 0, 1, 4269], [2049, TEXTS, 6, 9]]).unwrap();
        assert!(degrees.is_geographic() && degrees.unit.is_none() && degrees.name == "NAD83, EPSG:4269");
        let own = system(&[[1024, 0, 1, 1], [3072, 0, 1, 32767], [3077, NUMBERS, 1, 0]]).unwrap();
        assert_eq!((own.name.as_str(), own.unit.unwrap().meters()), ("without a name", Some(0.5)));
        assert_eq!(system(&[[1025, 0, 1, 1]]), None);
    }

    #[test]
    fn places_outside_the_records_are_ignored() {
        let far = system(&[[1024, 0, 1, 1], [1026, TEXTS, 99, 900], [3077, NUMBERS, 1, 9]]).unwrap();
        assert_eq!((far.name.as_str(), far.unit), ("without a name", None));
        assert_eq!(GeoKeys { keys: &[1, 2, 3], numbers: None, texts: None }.system(), None);
    }
}
