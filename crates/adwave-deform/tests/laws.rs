//! Laws of deformation and of detail on other bases.

use adwave::bands::Schedule;
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape};
use adwave::vector::{norm, subtract};
use adwave::{Decomposer, Progress};
use adwave_deform::{
    DeformParams, DeformRegions, Deformer, HandleMotion, Transplant, base_points, morph, transfer,
    transfer_decomposer, transplant, with_base,
};

/// Rounding relative to the size, over a few hundred operations.
const ROUNDING: f64 = 1e-12;

type Points = Vec<[f64; 3]>;

fn mesh(points: Points, faces: Polygons) -> Shape {
    Shape::Mesh(Mesh::new(points, faces).unwrap())
}

/// A bumpy sphere with its lower cap held and its upper cap as the handle.
fn bound_sphere() -> (Decomposer, Schedule, DeformRegions) {
    let sample = Sample::from_name("sphere", Some(3000)).unwrap();
    let bumpy = sample.points.iter().map(|p| {
        let s = 1.0 + 0.02 * ((9.0 * p[0]).sin() * (8.0 * p[1]).sin());
        p.map(|c| s * c)
    });
    let points: Points = bumpy.collect();
    let those = |sign: f64| (0..).zip(&points).filter(|(_, p)| sign * p[2] > 0.75).map(|(v, _)| v).collect();
    let regions = DeformRegions { fixed: those(-1.0), handles: vec![those(1.0)] };
    let decomposer = Decomposer::new(&mesh(points, sample.faces));
    (decomposer, Schedule::dyadic(6).unwrap(), regions)
}

fn bind(decomposer: &Decomposer, schedule: &Schedule, regions: &DeformRegions) -> Deformer {
    Deformer::bind(decomposer, schedule, regions, &DeformParams::default(), Progress::none()).unwrap()
}

fn points(decomposer: &Decomposer) -> &[[f64; 3]] {
    decomposer.points().unwrap()
}

fn bend() -> HandleMotion {
    HandleMotion::from_turn([1.0, 0.3, 0.0], 1.2, [0.0, 0.4, 0.2]).unwrap()
}

