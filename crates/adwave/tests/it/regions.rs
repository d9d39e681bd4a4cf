//! Regions made of the surface and of other regions.

use adwave::region::{BrushStroke, Length, Region, RegionError, parse_region};
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape, triangulate, vertex_normals};
use adwave::{Cancelled, Decomposer, Progress};

/// Distances over flat triangles, against those on the sphere that they approximate.
const PATHS: f64 = 0.015;

fn sphere(n: usize) -> (Vec<[f64; 3]>, Decomposer) {
    let Sample { points, faces } = Sample::from_name("sphere", Some(n)).unwrap();
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(points.clone(), faces).unwrap()));
    (points, decomposer)
}

fn try_weights(decomposer: &Decomposer, region: &Region) -> Result<Vec<f64>, RegionError> {
    let weights = region.weights(decomposer.metric(), &|_| None, &[], Progress::none())?;
    Ok(weights.to_vertices(decomposer.vertex_map()))
}

fn weights(decomposer: &Decomposer, region: &str) -> Vec<f64> {
    try_weights(decomposer, &parse_region(region).unwrap()).unwrap()
}

#[test]
fn facing_is_where_normals_have_a_positive_product() {
    let Sample { points, faces } = Sample::from_name("torus", Some(2000)).unwrap();
    let normals = vertex_normals(&points, &triangulate(&points, &faces));
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(points, faces).unwrap()));
    let hard = weights(&decomposer, "facing:direction=0 3 4");
    let soft = weights(&decomposer, "facing:direction=0 3 4,falloff=0.4");
    for (x, n) in normals.iter().enumerate() {
        let cosine = 0.6 * n[1] + 0.8 * n[2];
        assert_eq!(hard[x], f64::from(cosine > 0.0), "vertex {x}");
        assert!(if cosine <= 0.0 { soft[x] == 0.0 } else { cosine < 0.4 || soft[x] == 1.0 }, "vertex {x}");
        // The rise is symmetric about its middle.
        assert!(cosine <= 0.0 || (soft[x] >= 0.5) == (cosine >= 0.2), "vertex {x}");
    }
    let cloud = Decomposer::new(&Shape::Cloud(
        PointCloud::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap(),
    ));
    let refused = try_weights(&cloud, &parse_region("facing:direction=0 0 1").unwrap());
    assert_eq!(refused, Err(RegionError::NeedsFaces("facing")));
    let refused = try_weights(&decomposer, &parse_region("facing:direction=0 0 0").unwrap());
    assert!(matches!(refused, Err(RegionError::BadNumber { .. })));
}

#[test]
fn a_component_is_all_that_is_joined_to_a_vertex() {
    let Sample { points, faces } = Sample::from_name("sphere", Some(300)).unwrap();
    let triangles = triangulate(&points, &faces);
    let n = points.len();
    let two = |k: usize| {
        let shifted = points.iter().map(|p| [p[0] + 3.0 * k as f64, p[1], p[2]]);
        (shifted.collect::<Vec<_>>(), triangles.iter().map(move |t| t.map(|v| v + (k * n) as u32)))
    };
    let (mut all, first) = two(0);
    let (more, second) = two(1);
    all.extend(more);
    let faces = Polygons::from_triangles(&first.chain(second).collect::<Vec<_>>());
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(all, faces).unwrap()));
    let part = weights(&decomposer, &format!("component:vertex={}", n + 5));
    assert!(part[..n].iter().all(|r| *r == 0.0) && part[n..].iter().all(|r| *r == 1.0));
    let refused = try_weights(&decomposer, &Region::Component { vertex: 2 * n as u32 });
    assert!(matches!(refused, Err(RegionError::NoSuchVertex { .. })));
}

