//! Random meshes whose truth is known: machined parts, turned rings, organic bodies, rough skin, plates, tubes, terrain
//! and open scans, with about 7000 vertices each.

use super::random::Random;
use super::surfaces::{cross, dot, minus, unit};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshShape {
    /// Steps, slots and pockets with sharp edges, sheared and tapered.
    Machined,
    /// Ring with a random profile of cylinders, cones and steps.
    Turned,
    /// Smooth body with waves of several lengths.
    Organic,
    /// Body with detail of all lengths down to a few edges, on part of it or everywhere.
    Rough,
    /// Bent plate of one to three edges thickness.
    Plate,
    /// Tubes along closed curves.
    Tubes,
    /// Open terrain with ridges and steps.
    Terrain,
    /// The side of a body that a scanner sees.
    OpenScan,
}

/// Mesh without noise.
#[derive(Clone, Debug)]
pub struct CleanMesh {
    /// Positions of the vertices.
    pub points: Vec<[f64; 3]>,
    /// Triangles, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Position of the scanner.
    pub sensor: [f64; 3],
}

impl MeshShape {
    /// All kinds with their names.
    pub const ALL: [(&'static str, Self); 8] = [
        ("machined", Self::Machined),
        ("turned", Self::Turned),
        ("organic", Self::Organic),
        ("rough", Self::Rough),
        ("plate", Self::Plate),
        ("tubes", Self::Tubes),
        ("terrain", Self::Terrain),
        ("open scan", Self::OpenScan),
    ];

    /// The mesh of a seed.
    pub fn mesh(self, seed: u64) -> CleanMesh {
        let mut random = Random::new(seed ^ 0x6d65_7368 ^ ((self as u64) << 40));
        let (points, mut triangles) = match self {
            Self::Machined => machined(&mut random),
            Self::Turned => lathe_part(&mut random),
            Self::Organic => body(&mut random, Skin::Smooth),
            Self::Rough => body(&mut random, Skin::Rough),
            Self::OpenScan => {
                let skin = if random.index(2) == 0 { Skin::Smooth } else { Skin::Rough };
                body(&mut random, skin)
            }
            Self::Plate => plate(&mut random),
            Self::Tubes => tubes(&mut random),
            Self::Terrain => terrain(&mut random),
        };
        let sensor = random.direction().map(|c| 4.0 * c);
        if self == Self::OpenScan {
            let is_seen = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|v| points[v as usize]);
                let n = unit(cross(minus(b, a), minus(c, a)));
                dot(n, unit(minus(sensor, a))) > 0.2
            };
            triangles.retain(is_seen);
        }
        let (points, triangles) = used_points(&points, &triangles);
        CleanMesh { points, triangles, sensor }
    }
}

impl CleanMesh {
    /// Mean length of the edges.
    pub fn mean_edge(&self) -> f64 {
        let length = |t: &[u32; 3], k: usize| {
            let d = minus(self.points[t[k] as usize], self.points[t[(k + 1) % 3] as usize]);
            dot(d, d).sqrt()
        };
        let sum: f64 = self.triangles.iter().flat_map(|t| (0..3).map(move |k| length(t, k))).sum();
        sum / (3 * self.triangles.len()).max(1) as f64
    }

    /// Unit normals of the vertices, weighted by area.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.points.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| self.points[v as usize]);
            let n = cross(minus(b, a), minus(c, a));
            for &v in t {
                (0..3).for_each(|k| sums[v as usize][k] += n[k]);
            }
        }
        sums.into_iter().map(unit).collect()
    }

    /// Mean angle in degrees between the normals of the triangles and those of the same triangles at other positions.
    pub fn angle(&self, points: &[[f64; 3]]) -> f64 {
        let normal = |points: &[[f64; 3]], t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize]);
            unit(cross(minus(b, a), minus(c, a)))
        };
        let angle = |t: &[u32; 3]| {
            dot(normal(&self.points, t), normal(points, t)).clamp(-1.0, 1.0).acos().to_degrees()
        };
        self.triangles.iter().map(angle).sum::<f64>() / self.triangles.len().max(1) as f64
    }
}