#[test]
fn no_motion_gives_the_same_bits() {
    let (decomposer, schedule, regions) = bound_sphere();
    let mut deformer = bind(&decomposer, &schedule, &regions);
    assert_eq!(deformer.points(), points(&decomposer));
    deformer.set(1, bend()).unwrap();
    deformer.solve(Progress::none()).unwrap();
    assert_ne!(deformer.points(), points(&decomposer));
    deformer.set(1, HandleMotion::default()).unwrap();
    deformer.step(Progress::none()).unwrap();
    assert_eq!(deformer.points(), points(&decomposer));
    assert_eq!(deformer.rotations()[5], [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn handles_follow_their_motions_and_the_fixed_part_keeps_its_bits() {
    let (decomposer, schedule, regions) = bound_sphere();
    let mut deformer = bind(&decomposer, &schedule, &regions);
    deformer.set(1, bend()).unwrap();
    let info = deformer.solve(Progress::none()).unwrap();
    assert!(info.is_converged && info.energy_after < info.energy_before, "{info:?}");
    let (before, after) = (points(&decomposer), deformer.points());
    for &v in &regions.handles[0] {
        let wanted = bend().apply(&before[v as usize]);
        assert!(norm(&subtract(&after[v as usize], &wanted)) < ROUNDING);
    }
    for &v in &regions.fixed {
        assert_eq!(after[v as usize], before[v as usize]);
    }
    assert!(after.iter().flatten().all(|c| c.is_finite()));
}

#[test]
fn a_motion_of_all_handles_moves_the_shape_rigidly() {
    let (decomposer, schedule, regions) = bound_sphere();
    let regions =
        DeformRegions { fixed: Vec::new(), handles: vec![regions.fixed, regions.handles[0].clone()] };
    let mut deformer = bind(&decomposer, &schedule, &regions);
    assert!(deformer.info().is_free);
    deformer.set(1, bend()).unwrap();
    deformer.set(2, bend()).unwrap();
    deformer.solve(Progress::none()).unwrap();
    for (p, q) in points(&decomposer).iter().zip(deformer.points()) {
        assert!(norm(&subtract(&bend().apply(p), &q)) < ROUNDING);
    }
    // A single free handle takes the shape along.
    let regions = DeformRegions { fixed: Vec::new(), handles: vec![regions.handles[1].clone()] };
    let mut deformer = bind(&decomposer, &schedule, &regions);
    deformer.set(1, bend()).unwrap();
    deformer.step(Progress::none()).unwrap();
    for (p, q) in points(&decomposer).iter().zip(deformer.points()) {
        assert!(norm(&subtract(&bend().apply(p), &q)) < ROUNDING);
    }
}

#[test]
fn a_turn_of_everything_turns_the_result() {
    // The motions of handles g·T on the shape g·f: the result is g·f′ up to rounding and the order along the curve.
    let (decomposer, schedule, regions) = bound_sphere();
    let free = DeformRegions { fixed: Vec::new(), handles: vec![regions.fixed, regions.handles[0].clone()] };
    let shift = HandleMotion::from_translation([0.0, 0.0, 0.4]);
    let result = |common: &HandleMotion| {
        let mut deformer = bind(&decomposer, &schedule, &free);
        let moved = |motion: &HandleMotion| {
            let l = [0, 1, 2].map(|i| {
                [0, 1, 2].map(|j| (0..3).map(|k| common.linear()[i][k] * motion.linear()[k][j]).sum::<f64>())
            });
            HandleMotion::new(l, common.apply(motion.translation())).unwrap()
        };
        deformer.set(1, moved(&HandleMotion::default())).unwrap();
        deformer.set(2, moved(&shift)).unwrap();
        deformer.solve(Progress::none()).unwrap();
        deformer.points()
    };
    let (plain, turned) = (result(&HandleMotion::default()), result(&bend()));
    // Two solves end within the square root of their relative decrease of each other.
    for (p, q) in plain.iter().zip(&turned) {
        assert!(norm(&subtract(&bend().apply(p), q)) < 1e-3);
    }
}

#[test]
fn scaling_changes_nothing_and_the_number_of_threads_no_bit() {
    let (decomposer, schedule, regions) = bound_sphere();
    let result = |decomposer: &Decomposer, scale: f64| {
        let mut deformer = bind(decomposer, &schedule, &regions);
        let t = bend();
        deformer.set(1, HandleMotion::new(*t.linear(), t.translation().map(|c| scale * c)).unwrap()).unwrap();
        deformer.solve(Progress::none()).unwrap();
        deformer.points()
    };
    let plain = result(&decomposer, 1.0);
    let Shape::Mesh(shape) = decomposer.geometry().unwrap().shape() else { unreachable!() };
    for scale in [0.5_f64.powi(40), 2.0_f64.powi(30)] {
        let scaled = shape.points().iter().map(|p| p.map(|c| scale * c)).collect();
        let scaled = Decomposer::new(&mesh(scaled, shape.faces().clone()));
        let base = base_points(&decomposer, &schedule, Progress::none()).unwrap();
        let own = base_points(&scaled, &schedule, Progress::none()).unwrap();
        assert_eq!(
            own,
            base.iter().map(|p| p.map(|c| scale * c)).collect::<Points>(),
            "base scaled by {scale}"
        );
        let wanted: Points = plain.iter().map(|p| p.map(|c| scale * c)).collect();
        for (p, q) in result(&scaled, scale).iter().zip(&wanted) {
            assert!(norm(&subtract(p, q)) < ROUNDING * scale, "scaled by {scale}");
        }
    }
    for n in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        assert_eq!(pool.install(|| result(&decomposer, 1.0)), plain, "{n} threads");
    }
}

#[test]
fn the_order_of_vertices_changes_nothing() {
    let (decomposer, schedule, regions) = bound_sphere();
    let Shape::Mesh(shape) = decomposer.geometry().unwrap().shape() else { unreachable!() };
    let n = shape.points().len() as u32;
    // A permutation, as 7 and n have no common divisor.
    assert_ne!(n % 7, 0);
    let place = |v: u32| (7 * v + 3) % n;
    let mut shuffled = vec![[0.0; 3]; n as usize];
    for v in 0..n {
        shuffled[place(v) as usize] = shape.points()[v as usize];
    }
    let mut faces: Vec<[u32; 3]> = shape.faces().triangles().unwrap().iter().map(|t| t.map(place)).collect();
    faces.reverse();
    let other = Decomposer::new(&mesh(shuffled, Polygons::from_triangles(&faces)));
    let moved = |vertices: &[u32]| vertices.iter().rev().map(|&v| place(v)).collect::<Vec<u32>>();
    let others = DeformRegions { fixed: moved(&regions.fixed), handles: vec![moved(&regions.handles[0])] };
    let result = |decomposer: &Decomposer, regions: &DeformRegions| {
        let mut deformer = bind(decomposer, &schedule, regions);
        deformer.set(1, bend()).unwrap();
        deformer.solve(Progress::none()).unwrap();
        deformer.points()
    };
    let (one, two) = (result(&decomposer, &regions), result(&other, &others));
    for v in 0..n {
        // Areas add up in the order of the faces.
        assert!(norm(&subtract(&one[v as usize], &two[place(v) as usize])) < ROUNDING);
    }
}

#[test]
fn each_step_lowers_the_energy_and_dragging_ends_where_solving_does() {
    let (decomposer, schedule, regions) = bound_sphere();
    let mut dragged = bind(&decomposer, &schedule, &regions);
    let mut last = f64::INFINITY;
    for k in 1..=30 {
        let t = f64::from(k) / 20.0;
        if t <= 1.0 {
            dragged
                .set(1, HandleMotion::from_turn([1.0, 0.3, 0.0], 1.2 * t, [0.0, 0.4, 0.2]).unwrap())
                .unwrap();
        }
        let info = dragged.step(Progress::none()).unwrap();
        assert!(info.energy_after <= info.energy_before * (1.0 + ROUNDING), "{info:?}");
        if t > 1.0 {
            assert!(info.energy_after <= last * (1.0 + ROUNDING));
        }
        last = info.energy_after;
    }
    let mut solved = bind(&decomposer, &schedule, &regions);
    solved.set(1, bend()).unwrap();
    solved.solve(Progress::none()).unwrap();
    let gap =
        dragged.points().iter().zip(solved.points()).map(|(p, q)| norm(&subtract(p, &q))).fold(0.0, f64::max);
    assert!(gap < 0.01 * decomposer.diagonal(), "{gap}");
}

#[test]
fn single_points_turn_freely_and_are_reached() {
    let (decomposer, schedule, regions) = bound_sphere();
    let top = regions.handles[0][0];
    let regions = DeformRegions { fixed: regions.fixed, handles: vec![vec![top]] };
    let mut deformer = bind(&decomposer, &schedule, &regions);
    deformer.set(1, HandleMotion::from_translation([0.8, 0.0, 0.1])).unwrap();
    deformer.solve(Progress::none()).unwrap();
    let (before, after) = (points(&decomposer)[top as usize], deformer.points()[top as usize]);
    assert!((after[0] - before[0] - 0.8).abs() < ROUNDING);
    let turn = deformer.rotations()[top as usize];
    assert!(turn[0].abs() < 0.999, "pulled sideways it turns: {turn:?}");
    // No spike at the point: its neighbors have moved as far, nearly.
    let x = decomposer.vertex_map().welded(top as usize);
    let map = decomposer.vertex_map().as_slice();
    for &y in decomposer.neighbors().row(x) {
        let v = map.iter().position(|&w| w == y).unwrap();
        let moved = subtract(&deformer.points()[v], &points(&decomposer)[v]);
        assert!((moved[0] - 0.8).abs() < 0.1, "{moved:?}");
    }
}

#[test]
fn detail_edited_meanwhile_is_carried_along() {
    let (decomposer, schedule, regions) = bound_sphere();
    let mut deformer = bind(&decomposer, &schedule, &regions);
    deformer.set(1, bend()).unwrap();
    deformer.solve(Progress::none()).unwrap();
    let rest = points(&decomposer);
    let base = base_points(&decomposer, &schedule, Progress::none()).unwrap();
    let (mut smooth, mut plain, mut double) = (vec![[0.0; 3]; rest.len()], rest.to_vec(), rest.to_vec());
    deformer.carried_into(&base, &mut smooth);
    deformer.carried_into(rest, &mut plain);
    let doubled: Points = rest.iter().zip(&base).map(|(p, s)| [0, 1, 2].map(|c| 2.0 * p[c] - s[c])).collect();
    deformer.carried_into(&doubled, &mut double);
    for ((s, p), d) in smooth.iter().zip(&plain).zip(&double) {
        assert!((0..3).all(|c| (d[c] - p[c] - (p[c] - s[c])).abs() < ROUNDING));
    }
}

#[test]
fn the_own_base_gives_the_shape_and_a_moved_base_the_moved_shape() {
    let (decomposer, schedule, _) = bound_sphere();
    let base = base_points(&decomposer, &schedule, Progress::none()).unwrap();
    let same = with_base(&decomposer, &schedule, &base, Progress::none()).unwrap();
    assert_eq!(same, points(&decomposer));
    let moved: Points = base.iter().map(|p| bend().apply(p)).collect();
    let moved = with_base(&decomposer, &schedule, &moved, Progress::none()).unwrap();
    for (p, q) in points(&decomposer).iter().zip(&moved) {
        assert!(norm(&subtract(&bend().apply(p), q)) < ROUNDING);
    }
}

#[test]
fn bumps_on_a_bent_strip_keep_their_height() {
    // A flat strip with bumps, and its flat base bent on a cylinder of radius ρ: an exact answer exists.
    let (nx, ny, rho, height) = (121_u32, 31_u32, 4.0, 0.05);
    let flat = |i: u32, j: u32| [f64::from(i) * 0.1 - 6.0, f64::from(j) * 0.1, 0.0];
    let bump = |p: &[f64; 3]| height * ((7.0 * p[0]).sin() * (6.0 * p[1]).sin());
    let grid: Points = (0..nx * ny).map(|k| flat(k % nx, k / nx)).collect();
    let points: Points = grid.iter().map(|p| [p[0], p[1], bump(p)]).collect();
    let mut faces = Vec::new();
    for j in 0..ny - 1 {
        for i in 0..nx - 1 {
            let a = j * nx + i;
            faces.push([a, a + 1, a + nx + 1]);
            faces.push([a, a + nx + 1, a + nx]);
        }
    }
    let decomposer = Decomposer::new(&mesh(points.clone(), Polygons::from_triangles(&faces)));
    let schedule = Schedule::dyadic(7).unwrap();
    let onto = |p: &[f64; 3], h: f64| {
        let angle = p[0] / rho;
        [(rho + h) * angle.sin(), p[1], (rho + h) * angle.cos()]
    };
    let base = base_points(&decomposer, &schedule, Progress::none()).unwrap();
    let bent: Points = base.iter().map(|p| onto(p, p[2])).collect();
    let result = with_base(&decomposer, &schedule, &bent, Progress::none()).unwrap();
    let mut worst = 0.0_f64;
    for (p, q) in points.iter().zip(&result) {
        if p[0].abs() < 4.0 && p[1] > 0.5 && p[1] < 2.5 {
            worst = worst.max(norm(&subtract(q, &onto(p, p[2]))));
        }
    }
    assert!(worst < 2.0 * height * height / rho + 2e-3 * height, "{worst} of {height}");
}

#[test]
fn clouds_bend_too() {
    let sample = Sample::from_name("sphere", Some(2000)).unwrap();
    let those =
        |sign: f64| (0..).zip(&sample.points).filter(|(_, p)| sign * p[2] > 0.75).map(|(v, _)| v).collect();
    let regions = DeformRegions { fixed: those(-1.0), handles: vec![those(1.0)] };
    let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(sample.points.clone()).unwrap()));
    let mut deformer = bind(&decomposer, &Schedule::dyadic(6).unwrap(), &regions);
    let nod = HandleMotion::from_turn([1.0, 0.3, 0.0], 0.4, [0.0, 0.0, 0.0]).unwrap();
    deformer.set(1, nod).unwrap();
    deformer.solve(Progress::none()).unwrap();
    let after = deformer.points();
    for &v in &regions.handles[0] {
        assert!(norm(&subtract(&after[v as usize], &nod.apply(&sample.points[v as usize]))) < ROUNDING);
    }
    // Neighbors stay neighbors: no edge of the cloud's graph is torn.
    let map = decomposer.vertex_map();
    let (welded, rest) = (map.positions(&after), decomposer.positions());
    for x in 0..rest.len() {
        for &y in decomposer.neighbors().row(x) {
            let length = |p: &[[f64; 3]]| norm(&subtract(&p[x], &p[y as usize]));
            assert!(length(&welded) < 2.5 * length(rest));
        }
    }
}

