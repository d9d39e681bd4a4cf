//! Kinds of noise of meshes: impulses, noise in all directions, strong noise; each is recognized and treated.

use crate::denoise::{denoised, mean_angle, mesh};
use adwave::denoise::{DenoiseParams, Denoised, MeshDenoising, SharedNoise};
use adwave::sample::Sample;
use adwave::shape::{Polygons, Shape};

/// Uniform numbers in [0, 1) without pattern (splitmix64).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A sum of twelve uniform numbers: nearly normal.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A built-in shape, and the same with each vertex moved along its normal and along the axes, by lengths in mean edges.
fn pair(name: &str, mut displace: impl FnMut(&mut Random) -> (f64, [f64; 3])) -> (Shape, Shape) {
    let sample = Sample::from_name(name, Some(8000)).unwrap();
    let (edge, normals) = (sample.mean_edge_length(), sample.normals());
    let mut random = Random(7);
    let mut moved = |(p, n): (&[f64; 3], &[f64; 3])| -> [f64; 3] {
        let (along, free) = displace(&mut random);
        std::array::from_fn(|k| p[k] + edge * (along * n[k] + free[k]))
    };
    let noisy = sample.points.iter().zip(&normals).map(&mut moved).collect();
    (mesh(sample.points.clone(), &sample.faces), mesh(noisy, &sample.faces))
}

/// Mean angles before and after, with what was found.
fn angles(clean: &Shape, noisy: &Shape) -> (f64, f64, MeshDenoising) {
    let Denoised { points, info, .. } = denoised(noisy, &DenoiseParams::default());
    let (before, after) = (mean_angle(clean, noisy.points().unwrap()), mean_angle(clean, &points));
    println!("{before} → {after}, {info:?}");
    (before, after, info.mesh.unwrap())
}

#[test]
fn impulses_are_counted_and_taken_off() {
    for (name, most) in [("bracket", 0.25), ("sphere", 0.25), ("knot", 0.35)] {
        let (clean, noisy) =
            pair(name, |r| (if r.uniform() < 0.2 { 0.6 * r.normal() } else { 0.0 }, [0.0; 3]));
        let (before, after, found) = angles(&clean, &noisy);
        assert!((0.12..0.25).contains(&found.impulse_share), "{name}: {found:?}");
        assert!(after < most * before, "{name}: {before} → {after}");
    }
}

#[test]
fn other_noise_and_clean_shapes_have_no_impulses() {
    let pairs_of_noise = [[0.0, 0.3], [0.1, 0.7]];
    for (i, name) in ["bracket", "sphere", "knot", "creature", "plane"].into_iter().enumerate() {
        for noise in pairs_of_noise[i % 2] {
            let (clean, noisy) = pair(name, |r| (noise * r.normal(), [0.0; 3]));
            let (.., found) = angles(&clean, &noisy);
            assert_eq!(found.impulse_share, 0.0, "{name}, {noise}");
        }
    }
}

#[test]
fn noise_in_all_directions_turns_triangles_and_is_taken_off() {
    for (name, most) in [("bracket", 0.25), ("sphere", 0.15), ("knot", 0.25)] {
        let (clean, noisy) = pair(name, |r| (0.0, [(); 3].map(|()| 0.6 / 3.0_f64.sqrt() * r.normal())));
        let (before, after, found) = angles(&clean, &noisy);
        assert!(found.turned_share > 0.03 && found.linear_rounds > 1.5, "{name}: {found:?}");
        assert!(before > 35.0 && after < most * before, "{name}: {before} → {after}");
        let (.., along) = angles(&clean, &pair(name, |r| (0.35 * r.normal(), [0.0; 3])).1);
        assert!(along.turned_share < 0.3 * found.turned_share, "{name}: {along:?}");
    }
}

