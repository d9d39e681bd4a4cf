//! Meaning of the columns of a row.

use crate::ReadError;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::Evidence;
use crate::text::is_blank;
use crate::text::parse_f64;
use adwave::Progress;

use crate::progress::all;

/// Columns of a table: their names, and those of x, y and z.
#[derive(Debug)]
pub(crate) struct ColumnMeanings {
    /// Name of each column; `x`, `y` and `z` are the coordinates.
    pub(crate) names: Vec<String>,
    pub(crate) axes: [usize; 3],
    /// One line about what was assumed; `None` if the columns are named x, y and z, or are the first ones without
    /// names.
    pub(crate) note: Option<String>,
    /// True if the columns of x and y are named longitude and latitude; the values have the last word.
    pub(crate) are_named_degrees: bool,
}

/// Names of longitudes and latitudes.
const DEGREE_NAMES: [&[&str]; 2] =
    [&["lon", "long", "lng", "longitude", "laenge", "länge"], &["lat", "latitude", "breite"]];

/// Names of the three coordinates that belong together, in the order in which they are looked for.
const AXIS_NAMES: [[&[&str]; 2]; 3] = [
    [
        &["x", "xcoord", "coordx", "xcoordinate", "posx", "xpos", "pointx", "px"],
        &["y", "ycoord", "coordy", "ycoordinate", "posy", "ypos", "pointy", "py"],
    ],
    [
        &["easting", "east", "e", "utmx", "utme", "xutm", "rechtswert", "ost"],
        &["northing", "north", "n", "utmy", "utmn", "yutm", "hochwert", "nord"],
    ],
    DEGREE_NAMES,
];

/// Names of the third coordinate.
const HEIGHT_NAMES: [&str; 16] = [
    "z",
    "zcoord",
    "coordz",
    "zcoordinate",
    "posz",
    "zpos",
    "pointz",
    "pz",
    "elev",
    "elevation",
    "height",
    "alt",
    "altitude",
    "h",
    "hoehe",
    "höhe",
];

/// Names of columns that number the rows.
const INDEX_NAMES: [&str; 16] = [
    "",
    "id",
    "fid",
    "gid",
    "oid",
    "pid",
    "objectid",
    "pointid",
    "index",
    "idx",
    "no",
    "nr",
    "row",
    "rowid",
    "unnamed:0",
    "number",
];

/// Name in the form in which names are compared: lower case, without units in brackets, blanks, `_`, `-` and `.`.
fn comparable(name: &str) -> String {
    let bare = name.split(['[', '(']).next().unwrap_or_default();
    let kept = bare.chars().filter(|c| !c.is_whitespace() && !matches!(c, '_' | '-' | '.' | '/' | '#'));
    kept.flat_map(char::to_lowercase).collect()
}

/// Finds the columns of the coordinates by name; columns of words and of row numbers do not count.
///
/// # Errors
/// One line, if x and y are named and several columns could be z.
fn find_axes(names: &[String], has_words: &[bool]) -> Result<[usize; 3], String> {
    let compared: Vec<String> = names.iter().map(|name| comparable(name)).collect();
    let find = |list: &[&str]| {
        let position = |wanted: &&str| compared.iter().position(|name| name == *wanted);
        list.iter().find_map(position)
    };
    let is_number = |c: &usize| !has_words[*c] && !INDEX_NAMES.contains(&compared[*c].as_str());
    let pair = AXIS_NAMES.iter().find_map(|[x, y]| Some((find(x)?, find(y)?)));
    let Some((x, y)) = pair else {
        let mut free = (0..names.len()).filter(is_number);
        let axes = [free.next(), free.next(), free.next()];
        return match axes {
            [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
            _ => Err("three columns must be coordinates; name them x, y and z".to_owned()),
        };
    };
    if let Some(z) = find(&HEIGHT_NAMES) {
        return Ok([x, y, z]);
    }
    let others: Vec<usize> = (0..names.len()).filter(|c| is_number(c) && *c != x && *c != y).collect();
    match others[..] {
        [z] => Ok([x, y, z]),
        _ => Err(format!(
            "the columns `{}` and `{}` are coordinates, and no column is named z; name the third one z",
            names[x], names[y]
        )),
    }
}

/// Note on the columns of text, which are left out; `None` if there are none.
fn describe_words(names: &[String], words: &[Option<String>]) -> Option<String> {
    let left: Vec<String> = words
        .iter()
        .enumerate()
        .filter_map(|(c, word)| Some(format!("`{}` ({})", names[c], word.as_ref()?)))
        .collect();
    let noun = if left.len() == 1 { "column of text is" } else { "columns of text are" };
    (!left.is_empty()).then(|| format!("the {noun} left out: {}", left.join(", ")))
}

/// Note on the columns that are the coordinates and on those that are left out; `None` if nothing was assumed.
fn describe(names: &[String], axes: [usize; 3], words: &[Option<String>]) -> Option<String> {
    let is_plain = axes.iter().zip(["x", "y", "z"]).all(|(&c, axis)| names[c].eq_ignore_ascii_case(axis));
    let mut parts = Vec::new();
    if !is_plain {
        let [x, y, z] = axes.map(|c| &names[c]);
        parts.push(format!(
            "the columns `{x}`, `{y}` and `{z}` are x, y and z; others would be if they were named so"
        ));
    }
    parts.extend(describe_words(names, words));
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Values of a table, row by row.
#[derive(Clone, Copy)]
pub(crate) struct TableValues<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) n_columns: usize,
    pub(crate) n_rows: usize,
    /// First word in each column of text.
    pub(crate) words: &'a [Option<String>],
}

