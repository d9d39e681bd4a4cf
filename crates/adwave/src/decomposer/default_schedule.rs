//! Levels that edits use if none are asked for.

use super::{Decomposer, ResolvedLevels};
use crate::Progress;
use crate::bands::{DEFAULT_EXTENT, Schedule, levels_reaching};
use crate::parallel::expect_not_cancelled;
use crate::shape::encloses_volume;

/// Largest number of levels if already the first is wider than [`DEFAULT_EXTENT`] of the shape: one less than the
/// smallest number for other shapes.
const COARSE_LEVELS: usize = 3;

/// Largest width of such levels, as a share of the extent: five times the usual share. A sphere smoothed by it keeps
/// 84 % of its volume.
const COARSE_SHARE: f64 = 5.0 * DEFAULT_EXTENT;

/// Share of the volume that the smoothest default level keeps at least.
const KEPT_VOLUME: f64 = 0.5;

/// Width of the last level, in radii `3V/A` of a solid, from which its effect on the volume is computed. At that
/// width a sphere keeps 69 % of its volume, a long thin rod 75 %.
const SAFE_WIDTH: f64 = 0.5;

/// Largest number of times that the steps of two levels are halved, down to the smallest step of a level.
const MAX_HALVINGS: u32 = 5;

impl Decomposer {
    /// Levels of edits if none are asked for, and the reason. Usually the dyadic levels up to
    /// [`DEFAULT_EXTENT`](crate::bands::DEFAULT_EXTENT) of the [`extent`](Self::extent), at least 4
    /// ([`levels_reaching`]).
    ///
    /// A default never removes half of a shape. If the first level is already wider than that share, there are at
    /// most 3, not wider than a tenth of the extent. If removing all bands of a closed mesh would leave less than half
    /// of its volume, there are as many levels as keep half of it, at least two. If these are too wide as well, as on
    /// a cube of 8 vertices, their steps are fractions of a step. O(n); the product of a signal with the operator for
    /// thin and coarse shapes.
    ///
    /// ```
    /// use adwave::{Decomposer, sample::Sample, shape::{Mesh, Shape}};
    /// let sphere = Sample::from_name("sphere", Some(20_000))?;
    /// let sphere = Decomposer::new(&Shape::Mesh(Mesh::new(sphere.points, sphere.faces)?));
    /// assert_eq!(sphere.default_schedule().schedule.steps(), [1.0, 2.0, 4.0, 8.0, 16.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn default_schedule(&self) -> ResolvedLevels {
        let (step, extent) = (self.operator().step_length(), self.extent);
        let (mut n_levels, mut reason) = levels_reaching(DEFAULT_EXTENT, step, extent);
        let width = |n_levels: usize| step * ((n_levels as f64 - 1.0) / 2.0).exp2();
        if extent > 0.0 && width(1) >= DEFAULT_EXTENT * extent {
            n_levels = (2..=COARSE_LEVELS).rev().find(|&j| width(j) <= COARSE_SHARE * extent).unwrap_or(1);
            let percent = 100.0 * width(1) / extent;
            reason = format!("{}, because σ_1 is already {percent:.3} % of the diagonal", count(n_levels));
        }
        let dyadic = |n_levels| Schedule::dyadic(n_levels).unwrap_or_else(|e| unreachable!("{e}"));
        let usual = ResolvedLevels { schedule: dyadic(n_levels), reason };
        let Some(volume) = self.volume_at_risk(width(n_levels)) else { return usual };
        let kept = |schedule: &Schedule| {
            let volumes = self.volumes(schedule)?;
            Some(volumes.into_iter().map(|v| v / volume).collect::<Vec<f64>>())
        };
        let Some(shares) = kept(&dyadic(n_levels.max(2))) else { return usual };
        if n_levels <= shares.len() && shares[n_levels - 1] >= KEPT_VOLUME {
            return usual;
        }
        if let Some(j) = (2..=shares.len()).rev().find(|&j| shares[j - 1] >= KEPT_VOLUME) {
            let reason = format!("{}: more would remove half of the volume", count(j));
            return ResolvedLevels { schedule: dyadic(j), reason };
        }
        for halvings in 1..=MAX_HALVINGS {
            let first = 0.5_f64.powi(halvings as i32);
            let Ok(schedule) = Schedule::real(vec![first, 2.0 * first]) else { break };
            if kept(&schedule).is_some_and(|shares| shares[1] >= KEPT_VOLUME) {
                let reason = format!(
                    "2 levels of {first} and {} steps: more would remove half of the volume",
                    2.0 * first
                );
                return ResolvedLevels { schedule, reason };
            }
        }
        let reason = "1 level, the fewest: more would remove even more of the volume".to_owned();
        ResolvedLevels { schedule: dyadic(1), reason }
    }

    /// Volume of a closed mesh in units of its extent, if levels of this width may remove half of it.
    fn volume_at_risk(&self, width: f64) -> Option<f64> {
        let geometry = self.geometry()?;
        if geometry.faces().is_empty() || self.mask.is_some() || self.extent <= 0.0 {
            return None;
        }
        let points = self.unit_positions();
        let (area, volume) = (geometry.area_of(&points), geometry.volume_of(&points));
        let radius = 3.0 * volume.abs() / area;
        // The cheapest condition comes first.
        let is_at_risk = radius > 0.0 && width / self.extent > SAFE_WIDTH * radius && !geometry.is_open();
        let encloses = || expect_not_cancelled(encloses_volume(geometry, Progress::none()));
        (is_at_risk && encloses()).then_some(volume)
    }

    /// Positions of the welded vertices in units of the extent, so that volumes neither overflow nor underflow.
    fn unit_positions(&self) -> Vec<[f64; 3]> {
        let points = self.positions();
        let origin = points.first().copied().unwrap_or_default();
        points.iter().map(|p| [0, 1, 2].map(|c| (p[c] - origin[c]) / self.extent)).collect()
    }

    /// Volumes of the closed mesh smoothed to each level, in units of its extent; `None` if the levels do not suit the
    /// operator.
    fn volumes(&self, schedule: &Schedule) -> Option<Vec<f64>> {
        let (map, geometry) = (self.vertex_map(), self.geometry()?);
        let points = map.scatter(&self.unit_positions(), 1);
        let bands = self.decompose(points.as_flattened(), 3, schedule).ok()?;
        let volume = |j: usize| {
            let smooth = bands.scaling(j);
            geometry.volume_of(&map.positions(smooth.as_chunks().0))
        };
        Some((1..=schedule.n_levels()).map(volume).collect())
    }
}

/// `1 level`, `2 levels`.
fn count(n_levels: usize) -> String {
    format!("{n_levels} level{}", if n_levels == 1 { "" } else { "s" })
}
