//! Laws of deformation that keeps lengths, of crossings, of blended motions and of symmetric shapes.

use adwave::bands::Schedule;
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape};
use adwave::vector::{norm, subtract};
use adwave::{Decomposer, Progress};
use adwave_deform::{
    DeformError, DeformParams, DeformRegions, Deformer, HandleMotion, default_base, new_crossings,
};
use std::f64::consts::TAU;

/// Rounding relative to the size, over a few hundred operations.
const ROUNDING: f64 = 1e-12;

/// Rounding of the nodes, grown by some tens of steps along which the surface may buckle in several ways.
const GROWN_ROUNDING: f64 = 1e-7;

type Points = Vec<[f64; 3]>;

/// A tube along z of radius 0.2 and length 2 without ends, with `n` vertices around.
fn tube(n: usize) -> (Points, Polygons) {
    let rows = n * 8 / 5;
    let at = |i: usize, k: usize| {
        let angle = TAU * (k as f64 + 0.5 * (i % 2) as f64) / n as f64;
        [0.2 * angle.cos(), 0.2 * angle.sin(), 2.0 * i as f64 / (rows - 1) as f64]
    };
    let points = (0..rows).flat_map(|i| (0..n).map(move |k| at(i, k))).collect();
    let number = |i: usize, k: usize| (i * n + k % n) as u32;
    let mut faces = Vec::new();
    for i in 0..rows - 1 {
        for k in 0..n {
            let (a, b, c, d) = (number(i, k), number(i, k + 1), number(i + 1, k), number(i + 1, k + 1));
            let pair = if i % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] };
            faces.extend(pair);
        }
    }
    (points, Polygons::from_triangles(&faces))
}

/// Ends of a tube as regions.
fn ends(points: &Points) -> DeformRegions {
    let those =
        |is: &dyn Fn(f64) -> bool| (0..).zip(points).filter(|(_, p)| is(p[2])).map(|(v, _)| v).collect();
    DeformRegions { fixed: those(&|z| z < 0.3), handles: vec![those(&|z| z > 1.7)] }
}

fn bent(decomposer: &Decomposer, regions: &DeformRegions, lengths: f64, motion: HandleMotion) -> Deformer {
    let params = DeformParams::default().with_keep_lengths(lengths);
    let schedule = default_base(decomposer);
    let mut deformer = Deformer::bind(decomposer, &schedule, regions, &params, Progress::none()).unwrap();
    deformer.set(1, motion).unwrap();
    deformer.solve(Progress::none()).unwrap();
    deformer
}

/// Root of the mean square of the relative change of the lengths between neighbors.
fn stretch(decomposer: &Decomposer, after: &[[f64; 3]]) -> f64 {
    let (before, after) = (decomposer.positions(), decomposer.vertex_map().positions(after));
    let (mut sum, mut count) = (0.0, 0.0);
    for x in 0..before.len() {
        for &y in decomposer.neighbors().row(x) {
            let length = |p: &[[f64; 3]]| norm(&subtract(&p[x], &p[y as usize]));
            let change = length(&after) / length(before) - 1.0;
            (sum, count) = (sum + change * change, count + 1.0);
        }
    }
    (sum / count).sqrt()
}

fn quarter_turn() -> HandleMotion {
    HandleMotion::from_turn([1.0, 0.0, 0.0], 1.4, [0.0, 0.4, 1.0]).unwrap()
}

#[test]
fn a_larger_share_stretches_less_and_regions_stay_exact() {
    let (points, faces) = tube(30);
    let regions = ends(&points);
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(points.clone(), faces).unwrap()));
    let mut last = f64::INFINITY;
    let mut found = Vec::new();
    for share in [0.0, 0.3, 0.8, 1.0] {
        let after = bent(&decomposer, &regions, share, quarter_turn()).points();
        let strain = stretch(&decomposer, &after);
        assert!(strain < last, "share {share}: {strain} after {last}");
        last = strain;
        found.push(strain);
        for &v in &regions.fixed {
            assert_eq!(after[v as usize], points[v as usize]);
        }
        for &v in &regions.handles[0] {
            let wanted = quarter_turn().apply(&points[v as usize]);
            assert!(norm(&subtract(&after[v as usize], &wanted)) < ROUNDING);
        }
        assert_eq!(new_crossings(&decomposer, &after, Progress::none()).unwrap().n_pairs, 0);
    }
    assert!(found[3] < 0.5 * found[0], "{found:?}");
}

#[test]
fn rigid_motions_keep_everything_and_no_motion_keeps_the_bits() {
    let (points, faces) = tube(20);
    let ends = ends(&points);
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(points.clone(), faces).unwrap()));
    assert_eq!(bent(&decomposer, &ends, 1.0, HandleMotion::default()).points(), points);
    let regions = DeformRegions { fixed: Vec::new(), handles: vec![ends.fixed, ends.handles[0].clone()] };
    let mut deformer = bent(&decomposer, &regions, 1.0, quarter_turn());
    deformer.set(2, quarter_turn()).unwrap();
    deformer.solve(Progress::none()).unwrap();
    for (p, q) in points.iter().zip(deformer.points()) {
        assert!(norm(&subtract(&quarter_turn().apply(p), &q)) < ROUNDING);
    }
}

