//! Denoising: how much noise is taken off, what stays, what becomes of shapes that are none, and the real pairs.

mod bad_input;
mod clouds;
mod curves;
mod kinds;
mod laws;
mod parts;
mod real_files;
mod series;
mod signals;

use adwave::Progress;
use adwave::denoise::{DenoiseParams, Denoised, denoise};
use adwave::sample::{NoiseSigma, Sample};
use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode, face_normals};

fn denoised(shape: &Shape, params: &DenoiseParams) -> Denoised {
    let geometry = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    denoise(&geometry, params, Progress::none()).unwrap()
}

fn mesh(points: Vec<[f64; 3]>, faces: &Polygons) -> Shape {
    Shape::Mesh(Mesh::new(points, faces.clone()).unwrap())
}

/// A built-in shape, clean and with noise of so many mean edges.
fn pair(name: &str, n_vertices: usize, noise: f64) -> (Shape, Shape) {
    let clean = Sample::from_name(name, Some(n_vertices)).unwrap();
    let mut noisy = clean.clone();
    noisy.add_noise(NoiseSigma::MeanEdge(noise), 3).unwrap();
    (mesh(clean.points, &clean.faces), mesh(noisy.points, &noisy.faces))
}

fn triangles(shape: &Shape) -> Vec<[u32; 3]> {
    let Shape::Mesh(mesh) = shape else { panic!("a mesh") };
    mesh.faces().iter().map(|f| [f[0], f[1], f[2]]).collect()
}

/// Mean angle between the normals of the triangles of two shapes with the same triangles, in degrees.
fn mean_angle(clean: &Shape, points: &[[f64; 3]]) -> f64 {
    let triangles = triangles(clean);
    let [a, b] = [clean.points().unwrap(), points].map(|points| face_normals(points, &triangles));
    let angle = |(a, b): (&[f64; 3], &[f64; 3])| {
        let cosine: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
        cosine.clamp(-1.0, 1.0).acos().to_degrees()
    };
    a.iter().zip(&b).map(angle).sum::<f64>() / triangles.len() as f64
}

/// Root mean square distance of points.
fn rms(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let square = |(p, q): (&[f64; 3], &[f64; 3])| p.iter().zip(q).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    (a.iter().zip(b).map(square).sum::<f64>() / a.len() as f64).sqrt()
}
