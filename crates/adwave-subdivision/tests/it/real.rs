//! The levels of meshes that another program subdivided.

use adwave::Progress;
use adwave::shape::{Mesh, Polygons};
use adwave_subdivision::{Family, Hierarchy, LiftedWavelets, QuadParams};
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
fn a_pyramid_of_triangles_comes_back_from_its_catmull_clark_levels() {
    let read_level =
        |level: usize| read(&format!("domains/subdivision/catmark_pyramid/catmark_pyramid_level{level}.obj"));
    let file = read_level(4);
    let params = QuadParams { points: Some(file.points()), ..QuadParams::default() };
    let hierarchy =
        Hierarchy::from_faces(file.points().len(), file.faces(), &params, Progress::none()).unwrap();
    // The coarsest file was itself cut once: a pyramid of four triangles and a square.
    let sizes: Vec<usize> = (0..=5).map(|level| hierarchy.n_vertices(level)).collect();
    assert_eq!(sizes, [4098, 1026, 258, 66, 18, 5]);
    let faces = hierarchy.faces(5).unwrap();
    assert_eq!(faces.iter().filter(|face| face.len() == 3).count(), 4);
    let masses = vec![1.0; file.points().len()];
    let wavelets = LiftedWavelets::new(&hierarchy, Family::CatmullClark, &masses, Progress::none()).unwrap();
    let field = file.points().as_flattened();
    let coarse = wavelets.coarse_field(field, 3, 4, Progress::none()).unwrap();
    let coarser = read_level(0);
    // The files have six decimal places, and four inverse steps enlarge what is rounded.
    for p in coarse.chunks_exact(3) {
        let distance = |q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f64::max);
        let nearest = coarser.points().iter().map(distance).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-4, "{p:?}: {nearest}");
    }
    let details = wavelets.analyze(field, 3, Progress::none()).unwrap();
    let of_level = |level: u32| {
        let rows = details.values.chunks_exact(3).zip(&details.levels).filter(|(_, own)| **own == level);
        rows.flat_map(|(row, _)| row.iter().map(|x| x.abs())).fold(0.0, f64::max)
    };
    assert!((1..=5).all(|level| of_level(level) < 1e-4), "{:?}", (1..=5).map(of_level).collect::<Vec<_>>());
}
