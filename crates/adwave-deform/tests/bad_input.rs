//! Bad input: a finite result or an error of one line.

use adwave::bands::Schedule;
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, Shape};
use adwave::{Decomposer, Progress};
use adwave_deform::{
    DeformError, DeformParams, DeformRegions, Deformer, HandleMotion, Transplant, base_points, transplant,
    with_base,
};

fn sphere(n: usize) -> (Vec<[f64; 3]>, Polygons) {
    let sample = Sample::from_name("sphere", Some(n)).unwrap();
    (sample.points, sample.faces)
}

fn decomposer(n: usize) -> Decomposer {
    let (points, faces) = sphere(n);
    Decomposer::new(&Shape::Mesh(Mesh::new(points, faces).unwrap()))
}

fn try_bind(decomposer: &Decomposer, fixed: &[u32], handles: &[&[u32]]) -> Result<Deformer, DeformError> {
    let handles = handles.iter().map(|h| h.to_vec()).collect();
    let regions = DeformRegions { fixed: fixed.to_vec(), handles };
    let schedule = decomposer.default_schedule().schedule;
    Deformer::bind(decomposer, &schedule, &regions, &DeformParams::default(), Progress::none())
}

fn message(result: Result<Deformer, DeformError>) -> String {
    result.err().expect("an error").to_string()
}

#[test]
fn regions_that_cannot_be_are_refused_in_one_line() {
    let sphere = decomposer(800);
    let n = sphere.n_vertices() as u32;
    assert_eq!(message(try_bind(&sphere, &[0], &[])), "a deformation needs at least one handle, got none");
    assert_eq!(
        message(try_bind(&sphere, &[0], &[&[1], &[]])),
        "handle 2 holds no vertex that takes part in the analysis; enlarge it"
    );
    assert!(
        message(try_bind(&sphere, &[0], &[&[n]])).starts_with(&format!("handle 1 names vertex {n}, but"))
    );
    assert!(
        message(try_bind(&sphere, &[3, 4], &[&[4]])).starts_with("vertex 4 (or one at the same position) is")
    );
    let mut bound = try_bind(&sphere, &[0], &[&[1]]).unwrap();
    let motion = HandleMotion::default();
    assert_eq!(
        bound.set(2, motion).unwrap_err().to_string(),
        "handle 2 does not exist; there are 1, counted from 1"
    );
    assert!(HandleMotion::from_turn([0.0; 3], 1.0, [0.0; 3]).is_err());
    assert!(HandleMotion::new([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).is_err());
    assert!(HandleMotion::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, f64::NAN]], [0.0; 3]).is_err());
    assert!(bound.set(1, HandleMotion::from_translation([f64::NAN; 3])).is_err());
    let schedule = Schedule::dyadic(3).unwrap();
    let regions = DeformRegions { fixed: vec![0], handles: vec![vec![1]] };
    let params = DeformParams::default().with_stiffness(Some(-1.0));
    assert!(Deformer::bind(&sphere, &schedule, &regions, &params, Progress::none()).is_err());
}

#[test]
fn copies_of_a_vertex_belong_to_one_region() {
    // Two triangles that share an edge by equal positions.
    let points = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ];
    let faces = Polygons::from_triangles(&[[0, 1, 2], [3, 5, 4]]);
    let sheet = Decomposer::new(&Shape::Mesh(Mesh::new(points, faces).unwrap()));
    assert!(message(try_bind(&sheet, &[1], &[&[3]])).contains("is in the fixed part and in handle 1"));
}

#[test]
fn shapes_that_are_hardly_any_stay_finite() {
    let tetrahedron = Mesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        Polygons::from_triangles(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
    );
    let line: Vec<[f64; 3]> = (0..40).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    let shapes = [
        Shape::Mesh(tetrahedron.unwrap()),
        Shape::Cloud(PointCloud::new(line).unwrap()),
        Shape::Cloud(PointCloud::new(vec![[1.0; 3]; 5]).unwrap()),
    ];
    for shape in &shapes {
        let decomposer = Decomposer::new(shape);
        let last = decomposer.n_vertices() as u32 - 1;
        let Ok(mut bound) = try_bind(&decomposer, &[0], &[&[last]]) else { continue };
        for by in [0.5, 1e3] {
            bound.set(1, HandleMotion::from_translation([0.0, by, 0.0])).unwrap();
            bound.solve(Progress::none()).unwrap();
            assert!(bound.points().iter().flatten().all(|c| c.is_finite()), "{}", decomposer.n_vertices());
        }
    }
}