#[test]
fn strong_noise_leaves_creases() {
    let (clean, noisy) = pair("bracket", |r| (0.7 * r.normal(), [0.0; 3]));
    let (before, after, found) = angles(&clean, &noisy);
    assert_eq!(found.n_guides, 3);
    assert!(before > 40.0 && after < 0.2 * before, "{before} → {after}");
}

#[test]
fn noise_larger_than_the_shape_gives_finite_points() {
    let (_, noisy) = pair("sphere", |r| (0.0, [(); 3].map(|()| 100.0 * r.normal())));
    let result = denoised(&noisy, &DenoiseParams::default());
    assert!(result.points.iter().flatten().all(|c| c.is_finite()));
}

/// A built-in shape with noise along the normals that neighbors share, of standard deviation `noise` in mean edges.
fn pair_with_shared_noise(name: &str, noise: f64) -> (Shape, Shape) {
    let sample = Sample::from_name(name, Some(8000)).unwrap();
    let mut near = vec![Vec::new(); sample.points.len()];
    for face in sample.faces.iter() {
        for (k, &v) in face.iter().enumerate() {
            near[v as usize].push(face[(k + 1) % face.len()] as usize);
        }
    }
    let mut random = Random(7);
    let mut heights: Vec<f64> = sample.points.iter().map(|_| random.normal()).collect();
    for _ in 0..4 {
        let mean = |x: usize| {
            (heights[x] + near[x].iter().map(|&y| heights[y]).sum::<f64>()) / (near[x].len() + 1) as f64
        };
        heights = (0..heights.len()).map(mean).collect();
    }
    let square = heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64;
    let mut heights = heights.into_iter().map(|h| noise * h / square.sqrt());
    pair(name, |_| (heights.next().unwrap_or_default(), [0.0; 3]))
}

#[test]
fn shared_noise_is_bounded_and_removed_if_it_is_not_detail() {
    for (name, most) in [("sphere", 0.5), ("plane", 0.5), ("bracket", 0.75)] {
        let (clean, noisy) = pair_with_shared_noise(name, 0.2);
        let edge = Sample::from_name(name, Some(8000)).unwrap().mean_edge_length();
        let (.., without) = angles(&clean, &clean);
        assert!(without.shared_at_most < 0.02 * edge, "{name}: {without:?}");
        let (before, after, found) = angles(&clean, &noisy);
        assert!((0.15..0.25).contains(&(found.shared_at_most / edge)), "{name}: {found:?}");
        assert!(found.shared == 0.0 && after > 0.75 * before, "{name}: {before} → {after}");
        let params = DenoiseParams::default().with_shared(SharedNoise::Estimate);
        let removed = denoised(&noisy, &params);
        let after = mean_angle(&clean, &removed.points);
        println!("{name}: {after} with the estimate");
        assert!(after < most * before, "{name}: {before} → {after}");
        let given = SharedNoise::Deviation(found.shared_at_most);
        let given = denoised(&noisy, &DenoiseParams::default().with_shared(given));
        assert!(mean_angle(&clean, &given.points) < 1.01 * after, "{name}");
    }
}

#[test]
fn no_vertex_moves_farther_than_three_times_the_noise_there() {
    let (_, noisy) = pair("plane", |r| (0.1 * r.normal(), [0.0; 3]));
    let mut points = noisy.points().unwrap().to_vec();
    let far = points.len() / 2 + 40;
    let edge = Sample::from_name("plane", Some(8000)).unwrap().mean_edge_length();
    points[far][2] += 4.0 * edge;
    let Shape::Mesh(of) = &noisy else { panic!("a mesh") };
    let noisy = mesh(points.clone(), of.faces());
    let Denoised { points: after, info, .. } = denoised(&noisy, &DenoiseParams::default());
    let moved = |x: usize| (0..3).map(|k| (after[x][k] - points[x][k]).powi(2)).sum::<f64>().sqrt();
    let noise = info.noise;
    assert!((0.08 * edge..0.13 * edge).contains(&noise), "{}", noise / edge);
    // The noise at a place counts up to three times the typical one.
    assert!((2.9 * noise..9.001 * noise).contains(&moved(far)), "{}", moved(far) / noise);
    let n_farther = (0..points.len()).filter(|&x| moved(x) > 4.5 * noise).count();
    assert!(n_farther < 40, "{n_farther}");
    assert!((1..40).contains(&info.n_far), "{}", info.n_far);
    let furthest = (0..points.len()).map(moved).fold(0.0, f64::max);
    assert!((furthest - info.furthest).abs() < 1e-12 * furthest);
}

