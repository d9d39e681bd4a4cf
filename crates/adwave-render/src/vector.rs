//! The little of vectors that pictures need.

/// A vector of the model, as far as exactness matters.
pub(crate) type Vec3 = [f64; 3];

/// A direction, as far as shading needs it.
pub(crate) type Direction = [f32; 3];

pub(crate) fn sub(a: &Vec3, b: &Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: &Vec3, b: &Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: &Vec3, b: &Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + s b`.
pub(crate) fn add_scaled(a: &Vec3, s: f64, b: &Vec3) -> Vec3 {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// `a` of length 1; `None` where it has none.
pub(crate) fn unit(a: &Vec3) -> Option<Vec3> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| a.map(|c| c / length))
}

pub(crate) fn dot_f32(a: &Direction, b: &Direction) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a` of length 1, or straight at the viewer where it has no length.
pub(crate) fn facing_unit(a: &Direction) -> Direction {
    let length = dot_f32(a, a).sqrt();
    if length > 1e-12 { a.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
}
