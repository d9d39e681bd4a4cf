//! Strays, placeholders and the layout of parts change nothing elsewhere, and defaults never remove half of a shape.

use adwave::bands::{DEFAULT_EXTENT, Schedule};
use adwave::denoise::{DenoiseParams, denoise};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::region::parse_region;
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, PreparedGeometry, Shape, VertexRole, WeldMode};
use adwave::{Decomposer, LevelSpec, Progress};

/// Largest change of the other vertices, in extents.
const UNCHANGED: f64 = 1e-9;

fn bumpy_sphere(n: usize) -> (Vec<[f64; 3]>, Polygons) {
    let Sample { mut points, faces } = Sample::from_name("sphere", Some(n)).unwrap();
    for p in &mut points {
        let bump = 1.0 + 0.05 * p.iter().map(|c| (9.0 * c).sin()).product::<f64>();
        *p = p.map(|c| c * bump);
    }
    (points, faces)
}

fn mesh(points: Vec<[f64; 3]>, faces: Polygons) -> Shape {
    Shape::Mesh(Mesh::new(points, faces).unwrap())
}

fn cloud(points: Vec<[f64; 3]>) -> Shape {
    Shape::Cloud(PointCloud::new(points).unwrap())
}

/// A terrain of 40 × 40 points in meters, far from the origin, with rough heights.
fn terrain() -> Vec<[f64; 3]> {
    let height = |i: u32| {
        0.5 * f64::from(i % 40 / 4).sin() + 0.1 * f64::from(i.wrapping_mul(2_654_435_761) >> 16 & 255) / 256.0
    };
    (0..1600).map(|i| [5e5 + f64::from(i % 40), 5.4e6 + f64::from(i / 40), 300.0 + height(i)]).collect()
}

/// Positions smoothed over the default levels, the extent and the number of levels.
fn smoothed(shape: &Shape, kind: OperatorKind) -> (Vec<[f64; 3]>, f64, usize) {
    let params = OperatorParams::default().with_kind(kind);
    let decomposer = Decomposer::with_params(shape, &params, Progress::none()).unwrap();
    let schedule = LevelSpec::Default.resolve(&decomposer, DEFAULT_EXTENT).unwrap().schedule;
    let bands = decomposer.decompose(shape.points().unwrap().as_flattened(), 3, &schedule).unwrap();
    (bands.coarsest().as_chunks().0.to_vec(), decomposer.extent(), schedule.n_levels())
}

/// Checks that the first vertices of `more` are smoothed like those of `clean`, and the rest stays.
fn check_unchanged(clean: &Shape, more: &Shape, what: &str) {
    for kind in [OperatorKind::Walk, OperatorKind::Surface] {
        let ((expected, extent, n_levels), (found, own, own_levels)) =
            (smoothed(clean, kind), smoothed(more, kind));
        assert_eq!(own_levels, n_levels, "{what} {kind:?}");
        assert!((own / extent - 1.0).abs() < UNCHANGED, "{what} {kind:?}: {own} and {extent}");
        for (x, (p, q)) in expected.iter().zip(&found).enumerate() {
            let moved = (0..3).map(|c| (p[c] - q[c]).abs()).fold(0.0, f64::max);
            assert!(moved <= UNCHANGED * extent, "{what} {kind:?}: vertex {x} by {moved}");
        }
        let points = more.points().unwrap();
        assert!(found[expected.len()..] == points[expected.len()..], "{what} {kind:?}");
    }
}

#[test]
fn vertices_of_no_face_change_nothing() {
    let (points, faces) = bumpy_sphere(2000);
    let clean = mesh(points.clone(), faces.clone());
    for stray in [[500.0, 0.0, 0.0], [-9999.0; 3], [0.0, 0.0, -3.402_823_466_385_288_6e38]] {
        let more = mesh([points.clone(), vec![stray]].concat(), faces.clone());
        check_unchanged(&clean, &more, &format!("{stray:?}"));
        let geometry = PreparedGeometry::new(&more, WeldMode::EqualPositions, Progress::none()).unwrap();
        assert_eq!(geometry.outsiders(), [(points.len(), VertexRole::Unused)]);
        assert_eq!(geometry.frame(), adwave::shape::bounding_box(&points));
    }
}

