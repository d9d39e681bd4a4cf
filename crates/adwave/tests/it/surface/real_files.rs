//! Heat on every file of the test data that is a shape.

use crate::surface::{cloud, decomposer};
use adwave::bands::Schedule;
use adwave::shape::{Mesh, Shape};
use adwave_io::{ReadLimits, read_path};
use adwave_test_data::data_test;
use std::path::{Path, PathBuf};

/// Sums of the entries of a row, which may be many.
const ROW_SUM: f64 = 1e-12;
/// Four bands added up, relative to the largest coordinate.
const RECONSTRUCTION: f64 = 1e-12;
/// Larger files would take longer than the others together; there are few of them.
const MOST_VERTICES: usize = 60_000;

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}

#[data_test]
fn heat_on_every_file_is_a_walk_and_its_bands_are_finite() {
    let schedule = Schedule::dyadic(3).unwrap();
    let (mut n_meshes, mut n_clouds, mut n_large) = (0, 0, 0);
    for path in files_below(Path::new(adwave_test_data::folder!())) {
        let name = path.display();
        // Many are no shapes, or broken ones that a reader has to refuse.
        let Ok(file) = read_path(&path, &ReadLimits::default()) else { continue };
        let points = file.points().to_vec();
        if points.len() > MOST_VERTICES {
            n_large += 1;
            continue;
        }
        let mesh = if file.faces().is_empty() {
            None
        } else {
            Mesh::new(points.clone(), file.faces().clone()).ok().map(Shape::Mesh)
        };
        let cloud = (!points.is_empty() && points.as_flattened().iter().all(|c| c.is_finite()))
            .then(|| cloud(&points));
        n_meshes += usize::from(mesh.is_some());
        n_clouds += usize::from(cloud.is_some());
        for shape in mesh.iter().chain(&cloud) {
            let kind = if matches!(shape, Shape::Mesh(_)) { "mesh" } else { "cloud" };
            let decomposer = decomposer(shape);
            let heat = decomposer.rows("a test").unwrap();
            for x in 0..heat.n_vertices() {
                let weights = heat.row(x).1;
                assert!(weights.iter().all(|w| w.is_finite() && *w >= 0.0), "{name}, {kind}: row {x}");
                assert!(heat.diagonal(x) >= 0.0, "{name}, {kind}: row {x}");
                let sum = heat.diagonal(x) + weights.iter().sum::<f64>();
                assert!((sum - 1.0).abs() <= ROW_SUM, "{name}, {kind}: row {x} sums to {sum}");
            }
            let coords = shape.points().unwrap().as_flattened();
            if coords.is_empty() {
                continue;
            }
            let bands = decomposer
                .request(coords, 3, &schedule)
                .bands()
                .unwrap_or_else(|e| panic!("{name}, {kind}: {e}"));
            assert!(bands.wavelets().flatten().all(|v| v.is_finite()), "{name}, {kind}");
            let rebuilt = bands.reconstruct();
            let error = rebuilt.iter().zip(coords).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let largest = coords.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
            assert!(error <= RECONSTRUCTION * largest, "{name}, {kind}: rebuilt with an error of {error}");
        }
    }
    assert!(
        n_meshes >= 150 && n_clouds >= 170,
        "only {n_meshes} meshes and {n_clouds} clouds, {n_large} were too large"
    );
}
