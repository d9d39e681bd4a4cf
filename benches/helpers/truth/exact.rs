//! Random surfaces with a formula for the distance from them, their samples, and samples in scan lines.

use super::random::Random;
use super::sampling::{CleanCloud, DENSITY, PointsAndNormals, Sampling, mean_spacing};
use super::surfaces::{cross, dot, minus, unit};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Kind of surface. Smooth ones come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExactShape {
    /// Sphere.
    Sphere,
    /// Torus of which the tube has 0.25 to 0.7 of the radius of the ring.
    Torus,
    /// Saddle over a square, with two bends.
    Saddle,
    /// Square of a plane.
    Plane,
    /// Box with three different sides.
    Box,
    /// Cylinder with caps.
    Cylinder,
    /// Three to six treads and the risers between them.
    Stairs,
}

impl ExactShape {
    /// All kinds with their names.
    pub const ALL: [(&'static str, Self); 7] = [
        ("sphere", Self::Sphere),
        ("torus", Self::Torus),
        ("saddle", Self::Saddle),
        ("plane", Self::Plane),
        ("box", Self::Box),
        ("cylinder", Self::Cylinder),
        ("stairs", Self::Stairs),
    ];

    /// True for surfaces with edges.
    pub fn has_edges(self) -> bool {
        matches!(self, Self::Box | Self::Cylinder | Self::Stairs)
    }

    fn formula(self, random: &mut Random) -> Formula {
        match self {
            Self::Sphere => Formula::Sphere,
            Self::Torus => Formula::Torus { tube: random.uniform_in(0.2, 0.41) },
            Self::Saddle => {
                Formula::Saddle { bends: [random.uniform_in(0.3, 1.5), random.uniform_in(0.3, 1.5)] }
            }
            Self::Plane => Formula::Planes,
            Self::Box => {
                Formula::Box { half: [1.0, random.uniform_in(0.4, 0.9), random.uniform_in(0.3, 0.9)] }
            }
            Self::Cylinder => Formula::Cylinder {
                radius: random.uniform_in(0.4, 1.0),
                half_height: random.uniform_in(0.3, 1.0),
            },
            Self::Stairs => {
                let n = 3 + random.index(4);
                let rise = random.uniform_in(0.1, 0.4);
                let corner = |k: usize| [2.0 * k.div_ceil(2) as f64 / n as f64 - 1.0, rise * (k / 2) as f64];
                Formula::Stairs { corners: (0..2 * n).map(corner).collect() }
            }
        }
    }
}

/// Surface in its own coordinates, of which x is in −1..=1.
enum Formula {
    /// Sphere of radius 1.
    Sphere,
    /// Torus around z with the outer radius 1 and this radius of the tube.
    Torus { tube: f64 },
    /// Graph of (a·x² − b·y²)/2 over −1..=1; its distance is that of the graph over all x and y.
    Saddle { bends: [f64; 2] },
    /// One plane or several; the distance of a point is that from the plane of its clean position.
    Planes,
    /// Box with these halves of the sides.
    Box { half: [f64; 3] },
    /// Cylinder around z with caps.
    Cylinder { radius: f64, half_height: f64 },
    /// Profile of (x, z) along y from −1 to 1. Along y, and beyond the first and the last tread, the distance is that
    /// of stairs that continue.
    Stairs { corners: Vec<[f64; 2]> },
}

impl Formula {
    /// Random point, uniform by area, and its unit normal.
    fn draw(&self, random: &mut Random) -> ([f64; 3], [f64; 3]) {
        let square = |random: &mut Random| [random.uniform_in(-1.0, 1.0), random.uniform_in(-1.0, 1.0)];
        match self {
            Self::Planes => {
                let [x, y] = square(random);
                ([x, y, 0.0], [0.0, 0.0, 1.0])
            }
            Self::Saddle { bends: [a, b] } => loop {
                let [x, y] = square(random);
                let (slopes, steepest) = ([-a * x, b * y, 1.0], (1.0 + a * a + b * b).sqrt());
                if random.uniform() * steepest < dot(slopes, slopes).sqrt() {
                    return ([x, y, 0.5 * (a * x * x - b * y * y)], unit(slopes));
                }
            },
            Self::Sphere => {
                let d = random.direction();
                (d, d)
            }
            Self::Torus { tube } => loop {
                let (u, v) = (TAU * random.uniform(), TAU * random.uniform());
                let ring = 1.0 - tube + tube * v.cos();
                if random.uniform() < ring {
                    let n = [v.cos() * u.cos(), v.cos() * u.sin(), v.sin()];
                    return ([ring * u.cos(), ring * u.sin(), tube * v.sin()], n);
                }
            },
            Self::Box { half } => {
                let axis = random_index(&[half[1] * half[2], half[2] * half[0], half[0] * half[1]], random);
                let mut p = half.map(|h| random.uniform_in(-h, h));
                let mut n = [0.0; 3];
                n[axis] = if random.index(2) == 0 { -1.0 } else { 1.0 };
                p[axis] = n[axis] * half[axis];
                (p, n)
            }
            Self::Cylinder { radius, half_height } => {
                let angle = TAU * random.uniform();
                let d = [angle.cos(), angle.sin(), 0.0];
                if random_index(&[2.0 * half_height, *radius], random) == 0 {
                    let z = random.uniform_in(-half_height, *half_height);
                    return ([radius * d[0], radius * d[1], z], d);
                }
                let (r, side) = (radius * random.uniform().sqrt(), [-1.0, 1.0][random.index(2)]);
                ([r * d[0], r * d[1], side * half_height], [0.0, 0.0, side])
            }
            Self::Stairs { corners } => {
                let sides: Vec<[f64; 2]> =
                    corners.windows(2).map(|w| [w[1][0] - w[0][0], w[1][1] - w[0][1]]).collect();
                let lengths: Vec<f64> = sides.iter().map(|s| s[0].hypot(s[1])).collect();
                let k = random_index(&lengths, random);
                let (t, [dx, dz]) = (random.uniform(), sides[k]);
                let p = [corners[k][0] + t * dx, random.uniform_in(-1.0, 1.0), corners[k][1] + t * dz];
                (p, unit([-dz, 0.0, dx]))
            }
        }
    }

