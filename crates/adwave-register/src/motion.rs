//! Similarity transforms and their least-squares fits.

use nalgebra::{Matrix3, Rotation3, Vector3};

/// Number of reweighting rounds of a robust fit.
const N_ROBUST_ROUNDS: usize = 10;
/// Distance at which the weight of a pair is 0, in multiples of the median distance.
const TUKEY: f64 = 6.0;

/// Similarity transform `p ↦ s·R·p + t`; a rigid motion if s = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    rotation: Rotation3<f64>,
    scale: f64,
    translation: Vector3<f64>,
}

/// Point with three orthonormal, right-handed axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PrincipalFrame {
    pub(crate) origin: [f64; 3],
    pub(crate) axes: [[f64; 3]; 3],
}

impl Default for Motion {
    fn default() -> Self {
        Self { rotation: Rotation3::identity(), scale: 1.0, translation: Vector3::zeros() }
    }
}

impl Motion {
    /// Creates a rigid motion from a rotation vector, whose length is the angle in radians, and a translation.
    pub fn new(axis_angle: [f64; 3], translation: [f64; 3]) -> Self {
        Self {
            rotation: Rotation3::new(Vector3::from(axis_angle)),
            scale: 1.0,
            translation: translation.into(),
        }
    }

    /// Appends a scaling by a factor.
    #[must_use]
    pub fn scaled_by(self, factor: f64) -> Self {
        Self { scale: factor * self.scale, translation: factor * self.translation, ..self }
    }

    /// Creates a rigid motion that takes an orthonormal, right-handed frame at a point to another one.
    pub(crate) fn from_frames(from: &PrincipalFrame, to: &PrincipalFrame) -> Self {
        let matrix = |frame: &PrincipalFrame| Matrix3::from_columns(&frame.axes.map(Vector3::from));
        let rotation = Rotation3::from_matrix_unchecked(matrix(to) * matrix(from).transpose());
        let translation = Vector3::from(to.origin) - rotation * Vector3::from(from.origin);
        Self { rotation, scale: 1.0, translation }
    }

