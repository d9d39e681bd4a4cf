//! Prints how long calls take from the cancellation request to the error, for requests spread over the whole call:
//! `cargo run --release -p adwave-bench-helpers --bin cancel_time -- [--vertices N] [--tries N] [FORMAT… | work]`.
//! `work` prepares a shape, computes its bands, edits them, and computes saliency and features.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use adwave::bands::Schedule;
use adwave::features::{FeatureParams, features};
use adwave::operator::OperatorParams;
use adwave::saliency::{SaliencyParams, saliency};
use adwave::shape::{Polygons, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{Format, ReadLimits, ShapeFile, read_path_with, write_path_with};

fn main() {
    let (mut n, mut n_tries, mut formats, mut is_work) = (10_000_000_u32, 20, Vec::new(), false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || arguments.next().and_then(|n| n.parse().ok()).expect("a number");
        match argument.as_str() {
            "--vertices" => n = number(),
            "--tries" => n_tries = number(),
            "work" => is_work = true,
            name => formats.push(Format::from_name(name).expect("the name of a format")),
        }
    }
    if formats.is_empty() && !is_work {
        is_work = true;
        formats = vec![Format::PLY, Format::OBJ, Format::STL];
    }
    let side = f64::from(n).sqrt() as u32;
    let points = (0..n).map(|v| [f64::from(v % side), f64::from(v / side), f64::from(v).sin()]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..n - side - 1).flat_map(|v| [[v, v + 1, v + side], [v + 1, v + side + 1, v + side]]).collect();
    let shape = ShapeFile::from_mesh(points, Polygons::from_triangles(&triangles));
    drop(triangles);
    if is_work {
        work(&shape.to_shape().expect("triangles"), n_tries);
    }
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    for format in formats {
        let path = folder.path().join(format!("a.{}", format.extensions().first().unwrap_or(&"ply")));
        let whole = Instant::now();
        write_path_with(&shape, &path, Some(format), Progress::none()).expect("room for the file");
        let written = whole.elapsed();
        let write = |progress: Progress<'_>| {
            let other = path.with_extension("other");
            write_path_with(&shape, &other, Some(format), progress).is_err()
        };
        println!(
            "{format}: writing takes {:.2} s, {}",
            written.as_secs_f64(),
            stops(n_tries, written, write)
        );
        let whole = Instant::now();
        let is_read = read(&path, Progress::none());
        let took = whole.elapsed();
        assert!(!is_read, "the written file can be read");
        println!(
            "{format}: reading takes {:.2} s, {}",
            took.as_secs_f64(),
            stops(n_tries, took, |progress| read(&path, progress))
        );
        std::fs::remove_file(&path).expect("the file was written");
    }
}

/// Measures the cancellation of the calls on a shape.
fn work(shape: &Shape, n_tries: u32) {
    let params = OperatorParams::default();
    let prepare = |progress: Progress<'_>| Decomposer::with_params(shape, &params, progress);
    measure("preparing", n_tries, |progress| prepare(progress).is_err());
    let decomposer = prepare(Progress::none()).expect("no one cancels it");
    let (coords, schedule) =
        (shape.points().expect("a mesh").as_flattened(), Schedule::dyadic(8).expect("levels"));
    let request = || decomposer.request(coords, 3, &schedule);
    measure("bands", n_tries, |progress| request().progress(progress).bands().is_err());
    measure("editor", n_tries, |progress| request().progress(progress).editor().is_err());
    let norms = request().norms().expect("no one cancels it");
    measure("saliency", n_tries, |progress| {
        saliency(&decomposer, &norms, &SaliencyParams::paper(), progress).is_err()
    });
    measure("features", n_tries, |progress| {
        features(&decomposer, &norms, &FeatureParams::default(), progress).is_err()
    });
}

fn measure(what: &str, n_tries: u32, call: impl Fn(Progress<'_>) -> bool) {
    let whole = Instant::now();
    assert!(!call(Progress::none()), "{what} fails");
    let took = whole.elapsed();
    println!("{what} takes {:.2} s, {}", took.as_secs_f64(), stops(n_tries, took, call));
}

/// True if reading ends in an error.
fn read(path: &Path, progress: Progress<'_>) -> bool {
    read_path_with(path, &ReadLimits::default(), progress).is_err()
}

/// Longest and median cancellation time of several calls.
fn stops(n_tries: u32, whole: Duration, call: impl Fn(Progress<'_>) -> bool) -> String {
    let mut waits = Vec::new();
    for k in 0..n_tries {
        let stop = AtomicBool::new(false);
        let (wait, stopped) = std::thread::scope(|scope| {
            let flag = scope.spawn(|| {
                std::thread::sleep(whole.mul_f64((f64::from(k) + 0.5) / f64::from(n_tries)));
                stop.store(true, Ordering::Relaxed);
                Instant::now()
            });
            let stopped = call(Progress::none().with_cancel(&stop));
            let end = Instant::now();
            (end.saturating_duration_since(flag.join().expect("a thread that sleeps")), stopped)
        });
        if stopped {
            waits.push(wait);
        }
    }
    waits.sort_unstable();
    match (waits.last(), waits.get(waits.len() / 2)) {
        (Some(longest), Some(median)) => {
            let ms = |d: &Duration| d.as_secs_f64() * 1e3;
            format!("stops within {:.1} ms, median {:.1} ms, of {}", ms(longest), ms(median), waits.len())
        }
        _ => "was never stopped".to_owned(),
    }
}
