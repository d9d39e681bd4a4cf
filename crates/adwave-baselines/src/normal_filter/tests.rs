use super::*;
use adwave::Progress;
use adwave::sample::Sample;
use adwave::shape::{Mesh, Polygons, Shape, WeldMode, enclosed_volume, face_normals};
use adwave::vector::{Vector, dot};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

fn geometry(points: Vec<[f64; 3]>, triangles: &[[u32; 3]]) -> PreparedGeometry {
    let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(triangles)).unwrap());
    PreparedGeometry::new(&shape, WeldMode::default(), Progress::none()).unwrap()
}

fn bilateral(geometry: &PreparedGeometry, params: &BilateralParams) -> Vec<[f64; 3]> {
    bilateral_normals(geometry, params, Progress::none()).unwrap()
}

fn guided(geometry: &PreparedGeometry) -> Vec<[f64; 3]> {
    guided_normals(geometry, &GuidedParams::default(), Progress::none()).unwrap()
}

/// Grid of `n` × `n` cells of side 1 in the plane z = 0, cut so that two triangles meet in each corner of the grid.
fn grid(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let points = (0..=n).flat_map(|j| (0..=n).map(move |i| [f64::from(i), f64::from(j), 0.0])).collect();
    let cut = |(i, j): (u32, u32)| {
        let a = j * (n + 1) + i;
        let [b, c, d] = [a + 1, a + n + 2, a + n + 1];
        if (2 * i < n) == (2 * j < n) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    let triangles = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).flat_map(cut).collect();
    (points, triangles)
}

/// Surface of a cube of side `n`, made of six grids whose rims are at equal positions.
fn cube(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (flat, triangles) = grid(n);
    let side = f64::from(n);
    let mut points = Vec::new();
    let mut all = Vec::new();
    for k in 0..3 {
        for (height, turn) in [(0.0, true), (side, false)] {
            let first = points.len() as u32;
            points.extend(flat.iter().map(|p| {
                let mut q = [0.0; 3];
                (q[k], q[(k + 1) % 3], q[(k + 2) % 3]) = (height, p[0], p[1]);
                q
            }));
            let turned = |&[a, b, c]: &[u32; 3]| if turn { [a, c, b] } else { [a, b, c] };
            all.extend(triangles.iter().map(|t| turned(t).map(|v| v + first)));
        }
    }
    (points, all)
}

/// Adds normally distributed noise to every position; equal positions get equal noise.
fn noisy(points: &[[f64; 3]], sigma: f64, only_z: bool) -> Vec<[f64; 3]> {
    let mut order: Vec<[f64; 3]> = points.to_vec();
    order.sort_by(|a, b| a.partial_cmp(b).unwrap());
    order.dedup();
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    let shifts: Vec<[f64; 3]> = order.iter().map(|_| [draw(), draw(), draw()].map(|d| sigma * d)).collect();
    let moved = |p: &[f64; 3]| {
        let at = order.binary_search_by(|q| q.partial_cmp(p).unwrap()).unwrap();
        std::array::from_fn(|k| p[k] + if only_z && k < 2 { 0.0 } else { shifts[at][k] })
    };
    points.iter().map(moved).collect()
}

/// Mean angle between the normals of two meshes with equal triangles, in degrees.
fn mean_angle(a: &[[f64; 3]], b: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let (a, b) = (face_normals(a, triangles), face_normals(b, triangles));
    let angle = |(a, b): (&Vector, &Vector)| dot(a, b).clamp(-1.0, 1.0).acos().to_degrees();
    a.iter().zip(&b).map(angle).sum::<f64>() / triangles.len() as f64
}

#[test]
fn a_flat_and_a_sharp_shape_stay_where_they_are() {
    // Rounding of some hundred sums in units of the diagonal.
    const ROUNDING: f64 = 1e-12;
    for (points, triangles) in [grid(8), cube(6)] {
        let prepared = geometry(points.clone(), &triangles);
        let local = BilateralParams::default();
        let global = local.with_scheme(NormalScheme::Global { smoothness: 0.01 });
        // The weight across a right angle is e^(−(√2/0.35)²/2) = 3e-4, which the local scheme applies repeatedly;
        // here the width is narrow.
        let narrow = local.with_sigma_s(0.1);
        let tight = GuidedParams::default().with_sigma_r(0.1);
        for moved in [
            bilateral(&prepared, &narrow),
            bilateral(&prepared, &global.with_sigma_s(0.1)),
            guided_normals(&prepared, &tight, Progress::none()).unwrap(),
        ] {
            for (p, q) in points.iter().zip(&moved) {
                assert!((0..3).all(|k| (p[k] - q[k]).abs() < ROUNDING), "{p:?} {q:?}");
            }
        }
    }
}

