//! Reference values as text, checked by `benches/baselines/oracle.py`.
//!
//! ```text
//! oracle_values spectrum MESH.txt K as-given|delaunay     MESH: "v x y z" and "f a b c" lines, from 0
//! oracle_values sgwt GRAPH.txt FAMILY N LAMBDA_MAX        GRAPH: "u v w" lines, then "s value" lines
//! ```

use adwave::Progress;
use adwave::shape::{Mesh, Polygons, Shape};
use adwave_baselines::harmonics::Harmonics;
use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams, Triangulation};
use adwave_baselines::linalg::{EigenParams, SymmetricMatrix};
use adwave_baselines::sgwt::{ExactFrame, Frame, KernelFamily, Kernels};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["spectrum", path, k, triangulation] => spectrum(path, k.parse()?, triangulation),
        ["sgwt", path, family, n, lambda_max] => sgwt(path, family, n.parse()?, lambda_max.parse()?),
        _ => Err("unknown command; see the first lines of this program".into()),
    }
}

fn spectrum(path: &str, k: usize, triangulation: &str) -> Result<(), Box<dyn Error>> {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for line in std::fs::read_to_string(path)?.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["v", x, y, z] => points.push([x.parse()?, y.parse()?, z.parse()?]),
            ["f", a, b, c] => triangles.push([a.parse()?, b.parse()?, c.parse()?]),
            _ => return Err(format!("expected a vertex or a face: {line}").into()),
        }
    }
    let params = LaplacianParams::default().with_triangulation(match triangulation {
        "as-given" => Triangulation::AsGiven,
        "delaunay" => Triangulation::IntrinsicDelaunay,
        other => return Err(format!("unknown triangulation {other}").into()),
    });
    let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles))?);
    let start = Instant::now();
    let laplacian = LaplacianMatrices::new(&shape, &params)?;
    let harmonics = Harmonics::new(&laplacian, k, &EigenParams::default(), Progress::none())?;
    println!("seconds {}", start.elapsed().as_secs_f64());
    for value in &harmonics.values {
        println!("{value:e}");
    }
    Ok(())
}

fn sgwt(path: &str, family: &str, n: usize, lambda_max: f64) -> Result<(), Box<dyn Error>> {
    let (mut entries, mut signal): (Vec<(u32, u32, f64)>, Vec<f64>) = (Vec::new(), Vec::new());
    for line in std::fs::read_to_string(path)?.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["s", value] => signal.push(value.parse()?),
            [u, v, w] => {
                let (u, v, w): (u32, u32, f64) = (u.parse()?, v.parse()?, w.parse()?);
                entries.extend([(u, u, w), (v, v, w), (u, v, -w)]);
            }
            _ => return Err(format!("expected an edge or a value: {line}").into()),
        }
    }
    let laplacian = SymmetricMatrix::from_halves(signal.len(), &entries)?;
    let family = match family {
        "MexicanHat" => KernelFamily::MexicanHat,
        "Abspline" => KernelFamily::Abspline,
        "Itersine" => KernelFamily::Itersine,
        "Meyer" => KernelFamily::Meyer,
        other => return Err(format!("unknown family {other}").into()),
    };
    let kernels = Kernels::new(family, n, lambda_max)?;
    let exact = ExactFrame::new(&laplacian, kernels.clone())?.analyze(&signal)?;
    let polynomial = Frame::new(laplacian, kernels, 5e-7)?.analyze(&signal, Progress::none())?;
    for (a, b) in exact.iter().zip(&polynomial) {
        for (a, b) in a.iter().zip(b) {
            println!("{a:e} {b:e}");
        }
    }
    Ok(())
}
