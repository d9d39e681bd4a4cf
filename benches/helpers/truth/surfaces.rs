//! Triangle soups of random shapes.

use super::random::Random;
use std::f64::consts::{PI, TAU};

/// Corners of a triangle.
pub(super) type Triangle = [[f64; 3]; 3];

/// Adds the triangles of a grid of `n_u` × `n_v` cells over the unit square.
fn push_grid(soup: &mut Vec<Triangle>, [n_u, n_v]: [usize; 2], position: impl Fn(f64, f64) -> [f64; 3]) {
    let at = |i: usize, j: usize| position(i as f64 / n_u as f64, j as f64 / n_v as f64);
    for i in 0..n_u {
        for j in 0..n_v {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            soup.push([a, b, c]);
            soup.push([a, c, d]);
        }
    }
}

fn push_box(soup: &mut Vec<Triangle>, center: [f64; 3], half: [f64; 3]) {
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            push_grid(soup, [1, 1], |u, v| {
                let mut p = center;
                p[axis] += side * half[axis];
                p[a] += half[a] * (2.0 * u - 1.0);
                p[b] += half[b] * (2.0 * v - 1.0);
                p
            });
        }
    }
}

/// Turned part: random steps, cones and roundings around an axis.
pub(super) fn turned_part(random: &mut Random) -> Vec<Triangle> {
    let mut profile = vec![[0.0, 0.0]];
    let (mut radius, mut height) = (random.uniform_in(0.3, 1.0), 0.0);
    profile.push([radius, height]);
    for _ in 0..3 + random.index(6) {
        let rise = random.uniform_in(0.08, 0.6);
        match random.index(4) {
            0 => {
                radius = (radius + random.uniform_in(-0.4, 0.4)).max(0.12);
                profile.push([radius, height]);
                height += rise;
            }
            1 => {
                radius = (radius + random.uniform_in(-0.3, 0.3)).max(0.12);
                height += rise;
            }
            2 => {
                // A torus-like bulge.
                for k in 1..12 {
                    let angle = PI * f64::from(k) / 12.0;
                    let outside = radius + 0.3 * rise * angle.sin();
                    profile.push([outside, height + 0.5 * rise * (1.0 - angle.cos())]);
                }
                height += rise;
            }
            _ => height += rise,
        }
        profile.push([radius, height]);
    }
    profile.push([0.0, height]);
    let mut soup = Vec::new();
    for pair in profile.windows(2) {
        push_grid(&mut soup, [96, 1], |u, v| {
            let [r, z] = std::array::from_fn(|k| pair[0][k] + v * (pair[1][k] - pair[0][k]));
            [r * (TAU * u).cos(), r * (TAU * u).sin(), z]
        });
    }
    soup
}

/// Extruded part: a random outline with holes, cut from a plate whose thickness may be small.
pub(super) fn extruded_part(random: &mut Random) -> Vec<Triangle> {
    let thickness = random.uniform_in(0.04, 0.7);
    let n_teeth = 3 + random.index(10);
    let depth = random.uniform_in(0.0, 0.3);
    let is_smooth = random.index(2) == 0;
    let n = 240;
    let outline = |k: usize| {
        let angle = TAU * k as f64 / n as f64;
        let wave = (angle * n_teeth as f64).sin();
        let r = 1.0 + depth * if is_smooth { wave } else { wave.signum() };
        [r * angle.cos(), r * angle.sin()]
    };
    let hole = random.uniform_in(0.15, 0.55);
    let bolts: Vec<[f64; 3]> = (0..random.index(6))
        .map(|_| {
            let (angle, at) = (random.uniform_in(0.0, TAU), random.uniform_in(0.6, 0.68));
            [at * angle.cos(), at * angle.sin(), random.uniform_in(0.03, 0.08)]
        })
        .collect();
    let mut soup = Vec::new();
    for k in 0..n {
        let [a, b] = [outline(k), outline((k + 1) % n)];
        push_grid(&mut soup, [1, 1], |u, v| {
            [a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1]), thickness * v]
        });
        // The faces between the hole and the outline, in small cells, so that bolt holes can be cut.
        let inner = |p: [f64; 2]| {
            let angle = p[1].atan2(p[0]);
            [hole * angle.cos(), hole * angle.sin()]
        };
        for z in [0.0, thickness] {
            let mut face = Vec::new();
            push_grid(&mut face, [1, 40], |u, v| {
                let outer = [a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1])];
                let inside = inner(outer);
                [inside[0] + v * (outer[0] - inside[0]), inside[1] + v * (outer[1] - inside[1]), z]
            });
            face.retain(|t| !bolts.iter().any(|h| (t[0][0] - h[0]).hypot(t[0][1] - h[1]) < h[2]));
            soup.extend(face);
        }
    }
    for [x, y, r] in bolts.into_iter().chain([[0.0, 0.0, hole]]) {
        push_grid(&mut soup, [64, 1], |u, v| {
            [x + r * (TAU * u).cos(), y + r * (TAU * u).sin(), thickness * v]
        });
    }
    soup
}

