//! Places at which a field of directions turns around: their indices sum to the Euler characteristic.

use super::{Directions, DirectionsError};
use crate::Progress;
use crate::laplacian::{MeshDirections, TriangleTurns};
use std::f64::consts::TAU;

/// A triangle around which a field of directions turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Singularity {
    /// Number of the triangle among those of the prepared mesh; a polygon counts as its triangles.
    pub triangle: usize,
    /// Center of the triangle, in model units.
    pub center: [f64; 3],
    /// Number of turns of the field around the triangle, a multiple of 1/s.
    pub index: f64,
}

impl Directions {
    /// Singularities of a field of complex numbers in the tangent planes (n_vertices × 2, in the order of the shape).
    /// O(triangles).
    ///
    /// The index of a triangle is `(Σ δ + sΩ)/2πs`, with the smallest turns δ of the field along its sides, and the angle
    /// Ω by which the triangle turns whatever is carried around it. On a closed surface the indices sum to its Euler
    /// characteristic (Poincaré and Hopf), if the field is nowhere 0. A triangle with a corner where the field is 0 or
    /// NaN has none.
    ///
    /// # Errors
    /// [`DirectionsError::Length`] unless there are two values for each vertex, [`DirectionsError::NotOriented`] unless
    /// the mesh is an oriented surface.
    pub fn singularities(
        &self,
        channels: &[f64],
        progress: Progress<'_>,
    ) -> Result<Vec<Singularity>, DirectionsError> {
        self.check("directions", channels.len(), 2)?;
        let geometry = self.decomposer().geometry().ok_or(DirectionsError::NoSurface)?;
        if !geometry.shape().is_mesh() {
            return Err(DirectionsError::NotOriented);
        }
        let welded = self.decomposer().vertex_map().mean(channels, 2);
        let field: &[[f64; 2]] = welded.as_chunks().0;
        let (points, unit) = geometry.unit_points(progress)?;
        let (triangles, symmetry) = (geometry.triangles(), self.symmetry().order());
        let mesh = MeshDirections { points: &points, triangles, planes: &self.planes, symmetry };
        let around = mesh.triangle_turns(progress)?.ok_or(DirectionsError::NotOriented)?;
        let order = f64::from(symmetry);
        let mut found = Vec::new();
        for TriangleTurns { triangle, curvature, turns } in around {
            let corners = triangles[triangle].map(|x| x as usize);
            let values = corners.map(|x| field[x]);
            let has_direction = |z: &[f64; 2]| z[0].hypot(z[1]) > 0.0;
            if !values.iter().all(has_direction) {
                continue;
            }
            let turned: f64 = (0..3)
                .map(|k| {
                    let ([a, b], [c, d], [p, q]) = (values[k], values[(k + 1) % 3], turns[k]);
                    let there = [c * p - d * q, c * q + d * p];
                    (a * there[1] - b * there[0]).atan2(a * there[0] + b * there[1])
                })
                .sum();
            let turns_of_field = ((turned + order * curvature) / TAU).round();
            if turns_of_field != 0.0 {
                let center =
                    [0, 1, 2].map(|c| unit * corners.iter().map(|&x| points[x][c]).sum::<f64>() / 3.0);
                found.push(Singularity { triangle, center, index: turns_of_field / order });
            }
        }
        Ok(found)
    }
}
