//! Laws of the denoiser of clouds.

use crate::denoise::{denoised, pair, rms};
use adwave::Progress;
use adwave::denoise::{DenoiseParams, Denoised, Outliers};
use adwave::shape::{PointCloud, Shape};
use adwave::signal::normals_facing;
use adwave_io::{ReadLimits, read_path};
use adwave_test_data::data_test;
use std::path::Path;

fn defaults() -> DenoiseParams {
    DenoiseParams::default()
}

fn cloud(points: Vec<[f64; 3]>) -> Shape {
    Shape::Cloud(PointCloud::new(points).unwrap())
}

/// Deviates by the central limit, reproducible without a library.
struct Deviates(u64);

impl Deviates {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A jittered grid of so many points a side at height `z`, with noise along the normals.
fn sheet(side: usize, z: f64, noise: f64, random: &mut Deviates) -> Vec<[f64; 3]> {
    let mut jitter = |c: usize| c as f64 + 0.6 * (random.uniform() - 0.5);
    let flat: Vec<[f64; 2]> = (0..side * side).map(|i| [jitter(i / side), jitter(i % side)]).collect();
    flat.into_iter().map(|[x, y]| [x, y, z + noise * random.normal()]).collect()
}

/// Mean height and deviation of the inner points of a sheet.
fn inner_heights(points: &[[f64; 3]], side: usize) -> (f64, f64) {
    let is_inner = |p: &&[f64; 3]| p[..2].iter().all(|c| (8.0..side as f64 - 8.0).contains(c));
    let heights: Vec<f64> = points.iter().filter(is_inner).map(|p| p[2]).collect();
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let square = heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / heights.len() as f64;
    (mean, square.sqrt())
}

#[test]
fn plates_keep_their_thickness_with_normals_and_without() {
    const SIDE: usize = 50;
    const NOISE: f64 = 0.05;
    for (gap, has_normals) in [(0.5, true), (1.0, true), (1.5, false), (3.0, false)] {
        let mut random = Deviates(7);
        let low = sheet(SIDE, 0.0, NOISE, &mut random);
        let high = sheet(SIDE, gap, NOISE, &mut random);
        let n = low.len();
        let mut plates = PointCloud::new([low, high].concat()).unwrap();
        if has_normals {
            let normal = |i: usize| [0.0, 0.0, if i < n { -1.0 } else { 1.0 }];
            plates = plates.with_normals((0..2 * n).map(normal).collect());
        }
        let Denoised { points, .. } = denoised(&Shape::Cloud(plates), &defaults());
        let ((low, of_low), (high, of_high)) =
            (inner_heights(&points[..n], SIDE), inner_heights(&points[n..], SIDE));
        let thickness = (high - low) / gap;
        println!("{gap}: {thickness}, {of_low}, {of_high}");
        assert!((thickness - 1.0).abs() < 0.03, "{gap}: {thickness}");
        assert!(of_low.max(of_high) < 0.4 * NOISE, "{gap}: {of_low}, {of_high}");
    }
}

#[test]
fn a_flat_cloud_becomes_as_flat_as_a_quadric_through_thirty_neighbors_makes_it() {
    // The height of a quadric fitted to n points has about 4/n of their variance.
    let jets = (4.0_f64 / 30.0).sqrt();
    for noise in [0.05, 0.2, 0.5] {
        let points = sheet(60, 0.0, noise, &mut Deviates(3));
        let result = denoised(&cloud(points), &defaults());
        let (_, left) = inner_heights(&result.points, 60);
        let found = result.info.cloud.unwrap().noise_range;
        println!("{noise}: {left}, found {found:?}");
        assert!(left < jets * noise, "{noise}: {left}");
        assert!(found[0] < noise && noise < 1.1 * found[1], "{noise}: {found:?}");
    }
}

#[test]
fn clean_clouds_stay_and_nothing_moves_farther_than_the_noise_of_its_place() {
    for name in ["sphere", "torus", "bracket", "creature"] {
        for noise in [0.0, 0.1, 0.4] {
            if name == "creature" && noise < 0.2 {
                continue; // its texture is as large, and as fine as the points
            }
            let (clean, noisy) = pair(name, 8000, noise);
            let points = noisy.points().unwrap().to_vec();
            let result = denoised(&cloud(points.clone()), &defaults());
            let unit = result.info.noise / result.info.noise_in_edges.max(f64::MIN_POSITIVE);
            assert_eq!(result.info.n_far, 0, "{name}");
            assert!(result.info.furthest <= 3.0 * result.info.noise.max(10.0 * unit), "{name}");
            let truth = clean.points().unwrap();
            let (before, after) = (rms(&points, truth), rms(&result.points, truth));
            println!("{name}, {noise}: {before} → {after} of {unit}");
            if noise == 0.0 && result.info.noise > 0.0 {
                assert!(after < 0.05 * unit, "{name}: {after} of {unit}");
            }
            if noise > 0.0 {
                assert!(after < before, "{name}, {noise}: {before} → {after}");
            }
        }
    }
}

#[test]
fn outliers_are_kept_pulled_or_named() {
    let mut random = Deviates(11);
    let mut points = sheet(40, 0.0, 0.05, &mut random);
    let n = points.len();
    points.extend((0..20).map(|i| [5.0 + 1.5 * f64::from(i), 20.0 + 7.0 * random.normal(), 3.0]));
    for treatment in [Outliers::Keep, Outliers::Pull, Outliers::Drop] {
        let result = denoised(&cloud(points.clone()), &defaults().with_outliers(treatment));
        let far = result.outliers.iter().filter(|&&x| x as usize >= n).count();
        assert!(far >= 18 && result.outliers.len() <= far + 3, "{far} of {}", result.outliers.len());
        assert_eq!(result.info.cloud.as_ref().unwrap().n_outliers, result.outliers.len());
        for &x in &result.outliers {
            let [before, after] = [points[x as usize], result.points[x as usize]];
            match treatment {
                Outliers::Pull => assert!(after[2].abs() < 0.5, "{after:?}"),
                _ => assert_eq!(before, after),
            }
        }
    }
}

#[test]
fn lines_and_volumes_are_left_alone() {
    let mut random = Deviates(5);
    let line: Vec<[f64; 3]> =
        (0..600).map(|i| [f64::from(i), 0.1 * random.normal(), 0.1 * random.normal()]).collect();
    let result = denoised(&cloud(line.clone()), &defaults());
    assert!(rms(&result.points, &line) < 0.02);
    // A tree over a plain: points in a ball.
    let ground = sheet(60, 0.0, 0.03, &mut random);
    let n = ground.len();
    let tree: Vec<[f64; 3]> =
        (0..800).map(|_| [30.0, 30.0, 12.0].map(|c| c + 2.5 * random.normal())).collect();
    let points = [ground, tree].concat();
    let result = denoised(&cloud(points.clone()), &defaults());
    let moved = rms(&result.points[n..], &points[n..]);
    // A tenth of the size of the tree.
    assert!(moved < 0.25, "{moved}");
}

#[test]
fn coordinates_are_rounded_only_if_they_are_along_every_axis() {
    let found = |points: Vec<[f64; 3]>| {
        let result = denoised(&cloud(points), &defaults());
        result.info.cloud.unwrap().rounding
    };
    let mut random = Deviates(5);
    let any = sheet(30, 0.0, 0.05, &mut random);
    let rounded = |step: f64| any.iter().map(|p| p.map(|c| (c / step).round() * step)).collect::<Vec<_>>();
    assert_eq!(found(any.clone()), 0.0);
    assert!((found(rounded(0.25)) - 0.25).abs() < 1e-9);
    // Heights over a regular grid: its spacing is no rounding, and that of the heights is.
    let grid = |height: &dyn Fn(f64) -> f64| {
        any.iter().map(|p| [p[0].round(), p[1].round(), height(p[2])]).collect::<Vec<_>>()
    };
    assert_eq!(found(grid(&|z| z)), 0.0);
    assert!((found(grid(&|z| (z / 0.01).round() * 0.01)) - 0.01).abs() < 1e-9);
}

/// Random points of a unit sphere with noise along the normals, in mean distances of the points, and that distance.
fn sphere(n: usize, noise: f64, random: &mut Deviates) -> (Vec<[f64; 3]>, f64) {
    let spacing = (4.0 * std::f64::consts::PI / n as f64).sqrt();
    let mut point = || {
        let p: [f64; 3] = std::array::from_fn(|_| random.normal());
        let radius = 1.0 + noise * spacing * random.normal();
        p.map(|c| c * radius / p.iter().map(|c| c * c).sum::<f64>().sqrt())
    };
    ((0..n).map(|_| point()).collect(), spacing)
}

#[test]
fn noise_larger_than_the_distance_of_points_is_found_and_removed() {
    for (n, noise) in [(3000, 1.0), (10_000, 1.0), (10_000, 2.0), (10_000, 3.0), (20_000, 0.8)] {
        let (points, spacing) = sphere(n, noise, &mut Deviates(13));
        let result = denoised(&cloud(points), &defaults());
        let found = result.info.noise / (noise * spacing);
        let off = |p: &[f64; 3]| (p.iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).powi(2);
        let left = (result.points.iter().map(off).sum::<f64>() / n as f64).sqrt() / (noise * spacing);
        println!("{n}, {noise}: found {found}, left {left}");
        assert!((0.85..1.18).contains(&found), "{n}, {noise}: {found}");
        assert!(left < 0.25, "{n}, {noise}: {left}");
        assert_eq!(result.info.n_far, 0);
    }
}

#[test]
fn thin_walls_are_not_taken_for_strong_noise() {
    for gap in [1.5, 2.0, 3.0, 4.5, 6.0] {
        for noise in [0.05, 0.1, 0.4] {
            let mut random = Deviates(17);
            let walls = [sheet(50, 0.0, noise, &mut random), sheet(50, gap, noise, &mut random)].concat();
            let info = denoised(&cloud(walls), &defaults()).info;
            assert_eq!(info.cloud.unwrap().strong, None, "{gap}, {noise}");
            assert!(info.noise < 1.2 * noise.max(0.4), "{gap}, {noise}: {}", info.noise);
        }
    }
}

#[test]
fn walls_seen_from_both_sides_are_not_joined() {
    for gap in [0.5, 1.0, 1.5, 2.0, 3.0] {
        for noise in [0.05, 0.3, 0.6] {
            let mut random = Deviates(29);
            let (low, high) = (sheet(50, 0.0, noise, &mut random), sheet(50, gap, noise, &mut random));
            let n = low.len();
            let points = [low, high].concat();
            let scanners = [[10.0, 20.0, -40.0], [30.0, 25.0, 40.0]];
            let viewpoints: Vec<_> = (0..2 * n).map(|x| scanners[x / n]).collect();
            let normals = normals_facing(&points, &viewpoints, Progress::none()).unwrap();
            let seen = Shape::Cloud(PointCloud::new(points).unwrap().with_sides(normals));
            let points = denoised(&seen, &defaults()).points;
            let (low, high) = (inner_heights(&points[..n], 50), inner_heights(&points[n..], 50));
            println!("{gap}, {noise}: {low:?} {high:?}");
            assert!((high.0 - low.0 - gap).abs() < 0.05, "{gap}, {noise}: {low:?} {high:?}");
            assert!(low.1.max(high.1) < 0.5 * noise, "{gap}, {noise}: {low:?} {high:?}");
        }
    }
}

#[test]
fn noise_of_scan_lines_is_found_and_removed() {
    for apart in [5.0, 8.0, 15.0] {
        for noise in [0.05, 0.3, 1.0] {
            let mut random = Deviates(23);
            let lines: Vec<[f64; 3]> = (0..24 * 300)
                .map(|i| {
                    let along = f64::from(i % 300) + 0.4 * random.uniform();
                    [along, apart * f64::from(i / 300), noise * random.normal()]
                })
                .collect();
            let n = lines.len() as f64;
            let result = denoised(&cloud(lines), &defaults());
            let left = (result.points.iter().map(|p| p[2] * p[2]).sum::<f64>() / n).sqrt() / noise;
            let found = result.info.noise / noise;
            println!("{apart}, {noise}: found {found}, left {left}");
            assert!((0.75..1.33).contains(&found), "{apart}, {noise}: {found}");
            assert!(left < 0.3, "{apart}, {noise}: {left}");
            assert!(result.info.cloud.unwrap().neighbors > 48);
        }
    }
}

#[test]
fn smooth_parts_keep_a_fifth_of_weak_noise() {
    for noise in [0.1, 0.3] {
        let (points, spacing) = sphere(10_000, noise, &mut Deviates(29));
        let result = denoised(&cloud(points), &defaults());
        let off = |p: &[f64; 3]| (p.iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).powi(2);
        let left = (result.points.iter().map(off).sum::<f64>() / 1e4).sqrt() / (noise * spacing);
        println!("{noise}: left {left}");
        assert!(left < 0.2, "{noise}: {left}");
    }
}

/// Five plates of `side` × `side` points, `gap` apart, with noise in all directions.
fn plates(side: usize, gap: f64, noise: f64) -> Shape {
    let mut random = Deviates(11);
    let clean: Vec<[f64; 3]> =
        (0..5_u32).flat_map(|k| sheet(side, gap * f64::from(k), 0.0, &mut random)).collect();
    cloud(clean.into_iter().map(|p| p.map(|c| c + noise * random.normal())).collect())
}

#[test]
fn noise_that_no_flat_neighborhood_shows_is_doubtful() {
    for (noise, is_doubtful) in [(0.1, false), (3.0, true)] {
        let info = denoised(&plates(24, 6.0, noise), &defaults()).info;
        let found = info.cloud.expect("the shape is a cloud");
        println!("{noise}: found {}, flat {:?}", info.noise, found.flat_share);
        assert_eq!(found.is_noise_doubtful(), is_doubtful, "{noise}: {:?}", found.flat_share);
    }
    let found = denoised(&plates(24, 6.0, 3.0), &defaults().with_noise(3.0))
        .info
        .cloud
        .expect("the shape is a cloud");
    assert_eq!(found.flat_share, None);
}

#[data_test]
fn thin_walls_with_noise_of_a_spacing_are_not_made_worse() {
    let path = Path::new(adwave_test_data::folder!()).join("domains/points/PUNet/casting/clean_10000.xyz");
    let clean = read_path(&path, &ReadLimits::default()).unwrap().points().to_vec();
    let sum = clean.iter().fold([0.0; 3], |sum, p| [0, 1, 2].map(|k| sum[k] + p[k]));
    let center = sum.map(|c| c / clean.len() as f64);
    let radius = clean.iter().map(|p| square_distance(p, &center)).fold(0.0, f64::max).sqrt();
    let mut random = Deviates(5);
    let noisy: Vec<[f64; 3]> = clean.iter().map(|p| p.map(|c| c + 0.03 * radius * random.normal())).collect();
    let off = |points: &[[f64; 3]]| {
        let nearest = |p| clean.iter().map(|q| square_distance(p, q)).fold(f64::INFINITY, f64::min);
        points.iter().map(nearest).sum::<f64>()
    };
    let result = denoised(&cloud(noisy.clone()), &defaults());
    let [before, after] = [&noisy, &result.points].map(|points| off(points));
    println!("{before} before, {after} after, noise {} of {}", result.info.noise, 0.03 * radius);
    assert!(after < before, "{before} before, {after} after");
}

fn square_distance(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - q[k]).powi(2)).sum()
}
