//! Thinning of clouds: a Poisson disk sample of the points.

use crate::geometry::{length, minus};
use crate::wedges::scale_to_unit_box;
use crate::{Deviation, OneSided, SimplifyError};
use adwave::shape::PointCloud;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Target of thinning.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CloudTarget {
    /// Smallest distance between kept points, in model units; every dropped point has a kept point within it.
    Spacing(f64),
    /// Number of points, reached by a search for the spacing.
    Points(usize),
    /// Number of points to a fifth, reached by fewer tries.
    About(usize),
    /// Share of the points, in (0, 1].
    Ratio(f64),
}

/// A cloud with fewer points.
#[derive(Clone, Debug)]
pub struct ThinnedCloud {
    /// Indices of the kept points, increasing.
    pub kept: Vec<u32>,
    /// Smallest allowed distance between two kept points, in model units.
    pub spacing: f64,
    /// Distances from the original points to the kept ones, with equal areas. The opposite direction is 0, because kept
    /// points are points of the original.
    pub deviation: Deviation,
}

/// Thins a cloud evenly by greedy dart throwing (`cook1986`) among its points.
///
/// Points are visited in a pseudorandom order that depends only on their positions. Each is kept unless a kept point is
/// nearer than the spacing r. Hence no two kept points are nearer than r, and every dropped point has a kept point
/// within r. Of several points at one position, only the first in the file can be kept; otherwise the order in the file
/// does not matter.
///
/// Costs O(n log n) for each spacing that is tried: one for [`CloudTarget::Spacing`], at most 12 for a number of
/// points. The number of kept points is then within 1 % of the target ([`CloudTarget::About`]: within 20 %), unless the
/// points are on a grid. The result does not depend on the number of threads.
///
/// # Errors
/// Returns a [`SimplifyError`] for an invalid target and on cancellation.
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::PointCloud;
/// use adwave_simplify::{CloudTarget, simplify_cloud};
/// let line = PointCloud::new((0..1000).map(|k| [f64::from(k) / 1000.0, 0.0, 0.0]).collect())?;
/// let thinned = simplify_cloud(&line, CloudTarget::Spacing(0.1), Progress::none())?;
/// assert!((6..=10).contains(&thinned.kept.len())); // gaps of 0.1 to 0.2
/// assert!(thinned.deviation.greatest() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify_cloud(
    cloud: &PointCloud,
    target: CloudTarget,
    progress: Progress<'_>,
) -> Result<ThinnedCloud, SimplifyError> {
    let n = cloud.points().len();
    let order = hash_order(cloud.points(), progress)?;
    let (points, unit) = scale_to_unit_box(cloud.points());
    let thin = |spacing: f64| Thinning::new(&points, spacing, &order, progress.quiet());
    let tolerance = if matches!(target, CloudTarget::About(_)) { ABOUT } else { COUNT_TOLERANCE };
    let target_count = match target {
        CloudTarget::Spacing(r) if !(r.is_finite() && r >= 0.0) => return Err(SimplifyError::Length(r)),
        CloudTarget::Spacing(0.0) => return Ok(keep_all(n)),
        CloudTarget::Spacing(r) => return finish(&thin((r / unit).max(MIN_SPACING))?, r, unit, progress),
        CloudTarget::Points(0) | CloudTarget::About(0) => return Err(SimplifyError::NoVertices),
        CloudTarget::Points(n_points) | CloudTarget::About(n_points) => n_points,
        CloudTarget::Ratio(ratio) if !(ratio > 0.0 && ratio <= 1.0) => {
            return Err(SimplifyError::Ratio(ratio));
        }
        CloudTarget::Ratio(ratio) => ((n as f64 * ratio).round() as usize).max(1),
    };
    if target_count >= n {
        return Ok(keep_all(n));
    }
    let (spacing, thinning) = thin_to_count(target_count, tolerance, progress, &thin)?;
    finish(&thinning, unit * spacing, unit, progress)
}

/// Returns the result that keeps all n points.
fn keep_all(n: usize) -> ThinnedCloud {
    ThinnedCloud { kept: (0..n as u32).collect(), spacing: 0.0, deviation: Deviation::default() }
}

/// Largest number of spacings that are tried for a number of points.
const MAX_TRIES: u64 = 12;

