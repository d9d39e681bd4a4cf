use super::*;
use crate::sample::Sample;
use crate::shape::{Mesh, PointCloud, Polygons, WeldMode};
use crate::vector::dot;

fn found(points: Vec<[f64; 3]>, triangles: &[[u32; 3]], file: Option<&[f64]>) -> OutwardNormals {
    let mesh = Mesh::new(points, Polygons::from_triangles(triangles)).unwrap();
    outward(&Shape::Mesh(mesh), file)
}

/// Normals in the order of the shape.
fn outward(shape: &Shape, file: Option<&[f64]>) -> OutwardNormals {
    let geometry = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    let OutwardNormals { normals, info } = outward_normals(&geometry, file, Progress::none()).unwrap();
    let normals = geometry.vertex_map().scatter(normals.as_flattened(), 3);
    OutwardNormals { normals: normals.chunks_exact(3).map(|n| [n[0], n[1], n[2]]).collect(), info }
}

/// An octahedron about `center`, its triangles running outwards.
fn octahedron(center: [f64; 3], first: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let points = [1.0, -1.0].into_iter().flat_map(|s| axes.map(|a: [f64; 3]| a.map(|c| s * c)));
    let points = points.map(|p| [p[0] + center[0], p[1] + center[1], p[2] + center[2]]).collect();
    let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    (points, faces.map(|f| f.map(|v: u32| v + first)).to_vec())
}

/// A grid of n × n points at heights z(x, y) over [−1, 1]².
fn sheet(n: u32, z: impl Fn(f64, f64) -> f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n - 1) - 1.0;
    let points = (0..n * n).map(|k| (at(k % n), at(k / n))).map(|(x, y)| [x, y, z(x, y)]).collect();
    let squares = (0..(n - 1) * (n - 1)).map(|k| k / (n - 1) * n + k % (n - 1));
    (points, squares.flat_map(|a| [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]).collect())
}

#[test]
fn every_closed_part_points_away_from_its_own_inside_however_its_triangles_run() {
    let (mut points, mut triangles) = octahedron([0.0; 3], 0);
    let (more, mut inside_out) = octahedron([9.0, 0.0, 0.0], 6);
    for f in &mut inside_out {
        f.swap(0, 1);
    }
    points.extend(more);
    triangles.extend(inside_out);
    triangles[2].swap(1, 2); // and one of the first runs against its neighbors
    let OutwardNormals { normals, info } = found(points.clone(), &triangles, None);
    for (k, (n, p)) in normals.iter().zip(&points).enumerate() {
        let center = if k < 6 { [0.0; 3] } else { [9.0, 0.0, 0.0] };
        let out = [p[0] - center[0], p[1], p[2]];
        assert!((dot(n, &out) - 1.0).abs() < 1e-12, "vertex {k}: {n:?}");
    }
    assert_eq!((info.n_parts, info.n_closed, info.n_turned, info.without), (2, 2, 9, 0.0));
    assert_eq!(info.to_string(), "outside by the volume enclosed; 9 triangles turned over");
}

#[test]
fn turning_all_triangles_over_changes_nothing() {
    for name in ["creature", "knot", "torus"] {
        let Sample { points, faces, .. } = Sample::from_name(name, Some(2000)).unwrap();
        let given = crate::shape::triangulate(&points, &faces);
        let turned: Vec<[u32; 3]> = given.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let (a, b) = (found(points.clone(), &given, None), found(points, &turned, None));
        assert_eq!(a.normals, b.normals, "{name}");
        assert!(a.info.has_outside() && a.info.n_closed == 1, "{name}: {}", a.info);
    }
}

#[test]
fn an_open_cap_points_away_from_its_center_and_the_files_normals_outrank_that() {
    let (points, triangles) = sheet(9, |x, y| -0.4 * (x * x + y * y));
    let upward = vec![[0.0, 0.0, 1.0]; points.len()];
    let downward: Vec<f64> = upward.iter().flat_map(|n: &[f64; 3]| n.map(|c| -7.0 * c)).collect();
    let turned: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    for triangles in [&triangles, &turned] {
        let by_majority = found(points.clone(), triangles, None);
        assert!(by_majority.normals.iter().all(|n| n[2] > 0.5));
        assert_eq!(by_majority.info.n_by_majority, 1);
        let by_file = found(points.clone(), triangles, Some(&downward));
        assert!(by_file.normals.iter().all(|n| n[2] < -0.5));
        assert_eq!((by_file.info.n_by_file, by_file.info.to_string()), (1, by_file.info.words()));
    }
    // Normals without a direction are ignored.
    let unknown = found(points.clone(), &triangles, Some(&vec![f64::NAN; 3 * points.len()]));
    assert_eq!(unknown.info.n_by_majority, 1);
}

