//! Directions and tensors in the subcommands: the numbers are those of the library, and what takes no part is said.

use crate::common::{adwave, json, refused, words};
use adwave::bands::Schedule;
use adwave::denoise::{DenoiseParams, denoise_signal};
use adwave::directions::{Directions, Symmetry, TensorOrder, log_tensors};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::{Decomposer, Progress};
use adwave_io::{Field, FieldValues, GRID_VALUES, GridLayout, ReadLimits, ShapeFile, read_path, write_path};
use std::path::Path;

fn field(path: &Path, name: &str) -> Vec<f64> {
    read_path(path, &ReadLimits::default()).unwrap().field(name).unwrap().to_f64()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A sphere with a wind that has a part along its normals.
fn sphere(folder: &Path) -> ShapeFile {
    adwave(folder).args(words("sample sphere --vertices 600 -o s.ply")).assert().success();
    let mut file = read_path(&folder.join("s.ply"), &ReadLimits::default()).unwrap();
    let wind: Vec<f64> =
        file.points().iter().flat_map(|p| [0.1 * p[0] - p[1], p[0] + 0.1 * p[1], 0.1 * p[2]]).collect();
    file.add_vertex_field(Field::new("wind", 3, FieldValues::F64(wind))).unwrap();
    write_path(&file, &folder.join("wind.ply"), None).unwrap();
    file
}

#[test]
fn a_filter_of_directions_is_that_of_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let file = sphere(folder.path());
    let line = "filter wind.ply -o smooth.ply --signal wind --directions vectors --steps 20 --gains 0";
    let report = json(folder.path(), line);
    assert_eq!(report["directions"]["singularities"]["index_sum"], 2.0);
    let share = report["directions"]["normal_share"].as_f64().unwrap();
    assert!((0.012..0.018).contains(&share), "{share}");
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let decomposer = Decomposer::with_params(&file.to_shape().unwrap(), &params, Progress::none()).unwrap();
    let directions = Directions::new(&decomposer, Symmetry::Vectors, Progress::none()).unwrap();
    let split = directions.split(&file.field("wind").unwrap().to_f64()).unwrap();
    let schedule = Schedule::real(vec![20.0]).unwrap();
    let bands = directions.decomposer().decompose(&split.channels, 2, &schedule).unwrap();
    let expected = directions.join(bands.coarsest()).unwrap();
    assert!(apart(&field(&folder.path().join("smooth.ply"), "wind"), &expected) < 1e-8);
}

#[test]
fn bands_of_directions_are_vectors_that_sum_to_the_tangent_part() {
    let folder = tempfile::tempdir().unwrap();
    let file = sphere(folder.path());
    let report = json(
        folder.path(),
        "transform wind.ply -o bands.vtp --signal wind --directions vectors --steps 4,16",
    );
    assert_eq!((&report["channels"], &report["operator"]), (&3.into(), &"surface".into()));
    let band = |name: &str| field(&folder.path().join("bands.vtp"), name);
    let sum: Vec<f64> =
        band("W1").iter().zip(band("W2")).zip(band("S2")).map(|((a, b), c)| a + b + c).collect();
    let tangent = band("S0");
    assert!(apart(&sum, &tangent) < 1e-12);
    let wind = file.field("wind").unwrap().to_f64();
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let decomposer = Decomposer::with_params(&file.to_shape().unwrap(), &params, Progress::none()).unwrap();
    let directions = Directions::new(&decomposer, Symmetry::Vectors, Progress::none()).unwrap();
    let split = directions.split(&wind).unwrap();
    assert!(apart(&tangent, &directions.join(&split.channels).unwrap()) < 1e-12);
    // The trace of a tensor is a number, with the bands of one.
    let tensors: Vec<f64> =
        file.points().iter().flat_map(|p| [2.0 + p[0], 0.1, p[1], 1.0, 0.0, 3.0]).collect();
    let mut file = file;
    file.add_vertex_field(Field::new("strain", 6, FieldValues::F64(tensors))).unwrap();
    write_path(&file, &folder.path().join("strain.ply"), None).unwrap();
    json(folder.path(), "transform strain.ply -o t.vtp --signal strain --tensors upper --steps 9");
    let t = |name: &str| field(&folder.path().join("t.vtp"), name);
    let sum: Vec<f64> = t("W1").iter().zip(t("S1")).map(|(a, b)| a + b).collect();
    assert!(apart(&sum, &t("S0")) < 1e-12);
    let said = refused(folder.path(), "transform wind.ply -o b.vtp --directions vectors");
    assert!(said.contains("coordinates are positions"), "{said}");
    let said = refused(
        folder.path(),
        "transform wind.ply -o b.npz --signal wind --directions vectors --basis irregular",
    );
    assert!(said.contains("--directions"), "{said}");
}

