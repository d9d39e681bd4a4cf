//! Text of CSV files: how cells are quoted and numbers written, for everything that writes a table.

use super::push_f64;

/// Adds a row to a CSV text as RFC 4180 has it: cells with commas, quotes or line breaks stand in quotes; the row ends in a
/// line feed.
///
/// ```
/// let mut text = String::new();
/// adwave_io::push_csv_row(&mut text, ["x", "name"]);
/// adwave_io::push_csv_row(&mut text, [adwave_io::csv_number(0.5), "a, \"b\"".to_owned()]);
/// assert_eq!(text, "x,name\n0.5,\"a, \"\"b\"\"\"\n");
/// ```
pub fn push_csv_row<C: AsRef<str>>(text: &mut String, cells: impl IntoIterator<Item = C>) {
    for (k, cell) in cells.into_iter().enumerate() {
        if k > 0 {
            text.push(',');
        }
        let cell = cell.as_ref();
        if cell.contains([',', '"', '\n', '\r']) {
            text.push('"');
            text.push_str(&cell.replace('"', "\"\""));
            text.push('"');
        } else {
            text.push_str(cell);
        }
    }
    text.push('\n');
}

/// A number as the cell of a table: the shortest decimal that reads back to the same value; `nan` and `inf` in small letters.
pub fn csv_number(x: f64) -> String {
    let mut text = Vec::new();
    push_f64(&mut text, x);
    text.into_iter().map(char::from).collect()
}
