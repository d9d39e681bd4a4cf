//! The pairs of noisy and clean meshes of the test data.

use crate::denoise::signals::noise_of;
use crate::denoise::{denoised, mean_angle, rms};
use adwave::denoise::{DenoiseParams, denoise_signal};
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{ReadLimits, read_gifti_fields, read_path};
use adwave_test_data::data_test;
use std::path::Path;

/// Mean angle between the normals of the result and those of the clean mesh, in degrees, by pair; a little above what is
/// reached.
const PAIRS: [(&str, f64); 6] = [
    ("Block0.4", 3.5),
    ("Bunny0.2", 5.5),
    ("Fandisk0.3", 2.6),
    ("Nicolo0.2", 6.0),
    ("fertility-n3", 4.4),
    ("trim-star-n3", 5.4),
];

/// The mean of these over all pairs.
const MEAN: f64 = 4.6;

fn read(name: &str, file: &str) -> Shape {
    let path = Path::new(adwave_test_data::folder!()).join("denoise").join(name).join(file);
    let file = read_path(&path, &ReadLimits::default()).unwrap();
    Shape::Mesh(Mesh::new(file.points().to_vec(), file.faces().clone()).unwrap())
}

#[data_test]
fn normals_of_the_pairs_come_near_those_of_the_clean_meshes() {
    let mut total = 0.0;
    for (name, most) in PAIRS {
        let (clean, noisy) = (read(name, "clean.obj"), read(name, "noisy.obj"));
        let result = denoised(&noisy, &DenoiseParams::default());
        let angle = mean_angle(&clean, &result.points);
        println!("{name}: {angle:.2}° {:?}", result.info);
        assert!(angle <= most, "{name}: {angle}");
        total += angle;
    }
    assert!(total / PAIRS.len() as f64 <= MEAN, "{total}");
}

#[data_test]
fn clean_meshes_hardly_move() {
    for (name, _) in PAIRS {
        let clean = read(name, "clean.obj");
        let result = denoised(&clean, &DenoiseParams::default());
        let edge = result.info.noise / result.info.noise_in_edges;
        let moved = rms(&result.points, clean.points().unwrap()) / edge;
        println!("{name}: {moved:.4} mean edges");
        assert!(moved <= 0.1, "{name}: {moved} mean edges");
    }
}

#[data_test]
fn the_noise_of_the_curvature_of_a_cortex_is_not_overestimated() {
    let folder = Path::new(adwave_test_data::folder!()).join("fields/nilearn-fsaverage5");
    let surface = read_path(&folder.join("pial_left.gii.gz"), &ReadLimits::default()).unwrap();
    let fields = read_gifti_fields(&folder.join("curv_left.gii.gz"), &ReadLimits::default()).unwrap();
    let truth = fields[0].to_f64();
    let mesh = Mesh::new(surface.points().to_vec(), surface.faces().clone()).unwrap();
    let decomposer = Decomposer::new(&Shape::Mesh(mesh));
    let mean_square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let centered: Vec<f64> = truth.iter().map(|v| v - mean).collect();
    let added = 0.3 * mean_square(&centered).sqrt();
    let noise = noise_of(truth.len(), 3);
    let noisy: Vec<f64> = truth.iter().zip(&noise).map(|(v, e)| v + added * e).collect();
    let found = denoise_signal(&decomposer, &noisy, 1, &DenoiseParams::default(), Progress::none()).unwrap();
    let difference: Vec<f64> = found.values.iter().zip(&truth).map(|(v, t)| v - t).collect();
    let (level, error) = (found.info[0].noise / added, mean_square(&difference).sqrt() / added);
    println!("{level} times the noise, error {error} of it");
    assert!((0.9..1.15).contains(&level), "{level} times the noise");
    assert!(error < 0.75, "{error} of the noise is left");
}