#[test]
fn noise_of_directions_goes_by_the_command_as_by_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = sphere(folder.path());
    let mut wind = file.field("wind").unwrap().to_f64();
    for (i, v) in wind.iter_mut().enumerate() {
        *v += 0.3 * (((i * 7919) % 1013) as f64 / 1013.0 - 0.5);
    }
    file.add_vertex_field(Field::new("wind", 3, FieldValues::F64(wind.clone()))).unwrap();
    write_path(&file, &folder.path().join("noisy.ply"), None).unwrap();
    let report = json(folder.path(), "denoise noisy.ply -o calm.ply --signal wind --directions vectors");
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let decomposer = Decomposer::with_params(&file.to_shape().unwrap(), &params, Progress::none()).unwrap();
    let directions = Directions::new(&decomposer, Symmetry::Vectors, Progress::none()).unwrap();
    let split = directions.split(&wind).unwrap();
    let params = DenoiseParams::default();
    let clean =
        denoise_signal(directions.decomposer(), &split.channels, 2, &params, Progress::none()).unwrap();
    assert_eq!(report["denoise"][0]["noise"].as_f64(), Some(clean.info[0].noise));
    assert_eq!(report["directions"]["singularities"]["index_sum"], 2.0);
    let found = field(&folder.path().join("calm.ply"), "wind");
    assert!(apart(&found, &directions.join(&clean.values).unwrap()) < 1e-12);
    // Outside of a region the tangent part stays.
    let line = "denoise noisy.ply -o half.ply --signal wind --directions vectors --region";
    let region = "half-space:point=0 0 0,normal=0 0 1,falloff=0.1";
    adwave(folder.path()).args(words(line)).arg(region).assert().success();
    let half = field(&folder.path().join("half.ply"), "wind");
    let tangent = directions.join(&split.channels).unwrap();
    for (x, p) in file.points().iter().enumerate() {
        let expected = if p[2] > 0.3 { &found } else { &tangent };
        assert!(p[2].abs() < 0.3 || apart(&half[3 * x..3 * x + 3], &expected[3 * x..3 * x + 3]) < 1e-12);
    }
    for (line, says) in [
        ("denoise noisy.ply -o b.ply --directions vectors", "coordinates are positions"),
        (
            "denoise noisy.ply -o b.ply --signal wind --directions lines --noise-model poisson",
            "--noise-model",
        ),
        ("denoise noisy.ply -o b.ply --signal wind --directions lines --in-time", "--in-time"),
    ] {
        let said = refused(folder.path(), line);
        assert!(said.contains(says), "{line}: {said}");
    }
}

