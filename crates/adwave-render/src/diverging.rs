//! Diverging color map from blue through white to red, known as "cool to warm".

use std::f64::consts::FRAC_PI_3;
use std::sync::LazyLock;

/// Colors at the ends of the map, sRGB in [0, 1].
const COOL: [f64; 3] = [0.230, 0.299, 0.754];
const WARM: [f64; 3] = [0.706, 0.016, 0.150];

/// Magnitude of the white in the middle of the map.
const WHITE: f64 = 88.0;

/// CIE XYZ of the white of sRGB (D65).
const WHITE_XYZ: [f64; 3] = [0.950_47, 1.0, 1.088_83];

/// Matrix from linear sRGB to CIE XYZ, IEC 61966-2-1.
const TO_XYZ: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// Inverse of [`TO_XYZ`].
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// Number of steps of the table, finer than the resolution of a byte.
const STEPS: usize = 1024;

/// Magnitude, saturation and hue: CIE L*a*b* in polar coordinates around black.
#[derive(Clone, Copy)]
struct Msh {
    magnitude: f64,
    saturation: f64,
    hue: f64,
}

/// Color at `t` in [0, 1]: blue at 0, white at 0.5, red at 1.
///
/// Source: Moreland, "Diverging color maps for scientific visualization", 2009. Each half is a straight line in (M, s,
/// h) from a saturated end to a white whose hue is shifted so that colors change at an even rate.
pub(crate) fn coolwarm(t: f64) -> [u8; 3] {
    static TABLE: LazyLock<Vec<[u8; 3]>> =
        LazyLock::new(|| (0..=STEPS).map(|k| interpolate(k as f64 / STEPS as f64)).collect());
    TABLE[(t.clamp(0.0, 1.0) * STEPS as f64).round() as usize]
}

fn interpolate(t: f64) -> [u8; 3] {
    let end = if t < 0.5 { to_msh(COOL) } else { to_msh(WARM) };
    let white = Msh { magnitude: WHITE, saturation: 0.0, hue: adjusted_hue(end, WHITE) };
    let s = (2.0 * t - 1.0).abs();
    let mix = |a: f64, b: f64| a + s * (b - a);
    from_msh(Msh {
        magnitude: mix(white.magnitude, end.magnitude),
        saturation: mix(white.saturation, end.saturation),
        hue: mix(white.hue, end.hue),
    })
}

/// Hue of an unsaturated color of this magnitude when it is mixed with `end`.
fn adjusted_hue(end: Msh, magnitude: f64) -> f64 {
    if end.magnitude >= magnitude {
        return end.hue;
    }
    let turn = end.saturation * (magnitude.powi(2) - end.magnitude.powi(2)).sqrt()
        / (end.magnitude * end.saturation.sin());
    // Away from purple, on either side of it.
    if end.hue > -FRAC_PI_3 { end.hue + turn } else { end.hue - turn }
}

fn to_msh(rgb: [f64; 3]) -> Msh {
    let linear = rgb.map(|c| if c > 0.040_45 { ((c + 0.055) / 1.055).powf(2.4) } else { c / 12.92 });
    let f = |t: f64| if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
    let xyz = multiply(&TO_XYZ, linear);
    let [x, y, z] = [0, 1, 2].map(|k| f(xyz[k] / WHITE_XYZ[k]));
    let [l, a, b] = [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)];
    let magnitude = (l * l + a * a + b * b).sqrt();
    Msh { magnitude, saturation: (l / magnitude).acos(), hue: b.atan2(a) }
}

fn from_msh(msh: Msh) -> [u8; 3] {
    let l = msh.magnitude * msh.saturation.cos();
    let a = msh.magnitude * msh.saturation.sin() * msh.hue.cos();
    let b = msh.magnitude * msh.saturation.sin() * msh.hue.sin();
    let y = (l + 16.0) / 116.0;
    let f = |t: f64| if t > 0.206_893 { t.powi(3) } else { (t - 16.0 / 116.0) / 7.787 };
    let xyz = [f(y + a / 500.0) * WHITE_XYZ[0], f(y) * WHITE_XYZ[1], f(y - b / 200.0) * WHITE_XYZ[2]];
    multiply(&FROM_XYZ, xyz).map(|c| {
        let c = if c > 0.003_130_8 { 1.055 * c.powf(1.0 / 2.4) - 0.055 } else { 12.92 * c };
        (c.clamp(0.0, 1.0) * 255.0).round() as u8
    })
}

fn multiply(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_and_the_middle_are_those_published() {
        // Moreland's own table of the map has these bytes; a difference of one is rounding.
        for (t, expected) in [(0.0, [59, 76, 192]), (0.5, [221, 221, 221]), (1.0, [180, 4, 38])] {
            let found = coolwarm(t);
            for c in 0..3 {
                assert!(i32::from(found[c]).abs_diff(expected[c]) <= 1, "{t}: {found:?}");
            }
        }
    }

    #[test]
    fn it_is_cool_below_and_warm_above() {
        for k in 1..50 {
            let (cool, warm) = (coolwarm(0.5 - f64::from(k) / 100.0), coolwarm(0.5 + f64::from(k) / 100.0));
            assert!(cool[2] > cool[0] && warm[0] > warm[2], "{k}: {cool:?} {warm:?}");
        }
    }
}
