//! Value parsers that several commands share.

use adwave::denoise::SharedNoise;
use adwave::region::{Length, Region, RegionSyntaxError, parse_region};
use adwave::{NamedEntry, NamedValue};
use adwave_io::{LengthUnit, ValueType};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::num::NonZeroUsize;

/// Parser of a value that the library names.
pub(crate) fn parse_named<T: NamedValue + Send + Sync>() -> impl TypedValueParser<Value = T> {
    parse_named_among(T::ENTRIES)
}

fn parse_named_among<T: NamedValue + Send + Sync>(
    entries: &'static [NamedEntry<T>],
) -> impl TypedValueParser<Value = T> {
    let value = |entry: &NamedEntry<T>| {
        let value = PossibleValue::new(entry.name);
        let value = if entry.summary.is_empty() { value } else { value.help(entry.summary) };
        match entry.alias {
            Some(alias) => value.alias(alias),
            None => value,
        }
    };
    PossibleValuesParser::new(entries.iter().map(value)).try_map(|name| T::from_name(&name))
}

/// Reads a whole number of at least 1.
pub(crate) fn count_from_one(text: &str) -> Result<NonZeroUsize, String> {
    let found = text.trim().parse::<usize>().ok().and_then(NonZeroUsize::new);
    found.ok_or_else(|| "must be a whole number of at least 1".to_owned())
}

/// Reads a whole number of at least 0.
pub(crate) fn count(text: &str) -> Result<usize, String> {
    text.trim().parse().map_err(|_| "must be a whole number of at least 0".to_owned())
}

/// Reads a whole number of at least 0 that may be large, such as a seed.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| "must be a whole number of at least 0".to_owned())
}

/// Reads a number.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "must be a number".to_owned())
}

/// Reads the name of a type of numbers.
pub(crate) fn value_type(text: &str) -> Result<ValueType, String> {
    let found = ValueType::ALL.into_iter().find(|kind| kind.name() == text.trim());
    found.ok_or_else(|| format!("must be one of {}", ValueType::ALL.map(ValueType::name).join(", ")))
}

/// Reads a treatment of noise that neighbors share.
pub(crate) fn shared_noise(text: &str) -> Result<SharedNoise, String> {
    let text = text.trim();
    SharedNoise::from_word(text)
        .or_else(|| text.parse().ok().map(SharedNoise::Deviation))
        .ok_or_else(|| "must be detail, auto or a number".to_owned())
}

/// Reads a length of any sign and size; levels and errors are checked when all is known.
pub(crate) fn length(text: &str) -> Result<Length, String> {
    if let Ok(units) = text.trim().parse() {
        return Ok(Length::Units(units));
    }
    text.parse().map_err(|error: RegionSyntaxError| {
        let (number, unit) = text.trim().split_at(text.trim().trim_end_matches(char::is_alphabetic).len());
        match (number.trim().parse::<f64>(), LengthUnit::from_name(unit)) {
            (Ok(number), Some(unit)) => format!(
                "a length has the unit of the file, which `adwave info` states; write {number} for a file in {}",
                unit.plural()
            ),
            _ => error.to_string(),
        }
    })
}

/// Reads the width of a level: a length, or an arc of a sphere such as `5deg` or `100km/6371`.
pub(crate) fn width(text: &str) -> Result<Length, String> {
    match Length::parse_width(text) {
        Ok(arc @ Length::Degrees(_)) => Ok(arc),
        _ => length(text).map_err(|error| match text.trim().strip_suffix("km") {
            Some(_) => format!(
                "{error}, or {}/6371 on a sphere of that radius in km, such as the earth",
                text.trim()
            ),
            None => error,
        }),
    }
}

/// Reads a region.
pub(crate) fn region(text: &str) -> Result<Region, RegionSyntaxError> {
    parse_region(text)
}

/// Reads a number of bytes: `4000000`, `500M`, `1.5G`, with or without `iB` or `B` after the letter, which counts by
/// 1024.
pub(crate) fn size(text: &str) -> Result<u64, String> {
    let plain = text.trim().trim_end_matches(['b', 'B']).trim_end_matches(['i', 'I']);
    let (digits, factor) = match plain.as_bytes().last().map(u8::to_ascii_uppercase) {
        Some(b'K') => (&plain[..plain.len() - 1], 1_u64 << 10),
        Some(b'M') => (&plain[..plain.len() - 1], 1 << 20),
        Some(b'G') => (&plain[..plain.len() - 1], 1 << 30),
        Some(b'T') => (&plain[..plain.len() - 1], 1 << 40),
        _ => (plain, 1),
    };
    match digits.trim().parse::<f64>() {
        Ok(n) if n > 0.0 && n.is_finite() => Ok((n * factor as f64) as u64),
        _ => Err("must be a size such as 500M or 8G".into()),
    }
}
