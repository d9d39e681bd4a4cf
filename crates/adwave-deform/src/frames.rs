//! Rotations between the neighborhoods of a vertex on two bases.

use crate::rotation::{Matrix, NO_TURN, add_outer, image, nearest_rotation, to_matrix};
use adwave::vector::{Vector, dot};

/// A rotation about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    quaternion: [f64; 4],
    matrix: Matrix,
}

impl Turn {
    pub(crate) fn from_quaternion(quaternion: [f64; 4]) -> Self {
        Self { quaternion, matrix: to_matrix(&quaternion) }
    }

    /// Unit quaternion `w, x, y, z`.
    pub fn quaternion(&self) -> [f64; 4] {
        self.quaternion
    }

    /// Image of a vector.
    pub fn apply(&self, v: &Vector) -> Vector {
        image(&self.matrix, v)
    }
}

/// Rotation R with the least `Σ |e′ − R e|²/|e|²` over pairs of edges e, e′ (`horn1987`): that of a neighborhood
/// between two bases. Equal edges, or none, give exactly no rotation.
pub fn nearest_turn(edges: impl Iterator<Item = (Vector, Vector)>) -> Turn {
    let (mut m, mut is_equal) = ([[0.0; 3]; 3], true);
    for (e, f) in edges {
        is_equal &= e == f;
        let squared = dot(&e, &e);
        if squared > 0.0 && squared.is_finite() {
            add_outer(&mut m, 1.0 / squared, &f, &e);
        }
    }
    Turn::from_quaternion(if is_equal { NO_TURN } else { nearest_rotation(&m) })
}
