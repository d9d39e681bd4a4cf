//! Samples of random shapes: even, random or uneven density, from one side, or by rays from one point.

use super::random::Random;
use super::surfaces::{self, Triangle, cross, dot, minus, unit};
use std::collections::HashMap;

/// Kind of shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CloudShape {
    /// Turned part with steps, cones and roundings.
    Turned,
    /// Outline with holes cut from a plate.
    Extruded,
    /// Thin walls that cross each other.
    Ribs,
    /// Smooth body with waves of several lengths.
    Organic,
    /// Two sheets close to each other.
    Shell,
    /// Tubes along closed curves.
    Tubes,
    /// Open terrain, with points of vegetation above it.
    Terrain,
    /// Body seen from one side.
    OpenScan,
    /// Room seen from one point.
    Room,
}

/// Sample of a shape without noise, in the unit sphere.
pub struct CleanCloud {
    /// The points.
    pub points: Vec<[f64; 3]>,
    /// Unit normals of the surface at the points; zero for vegetation.
    pub normals: Vec<[f64; 3]>,
    /// Many points of the surface, to measure distances from it; empty where a formula gives the distance.
    pub dense: Vec<[f64; 3]>,
    /// Unit normals at them.
    pub dense_normals: Vec<[f64; 3]>,
    /// Position of the scanner.
    pub sensor: [f64; 3],
    /// Mean distance of a point to the nearest other one.
    pub spacing: f64,
}

/// Distribution of the points over a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// None closer to another than a radius, and nearly as many as fit.
    Even,
    /// Uniform by area, independent of each other.
    Random,
    /// Independent, with a density that falls to a quarter from x = −1 to x = 1.
    Uneven,
}

impl Sampling {
    /// All distributions.
    pub const ALL: [Self; 3] = [Self::Even, Self::Random, Self::Uneven];

    /// Picks about `n` of many points that are uniform by area, with x in −1..=1, and their normals.
    pub(super) fn pick(
        self,
        dense: &[[f64; 3]],
        normals: &[[f64; 3]],
        n: usize,
        random: &mut Random,
    ) -> PointsAndNormals {
        let mean = n as f64 / dense.len() as f64;
        match self {
            Self::Even => pick_evenly(dense, normals, n),
            Self::Random => pick(dense, normals, |_| mean, random),
            Self::Uneven => pick(dense, normals, |p| (1.6 - 1.2 * (0.5 + 0.5 * p[0])) * mean, random),
        }
    }
}

/// Number of dense points for each point.
pub(super) const DENSITY: usize = 16;

/// Share of the points of a terrain that are vegetation.
const VEGETATION: f64 = 0.06;

