//! Laws of signed saliency: bumps are above 0, dents below, and neither scale nor the way triangles run matters.

use adwave::bands::Schedule;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::saliency::{SaliencyParams, Sign, saliency, saliency_f32};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Polygons, Shape, triangulate};
use adwave::{Decomposer, Progress};

/// Sums of a few bands in another order.
const ROUNDING: f64 = 1e-9;
const N_LEVELS: usize = 8;

/// A sphere with a bump round the vertex 100 and a dent as deep round the vertex 1900.
fn bump_and_dent() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let Sample { mut points, faces } = Sample::from_name("sphere", Some(2000)).unwrap();
    let triangles = triangulate(&points, &faces);
    let (top, pit) = (points[100], points[1900]);
    let hill = |p: &[f64; 3], at: &[f64; 3]| {
        let square: f64 = (0..3).map(|c| (p[c] - at[c]).powi(2)).sum();
        0.15 * (-square / 0.04).exp()
    };
    for p in &mut points {
        let radius = 1.0 + hill(p, &top) - hill(p, &pit);
        *p = p.map(|c| c * radius);
    }
    (points, triangles)
}

/// The signed map of coordinates, in the order of the shape.
fn map(points: &[[f64; 3]], triangles: &[[u32; 3]], kind: OperatorKind) -> Vec<f64> {
    let mesh = Mesh::new(points.to_vec(), Polygons::from_triangles(triangles)).unwrap();
    let params = OperatorParams::default().with_kind(kind);
    let decomposer = Decomposer::with_params(&Shape::Mesh(mesh), &params, Progress::none()).unwrap();
    let outward = decomposer.outward_normals(None, Progress::none()).unwrap();
    assert!(outward.info.has_outside());
    let schedule = Schedule::dyadic(N_LEVELS).unwrap();
    let request = decomposer.request(points.as_flattened(), 3, &schedule);
    let along = request.normal_components(&outward.normals).unwrap();
    // By hand.
    let whole = request.wavelets().unwrap();
    for j in 1..=N_LEVELS {
        for (x, n) in outward.normals.iter().enumerate() {
            let w = &whole.wavelet(j)[3 * x..3 * x + 3];
            let expected: f64 = (0..3).map(|c| w[c] * n[c]).sum();
            assert!((along.wavelet(j)[x] - expected).abs() < ROUNDING);
        }
    }
    saliency(&decomposer, &along, &SaliencyParams::default(), Progress::none()).unwrap().map
}

#[test]
fn a_drawn_map_is_within_less_than_a_color_of_the_exact_one() {
    /// Request of the studio.
    const ACCURACY: f64 = 3e-3;
    const COLORS: f64 = 256.0;
    let Sample { points, faces } = Sample::from_name("creature", Some(20_000)).unwrap();
    let shape = Shape::Mesh(Mesh::new(points.clone(), faces).unwrap());
    for (kind, schedule) in [
        (OperatorKind::Walk, Schedule::dyadic(N_LEVELS).unwrap()),
        (OperatorKind::Walk, Schedule::voices(5, 2).unwrap()),
        (OperatorKind::Surface, Schedule::dyadic(N_LEVELS).unwrap()),
    ] {
        let params = OperatorParams::default().with_kind(kind);
        let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
        let outward = decomposer.outward_normals(None, Progress::none()).unwrap();
        // Rough, smooth, and equal levels.
        let mut x = 1_u32;
        let mut noise = || {
            x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(x) / f64::from(u32::MAX) - 0.5
        };
        for size in [0.0, 1e-3, 0.02] {
            let edited: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c + size * noise())).collect();
            let request = decomposer.request(edited.as_flattened(), 3, &schedule);
            let exact = request.normal_components(&outward.normals).unwrap();
            let exact =
                saliency(&decomposer, &exact, &SaliencyParams::default(), Progress::none()).unwrap().map;
            let drawn = request.accuracy(ACCURACY).normal_components_in_one_pass(&outward.normals).unwrap();
            let drawn = saliency_f32(&decomposer, &drawn, Progress::none()).unwrap();
            let mut sizes: Vec<f64> = exact.iter().map(|v| v.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            let step = 2.0 * sizes[sizes.len() * 24 / 25] / COLORS;
            let off = exact.iter().zip(&drawn).map(|(e, d)| (e - f64::from(*d)).abs()).fold(0.0, f64::max);
            assert!(off < step, "{kind:?}, {size}: {off:e}, a step is {step:e}");
        }
    }
}

#[test]
fn a_bump_is_above_0_and_a_dent_below_by_both_operators() {
    let (points, triangles) = bump_and_dent();
    for kind in [OperatorKind::Walk, OperatorKind::Surface] {
        let map = map(&points, &triangles, kind);
        let extreme =
            |sign: f64| (0..map.len()).max_by(|&a, &b| (sign * map[a]).total_cmp(&(sign * map[b]))).unwrap();
        assert!(map[100] > 0.0 && map[1900] < 0.0, "{kind:?}: {} {}", map[100], map[1900]);
        let near = |x: usize, y: usize| {
            (0..3).map(|c| (points[x][c] - points[y][c]).powi(2)).sum::<f64>().sqrt() < 0.1
        };
        assert!(
            near(extreme(1.0), 100) && near(extreme(-1.0), 1900),
            "{kind:?}: {} {}",
            extreme(1.0),
            extreme(-1.0)
        );
    }
}

#[test]
fn neither_scale_nor_the_way_triangles_run_matters() {
    let (points, triangles) = bump_and_dent();
    let expected = map(&points, &triangles, OperatorKind::Walk);
    let largest = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let turned: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [c, b, a]).collect();
    let large: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| 1024.0 * c)).collect();
    for (points, triangles) in [(&points, &turned), (&large, &triangles)] {
        let found = map(points, triangles, OperatorKind::Walk);
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() <= ROUNDING * largest, "{a} {b}");
        }
    }
}

#[test]
fn a_scalar_turned_over_turns_its_map_over_and_its_size_is_the_unsigned_one() {
    let (points, triangles) = bump_and_dent();
    let mesh = Mesh::new(points.clone(), Polygons::from_triangles(&triangles)).unwrap();
    let decomposer = Decomposer::new(&Shape::Mesh(mesh));
    let signal: Vec<f64> = points.iter().map(|p| (9.0 * p[0]).sin() * p[1]).collect();
    let turned: Vec<f64> = signal.iter().map(|f| -f).collect();
    let schedule = Schedule::dyadic(1).unwrap();
    let of = |signal: &[f64], sign: Sign| {
        let norms = decomposer.request(signal, 1, &schedule).norms().unwrap();
        saliency(&decomposer, &norms, &SaliencyParams::default().with_sign(sign), Progress::none())
            .unwrap()
            .map
    };
    let (map, other) = (of(&signal, Sign::Signed), of(&turned, Sign::Signed));
    assert!(map.iter().zip(&other).all(|(a, b)| *a == -b) && map.iter().any(|v| *v > 0.0));
    let unsigned = of(&signal, Sign::Unsigned);
    assert!(map.iter().zip(&unsigned).all(|(a, b)| a.abs() == *b));
}
