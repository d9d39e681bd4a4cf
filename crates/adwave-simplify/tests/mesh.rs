//! Guarantees of simplified meshes, and their measured deviation.

use adwave::Progress;
use adwave::sample::Sample;
use adwave::shape::{Mesh, Polygons, triangulate};
use adwave_simplify::{Border, MeshParams, MeshTarget, SimplifiedMesh, SimplifyError, Why, simplify_mesh};
use std::collections::HashMap;
use std::sync::atomic::AtomicBool;

/// Distances caused by rounding on shapes of unit size.
const ROUNDING: f64 = 1e-9;

fn sample(name: &str, n_vertices: usize) -> Mesh {
    let sample = Sample::from_name(name, Some(n_vertices)).unwrap();
    Mesh::new(sample.points, sample.faces).unwrap()
}

fn simplify(mesh: &Mesh, target: MeshTarget) -> SimplifiedMesh {
    simplify_mesh(mesh, None, &MeshParams::new(target), Progress::none()).unwrap()
}

/// Square of n × n cells with two triangles each, with a height per vertex.
fn grid(n: u32, height: impl Fn(u32, u32) -> f64) -> Mesh {
    let side = n + 1;
    let points =
        (0..side * side).map(|k| [f64::from(k % side), f64::from(k / side), height(k % side, k / side)]);
    let squares = (0..n * n).map(|s| s / n * side + s % n);
    let triangles: Vec<[u32; 3]> =
        squares.flat_map(|k| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]]).collect();
    Mesh::new(points.collect(), Polygons::from_triangles(&triangles)).unwrap()
}

fn points_of(mesh: &Mesh, simplified: &SimplifiedMesh) -> Vec<[f64; 3]> {
    simplified.kept.iter().map(|&x| mesh.points()[x as usize]).collect()
}

/// Distance of a point from a triangle, by the seven regions of Ericson, "Real-Time Collision Detection", 5.1.5.
fn distance(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    let minus = |u: [f64; 3], v: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| u[k] - v[k]) };
    let dot = |u: [f64; 3], v: [f64; 3]| -> f64 { u.iter().zip(v).map(|(u, v)| u * v).sum() };
    let along = |u: [f64; 3], v: [f64; 3], t: f64| -> [f64; 3] { std::array::from_fn(|k| u[k] + t * v[k]) };
    let (ab, ac, ap, bp, cp) = (minus(b, a), minus(c, a), minus(p, a), minus(p, b), minus(p, c));
    let (d1, d2, d3, d4, d5, d6) =
        (dot(ab, ap), dot(ac, ap), dot(ab, bp), dot(ac, bp), dot(ab, cp), dot(ac, cp));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let q = if d1 <= 0.0 && d2 <= 0.0 {
        a
    } else if d3 >= 0.0 && d4 <= d3 {
        b
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        along(a, ab, d1 / (d1 - d3))
    } else if d6 >= 0.0 && d5 <= d6 {
        c
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        along(a, ac, d2 / (d2 - d6))
    } else if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        along(b, minus(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6)))
    } else {
        let sum = va + vb + vc;
        along(along(a, ab, vb / sum), ac, vc / sum)
    };
    let to = minus(p, q);
    dot(to, to).sqrt()
}

/// Largest distance of points in a grid on triangles from other triangles, by brute force.
fn sample_distances(from: &[[[f64; 3]; 3]], to: &[[[f64; 3]; 3]], steps: u32) -> f64 {
    let nearest = |p: [f64; 3]| to.iter().map(|&t| distance(p, t)).fold(f64::INFINITY, f64::min);
    let grid = (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| [i, j, steps - i - j]));
    let weights: Vec<[f64; 3]> = grid.map(|w| w.map(|x| f64::from(x) / f64::from(steps))).collect();
    let at = |t: &[[f64; 3]; 3], w: &[f64; 3]| -> [f64; 3] {
        std::array::from_fn(|c| w[0] * t[0][c] + w[1] * t[1][c] + w[2] * t[2][c])
    };
    from.iter().flat_map(|t| weights.iter().map(move |w| at(t, w))).map(nearest).fold(0.0, f64::max)
}

fn triangles_of(mesh: &Mesh) -> Vec<[[f64; 3]; 3]> {
    triangulate(mesh.points(), mesh.faces()).iter().map(|t| t.map(|x| mesh.points()[x as usize])).collect()
}

