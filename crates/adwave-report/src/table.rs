//! Tables of numbers, for pages and CSV files.

use std::fmt::Write as _;

/// Cell of a missing value.
pub const NONE: &str = "–";

/// Table, as a page shows it and a CSV file stores it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// File name with the extension `.csv`, unique within the page or figure.
    pub name: String,
    /// Description of the numbers.
    pub caption: String,
    /// Names of the columns, with units.
    pub head: Vec<String>,
    /// Rows of cells, one cell per column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table without rows.
    pub fn new(name: &str, caption: &str, head: &[&str]) -> Self {
        let head = head.iter().map(|&h| h.to_owned()).collect();
        Self { name: name.to_owned(), caption: caption.to_owned(), head, rows: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If the number of cells differs from the number of columns.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        assert_eq!(N, self.head.len(), "one cell a column of {}", self.name);
        self.rows.push(row.into());
    }

    /// Removes the columns that have no value in any row.
    #[must_use]
    pub fn drop_empty_columns(mut self) -> Self {
        let kept: Vec<bool> = (0..self.head.len())
            .map(|k| self.rows.is_empty() || self.rows.iter().any(|row| row[k] != NONE))
            .collect();
        for row in std::iter::once(&mut self.head).chain(&mut self.rows) {
            let mut k = 0;
            row.retain(|_| {
                k += 1;
                kept[k - 1]
            });
        }
        self
    }

    /// Converts the table to CSV (RFC 4180); cells with commas, quotes or line breaks are quoted.
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

/// Formats a column with an equal number of decimals in every cell: three significant digits of the smallest nonzero
/// value, or scientific notation if that takes more than seven decimals or if a value is at least 10⁶. A value that is
/// not finite becomes [`NONE`].
///
/// ```
/// use adwave_report::column;
/// assert_eq!(column(&[0.00056, 0.25]), ["0.000560", "0.250000"]);
/// assert_eq!(column(&[1e-9, 2.0, f64::NAN]), ["1.000e-9", "2.000e0", "–"]);
/// ```
pub fn column(values: &[f64]) -> Vec<String> {
    let sizes = || values.iter().filter(|v| v.is_finite() && **v != 0.0).map(|v| v.abs());
    let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    let decimals = if least.is_finite() { 2 - least.log10().floor() as i32 } else { 0 };
    let cell = |value: &f64| {
        if !value.is_finite() {
            NONE.to_owned()
        } else if decimals > 7 || most >= 1e6 {
            if *value == 0.0 { "0".to_owned() } else { format!("{value:.3e}") }
        } else {
            format!("{value:.*}", decimals.max(0) as usize)
        }
    };
    values.iter().map(cell).collect()
}

/// Formats a number with four significant digits, in scientific notation if it is very large or small.
///
/// ```
/// use adwave_report::digits;
/// assert_eq!((digits(0.0), digits(12.3456), digits(1.0e-9)), ("0".into(), "12.35".into(), "1.000e-9".into()));
/// assert_eq!((digits(0.99999), digits(999.96)), ("1.000".into(), "1000".into()));
/// ```
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if !value.is_finite() {
        String::new()
    } else if (1e-3..1e6).contains(&size) {
        // Exponent of the first digit after rounding, which may be larger than that of the value.
        let place = format!("{size:.3e}").rsplit('e').next().and_then(|e| e.parse::<i32>().ok()).unwrap_or(0);
        let decimals = (3 - place).clamp(0, 6) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

/// Formats a number with three significant digits and without trailing zeros, where there is little space.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    let text = if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.2e}")
    };
    text.replacen('-', "−", usize::from(value < 0.0))
}

/// Formats an end of a range of length `span` like [`short`], with enough digits to distinguish a hundredth of the
/// span.
pub(crate) fn range_end(value: f64, span: f64) -> String {
    let decimals = 2.0 - span.log10().floor();
    // Three digits of the value are enough unless its range is narrower than that.
    let is_narrow = value.abs() >= 1e3 * span && span > 0.0;
    if is_narrow && decimals <= 12.0 && value.abs() < 1e15 {
        let text = format!("{value:.*}", decimals.max(0.0) as usize);
        return text.replacen('-', "−", usize::from(value < 0.0));
    }
    if is_narrow {
        let digits = (value.abs().log10().floor() - span.log10().floor() + 2.0).clamp(2.0, 16.0);
        let text = format!("{value:.*e}", digits as usize);
        return text.replacen('-', "−", usize::from(value < 0.0));
    }
    short(value)
}

/// Formats a count in groups of three digits, separated by narrow spaces.
pub(crate) fn grouped(count: usize) -> String {
    let text = count.to_string();
    let mut out = String::new();
    for (k, digit) in text.chars().enumerate() {
        if k > 0 && (text.len() - k).is_multiple_of(3) && text.len() > 4 {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped_from_five_digits_on() {
        assert_eq!(
            [0, 1234, 12345, 1_234_567].map(grouped),
            ["0", "1234", "12\u{202f}345", "1\u{202f}234\u{202f}567"]
        );
    }

    #[test]
    fn short_numbers_have_three_digits_at_most() {
        let texts = [0.0, -0.075, 1344.9, 120.0, 3.118e-7, 12345.0, -2e-9].map(short);
        assert_eq!(texts, ["0", "−0.075", "1345", "120", "3.12e-7", "12345", "−2.00e-9"]);
    }

    #[test]
    fn ends_of_a_range_tell_its_hundredths_apart() {
        let ends = |low: f64, high: f64| [low, high].map(|value| range_end(value, high - low));
        assert_eq!(ends(1e6, 1e6 + 1.0), ["1000000.00", "1000001.00"]);
        assert_eq!(ends(0.0, 1.0), ["0", "1"]);
        assert_eq!(ends(-2.5e-7, 2.5e-7), ["−2.50e-7", "2.50e-7"]);
        assert_eq!(ends(-1e6 - 50.0, -1e6), ["−1000050.0", "−1000000.0"]);
        for size in [1e-9, 0.3, 17.0, 4e5, 6e12] {
            for narrow in [1e-3, 1e-5, 1e-7] {
                let (low, high) = (size, size * (1.0 + narrow));
                let [first, last] = ends(low, high).map(|text| text.parse::<f64>().unwrap());
                assert!((last - first - (high - low)).abs() <= 0.02 * (high - low), "{low:e}, {high:e}");
            }
        }
    }

    #[test]
    fn columns_without_values_are_left_out() {
        let mut table = Table::new("a.csv", "", &["x", "y", "z"]);
        table.push(["1".to_owned(), NONE.to_owned(), NONE.to_owned()]);
        table.push(["2".to_owned(), NONE.to_owned(), "3".to_owned()]);
        assert_eq!(table.drop_empty_columns().csv(), "x,z\n1,–\n2,3\n");
        assert_eq!(Table::new("a.csv", "", &["x"]).drop_empty_columns().head, ["x"]);
    }

    #[test]
    fn a_column_has_the_same_decimals_throughout() {
        assert_eq!(column(&[0.0, -0.012, 3.0]), ["0.0000", "-0.0120", "3.0000"]);
        assert_eq!(column(&[1234.5, 12.0]), ["1234.5", "12.0"]);
        assert_eq!(column(&[2e9, 0.0]), ["2.000e9", "0"]);
        assert_eq!(column(&[0.0, f64::INFINITY]), ["0", NONE]);
        assert!(column(&[]).is_empty());
    }
}
