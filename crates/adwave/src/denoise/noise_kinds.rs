//! Kinds of noise of a mesh: along the normals, impulses, and in all directions; and the treatment of each.

use super::impulses::Impulses;
use super::noise_level::{NoiseLevels, noise_levels, quantile};
use super::smoothed_normals::SelectedWalks;
use super::surface::NoisySurface;
use super::{DenoiseInfo, DenoiseParams, MeshDenoising, SharedNoise};
use crate::vector::{dot, norm, subtract};
use crate::{Cancelled, Progress, parallel};

/// Number of lazy steps that smooth a surface for the direction that its triangles should have.
const STEPS_OF_DIRECTION: usize = 3;

/// Noise along the normals, in mean edges, above which the linear filter precedes the walks. Normals depend less than
/// linearly on stronger noise, so less is lost if positions are averaged first.
const LINEAR_FROM: f64 = 0.1;

/// Rounds of the linear filter for each mean edge of noise beyond [`LINEAR_FROM`].
const ROUNDS_BY_NOISE: f64 = 3.0;

/// Rounds of the linear filter if one triangle in a hundred is turned; for other shares they grow with the root.
const ROUNDS_BY_TURNED: f64 = 1.0;

/// Range of the noise along the normals, in mean edges, over which turned triangles change from counting as shape to
/// counting as noise.
const TURNED_BY_NOISE: [f64; 2] = [0.02, 0.1];

/// Range of the noise along the normals, in mean edges, over which differences between places change from counting as
/// shape to counting as noise.
const VARIED_BY_NOISE: [f64; 2] = [0.08, 0.12];

/// Ratio of the noise of noisy places to that of quiet places from which they count as different, relative to the ratio
/// that equal noise has by chance; shape causes smaller ratios.
const LEAST_SPREAD: f64 = 2.5;

/// Largest factor of the typical noise up to which the noise of the noisiest places counts, and the factor after
/// impulses, of which small ones remain.
const MOST_VARIED: f64 = 2.0;
const MOST_AFTER_IMPULSES: f64 = 5.0;

/// Range of the share of vertices that impulses moved, over which the remaining noise counts up to twice: many impulses
/// hide each other, and the remaining ones are large but too few to change a quantile.
const HIDDEN_BY_SHARE: [f64; 2] = [0.16, 0.2];

/// Cap on the rounds of the linear filter.
pub(super) const MAX_LINEAR_ROUNDS: f64 = 6.0;

/// Noise along the normals, in mean edges, beyond which a further guide is made.
const STRONG: f64 = 0.35;

/// Noise of a surface in model units, estimated or given, and impulses if it has any; `unit` is the unit of the points.
pub(super) fn estimate_noise(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    unit: f64,
    params: &DenoiseParams,
    progress: Progress<'_>,
) -> Result<(DenoiseInfo, Option<Impulses>), Cancelled> {
    let edge = mean_distance(surface, points, progress)?;
    let (mut mesh, impulses) = if params.strength > 0.0 && params.noise != Some(0.0) {
        find_impulses(surface, points, edge, progress)?
    } else {
        (MeshDenoising::default(), None)
    };
    let points = impulses.as_ref().map_or(points, |found| &found.points[..]);
    let noise = if let Some(noise) = params.noise {
        noise / unit
    } else {
        let levels = noise_levels(surface, points, progress)?;
        if mesh.impulse_share == 0.0 && levels.typical > VARIED_BY_NOISE[0] * edge {
            mesh.noise_range = match surface.sample(points, progress)? {
                Some((part, points)) => noise_range(&part, &points, progress)?,
                None => noise_range(surface, points, progress)?,
            };
        }
        varied_noise(levels, edge, mesh.impulse_share)
    };
    if mesh.noise_range == [0.0; 2] {
        mesh.noise_range = [noise; 2];
    }
    mesh.noise_range = mesh.noise_range.map(|level| level * unit);
    let in_edges = if edge > 0.0 { noise / edge } else { 0.0 };
    let admitted = match surface.sample(points, progress)? {
        Some((part, points)) => part.shared_noise(&points, noise, progress)?,
        None => surface.shared_noise(points, noise, progress)?,
    };
    mesh.shared_at_most = admitted.shared * unit;
    mesh.shared_steps = admitted.steps;
    mesh.shared = match params.shared {
        SharedNoise::Detail => 0.0,
        SharedNoise::Estimate => mesh.shared_at_most,
        SharedNoise::Deviation(deviation) => deviation,
    };
    mesh.impulse_size *= unit;
    mesh.turned_share = turned_share(surface, points, progress)?;
    let [from, to] = TURNED_BY_NOISE;
    let by_turned = ROUNDS_BY_TURNED * (100.0 * mesh.turned_share).sqrt();
    let by_noise = ROUNDS_BY_NOISE * (params.strength * in_edges - LINEAR_FROM).max(0.0);
    mesh.linear_rounds =
        (by_noise + by_turned * ((in_edges - from) / (to - from)).clamp(0.0, 1.0)).min(MAX_LINEAR_ROUNDS);
    mesh.n_guides = if in_edges > STRONG { 3 } else { 2 };
    let info = DenoiseInfo {
        noise: noise * unit,
        noise_in_edges: in_edges,
        kept: 1.0,
        mesh: Some(mesh),
        ..DenoiseInfo::default()
    };
    Ok((info, impulses))
}

