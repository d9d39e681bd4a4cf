//! What the columns of a row mean.

use crate::model::file_head::FileHead;
use crate::model::format_descriptor::Evidence;
use crate::text::is_blank;
use crate::text::parse_f64;
use adwave::{Cancelled, Progress};

use crate::progress::all;

/// Names the columns. Names in the file are kept, with `x`, `y`, `z` for the coordinates. Columns without names are
/// named by their values: unit vectors are normals, and groups of three integers up to 255 are colors.
pub(crate) fn name_columns(
    names: &[String],
    values: &[f64],
    n_columns: usize,
    n_rows: usize,
    progress: Progress<'_>,
) -> Result<Vec<String>, Cancelled> {
    if names.len() == n_columns && n_columns >= 3 {
        let lower = |axis: &str| names.iter().position(|n| n.eq_ignore_ascii_case(axis));
        let mut named = names.to_vec();
        let axes = match (lower("x"), lower("y"), lower("z")) {
            (Some(x), Some(y), Some(z)) => [x, y, z],
            _ => [0, 1, 2],
        };
        for (axis, at) in ["x", "y", "z"].into_iter().zip(axes) {
            named[at] = axis.into();
        }
        return Ok(named);
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
    Ok(named)
}

/// Deviation from a unit vector that a few digits of text allow.
const UNIT_TOLERANCE: f64 = 1e-2;

fn is_unit(v: [f64; 3]) -> bool {
    let squared: f64 = v.iter().map(|x| x * x).sum();
    squared == 0.0 || (squared.sqrt() - 1.0).abs() < UNIT_TOLERANCE
}

/// Whether it is a whole number that fits a byte.
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