/// Thin walls that cross each other on a thin plate, as in a cast housing.
pub(super) fn ribs(random: &mut Random) -> Vec<Triangle> {
    let wall = random.uniform_in(0.012, 0.06);
    let size = [1.0, random.uniform_in(0.5, 1.0), random.uniform_in(0.15, 0.5)];
    let mut boxes = vec![([0.0, 0.0, 0.0], [size[0], size[1], wall])];
    for _ in 0..2 + random.index(5) {
        let thin = wall * random.uniform_in(0.7, 1.5);
        let height = size[2] * random.uniform_in(0.6, 1.0);
        if random.index(2) == 0 {
            let x = random.uniform_in(-1.0, 1.0) * (size[0] - thin);
            boxes.push(([x, 0.0, height], [thin, size[1], height]));
        } else {
            let y = random.uniform_in(-1.0, 1.0) * (size[1] - thin);
            boxes.push(([0.0, y, height], [size[0], thin, height]));
        }
    }
    let mut soup = Vec::new();
    for (k, (center, half)) in boxes.iter().enumerate() {
        let mut own = Vec::new();
        for axis in 0..3 {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            for side in [-1.0, 1.0] {
                push_grid(&mut own, [80, 80], |u, v| {
                    let mut p = *center;
                    p[axis] += side * half[axis];
                    p[a] += half[a] * (2.0 * u - 1.0);
                    p[b] += half[b] * (2.0 * v - 1.0);
                    p
                });
            }
        }
        // What lies in another wall is not seen.
        own.retain(|t| {
            let middle: [f64; 3] = std::array::from_fn(|c| (t[0][c] + t[1][c] + t[2][c]) / 3.0);
            let is_in = |(j, (c, h)): (usize, &([f64; 3], [f64; 3]))| {
                j != k && (0..3).all(|i| (middle[i] - c[i]).abs() <= h[i] + if j < k { 1e-9 } else { -1e-9 })
            };
            !boxes.iter().enumerate().any(is_in)
        });
        soup.extend(own);
    }
    soup
}

/// Organic shape: a sphere with random waves of several lengths.
pub(super) fn organic(random: &mut Random) -> Vec<Triangle> {
    let waves: Vec<([f64; 3], f64, f64)> = (0..4 + random.index(10))
        .map(|_| {
            let length = random.uniform_in(1.0, 9.0);
            let amplitude = random.uniform_in(0.1, 0.45) / length;
            (random.direction().map(|c| c * length), random.uniform_in(0.0, TAU), amplitude)
        })
        .collect();
    let stretch = [1.0, random.uniform_in(0.4, 1.0), random.uniform_in(0.4, 1.0)];
    let mut soup = Vec::new();
    push_grid(&mut soup, [240, 120], |u, v| {
        let (angle, polar) = (TAU * u, PI * v);
        let d = [polar.sin() * angle.cos(), polar.sin() * angle.sin(), polar.cos()];
        let r: f64 = 1.0
            + waves
                .iter()
                .map(|(k, phase, a)| a * (k[0] * d[0] + k[1] * d[1] + k[2] * d[2] + phase).sin())
                .sum::<f64>();
        std::array::from_fn(|k| r.max(0.15) * stretch[k] * d[k])
    });
    soup
}

/// Shell: two sheets a small, constant distance apart, flat, bent or round, with a rim.
pub(super) fn shell(random: &mut Random) -> Vec<Triangle> {
    let thickness = random.uniform_in(0.02, 0.2);
    let bend = if random.index(3) == 0 { 0.0 } else { random.uniform_in(0.2, 2.5) };
    let twist = random.uniform_in(-0.5, 0.5);
    let width = random.uniform_in(0.4, 1.0);
    let at = |u: f64, v: f64, offset: f64| {
        let (x, y) = (2.0 * u - 1.0, width * (2.0 * v - 1.0));
        let ripple = 0.06 * (7.0 * y).sin() * twist;
        if bend < 1e-9 {
            return [x, y, offset + ripple];
        }
        let r = 1.0 / bend + offset + ripple;
        [r * (bend * x).sin(), y, r * (bend * x).cos()]
    };
    let mut soup = Vec::new();
    for offset in [0.0, thickness] {
        push_grid(&mut soup, [120, 60], |u, v| at(u, v, offset));
    }
    for side in [0.0, 1.0] {
        push_grid(&mut soup, [120, 1], |u, v| at(u, side, thickness * v));
        push_grid(&mut soup, [1, 60], |u, v| at(side, v, thickness * u));
    }
    soup
}