#[test]
fn targets_a_hundred_diagonals_away_stay_finite_and_exact() {
    let sphere = decomposer(2000);
    let mut bound = try_bind(&sphere, &[0, 1, 2], &[&[1900, 1901, 1902]]).unwrap();
    bound.set(1, HandleMotion::from_translation([0.0, 0.0, 100.0 * sphere.diagonal()])).unwrap();
    bound.solve(Progress::none()).unwrap();
    let points = bound.points();
    assert!(points.iter().flatten().all(|c| c.is_finite()));
    let rest = sphere.points().unwrap();
    assert!((points[1900][2] - rest[1900][2] - 100.0 * sphere.diagonal()).abs() < 1e-9);
}

#[test]
fn strays_keep_their_place_unless_they_are_moved() {
    let (mut points, faces) = sphere(1500);
    points.push([5.0, 5.0, 5.0]);
    points.push([6.0, 5.0, 5.0]);
    let n = points.len() as u32;
    let shape = Decomposer::new(&Shape::Mesh(Mesh::new(points.clone(), faces).unwrap()));
    assert!(
        message(try_bind(&shape, &[0], &[&[n - 1]])).starts_with("handle 1 holds no vertex that takes part")
    );
    let mut bound = try_bind(&shape, &[0, 1], &[&[1000, 1001, n - 1]]).unwrap();
    bound.set(1, HandleMotion::from_translation([0.0, 0.0, 0.3])).unwrap();
    bound.solve(Progress::none()).unwrap();
    let after = bound.points();
    assert_eq!(after[n as usize - 2], points[n as usize - 2]);
    assert!((after[n as usize - 1][2] - 5.3).abs() < 1e-12);
}

#[test]
fn graphs_without_positions_are_refused() {
    let graph = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)]).unwrap());
    let decomposer = Decomposer::new(&graph);
    let regions = DeformRegions { fixed: vec![0], handles: vec![vec![2]] };
    let schedule = Schedule::dyadic(2).unwrap();
    let result = Deformer::bind(&decomposer, &schedule, &regions, &DeformParams::default(), Progress::none());
    assert!(message(result).starts_with("a deformation needs positions"));
}

#[test]
fn bases_that_are_no_edited_copy_are_refused() {
    let sphere = decomposer(2000);
    let schedule = Schedule::dyadic(5).unwrap();
    let base = base_points(&sphere, &schedule, Progress::none()).unwrap();
    let refused = |base: &[[f64; 3]]| {
        with_base(&sphere, &schedule, base, Progress::none()).expect_err("an error").to_string()
    };
    assert!(refused(&base[1..]).starts_with("the base must have the"));
    assert_eq!(refused(&vec![[1.0; 3]; base.len()]), DeformError::CollapsedBase.to_string());
    let mut shuffled = base.clone();
    let n = shuffled.len();
    for v in 0..n {
        shuffled[v] = base[(v * 7 + 3) % n];
    }
    assert!(refused(&shuffled).contains("in another order"));
    let mut broken = base.clone();
    broken[17][1] = f64::NAN;
    assert_eq!(refused(&broken), "coordinates of the base must be finite; vertex 17 has NaN");
    let mirrored: Vec<[f64; 3]> = base.iter().map(|p| [-p[0], p[1], p[2]]).collect();
    assert!(refused(&mirrored).starts_with("the base is mirrored"));
}

#[test]
fn clones_onto_a_tip_stay_finite_and_bad_ones_are_refused() {
    let (mut points, faces) = sphere(4000);
    for p in &mut points {
        if p[2] > 0.8 {
            p[2] += 8.0 * (p[2] - 0.8);
        }
    }
    let tip = (0..points.len()).max_by(|&a, &b| points[a][2].total_cmp(&points[b][2])).unwrap() as u32;
    let shape = Decomposer::new(&Shape::Mesh(Mesh::new(points, faces).unwrap()));
    let schedule = Schedule::dyadic(4).unwrap();
    let clone = Transplant { source: 0, target: tip, radius: 0.5, angle: 0.3, levels: 1..=4 };
    let result = transplant(&shape, &schedule, &clone, Progress::none()).unwrap();
    assert!(result.points.iter().flatten().all(|c| c.is_finite()));
    assert!(result.distortion >= 1.0);
    for bad in [
        Transplant { radius: 0.0, ..clone.clone() },
        Transplant { radius: f64::NAN, ..clone.clone() },
        Transplant { levels: 0..=2, ..clone.clone() },
        Transplant { levels: 2..=5, ..clone.clone() },
        Transplant { target: 1 << 30, ..clone.clone() },
        Transplant { angle: f64::INFINITY, ..clone },
    ] {
        assert!(transplant(&shape, &schedule, &bad, Progress::none()).is_err(), "{bad:?}");
    }
}
