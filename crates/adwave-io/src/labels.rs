//! Recognition of fields whose numbers are labels: classes, segments, parcels. Their mean is no label.

/// Words that name labels, in lower case: LAS classes and returns, segmentations, parcellations, materials.
const WORDS: [&str; 27] = [
    "annot",
    "annotation",
    "aparc",
    "category",
    "class",
    "classes",
    "classification",
    "cluster",
    "clusters",
    "component",
    "dlabel",
    "id",
    "ids",
    "instance",
    "label",
    "labels",
    "lulc",
    "material",
    "object",
    "parcel",
    "parcellation",
    "returns",
    "roi",
    "segment",
    "segmentation",
    "segments",
    "species",
];

/// Names of labels that consist of several words.
const NAMES: [&str; 4] = ["return_number", "number_of_returns", "point_source_id", "scanner_channel"];

/// Largest number of different labels: atlases have some hundreds, segmentations of scans some thousands.
const MOST: usize = 65_536;

/// Different labels of a field that has labels, in ascending order; `None` if it has numbers.
///
/// A field has labels if its name says so (`classification`, `return_number`, a name with the word `label`, `class`,
/// `segment`, `id` … such as `part_id` or `lh.aparc.annot`), it has one channel, and all of its values but NaN are
/// integers, of which at most 65 536 differ. The type of the numbers does not decide: text tables have none.
///
/// ```
/// use adwave_io::labels_of_field;
/// assert_eq!(labels_of_field("classification", 1, &[2.0, 6.0, 2.0]), Some(vec![2.0, 6.0]));
/// assert_eq!(labels_of_field("scan.csv:partLabel", 1, &[1.0, f64::NAN]), Some(vec![1.0]));
/// assert_eq!(labels_of_field("intensity", 1, &[2.0, 6.0]), None);
/// assert_eq!(labels_of_field("label", 1, &[0.25]), None);
/// ```
pub fn labels_of_field(name: &str, n_channels: usize, values: &[f64]) -> Option<Vec<f64>> {
    let is_integer = |v: &f64| v.is_nan() || (v.is_finite() && v.fract() == 0.0);
    if n_channels != 1 || !is_name_of_labels(name) || !values.iter().all(is_integer) {
        return None;
    }
    distinct_labels(values).filter(|labels| !labels.is_empty())
}

/// Different values of a field but NaN, in ascending order; `None` if there are more than 65 536.
pub fn distinct_labels(values: &[f64]) -> Option<Vec<f64>> {
    let mut found = std::collections::BTreeMap::new();
    for v in values.iter().filter(|v| !v.is_nan()) {
        let v = v + 0.0; // −0 is 0
        // The order of the bits of a number is its own order, once the sign is turned.
        let bits = v.to_bits();
        let key = if v < 0.0 { !bits } else { bits | 1 << 63 };
        found.insert(key, v);
        if found.len() > MOST {
            return None;
        }
    }
    Some(found.into_values().collect())
}

fn is_name_of_labels(name: &str) -> bool {
    let last = name.rsplit(['/', '\\', ':']).next().unwrap_or(name);
    let mut words = vec![String::new()];
    let mut was_lower = false;
    for c in last.chars() {
        let starts = !c.is_alphanumeric() || c.is_uppercase() && was_lower;
        if starts {
            words.push(String::new());
        }
        if let (Some(word), true) = (words.last_mut(), c.is_alphanumeric()) {
            word.extend(c.to_lowercase());
        }
        was_lower = c.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words.iter().any(|word| WORDS.contains(&word.as_str())) || NAMES.contains(&words.join("_").as_str())
}