#[test]
fn parts_without_a_handle_follow_the_nearest() {
    let sample = Sample::from_name("sphere", Some(1500)).unwrap();
    let n = sample.points.len() as u32;
    let mut all = sample.points.clone();
    all.extend(sample.points.iter().map(|p| [0.2 * p[0], 0.2 * p[1], 0.2 * p[2] + 1.5]));
    let triangles = sample.faces.triangles().unwrap();
    let faces: Vec<[u32; 3]> =
        triangles.iter().copied().chain(triangles.iter().map(|t| t.map(|c| c + n))).collect();
    let those = |sign: f64| {
        (0..n).zip(&all).filter(|(_, p)| sign * p[2] > 0.75).map(|(v, _)| v).collect::<Vec<u32>>()
    };
    let regions = DeformRegions { fixed: those(-1.0), handles: vec![those(1.0)] };
    let decomposer = Decomposer::new(&mesh(all.clone(), Polygons::from_triangles(&faces)));
    let mut deformer = bind(&decomposer, &Schedule::dyadic(5).unwrap(), &regions);
    assert_eq!((deformer.info().n_following_parts, deformer.info().n_following_vertices), (1, n as usize));
    deformer.set(1, bend()).unwrap();
    deformer.solve(Progress::none()).unwrap();
    // The small sphere sits over the handle, and so it makes the handle's motion.
    for (p, q) in all.iter().zip(deformer.points()).skip(n as usize) {
        assert!(norm(&subtract(&bend().apply(p), &q)) < 1e-9);
    }
}