type PointsAndTriangles = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Removes points without triangles.
fn used_points(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> PointsAndTriangles {
    let mut names = vec![u32::MAX; points.len()];
    let mut kept = Vec::new();
    let rename = |v: &u32| {
        let name = &mut names[*v as usize];
        if *name == u32::MAX {
            *name = kept.len() as u32;
            kept.push(points[*v as usize]);
        }
        *name
    };
    let names: Vec<u32> = triangles.as_flattened().iter().map(rename).collect();
    (kept, names.as_chunks().0.to_vec())
}

/// Splits a quad along a random diagonal.
fn push_quad(triangles: &mut Vec<[u32; 3]>, [a, b, c, d]: [u32; 4], random: &mut Random) {
    if random.index(2) == 0 {
        triangles.extend([[a, b, c], [a, c, d]]);
    } else {
        triangles.extend([[a, b, d], [b, c, d]]);
    }
}

/// Grid of `n_u` × `n_v` cells, closed along an axis where it is `is_closed`, with jittered parameters.
fn grid(
    n: [usize; 2],
    is_closed: [bool; 2],
    jitter: f64,
    random: &mut Random,
    position: impl Fn(f64, f64) -> [f64; 3],
) -> PointsAndTriangles {
    let rows: [usize; 2] = std::array::from_fn(|k| if is_closed[k] { n[k] } else { n[k] + 1 });
    let mut points = Vec::with_capacity(rows[0] * rows[1]);
    for i in 0..rows[0] {
        for j in 0..rows[1] {
            let at: [f64; 2] = std::array::from_fn(|k| {
                let own = [i, j][k];
                let is_border = !is_closed[k] && (own == 0 || own == n[k]);
                let shift = if is_border { 0.0 } else { jitter * random.uniform_in(-1.0, 1.0) };
                (own as f64 + shift) / n[k] as f64
            });
            points.push(position(at[0], at[1]));
        }
    }
    let mut triangles = Vec::new();
    let name = |i: usize, j: usize| ((i % rows[0]) * rows[1] + j % rows[1]) as u32;
    for i in 0..n[0] {
        for j in 0..n[1] {
            let quad = [name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)];
            push_quad(&mut triangles, quad, random);
        }
    }
    (points, triangles)
}

