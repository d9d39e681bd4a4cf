//! Extra bytes: attributes after the standard ones of a LAS record, and their descriptions.

use adwave::Progress;

use crate::model::grouping::{column_names, group};
use crate::{Field, FieldValues, ValueType};

/// Size of the description of one attribute in bytes.
pub(crate) const DESCRIPTION: usize = 192;
/// Size of an attribute's name in bytes.
const NAME: usize = 32;
/// Types by their number in a description, from 1 on.
const TYPES: [ValueType; 10] = [
    ValueType::U8,
    ValueType::I8,
    ValueType::U16,
    ValueType::I16,
    ValueType::U32,
    ValueType::I32,
    ValueType::U64,
    ValueType::I64,
    ValueType::F32,
    ValueType::F64,
];

/// Attribute after the standard ones.
pub(crate) struct ExtraBytes {
    pub(crate) name: String,
    pub(crate) value_type: ValueType,
    pub(crate) n_channels: usize,
    /// Scale and offset of the numbers.
    pub(crate) scale: Option<(f64, f64)>,
    /// Byte offset in the record.
    pub(crate) at: usize,
}

impl ExtraBytes {
    /// Parses the descriptions of the bytes from `at` on; stops at a description of unknown size.
    pub(crate) fn parse(content: &[u8], mut at: usize) -> Vec<Self> {
        let mut all = Vec::new();
        for entry in content.chunks_exact(DESCRIPTION) {
            let code = usize::from(entry[2]);
            // Type 0 means `options` bytes without a meaning; 11 to 30 are pairs and triples of the first ten.
            let (value_type, n_channels) = match code {
                0 => (ValueType::U8, usize::from(entry[3]).max(1)),
                1..=30 => (TYPES[(code - 1) % 10], 1 + (code - 1) / 10),
                _ => break,
            };
            let text = entry[4..4 + NAME].split(|&b| b == 0).next().unwrap_or(b"");
            let number = |at: usize| {
                let mut own = [0; 8];
                own.copy_from_slice(&entry[at..at + 8]);
                f64::from_le_bytes(own)
            };
            let (has_scale, has_offset) = (entry[3] & 8 != 0, entry[3] & 16 != 0);
            let scale = (code > 0 && (has_scale || has_offset)).then(|| {
                (if has_scale { number(112) } else { 1.0 }, if has_offset { number(136) } else { 0.0 })
            });
            let name = String::from_utf8_lossy(text).into_owned();
            let own = Self { name, value_type, n_channels, scale, at };
            at += own.n_bytes();
            all.push(own);
        }
        all
    }

    /// Number of bytes in a record.
    pub(crate) fn n_bytes(&self) -> usize {
        self.value_type.n_bytes() * self.n_channels
    }

    /// Type in which the values are read.
    fn read_type(&self) -> ValueType {
        if self.scale.is_some() { ValueType::F64 } else { self.value_type }
    }
}

/// Creates the description of a new attribute with one number.
pub(crate) fn description(name: &str, value_type: ValueType) -> [u8; DESCRIPTION] {
    let mut entry = [0; DESCRIPTION];
    entry[2] = 1 + TYPES.iter().position(|&own| own == value_type).unwrap_or(9) as u8;
    entry[4..4 + name.len()].copy_from_slice(name.as_bytes());
    entry
}

/// Creates descriptions for undescribed bytes, so that later descriptions refer to the correct bytes.
pub(crate) fn undescribed(mut n_bytes: usize) -> Vec<u8> {
    let mut entries = Vec::new();
    while n_bytes > 0 {
        let n = n_bytes.min(255);
        let mut entry = [0; DESCRIPTION];
        entry[3] = n as u8;
        entry[4..15].copy_from_slice(b"undescribed");
        entries.extend(entry);
        n_bytes -= n;
    }
    entries
}

