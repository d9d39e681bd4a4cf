//! Names and colors of labels, such as the parcels of an atlas.

use std::collections::HashMap;
use std::sync::Arc;

/// Number of vertices without a label where a file needs one.
const NO_LABEL: i32 = -1;

/// Label with its name and color.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelEntry {
    /// Number of the label in the values.
    pub key: i32,
    /// Name, such as that of a region.
    pub name: String,
    /// Red, green, blue and opacity, 0 to 1.
    pub color: [f32; 4],
}

/// Names and colors of the labels of a field, in the order of the file. Keys differ.
///
/// ```
/// use adwave_io::{LabelEntry, LabelTable};
/// let entry = LabelEntry { key: 7, name: "V1".into(), color: [1.0, 0.0, 0.0, 1.0] };
/// let table = LabelTable::new(vec![entry]);
/// assert_eq!(table.entry(7).unwrap().name, "V1");
/// assert!(table.entry(8).is_none());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LabelTable {
    entries: Vec<LabelEntry>,
    /// Index of the entry of each key.
    index: HashMap<i32, usize>,
}

impl LabelTable {
    /// Table of these entries; of several with one key the last counts.
    pub fn new(entries: Vec<LabelEntry>) -> Self {
        let mut table = Self::default();
        for entry in entries {
            match table.index.get(&entry.key) {
                Some(&i) => table.entries[i] = entry,
                None => table.push(entry),
            }
        }
        table
    }

    /// Adds an entry with a new key.
    fn push(&mut self, entry: LabelEntry) {
        self.index.insert(entry.key, self.entries.len());
        self.entries.push(entry);
    }

    /// All entries.
    pub fn entries(&self) -> &[LabelEntry] {
        &self.entries
    }

    /// Entry of a label.
    pub fn entry(&self, key: i32) -> Option<&LabelEntry> {
        self.index.get(&key).map(|&i| &self.entries[i])
    }

    /// Table of all labels of several tables.
    ///
    /// # Errors
    /// Words about two tables that give one number different names or colors.
    pub(crate) fn join<'a>(tables: impl Iterator<Item = &'a Arc<Self>>) -> Result<Self, String> {
        let mut joined = Self::default();
        for entry in tables.flat_map(|table| &table.entries) {
            match joined.entry(entry.key) {
                None => joined.push(entry.clone()),
                Some(other) if other == entry => {}
                Some(other) => {
                    return Err(format!(
                        "label {} with two names or colors, `{}` and `{}`",
                        entry.key, other.name, entry.name
                    ));
                }
            }
        }
        Ok(joined)
    }

    /// Table that has the labels of these values too: [`label_key`] of NaN and −1 is named `???`.
    ///
    /// # Errors
    /// Words about a label that has no name.
    pub(crate) fn with_labels(mut self, values: impl Iterator<Item = f64>) -> Result<Self, String> {
        for value in values {
            let key = label_key(value).ok_or_else(|| format!("{value}, which is no label"))?;
            if self.entry(key).is_some() {
                continue;
            }
            if key != NO_LABEL {
                return Err(format!("label {key}, which has no name in the table of labels"));
            }
            self.push(LabelEntry { key, name: "???".into(), color: [0.0; 4] });
        }
        Ok(self)
    }
}

/// Number of a label among the values of a field: −1 for NaN; `None` for other values than integers of 32 bits.
pub(crate) fn label_key(value: f64) -> Option<i32> {
    if value.is_nan() {
        return Some(NO_LABEL);
    }
    let key = value as i32;
    (f64::from(key) == value).then_some(key)
}

#[cfg(feature = "neuro")]
impl LabelTable {
    /// Reads the element `LabelTable` of a GIFTI or a CIFTI; `None` if it has no label.
    pub(crate) fn from_xml(table: roxmltree::Node<'_, '_>) -> Option<Arc<Self>> {
        let labels = table.children().filter(|node| node.has_tag_name("Label"));
        let entry = |label: roxmltree::Node<'_, '_>| {
            // The first version of GIFTI has an index.
            let key = label.attribute("Key").or_else(|| label.attribute("Index"))?.trim().parse().ok()?;
            let color = ["Red", "Green", "Blue", "Alpha"].map(|name| {
                let usual = if name == "Alpha" { 1.0 } else { 0.0 };
                let number = label.attribute(name).and_then(|number| number.trim().parse::<f32>().ok());
                number.filter(|part| part.is_finite()).map_or(usual, |part| part.clamp(0.0, 1.0))
            });
            Some(LabelEntry { key, name: label.text().unwrap_or_default().trim().to_owned(), color })
        };
        let table = Self::new(labels.filter_map(entry).collect());
        (!table.entries.is_empty()).then(|| Arc::new(table))
    }

    /// The element `LabelTable` of a GIFTI or a CIFTI.
    pub(crate) fn to_xml(&self) -> String {
        let mut xml = String::from("<LabelTable>\n");
        for LabelEntry { key, name, color: [red, green, blue, alpha] } in &self.entries {
            xml += &format!(
                "<Label Key=\"{key}\" Red=\"{red}\" Green=\"{green}\" Blue=\"{blue}\" Alpha=\"{alpha}\">{}</Label>\n",
                crate::text::escape_xml(name)
            );
        }
        xml + "</LabelTable>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(key: i32, name: &str) -> LabelEntry {
        LabelEntry { key, name: name.into(), color: [0.5, 0.25, 0.0, 1.0] }
    }

    #[test]
    fn tables_are_joined_unless_a_number_has_two_names() {
        let [left, right, other] =
            [[entry(1, "a"), entry(2, "b")], [entry(2, "b"), entry(3, "c")], [entry(2, "x"), entry(4, "d")]]
                .map(|entries| Arc::new(LabelTable::new(entries.to_vec())));
        let joined = LabelTable::join([&left, &right].into_iter()).unwrap();
        assert_eq!(joined.entries().iter().map(|entry| entry.key).collect::<Vec<_>>(), [1, 2, 3]);
        let error = LabelTable::join([&left, &other].into_iter()).unwrap_err();
        assert_eq!(error, "label 2 with two names or colors, `b` and `x`");
    }

    #[test]
    fn large_tables_are_read_at_once_and_the_last_entry_of_a_key_counts() {
        let n = 300_000;
        let entries = (0..n).chain(0..n).map(|i| entry(i % n, if i < 5 { "first" } else { "other" }));
        let mut entries: Vec<LabelEntry> = entries.collect();
        entries.push(entry(7, "last"));
        let table = LabelTable::new(entries);
        assert_eq!((table.entries().len(), table.entry(7).unwrap().name.as_str()), (n as usize, "last"));
    }

    #[test]
    fn labels_without_a_name_are_refused_but_for_those_of_no_label() {
        let table = LabelTable::new(vec![entry(1, "a")]);
        let more = table.clone().with_labels([1.0, f64::NAN, -1.0].into_iter()).unwrap();
        assert_eq!(more.entry(-1).unwrap().name, "???");
        assert!(table.clone().with_labels([5.0].into_iter()).unwrap_err().contains("label 5"));
        assert!(table.with_labels([0.5].into_iter()).unwrap_err().contains("0.5"));
    }
}
