//! Tests that the published models have the numbers of vertices and faces stated by their sources.

use crate::common;

use adwave_io::{CoordinatePrecision, ReadLimits, read_path};
use adwave_test_data::data_test;

/// `(file, vertices, faces)`.
const MODELS: &[(&str, usize, usize)] = &[
    ("paper/common-3d-test-models/fandisk.obj", 6475, 12946),
    ("paper/common-3d-test-models/horse.ply", 48485, 96966),
    ("paper/common-3d-test-models/stanford-bunny.obj", 35947, 69451),
    ("paper/libigl-tutorial-data/armadillo.obj", 43243, 86482),
    ("paper/libigl-tutorial-data/face.obj", 25905, 51712),
    ("paper/COMP5411/dinosaur.obj", 14000, 27996),
    ("paper/mesh_saliency_simplification/kitten.obj", 24956, 49912),
    ("paper/geom-algo-segmentation/skull.off", 20002, 40000),
    ("pointclouds/PCL-data/tutorials/lamppost.pcd", 1771, 0),
    ("pointclouds/PCL-data/tutorials/room_scan1.pcd", 112_586, 0),
    ("pointclouds/PCL-test/test/bun0.pcd", 397, 0),
    ("pointclouds/PCL-test/test/milk_color.pcd", 13704, 0),
    ("pointclouds/PDAL-test/autzen/autzen-thin.las", 10653, 0),
    ("pointclouds/PDAL-test/las/1.2-with-color.las", 1065, 0),
    ("pointclouds/CGAL-points_3/kitten.xyz", 5210, 0),
    ("pointclouds/CGAL-points_3/oni.pwn", 1435, 0),
    ("fields/spot-textured/spot.obj", 2930, 5856),
    ("benchmarks/FandosA-gaze-saliency/gaze_ply/bunny.ply", 20000, 39996),
    ("benchmarks/FandosA-gaze-saliency/gaze_ply/octopus.ply", 20000, 39984),
];

#[data_test]
fn models_have_their_stated_sizes() {
    let root = common::test_inputs();
    for &(file, n_vertices, n_faces) in MODELS {
        let shape = read_path(&root.join(file), &ReadLimits::default()).unwrap();
        assert_eq!((shape.n_vertices(), shape.faces().len()), (n_vertices, n_faces), "{file}");
    }
}

#[data_test]
fn the_gaze_field_keeps_its_type() {
    let root = common::test_inputs();
    let file = root.join("benchmarks/FandosA-gaze-saliency/gaze_ply/bunny.ply");
    let shape = read_path(&file, &ReadLimits::default()).unwrap();
    assert_eq!(shape.field_names(), ["gaze", "bin"]);
    assert_eq!(shape.precision(), CoordinatePrecision::F32);
    assert!(matches!(shape.field("gaze").unwrap().values, adwave_io::FieldValues::F32(_)));
    assert!(matches!(shape.field("bin").unwrap().values, adwave_io::FieldValues::U8(_)));
}
