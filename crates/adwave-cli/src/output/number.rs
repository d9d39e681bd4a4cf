//! Numbers in text and in JSON.

use adwave_report::digits;
use serde_json::{Value, json};

/// Four significant digits, in scientific notation if the number is very large or small.
pub(crate) fn number(value: f64) -> String {
    if value.is_finite() { digits(value) } else { value.to_string() }
}

/// Shift in words: three numbers, 0 for what is rounding beside `size`.
pub(crate) fn shift(coordinates: [f64; 3], size: f64) -> String {
    /// Largest rounding beside 1.
    const ROUNDING: f64 = 1e-14;
    coordinates.map(|c| number(if c.abs() < ROUNDING * size { 0.0 } else { c })).join(", ")
}

/// A number of things with its noun: `1 tile`, `2 tiles`. `plural` is the plural of `noun`.
pub(crate) fn count<N: std::fmt::Display + Copy + PartialEq + From<u8>>(
    n: N,
    noun: &str,
    plural: &str,
) -> String {
    if n == N::from(1) { format!("{n} {noun}") } else { format!("{n} {plural}") }
}

/// A number of steps: a whole one as it is, else four significant digits.
pub(crate) fn steps_text(steps: f64) -> String {
    if steps.fract() == 0.0 { steps.to_string() } else { number(steps) }
}

/// Numbers of steps, the whole ones as whole numbers.
pub(crate) fn steps_json(steps: &[f64]) -> Vec<Value> {
    steps.iter().map(|&n| if n.fract() == 0.0 { json!(n as u64) } else { json!(n) }).collect()
}

/// Number of bytes in kB, MB or GB.
pub(crate) fn bytes_text(bytes: f64) -> String {
    if bytes < 1e5 {
        format!("{:.1} kB", bytes / 1e3)
    } else if bytes < 1e8 {
        format!("{:.1} MB", bytes / 1e6)
    } else {
        format!("{:.1} GB", bytes / 1e9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nouns_agree_with_their_numbers() {
        assert_eq!(count(1_usize, "tile", "tiles"), "1 tile");
        assert_eq!(count(0_usize, "vertex", "vertices"), "0 vertices");
        assert_eq!(count(2_u64, "vertex", "vertices"), "2 vertices");
    }
}
