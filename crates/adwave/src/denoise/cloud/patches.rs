//! Quadrics over wide neighborhoods of some of the points, for noise as large as the points are apart and for lines of
//! a scanner.
//!
//! The nearest neighbors of a point with a large error are those with a similar error, so a fit to few of them finds
//! too little noise. A patch is fitted to the points of a cylinder inside a larger ball, which is unbiased as long as
//! the noise stays inside. Each point is within several patches, and their mean has less noise than each.

use super::fit::{FitFrame, HeightFit, basis, factorize, substitute};
use super::noise::{SmallFits, distance, one_sheet_deviation};
use super::{FIT_SIZES, NOTHING, NearestRows, median};
use crate::vector::{Vector, add_scaled, dot, subtract};
use crate::{Cancelled, Progress, parallel};
use std::ops::Range;

/// Numbers of neighbors of the patches.
const PATCH_SIZES: [usize; 4] = [48, 120, 300, 700];

/// Number of rings of neighbors that contain them, each ring around the centers of patches within the last.
const PATCH_RINGS: [usize; 4] = [2, 3, 5, 7];

/// Number of nearest points among which the center of a patch has the smallest residual.
const APART: usize = 7;

/// Height of a cylinder in standard deviations of the heights, and its largest and smallest radius relative to its
/// ball.
const CYLINDER_HEIGHT: f64 = 3.0;
const LEAST_RADIUS: f64 = 0.6;

/// Part of the radius within which the residuals of a patch show its bias.
const CENTRAL: f64 = 0.35;

/// Fewest points of a patch.
const FEWEST: usize = 15;

/// Largest noise of a patch relative to the radius of its ball.
const FLAT: f64 = 0.25;

/// The same for the larger patch if the largest is not needed, which is used if it finds about the same noise.
const VERY_FLAT: f64 = 0.15;
const SAME_NOISE: f64 = 1.15;

/// The same for the largest patch: a volume has more.
const VOLUME: f64 = 0.34;

/// Noise relative to the distance to the 32nd neighbor from which small neighborhoods show too little of it.
const STRONG: f64 = 0.1;

/// The same for the noise of a patch from which all around it need patches.
const VERY_STRONG: f64 = 0.25;

/// Cosine of the largest angle between the normals of two sizes of neighborhoods of the same surface.
const SAME_NORMAL: f64 = 0.5;

/// Ratio of the second to the largest variance below which a neighborhood is a line.
const PATCH_LINE: f64 = 0.1;

/// Number of times that a patch is fitted again around its own surface, if that is farther from its center than this
/// part of its ball.
const RECENTERINGS: usize = 6;
const LEAST_RECENTERING: f64 = 0.05;

/// Number of patches at a time that a thread fits.
const AT_A_TIME: usize = 256;

/// Quadric over the tangent plane of a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Point on the surface, near the center.
    origin: Vector,
    axes: [Vector; 3],
    /// Radius of the cylinder.
    radius: f64,
    /// Coefficients for tangential coordinates in units of the radius.
    coefficients: [f64; 6],
    /// Cholesky factor of the normal equations.
    factor: [[f64; 6]; 6],
    /// Standard deviation of the residuals.
    pub(super) deviation: f64,
    /// Squared mean of the central residuals, less its expectation for white noise, in units of the noise.
    bias: f64,
    /// Radius of the ball.
    ball: f64,
}

impl Patch {
    /// Patch for the points `row`, the nearest of `origin`, in this order.
    fn new(points: &[Vector], origin: Vector, row: &[u32]) -> Option<Self> {
        let ball = distance(&points[*row.last()? as usize], &origin);
        if row.len() < FEWEST || ball < NOTHING {
            return None;
        }
        let FitFrame { axes, variances } = FitFrame::new(points, &origin, row, f64::INFINITY);
        if variances[1] < PATCH_LINE * variances[2] {
            return None;
        }
        let height = (CYLINDER_HEIGHT * CYLINDER_HEIGHT * variances[0])
            .min((1.0 - LEAST_RADIUS * LEAST_RADIUS) * ball * ball);
        let radius = (ball * ball - height).sqrt();
        let mut patch = Self {
            origin,
            axes,
            radius,
            coefficients: [0.0; 6],
            factor: [[0.0; 6]; 6],
            deviation: 0.0,
            bias: 0.0,
            ball,
        };
        let inside: Vec<([f64; 2], f64)> = row
            .iter()
            .map(|&y| patch.coordinates(&points[y as usize]))
            .filter(|([u, v], _)| u * u + v * v <= 1.0)
            .collect();
        if inside.len() < FEWEST {
            return None;
        }
        let mut right = [0.0; 6];
        for &(tangential, height) in &inside {
            let f = basis::<6>(tangential);
            for i in 0..6 {
                for j in 0..=i {
                    patch.factor[i][j] += f[i] * f[j];
                }
                right[i] += f[i] * height;
            }
        }
        if !factorize(&mut patch.factor) {
            return None;
        }
        patch.coefficients = substitute(&patch.factor, right);
        let n = inside.len() as f64;
        let residual = |(at, height): &([f64; 2], f64)| height - patch.height(*at);
        let is_central = |([u, v], _): &&([f64; 2], f64)| u * u + v * v < CENTRAL * CENTRAL;
        let central: Vec<f64> = inside.iter().filter(is_central).map(residual).collect();
        let mut residuals: Vec<f64> = inside.iter().map(|point| residual(point).abs()).collect();
        patch.deviation = one_sheet_deviation(&mut residuals) * (n / (n - 6.0)).sqrt();
        if !central.is_empty() && patch.deviation > NOTHING {
            let n = central.len() as f64;
            patch.bias = (central.iter().sum::<f64>() / (n * patch.deviation)).powi(2) - 1.0 / n;
        }
        Some(patch)
    }

