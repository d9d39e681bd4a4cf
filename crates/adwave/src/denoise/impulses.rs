//! Impulses of a mesh: single vertices far from where the surface around them is.

use super::noise_level::median;
use super::surface::NoisySurface;
use crate::vector::{add_scaled, cross, dot, norm, subtract, unit};
use crate::{Cancelled, Progress, parallel};

/// Cap on the rounds that find impulses, for each sensitivity; a round takes the largest impulse of each neighborhood.
const MAX_ROUNDS: [usize; 2] = [5, 4];

/// Rings of neighbors on which a round depends: planes of the triangles around a ring, medians over two rings of their
/// heights, and the comparison with neighbors.
const RINGS_A_ROUND: usize = 5;

/// Rings of neighbors on which all rounds depend.
pub(super) const RINGS: usize = (MAX_ROUNDS[0] + MAX_ROUNDS[1]) * RINGS_A_ROUND;

/// Offset from the predicted interval beyond which a vertex is an impulse.
struct Sensitivity {
    /// Cap on the rounds.
    rounds: usize,
    /// Smallest offset, in robust standard deviations of the offsets within two rings.
    deviations: f64,
    /// Smallest offset, in edges of the ring; smaller impulses do not need a treatment of their own.
    edges: f64,
}

/// Sensitivity of the rounds, and of further rounds if there are many impulses, which hide each other.
const SENSITIVITIES: [Sensitivity; 2] = [
    Sensitivity { rounds: MAX_ROUNDS[0], deviations: 3.5, edges: 0.15 },
    Sensitivity { rounds: MAX_ROUNDS[1], deviations: 2.0, edges: 0.1 },
];

/// Share of the vertices from which impulses are many.
const MANY: f64 = 0.2;

/// Least share of the vertices for impulses to be a kind of noise of their own.
const LEAST_SHARE: f64 = 0.02;

/// Least root mean square offset of impulses in mean edges: the offsets of features of clean shapes are smaller.
const LEAST_SIZE: f64 = 0.28;

/// Least root mean square offset of impulses in standard deviations of the remaining noise: that of the tails of normal
/// noise is below 4.5.
const LEAST_RATIO: f64 = 5.0;

/// Standard deviation of a normal variable in median absolute deviations.
const MEDIANS_A_DEVIATION: f64 = 1.482_602_218_505_602;

/// Share of the height of the planes of a ring that a smooth surface has: planes touch it about 1.15 edges away, the
/// mean of the neighbors is taken one edge away.
const SMOOTH_SHARE: f64 = 0.43;

/// Least cosine between a plane and the ring for the plane to predict a height.
const LEAST_COSINE: f64 = 0.25;

/// Offset of a vertex from the heights that its surroundings predict without it.
#[derive(Clone, Copy, Default)]
struct Offset {
    direction: [f64; 3],
    height: f64,
    /// Mean edge of the ring.
    edge: f64,
}

/// Vertices that impulses may have moved, and the positions without these.
pub(super) struct Impulses {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) is_hit: Vec<bool>,
}

/// Share of the vertices that impulses moved, and their root mean square size in the units of the points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ImpulseStatistics {
    pub(super) share: f64,
    pub(super) size: f64,
}

impl Impulses {
    /// Statistics of the impulses if these are more than features or the tails of noise of standard deviation `noise`
    /// on edges of mean length `edge`.
    pub(super) fn statistics(&self, before: &[[f64; 3]], noise: f64, edge: f64) -> Option<ImpulseStatistics> {
        let hit = (0..before.len()).filter(|&x| self.is_hit[x]);
        let (mut n, mut sum) = (0.0, 0.0);
        for x in hit {
            let d = subtract(&self.points[x], &before[x]);
            n += 1.0;
            sum += dot(&d, &d);
        }
        let share = n / before.len().max(1) as f64;
        let size = if n > 0.0 { (sum / n).sqrt() } else { 0.0 };
        let is_kind = share >= LEAST_SHARE && size >= LEAST_SIZE * edge && size >= LEAST_RATIO * noise;
        is_kind.then_some(ImpulseStatistics { share, size })
    }
}