/// Accepted relative difference of the number of points.
const COUNT_TOLERANCE: f64 = 0.01;

/// Accepted relative difference of the number of points of [`CloudTarget::About`].
const ABOUT: f64 = 0.2;

/// Smallest spacing relative to the longest side; below it, cell numbers would be dominated by rounding.
const MIN_SPACING: f64 = 1e-12;

/// Searches for the spacing that keeps about `target_count` points, by a power law within the interval of earlier
/// tries.
fn thin_to_count<'a>(
    target_count: usize,
    tolerance: f64,
    progress: Progress<'_>,
    thin: &dyn Fn(f64) -> Result<Thinning<'a>, Cancelled>,
) -> Result<(f64, Thinning<'a>), Cancelled> {
    // On a square of side 1, n evenly spread points are about 1/√n apart.
    let mut spacing = 0.8 / (target_count as f64).sqrt();
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut best: Option<(usize, f64, Thinning<'a>)> = None;
    for try_ in 0..MAX_TRIES {
        progress.step(try_, MAX_TRIES)?;
        let thinning = thin(spacing)?;
        let count = thinning.n_kept();
        let off = count.abs_diff(target_count);
        if count > target_count {
            low = spacing;
        } else {
            high = spacing;
        }
        if best.as_ref().is_none_or(|b| off < b.0) {
            best = Some((off, spacing, thinning));
        }
        if off as f64 <= tolerance * target_count as f64 {
            break;
        }
        let by_power = spacing * (count as f64 / target_count as f64).sqrt();
        spacing = if by_power > low && by_power < high {
            by_power
        } else if high.is_finite() {
            0.5 * (low + high)
        } else {
            2.0 * spacing
        };
        if spacing <= MIN_SPACING || spacing > 4.0 {
            break;
        }
    }
    let (_, spacing, thinning) = best.expect("at least one spacing is tried");
    Ok((spacing, thinning))
}

/// Collects the kept points and measures the distances of the dropped ones.
fn finish(
    thinning: &Thinning<'_>,
    spacing: f64,
    unit: f64,
    progress: Progress<'_>,
) -> Result<ThinnedCloud, SimplifyError> {
    let kept: Vec<u32> = (0..thinning.points.len() as u32).filter(|&x| thinning.is_kept(x)).collect();
    let of_original = thinning.distances(progress)?;
    let deviation = Deviation { of_original, of_simplified: OneSided::default() };
    Ok(ThinnedCloud { kept, spacing, deviation: deviation.scaled_by(unit) })
}

/// Sorts the points by a hash of their positions (the finalizer of SplitMix64); equal positions by index.
fn hash_order(points: &[[f64; 3]], progress: Progress<'_>) -> Result<Vec<u32>, Cancelled> {
    let mix = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let hash = |p: &[f64; 3]| {
        // 0 and −0 are the same position.
        p.iter().fold(0x9e37_79b9_7f4a_7c15_u64, |h, x| mix(h.wrapping_add((x + 0.0).to_bits())))
    };
    let mut keyed: Vec<(u64, u32)> =
        points.par_iter().enumerate().map(|(x, p)| (hash(p), x as u32)).collect();
    progress.check()?;
    keyed.par_sort_unstable();
    Ok(keyed.into_iter().map(|(_, x)| x).collect())
}

/// Marker for a missing point or cell.
const NONE: u32 = u32::MAX;

/// Points in cubic cells whose side is the spacing; neighbors within the spacing lie in the 27 cells around a point.
struct Thinning<'a> {
    points: &'a [[f64; 3]],
    spacing: f64,
    /// Cell of each point.
    cell: Vec<u32>,
    /// Nonempty cells around each cell, itself included, then `NONE`.
    around: Vec<[u32; 27]>,
    /// Last kept point of each cell, the head of a linked list, or `NONE`.
    head: Vec<u32>,
    /// Previous kept point of the same cell, `NONE` for the first, or `DROPPED`.
    before: Vec<u32>,
}

/// Marker for a point that is not kept.
const DROPPED: u32 = u32::MAX - 1;