    /// Tangential coordinates of a point in units of the radius, and its height.
    fn coordinates(&self, point: &Vector) -> ([f64; 2], f64) {
        let d = subtract(point, &self.origin);
        let [normal, first, second] = &self.axes;
        ([dot(&d, first) / self.radius, dot(&d, second) / self.radius], dot(&d, normal))
    }

    fn height(&self, tangential: [f64; 2]) -> f64 {
        let f = basis::<6>(tangential);
        (0..6).map(|i| self.coefficients[i] * f[i]).sum()
    }

    /// Motion of a point onto the patch, its leverage and its weight; `None` outside.
    fn motion(&self, point: &Vector) -> Option<(Vector, f64, f64)> {
        let (at, height) = self.coordinates(point);
        let [u, v] = at;
        let square = u * u + v * v;
        if square > 1.0 {
            return None;
        }
        let [_, b, c, d, e, f] = self.coefficients;
        let slopes = [(b + 2.0 * d * u + e * v) / self.radius, (c + e * u + 2.0 * f * v) / self.radius];
        let fit = HeightFit { height: self.height(at) - height, variance: 0.0, slopes };
        let frame = FitFrame { axes: self.axes, variances: [0.0; 3] };
        let (f, solved) = (basis::<6>(at), substitute(&self.factor, basis::<6>(at)));
        let leverage = (0..6).map(|i| f[i] * solved[i]).sum();
        Some((fit.motion(&frame), leverage, (1.0 - square).powi(2)))
    }
}

/// Patches around some of the points, the centers.
pub(super) struct Patches {
    /// Index of the patches of each point that is a center; `u32::MAX` for others.
    numbers: Vec<u32>,
    centers: Vec<u32>,
    of_center: Vec<CenterPatches>,
}

/// Patches of a center.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CenterPatches {
    /// The patches of the second and the third of the sizes.
    wide: [Option<Patch>; 2],
    /// Standard deviation of the noise if small neighborhoods do not show it.
    level: Option<f64>,
}

impl CenterPatches {
    /// Adds the patches that noise of the size of the neighborhoods needs, fitted by `patch`, which takes the number of a
    /// size.
    fn widen(&mut self, mut patch: impl FnMut(usize) -> Option<Patch>) {
        let large = patch(2);
        let largest = if large.as_ref().is_some_and(is_flat(VERY_FLAT)) { None } else { patch(3) };
        let is_as_flat = |p: &Patch| large.is_none_or(|q| p.deviation <= SAME_NOISE * q.deviation);
        let widest = largest.filter(is_as_flat).or(large).filter(is_flat(VOLUME));
        let sizes = [patch(0), self.wide[0], large, widest];
        // A strip along a line of a scanner is flat too, but wider neighborhoods are turned against it.
        let known = |c: usize| {
            let p = sizes[c].filter(|p| c == 3 || is_flat(FLAT)(p))?;
            let wider = sizes[c + 1..].iter().flatten().next();
            let agrees = |q: &Patch| !is_turned(&p.axes[0], &q.axes[0]);
            wider.is_none_or(agrees).then_some(p.deviation)
        };
        self.level = (0..4).find_map(known);
        self.wide = [self.wide[0].filter(is_flat(FLAT)), widest];
    }
}

fn is_flat(limit: f64) -> impl Fn(&Patch) -> bool {
    move |p| p.deviation <= limit * p.ball
}

/// True if two normals are not those of neighborhoods of one surface.
fn is_turned(normal: &Vector, other: &Vector) -> bool {
    dot(normal, other).abs() < SAME_NORMAL
}

