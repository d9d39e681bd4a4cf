//! Vectors of three coordinates.

use crate::named_values;

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The first coordinate.
    X,
    /// The second coordinate.
    Y,
    /// The third coordinate.
    Z,
}

named_values!(Axis, "axis", {
    X => "x", "";
    Y => "y", "";
    Z => "z", "";
});

impl Axis {
    /// Index of the coordinate, from 0.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// A point or a direction.
pub type Vector = [f64; 3];

/// Difference `a − b`.
pub fn subtract(a: &Vector, b: &Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Dot product `a · b`.
pub fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Cross product `a × b`.
///
/// ```
/// assert_eq!(adwave::vector::cross(&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
/// ```
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Euclidean norm `|a|`.
pub fn norm(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Sum `a + s b`.
pub fn add_scaled(a: &Vector, s: f64, b: &Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// Unit vector in the direction of `a`; `None` if `a` has no direction.
pub fn unit(a: &Vector) -> Option<Vector> {
    let length = norm(a);
    (length > 0.0 && length.is_finite()).then(|| a.map(|c| c / length))
}
