use super::*;
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons};

fn sample(name: &str, n: usize) -> Shape {
    let sample = Sample::from_name(name, Some(n)).unwrap();
    Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
}

#[test]
fn a_sphere_has_constant_curvature_and_nothing_salient() {
    let shape = sample("sphere", 5000);
    let radius = norm(&shape.points().unwrap()[0]);
    let lee = lee_saliency(&shape, Progress::none()).unwrap();
    // Normals and curvature are exact if all vertices lie on the sphere. The bounding box of the mesh is slightly
    // smaller than that of the sphere, so the radius is measured.
    assert!(lee.curvature.iter().all(|h| (h * radius - 1.0).abs() < 1e-9));
    for map in &lee.scales {
        assert!(map.iter().all(|s| s * radius < 1e-9), "{:?}", map.iter().copied().fold(0.0, f64::max));
    }
}

#[test]
fn a_bump_is_more_salient_than_a_plane() {
    let plane = {
        let points =
            (0..100).flat_map(|i| (0..100).map(move |j| [f64::from(i), f64::from(j), 0.0])).collect();
        let cell = |i: u32, j: u32| {
            let a = 100 * i + j;
            [[a, a + 100, a + 101], [a, a + 101, a + 1]]
        };
        let triangles: Vec<[u32; 3]> = (0..99).flat_map(|i| (0..99).flat_map(move |j| cell(i, j))).collect();
        Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap()
    };
    let mut points = plane.points().to_vec();
    let (lo, hi) = adwave::shape::bounding_box(&points).unwrap();
    let up = (0..3).find(|&c| hi[c] == lo[c]).unwrap();
    let middle: [f64; 3] = std::array::from_fn(|c| 0.5 * (lo[c] + hi[c]));
    let size = diagonal(&points);
    let distance = |p: &[f64; 3]| norm(&subtract(p, &middle)) / size;
    for p in &mut points {
        p[up] += 0.02 * size * (-(distance(p) / 0.02).powi(2)).exp();
    }
    let flat = plane.points().to_vec();
    let lee = lee_saliency(&Shape::Mesh(Mesh::new(points, plane.faces().clone()).unwrap()), Progress::none())
        .unwrap();
    let top = (0..flat.len()).max_by(|&a, &b| lee.saliency[a].total_cmp(&lee.saliency[b])).unwrap();
    assert!(distance(&flat[top]) < 0.08, "{}", distance(&flat[top]));
    for (p, s) in flat.iter().zip(&lee.saliency) {
        let border = (0..3).any(|c| c != up && (p[c] - lo[c]).min(hi[c] - p[c]) < 0.1 * size);
        assert!(distance(p) < 0.15 || border || *s < 0.01 * lee.saliency[top], "{p:?} {s}");
    }
}

#[test]
fn the_tree_finds_what_comparing_all_pairs_finds() {
    let shape = sample("creature", 2000);
    let geometry = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none()).unwrap();
    let epsilon = EPSILON * diagonal(geometry.points());
    let points: Vec<[f64; 3]> = geometry.points().iter().map(|p| p.map(|c| c / epsilon)).collect();
    let h: Vec<f64> = (0..points.len()).map(|i| (i as f64 * 0.1).sin()).collect();
    let found = gaussians(&points, &h, Progress::none()).unwrap();
    for x in (0..points.len()).step_by(37) {
        for (k, width) in WIDTHS.iter().enumerate() {
            let (mut sum, mut total) = (0.0, 0.0);
            for (p, h) in points.iter().zip(&h) {
                let d = subtract(p, &points[x]);
                let squared = dot(&d, &d);
                if squared <= 4.0 * width * width {
                    let g = (-squared / (2.0 * width * width)).exp();
                    (sum, total) = (sum + g * h, total + g);
                }
            }
            assert!((found[x][k] - sum / total).abs() < 1e-12);
        }
    }
}

#[test]
fn odd_shapes_give_an_answer() {
    let cloud = Shape::Cloud(PointCloud::new(vec![[0.0; 3]]).unwrap());
    assert_eq!(lee_saliency(&cloud, Progress::none()), Err(LeeError::NotAMesh));
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [7.0, 7.0, 7.0]];
    let line = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&[[0, 1, 2], [1, 1, 1]])).unwrap());
    let lee = lee_saliency(&line, Progress::none()).unwrap();
    assert!(lee.saliency.len() == 4 && lee.saliency.iter().all(|s| s.is_finite()));
    let one = Shape::Mesh(Mesh::new(vec![[1e99; 3]], Polygons::new()).unwrap());
    assert_eq!(lee_saliency(&one, Progress::none()).unwrap().saliency, [0.0]);
}
