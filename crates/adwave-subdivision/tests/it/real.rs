//! The levels of meshes that another program subdivided.

use adwave::Progress;
use adwave::shape::{Mesh, Polygons};
use adwave_subdivision::{Family, Hierarchy, LiftedWavelets};
use adwave_test_data::data_test;
use std::path::Path;

fn folder() -> &'static Path {
    Path::new(adwave_test_data::folder!())
}

/// Vertices and faces of an OBJ file.
fn read(name: &str) -> Mesh {
    let text = std::fs::read_to_string(folder().join(name)).expect("a file");
    let (mut points, mut faces) = (Vec::new(), Polygons::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let xyz: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
                points.push([xyz[0], xyz[1], xyz[2]]);
            }
            Some("f") => {
                let index =
                    |word: &str| word.split('/').next().unwrap_or(word).parse::<u32>().expect("an index");
                faces.push(&words.map(|word| index(word) - 1).collect::<Vec<u32>>());
            }
            _ => {}
        }
    }
    Mesh::new(points, faces).expect("a mesh")
}

#[data_test]
fn loop_refined_positions_of_another_program_have_no_loop_details() {
    let mesh = read("domains/subdivision/loop_icosahedron/loop_icosahedron_level3.obj");
    let hierarchy = Hierarchy::from_mesh(&mesh, Progress::none()).unwrap();
    assert_eq!((hierarchy.n_levels(), hierarchy.n_vertices(3)), (4, 42));
    let wavelets =
        LiftedWavelets::new(&hierarchy, Family::Loop, &vec![1.0; mesh.points().len()], Progress::none())
            .unwrap();
    let coefficients = wavelets.analyze(mesh.points().as_flattened(), 3, Progress::none()).unwrap();
    let rows = coefficients.levels.iter().zip(coefficients.values.as_chunks::<3>().0);
    let largest =
        rows.filter(|(level, _)| **level <= 3).flat_map(|(_, row)| row).fold(0.0_f64, |m, c| m.max(c.abs()));
    // The file has six digits.
    assert!(largest < 5e-6, "{largest:e}");
}

#[data_test]
fn quadrilateral_subdivision_is_named() {
    let mesh = read("domains/subdivision/catmark_pyramid/catmark_pyramid_level2.obj");
    let error = Hierarchy::from_mesh(&mesh, Progress::none()).unwrap_err();
    assert!(error.to_string().contains("quadrilateral schemes are not covered"), "{error}");
}
