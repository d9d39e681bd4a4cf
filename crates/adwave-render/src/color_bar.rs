//! Color bar: shows which color stands for which value.

use crate::color_range::ColorScale;
use crate::picture::Picture;
use crate::text;

/// Color of text and lines.
pub(crate) const INK: [u8; 3] = [38, 42, 48];

/// Approximate number of tick labels beside a bar.
const TICKS: f64 = 5.0;

/// Position of the bar in the picture, in pixels, and its labels.
#[derive(Debug)]
pub(crate) struct Bar {
    /// Left edge of the bar's part of the picture.
    pub(crate) left_edge: f64,
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) thick: f64,
    pub(crate) tall: f64,
    pub(crate) gap: f64,
    /// Font size.
    pub(crate) size: f32,
    pub(crate) label: String,
    /// Tick values with their labels.
    pub(crate) marks: Vec<(f64, String)>,
}

/// Round tick values between `low` and `high` with their labels: multiples of 1, 2 or 5 times a power of ten.
pub(crate) fn ticks(low: f64, high: f64) -> Vec<(f64, String)> {
    let span = high - low;
    let rough = span / TICKS;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= 0.999 * rough);
    let Some(step) = step.filter(|s| *s > 0.0 && s.is_finite()) else {
        return vec![(low, format_tick(low, span)), (high, format_tick(high, span))];
    };
    // A range far from 0 may be narrower than the spacing of floating-point numbers there.
    let first = (low / step - 1e-9).ceil();
    let marks: Vec<f64> = (0..=10)
        .map(|k| (first + f64::from(k)) * step)
        .take_while(|v| *v <= high + 1e-9 * span)
        .map(|v| if v.abs() < 1e-9 * span { 0.0 } else { v })
        .collect();
    let mut known = Vec::new();
    for v in marks {
        let text = format_tick(v, step);
        if known.iter().all(|(_, other)| *other != text) {
            known.push((v, text));
        }
    }
    known
}

/// Formats a tick value with the precision that steps of `step` need.
fn format_tick(value: f64, step: f64) -> String {
    let size = value.abs().max(step.abs());
    let text = if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (-(step * 1.001).log10().floor()).clamp(0.0, 8.0) as usize;
        format!("{value:.decimals$}")
    } else {
        let digits = (value.abs().log10().floor() - (step * 1.001).log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$e}")
    };
    text.replace('-', "−")
}

/// Draws the bar with `high` at the top; an arrowhead at an end marks values beyond it.
pub(crate) fn draw(picture: &mut Picture, bar: &Bar, scale: &ColorScale) {
    let (left, top) = (bar.left.round() as i64, bar.top.round() as i64);
    let (thick, tall) = (bar.thick.round().max(1.0) as i64, bar.tall.round().max(2.0) as i64);
    for y in 0..tall {
        let color = scale.map.color(1.0 - y as f64 / (tall - 1) as f64);
        for x in 0..thick {
            picture.blend(left + x, top + y, color, 1.0);
        }
    }
    let tip = thick * 3 / 5;
    for k in 1..=tip {
        // Narrower with each row, with smoothed edges.
        let half = thick as f32 / 2.0 * (1.0 - k as f32 / (tip + 1) as f32);
        for x in 0..thick {
            let off = (x as f32 + 0.5 - thick as f32 / 2.0).abs();
            let coverage = (half - off + 0.5).clamp(0.0, 1.0);
            if scale.above {
                picture.blend(left + x, top - k, scale.map.color(1.0), coverage);
            }
            if scale.below {
                picture.blend(left + x, top + tall - 1 + k, scale.map.color(0.0), coverage);
            }
        }
    }
    for (value, text) in &bar.marks {
        let y = bar.top + (1.0 - scale.position(*value)) * (bar.tall - 1.0);
        for x in 0..(bar.gap * 0.5).round() as i64 {
            picture.blend(left + thick + x, y.round() as i64, INK, 0.8);
        }
        let from = (left + thick) as f32 + bar.gap as f32;
        text::draw(picture, text, bar.size, from, y as f32 + 0.5, INK);
    }
    let above = bar.top - 0.6 * bar.thick - 0.95 * f64::from(bar.size);
    text::draw(picture, &bar.label, bar.size, left as f32, above as f32, INK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_round_and_inside() {
        let texts = |low, high| ticks(low, high).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(texts(0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(-3.0, 3.0), ["−2", "0", "2"]);
        assert_eq!(texts(0.0, 2.3e-7), ["0", "5e−8", "1.0e−7", "1.5e−7", "2.0e−7"]);
        assert_eq!(texts(100.0, 104.0), ["100", "101", "102", "103", "104"]);
        for (low, high) in [(1e16, 1e16 + 4.0), (-1e300, 1e300), (0.0, 1e-300), (5.0, 5.000_001)] {
            let found = ticks(low, high);
            assert!(!found.is_empty() && found.len() <= 11, "{found:?}");
            assert!(
                found.iter().all(|t| t.0 >= low - (high - low) * 1e-6 && t.0 <= high + (high - low) * 1e-6)
            );
        }
    }
}
