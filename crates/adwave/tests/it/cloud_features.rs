//! Features of clouds are those of the shape: none on flat and round clouds, and bumps where they are.

use adwave::bands::{BandsParams, Schedule};
use adwave::features::{
    CoordinateFeatureError, Feature, FeatureError, FeatureParams, ShapeCoordinates, coordinate_features,
};
use adwave::shape::{PointCloud, Shape};
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Tops of the bumps of [`bumpy`].
const TOPS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.8, 0.6], [-0.5, -0.5, std::f64::consts::FRAC_1_SQRT_2]];

/// Random numbers for shapes.
struct Draw(Pcg64Mcg);

impl Draw {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// A point of the unit sphere.
    fn direction(&mut self) -> [f64; 3] {
        let v = [self.normal(), self.normal(), self.normal()];
        let size = v.iter().map(|c| c * c).sum::<f64>().sqrt().max(1e-9);
        v.map(|c| c / size)
    }
}

/// Draws `n` points of a surface, each with noise along its normal.
fn cloud(n: usize, seed: u64, noise: f64, draw: impl Fn(&mut Draw) -> ([f64; 3], [f64; 3])) -> Vec<[f64; 3]> {
    let mut random = Draw::new(seed);
    (0..n)
        .map(|_| {
            let (point, normal) = draw(&mut random);
            let off = noise * random.normal();
            std::array::from_fn(|c| point[c] + off * normal[c])
        })
        .collect()
}

fn flat(random: &mut Draw) -> ([f64; 3], [f64; 3]) {
    ([random.uniform(), random.uniform(), 0.0], [0.0, 0.0, 1.0])
}

/// A plane that is sampled ten times as densely on one side.
fn uneven(random: &mut Draw) -> ([f64; 3], [f64; 3]) {
    ([random.uniform().powf(2.5), random.uniform(), 0.0], [0.0, 0.0, 1.0])
}

fn round(random: &mut Draw) -> ([f64; 3], [f64; 3]) {
    let p = random.direction();
    (p, p)
}

fn cylinder(random: &mut Draw) -> ([f64; 3], [f64; 3]) {
    let angle = std::f64::consts::TAU * random.uniform();
    let out = [angle.cos(), angle.sin(), 0.0];
    ([out[0], out[1], 4.0 * random.uniform()], out)
}

/// A sphere with three bumps of a fifth of its radius.
fn bumpy(random: &mut Draw) -> ([f64; 3], [f64; 3]) {
    let p = random.direction();
    let bump = |top: &[f64; 3]| {
        let squared: f64 = (0..3).map(|c| (p[c] - top[c]).powi(2)).sum();
        0.2 * (-squared / (2.0 * 0.2 * 0.2)).exp()
    };
    let size = 1.0 + TOPS.iter().map(bump).sum::<f64>();
    (p.map(|c| c * size), p)
}

fn find(points: &[[f64; 3]], n_levels: usize) -> Vec<Feature> {
    let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.to_vec()).unwrap()));
    let schedule = Schedule::dyadic(n_levels).unwrap();
    let coordinates =
        ShapeCoordinates { points, normals: None, schedule: &schedule, bands: BandsParams::default() };
    let params = FeatureParams::default();
    coordinate_features(&decomposer, &coordinates, &params, Progress::none()).unwrap().features
}

#[test]
fn flat_round_and_cylindrical_clouds_have_no_features() {
    // The default levels for these numbers of points.
    for (n, n_levels) in [(1000, 4), (4000, 6)] {
        for seed in 0..4 {
            for noise in [0.0, 1e-6, 3e-3, 1e-2] {
                let shapes = [
                    ("flat", cloud(n, seed, noise, flat)),
                    ("uneven", cloud(n, seed, noise, uneven)),
                    ("round", cloud(n, seed, noise, round)),
                    ("cylinder", cloud(n, seed, noise, cylinder)),
                ];
                for (name, points) in shapes {
                    let found = find(&points, n_levels);
                    assert!(found.is_empty(), "{name}, {n} points, seed {seed}, noise {noise}: {found:?}");
                }
            }
        }
    }
}

#[test]
fn the_strongest_features_of_a_ball_with_three_bumps_are_the_bumps() {
    for (n, n_levels, noises) in [(3000, 5, [0.0, 0.003]), (8000, 6, [0.0, 0.01])] {
        for seed in 0..3 {
            for noise in noises {
                let mut found = find(&cloud(n, seed, noise, bumpy), n_levels);
                found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
                assert!(found.len() >= 3, "{n} {seed} {noise}: {found:?}");
                for top in TOPS {
                    let is_on_top = |f: &Feature| {
                        let p = f.position.unwrap();
                        (0..3).map(|c| (p[c] - 1.2 * top[c]).powi(2)).sum::<f64>().sqrt() < 0.2
                    };
                    let n_on_top = found[..3].iter().filter(|f| is_on_top(f)).count();
                    assert_eq!(n_on_top, 1, "{n} {seed} {noise}: {top:?} in {found:?}");
                }
            }
        }
    }
}

#[test]
fn features_of_clouds_move_scale_and_reorder_with_their_points() {
    let points = cloud(3000, 0, 0.002, bumpy);
    let found = find(&points, 5);
    assert!(!found.is_empty());
    let moved: Vec<[f64; 3]> = points.iter().rev().map(|[x, y, z]| [8.0 * y, -8.0 * x, 8.0 * z]).collect();
    let again = find(&moved, 5);
    let vertices = |found: &[Feature], map: &dyn Fn(usize) -> usize| {
        let mut vertices: Vec<(usize, usize)> = found.iter().map(|f| (map(f.vertex), f.level)).collect();
        vertices.sort_unstable();
        vertices
    };
    let n_common = {
        let (a, b) = (vertices(&found, &|v| v), vertices(&again, &|v| points.len() - 1 - v));
        a.iter().filter(|f| b.contains(f)).count()
    };
    // The half that is drawn depends on the order along the curve, which a rotation changes.
    assert!(n_common * 10 >= 8 * found.len().max(again.len()), "{found:?} {again:?}");
    let reversed: Vec<[f64; 3]> = points.iter().rev().copied().collect();
    let reversed = find(&reversed, 5);
    assert_eq!(vertices(&found, &|v| v), vertices(&reversed, &|v| points.len() - 1 - v));
}

#[test]
fn degenerate_clouds_have_no_features_and_few_levels_are_an_error() {
    for points in [
        vec![[1.0; 3]; 50],
        vec![[0.0; 3]],
        (0..200).map(|k| [f64::from(k), 0.0, 0.0]).collect(),
        (0..200).map(|k| [1e-200 * f64::from(k % 20), 1e-200 * f64::from(k / 20), 0.0]).collect(),
        (0..200).map(|k| [1e90 * f64::from(k % 20), 1e90 * f64::from(k / 20), 0.0]).collect(),
    ] {
        assert_eq!(find(&points, 5), [], "{:?}", points[0]);
    }
    let points = cloud(100, 0, 0.0, round);
    let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone()).unwrap()));
    let schedule = Schedule::dyadic(2).unwrap();
    let coordinates = ShapeCoordinates {
        points: &points,
        normals: None,
        schedule: &schedule,
        bands: BandsParams::default(),
    };
    let error = coordinate_features(&decomposer, &coordinates, &FeatureParams::default(), Progress::none());
    assert!(matches!(
        error,
        Err(CoordinateFeatureError::Features(FeatureError::TooFewLevels { n_levels: 2 }))
    ));
}