#[test]
fn noise_goes_from_a_plane_and_the_border_stays_or_follows() {
    let (clean, triangles) = grid(24);
    let rough = noisy(&clean, 0.2, true);
    let before = mean_angle(&clean, &rough, &triangles);
    let prepared = geometry(rough.clone(), &triangles);
    let params = BilateralParams::default();
    let fixed = bilateral(&prepared, &params);
    let free = bilateral(&prepared, &BilateralParams { border: Border::Free, ..params });
    let global = bilateral(&prepared, &params.with_scheme(NormalScheme::Global { smoothness: 0.01 }));
    let by_guidance = guided(&prepared);
    for (name, points, part) in [
        ("fixed", &fixed, 0.7),
        ("free", &free, 0.4),
        ("global", &global, 0.7),
        ("guided", &by_guidance, 0.3),
    ] {
        let after = mean_angle(&clean, points, &triangles);
        assert!(after < part * before, "{name}: {before} to {after}");
    }
    let at_border = |p: &[f64; 3]| p[0] == 0.0 || p[0] == 24.0 || p[1] == 0.0 || p[1] == 24.0;
    for ((p, q), r) in clean.iter().zip(&rough).zip(&fixed) {
        assert!(!at_border(p) || q == r, "a vertex of the border moved");
    }
}

#[test]
fn a_noisy_cube_keeps_its_edges_and_its_seams() {
    let (clean, triangles) = cube(16);
    let rough = noisy(&clean, 0.12, false);
    let before = mean_angle(&clean, &rough, &triangles);
    let prepared = geometry(rough.clone(), &triangles);
    let volume = |points: &[[f64; 3]]| enclosed_volume(points, &triangles);
    for (name, points, most) in [
        ("bilateral", bilateral(&prepared, &BilateralParams::default()), 0.35),
        ("guided", guided(&prepared), 0.3),
    ] {
        let after = mean_angle(&clean, &points, &triangles);
        assert!(after < most * before, "{name}: {before} to {after}");
        assert!((volume(&points) / volume(&clean) - 1.0).abs() < 0.01, "{name}");
        // The sides are separate meshes in the file; their rims still coincide to the last bit.
        for (x, p) in rough.iter().enumerate() {
            let y = rough.iter().position(|q| q == p).unwrap();
            assert_eq!(points[x], points[y], "{name}: vertices {x} and {y}");
        }
        // Corners keep their distance from the center.
        let corner = points.iter().map(|p| p.iter().sum::<f64>()).fold(0.0, f64::max);
        assert!((corner - 48.0).abs() < 1.5, "{name}: {corner}");
    }
}

#[test]
fn rotation_scale_and_the_order_of_faces_change_nothing_but_rounding() {
    let sample = Sample::from_name("knot", Some(1500)).unwrap();
    let triangles = sample.faces.triangles().unwrap().to_vec();
    let rough = noisy(&sample.points, 0.01, false);
    let turn = |p: &[f64; 3]| [-1e30 * p[1], 1e30 * p[0], 1e30 * p[2]];
    let turned: Vec<[f64; 3]> = rough.iter().map(turn).collect();
    let mut reversed = triangles.clone();
    reversed.reverse();
    let (a, b) = (geometry(rough, &triangles), geometry(turned, &reversed));
    for (here, there) in [
        (bilateral(&a, &BilateralParams::default()), bilateral(&b, &BilateralParams::default())),
        (guided(&a), guided(&b)),
    ] {
        for (p, q) in here.iter().zip(&there) {
            assert!((0..3).all(|k| (turn(p)[k] - q[k]).abs() < 1e-9 * 1e30), "{p:?} {q:?}");
        }
    }
}

#[test]
fn same_bits_on_any_number_of_threads() {
    let sample = Sample::from_name("bracket", Some(3000)).unwrap();
    let triangles = sample.faces.triangles().unwrap().to_vec();
    let prepared = geometry(noisy(&sample.points, 0.01, false), &triangles);
    let on = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let global = BilateralParams::default().with_scheme(NormalScheme::Global { smoothness: 0.01 });
        pool.install(|| {
            (
                bilateral(&prepared, &BilateralParams::default()),
                bilateral(&prepared, &global),
                guided(&prepared),
            )
        })
    };
    let one = on(1);
    assert!(one == on(2) && one == on(3));
}

