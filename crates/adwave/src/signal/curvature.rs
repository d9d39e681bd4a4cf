//! Mean and Gaussian curvature, and derived quantities.

use std::f64::consts::FRAC_2_PI;

/// Curvatures at each vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Curvature {
    /// Mean curvature H = (κ₁ + κ₂)/2 in 1/length; positive on a sphere with outward normals.
    pub mean: Vec<f64>,
    /// Gaussian curvature K = κ₁·κ₂ in 1/length².
    pub gaussian: Vec<f64>,
}

impl Curvature {
    /// Koenderink's shape index `2/π·atan(H / √(H² − K))` in [−1, 1]: 1 on a bump, ½ on a ridge, 0 on a saddle, −½
    /// in a rut, −1 in a pit. It is also 0 where the surface is flat: its curvedness `√(κ₁² + κ₂²)` is at most
    /// `flat`, in 1/length. If K > H², which no smooth surface has, it is 1 or −1 by the sign of H.
    ///
    /// Source: `koenderink1992`, with the sign reversed so that bumps are positive.
    ///
    /// ```
    /// use adwave::signal::Curvature;
    /// let curvature = Curvature { mean: vec![2.0, 1.0, 0.0, -2.0, 0.0], gaussian: vec![4.0, 0.0, -1.0, 4.0, 0.0] };
    /// assert_eq!(curvature.shape_index(0.0), [1.0, 0.5, 0.0, -1.0, 0.0]);
    /// ```
    pub fn shape_index(&self, flat: f64) -> Vec<f64> {
        let index = |(&h, &k): (&f64, &f64)| {
            // H² ≥ K on a smooth surface; meshes violate it, most at the sharpest tips. There κ₁ = κ₂ = H is used.
            let spread = (h * h - k).max(0.0).sqrt();
            // κ₁² + κ₂² = 2H² + 2(H² − K)
            if std::f64::consts::SQRT_2 * h.hypot(spread) <= flat {
                return 0.0;
            }
            FRAC_2_PI * h.atan2(spread)
        };
        crate::parallel::collect(self.mean.len().min(self.gaussian.len()), |x| {
            index((&self.mean[x], &self.gaussian[x]))
        })
    }
}