#[test]
fn repeated_solves_and_any_number_of_threads_give_the_same_bits_and_scaled_shapes_the_same() {
    let (points, faces) = tube(20);
    let regions = ends(&points);
    let solve = |scale: f64| {
        let scaled: Points = points.iter().map(|p| p.map(|c| scale * c)).collect();
        let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(scaled, faces.clone()).unwrap()));
        let turn = quarter_turn();
        let motion = HandleMotion::new(*turn.linear(), turn.translation().map(|c| scale * c)).unwrap();
        let mut deformer = bent(&decomposer, &regions, 1.0, motion);
        let once = deformer.points();
        deformer.reset();
        deformer.set(1, motion).unwrap();
        deformer.solve(Progress::none()).unwrap();
        assert_eq!(deformer.points(), once);
        once
    };
    let one = solve(1.0);
    for (p, q) in one.iter().zip(solve(4.0)) {
        let apart = norm(&subtract(p, &q.map(|c| c / 4.0)));
        assert!(apart < GROWN_ROUNDING, "{apart}");
    }
    for n in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        assert_eq!(pool.install(|| solve(1.0)), one, "{n} threads");
    }
}

#[test]
fn clouds_keep_lengths_too() {
    let (points, _) = tube(30);
    let regions = ends(&points);
    let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points).unwrap()));
    let detail = bent(&decomposer, &regions, 0.0, quarter_turn()).points();
    let lengths = bent(&decomposer, &regions, 1.0, quarter_turn()).points();
    let (a, b) = (stretch(&decomposer, &detail), stretch(&decomposer, &lengths));
    assert!(b < 0.6 * a, "{a} {b}");
}

#[test]
fn values_of_an_edit_ride_along_with_kept_lengths() {
    let (points, faces) = tube(20);
    let regions = ends(&points);
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(points.clone(), faces).unwrap()));
    let deformer = bent(&decomposer, &regions, 1.0, quarter_turn());
    let (after, turns) = (deformer.points(), deformer.rotations());
    let mut moved = points.clone();
    let v = points.len() / 2;
    moved[v][0] += 0.01;
    let mut carried = points.clone();
    deformer.carried_into(&moved, &mut carried);
    let length = norm(&subtract(&carried[v], &after[v]));
    assert!((length - 0.01).abs() < ROUNDING && turns[v] != [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(carried[v + 1], after[v + 1]);
}

#[test]
fn only_crossings_that_the_shape_did_not_have_count() {
    // Two sheets that cross, and a third that is moved through both.
    let sheet = |z: f64, tilt: f64| -> Points {
        let at = |i: usize| [(i % 5) as f64, (i / 5) as f64, z + tilt * ((i % 5) as f64 - 1.7)];
        (0..25).map(at).collect()
    };
    let points: Points = [sheet(0.0, 0.0), sheet(0.0, 0.3), sheet(5.0, 0.1)].concat();
    let mut triangles = Vec::new();
    for s in 0..3_u32 {
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let a = 25 * s + 5 * i + j;
            triangles.extend([[a, a + 1, a + 5], [a + 1, a + 6, a + 5]]);
        }
    }
    let mesh = Mesh::new(points.clone(), Polygons::from_triangles(&triangles)).unwrap();
    let decomposer = Decomposer::new(&Shape::Mesh(mesh));
    let find = |points: &Points| new_crossings(&decomposer, points, Progress::none()).unwrap();
    assert_eq!(find(&points).n_pairs, 0);
    let mut moved = points;
    for p in &mut moved[50..] {
        *p = [p[0] + 0.3, p[1] + 0.2, p[2] - 4.95];
    }
    let found = find(&moved);
    assert!(found.n_pairs > 0 && !found.places.is_empty(), "{found:?}");
    assert_eq!(found.places.iter().map(|place| place.n_pairs).sum::<usize>(), found.n_pairs);
    assert!(found.places.windows(2).all(|pair| pair[0].n_pairs >= pair[1].n_pairs));
    let place = found.places[0];
    let apart = norm(&subtract(&place.point, &moved[place.vertex as usize]));
    assert!(apart < 6.0 && place.point.iter().all(|c| c.is_finite()));
}

#[test]
fn a_symmetric_shape_bends_symmetrically() {
    // A box mirrored in x, whose ends along z are handles that move by mirrored motions.
    let sample = Sample::from_name("sphere", Some(1200)).unwrap();
    let half: Vec<usize> = (0..sample.points.len()).filter(|&v| sample.points[v][0] > 0.05).collect();
    let mut points: Points = half.iter().map(|&v| sample.points[v]).collect();
    points.extend(half.iter().map(|&v| [-sample.points[v][0], sample.points[v][1], sample.points[v][2]]));
    let n = half.len();
    let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone()).unwrap()));
    let those = |sign: f64| (0..).zip(&points).filter(|(_, p)| sign * p[2] > 0.7).map(|(v, _)| v).collect();
    let regions = DeformRegions { fixed: those(-1.0), handles: vec![those(1.0)] };
    let schedule = Schedule::dyadic(5).unwrap();
    let params = DeformParams::default();
    let mut deformer = Deformer::bind(&decomposer, &schedule, &regions, &params, Progress::none()).unwrap();
    deformer.set(1, HandleMotion::from_turn([1.0, 0.0, 0.0], 0.9, [0.0, 0.0, 0.3]).unwrap()).unwrap();
    deformer.solve(Progress::none()).unwrap();
    let after = deformer.points();
    let mut worst = 0.0_f64;
    for v in 0..n {
        let mirrored = [-after[n + v][0], after[n + v][1], after[n + v][2]];
        worst = worst.max(norm(&subtract(&after[v], &mirrored)));
    }
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn bad_shares_of_lengths_are_refused() {
    let (points, faces) = tube(20);
    let regions = ends(&points);
    let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(points, faces).unwrap()));
    for share in [-0.1, 1.5, f64::NAN] {
        let params = DeformParams::default().with_keep_lengths(share);
        let bound =
            Deformer::bind(&decomposer, &default_base(&decomposer), &regions, &params, Progress::none());
        assert!(matches!(bound, Err(DeformError::BadLengths(_))));
    }
}
