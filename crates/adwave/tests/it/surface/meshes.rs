//! Meshes with closed forms, their triangles irregular and ten times as long at some places as at others.

use adwave::sample::Sample;
use std::f64::consts::PI;

pub(crate) type Points = Vec<[f64; 3]>;
pub(crate) type Triangles = Vec<[u32; 3]>;

/// Numbers in [−1, 1) without pattern, the same in every run.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Splitmix64.
    pub(crate) fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

pub(crate) fn sample(name: &str, n_vertices: usize) -> (Points, Triangles) {
    let sample = Sample::from_name(name, Some(n_vertices)).unwrap();
    let triangles = sample.faces.iter().map(|f| [f[0], f[1], f[2]]).collect();
    (sample.points, triangles)
}

fn unit(p: [f64; 3]) -> [f64; 3] {
    let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
    p.map(|c| c / length)
}

/// The unit sphere: vertices spread evenly, pushed about by up to a quarter of their distance, then mapped so that edges become
/// ten times as long at one pole as at the other, and stretched by up to 1.4 in turn.
pub(crate) fn uneven_sphere(n_vertices: usize) -> (Points, Triangles) {
    let (mut points, triangles) = sample("sphere", n_vertices);
    let mut noise = Noise::new(n_vertices as u64);
    let push = 0.25 * (4.0 * PI / n_vertices as f64).sqrt();
    for p in &mut points {
        let pushed = unit(p.map(|c| c + push * noise.signed()));
        let [x, y, z] = unit([pushed[0] * 1.2, pushed[1], pushed[2] * 0.85]);
        // Stereographic coordinates times k: lengths grow by k at one pole, by 1/k at the other.
        let k = 10.0_f64.sqrt();
        let (u, v) = (k * x / (1.0 + z), k * y / (1.0 + z));
        let s = 1.0 + u * u + v * v;
        *p = [2.0 * u / s, 2.0 * v / s, (1.0 - u * u - v * v) / s];
    }
    (points, triangles)
}

/// A grid of `n` × `n` squares on [0, 1]², each cut in two along diagonals that turn, its vertices pushed about by 0.3 of a square
/// but at the border, where they stay on it.
pub(crate) fn jittered_grid(n: u32, seed: u64) -> (Points, Triangles) {
    let mut noise = Noise::new(seed);
    let mut points = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            let (a, b) = (noise.signed(), noise.signed());
            let at = |k: u32, push: f64| {
                let free = if k > 0 && k < n { 0.3 * push } else { 0.0 };
                (f64::from(k) + free) / f64::from(n)
            };
            points.push([at(i, a), at(j, b), 0.0]);
        }
    }
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| i * (n + 1) + j);
            let halves =
                if (i * 5 + j * 3) % 4 < 2 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            triangles.extend(halves);
        }
    }
    (points, triangles)
}

/// The rectangle [0, 1.3] × [0, 1], its squares ten times as long on the right as on the left, and three times as wide
/// above as below.
pub(crate) fn uneven_rectangle(n: u32) -> (Points, Triangles) {
    let (mut points, triangles) = jittered_grid(n, u64::from(n));
    let grow = |t: f64, factor: f64| (factor.powf(t) - 1.0) / (factor - 1.0);
    for p in &mut points {
        *p = [1.3 * grow(p[0], 10.0), grow(p[1], 3.0), 0.0];
    }
    (points, triangles)
}

/// A sector of the ring 1 ≤ r ≤ 10 in the plane, 66° to either side of the x axis: triangles as large as their distance from
/// the center, in all directions alike. Gives the length of an edge at r = 1 too.
pub(crate) fn sector(n: u32) -> (Points, Triangles, f64) {
    let (mut points, triangles) = jittered_grid(n, 7);
    let span = 10.0_f64.ln();
    for p in &mut points {
        let (r, angle) = ((span * p[0]).exp(), span * (p[1] - 0.5));
        *p = [r * angle.cos(), r * angle.sin(), 0.0];
    }
    (points, triangles, span / f64::from(n))
}
