//! Shapes that are no surface, or hardly one: what each gives stands beside it.

use crate::surface::meshes::{Noise, jittered_grid, sample};
use crate::surface::{cloud, decomposer, mesh};
use adwave::bands::{Bands, Schedule};
use adwave::features::{FeatureParams, features};
use adwave::operator::Semigroup;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::shape::{Graph, Shape};
use adwave::{Decomposer, Progress};
use std::f64::consts::TAU;

/// Default accuracy.
const ACCURACY: f64 = 1e-9;
/// Rounding per jump of heat in the long recurrence of needles.
const ROUNDED_JUMPS: f64 = 1e-13;
const LEVELS: usize = 6;

fn noise(n: usize) -> Vec<f64> {
    let mut noise = Noise::new(13);
    (0..n).map(|_| noise.signed()).collect()
}

/// All that can be asked of a shape: finite, the bands sum to the signal, no value grows. Gives the bands of noise.
fn check(name: &str, shape: &Shape) -> (Decomposer, Bands) {
    let decomposer = decomposer(shape);
    let (n, phi) = (shape.n_vertices(), decomposer.rows("a test").unwrap());
    let f = noise(n);
    let schedule = Schedule::dyadic(LEVELS).unwrap();
    for x in 0..phi.n_vertices() {
        let weights = phi.row(x).1;
        assert!(weights.iter().all(|w| w.is_finite() && *w >= 0.0), "{name}: row {x}: {weights:?}");
        assert!((0.0..=1.0).contains(&phi.diagonal(x)), "{name}: row {x}");
    }
    assert!(phi.stationary().iter().all(|p| p.is_finite()) && phi.step_length().is_finite(), "{name}");
    assert!(decomposer.areas().iter().all(|a| a.is_finite() && *a >= 0.0), "{name}");
    let bands = decomposer.decompose(&f, 1, &schedule).unwrap();
    for w in bands.wavelets() {
        assert!(w.iter().all(|v| v.abs() <= 2.0), "{name}: {w:?}");
    }
    for (a, b) in bands.reconstruct().iter().zip(&f) {
        assert!((a - b).abs() < 1e-14, "{name}");
    }
    if let Some(points) = shape.points() {
        let bands = decomposer.decompose(points.as_flattened(), 3, &schedule).unwrap();
        assert!(bands.wavelets().flatten().all(|v| v.is_finite()), "{name}");
    }
    let wavelets = decomposer.request(&f, 1, &schedule).norms().unwrap();
    let map = saliency(&decomposer, &wavelets, &SaliencyParams::paper(), Progress::none()).unwrap().map;
    assert!(map.iter().all(|v| v.is_finite()), "{name}: {map:?}");
    for feature in features(&decomposer, &wavelets, &FeatureParams::default(), Progress::none()).unwrap() {
        assert!(feature.response.is_finite(), "{name}");
    }
    let Semigroup::Heat { rate, .. } = phi.semigroup() else { panic!("{name}: no heat") };
    let n_jumps = rate * f64::from(1 << (LEVELS - 1));
    for vertex in (0..n).step_by((n / 7).max(1)) {
        let functions = decomposer.basis_of_vertex(vertex, &schedule, Progress::none()).unwrap();
        assert!(functions.wavelet.iter().all(|v| v.is_finite()), "{name}");
        let phi = functions.scaling_function;
        let sum: f64 = decomposer.vertex_map().mean(&phi, 1).iter().sum();
        // Its function is as accurate as all values are, beside the mass that there is of it. Needles take very many jumps, each
        // of which rounds.
        let pi = decomposer.rows("a test").unwrap().stationary()[decomposer.vertex_map().welded(vertex)];
        let allowed = (ACCURACY + ROUNDED_JUMPS * n_jumps) / pi.max(f64::MIN_POSITIVE);
        assert!(
            phi.iter().all(|&v| v >= 0.0) && (sum - 1.0).abs() < allowed,
            "{name}: {sum}, mass {pi:e}, {n_jumps:e} jumps"
        );
    }
    if n > 1 {
        let flags: Vec<bool> = (0..n).map(|x| x % 3 == 1).collect();
        if let Ok(masked) = decomposer.masked(&flags) {
            let bands = masked.decompose(&f, 1, &schedule).unwrap();
            let is_out = |x: usize| bands.coarsest()[x].is_nan();
            assert!((0..n).all(|x| flags[x] || !is_out(x)), "{name}");
        }
    }
    (decomposer, bands)
}

