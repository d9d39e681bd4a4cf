//! Times the engine and compares it with the memory bandwidth of this machine, as lines of JSON.
//!
//! `cargo run --release -p adwave-bench-helpers --bin engine_timing -- MESH.obj [subdivisions] [sweep [largest]]`.
//! The mesh is subdivided 1:4 the given number of times (2 by default). `sweep` adds the cost against the number of
//! vertices (4^(largest + 1) + 2 at most) and against the number of levels. Times are in seconds; `bound` is the
//! number of bytes that must be moved divided by the bandwidth of `a = b + s·c` over arrays far larger than the
//! caches, measured in the same run.

use adwave::Progress;
use adwave::bands::{BandsParams, Engine, Schedule, Transform, smooth};
use adwave::operator::{Diffusion, OperatorParams, local_operator};
use adwave::shape::{PreparedGeometry, Shape};
use adwave::sparse::apply;
use adwave_bench_helpers::{Triangles, triad};
use std::sync::Arc;
use std::time::Instant;

/// Relative error allowed for every band.
const ACCURACY: f64 = 1e-5;

/// Shortest and median seconds of `repeats` calls.
fn time(repeats: usize, mut call: impl FnMut()) -> (f64, f64) {
    let mut seconds: Vec<f64> = (0..repeats)
        .map(|_| {
            let start = Instant::now();
            call();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    (seconds[0], seconds[repeats / 2])
}

fn outputs(levels: usize, len: usize) -> Vec<Vec<f64>> {
    (0..levels).map(|_| vec![0.0; len]).collect()
}

fn wavelets_into(
    transform: &Transform,
    signal: &[f64],
    levels: usize,
    outs: &mut [Vec<f64>],
) -> adwave::bands::BandsInfo {
    let schedule = Schedule::dyadic(levels).expect("a valid number of levels");
    let mut outs: Vec<&mut [f64]> = outs.iter_mut().map(Vec::as_mut_slice).collect();
    transform.wavelets_into(signal, 3, &schedule, &mut outs, Progress::none()).expect("a valid request")
}

struct TimedShape {
    shape: Shape,
    geometry: PreparedGeometry,
    diffusion: Arc<Diffusion>,
}

impl TimedShape {
    fn new(triangles: Triangles) -> Self {
        let (shape, params) = (triangles.into_shape(), OperatorParams::default());
        let geometry = PreparedGeometry::new(&shape, params.weld, Progress::none()).expect("not cancelled");
        let operator = local_operator(&geometry, &params, Progress::none()).expect("not cancelled");
        let diffusion = Arc::new(Diffusion::new(operator, Progress::none()).expect("not cancelled"));
        Self { shape, geometry, diffusion }
    }

    fn signal(&self) -> &[f64] {
        self.geometry.points().as_flattened()
    }

    fn transform(&self, accuracy: f64) -> Transform {
        Transform::new(Arc::clone(&self.diffusion), &BandsParams::default().with_accuracy(accuracy))
            .expect("a valid accuracy")
    }
}

fn product(subject: &TimedShape, bandwidth: f64) -> f64 {
    let n = subject.diffusion.n_vertices();
    let entries = subject.diffusion.weights().len();
    let mut out = vec![0.0; 3 * n];
    let (least, median) = time(25, || apply(&subject.diffusion, subject.signal(), &mut out, 3));
    // Weights, columns, row ends; the signal in and out.
    let bytes = 12 * entries + 8 * n + 48 * n;
    let bound = bytes as f64 / bandwidth;
    println!(
        r#"{{"name":"product","n":{n},"min":{least},"median":{median},"bytes":{bytes},"bound":{bound},"part_of_bound":{}}}"#,
        bound / least
    );
    least
}

fn transform(subject: &TimedShape, levels: usize, bandwidth: f64, one_product: f64) {
    let n = subject.diffusion.n_vertices();
    let (prepare, _) = time(3, || drop(subject.transform(ACCURACY)));
    let transform = subject.transform(ACCURACY);
    let mut outs = outputs(levels, 3 * n);
    let mut info = wavelets_into(&transform, subject.signal(), levels, &mut outs);
    let (least, median) = time(if levels > 10 { 3 } else { 11 }, || {
        info = wavelets_into(&transform, subject.signal(), levels, &mut outs);
    });
    // Each product reads the operator and two vectors and writes one; each term reads two vectors and writes one.
    let entries = subject.diffusion.weights().len() as u64;
    let bytes = info.products * (12 * entries + 80 * n as u64) + info.terms * 72 * n as u64;
    let bound = bytes as f64 / bandwidth;
    let powers = one_product * (1_u64 << (levels - 1)) as f64;
    println!(
        r#"{{"name":"bands","levels":{levels},"n":{n},"accuracy":{ACCURACY},"min":{least},"median":{median},"prepare":{prepare},"degree":{},"products":{},"terms":{},"unfused_bytes":{bytes},"unfused_bound":{bound},"past_unfused_bound":{},"powers":{powers},"powers_ratio":{},"error_bound":{},"working_bytes_per_vertex":{}}}"#,
        info.degree,
        info.products,
        info.terms,
        bound / least,
        powers / least,
        info.error_bound,
        info.bytes / n as u64
    );
    if levels <= 10 && bandwidth > 1.0 {
        errors(subject, levels, &outs);
    }
}

/// Prints the relative error of every band against repeated products.
fn errors(subject: &TimedShape, levels: usize, outs: &[Vec<f64>]) {
    let params = BandsParams::default().with_engine(Engine::Powers);
    let powers = Transform::new(Arc::clone(&subject.diffusion), &params).expect("a valid accuracy");
    let mut exact = outputs(levels, subject.signal().len());
    wavelets_into(&powers, subject.signal(), levels, &mut exact);
    let errors: Vec<String> = outs
        .iter()
        .zip(&exact)
        .map(|(w, e)| {
            let error: f64 = w.iter().zip(e).map(|(w, e)| (w - e).powi(2)).sum();
            let square: f64 = e.iter().map(|e| e * e).sum();
            format!("{:e}", (error / square).sqrt())
        })
        .collect();
    println!(r#"{{"name":"errors","levels":{levels},"relative":[{}]}}"#, errors.join(","));
}

/// Times a one-off call with a file's vertex order and without prepared state.
fn one_off(subject: &TimedShape, levels: usize) {
    let signal = subject.shape.points().expect("a mesh has points").as_flattened();
    let schedule = Schedule::dyadic(levels).expect("a valid number of levels");
    let params = BandsParams::default().with_accuracy(ACCURACY);
    let (diffusion, vertex_map) = (&subject.diffusion, subject.geometry.vertex_map());
    let (least, median) = time(5, || {
        let transform = Transform::new(Arc::clone(diffusion), &params).expect("a valid accuracy");
        transform.bands(vertex_map, signal, 3, &schedule, Progress::none()).expect("a valid request");
    });
    println!(r#"{{"name":"decompose","levels":{levels},"min":{least},"median":{median}}}"#);
    let factors = vec![0.5; levels];
    let (least, median) = time(5, || {
        let transform = Transform::new(Arc::clone(diffusion), &params).expect("a valid accuracy");
        transform
            .weighted(vertex_map, signal, 3, &schedule, &factors, Progress::none())
            .expect("a valid request");
    });
    println!(r#"{{"name":"weighted_bands","levels":{levels},"min":{least},"median":{median}}}"#);
}

/// Measures the cost against n (4·4^s + 2 vertices) and against J.
fn sweep(largest: usize) {
    for subdivisions in 6..=largest {
        let subject = TimedShape::new(Triangles::sphere(subdivisions));
        let n = subject.diffusion.n_vertices();
        let transform = subject.transform(ACCURACY);
        let mut outs = outputs(8, 3 * n);
        let (least, median) = time(if n > 1_000_000 { 3 } else { 9 }, || {
            wavelets_into(&transform, subject.signal(), 8, &mut outs);
        });
        println!(r#"{{"name":"against_n","n":{n},"levels":8,"min":{least},"median":{median}}}"#);
    }
    let subject = TimedShape::new(Triangles::sphere(8));
    let n = subject.diffusion.n_vertices();
    let transform = subject.transform(ACCURACY);
    for levels in 1..=20 {
        let mut outs = outputs(levels, 3 * n);
        let mut info = wavelets_into(&transform, subject.signal(), levels, &mut outs);
        let (least, _) = time(if levels > 14 { 1 } else { 5 }, || {
            info = wavelets_into(&transform, subject.signal(), levels, &mut outs);
        });
        println!(
            r#"{{"name":"against_levels","n":{n},"levels":{levels},"min":{least},"degree":{}}}"#,
            info.degree
        );
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = arguments.first() else {
        println!("usage: engine_timing MESH.obj [subdivisions] [sweep [largest]]");
        return;
    };
    let mut triangles = match Triangles::from_obj(path.as_ref()) {
        Ok(triangles) => triangles,
        Err(error) => {
            println!("skipped: {path}: {error}");
            return;
        }
    };
    let plain = TimedShape::new(triangles.clone());
    let subdivisions = arguments.get(1).and_then(|word| word.parse().ok()).unwrap_or(2);
    for _ in 0..subdivisions {
        triangles = triangles.subdivide();
    }
    let subject = TimedShape::new(triangles);
    if arguments.iter().any(|word| word == "quick") {
        transform(&subject, 8, 1.0, 1.0);
        return;
    }
    let bandwidth = triad();
    println!(
        r#"{{"name":"triad","bytes_per_second":{bandwidth},"threads":{}}}"#,
        rayon::current_num_threads()
    );
    let one_product = product(&subject, bandwidth);
    let (smoothing, _) = time(1, || {
        smooth(&subject.diffusion, subject.signal(), 3, &[128], Progress::none()).expect("not cancelled");
    });
    println!(r#"{{"name":"powers","steps":128,"min":{smoothing}}}"#);
    transform(&subject, 8, bandwidth, one_product);
    transform(&subject, 16, bandwidth, one_product);
    one_off(&subject, 8);
    println!(r#"{{"name":"plain","n":{}}}"#, plain.diffusion.n_vertices());
    one_off(&plain, 8);
    if let Some(at) = arguments.iter().position(|word| word == "sweep") {
        // 4,194,306 vertices; 11 gives 16,777,218 and takes about 12 GB.
        let largest = arguments.get(at + 1).and_then(|word| word.parse().ok()).unwrap_or(10);
        sweep(largest);
    }
}
