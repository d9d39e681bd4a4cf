//! Parts, holes, handles, seams and colors, which a simplification keeps.

mod common;

use adwave::Progress;
use adwave::sample::Sample;
use adwave::shape::{Mesh, Polygons};
use adwave_simplify::{
    Appearance, AppearanceValues, MeshParams, MeshTarget, SimplifiedMesh, Why, simplify_mesh,
    simplify_mesh_with_appearance,
};
use common::{edges, euler_characteristic};
use std::collections::{BTreeMap, BTreeSet};

fn simplify(mesh: &Mesh, target: MeshTarget) -> SimplifiedMesh {
    simplify_mesh(mesh, None, &MeshParams::new(target), Progress::none()).unwrap()
}

fn count_parts(triangles: &[[u32; 3]]) -> usize {
    let mut part: BTreeMap<u32, u32> = triangles.iter().flatten().map(|&x| (x, x)).collect();
    loop {
        let before = part.clone();
        for triangle in triangles {
            let least = triangle.iter().map(|x| part[x]).min().unwrap();
            for x in triangle {
                part.insert(*x, least);
            }
        }
        if before == part {
            return part.values().collect::<BTreeSet<_>>().len();
        }
    }
}

fn triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.faces().triangles().unwrap().to_vec()
}

/// Torus of m × n squares with two triangles each.
fn torus(m: u32, n: u32) -> Mesh {
    let turn = |k: u32, n: u32| f64::from(k) / f64::from(n) * std::f64::consts::TAU;
    let points = (0..m * n).map(|k| {
        let (u, v) = (turn(k / n, m), turn(k % n, n));
        [(2.0 + 0.5 * v.cos()) * u.cos(), (2.0 + 0.5 * v.cos()) * u.sin(), 0.5 * v.sin()]
    });
    let squares = (0..m * n).flat_map(|k| {
        let at = |i: u32, j: u32| (k / n + i) % m * n + (k % n + j) % n;
        [[at(0, 0), at(1, 0), at(0, 1)], [at(1, 0), at(1, 1), at(0, 1)]]
    });
    Mesh::new(points.collect(), Polygons::from_triangles(&squares.collect::<Vec<_>>())).unwrap()
}

/// Square of n × n cells with the side 1, without the cells of `is_hole`.
fn plate(n: u32, is_hole: impl Fn(u32, u32) -> bool) -> Mesh {
    let side = n + 1;
    let scale = |x: u32| f64::from(x) / f64::from(n);
    let points = (0..side * side).map(|k| [scale(k % side), scale(k / side), 0.0]).collect();
    let cells = (0..n * n).filter(|s| !is_hole(s % n, s / n)).map(|s| s / n * side + s % n);
    let triangles: Vec<[u32; 3]> =
        cells.flat_map(|k| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]]).collect();
    Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap()
}

/// Copies of a mesh at a distance of 3 along x.
fn copies(mesh: &Mesh, n: u32) -> Mesh {
    let size = mesh.points().len() as u32;
    let shift = |k: u32| mesh.points().iter().map(move |&[x, y, z]| [x + 3.0 * f64::from(k), y, z]);
    let faces: Vec<[u32; 3]> =
        (0..n).flat_map(|k| triangles(mesh).into_iter().map(move |t| t.map(|x| x + k * size))).collect();
    Mesh::new((0..n).flat_map(shift).collect(), Polygons::from_triangles(&faces)).unwrap()
}

#[test]
fn a_torus_keeps_its_handle_at_any_number_of_vertices() {
    let mesh = torus(24, 12);
    for n in [200, 60, 20, 7, 1] {
        let simplified = simplify(&mesh, MeshTarget::Vertices(n));
        assert_eq!(euler_characteristic(&simplified.triangles), 0, "{n}");
        assert!(edges(&simplified.triangles).values().all(|&faces| faces == 2), "{n}");
        // A torus has at least 7 vertices.
        assert!(simplified.kept.len() >= n.max(7), "{} for {n}", simplified.kept.len());
        if n >= 20 {
            assert_eq!((simplified.kept.len(), simplified.why), (n, Why::Reached));
        }
    }
    let coarse = simplify(&mesh, MeshTarget::Error(10.0));
    assert_eq!(euler_characteristic(&coarse.triangles), 0);
}

