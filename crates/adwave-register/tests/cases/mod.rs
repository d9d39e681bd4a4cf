//! Pairs of shapes with a known motion, or with none: terrains by seed, and cuts and views of given surfaces.

#![allow(dead_code)]

use adwave::shape::{Mesh, Polygons, Shape};
use adwave_register::Motion;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Random numbers by seed.
pub(crate) struct Random(Pcg64Mcg);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        random.next_u64();
        Self(random)
    }

    /// Uniform in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with mean 0 and variance 1.
    pub(crate) fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// Uniform on the unit sphere.
    pub(crate) fn direction(&mut self) -> [f64; 3] {
        let v: [f64; 3] = std::array::from_fn(|_| self.normal());
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        v.map(|c| c / length)
    }

    /// Rotation by up to half a turn about a random axis, and a translation of about `size`.
    pub(crate) fn motion(&mut self, size: f64) -> Motion {
        let angle = std::f64::consts::PI * (2.0 * self.uniform() - 1.0);
        let axis = self.direction().map(|c| angle * c);
        Motion::new(axis, std::array::from_fn(|_| size * self.normal()))
    }
}

/// Surface as points and triangles.
#[derive(Clone)]
pub(crate) struct Surface {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Surface {
    pub(crate) fn shape(&self) -> Shape {
        Shape::Mesh(Mesh::new(self.points.clone(), Polygons::from_triangles(&self.triangles)).unwrap())
    }

    pub(crate) fn moved(&self, motion: &Motion) -> Self {
        let points = self.points.iter().map(|p| motion.apply(p)).collect();
        Self { points, triangles: self.triangles.clone() }
    }

    pub(crate) fn mean_edge(&self) -> f64 {
        let length = |t: &[u32; 3]| distance(&self.points[t[0] as usize], &self.points[t[1] as usize]);
        self.triangles.iter().map(length).sum::<f64>() / self.triangles.len() as f64
    }

    /// Displaces every coordinate by normal noise of `edges` mean edges.
    pub(crate) fn noisy(mut self, edges: f64, seed: u64) -> Self {
        let (mut random, sigma) = (Random::new(seed), edges * self.mean_edge());
        for p in &mut self.points {
            *p = p.map(|c| c + sigma * random.normal());
        }
        self
    }

    /// Keeps the triangles whose three vertices are kept.
    pub(crate) fn cut(&self, is_kept: impl Fn(usize) -> bool) -> Self {
        let flags: Vec<bool> = (0..self.points.len()).map(is_kept).collect();
        let triangles: Vec<[u32; 3]> =
            self.triangles.iter().copied().filter(|t| t.iter().all(|&x| flags[x as usize])).collect();
        let mut index = vec![u32::MAX; self.points.len()];
        let mut points = Vec::new();
        for &x in triangles.iter().flatten() {
            if index[x as usize] == u32::MAX {
                index[x as usize] = points.len() as u32;
                points.push(self.points[x as usize]);
            }
        }
        Self { points, triangles: triangles.iter().map(|t| t.map(|x| index[x as usize])).collect() }
    }

    /// The part within a distance of the z axis.
    pub(crate) fn cut_round(&self, radius: f64) -> Self {
        self.cut(|x| self.points[x][0].hypot(self.points[x][1]) <= radius)
    }

    /// The parts before the quantile `upper` and behind the quantile `lower` of the vertices along a direction.
    pub(crate) fn parts(&self, direction: &[f64; 3], upper: f64, lower: f64) -> [Self; 2] {
        let along: Vec<f64> = self.points.iter().map(|p| (0..3).map(|c| p[c] * direction[c]).sum()).collect();
        let mut sorted = along.clone();
        sorted.sort_by(f64::total_cmp);
        let quantile = |share: f64| sorted[((share * sorted.len() as f64) as usize).min(sorted.len() - 1)];
        let (end, start) = (quantile(upper), quantile(lower));
        [self.cut(|x| along[x] <= end), self.cut(|x| along[x] >= start)]
    }