#[test]
fn growing_moves_the_edge_outwards_and_shrinking_inwards() {
    let (points, decomposer) = sphere(20_000);
    // A cap of geodesic radius π/2 about the pole, with a hard edge at the equator.
    let cap = "half-space:point=0 0 0,normal=0 0 1,falloff=0";
    let grown = weights(&decomposer, &format!("grown:by=0.2({cap})"));
    let shrunk = weights(&decomposer, &format!("shrunk:by=0.2({cap})"));
    for (x, p) in points.iter().enumerate() {
        let below = -p[2].asin();
        let (up_to, beyond) = (0.2 * (1.0 - PATHS), 0.4 * (1.0 + PATHS));
        if below < up_to - 0.03 {
            assert_eq!(grown[x], 1.0, "{below}");
        }
        if below > beyond {
            assert_eq!(grown[x], 0.0, "{below}");
        }
        if -below < up_to - 0.03 {
            assert_eq!(shrunk[x], 0.0, "{below}");
        }
        if -below > beyond {
            assert_eq!(shrunk[x], 1.0, "{below}");
        }
    }
    // Growing never takes away, and shrinking never adds.
    let ball = "0.7*ball:vertex=3,radius=0.5";
    let [r, more, less] = ["(", "grown:by=0.05(", "shrunk:by=0.05("]
        .map(|kind| weights(&decomposer, &format!("{kind}{ball})")));
    assert!((0..r.len()).all(|x| more[x] >= r[x] - 1e-9 && less[x] <= r[x] + 1e-9));
    assert_eq!(weights(&decomposer, "grown:by=1%(all)"), vec![1.0; points.len()]);
    let refused = try_weights(&decomposer, &parse_region("grown:by=0(all & all)").unwrap());
    assert!(matches!(refused, Err(RegionError::BadNumber { .. })));
}

#[test]
fn a_blur_is_the_walk_that_it_says() {
    // A literal walk of k = 4 (by/h)² steps on a small mesh.
    let (points, decomposer) = sphere(200);
    let hard = weights(&decomposer, "half-space:point=0 0 0.3,normal=0 0 1,falloff=0");
    let Sample { faces, .. } = Sample::from_name("sphere", Some(200)).unwrap();
    let ring = adwave::shape::one_ring(points.len(), &triangulate(&points, &faces));
    let squared = |x: usize, y: usize| (0..3).map(|c| (points[x][c] - points[y][c]).powi(2)).sum::<f64>();
    let mean_square = |x: usize| {
        ring.row(x).iter().map(|&y| squared(x, y as usize)).sum::<f64>() / ring.row(x).len() as f64
    };
    let h = ((0..points.len()).map(mean_square).sum::<f64>() / points.len() as f64).sqrt();
    let by = 1.6 * h;
    let mut expected = hard;
    for _ in 0..(4.0_f64 * 1.6 * 1.6).ceil() as usize {
        let mean = |x: usize| {
            ring.row(x).iter().map(|&y| expected[y as usize]).sum::<f64>() / ring.row(x).len() as f64
        };
        expected = (0..points.len()).map(|x| 0.5 * (expected[x] + mean(x))).collect();
    }
    let blurred =
        weights(&decomposer, &format!("blurred:by={by}(half-space:point=0 0 0.3,normal=0 0 1,falloff=0)"));
    for (x, r) in blurred.iter().enumerate() {
        assert!((r - expected[x]).abs() < 1e-8, "vertex {x}: {r} and {}", expected[x]);
    }
    assert!(weights(&decomposer, "blurred:by=9%(0.3*all)").iter().all(|r| (r - 0.3).abs() < 1e-12));
    let too_wide = parse_region(&format!("blurred:by={}(0.3*all)", 2001.0 * h)).unwrap();
    assert!(matches!(try_weights(&decomposer, &too_wide), Err(RegionError::BadNumber { .. })));
}

#[test]
fn a_blur_spreads_by_its_length() {
    // From one vertex to a bell of the variance `by²` in each of two directions, on the mean of all places and directions.
    let (points, decomposer) = sphere(20_000);
    let by = 0.1;
    let mut ratios = 0.0;
    for v in (0..20_000).step_by(2000) {
        let bell = weights(&decomposer, &format!("blurred:by={by}(vertices:indices={v})"));
        let squared = |x: usize| (0..3).map(|c| (points[x][c] - points[v][c]).powi(2)).sum::<f64>();
        let spread: f64 = (0..points.len()).map(|x| bell[x] * squared(x)).sum();
        ratios += spread / bell.iter().sum::<f64>() / (2.0 * by * by) / 10.0;
    }
    assert!((ratios - 1.0).abs() < 0.1, "{ratios}");
}