#[test]
fn every_part_stays_and_fewer_vertices_than_parts_need_are_not_promised() {
    let ball = Sample::from_name("sphere", Some(42)).unwrap();
    let balls = copies(&Mesh::new(ball.points, ball.faces).unwrap(), 10);
    for n in [200, 100, 40, 21, 5] {
        let simplified = simplify(&balls, MeshTarget::Vertices(n));
        assert_eq!(count_parts(&simplified.triangles), 10, "{n}");
        assert_eq!(euler_characteristic(&simplified.triangles), 20, "{n}");
        assert_eq!(simplified.kept.len(), n.max(40), "{n}");
        let (why, parts) = (simplified.why, simplified.parts);
        if n >= 40 {
            assert_eq!((why, parts), (Why::Reached, None));
        } else {
            assert_eq!(why, Why::Stuck);
            assert_eq!(parts.unwrap().n_least_vertices(), 40);
        }
    }
}

#[test]
fn holes_of_a_plate_stay_and_its_flat_rest_goes() {
    let is_hole = |x: u32, y: u32| (5..9).contains(&x) && (5..9).contains(&y) || (14, 15) == (x, y);
    let mesh = plate(24, is_hole);
    let flat = simplify(&mesh, MeshTarget::Error(1e-9));
    // The corners of the plate and of its square holes are enough.
    assert_eq!((flat.kept.len(), euler_characteristic(&flat.triangles)), (12, -1));
    assert!(flat.deviation.unwrap().greatest() <= 1e-9);
    let least = simplify(&mesh, MeshTarget::Vertices(1));
    assert_eq!(euler_characteristic(&least.triangles), -1);
    assert_eq!(count_parts(&least.triangles), 1);
}