#[test]
fn where_neither_side_is_outside_there_are_no_normals() {
    let (flat, triangles) = sheet(7, |x, y| 0.3 * x - 0.1 * y);
    let flat = found(flat, &triangles, None);
    assert!(flat.normals.iter().all(|n| *n == [0.0; 3]) && flat.info.without == 1.0, "{}", flat.info);
    // A Möbius strip.
    let n = 40;
    let at = |k: u32, s: f64| {
        let t = std::f64::consts::TAU * f64::from(k) / f64::from(n);
        let r = 1.0 + s * (0.5 * t).cos();
        [r * t.cos(), r * t.sin(), s * (0.5 * t).sin()]
    };
    let points: Vec<[f64; 3]> = (0..n).flat_map(|k| [at(k, -0.3), at(k, 0.3)]).collect();
    let strip: Vec<[u32; 3]> = (0..n)
        .flat_map(|k| {
            let [a, b] = [2 * k, 2 * k + 1];
            let [c, d] = if k + 1 == n { [1, 0] } else { [2 * k + 2, 2 * k + 3] };
            [[a, c, b], [b, c, d]]
        })
        .collect();
    let moebius = found(points, &strip, None);
    assert!(!moebius.info.has_outside() && moebius.info.n_without == 1, "{:?}", moebius.info);
    assert!(moebius.info.to_string().starts_with("no side is outside"));
    // A closed sheet without thickness: front and back are the same four points.
    let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let double = found(square, &[[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]], None);
    assert!(!double.info.has_outside(), "{:?}", double.info);
}

#[test]
fn a_saddle_is_alike_from_both_sides_and_taken_as_its_triangles_run() {
    let (points, mut triangles) = sheet(9, |x, y| 0.5 * (x * x - y * y));
    let as_given = found(points.clone(), &triangles, None);
    assert_eq!((as_given.info.n_as_given, as_given.info.n_turned), (1, 0));
    assert!(as_given.normals.iter().all(|n| n[2] > 0.3));
    triangles[5].swap(0, 1);
    assert_eq!(found(points, &triangles, None).info.n_without, 1);
}

#[test]
fn triangles_without_area_and_edges_of_many_have_a_say_but_no_veto() {
    let (mut points, mut triangles) = octahedron([0.0; 3], 0);
    triangles.extend([[0, 0, 1], [2, 2, 2]]);
    points.push([50.0, 0.0, 0.0]); // no triangle
    let lone = found(points.clone(), &triangles, None);
    assert!(lone.normals[6] == [0.0; 3] && lone.info.n_closed == 1 && lone.info.has_outside());
    // Two octahedra that share an edge: four triangles at it, so each is open there.
    let shared: Vec<[u32; 3]> = octahedron([0.0; 3], 0).1;
    // The point reflection that swaps the ends of the edge.
    let mirrored = |v: u32| if v < 2 { 1 - v } else { v + 4 };
    let other: Vec<[f64; 3]> =
        (2..6).map(|v| points[v].map(|c| -c)).map(|p| [p[0] + 1.0, p[1] + 1.0, p[2]]).collect();
    points.truncate(6);
    points.extend(other);
    let both: Vec<[u32; 3]> = shared.iter().copied().chain(shared.iter().map(|f| f.map(mirrored))).collect();
    let found = found(points, &both, None);
    assert!(found.info.has_outside() && found.info.n_parts == 2, "{:?}", found.info);
}

#[test]
fn a_cloud_points_outwards_or_as_its_file_says() {
    let sphere = Sample::from_name("sphere", Some(800)).unwrap().points;
    let cloud = Shape::Cloud(PointCloud::new(sphere.clone()).unwrap());
    let estimated = outward(&cloud, None);
    assert!(estimated.normals.iter().zip(&sphere).all(|(n, p)| dot(n, p) > 0.5), "{}", estimated.info);
    let inward: Vec<f64> = sphere.iter().flat_map(|p| p.map(|c| -c)).collect();
    let by_file = outward(&cloud, Some(&inward));
    assert!(by_file.normals.iter().zip(&sphere).all(|(n, p)| dot(n, p) < -0.5));
    let plane = (0..400).map(|k| [f64::from(k % 20), f64::from(k / 20), 3.0]).collect();
    let flat = outward(&Shape::Cloud(PointCloud::new(plane).unwrap()), None);
    assert!(!flat.info.has_outside(), "{:?}", flat.info);
}

#[test]
fn a_graph_and_normals_of_another_shape_are_named() {
    let graph = Shape::Graph(crate::shape::Graph::new(3, &[(0, 1, 1.0)]).unwrap());
    let geometry = PreparedGeometry::new(&graph, WeldMode::EqualPositions, Progress::none()).unwrap();
    assert_eq!(outward_normals(&geometry, None, Progress::none()), Err(OutwardError::NoPositions));
    let (points, triangles) = octahedron([0.0; 3], 0);
    let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap());
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    let error = outward_normals(&geometry, Some(&[0.0; 9]), Progress::none()).unwrap_err();
    assert!(error.to_string().starts_with("there are 3 normals and 6 vertices"), "{error}");
}
