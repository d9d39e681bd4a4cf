//! The motion of frames: along time, in space, and of the whole.

use super::frames::Frames;
use adwave::bands::{BandsError, Schedule};
use adwave::{Cancelled, Decomposer, Progress};
use adwave_register::Motion;
use rayon::prelude::*;
use std::ops::Range;

/// Rounds in which the frames are moved onto their mean.
const MOST_ROUNDS: usize = 10;

/// Movement of the mean relative to the size of the shape at which the rounds end.
const AT_REST: f64 = 1e-12;

/// Values of displacements that are split into bands together.
const VALUES_TOGETHER: usize = 1 << 21;

/// Frames whose coordinates fill whole cache lines.
const LINE: usize = 8;

/// Positions that are compared at a time.
const POSITIONS_AT_A_TIME: usize = 1 << 10;

/// Flags of the vertices without a position in some frame; `None` if there are none.
pub(super) fn unknown(frames: &Frames) -> Option<Vec<bool>> {
    let is_unknown = |row: &[[f64; 3]]| row.as_flattened().iter().any(|c| !c.is_finite());
    let flags: Vec<bool> = frames.positions.par_chunks(frames.length).map(is_unknown).collect();
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
    let n_frames = frames.length;
    let weights: Vec<f64> = (0..frames.shape.n_vertices())
        .map(|x| f64::from(u8::from(unknown.is_none_or(|unknown| !unknown[x]))))
        .collect();
    let total: f64 = weights.iter().sum();
    let known = |p: [f64; 3]| if p.iter().all(|c| c.is_finite()) { p } else { [0.0; 3] };
    let frame = |t: usize| frames.frame(t).into_iter().map(known).collect::<Vec<_>>();
    let center = |t: usize| -> [f64; 3] {
        let points = frame(t);
        std::array::from_fn(|c| points.iter().zip(&weights).map(|(p, w)| w * p[c]).sum::<f64>() / total)
    };
    let centers: Vec<[f64; 3]> = (0..n_frames).into_par_iter().map(center).collect();
    let first = frame(0);
    let (mut target, mut motions) = (first.clone(), Vec::new());
    for round in 0..MOST_ROUNDS {
        progress.step(round as u64, MOST_ROUNDS as u64)?;
        let onto_target = |t: usize| -> Result<Option<Motion>, Cancelled> {
            progress.check()?;
            Ok(Motion::fit(&frame(t), &target, &weights, false))
        };
        let all = (0..n_frames).into_par_iter().map(onto_target).collect::<Result<Option<Vec<_>>, _>>()?;
        let Some(all) = all else { return Ok(None) };
        motions = all;
        let moved = |row: &[[f64; 3]]| known(mean_point(row.iter().zip(&motions).map(|(p, m)| m.apply(p))));
        let mean: Vec<[f64; 3]> = frames.positions.par_chunks(n_frames).map(moved).collect();
        let size = target.iter().flatten().fold(0.0_f64, |size, c| size.max(c.abs()));
        let difference =
            |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max);
        let step = mean.iter().zip(&target).map(difference).fold(0.0, f64::max);
        target = mean;
        if step <= AT_REST * size {
            break;
        }
    }
    let Some(back) = Motion::fit(&target, &first, &weights, false) else { return Ok(None) };
    let turn = motions.iter().map(Motion::degrees).fold(0.0, f64::max);
    frames.positions.par_chunks_mut(n_frames).for_each(|row| {
        row.iter_mut().zip(&motions).for_each(|(p, motion)| *p = back.apply(&motion.apply(p)));
    });
    let way = |c: &[f64; 3]| (0..3).map(|k| (c[k] - centers[0][k]).powi(2)).sum::<f64>().sqrt();
    Ok(Some([turn, centers.iter().map(way).fold(0.0, f64::max)]))
}

/// The mean of some points.
fn mean_point(points: impl ExactSizeIterator<Item = [f64; 3]>) -> [f64; 3] {
    let n = points.len() as f64;
    let sum = points.fold([0.0; 3], |sum: [f64; 3], p| std::array::from_fn(|c| sum[c] + p[c]));
    sum.map(|c| c / n)
}

