//! Quadric error: weighted squared distances from planes.

use crate::geometry::{Point, cross, dot, length, minus};

/// Quadratic function `x ↦ Σ w (n·x + d)²` over planes (`garland1997`), and the sum of the weights.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quadric {
    /// Upper triangle of `Σ w n nᵀ`: xx, yy, zz, xy, xz, yz.
    square: [f64; 6],
    /// `Σ w d n`.
    linear: Point,
    /// `Σ w d²`.
    constant: f64,
    weight: f64,
}

/// Weight of the constraint planes on borders and seams, relative to faces.
const EDGE_WEIGHT: f64 = 10.0;

impl Quadric {
    fn plane(n: Point, origin: Point, w: f64) -> Self {
        let d = -dot(n, origin);
        Self {
            square: [n[0] * n[0], n[1] * n[1], n[2] * n[2], n[0] * n[1], n[0] * n[2], n[1] * n[2]]
                .map(|x| w * x),
            linear: n.map(|x| w * d * x),
            constant: w * d * d,
            weight: w,
        }
    }

    /// Quadric of the plane of a triangle, weighted by its doubled area.
    pub(crate) fn triangle([a, b, c]: [Point; 3]) -> Self {
        let normal = cross(minus(b, a), minus(c, a));
        let area = length(normal);
        Self::plane(normal.map(|x| x / area.max(f64::MIN_POSITIVE)), a, area)
    }

    /// Quadric of the plane through the edge `ab` of a triangle perpendicular to it, weighted by the squared length.
    pub(crate) fn edge([a, b, c]: [Point; 3]) -> Self {
        let along = minus(b, a);
        let squared = dot(along, along);
        let to = minus(c, a);
        let t = dot(to, along) / squared.max(f64::MIN_POSITIVE);
        let across: Point = std::array::from_fn(|k| to[k] - t * along[k]);
        let norm = length(across);
        if norm > 0.0 {
            Self::plane(across.map(|x| x / norm), a, EDGE_WEIGHT * squared)
        } else {
            Self::default()
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        for (x, y) in self.square.iter_mut().zip(&other.square) {
            *x += y;
        }
        for (x, y) in self.linear.iter_mut().zip(&other.linear) {
            *x += y;
        }
        self.constant += other.constant;
        self.weight += other.weight;
    }

    /// Multiplies squared distances by a factor.
    pub(crate) fn multiply(self, factor: f64) -> Self {
        Self {
            square: self.square.map(|x| factor * x),
            linear: self.linear.map(|x| factor * x),
            constant: factor * self.constant,
            weight: self.weight,
        }
    }

    /// Mean squared distance of a point from the planes.
    pub(crate) fn mean(&self, p: Point) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = self.square;
        let [x, y, z] = p;
        let square = xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z);
        let sum = square + 2.0 * dot(self.linear, p) + self.constant;
        if self.weight > 0.0 { (sum / self.weight).max(0.0) } else { 0.0 }
    }
}
