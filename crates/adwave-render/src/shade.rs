//! Lighting: brightness of a surface as a function of its normal.

use crate::vector::{Direction, dot_f32, facing_unit};

/// Light at infinity, in the viewer's axes: right, up, toward the viewer.
struct Light {
    toward: Direction,
    color: [f32; 3],
}

/// Main light over the viewer's left shoulder, high enough to shade relief.
const KEY: Light = Light { toward: [-0.51, 0.62, 0.596], color: [1.02, 0.99, 0.94] };
/// Weak, cool light from the right that brightens the shaded side.
const FILL: Light = Light { toward: [0.82, 0.05, 0.57], color: [0.12, 0.135, 0.16] };
/// Light from behind that draws a thin bright line along the outline.
const RIM: Light = Light { toward: [0.42, 0.42, -0.805], color: [0.45, 0.46, 0.48] };
/// Ambient light from above; that from below is `GROUND`.
const SKY: [f32; 3] = [0.19, 0.20, 0.22];
const GROUND: [f32; 3] = [0.07, 0.066, 0.062];

/// Amount by which the key light extends past the terminator, which softens the terminator like a large lamp.
const WRAP: f32 = 0.06;

/// Strength and exponent of the reflection of the key light.
#[derive(Clone, Copy)]
pub(crate) struct Gloss {
    pub(crate) strength: f32,
    pub(crate) exponent: i32,
}

/// Gloss of plain surfaces, which shows relief best.
pub(crate) const CLAY: Gloss = Gloss { strength: 0.09, exponent: 20 };
/// Gloss for colors that encode values; it does not whiten them.
pub(crate) const MATTE: Gloss = Gloss { strength: 0.02, exponent: 20 };
/// Gloss of balls.
pub(crate) const GLOSSY: Gloss = Gloss { strength: 0.22, exponent: 40 };

/// Linear light that a surface with a normal and a linear color sends to the viewer.
pub(crate) fn reflect(normal: Direction, color: [f32; 3], gloss: Gloss) -> [f32; 3] {
    // Interpolated normals may point away from the viewer at the outline.
    let n = facing_unit(&[normal[0], normal[1], normal[2].max(0.02)]);
    let key = ((dot_f32(&n, &KEY.toward) + WRAP) / (1.0 + WRAP)).max(0.0);
    let fill = dot_f32(&n, &FILL.toward).max(0.0);
    let rim = dot_f32(&n, &RIM.toward).max(0.0);
    let sky = 0.5 + 0.5 * n[1];
    let half = facing_unit(&[KEY.toward[0], KEY.toward[1], KEY.toward[2] + 1.0]);
    let shine = gloss.strength * dot_f32(&n, &half).max(0.0).powi(gloss.exponent);
    [0, 1, 2].map(|c| {
        let ambient = GROUND[c] + sky * (SKY[c] - GROUND[c]);
        let light = ambient + key * KEY.color[c] + fill * FILL.color[c] + rim * RIM.color[c];
        color[c] * light + shine
    })
}

/// Converts a color from bytes of sRGB to linear light (IEC 61966-2-1).
pub(crate) fn to_linear(color: [u8; 3]) -> [f32; 3] {
    color.map(|c| {
        let c = f32::from(c) / 255.0;
        if c > 0.040_45 { ((c + 0.055) / 1.055).powf(2.4) } else { c / 12.92 }
    })
}

/// Converts linear light to a byte of sRGB; light brighter than white is compressed smoothly.
pub(crate) fn to_byte(light: f32) -> u8 {
    const SHOULDER: f32 = 0.8;
    let light = if light > SHOULDER {
        let room = 1.0 - SHOULDER;
        SHOULDER + room * (1.0 - (-(light - SHOULDER) / room).exp())
    } else {
        light.max(0.0)
    };
    to_byte_exact(light)
}

/// Converts linear light in [0, 1] to a byte of sRGB.
pub(crate) fn to_byte_exact(light: f32) -> u8 {
    let c = if light > 0.003_130_8 { 1.055 * light.powf(1.0 / 2.4) - 0.055 } else { 12.92 * light };
    (c.clamp(0.0, 1.0) * 255.0).round() as u8
}
