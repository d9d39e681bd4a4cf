//! Laws for every shape: the walk is a walk, bands sum to the signal, and the way a shape is placed, scaled or
//! listed does not matter.

use adwave::bands::Schedule;
use adwave::operator::{CloudGraph, OperatorParams};
use adwave::sample::Sample;
use adwave::shape::{CloudArea, Graph, Mesh, MeshArea, PointCloud, Polygons, Shape, WeldMode};
use adwave::{Decomposer, Progress};
use nalgebra::{Rotation3, Vector3};

/// Sums of a row's few entries.
const ROW_SUM: f64 = 1e-14;
/// A few roundings for each of 128 steps, relative to the signal.
const CONSTANT: f64 = 1e-13;
/// Default accuracy of a band, for signals of about unit size.
const ACCURACY: f64 = 1e-10;
/// Adding up nine bands, relative to the diagonal.
const RECONSTRUCTION: f64 = 1e-12;
/// Rounding of rotating the coordinates and back, through 128 steps, relative to the diagonal.
const COMMUTES: f64 = 1e-10;

const LEVELS: usize = 8;

fn sample(name: &str, n_vertices: usize) -> (Vec<[f64; 3]>, Polygons) {
    let sample = Sample::from_name(name, Some(n_vertices)).unwrap();
    (sample.points, sample.faces)
}

fn mesh(points: &[[f64; 3]], faces: &Polygons) -> Shape {
    Shape::Mesh(Mesh::new(points.to_vec(), faces.clone()).unwrap())
}

fn cloud(points: &[[f64; 3]]) -> Shape {
    Shape::Cloud(PointCloud::new(points.to_vec()).unwrap())
}

/// A path of `n` nodes with uneven weights, and a node by itself.
fn graph(n: u32) -> Shape {
    let edges: Vec<_> = (1..n).map(|i| (i - 1, i, 1.0 + f64::from(i % 3))).collect();
    Shape::Graph(Graph::new(n as usize + 1, &edges).unwrap())
}

/// Shapes of every kind with every option of the operator.
fn all() -> Vec<(String, Shape, OperatorParams)> {
    let mut shapes = Vec::new();
    let default = OperatorParams::default();
    let (points, faces) = sample("torus", 1500);
    for area in [MeshArea::Barycentric, MeshArea::MixedVoronoi] {
        shapes.push((format!("torus {area:?}"), mesh(&points, &faces), default.with_mesh_area(area)));
    }
    shapes.push(("torus, 2 rings".into(), mesh(&points, &faces), default.with_rings(2)));
    for area in [CloudArea::KthNeighbor, CloudArea::Unit, CloudArea::TangentVoronoi] {
        shapes.push((format!("cloud {area:?}"), cloud(&points), default.with_cloud_area(area)));
    }
    let directed = default.with_cloud_graph(CloudGraph::Directed);
    shapes.push(("directed cloud".into(), cloud(&points), directed));
    shapes.push(("graph".into(), graph(400), default));
    shapes.push(("broken mesh".into(), broken(), default));
    shapes.push(("broken mesh, not welded".into(), broken(), default.with_weld(WeldMode::Off)));
    shapes.push(("one point".into(), cloud(&[[1.0, 2.0, 3.0]]), default));
    shapes.push(("two points".into(), cloud(&[[1.0, 2.0, 3.0], [1.0, 2.0, 4.0]]), default));
    let equal = vec![[4.0, 4.0, 4.0]; 30];
    shapes.push(("equal points".into(), cloud(&equal), default));
    shapes.push(("equal points, not welded".into(), cloud(&equal), default.with_weld(WeldMode::Off)));
    let line: Vec<_> = (0..50).map(|i| [f64::from(i * i), 0.0, 0.0]).collect();
    let flat = Polygons::from_triangles(&(0..48).map(|i| [i, i + 1, i + 2]).collect::<Vec<_>>());
    shapes.push(("mesh without any area".into(), mesh(&line, &flat), default));
    shapes
}

