//! Noise of many kinds for clouds.

use super::random::Random;
use super::sampling::CleanCloud;
use super::surfaces::{dot, minus, unit};

/// Kind of noise with its strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CloudNoise {
    /// None: clean points must stay.
    Clean,
    /// In all directions, each coordinate with this share of the radius, as the published pairs have it.
    OfRadius(f64),
    /// In all directions, each coordinate with this many spacings.
    Isotropic(f64),
    /// Along the normals, in spacings.
    Normal(f64),
    /// Along the normals for one point in five, in spacings.
    Impulses(f64),
    /// Along the normals, shared by neighbors over about three spacings.
    Correlated(f64),
    /// Along the line of sight, in spacings at the mean depth, growing with the square of the depth.
    Sight(f64),
    /// Along the normals, in spacings in the middle of the cloud, growing threefold from one side to the other.
    ByPlace(f64),
    /// Coordinates rounded to multiples of this many spacings.
    Quantized(f64),
    /// Along the normals, and one point in twenty anywhere near.
    Outliers(f64),
}

/// A noisy cloud.
pub struct NoisyCloud {
    /// The points, in the order of the clean ones.
    pub points: Vec<[f64; 3]>,
    /// True for those that are outliers.
    pub is_outlier: Vec<bool>,
}

impl CloudNoise {
    /// Kinds and strengths of the benchmark, with their names.
    pub const ALL: [(&'static str, Self); 15] = [
        ("none", Self::Clean),
        ("1 % of the radius", Self::OfRadius(0.01)),
        ("2 % of the radius", Self::OfRadius(0.02)),
        ("all directions, 0.1", Self::Isotropic(0.1)),
        ("all directions, 0.3", Self::Isotropic(0.3)),
        ("normals, 0.05", Self::Normal(0.05)),
        ("normals, 0.2", Self::Normal(0.2)),
        ("normals, 0.5", Self::Normal(0.5)),
        ("normals, 1", Self::Normal(1.0)),
        ("impulses, 0.6", Self::Impulses(0.6)),
        ("shared, 0.2", Self::Correlated(0.2)),
        ("sight, 0.2", Self::Sight(0.2)),
        ("sight, 0.5", Self::Sight(0.5)),
        ("rounded, 0.4", Self::Quantized(0.4)),
        ("outliers, 0.2", Self::Outliers(0.2)),
    ];

    /// Adds the noise of a seed.
    pub fn apply(self, clean: &CleanCloud, seed: u64) -> NoisyCloud {
        let mut random = Random::new(seed.wrapping_add(0x00c0_ffee));
        let spacing = clean.spacing;
        let mut is_outlier = vec![false; clean.points.len()];
        let waves: Vec<([f64; 3], f64)> = (0..24)
            .map(|_| {
                let d = random.direction();
                (d.map(|c| c * 2.0 / spacing), random.uniform_in(0.0, std::f64::consts::TAU))
            })
            .collect();
        let depth = |p: &[f64; 3]| dot(minus(*p, clean.sensor), minus(*p, clean.sensor)).sqrt();
        let mean_depth = clean.points.iter().map(depth).sum::<f64>() / clean.points.len() as f64;
        let across = Random::new(seed.wrapping_add(0x0b1_ace)).direction();
        let ends = clean.points.iter().map(|p| dot(across, *p));
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| [a.min(t), b.max(t)]);
        let mut moved = |x: usize, p: &[f64; 3]| -> [f64; 3] {
            let n = clean.normals[x];
            let along = |n: [f64; 3], h: f64| std::array::from_fn(|k| p[k] + h * n[k]);
            match self {
                Self::Clean => *p,
                Self::OfRadius(s) => {
                    let v = random.normals();
                    std::array::from_fn(|k| p[k] + s * v[k])
                }
                Self::Isotropic(s) => {
                    let v = random.normals();
                    std::array::from_fn(|k| p[k] + s * spacing * v[k])
                }
                Self::Normal(s) => along(n, s * spacing * random.normal()),
                Self::Impulses(s) => {
                    let h = random.normal();
                    along(n, if random.uniform() < 0.2 { s * spacing * h } else { 0.02 * spacing * h })
                }
                Self::Correlated(s) => {
                    let sum: f64 = waves.iter().map(|(k, phase)| (dot(*k, *p) + phase).sin()).sum();
                    along(n, s * spacing * sum / (0.5 * waves.len() as f64).sqrt())
                }
                Self::Sight(s) => {
                    let d = minus(*p, clean.sensor);
                    along(unit(d), s * spacing * (depth(p) / mean_depth).powi(2) * random.normal())
                }
                Self::ByPlace(s) => {
                    let growth = 0.5 + (dot(across, *p) - low) / (high - low);
                    along(n, s * growth * spacing * random.normal())
                }
                Self::Quantized(s) => p.map(|c| (c / (s * spacing)).round() * s * spacing),
                Self::Outliers(s) => {
                    if random.uniform() < 0.05 {
                        is_outlier[x] = true;
                        let v = random.direction();
                        let h = spacing * random.uniform_in(3.0, 25.0);
                        std::array::from_fn(|k| p[k] + h * v[k])
                    } else {
                        along(n, s * spacing * random.normal())
                    }
                }
            }
        };
        let points = clean.points.iter().enumerate().map(|(x, p)| moved(x, p)).collect();
        NoisyCloud { points, is_outlier }
    }
}
