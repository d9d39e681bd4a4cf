//! Colors: fields of red, green, blue and perhaps alpha, encoded as sRGB for display.

use crate::{Field, FieldValues, ShapeFile, WriteReport};

/// Intensity in [0, 1] that a number of sRGB in [0, 1] stands for (IEC 61966-2-1).
pub(crate) fn linear_from_srgb(x: f64) -> f64 {
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Number of sRGB for an intensity: the inverse of [`linear_from_srgb`].
pub(crate) fn srgb_from_linear(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// Field of the colors, if it is `color` with three or four channels.
pub(crate) fn is_color(field: &Field) -> bool {
    field.name == "color" && matches!(field.n_channels, 3 | 4)
}

/// True if the colors are intensities: integers of 8 or 16 bits, or floats in [0, 1]. Other numbers of that name stay
/// as they are.
pub(crate) fn is_intensity(field: &Field) -> bool {
    let is_within = || field.to_f64().iter().all(|x| (0.0..=1.0).contains(x));
    is_color(field)
        && match field.values {
            FieldValues::U8(_) | FieldValues::U16(_) => true,
            FieldValues::F32(_) | FieldValues::F64(_) => is_within(),
            _ => false,
        }
}

/// Difference of a channel from a byte that rounding to 16 bits of linear intensity leaves, of 255.
const BYTE_TOLERANCE: f64 = 0.03;

/// Numbers of sRGB for colors in linear intensities, which are fractions of the largest integer for integers; alpha
/// stays. Bytes if the intensities are bytes or all numbers are those of bytes, else 32-bit floats in [0, 1].
pub(crate) fn srgb_values(linear: &FieldValues, n_channels: usize) -> FieldValues {
    let full = match linear {
        FieldValues::U8(_) => f64::from(u8::MAX),
        FieldValues::U16(_) => f64::from(u16::MAX),
        _ => 1.0,
    };
    let number = |k: usize| {
        let x = linear.get(k) / full;
        if n_channels > 2 && k % n_channels < 3 { srgb_from_linear(x) } else { x }
    };
    let numbers: Vec<f64> = (0..linear.len()).map(number).collect();
    let is_byte = |x: &f64| {
        let scaled = 255.0 * x;
        (-BYTE_TOLERANCE..255.0 + BYTE_TOLERANCE).contains(&scaled)
            && (scaled - scaled.round()).abs() <= BYTE_TOLERANCE
    };
    if matches!(linear, FieldValues::U8(_)) || numbers.iter().all(is_byte) {
        FieldValues::U8(numbers.iter().map(|x| (255.0 * x).round() as u8).collect())
    } else {
        FieldValues::F32(numbers.iter().map(|x| *x as f32).collect())
    }
}

/// Colors in bytes; `None` unless they are floats in [0, 1], which all readers of colors take for intensities. The flag
/// is true if digits are lost.
fn in_bytes(field: &Field) -> Option<(Field, bool)> {
    if !is_intensity(field) || matches!(field.values, FieldValues::U8(_) | FieldValues::U16(_)) {
        return None;
    }
    let scaled: Vec<f64> = field.to_f64().iter().map(|x| 255.0 * x).collect();
    let is_rounded = scaled.iter().any(|x| (x - x.round()).abs() > 1e-4);
    let bytes = scaled.iter().map(|x| x.round() as u8).collect();
    Some((Field::new("color", field.n_channels, FieldValues::U8(bytes)), is_rounded))
}

/// Copy of a shape with colors in bytes, for formats whose readers expect them; `None` if nothing changes.
pub(crate) fn with_byte_colors(shape: &ShapeFile, report: &mut WriteReport) -> Option<ShapeFile> {
    let mut changed: Option<ShapeFile> = None;
    let lists = [&shape.vertex_fields, &shape.face_fields];
    for (at, fields) in lists.into_iter().enumerate() {
        for (k, field) in fields.iter().enumerate() {
            let Some((bytes, is_rounded)) = in_bytes(field) else { continue };
            if is_rounded {
                report.report_dropped("digits of `color` beyond 8 bits");
            }
            let copy = changed.get_or_insert_with(|| shape.clone());
            let list = if at == 0 { &mut copy.vertex_fields } else { &mut copy.face_fields };
            list[k] = bytes;
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_inverse_and_have_the_values_of_the_standard() {
        for k in 0..=1000 {
            let x = f64::from(k) / 1000.0;
            assert!((srgb_from_linear(linear_from_srgb(x)) - x).abs() < 1e-6, "{x}");
        }
        // Middle gray of 188 is half of the light; 128 is 21.6 %.
        assert!((linear_from_srgb(188.0 / 255.0) - 0.5029).abs() < 1e-4);
        assert!((linear_from_srgb(128.0 / 255.0) - 0.2159).abs() < 1e-4);
    }

    #[test]
    fn only_intensities_become_bytes() {
        let bytes = |values| in_bytes(&Field::new("color", 3, values));
        let (field, is_rounded) = bytes(FieldValues::F64(vec![0.0, 0.5, 1.0])).unwrap();
        assert_eq!((field.to_f64(), is_rounded), (vec![0.0, 128.0, 255.0], true));
        assert!(bytes(FieldValues::F32(vec![0.0, 0.5, 1.5])).is_none());
        assert!(bytes(FieldValues::F32(vec![0.0, f32::NAN, 1.0])).is_none());
        assert!(bytes(FieldValues::U32(vec![0, 1, 5_514_484])).is_none());
    }

    #[test]
    fn bytes_survive_sixteen_bits_of_light() {
        let light: Vec<u16> =
            (0..=255).map(|b| (65_535.0 * linear_from_srgb(f64::from(b) / 255.0)).round() as u16).collect();
        let light: Vec<u16> = light.iter().flat_map(|x| [*x; 3]).collect();
        let FieldValues::U8(bytes) = srgb_values(&FieldValues::U16(light), 3) else { panic!("no bytes") };
        assert_eq!(bytes, (0..=255).flat_map(|b| [b; 3]).collect::<Vec<u8>>());
    }
}
