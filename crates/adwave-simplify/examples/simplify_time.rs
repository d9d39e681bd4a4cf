//! Time of simplifications of a sphere with bumps, noise and a border, by target.
//!
//! ```sh
//! cargo run --release -p adwave-simplify --example simplify_time -- 500000 0.001
//! ```
//!
//! Arguments: the number of vertices, noise as a share of the radius, and the number of a target, else all.

use adwave::Progress;
use adwave::shape::{Mesh, Polygons};
use adwave_simplify::{MeshParams, MeshTarget, simplify_mesh};
use std::time::Instant;

fn main() {
    let arguments: Vec<f64> = std::env::args().skip(1).map(|word| word.parse().expect("a number")).collect();
    let (n, noise) =
        (arguments.first().copied().unwrap_or(500_000.0), arguments.get(1).copied().unwrap_or(0.0));
    let mesh = bumpy_sphere(n as usize, noise);
    println!("{} vertices", mesh.points().len());
    println!("| target | vertices | largest distance / diagonal | at least | seconds |");
    println!("|---|---|---|---|---|");
    let diagonal = 12.0_f64.sqrt();
    let targets =
        [MeshTarget::Ratio(0.1), MeshTarget::Error(0.001 * diagonal), MeshTarget::Error(0.0001 * diagonal)];
    let only = arguments.get(2).map(|&k| k as usize);
    for (_, target) in targets.into_iter().enumerate().filter(|(k, _)| only.is_none_or(|only| only == *k)) {
        let start = Instant::now();
        let found =
            simplify_mesh(&mesh, None, &MeshParams::new(target), Progress::none()).expect("a valid target");
        let deviation = found.deviation.unwrap_or_default();
        println!(
            "| {target:?} | {} | {:.6} | {:.6} | {:.2} |",
            found.kept.len(),
            deviation.greatest() / diagonal,
            deviation.lower_bound() / diagonal,
            start.elapsed().as_secs_f64()
        );
    }
}

/// Sphere of radius 1 with bumps and noise, open at one pole, of about `n` vertices.
fn bumpy_sphere(n: usize, noise: f64) -> Mesh {
    let rows = ((n as f64 / 2.0).sqrt() as usize).max(4);
    let columns = 2 * rows;
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut points = vec![[0.0, 0.0, 1.0]];
    for i in 1..rows {
        let latitude = std::f64::consts::PI * i as f64 / rows as f64;
        for j in 0..columns {
            let longitude = std::f64::consts::TAU * (j as f64 + 0.5 * (i % 2) as f64) / columns as f64;
            let bumps = 0.05 * (9.0 * latitude).sin() * (7.0 * longitude).cos()
                + 0.01 * (40.0 * latitude).sin() * (31.0 * longitude).sin() * latitude.sin();
            let r = 1.0 + bumps + noise * random();
            points.push([
                r * latitude.sin() * longitude.cos(),
                r * latitude.sin() * longitude.sin(),
                r * latitude.cos(),
            ]);
        }
    }
    let at = |i: usize, j: usize| (1 + (i - 1) * columns + j % columns) as u32;
    let mut triangles: Vec<[u32; 3]> = (0..columns).map(|j| [0, at(1, j), at(1, j + 1)]).collect();
    for i in 1..rows - 1 {
        for j in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
            // Rows are shifted by half a column in turn.
            triangles.extend(if i % 2 == 1 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] });
        }
    }
    Mesh::new(points, Polygons::from_triangles(&triangles)).expect("valid triangles")
}
