//! Decisions of the denoiser that depend on a whole surface or a sample of it, so that its parts can be denoised
//! separately.

use super::double_sides::without_reverse_sides;
use super::filter_rounds::choose_rounds;
use super::impulses;
use super::mixture::PlaceMixture;
use super::noise_kinds::{MAX_LINEAR_ROUNDS, estimate_noise, prepared_points};
use super::shared_noise::NoiseLaw;
use super::smoothed_normals::{
    GUIDE_LEVELS, GUIDE_MOVES, GUIDE_STEPS, GuideScales, LEVELS, MAX_GUIDES, fixed, mix_normals,
};
use super::surface::NoisySurface;
use super::{
    Creases, DenoiseError, DenoiseInfo, DenoiseParams, MOVES, best_mixture, build_surface, cloud,
    denoise_cloud, is_anything_to_do, stop_far_moves, used_walks,
};
use crate::Progress;
use crate::bands::FixedSeries;
use crate::shape::{Adjacency, PreparedGeometry};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Global quantities of [`denoise`](super::denoise): the noise level, the weights of the mixture, and the medians
/// that scale the walks.
///
/// With it, the parts of a surface too large for memory are denoised one after another, with the same bits as the
/// whole. A resulting point depends on the points within [`reach`](Self::reach) rings of neighbors, provided these
/// have the same order.
///
/// ```
/// use adwave::denoise::{DenoiseChoice, DenoiseParams, denoise};
/// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
/// use adwave::Progress;
/// let rough = |x: u32, y: u32| [f64::from(x), f64::from(y), 0.3 * f64::from((7 * x + 3 * y) % 5) / 5.0];
/// let points = (0..400).map(|i| rough(i % 20, i / 20)).collect();
/// let corners = (0..380_u32).filter(|i| i % 20 < 19);
/// let faces: Vec<_> = corners.flat_map(|i| [[i, i + 1, i + 20], [i + 1, i + 21, i + 20]]).collect();
/// let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&faces))?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
/// let choice = DenoiseChoice::estimate(&geometry, &DenoiseParams::default(), Progress::none())?;
/// let part = choice.denoise_mesh(geometry.points(), geometry.triangles(), Progress::none())?;
/// let whole = denoise(&geometry, &DenoiseParams::default(), Progress::none())?;
/// let part = geometry.vertex_map().scatter(&part.points, 1);
/// let off = |x: usize| (part[x][2] - whole.points[x][2]).abs();
/// assert!((0..400).all(|x| off(x) < 1e-3 * whole.info.noise));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DenoiseChoice {
    /// Assumed noise and weights of the mixture. Counts that refer to a result are 0.
    pub info: DenoiseInfo,
    creases: Creases,
    mixture: PlaceMixture,
    scales: GuideScales,
    /// Parameters for the parts of a cloud.
    params: DenoiseParams,
}

/// Denoised part of a mesh, one entry per point.
#[derive(Clone, Debug, PartialEq)]
pub struct DenoisedPart {
    /// New positions.
    pub points: Vec<[f64; 3]>,
    /// True for points that would have moved farther than three times the noise there.
    pub is_stopped: Vec<bool>,
}

impl DenoiseChoice {
    /// Number of nearest neighbors of a point of a cloud.
    pub const NEIGHBORS: usize = cloud::NEIGHBORS;

    /// Estimates the quantities from a surface, or from a sample that consists of connected pieces; all of it is
    /// used. [`denoise`](super::denoise) takes a sample itself if there are more than 48 000 triangles or points.
    /// O(n log n).
    ///
    /// # Errors
    /// [`DenoiseError`] for a graph, a parameter out of its range, or if the call is cancelled.
    pub fn estimate(
        geometry: &PreparedGeometry,
        params: &DenoiseParams,
        progress: Progress<'_>,
    ) -> Result<Self, DenoiseError> {
        params.check()?;
        if geometry.shape().is_graph() {
            return Err(DenoiseError::NoPositions);
        }
        if let Some(members) = geometry.members(progress)? {
            return Self::estimate(&members.geometry, params, progress);
        }
        if geometry.shape().is_cloud() {
            let mut info = denoise_cloud(geometry, geometry.points(), params, progress)?.info;
            (info.n_far, info.furthest) = (0, 0.0);
            return Ok(Self {
                info,
                creases: params.creases,
                mixture: PlaceMixture::default(),
                scales: GuideScales::default(),
                params: *params,
            });
        }
        let (points, unit) = geometry.unit_points(progress)?;
        let surface = build_surface(geometry, &points, progress)?;
        let (mut info, impulses) = estimate_noise(&surface, &points, unit, params, progress)?;
        let points = impulses.map_or_else(|| points.to_vec(), |found| found.points);
        let (law, mut scales) = (NoiseLaw::from_info(&info, unit), GuideScales::default());
        let mut mixture = PlaceMixture::default();
        let is_noisy = is_anything_to_do(&surface, &law, params);
        if is_noisy {
            choose_rounds(&surface, &points, &law, params, &mut info, progress.quiet())?;
        }
        if is_noisy
            && let Some(found) =
                best_mixture(&surface, &points, None, &law, params, &mut info, progress.quiet())?
        {
            scales = GuideScales { distance: found.scales.distance * unit * unit, ..found.scales };
            mixture = found.factors;
        }
        Ok(Self { info, creases: params.creases, mixture, scales, params: *params })
    }

