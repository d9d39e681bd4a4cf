//! Directions in which the gains move vertices, against the constraints in memory and with tiles of any size.

use std::path::{Path, PathBuf};

use adwave::bands::Schedule;
use adwave::filter::{Edit, Gains, Layer};
use adwave::local_fit::LocalFit;
use adwave::positions::{Borders, MoveDirection, PositionParams, constrain_positions};
use adwave::region::Region;
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{LasReader, ReadLimits, read_path};

use super::mesh::{Form, ply};
use super::{RECORD, cloud, joined, write};
use crate::Params;
use crate::layout::quantized_xyz;

const GAINS: [f64; 4] = [0.0, 0.2, 1.5, 1.0];

/// Positions that the filter in memory gives.
fn in_memory(shape: &Shape, params: &Params) -> Vec<[f64; 3]> {
    let decomposer = Decomposer::new(shape);
    let (points, schedule) = (shape.points().unwrap(), Schedule::dyadic(4).unwrap());
    let layers = [Layer { gains: Gains::Gains(GAINS.to_vec()), region: Region::Everywhere {} }];
    let filtered = |values: &[f64], n_channels: usize, fit: LocalFit| {
        let request = decomposer.request(values, n_channels, &schedule).accuracy(1e-9).local_fit(fit);
        request.filter(&Edit::new(&layers)).unwrap()
    };
    let mut after = points.to_vec();
    if let Some(axis) = params.along.and_then(MoveDirection::axis) {
        let heights: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        for (p, height) in after.iter_mut().zip(filtered(&heights, 1, params.local_fit)) {
            p[axis] = height;
        }
    } else {
        after = filtered(points.as_flattened(), 3, LocalFit::Constant).as_chunks().0.to_vec();
    }
    let constraints = PositionParams::default().with_along(params.along).with_borders(params.borders);
    constrain_positions(&decomposer, points, after, &constraints, Progress::none()).unwrap()
}

/// Parameters for all rules of motion.
fn rules() -> Vec<Params> {
    let asked = |along, borders, local_fit| Params {
        levels: 4,
        gains: GAINS.to_vec(),
        accuracy: 1e-9,
        along,
        borders,
        local_fit,
        ..Params::default()
    };
    let natural = |along| asked(along, Borders::Natural, LocalFit::Linear);
    let mut rules: Vec<Params> = MoveDirection::ALL.iter().map(|along| natural(Some(*along))).collect();
    rules.push(natural(None));
    rules.push(asked(None, Borders::Free, LocalFit::Linear));
    rules.push(asked(Some(MoveDirection::Z), Borders::Natural, LocalFit::Constant));
    rules
}

/// Bytes of the result in tiles of several sizes, which must be equal.
fn in_tiles(folder: &Path, input: &Path, params: &Params) -> Vec<u8> {
    let inputs: [PathBuf; 1] = [input.to_path_buf()];
    let of = |n_tiles: usize| {
        let params = Params { n_tiles: Some(n_tiles), n_workers: 2, ..params.clone() };
        let path = folder.join(n_tiles.to_string());
        let bytes = joined(&path, &inputs, &params);
        std::fs::remove_dir_all(path).unwrap();
        bytes
    };
    let whole = of(1);
    for n_tiles in [3, 7] {
        assert!(of(n_tiles) == whole, "{:?}: {n_tiles} tiles differ", params.along);
    }
    whole
}

#[test]
fn points_of_a_cloud_move_as_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let points = cloud(24_000);
    let input = folder.path().join("a.las");
    write(&input, &points, 0.0);
    let positions: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| f64::from(c) * 0.001)).collect();
    let shape = Shape::Cloud(PointCloud::new(positions.clone()).unwrap());
    for params in rules() {
        let path = folder.path().join("out.las");
        std::fs::write(&path, in_tiles(folder.path(), &input, &params)).unwrap();
        let mut records = Vec::new();
        let mut reader = LasReader::open(&path).unwrap();
        while reader.read(usize::MAX, &mut records).unwrap() > 0 {}
        let exact = in_memory(&shape, &params);
        let mut largest = 0.0_f64;
        for record in records.chunks_exact(RECORD) {
            let i = usize::from(u16::from_le_bytes([record[12], record[13]]));
            let found = quantized_xyz(record).map(|c| f64::from(c) * 0.001);
            for c in 0..3 {
                let difference = (found[c] - exact[i][c]).abs();
                assert!(difference <= 0.000_502, "{:?} {i} {c}: {difference}", params.along);
                largest = largest.max((found[c] - positions[i][c]).abs());
            }
        }
        assert!(largest > 0.02, "{:?} moves nothing", params.along);
    }
}

/// A bumpy plane with a border, and a closed sphere above it.
fn plane_and_sphere() -> (Vec<[f64; 3]>, Polygons) {
    let Sample { mut points, faces } = Sample::from_name("plane", Some(9000)).unwrap();
    for [x, y, z] in &mut points {
        *y += 0.05 * (9.0 * *x).sin() * (7.0 * *z).cos() + 0.004 * (400.0 * *x).sin() * (300.0 * *z).cos();
    }
    let mut all = Polygons::new();
    faces.iter().for_each(|face| all.push(face));
    let first = points.len() as u32;
    let Sample { points: ball, faces } = Sample::from_name("sphere", Some(6000)).unwrap();
    points.extend(ball.iter().enumerate().map(|(i, p)| {
        let r = 0.3 * (1.0 + 0.02 * f64::from(i as u32 * 7919 % 13) / 13.0);
        [r * p[0], 2.0 + r * p[1], r * p[2]]
    }));
    for face in faces.iter() {
        all.push(&face.iter().map(|v| v + first).collect::<Vec<_>>());
    }
    (points, all)
}

#[test]
fn vertices_of_a_mesh_move_as_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let (points, faces) = plane_and_sphere();
    let input = folder.path().join("a.ply");
    std::fs::write(&input, ply(&(points.clone(), faces.clone()), Form::Little)).unwrap();
    let shape = Shape::Mesh(Mesh::new(points.clone(), faces).unwrap());
    let edge = Decomposer::new(&shape).mean_length();
    for params in rules() {
        let path = folder.path().join("out.ply");
        std::fs::write(&path, in_tiles(folder.path(), &input, &params)).unwrap();
        let found = read_path(&path, &ReadLimits::default()).unwrap();
        let exact = in_memory(&shape, &params);
        let mut largest = 0.0_f64;
        for (i, (found, exact)) in found.points().iter().zip(&exact).enumerate() {
            for c in 0..3 {
                let difference = (found[c] - exact[c]).abs();
                assert!(difference <= 1e-6 * edge, "{:?} {i} {c}: {difference}", params.along);
                largest = largest.max((exact[c] - points[i][c]).abs());
            }
        }
        assert!(largest > 0.01 * edge, "{:?} moves nothing", params.along);
    }
}

#[test]
fn borders_that_stay_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, &cloud(100), 0.0);
    let params = Params { gains: vec![0.0; 8], borders: Borders::Keep, ..Params::default() };
    let error = crate::forecast(&[input], &params).unwrap_err().to_string();
    assert!(error.contains("cannot keep borders"), "{error}");
}
