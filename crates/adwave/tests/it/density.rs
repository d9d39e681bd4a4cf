//! Walks from which the density of the samples is taken out: their eigenvalues are those of even sampling.

use adwave::bands::Schedule;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::sample::Sample;
use adwave::shape::{Graph, PointCloud, Shape};
use adwave::{Decomposer, Progress};
use nalgebra::{DMatrix, SymmetricEigen};
use std::f64::consts::PI;

/// Functions that the first eigenvalues are looked for among.
const WIDTH: usize = 24;

/// Points on a circle, `jump` times as dense on one half as on the other.
fn circle(n: usize, jump: f64) -> Vec<[f64; 3]> {
    let dense = (n as f64 * jump / (1.0 + jump)) as usize;
    let half = |m: usize, from: f64| (0..m).map(move |i| from + (i as f64 + 0.5) / m as f64 * PI);
    half(dense, 0.0).chain(half(n - dense, PI)).map(|a| [a.cos(), a.sin(), 0.0]).collect()
}

/// Points on a sphere, `jump` times as dense on one half as on the other, each half a Fibonacci lattice.
fn sphere(n: usize, jump: f64) -> Vec<[f64; 3]> {
    let dense = (n as f64 * jump / (1.0 + jump)) as usize;
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let half = |m: usize, side: f64| {
        (0..m).map(move |i| {
            let (z, a) = ((i as f64 + 0.5) / m as f64, golden * i as f64);
            let r = (1.0 - z * z).sqrt();
            [r * a.cos(), r * a.sin(), side * z]
        })
    };
    half(dense, 1.0).chain(half(n - dense, -1.0)).collect()
}

/// The first ten eigenvalues after 0 of what generates the diffusion, in units of 1/area, by subspace iteration: `time` steps long
/// rounds, then Rayleigh–Ritz.
fn eigenvalues(shape: &Shape, params: &OperatorParams, dimension: f64) -> Vec<f64> {
    let decomposer = Decomposer::with_params(shape, params, Progress::none()).unwrap();
    let (diffusion, n) = (decomposer.rows("a test").unwrap(), decomposer.n_vertices());
    let pi = diffusion.stationary();
    let map = decomposer.vertex_map();
    // σ² = n_steps·step² = 2·dimension·time.
    let time_of_step = diffusion.step_length().powi(2) / (2.0 * dimension);
    let steps = (0.15 / time_of_step).ceil();
    let schedule = Schedule::real(vec![steps]).unwrap();
    let mixed = |i: usize| (i as u32).wrapping_mul(2_654_435_761).rotate_left(13).wrapping_mul(0x85eb_ca6b);
    let mut f: Vec<f64> = (0..n * WIDTH).map(|i| f64::from(mixed(i)) / f64::from(u32::MAX) - 0.5).collect();
    let mut values = Vec::new();
    for _ in 0..6 {
        let smooth = decomposer.request(&f, WIDTH, &schedule).accuracy(1e-9).bands().unwrap();
        let smooth = smooth.coarsest().to_vec();
        let column = |g: &[f64]| DMatrix::from_row_slice(n, WIDTH, g);
        let (before, after) = (column(&f), column(&smooth));
        let weight = |v: usize| pi[map.welded(v)];
        let weighted = DMatrix::from_fn(n, WIDTH, |v, c| weight(v) * before[(v, c)]);
        let (gram, moved) = (weighted.transpose() * &before, weighted.transpose() * &after);
        let low = gram.cholesky().unwrap().l().try_inverse().unwrap();
        let reduced = &low * moved * low.transpose();
        let eigen = SymmetricEigen::new((&reduced + reduced.transpose()) * 0.5);
        let mut order: Vec<usize> = (0..WIDTH).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        values =
            order.iter().map(|&k| -eigen.eigenvalues[k].max(1e-300).ln() / (steps * time_of_step)).collect();
        let next = &after * low.transpose() * &eigen.eigenvectors;
        let norm = |c: usize| next.column(c).iter().enumerate().map(|(v, g)| weight(v) * g * g).sum::<f64>();
        let scale: Vec<f64> = (0..WIDTH).map(|c| 1.0 / norm(c).sqrt().max(1e-300)).collect();
        f = (0..n * WIDTH).map(|i| next[(i / WIDTH, i % WIDTH)] * scale[i % WIDTH]).collect();
    }
    values[1..=10].to_vec()
}