/// Asserts that a vertex keeps its value: it has no bands.
fn keeps_its_value(name: &str, bands: &Bands, x: usize) {
    assert!(bands.wavelets().all(|w| w[x] == 0.0), "{name}: vertex {x}");
}

/// Heat that has flowed from `from` to `to` after `n` steps.
fn heat(decomposer: &Decomposer, from: usize, to: usize, n: f64) -> f64 {
    let schedule = Schedule::real(vec![n]).unwrap();
    decomposer.basis_of_vertex(from, &schedule, Progress::none()).unwrap().scaling_function[to]
}

#[test]
fn sheets_that_share_an_edge_share_its_heat() {
    // Three pages of a book, equal but for their direction: 5 × 9 squares with the spine x = 0.
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for page in 0..3_u32 {
        let (first, angle) = (points.len() as u32, f64::from(page) * TAU / 3.0);
        for i in 0..6 {
            for j in 0..10 {
                let (across, along) = (f64::from(i), f64::from(j) + 0.5 * f64::from(i));
                points.push([0.9 * across * angle.cos(), 0.9 * across * angle.sin(), along]);
            }
        }
        for i in 0..5 {
            for j in 0..9 {
                let [a, b, c, d] =
                    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| first + 10 * i + j);
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    let (decomposer, _) = check("book", &mesh(&points, &triangles));
    // From the spine the same to each page; from one page through the spine to both others.
    let at = |page: usize, i: usize, j: usize| 60 * page + 10 * i + j;
    for j in [2, 5] {
        let pages = [0, 1, 2].map(|page| heat(&decomposer, at(0, 0, j), at(page, 2, 4), 8.0));
        assert!(pages[0] > 1e-4 && pages.iter().all(|p| (p / pages[0] - 1.0).abs() < 1e-6), "{pages:?}");
        let others = [1, 2].map(|page| heat(&decomposer, at(0, 2, j), at(page, 2, 4), 8.0));
        assert!(others[0] > 1e-5 && (others[0] / others[1] - 1.0).abs() < 1e-6, "{others:?}");
    }
}

#[test]
fn sheets_that_touch_at_a_vertex_exchange_heat_through_it_and_others_do_not() {
    let (square, halves) = jittered_grid(8, 2);
    let n = square.len() as u32;
    let turned =
        |shift: f64| square.iter().map(move |p| [-p[0] - shift, -p[1] - shift, p[2] + 0.3 * p[0] * p[1]]);
    for (name, shift, touch) in [("touching sheets", 0.0, true), ("sheets apart", 0.1, false)] {
        let mut points = square.clone();
        points.extend(turned(shift));
        let mut triangles = halves.clone();
        triangles.extend(halves.iter().map(|t| t.map(|x| x + n)));
        let (decomposer, _) = check(name, &mesh(&points, &triangles));
        // Vertex 0 of both is the corner at the origin.
        let across = heat(&decomposer, 1, n as usize + 1, 4.0);
        assert_eq!(across > 1e-4, touch, "{name}: {across:e}");
        assert!(touch || across == 0.0, "{name}: {across:e}");
    }
}

#[test]
fn a_moebius_strip_is_a_surface_all_the_same() {
    // It is flat but for its bending, so functions that change around it only decay as on a ring of that length.
    let (around, across) = (120_u32, 8_u32);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..around {
        let angle = TAU * f64::from(i) / f64::from(around);
        for j in 0..=across {
            let t = 0.25 * (2.0 * f64::from(j) / f64::from(across) - 1.0);
            let r = 1.0 + t * (0.5 * angle).cos();
            points.push([r * angle.cos(), r * angle.sin(), t * (0.5 * angle).sin()]);
        }
    }
    let at = |i: u32, j: u32| if i < around { i * (across + 1) + j } else { across - j };
    for i in 0..around {
        for j in 0..across {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let shape = mesh(&points, &triangles);
    let (decomposer, _) = check("Möbius strip", &shape);
    let area = adwave::shape::surface_area(&points, &triangles);
    assert!((decomposer.areas().iter().sum::<f64>() / area - 1.0).abs() < ACCURACY);
    let f: Vec<f64> = points.iter().map(|p| p[0].atan2(p[1]).cos()).collect();
    let step = decomposer.operator().step_length();
    let bands = decomposer.decompose(&f, 1, &Schedule::lengths(&[2.0], step).unwrap()).unwrap();
    // t = σ²/4 = 1, λ about 1 on a ring of radius 1.
    for (s, f) in bands.coarsest().iter().zip(&f) {
        assert!((s - (-1.0_f64).exp() * f).abs() < 0.03, "{s} {f}");
    }
}

#[test]
fn faces_without_area_and_faces_twice_change_next_to_nothing() {
    let (points, triangles) = sample("sphere", 600);
    let f = noise(points.len());
    let bands = |triangles: &[[u32; 3]], name: &str| {
        let (decomposer, _) = check(name, &mesh(&points, triangles));
        let schedule = Schedule::lengths(&[0.2, 0.4, 0.8], decomposer.operator().step_length()).unwrap();
        decomposer.decompose(&f, 1, &schedule).unwrap().wavelets().flatten().copied().collect::<Vec<f64>>()
    };
    let before = bands(&triangles, "sphere");
    let off = |other: Vec<f64>| before.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Corners that repeat: no face at all.
    let mut repeated = triangles.clone();
    repeated.extend([[5, 5, 9], [7, 7, 7], [1, 2, 1]]);
    assert_eq!(off(bands(&repeated, "repeated corners")), 0.0);
    // One face twice: a blister, seen around it only and there little.
    let mut blister = triangles.clone();
    blister.push(triangles[100]);
    let blister = off(bands(&blister, "one face twice"));
    // Each face twice: where an angle is obtuse its triangle is glued to its copy rather than to what lies beyond the edge.
    let twice = off(bands(&[&triangles[..], &triangles[..]].concat(), "all faces twice"));
    println!("one face twice: {blister:.1e}, all: {twice:.1e}");
    assert!(twice < 0.05 && blister < 0.05, "{twice:e} {blister:e}");
}

#[test]
fn acute_faces_twice_have_the_heat_of_each_once() {
    let mut noise = Noise::new(5);
    let mut points = Vec::new();
    for i in 0..12_u32 {
        for j in 0..12_u32 {
            let mut push = || 0.05 * noise.signed();
            points.push([f64::from(j) + 0.5 * f64::from(i) + push(), 0.87 * f64::from(i) + push(), push()]);
        }
    }
    let at = |i: u32, j: u32| 12 * i + j;
    let squares = (0..11).flat_map(|i| (0..11).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = squares
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            [[a, b, d], [b, c, d]]
        })
        .collect();
    let bands = |triangles: &[[u32; 3]]| {
        let (decomposer, _) = check("acute", &mesh(&points, triangles));
        let schedule = Schedule::lengths(&[1.0, 2.0, 4.0], decomposer.operator().step_length()).unwrap();
        let f: Vec<f64> = points.iter().map(|p| (p[0] * 1.3).sin() + p[1].cos()).collect();
        decomposer.decompose(&f, 1, &schedule).unwrap().wavelets().flatten().copied().collect::<Vec<f64>>()
    };
    let (once, twice) = (bands(&triangles), bands(&[&triangles[..], &triangles[..]].concat()));
    for (a, b) in once.iter().zip(&twice) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
}

#[test]
fn vertices_that_no_face_names_keep_their_value_and_cost_nothing() {
    let (mut points, triangles) = sample("torus", 700);
    let n = points.len();
    let (alone, _) = check("torus", &mesh(&points, &triangles));
    points.extend([[9.0, 9.0, 9.0], [0.0, 0.0, 0.0], [9.0, 9.0, 9.0]]);
    let (with_others, bands) = check("torus and points", &mesh(&points, &triangles));
    for x in [n, n + 1] {
        assert!(bands.wavelets().skip(1).all(|w| w[x] == 0.0) && with_others.areas()[x] == 0.0);
    }
    keeps_its_value("torus and points", &bands, n + 1);
    let (a, b) = (alone.operator().step_length(), with_others.operator().step_length());
    assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
}

#[test]
fn needles_keep_their_area() {
    // A strip 1e6 times as long as its triangles are high, and one whose triangles are that thin each.
    let strip = |length: f64, height: f64, n: u32| {
        let points: Vec<[f64; 3]> = (0..n)
            .map(|i| [length * f64::from(i) / 2.0, if i % 2 == 0 { 0.0 } else { height }, 0.0])
            .collect();
        let triangles: Vec<[u32; 3]> = (0..n - 2).map(|i| [i, i + 1, i + 2]).collect();
        (points, triangles)
    };
    for (name, length, height) in
        [("long needles", 1e6, 1.0), ("flat needles", 1.0, 1e-6), ("standing needles", 1e-6, 1.0)]
    {
        let (points, triangles) = strip(length, height, 60);
        let (decomposer, bands) = check(name, &mesh(&points, &triangles));
        let area: f64 = decomposer.areas().iter().sum();
        let expected = 58.0 * 0.5 * length * height;
        println!("{name}: area {area:.3e} for {expected:.3e}");
        // Sides are lengthened by 1e-10 of the mean at most, which gives a needle of no height one of 1e-5.
        assert!(
            area >= expected * 0.99 && area <= expected + 1e-5 * 58.0 * length.max(height).powi(2),
            "{name}"
        );
        assert!(bands.wavelets().flatten().any(|w| *w != 0.0), "{name}: nothing moves");
    }
    // A vertex that is 1e-6 of an edge away from it, in one of its triangles, is as good as on the edge in both.
    let (mut points, mut triangles) = sample("sphere", 600);
    let [a, b, c] = triangles.swap_remove(50);
    let (p, q, r) = (points[a as usize], points[b as usize], points[c as usize]);
    points.push(std::array::from_fn(|k| 0.5 * (p[k] + q[k]) + 1e-6 * (r[k] - p[k])));
    let new = points.len() as u32 - 1;
    let mut split = triangles.clone();
    triangles.extend([[a, b, new], [b, c, new], [c, a, new]]);
    let beyond = split.iter().position(|t| t.contains(&a) && t.contains(&b)).unwrap();
    let d = split.swap_remove(beyond).into_iter().find(|&d| d != a && d != b).unwrap();
    split.extend([[b, c, new], [c, a, new], [a, d, new], [d, b, new]]);
    let f: Vec<f64> = points.iter().map(|p| p[0] * p[1] + p[2]).collect();
    let smooth = |triangles: &[[u32; 3]]| {
        let (decomposer, _) = check("a needle in a sphere", &mesh(&points, triangles));
        let schedule = Schedule::lengths(&[0.5], decomposer.operator().step_length()).unwrap();
        decomposer.decompose(&f, 1, &schedule).unwrap().coarsest().to_vec()
    };
    let off = smooth(&triangles).iter().zip(smooth(&split)).map(|(s, t)| (s - t).abs()).fold(0.0, f64::max);
    println!("a needle: {off:.1e}");
    assert!(off < 1e-3, "{off:e}");
}

#[test]
fn a_cloud_on_a_line_has_the_heat_of_the_line() {
    let points: Vec<[f64; 3]> = (0..200).map(|i| [f64::from(i), 2.0 * f64::from(i), 0.0]).collect();
    let (decomposer, _) = check("line", &cloud(&points));
    let step = decomposer.operator().step_length();
    let sigma = 8.0 * 5.0_f64.sqrt();
    let schedule = Schedule::lengths(&[sigma], step).unwrap();
    let phi = decomposer.basis_of_vertex(100, &schedule, Progress::none()).unwrap().scaling_function;
    let moment: f64 = phi.iter().enumerate().map(|(i, v)| v * 5.0 * (i as f64 - 100.0).powi(2)).sum();
    assert!((moment / (0.5 * sigma * sigma) - 1.0).abs() < 1e-6, "{moment}");
    // Uneven distances.
    let uneven: Vec<[f64; 3]> = (0..120).map(|i| [1.05_f64.powi(i), 0.0, 0.0]).collect();
    check("uneven line", &cloud(&uneven));
}

#[test]
fn where_nothing_can_move_all_keep_their_value() {
    let one = [[1.0, 2.0, 3.0]];
    let spot = [[4.0, 4.0, 4.0]; 30];
    let still: Vec<(&str, Shape)> = vec![
        ("one point", cloud(&one)),
        ("one vertex", mesh(&one, &[])),
        ("no faces", mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[])),
        ("no edges", Shape::Graph(Graph::new(5, &[]).unwrap())),
        ("loops", Shape::Graph(Graph::new(2, &[(0, 0, 1.0), (1, 1, 2.0)]).unwrap())),
    ];
    for (name, shape) in still {
        let (_, bands) = check(name, &shape);
        (0..shape.n_vertices()).for_each(|x| keeps_its_value(name, &bands, x));
    }
    // At one spot all are one vertex, whose value is their mean.
    for (name, shape) in
        [("cloud at a spot", cloud(&spot)), ("mesh at a spot", mesh(&spot, &[[0, 1, 2], [5, 6, 7]]))]
    {
        let (_, bands) = check(name, &shape);
        let mean = noise(30).iter().sum::<f64>() / 30.0;
        assert!(bands.coarsest().iter().all(|v| (v - mean).abs() < 1e-14), "{name}");
    }
}

#[test]
fn two_points_exchange_what_they_have_whatever_way_they_lie() {
    for d in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, -0.3, 2.0]] {
        let (_, bands) =
            check("two points", &cloud(&[[1.0, 2.0, 3.0], [1.0 + d[0], 2.0 + d[1], 3.0 + d[2]]]));
        let (s, f) = (bands.coarsest(), noise(2));
        assert!((s[0] - s[1]).abs() < 1e-3 * (f[0] - f[1]).abs(), "{d:?}: {s:?}");
        assert!((s[0] + s[1] - f[0] - f[1]).abs() < ACCURACY, "{d:?}: {s:?}");
    }
}

