//! Neighbors of the points of a cloud that span a surface.
//!
//! Scanners with few rays put points in lines: close to each other along a line, and far from the next one. The nearest
//! points of a point are then on its own line, and any surface fits a line. There the neighbors are drawn from more of
//! the nearest points, so that they are about as far apart along the lines as the lines are.

use super::fit::FitFrame;
use super::noise::distance;
use super::patches::scrambled;
use super::{FIT_SIZES, LINE_RATIO, NEIGHBORS};
use crate::shape::{Adjacency, Neighborhoods};
use crate::vector::{Vector, dot, subtract};
use crate::{Cancelled, Progress, parallel};
use std::borrow::Cow;

/// Number of nearest neighbors, of those that are drawn in lines, whose mean distance is the unit of reported noise.
const UNIT_NEIGHBORS: usize = 12;

/// Largest number of nearest points, in multiples of [`NEIGHBORS`], from which neighbors are drawn.
const MOST_WIDE: usize = 16;

/// Number of places where lines are looked for, the share of them that must be in lines, and the share of those that
/// may be so still when neighbors are drawn from more points; if more are even at the most, they are no scan lines.
const PLACES: usize = 2000;
const LEAST_LINES: f64 = 0.1;
const FEW_LINES: f64 = 0.1;
const MANY_LINES: f64 = 0.5;

/// Largest ratio of the second to the largest variance of the drawn nearest 8 that are too much of a line.
const DRAWN_RATIO: f64 = 0.3;

/// Largest ratio of the variance of a neighborhood along its normal to that along its shorter side.
const FLAT: f64 = 0.1;

/// A fence: a line of points with noise, whose nearest 8 lie in a plane upright on the surface. Largest ratio of the
/// middle to the largest variance of these 8, and of the least to the middle variance of the nearest 32; largest cosines
/// between the normal of the 32 and the normal of the 8, and between the normal of the 32 and the line.
const FENCE: f64 = 0.35;
const FENCE_TURN: f64 = 0.7;
const ALONG: f64 = 0.35;

/// A place is in lines if more than a third of the points around it are: one in three.
const LINE_PART: usize = 3;

/// Neighbors of each point in the order of their distances.
pub(in crate::denoise) struct NearestRows {
    rows: Adjacency,
    /// Binary logarithms of the numbers of nearest points of which each neighbor is drawn; empty if none are drawn.
    drawn: Vec<u8>,
}

impl NearestRows {
    /// At most [`NEIGHBORS`] of the neighbors in `near`: the nearest, and at equal distances those with the smaller
    /// index. Where a third of the points around lie in lines, a random one of each 2, 4, 8 or 16 of the nearest `most`
    /// that follow each other by distance; as few as suffice for the drawn to span a surface. `search` finds at least
    /// as many nearest points as it is told, of the points with a flag.
    pub(in crate::denoise) fn new<'a>(
        points: &[Vector],
        near: &Adjacency,
        most: usize,
        search: impl Fn(usize, &[bool]) -> Result<Cow<'a, Adjacency>, Cancelled>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n = points.len();
        let add_nearest =
            |(): &mut (), x: usize, row: &mut Vec<u32>| row.extend(nearest(points, near, x, NEIGHBORS));
        let rows = Adjacency::from_rows(n, progress, || (), add_nearest)?;
        if most <= NEIGHBORS {
            return Ok(Self { rows, drawn: Vec::new() });
        }
        let (mut is_open, mut drawn, mut one_in) = (vec![true; n], vec![Vec::new(); n], vec![0; n]);
        for i in 0..=(most / NEIGHBORS).ilog2() {
            let is_wanted = with_neighbors(&rows, &is_open);
            let near = search(NEIGHBORS << i, &is_wanted)?;
            let row = |x: usize| nearest(points, &near, x, NEIGHBORS << i);
            let is_line =
                parallel::try_collect(n, progress, |x| is_wanted[x] && is_line(points, x, &row(x), 1 << i))?;
            let found = parallel::try_collect(n, progress, |x| {
                let row = if is_open[x] { row(x) } else { Vec::new() };
                if row.len().next_multiple_of(NEIGHBORS) < NEIGHBORS << i {
                    return Some(Vec::new());
                }
                let around = rows.row(x);
                let n_in_lines = around.iter().filter(|&&y| is_line[y as usize]).count();
                (LINE_PART * n_in_lines <= around.len()).then(|| draw(&points[x], &row, i))
            })?;
            for (x, found) in found.into_iter().enumerate() {
                if let (true, Some(row)) = (is_open[x], found) {
                    (is_open[x], one_in[x]) = (false, if row.is_empty() { 0 } else { i as u8 });
                    drawn[x] = row;
                }
            }
        }
        let add_drawn = |(): &mut (), x: usize, row: &mut Vec<u32>| {
            row.extend(if drawn[x].is_empty() { rows.row(x) } else { &drawn[x] });
        };
        Ok(Self { rows: Adjacency::from_rows(n, progress, || (), add_drawn)?, drawn: one_in })
    }

    /// A length in mean distances to the 12 nearest neighbors of the rows; 0 if all points coincide.
    pub(in crate::denoise) fn in_mean_distances(
        &self,
        points: &[Vector],
        length: f64,
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        let few = |x: usize| &self.row(x)[..self.row(x).len().min(UNIT_NEIGHBORS)];
        let total = parallel::try_sum(points.len(), progress, |x| {
            few(x).iter().map(|&y| distance(&points[x], &points[y as usize])).sum()
        })?;
        let n: usize = (0..points.len()).map(|x| few(x).len()).sum();
        Ok(if total > 0.0 { length * n as f64 / total } else { 0.0 })
    }

    pub(super) fn row(&self, x: usize) -> &[u32] {
        self.rows.row(x)
    }

    /// Number of nearest points of which each neighbor of a point is drawn.
    pub(super) fn one_in(&self, x: usize) -> usize {
        self.drawn.get(x).map_or(1, |i| 1 << i)
    }

    /// Distance to the `k`-th neighbor, or to the last one; 0 without neighbors.
    pub(super) fn radius(&self, points: &[Vector], x: usize, k: usize) -> f64 {
        let row = self.row(x);
        row.get(k.min(row.len()).wrapping_sub(1)).map_or(0.0, |&y| distance(&points[x], &points[y as usize]))
    }
}