    /// Number of rings around a point of a cloud that determine its result: the [`NEIGHBORS`](Self::NEIGHBORS)
    /// nearest points.
    pub const CLOUD_REACH: usize = cloud::REACH;

    /// Number of rings of neighbors around a vertex of a mesh that determine its result, along edges.
    ///
    /// # Errors
    /// Never, because the levels and the accuracy are fixed.
    pub fn reach() -> Result<usize, DenoiseError> {
        let rings = |n_levels| {
            let bands = fixed(n_levels)?;
            Ok::<_, DenoiseError>(bands.iter().map(FixedSeries::reach).max().unwrap_or(0))
        };
        let guides = MAX_GUIDES * (GUIDE_MOVES + 1 + rings(GUIDE_LEVELS)? + 2);
        let before = impulses::RINGS + 2 * MAX_LINEAR_ROUNDS.ceil() as usize;
        // Counted from the result back to the data: the moves; the walk, whose entries need normals one ring further;
        // for each guide, the moves to smoothed normals and the walk that smoothed these; for the first guide, the
        // normals of smoothed points; then the linear filter and the impulses. One ring of neighbors is another ring
        // for the triangles that define normals.
        Ok(MOVES + rings(LEVELS)? + 2 + guides + GUIDE_STEPS + 2 + before)
    }

    /// Denoised points of a part of a mesh with `triangles` in any order, and flags of those that were stopped at three
    /// times the noise. Points with fewer than [`reach`](Self::reach) rings around them differ from those of the whole.
    ///
    /// # Errors
    /// If the call is cancelled.
    pub fn denoise_mesh(
        &self,
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        progress: Progress<'_>,
    ) -> Result<DenoisedPart, DenoiseError> {
        let mesh = self.info.mesh.as_ref();
        let impulse_share = mesh.map_or(0.0, |mesh| mesh.impulse_share);
        let is_filtered = mesh.is_some_and(|mesh| mesh.linear_rounds > 0.0);
        if self.info.kept >= 1.0 && impulse_share == 0.0 && !is_filtered {
            return Ok(DenoisedPart { points: points.to_vec(), is_stopped: vec![false; points.len()] });
        }
        let surface = NoisySurface::mesh(points.len(), without_reverse_sides(triangles.to_vec()), progress)?;
        if impulse_share == 0.0 {
            return self.denoise(&surface, points, progress);
        }
        let repaired = surface.impulses_of_share(points, impulse_share, progress)?.points;
        self.denoise(&surface, &repaired, progress)
    }

    /// Number of nearest neighbors of each point that [`denoise_cloud`](Self::denoise_cloud) needs:
    /// [`NEIGHBORS`](Self::NEIGHBORS), or more if points lie in lines.
    pub fn neighbors(&self) -> usize {
        self.info.cloud.as_ref().map_or(0, |found| found.neighbors).max(Self::NEIGHBORS)
    }

    /// Denoised points of a part of a cloud; `neighbors` hold at least the [`neighbors`](Self::neighbors) nearest of
    /// each point. Points with fewer than [`CLOUD_REACH`](Self::CLOUD_REACH) rings around them differ from those of
    /// the whole.
    ///
    /// # Errors
    /// If the call is cancelled.
    ///
    /// # Panics
    /// Unless there is one row of neighbors per point.
    pub fn denoise_cloud(
        &self,
        points: &[[f64; 3]],
        neighbors: &Adjacency,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        assert_eq!(neighbors.n_rows(), points.len(), "a row of neighbors for each point");
        let near = cloud::NearestRows::new(
            points,
            neighbors,
            self.neighbors(),
            |_, _| Ok(Cow::Borrowed(neighbors)),
            progress,
        )?;
        let strong = self.info.cloud.as_ref().and_then(|found| found.strong.as_ref());
        let noise = cloud::CloudNoise::new(points, &near, self.params.noise, strong, progress)?;
        Ok(cloud::denoise_points(points, &near, &noise, self.info.noise, &self.params, progress)?.points)
    }

    fn denoise(
        &self,
        surface: &NoisySurface,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<DenoisedPart, DenoiseError> {
        let mut moved = prepared_points(surface, points, &self.info, progress)?;
        if self.info.kept < 1.0 {
            let used = used_walks(&self.mixture, self.creases, &self.info);
            let known = Some(&self.scales);
            let (normals, _) = mix_normals(surface, &moved, used, known, &self.mixture, progress)?;
            surface.move_to(&mut moved, &normals, MOVES, progress)?;
        }
        let noise = self.info.total_noise() * self.params.strength.max(1.0);
        let is_stopped = stop_far_moves(&mut moved, points, &surface.most_moved(points, noise, progress)?);
        Ok(DenoisedPart { points: moved, is_stopped })
    }
}
