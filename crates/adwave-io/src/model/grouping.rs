//! Conversion between the columns of a file and fields: `nx ny nz` is the field `normal` with three channels.

use std::collections::{HashMap, HashSet, VecDeque};

use adwave::{Cancelled, Progress};

use crate::{Field, FieldValues};

/// Columns that form one field with a known name.
const KNOWN: &[(&str, &[&str])] = &[
    ("normal", &["nx", "ny", "nz"]),
    ("normal", &["normal_x", "normal_y", "normal_z"]),
    ("color", &["red", "green", "blue", "alpha"]),
    ("color", &["red", "green", "blue"]),
    ("color", &["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"]),
    ("color", &["diffuse_red", "diffuse_green", "diffuse_blue"]),
    ("color", &["r", "g", "b", "a"]),
    ("color", &["r", "g", "b"]),
    ("texcoord", &["s", "t"]),
    ("texcoord", &["u", "v"]),
    ("texcoord", &["texture_u", "texture_v"]),
];

/// Name of a field and the positions of its columns.
pub(crate) type FieldColumns = (String, Vec<usize>);

/// Groups columns with one number per vertex to fields; each field lists its columns. O(columns) for any names.
pub(crate) fn group(
    columns: Vec<(String, FieldValues)>,
    progress: Progress<'_>,
) -> Result<(Vec<Field>, Vec<FieldColumns>), Cancelled> {
    let mut fields: Vec<Field> = Vec::new();
    let mut members = Vec::new();
    let mut free = FreeColumns::new(&columns);
    let mut names = UsedNames::default();
    let mut columns: Vec<_> = columns.into_iter().map(|(name, values)| (name, Some(values))).collect();
    for i in 0..columns.len() {
        if free.is_used[i] {
            continue;
        }
        let (name, positions) = find_known_field(&columns, &mut free, i)
            .or_else(|| numbered(&columns, &mut free, i))
            .unwrap_or_else(|| (columns[i].0.clone(), vec![i]));
        for &p in &positions {
            free.is_used[p] = true;
        }
        let lists: Vec<FieldValues> = positions.iter().filter_map(|&p| columns[p].1.take()).collect();
        let values = match <[FieldValues; 1]>::try_from(lists) {
            Ok([single]) => Some(single),
            Err(lists) => FieldValues::interleave(&lists.iter().collect::<Vec<_>>(), progress)?,
        };
        let Some(values) = values else { continue };
        let name = names.unique(name);
        members.push((name.clone(), positions.clone()));
        fields.push(Field::new(name, positions.len(), values));
    }
    Ok((fields, members))
}

/// Names of the columns that form a field by themselves.
pub(crate) fn single_columns(names: &[&str]) -> Vec<String> {
    let columns = names.iter().map(|name| ((*name).to_owned(), FieldValues::U8(vec![0]))).collect();
    let Ok((fields, _)) = group(columns, Progress::none()) else { return Vec::new() };
    fields.into_iter().filter(|field| field.n_channels == 1).map(|field| field.name).collect()
}

type Columns = [(String, Option<FieldValues>)];

/// Columns by name, and the columns that belong to no field yet.
struct FreeColumns {
    is_used: Vec<bool>,
    exact: HashSet<String>,
    /// Positions by lower-case name, the first candidate in front.
    places: HashMap<String, VecDeque<usize>>,
}

impl FreeColumns {
    fn new(columns: &[(String, FieldValues)]) -> Self {
        let mut places: HashMap<String, VecDeque<usize>> = HashMap::new();
        for (p, (name, _)) in columns.iter().enumerate() {
            places.entry(name.to_ascii_lowercase()).or_default().push_back(p);
        }
        let exact = columns.iter().map(|(name, _)| name.clone()).collect();
        Self { is_used: vec![false; columns.len()], exact, places }
    }

    /// First free column of that name, ignoring case.
    fn first(&mut self, name: &str) -> Option<usize> {
        let places = self.places.get_mut(&name.to_ascii_lowercase())?;
        while places.front().is_some_and(|&p| self.is_used[p]) {
            places.pop_front();
        }
        places.front().copied()
    }
}

/// Positions of the columns with these names, if all are free and have the type of the first.
fn find(columns: &Columns, free: &mut FreeColumns, names: &[String]) -> Option<Vec<usize>> {
    let positions: Vec<usize> = names.iter().map(|name| free.first(name)).collect::<Option<_>>()?;
    let value_type = |p: &usize| columns[*p].1.as_ref().map(FieldValues::value_type);
    positions.iter().all(|p| value_type(p) == value_type(&positions[0])).then_some(positions)
}

fn find_known_field(columns: &Columns, free: &mut FreeColumns, i: usize) -> Option<FieldColumns> {
    KNOWN.iter().filter(|(_, names)| names[0].eq_ignore_ascii_case(&columns[i].0)).find_map(
        |(field, names)| {
            let names: Vec<String> = names.iter().map(ToString::to_string).collect();
            Some(((*field).to_string(), find(columns, free, &names)?))
        },
    )
}