    /// Distance from the surface; `None` if it is that from the plane of the clean position.
    fn distance(&self, p: &[f64; 3]) -> Option<f64> {
        let [x, y, z] = *p;
        Some(match self {
            Self::Planes => return None,
            Self::Sphere => (dot(*p, *p).sqrt() - 1.0).abs(),
            Self::Torus { tube } => ((x.hypot(y) - (1.0 - tube)).hypot(z) - tube).abs(),
            Self::Saddle { bends } => saddle_distance(p, *bends),
            Self::Box { half } => boundary_distance(&[0, 1, 2].map(|k| p[k].abs() - half[k])),
            Self::Cylinder { radius, half_height } => {
                boundary_distance(&[x.hypot(y) - radius, z.abs() - half_height])
            }
            Self::Stairs { corners } => {
                let last = corners.len() - 2;
                let side = |(k, w): (usize, &[[f64; 2]])| {
                    let (a, d) = (w[0], [w[1][0] - w[0][0], w[1][1] - w[0][1]]);
                    let t = ((x - a[0]) * d[0] + (z - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
                    let low = if k == 0 { f64::NEG_INFINITY } else { 0.0 };
                    let t = t.clamp(low, if k == last { f64::INFINITY } else { 1.0 });
                    (x - a[0] - t * d[0]).hypot(z - a[1] - t * d[1])
                };
                corners.windows(2).enumerate().map(side).fold(f64::INFINITY, f64::min)
            }
        })
    }
}

/// Index drawn with probabilities proportional to weights.
fn random_index(weights: &[f64], random: &mut Random) -> usize {
    let mut left = random.uniform() * weights.iter().sum::<f64>();
    let is_passed = |w: &&f64| {
        left -= **w;
        left >= 0.0
    };
    weights.iter().take_while(is_passed).count().min(weights.len() - 1)
}

/// Distance from the boundary of a box, from how far each coordinate is beyond its half side.
fn boundary_distance(beyond: &[f64]) -> f64 {
    let deepest = beyond.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if deepest <= 0.0 { -deepest } else { beyond.iter().map(|b| b.max(0.0).powi(2)).sum::<f64>().sqrt() }
}

/// Distance from the graph of (a·x² − b·y²)/2: the closest point q has p − q = t·(−a·u, b·v, 1), and the height that
/// is left falls with t in −1/b..1/a.
fn saddle_distance([x, y, z]: &[f64; 3], [a, b]: [f64; 2]) -> f64 {
    let (mut low, mut high, mut t) = (-1.0 / b, 1.0 / a, 0.0);
    let foot = |t: f64| (x / (1.0 - t * a), y / (1.0 + t * b));
    for _ in 0..100 {
        let (u, v) = foot(t);
        let left = z - t - 0.5 * (a * u * u - b * v * v);
        if left > 0.0 {
            low = t;
        } else {
            high = t;
        }
        let slope = 1.0 + (a * u).powi(2) / (1.0 - t * a) + (b * v).powi(2) / (1.0 + t * b);
        let step = left / slope;
        let next = if (low..high).contains(&(t + step)) { t + step } else { f64::midpoint(low, high) };
        if (next - t).abs() < 1e-15 {
            break;
        }
        t = next;
    }
    let (u, v) = foot(t);
    t.abs() * (1.0 + (a * u).powi(2) + (b * v).powi(2)).sqrt()
}

/// Rotation, scale and shift from a surface's own coordinates to those of the cloud.
struct Placement {
    axes: [[f64; 3]; 3],
    scale: f64,
    shift: [f64; 3],
}

impl Placement {
    fn new(random: &mut Random) -> Self {
        let a = random.direction();
        let b = unit(cross(a, random.direction()));
        let scale = 10.0_f64.powf(random.uniform_in(-1.0, 1.0));
        Self { axes: [a, b, cross(a, b)], scale, shift: random.normals().map(|c| scale * c) }
    }

    fn direction(&self, v: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| (0..3).map(|i| v[i] * self.axes[i][k]).sum())
    }

    fn position(&self, p: [f64; 3]) -> [f64; 3] {
        let d = self.direction(p);
        std::array::from_fn(|k| self.shift[k] + self.scale * d[k])
    }

    fn own_position(&self, p: &[f64; 3]) -> [f64; 3] {
        self.axes.map(|axis| dot(axis, minus(*p, self.shift)) / self.scale)
    }
}

/// Sample of a surface, with the distance of any point from the surface.
pub struct ExactCloud {
    /// The points without noise.
    pub clean: CleanCloud,
    formula: Formula,
    placement: Placement,
}

impl ExactCloud {
    /// Samples the shape of a seed at about `n` points, in a random size and pose.
    pub fn new(shape: ExactShape, sampling: Sampling, n: usize, seed: u64) -> Self {
        let mut random = Random::new(seed ^ ((shape as u64 + 128) << 40));
        let formula = shape.formula(&mut random);
        let (dense, normals): PointsAndNormals = (0..DENSITY * n).map(|_| formula.draw(&mut random)).unzip();
        let sample = sampling.pick(&dense, &normals, n, &mut random);
        Self::place(formula, sample, None, &mut random)
    }