    /// The two parts of which a share `overlap` is in the other too.
    pub(crate) fn overlapping(&self, direction: &[f64; 3], overlap: f64) -> [Self; 2] {
        let size = 1.0 / (2.0 - overlap);
        self.parts(direction, size, 1.0 - size)
    }

    /// The triangles that face a direction.
    pub(crate) fn view(&self, direction: &[f64; 3]) -> Self {
        let mut is_facing = vec![false; self.points.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|x| self.points[x as usize]);
            let (u, v) = (adwave::vector::subtract(&b, &a), adwave::vector::subtract(&c, &a));
            let n = adwave::vector::cross(&u, &v);
            if adwave::vector::dot(&n, direction) > 0.2 * adwave::vector::norm(&n) {
                for &x in t {
                    is_facing[x as usize] = true;
                }
            }
        }
        self.cut(|x| is_facing[x])
    }
}

pub(crate) fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

/// Random heights: the sum of waves whose power falls with the cube of the frequency.
pub(crate) struct Terrain(Vec<[f64; 4]>);

impl Terrain {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let wave = |_| {
            // Equal numbers of waves per octave of the wavelength, from 4 to 120.
            let k = std::f64::consts::TAU / 4.0 * (1.0_f64 / 30.0).powf(random.uniform());
            let angle = std::f64::consts::TAU * random.uniform();
            let amplitude = 0.6 * (k / 0.2).powf(-0.5) * random.normal();
            [k * angle.cos(), k * angle.sin(), std::f64::consts::TAU * random.uniform(), amplitude * 0.25]
        };
        Self((0..400).map(wave).collect())
    }

    pub(crate) fn height(&self, x: f64, y: f64) -> f64 {
        self.0.iter().map(|[a, b, phase, amplitude]| amplitude * (a * x + b * y + phase).cos()).sum()
    }

    /// Grid of rows × columns whose first point is at (x, y).
    pub(crate) fn patch(&self, x: f64, y: f64, rows: u32, columns: u32) -> Surface {
        let mut points = Vec::new();
        for i in 0..rows {
            for j in 0..columns {
                let (u, v) = (x + f64::from(i), y + f64::from(j));
                points.push([u, v, self.height(u, v)]);
            }
        }
        let mut triangles = Vec::new();
        for i in 0..rows - 1 {
            for j in 0..columns - 1 {
                let v = i * columns + j;
                triangles.extend([[v, v + columns, v + columns + 1], [v, v + columns + 1, v + 1]]);
            }
        }
        Surface { points, triangles }
    }

    /// Strip of equal reliefs in a row, each of [`Self::PERIOD`] columns with a flat frame: reliefs `from..to`, seen at
    /// points that are shifted by `shift`. `differences` is the share by which the relief of each differs from the others.
    pub(crate) fn repeated(&self, reliefs: std::ops::Range<u32>, shift: f64, differences: f64) -> Surface {
        const ROWS: u32 = 44;
        let columns = Self::PERIOD * (reliefs.end - reliefs.start);
        let mut strip = self.patch(0.0, 0.0, ROWS, columns);
        let frame = |t: f64| (std::f64::consts::PI * t.clamp(0.0, 1.0)).sin().powi(2);
        for p in &mut strip.points {
            let (u, v) = (p[0] + shift, p[1] + shift + f64::from(Self::PERIOD * reliefs.start));
            let within = v.rem_euclid(f64::from(Self::PERIOD));
            let window = frame(u / f64::from(ROWS - 1)) * frame(within / f64::from(Self::PERIOD));
            let relief = self.height(u, within) + differences * self.height(u + 500.0, v);
            *p = [u, v, window * relief];
        }
        strip
    }

    /// Columns of a relief of [`Self::repeated`].
    pub(crate) const PERIOD: u32 = 40;
}
