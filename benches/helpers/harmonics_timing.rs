//! Times eigenpairs of a mesh in an OBJ file: `cargo run --release -p adwave-bench-helpers --bin harmonics_timing --
//! bunny.obj 100 300`.

use adwave::Progress;
use adwave::shape::{Mesh, Polygons, Shape};
use adwave_baselines::harmonics::Harmonics;
use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
use adwave_baselines::linalg::EigenParams;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: harmonics_timing SHAPE.obj N_EIGENPAIRS…")?;
    let text = std::fs::read_to_string(path)?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z, ..] => points.push([x.parse()?, y.parse()?, z.parse()?]),
            ["f", a, b, c] => {
                let index = |w: &str| w.split('/').next().unwrap_or("").parse::<u32>().map(|i| i - 1);
                triangles.push([index(a)?, index(b)?, index(c)?]);
            }
            _ => {}
        }
    }
    let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles))?);
    let start = Instant::now();
    let laplacian = LaplacianMatrices::new(&shape, &LaplacianParams::default())?;
    println!(
        "Laplacian of {} vertices: {:.3} s, {:?}",
        laplacian.n(),
        start.elapsed().as_secs_f64(),
        laplacian.info
    );
    for k in arguments {
        let start = Instant::now();
        let harmonics = Harmonics::new(&laplacian, k.parse()?, &EigenParams::default(), Progress::none())?;
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "{k} eigenpairs: {seconds:.3} s, last {:.6e}, {:?}",
            harmonics.values[harmonics.len() - 1],
            harmonics.info
        );
    }
    Ok(())
}
