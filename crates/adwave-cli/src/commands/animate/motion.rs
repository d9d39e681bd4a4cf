//! The motion of frames: along time, in space, and of the whole.

use super::frames::Frames;
use adwave::bands::{BandsError, Schedule};
use adwave::{Cancelled, Decomposer, Progress};
use adwave_register::Motion;
use rayon::prelude::*;

/// Rounds in which the frames are moved onto their mean.
const MOST_ROUNDS: usize = 10;

/// Movement of the mean relative to the size of the shape at which the rounds end.
const AT_REST: f64 = 1e-12;

/// Values of displacements that are split into bands together.
const VALUES_TOGETHER: usize = 1 << 22;

/// Degrees by which a frame was turned, and its positions after it.
type TurnedFrame = (f64, Vec<[f64; 3]>);

/// The positions over time as a signal, vertices × frames × 3.
pub(super) fn series(frames: &Frames) -> Vec<f64> {
    let (n, n_frames) = (frames.shape.n_vertices(), frames.points.len());
    let mut values = Vec::with_capacity(3 * n * n_frames);
    for x in 0..n {
        values.extend(frames.points.iter().flat_map(|points| points[x]));
    }
    values
}

/// Replaces the positions by those of a signal, vertices × frames × 3.
pub(super) fn set_series(frames: &mut Frames, values: &[f64]) {
    let n_frames = frames.points.len();
    for (k, point) in values.as_chunks::<3>().0.iter().enumerate() {
        frames.points[k % n_frames][k / n_frames] = *point;
    }
}

/// Flags of the vertices without a position in some frame; `None` if there are none.
pub(super) fn unknown(frames: &Frames) -> Option<Vec<bool>> {
    let is_unknown = |x: usize| frames.points.iter().any(|points| points[x].iter().any(|c| !c.is_finite()));
    let flags: Vec<bool> = (0..frames.shape.n_vertices()).map(is_unknown).collect();
    flags.contains(&true).then_some(flags)
}

/// Turns and moves each frame onto the mean of all by least squares, in rounds until the mean rests, and that onto the
/// first frame. Vertices that are unknown have no part in it. Returns the largest turn in degrees and the longest way of
/// the center; `None` if points on a line leave the turn open. Frames are moved in parallel.
pub(super) fn take_motion_out(
    frames: &mut Frames,
    unknown: Option<&[bool]>,
    progress: Progress<'_>,
) -> Result<Option<[f64; 2]>, Cancelled> {
    let weights: Vec<f64> = (0..frames.shape.n_vertices())
        .map(|x| f64::from(u8::from(unknown.is_none_or(|unknown| !unknown[x]))))
        .collect();
    let known = |points: &[[f64; 3]]| -> Vec<[f64; 3]> {
        points.iter().map(|p| if p.iter().all(|c| c.is_finite()) { *p } else { [0.0; 3] }).collect()
    };
    let center = |points: &[[f64; 3]]| -> [f64; 3] {
        let total: f64 = weights.iter().sum();
        std::array::from_fn(|c| {
            known(points).iter().zip(&weights).map(|(p, w)| w * p[c]).sum::<f64>() / total
        })
    };
    let first = frames.points[0].clone();
    let centers: Vec<[f64; 3]> = frames.points.iter().map(|points| center(points)).collect();
    let mut target = known(&first);
    let mut turned: Vec<TurnedFrame> = Vec::new();
    for round in 0..MOST_ROUNDS {
        progress.step(round as u64, MOST_ROUNDS as u64)?;
        let onto_target = |points: &Vec<[f64; 3]>| -> Result<Option<TurnedFrame>, Cancelled> {
            progress.check()?;
            let motion = Motion::fit(&known(points), &target, &weights, false);
            Ok(motion.map(|motion| (motion.degrees(), points.iter().map(|p| motion.apply(p)).collect())))
        };
        let Some(all) = frames.points.par_iter().map(onto_target).collect::<Result<Option<Vec<_>>, _>>()?
        else {
            return Ok(None);
        };
        turned = all;
        let mean = mean_points(turned.iter().map(|(_, points)| points.as_slice()));
        let size = target.iter().flatten().fold(0.0_f64, |size, c| size.max(c.abs()));
        let difference =
            |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max);
        let step = known(&mean).iter().zip(&target).map(difference).fold(0.0, f64::max);
        target = known(&mean);
        if step <= AT_REST * size {
            break;
        }
    }
    let Some(back) = Motion::fit(&target, &known(&first), &weights, false) else { return Ok(None) };
    let turn = turned.iter().fold(0.0, |most, (degrees, _)| f64::max(most, *degrees));
    frames.points =
        turned.into_iter().map(|(_, points)| points.iter().map(|p| back.apply(p)).collect()).collect();
    let way = |c: &[f64; 3]| (0..3).map(|k| (c[k] - centers[0][k]).powi(2)).sum::<f64>().sqrt();
    Ok(Some([turn, centers.iter().map(way).fold(0.0, f64::max)]))
}

