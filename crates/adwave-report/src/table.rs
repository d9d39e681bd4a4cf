//! Tables of numbers: rows of a page, and CSV files.

use std::fmt::Write as _;

/// Numbers in rows, as a page shows them and as a file holds them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// The name of its file, with the ending `.csv`; unique within the page or figure.
    pub name: String,
    /// What the numbers are.
    pub caption: String,
    /// Names of the columns, with units.
    pub head: Vec<String>,
    /// One cell a column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(name: &str, caption: &str, head: &[&str]) -> Self {
        let head = head.iter().map(|&h| h.to_owned()).collect();
        Self { name: name.to_owned(), caption: caption.to_owned(), head, rows: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// Unless there is one cell a column.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        assert_eq!(N, self.head.len(), "one cell a column of {}", self.name);
        self.rows.push(row.into());
    }

    /// The table as RFC 4180 has it: cells with commas, quotes or line breaks in quotes.
    ///
    /// ```
    /// use adwave_report::Table;
    /// let mut table = Table::new("a.csv", "", &["x", "y"]);
    /// table.push(["1".to_owned(), "a, \"b\"".to_owned()]);
    /// assert_eq!(table.csv(), "x,y\n1,\"a, \"\"b\"\"\"\n");
    /// ```
    pub fn csv(&self) -> String {
        let mut text = String::new();
        for row in std::iter::once(&self.head).chain(&self.rows) {
            for (k, cell) in row.iter().enumerate() {
                text.push_str(if k > 0 { "," } else { "" });
                if cell.contains([',', '"', '\n', '\r']) {
                    let _ = write!(text, "\"{}\"", cell.replace('"', "\"\""));
                } else {
                    text.push_str(cell);
                }
            }
            text.push('\n');
        }
        text
    }
}

/// Four significant digits, in scientific notation where the number is very large or small.
///
/// ```
/// use adwave_report::digits;
/// assert_eq!((digits(0.0), digits(12.3456), digits(1.0e-9)), ("0".into(), "12.35".into(), "1.000e-9".into()));
/// ```
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if !value.is_finite() {
        String::new()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}
