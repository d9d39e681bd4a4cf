//! Light: how bright a surface is by the direction it faces.

use crate::vector::{Direction, dot_f32, facing_unit};

/// A light at infinity, in the viewer's axes: right, up, toward the viewer.
struct Light {
    toward: Direction,
    color: [f32; 3],
}

/// The main light comes over the viewer's left shoulder, high enough that relief throws shade.
const KEY: Light = Light { toward: [-0.51, 0.62, 0.596], color: [1.02, 0.99, 0.94] };
/// A weak, cool one from the right lifts the shaded side.
const FILL: Light = Light { toward: [0.82, 0.05, 0.57], color: [0.12, 0.135, 0.16] };
/// One from behind draws a fine bright line along the outline.
const RIM: Light = Light { toward: [0.42, 0.42, -0.805], color: [0.45, 0.46, 0.48] };
/// From everywhere: from above and from below.
const SKY: [f32; 3] = [0.19, 0.20, 0.22];
const GROUND: [f32; 3] = [0.07, 0.066, 0.062];

/// How much of the key light wraps past the terminator, which softens it as a large lamp would.
const WRAP: f32 = 0.06;

/// How strongly and how narrowly a surface reflects the key light.
#[derive(Clone, Copy)]
pub(crate) struct Gloss {
    pub(crate) strength: f32,
    pub(crate) exponent: i32,
}

/// What shows relief best.
pub(crate) const CLAY: Gloss = Gloss { strength: 0.09, exponent: 20 };
/// Colors that mean something are not whitened.
pub(crate) const MATTE: Gloss = Gloss { strength: 0.02, exponent: 20 };
/// Balls.
pub(crate) const GLOSSY: Gloss = Gloss { strength: 0.22, exponent: 40 };

/// The light that a surface of this color (linear) with this normal sends to the viewer, linear.
pub(crate) fn lit(normal: Direction, color: [f32; 3], gloss: Gloss) -> [f32; 3] {
    // Interpolated normals may point away at the outline.
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

/// From a byte of sRGB to linear light, IEC 61966-2-1.
pub(crate) fn to_linear(color: [u8; 3]) -> [f32; 3] {
    color.map(|c| {
        let c = f32::from(c) / 255.0;
        if c > 0.040_45 { ((c + 0.055) / 1.055).powf(2.4) } else { c / 12.92 }
    })
}

/// From linear light to a byte of sRGB; what is brighter than white bends softly into it.
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

/// From linear light in [0, 1] to a byte of sRGB.
pub(crate) fn to_byte_exact(light: f32) -> u8 {
    let c = if light > 0.003_130_8 { 1.055 * light.powf(1.0 / 2.4) - 0.055 } else { 12.92 * light };
    (c.clamp(0.0, 1.0) * 255.0).round() as u8
}
