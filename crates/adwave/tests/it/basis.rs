//! The explicit basis: laws, closed forms, dense powers, the two methods against one another, and what is refused.

use adwave::bands::Schedule;
use adwave::basis::{
    Basis, BasisError, BasisParams, CompressedRows, Value, basis, basis_by_squaring, one_vertex,
};
use adwave::operator::{CloudGraph, Diffusion, OperatorParams, local_operator};
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, PreparedGeometry, Shape, VertexMap, WeldMode};
use adwave::{Cancelled, Progress};
use proptest::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Rounding of double precision in some ten products.
const ROUNDING: f64 = 1e-13;
/// Rounding of single precision in some hundred sums of numbers up to 1.
const SINGLE_ROUNDING: f64 = 1e-6;
/// Error of the Chebyshev sum of one vertex, times √(π(y)/π(x)) ≤ 30 on the graphs here.
const ONE_VERTEX_ERROR: f64 = 1e-9;
/// Largest difference of the two methods in a value, and in the number of entries.
const METHODS_DIFFER: f64 = 1e-5;
const COUNTS_DIFFER: f64 = 0.02;

fn diffusion_of(shape: &Shape) -> Diffusion {
    let geometry = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    Diffusion::new(
        local_operator(&geometry, &OperatorParams::default(), Progress::none()).unwrap(),
        Progress::none(),
    )
    .unwrap()
}

fn walk_on_graph(n_nodes: usize, edges: &[(u32, u32, f64)]) -> Diffusion {
    let graph = Graph::new(n_nodes, edges).unwrap();
    // In the order of the nodes, so that tests can name them.
    let geometry = PreparedGeometry::from_ordered_graph(graph);
    Diffusion::new(
        local_operator(&geometry, &OperatorParams::default(), Progress::none()).unwrap(),
        Progress::none(),
    )
    .unwrap()
}

