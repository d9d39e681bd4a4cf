//! Headers of FITS: cards of 80 letters in blocks of 2880 bytes, and the size of the data behind them.

use crate::ReadError;
use crate::model::units::show;

/// Bytes of a block, of which headers and data fill whole numbers.
pub(super) const BLOCK: usize = 2880;

/// Bytes of a card.
pub(super) const CARD: usize = 80;

/// Largest number of columns of a table, by the standard.
pub(super) const MAX_COLUMNS: u64 = 999;

/// A header with its data: one unit of a FITS.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    /// Byte at which the header begins.
    pub(super) start: usize,
    /// Keywords and values in the order of the cards, without comments; strings in their quotes.
    cards: Vec<(String, String)>,
    /// Byte at which the data begin.
    pub(super) data: usize,
    /// Number of bytes of the data, without their padding.
    pub(super) n_bytes: usize,
    /// Byte after the padding of the data, at most the length of the file.
    pub(super) end: usize,
}

/// Keyword and value of a card; `None` if it has no value.
fn parse_card(card: &[u8]) -> Option<(String, String)> {
    let text = String::from_utf8_lossy(card);
    let (keyword, rest) = text.split_at_checked(8)?;
    let rest = rest.strip_prefix("= ")?.trim_start();
    let value = if rest.starts_with('\'') {
        // A quote within a string is written twice.
        let mut end = 1;
        loop {
            end += rest[end..].find('\'')? + 1;
            if !rest[end..].starts_with('\'') {
                break;
            }
            end += 1;
        }
        &rest[..end]
    } else {
        rest.split('/').next()?.trim()
    };
    Some((keyword.trim().to_owned(), value.to_owned()))
}

impl Unit {
    /// Reads the header that begins at a byte.
    pub(super) fn read(bytes: &[u8], start: usize) -> Result<Self, ReadError> {
        let mut cards = Vec::new();
        let mut at = start;
        loop {
            let Some(card) = bytes.get(at..at + CARD) else {
                return Err(ReadError::byte_error(
                    at,
                    "the header of the FITS has no END; get the whole file",
                ));
            };
            at += CARD;
            if card.starts_with(b"END") && card[3..].trim_ascii().is_empty() {
                break;
            }
            cards.extend(parse_card(card));
        }
        let data = start + (at - start).next_multiple_of(BLOCK);
        let mut unit = Self { start, cards, data, n_bytes: 0, end: data };
        let n_bytes = unit.data_size()?;
        let needed = (data as u64).saturating_add(n_bytes);
        if needed > bytes.len() as u64 && n_bytes > 0 {
            let row = unit.integer("NAXIS1")?.filter(|row| *row > 0).unwrap_or(1) as u64;
            return Err(ReadError::Truncated {
                end: bytes.len() as u64,
                needed,
                element: "data".into(),
                row: (bytes.len() as u64).saturating_sub(data as u64) / row,
            });
        }
        unit.n_bytes = n_bytes as usize;
        unit.end = (data + unit.n_bytes.next_multiple_of(BLOCK)).min(bytes.len());
        Ok(unit)
    }

    /// Number of bytes of the data by the header.
    fn data_size(&self) -> Result<u64, ReadError> {
        let count = |key: &str, usual: i64| -> Result<u64, ReadError> {
            let found = self.integer(key)?.unwrap_or(usual);
            u64::try_from(found).map_err(|_| self.wrong(key, "a whole number of at least 0"))
        };
        let n_axes = count("NAXIS", 0)?;
        if n_axes > 999 {
            return Err(self.wrong("NAXIS", "a whole number of at most 999"));
        }
        if n_axes == 0 {
            return Ok(0);
        }
        let bits = self.integer("BITPIX")?.unwrap_or(8);
        if ![8, 16, 32, 64, -32, -64].contains(&bits) {
            return Err(self.wrong("BITPIX", "8, 16, 32, 64, -32 or -64"));
        }
        let mut size = 1_u64;
        for axis in 1..=n_axes {
            size = size.saturating_mul(count(&format!("NAXIS{axis}"), 0)?);
        }
        let size = size.saturating_add(count("PCOUNT", 0)?).saturating_mul(count("GCOUNT", 1)?);
        Ok(size.saturating_mul(bits.unsigned_abs() / 8))
    }