#[test]
fn bounds_of_the_distance_hold_for_dense_samples_and_are_close() {
    let ball = sample("sphere", 400);
    // Long triangles: heights of a grid that is stretched 30 times.
    let rough = grid(14, |x, y| f64::from((x * 7 + y * 13) % 5) * 0.3);
    let stretched = rough.points().iter().map(|&[x, y, z]| [30.0 * x, y, z]).collect();
    let stretched = Mesh::new(stretched, rough.faces().clone()).unwrap();
    for (mesh, target) in [
        (&ball, MeshTarget::Ratio(0.15)),
        (&ball, MeshTarget::Error(0.1)),
        (&rough, MeshTarget::Ratio(0.4)),
        (&stretched, MeshTarget::Ratio(0.3)),
        (&stretched, MeshTarget::Error(0.4)),
    ] {
        let simplified = simplify(mesh, target);
        let points = points_of(mesh, &simplified);
        let after: Vec<_> = simplified.triangles.iter().map(|t| t.map(|x| points[x as usize])).collect();
        let before = triangles_of(mesh);
        let deviation = simplified.deviation.unwrap();
        for (side, from, to) in
            [(deviation.of_original, &before, &after), (deviation.of_simplified, &after, &before)]
        {
            let found = sample_distances(from, to, 6);
            assert!(found <= side.greatest + ROUNDING, "{target:?}: {found} is beyond {side:?}");
            assert!(side.at_least <= side.greatest, "{target:?}: {side:?}");
            // The longest triangles need more pieces than are tried; their bounds hold, but are not close.
            let is_close = side.greatest <= 1.02 * side.at_least.max(found) + ROUNDING;
            assert!(is_close || std::ptr::eq(mesh, &raw const stretched), "{target:?}: {found}, {side:?}");
        }
        assert!(deviation.rms() < deviation.greatest(), "{target:?}");
    }
}

#[test]
fn the_measured_error_is_at_most_the_one_asked_for_and_less_error_keeps_more() {
    let mesh = sample("creature", 4000);
    let mut last = usize::MAX;
    for share in [0.0005, 0.002, 0.01, 0.03] {
        let error = share * adwave::shape::diagonal(mesh.points());
        let simplified = simplify(&mesh, MeshTarget::Error(error));
        let measured = simplified.deviation.unwrap().greatest();
        assert!(measured <= error + ROUNDING, "{measured} is beyond {error}");
        assert!(simplified.kept.len() < last, "{} at {share}", simplified.kept.len());
        // Few vertices: most of the allowed error is used.
        assert!(measured > 0.5 * error, "{measured} of {error}");
        last = simplified.kept.len();
    }
}

#[test]
fn numbers_of_vertices_are_met_and_positions_are_exact() {
    let mesh = sample("creature", 5000);
    for n in [3000, 1000, 300] {
        let simplified = simplify(&mesh, MeshTarget::Vertices(n));
        let found = simplified.kept.len();
        assert!(found.abs_diff(n) <= n / 50, "{found} in place of {n}");
        assert_eq!(simplified.why, Why::Reached);
        assert!(simplified.kept.is_sorted_by(|a, b| a < b));
        // A closed manifold stays one: every edge has two triangles.
        let mut edges = HashMap::new();
        for [a, b, c] in &simplified.triangles {
            for (x, y) in [(a, b), (b, c), (c, a)] {
                *edges.entry((x.min(y), x.max(y))).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|&n| n == 2));
    }
}

#[test]
fn what_is_flat_goes_and_a_border_that_is_kept_stays() {
    let flat = grid(12, |_, _| 0.0);
    assert_eq!(simplify(&flat, MeshTarget::Error(1e-6)).kept.len(), 4);
    let params = MeshParams::new(MeshTarget::Error(1e-6)).with_border(Border::Kept);
    let kept = simplify_mesh(&flat, None, &params, Progress::none()).unwrap().kept;
    let is_border = |x: u32| x.is_multiple_of(13) || x % 13 == 12 || x / 13 == 0 || x / 13 == 12;
    assert_eq!(kept.iter().filter(|&&x| is_border(x)).count(), 48);
    assert!(kept.len() < 60, "{} are kept", kept.len());
}

#[test]
fn nothing_that_can_be_dropped_leaves_the_shape_as_it_is() {
    // A bowl: no vertex lies in the plane of its neighbors.
    let rough = grid(6, |x, y| f64::from(x * x + y * y));
    let simplified = simplify(&rough, MeshTarget::Error(0.0));
    assert_eq!((simplified.why, simplified.kept.len()), (Why::Unchanged, 49));
    assert_eq!(simplified.deviation.unwrap().greatest(), 0.0);
    assert_eq!(simplify(&rough, MeshTarget::Vertices(49)).why, Why::Unchanged);
    assert_eq!(simplify(&rough, MeshTarget::Vertices(5000)).why, Why::Unchanged);
}

