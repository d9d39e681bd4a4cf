//! Prints how long reading a file takes: `cargo run --release -p adwave-io --example read_time -- FILE`. Without a
//! file, an OBJ of about 90 MB is made first.

use std::io::Write;
use std::time::Instant;

fn main() {
    let path = std::env::args_os().nth(1).map_or_else(generated, std::path::PathBuf::from);
    for _ in 0..3 {
        let start = Instant::now();
        let shape = adwave_io::read_path(&path, &adwave_io::ReadLimits::default());
        let seconds = start.elapsed().as_secs_f64();
        match shape {
            Ok(shape) => println!(
                "{seconds:.2} s: {} vertices, {} faces, fields {:?}",
                shape.n_vertices(),
                shape.faces().len(),
                shape.field_names()
            ),
            Err(error) => println!("{seconds:.2} s: {error}"),
        }
    }
}

/// Vertices along a side.
const N: u32 = 1060;

/// A wavy square grid of triangles.
fn generated() -> std::path::PathBuf {
    let path = std::env::temp_dir().join("adwave_read_time.obj");
    let mut out =
        std::io::BufWriter::new(std::fs::File::create(&path).expect("a folder for temporary files"));
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
    line().expect("room for 90 MB");
    path
}