/// Points around a point.
struct Gathering {
    /// The last point around which each was gathered.
    last: Vec<u32>,
    found: Vec<u32>,
    by_distance: Vec<(f64, u32)>,
    /// The gathered points in the order of their distances.
    row: Vec<u32>,
}

impl Gathering {
    fn new(n: usize) -> Self {
        Self { last: vec![u32::MAX; n], found: Vec::new(), by_distance: Vec::new(), row: Vec::new() }
    }

    /// Gathers the points within some rings of neighbors around `x`, and itself.
    fn gather(&mut self, near: &NearestRows, numbers: &[u32], x: usize, rings: usize) {
        self.found.clear();
        self.found.push(x as u32);
        self.last[x] = x as u32;
        let mut first = 0;
        for _ in 0..rings {
            let end = self.found.len();
            for k in first..end {
                let y = self.found[k] as usize;
                if y != x && numbers[y] == u32::MAX {
                    continue;
                }
                for &z in near.row(y) {
                    if self.last[z as usize] != x as u32 {
                        self.last[z as usize] = x as u32;
                        self.found.push(z);
                    }
                }
            }
            first = end;
        }
        // So that the same point can be gathered with more rings.
        for &y in &self.found {
            self.last[y as usize] = u32::MAX;
        }
    }

    /// The `n` gathered points nearest to a position, in the order of their distances.
    fn nearest(&mut self, points: &[Vector], origin: &Vector, n: usize) -> &[u32] {
        self.by_distance.clear();
        self.by_distance.extend(self.found.iter().map(|&y| {
            let d = subtract(&points[y as usize], origin);
            (dot(&d, &d), y)
        }));
        let order = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if self.by_distance.len() > n {
            self.by_distance.select_nth_unstable_by(n - 1, order);
            self.by_distance.truncate(n);
        }
        self.by_distance.sort_unstable_by(order);
        self.row.clear();
        self.row.extend(self.by_distance.iter().map(|&(_, y)| y));
        &self.row
    }

    /// Patch of a size around a point, and around its own surface.
    fn patch(
        &mut self,
        points: &[Vector],
        near: &NearestRows,
        numbers: &[u32],
        x: usize,
        size: usize,
    ) -> Option<Patch> {
        self.gather(near, numbers, x, PATCH_RINGS[size]);
        let (center, n) = (&points[x], PATCH_SIZES[size]);
        let mut patch = Patch::new(points, *center, self.nearest(points, center, n))?;
        for _ in 0..RECENTERINGS {
            let (motion, ..) = patch.motion(center)?;
            let origin = add_scaled(center, 1.0, &motion);
            if distance(&origin, &patch.origin) < LEAST_RECENTERING * patch.ball {
                break;
            }
            patch = Patch::new(points, origin, self.nearest(points, &origin, n))?;
        }
        Some(patch)
    }
}

impl Patches {
    /// Patches of the second size around points whose residual is the smallest of their nearest.
    pub(super) fn new(
        points: &[Vector],
        near: &NearestRows,
        fits: &[SmallFits],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let is_center = parallel::try_collect(points.len(), progress, |x| {
            let residual = |y: usize| fits[y].residuals[1];
            let is_smaller =
                |&y: &u32| residual(x).total_cmp(&residual(y as usize)).then((x as u32).cmp(&y)).is_lt();
            let row = near.row(x);
            row.len() >= FIT_SIZES[0] && row.iter().take(APART).all(is_smaller)
        })?;
        let centers: Vec<u32> = (0..points.len()).filter(|&x| is_center[x]).map(|x| x as u32).collect();
        let mut numbers = vec![u32::MAX; points.len()];
        for (k, &x) in centers.iter().enumerate() {
            numbers[x as usize] = k as u32;
        }
        let mut out = Self { numbers, of_center: vec![CenterPatches::default(); centers.len()], centers };
        out.visit(points.len(), progress, |out, gathering, k| {
            let x = out.centers[k] as usize;
            let patch = gathering.patch(points, near, &out.numbers, x, 1).filter(is_flat(VOLUME));
            CenterPatches { wide: [patch, None], level: None }
        })?;
        Ok(out)
    }