#[test]
fn a_morph_begins_at_one_shape_and_ends_at_the_other() {
    let (a, schedule, regions) = bound_sphere();
    let mut deformer = bind(&a, &schedule, &regions);
    deformer.set(1, bend()).unwrap();
    deformer.solve(Progress::none()).unwrap();
    let Shape::Mesh(shape) = a.geometry().unwrap().shape() else { unreachable!() };
    let b = Decomposer::new(&mesh(deformer.points(), shape.faces().clone()));
    for (t, wanted) in [(0.0, points(&a)), (1.0, points(&b))] {
        let found = morph(&a, &b, &schedule, &[t; 7], Progress::none()).unwrap();
        for (p, q) in found.iter().zip(wanted) {
            assert!(norm(&subtract(p, q)) < ROUNDING);
        }
    }
    let base_only = morph(&a, &b, &schedule, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], Progress::none()).unwrap();
    assert!(base_only.iter().flatten().all(|c| c.is_finite()));
    let error = morph(&a, &b, &schedule, &[0.5], Progress::none()).unwrap_err().to_string();
    assert_eq!(error, "a morph needs 7 shares, one per band and one for the base, got 1");
}

#[test]
fn a_transfer_onto_the_same_mesh_is_the_shape() {
    let (decomposer, _, _) = bound_sphere();
    let own = transfer_decomposer(decomposer.geometry().unwrap().shape(), Progress::none()).unwrap();
    let found = transfer(&own, &own, Some(0.1), None, Progress::none()).unwrap();
    for (p, q) in points(&own).iter().zip(&found.points) {
        assert!(norm(&subtract(p, q)) < 1e-9);
    }
    assert_eq!(found.n_far, 0);
    let none = transfer(&own, &own, Some(0.1), Some(&vec![0.0; own.n_vertices()]), Progress::none()).unwrap();
    assert_eq!(none.points, points(&own));
}

