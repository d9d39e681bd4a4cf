//! Lengths, widths and boxes in text and in JSON.

use super::number;
use adwave::bands::FWHM;
use serde_json::{Value, json};

/// The least and the greatest coordinates.
type Bounds = ([f64; 3], [f64; 3]);

/// A length in % of the diagonal; a dash if there is none, as on a graph.
pub(crate) fn percent_of(length: f64, diagonal: f64) -> String {
    if diagonal > 0.0 { number(100.0 * length / diagonal) } else { "–".to_owned() }
}

/// The full width at half maximum of a width σ; a dash on a graph, which has no lengths.
pub(crate) fn fwhm_text(sigma: f64, diagonal: f64) -> String {
    if diagonal > 0.0 { number(FWHM * sigma) } else { "–".to_owned() }
}

/// The full widths at half maximum of widths σ; null on a graph.
pub(crate) fn fwhm_json(sigma: &[f64], diagonal: f64) -> Value {
    if diagonal > 0.0 { sigma.iter().map(|sigma| FWHM * sigma).collect() } else { Value::Null }
}

/// A coordinate with four digits of the `diagonal` of the whole shape, however far from 0 that lies.
pub(crate) fn coordinate_text(c: f64, diagonal: f64) -> String {
    let decimals = if diagonal > 0.0 { 3.0 - diagonal.log10().floor() } else { 3.0 };
    let is_plain = c.abs() < 1e9 && decimals <= 9.0;
    if is_plain { format!("{c:.*}", decimals.max(0.0) as usize) } else { number(c) }
}

/// The corners of a box, with four digits of the `diagonal` of the whole shape.
pub(crate) fn bounds_text(bounds: &Bounds, diagonal: f64) -> String {
    let corner = |p: [f64; 3]| p.map(|c| coordinate_text(c, diagonal)).join(" ");
    format!("{} to {}", corner(bounds.0), corner(bounds.1))
}

/// The corners of a box as `min` and `max`; null if there is no box.
pub(crate) fn bounds_json(bounds: Option<Bounds>) -> Value {
    json!(bounds.map(|(min, max)| json!({"min": min, "max": max})))
}
