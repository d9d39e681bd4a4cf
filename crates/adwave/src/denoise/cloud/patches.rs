//! Patches: quadrics over more neighbors than the fits of single points have.
//!
//! They remove weak noise better where the surface bends little: the risk decides. Noise that is larger than about
//! half the distance of the points hides from small neighborhoods: the nearest points of a point with a large error are
//! those with a similar error. A neighborhood that is flat (much wider than thick) does not hide it. Strong noise is
//! looked for at some places of the cloud; only if most of them agree, and their residuals are distributed as those of
//! one sheet, points move by patches alone. Two sheets are told by the mean of their absolute residuals, which is
//! closer to the root mean square than that of normal deviates (Geary's ratio).

// Code compiled for several instruction sets must be inlined into the function that selects one.
#![allow(clippy::inline_always)]

use super::fit::{FitFrame, basis, factorize, principal_axes, substitute};
use super::lanes::{FitSums, FourValues, LANES};
use super::{CAUTION, FARTHEST, LINE_RATIO, NEIGHBORS, NOTHING, NearestRows, quantile};
use crate::denoise::noise_level::median;
use crate::denoise::params::StrongNoise;
use crate::vector::{Vector, add_scaled, dot, norm, subtract};
use crate::{Cancelled, Progress, parallel};
use pulp::{Arch, NullaryFnOnce};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::PI;

/// Numbers of neighbors of the quadrics. Each is at most a quarter of the points.
const SIZES: [usize; 7] = [16, 32, 64, 128, 256, 512, 768];

/// Number of nearest neighbors of a found point that may be found next.
const OFFERED: usize = 16;

/// Number of places where strong noise is looked for, and the share of them that must be flat at some size.
const PLACES: usize = 2000;
const FEWEST_FLAT: f64 = 0.3;

/// Largest ratio of the smallest to the middle spread of a flat neighborhood.
const FLAT: f64 = 0.5;

/// Weight of the cubed flatness in the noise: a ball around a point cuts off the largest deviations. Measured on
/// spheres: 0.96 of the noise is found at a flatness of 0.46, and 0.88 at 0.6.
const CUT_OFF: f64 = 0.5;

/// Noise in distances of points from which it is strong.
const STRONG: f64 = 0.6;

/// Share of the flat places that must have strong noise.
const MOST_PLACES: f64 = 0.5;

/// Range of the mean of Geary's ratio over all places; it is 0.798 for normal deviates, and 0.82 for two sheets that
/// are 2 standard deviations apart.
const ONE_SHEET: [f64; 2] = [0.77, 0.811];

/// Excess of Geary's ratio of a place over that range, times the square root of the number of neighbors, from which the
/// place alone is known to hold two sheets: about two standard deviations.
const TWO_SHEETS: f64 = 1.2;

/// Noise in distances of points from which the residuals of a place tell one sheet from two, the share of the places that
/// must have it for that, and the largest median growth to the next size, beyond which it is bending.
const TELLING: f64 = 0.2;
const MOST_TELLING: f64 = 0.5;
const TELLING_GROWTH: f64 = 1.2;

/// Geary's ratio of a patch, and its largest deviations for many and for few patches around it.
const PATCH_RATIO: f64 = 0.795;
const RATIO_MARGINS: [f64; 2] = [0.03, 0.1];

/// Largest growth of the noise from the first flat size to the next: beyond, it is bending.
const GROWTH: f64 = 1.25;

/// Number of centers of patches in a flat neighborhood, and smallest number of points a center.
const CENTERS: f64 = 5.0;
const POINTS_A_CENTER: f64 = 4.0;

/// Number of neighbors that the fits to weak noise have at least; they have up to four times as many, and more where
/// the rows of neighbors are drawn from the nearest.
const WEAK_NEIGHBORS: usize = 64;

/// Largest ratio of weak noise that patches see to that which the other fits find.
const MOST_MORE: f64 = 1.25;

/// Number of sizes beyond the first flat one, for strong noise.
const MORE_SIZES: usize = 3;

/// Number of centers around one whose noise is pooled, and the least number of them that must be flat.
const POOL: usize = 24;
const LEAST_POOL: usize = 3;