/// The mean of all frames.
fn mean_points<'a>(frames: impl Iterator<Item = &'a [[f64; 3]]>) -> Vec<[f64; 3]> {
    let (mut sum, mut n) = (Vec::new(), 0.0);
    for points in frames {
        sum.resize(points.len(), [0.0; 3]);
        sum.iter_mut().zip(points).for_each(|(sum, p)| (0..3).for_each(|c| sum[c] += p[c]));
        n += 1.0;
    }
    sum.into_iter().map(|sum: [f64; 3]| sum.map(|c| c / n)).collect()
}

impl Frames {
    /// The mean of all frames.
    pub(super) fn mean(&self) -> Vec<[f64; 3]> {
        mean_points(self.points.iter().map(Vec::as_slice))
    }
}

/// Multiplies the bands in space of the displacements from the mean over all frames by gains, fine to coarse; a further
/// gain is that of the rest, else 1.
pub(super) fn scale_bands(
    decomposer: &Decomposer,
    frames: &mut Frames,
    schedule: &Schedule,
    gains: &[f64],
    progress: Progress<'_>,
) -> Result<(), BandsError> {
    let (gains, of_rest) = gains.split_at(schedule.n_levels());
    let of_rest = of_rest.first().copied().unwrap_or(1.0);
    // The rest is what remains of the displacements without their bands.
    let factors: Vec<f64> = gains.iter().map(|gain| gain - of_rest).collect();
    let mean = frames.mean();
    visit_groups(
        frames.points.len(),
        mean.len(),
        |group, progress| {
            let n_channels = 3 * group.len();
            let displacements = displacements(&frames.points[group.clone()], &mean);
            let request = decomposer.request(&displacements, n_channels, schedule).progress(progress);
            let (change, _) = request.weighted(&factors)?;
            let rows = change.chunks_exact(n_channels).zip(displacements.chunks_exact(n_channels));
            for (x, (row, moved)) in rows.enumerate() {
                let of_frames = row.as_chunks::<3>().0.iter().zip(moved.as_chunks::<3>().0);
                for (t, (change, moved)) in group.clone().zip(of_frames) {
                    let change: [f64; 3] = std::array::from_fn(|c| change[c] + (of_rest - 1.0) * moved[c]);
                    let known = change.iter().all(|c| c.is_finite());
                    for (c, d) in frames.points[t][x].iter_mut().zip(change).filter(|_| known) {
                        *c += d;
                    }
                }
            }
            Ok(())
        },
        progress,
    )
}

/// Root mean squares over time of the bands of the displacements from the mean over all frames, and of the rest: a map
/// for each.
pub(super) fn motion_maps(
    decomposer: &Decomposer,
    frames: &Frames,
    schedule: &Schedule,
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, BandsError> {
    let (mean, n_frames) = (frames.mean(), frames.points.len());
    let mut maps = vec![vec![0.0; mean.len()]; schedule.n_levels() + 1];
    visit_groups(
        n_frames,
        mean.len() * maps.len(),
        |group, progress| {
            let n_channels = 3 * group.len();
            let displacements = displacements(&frames.points[group], &mean);
            let request = decomposer.request(&displacements, n_channels, schedule).progress(progress);
            let bands = request.bands()?.into_vec();
            for (map, band) in maps.iter_mut().zip(bands.chunks_exact(mean.len() * n_channels)) {
                for (sum, row) in map.iter_mut().zip(band.chunks_exact(n_channels)) {
                    *sum += row.iter().map(|v| v * v).sum::<f64>();
                }
            }
            Ok(())
        },
        progress,
    )?;
    for sum in maps.iter_mut().flatten() {
        *sum = (*sum / n_frames as f64).sqrt();
    }
    Ok(maps)
}

/// Displacements of some frames from the mean, vertices × frames × 3.
fn displacements(frames: &[Vec<[f64; 3]>], mean: &[[f64; 3]]) -> Vec<f64> {
    let mut values = Vec::with_capacity(3 * mean.len() * frames.len());
    for (x, mean) in mean.iter().enumerate() {
        values.extend(frames.iter().flat_map(|points| (0..3).map(move |c| points[x][c] - mean[c])));
    }
    values
}

/// Calls `each` for groups of frames of 3·n values each.
fn visit_groups(
    n_frames: usize,
    n: usize,
    mut each: impl FnMut(std::ops::Range<usize>, Progress<'_>) -> Result<(), BandsError>,
    progress: Progress<'_>,
) -> Result<(), BandsError> {
    let together = (VALUES_TOGETHER / (3 * n).max(1)).clamp(1, n_frames);
    for first in (0..n_frames).step_by(together) {
        progress.step(first as u64, n_frames as u64)?;
        each(first..(first + together).min(n_frames), progress.quiet())?;
    }
    Ok(progress.step(n_frames as u64, n_frames as u64)?)
}

/// Root mean square distance between two states of the frames over vertices that are known.
pub(super) fn rms_change(before: &[f64], after: &[f64]) -> f64 {
    let (mut sum, mut n) = (0.0, 0_usize);
    for (a, b) in before.as_chunks::<3>().0.iter().zip(after.as_chunks::<3>().0) {
        let square: f64 = (0..3).map(|c| (a[c] - b[c]).powi(2)).sum();
        if square.is_finite() {
            sum += square;
            n += 1;
        }
    }
    (sum / n.max(1) as f64).sqrt()
}
