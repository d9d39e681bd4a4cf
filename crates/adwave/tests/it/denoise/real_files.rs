//! The pairs of noisy and clean meshes of the test data.

use crate::denoise::{denoised, mean_angle, rms};
use adwave::denoise::DenoiseParams;
use adwave::shape::{Mesh, Shape};
use adwave_io::{ReadLimits, read_path};
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