/// Everything that is wrong with meshes at once.
fn broken() -> Shape {
    let (mut points, mut faces) = sample("sphere", 300);
    let n = points.len() as u32;
    points.extend([[0.0, 0.0, 9.0], [5.0, 5.0, 5.0], points[0], points[1], [0.0, 0.0, 9.0]]);
    points.extend([[1e-200, 0.0, 0.0], [300.0, 0.0, 0.0]]);
    faces.push(&[n, n, n + 4]); // a point
    faces.push(&[0, 1, n]); // a third face at an edge
    faces.push(&[n + 2, n + 3, 7]); // corners at the positions of others
    let first = faces.get(0).to_vec();
    faces.push(&first); // again
    faces.push(&[1, 2]); // no face at all
    faces.push(&[2, 2, 2]);
    faces.push(&[10, 20, 30, 40, 50]); // a polygon across the inside
    faces.push(&[11, n + 5, n + 6]); // a very long and thin triangle
    mesh(&points, &faces)
}

fn signal(shape: &Shape) -> (Vec<f64>, usize) {
    match shape.points() {
        Some(points) => (points.as_flattened().to_vec(), 3),
        None => ((0..shape.n_vertices()).map(|i| (i as f64 * 0.37).sin()).collect(), 1),
    }
}

fn bands(shape: &Shape, params: &OperatorParams, signal: &[f64], n_channels: usize) -> adwave::bands::Bands {
    let decomposer = Decomposer::with_params(shape, params, Progress::none()).expect("nobody can stop this");
    let schedule = Schedule::dyadic(LEVELS).unwrap();
    decomposer.decompose(signal, n_channels, &schedule).unwrap()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(a.iter().chain(b).all(|v| v.is_finite()));
    largest
}

#[test]
fn rows_of_the_walk_are_probabilities_and_the_law_is_stationary() {
    for (name, shape, params) in all() {
        let decomposer =
            Decomposer::with_params(&shape, &params, Progress::none()).expect("nobody can stop this");
        let walk = decomposer.rows("a test").unwrap();
        let pi = walk.stationary();
        let mut after = vec![0.0; pi.len()];
        for x in 0..walk.n_vertices() {
            let (columns, weights) = walk.row(x);
            assert!(weights.iter().all(|&w| w >= 0.0), "{name}: row {x}");
            let sum = walk.diagonal(x) + weights.iter().sum::<f64>();
            assert!((sum - 1.0).abs() <= ROW_SUM, "{name}: row {x} sums to {sum}");
            let stays = if weights.iter().sum::<f64>() == 0.0 { 1.0 } else { 0.5 };
            assert!((walk.diagonal(x) - stays).abs() <= ROW_SUM, "{name}: row {x} is not lazy");
            after[x] += pi[x] * walk.diagonal(x);
            for (&y, &w) in columns.iter().zip(weights) {
                after[y as usize] += pi[x] * w;
            }
        }
        assert!((pi.iter().sum::<f64>() - 1.0).abs() < CONSTANT, "{name}");
        if walk.is_reversible() {
            assert!(largest_difference(pi, &after) < ROW_SUM, "{name}: π is not stationary");
        }
    }
}

#[test]
fn bands_sum_to_the_signal_and_constants_have_none() {
    for (name, shape, params) in all() {
        let (values, n_channels) = signal(&shape);
        let size = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let split = bands(&shape, &params, &values, n_channels);
        let error = largest_difference(&split.reconstruct(), &values);
        assert!(error <= RECONSTRUCTION * size, "{name}: off by {error}");
        let scaling = split.all_scaling();
        for (j, level) in scaling.chunks_exact(values.len()).enumerate() {
            assert_eq!(*split.scaling(j), *level, "{name}: S_{j} by itself and with the others");
        }

        let constant = vec![0.3; shape.n_vertices()];
        let split = bands(&shape, &params, &constant, 1);
        let error = largest_difference(&split.scaling(LEVELS), &constant);
        assert!(error <= CONSTANT, "{name}: a constant moved by {error}");
        assert!(split.wavelets().flatten().all(|w| w.abs() <= CONSTANT), "{name}");
    }
}

#[test]
fn vertices_without_neighbors_keep_their_value() {
    let shape = broken();
    let (values, _) = signal(&shape);
    let split = bands(&shape, &OperatorParams::default(), &values, 3);
    let alone = shape.points().unwrap().iter().position(|p| *p == [5.0, 5.0, 5.0]).unwrap();
    for level in split.all_scaling().chunks_exact(values.len()) {
        assert_eq!(level[3 * alone..][..3], [5.0, 5.0, 5.0]);
    }
}

