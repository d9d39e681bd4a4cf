//! Times repeated calls on a prepared shape: bands, edits of stored bands, regions. Prints a line of JSON for each,
//! with the shortest and the median time in seconds and memory in bytes per vertex.
//!
//! `prepared_timing [VERTICES …]`: for each number a torus of about that many vertices, 8 levels, coordinates,
//! accuracy 1e-5.

use adwave::bands::{BandsParams, Precision, Schedule};
use adwave::filter::WeightedLayer;
use adwave::region::{RegionWeights, parse_region};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Editor, Progress};
use adwave_bench_helpers::triad;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

const LEVELS: usize = 8;
const ACCURACY: f64 = 1e-5;
/// Calls of each kind, because the machine may be shared.
const CALLS: usize = 31;
/// Calls that prepare a shape.
const FRESH_CALLS: usize = 7;

fn main() -> Result<(), Failure> {
    let sizes: Vec<usize> = std::env::args().skip(1).map(|n| n.parse()).collect::<Result<_, _>>()?;
    let sizes = if sizes.is_empty() { vec![50_000, 500_000, 1_000_000] } else { sizes };
    for n in sizes {
        measure(n)?;
    }
    Ok(())
}

/// Shortest and median time of several calls, in seconds.
#[derive(Clone, Copy)]
struct Timing {
    least: f64,
    median: f64,
}

/// Times a call, without the first one.
fn time(call: impl FnMut() -> Result<(), Failure>) -> Result<Timing, Failure> {
    time_calls(CALLS, call)
}

/// Times a call that allocates all its memory.
fn time_fresh(call: impl FnMut() -> Result<(), Failure>) -> Result<Timing, Failure> {
    time_calls(FRESH_CALLS, call)
}