#[test]
fn corners_split_at_every_face_are_welded() {
    let closed = sample("creature", 2500);
    let triangles = triangulate(closed.points(), closed.faces());
    let soup: Vec<[f64; 3]> = triangles.as_flattened().iter().map(|&x| closed.points()[x as usize]).collect();
    let own: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let soup = Mesh::new(soup, Polygons::from_triangles(&own)).unwrap();
    let (of_soup, of_closed) =
        (simplify(&soup, MeshTarget::Vertices(500)), simplify(&closed, MeshTarget::Vertices(500)));
    assert_eq!(of_soup.n_vertices_before, closed.points().len());
    assert!(of_soup.kept.len().abs_diff(of_closed.kept.len()) < 20);
}

#[test]
fn seams_stay_where_they_are_and_corners_on_their_side() {
    // Two materials that meet along x = 6 of a flat square.
    let flat = grid(12, |_, _| 0.0);
    let side_of = |corners: &[u32]| u32::from(corners.iter().map(|x| x % 13).sum::<u32>() > 18);
    let labels: Vec<u32> = flat.faces().iter().flat_map(|face| [side_of(face); 3]).collect();
    let params = MeshParams::new(MeshTarget::Error(1e-6));
    let simplified = simplify_mesh(&flat, Some(&labels), &params, Progress::none()).unwrap();
    assert_eq!(simplified.kept, [0, 6, 12, 156, 162, 168]);
    for (triangle, corners) in simplified.triangles.iter().zip(&simplified.corners) {
        let sides = corners.map(|k| labels[k as usize]);
        assert!(sides == [sides[0]; 3], "one side for the whole triangle");
        for (&x, &k) in triangle.iter().zip(corners) {
            assert_eq!(flat.faces().corners()[k as usize], simplified.kept[x as usize]);
        }
        let own: Vec<u32> = triangle.iter().map(|&x| simplified.kept[x as usize] % 13).collect();
        assert!(own.iter().all(|&x| if sides[0] == 0 { x <= 6 } else { x >= 6 }), "{own:?} {sides:?}");
    }
    assert!(simplify_mesh(&flat, Some(&labels[1..]), &params, Progress::none()).is_err());
}

#[test]
fn corners_at_a_crease_continue_the_face_that_is_turned_alike() {
    // A cube of squares, six sides of 8 × 8, welded at its edges.
    let n = 8_u32;
    let (mut points, mut triangles, mut side_of_face) = (Vec::new(), Vec::new(), Vec::new());
    for side in 0..6_u32 {
        let first = points.len() as u32;
        for k in 0..(n + 1) * (n + 1) {
            let (u, v) = (f64::from(k % (n + 1)), f64::from(k / (n + 1)));
            let w = if side % 2 == 0 { 0.0 } else { f64::from(n) };
            let (u, v) = if side % 2 == 0 { (v, u) } else { (u, v) };
            points.push([[u, v, w], [w, u, v], [v, w, u]][side as usize / 2]);
        }
        for s in 0..n * n {
            let k = first + s / n * (n + 1) + s % n;
            triangles.extend([[k, k + 1, k + n + 1], [k + 1, k + n + 2, k + n + 1]]);
            side_of_face.extend([side; 2]);
        }
    }
    let cube = Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap();
    let simplified = simplify(&cube, MeshTarget::Error(1e-6));
    assert_eq!((simplified.kept.len(), simplified.triangles.len()), (8, 12));
    for (corners, &face) in simplified.corners.iter().zip(&simplified.faces) {
        assert!(corners.iter().all(|&k| side_of_face[k as usize / 3] == side_of_face[face as usize]));
    }
}

#[test]
fn polygons_repeated_empty_and_degenerate_faces_and_unused_vertices_do_no_harm() {
    let mut faces = Polygons::new();
    for k in 0..9_u32 {
        let first = k / 3 * 4 + k % 3;
        faces.push(&[first, first + 1, first + 5, first + 4]);
    }
    faces.push(&[0, 1, 5, 4]);
    faces.push(&[3]);
    faces.push(&[]);
    faces.push(&[2, 2, 7]);
    faces.push(&[0, 1, 2]); // on one line
    let mut points: Vec<[f64; 3]> = (0..16_u32).map(|k| [f64::from(k % 4), f64::from(k / 4), 0.0]).collect();
    points.push([50.0, 50.0, 50.0]);
    let mesh = Mesh::new(points, faces).unwrap();
    let simplified = simplify(&mesh, MeshTarget::Error(1e-6));
    assert_eq!(simplified.kept, [0, 3, 12, 15]);
    assert_eq!((simplified.n_triangles_before, simplified.n_vertices_before), (18, 16));
    assert!(simplified.faces.iter().all(|&f| f < 10));
}