#[test]
fn rotating_moving_and_scaling_commute_with_the_transform() {
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let (scale, shift) = (7.3, Vector3::new(3.0, -2.0, 0.5));
    let place = |p: &[f64; 3]| -> [f64; 3] { (turn * Vector3::from(*p) * scale + shift).into() };
    // A sphere whose vertices spread evenly has many neighbors at nearly equal distances; the grid of the torus has ties.
    for name in ["sphere", "torus", "plane"] {
        let (points, faces) = sample(name, 2000);
        let placed: Vec<_> = points.iter().map(place).collect();
        let pairs = [(mesh(&points, &faces), mesh(&placed, &faces)), (cloud(&points), cloud(&placed))];
        for (before, after) in &pairs {
            let params = OperatorParams::default();
            let a = bands(before, &params, points.as_flattened(), 3);
            let b = bands(after, &params, placed.as_flattened(), 3);
            for level in 0..=LEVELS {
                let expected: Vec<_> = a.scaling(level).as_chunks().0.iter().map(place).collect();
                let error = largest_difference(expected.as_flattened(), &b.scaling(level));
                assert!(error <= COMMUTES * after.diagonal(), "{name}: S_{level} is off by {error}");
                assert!((a.sigma[level] * scale - b.sigma[level]).abs() <= COMMUTES * b.sigma[level]);
            }
            for level in 0..LEVELS {
                let expected: Vec<_> = a
                    .wavelet(level + 1)
                    .as_chunks()
                    .0
                    .iter()
                    .map(|w: &[f64; 3]| -> [f64; 3] { (turn * Vector3::from(*w) * scale).into() })
                    .collect();
                let error = largest_difference(expected.as_flattened(), b.wavelet(level + 1));
                assert!(error <= COMMUTES * after.diagonal(), "{name}: W_{} is off by {error}", level + 1);
            }
        }
    }
}

#[test]
fn listing_the_vertices_in_another_order_permutes_the_result_bit_for_bit() {
    let (points, faces) = sample("knot", 3000);
    let n = points.len();
    // A stride that shares no factor with n visits every vertex once.
    let stride = (n / 3..n).find(|s| gcd(*s, n) == 1).unwrap();
    let new_index: Vec<u32> = (0..n).map(|x| (x * stride % n) as u32).collect();
    let mut shuffled = vec![[0.0; 3]; n];
    for x in 0..n {
        shuffled[new_index[x] as usize] = points[x];
    }
    let renamed: Vec<[u32; 3]> =
        faces.iter().map(|f| std::array::from_fn(|c| new_index[f[c] as usize])).collect();
    let pairs = [
        (mesh(&points, &faces), mesh(&shuffled, &Polygons::from_triangles(&renamed))),
        (cloud(&points), cloud(&shuffled)),
    ];
    for (before, after) in &pairs {
        let params = OperatorParams::default();
        let a = bands(before, &params, points.as_flattened(), 3);
        let b = bands(after, &params, shuffled.as_flattened(), 3);
        for level in 0..LEVELS {
            for (x, &y) in new_index.iter().enumerate() {
                let y = y as usize;
                assert_eq!(a.wavelet(level + 1)[3 * x..][..3], b.wavelet(level + 1)[3 * y..][..3]);
            }
        }
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[test]
fn channels_do_not_mix_and_threads_do_not_matter() {
    let (points, faces) = sample("knot", 5000);
    let shape = mesh(&points, &faces);
    let params = OperatorParams::default();
    let on = |threads: usize, values: &[f64], n_channels: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bands(&shape, &params, values, n_channels))
    };
    let together = on(1, points.as_flattened(), 3);
    for threads in [2, 3] {
        assert_eq!(on(threads, points.as_flattened(), 3), together, "{threads} threads");
    }
    for channel in 0..3 {
        let values: Vec<f64> = points.iter().map(|p| p[channel]).collect();
        let alone = on(2, &values, 1);
        for level in 0..LEVELS {
            let of_three: Vec<f64> =
                together.wavelet(level + 1).iter().skip(channel).step_by(3).copied().collect();
            let error = largest_difference(alone.wavelet(level + 1), &of_three);
            assert!(error <= RECONSTRUCTION * shape.diagonal(), "channel {channel}: {error}");
        }
    }
}

