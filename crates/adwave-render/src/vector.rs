//! Directions in single precision: what shading needs. Positions are `adwave::vector`s.

/// A direction, as far as shading needs it.
pub(crate) type Direction = [f32; 3];

pub(crate) fn dot_f32(a: &Direction, b: &Direction) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a` of length 1, or straight at the viewer where it has no length.
pub(crate) fn facing_unit(a: &Direction) -> Direction {
    let length = dot_f32(a, a).sqrt();
    if length > 1e-12 { a.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
}