/// An octahedron cut in four as often as asked for, with bumps: 4^n·8 triangles, 4^n·4 + 2 vertices.
fn bumpy_sphere(n_cuts: usize) -> Shape {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut p = [0.0; 3];
            p[axis] = sign;
            points.push(p);
        }
    }
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for (a, b, c) in [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    {
        triangles.push([a, b, c]);
    }
    for _ in 0..n_cuts {
        let mut middle = std::collections::HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut between = |u: u32, v: u32| {
                *middle.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    let (p, q) = (points[u as usize], points[v as usize]);
                    points.push(std::array::from_fn(|k| p[k] + q[k]));
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (between(a, b), between(b, c), between(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
        for p in &mut points {
            let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
            *p = p.map(|c| c / length);
        }
    }
    for p in &mut points {
        let bump = 1.0 + 0.1 * (7.0 * p[0]).sin() * (5.0 * p[1]).cos() + 0.05 * (11.0 * p[2]).sin();
        *p = p.map(|c| c * bump);
    }
    Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap())
}

fn params(n_levels: usize) -> BasisParams {
    BasisParams::new(Schedule::dyadic(n_levels).unwrap())
}

/// Φ₁ as a dense matrix.
fn dense(walk: &Diffusion) -> Vec<Vec<f64>> {
    let n = walk.n_vertices();
    (0..n)
        .map(|x| {
            let mut row = vec![0.0; n];
            row[x] = walk.diagonal(x);
            for (&y, &w) in walk.row(x).0.iter().zip(walk.row(x).1) {
                row[y as usize] += w;
            }
            row
        })
        .collect()
}

fn product(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    a.iter()
        .map(|row| (0..b.len()).map(|y| row.iter().zip(b).map(|(v, from)| v * from[y]).sum()).collect())
        .collect()
}

fn power(matrix: &[Vec<f64>], steps: u64) -> Vec<Vec<f64>> {
    match steps {
        1 => matrix.to_vec(),
        n if n % 2 == 0 => power(&product(matrix, matrix), n / 2),
        n => product(&power(matrix, n - 1), matrix),
    }
}

fn assert_near<V: Value>(level: &CompressedRows<V>, expected: &[Vec<f64>], tolerance: f64) {
    assert_eq!(level.n_rows(), expected.len());
    for (x, row) in expected.iter().enumerate() {
        for (y, &value) in row.iter().enumerate() {
            let found: f64 = level.get(x, y).into();
            assert!((found - value).abs() <= tolerance, "({x}, {y}): {found}, not {value}");
        }
    }
}

fn assert_well_formed<V: Value>(level: &CompressedRows<V>, tolerance: f64) {
    for x in 0..level.n_rows() {
        let (columns, values) = level.row(x);
        assert!(columns.windows(2).all(|pair| pair[0] < pair[1]), "row {x} is not sorted");
        assert!(values.iter().all(|&v| v.into() > 0.0), "row {x} has an entry that is not positive");
        let sum: f64 = values.iter().map(|&v| v.into()).sum();
        assert!((sum - 1.0).abs() < tolerance, "row {x} sums to {sum}");
    }
}

fn random_graph() -> impl Strategy<Value = (usize, Vec<(u32, u32, f64)>)> {
    (1_usize..14).prop_flat_map(|n| {
        let edge = (0..n as u32, 0..n as u32, 0.05_f64..3.0);
        (Just(n), prop::collection::vec(edge, 0..30))
    })
}

/// Stochastic matrices with some entries 0, as dense rows.
fn random_walk() -> impl Strategy<Value = Vec<Vec<f64>>> {
    (1_usize..10).prop_flat_map(|n| {
        let entry = prop_oneof![Just(0.0), 0.1_f64..1.0];
        prop::collection::vec(prop::collection::vec(entry, n), n).prop_map(|mut rows| {
            for (x, row) in rows.iter_mut().enumerate() {
                row[x] += 0.5;
                let sum: f64 = row.iter().sum();
                for v in row {
                    *v /= sum;
                }
            }
            rows
        })
    })
}

fn from_dense(rows: &[Vec<f64>]) -> Diffusion {
    let n = rows.len();
    let offsets: Vec<usize> = (0..=n).map(|x| x * n).collect();
    let columns: Vec<u32> = (0..n * n).map(|k| (k % n) as u32).collect();
    Diffusion::from_rows(&offsets, &columns, &rows.concat()).unwrap()
}

fn check_against_dense(walk: &Diffusion) -> Result<(), TestCaseError> {
    let everything = params(5).with_drop_tolerance(0.0);
    let squared = basis_by_squaring(walk, &everything, Progress::none()).unwrap();
    let fast = basis(walk, &everything, Progress::none()).unwrap();
    let first = dense(walk);
    for (j, &steps) in squared.steps.iter().enumerate() {
        let expected = power(&first, steps);
        assert_near(&squared.scaling[j], &expected, ROUNDING);
        assert_near(&fast.scaling[j], &expected, SINGLE_ROUNDING);
        assert_well_formed(&fast.scaling[j], SINGLE_ROUNDING);
        for (x, row) in expected.iter().enumerate() {
            let at = one_vertex(walk, x, steps / 2, steps, 0.0, Progress::none()).unwrap();
            for (y, &value) in row.iter().enumerate() {
                prop_assert!((at.scaling.get(y) - value).abs() < ONE_VERTEX_ERROR);
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn graphs_give_dense_powers((n, edges) in random_graph()) {
        check_against_dense(&walk_on_graph(n, &edges))?;
    }

    #[test]
    fn directed_walks_give_dense_powers(rows in random_walk()) {
        check_against_dense(&from_dense(&rows))?;
    }

    #[test]
    fn deep_levels_of_graphs_give_dense_powers((n, edges) in random_graph(), last in 400_u64..5000) {
        let walk = walk_on_graph(n, &edges);
        let schedule = Schedule::new(vec![3, 40, 300, last]).unwrap();
        let everything = BasisParams::new(schedule).with_drop_tolerance(0.0);
        let found = basis(&walk, &everything, Progress::none()).unwrap();
        for (level, &steps) in found.scaling.iter().zip(&found.steps) {
            // Rounding of single precision grows with the number of products, some 200 here.
            assert_near(level, &power(&dense(&walk), steps), 2e-5);
        }
    }
}

#[test]
fn both_methods_give_the_same_matrices() {
    let walk = diffusion_of(&bumpy_sphere(5));
    assert_eq!(walk.n_vertices(), 4098);
    let fast = basis(&walk, &params(6), Progress::none()).unwrap();
    let squared = basis_by_squaring(&walk, &params(6), Progress::none()).unwrap();
    for (j, (a, b)) in fast.scaling.iter().zip(&squared.scaling).enumerate() {
        let ratio = a.nnz() as f64 / b.nnz() as f64;
        assert!((ratio - 1.0).abs() < COUNTS_DIFFER, "level {}: {} and {}", j + 1, a.nnz(), b.nnz());
        for x in 0..a.n_rows() {
            let (columns, values) = a.row(x);
            for (&y, &v) in columns.iter().zip(values) {
                assert!((f64::from(v) - b.get(x, y as usize)).abs() < METHODS_DIFFER);
            }
            for (&y, &v) in b.row(x).0.iter().zip(b.row(x).1) {
                assert!((f64::from(a.get(x, y as usize)) - v).abs() < METHODS_DIFFER);
            }
        }
        assert_well_formed(a, SINGLE_ROUNDING);
        assert_well_formed(b, ROUNDING);
    }
    assert!(fast.scaling[5].nnz() > 50 * walk.n_vertices(), "the mesh is large enough to drop entries");
    assert!(fast.info.largest_dropped[5] > 0.0);
    let actual: u64 = fast.info.bytes.iter().sum();
    let forecast = fast.info.forecast as f64 / actual as f64;
    assert!((0.9..2.0).contains(&forecast), "{forecast} times what the matrices take");
}

#[test]
fn rows_of_wavelets_sum_to_zero_and_add_up() {
    let walk = diffusion_of(&bumpy_sphere(3));
    let fast = basis(&walk, &params(4), Progress::none()).unwrap();
    for j in 1..=4 {
        let wavelets = fast.wavelet(j);
        for x in 0..walk.n_vertices() {
            let (columns, values) = wavelets.row(x);
            assert_eq!(fast.wavelet_row(j, x), (columns.to_vec(), values.to_vec()));
            let sum: f64 = values.iter().copied().map(f64::from).sum();
            assert!(sum.abs() < SINGLE_ROUNDING, "row {x} of level {j} sums to {sum}");
            for &y in columns {
                let y = y as usize;
                let fine = if j == 1 { f32::from(u8::from(x == y)) } else { fast.scaling[j - 2].get(x, y) };
                assert_eq!(wavelets.get(x, y), fine - fast.scaling[j - 1].get(x, y));
            }
        }
    }
}

#[test]
fn a_cycle_gives_binomial_coefficients() {
    const N: u32 = 200;
    let edges: Vec<_> = (0..N).map(|x| (x, (x + 1) % N, 1.0)).collect();
    let walk = walk_on_graph(N as usize, &edges);
    let schedule = Schedule::new(vec![1, 5, 30]).unwrap();
    let everything = BasisParams::new(schedule).with_drop_tolerance(0.0);
    let found = basis(&walk, &everything, Progress::none()).unwrap();
    for (level, &n) in found.scaling.iter().zip(&found.steps) {
        for x in [0, 77, N - 1] {
            assert_eq!(level.row(x as usize).0.len() as u64, 2 * n + 1);
            let exact = one_vertex(&walk, x as usize, n - 1, n, 0.0, Progress::none()).unwrap();
            // C(2n, n+k)/4ⁿ, from k = n inwards.
            let mut value = 0.25_f64.powi(n as i32);
            for k in (0..=n as u32).rev() {
                for y in [(x + k) % N, (x + N - k) % N] {
                    let found = f64::from(level.get(x as usize, y as usize));
                    assert!((found / value - 1.0).abs() < 1e-5, "n = {n}, k = {k}: {found}, not {value}");
                    assert!((exact.scaling.get(y as usize) - value).abs() < ONE_VERTEX_ERROR);
                }
                value *= (n + u64::from(k)) as f64 / (n - u64::from(k) + 1) as f64;
            }
        }
    }
}

#[test]
fn a_hub_gathers_what_small_values_hold() {
    // A star of m leaves: λ = 1, ½, 0. Single leaves hold less than the part of the tolerance that is left out, and
    // together half of the walk, which comes back to the hub.
    const M: u32 = 3000;
    const TOLERANCE: f64 = 0.02;
    let edges: Vec<_> = (1..=M).map(|leaf| (0, leaf, 1.0)).collect();
    let walk = walk_on_graph(M as usize + 1, &edges);
    let found = basis(&walk, &params(3).with_drop_tolerance(TOLERANCE), Progress::none()).unwrap();
    for (level, &n) in found.scaling.iter().zip(&found.steps) {
        let (hub, itself) = (0.5, 0.5 / f64::from(M) + 0.5_f64.powi(n as i32) * (1.0 - 1.0 / f64::from(M)));
        for leaf in [1, 1500, M] {
            let expected = hub / (hub + itself);
            let found = f64::from(level.get(leaf as usize, 0));
            assert!((found - expected).abs() < SINGLE_ROUNDING, "{n} steps: {found}, not {expected}");
            assert_eq!(level.row(leaf as usize).0, [0, leaf]);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let walk = diffusion_of(&bumpy_sphere(4));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let fast = basis(&walk, &params(5), Progress::none()).unwrap();
            let squared = basis_by_squaring(&walk, &params(4), Progress::none()).unwrap();
            (fast.scaling, fast.info.largest_dropped, squared.scaling)
        })
    };
    let alone = with(1);
    assert_eq!(alone, with(2));
    assert_eq!(alone, with(5));
}

#[test]
fn one_vertex_is_a_row_of_the_matrix() {
    let walk = diffusion_of(&bumpy_sphere(4));
    let squared = basis_by_squaring(&walk, &params(7).with_drop_tolerance(0.0), Progress::none()).unwrap();
    for x in [0, 700, walk.n_vertices() - 1] {
        for j in 1..=7 {
            let steps = 1 << (j - 1);
            let at = one_vertex(&walk, x, steps / 2, steps, 0.0, Progress::none()).unwrap();
            let scaling = at.scaling.to_dense(walk.n_vertices());
            let wavelet = at.wavelet.to_dense(walk.n_vertices());
            let (columns, values) = squared.wavelet_row(j, x);
            for (&y, &v) in columns.iter().zip(&values) {
                assert!((wavelet[y as usize] - v).abs() < ONE_VERTEX_ERROR);
                assert!(
                    (scaling[y as usize] - squared.scaling[j - 1].get(x, y as usize)).abs()
                        < ONE_VERTEX_ERROR
                );
            }
            assert!((scaling.iter().sum::<f64>() - 1.0).abs() < ROUNDING);
            assert!(wavelet.iter().sum::<f64>().abs() < ROUNDING);
        }
    }
    let deep = one_vertex(&walk, 5, 1 << 20, 1 << 30, 0.0, Progress::none()).unwrap();
    for (&y, &v) in deep.scaling.columns.iter().zip(&deep.scaling.values) {
        assert!((v - walk.stationary()[y as usize]).abs() < ONE_VERTEX_ERROR, "{y}: the stationary law");
    }
}

#[test]
fn one_vertex_drops_what_the_matrix_drops() {
    let walk = diffusion_of(&bumpy_sphere(5));
    let fast = basis(&walk, &params(6), Progress::none()).unwrap();
    for x in (0..walk.n_vertices()).step_by(500) {
        let at = one_vertex(&walk, x, 16, 32, BasisParams::DROP_TOLERANCE, Progress::none()).unwrap();
        let (columns, values) = fast.scaling[5].row(x);
        assert!(at.scaling.columns.len().abs_diff(columns.len()) <= 2);
        for (&y, &v) in columns.iter().zip(values) {
            assert!((f64::from(v) - at.scaling.get(y as usize)).abs() < 1.1 * BasisParams::DROP_TOLERANCE);
        }
    }
}

#[test]
fn deep_levels_of_a_mesh_are_rows_of_powers() {
    let walk = diffusion_of(&bumpy_sphere(4));
    let found = basis(&walk, &params(11), Progress::none()).unwrap();
    for x in [3, 500, 1025] {
        for (level, &steps) in found.scaling.iter().zip(&found.steps) {
            let tolerance = BasisParams::DROP_TOLERANCE;
            let at = one_vertex(&walk, x, steps - 1, steps, tolerance, Progress::none()).unwrap();
            let (columns, values) = level.row(x);
            for (&y, &v) in columns.iter().zip(values) {
                let exact = at.scaling.get(y as usize);
                assert!(
                    (f64::from(v) - exact).abs() < 1.1 * tolerance,
                    "{steps} steps, {y}: {v}, not {exact}"
                );
            }
        }
    }
    assert!(found.scaling[10].nnz() > 900 * walk.n_vertices(), "1024 steps reach the whole mesh");
}

#[test]
fn isolated_vertices_and_single_ones_keep_to_themselves() {
    let walk = walk_on_graph(40, &[(3, 4, 1.0)]);
    let fast = basis(&walk, &params(4), Progress::none()).unwrap();
    let squared = basis_by_squaring(&walk, &params(4), Progress::none()).unwrap();
    assert_eq!(fast.scaling[3].row(7), ([7].as_slice(), [1.0].as_slice()));
    assert_eq!(squared.scaling[3].row(39), ([39].as_slice(), [1.0].as_slice()));
    assert_eq!(fast.scaling[0].row(3), ([3, 4].as_slice(), [0.5, 0.5].as_slice()));
    assert_eq!(fast.wavelet_row(1, 7), (vec![7], vec![0.0]));
    let alone = walk_on_graph(1, &[]);
    assert_eq!(
        basis(&alone, &params(20), Progress::none()).unwrap().scaling[19],
        CompressedRows::identity(1)
    );
    let at = one_vertex(&alone, 0, 0, 1 << 31, 1e-6, Progress::none()).unwrap();
    assert_eq!((at.scaling.values, at.wavelet.values), (vec![1.0], vec![0.0]));
}

#[test]
fn a_directed_cloud_has_a_basis() {
    let points: Vec<[f64; 3]> = (0..600)
        .map(|k| {
            let t = f64::from(k);
            [(t * 0.618_034).fract(), (t * 0.414_214).fract().powi(2), 0.1 * (t * 0.732_051).fract()]
        })
        .collect();
    let shape = Shape::Cloud(PointCloud::new(points).unwrap());
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    let directed = OperatorParams::default().with_cloud_graph(CloudGraph::Directed);
    let walk =
        Diffusion::new(local_operator(&geometry, &directed, Progress::none()).unwrap(), Progress::none())
            .unwrap();
    assert!(!walk.is_reversible());
    let fast = basis(&walk, &params(6), Progress::none()).unwrap();
    let exact = power(&dense(&walk), 32);
    // What is dropped at most, and what the rest is divided by.
    assert_near(&fast.scaling[5], &exact, 3e-5);
    let at = one_vertex(&walk, 11, 16, 32, 0.0, Progress::none()).unwrap();
    for (y, &value) in exact[11].iter().enumerate() {
        assert!((at.scaling.get(y) - value).abs() < ROUNDING);
    }
}

#[test]
fn the_shape_order_is_a_permutation_or_refused() {
    let shape = bumpy_sphere(2);
    let geometry = PreparedGeometry::new(&shape, WeldMode::Off, Progress::none()).unwrap();
    let walk = Diffusion::new(
        local_operator(&geometry, &OperatorParams::default(), Progress::none()).unwrap(),
        Progress::none(),
    )
    .unwrap();
    let inner = basis(&walk, &params(3), Progress::none()).unwrap();
    let outer = inner.to_shape_order(geometry.vertex_map()).unwrap();
    assert_ne!(inner.scaling, outer.scaling, "the numbering of the shape is another");
    for x in 0..shape.n_vertices() {
        for y in 0..shape.n_vertices() {
            let (class_x, class_y) = (geometry.vertex_map().welded(x), geometry.vertex_map().welded(y));
            assert_eq!(outer.scaling[2].get(x, y), inner.scaling[2].get(class_x, class_y));
        }
    }
    assert_well_formed(&outer.scaling[2], SINGLE_ROUNDING);
    let welded = VertexMap::new(&[[0.0; 3], [1.0; 3], [0.0; 3]], WeldMode::EqualPositions);
    let two: Basis = basis(&walk_on_graph(2, &[(0, 1, 1.0)]), &params(1), Progress::none()).unwrap();
    assert_eq!(two.to_shape_order(&welded).unwrap_err(), BasisError::Welded { n_vertices: 3, n_welded: 2 });
}

#[test]
fn cancelled_calls_stop() {
    let walk = diffusion_of(&bumpy_sphere(3));
    let stop = AtomicBool::new(true);
    let cancelled = Progress::none().with_cancel(&stop);
    assert_eq!(basis(&walk, &params(4), cancelled).unwrap_err(), Cancelled.into());
    assert_eq!(basis_by_squaring(&walk, &params(4), cancelled).unwrap_err(), Cancelled.into());
    assert_eq!(one_vertex(&walk, 0, 4, 8, 0.0, cancelled).unwrap_err(), Cancelled.into());
    // Stopped in the middle, from the report.
    let stop = AtomicBool::new(false);
    let report = |done: u64, _| stop.store(done > 0, Ordering::Relaxed);
    let cancelled = Progress::none().with_report(&report).with_cancel(&stop);
    assert_eq!(basis(&walk, &params(4), cancelled).unwrap_err(), Cancelled.into());
    assert_eq!(basis_by_squaring(&walk, &params(4), cancelled).unwrap_err(), Cancelled.into());
}

#[test]
fn progress_ends_at_its_total() {
    let walk = diffusion_of(&bumpy_sphere(3));
    let (done_last, total_last) = (AtomicU64::new(0), AtomicU64::new(1));
    let report = |done, total| {
        assert!(done >= done_last.swap(done, Ordering::Relaxed) || done == 0, "progress goes forward");
        total_last.store(total, Ordering::Relaxed);
    };
    let progress = Progress::none().with_report(&report);
    basis(&walk, &params(3), progress).unwrap();
    assert_eq!(done_last.swap(0, Ordering::Relaxed), total_last.load(Ordering::Relaxed));
    basis_by_squaring(&walk, &params(3), progress).unwrap();
    assert_eq!(done_last.swap(0, Ordering::Relaxed), total_last.load(Ordering::Relaxed));
    one_vertex(&walk, 0, 16, 32, 0.0, progress).unwrap();
    assert_eq!(done_last.load(Ordering::Relaxed), total_last.load(Ordering::Relaxed));
}

#[test]
fn what_does_not_fit_is_refused_with_the_number() {
    let walk = diffusion_of(&bumpy_sphere(4));
    let n = walk.n_vertices();
    let fits = basis(&walk, &params(6), Progress::none()).unwrap().info;
    for limit in [0, 1000, fits.bytes.iter().sum::<u64>() / 2] {
        for squaring in [false, true] {
            let small = params(6).with_memory_limit(limit);
            let refused = if squaring {
                basis_by_squaring(&walk, &small, Progress::none()).map(|_| ())
            } else {
                basis(&walk, &small, Progress::none()).map(|_| ())
            };
            let Err(BasisError::TooLarge { n_levels: 6, n_vertices, needed, limit: named }) = refused else {
                panic!("{limit} bytes: {refused:?}");
            };
            assert_eq!((n_vertices, named), (n, limit));
            assert!(needed > limit);
        }
    }
    let enough = params(6).with_memory_limit(fits.forecast);
    assert!(basis(&walk, &enough, Progress::none()).is_ok());
    // A depth that fills the matrix: found without filling it.
    let deep = params(30).with_memory_limit(1 << 20);
    let refused = basis(&walk, &deep, Progress::none());
    assert!(matches!(refused, Err(BasisError::TooLarge { needed, .. }) if needed > 1 << 20), "{refused:?}");
}

#[test]
fn senseless_requests_are_errors() {
    let walk = walk_on_graph(10, &(0..10).map(|x| (x, (x + 1) % 10, 1.0)).collect::<Vec<_>>());
    for tolerance in [-1e-9, f64::NAN, 1.0, f64::INFINITY] {
        let bad = params(2).with_drop_tolerance(tolerance);
        assert!(matches!(basis(&walk, &bad, Progress::none()), Err(BasisError::BadTolerance(_))));
        assert!(matches!(basis_by_squaring(&walk, &bad, Progress::none()), Err(BasisError::BadTolerance(_))));
        assert!(matches!(
            one_vertex(&walk, 0, 1, 2, tolerance, Progress::none()),
            Err(BasisError::BadTolerance(_))
        ));
    }
    let voices = BasisParams::new(Schedule::new(vec![1, 2, 3]).unwrap());
    assert_eq!(
        basis_by_squaring(&walk, &voices, Progress::none()).unwrap_err(),
        BasisError::NotDyadic { level: 3, steps: 3 }
    );
    assert_eq!(
        one_vertex(&walk, 10, 1, 2, 0.0, Progress::none()).unwrap_err(),
        BasisError::NoVertex { vertex: 10, n_vertices: 10 }
    );
    for (fine, coarse) in [(2, 2), (3, 2), (1, u64::MAX)] {
        assert_eq!(
            one_vertex(&walk, 0, fine, coarse, 0.0, Progress::none()).unwrap_err(),
            BasisError::BadSteps { fine, coarse }
        );
    }
    // After 64 steps on a cycle of ten no entry is above 0.2.
    let coarse = params(7).with_drop_tolerance(0.2);
    assert!(matches!(basis(&walk, &coarse, Progress::none()), Err(BasisError::EmptyRow { .. })));
    // Algorithm 1 divides what it keeps by its sum before it squares again, so its rows stay larger: two steps leave
    // 6/16 at the most.
    assert!(basis_by_squaring(&walk, &coarse, Progress::none()).is_ok());
    assert!(matches!(
        basis_by_squaring(&walk, &params(2).with_drop_tolerance(0.4), Progress::none()),
        Err(BasisError::EmptyRow { steps: 2, .. })
    ));
    assert!(matches!(
        one_vertex(&walk, 0, 1, 64, 0.2, Progress::none()),
        Err(BasisError::EmptyRow { row: 0, steps: 64, .. })
    ));
}
