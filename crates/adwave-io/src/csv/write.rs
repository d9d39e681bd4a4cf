//! The text of CSV files: how cells are quoted and numbers written, for everything that writes a table.

use crate::text::push_f64;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let values = [0.1, -0.0, 1e300, f64::NAN];
        let mut text = String::new();
        push_csv_row(&mut text, ["the \"first\", and only"]);
        for x in values {
            push_csv_row(&mut text, [csv_number(x)]);
        }
        let fields = crate::parse_csv_fields(text.as_bytes(), &crate::ReadLimits::default()).unwrap();
        assert_eq!(fields[0].name, "the \"first\", and only");
        let read = fields[0].to_f64();
        assert_eq!(
            read[..3].iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
            values[..3].iter().map(|x| x.to_bits()).collect::<Vec<_>>()
        );
        assert!(read[3].is_nan());
    }
}