/// Share of the excess of the residuals of a patch that is its squared error, and the leverage of a patch in parts of
/// a point.
const BIAS: f64 = 0.5;
const LEVERAGE: f64 = 4.0;

/// Largest excess of the residuals of a patch over the noise, in standard deviations of their root mean square: a patch
/// beyond it holds some points of another sheet.
const OWN_MARGIN: f64 = 2.5;

/// Part of the excess of the squared residuals around a center that may be chance, in standard deviations of the squared
/// noise of one patch.
const CHANCE: f64 = 1.4;

/// Least sum of the weights of patches that decide a point.
const LEAST_WEIGHT: f64 = 0.05;

/// Number of centers whose motions are held at a time.
const BATCH: usize = 4096;

/// Noise and motions of the points that patches cover.
pub(super) struct Patches {
    /// Standard deviation of the noise; 0 for points that no patch covers.
    pub(super) noise: Vec<f64>,
    pub(super) motions: Vec<Vector>,
    /// Variance of each motion for noise of variance 1; infinite for points that no patch covers.
    pub(super) leverages: Vec<f64>,
}

/// Points nearest to a position, found along the rows of neighbors.
struct Search {
    seen: Vec<u32>,
    round: u32,
    /// Squared distances as bits, which ascend as they do, and points.
    next: BinaryHeap<Reverse<(u64, u32)>>,
    at: Vector,
    found: Vec<u32>,
}

impl Search {
    fn new(n: usize) -> Self {
        Self { seen: vec![0; n], round: 0, next: BinaryHeap::new(), at: [0.0; 3], found: Vec::new() }
    }

    /// Begins at the points `from` near the position `at`.
    fn start(&mut self, points: &[Vector], at: Vector, from: &[u32]) {
        self.round += 1;
        self.next.clear();
        self.found.clear();
        self.at = at;
        for &y in from {
            self.offer(points, y);
        }
    }

    fn offer(&mut self, points: &[Vector], y: u32) {
        let seen = &mut self.seen[y as usize];
        if *seen != self.round {
            *seen = self.round;
            let d = subtract(&points[y as usize], &self.at);
            self.next.push(Reverse((dot(&d, &d).to_bits(), y)));
        }
    }

    /// Finds points until there are `k`; false if fewer are connected.
    fn extend(&mut self, points: &[Vector], near: &NearestRows, k: usize) -> bool {
        while self.found.len() < k {
            let Some(Reverse((_, y))) = self.next.pop() else { return false };
            self.found.push(y);
            let row = near.row(y as usize);
            row[..row.len().min(OFFERED)].iter().for_each(|&z| self.offer(points, z));
        }
        true
    }
}

/// Quadric over the widest plane of some points.
#[derive(Clone, Copy)]
struct Quadric {
    frame: FitFrame,
    center: Vector,
    /// Unit of the tangential coordinates.
    scale: f64,
    coefficients: [f64; 6],
    /// Standard deviation of the noise.
    noise: f64,
    /// Mean of the absolute residuals over their root mean square.
    ratio: f64,
    is_flat: bool,
    /// Mean distance of the points on their surface.
    spacing: f64,
}

/// Normal equations of the quadric over some points, compiled for several processors.
struct MemberSums<'a> {
    points: &'a [Vector],
    members: &'a [u32],
    fit: &'a Quadric,
}

impl NullaryFnOnce for MemberSums<'_> {
    type Output = ([[f64; 6]; 6], [f64; 6]);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let mut sums = FitSums::<6>::default();
        for part in self.members.chunks(LANES) {
            let [mut weights, mut u, mut v, mut heights] = [[0.0; LANES]; 4];
            for (lane, &y) in part.iter().enumerate() {
                let (height, place) = self.fit.local(&self.points[y as usize]);
                (weights[lane], u[lane], v[lane], heights[lane]) = (1.0, place[0], place[1], height);
            }
            sums.add(FourValues(weights), [FourValues(u), FourValues(v)], FourValues(heights));
        }
        sums.equations()
    }
}