fn cloud(points: Vec<[f64; 3]>) -> Shape {
    Shape::Cloud(PointCloud::new(points).unwrap())
}

/// Largest relative distance between two lists of eigenvalues.
fn apart(found: &[f64], expected: &[f64]) -> f64 {
    found.iter().zip(expected).map(|(f, e)| (f / e - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn a_circle_and_a_sphere_with_a_jump_of_ten_have_their_own_eigenvalues() {
    let on_circle = [1.0, 1.0, 4.0, 4.0, 9.0, 9.0, 16.0, 16.0, 25.0, 25.0];
    let on_sphere = [2.0, 2.0, 2.0, 6.0, 6.0, 6.0, 6.0, 6.0, 12.0, 12.0];
    let even = OperatorParams::default().with_density_invariant(true);
    for (name, points, dimension, expected) in
        [("circle", circle(1500, 10.0), 1.0, on_circle), ("sphere", sphere(12_000, 10.0), 2.0, on_sphere)]
    {
        let shape = cloud(points);
        let found = eigenvalues(&shape, &even, dimension);
        assert!(apart(&found, &expected) < 0.02, "{name}: {found:?} for {expected:?}");
        let walk = eigenvalues(&shape, &OperatorParams::default(), dimension);
        assert!(apart(&walk, &expected) > 0.2, "{name}: the walk sees the density");
    }
}

/// Φ₁ of a graph with `w(x,y)/(q(x)q(y))` by the formula.
#[test]
fn weights_of_a_graph_are_divided_by_both_degrees() {
    // Of sizes whose products neither fit nor are told from 0.
    let edges = [(0, 1, 1e300), (1, 2, 2e300), (2, 3, 1e-300), (3, 0, 5e-300), (3, 4, 1e-300)];
    let params = OperatorParams::default().with_density_invariant(true);
    let shape = Shape::Graph(Graph::new(6, &edges).unwrap());
    let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
    let weight = |x: u32, y: u32| {
        edges.iter().filter(|e| (e.0, e.1) == (x, y) || (e.1, e.0) == (x, y)).map(|e| e.2).sum::<f64>()
    };
    let degree = |x: u32| (0..6).map(|y| weight(x, y)).sum::<f64>();
    let map = decomposer.vertex_map();
    for x in 0..6_u32 {
        let row: Vec<f64> =
            (0..6).map(|y| if degree(y) > 0.0 { weight(x, y) / degree(y) } else { 0.0 }).collect();
        let sum: f64 = row.iter().sum();
        let (columns, values) = decomposer.rows("a test").unwrap().row(map.welded(x as usize));
        let found = |y: usize| {
            columns
                .iter()
                .zip(values)
                .filter(|(c, _)| **c as usize == map.welded(y))
                .map(|(_, v)| *v)
                .sum::<f64>()
        };
        for (y, w) in row.iter().enumerate() {
            let expected = if sum > 0.0 { 0.5 * w / sum } else { 0.0 };
            assert!((found(y) - expected).abs() < 1e-12, "({x}, {y}): {} for {expected}", found(y));
        }
    }
}

#[test]
fn a_mesh_with_a_tenfold_jump_walks_as_far_on_either_side() {
    // A strip, ten times as dense on the left.
    let xs: Vec<f64> =
        (0..=100).map(|i| 0.1 * f64::from(i)).chain((1..=20).map(|i| 10.0 + f64::from(i))).collect();
    let (wide, high) = (xs.len(), 31);
    let points: Vec<[f64; 3]> =
        (0..high).flat_map(|j| xs.iter().map(move |x| [*x, f64::from(j as u32), 0.0])).collect();
    let at = |i: usize, j: usize| (j * wide + i) as u32;
    let faces: Vec<[u32; 3]> = (0..high - 1)
        .flat_map(|j| {
            (0..wide - 1).flat_map(move |i| {
                [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
            })
        })
        .collect();
    let shape = Shape::Mesh(adwave::shape::Mesh::new(points, faces.into()).unwrap());
    let spread = |params: &OperatorParams, x: usize| {
        let decomposer = Decomposer::with_params(&shape, params, Progress::none()).unwrap();
        let (map, points) = (decomposer.vertex_map(), decomposer.positions());
        let x = map.welded(x);
        let (columns, values) = decomposer.rows("a test").unwrap().row(x);
        let along = |y: u32| (points[y as usize][0] - points[x][0]).powi(2);
        columns.iter().zip(values).map(|(&y, w)| w * along(y)).sum::<f64>()
    };
    let (dense, sparse) = (15 * wide + 50, 15 * wide + 110);
    let ratio = |params: &OperatorParams| spread(params, sparse) / spread(params, dense);
    let plain = ratio(&OperatorParams::default());
    let even = ratio(&OperatorParams::default().with_density_invariant(true));
    assert!(plain > 20.0 && (even - 1.0).abs() < 0.5, "{plain} by the walk, {even} without density");
}

#[test]
fn points_in_one_spot_and_clumps_end_and_give_rows_that_sum_to_one() {
    let spot = vec![[1.0, 2.0, 3.0]; 3000];
    let mut clump: Vec<[f64; 3]> = (0..3000).map(|i| [1e-7 * f64::from(i), 0.0, 0.0]).collect();
    clump.extend((0..300).map(|i| [f64::from(i), 1.0, 0.0]));
    for (points, weld) in
        [(spot, adwave::shape::WeldMode::Off), (clump, adwave::shape::WeldMode::EqualPositions)]
    {
        let params = OperatorParams::default().with_density_invariant(true).with_weld(weld);
        let decomposer = Decomposer::with_params(&cloud(points), &params, Progress::none()).unwrap();
        let diffusion = decomposer.rows("a test").unwrap();
        assert!(diffusion.nnz() < 200 * diffusion.n_vertices(), "{} entries", diffusion.nnz());
        assert!(
            (0..diffusion.n_vertices()).all(|x| diffusion
                .row(x)
                .1
                .iter()
                .all(|w| w.is_finite() && *w >= 0.0))
        );
        assert!((diffusion.stationary().iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn steps_that_keep_creases_do_not_cross_them() {
    let across = |sample: &Sample, params: &OperatorParams| {
        let shape =
            Shape::Mesh(adwave::shape::Mesh::new(sample.points.clone(), sample.faces.clone()).unwrap());
        let decomposer = Decomposer::with_params(&shape, params, Progress::none()).unwrap();
        let geometry = decomposer.geometry().unwrap();
        let normals = adwave::shape::vertex_normals(geometry.points(), geometry.triangles());
        let mut turned = 0.0;
        for x in 0..geometry.n_vertices() {
            let (columns, values) = decomposer.rows("a test").unwrap().row(x);
            for (&y, w) in columns.iter().zip(values) {
                let dot: f64 = normals[x].iter().zip(&normals[y as usize]).map(|(a, b)| a * b).sum();
                if dot < 0.8 {
                    turned += w;
                }
            }
        }
        let n = geometry.n_vertices() as f64;
        let bands = decomposer.decompose(geometry.points().as_flattened(), 3, &Schedule::dyadic(3).unwrap());
        assert!(bands.unwrap().coarsest().iter().all(|v| v.is_finite()));
        turned / n
    };
    let bracket = Sample::from_name("bracket", Some(4000)).unwrap();
    for kind in [OperatorKind::Walk, OperatorKind::Surface] {
        let plain = OperatorParams::default().with_kind(kind);
        let keeping = plain.with_keep_creases(true);
        let (before, after) = (across(&bracket, &plain), across(&bracket, &keeping));
        assert!(before > 0.01 && after < 0.05 * before, "{kind:?}: {before} before, {after} after");
    }
}