/// Names the columns. Names in the file are kept and decide which columns are the coordinates. Columns without names
/// are named by their values: unit vectors are normals, and groups of three integers up to 255 are colors.
pub(crate) fn name_columns(
    names: &[String],
    table: &TableValues<'_>,
    progress: Progress<'_>,
) -> Result<ColumnMeanings, ReadError> {
    let TableValues { values, n_columns, n_rows, words } = *table;
    let has_words: Vec<bool> = (0..n_columns).map(|c| words.get(c).is_some_and(Option::is_some)).collect();
    let has_names = names.len() == n_columns;
    let numbered = if has_names { None } else { NumberedRows::find(table) };
    if let Some(numbered) = numbered {
        return Ok(numbered.meanings(n_columns, words));
    }
    if (has_names || has_words.contains(&true)) && n_columns >= 3 {
        let mut named: Vec<String> =
            if has_names { names.to_vec() } else { (1..=n_columns).map(|c| format!("column_{c}")).collect() };
        let axes = find_axes(&named, &has_words).map_err(ReadError::Whole)?;
        let note = describe(&named, axes, words);
        let are_named_degrees =
            (0..2).all(|k| DEGREE_NAMES[k].contains(&comparable(&named[axes[k]]).as_str()));
        if let Some(first) = named.iter_mut().find(|name| name.is_empty()) {
            "index".clone_into(first);
        }
        for (axis, at) in ["x", "y", "z"].into_iter().zip(axes) {
            named[at] = axis.into();
        }
        return Ok(ColumnMeanings { names: named, axes, note, are_named_degrees });
    }
    let mut named: Vec<String> = ["x", "y", "z"].map(String::from).to_vec();
    let at = |row: usize, column: usize| values[row * n_columns + column];
    while named.len() < n_columns {
        let c = named.len();
        let triple = c + 3 <= n_columns && n_rows > 0;
        if triple
            && !named.contains(&"nx".into())
            && all(n_rows, progress, |i| is_unit([0, 1, 2].map(|k| at(i, c + k))))?
        {
            named.extend(["nx", "ny", "nz"].map(String::from));
        } else if triple
            && !named.contains(&"red".into())
            && all(n_rows, progress, |i| (0..3).all(|k| is_color_byte(at(i, c + k))))?
        {
            named.extend(["red", "green", "blue"].map(String::from));
        } else if n_columns == 4 || (n_columns == 7 && c == 3) {
            // Laser scanners write x y z intensity [red green blue].
            named.push("intensity".into());
        } else {
            named.push(format!("column_{}", c + 1));
        }
    }
    named.truncate(n_columns);
    Ok(ColumnMeanings { names: named, axes: [0, 1, 2], note: None, are_named_degrees: false })
}

/// Rows without names that begin with the number of the point, before the coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NumberedRows {
    /// Number, x, y, z.
    Plain,
    /// Number, northing, easting, height and code: the rows of a total station.
    NorthingFirst,
    /// Number, easting, northing, height and code.
    EastingFirst,
}

impl NumberedRows {
    /// Smallest number of rows that distinguish their first column from a coordinate.
    const MIN_ROWS: usize = 3;

    /// Range of eastings in projected systems of meters, in which northings of most places are greater.
    const EASTINGS: std::ops::Range<f64> = 1e5..1e6;