impl CloudShape {
    /// All kinds with their names.
    pub const ALL: [(&'static str, Self); 9] = [
        ("turned", Self::Turned),
        ("extruded", Self::Extruded),
        ("ribs", Self::Ribs),
        ("organic", Self::Organic),
        ("shell", Self::Shell),
        ("tubes", Self::Tubes),
        ("terrain", Self::Terrain),
        ("open scan", Self::OpenScan),
        ("room", Self::Room),
    ];

    /// Samples the shape of a seed at about `n` points.
    pub fn sample(self, n: usize, seed: u64) -> CleanCloud {
        let mut random = Random::new(seed ^ ((self as u64) << 40));
        let mut soup = match self {
            Self::Turned => surfaces::turned_part(&mut random),
            Self::Extruded => surfaces::extruded_part(&mut random),
            Self::Ribs => surfaces::ribs(&mut random),
            Self::Organic | Self::OpenScan => surfaces::organic(&mut random),
            Self::Shell => surfaces::shell(&mut random),
            Self::Tubes => surfaces::tubes(&mut random),
            Self::Terrain => surfaces::terrain(&mut random),
            Self::Room => surfaces::room(&mut random),
        };
        fit_unit_sphere(&mut soup);
        let mut sensor = random.direction().map(|c| 3.0 * c);
        if self == Self::Room {
            sensor = std::array::from_fn(|_| random.uniform_in(-0.1, 0.1));
        }
        let (mut dense, mut dense_normals) = scatter(&soup, DENSITY * n, &mut random);
        if self == Self::OpenScan {
            let seen: Vec<bool> =
                dense.iter().zip(&dense_normals).map(|(p, m)| dot(*m, minus(sensor, *p)) > 0.3).collect();
            retain(&mut dense, &seen);
            retain(&mut dense_normals, &seen);
        }
        let sampling = [Sampling::Random, Sampling::Uneven, Sampling::Even, Sampling::Even][random.index(4)];
        let (mut points, mut normals) = match self {
            Self::Room => cast_rays(&soup, sensor, n, &mut random),
            _ => sampling.pick(&dense, &dense_normals, n, &mut random),
        };
        if self == Self::Terrain {
            for _ in 0..3 {
                let tree = points[random.index(points.len())];
                for _ in 0..(VEGETATION / 3.0 * n as f64) as usize {
                    let v = random.normals();
                    points.push([tree[0] + 0.05 * v[0], tree[1] + 0.05 * v[1], tree[2] + 0.12 + 0.05 * v[2]]);
                    normals.push([0.0; 3]);
                }
            }
        }
        let spacing = mean_spacing(&points);
        CleanCloud { points, normals, dense, dense_normals, sensor, spacing }
    }
}

/// Moves and scales a soup so that the unit sphere around the middle of its box touches it.
pub(super) fn fit_unit_sphere(soup: &mut [Triangle]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in soup.as_flattened() {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    let radius = soup
        .as_flattened()
        .iter()
        .map(|p| dot(minus(*p, middle), minus(*p, middle)).sqrt())
        .fold(0.0, f64::max);
    for p in soup.as_flattened_mut() {
        *p = minus(*p, middle).map(|c| c / radius);
    }
}

/// Points and the unit normals at them.
pub(super) type PointsAndNormals = (Vec<[f64; 3]>, Vec<[f64; 3]>);

/// Random points of a soup, uniform by area.
pub(super) fn scatter(soup: &[Triangle], n: usize, random: &mut Random) -> PointsAndNormals {
    let mut total = 0.0;
    let areas: Vec<f64> = soup
        .iter()
        .map(|[a, b, c]| {
            let doubled = cross(minus(*b, *a), minus(*c, *a));
            total += dot(doubled, doubled).sqrt();
            total
        })
        .collect();
    (0..n)
        .map(|_| {
            let at = random.uniform() * total;
            let [a, b, c] = soup[areas.partition_point(|sum| *sum < at).min(soup.len() - 1)];
            let (mut u, mut v) = (random.uniform(), random.uniform());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let p = std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
            (p, unit(cross(minus(b, a), minus(c, a))))
        })
        .unzip()
}

fn retain(vectors: &mut Vec<[f64; 3]>, is_kept: &[bool]) {
    let mut kept = is_kept.iter();
    vectors.retain(|_| *kept.next().unwrap_or(&false));
}

fn pick(
    dense: &[[f64; 3]],
    normals: &[[f64; 3]],
    share: impl Fn(&[f64; 3]) -> f64,
    random: &mut Random,
) -> PointsAndNormals {
    dense.iter().zip(normals).filter(|(p, _)| random.uniform() < share(p)).map(|(p, n)| (*p, *n)).unzip()
}

/// At most `n` points, none of them closer to another than a radius chosen so that about `n` fit.
fn pick_evenly(dense: &[[f64; 3]], normals: &[[f64; 3]], n: usize) -> PointsAndNormals {
    let mut radius = 4.0 / (n as f64).sqrt();
    loop {
        let mut cells: HashMap<[i32; 3], Vec<[f64; 3]>> = HashMap::new();
        let (mut points, mut picked) = (Vec::new(), Vec::new());
        for (p, m) in dense.iter().zip(normals) {
            let cell = p.map(|c| (c / radius).floor() as i32);
            let is_free = neighbor_cells(cell)
                .filter_map(|c| cells.get(&c))
                .flatten()
                .all(|q| dot(minus(*p, *q), minus(*p, *q)) >= radius * radius);
            if is_free {
                cells.entry(cell).or_default().push(*p);
                points.push(*p);
                picked.push(*m);
            }
        }
        if points.len() >= n {
            points.truncate(n);
            picked.truncate(n);
            return (points, picked);
        }
        radius *= 0.96_f64.min((points.len() as f64 / n as f64).sqrt());
    }
}

fn neighbor_cells(cell: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (0..27).map(move |k| [cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1])
}

/// Points that rays from the sensor hit: their density falls with the square of the distance and with the angle.
fn cast_rays(soup: &[Triangle], sensor: [f64; 3], n: usize, random: &mut Random) -> PointsAndNormals {
    // Equal angles, as a turning scanner has them, with a little disorder.
    let n_rings = ((n as f64 / 2.0).sqrt() * 0.8) as usize;
    let n_rays = n / n_rings;
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    for ring in 0..n_rings {
        let height = -0.9 + 1.8 * (ring as f64 + 0.5) / n_rings as f64;
        for ray in 0..n_rays {
            let angle = std::f64::consts::TAU * (ray as f64 + 0.3 * random.uniform()) / n_rays as f64;
            let flat = (1.0 - height * height).sqrt();
            let d = [flat * angle.cos(), flat * angle.sin(), height];
            let hit = soup
                .iter()
                .filter_map(|t| hit_distance(t, sensor, d).map(|s| (s, t)))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((s, [a, b, c])) = hit {
                points.push(std::array::from_fn(|k| sensor[k] + s * d[k]));
                normals.push(unit(cross(minus(*b, *a), minus(*c, *a))));
            }
        }
    }
    (points, normals)
}

pub(super) fn hit_distance([a, b, c]: &Triangle, from: [f64; 3], d: [f64; 3]) -> Option<f64> {
    let (e, f) = (minus(*b, *a), minus(*c, *a));
    let p = cross(d, f);
    let det = dot(e, p);
    if det.abs() < 1e-12 {
        return None;
    }
    let t = minus(from, *a);
    let u = dot(t, p) / det;
    let q = cross(t, e);
    let v = dot(d, q) / det;
    let s = dot(f, q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && s > 1e-9).then_some(s)
}

/// Mean distance of a point to the nearest other one.
pub(super) fn mean_spacing(points: &[[f64; 3]]) -> f64 {
    let tree = super::closest::Tree::new(points);
    let sum: f64 = points.iter().map(|p| tree.nearest_other(p)).sum();
    sum / points.len() as f64
}
