//! Colors and texture coordinates at wedges, and the change of them by a simplification.

use crate::appearance::AppearanceValues;
use crate::geometry::{length, minus};
use crate::wedges::Wedges;

/// Difference between values that is not regarded as a change, relative to the full range: four steps of 8 bits.
const VALUE_TOLERANCE: f64 = 1.0 / 64.0;

/// Values at wedges, and the largest rates at which they change.
pub(crate) struct WedgeColors {
    n_channels: usize,
    values: Vec<f64>,
    /// Largest change per length along the edges at each wedge, with lengths in the unit box.
    slope: Vec<f64>,
}

impl WedgeColors {
    /// Copies the values of one corner of each wedge.
    pub(crate) fn new(wedges: &Wedges, corner_values: AppearanceValues<'_>) -> Self {
        let n_channels = corner_values.n_channels;
        let mut values = vec![0.0; wedges.points.len() * n_channels];
        for (triangle, corners) in wedges.triangles.iter().zip(&wedges.corners) {
            for (&wedge, &corner) in triangle.iter().zip(corners) {
                let row = &corner_values.values[corner as usize * n_channels..][..n_channels];
                values[wedge as usize * n_channels..][..n_channels].copy_from_slice(row);
            }
        }
        let mut colors = Self { n_channels, values, slope: vec![0.0; wedges.points.len()] };
        for &[a, b, c] in &wedges.triangles {
            for (x, y) in [(a, b), (b, c), (c, a)] {
                let distance = length(minus(wedges.points[x as usize], wedges.points[y as usize]));
                let change = colors.difference(x, [y; 3], [1.0, 0.0, 0.0]);
                let slope = change / distance.max(f64::MIN_POSITIVE);
                for wedge in [x, y] {
                    let greatest = &mut colors.slope[wedge as usize];
                    *greatest = greatest.max(slope);
                }
            }
        }
        colors
    }

    /// The values of some wedges, in their order.
    pub(crate) fn select(&self, wedges: &[u32]) -> Self {
        Self {
            n_channels: self.n_channels,
            values: wedges.iter().flat_map(|&wedge| self.row(wedge)).copied().collect(),
            slope: wedges.iter().map(|&wedge| self.slope[wedge as usize]).collect(),
        }
    }

    fn row(&self, wedge: u32) -> &[f64] {
        &self.values[wedge as usize * self.n_channels..][..self.n_channels]
    }

    /// Largest difference over the channels between the value of a wedge and that of a point of a face, given by
    /// barycentric weights.
    pub(crate) fn difference(&self, wedge: u32, face: [u32; 3], weights: [f64; 3]) -> f64 {
        let [a, b, c] = face.map(|corner| self.row(corner));
        let interpolate = |k: usize| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k];
        self.row(wedge).iter().enumerate().map(|(k, x)| (x - interpolate(k)).abs()).fold(0.0, f64::max)
    }

    /// True if the value at a point of a face occurs on the original within `limit` of a wedge: the difference is at
    /// most the largest change along an edge of this length, plus a tolerance that is too small to be seen.
    pub(crate) fn is_kept(&self, wedge: u32, face: [u32; 3], weights: [f64; 3], limit: f64) -> bool {
        self.difference(wedge, face, weights) <= VALUE_TOLERANCE + limit * self.slope[wedge as usize]
    }
}
