//! Prints the time of reading files, median and shortest of several runs, next to a plain copy of the file into
//! memory: `cargo run --release -p adwave-bench-helpers --bin read_time -- [--runs N] FILE…`. Without a file, it
//! first generates an OBJ of about 90 MB.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() {
    let mut files = Vec::new();
    let mut n_runs = 7_usize;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        if argument == "--runs" {
            n_runs = arguments.next().and_then(|n| n.parse().ok()).expect("--runs needs a number");
        } else {
            files.push(PathBuf::from(argument));
        }
    }
    if files.is_empty() {
        files.push(generate_grid());
    }
    for path in files {
        let copy = times(n_runs, || std::fs::read(&path).map_or(0, |bytes| bytes.len()));
        let read = times(n_runs, || read(&path));
        println!(
            "{}: {}; median {:.4} s, shortest {:.4} s; plain copy {:.4} s",
            path.display(),
            describe(&path),
            read.0,
            read.1,
            copy.0
        );
    }
}

/// Median and shortest time of several runs, in seconds.
fn times<T>(n_runs: usize, run: impl Fn() -> T) -> (f64, f64) {
    let mut seconds: Vec<f64> = (0..n_runs.max(1))
        .map(|_| {
            let start = Instant::now();
            // The time to free the result does not count as reading.
            let result = run();
            let seconds = start.elapsed().as_secs_f64();
            drop(result);
            seconds
        })
        .collect();
    seconds.sort_unstable_by(f64::total_cmp);
    (seconds[seconds.len() / 2], seconds[0])
}

fn read(path: &Path) -> Result<adwave_io::ShapeFile, adwave_io::ReadError> {
    adwave_io::read_path(path, &adwave_io::ReadLimits::default())
}

fn describe(path: &Path) -> String {
    match read(path) {
        Ok(shape) => format!(
            "{} vertices, {} faces, fields {:?}",
            shape.n_vertices(),
            shape.faces().len(),
            shape.field_names()
        ),
        Err(error) => error.to_string(),
    }
}

/// Vertices along a side.
const N: u32 = 1060;

/// Generates a wavy square grid of triangles.
fn generate_grid() -> PathBuf {
    let path = std::env::temp_dir().join("adwave_read_time.obj");
    let mut out =
        std::io::BufWriter::new(std::fs::File::create(&path).expect("there is a folder for temporary files"));
    let mut line = || -> std::io::Result<()> {
        for i in 0..N {
            for j in 0..N {
                let (x, y) = (f64::from(i) * 0.013_37, f64::from(j) * 0.017_31);
                writeln!(out, "v {x:.6} {y:.6} {:.6}", (x * 3.1).sin() * (y * 2.3).cos())?;
            }
        }
        for i in 0..N - 1 {
            for j in 0..N - 1 {
                let a = i * N + j + 1;
                writeln!(out, "f {a} {} {}\nf {a} {} {}", a + 1, a + N + 1, a + N + 1, a + N)?;
            }
        }
        out.flush()
    };
    line().expect("there is room for 90 MB");
    path
}
