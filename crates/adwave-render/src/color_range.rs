//! Value range of a color map.

use crate::color_map::{ColorMap, value_range};
use crate::error::RenderError;
use crate::surface::FieldPaint;

/// Fraction of the values that may lie outside an automatic range at each end.
const TAIL: f64 = 0.01;

/// Ratio of the smaller to the larger magnitude of a range's ends above which the range counts as having both signs;
/// below it the change of sign is noise.
const BOTH_SIGNS: f64 = 0.1;

/// Values at the ends of the color map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum ValueRange {
    /// Range from the 1st to the 99th percentile, or of all values if few of them differ; symmetric about 0 for a field
    /// of both signs.
    #[default]
    Auto,
    /// Range from the first to the second value.
    Fixed(f64, f64),
}

impl ValueRange {
    pub(crate) fn check(self) -> Result<(), RenderError> {
        match self {
            Self::Fixed(low, high) if !(low < high && (high - low).is_finite()) => {
                Err(RenderError::BadRange { low, high })
            }
            _ => Ok(()),
        }
    }
}

/// Color map with the values at its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ColorScale {
    pub(crate) map: ColorMap,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// True if there are values below `low`.
    pub(crate) below: bool,
    /// True if there are values above `high`.
    pub(crate) above: bool,
}

impl ColorScale {
    /// Creates a color scale shared by several fields: one range for all their values.
    pub(crate) fn from_fields(fields: &[&FieldPaint]) -> Self {
        let values: Vec<f64> = fields.iter().flat_map(|f| f.values.iter().copied()).collect();
        let (least, most) = value_range(&values, 0.0, 1.0);
        let fixed = fields.iter().find_map(|f| match f.range {
            ValueRange::Fixed(low, high) => Some((low, high)),
            ValueRange::Auto => None,
        });
        let (low, high) = fixed.unwrap_or_else(|| automatic(&values));
        let chosen = fields.iter().find_map(|f| f.color_map);
        let usual = if both_signs(low, high) { "coolwarm" } else { "viridis" };
        let map = chosen.unwrap_or_else(|| ColorMap::built_in(usual));
        Self { map, low, high, below: least < low, above: most > high }
    }

    /// True if one color bar is valid for both scales.
    pub(crate) fn has_same_range_as(&self, other: &Self) -> bool {
        (self.map, self.low, self.high) == (other.map, other.low, other.high)
    }

    /// Relative position of a value between the ends, in [0, 1] inside the range.
    pub(crate) fn position(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

fn both_signs(low: f64, high: f64) -> bool {
    low < 0.0 && high > 0.0 && -low > BOTH_SIGNS * high && high > BOTH_SIGNS * -low
}

/// Chooses a range that is robust against a few extreme values.
fn automatic(values: &[f64]) -> (f64, f64) {
    let (least, most) = value_range(values, 0.0, 1.0);
    let (mut low, mut high) = value_range(values, TAIL, 1.0 - TAIL);
    if low >= high {
        // Nearly all values are equal, so the few that differ are worth showing.
        (low, high) = (least, most);
    }
    if both_signs(low, high) {
        let size = high.max(-low);
        (low, high) = (-size, size);
    }
    // A range wider than the largest number has no finite width to divide by.
    let largest = f64::MAX / 4.0;
    (low, high) = (low.clamp(-largest, largest), high.clamp(-largest, largest));
    if low < high {
        return (low, high);
    }
    let room = if low == 0.0 { 1.0 } else { low.abs() * 0.5 };
    (low - room, low + room)
}