    /// Square of a plane, of about `n` points in parallel lines that are `apart` times as far from each other as the
    /// points along a line. The latter distance is the spacing.
    pub fn plane_in_lines(apart: f64, n: usize, seed: u64) -> Self {
        let mut random = Random::new(seed ^ (160 << 40));
        let n_lines = (n as f64 / apart).sqrt().round();
        let step = 2.0 / (n_lines * apart);
        let line = |k: usize| {
            let first = random.uniform();
            let point = move |i: usize| {
                let p = [(i as f64 + first) * step - 1.0, (k as f64 + 0.5) * apart * step - 1.0, 0.0];
                (p, [0.0, 0.0, 1.0])
            };
            (0..(n as f64 / n_lines) as usize).map(point)
        };
        let sample = (0..n_lines as usize).flat_map(line).unzip();
        Self::place(Formula::Planes, sample, Some(step), &mut random)
    }

    /// Sphere of about `n` points in lines of latitude that are `apart` times as far from each other as the points
    /// along a line. The latter distance is the spacing.
    pub fn sphere_in_lines(apart: f64, n: usize, seed: u64) -> Self {
        let mut random = Random::new(seed ^ (161 << 40));
        let between = PI / (PI / (4.0 * PI * apart / n as f64).sqrt()).round();
        let step = between / apart;
        let line = |k: usize| {
            let (sin, cos) = (between * (k as f64 + 0.5) - FRAC_PI_2).sin_cos();
            let (first, n) = (random.uniform(), (TAU * cos / step).round().max(3.0));
            (0..n as usize).map(move |i| {
                let angle = TAU * (i as f64 + first) / n;
                let d = [cos * angle.cos(), cos * angle.sin(), sin];
                (d, d)
            })
        };
        let sample = (0..(PI / between).round() as usize).flat_map(line).unzip();
        Self::place(Formula::Sphere, sample, Some(step), &mut random)
    }