#[test]
fn an_empty_shape_has_empty_bands_or_is_refused() {
    for shape in
        [cloud_or_none(), mesh_or_none(), Graph::new(0, &[]).ok().map(Shape::Graph)].into_iter().flatten()
    {
        let decomposer = decomposer(&shape);
        assert_eq!(decomposer.rows("a test").unwrap().n_vertices(), 0);
        let bands = decomposer.decompose(&[], 1, &Schedule::dyadic(2).unwrap());
        assert!(bands.map_or(true, |bands| bands.coarsest().is_empty()));
    }
}

fn cloud_or_none() -> Option<Shape> {
    adwave::shape::PointCloud::new(Vec::new()).ok().map(Shape::Cloud)
}

fn mesh_or_none() -> Option<Shape> {
    adwave::shape::Mesh::new(Vec::new(), adwave::shape::Polygons::new()).ok().map(Shape::Mesh)
}

#[test]
fn all_at_once() {
    let (mut points, mut triangles) = sample("sphere", 300);
    let n = points.len() as u32;
    points.extend([[0.0, 0.0, 9.0], [5.0, 5.0, 5.0], points[0], points[1], [0.0, 0.0, 9.0]]);
    points.extend([[1e-200, 0.0, 0.0], [300.0, 0.0, 0.0], [300.0, 1e-9, 0.0]]);
    triangles.extend([
        [n, n, n + 4],
        [0, 1, n],
        [n + 2, n + 3, 7],
        [n + 5, 3, 4],
        [n + 6, n + 7, 0],
        [9, 8, 3],
    ]);
    triangles.push(triangles[20]);
    triangles[30].swap(0, 1);
    check("all at once", &mesh(&points, &triangles));
    check("its cloud", &cloud(&points));
}