#[test]
fn a_clone_onto_its_own_place_changes_nothing_and_elsewhere_carries_the_detail() {
    // A plane with one bump; the bump is cloned to a bare place.
    let (n, step) = (81_u32, 0.05);
    let grid = |k: u32| [f64::from(k % n) * step, f64::from(k / n) * step];
    let bump = |x: f64, y: f64| 0.1 * (-((x - 1.0).powi(2) + (y - 1.0).powi(2)) / 0.02).exp();
    let points: Points = (0..n * n).map(grid).map(|[x, y]| [x, y, bump(x, y)]).collect();
    let mut faces = Vec::new();
    for j in 0..n - 1 {
        for i in 0..n - 1 {
            let a = j * n + i;
            faces.push([a, a + 1, a + n + 1]);
            faces.push([a, a + n + 1, a + n]);
        }
    }
    let decomposer = Decomposer::new(&mesh(points.clone(), Polygons::from_triangles(&faces)));
    let schedule = Schedule::dyadic(6).unwrap();
    let at = |x: f64, y: f64| (y / step).round() as u32 * n + (x / step).round() as u32;
    let clone =
        |target: u32| Transplant { source: at(1.0, 1.0), target, radius: 0.6, angle: 0.0, levels: 1..=6 };
    let same = transplant(&decomposer, &schedule, &clone(at(1.0, 1.0)), Progress::none()).unwrap();
    for (p, q) in points.iter().zip(&same.points) {
        assert!(norm(&subtract(p, q)) < 1e-9);
    }
    let target = at(2.5, 2.5);
    let cloned = transplant(&decomposer, &schedule, &clone(target), Progress::none()).unwrap();
    assert!(cloned.n_changed > 200 && cloned.n_without_source == 0, "{}", cloned.n_changed);
    let top = cloned.points[target as usize][2];
    assert!(top > 0.06 && top < 0.11, "{top}");
    assert!((cloned.points[at(1.0, 1.0) as usize][2] - 0.1).abs() < 1e-12, "the source stays");
}
