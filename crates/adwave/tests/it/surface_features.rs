//! Features of meshes are those of the surface: none on plain shapes, whatever their triangles, and bumps where they are,
//! with their sizes.

use adwave::bands::{BandsParams, Schedule};
use adwave::features::{Feature, FeatureParams, ShapeCoordinates, coordinate_features, feature_extent};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::saliency::{SaliencyParams, saliency};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Polygons, Shape, vertex_normals};
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::{PI, TAU};

type Point = [f64; 3];

/// A mesh of triangles.
struct Surface {
    points: Vec<Point>,
    triangles: Vec<[u32; 3]>,
}

/// Uniform numbers in [0, 1).
struct Draw(Pcg64Mcg);

impl Draw {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

fn unit(p: Point) -> Point {
    let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
    p.map(|c| c / length)
}

fn distance(p: &Point, q: &Point) -> f64 {
    (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt()
}

/// Sphere of radius 1, whose vertices are moved along it by up to `uneven` edges.
fn sphere(n: usize, uneven: f64, seed: u64) -> Surface {
    let Sample { points, faces, .. } = Sample::from_name("sphere", Some(n)).unwrap();
    let mut draw = Draw::new(seed);
    let edge = (4.0 * PI / n as f64 * 1.155).sqrt();
    let moved = |p: &Point| unit(p.map(|c| c + uneven * edge * (2.0 * draw.uniform() - 1.0)));
    let points = points.iter().map(moved).collect();
    Surface { points, triangles: faces.triangles().unwrap().to_vec() }
}

/// Images of a grid of `size` × `size` parameters in [0, 1]², each moved by up to `uneven` sides of a cell, in triangles
/// by random diagonals.
fn patch(size: usize, uneven: f64, seed: u64, image: impl Fn(f64, f64) -> Point) -> Surface {
    let mut draw = Draw::new(seed);
    let side = 1.0 / (size - 1) as f64;
    let mut points = Vec::new();
    for row in 0..size {
        for column in 0..size {
            let mut move_by = |at: usize| {
                let inside = at > 0 && at < size - 1;
                at as f64 * side + if inside { uneven * side * (2.0 * draw.uniform() - 1.0) } else { 0.0 }
            };
            let (u, v) = (move_by(column), move_by(row));
            points.push(image(u, v));
        }
    }
    let mut triangles = Vec::new();
    for row in 0..size - 1 {
        for column in 0..size - 1 {
            let a = (row * size + column) as u32;
            let [b, c, d] = [a + 1, a + size as u32, a + size as u32 + 1];
            let cut = if draw.uniform() < 0.5 { [[a, b, d], [a, d, c]] } else { [[a, b, c], [b, d, c]] };
            triangles.extend(cut);
        }
    }
    Surface { points, triangles }
}

/// A plane, a cylinder, a cone, a paraboloid and a saddle.
fn open_surface(kind: usize, size: usize, uneven: f64, graded: bool, seed: u64) -> Surface {
    patch(size, uneven, seed, |u, v| {
        let u = if graded { u.powf(1.7) } else { u };
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let around = 1.5 * PI * u;
        match kind {
            0 => [x, y, 0.0],
            1 => [around.cos(), around.sin(), 4.7 * v],
            2 => [(1.0 - 0.4 * v) * around.cos(), (1.0 - 0.4 * v) * around.sin(), 4.7 * v],
            3 => [x, y, 0.5 * (x * x + y * y)],
            _ => [x, y, 0.5 * (x * x - y * y)],
        }
    })
}

impl Surface {
    /// Noise along the normals with a standard deviation in mean edges.
    fn with_noise(mut self, noise: f64, seed: u64) -> Self {
        let mut draw = Draw::new(seed.wrapping_add(77));
        let normals = vertex_normals(&self.points, &self.triangles);
        let lengths =
            self.triangles.iter().map(|t| distance(&self.points[t[0] as usize], &self.points[t[1] as usize]));
        let edge = lengths.sum::<f64>() / self.triangles.len() as f64;
        for (p, n) in self.points.iter_mut().zip(normals) {
            let off = noise * edge * draw.normal();
            (0..3).for_each(|c| p[c] += off * n[c]);
        }
        self
    }

    fn decomposer(&self) -> Decomposer {
        let faces = Polygons::from_triangles(&self.triangles);
        let shape = Shape::Mesh(Mesh::new(self.points.clone(), faces).unwrap());
        let params = OperatorParams::default().with_kind(OperatorKind::Surface);
        Decomposer::with_params(&shape, &params, Progress::none()).unwrap()
    }

    fn saliency(&self) -> Vec<f64> {
        let decomposer = self.decomposer();
        let outward = decomposer.outward_normals(None, Progress::none()).unwrap();
        let schedule = Schedule::dyadic(decomposer.levels_reaching(0.16).0).unwrap();
        let request = decomposer.request(self.points.as_flattened(), 3, &schedule);
        let wavelets = request.normal_components(&outward.normals).unwrap();
        saliency(&decomposer, &wavelets, &SaliencyParams::default(), Progress::none()).unwrap().map
    }

    fn features(&self) -> Vec<Feature> {
        let decomposer = self.decomposer();
        let levels = decomposer.levels_reaching(feature_extent(&decomposer)).0;
        let schedule = Schedule::dyadic(levels).unwrap();
        let bands = BandsParams::default();
        let coordinates =
            ShapeCoordinates { points: &self.points, normals: None, schedule: &schedule, bands };
        let params = FeatureParams::default();
        assert!(params.finds_significant(&decomposer));
        coordinate_features(&decomposer, &coordinates, &params, Progress::none()).unwrap().features
    }
}

/// Numbers of cases with features among plain shapes, without and with noise, for some seeds and sizes.
fn plain_shapes_with_features(seeds: std::ops::Range<u64>, n: usize) -> ([usize; 2], usize) {
    let (mut with_features, mut n_cases) = ([0, 0], 0);
    for seed in seeds {
        for kind in 0..6 {
            for (k, noise) in [0.0, [0.02, 0.1, 0.3][(seed % 3) as usize]].into_iter().enumerate() {
                let uneven = [0.0, 0.2, 0.3, 0.45][((seed + kind as u64) % 4) as usize];
                let size = (n as f64).sqrt() as usize;
                let surface = match kind {
                    5 => sphere(n, uneven, seed),
                    _ => open_surface(kind, size, uneven, seed % 2 == 0, seed),
                };
                let found = surface.with_noise(noise, seed).features();
                if !found.is_empty() {
                    println!("kind {kind}, {n} vertices, seed {seed}, noise {noise}: {:?}", found[0]);
                }
                with_features[k] += usize::from(!found.is_empty());
                n_cases += k;
            }
        }
    }
    (with_features, n_cases)
}

#[test]
fn plain_shapes_have_no_features() {
    let (with_features, n_cases) = plain_shapes_with_features(0..4, 2500);
    assert_eq!(with_features[0], 0, "of {n_cases} shapes without noise");
    assert!(20 * with_features[1] <= n_cases, "{} of {n_cases} shapes with noise", with_features[1]);
}

/// Directions that are at least `apart` from each other.
fn spread(count: usize, apart: f64, seed: u64) -> Vec<Point> {
    let mut draw = Draw::new(seed);
    let mut found: Vec<Point> = Vec::new();
    for _ in 0..100_000 {
        let p = unit([draw.normal(), draw.normal(), draw.normal()]);
        if found.len() < count && found.iter().all(|q| distance(&p, q) > apart) {
            found.push(p);
        }
    }
    found
}

#[test]
fn bumps_and_dents_are_found_with_their_sizes() {
    let n = 10_000;
    let edge = (4.0 * PI / f64::from(n) * 1.155).sqrt();
    for (k, (edges, height, count)) in [
        (3.0, 0.005, 12),
        (3.0, -0.005, 12),
        (6.0, 0.005, 8),
        (6.0, -0.02, 8),
        (8.0, 0.01, 4),
        (4.0, 0.02, 30),
    ]
    .into_iter()
    .enumerate()
    {
        let width = edges * edge;
        let mut surface = sphere(n as usize, 0.3, 40 + k as u64);
        let centers = spread(count, (6.0 * width).min(1.2), 50 + k as u64);
        let directions = surface.points.clone();
        for p in &mut surface.points {
            let heights =
                centers.iter().map(|c| height * (-distance(p, c).powi(2) / (2.0 * width * width)).exp());
            let factor = 1.0 + heights.sum::<f64>();
            *p = p.map(|c| factor * c);
        }
        let found = surface.features();
        let is_near = |f: &Feature, c: &Point| {
            distance(&directions[f.vertex], c) < 0.5 * width
                && (f.sigma / width - 1.0).abs() < 0.25
                && f64::from(f.sign()) * height > 0.0
        };
        let n_found = centers.iter().filter(|c| found.iter().any(|f| is_near(f, c))).count();
        let n_false = found.iter().filter(|f| !centers.iter().any(|c| is_near(f, c))).count();
        assert_eq!((n_found, n_false), (centers.len(), 0), "{edges} edges wide, {height} high: {found:?}");
    }
}

#[test]
fn the_saliency_of_a_sphere_is_nothing_whatever_its_triangles() {
    for (uneven, height) in [(0.0, 0.0), (0.3, 0.0), (0.45, 0.0), (0.3, 0.02)] {
        let mut surface = sphere(5000, uneven, 3);
        for p in &mut surface.points {
            let factor = 1.0 + height * (-distance(p, &[0.0, 0.0, 1.0]).powi(2) / 0.02).exp();
            *p = p.map(|c| factor * c);
        }
        let map = surface.saliency();
        let most = map.iter().copied().fold(0.0, |a: f64, b| a.max(b.abs()));
        if height == 0.0 {
            // On triangles this thin, heat lags at the vertices with the shortest edges.
            let limit = if uneven > 0.4 { 1e-3 } else { 0.0 };
            assert!(most <= limit, "{most} for vertices uneven by {uneven}");
        } else {
            let top = (0..map.len()).max_by(|&a, &b| map[a].total_cmp(&map[b])).unwrap();
            assert!(most > 2e-3 && surface.points[top][2] > 0.99, "{most} at {:?}", surface.points[top]);
        }
    }
}

#[test]
fn the_saliency_of_noise_on_a_sphere_of_uneven_triangles_is_nothing() {
    for seed in 0..4 {
        let mut surface = sphere(10_000, 0.2, seed);
        for p in &mut surface.points {
            // A conformal map of the sphere to itself: triangles keep their angles, and shrink towards one pole.
            let factor = 1.0 / (1.0 + 0.5 * p[2]);
            *p = [0.75_f64.sqrt() * factor * p[0], 0.75_f64.sqrt() * factor * p[1], factor * (p[2] + 0.5)];
        }
        let map = surface.with_noise(0.05, seed).saliency();
        let most = map.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = map.iter().copied().fold(f64::INFINITY, f64::min);
        // With one estimate for all triangles four of six such spheres had 0.2 to 1.2.
        assert!(most - least < 0.02, "{least} to {most} for seed {seed}");
    }
}

#[test]
fn saliency_does_not_depend_on_the_unit_of_length() {
    let scaled = |factor: f64| {
        let mut surface = sphere(3000, 0.3, 5);
        for p in &mut surface.points {
            let height = 0.05 * (-distance(p, &[0.0, 0.0, 1.0]).powi(2) / 0.02).exp();
            *p = p.map(|c| factor * (1.0 + height) * c);
        }
        surface.saliency()
    };
    let map = scaled(1.0);
    let most = map.iter().copied().fold(0.0, f64::max);
    assert!(most > 1e-3, "{most}");
    for factor in [1e-90, 1e-30, 1e30, 1e90] {
        let other = scaled(factor);
        let error = map.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6 * most, "{error} of {most} for the factor {factor:e}");
    }
}
