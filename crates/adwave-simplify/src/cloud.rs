//! Clouds: a Poisson disk sample of the points.

use crate::wedges::{in_unit_box, length, minus};
use crate::{Deviation, OneSided, SimplifyError};
use adwave::shape::PointCloud;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// What to aim at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CloudTarget {
    /// No two points are nearer than this, in model units, and every dropped one has a kept one within it.
    Spacing(f64),
    /// So many points, by a search for that spacing.
    Points(usize),
    /// This share of the points.
    Ratio(f64),
}

/// A cloud with fewer points.
#[derive(Clone, Debug)]
pub struct ThinnedCloud {
    /// Which points are kept, increasing.
    pub kept: Vec<u32>,
    /// No two are nearer, in model units.
    pub spacing: f64,
    /// From the points to the kept ones, each with the same area; nothing is measured the other way, as kept points are points
    /// of the original.
    pub deviation: Deviation,
}

/// Fewer points, evenly: greedy dart throwing (`cook1986`) among the points themselves.
///
/// Points are taken in an order that looks like chance and depends on their positions alone, and each is kept unless a kept one
/// is nearer than the spacing r. So no two kept points are nearer than r, every dropped one has a kept one within r, and of
/// points at one position the first stays. The order of the points in the file changes nothing but which of equal ones that is.
///
/// O(n log n) for each spacing that is tried: one for [`CloudTarget::Spacing`], at most 12 for a number, which come within 1 %
/// where the points are not on a grid. The same input gives the same bits on any number of threads.
///
/// # Errors
/// [`SimplifyError`]: a target that cannot be, or a stop.
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
    let order = order(cloud.points(), progress)?;
    let (points, unit) = in_unit_box(cloud.points());
    let thin = |spacing: f64| Thinning::new(&points, spacing, &order, progress.quiet());
    let wanted = match target {
        CloudTarget::Spacing(r) if !(r.is_finite() && r >= 0.0) => return Err(SimplifyError::Length(r)),
        CloudTarget::Spacing(0.0) => return Ok(all(n)),
        CloudTarget::Spacing(r) => return finish(&thin((r / unit).max(LEAST_SPACING))?, r, unit, progress),
        CloudTarget::Points(0) => return Err(SimplifyError::NoVertices),
        CloudTarget::Points(wanted) => wanted,
        CloudTarget::Ratio(ratio) if !(ratio > 0.0 && ratio <= 1.0) => {
            return Err(SimplifyError::Ratio(ratio));
        }
        CloudTarget::Ratio(ratio) => ((n as f64 * ratio).round() as usize).max(1),
    };
    if wanted >= n {
        return Ok(all(n));
    }
    let (spacing, thinning) = of_number(wanted, progress, &thin)?;
    finish(&thinning, unit * spacing, unit, progress)
}

/// Every point kept.
fn all(n: usize) -> ThinnedCloud {
    ThinnedCloud { kept: (0..n as u32).collect(), spacing: 0.0, deviation: Deviation::default() }
}

/// Spacings that are tried for one number.
const TRIES: u64 = 12;

/// A number that differs by less than this share is near enough.
const NEAR_ENOUGH: f64 = 0.01;

/// The least spacing, as a share of the longest side, which is rounding: cells are counted in whole numbers.
const LEAST_SPACING: f64 = 1e-12;

