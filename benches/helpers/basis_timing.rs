//! Times the explicit basis of a mesh: `cargo run --release -p adwave-bench-helpers --bin basis_timing -- SHAPE.obj
//! [LEVELS] [REPEATS] [fast-only]`.
//!
//! Prints one JSON object per line with the shortest time of the repeats: the fast method, Algorithm 1 (once; not
//! with `fast-only`), their largest difference, and one wavelet on a sphere of 50,600 vertices at several levels.

use adwave::Progress;
use adwave::bands::Schedule;
use adwave::basis::{Basis, BasisParams, Value, basis, basis_by_squaring, one_vertex};
use adwave::operator::{Diffusion, OperatorParams, local_operator};
use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
use adwave_bench_helpers::Triangles;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: basis_timing SHAPE.obj [LEVELS] [REPEATS] [fast-only]")?;
    let n_levels: usize = arguments.next().map_or(Ok(6), |a| a.parse())?;
    let repeats: usize = arguments.next().map_or(Ok(5), |a| a.parse())?;
    let squaring = arguments.next().as_deref() != Some("fast-only");

    let operator = diffusion(&Triangles::from_obj(path.as_ref())?.into_shape());
    let params = BasisParams::new(Schedule::dyadic(n_levels)?);
    let (seconds, fast) = fastest(repeats, || basis(&operator, &params, Progress::none()))?;
    report("fast", seconds, &fast);
    if squaring {
        let (seconds, reference) = fastest(1, || basis_by_squaring(&operator, &params, Progress::none()))?;
        report("squaring", seconds, &reference);
        let differences: Vec<f64> = fast
            .scaling
            .iter()
            .zip(&reference.scaling)
            .map(|(a, b)| {
                let differences = (0..a.n_rows()).map(|x| {
                    let (single, double) = (a.row(x), b.row(x));
                    row_difference(
                        &SparseRow { columns: single.0, values: single.1 },
                        &SparseRow { columns: double.0, values: double.1 },
                    )
                });
                differences.fold(0.0, f64::max)
            })
            .collect();
        println!("{{\"method\": \"fast − squaring\", \"max_difference\": {differences:?}}}");
    }
    time_one_wavelet(repeats)
}

/// Shortest time of several runs, and the result of the last.
fn fastest<T, E>(repeats: usize, run: impl Fn() -> Result<T, E>) -> Result<(f64, T), E> {
    let mut best = f64::INFINITY;
    let mut last = None;
    for _ in 0..repeats.max(1) {
        drop(last.take());
        let start = Instant::now();
        last = Some(run()?);
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok((best, last.expect("there is at least one run")))
}

fn report<V: Value>(method: &str, seconds: f64, basis: &Basis<V>) {
    println!(
        "{{\"method\": \"{method}\", \"n_vertices\": {}, \"seconds\": {seconds:.4}, \"nnz\": {:?}, \"bytes\": {}, \"forecast\": {}, \"largest_dropped\": {:?}}}",
        basis.n_vertices(),
        basis.info.nnz,
        basis.info.bytes.iter().sum::<u64>(),
        basis.info.forecast,
        basis.info.largest_dropped,
    );
}

fn diffusion(shape: &Shape) -> Diffusion {
    let geometry = PreparedGeometry::new(shape, WeldMode::Off, Progress::none()).unwrap();
    Diffusion::new(
        local_operator(&geometry, &OperatorParams::default(), Progress::none()).unwrap(),
        Progress::none(),
    )
    .unwrap()
}

/// Row of a sparse matrix.
struct SparseRow<'a, T> {
    columns: &'a [u32],
    values: &'a [T],
}

/// Largest difference of two sparse rows.
fn row_difference(single: &SparseRow<'_, f32>, double: &SparseRow<'_, f64>) -> f64 {
    let double_value = |y: &u32| double.columns.binary_search(y).map_or(0.0, |k| double.values[k]);
    let single_value = |y: &u32| single.columns.binary_search(y).map_or(0.0, |k| f64::from(single.values[k]));
    let in_single = single.columns.iter().zip(single.values);
    let in_double = double.columns.iter().zip(double.values);
    let differences = in_single.map(|(y, &v)| (f64::from(v) - double_value(y)).abs());
    differences.chain(in_double.map(|(y, &v)| (v - single_value(y)).abs())).fold(0.0, f64::max)
}

/// Times one wavelet in the middle of a sphere of about 50,000 vertices.
fn time_one_wavelet(repeats: usize) -> Result<(), Box<dyn Error>> {
    let operator = diffusion(&Shape::Mesh(sphere(220, 230)?));
    let vertex = operator.n_vertices() / 2;
    for level in [4_u32, 6, 8, 10, 12] {
        let steps = 1_u64 << (level - 1);
        let run = || one_vertex(&operator, vertex, steps / 2, steps, 1e-9, Progress::none());
        let (seconds, functions) = fastest(20 * repeats, run)?;
        println!(
            "{{\"method\": \"one vertex\", \"n_vertices\": {}, \"level\": {level}, \"seconds\": {seconds:.6}, \"nnz\": {}, \"products\": {}}}",
            operator.n_vertices(),
            functions.wavelet.columns.len(),
            functions.n_products,
        );
    }
    Ok(())
}

/// Sphere made of rings of latitude with a wavy radius, two triangles per cell.
fn sphere(n_rings: u32, n_around: u32) -> Result<Mesh, Box<dyn Error>> {
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n_rings {
        // Equal areas: the rings have equal heights.
        let z: f64 = (2.0 * f64::from(i) + 1.0) / f64::from(n_rings) - 1.0;
        for k in 0..n_around {
            let angle = (f64::from(k) + 0.5 * f64::from(i % 2)) / f64::from(n_around) * std::f64::consts::TAU;
            let radius = 1.0 + 0.05 * (5.0 * angle).sin() * (7.0 * z).cos();
            let across = (1.0 - z * z).sqrt();
            points.push([across * angle.cos(), across * angle.sin(), z].map(|c| radius * c));
            if i + 1 < n_rings {
                let (here, right) = (i * n_around + k, i * n_around + (k + 1) % n_around);
                let (above, above_right) = (here + n_around, right + n_around);
                if i % 2 == 0 {
                    triangles.extend([[here, right, above], [right, above_right, above]]);
                } else {
                    triangles.extend([[here, above_right, above], [here, right, above_right]]);
                }
            }
        }
    }
    Ok(Mesh::new(points, Polygons::from_triangles(&triangles))?)
}
