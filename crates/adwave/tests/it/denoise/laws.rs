//! Laws on shapes whose truth is known, and on degenerate shapes.

use crate::denoise::{denoised, mean_angle, mesh, pair, rms, triangles};
use adwave::denoise::{Creases, DenoiseError, DenoiseParams, denoise};
use adwave::shape::{Graph, PointCloud, Polygons, PreparedGeometry, Shape, WeldMode};
use adwave::{Cancelled, ClassifiedError, ErrorKind, Progress};
use std::sync::atomic::AtomicBool;

fn defaults() -> DenoiseParams {
    DenoiseParams::default()
}

#[test]
fn noise_is_estimated_and_taken_off_at_every_level_of_it() {
    for (name, most) in [("knot", 0.35_f64), ("creature", 0.75), ("sphere", 0.3)] {
        for noise in [0.05, 0.1, 0.2, 0.4] {
            if name == "creature" && noise < 0.2 {
                continue; // its texture is as large, and as fine as its triangles
            }
            let (clean, noisy) = pair(name, 8000, noise);
            let result = denoised(&noisy, &defaults());
            let found = result.info.noise_in_edges;
            // Strong noise makes edges longer, so that there are fewer of them to it.
            assert!((0.7 * noise..1.2 * noise + 0.06).contains(&found), "{name}, {noise}: {found}");
            println!("{name}, {noise}: {found}");
            let (before, after) =
                (mean_angle(&clean, noisy.points().unwrap()), mean_angle(&clean, &result.points));
            assert!(
                after < most.max(0.6 * f64::from(noise < 0.1)) * before,
                "{name}, {noise}: {before} → {after}"
            );
            let distances =
                [noisy.points().unwrap(), &result.points].map(|p| rms(p, clean.points().unwrap()));
            assert!(distances[1] < 0.8 * distances[0], "{name}, {noise}: {distances:?}");
        }
    }
}

#[test]
fn clean_shapes_hardly_move() {
    for name in ["sphere", "torus", "knot", "creature", "plane", "bracket"] {
        let (clean, _) = pair(name, 20_000, 0.0);
        let result = denoised(&clean, &defaults());
        let edge = result.info.noise / result.info.noise_in_edges.max(f64::MIN_POSITIVE);
        let moved = rms(&result.points, clean.points().unwrap());
        println!("{name}: {}", moved / edge);
        assert!(moved <= 0.1 * edge || moved == 0.0, "{name}: {moved} of an edge of {edge}");
    }
}

/// A cube of n × n squares a side, and the distance of a point from its surface.
fn cube(n: u32) -> (Vec<[f64; 3]>, Polygons) {
    let (mut points, mut faces) = (Vec::new(), Polygons::new());
    for side in 0..6 {
        let first = points.len() as u32;
        for i in 0..=n {
            for j in 0..=n {
                let [u, v] = [i, j].map(|k| 2.0 * f64::from(k) / f64::from(n) - 1.0);
                points.push(match side {
                    0 => [u, v, 1.0],
                    1 => [v, u, -1.0],
                    2 => [1.0, u, v],
                    3 => [-1.0, v, u],
                    4 => [v, 1.0, u],
                    _ => [u, -1.0, v],
                });
            }
        }
        for i in 0..n {
            for j in 0..n {
                let [a, b, c, d] =
                    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| first + i * (n + 1) + j);
                for half in [[a, b, c], [a, c, d]] {
                    faces.push(&half);
                }
            }
        }
    }
    (points, faces)
}

