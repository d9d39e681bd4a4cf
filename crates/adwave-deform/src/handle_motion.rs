//! Motions of handles: affine maps that keep the orientation.

use crate::DeformError;
use crate::rotation::{
    IDENTITY, Matrix, determinant, exponential, image, logarithm, nearest_rotation, product, to_matrix,
    transpose,
};
use adwave::vector::{Vector, norm};

/// Largest entry of `LᵀL − I` of a linear part that counts as a rotation.
const RIGID: f64 = 1e-9;

/// Affine map `p ↦ L·p + t` of a handle, in model units. Its determinant is positive: handles are not mirrored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandleMotion {
    linear: Matrix,
    translation: Vector,
}

impl Default for HandleMotion {
    fn default() -> Self {
        Self { linear: IDENTITY, translation: [0.0; 3] }
    }
}

impl HandleMotion {
    /// Translation by a vector in model units.
    pub fn from_translation(by: Vector) -> Self {
        Self { translation: by, ..Self::default() }
    }

    /// Rotation about `axis`, of any length except 0, through `center`, by an angle in radians, counterclockwise seen
    /// against the axis.
    ///
    /// ```
    /// use adwave_deform::HandleMotion;
    /// let turn = HandleMotion::from_turn([0.0, 0.0, 2.0], std::f64::consts::FRAC_PI_2, [1.0, 0.0, 0.0])?;
    /// let p = turn.apply(&[2.0, 0.0, 0.0]);
    /// assert!((p[0] - 1.0).abs() < 1e-15 && (p[1] - 1.0).abs() < 1e-15);
    /// # Ok::<(), adwave_deform::DeformError>(())
    /// ```
    ///
    /// # Errors
    /// [`DeformError::BadAxis`] if the axis has no direction, [`DeformError::BadMotion`] if a number is not finite.
    pub fn from_turn(axis: Vector, angle: f64, center: Vector) -> Result<Self, DeformError> {
        let length = norm(&axis);
        if !(length > 0.0 && length.is_finite()) {
            return Err(DeformError::BadAxis(axis));
        }
        let linear = to_matrix(&exponential(&axis.map(|c| c / length * angle)));
        let moved = image(&linear, &center);
        Self::new(linear, [0, 1, 2].map(|c| center[c] - moved[c]))
    }

    /// Map `p ↦ linear·p + translation`, with the rows of the matrix.
    ///
    /// # Errors
    /// [`DeformError::BadMotion`] if a number is not finite, [`DeformError::Mirrored`] if the determinant is not
    /// positive.
    pub fn new(linear: [[f64; 3]; 3], translation: Vector) -> Result<Self, DeformError> {
        let numbers = || linear.as_flattened().iter().chain(&translation);
        if let Some(&value) = numbers().find(|c| !c.is_finite()) {
            return Err(DeformError::BadMotion(value));
        }
        let det = determinant(&linear);
        if !(det > 0.0 && det.is_finite()) {
            return Err(DeformError::Mirrored(det));
        }
        Ok(Self { linear, translation })
    }

    /// Map of a 4 × 4 matrix by rows, whose last row is 0 0 0 1.
    ///
    /// # Errors
    /// As for [`new`](Self::new), and [`DeformError::NotAffine`] for another last row.
    pub fn from_matrix(matrix: &[[f64; 4]; 4]) -> Result<Self, DeformError> {
        if matrix[3] != [0.0, 0.0, 0.0, 1.0] {
            return Err(DeformError::NotAffine(matrix[3]));
        }
        let row = |i: usize| [matrix[i][0], matrix[i][1], matrix[i][2]];
        Self::new([row(0), row(1), row(2)], [0, 1, 2].map(|i| matrix[i][3]))
    }

    /// Blend `I + Σ_i t_i (motion i − I)` of motions of one handle, in which rotations turn on the way: with
    /// `L_i = R_i S_i`, `L = exp(Σ t_i log R_i) (I + Σ t_i (S_i − I))`, and the center moves by the blended vector. Rotations
    /// of more than 180° are taken the shorter way. `center` is a point of the handle, in model units.
    ///
    /// ```
    /// use adwave_deform::HandleMotion;
    /// let (axis, center) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    /// let (a, b) = (HandleMotion::from_turn(axis, 0.4, center)?, HandleMotion::from_turn(axis, 1.6, center)?);
    /// let blend = HandleMotion::blend(&[a, b], &[0.5, 0.25], center)?;
    /// let (found, expected) = (blend.apply(&[3.0, 0.0, 0.0]), HandleMotion::from_turn(axis, 0.6, center)?.apply(&[3.0, 0.0, 0.0]));
    /// assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-12));
    /// # Ok::<(), adwave_deform::DeformError>(())
    /// ```
    ///
    /// # Errors
    /// [`DeformError::BadShare`] for another number of shares; [`new`](Self::new)'s errors.
    pub fn blend(motions: &[Self], shares: &[f64], center: Vector) -> Result<Self, DeformError> {
        if motions.len() != shares.len() {
            let (expected, found) = (motions.len(), shares.len());
            return Err(DeformError::BadShare(format!(
                "a blend needs a share for each motion, {expected} in all, got {found}"
            )));
        }
        let (mut turn, mut stretch, mut moved) = ([0.0; 3], IDENTITY, center);
        for (motion, &share) in motions.iter().zip(shares) {
            let quaternion = motion.rotation();
            let vector = logarithm(&quaternion);
            let own = product(&transpose(&to_matrix(&quaternion)), &motion.linear);
            let image = motion.apply(&center);
            for i in 0..3 {
                turn[i] += share * vector[i];
                moved[i] += share * (image[i] - center[i]);
                for j in 0..3 {
                    stretch[i][j] += share * (own[i][j] - IDENTITY[i][j]);
                }
            }
        }
        let linear = product(&to_matrix(&exponential(&turn)), &stretch);
        let turned = image(&linear, &center);
        Self::new(linear, [0, 1, 2].map(|c| moved[c] - turned[c]))
    }

    /// Image of a point.
    pub fn apply(&self, p: &Vector) -> Vector {
        let moved = image(&self.linear, p);
        [0, 1, 2].map(|c| moved[c] + self.translation[c])
    }

    /// Linear part L, by rows.
    pub fn linear(&self) -> &[[f64; 3]; 3] {
        &self.linear
    }

    /// Translation t in model units.
    pub fn translation(&self) -> &Vector {
        &self.translation
    }

    /// True if L is a rotation, up to rounding.
    pub fn is_rigid(&self) -> bool {
        let gram = product(&transpose(&self.linear), &self.linear);
        gram.as_flattened().iter().zip(IDENTITY.as_flattened()).all(|(a, b)| (a - b).abs() <= RIGID)
    }

    /// Rotation nearest to L, as a unit quaternion `w, x, y, z`.
    pub(crate) fn rotation(&self) -> [f64; 4] {
        nearest_rotation(&self.linear)
    }

    /// The map with its lengths divided by `unit`.
    pub(crate) fn in_unit(&self, unit: f64) -> Self {
        Self { linear: self.linear, translation: self.translation.map(|c| c / unit) }
    }

    /// This map after the inverse of a rigid map.
    pub(crate) fn relative_to(&self, rigid: &Self) -> Self {
        let back = transpose(&rigid.linear);
        let offset = [0, 1, 2].map(|c| self.translation[c] - rigid.translation[c]);
        Self { linear: product(&back, &self.linear), translation: image(&back, &offset) }
    }
}