impl Frames {
    /// The mean of all frames.
    pub(super) fn mean(&self) -> Vec<[f64; 3]> {
        self.positions.par_chunks(self.length).map(|row| mean_point(row.iter().copied())).collect()
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
    let (mean, n_frames) = (frames.mean(), frames.length);
    visit_groups(
        n_frames,
        mean.len(),
        |group, progress| {
            let n_channels = 3 * group.len();
            let displacements = displacements(frames, group.clone(), &mean);
            let request = decomposer.request(&displacements, n_channels, schedule).progress(progress);
            let (change, _) = request.weighted(&factors)?;
            let edits = change.par_chunks(n_channels).zip(displacements.par_chunks(n_channels));
            frames.positions.par_chunks_mut(n_frames).zip(edits).for_each(|(row, (change, moved))| {
                let of_frames = change.as_chunks::<3>().0.iter().zip(moved.as_chunks::<3>().0);
                for (position, (change, moved)) in row[group.clone()].iter_mut().zip(of_frames) {
                    let change: [f64; 3] = std::array::from_fn(|c| change[c] + (of_rest - 1.0) * moved[c]);
                    let known = change.iter().all(|c| c.is_finite());
                    for (c, d) in position.iter_mut().zip(change).filter(|_| known) {
                        *c += d;
                    }
                }
            });
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
    let (mean, n_frames) = (frames.mean(), frames.length);
    let mut maps = vec![vec![0.0; mean.len()]; schedule.n_levels() + 1];
    visit_groups(
        n_frames,
        mean.len() * maps.len(),
        |group, progress| {
            let n_channels = 3 * group.len();
            let displacements = displacements(frames, group, &mean);
            let request = decomposer.request(&displacements, n_channels, schedule).progress(progress);
            let bands = request.bands()?.into_vec();
            for (map, band) in maps.iter_mut().zip(bands.chunks_exact(mean.len() * n_channels)) {
                map.par_iter_mut().zip(band.par_chunks(n_channels)).for_each(|(sum, row)| {
                    *sum += row.iter().map(|v| v * v).sum::<f64>();
                });
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
fn displacements(frames: &Frames, group: Range<usize>, mean: &[[f64; 3]]) -> Vec<f64> {
    let mut values = vec![0.0; 3 * mean.len() * group.len()];
    let rows = frames.positions.par_chunks(frames.length).zip(mean);
    values.par_chunks_mut(3 * group.len()).zip(rows).for_each(|(out, (row, mean))| {
        for (out, position) in out.as_chunks_mut::<3>().0.iter_mut().zip(&row[group.clone()]) {
            *out = std::array::from_fn(|c| position[c] - mean[c]);
        }
    });
    values
}

/// Calls `each` for groups of frames of 3·n values each.
fn visit_groups(
    n_frames: usize,
    n: usize,
    mut each: impl FnMut(Range<usize>, Progress<'_>) -> Result<(), BandsError>,
    progress: Progress<'_>,
) -> Result<(), BandsError> {
    let most = (VALUES_TOGETHER / (3 * n).max(1)).clamp(1, n_frames);
    let together = if most > LINE { most / LINE * LINE } else { most };
    for first in (0..n_frames).step_by(together) {
        progress.step(first as u64, n_frames as u64)?;
        each(first..(first + together).min(n_frames), progress.quiet())?;
    }
    Ok(progress.step(n_frames as u64, n_frames as u64)?)
}

/// Root mean square distance between two states of the frames over vertices that are known.
pub(super) fn rms_change(before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let of_rows = |(before, after): (&[[f64; 3]], &[[f64; 3]])| {
        let square = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>();
        let known = before.iter().zip(after).map(square).filter(|square| square.is_finite());
        known.fold((0.0, 0_usize), |(sum, n), square| (sum + square, n + 1))
    };
    let parts: Vec<(f64, usize)> = before
        .par_chunks(POSITIONS_AT_A_TIME)
        .zip(after.par_chunks(POSITIONS_AT_A_TIME))
        .map(of_rows)
        .collect();
    let (sum, n) = parts.into_iter().fold((0.0, 0), |(sum, n), (s, m)| (sum + s, n + m));
    (sum / n.max(1) as f64).sqrt()
}