impl<'a> Thinning<'a> {
    fn new(
        points: &'a [[f64; 3]],
        spacing: f64,
        order: &[u32],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let (cell, around) = cells(points, spacing, progress)?;
        let (head, before) = (vec![NONE; around.len()], vec![DROPPED; points.len()]);
        let mut thinning = Self { points, spacing, cell, around, head, before };
        for (k, &x) in order.iter().enumerate() {
            if k % 4096 == 0 {
                progress.check()?;
            }
            if !thinning.has_near(x) {
                let cell = thinning.cell[x as usize] as usize;
                thinning.before[x as usize] = thinning.head[cell];
                thinning.head[cell] = x;
            }
        }
        Ok(thinning)
    }

    fn is_kept(&self, x: u32) -> bool {
        self.before[x as usize] != DROPPED
    }

    fn n_kept(&self) -> usize {
        self.before.iter().filter(|&&before| before != DROPPED).count()
    }

    /// Iterates over the kept points in the cells around a point.
    fn near(&self, x: u32) -> impl Iterator<Item = u32> + '_ {
        let around = &self.around[self.cell[x as usize] as usize];
        around.iter().take_while(|&&cell| cell != NONE).flat_map(move |&cell| {
            let first = Some(self.head[cell as usize]).filter(|&y| y != NONE);
            std::iter::successors(first, |&y| Some(self.before[y as usize]).filter(|&y| y != NONE))
        })
    }

    fn distance(&self, x: u32, y: u32) -> f64 {
        length(minus(self.points[x as usize], self.points[y as usize]))
    }

    fn has_near(&self, x: u32) -> bool {
        self.near(x).any(|y| self.distance(x, y) < self.spacing)
    }

    /// Measures the distance from each dropped point to the nearest kept one.
    fn distances(&self, progress: Progress<'_>) -> Result<OneSided, Cancelled> {
        let chunk = |c: usize| {
            progress.check()?;
            let range = c * POINTS_PER_CHUNK..((c + 1) * POINTS_PER_CHUNK).min(self.points.len());
            let (mut greatest, mut squares) = (0.0_f64, 0.0);
            for x in range.map(|x| x as u32).filter(|&x| !self.is_kept(x)) {
                let nearest = self.near(x).map(|y| self.distance(x, y)).fold(f64::INFINITY, f64::min);
                greatest = greatest.max(nearest);
                squares += nearest * nearest;
            }
            Ok((greatest, squares))
        };
        let n = self.points.len();
        let chunks: Vec<_> =
            (0..n.div_ceil(POINTS_PER_CHUNK)).into_par_iter().map(chunk).collect::<Result<_, Cancelled>>()?;
        let (greatest, squares) =
            chunks.into_iter().fold((0.0_f64, 0.0), |sum, c| (sum.0.max(c.0), sum.1 + c.1));
        Ok(OneSided { greatest, at_least: greatest, rms: (squares / n as f64).sqrt() })
    }
}

/// Number of points that a thread processes at a time.
const POINTS_PER_CHUNK: usize = 1 << 12;

/// Computes the cell of each point, numbered by coordinates, and the nonempty cells around each cell.
fn cells(
    points: &[[f64; 3]],
    spacing: f64,
    progress: Progress<'_>,
) -> Result<(Vec<u32>, Vec<[u32; 27]>), Cancelled> {
    let coordinates = |p: &[f64; 3]| -> [i64; 3] { std::array::from_fn(|c| (p[c] / spacing).floor() as i64) };
    let coordinates: Vec<[i64; 3]> = points.par_iter().map(coordinates).collect();
    let mut cells = coordinates.clone();
    cells.par_sort_unstable();
    cells.dedup();
    progress.check()?;
    let find = |key: &[i64; 3]| cells.partition_point(|cell| cell < key);
    let cell = coordinates.par_iter().map(|key| find(key) as u32).collect();
    progress.check()?;
    let around = cells.par_iter().map(|&[x, y, z]| {
        let (mut neighbors, mut n) = ([NONE; 27], 0);
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            // Cells that differ in z only are consecutive.
            let column = [x + dx, y + dy];
            let first = find(&[column[0], column[1], z - 1]);
            for (k, cell) in cells.iter().enumerate().skip(first).take(3) {
                if cell[..2] == column && cell[2] <= z + 1 {
                    neighbors[n] = k as u32;
                    n += 1;
                }
            }
        }
        neighbors
    });
    Ok((cell, around.collect()))
}