/// The spacing that leaves about so many points: by the power law between the two nearest tries, kept between them.
fn of_number<'a>(
    wanted: usize,
    progress: Progress<'_>,
    thin: &dyn Fn(f64) -> Result<Thinning<'a>, Cancelled>,
) -> Result<(f64, Thinning<'a>), Cancelled> {
    // On a square of side 1, n points as far apart as they can be are about 1/√n apart.
    let mut spacing = 0.8 / (wanted as f64).sqrt();
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut best: Option<(usize, f64, Thinning<'a>)> = None;
    for try_ in 0..TRIES {
        progress.step(try_, TRIES)?;
        let thinning = thin(spacing)?;
        let count = thinning.n_kept();
        let off = count.abs_diff(wanted);
        if count > wanted {
            low = spacing;
        } else {
            high = spacing;
        }
        if best.as_ref().is_none_or(|b| off < b.0) {
            best = Some((off, spacing, thinning));
        }
        if off as f64 <= NEAR_ENOUGH * wanted as f64 {
            break;
        }
        let by_power = spacing * (count as f64 / wanted as f64).sqrt();
        spacing = if by_power > low && by_power < high {
            by_power
        } else if high.is_finite() {
            0.5 * (low + high)
        } else {
            2.0 * spacing
        };
        if spacing <= LEAST_SPACING || spacing > 4.0 {
            break;
        }
    }
    let (_, spacing, thinning) = best.expect("at least one spacing is tried");
    Ok((spacing, thinning))
}

/// Measures what was dropped.
fn finish(
    thinning: &Thinning<'_>,
    spacing: f64,
    unit: f64,
    progress: Progress<'_>,
) -> Result<ThinnedCloud, SimplifyError> {
    let kept: Vec<u32> = (0..thinning.points.len() as u32).filter(|&x| thinning.is_kept(x)).collect();
    let of_original = thinning.distances(progress)?;
    let deviation = Deviation { of_original, of_simplified: OneSided::default() };
    Ok(ThinnedCloud { kept, spacing, deviation: deviation.times(unit) })
}

/// The points in the order of a hash of their positions (the finalizer of SplitMix64), those at one position by index.
fn order(points: &[[f64; 3]], progress: Progress<'_>) -> Result<Vec<u32>, Cancelled> {
    let mix = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let hash = |p: &[f64; 3]| {
        // 0 and −0 are one position.
        p.iter().fold(0x9e37_79b9_7f4a_7c15_u64, |h, x| mix(h.wrapping_add((x + 0.0).to_bits())))
    };
    let mut keyed: Vec<(u64, u32)> =
        points.par_iter().enumerate().map(|(x, p)| (hash(p), x as u32)).collect();
    progress.check()?;
    keyed.par_sort_unstable();
    Ok(keyed.into_iter().map(|(_, x)| x).collect())
}

/// No point or cell.
const NONE: u32 = u32::MAX;

/// Points in cubes of the spacing: what is nearer than the spacing lies in the 27 cells round a point.
struct Thinning<'a> {
    points: &'a [[f64; 3]],
    spacing: f64,
    /// The cell of each point.
    cell: Vec<u32>,
    /// The cells round each cell that hold points, itself among them.
    around: Vec<[u32; 27]>,
    /// The kept point last found in each cell, and the one before each kept point.
    head: Vec<u32>,
    before: Vec<u32>,
}

/// A point that is not kept.
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

    /// The kept points in the cells round a point.
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

    /// From each point to the nearest that is kept.
    fn distances(&self, progress: Progress<'_>) -> Result<OneSided, Cancelled> {
        let chunk = |c: usize| {
            progress.check()?;
            let range = c * AT_A_TIME..((c + 1) * AT_A_TIME).min(self.points.len());
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
            (0..n.div_ceil(AT_A_TIME)).into_par_iter().map(chunk).collect::<Result<_, Cancelled>>()?;
        let (greatest, squares) =
            chunks.into_iter().fold((0.0_f64, 0.0), |sum, c| (sum.0.max(c.0), sum.1 + c.1));
        Ok(OneSided { greatest, rms: (squares / n as f64).sqrt() })
    }
}

/// Points that a thread looks at in one go.
const AT_A_TIME: usize = 1 << 12;

/// The cell of each point, numbered in the order of their coordinates, and those round each.
fn cells(
    points: &[[f64; 3]],
    spacing: f64,
    progress: Progress<'_>,
) -> Result<(Vec<u32>, Vec<[u32; 27]>), Cancelled> {
    let place = |p: &[f64; 3]| -> [i64; 3] { std::array::from_fn(|c| (p[c] / spacing).floor() as i64) };
    let places: Vec<[i64; 3]> = points.par_iter().map(place).collect();
    let mut cells = places.clone();
    cells.par_sort_unstable();
    cells.dedup();
    progress.check()?;
    let find = |place: &[i64; 3]| cells.partition_point(|cell| cell < place);
    let cell = places.par_iter().map(|place| find(place) as u32).collect();
    progress.check()?;
    let around = cells.par_iter().map(|&[x, y, z]| {
        let (mut found, mut n) = ([NONE; 27], 0);
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            // Those above one another follow each other.
            let column = [x + dx, y + dy];
            let first = find(&[column[0], column[1], z - 1]);
            for (k, cell) in cells.iter().enumerate().skip(first).take(3) {
                if cell[..2] == column && cell[2] <= z + 1 {
                    found[n] = k as u32;
                    n += 1;
                }
            }
        }
        found
    });
    Ok((cell, around.collect()))
}
