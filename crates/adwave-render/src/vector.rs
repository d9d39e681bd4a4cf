//! Directions in single precision, for shading. Positions have the type `adwave::vector::Vector`.

/// Direction in single precision.
pub(crate) type Direction = [f32; 3];

pub(crate) fn dot_f32(a: &Direction, b: &Direction) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Direction `a` scaled to length 1, or the direction toward the viewer if `a` has no length.
pub(crate) fn facing_unit(a: &Direction) -> Direction {
    let length = dot_f32(a, a).sqrt();
    if length > 1e-12 { a.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
}