impl Quadric {
    fn new(points: &[Vector], members: &[u32]) -> Option<Self> {
        let n = members.len() as f64;
        let sum = members.iter().fold([0.0; 3], |sum, &y| add_scaled(&sum, 1.0, &points[y as usize]));
        let center = sum.map(|c| c / n);
        let mut squares = [[0.0; 3]; 3];
        for &y in members {
            let d = subtract(&points[y as usize], &center);
            for (row, a) in squares.iter_mut().zip(d) {
                *row = add_scaled(row, a / n, &d);
            }
        }
        let frame = principal_axes(squares);
        let [least, middle, most] = frame.variances;
        let scale = (middle + most).sqrt();
        if middle <= 0.0 {
            return None;
        }
        let coefficients = [0.0; 6];
        let mut fit =
            Self { frame, center, scale, coefficients, noise: 0.0, ratio: 0.0, is_flat: false, spacing: 0.0 };
        let (mut matrix, right) = Arch::new().dispatch(MemberSums { points, members, fit: &fit });
        if !factorize(&mut matrix) {
            return None;
        }
        fit.coefficients = substitute(&matrix, right);
        let (mut absolute, mut square) = (0.0, 0.0);
        for &y in members {
            let (height, place) = fit.local(&points[y as usize]);
            let residual = height - fit.height(place);
            absolute += residual.abs();
            square += residual * residual;
        }
        let flatness = (least / middle).sqrt();
        fit.noise = (square / (n - 6.0)).sqrt() * (1.0 + CUT_OFF * flatness.powi(3));
        fit.ratio = absolute / n / (square / n).sqrt().max(f64::MIN_POSITIVE);
        fit.is_flat = flatness <= FLAT && middle >= LINE_RATIO * most;
        fit.spacing = (4.0 * PI * (middle * most).sqrt() / n).sqrt();
        Some(fit)
    }

    /// Height over the plane and tangential coordinates.
    fn local(&self, p: &Vector) -> (f64, [f64; 2]) {
        let d = subtract(p, &self.center);
        let [normal, first, second] = &self.frame.axes;
        (dot(&d, normal), [dot(&d, first) / self.scale, dot(&d, second) / self.scale])
    }

    fn height(&self, place: [f64; 2]) -> f64 {
        self.coefficients.iter().zip(basis::<6>(place)).map(|(c, f)| c * f).sum()
    }

    /// Motion of a point onto the surface, along its normal.
    fn motion(&self, p: &Vector) -> Vector {
        let (height, [u, v]) = self.local(p);
        let [_, by_u, by_v, uu, uv, vv] = self.coefficients;
        let slopes = [by_u + 2.0 * uu * u + uv * v, by_v + uv * u + 2.0 * vv * v].map(|s| s / self.scale);
        let [normal, first, second] = &self.frame.axes;
        let upright = add_scaled(&add_scaled(normal, -slopes[0], first), -slopes[1], second);
        let over = self.height([u, v]) - height;
        upright.map(|c| c * over / dot(&upright, &upright))
    }
}

/// Quadrics of ascending [`SIZES`] around a position, up to some beyond the first flat one.
struct Sizes {
    fits: Vec<Quadric>,
    /// Index of the smallest flat size.
    first: Option<usize>,
}

impl Sizes {
    /// The members are those that `search` has found.
    fn new(points: &[Vector], near: &NearestRows, search: &mut Search, more: usize, last: usize) -> Self {
        let mut out = Self { fits: Vec::new(), first: None };
        for (i, &k) in SIZES.iter().enumerate().take(last + 1) {
            let is_enough = out.first.is_some_and(|first| i > first + more);
            if is_enough || 4 * k > points.len() || !search.extend(points, near, k) {
                break;
            }
            let Some(fit) = Quadric::new(points, &search.found[..k]) else { break };
            if fit.is_flat && out.first.is_none() {
                out.first = Some(i);
            }
            out.fits.push(fit);
        }
        out
    }

    fn flat(&self) -> Option<&Quadric> {
        self.first.map(|i| &self.fits[i])
    }
}

