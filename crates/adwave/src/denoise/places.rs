//! Kinds of places of a surface: those where it bends little, more and most, with soft limits between them.

use super::noise_level::{point_normals, quantile};
use super::surface::NoisySurface;
use crate::vector::dot;
use crate::{Cancelled, Progress, parallel};
use serde::{Deserialize, Serialize};

/// Number of kinds of places.
pub(super) const KINDS: usize = 3;

/// Number of lazy steps that smooth a surface for the normals whose turns are compared.
const STEPS_BEFORE: usize = 2;

/// Number of means over a vertex and its neighbors of how much the surface bends.
const WINDOW: usize = 8;

/// Least turn `1 − n·m` between normals n, m, which keeps logarithms finite.
const LEAST_TURN: f64 = 1e-12;

/// Kinds of places of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PlaceKinds {
    /// Logarithms of the turns at which a place is of one kind alone, ascending.
    centers: [f64; KINDS],
}

impl PlaceKinds {
    /// Kinds of which each holds about a third of the points. O(points).
    pub(super) fn new(
        surface: &NoisySurface,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let mut turns = surface.log_turns(points, progress)?;
        let center = |kind: usize| (2 * kind + 1) as f64 / (2 * KINDS) as f64;
        Ok(Self { centers: std::array::from_fn(|kind| quantile(&mut turns, center(kind))) })
    }

    /// Shares of the kinds at each site, ≥ 0 with sum 1: the means over its three corners. O(points).
    pub(super) fn shares(
        &self,
        surface: &NoisySurface,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; KINDS]>, Cancelled> {
        let turns = surface.log_turns(points, progress)?;
        parallel::try_collect(surface.n_sites(), progress, |t| {
            let [a, b, c] = surface.triangles[t].map(|v| self.shares_at(turns[v as usize]));
            std::array::from_fn(|kind| (a[kind] + b[kind] + c[kind]) / 3.0)
        })
    }

    fn shares_at(&self, turn: f64) -> [f64; KINDS] {
        let mut shares = [0.0; KINDS];
        let above = self.centers.partition_point(|center| *center <= turn);
        if above == 0 {
            shares[0] = 1.0;
        } else if above == KINDS {
            shares[KINDS - 1] = 1.0;
        } else {
            let [low, high] = [self.centers[above - 1], self.centers[above]];
            shares[above] = (turn - low) / (high - low);
            shares[above - 1] = 1.0 - shares[above];
        }
        shares
    }
}

impl NoisySurface {
    /// Logarithms of the turns between the normals of neighboring points of the smoothed surface, averaged over some
    /// rings.
    fn log_turns(&self, points: &[[f64; 3]], progress: Progress<'_>) -> Result<Vec<f64>, Cancelled> {
        let smooth = self.smoothed(points, STEPS_BEFORE, progress)?;
        let normals = point_normals(self, &smooth, progress)?;
        let mut turns = parallel::try_collect(points.len(), progress, |x| {
            let near = self.ring.row(x);
            let turn = |&y: &u32| 1.0 - dot(&normals[x], &normals[y as usize]);
            near.iter().map(turn).sum::<f64>() / near.len().max(1) as f64
        })?;
        for _ in 0..WINDOW {
            turns = self.means(&turns, progress)?;
        }
        Ok(turns.into_iter().map(|turn| (turn.max(0.0) + LEAST_TURN).ln()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_the_nearest_centers() {
        let kinds = PlaceKinds { centers: [-4.0, -2.0, 1.0] };
        for (turn, expected) in [
            (-9.0, [1.0, 0.0, 0.0]),
            (-4.0, [1.0, 0.0, 0.0]),
            (-3.0, [0.5, 0.5, 0.0]),
            (-2.0, [0.0, 1.0, 0.0]),
            (0.25, [0.0, 0.25, 0.75]),
            (1.0, [0.0, 0.0, 1.0]),
            (9.0, [0.0, 0.0, 1.0]),
        ] {
            assert_eq!(kinds.shares_at(turn), expected, "{turn}");
        }
        let same = PlaceKinds { centers: [2.0; 3] };
        assert_eq!(same.shares_at(1.0), [1.0, 0.0, 0.0]);
        assert_eq!(same.shares_at(2.0), [0.0, 0.0, 1.0]);
    }
}