#[test]
fn noise_that_grows_along_a_shape_is_found_and_taken_off_by_place() {
    let sample = Sample::from_name("plane", Some(8000)).unwrap();
    let edge = sample.mean_edge_length();
    let [low, high] = [f64::min, f64::max]
        .map(|least: fn(f64, f64) -> f64| sample.points.iter().map(|p| p[0]).reduce(least).unwrap());
    let mut random = Random(11);
    let mut moved = |p: &[f64; 3], deviation: f64| [p[0], p[1] + deviation * edge * random.normal(), p[2]];
    let growing = |p: &[f64; 3]| 0.05 + 0.45 * (p[0] - low) / (high - low);
    let clean = mesh(sample.points.clone(), &sample.faces);
    let noisy = sample.points.iter().map(|p| moved(p, growing(p))).collect();
    let (before, after, found) = angles(&clean, &mesh(noisy, &sample.faces));
    let [least, most] = found.noise_range.map(|level| level / edge);
    assert!((0.05..0.13).contains(&least) && (0.36..0.55).contains(&most), "{least} to {most}");
    assert!(before > 20.0 && after < 0.3 * before, "{before} → {after}");

    let noisy = sample.points.iter().map(|p| moved(p, 0.2)).collect();
    let (_, _, found) = angles(&clean, &mesh(noisy, &sample.faces));
    assert!(found.noise_range[0] == found.noise_range[1], "{found:?}");
}

#[test]
fn flat_places_are_smoothed_more_than_those_with_detail() {
    // Waves of eight edges on one half of a sheet, the other half flat, with noise.
    let n = 90_usize;
    let wave = |x: usize, y: usize| {
        if x < n / 2 { 0.0 } else { 0.5 * (0.8 * x as f64).sin() * (0.8 * y as f64).cos() }
    };
    let at = |i: usize| [(i % n) as f64, (i / n) as f64, wave(i % n, i / n)];
    let clean: Vec<[f64; 3]> = (0..n * n).map(at).collect();
    let m = n as u32;
    let corners = (0..m * (m - 1)).filter(|i| i % m < m - 1);
    let faces: Vec<[u32; 3]> = corners.flat_map(|i| [[i, i + 1, i + m], [i + 1, i + m + 1, i + m]]).collect();
    let faces = Polygons::from_triangles(&faces);
    let mut random = Random(5);
    let noisy: Vec<[f64; 3]> = clean.iter().map(|p| [p[0], p[1], p[2] + 0.15 * random.normal()]).collect();
    let noisy = mesh(noisy, &faces);
    let Denoised { points, info, .. } = denoised(&noisy, &DenoiseParams::default());
    let kept = info.mesh.unwrap().kept_by_place;
    assert!(kept.len() == 3 && kept[0] < 0.05 && kept[2] > 2.0 * kept[0] + 0.1, "{kept:?}");
    let rms = |half: usize, points: &[[f64; 3]]| {
        let squares =
            (0..n * n).filter(|i| (i % n) / (n / 2) == half).map(|i| (points[i][2] - clean[i][2]).powi(2));
        (squares.sum::<f64>() / (n * n / 2) as f64).sqrt()
    };
    let noisy = noisy.points().unwrap();
    println!("{} → {}, {} → {}", rms(0, noisy), rms(0, &points), rms(1, noisy), rms(1, &points));
    assert!(rms(0, &points) < 0.3 * rms(0, noisy) && rms(1, &points) < 0.8 * rms(1, noisy));
}