#[test]
fn edges_of_three_triangles_stay() {
    // Three walls on one line, each of 4 × 4 squares.
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for wall in 0..3_u32 {
        let turn = f64::from(wall) * 2.0;
        let first = points.len() as u32;
        for k in 0..25_u32 {
            let along = f64::from(k % 5);
            points.push([along * turn.cos(), along * turn.sin(), f64::from(k / 5)]);
        }
        for s in 0..16_u32 {
            let k = first + s / 4 * 5 + s % 4;
            triangles.extend([[k, k + 1, k + 5], [k + 1, k + 6, k + 5]]);
        }
    }
    let mesh = Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap();
    let simplified = simplify(&mesh, MeshTarget::Error(1e-6));
    assert!(simplified.kept.len() < 30, "{}", simplified.kept.len());
    assert!(simplified.deviation.unwrap().greatest() < 1e-6);
}

#[test]
fn shapes_as_small_as_they_can_be_and_targets_that_cannot_be() {
    let triangle =
        Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], Polygons::from_triangles(&[[0, 1, 2]]));
    let triangle = triangle.unwrap();
    for target in [MeshTarget::Error(1e9), MeshTarget::Vertices(1), MeshTarget::Ratio(0.1)] {
        assert_eq!(simplify(&triangle, target).kept, [0, 1, 2], "{target:?}");
    }
    let refused = |mesh: &Mesh, target| {
        simplify_mesh(mesh, None, &MeshParams::new(target), Progress::none()).unwrap_err()
    };
    for (target, said) in [
        (MeshTarget::Error(f64::NAN), "the target distance must be finite and not negative, got NaN"),
        (MeshTarget::Error(-1.0), "the target distance must be finite and not negative, got -1.0"),
        (MeshTarget::Vertices(0), "the number of vertices must be at least 1, got 0"),
        (MeshTarget::Ratio(1.5), "the ratio must be above 0 and at most 1, got 1.5"),
    ] {
        assert_eq!(refused(&triangle, target).to_string(), said);
    }
    let equal = Mesh::new(vec![[1.0; 3]; 3], Polygons::from_triangles(&[[0, 1, 2]])).unwrap();
    assert_eq!(refused(&equal, MeshTarget::Error(1.0)), SimplifyError::NoSurface);
}

#[test]
fn sizes_from_1e_minus_200_to_1e90_give_the_same_vertices() {
    let mesh = sample("creature", 2500);
    let kept = simplify(&mesh, MeshTarget::Ratio(0.3)).kept;
    for scale in [2.0_f64.powi(-660), 2.0_f64.powi(300)] {
        let points = mesh.points().iter().map(|p| p.map(|x| x * scale)).collect();
        let scaled = Mesh::new(points, mesh.faces().clone()).unwrap();
        let simplified = simplify(&scaled, MeshTarget::Ratio(0.3));
        assert_eq!(simplified.kept, kept);
        assert!(
            simplified.deviation.unwrap().greatest().is_finite()
                && simplified.deviation.unwrap().greatest() > 0.0
        );
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits_and_a_stop_is_heard() {
    let mesh = sample("creature", 3000);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let params = MeshParams::new(MeshTarget::Error(0.01));
    let one = alone.install(|| simplify_mesh(&mesh, None, &params, Progress::none()).unwrap());
    let all = simplify_mesh(&mesh, None, &params, Progress::none()).unwrap();
    assert_eq!((one.kept, one.triangles, one.deviation), (all.kept, all.triangles, all.deviation));
    let stop = AtomicBool::new(true);
    let stopped = simplify_mesh(&mesh, None, &params, Progress::none().with_cancel(&stop));
    assert!(matches!(stopped, Err(SimplifyError::Cancelled(_))));
}

#[test]
fn what_is_not_asked_for_is_left_out_and_changes_nothing_else() {
    let mesh = sample("creature", 3000);
    for target in [MeshTarget::Ratio(0.2), MeshTarget::Error(0.02)] {
        let params = MeshParams::new(target);
        let whole = simplify_mesh(&mesh, None, &params, Progress::none()).unwrap();
        let fast = params.with_measure(false).with_nearest_faces(false);
        let fast = simplify_mesh(&mesh, None, &fast, Progress::none()).unwrap();
        assert_eq!(
            (&fast.kept, &fast.triangles, &fast.corners),
            (&whole.kept, &whole.triangles, &whole.corners)
        );
        assert!(fast.deviation.is_none() && fast.measure_seconds == 0.0 && whole.measure_seconds > 0.0);
        assert!(fast.faces.iter().all(|&face| (face as usize) < mesh.faces().len()));
        match target {
            MeshTarget::Error(error) => {
                assert_eq!(fast.within, whole.within);
                let within = fast.within.unwrap();
                assert!(within <= error && whole.deviation.unwrap().greatest() <= within * (1.0 + 1e-12));
            }
            _ => assert!(fast.within.is_none() && whole.within.is_none()),
        }
    }
}
