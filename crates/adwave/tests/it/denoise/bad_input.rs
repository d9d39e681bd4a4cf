//! Shapes and clouds that are not what a denoiser hopes for: results are finite, and never worse than the input.

use crate::denoise::{denoised, mesh, pair, rms};
use adwave::denoise::{DenoiseParams, Outliers};
use adwave::shape::{Mesh, PointCloud, Polygons, Shape};

fn defaults() -> DenoiseParams {
    DenoiseParams::default()
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

    fn normals(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.normal())
    }
}

fn faces_of(shape: &Shape) -> Vec<[u32; 3]> {
    let Shape::Mesh(mesh) = shape else { panic!("a mesh") };
    mesh.faces().iter().map(|f| [f[0], f[1], f[2]]).collect()
}

/// A band of `n` × 12 vertices with `half_turns`, and its triangles.
fn band(n: u32, half_turns: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    const ACROSS: u32 = 12;
    let place = |i: u32, j: u32| {
        let phi = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        let width = 0.4 * (f64::from(j) / f64::from(ACROSS - 1) - 0.5);
        let turn = 0.5 * f64::from(half_turns) * phi;
        let radius = 1.0 + width * turn.cos();
        [radius * phi.cos(), radius * phi.sin(), width * turn.sin()]
    };
    let points = (0..n * ACROSS).map(|x| place(x / ACROSS, x % ACROSS)).collect();
    // Where the band closes after an odd number of half turns, its sides are exchanged.
    let at = |i: u32, j: u32| match i {
        i if i < n => i * ACROSS + j,
        _ if half_turns % 2 == 1 => ACROSS - 1 - j,
        _ => j,
    };
    let cells = (0..n).flat_map(|i| (0..ACROSS - 1).map(move |j| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    (points, faces.collect())
}

/// Points with noise in all directions.
fn noisy(points: &[[f64; 3]], deviation: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Deviates(seed);
    points
        .iter()
        .map(|p| {
            let d = random.normals();
            std::array::from_fn(|k| p[k] + deviation * d[k])
        })
        .collect()
}

#[test]
fn bands_with_one_side_or_two_and_surfaces_through_themselves_lose_noise() {
    let (mobius, mobius_faces) = band(160, 1);
    let (ring, ring_faces) = band(160, 0);
    // Two rings through each other, at a right angle.
    let n = ring.len() as u32;
    let other = ring.iter().map(|[x, y, z]| [x + 1.0, *z, *y]);
    let crossing: Vec<[f64; 3]> = ring.iter().copied().chain(other).collect();
    let crossing_faces: Vec<[u32; 3]> =
        ring_faces.iter().copied().chain(ring_faces.iter().map(|f| f.map(|v| v + n))).collect();
    for (name, points, faces) in [
        ("one side", mobius, mobius_faces),
        ("two sides", ring, ring_faces),
        ("crossing", crossing, crossing_faces),
    ] {
        let before = noisy(&points, 0.006, 5);
        let shape = mesh(before.clone(), &Polygons::from_triangles(&faces));
        let result = denoised(&shape, &defaults());
        let (off, left) = (rms(&before, &points), rms(&result.points, &points));
        println!("{name}: {off} → {left}");
        assert!(left < 0.85 * off, "{name}: {off} → {left}");
    }
}

#[test]
fn shapes_turned_inside_out_are_denoised_alike() {
    let (_, noisy) = pair("torus", 4000, 0.3);
    let points = noisy.points().unwrap().to_vec();
    let inside_out: Vec<[u32; 3]> = faces_of(&noisy).into_iter().map(|[a, b, c]| [a, c, b]).collect();
    let [one, other] = [noisy, mesh(points, &Polygons::from_triangles(&inside_out))]
        .map(|shape| denoised(&shape, &defaults()));
    assert!(rms(&one.points, &other.points) < 0.02 * one.info.noise);
}

#[test]
fn faces_without_area_and_doubled_points_change_nothing_around_them() {
    let (clean, noisy) = pair("bracket", 6000, 0.3);
    let points = noisy.points().unwrap().to_vec();
    let mut faces = faces_of(&noisy);
    faces.extend((0..40).map(|i| [i * 50, i * 50, i * 50 + 1]));
    let shape = Shape::Mesh(Mesh::new(points.clone(), Polygons::from_triangles(&faces)).unwrap());
    let result = denoised(&shape, &defaults());
    let truth = clean.points().unwrap();
    assert!(rms(&result.points, truth) < 0.5 * rms(&points, truth));
    // A cloud with every point twice: both copies move alike.
    let doubled = [points.clone(), points.clone()].concat();
    let result = denoised(&Shape::Cloud(PointCloud::new(doubled).unwrap()), &defaults());
    let (first, second) = result.points.split_at(points.len());
    assert_eq!(first, second);
    assert!(rms(first, truth) < rms(&points, truth));
}

#[test]
fn two_scans_of_one_wall_stay_two() {
    let mut random = Deviates(7);
    let mut scan = |z: f64| -> Vec<[f64; 3]> {
        let mut place = |c: u32| f64::from(c) + 0.8 * (random.uniform() - 0.5);
        let places: Vec<[f64; 2]> = (0..2500).map(|i| [place(i / 50), place(i % 50)]).collect();
        places.into_iter().map(|[x, y]| [x, y, z + 0.05 * random.normal()]).collect()
    };
    let (near, far) = (scan(0.0), scan(0.6));
    let n = near.len();
    let points = [near, far].concat();
    let result = denoised(&Shape::Cloud(PointCloud::new(points).unwrap()), &defaults());
    let mean = |points: &[[f64; 3]]| points.iter().map(|p| p[2]).sum::<f64>() / points.len() as f64;
    let gap = mean(&result.points[n..]) - mean(&result.points[..n]);
    println!("two scans 0.6 apart: {gap}");
    assert!(gap > 0.5, "{gap}");
}

#[test]
fn many_outliers_and_normals_of_either_sign_do_no_harm() {
    let (clean, noisy) = pair("sphere", 6000, 0.2);
    let truth = clean.points().unwrap();
    let points = noisy.points().unwrap().to_vec();
    let size = points.iter().flatten().fold(0.0, |most: f64, c| most.max(c.abs()));
    let mut random = Deviates(13);
    let n_outliers = points.len() * 2 / 3;
    let stray = (0..n_outliers).map(|_| [(); 3].map(|()| 6.0 * size * (random.uniform() - 0.5)));
    let all: Vec<[f64; 3]> = points.iter().copied().chain(stray).collect();
    let drop = defaults().with_outliers(Outliers::Drop);
    let result = denoised(&Shape::Cloud(PointCloud::new(all.clone()).unwrap()), &drop);
    let n = points.len();
    let off = (rms(&points, truth), rms(&result.points[..n], truth));
    // Strays everywhere form a volume, which is no surface to be moved to.
    let still = (n..all.len()).filter(|&x| result.points[x] == all[x]).count();
    let lost = result.outliers.iter().filter(|x| (**x as usize) < n).count();
    println!("40 % outliers: {off:?}, {still} of {n_outliers} stay, {lost} of the surface are lost");
    assert!(off.1 < 0.7 * off.0, "{off:?}");
    assert!(still > n_outliers * 4 / 5 && lost < n / 100, "{still}, {lost}");

    let normals = truth.iter().map(|p| {
        let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        p.map(|c| sign * c / length)
    });
    let normals: Vec<[f64; 3]> = normals.collect();
    let signed = PointCloud::new(points.clone()).unwrap().with_normals(normals);
    let result = denoised(&Shape::Cloud(signed), &defaults());
    let left = rms(&result.points, truth);
    println!("normals of either sign: {} → {left}", off.0);
    assert!(left < off.0, "{left} of {}", off.0);
}