#[test]
fn a_hole_that_is_larger_than_the_error_keeps_its_size() {
    // A round hole: its border is flat, so that every vertex on it is at distance 0 from a plate without it.
    let is_hole = |x: u32, y: u32| (f64::from(x) - 19.5).hypot(f64::from(y) - 19.5) < 10.0;
    let mesh = plate(40, is_hole);
    let area = |triangles: &[[u32; 3]], points: &dyn Fn(u32) -> [f64; 3]| -> f64 {
        let doubled = |t: &[u32; 3]| {
            let [a, b, c] = t.map(points);
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        0.5 * triangles.iter().map(doubled).sum::<f64>()
    };
    let before = area(&triangles(&mesh), &|x| mesh.points()[x as usize]);
    for error in [0.02, 0.05] {
        let simplified = simplify(&mesh, MeshTarget::Error(error));
        let after = area(&simplified.triangles, &|x| mesh.points()[simplified.kept[x as usize] as usize]);
        let perimeter = std::f64::consts::TAU * 0.25 * 1.3;
        assert!((after - before).abs() <= perimeter * error, "{before} became {after} at {error}");
        assert!(simplified.kept.len() < 80, "{}", simplified.kept.len());
    }
}

/// Returns true for places in the disc around the middle of a plate of side 1.
fn is_in_disc(x: f64, y: f64) -> bool {
    (x - 0.5).hypot(y - 0.5) < 0.2
}

/// Share of the unit square for which the nearest triangle below a point is not as `is_red` tells.
fn wrong_share(mesh: &Mesh, simplified: &SimplifiedMesh, is_red: &dyn Fn(usize, [f64; 3]) -> bool) -> f64 {
    let n = 60_u32;
    let points: Vec<[f64; 3]> = simplified.kept.iter().map(|&x| mesh.points()[x as usize]).collect();
    let cross =
        |a: [f64; 3], b: [f64; 3], x: f64, y: f64| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    let mut wrong = 0;
    for k in 0..n * n {
        let (x, y) = ((f64::from(k % n) + 0.5) / f64::from(n), (f64::from(k / n) + 0.5) / f64::from(n));
        let found = simplified.triangles.iter().enumerate().find_map(|(t, triangle)| {
            let [a, b, c] = triangle.map(|v| points[v as usize]);
            let weights = [cross(b, c, x, y), cross(c, a, x, y), cross(a, b, x, y)];
            let sum: f64 = weights.iter().sum();
            weights.iter().all(|&w| w >= -1e-12).then(|| (t, weights.map(|w| w / sum)))
        });
        let (t, weights) = found.expect("the square is covered");
        wrong += u32::from(is_red(t, weights) != is_in_disc(x, y));
    }
    f64::from(wrong) / f64::from(n * n)
}

#[test]
fn a_red_disc_in_a_flat_blue_square_survives_as_a_material() {
    let mesh = plate(40, |_, _| false);
    let middle = |face: &[u32]| {
        let mean = |c: usize| face.iter().map(|&x| mesh.points()[x as usize][c]).sum::<f64>() / 3.0;
        is_in_disc(mean(0), mean(1))
    };
    let labels: Vec<u32> = mesh.faces().iter().flat_map(|face| [u32::from(middle(face)); 3]).collect();
    for target in [MeshTarget::Error(0.03), MeshTarget::Vertices(40), MeshTarget::Vertices(1)] {
        let params = MeshParams::new(target);
        let simplified = simplify_mesh(&mesh, Some(&labels), &params, Progress::none()).unwrap();
        let is_red = |t: usize, _: [f64; 3]| labels[simplified.corners[t][0] as usize] == 1;
        let of_face = |t: usize| labels[3 * simplified.faces[t] as usize] == 1;
        assert!((0..simplified.triangles.len()).all(|t| is_red(t, [0.0; 3]) == of_face(t)));
        if target == MeshTarget::Vertices(1) {
            assert!((0..simplified.triangles.len()).any(of_face), "the disc does not vanish");
        } else {
            let wrong = wrong_share(&mesh, &simplified, &is_red);
            assert!(wrong < 0.04, "{wrong} at {target:?}, {} vertices", simplified.kept.len());
            assert!(simplified.kept.len() < 100, "{}", simplified.kept.len());
        }
    }
}

#[test]
fn a_red_disc_in_a_flat_blue_square_survives_as_colors_of_vertices() {
    let mesh = plate(40, |_, _| false);
    let red = |x: u32| {
        let p = mesh.points()[x as usize];
        if is_in_disc(p[0], p[1]) { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] }
    };
    let values: Vec<f64> = mesh.faces().corners().iter().flat_map(|&x| red(x)).collect();
    let values = Some(AppearanceValues { values: &values, n_channels: 3 });
    for target in [MeshTarget::Error(0.03), MeshTarget::Error(0.3), MeshTarget::Vertices(120)] {
        let appearance = Appearance { values, ..Appearance::default() };
        let params = MeshParams::new(target);
        let simplified = simplify_mesh_with_appearance(&mesh, appearance, &params, Progress::none()).unwrap();
        let is_red = |t: usize, weights: [f64; 3]| {
            let corners = simplified.triangles[t].map(|x| red(simplified.kept[x as usize])[0]);
            corners.iter().zip(weights).map(|(c, w)| c * w).sum::<f64>() > 0.5
        };
        let wrong = wrong_share(&mesh, &simplified, &is_red);
        let limit = if target == MeshTarget::Error(0.3) { 0.13 } else { 0.05 };
        assert!(wrong < limit, "{wrong} at {target:?}, {} vertices", simplified.kept.len());
        assert!(simplified.kept.len() < 900, "{} at {target:?}", simplified.kept.len());
    }
    let appearance =
        Appearance { values: Some(AppearanceValues { values: &[], n_channels: 3 }), ..Appearance::default() };
    let params = MeshParams::new(MeshTarget::Vertices(9));
    assert!(simplify_mesh_with_appearance(&mesh, appearance, &params, Progress::none()).is_err());
}