/// A number in [−1, 1) without pattern (splitmix64).
fn signed(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn from_cube(p: &[f64; 3]) -> f64 {
    (p.iter().map(|c| c.abs()).fold(0.0, f64::max) - 1.0).abs()
}

#[test]
fn the_edges_of_a_cube_stay_sharp_unless_they_are_not_wanted() {
    let (points, faces) = cube(30);
    let clean = mesh(points.clone(), &faces);
    // Noise is put on by position, so that what is welded stays so.
    let mut noisy = points.clone();
    for p in &mut noisy {
        let mut state = p
            .iter()
            .fold(7_u64, |h, c| h.wrapping_mul(0x9e37_79b9).wrapping_add((c * 1e6).round() as i64 as u64));
        *p = p.map(|c| c + 0.02 * signed(&mut state));
    }
    let noisy = mesh(noisy, &faces);
    let before = mean_angle(&clean, noisy.points().unwrap());
    let angle = |creases| mean_angle(&clean, &denoised(&noisy, &defaults().with_creases(creases)).points);
    let (auto, keep, none) = (angle(Creases::Auto), angle(Creases::Keep), angle(Creases::None));
    println!("{before} → {auto} {keep} {none}");
    assert!(before > 10.0 && auto < 0.15 * before, "{before} → {auto}");
    assert!(keep < 0.15 * before && none > 2.0 * keep, "kept {keep}, smoothed {none}");
    let result = denoised(&noisy, &defaults());
    let worst = result.points.iter().map(from_cube).fold(0.0, f64::max);
    assert!(worst < 0.03, "a point is {worst} from the cube");
}

#[test]
fn clouds_move_along_their_normals_toward_the_surface() {
    let (clean, noisy) = pair("sphere", 6000, 0.3);
    let cloud = Shape::Cloud(PointCloud::new(noisy.points().unwrap().to_vec()).unwrap());
    let result = denoised(&cloud, &defaults());
    let off = |points: &[[f64; 3]]| {
        let squares: f64 =
            points.iter().map(|p| (p.iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).powi(2)).sum();
        (squares / points.len() as f64).sqrt()
    };
    let (before, after) = (off(cloud.points().unwrap()), off(&result.points));
    assert!(after < 0.5 * before, "{before} → {after}");
    assert_eq!(result.points.len(), clean.n_vertices());
}

#[test]
fn no_vertex_moves_farther_than_three_times_its_noise() {
    let (_, noisy) = pair("knot", 4000, 0.3);
    let points = noisy.points().unwrap().to_vec();
    let mut state = 5;
    let mut wave = |i: u32| [0.1 * f64::from(i), (0.05 * f64::from(i)).sin(), 0.03 * signed(&mut state)];
    let curve: Vec<[f64; 3]> = (0..400).map(&mut wave).collect();
    let steps: Vec<[u32; 2]> = (0..399).map(|i| [i, i + 1]).collect();
    let shapes = [
        noisy,
        Shape::Cloud(PointCloud::new(points).unwrap()),
        Shape::Graph(Graph::curve(curve, &steps).unwrap()),
    ];
    for (kind, shape) in ["mesh", "cloud", "curve"].into_iter().zip(&shapes) {
        for strength in [0.5, 1.0, 3.0] {
            let result = denoised(shape, &defaults().with_strength(strength));
            let moves = shape.points().unwrap().iter().zip(&result.points);
            let shares: Vec<f64> = moves
                .zip(&result.noise)
                .map(|((p, q), noise)| rms(&[*p], &[*q]) / (noise * strength.max(1.0)))
                .collect();
            let most = shares.iter().copied().fold(0.0, f64::max);
            println!("{kind}, strength {strength}: {most}");
            assert!(most > 0.5 && most <= 3.0 + 1e-9, "{kind}, strength {strength}: {most}");
        }
    }
}

#[test]
fn the_noise_at_each_point_follows_noise_that_grows() {
    let mut state = 3;
    let n = 90;
    let true_noise = |x: f64| 0.1 + 0.4 * x / f64::from(n);
    // The sum of twelve uniform numbers is nearly normal.
    let mut point = |i: u32| {
        let [x, y] = [i % n, i / n].map(|k| f64::from(k) + 0.4 * signed(&mut state));
        let normal = 0.5 * (0..12).map(|_| signed(&mut state)).sum::<f64>();
        [x, y, true_noise(x) * normal]
    };
    let points: Vec<[f64; 3]> = (0..n * n).map(&mut point).collect();
    let result = denoised(&Shape::Cloud(PointCloud::new(points.clone()).unwrap()), &defaults());
    for part in 0..4 {
        let range = 0.25 * f64::from(n * part)..0.25 * f64::from(n * (part + 1));
        let own = points.iter().zip(&result.noise).filter(|(p, _)| range.contains(&p[0]));
        let mut ratios: Vec<f64> = own.map(|(p, noise)| noise / true_noise(p[0])).collect();
        ratios.sort_by(f64::total_cmp);
        let quantiles = [0.1, 0.5, 0.9].map(|share| ratios[(share * ratios.len() as f64) as usize]);
        println!("{range:?}: {quantiles:?}");
        assert!(quantiles[0] > 0.7 && quantiles[2] < 1.4, "{range:?}: {quantiles:?}");
    }
}

#[test]
fn strength_nought_changes_nothing_and_more_of_it_smooths_more() {
    let (_, noisy) = pair("knot", 4000, 0.2);
    let points = noisy.points().unwrap();
    let moved = |strength| rms(&denoised(&noisy, &defaults().with_strength(strength)).points, points);
    assert_eq!(moved(0.0), 0.0);
    let (half, one, two) = (moved(0.5), moved(1.0), moved(2.0));
    assert!(half < one && one < two, "{half} {one} {two}");
}

#[test]
fn units_the_order_of_vertices_and_the_number_of_threads_do_not_matter() {
    let (_, noisy) = pair("creature", 5000, 0.2);
    let (points, result) = (noisy.points().unwrap(), denoised(&noisy, &defaults()));
    let Shape::Mesh(as_mesh) = &noisy else { panic!("a mesh") };
    for factor in [2.0_f64.powi(40), 2.0_f64.powi(-300)] {
        let scaled = points.iter().map(|p| p.map(|c| factor * c)).collect();
        let scaled = denoised(&mesh(scaled, as_mesh.faces()), &defaults());
        let back: Vec<[f64; 3]> = scaled.points.iter().map(|p| p.map(|c| c / factor)).collect();
        assert_eq!(back, result.points, "times {factor}");
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| denoised(&noisy, &defaults())), result);
}