/// Tube along a random closed curve, or several.
pub(super) fn tubes(random: &mut Random) -> Vec<Triangle> {
    let mut soup = Vec::new();
    for _ in 0..=random.index(3) {
        let terms: Vec<([f64; 3], [f64; 3])> = (1..4)
            .map(|k| [(); 2].map(|()| random.normals().map(|c| c / f64::from(k * k))))
            .map(|[a, b]| (a, b))
            .collect();
        let wanted = random.uniform_in(0.05, 0.3);
        let center = |t: f64| -> [f64; 3] {
            std::array::from_fn(|k| {
                terms
                    .iter()
                    .zip(1..)
                    .map(|((a, b), n)| {
                        let angle = TAU * t * f64::from(n);
                        a[k] * angle.cos() + b[k] * angle.sin()
                    })
                    .sum()
            })
        };
        // A tube that is thicker than its curve is round would pass through itself.
        let roundest =
            (0..400).map(|i| curve_radius(&center, f64::from(i) / 400.0)).fold(f64::INFINITY, f64::min);
        let radius = wanted.min(0.7 * roundest);
        push_grid(&mut soup, [400, 24], |u, v| {
            let (p, q) = (center(u), center(u + 1e-4));
            let along = unit(std::array::from_fn(|k| q[k] - p[k]));
            let side = unit(cross(along, [0.311, 0.273, 0.911]));
            let up = cross(along, side);
            let (s, c) = (TAU * v).sin_cos();
            std::array::from_fn(|k| p[k] + radius * (c * side[k] + s * up[k]))
        });
    }
    soup
}

/// Radius of the circle through three neighboring points of a curve.
fn curve_radius(center: &impl Fn(f64) -> [f64; 3], t: f64) -> f64 {
    let [p, q, r] = [t - 1e-3, t, t + 1e-3].map(center);
    let (a, b, c) = (minus(q, p), minus(r, q), minus(r, p));
    let doubled = cross(a, b);
    (dot(a, a) * dot(b, b) * dot(c, c)).sqrt() / (2.0 * dot(doubled, doubled).sqrt()).max(1e-12)
}

/// Open terrain with ridges and steps.
pub(super) fn terrain(random: &mut Random) -> Vec<Triangle> {
    let n_ridges = random.index(5);
    let waves: Vec<([f64; 2], f64, f64)> = (0..8)
        .map(|_| {
            let (angle, length) = (random.uniform_in(0.0, TAU), random.uniform_in(1.0, 8.0));
            let k = [length * angle.cos(), length * angle.sin()];
            (k, random.uniform_in(0.0, TAU), random.uniform_in(0.05, 0.3) / length)
        })
        .collect();
    let (step, edge) = (random.uniform_in(0.0, 0.15), random.uniform_in(-0.5, 0.5));
    let mut soup = Vec::new();
    push_grid(&mut soup, [160, 160], |u, v| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let wave = |(j, (k, p, a)): (usize, &([f64; 2], f64, f64))| {
            let s = (k[0] * x + k[1] * y + p).sin();
            a * if j < n_ridges { 1.0 - 2.0 * s.abs() } else { s }
        };
        let z: f64 = waves.iter().enumerate().map(wave).sum();
        [x, y, z + if x + 0.3 * y > edge { step } else { 0.0 }]
    });
    soup
}

/// Room with furniture; it is seen from inside.
pub(super) fn room(random: &mut Random) -> Vec<Triangle> {
    let half = [random.uniform_in(0.7, 1.0), random.uniform_in(0.5, 1.0), random.uniform_in(0.3, 0.5)];
    let mut soup = Vec::new();
    push_box(&mut soup, [0.0; 3], half);
    for _ in 0..3 + random.index(6) {
        let size =
            [random.uniform_in(0.03, 0.2), random.uniform_in(0.03, 0.2), random.uniform_in(0.05, 0.25)];
        let x = random.uniform_in(-0.9, 0.9) * half[0];
        let y = random.uniform_in(-0.9, 0.9) * half[1];
        if x.hypot(y) < 0.35 {
            continue;
        }
        match random.index(3) {
            0 => push_box(&mut soup, [x, y, size[2] - half[2]], size),
            1 => push_grid(&mut soup, [24, 12], |u, v| {
                let (angle, polar, r) = (TAU * u, PI * v, size[0]);
                let d = [polar.sin() * angle.cos(), polar.sin() * angle.sin(), polar.cos()];
                [x + r * d[0], y + r * d[1], r - half[2] + r * d[2] + size[2]]
            }),
            _ => push_grid(&mut soup, [20, 1], |u, v| {
                let r = 0.15 * size[0];
                let z = half[2] * (2.0 * v - 1.0);
                [x + r * (TAU * u).cos(), y + r * (TAU * u).sin(), z]
            }),
        }
    }
    soup
}

/// Cross product.
pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Inner product.
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Difference of two vectors.
pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Unit vector; zero for zero.
pub(super) fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    if length > 0.0 { a.map(|c| c / length) } else { a }
}