/// Bits that look random.
pub(super) fn scrambled(value: u64) -> u64 {
    let bits = value.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let bits = (bits ^ (bits >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits ^ (bits >> 32)
}

/// Findings about the noise of a cloud at some of its places.
pub(in crate::denoise) struct FoundAtPlaces {
    /// Strong noise, if most places that are flat at some size have it.
    pub(in crate::denoise) strong: Option<StrongNoise>,
    /// Mean of Geary's ratio ([`CloudDenoising::residual_ratio`](super::CloudDenoising)).
    pub(in crate::denoise) residual_ratio: Option<f64>,
    /// Share of the places that are flat at some size; `None` for clouds of few points.
    pub(in crate::denoise) flat_share: Option<f64>,
}

/// Looks at some places for strong noise and for two sheets. O(1) beyond a number for each point.
pub(in crate::denoise) fn noise_at_places(
    points: &[Vector],
    near: &NearestRows,
    progress: Progress<'_>,
) -> Result<FoundAtPlaces, Cancelled> {
    let n = points.len();
    let n_places = PLACES.min(n);
    let at_place = |search: &mut Search, i: usize| {
        let x = (scrambled(i as u64) % n as u64) as u32;
        search.start(points, points[x as usize], &[x]);
        let sizes = Sizes::new(points, near, search, 1, SIZES.len());
        let (fit, first) = (*sizes.flat()?, sizes.first?);
        let growth = |next: &Quadric| next.noise / fit.noise.max(f64::MIN_POSITIVE);
        Some((fit, sizes.fits.get(first + 1).map(growth), first))
    };
    let scratch = || Search::new(n);
    let found = parallel::try_map_chunks(n_places, 64, progress, scratch, |search, range| {
        range.filter_map(|i| at_place(search, i)).collect::<Vec<_>>()
    })?;
    let flat: Vec<PlaceFit> = found.into_iter().flatten().collect();
    let has_noise = |least: f64| move |(fit, ..): &&PlaceFit| fit.noise > least * fit.spacing;
    let mean_ratio =
        |fits: &[&PlaceFit]| fits.iter().map(|(fit, ..)| fit.ratio).sum::<f64>() / fits.len() as f64;
    let median_growth = |fits: &[&PlaceFit]| {
        median(&mut fits.iter().filter_map(|(_, growth, _)| *growth).collect::<Vec<_>>())
    };
    let telling: Vec<&PlaceFit> = flat.iter().filter(has_noise(TELLING)).collect();
    let tells =
        telling.len() as f64 > MOST_TELLING * n_places as f64 && median_growth(&telling) < TELLING_GROWTH;
    let residual_ratio = tells.then(|| mean_ratio(&telling));
    let flat_share = (n >= 4 * WEAK_NEIGHBORS).then(|| flat.len() as f64 / n_places as f64);
    let found = FoundAtPlaces { strong: None, residual_ratio, flat_share };
    // Places that only the largest size finds flat tell nothing: nothing shows whether that is bending.
    let is_one_sheet = |(fit, growth, size): &&PlaceFit| {
        growth.is_some() && fit.ratio < ONE_SHEET[1] + TWO_SHEETS / (SIZES[*size] as f64).sqrt()
    };
    let one_sheet: Vec<&PlaceFit> = flat.iter().filter(is_one_sheet).collect();
    let strong: Vec<&PlaceFit> = one_sheet.iter().copied().filter(has_noise(STRONG)).collect();
    if one_sheet.is_empty()
        || (one_sheet.len() as f64) < FEWEST_FLAT * n_places as f64
        || (strong.len() as f64) < MOST_PLACES * one_sheet.len() as f64
        || !(ONE_SHEET[0]..ONE_SHEET[1]).contains(&mean_ratio(&strong))
        || median_growth(&strong) > GROWTH
    {
        return Ok(found);
    }
    let mut noise: Vec<f64> = strong.iter().map(|(fit, ..)| fit.noise).collect();
    let size = median(&mut strong.iter().map(|(.., size)| *size as f64).collect::<Vec<_>>()) as usize;
    let strong = StrongNoise {
        noise: median(&mut noise),
        at_least: quantile(&mut noise, 0.25),
        neighbors: SIZES[size],
    };
    Ok(FoundAtPlaces { strong: Some(strong), ..found })
}

/// Smallest flat fit at a place, the growth of the noise to the next size if there is one, and the index of its size.
type PlaceFit = (Quadric, Option<f64>, usize);

/// Fits around the center of a patch.
struct Center {
    at: Vector,
    members: Vec<u32>,
    sizes: Sizes,
}

impl Center {
    fn new(
        points: &[Vector],
        near: &NearestRows,
        search: &mut Search,
        x: u32,
        last: usize,
        more: usize,
    ) -> Option<Self> {
        let p = &points[x as usize];
        search.start(points, *p, &[x]);
        let motion = Sizes::new(points, near, search, 0, last).fits.last()?.motion(p);
        // Around the foot of the point, since a ball around the point itself holds more of its side.
        let at = add_scaled(p, 1.0, &motion);
        let from = std::mem::take(&mut search.found);
        search.start(points, at, &from);
        let sizes = Sizes::new(points, near, search, more, last);
        let members = search.found[..SIZES[sizes.fits.len().checked_sub(1)?]].to_vec();
        Some(Self { at, members, sizes })
    }
}

/// Strong noise around a center; `None` if the noise there is not strong, or if there may be two sheets.
fn strong_noise_around(around: &[&Center], strong: &StrongNoise) -> Option<f64> {
    let flat: Vec<&Quadric> = around.iter().filter_map(|center| center.sizes.flat()).collect();
    if flat.len() < LEAST_POOL {
        return Some(strong.noise);
    }
    let n = flat.len() as f64;
    let noise = median(&mut flat.iter().map(|fit| fit.noise).collect::<Vec<_>>());
    let spacing = median(&mut flat.iter().map(|fit| fit.spacing).collect::<Vec<_>>());
    let ratio = flat.iter().map(|fit| fit.ratio).sum::<f64>() / n;
    let margin = RATIO_MARGINS[0] + RATIO_MARGINS[1] / n.sqrt();
    (noise >= STRONG * spacing && (ratio - PATCH_RATIO).abs() <= margin).then_some(noise)
}

/// Weak noise around a center: that of the smallest patches, at least `found` and hardly more.
fn weak_noise_around(around: &[&Center], found: f64) -> f64 {
    let size = SIZES.partition_point(|&k| k < NEIGHBORS);
    let mut noise: Vec<f64> =
        around.iter().filter_map(|center| Some(center.sizes.fits.get(size)?.noise)).collect();
    if noise.is_empty() { found } else { median(&mut noise).clamp(found, MOST_MORE * found) }
}

/// Index of the size of least risk around a center; `None` if that is not larger than that of the other fits.
fn size_of_least_risk(own: &Center, around: &[&Center], noise: f64) -> Option<usize> {
    let risk = |i: usize| {
        let margin = 1.0 + OWN_MARGIN / (2.0 * SIZES[i] as f64).sqrt();
        if own.sizes.fits[i].noise > margin * noise {
            return f64::INFINITY;
        }
        let mut found: Vec<f64> =
            around.iter().filter_map(|center| Some(center.sizes.fits.get(i)?.noise)).collect();
        if found.is_empty() {
            return f64::INFINITY;
        }
        let chance = 1.0 + CHANCE * (2.0 / SIZES[i] as f64).sqrt();
        let excess = (median(&mut found).powi(2) - chance * noise * noise).max(0.0);
        BIAS * excess + LEVERAGE * noise * noise / SIZES[i] as f64
    };
    let first = own.sizes.first.unwrap_or(0).saturating_sub(1);
    let size = (first..own.sizes.fits.len()).min_by(|&i, &j| risk(i).total_cmp(&risk(j)))?;
    (SIZES[size] >= NEIGHBORS && risk(size).is_finite()).then_some(size)
}

impl Patches {
    /// Fits patches around some of the points, where the noise is strong or, without strong noise, of the deviations
    /// `by_point`. O(points), with about [`CENTERS`] fits of each size for each point.
    pub(super) fn new(
        points: &[Vector],
        near: &NearestRows,
        strong: Option<&StrongNoise>,
        by_point: &[f64],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n = points.len();
        let least = strong.map_or(WEAK_NEIGHBORS, |strong| strong.neighbors);
        let first = SIZES.iter().position(|&k| k >= least).unwrap_or(SIZES.len() - 1);
        let last = (first + 2).min(SIZES.len() - 1);
        let more = if strong.is_some() { MORE_SIZES } else { SIZES.len() };
        let one_in = (SIZES[first] as f64 / CENTERS).max(POINTS_A_CENTER);
        // By the coordinates, so that the parts of a cloud have the same centers as the whole.
        let most = (u64::MAX as f64 / one_in) as u64;
        let bits = |p: &Vector| p.iter().fold(0, |bits, c| scrambled(bits ^ c.to_bits()));
        let centers: Vec<u32> = (0..n as u32).filter(|&x| bits(&points[x as usize]) < most).collect();
        let mut index = vec![usize::MAX; n];
        for (c, &x) in centers.iter().enumerate() {
            index[x as usize] = c;
        }
        let scratch = || Search::new(n);
        let fits = parallel::try_map_chunks(centers.len(), 64, progress, scratch, |search, range| {
            let center = |c: usize| {
                let x = centers[c] as usize;
                let is_noisy = strong.is_some() || by_point[x] > NOTHING;
                let most = SIZES[last] * near.one_in(x);
                let last = SIZES.iter().rposition(|&k| k <= most).unwrap_or(last);
                is_noisy.then(|| Center::new(points, near, search, centers[c], last, more)).flatten()
            };
            range.map(center).collect::<Vec<_>>()
        })?;
        let fits: Vec<Option<Center>> = fits.into_iter().flatten().collect();
        let chosen = parallel::try_collect(fits.len(), progress, |c| {
            let own = fits[c].as_ref()?;
            let around = own.members.iter().filter_map(|&y| fits.get(index[y as usize])?.as_ref());
            let around = around.take(POOL).collect::<Vec<_>>();
            let noise = match strong {
                Some(strong) => strong_noise_around(&around, strong)?,
                None => weak_noise_around(&around, CAUTION * by_point[centers[c] as usize]),
            };
            Some((noise, size_of_least_risk(own, &around, noise)?))
        })?;
        let mut out =
            Self { noise: vec![0.0; n], motions: vec![[0.0; 3]; n], leverages: vec![f64::INFINITY; n] };
        let mut total = vec![0.0; n];
        for start in (0..fits.len()).step_by(BATCH) {
            let count = BATCH.min(fits.len() - start);
            let parts =
                parallel::try_collect(count, progress, |i| match (&fits[start + i], chosen[start + i]) {
                    (Some(center), Some((noise, size))) => part_motions(points, center, noise, size),
                    _ => Vec::new(),
                })?;
            for (y, weight, motion, noise, leverage) in parts.into_iter().flatten() {
                total[y] += weight;
                out.leverages[y] = if total[y] > weight { out.leverages[y] } else { 0.0 } + weight * leverage;
                out.noise[y] += weight * noise;
                out.motions[y] = add_scaled(&out.motions[y], weight, &motion);
            }
        }
        let parts = out.noise.iter_mut().zip(&mut out.motions).zip(&mut out.leverages);
        for (((noise, motion), leverage), total) in parts.zip(total) {
            if total <= LEAST_WEIGHT {
                (*noise, *motion, *leverage) = (0.0, [0.0; 3], f64::INFINITY);
                continue;
            }
            *leverage /= total;
            *noise /= total;
            // Strictly below the limit, whatever the sum of position and motion rounds to.
            let (length, most) = (norm(motion) / total, FARTHEST * (1.0 - 1e-9) * *noise / CAUTION);
            *motion = motion.map(|c| c / total * (most / length.max(most)));
        }
        Ok(out)
    }
}

/// Motion of a point by a patch: its index, its weight, the motion, the noise of the patch, and the leverage.
type PartMotion = (usize, f64, Vector, f64, f64);

/// Motions of the points of a patch.
fn part_motions(points: &[Vector], center: &Center, noise: f64, size: usize) -> Vec<PartMotion> {
    let members = &center.members[..SIZES[size]];
    let square = |p: &Vector| {
        let d = subtract(p, &center.at);
        dot(&d, &d)
    };
    let radius = members.last().map_or(0.0, |&y| square(&points[y as usize])).max(f64::MIN_POSITIVE);
    let one = |&y: &u32| {
        let p = &points[y as usize];
        let motion = center.sizes.fits[size].motion(p);
        let share = 1.0 - square(&add_scaled(p, 1.0, &motion)) / radius;
        (share > 0.0).then_some((y as usize, share * share, motion, noise, LEVERAGE / SIZES[size] as f64))
    };
    members.iter().filter_map(one).collect()
}