/// The 5 % and the 95 % quantile of the noise by place; zeros if it differs no more than its estimates do by chance.
fn noise_range(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<[f64; 2], Cancelled> {
    let (mut levels, spread) = surface.noise_by_place(points, progress)?;
    if spread < LEAST_SPREAD {
        return Ok([0.0; 2]);
    }
    Ok([0.05, 0.95].map(|share| quantile(&mut levels, share)))
}

/// The level that represents noise which differs from place to place, as along a line of sight or after the removal of
/// impulses: that of the noisiest places, up to a factor of the typical one. Where there is hardly any noise, the
/// difference between the two is shape. A large share of impulses raises the level, because some of them are hidden.
fn varied_noise(levels: NoiseLevels, edge: f64, impulse_share: f64) -> f64 {
    let NoiseLevels { typical, high } = levels;
    let ramp = |[from, to]: [f64; 2], value: f64| ((value - from) / (to - from)).clamp(0.0, 1.0);
    let share = if edge > 0.0 { ramp(VARIED_BY_NOISE, typical / edge) } else { 0.0 };
    let most = if impulse_share > 0.0 { MOST_AFTER_IMPULSES } else { 1.0 + share * (MOST_VARIED - 1.0) };
    high.max(typical).min(most * typical) * (1.0 + ramp(HIDDEN_BY_SHARE, impulse_share))
}

/// Impulses of a surface if it has any; on a large surface they are first sought in a sample.
fn find_impulses(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    edge: f64,
    progress: Progress<'_>,
) -> Result<(MeshDenoising, Option<Impulses>), Cancelled> {
    let found_in = |surface: &NoisySurface, points: &[[f64; 3]]| {
        let found = surface.impulses(points, progress)?;
        let noise = noise_levels(surface, &found.points, progress)?.typical;
        Ok::<_, Cancelled>(found.statistics(points, noise, edge).map(|statistics| (statistics, found)))
    };
    let none = (MeshDenoising::default(), None);
    let sample = surface.sample(points, progress)?;
    let Some((statistics, found)) = (match &sample {
        Some((part, points)) => found_in(part, points)?,
        None => found_in(surface, points)?,
    }) else {
        return Ok(none);
    };
    let share = statistics.share;
    let found = if sample.is_some() {
        surface.impulses_of_share(points, share, progress)?
    } else {
        let mut found = found;
        surface.add_if_many(&mut found, share, progress)?;
        found
    };
    let mesh =
        MeshDenoising { impulse_share: share, impulse_size: statistics.size, ..MeshDenoising::default() };
    Ok((mesh, Some(found)))
}

/// Share of the triangles whose normals point away from those of the same triangles of the smoothed surface.
fn turned_share(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let normals = surface.normals(points, progress)?;
    let smooth = surface.normals(&surface.smoothed(points, STEPS_OF_DIRECTION, progress)?, progress)?;
    let n_turned = (0..normals.len()).filter(|&t| dot(&normals[t], &smooth[t]) < 0.0).count();
    Ok(n_turned as f64 / normals.len().max(1) as f64)
}

/// Points after the linear filter that precedes the walks.
pub(super) fn prepared_points(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    info: &DenoiseInfo,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    surface.linear_filtered(points, info.mesh.as_ref().map_or(0.0, |mesh| mesh.linear_rounds), progress)
}

impl SelectedWalks {
    /// The walks with the number of guides that the noise asks for.
    pub(super) fn with_guides(self, info: &DenoiseInfo) -> Self {
        Self { n_guides: info.mesh.as_ref().map_or(1, |mesh| mesh.n_guides.saturating_sub(1)), ..self }
    }
}

/// Mean distance between neighbors; 0 if there are none.
fn mean_distance(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let total = parallel::try_sum(points.len(), progress, |x| {
        surface.ring.row(x).iter().map(|&y| norm(&subtract(&points[x], &points[y as usize]))).sum()
    })?;
    Ok(total / surface.ring.nnz().max(1) as f64)
}