    /// Adds wider patches where the noise is too large for small neighborhoods, or these are no surfaces. `small` is the
    /// noise that they show, NaN where they show none.
    pub(super) fn widen(
        &mut self,
        points: &[Vector],
        near: &NearestRows,
        small: &[f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let radius = |x: usize| near.radius(points, x, FIT_SIZES[2]);
        self.visit(points.len(), progress, |out, gathering, k| {
            let (x, mut patches) = (out.centers[k] as usize, out.of_center[k]);
            if small[x].is_nan() || small[x] > STRONG * radius(x) {
                patches.widen(|c| gathering.patch(points, near, &out.numbers, x, c));
            }
            patches
        })?;
        // The neighbors of a point with a large error have similar errors, and small neighborhoods show none of it.
        self.visit(points.len(), progress, |out, gathering, k| {
            let (x, mut patches) = (out.centers[k] as usize, out.of_center[k]);
            let is_strong = |p: &CenterPatches| p.level.is_some_and(|level| level > VERY_STRONG * radius(x));
            if patches.level.is_none() && out.around(near, x).any(is_strong) {
                patches.widen(|c| gathering.patch(points, near, &out.numbers, x, c));
            }
            patches
        })
    }

    /// Replaces the patches of each center by those that `work` returns for its number.
    fn visit(
        &mut self,
        n_points: usize,
        progress: Progress<'_>,
        work: impl Fn(&Self, &mut Gathering, usize) -> CenterPatches + Sync + Send,
    ) -> Result<(), Cancelled> {
        let all = |gathering: &mut Gathering, range: Range<usize>| {
            range.map(|k| work(self, gathering, k)).collect::<Vec<CenterPatches>>()
        };
        let scratch = || Gathering::new(n_points);
        self.of_center =
            parallel::try_map_chunks(self.centers.len(), AT_A_TIME, progress, scratch, all)?.concat();
        Ok(())
    }

    /// True if most patches around a point have other normals than its nearest neighbors, as those of a single line of a
    /// scanner.
    pub(super) fn is_turned(&self, near: &NearestRows, fits: &[SmallFits], x: usize) -> bool {
        let (mut n, mut n_turned) = (0, 0);
        for patch in self.around(near, x).filter_map(|p| p.wide[0].as_ref()) {
            n += 1;
            n_turned += usize::from(is_turned(&patch.axes[0], &fits[x].normal));
        }
        2 * n_turned > n
    }

    /// Patches whose centers are a point and its neighbors.
    fn around<'a>(&'a self, near: &'a NearestRows, x: usize) -> impl Iterator<Item = &'a CenterPatches> {
        let all = near.row(x).iter().map(|&y| y as usize).chain([x]);
        all.filter_map(|y| self.of_center.get(self.numbers[y] as usize))
    }

    /// Median of the noise around a point, of patches or of small neighborhoods, whichever their centers need; NaN if
    /// it is unknown.
    pub(super) fn level(&self, points: &[Vector], near: &NearestRows, small: &[f64], x: usize) -> f64 {
        let mut wide: Vec<f64> = self.around(near, x).filter_map(|p| p.level).collect();
        if wide.is_empty() {
            return small[x];
        }
        let level = median(&mut wide);
        if level > VERY_STRONG * near.radius(points, x, FIT_SIZES[2]) {
            return level;
        }
        let centers = near.row(x).iter().map(|&y| y as usize).chain([x]);
        let level = |y: usize| self.of_center.get(self.numbers[y] as usize)?.level.or(Some(small[y]));
        let mut levels: Vec<f64> = centers.filter_map(level).filter(|level| level.is_finite()).collect();
        median(&mut levels)
    }

    /// Mean motion of a point by the patches of each size around it; if there are none, by those around its neighbors.
    pub(super) fn motions(
        &self,
        points: &[Vector],
        near: &NearestRows,
        x: usize,
    ) -> [Option<PatchMotion>; 2] {
        let mut means = [PatchMotion::default(); 2];
        let mut add = |y: usize| {
            for patches in self.around(near, y) {
                for (mean, patch) in means.iter_mut().zip(&patches.wide) {
                    mean.add(patch.as_ref(), &points[x]);
                }
            }
            means.iter().any(|mean| mean.weight > 0.0)
        };
        if !add(x) {
            near.row(x).iter().for_each(|&y| {
                add(y as usize);
            });
        }
        means.map(|mean| (mean.weight > 0.0).then(|| mean.normalized()))
    }
}

/// Mean motion of a point by patches.
#[derive(Clone, Copy, Default)]
pub(super) struct PatchMotion {
    pub(super) motion: Vector,
    pub(super) leverage: f64,
    /// Squared bias in units of σ².
    pub(super) bias: f64,
    weight: f64,
}

impl PatchMotion {
    fn add(&mut self, patch: Option<&Patch>, point: &Vector) {
        if let Some(patch) = patch
            && let Some((motion, leverage, weight)) = patch.motion(point)
        {
            self.motion = add_scaled(&self.motion, weight, &motion);
            self.leverage += weight * leverage;
            self.bias += weight * patch.bias;
            self.weight += weight;
        }
    }

    fn normalized(self) -> Self {
        let share = 1.0 / self.weight;
        Self {
            motion: self.motion.map(|c| c * share),
            leverage: self.leverage * share,
            bias: self.bias * share,
            weight: 1.0,
        }
    }
}