/// Boundary of a set of cells of a lattice; points in the middle of flat regions are jittered within them. Positions
/// are in cells.
fn lattice_boundary(
    size: [usize; 3],
    is_full: &dyn Fn([i64; 3]) -> bool,
    jitter: f64,
    random: &mut Random,
) -> PointsAndTriangles {
    let mut names: HashMap<[i64; 3], u32> = HashMap::new();
    let (mut points, mut triangles): (Vec<[f64; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    let mut axes: Vec<[bool; 3]> = Vec::new();
    for x in 0..size[0] as i64 {
        for y in 0..size[1] as i64 {
            for z in 0..size[2] as i64 {
                let cell = [x, y, z];
                if !is_full(cell) {
                    continue;
                }
                for axis in 0..3 {
                    for side in [0, 1] {
                        let mut beyond = cell;
                        beyond[axis] += 2 * side - 1;
                        if is_full(beyond) {
                            continue;
                        }
                        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
                        let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| {
                            let mut corner = cell;
                            corner[axis] += side;
                            corner[a] += u;
                            corner[b] += v;
                            let name = *names.entry(corner).or_insert_with(|| {
                                points.push(corner.map(|c| c as f64));
                                axes.push([false; 3]);
                                points.len() as u32 - 1
                            });
                            axes[name as usize][axis] = true;
                            name
                        });
                        if side == 0 {
                            quad.reverse();
                        }
                        push_quad(&mut triangles, quad, random);
                    }
                }
            }
        }
    }
    for (p, normals) in points.iter_mut().zip(&axes) {
        for (c, is_normal) in p.iter_mut().zip(normals) {
            let shift = jitter * random.uniform_in(-1.0, 1.0);
            // Along an edge or within a face; a corner stays.
            if !is_normal {
                *c += shift;
            }
        }
    }
    (points, triangles)
}

fn machined(random: &mut Random) -> PointsAndTriangles {
    let size = [44 + random.index(12), 26 + random.index(10), 12 + random.index(12)];
    let mut cuts: Vec<[[i64; 2]; 3]> = Vec::new();
    for _ in 0..3 + random.index(7) {
        // A cut begins outside of the block along at least one axis.
        let open = random.index(3);
        cuts.push(std::array::from_fn(|k| {
            let n = size[k] as f64;
            let extent = random.uniform_in(0.12, 0.5) * n;
            let from = random.uniform_in(0.0, 1.0) * (n - extent);
            let from =
                if k == open { if random.index(2) == 0 { -1.0 } else { n - extent + 1.0 } } else { from };
            [from.round() as i64, (from + extent).round().max(from.round() + 2.0) as i64]
        }));
    }
    let is_full = move |c: [i64; 3]| {
        (0..3).all(|k| (0..size[k] as i64).contains(&c[k]))
            && !cuts.iter().any(|cut| (0..3).all(|k| (cut[k][0]..cut[k][1]).contains(&c[k])))
    };
    let jitter = random.uniform_in(0.0, 0.3);
    let (mut points, triangles) = lattice_boundary(size, &is_full, jitter, random);
    let shear: [f64; 3] = std::array::from_fn(|_| random.uniform_in(-0.5, 0.5));
    let (taper, twist) =
        (random.uniform_in(-0.4, 0.4), [0.0, 0.0, random.uniform_in(-0.8, 0.8)][random.index(3)]);
    let stretch: [f64; 3] = std::array::from_fn(|_| random.uniform_in(0.8, 1.25));
    let turn = [random.direction(), random.direction()];
    for p in &mut points {
        let [x, y, z] = std::array::from_fn(|k| (p[k] - 0.5 * size[k] as f64) / size[0] as f64);
        let s = 1.0 + taper * x;
        let (sin, cos) = (twist * x).sin_cos();
        let [y, z] = [s * (cos * y - sin * z), s * (sin * y + cos * z)];
        let q = [x + shear[0] * y + shear[1] * z, y + shear[2] * z, z];
        *p = rotated(std::array::from_fn(|k| stretch[k] * q[k]), &turn);
    }
    (points, triangles)
}

/// A point in the frame of two random directions.
fn rotated(p: [f64; 3], turn: &[[f64; 3]; 2]) -> [f64; 3] {
    let a = turn[0];
    let b = unit(cross(a, turn[1]));
    let c = cross(a, b);
    std::array::from_fn(|k| p[0] * a[k] + p[1] * b[k] + p[2] * c[k])
}

fn lathe_part(random: &mut Random) -> PointsAndTriangles {
    let bore = random.uniform_in(0.25, 0.6);
    let mut profile = vec![[bore, 0.0]];
    let mut radius = bore + random.uniform_in(0.2, 0.6);
    let mut height = 0.0;
    profile.push([radius, height]);
    for _ in 0..2 + random.index(5) {
        let rise = random.uniform_in(0.12, 0.5);
        let next = (radius + random.uniform_in(-0.35, 0.35)).max(bore + 0.12);
        match random.index(4) {
            0 => {
                height += rise;
                profile.push([radius, height]);
                profile.push([next, height]);
                radius = next;
            }
            1 => {
                height += rise;
                radius = next;
                profile.push([radius, height]);
            }
            2 => {
                for k in 1..=10 {
                    let angle = std::f64::consts::PI * f64::from(k) / 10.0;
                    let outside = radius + 0.4 * rise * angle.sin();
                    profile.push([outside, height + 0.5 * rise * (1.0 - angle.cos())]);
                }
                height += rise;
            }
            _ => {
                height += rise;
                profile.push([radius, height]);
            }
        }
    }
    profile.push([bore, height]);
    let step = (height + 2.0) / 55.0;
    // Cells of about that size, with vertices at all corners of the profile.
    let mut samples: Vec<[f64; 2]> = Vec::new();
    for k in 0..profile.len() {
        let (p, q) = (profile[k], profile[(k + 1) % profile.len()]);
        let n = ((q[0] - p[0]).hypot(q[1] - p[1]) / step).round().max(1.0) as usize;
        samples.extend((0..n).map(|i| {
            let t = i as f64 / n as f64;
            [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
        }));
    }
    let mean_radius = samples.iter().map(|s| s[0]).sum::<f64>() / samples.len() as f64;
    let around = ((TAU * mean_radius / step) as usize).clamp(24, 240);
    let jitter = random.uniform_in(0.0, 0.3);
    // Shifts along the circle only, so that the edges stay.
    let shifts: Vec<f64> =
        (0..around * samples.len()).map(|_| jitter * random.uniform_in(-1.0, 1.0)).collect();
    let mut points = Vec::new();
    for (j, s) in samples.iter().enumerate() {
        for i in 0..around {
            let angle = TAU * (i as f64 + 0.5 * (j % 2) as f64 + shifts[j * around + i]) / around as f64;
            points.push([s[0] * angle.cos(), s[0] * angle.sin(), s[1]]);
        }
    }
    let name = |j: usize, i: usize| ((j % samples.len()) * around + i % around) as u32;
    let mut triangles = Vec::new();
    for j in 0..samples.len() {
        for i in 0..around {
            push_quad(
                &mut triangles,
                [name(j, i), name(j, i + 1), name(j + 1, i + 1), name(j + 1, i)],
                random,
            );
        }
    }
    let turn = [random.direction(), random.direction()];
    (points.into_iter().map(|p| rotated(p, &turn)).collect(), triangles)
}

#[derive(Clone, Copy, PartialEq)]
enum Skin {
    Smooth,
    Rough,
}

struct Wave {
    k: [f64; 3],
    phase: f64,
    amplitude: f64,
}

fn height(waves: &[Wave], d: [f64; 3]) -> f64 {
    waves.iter().map(|w| w.amplitude * (dot(w.k, d) + w.phase).sin()).sum()
}

/// Icosphere with random waves; rough skin has waves down to a few edges, whose amplitude falls by a random power of
/// their length.
fn body(random: &mut Random, skin: Skin) -> PointsAndTriangles {
    let (mut points, triangles) = sphere(84, random);
    let mut waves: Vec<Wave> = (0..4 + random.index(10))
        .map(|_| {
            let length = random.uniform_in(1.0, 8.0);
            let amplitude = random.uniform_in(0.1, 0.4) / length;
            Wave { k: random.direction().map(|c| c * length), phase: random.uniform_in(0.0, TAU), amplitude }
        })
        .collect();
    let mut fine: Vec<Wave> = Vec::new();
    if skin == Skin::Rough {
        let (power, slope) = (random.uniform_in(0.8, 1.6), random.uniform_in(0.03, 0.12));
        for _ in 0..80 {
            let length = 8.0 * (random.uniform() * (80.0_f64 / 8.0).ln()).exp();
            let amplitude = slope * 1.6 / 8.0 * (8.0 / length).powf(power);
            let k = random.direction().map(|c| c * length);
            fine.push(Wave { k, phase: random.uniform_in(0.0, TAU), amplitude });
        }
        for wave in &mut waves {
            wave.amplitude *= 0.7;
        }
    }
    let (patch, share) = (random.direction(), random.uniform_in(-1.5, 0.4));
    let stretch = [1.0, random.uniform_in(0.5, 1.0), random.uniform_in(0.5, 1.0)];
    for p in &mut points {
        let d = unit(*p);
        let weight = 1.0 / (1.0 + (-12.0 * (dot(patch, d) - share)).exp());
        let r = (1.0 + height(&waves, d)).max(0.3) + weight * height(&fine, d);
        *p = std::array::from_fn(|k| r * stretch[k] * d[k]);
    }
    (points, triangles)
}

/// Unit sphere from a cube whose sides have a jittered grid.
fn sphere(n: usize, random: &mut Random) -> PointsAndTriangles {
    let n = n * 2 / 5;
    let jitter = random.uniform_in(0.0, 0.3);
    let is_full = |c: [i64; 3]| c.iter().all(|&c| (0..n as i64).contains(&c));
    let (mut points, triangles) = lattice_boundary([n; 3], &is_full, 0.0, random);
    for p in &mut points {
        let q: [f64; 3] = std::array::from_fn(|k| {
            let c = 2.0 * p[k] / n as f64 - 1.0;
            (0.25 * std::f64::consts::PI * c).tan()
        });
        let d = unit(q);
        let shift = random.normals().map(|c| 0.4 * jitter * std::f64::consts::PI / (2.0 * n as f64) * c);
        *p = unit(std::array::from_fn(|k| d[k] + shift[k]));
    }
    (points, triangles)
}

fn plate(random: &mut Random) -> PointsAndTriangles {
    let size = [60 + random.index(10), 40 + random.index(14), 1 + random.index(3)];
    let is_full = move |c: [i64; 3]| (0..3).all(|k| (0..size[k] as i64).contains(&c[k]));
    let jitter = random.uniform_in(0.0, 0.3);
    let (mut points, triangles) = lattice_boundary(size, &is_full, jitter, random);
    let bend = if random.index(3) == 0 { 0.0 } else { random.uniform_in(0.3, 3.0) };
    let (ripple, thin) = (random.uniform_in(0.0, 0.04), random.uniform_in(0.5, 1.2));
    for p in &mut points {
        let [x, y, z] = [0, 1, 2].map(|k| (p[k] - 0.5 * size[k] as f64) / size[0] as f64);
        let h = thin * z + ripple * (9.0 * y).sin();
        *p = if bend == 0.0 {
            [x, y, h]
        } else {
            let r = 1.0 / bend + h;
            [r * (bend * x).sin(), y, r * (bend * x).cos()]
        };
    }
    (points, triangles)
}

fn tubes(random: &mut Random) -> PointsAndTriangles {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let n_tubes = 1 + random.index(3);
    for tube in 0..n_tubes {
        let terms: Vec<[[f64; 3]; 2]> =
            (1..3).map(|k| [(); 2].map(|()| random.normals().map(|c| c / f64::from(k * k)))).collect();
        let center = |t: f64| -> [f64; 3] {
            std::array::from_fn(|k| {
                let term = |(w, n): (&[[f64; 3]; 2], f64)| {
                    w[0][k] * (TAU * t * n).cos() + w[1][k] * (TAU * t * n).sin()
                };
                terms.iter().zip([1.0, 2.0]).map(term).sum::<f64>()
                    + if k == 0 { 5.0 * tube as f64 } else { 0.0 }
            })
        };
        let around = 10 + random.index(20);
        let length: f64 = (0..400)
            .map(|i| {
                let d = minus(center(f64::from(i + 1) / 400.0), center(f64::from(i) / 400.0));
                dot(d, d).sqrt()
            })
            .sum();
        let along = 7000 / n_tubes / around;
        let radius = length / along as f64 * around as f64 / TAU;
        let jitter = random.uniform_in(0.0, 0.3);
        let (own, own_triangles) = grid([along, around], [true, true], jitter, random, |u, v| {
            let (p, q) = (center(u), center(u + 1e-4));
            let along = unit(minus(q, p));
            let side = unit(cross(along, [0.311, 0.273, 0.911]));
            let up = cross(along, side);
            let (s, c) = (TAU * v).sin_cos();
            std::array::from_fn(|k| p[k] + radius * (c * side[k] + s * up[k]))
        });
        let first = points.len() as u32;
        points.extend(own);
        triangles.extend(own_triangles.into_iter().map(|t| t.map(|v| v + first)));
    }
    (points, triangles)
}

fn terrain(random: &mut Random) -> PointsAndTriangles {
    let n_ridges = random.index(5);
    let waves: Vec<([f64; 2], f64, f64)> = (0..8)
        .map(|_| {
            let (angle, length) = (random.uniform_in(0.0, TAU), random.uniform_in(1.0, 8.0));
            let k = [length * angle.cos(), length * angle.sin()];
            (k, random.uniform_in(0.0, TAU), random.uniform_in(0.05, 0.3) / length)
        })
        .collect();
    let (step, edge) = (random.uniform_in(0.0, 0.15), random.uniform_in(-0.5, 0.5));
    let jitter = random.uniform_in(0.0, 0.35);
    grid([84, 84], [false, false], jitter, random, |u, v| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let wave = |(j, (k, p, a)): (usize, &([f64; 2], f64, f64))| {
            let s = (k[0] * x + k[1] * y + p).sin();
            a * if j < n_ridges { 1.0 - 2.0 * s.abs() } else { s }
        };
        let z: f64 = waves.iter().enumerate().map(wave).sum();
        let rise = ((x + 0.3 * y - edge) / 0.05).clamp(0.0, 1.0);
        [x, y, z + step * rise]
    })
}

/// Kind of noise of a mesh, with its strength in mean edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshNoise {
    /// None: a clean mesh must stay.
    Clean,
    /// Along the normals.
    Normal(f64),
    /// In all directions; the length of the displacement has this root mean square.
    Isotropic(f64),
    /// Along the normals for a share of the vertices, after weak noise along the normals of all.
    Impulses {
        /// Share of the vertices.
        share: f64,
        /// Standard deviation of the impulses.
        deviation: f64,
        /// Standard deviation of all others.
        others: f64,
    },
    /// Along one direction, averaged four times over neighbors.
    Correlated(f64),
    /// Along the line of sight, growing with the square of the depth.
    Sight(f64),
    /// Coordinates rounded to multiples of this.
    Quantized(f64),
}