#[test]
fn a_stroke_smooths_what_was_painted_before() {
    let (points, decomposer) = sphere(3000);
    let hard = parse_region("half-space:point=0 0 0,normal=0 0 1,falloff=0").unwrap();
    let by = Length::Units(0.08);
    let part = parse_region("half-space:point=0 0 0,normal=1 0 0,falloff=0.2").unwrap();
    let smoothed = Region::Painted(vec![
        BrushStroke::Add(hard.clone()),
        BrushStroke::Smooth { region: part.clone(), by },
    ]);
    let blurred = Region::Blurred { by, region: Box::new(hard.clone()) };
    let [all, before, blurred, part] =
        [&smoothed, &hard, &blurred, &part].map(|region| try_weights(&decomposer, region).unwrap());
    for x in 0..points.len() {
        assert_eq!(all[x], before[x] + part[x] * (blurred[x] - before[x]), "vertex {x}");
    }
    assert!(all.iter().any(|r| *r > 0.3 && *r < 0.7));
}

#[test]
fn what_is_made_of_regions_stops_when_told_to() {
    let (_, decomposer) = sphere(20_000);
    let stop = std::sync::atomic::AtomicBool::new(true);
    let cancelled = Progress::none().with_cancel(&stop);
    for region in [
        "facing:direction=1 0 0",
        "component:vertex=0",
        "grown:by=50%(all & all)",
        "blurred:by=5%(all & all)",
    ] {
        let region = parse_region(region).unwrap();
        let error = region.weights(decomposer.metric(), &|_| None, &[], cancelled).unwrap_err();
        assert_eq!(error, RegionError::Cancelled(Cancelled), "{region:?}");
    }
}

/// Distance from the weight of a ball whose falloff is its radius.
fn distance_in_ball(weight: f64, radius: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let t: f64 = 0.5 * (low + high);
        if t * t * t * (t * (6.0 * t - 15.0) + 10.0) < weight { low = t } else { high = t }
    }
    radius * (1.0 - low)
}

#[test]
fn a_ball_on_a_sphere_is_measured_along_great_circles() {
    for n in [2000, 20_000] {
        let (points, decomposer) = sphere(n);
        for vertex in [0, n / 3, n - 1] {
            let r = weights(&decomposer, &format!("ball:vertex={vertex},radius=1.5,falloff=1.5"));
            for (x, p) in points.iter().enumerate() {
                let cosine: f64 = (0..3).map(|c| p[c] * points[vertex][c]).sum();
                let along = cosine.clamp(-1.0, 1.0).acos();
                if along > 0.2 && along < 1.4 {
                    let found = distance_in_ball(r[x], 1.5);
                    assert!((found / along - 1.0).abs() < PATHS, "{n}, vertex {x}: {found} {along}");
                }
            }
        }
    }
}

/// A flat grid with cells of the given sides.
fn flat_grid(side: u32, cell: [f64; 2]) -> (Vec<[f64; 3]>, Decomposer) {
    let points: Vec<[f64; 3]> = (0..side * side)
        .map(|k| [cell[0] * f64::from(k % side), cell[1] * f64::from(k / side), 5.0])
        .collect();
    let cells = (0..(side - 1) * (side - 1)).map(|k| k / (side - 1) * side + k % (side - 1));
    let faces: Vec<[u32; 3]> =
        cells.flat_map(|a| [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]]).collect();
    let mesh = Mesh::new(points.clone(), Polygons::from_triangles(&faces)).unwrap();
    (points, Decomposer::new(&Shape::Mesh(mesh)))
}