    /// Recognizes numbers of points by values: different integers before coordinates that have fractions. Without codes
    /// in words after the coordinates they must increase too.
    fn find(table: &TableValues<'_>) -> Option<Self> {
        let TableValues { values, n_columns, n_rows, words } = *table;
        let has_words = |c: usize| words.get(c).is_some_and(Option::is_some);
        if n_columns < 4 || n_rows < Self::MIN_ROWS || (1..4).any(has_words) {
            return None;
        }
        let column = |c: usize| values.iter().skip(c).step_by(n_columns).copied();
        let has_fractions = |c: usize| 2 * column(c).filter(|x| x.fract() != 0.0).count() >= n_rows;
        if !has_fractions(1) || !has_fractions(2) {
            return None;
        }
        let has_words_after = n_columns > 4 && has_words(4);
        let has_code = has_words_after
            || (n_columns == 5 && column(4).all(|x| x.is_nan() || (x.fract() == 0.0 && x.abs() < 1e6)));
        if has_words(0) {
            return (has_words_after && n_columns == 5).then(|| Self::order(column(1), column(2)));
        }
        if !column(0).all(|x| x >= 0.0 && x.fract() == 0.0) {
            return None;
        }
        let mut numbers: Vec<f64> = column(0).collect();
        let increases = numbers.is_sorted();
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        if numbers.len() < n_rows || !(increases || has_words_after) {
            return None;
        }
        Some(if has_code { Self::order(column(1), column(2)) } else { Self::Plain })
    }

    /// Order of northing and easting: by their size if that decides it, else the usual one.
    fn order(mut first: impl Iterator<Item = f64>, mut second: impl Iterator<Item = f64>) -> Self {
        let is_easting = first.all(|x| x.is_nan() || Self::EASTINGS.contains(&x));
        let is_northing = second.all(|x| x.is_nan() || x >= Self::EASTINGS.end);
        if is_easting && is_northing { Self::EastingFirst } else { Self::NorthingFirst }
    }

    fn meanings(self, n_columns: usize, words: &[Option<String>]) -> ColumnMeanings {
        let (axes, order) = match self {
            Self::Plain => ([1, 2, 3], "x, y and z"),
            Self::EastingFirst => ([1, 2, 3], "easting (x), northing (y) and height (z)"),
            Self::NorthingFirst => ([2, 1, 3], "northing (y), easting (x) and height (z)"),
        };
        let mut names = vec!["number".to_owned(), String::new(), String::new(), String::new()];
        for (axis, at) in ["x", "y", "z"].into_iter().zip(axes) {
            axis.clone_into(&mut names[at]);
        }
        if self != Self::Plain {
            names.push("code".to_owned());
        }
        names.extend((names.len() + 1..=n_columns).map(|c| format!("column_{c}")));
        names.truncate(n_columns);
        let line = names.join(",");
        let assumed = format!(
            "the first column numbers the points, and the next three are {order}; a first line with the names of the \
             columns, as in {line}, would change this"
        );
        let note = [Some(assumed), describe_words(&names, words)].into_iter().flatten().collect::<Vec<_>>();
        ColumnMeanings { axes, note: Some(note.join("; ")), are_named_degrees: false, names }
    }
}

/// Deviation from a unit vector that a few digits of text allow.
const UNIT_TOLERANCE: f64 = 1e-2;

fn is_unit(v: [f64; 3]) -> bool {
    let squared: f64 = v.iter().map(|x| x * x).sum();
    squared == 0.0 || (squared.sqrt() - 1.0).abs() < UNIT_TOLERANCE
}

/// True if the number is an integer that fits a byte.
pub(crate) fn is_color_byte(x: f64) -> bool {
    (0.0..=255.0).contains(&x) && x.fract() == 0.0
}

/// Evidence by the first lines: rows of at least three numbers, but for a count or a row of names before them.
pub(crate) fn recognize_numbers(file: &FileHead<'_>) -> Option<Evidence> {
    let numbers = |line: &[u8]| {
        let mut n = 0;
        let separator = |b: &u8| is_blank(*b) || matches!(b, b',' | b';');
        let all = line.split(separator).filter(|w| !w.is_empty()).all(|w| {
            n += 1;
            parse_f64(w).is_some()
        });
        all.then_some(n)
    };
    let mut lines = file.statements();
    let is_table = file.is_text()
        && match lines.next().map(numbers) {
            Some(Some(n)) if n >= 3 => true,
            Some(Some(1) | None) => lines.next().and_then(numbers).is_some_and(|n| n >= 3),
            _ => false,
        };
    is_table.then_some(Evidence::Numbers)
}