fn time_calls(n_calls: usize, mut call: impl FnMut() -> Result<(), Failure>) -> Result<Timing, Failure> {
    call()?;
    let mut seconds = Vec::with_capacity(n_calls);
    for _ in 0..n_calls {
        let start = Instant::now();
        call()?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    Ok(Timing { least: seconds[0], median: seconds[n_calls / 2] })
}

fn print(what: &str, n: usize, seconds: Timing) {
    let Timing { least, median } = seconds;
    println!(r#"{{"what":"{what}","vertices":{n},"least":{least:.6},"median":{median:.6}}}"#);
}

fn measure(n: usize) -> Result<(), Failure> {
    let sample = Sample::from_name("torus", Some(n))?;
    let points = sample.points.clone();
    let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces)?);
    let (coords, n) = (points.as_flattened(), points.len());
    let schedule = Schedule::dyadic(LEVELS)?;
    let prepared = time_fresh(|| {
        drop(Decomposer::new(&shape));
        Ok(())
    })?;
    print("prepare", n, prepared);
    let from_nothing = time_fresh(|| {
        drop(Decomposer::new(&shape).request(coords, 3, &schedule).accuracy(ACCURACY).bands()?);
        Ok(())
    })?;
    print("prepare, cut tiles and compute the bands", n, from_nothing);
    let decomposer = Decomposer::new(&shape);

    // The transform alone, in the analysis order, into allocated memory.
    let params = BandsParams::default().with_accuracy(ACCURACY);
    let transform = decomposer.transform().with_params(&params)?;
    let mean = decomposer.vertex_map().mean(coords, 3);
    let mut levels = vec![vec![0.0; mean.len()]; LEVELS];
    transforms_alone(&decomposer, &mean, &schedule, &mut levels, n)?;
    let per_vertex = transform.working_bytes(3) as f64 / n as f64;
    println!(r#"{{"what":"memory of the transform","vertices":{n},"bytes_per_vertex":{per_vertex:.1}}}"#);
    let request = decomposer.request(coords, 3, &schedule).accuracy(ACCURACY);
    let mut buffer = vec![0.0; (LEVELS + 1) * coords.len()];
    let into = time(|| {
        request.bands_into(&mut buffer)?;
        Ok(())
    })?;
    print("bands into a buffer, order of the shape", n, into);
    drop((levels, buffer, mean));

    let mut editor = request.editor()?;
    editor.set_layers(vec![WeightedLayer::everywhere(vec![0.5; LEVELS])])?;
    // Memory bound at this moment: an edit reads the levels and the signal and writes the result.
    let bytes = (8 * (LEVELS + 2) * coords.len()) as f64;
    let bound = bytes / triad();
    print(
        "bound of an edit everywhere, by the bandwidth of a = b + s·c",
        n,
        Timing { least: bound, median: bound },
    );
    let mut gain = 0.5;
    print(
        "edit everywhere",
        n,
        time(|| {
            gain += 0.01;
            editor.set_gains(1, &[gain; LEVELS])?;
            Ok(())
        })?,
    );
    regions(&decomposer, &mut editor, n)
}

/// Measures the transform in double and in single precision in turns, truncated for the same accuracy; the rounding of
/// single precision comes on top, and its bound is printed.
fn transforms_alone(
    decomposer: &Decomposer,
    mean: &[f64],
    schedule: &Schedule,
    levels: &mut [Vec<f64>],
    n: usize,
) -> Result<(), Failure> {
    let mut outs: Vec<&mut [f64]> = levels.iter_mut().map(Vec::as_mut_slice).collect();
    let formats = [
        (Precision::Double, ACCURACY),
        // Half of the accuracy is for rounding.
        (Precision::Single, 2.0 * ACCURACY),
    ];
    let mut seconds: [Vec<f64>; 2] = Default::default();
    let mut bounds = [0.0; 2];
    for call in 0..=CALLS {
        for ((precision, accuracy), (seconds, bound)) in
            formats.into_iter().zip(seconds.iter_mut().zip(&mut bounds))
        {
            let params = BandsParams::default().with_accuracy(accuracy).with_precision(precision);
            let transform = decomposer.transform().with_params(&params)?;
            let start = Instant::now();
            let info = transform.wavelets_into(mean, 3, schedule, &mut outs, Progress::none())?;
            // The first call prepares.
            if call > 0 {
                seconds.push(start.elapsed().as_secs_f64());
            }
            *bound = info.error_bound;
        }
    }
    let mut ratios: Vec<f64> =
        seconds[0].iter().zip(&seconds[1]).map(|(double, single)| single / double).collect();
    ratios.sort_by(f64::total_cmp);
    for (mut seconds, what) in
        seconds.into_iter().zip(["transform alone", "transform alone, single precision"])
    {
        seconds.sort_by(f64::total_cmp);
        print(what, n, Timing { least: seconds[0], median: seconds[CALLS / 2] });
    }
    let (ratio, [_, bound]) = (ratios[CALLS / 2], bounds);
    println!(
        r#"{{"what":"single beside double precision","vertices":{n},"median_ratio":{ratio:.3},"error_bound":{bound:.1e}}}"#
    );
    Ok(())
}

/// Measures a ball and a stroke of about 1 % of the vertices: weights and edits.
fn regions(decomposer: &Decomposer, editor: &mut Editor, n: usize) -> Result<(), Failure> {
    let weights = |region: &str| -> Result<RegionWeights, Failure> {
        Ok(parse_region(region)?.weights(decomposer.metric(), &|_| None, &[], Progress::none())?)
    };
    // On the built-in torus these cover 1.0 % and 1.1 %.
    let ball = |vertex: usize| format!("ball:vertex={vertex},radius=4.6%");
    let stroke = "stroke:path=1 0.4 0; 0.9 0.45 0.1; 0.8 0.5 0.15,radius=3%";
    let (first, second) = (weights(&ball(n / 3))?, weights(&ball(2 * n / 3))?);
    for (what, region) in [("ball", ball(n / 3)), ("stroke", stroke.to_owned())] {
        let covered = match weights(&region)? {
            RegionWeights::Sparse { vertices, .. } => 100.0 * vertices.len() as f64 / n as f64,
            _ => 100.0,
        };
        let timed = time(|| weights(&region).map(drop))?;
        print(&format!("weights of a {what} of {covered:.2} %"), n, timed);
    }
    editor.set_layers(vec![WeightedLayer { gains: vec![1.5; LEVELS], weights: first.clone() }])?;
    let mut gain = 1.5;
    print(
        "gains of the ball",
        n,
        time(|| {
            gain += 0.01;
            editor.set_gains(1, &[gain; LEVELS])?;
            Ok(())
        })?,
    );
    let mut turn = 0;
    print(
        "the ball moves",
        n,
        time(|| {
            turn += 1;
            editor.set_weights(1, if turn % 2 == 0 { first.clone() } else { second.clone() })?;
            Ok(())
        })?,
    );
    Ok(())
}
