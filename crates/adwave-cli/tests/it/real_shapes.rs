//! The laws of the walk on real meshes and scans, read from their files.

use crate::common;

use adwave::bands::{BandsParams, Schedule};
use adwave::operator::{CloudGraph, OperatorParams};
use adwave::shape::{Mesh, PointCloud, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{ReadLimits, read_path};
use adwave_test_data::data_test;
use common::{files_below, real_files};

/// Sums of a row's few entries.
const ROW_SUM: f64 = 1e-14;
/// A constant through eight levels.
const CONSTANT: f64 = 1e-13;
/// Nine bands added up, relative to the diagonal.
const RECONSTRUCTION: f64 = 1e-12;

#[data_test]
fn eight_levels_of_every_model_and_scan_rebuild_it() {
    let data = real_files();
    let mut files = files_below(&data.join("paper"));
    files.extend(files_below(&data.join("pointclouds")));
    files.push(data.join("fields/spot-textured/spot.obj"));
    assert!(files.len() >= 17, "only {} files", files.len());
    let schedule = Schedule::dyadic(8).unwrap();
    for path in files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let file = read_path(&path, &ReadLimits::default()).unwrap_or_else(|e| panic!("{e}"));
        let points = file.points().to_vec();
        let is_mesh = !file.faces().is_empty();
        let shape = if is_mesh {
            Shape::Mesh(Mesh::new(points, file.faces().clone()).unwrap())
        } else {
            Shape::Cloud(PointCloud::new(points).unwrap())
        };
        let graphs =
            if is_mesh { vec![CloudGraph::Union] } else { vec![CloudGraph::Union, CloudGraph::Directed] };
        for graph in graphs {
            let decomposer = Decomposer::with_params(
                &shape,
                &OperatorParams::default().with_cloud_graph(graph),
                Progress::none(),
            )
            .expect("nobody can stop this");
            let walk = decomposer.rows("a test").unwrap();
            for x in 0..walk.n_vertices() {
                let sum = walk.diagonal(x) + walk.row(x).1.iter().sum::<f64>();
                assert!((sum - 1.0).abs() <= ROW_SUM, "{name}: row {x} sums to {sum}");
            }
            let split = |signal: &[f64], n_channels: usize| {
                let params = BandsParams::default();
                decomposer.request(signal, n_channels, &schedule).params(&params).bands().unwrap()
            };
            let coords = shape.points().unwrap().as_flattened();
            let rebuilt = split(coords, 3).reconstruct();
            let error = rebuilt.iter().zip(coords).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error <= RECONSTRUCTION * shape.diagonal(), "{name}: rebuilt with an error of {error}");
            let constant = vec![0.7; shape.n_vertices()];
            let bands = split(&constant, 1);
            let level = bands.coarsest();
            let moved = level.iter().map(|v| (v - 0.7).abs()).fold(0.0, f64::max);
            assert!(moved <= CONSTANT, "{name}: a constant moved by {moved}");
        }
    }
}