#[test]
fn strays_and_placeholders_of_a_cloud_change_nothing() {
    let points = terrain();
    let clean = cloud(points.clone());
    let at = |x: usize, z: f64| [points[x][0] + 0.5, points[x][1] + 0.5, z];
    let nodata = |z: f64| (0..40).map(|k| at(37 * k, z)).collect::<Vec<_>>();
    let cases: Vec<(&str, Vec<[f64; 3]>, VertexRole)> = vec![
        ("origin", vec![[0.0; 3]], VertexRole::Placeholder),
        ("-9999", nodata(-9999.0), VertexRole::Placeholder),
        ("-3.4e38", nodata(-3.402_823_466_385_288_6e38), VertexRole::Placeholder),
        ("one far away", vec![at(3, 800.0)], VertexRole::Stray),
        ("a few far away", (0..4).map(|k| at(3 + k, 900.0)).collect(), VertexRole::Stray),
        ("two far apart", vec![at(3, 900.0), at(700, -100.0)], VertexRole::Stray),
    ];
    for (what, strays, role) in cases {
        let more = cloud([points.clone(), strays.clone()].concat());
        check_unchanged(&clean, &more, what);
        let geometry = PreparedGeometry::new(&more, WeldMode::EqualPositions, Progress::none()).unwrap();
        let expected: Vec<_> = (points.len()..points.len() + strays.len()).map(|x| (x, role)).collect();
        assert_eq!(geometry.outsiders(), expected, "{what}");
        let params = DenoiseParams::default();
        let own = PreparedGeometry::new(&clean, WeldMode::EqualPositions, Progress::none()).unwrap();
        let [own, found] = [&own, &geometry].map(|g| denoise(g, &params, Progress::none()).unwrap());
        assert!((own.info.noise - found.info.noise).abs() < UNCHANGED, "{what}");
        for (p, q) in own.points.iter().zip(&found.points) {
            assert!((0..3).all(|c| (p[c] - q[c]).abs() < UNCHANGED * 50.0), "{what}: {p:?} and {q:?}");
        }
    }
}

#[test]
fn ordinary_positions_are_no_strays() {
    let grid: Vec<[f64; 3]> = (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20), 0.0]).collect();
    // Spacing that grows along the cloud, two parts, and a part that is as sparse as ten times the other.
    let spread: Vec<[f64; 3]> =
        grid.iter().map(|p| [1.2_f64.powf(p[0]), 1.2_f64.powf(p[0]) * p[1], 0.0]).collect();
    let apart = [grid.clone(), grid.iter().map(|p| [p[0] + 500.0, p[1], 3.0]).collect()].concat();
    let coarse =
        [grid.clone(), grid.iter().map(|p| [30.0 + 10.0 * p[0], 10.0 * p[1], 3.0]).collect()].concat();
    let few = vec![[0.0; 3], [5.0, 1.0, 2.0], [9.0; 3]];
    let values: Vec<[f64; 3]> =
        (0..300).map(|i| [-9999.0, 50.0 * f64::from(i) - 15_000.0, f64::from(i % 7)]).collect();
    for (k, points) in [grid, spread, apart, coarse, few, values].into_iter().enumerate() {
        let geometry =
            PreparedGeometry::new(&cloud(points), WeldMode::EqualPositions, Progress::none()).unwrap();
        assert_eq!(geometry.outsiders(), [], "{k}");
    }
}

#[test]
fn the_layout_of_parts_does_not_change_them() {
    let (points, faces) = bumpy_sphere(2000);
    let n = points.len();
    let clean = mesh(points.clone(), faces.clone());
    let (expected, extent, n_levels) = smoothed(&clean, OperatorKind::Walk);
    assert_eq!(extent, clean.diagonal());
    let layouts: [Vec<[f64; 3]>; 2] = [
        vec![[0.0; 3], [100.0, 0.0, 0.0]],
        (0..25).map(|k| [3.0 * f64::from(k % 5), 3.0 * f64::from(k / 5), 0.0]).collect(),
    ];
    for offsets in layouts {
        let moved = |o: &[f64; 3]| points.iter().map(|p| [0, 1, 2].map(|c| p[c] + o[c])).collect::<Vec<_>>();
        let all: Vec<[f64; 3]> = offsets.iter().flat_map(moved).collect();
        let copy = |k: usize| faces.corners().iter().map(move |c| c + (k * n) as u32);
        let corners: Vec<u32> = (0..offsets.len()).flat_map(copy).collect();
        let plate = mesh(all, Polygons::from_triangles(corners.as_chunks().0));
        let (found, own, own_levels) = smoothed(&plate, OperatorKind::Walk);
        assert_eq!(own_levels, n_levels);
        assert!((own / extent - 1.0).abs() < UNCHANGED);
        for (x, (p, q)) in expected.iter().zip(&found).enumerate() {
            assert!((0..3).all(|c| (p[c] - q[c]).abs() < UNCHANGED * extent), "vertex {x}");
        }
        // A radius in percent is one of a part.
        let region = parse_region("ball:point=1 0 0,radius=10%").unwrap();
        let weights = |shape: &Shape| {
            let decomposer = Decomposer::new(shape);
            let weights = region.weights(decomposer.metric(), &|_| None, &[], Progress::none()).unwrap();
            weights.to_vertices(decomposer.vertex_map())
        };
        let (one, many) = (weights(&clean), weights(&plate));
        assert!((0..n).all(|x| (one[x] - many[x]).abs() < UNCHANGED));
    }
}

