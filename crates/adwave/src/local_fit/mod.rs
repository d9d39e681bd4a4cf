//! Smoothing that keeps slopes: bands about a local linear fit instead of a local mean.
//!
//! A mean over neighbors is biased wherever a field has a gradient and the neighbors lie unevenly: with the drift
//! `d_j = p − Φ_j p` of the positions p, a field `f = a·p + b` has `Φ_j f = f − a·d_j`. The drift is known, and a
//! local gradient a_j can be fitted, so the scaling coefficients become
//!
//! ```text
//! S_f(j) = Φ_j f + a_j·d_j,     W_f(j) = S_f(j−1) − S_f(j)
//! ```
//!
//! They are linear in f, sum to f, and leave every linear field unchanged, at borders and holes too. This is the step
//! from a local constant to a local linear fit (`fan1992`).
//!
//! * [`gradient`](self) fits the gradient along the edges of a walk.
//! * `wavelets` computes the bands.
//! * `part` computes them for a part of a shape.

mod gradient;
mod part;
mod wavelets;

pub use part::{HeightPart, HeightSeries};
pub(crate) use wavelets::LinearTransform;

use crate::named_values;
use serde::{Deserialize, Serialize};

/// Fields that smoothing reproduces exactly.
///
/// ```
/// use adwave::bands::Schedule;
/// use adwave::local_fit::LocalFit;
/// use adwave::shape::{PointCloud, Shape};
/// use adwave::Decomposer;
/// let uneven = |i: u32| [f64::from(i % 20) + 0.4 * f64::from(i * 7 % 5), f64::from(i / 20), 0.0];
/// let points: Vec<[f64; 3]> = (0..400).map(uneven).collect();
/// let slope: Vec<f64> = points.iter().map(|p| 0.5 * p[0] - p[1]).collect();
/// let (decomposer, schedule) = (Decomposer::new(&Shape::Cloud(PointCloud::new(points)?)), Schedule::dyadic(4)?);
/// let largest = |fit: LocalFit| -> Result<f64, adwave::bands::BandsError> {
///     let bands = decomposer.request(&slope, 1, &schedule).local_fit(fit).bands()?;
///     Ok(bands.wavelets().flatten().fold(0.0, |most, w| w.abs().max(most)))
/// };
/// assert!(largest(LocalFit::Constant)? > 0.1); // where the neighbors lie on one side
/// assert!(largest(LocalFit::Linear)? < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum LocalFit {
    /// Linear fields: a slope keeps its values however irregular the samples are. On a shape without positions this
    /// is [`Constant`](Self::Constant).
    Linear,
    /// Constant fields: the diffusion operator itself.
    Constant,
}

named_values!(LocalFit, "local fit", {
    Linear => "linear", "Slopes stay: a linear field is unchanged, however irregular the samples are";
    Constant => "constant", "The operator itself: a mean over the neighbors, which drags a slope to where they lie";
});

/// Positions that a field is fitted over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FitDomain {
    /// The tangent plane of a surface, or all of space for the points of a volume.
    Surface,
    /// The plane of the two other coordinates, for a field that is the coordinate with this index: heights.
    Plane {
        /// Index of the coordinate that is the field.
        height: usize,
    },
}

impl FitDomain {
    /// Domain of a field of one channel: the plane of the two other coordinates if it equals a coordinate of the
    /// positions at all vertices that are not masked.
    ///
    /// Fitting heights over positions that contain them would explain their noise by itself.
    pub(crate) fn from_field(field: &[f64], points: &[[f64; 3]], masked: Option<&[bool]>) -> Self {
        let is_height = |axis: &usize| {
            let values = field.iter().zip(points).enumerate();
            let mut known = values.filter(|(x, _)| masked.is_none_or(|masked| !masked[*x]));
            known.all(|(_, (f, p))| *f == p[*axis])
        };
        (0..3).find(is_height).map_or(Self::Surface, |height| Self::Plane { height })
    }

    /// Indices of the coordinates that the field is fitted over.
    fn axes(self) -> &'static [usize] {
        match self {
            Self::Surface => &[0, 1, 2],
            Self::Plane { height: 0 } => &[1, 2],
            Self::Plane { height: 1 } => &[0, 2],
            Self::Plane { .. } => &[0, 1],
        }
    }
}