#[test]
fn more_vertices_remain_where_weights_are_large_and_their_scale_and_sign_do_not_matter() {
    let ball = Sample::from_name("sphere", Some(4000)).unwrap();
    let mesh = Mesh::new(ball.points, ball.faces).unwrap();
    let simplify = |weights: &[f64]| {
        let appearance = Appearance { weights: Some(weights), ..Appearance::default() };
        let params = MeshParams::new(MeshTarget::Vertices(400));
        simplify_mesh_with_appearance(&mesh, appearance, &params, Progress::none())
    };
    let upper = |kept: &[u32]| kept.iter().filter(|&&x| mesh.points()[x as usize][2] > 0.0).count();
    let even = vec![1.0; mesh.points().len()];
    let plain =
        simplify_mesh(&mesh, None, &MeshParams::new(MeshTarget::Vertices(400)), Progress::none()).unwrap();
    assert_eq!(simplify(&even).unwrap().kept, plain.kept);
    assert!(upper(&plain.kept).abs_diff(200) < 20, "{}", upper(&plain.kept));
    // The mean squared distance of a sphere goes as density⁻², so 16 gives 4 times the density.
    let uneven: Vec<f64> = mesh.points().iter().map(|p| if p[2] > 0.0 { 16.0 } else { 1.0 }).collect();
    let kept = simplify(&uneven).unwrap().kept;
    assert!(upper(&kept).abs_diff(320) < 25, "{}", upper(&kept));
    let signed: Vec<f64> = uneven.iter().map(|w| -0.25 * w).collect();
    assert_eq!(simplify(&signed).unwrap().kept, kept);
    let nothing = vec![0.0; mesh.points().len()];
    assert_eq!(simplify(&nothing).unwrap().kept, plain.kept);
    let error = |weights: &[f64]| simplify(weights).unwrap_err().to_string();
    assert!(error(&even[1..]).contains("one weight per vertex"));
    let mut missing = even.clone();
    missing[7] = f64::NAN;
    assert!(error(&missing).contains("got NaN at vertex 7"));
}

#[test]
fn meshes_that_are_not_manifold_get_no_new_edges_of_more_than_two_faces() {
    // Two balls that share a vertex, and three walls on one line.
    let ball = Sample::from_name("sphere", Some(300)).unwrap();
    let ball = Mesh::new(ball.points, ball.faces).unwrap();
    let two = copies(&ball, 2);
    let size = ball.points().len() as u32;
    let touching: Vec<[u32; 3]> =
        triangles(&two).into_iter().map(|t| t.map(|x| if x == size { 0 } else { x })).collect();
    let mesh = Mesh::new(two.points().to_vec(), Polygons::from_triangles(&touching)).unwrap();
    let simplified = simplify(&mesh, MeshTarget::Vertices(30));
    assert!(edges(&simplified.triangles).values().all(|&faces| faces == 2));
    assert_eq!(count_parts(&simplified.triangles), 1);
    assert_eq!(euler_characteristic(&simplified.triangles), 3);
}

#[test]
fn clusters_of_balls_that_overlap_keep_their_number() {
    // 40 balls at pseudorandom places of a small box; they intersect, but no vertex is shared.
    let ball = Sample::from_name("sphere", Some(60)).unwrap();
    let ball = Mesh::new(ball.points, ball.faces).unwrap();
    let mut mesh = copies(&ball, 40);
    let size = ball.points().len();
    let place = |k: usize, c: u32| {
        let mixed = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (8 * c);
        (mixed & 0xff) as f64 / 64.0
    };
    let points = mesh.points().iter().enumerate().map(|(x, p)| {
        let k = x / size;
        [p[0] - 3.0 * k as f64 + place(k, 1), p[1] + place(k, 3), p[2] + place(k, 5)]
    });
    mesh = Mesh::new(points.collect(), mesh.faces().clone()).unwrap();
    for target in [MeshTarget::Error(0.3), MeshTarget::Error(1.0), MeshTarget::Vertices(400)] {
        let simplified = simplify(&mesh, target);
        assert_eq!(count_parts(&simplified.triangles), 40, "{target:?}");
        assert!(edges(&simplified.triangles).values().all(|&faces| faces == 2), "{target:?}");
        assert!(simplified.kept.len() < 40 * size, "{target:?}");
    }
}

#[test]
fn faces_with_both_orientations_stay_in_pairs() {
    let one_sided = plate(12, |_, _| false);
    let mut both = triangles(&one_sided);
    both.extend(triangles(&one_sided).into_iter().map(|[a, b, c]| [a, c, b]));
    let mesh = Mesh::new(one_sided.points().to_vec(), Polygons::from_triangles(&both)).unwrap();
    let simplified = simplify(&mesh, MeshTarget::Error(1e-9));
    assert_eq!((simplified.kept.len(), simplified.triangles.len()), (4, 4));
    assert!(edges(&simplified.triangles).values().all(|faces| faces % 2 == 0));
}