    /// Fits the motion that takes the points `from` to `to` with the least weighted sum of squares, in O(pairs).
    ///
    /// Returns `None` for fewer than three pairs, and for pairs on one line, which do not determine the rotation. With
    /// `scaled` the scale is fitted too.
    ///
    /// Source: `umeyama1991`.
    ///
    /// ```
    /// use adwave_register::Motion;
    /// let from = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    /// let to = from.map(|[x, y, z]| [5.0 - y, x, z + 1.0]); // a quarter turn and a shift
    /// let motion = Motion::fit(&from, &to, &[1.0; 3], false).unwrap();
    /// assert!((motion.apply(&[1.0, 1.0, 1.0])[0] - 4.0).abs() < 1e-12);
    /// assert!((motion.degrees() - 90.0).abs() < 1e-9);
    /// ```
    pub fn fit(from: &[[f64; 3]], to: &[[f64; 3]], weights: &[f64], scaled: bool) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        if from.len() < 3 || !(total.is_finite() && total > 0.0) {
            return None;
        }
        let mean = |points: &[[f64; 3]]| {
            let sum = |sum: Vector3<f64>, (p, w): (&[f64; 3], &f64)| sum + *w * Vector3::from(*p);
            points.iter().zip(weights).fold(Vector3::zeros(), sum) / total
        };
        let (from_mean, to_mean) = (mean(from), mean(to));
        let (mut covariance, mut spread) = (Matrix3::zeros(), 0.0);
        for ((p, q), w) in from.iter().zip(to).zip(weights) {
            let (p, q) = (Vector3::from(*p) - from_mean, Vector3::from(*q) - to_mean);
            covariance += *w * q * p.transpose();
            spread += w * p.norm_squared();
        }
        let svd = covariance.try_svd(true, true, f64::EPSILON, 100)?;
        let (u, v_t) = (svd.u?, svd.v_t?);
        let values = svd.singular_values;
        // All points on a line: the rotation about it is undetermined.
        if values[1].is_nan() || values[1] <= 1e-12 * values[0] {
            return None;
        }
        let flip = if (u * v_t).determinant() < 0.0 { -1.0 } else { 1.0 };
        let signs = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, flip));
        let rotation = Rotation3::from_matrix_unchecked(u * signs * v_t);
        let scale = if scaled { (values[0] + values[1] + flip * values[2]) / spread } else { 1.0 };
        Some(Self { rotation, scale, translation: to_mean - scale * (rotation * from_mean) })
    }

    /// Fits a rigid motion robustly: repeats [`fit`](Self::fit) in ten rounds, with Tukey's weights of the distances
    /// relative to their median, times `areas`. Points that moved differently from most are ignored.
    pub fn fit_robust(from: &[[f64; 3]], to: &[[f64; 3]], areas: &[f64]) -> Option<Self> {
        let mut motion = Self::fit(from, to, areas, false)?;
        for _ in 0..N_ROBUST_ROUNDS {
            let distance =
                |(p, q): (&[f64; 3], &[f64; 3])| (Vector3::from(motion.apply(p)) - Vector3::from(*q)).norm();
            let distances: Vec<f64> = from.iter().zip(to).map(distance).collect();
            let middle = distances.len() / 2;
            let median = *distances.clone().select_nth_unstable_by(middle, f64::total_cmp).1;
            let weight =
                |(d, area): (&f64, &f64)| area * (1.0 - (d / (TUKEY * median)).powi(2)).max(0.0).powi(2);
            if median <= 0.0 {
                break;
            }
            let weights: Vec<f64> = distances.iter().zip(areas).map(weight).collect();
            let Some(next) = Self::fit(from, to, &weights, false) else { break };
            motion = next;
        }
        Some(motion)
    }

    /// Transforms a point.
    pub fn apply(&self, point: &[f64; 3]) -> [f64; 3] {
        (self.scale * (self.rotation * Vector3::from(*point)) + self.translation).into()
    }

    /// Rotates a direction; its length is preserved.
    pub fn turn(&self, direction: &[f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(*direction)).into()
    }

    /// Composes two motions: first `self`, then `after`.
    #[must_use]
    pub fn then(&self, after: &Self) -> Self {
        Self {
            rotation: after.rotation * self.rotation,
            scale: after.scale * self.scale,
            translation: after.scale * (after.rotation * self.translation) + after.translation,
        }
    }

    /// Returns the inverse motion.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let (rotation, scale) = (self.rotation.inverse(), 1.0 / self.scale);
        Self { rotation, scale, translation: -(scale * (rotation * self.translation)) }
    }

    /// Scale factor s.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Rotation angle in degrees, in [0, 180].
    pub fn degrees(&self) -> f64 {
        let m = self.rotation.matrix();
        let axis = [m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]];
        // The arc cosine of the trace has no digits near 0, and is not a number if rounding takes it above 1.
        adwave::vector::norm(&axis).atan2(m.trace() - 1.0).to_degrees()
    }

    /// Root mean square distance between the images of `points` under two motions.
    pub fn difference(&self, other: &Self, points: &[[f64; 3]]) -> f64 {
        let square = |p: &[f64; 3]| {
            adwave::vector::norm(&adwave::vector::subtract(&self.apply(p), &other.apply(p))).powi(2)
        };
        (points.iter().map(square).sum::<f64>() / points.len().max(1) as f64).sqrt()
    }

    /// Translation t, the image of the origin.
    pub fn translation(&self) -> [f64; 3] {
        self.translation.into()
    }

    /// Homogeneous matrix, row by row.
    pub fn matrix(&self) -> [[f64; 4]; 4] {
        let m = self.rotation.matrix();
        std::array::from_fn(|i| {
            std::array::from_fn(|j| match (i, j) {
                (3, 3) => 1.0,
                (3, _) => 0.0,
                (i, 3) => self.translation[i],
                (i, j) => self.scale * m[(i, j)],
            })
        })
    }
}