#[test]
fn directions_are_refused_where_there_are_none() {
    let folder = tempfile::tempdir().unwrap();
    sphere(folder.path());
    let said =
        refused(folder.path(), "filter wind.ply -o o.ply --signal z --directions lines --preset smooth");
    assert!(said.contains("vectors of three components, and z has 1 number"), "{said}");
    // Positions are no vectors: their tangent parts alone would flatten the shape.
    let said = refused(folder.path(), "filter wind.ply -o o.ply --directions vectors --preset smooth");
    assert!(said.contains("coordinates are positions") && !folder.path().join("o.ply").exists(), "{said}");
    let line = "filter wind.ply -o o.ply --signal wind --directions lines --preset smooth --local-fit linear";
    assert!(refused(folder.path(), line).contains("--local-fit"));
    std::fs::write(
        folder.path().join("g.mtx"),
        "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 1\n2 1 1\n",
    )
    .unwrap();
    adwave_io::write_npy(&folder.path().join("v.npy"), &[2, 3], adwave_io::ArrayValues::F64(&[1.0; 6]))
        .unwrap();
    let said = refused(
        folder.path(),
        "filter g.mtx -o o.npy --signal v.npy --directions vectors --preset smooth --quiet",
    );
    assert!(said.contains("tangent planes of a mesh or a point cloud"), "{said}");
}

#[test]
fn tensors_of_a_volume_stay_positive_and_their_determinants_diffuse() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let n = 6 * 7 * 8;
    // The order of MRtrix: xx, yy, zz, xy, xz, yz. The first tensor is 0, the second not positive.
    let mut values: Vec<f64> = (0..n)
        .flat_map(|i| {
            let wave = 0.4 * f64::from(i).sin();
            [2.0 + wave, 1.0 - wave, 1.5, 0.3, wave, 0.1]
        })
        .collect();
    values[..6].fill(0.0);
    values[6..12].copy_from_slice(&[-1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let mut file = ShapeFile::from_grid(GridLayout::new(&[6, 7, 8], &[2.0; 3])).unwrap();
    file.add_vertex_field(Field::new(GRID_VALUES, 6, FieldValues::F64(values.clone()))).unwrap();
    write_path(&file, &at("dti.nii"), None).unwrap();
    let report =
        json(folder.path(), "filter dti.nii -o smooth.nii --tensors mrtrix --fwhm 5 --preset suppress");
    assert_eq!(report["tensors"]["not_positive"], 1);
    let smooth = field(&at("smooth.nii"), GRID_VALUES);
    assert_eq!(smooth[..12], values[..12]);
    let trace = |values: &[f64]| -> Vec<f64> {
        let logs = log_tensors(&TensorOrder::Diagonal.to_upper(values), Progress::none()).unwrap().logarithms;
        logs.chunks_exact(6).map(|t| t[0] + t[3] + t[5]).collect()
    };
    // log det is a scalar field, with the same mask.
    let mut scalar = ShapeFile::from_grid(GridLayout::new(&[6, 7, 8], &[2.0; 3])).unwrap();
    scalar.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::F64(trace(&values)))).unwrap();
    write_path(&scalar, &at("logdet.nii"), None).unwrap();
    adwave(folder.path())
        .args(words("filter logdet.nii -o expected.nii --fwhm 5 --preset suppress"))
        .assert()
        .success();
    let (found, expected) = (trace(&smooth), field(&at("expected.nii"), GRID_VALUES));
    assert!(apart(&found[2..], &expected[2..]) < 1e-9);
    // Tensors that take no part have no share in the size of a band.
    let report = json(folder.path(), "transform dti.nii -o bands.nii --tensors mrtrix --fwhm 5");
    let energy = report["energy"][0].as_f64().unwrap();
    assert!(energy > 0.0, "{report}");
    let bands = field(&at("bands.nii"), GRID_VALUES);
    let logs = log_tensors(&TensorOrder::Diagonal.to_upper(&values), Progress::none()).unwrap().logarithms;
    let logs = TensorOrder::Diagonal.reorder_upper(&logs);
    let sums: Vec<f64> = bands.chunks_exact(12).flat_map(|row| (0..6).map(|c| row[c] + row[6 + c])).collect();
    assert!(sums[..12].iter().all(|v| v.is_nan()) && apart(&sums[12..], &logs[12..]) < 1e-6);
    let said =
        refused(folder.path(), "filter logdet.nii -o o.nii --tensors fsl --fwhm 5 --preset suppress --quiet");
    assert!(said.contains("six components, and values has 1 number at each place"), "{said}");
}