/// The neighbors of a point by their distance, at most `most`.
fn nearest(points: &[Vector], neighbors: &Adjacency, x: usize, most: usize) -> Vec<u32> {
    let square = |y: u32| {
        let d = subtract(&points[y as usize], &points[x]);
        dot(&d, &d)
    };
    let mut row: Vec<(f64, u32)> =
        neighbors.row(x).iter().filter(|&&y| y as usize != x).map(|&y| (square(y), y)).collect();
    row.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    row.truncate(most);
    row.into_iter().map(|(_, y)| y).collect()
}

/// True if the nearest points of a point span no surface, of which `row` holds at least 32 for each that is drawn: the
/// nearest 8 or 32 lie in a line; or noise makes a fence of the line; or if not all are drawn, the nearest 32 lie in no
/// plane.
fn is_line(points: &[Vector], x: usize, row: &[u32], one_in: usize) -> bool {
    let frame = |k: usize| FitFrame::new(points, x, &row[..row.len().min(k * one_in)], f64::INFINITY);
    let (few, many) = (frame(FIT_SIZES[0]), frame(FIT_SIZES[2]));
    let is_within = |axis: usize, limit: f64| dot(&few.axes[axis], &many.axes[0]).abs() < limit;
    let [least, middle, most] = many.variances;
    let is_fence = few.variances[1] < FENCE * few.variances[2]
        && least < FENCE * middle
        && is_within(0, FENCE_TURN)
        && is_within(2, ALONG);
    few.variances[1] < if one_in > 1 { DRAWN_RATIO } else { LINE_RATIO } * few.variances[2]
        || middle < LINE_RATIO * most
        || is_fence
        || (one_in > 1 && least > FLAT * middle)
}

/// A random one of each 2^i points of a row that follow each other; all of them for i = 0.
fn draw(point: &Vector, row: &[u32], i: u32) -> Vec<u32> {
    let bits = point.iter().fold(0, |bits, c| scrambled(bits ^ c.to_bits()));
    let of = |(k, few): (usize, &[u32])| match k {
        0 => few[0],
        _ => few[(scrambled(bits ^ k as u64) % few.len() as u64) as usize],
    };
    row.chunks(1 << i).enumerate().map(of).collect()
}

/// Flags of the points that have one or are in the row of one.
fn with_neighbors(rows: &Adjacency, is_open: &[bool]) -> Vec<bool> {
    let mut is_wanted = is_open.to_vec();
    for x in (0..is_open.len()).filter(|&x| is_open[x]) {
        rows.row(x).iter().for_each(|&y| is_wanted[y as usize] = true);
    }
    is_wanted
}

/// The rows of a cloud, and the number of nearest points from which they are drawn: more than [`NEIGHBORS`] where a
/// tenth of the places are in lines. `search` finds as many nearest points as it is told, of the points with a flag.
pub(in crate::denoise) fn rows_across_lines(
    points: &[Vector],
    search: impl Fn(usize, &[bool]) -> Result<Neighborhoods, Cancelled>,
    progress: Progress<'_>,
) -> Result<(NearestRows, usize), Cancelled> {
    let n = points.len();
    let place = |i: usize| if n > PLACES { (scrambled(i as u64) % n as u64) as usize } else { i };
    let places: Vec<usize> = (0..PLACES.min(n)).map(place).collect();
    let search = |k: usize, is_wanted: &[bool]| Ok(Cow::Owned(search(k, is_wanted)?.adjacency));
    let near: Cow<'_, Adjacency> = search(NEIGHBORS, &vec![true; n])?;
    let around =
        parallel::try_collect(places.len(), progress, |i| nearest(points, &near, places[i], NEIGHBORS))?;
    let mut is_wanted = vec![false; n];
    around.iter().flatten().for_each(|&y| is_wanted[y as usize] = true);
    let in_lines = |near: &Adjacency, wide: usize| {
        let is_line = parallel::try_collect(n, progress, |y| {
            is_wanted[y] && is_line(points, y, &nearest(points, near, y, FIT_SIZES[2] * wide), wide)
        })?;
        let is_in_lines =
            |row: &Vec<u32>| LINE_PART * row.iter().filter(|&&y| is_line[y as usize]).count() > row.len();
        Ok(around.iter().filter(|row| is_in_lines(row)).count() as f64 / around.len().max(1) as f64)
    };
    let first = in_lines(&near, 1)?;
    let (mut wide, mut left) = (1, first);
    while first >= LEAST_LINES && left > FEW_LINES * first && wide < MOST_WIDE && NEIGHBORS * wide < n {
        wide *= 2;
        let near: Cow<'_, Adjacency> = search(NEIGHBORS * wide, &is_wanted)?;
        left = in_lines(&near, wide)?;
    }
    let most = if left > MANY_LINES * first { NEIGHBORS } else { NEIGHBORS * wide };
    Ok((NearestRows::new(points, &near, most, search, progress)?, most))
}
