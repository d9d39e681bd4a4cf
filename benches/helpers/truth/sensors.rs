//! Clouds with the noise that sensors make.

use super::closest::Tree;
use super::noise::NoisyCloud;
use super::random::Random;
use super::sampling::{CleanCloud, fit_unit_sphere, hit_distance, mean_spacing, scatter};
use super::surfaces::{self, Triangle, cross, dot, minus, unit};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Turning scanner with few rings in a room: noise of the range, and points between two surfaces at edges.
    Spinning,
    /// Scanner on a tripod in a room: noise grows with the range and with the angle of incidence.
    Terrestrial,
    /// Depth camera in front of a body: noise grows with the square of the depth; flying points at edges.
    Depth,
    /// Two cameras in front of a body: disparities are rounded to steps, and neighbors share their errors.
    Stereo,
    /// Stripes projected onto a body: a line shares its error.
    Stripes,
    /// Many images of a body: neighbors share their errors; outliers come in clumps.
    Images,
    /// Two passes over a terrain, shifted against each other by 1.5 spacings.
    TwoPasses,
}

/// Direction of a ray, with its row and column.
type Ray = ([f64; 3], usize, usize);

/// Ranges and normals of rays.
struct Hits {
    sensor: [f64; 3],
    hits: Vec<(Ray, f64, [f64; 3])>,
}

impl Sensor {
    /// All kinds with their names.
    pub const ALL: [(&'static str, Self); 7] = [
        ("spinning lidar", Self::Spinning),
        ("terrestrial scanner", Self::Terrestrial),
        ("depth camera", Self::Depth),
        ("stereo", Self::Stereo),
        ("structured light", Self::Stripes),
        ("photogrammetry", Self::Images),
        ("two passes", Self::TwoPasses),
    ];

    /// The clean and the noisy cloud of a seed, of about `n` points.
    pub fn scan(self, n: usize, seed: u64) -> (CleanCloud, NoisyCloud) {
        let mut random = Random::new(seed ^ ((self as u64 + 64) << 40));
        let mut soup = match self {
            Self::Spinning | Self::Terrestrial => surfaces::room(&mut random),
            Self::TwoPasses => surfaces::terrain(&mut random),
            _ => surfaces::organic(&mut random),
        };
        fit_unit_sphere(&mut soup);
        let side = (n as f64).sqrt();
        let hits = match self {
            Self::Spinning => Hits::turning(&soup, [0.0; 3], [16, n / 16], 0.45),
            Self::Terrestrial => {
                Hits::turning(&soup, [0.0; 3], [(0.6 * side) as usize, (1.6 * side) as usize], 0.9)
            }
            Self::Depth | Self::Stereo | Self::Stripes => {
                Hits::camera(&soup, random.direction().map(|c| 2.5 * c), (1.3 * side) as usize)
            }
            Self::Images | Self::TwoPasses => Hits::everywhere(&soup, n, &mut random),
        };
        let (points, is_outlier) = hits.with_noise(self, &mut random);
        let position = |(ray, range, _): &(Ray, f64, [f64; 3])| hits.position(ray, *range);
        let (dense, dense_normals) = scatter(&soup, 16 * n, &mut random);
        let mut clean = CleanCloud {
            points: hits.hits.iter().map(position).collect(),
            normals: hits.hits.iter().map(|(.., normal)| *normal).collect(),
            dense,
            dense_normals,
            sensor: hits.sensor,
            spacing: 0.0,
        };
        clean.spacing = mean_spacing(&clean.points);
        (clean, NoisyCloud { points, is_outlier })
    }
}

impl Hits {
    fn new(soup: &[Triangle], sensor: [f64; 3], rays: Vec<Ray>) -> Self {
        let first = |ray: Ray| {
            let hit = |t: &Triangle| Some((hit_distance(t, sensor, ray.0)?, *t));
            let (range, [a, b, c]) = soup.iter().filter_map(hit).min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some((ray, range, unit(cross(minus(b, a), minus(c, a)))))
        };
        Self { sensor, hits: rays.into_par_iter().filter_map(first).collect() }
    }

    /// Rings of rays at equal angles from `-most` to `most` in the sine of the elevation.
    fn turning(soup: &[Triangle], sensor: [f64; 3], [rings, rays]: [usize; 2], most: f64) -> Self {
        let ray = |i: usize| {
            let (ring, k) = (i / rays, i % rays);
            let up = most * (2.0 * (ring as f64 + 0.5) / rings as f64 - 1.0);
            let (angle, flat) = (TAU * k as f64 / rays as f64, (1.0 - up * up).sqrt());
            ([flat * angle.cos(), flat * angle.sin(), up], ring, k)
        };
        Self::new(soup, sensor, (0..rings * rays).map(ray).collect())
    }

