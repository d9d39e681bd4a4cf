//! Given normals of clouds: signs are used where neighbors agree on them, and found from the points elsewhere.

use adwave::bands::Schedule;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::sample::Sample;
use adwave::shape::{
    GivenNormals, NormalSigns, PointCloud, PreparedGeometry, Shape, WeldMode, nearest_neighbors, triangulate,
    vertex_normals,
};
use adwave::signal::{MovedPoints, moved_cloud_normals, outward_normals};
use adwave::vector::dot;
use adwave::{Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Share of the strongest values of a map whose sign must be right.
const RIGHT: f64 = 0.99;

/// Vertices of a built-in shape with outward normals.
fn shape(name: &str, n: usize) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let Sample { points, faces } = Sample::from_name(name, Some(n)).unwrap();
    let normals = vertex_normals(&points, &triangulate(&points, &faces));
    (points, normals)
}

fn turn_over(normals: &[[f64; 3]], is_turned: impl Fn(usize) -> bool) -> Vec<[f64; 3]> {
    let turn = |(k, n): (usize, &[f64; 3])| if is_turned(k) { n.map(|c| -c) } else { *n };
    normals.iter().enumerate().map(turn).collect()
}

fn random_signs(n: usize, seed: u64) -> Vec<bool> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| random.next_u32().is_multiple_of(2)).collect()
}

fn signed_map(points: &[[f64; 3]], normals: &[[f64; 3]]) -> Vec<f64> {
    let cloud = PointCloud::new(points.to_vec()).unwrap().with_normals(normals.to_vec());
    let decomposer = Decomposer::new(&Shape::Cloud(cloud));
    let outward = decomposer.outward_normals(Some(normals.as_flattened()), Progress::none()).unwrap();
    assert!(outward.info.has_outside(), "{}", outward.info);
    let schedule = Schedule::dyadic(7).unwrap();
    let request = decomposer.request(points.as_flattened(), 3, &schedule);
    let wavelets = request.normal_components(&outward.normals).unwrap();
    saliency(&decomposer, &wavelets, &SaliencyParams::default(), Progress::none()).unwrap().map
}

#[test]
fn signs_of_saliency_do_not_depend_on_those_of_normals_that_disagree() {
    for name in ["creature", "knot", "torus"] {
        let (points, normals) = shape(name, 4000);
        let right = signed_map(&points, &normals);
        let mut sizes: Vec<f64> = right.iter().map(|v| v.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let strong = sizes[sizes.len() * 4 / 5];
        let signs = random_signs(points.len(), 3);
        // At random; to one side of a plane, as airborne scans do; by the largest component, as fits of planes do; few.
        let kinds: [(&str, &dyn Fn(usize) -> bool); 4] = [
            ("random", &|k| signs[k]),
            ("upward", &|k| normals[k][2] < 0.0),
            ("dominant", &|k| {
                let n = normals[k];
                let largest = (0..3).max_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).unwrap();
                n[largest] < 0.0
            }),
            ("few", &|k| k % 13 == 0),
        ];
        for (kind, is_turned) in kinds {
            let found = signed_map(&points, &turn_over(&normals, is_turned));
            let strongest: Vec<usize> = (0..points.len()).filter(|&k| right[k].abs() > strong).collect();
            let n_right = strongest.iter().filter(|&&k| found[k] * right[k] > 0.0).count();
            let share = n_right as f64 / strongest.len() as f64;
            assert!(share >= RIGHT, "{name}, {kind}: {share}");
        }
    }
}

fn check(points: &[[f64; 3]], normals: &[[f64; 3]]) -> GivenNormals {
    GivenNormals::new(points, &nearest_neighbors(points, 10), normals, Progress::none()).unwrap().unwrap()
}

#[test]
fn what_is_wrong_with_normals_is_said() {
    let (points, normals) = shape("sphere", 2000);
    let given = check(&points, &normals);
    assert_eq!(
        (given.check.signs, given.check.n_turned, given.check.describe()),
        (NormalSigns::AsGiven, 0, None)
    );
    let inward = check(&points, &turn_over(&normals, |_| true));
    assert_eq!((inward.check.signs, inward.check.n_inward), (NormalSigns::AsGiven, 1));
    assert!(inward.check.describe().unwrap().contains("point inward"));
    assert!(inward.normals.iter().zip(&points).all(|(n, p)| dot(n, p) < 0.0), "inward normals stay");
    let few = check(&points, &turn_over(&normals, |k| k % 20 == 0));
    assert_eq!((few.check.signs, few.check.n_turned), (NormalSigns::Repaired, 100));
    let upward = check(&points, &turn_over(&normals, |k| normals[k][2] < 0.0));
    assert_eq!(upward.check.signs, NormalSigns::Unoriented);
    assert!(upward.check.agreement > 0.9, "most neighbors agree, and half of the sphere is wrong");
    assert!(upward.check.describe().unwrap().contains("not oriented"));
    for found in [few, upward] {
        assert!(found.normals.iter().zip(&points).all(|(n, p)| dot(n, p) > 0.9));
    }
    let near = nearest_neighbors(&points, 10);
    let none = vec![[f64::NAN; 3]; points.len()];
    assert_eq!(GivenNormals::new(&points, &near, &none, Progress::none()), Ok(None));
}