impl MeshNoise {
    /// Kinds and strengths of the benchmark, with their names.
    pub const ALL: [(&'static str, Self); 17] = [
        ("none", Self::Clean),
        ("normals, 0.05", Self::Normal(0.05)),
        ("normals, 0.1", Self::Normal(0.1)),
        ("normals, 0.2", Self::Normal(0.2)),
        ("normals, 0.3", Self::Normal(0.3)),
        ("normals, 0.5", Self::Normal(0.5)),
        ("normals, 0.7", Self::Normal(0.7)),
        ("normals, 1", Self::Normal(1.0)),
        ("all directions, 0.3", Self::Isotropic(0.3)),
        ("all directions, 0.6", Self::Isotropic(0.6)),
        ("impulses, 20 % by 0.6", Self::Impulses { share: 0.2, deviation: 0.6, others: 0.0 }),
        ("impulses, 40 % by 0.6", Self::Impulses { share: 0.4, deviation: 0.6, others: 0.0 }),
        ("impulses, 10 % by 0.8, and 0.1", Self::Impulses { share: 0.1, deviation: 0.8, others: 0.1 }),
        ("shared, 0.15", Self::Correlated(0.15)),
        ("shared, 0.3", Self::Correlated(0.3)),
        ("sight, 0.3", Self::Sight(0.3)),
        ("rounded, 0.5", Self::Quantized(0.5)),
    ];

    /// Adds the noise of a seed.
    pub fn apply(self, clean: &CleanMesh, seed: u64) -> Vec<[f64; 3]> {
        let mut random = Random::new(seed.wrapping_add(0x0dec_0de0));
        let edge = clean.mean_edge();
        let normals = clean.normals();
        let depth = |p: &[f64; 3]| dot(minus(*p, clean.sensor), minus(*p, clean.sensor)).sqrt();
        let mean_depth = clean.points.iter().map(depth).sum::<f64>() / clean.points.len().max(1) as f64;
        let shared =
            if let Self::Correlated(_) = self { shared_heights(clean, &mut random) } else { Vec::new() };
        let along = |p: &[f64; 3], n: [f64; 3], h: f64| std::array::from_fn(|k| p[k] + h * edge * n[k]);
        let mut moved = |x: usize, p: &[f64; 3]| -> [f64; 3] {
            match self {
                Self::Clean => *p,
                Self::Normal(s) => along(p, normals[x], s * random.normal()),
                Self::Isotropic(s) => along(p, random.normals(), s / 3.0_f64.sqrt()),
                Self::Impulses { share, deviation, others } => {
                    let s = if random.uniform() < share { deviation } else { others };
                    along(p, normals[x], s * random.normal())
                }
                Self::Correlated(s) => along(p, [0.267_261, 0.534_522, 0.801_784], s * shared[x]),
                Self::Sight(s) => {
                    let d = unit(minus(*p, clean.sensor));
                    along(p, d, s * (depth(p) / mean_depth).powi(2) * random.normal())
                }
                Self::Quantized(s) => p.map(|c| (c / (s * edge)).round() * s * edge),
            }
        };
        clean.points.iter().enumerate().map(|(x, p)| moved(x, p)).collect()
    }
}

/// Heights averaged four times over neighbors, with a mean square of 1.
fn shared_heights(clean: &CleanMesh, random: &mut Random) -> Vec<f64> {
    let n = clean.points.len();
    let mut heights: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    for _ in 0..4 {
        let (mut sums, mut counts) = (heights.clone(), vec![1.0; n]);
        for t in &clean.triangles {
            for k in 0..3 {
                // Each inner edge occurs twice.
                let [a, b] = [t[k] as usize, t[(k + 1) % 3] as usize];
                sums[a] += 0.5 * heights[b];
                sums[b] += 0.5 * heights[a];
                counts[a] += 0.5;
                counts[b] += 0.5;
            }
        }
        heights = sums.iter().zip(&counts).map(|(s, c)| s / c).collect();
    }
    let square = heights.iter().map(|h| h * h).sum::<f64>() / n.max(1) as f64;
    heights.iter().map(|h| h / square.sqrt().max(f64::MIN_POSITIVE)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_oriented_and_noise_has_the_asked_size() {
        for (name, shape) in MeshShape::ALL {
            let clean = shape.mesh(4);
            assert!((1500..15_000).contains(&clean.points.len()), "{name}: {}", clean.points.len());
            let mut edges: HashMap<[u32; 2], i64> = HashMap::new();
            for t in &clean.triangles {
                for k in 0..3 {
                    let [a, b] = [t[k], t[(k + 1) % 3]];
                    *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
                }
            }
            let n_open = edges.values().filter(|n| **n != 0).count();
            let is_open = matches!(shape, MeshShape::Terrain | MeshShape::OpenScan);
            assert_eq!(n_open > 0, is_open, "{name}: {n_open}");
            assert!(clean.angle(&clean.points) < 1e-4, "{name}: degrees by rounding");
            let noisy = MeshNoise::Normal(0.3).apply(&clean, 9);
            let square = |(p, q): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
            let n = clean.points.len() as f64;
            let rms = (noisy.iter().zip(&clean.points).map(square).sum::<f64>() / n).sqrt();
            assert!((rms / clean.mean_edge() / 0.3 - 1.0).abs() < 5.0 / (2.0 * n).sqrt(), "{name}: {rms}");
        }
    }
}