    /// Rays of the pixels of a camera that looks at the origin.
    fn camera(soup: &[Triangle], sensor: [f64; 3], side: usize) -> Self {
        let ahead = unit(sensor.map(|c| -c));
        let right = unit(cross(ahead, if ahead[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] }));
        let up = cross(right, ahead);
        let ray = |i: usize| {
            let at = |k: usize| 0.42 * (2.0 * k as f64 / side as f64 - 1.0);
            let (u, v) = (at(i / side), at(i % side));
            (unit(std::array::from_fn(|k| ahead[k] + u * right[k] + v * up[k])), i / side, i % side)
        };
        Self::new(soup, sensor, (0..side * side).map(ray).collect())
    }

    /// Points anywhere, each seen along its normal from one unit away.
    fn everywhere(soup: &[Triangle], n: usize, random: &mut Random) -> Self {
        let (points, normals) = scatter(soup, n, random);
        let hit = |(i, (p, m)): (usize, (&[f64; 3], &[f64; 3]))| ((*p, i, 0), 1.0, *m);
        Self { sensor: [0.0; 3], hits: points.iter().zip(&normals).enumerate().map(hit).collect() }
    }

    fn position(&self, ray: &Ray, range: f64) -> [f64; 3] {
        std::array::from_fn(|k| self.sensor[k] + range * ray.0[k])
    }

    /// Positions with the noise of a sensor, and which of them are outliers.
    fn with_noise(&self, sensor: Sensor, random: &mut Random) -> (Vec<[f64; 3]>, Vec<bool>) {
        let clean: Vec<[f64; 3]> =
            self.hits.iter().map(|(ray, range, _)| self.position(ray, *range)).collect();
        let spacing = mean_spacing(&clean);
        let mean = self.hits.iter().map(|hit| hit.1).sum::<f64>() / self.hits.len() as f64;
        let waves: Vec<([f64; 3], f64)> = (0..24)
            .map(|_| (random.direction().map(|c| c * 2.0 / spacing), random.uniform_in(0.0, TAU)))
            .collect();
        let shared = |p: &[f64; 3]| {
            let sum: f64 = waves.iter().map(|(k, phase)| (dot(*k, *p) + phase).sin()).sum();
            sum / (0.5 * waves.len() as f64).sqrt()
        };
        let lines: Vec<f64> = (0..4096).map(|_| random.normal()).collect();
        let clumps: Vec<[f64; 3]> = (0..8).map(|_| clean[random.index(clean.len())]).collect();
        let tree = Tree::new(&clean);
        let mut is_outlier = vec![false; clean.len()];
        let mut points = Vec::with_capacity(clean.len());
        for (x, (ray, range, normal)) in self.hits.iter().enumerate() {
            let slant = dot(ray.0, *normal).abs().max(0.2);
            let weight = range / mean;
            let along = match sensor {
                Sensor::Spinning => 0.5 * random.normal(),
                Sensor::Terrestrial => 0.3 * weight / slant.sqrt() * random.normal(),
                Sensor::Depth => 0.5 * weight.powi(2) * random.normal(),
                Sensor::Stereo => 0.4 * weight.powi(2) * (0.7 * random.normal() + 0.7 * shared(&clean[x])),
                Sensor::Stripes => 0.2 * random.normal() + 0.3 * lines[ray.1 % lines.len()],
                Sensor::Images => 0.2 * random.normal() + 0.2 * shared(&clean[x]),
                Sensor::TwoPasses => 0.2 * random.normal(),
            };
            let mut range = range + along * spacing;
            // Where the next ray hits something else, a part of the beams returns a mean of both.
            let next = self.hits.get(x + 1).filter(|next| next.0.1 == ray.1 && next.0.2 == ray.2 + 1);
            let gap = next.map_or(0.0, |next| next.1 - range);
            let is_mixed = matches!(sensor, Sensor::Spinning | Sensor::Terrestrial | Sensor::Depth)
                && gap.abs() > 8.0 * spacing
                && random.uniform() < 0.5;
            if is_mixed {
                range += gap * random.uniform();
                is_outlier[x] = true;
            }
            if sensor == Sensor::Stereo {
                let step = 1.0 / mean - 1.0 / (mean + 0.5 * spacing);
                range = 1.0 / ((1.0 / range / step).round() * step);
            }
            let mut p = match sensor {
                Sensor::Images | Sensor::TwoPasses => {
                    let side = if sensor == Sensor::TwoPasses && x % 2 == 1 { 1.5 * spacing } else { 0.0 };
                    std::array::from_fn(|k| clean[x][k] + (range - 1.0 + side) * normal[k])
                }
                _ => self.position(ray, range),
            };
            if sensor == Sensor::Images && x % 25 == 0 {
                is_outlier[x] = true;
                let (center, v) = (clumps[random.index(clumps.len())], random.normals());
                p = std::array::from_fn(|k| 1.1 * center[k] + 2.0 * spacing * v[k]);
                is_outlier[x] = tree.closest(&p, |_, _| true).square > spacing * spacing;
            }
            points.push(p);
        }
        (points, is_outlier)
    }
}