    /// Value of a card as it is written.
    fn raw(&self, key: &str) -> Option<&str> {
        self.cards.iter().find(|(own, _)| own == key).map(|(_, value)| value.as_str())
    }

    /// Text of a card without its quotes and the blanks at its end.
    pub(super) fn text(&self, key: &str) -> Option<String> {
        let raw = self.raw(key)?;
        let inner = raw.strip_prefix('\'').and_then(|raw| raw.strip_suffix('\'')).unwrap_or(raw);
        Some(show(&inner.replace("''", "'")))
    }

    /// Whole number of a card.
    pub(super) fn integer(&self, key: &str) -> Result<Option<i64>, ReadError> {
        let Some(raw) = self.raw(key) else { return Ok(None) };
        raw.parse().map(Some).map_err(|_| self.wrong(key, "a whole number"))
    }

    /// Number of a card.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, ReadError> {
        let Some(raw) = self.raw(key) else { return Ok(None) };
        let found = raw.replace(['D', 'd'], "E").parse::<f64>().ok().filter(|number| number.is_finite());
        found.map(Some).ok_or_else(|| self.wrong(key, "a number"))
    }

    /// Error of a card whose value is not what it must be.
    pub(super) fn wrong(&self, key: &str, expected: &str) -> ReadError {
        let found = self.raw(key).map_or_else(|| "nothing".to_owned(), show);
        ReadError::byte_error(
            self.start,
            format!("{key} must be {expected}, got {found}; correct the header"),
        )
    }
}

/// A card with a keyword, a value and a comment.
pub(super) fn card(keyword: &str, value: &str, comment: &str) -> Vec<u8> {
    let value = if value.starts_with('\'') { format!("{value:<20}") } else { format!("{value:>20}") };
    let mut card = format!("{keyword:<8}= {value}");
    if !comment.is_empty() {
        card += " / ";
        card += comment;
    }
    let mut bytes: Vec<u8> =
        card.into_bytes().into_iter().map(|b| if b.is_ascii() { b } else { b'?' }).collect();
    bytes.resize(CARD, b' ');
    bytes
}

/// A string in quotes as the value of a card, of at most 68 letters.
pub(super) fn quoted(text: &str) -> String {
    let mut inner = String::new();
    for c in text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '_' }) {
        let letter = if c == '\'' { "''".to_owned() } else { c.to_string() };
        if inner.len() + letter.len() <= 68 {
            inner += &letter;
        }
    }
    format!("'{inner:<8}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Option<(String, String)> {
        let mut card = text.as_bytes().to_vec();
        card.resize(CARD, b' ');
        parse_card(&card)
    }

    #[test]
    fn cards_lead_back_to_their_values() {
        for text in ["K", "it's", "", "a / b", "''", "Kelvin_CMB"] {
            let bytes = card("TUNIT1", &quoted(text), "unit");
            assert_eq!(bytes.len(), CARD);
            let (keyword, value) = parse_card(&bytes).unwrap();
            let unit = Unit { start: 0, cards: vec![(keyword, value)], data: 0, n_bytes: 0, end: 0 };
            assert_eq!(unit.text("TUNIT1").unwrap(), text);
        }
        assert_eq!(parse("NSIDE   =                   64 / resolution"), Some(("NSIDE".into(), "64".into())));
        assert_eq!(parse("COMMENT = none"), Some(("COMMENT".into(), "none".into())));
        assert_eq!(parse("HISTORY made by hand"), None);
        assert_eq!(parse("OPEN    = 'never closed"), None);
    }
}
