//! The bar that says which colour stands for which value.

use crate::color_range::ColorScale;
use crate::picture::Picture;
use crate::text;

/// Ink for text and ticks: dark grey on light grounds, light on dark ones.
pub(crate) fn ink(background: [u8; 3]) -> [u8; 3] {
    let bright = background.iter().map(|&c| u32::from(c)).sum::<u32>() > 330;
    if bright { [48, 48, 48] } else { [232, 232, 232] }
}

/// The size of letters in a picture of that size, pixels.
pub(crate) fn letter_size(width: u32, height: u32) -> f32 {
    (0.030 * width.min(height) as f32).clamp(11.0, 44.0)
}

/// How many pixels at the right of a picture the bar takes.
pub(crate) fn room(width: u32, height: u32) -> u32 {
    ((6.4 * letter_size(width, height)) as u32).min(width / 3)
}

/// Draws the bar with its ticks into the right of a picture, the label above.
pub(crate) fn draw(picture: &mut Picture, scale: &ColorScale, label: &str, color: [u8; 3]) {
    let size = letter_size(picture.width, picture.height);
    let room = room(picture.width, picture.height) as f32;
    let (width, height) = (picture.width as f32, picture.height as f32);
    let left = width - room + 0.3 * size;
    let (top, bottom) = (0.22 * height, 0.82 * height);
    let thick = 0.95 * size;
    for y in top as i64..=bottom as i64 {
        let t = 1.0 - (y as f32 - top) / (bottom - top);
        for x in 0..thick as i64 {
            picture.blend(left as i64 + x, y, scale.map.color(f64::from(t)), 1.0);
        }
    }
    let (ticks, step) = ticks(scale.low, scale.high);
    for value in ticks {
        let y = bottom - (bottom - top) * scale.place(value) as f32;
        for x in 0..(0.35 * size) as i64 {
            picture.blend((left + thick) as i64 + x, y as i64, color, 1.0);
        }
        let text = tick_text(value, step, scale.low.abs().max(scale.high.abs()));
        let text = text::fitted(&text, 0.85 * size, width - left - thick - 0.5 * size);
        text::write(picture, &text, left + thick + 0.55 * size, y, 0.85 * size, color);
    }
    // Values beyond the ends have the colours of the ends; the arrows say so.
    if scale.above {
        arrow(picture, left, top, thick, -1.0, scale.map.color(1.0));
    }
    if scale.below {
        arrow(picture, left, bottom, thick, 1.0, scale.map.color(0.0));
    }
    let label = text::fitted(label, size, 2.0 * room);
    let start =
        (left + thick - 0.5 * text::width(&label, size)).min(width - text::width(&label, size) - 0.3 * size);
    text::write(picture, &label, start.max(0.0), top - 2.0 * size, size, color);
}

fn arrow(picture: &mut Picture, left: f32, base: f32, thick: f32, way: f32, color: [u8; 3]) {
    let n = (0.6 * thick) as i64;
    for k in 1..=n {
        let inset = (0.5 * thick * k as f32 / n as f32) as i64;
        for x in inset..thick as i64 - inset {
            picture.blend(left as i64 + x, base as i64 + way as i64 * k, color, 1.0);
        }
    }
}

/// Round values between two, about five of them, and the step between them.
pub(crate) fn ticks(low: f64, high: f64) -> (Vec<f64>, f64) {
    let rough = (high - low) / 5.0;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= 0.999 * rough);
    let step = step.unwrap_or(10.0 * power);
    if !(step > 0.0 && step.is_finite()) {
        return (vec![low, high], high - low);
    }
    let first = (low / step - 1e-9).ceil();
    let values = (0..12).map(|k| (first + f64::from(k)) * step).take_while(|v| *v <= high + 1e-9 * step);
    (values.collect(), step)
}

fn tick_text(value: f64, step: f64, largest: f64) -> String {
    if value == 0.0 || value.abs() < 1e-9 * step {
        return "0".to_owned();
    }
    if !(1e-3..1e5).contains(&largest) {
        return format!("{value:.1e}");
    }
    let digits = (-step.log10()).ceil().clamp(0.0, 6.0) as usize;
    // A step of 0.25 has one more digit than its power of ten tells.
    let shown = format!("{value:.digits$}");
    let exact = shown.parse::<f64>().is_ok_and(|v| (v - value).abs() < 1e-3 * step);
    if exact { shown } else { format!("{value:.*}", digits + 1) }
}