/// Name, points and triangles of a mesh.
type Case<'a> = (&'a str, Vec<[f64; 3]>, Vec<[u32; 3]>);

#[test]
fn broken_meshes_give_finite_positions() {
    let p = |x: f64, y: f64, z: f64| [x, y, z];
    let cases: Vec<Case<'_>> = vec![
        (
            "three faces at an edge",
            vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., -1., 0.), p(0., 0., 1.)],
            vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        ),
        (
            "zero area",
            vec![p(0., 0., 0.), p(1., 0., 0.), p(2., 0., 0.), p(0., 1., 0.)],
            vec![[0, 1, 2], [0, 1, 3], [0, 0, 1]],
        ),
        ("all points equal", vec![p(3., 3., 3.); 3], vec![[0, 1, 2]]),
        (
            "a face alone and a vertex alone",
            vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(5., 5., 5.)],
            vec![[0, 1, 2]],
        ),
        (
            "turned inside out",
            vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(1., 1., 0.5)],
            vec![[0, 1, 2], [1, 2, 3]],
        ),
        (
            "twice the same face",
            vec![p(0., 0., 0.), p(1e99, 0., 0.), p(0., 1e99, 0.)],
            vec![[0, 1, 2], [0, 1, 2], [0, 2, 1]],
        ),
        (
            "tiny",
            vec![p(0., 0., 0.), p(1e-200, 0., 0.), p(0., 1e-200, 0.), p(1e-200, 1e-200, 1e-200)],
            vec![[0, 1, 2], [1, 3, 2]],
        ),
    ];
    for (name, points, triangles) in cases {
        let prepared = geometry(points.clone(), &triangles);
        let global = BilateralParams::default().with_scheme(NormalScheme::Global { smoothness: 0.01 });
        let free = BilateralParams { border: Border::Free, ..BilateralParams::default() };
        for moved in [
            bilateral(&prepared, &BilateralParams::default()),
            bilateral(&prepared, &free),
            bilateral(&prepared, &global),
            guided(&prepared),
        ] {
            assert_eq!(moved.len(), points.len(), "{name}");
            assert!(moved.as_flattened().iter().all(|c| c.is_finite()), "{name}: {moved:?}");
        }
    }
}

#[test]
fn what_cannot_be_filtered_is_an_error() {
    let (points, triangles) = grid(2);
    let prepared = geometry(points.clone(), &triangles);
    let none = Progress::none();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let params = BilateralParams::default().with_sigma_s(bad);
        assert!(matches!(
            bilateral_normals(&prepared, &params, none),
            Err(NormalFilterError::Parameter { .. })
        ));
        let params = GuidedParams::default().with_sigma_r(bad);
        assert!(matches!(guided_normals(&prepared, &params, none), Err(NormalFilterError::Parameter { .. })));
    }
    let params = BilateralParams::default().with_scheme(NormalScheme::Global { smoothness: 0.0 });
    assert!(bilateral_normals(&prepared, &params, none).is_err());
    let params = GuidedParams::default().with_normal_iterations(MAX_ITERATIONS + 1);
    assert!(guided_normals(&prepared, &params, none).is_err());
    let wrong = update_vertices(&prepared, &[[0.0; 3]], 1, Border::Free, none);
    assert_eq!(wrong, Err(NormalFilterError::Normals { got: 1, wanted: 8 }));

    let faceless = geometry(points, &[]);
    assert_eq!(guided_normals(&faceless, &GuidedParams::default(), none), Err(NormalFilterError::NotAMesh));
    // A fan whose hub has more faces than neighbor lists can hold.
    let n = 600;
    let rim = (0..n).map(|k| f64::from(k) * std::f64::consts::TAU / f64::from(n));
    let fan: Vec<[f64; 3]> = std::iter::once([0.0; 3]).chain(rim.map(|a| [a.cos(), a.sin(), 0.0])).collect();
    let blades: Vec<[u32; 3]> = (1..n).map(|k| [0, k, k + 1]).collect();
    let error = bilateral_normals(&geometry(fan, &blades), &BilateralParams::default(), none);
    assert!(
        matches!(error, Err(NormalFilterError::TooManyFaces { vertex: 0, n_faces: 599, .. })),
        "{error:?}"
    );
}