#[test]
fn oriented_normals_of_any_shape_and_size_are_used_as_they_are() {
    for name in ["creature", "knot", "torus", "sphere"] {
        for n in [2000, 5000] {
            let (points, normals) = shape(name, n);
            for size in [1e-30, 1.0, 1e30] {
                let scaled: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c * size)).collect();
                let found = check(&scaled, &normals);
                assert_eq!(
                    (found.check.signs, found.check.n_inward),
                    (NormalSigns::AsGiven, 0),
                    "{name} {n}"
                );
            }
        }
    }
    // A terrain whose normals point downward is open, so that neither side is inside.
    let terrain: Vec<[f64; 3]> = (0..900)
        .map(|k| (f64::from(k % 30), f64::from(k / 30)))
        .map(|(x, y)| [x, y, (0.3 * x).sin() + (0.2 * y).cos()])
        .collect();
    let down = vec![[0.0, 0.0, -3.0]; 900];
    assert_eq!(check(&terrain, &down).check.describe(), None);
}

#[test]
fn the_outside_says_how_given_normals_were_used() {
    let (points, normals) = shape("sphere", 1000);
    let words = |normals: &[[f64; 3]]| {
        let cloud = PointCloud::new(points.clone()).unwrap().with_normals(normals.to_vec());
        let shape = Shape::Cloud(cloud);
        let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
        outward_normals(&geometry, Some(normals.as_flattened()), Progress::none()).unwrap().info.to_string()
    };
    assert_eq!(words(&normals), "outside by the file's normals");
    assert!(words(&turn_over(&normals, |_| true)).contains("point inward"));
    assert!(words(&turn_over(&normals, |k| k % 2 == 0)).contains("not oriented"));
    assert!(words(&turn_over(&normals, |k| k % 25 == 0)).contains("40 of them turned over"));
}

#[test]
fn normals_of_arbitrary_signs_follow_moved_points_as_oriented_ones_do() {
    let (points, normals) = shape("torus", 3000);
    let after: Vec<[f64; 3]> = points.iter().map(|p| [1.1 * p[0], p[1], 0.9 * p[2]]).collect();
    let moved = MovedPoints { before: &points, after: &after };
    let expected = moved_cloud_normals(&moved, &normals, Progress::none()).unwrap();
    let signs = random_signs(points.len(), 8);
    let found = moved_cloud_normals(&moved, &turn_over(&normals, |k| signs[k]), Progress::none()).unwrap();
    for (k, (a, b)) in found.iter().zip(&expected).enumerate() {
        let sign = if signs[k] { -1.0 } else { 1.0 };
        assert!(sign * dot(a, b) > 1.0 - 1e-9, "point {k}: {a:?} {b:?}");
    }
}

#[test]
fn faces_of_a_box_are_turned_to_one_side_across_its_edges() {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let mut uniform = || 2.0 * f64::from(random.next_u32()) / f64::from(u32::MAX) - 1.0;
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    for k in 0..3000 {
        let (axis, side) = (k % 3, if k % 2 == 0 { 1.0 } else { -1.0 });
        let mut point = [uniform(), uniform(), uniform()];
        let mut normal = [0.0; 3];
        (point[axis], normal[axis]) = (side, side);
        points.push(point);
        normals.push(normal);
    }
    // Plane fits turn all normals of an axis to one side.
    let fitted: Vec<[f64; 3]> = normals.iter().map(|n| n.map(f64::abs)).collect();
    let found = check(&points, &fitted);
    assert_eq!(found.check.signs, NormalSigns::Unoriented, "{:?}", found.check);
    let n_right = found.normals.iter().zip(&normals).filter(|(a, b)| dot(a, b) > 0.0).count();
    assert!(n_right as f64 >= RIGHT * points.len() as f64, "{n_right}");
    let inward = check(&points, &turn_over(&normals, |_| true));
    assert_eq!((inward.check.signs, inward.check.n_inward), (NormalSigns::AsGiven, 1));
}