#[test]
fn shapes_that_are_hardly_any_stay_finite() {
    let triangle = |faces: &[[u32; 3]]| Polygons::from_triangles(faces);
    let flat: Vec<[f64; 3]> = (0..9).map(|i| [f64::from(i % 3), f64::from(i / 3), 0.0]).collect();
    let spot = vec![[1.0, 2.0, 3.0]; 5];
    let line: Vec<[f64; 3]> = (0..40).map(|i| [f64::from(i).sqrt(), 0.0, 0.0]).collect();
    let mut fan: Vec<[f64; 3]> =
        (0..500).map(|i| [f64::from(i).cos(), f64::from(i).sin(), 0.1 * f64::from(i % 7)]).collect();
    fan.push([0.0; 3]);
    let fan_faces: Vec<[u32; 3]> = (0..499).map(|i| [i, i + 1, 500]).collect();
    let shapes = [
        ("one triangle", mesh(flat[..3].to_vec(), &triangle(&[[0, 1, 2]]))),
        ("no faces", mesh(flat.clone(), &triangle(&[]))),
        ("a face without area", mesh(flat.clone(), &triangle(&[[0, 1, 2], [0, 3, 6]]))),
        ("three faces at an edge", mesh(flat.clone(), &triangle(&[[0, 1, 3], [0, 1, 4], [1, 0, 5]]))),
        ("a fan of 499 triangles", mesh(fan, &triangle(&fan_faces))),
        ("a cloud in one spot", Shape::Cloud(PointCloud::new(spot).unwrap())),
        ("a cloud on a line", Shape::Cloud(PointCloud::new(line).unwrap())),
        ("one point", Shape::Cloud(PointCloud::new(vec![[0.0; 3]]).unwrap())),
    ];
    for (name, shape) in &shapes {
        for params in [defaults(), defaults().with_noise(100.0), defaults().with_strength(1e6)] {
            let result = denoised(shape, &params);
            assert_eq!(result.points.len(), shape.n_vertices(), "{name}");
            assert!(
                result.points.as_flattened().iter().all(|c| c.is_finite()),
                "{name}: {:?}",
                result.points
            );
            assert!(result.info.noise.is_finite() && result.info.furthest.is_finite(), "{name}");
        }
    }
}

#[test]
fn graphs_and_numbers_without_meaning_are_refused_and_a_call_stops() {
    let prepared =
        |shape: &Shape| PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    let graph = prepared(&Shape::Graph(Graph::new(2, &[(0, 1, 1.0)]).unwrap()));
    assert_eq!(denoise(&graph, &defaults(), Progress::none()), Err(DenoiseError::NoPositions));
    let noisy = prepared(&pair("knot", 2000, 0.2).1);
    for params in [defaults().with_strength(-1.0), defaults().with_noise(f64::NAN)] {
        let error = denoise(&noisy, &params, Progress::none()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Input, "{error}");
    }
    let stop = AtomicBool::new(true);
    let stopped = denoise(&noisy, &defaults(), Progress::none().with_cancel(&stop));
    assert_eq!(stopped, Err(DenoiseError::Cancelled(Cancelled)));
}

#[test]
fn both_sides_of_a_surface_are_denoised_like_one() {
    for (name, n) in [("sphere", 2500), ("creature", 3000)] {
        let (clean, noisy) = pair(name, n, 0.2);
        let single = triangles(&noisy);
        let points = noisy.points().unwrap();
        let one = denoised(&noisy, &defaults());
        let reversed: Vec<[u32; 3]> = single.iter().map(|[a, b, c]| [*b, *a, *c]).collect();
        let mixed: Vec<[u32; 3]> = single.iter().zip(&reversed).flat_map(|(a, b)| [*b, *a]).collect();
        // The other side with corners of its own, as exporters write it.
        let second: Vec<[u32; 3]> = reversed.iter().map(|t| t.map(|x| x + points.len() as u32)).collect();
        let doubled = [points, points].concat();
        for (points, faces) in [
            (points.to_vec(), [&single[..], &reversed[..]].concat()),
            (points.to_vec(), mixed),
            (doubled, [single.clone(), second].concat()),
        ] {
            let two = denoised(&mesh(points, &Polygons::from_triangles(&faces)), &defaults());
            assert!((two.info.noise / one.info.noise - 1.0).abs() < 0.02, "{name}: {:?}", two.info.noise);
            let clean = clean.points().unwrap();
            let [left, expected] = [&two.points[..clean.len()], &one.points].map(|points| rms(points, clean));
            assert!(left < 1.05 * expected, "{name}: {left}, {expected}");
        }
    }
}