#[test]
fn a_default_keeps_half_of_the_volume() {
    let cube = |n: u32| {
        let corner = |i: u32| [0, 1, 2].map(|c| f64::from(i >> c & 1));
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces: Polygons = sides.iter().map(<[u32; 4]>::as_slice).collect();
        (if n == 8 { (0..8).map(corner).collect() } else { Vec::new() }, faces)
    };
    // A closed tube: rings of 8 vertices and two caps.
    let tube = |rings: u32, length: f64| {
        let point = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i % 8) / 8.0;
            [0.5 * angle.cos(), 0.5 * angle.sin(), length * f64::from(i / 8) / f64::from(rings - 1)]
        };
        let mut faces = Polygons::new();
        for k in 0..rings - 1 {
            for i in 0..8 {
                faces.push(&[8 * k + i, 8 * k + (i + 1) % 8, 8 * (k + 1) + (i + 1) % 8, 8 * (k + 1) + i]);
            }
        }
        faces.push(&[7, 6, 5, 4, 3, 2, 1, 0]);
        faces.push(&[0, 1, 2, 3, 4, 5, 6, 7].map(|i| 8 * (rings - 1) + i));
        ((0..8 * rings).map(point).collect::<Vec<[f64; 3]>>(), faces)
    };
    for (what, (points, faces)) in [("cube", cube(8)), ("tube", tube(16, 11.0)), ("wire", tube(400, 180.0))] {
        let shape = mesh(points, faces);
        for kind in [OperatorKind::Walk, OperatorKind::Surface] {
            let params = OperatorParams::default().with_kind(kind);
            let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
            let before = decomposer.health().volume.unwrap();
            let levels = decomposer.default_schedule();
            let coordinates = shape.points().unwrap().as_flattened();
            let bands = decomposer.decompose(coordinates, 3, &levels.schedule).unwrap();
            let geometry = decomposer.geometry().unwrap();
            let after = geometry.volume_of(&geometry.vertex_map().positions(bands.coarsest().as_chunks().0));
            assert!(after > 0.5 * before, "{what} {kind:?}: {after} of {before}, {}", levels.reason);
            assert!(levels.schedule.n_levels() < 4, "{what} {kind:?}: {}", levels.reason);
        }
    }
    // Asked for, any number of levels is taken.
    let (points, faces) = cube(8);
    let decomposer = Decomposer::new(&mesh(points, faces));
    let asked = LevelSpec::Dyadic(6).resolve(&decomposer, DEFAULT_EXTENT).unwrap();
    assert_eq!(asked.schedule, Schedule::dyadic(6).unwrap());
}

#[test]
fn the_frame_leaves_out_what_is_far() {
    let mut points = terrain();
    let whole = adwave::shape::bounding_box(&points);
    let frame = |points: &[[f64; 3]]| {
        PreparedGeometry::new(&cloud(points.to_vec()), WeldMode::EqualPositions, Progress::none())
            .unwrap()
            .frame()
    };
    assert_eq!(frame(&points), whole);
    // Placeholders and a few points far away.
    points.extend((0..100).map(|k| [5e5 + f64::from(k), 5.4e6, -9999.0]));
    points.extend((0..6).map(|k| [6e5 + f64::from(k), 5.5e6, 2000.0]));
    assert_eq!(frame(&points), whole);
    // Twelve at a time are a part, and one in a hundred is not left out.
    points.extend((0..20).map(|k| [6e5 + f64::from(k), 5.5e6, 2100.0]));
    assert_eq!(frame(&points).unwrap().1[2], 2100.0);
}