#[test]
fn a_seam_that_differs_is_kept_and_does_not_split_the_surface() {
    // Every triangle with corners of its own, as in an STL: the walk crosses, and a color that jumps comes back.
    let (points, faces) = sample("sphere", 500);
    let soup: Vec<_> = faces.corners().iter().map(|&v| points[v as usize]).collect();
    let own: Vec<[u32; 3]> = (0..faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let torn = mesh(&soup, &Polygons::from_triangles(&own));
    let whole = bands(&mesh(&points, &faces), &OperatorParams::default(), points.as_flattened(), 3);
    let split = bands(&torn, &OperatorParams::default(), soup.as_flattened(), 3);
    for level in 0..=LEVELS {
        for (corner, &v) in faces.corners().iter().enumerate() {
            assert_eq!(split.scaling(level)[3 * corner..][..3], whole.scaling(level)[3 * v as usize..][..3]);
        }
    }
    let by_face: Vec<f64> = (0..soup.len()).map(|corner| (corner / 3 % 7) as f64).collect();
    let split = bands(&torn, &OperatorParams::default(), &by_face, 1);
    assert!(largest_difference(&split.reconstruct(), &by_face) <= RECONSTRUCTION * 7.0);
}

#[test]
fn the_cycle_has_its_closed_form() {
    // On a cycle of equal weights a wave of angle θ is an eigenvector: Φ₁ f = (½ + ½ cos θ) f.
    let n = 64_u32;
    let edges: Vec<_> = (0..n).map(|i| (i, (i + 1) % n, 2.0)).collect();
    let shape = Shape::Graph(Graph::new(n as usize, &edges).unwrap());
    let angle = 2.0 * std::f64::consts::PI * 5.0 / f64::from(n);
    let wave: Vec<f64> = (0..n).map(|i| (angle * f64::from(i)).cos()).collect();
    let split = bands(&shape, &OperatorParams::default(), &wave, 1);
    let eigenvalue = 0.5 + 0.5 * angle.cos();
    for level in 1..=LEVELS {
        let factor = eigenvalue.powi(1 << (level - 1));
        let expected: Vec<f64> = wave.iter().map(|w| factor * w).collect();
        assert!(largest_difference(&split.scaling(level), &expected) < ACCURACY, "level {level}");
    }
    // Each step of a hop or none: s² = ½.
    assert!((split.sigma[1] - 0.5_f64.sqrt()).abs() < ROW_SUM);
}

#[test]
fn one_step_on_a_regular_triangulation_is_as_wide_as_the_formula_says() {
    // In the middle of equilateral triangles of side 1 all six neighbors are alike: s² = ½·1.
    let (rows, columns) = (80_u32, 80_u32);
    let mut points = Vec::new();
    for r in 0..rows {
        for c in 0..columns {
            points.push([f64::from(c) + 0.5 * f64::from(r), f64::from(r) * 0.75_f64.sqrt(), 0.0]);
        }
    }
    let mut triangles = Vec::new();
    for r in 1..rows {
        for c in 1..columns {
            let [a, b] = [(r - 1) * columns + c, r * columns + c];
            triangles.push([a - 1, a, b - 1]);
            triangles.push([a, b, b - 1]);
        }
    }
    let decomposer = Decomposer::new(&mesh(&points, &Polygons::from_triangles(&triangles)));
    let (at, _) =
        points.iter().enumerate().find(|(_, p)| **p == points[(40 * columns + 40) as usize]).unwrap();
    let class = decomposer.vertex_map().welded(at);
    let (neighbors, weights) = decomposer.rows("a test").unwrap().row(class);
    assert_eq!(neighbors.len(), 6);
    assert!(weights.iter().all(|w| (w - 1.0 / 12.0).abs() < ROW_SUM));
    assert!((decomposer.operator().step_length() - 0.5_f64.sqrt()).abs() < 1e-9);
}