#[test]
fn balls_and_strokes_on_a_plane_have_the_distances_of_space_whatever_the_cells() {
    for cell in [[1.0, 1.0], [1.0, 0.2], [0.1, 1.0]] {
        let (points, decomposer) = flat_grid(61, cell);
        let (width, height) = (60.0 * cell[0], 60.0 * cell[1]);
        let radius = 0.45 * width.min(height);
        let (x, y) = (0.503 * width, 0.48 * height);
        let ball = weights(&decomposer, &format!("ball:point={x} {y} 5,radius={radius},falloff={radius}"));
        let (start, end) = ([0.3 * width, y], [0.7 * width, y]);
        let path = format!("{} {} 5; {} {} 5", start[0], start[1], end[0], end[1]);
        let stroke = weights(&decomposer, &format!("stroke:path={path},radius={radius},falloff={radius}"));
        for (k, p) in points.iter().enumerate() {
            let to_center = (p[0] - x).hypot(p[1] - y);
            let to_line = (p[0] - p[0].clamp(start[0], end[0])).hypot(p[1] - y);
            // A line starts at the vertices beside it, which stretched cells put at one cell's length.
            let beside = cell[0].max(cell[1]);
            for (weight, expected, least) in [(ball[k], to_center, 0.0), (stroke[k], to_line, 1.5 * beside)] {
                if expected > least.max(0.1 * radius) && expected < 0.95 * radius {
                    let found = distance_in_ball(weight, radius);
                    assert!((found / expected - 1.0).abs() < 0.01, "{cell:?} at {p:?}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn a_border_of_a_plane_is_as_far_as_its_lines() {
    // The weight of a map that fades at the border rises with the distance from it.
    let (points, decomposer) = flat_grid(41, [1.0, 0.25]);
    let inside = weights(&decomposer, "shrunk:by=2(box:min=-1 -1 0,max=41 11 9,falloff=0)");
    assert!(inside.iter().all(|r| *r == 1.0), "nothing is outside, so nothing shrinks");
    let half = weights(&decomposer, "grown:by=2(half-space:point=20 0 0,normal=1 0 0,falloff=0)");
    for (p, r) in points.iter().zip(half) {
        let away = 20.0 - p[0];
        assert!(if away <= 2.0 { r > 1.0 - 1e-9 } else { away < 4.0 || r < 1e-9 }, "{p:?}: {r}");
    }
}

#[test]
fn a_ball_in_the_middle_of_a_sphere_is_reported_and_one_on_it_is_not() {
    let (points, decomposer) = sphere(2000);
    let far =
        |text: &str| parse_region(text).unwrap().far_points(decomposer.metric(), Progress::none()).unwrap();
    let found = far("!grown:by=1(ball:point=0 0 0.1,radius=0.6)");
    assert_eq!(found.len(), 1);
    assert!((found[0].distance - 0.9).abs() < 0.03 && found[0].point == [0.0, 0.0, 0.1], "{found:?}");
    assert!(found[0].describe().starts_with("the point 0 0 0.1 of the region lies 0."));
    let distant = far("ball:point=0 0 50,radius=0.6 | stroke:path=0 0 1; 0 9 0,radius=0.2");
    assert_eq!(distant.len(), 2, "{distant:?}");
    assert!((distant[0].nearest[2] - 1.0).abs() < 0.05);
    // The region is around the nearest place, as far away as the point may be.
    let around = weights(&decomposer, "ball:point=0 0 50,radius=0.6");
    let center = distant[0].nearest;
    for (p, r) in points.iter().zip(around) {
        let angle = (0..3).map(|c| p[c] * center[c]).sum::<f64>().clamp(-1.0, 1.0).acos();
        assert!(if angle < 0.57 { r > 0.0 } else { angle < 0.63 || r == 0.0 }, "{p:?}: {r}");
    }
    assert_eq!(far("ball:vertex=3,radius=0.01"), []);
    let [x, y, z] = points[77];
    assert_eq!(far(&format!("ball:point={x} {y} {z},radius=0.001")), []);
    let cloud = Decomposer::new(&Shape::Cloud(PointCloud::new(points).unwrap()));
    let middle = parse_region("ball:point=0 0 0,radius=0.5").unwrap();
    assert_eq!(middle.far_points(cloud.metric(), Progress::none()).unwrap().len(), 1);
    assert!(weights(&cloud, "ball:point=0 0 0,radius=0.5").contains(&1.0));
}