/// Finds `flow_x flow_y flow_z`, or `flow_0 flow_1 …`.
fn numbered(columns: &Columns, free: &mut FreeColumns, i: usize) -> Option<FieldColumns> {
    let name = &columns[i].0;
    if let Some(base) = name.strip_suffix("_x").filter(|base| !base.is_empty()) {
        return Some((base.into(), find(columns, free, &["x", "y", "z"].map(|c| format!("{base}_{c}")))?));
    }
    let base = name.strip_suffix("_0").filter(|base| !base.is_empty())?;
    let mut names = vec![name.clone()];
    loop {
        let next = format!("{base}_{}", names.len());
        if !free.exact.contains(&next) {
            break;
        }
        // A column of another field ends the search before the rest is examined.
        free.first(&next)?;
        names.push(next);
    }
    (names.len() > 1).then(|| find(columns, free, &names).map(|positions| (base.to_string(), positions)))?
}

/// Names in use, and the last number tried for each.
#[derive(Default)]
struct UsedNames {
    taken: HashSet<String>,
    last: HashMap<String, usize>,
}

impl UsedNames {
    /// Returns the name, or with the first free number appended if it is in use.
    fn unique(&mut self, name: String) -> String {
        if self.taken.insert(name.clone()) {
            return name;
        }
        let last = self.last.entry(name.clone()).or_insert(1);
        loop {
            *last += 1;
            let numbered = format!("{name}_{last}");
            if self.taken.insert(numbered.clone()) {
                return numbered;
            }
        }
    }
}

/// Returns the name, with a number appended if a field already has it.
pub(crate) fn unique(fields: &[Field], name: String) -> String {
    let taken = |name: &str| fields.iter().any(|f| f.name == name);
    if !taken(&name) {
        return name;
    }
    (2..=fields.len() + 2).map(|n| format!("{name}_{n}")).find(|name| !taken(name)).unwrap_or(name)
}

/// Column names for a field, one per channel; the inverse of [`group`].
pub(crate) fn column_names(field: &Field) -> Vec<String> {
    let own = |names: &[&str]| names.iter().map(ToString::to_string).collect();
    match (field.name.as_str(), field.n_channels) {
        ("normal", 3) => own(&["nx", "ny", "nz"]),
        ("color", 3) => own(&["red", "green", "blue"]),
        ("color", 4) => own(&["red", "green", "blue", "alpha"]),
        ("texcoord", 2) => own(&["s", "t"]),
        (name, 1) => vec![one_word(name)],
        (name, 3) => ["x", "y", "z"].iter().map(|c| format!("{}_{c}", one_word(name))).collect(),
        (name, n) => (0..n).map(|c| format!("{}_{c}", one_word(name))).collect(),
    }
}

/// Replaces blanks and separators, which end column names, by `_`.
pub(crate) fn one_word(name: &str) -> String {
    let bad = |c: char| c.is_whitespace() || c.is_control() || matches!(c, ',' | ';' | '"' | '#');
    let word: String = name.chars().map(|c| if bad(c) { '_' } else { c }).collect();
    if word.is_empty() { "_".into() } else { word }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_columns_lead_back_to_the_field() {
        for (name, n) in [("normal", 3), ("color", 3), ("color", 4), ("texcoord", 2), ("flow", 3), ("hks", 5)]
        {
            let field = Field::new(name, n, FieldValues::F32((0..2 * n).map(|i| i as f32).collect()));
            let columns = column_names(&field)
                .into_iter()
                .enumerate()
                .map(|(c, name)| (name, FieldValues::F32(vec![c as f32, (n + c) as f32])))
                .collect();
            let (fields, members) = group(columns, Progress::none()).unwrap();
            assert_eq!(fields, [field]);
            assert_eq!(members[0].1, (0..n).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_name_that_comes_twice_is_kept_twice() {
        let column = |x| ("q".to_string(), FieldValues::U8(vec![x]));
        let (fields, _) = group(vec![column(1), column(2)], Progress::none()).unwrap();
        assert_eq!((fields[0].name.as_str(), fields[1].name.as_str()), ("q", "q_2"));
    }

    #[test]
    fn a_hundred_thousand_columns_are_grouped_at_once() {
        const MANY: usize = 100_000;
        let named = |name: &dyn Fn(usize) -> String| {
            let columns = (0..MANY).map(|c| (name(c), FieldValues::U8(vec![c as u8]))).collect();
            let start = std::time::Instant::now();
            let (fields, _) = group(columns, Progress::none()).unwrap();
            assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
            fields.len()
        };
        // Names that could all be compared with each other.
        assert_eq!(named(&|c| format!("c{c}")), MANY);
        assert_eq!(named(&|_| "q".into()), MANY);
        assert_eq!(named(&|_| "nx".into()), MANY);
        assert_eq!(named(&|c| if c % 2 == 0 { "a_0".into() } else { format!("a_{}", c / 2 + 1) }), MANY / 2);
        assert_eq!(named(&|c| format!("a_{c}")), 1);
    }
}
