//! Luminance and lightness of a color.

/// Linear light of an sRGB channel (IEC 61966-2-1), both in [0, 1].
fn linear(channel: f64) -> f64 {
    let c = channel.clamp(0.0, 1.0);
    if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Relative luminance Y = 0.2126 R + 0.7152 G + 0.0722 B of linear light, in [0, 1], for an sRGB color with
/// channels in [0, 1]; NaN if a channel is.
///
/// ```
/// use adwave::signal::luminance;
/// assert_eq!(luminance([0.0, 0.0, 0.0]), 0.0);
/// assert!((luminance([1.0, 1.0, 1.0]) - 1.0).abs() < 1e-15);
/// assert!(luminance([0.0, 1.0, 0.0]) > luminance([1.0, 0.0, 0.0]));
/// ```
pub fn luminance(rgb: [f64; 3]) -> f64 {
    let [r, g, b] = rgb.map(linear);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// CIE lightness L* in [0, 100] of an sRGB color with channels in [0, 1]. Equal steps look equally large, unlike
/// those of [`luminance`].
///
/// ```
/// use adwave::signal::lightness;
/// assert!((lightness([1.0, 1.0, 1.0]) - 100.0).abs() < 1e-12);
/// assert_eq!(lightness([0.0, 0.0, 0.0]), 0.0);
/// ```
pub fn lightness(rgb: [f64; 3]) -> f64 {
    const EPSILON: f64 = 216.0 / 24389.0;
    const KAPPA: f64 = 24389.0 / 27.0;
    let y = luminance(rgb);
    if y <= EPSILON { KAPPA * y } else { 116.0 * y.cbrt() - 16.0 }
}