impl NoisySurface {
    /// Finds vertices that impulses may have moved, and moves each to the height that the planes around its ring
    /// predict. O(points) per round.
    ///
    /// The height of a vertex is predicted by the planes of the triangles beyond the edges of its ring: their median on
    /// flat sides and at creases between them, a part of it where the surface bends. All heights in between count as
    /// predicted.
    pub(super) fn impulses(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Impulses, Cancelled> {
        let mut found = Impulses { points: points.to_vec(), is_hit: vec![false; points.len()] };
        self.add_impulses(&mut found, &SENSITIVITIES[0], progress)?;
        Ok(found)
    }

    /// Impulses of a surface on which they moved the given share of the vertices.
    pub(super) fn impulses_of_share(
        &self,
        points: &[[f64; 3]],
        share: f64,
        progress: Progress<'_>,
    ) -> Result<Impulses, Cancelled> {
        let mut found = self.impulses(points, progress)?;
        self.add_if_many(&mut found, share, progress)?;
        Ok(found)
    }

    /// Adds the impulses that other impulses hid, if the given share of the vertices is large.
    pub(super) fn add_if_many(
        &self,
        found: &mut Impulses,
        share: f64,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        if share < MANY { Ok(()) } else { self.add_impulses(found, &SENSITIVITIES[1], progress) }
    }

    fn add_impulses(
        &self,
        found: &mut Impulses,
        sensitivity: &Sensitivity,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let n = found.points.len();
        for _ in 0..sensitivity.rounds {
            let normals = self.normals(&found.points, progress)?;
            let points = &found.points;
            let offsets = parallel::try_collect(n, progress, |x| self.offset(points, &normals, x))?;
            let ratios = parallel::try_collect(n, progress, |x| self.ratio(&offsets, sensitivity, x))?;
            let is_first = |x: &usize| {
                let is_less = |&y: &u32| {
                    let y = y as usize;
                    ratios[y] < ratios[*x] || (ratios[y] == ratios[*x] && y >= *x)
                };
                ratios[*x] > 1.0 && self.ring.row(*x).iter().all(is_less)
            };
            let chosen: Vec<usize> = (0..n).filter(is_first).collect();
            for &x in &chosen {
                found.is_hit[x] = true;
                found.points[x] = add_scaled(&found.points[x], -offsets[x].height, &offsets[x].direction);
            }
            if chosen.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// Offset of a vertex in units of the least offset of an impulse.
    fn ratio(&self, offsets: &[Offset], sensitivity: &Sensitivity, x: usize) -> f64 {
        let rings = self.ring.row(x).iter().flat_map(|&y| self.ring.row(y as usize));
        let mut around: Vec<f64> =
            rings.filter(|y| **y as usize != x).map(|&y| offsets[y as usize].height.abs()).collect();
        let deviation = MEDIANS_A_DEVIATION * median(&mut around);
        let least = (sensitivity.deviations * deviation).max(sensitivity.edges * offsets[x].edge);
        if least > 0.0 { offsets[x].height.abs() / least } else { 0.0 }
    }

    fn offset(&self, points: &[[f64; 3]], normals: &[[f64; 3]], x: usize) -> Offset {
        let middle = add_scaled(&points[x], 1.0, &self.umbrella(points, x));
        let around = self.at_vertex.row(x);
        let (mut sum, mut edges) = ([0.0; 3], 0.0);
        for &t in around {
            let [a, b] = self.opposite_edge(t, x).map(|v| points[v as usize]);
            sum = add_scaled(&sum, 1.0, &cross(&subtract(&a, &middle), &subtract(&b, &middle)));
            edges += norm(&subtract(&a, &b));
        }
        let Some(direction) = unit(&sum) else { return Offset::default() };
        let mut heights: Vec<f64> = Vec::with_capacity(around.len());
        for &t in around {
            let [a, b] = self.opposite_edge(t, x);
            let has = |t: u32, v: u32| self.triangles[t as usize].contains(&v);
            let beyond = self.at_vertex.row(a as usize).iter();
            let beyond = beyond.filter(|&&u| u != t && has(u, b) && !has(u, x as u32));
            for &u in beyond {
                let cosine = dot(&normals[u as usize], &direction);
                if cosine > LEAST_COSINE {
                    let rise = subtract(&points[a as usize], &middle);
                    heights.push(dot(&normals[u as usize], &rise) / cosine);
                }
            }
        }
        if heights.len() < 3 {
            return Offset::default();
        }
        let planes = median(&mut heights);
        let (low, high) = (planes.min(SMOOTH_SHARE * planes), planes.max(SMOOTH_SHARE * planes));
        let height = dot(&direction, &subtract(&points[x], &middle));
        Offset { direction, height: height - height.clamp(low, high), edge: edges / around.len() as f64 }
    }

    /// The corners of a triangle after one of them.
    fn opposite_edge(&self, t: u32, x: usize) -> [u32; 2] {
        let [a, b, c] = self.triangles[t as usize];
        match x as u32 {
            v if v == a => [b, c],
            v if v == b => [c, a],
            _ => [a, b],
        }
    }
}