/// Fields by name with the attributes that form each, as in reading.
pub(crate) fn fields_of(extra: &[ExtraBytes]) -> Vec<(String, Vec<usize>)> {
    let alone = |e: &usize| extra[*e].n_channels == 1;
    let (columns, arrays): (Vec<usize>, Vec<usize>) = (0..extra.len()).partition(alone);
    let mut all: Vec<_> = arrays.into_iter().map(|e| (extra[e].name.clone(), vec![e])).collect();
    let empty = columns.iter().map(|&e| (extra[e].name.clone(), extra[e].read_type().empty())).collect();
    let grouped = group(empty, Progress::none()).map(|(_, members)| members).unwrap_or_default();
    all.extend(grouped.into_iter().map(|(name, own)| (name, own.into_iter().map(|k| columns[k]).collect())));
    all
}

/// Names for a field with `n_channels` channels and for its columns: short enough and different from `others`.
pub(crate) fn names(name: &str, n_channels: usize, others: &[String]) -> (String, Vec<String>) {
    let is_free = |name: &String| !others.iter().any(|other| other.eq_ignore_ascii_case(name));
    for number in 1_usize.. {
        let end = if number == 1 { String::new() } else { format!("_{number}") };
        let mut base = format!("{name}{end}");
        let mut columns = columns_of(&base, n_channels);
        let longest = columns.iter().map(String::len).max().unwrap_or(0);
        if longest > NAME {
            let left = name.len().saturating_sub(longest - NAME);
            let cut = (0..=left).rev().find(|&at| name.is_char_boundary(at)).unwrap_or(0);
            base = format!("{}{end}", &name[..cut]);
            columns = columns_of(&base, n_channels);
        }
        if columns.iter().all(is_free) {
            return (base, columns);
        }
    }
    unreachable!("there are more numbers than names")
}

fn columns_of(name: &str, n_channels: usize) -> Vec<String> {
    // Names may contain blanks here.
    if n_channels == 1 && !name.is_empty() {
        return vec![name.replace(|c: char| c.is_control(), "_")];
    }
    column_names(&Field::new(name, n_channels, FieldValues::U8(Vec::new())))
}

/// True if an attribute can store all values of a channel exactly.
pub(crate) fn holds(extra: &ExtraBytes, values: &FieldValues) -> bool {
    extra.scale.is_none() && extra.value_type == values.value_type()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cut_and_told_apart() {
        let own = |name: &str, others: &[&str]| {
            names(name, 1, &others.iter().map(ToString::to_string).collect::<Vec<_>>()).1.remove(0)
        };
        let long = "a_name_of_more_than_the_thirty_two_bytes_that_there_are";
        let first = own(long, &[]);
        assert_eq!(first, long[..NAME]);
        let second = own(long, &[&first]);
        assert!(second.ends_with("_2") && second.len() == NAME, "{second}");
        assert_eq!(own("Intensity", &["intensity"]), "Intensity_2");
        // Not within a character.
        assert_eq!(own(&"é".repeat(20), &[]), "é".repeat(16));
        assert_eq!(own(&format!("a{}", "é".repeat(20)), &[]), format!("a{}", "é".repeat(15)));
        assert_eq!(own("Pulse width", &[]), "Pulse width");
        let (name, columns) = names("color", 3, &["Green".into()]);
        assert_eq!((name.as_str(), columns.join(" ")), ("color_2", "color_2_x color_2_y color_2_z".into()));
    }

    #[test]
    fn descriptions_lead_back() {
        let content =
            [&description("a", ValueType::F32)[..], &undescribed(300), &description("b", ValueType::U64)];
        let extra = ExtraBytes::parse(&content.concat(), 20);
        let found: Vec<_> = extra.iter().map(|e| (e.name.as_str(), e.at, e.n_bytes())).collect();
        assert_eq!(found, [("a", 20, 4), ("undescribed", 24, 255), ("undescribed", 279, 45), ("b", 324, 8)]);
    }
}