    /// Two parallel squares of `n / 2` even points each, `gap` spacings apart, with normals to the outside. The spacing
    /// is that of one square, and distances are those from the square to which a point belongs.
    pub fn two_sheets(gap: f64, n: usize, seed: u64) -> Self {
        let mut random = Random::new(seed ^ (162 << 40));
        let mut sheet = || {
            let (dense, normals): PointsAndNormals =
                (0..DENSITY * n / 2).map(|_| Formula::Planes.draw(&mut random)).unzip();
            Sampling::Even.pick(&dense, &normals, n / 2, &mut random)
        };
        let [mut sample, below] = [sheet(), sheet()];
        let spacing = mean_spacing(&sample.0);
        sample.0.extend(below.0.iter().map(|p| [p[0], p[1], p[2] - gap * spacing]));
        sample.1.extend(below.1.iter().map(|n| n.map(|c| -c)));
        Self::place(Formula::Planes, sample, Some(spacing), &mut random)
    }

    /// Puts a sample into a random size and pose. The spacing is measured unless it is given in the sample's own unit.
    fn place(formula: Formula, sample: PointsAndNormals, spacing: Option<f64>, random: &mut Random) -> Self {
        let placement = Placement::new(random);
        let points: Vec<[f64; 3]> = sample.0.into_iter().map(|p| placement.position(p)).collect();
        let spacing = spacing.map_or_else(|| mean_spacing(&points), |s| s * placement.scale);
        let clean = CleanCloud {
            normals: sample.1.into_iter().map(|n| placement.direction(n)).collect(),
            dense: Vec::new(),
            dense_normals: Vec::new(),
            sensor: placement.position(random.direction().map(|c| 3.0 * c)),
            points,
            spacing,
        };
        Self { clean, formula, placement }
    }

    /// Distance of `p`, where a denoiser put the point `x`, from the surface, in model units.
    pub fn distance(&self, x: usize, p: &[f64; 3]) -> f64 {
        let own = self.formula.distance(&self.placement.own_position(p));
        own.map_or_else(|| self.height(x, p).abs(), |distance| distance * self.placement.scale)
    }

    /// Root mean square distance of moved points from the surface, in model units.
    pub fn error(&self, points: &[[f64; 3]]) -> f64 {
        root_mean_square(points.iter().enumerate().map(|(x, p)| self.distance(x, p)))
    }

    /// Root mean square displacement of noisy points along the normals, in model units.
    pub fn noise(&self, noisy: &[[f64; 3]]) -> f64 {
        root_mean_square(noisy.iter().enumerate().map(|(x, p)| self.height(x, p)))
    }

    fn height(&self, x: usize, p: &[f64; 3]) -> f64 {
        dot(self.clean.normals[x], minus(*p, self.clean.points[x]))
    }
}

/// Root mean square of values.
pub fn root_mean_square(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    (values.map(|v| v * v).sum::<f64>() / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_the_distance_by_which_they_left_the_surface() {
        for (name, shape) in ExactShape::ALL {
            for sampling in Sampling::ALL {
                let cloud = ExactCloud::new(shape, sampling, 1500, 3);
                let clean = &cloud.clean;
                assert!((1200..1800).contains(&clean.points.len()), "{name}: {}", clean.points.len());
                let unit = cloud.placement.scale;
                assert!(cloud.error(&clean.points) < 1e-12 * unit, "{name}");
                let moved = |h: f64| {
                    let point = |(p, n): (&[f64; 3], &[f64; 3])| std::array::from_fn(|k| p[k] + h * n[k]);
                    clean.points.iter().zip(&clean.normals).map(point).collect::<Vec<[f64; 3]>>()
                };
                for h in [-0.02, 0.02] {
                    let points = moved(h * unit);
                    let is_right = |(x, p): (usize, &[f64; 3])| {
                        let distance = cloud.distance(x, p) / unit;
                        assert!(distance < h.abs() + 1e-12, "{name}: {distance}");
                        (distance - h.abs()).abs() < 1e-9
                    };
                    let n_right = points.iter().enumerate().filter(|p| is_right(*p)).count();
                    // Beside an edge, another face may be closer.
                    let least = if shape.has_edges() { 0.8 } else { 1.0 };
                    assert!(n_right as f64 >= least * points.len() as f64, "{name}: {n_right}");
                    assert!((cloud.noise(&points) / unit - h.abs()).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn lines_have_the_stated_distances() {
        for cloud in [ExactCloud::plane_in_lines(8.0, 4000, 1), ExactCloud::sphere_in_lines(8.0, 4000, 1)] {
            let n = cloud.clean.points.len();
            assert!((3800..4200).contains(&n), "{n}");
            let nearest = mean_spacing(&cloud.clean.points) / cloud.clean.spacing;
            assert!((0.97..1.03).contains(&nearest), "{nearest}");
        }
    }
}
