//! Places at which a field of directions turns around: their indices sum to the Euler characteristic.

use super::{Directions, DirectionsError};
use crate::laplacian::{MeshDirections, TriangleTurns};
use crate::{Progress, parallel};
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
        Ok(self.singularities_of(&[channels], progress)?.remove(0))
    }

    /// [`singularities`](Self::singularities) of several fields, for little more than the time of one.
    ///
    /// # Errors
    /// As for [`singularities`](Self::singularities).
    pub fn singularities_of(
        &self,
        fields: &[&[f64]],
        progress: Progress<'_>,
    ) -> Result<Vec<Vec<Singularity>>, DirectionsError> {
        for channels in fields {
            self.check("directions", channels.len(), 2)?;
        }
        let geometry = self.decomposer().geometry().ok_or(DirectionsError::NoSurface)?;
        if !geometry.shape().is_mesh() {
            return Err(DirectionsError::NotOriented);
        }
        let (points, unit) = geometry.unit_points(progress)?;
        let (triangles, symmetry) = (geometry.triangles(), self.symmetry().order());
        let mesh = MeshDirections { points: &points, triangles, planes: &self.planes, symmetry };
        let around = mesh.triangle_turns(progress)?.ok_or(DirectionsError::NotOriented)?;
        let corners = |triangle: usize| triangles[triangle].map(|x| x as usize);
        let find = |channels: &&[f64]| {
            let welded = self.decomposer().vertex_map().try_mean(channels, 2, progress)?;
            let field: &[[f64; 2]] = welded.as_chunks().0;
            let index = |k: usize| index(corners(around[k].triangle).map(|x| field[x]), &around[k], symmetry);
            let indices = parallel::try_collect(around.len(), progress, index)?;
            let found = around.iter().zip(indices).filter(|(_, index)| *index != 0.0);
            let singularity = |(turns, index): (&TriangleTurns, f64)| {
                let corners = corners(turns.triangle);
                let center =
                    [0, 1, 2].map(|c| unit * corners.iter().map(|&x| points[x][c]).sum::<f64>() / 3.0);
                Singularity { triangle: turns.triangle, center, index }
            };
            Ok(found.map(singularity).collect())
        };
        fields.iter().map(find).collect()
    }
}

/// Number of turns of a field with these values at the corners of a triangle; 0 if one has no direction.
fn index(values: [[f64; 2]; 3], around: &TriangleTurns, symmetry: u32) -> f64 {
    let order = f64::from(symmetry);
    if !values.iter().all(|z| z[0].hypot(z[1]) > 0.0) {
        return 0.0;
    }
    let turned: f64 = (0..3)
        .map(|k| {
            let ([a, b], [c, d], [p, q]) = (values[k], values[(k + 1) % 3], around.turns[k]);
            let there = [c * p - d * q, c * q + d * p];
            (a * there[1] - b * there[0]).atan2(a * there[0] + b * there[1])
        })
        .sum();
    ((turned + order * around.curvature) / TAU).round() / order
}
