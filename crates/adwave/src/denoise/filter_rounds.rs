//! Choice between few and many rounds of the linear filter that precedes the walks, by the estimated risk of positions.

use super::mixture::{MixtureParts, MixtureRisk};
use super::noise_level::point_normals;
use super::shared_noise::NoiseLaw;
use super::surface::NoisySurface;
use super::{DenoiseError, DenoiseInfo, DenoiseParams, MOVES, SEED, SHAKE, prepare_parts};
use crate::vector::{dot, subtract};
use crate::{Cancelled, Progress, parallel};

/// Alternative number of rounds, at which the linear filter does most of the smoothing; it suits detail that is not
/// piecewise smooth.
const MANY_ROUNDS: f64 = 4.0;

/// Number of rounds from which no alternative is tried.
const ENOUGH_ROUNDS: f64 = 3.0;

/// Range of the noise along the normals, in mean edges, in which the alternative is tried; for stronger noise the
/// estimate favors many rounds.
const NOISE: [f64; 2] = [0.05, 0.35];

/// Smallest advantage that many rounds must promise, in squared standard deviations of the noise per edge; the estimate
/// favors them by less than that.
const LEAST_ADVANTAGE: f64 = 0.025;

/// Number of lazy steps that smooth a surface for the directions along which positions are compared.
const STEPS_BEFORE: usize = 3;

/// Number of pieces of the sample, and of sites in each.
const PIECES: [usize; 2] = [8, 1_000];

/// Replaces the rounds of the linear filter by [`MANY_ROUNDS`] if these promise a smaller error, estimated on a sample.
/// `noise` is in the units of the points. O(n log n) for the n sites of the sample.
pub(super) fn choose_rounds(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    law: &NoiseLaw,
    params: &DenoiseParams,
    info: &mut DenoiseInfo,
    progress: Progress<'_>,
) -> Result<(), DenoiseError> {
    let Some(rounds) = info.mesh.as_ref().map(|mesh| mesh.linear_rounds) else { return Ok(()) };
    let [least, most] = NOISE;
    if rounds >= ENOUGH_ROUNDS || !(least..most).contains(&(info.noise_in_edges * params.strength)) {
        return Ok(());
    }
    let sample = surface.sample_of(PIECES, points, progress)?;
    let (part, points) = sample.as_ref().map_or((surface, points), |(part, points)| (part, &points[..]));
    let risk = |rounds: f64| {
        let mut info = info.clone();
        if let Some(mesh) = &mut info.mesh {
            mesh.linear_rounds = rounds;
        }
        position_risk(part, points, law, params, &info, progress)
    };
    let (few, many) = rayon::join(|| risk(rounds), || risk(MANY_ROUNDS));
    if few? - many? > LEAST_ADVANTAGE * (law.white * params.strength).powi(2)
        && let Some(mesh) = &mut info.mesh
    {
        mesh.linear_rounds = MANY_ROUNDS;
    }
    Ok(())
}

/// Risk of the positions after the given rounds, less the noise of the data: the mean of `(δ_x − δ_y)²` over the edges,
/// δ_x being the error of the position of x along its normal. Differences along edges are errors of slopes, as are the
/// angles between normals.
///
/// For data y = m + e and a result X it is Stein's estimate `(X − y)·L(X − y) + 2·tr(L·cov(X − y, e))` with the
/// Laplacian L of the edges. The covariance is estimated from one repetition with added noise.
fn position_risk(
    surface: &NoisySurface,
    points: &[[f64; 3]],
    law: &NoiseLaw,
    params: &DenoiseParams,
    info: &DenoiseInfo,
    progress: Progress<'_>,
) -> Result<f64, DenoiseError> {
    let shaken_points = law.shaken(surface, points, SEED, progress)?;
    let prepare = |points: &[[f64; 3]]| prepare_parts(surface, points, None, params, info, progress);
    let (as_they_are, shaken) = (prepare(points)?, prepare(&shaken_points)?);
    let shaken_parts = [shaken.parts];
    let areas = &as_they_are.walks.areas;
    let risk = MixtureRisk::new(&as_they_are.parts, &shaken_parts, areas, params.strength, progress)?;
    let chosen = risk.best(surface.n_sites());
    let finish = |mut moved: Vec<[f64; 3]>, parts: &MixtureParts| {
        if !chosen.is_nothing() {
            surface.move_to(&mut moved, &chosen.normals(parts, progress)?, MOVES, progress)?;
        }
        Ok::<_, DenoiseError>(moved)
    };
    let result = finish(as_they_are.start, &as_they_are.parts)?;
    let shaken_result = finish(shaken.start, &shaken_parts[0])?;
    let smooth = surface.smoothed(points, STEPS_BEFORE, progress)?;
    let directions = point_normals(surface, &smooth, progress)?;
    let n = points.len();
    let heights = |to: &[[f64; 3]], from: &[[f64; 3]]| {
        parallel::try_collect(n, progress, |x| dot(&directions[x], &subtract(&to[x], &from[x])))
    };
    let change = heights(&result, points)?;
    let added = heights(&shaken_points, points)?;
    let shaken_change = heights(&shaken_result, &shaken_points)?;
    let response: Vec<f64> = shaken_change.iter().zip(&change).map(|(s, c)| s - c).collect();
    let own = mean_product_over_edges(surface, &change, &change, progress)?;
    let covariance = mean_product_over_edges(surface, &response, &added, progress)?;
    Ok(own + 2.0 * covariance * (params.strength / SHAKE).powi(2))
}

/// Mean of `(a_x − a_y)·(b_x − b_y)` over edges.
fn mean_product_over_edges(
    surface: &NoisySurface,
    a: &[f64],
    b: &[f64],
    progress: Progress<'_>,
) -> Result<f64, Cancelled> {
    let sum = parallel::try_sum(a.len(), progress, |x| {
        let ring = surface.ring.row(x).iter().map(|&y| y as usize);
        ring.map(|y| (a[x] - a[y]) * (b[x] - b[y])).sum()
    })?;
    Ok(sum / surface.ring.nnz().max(1) as f64)
}
