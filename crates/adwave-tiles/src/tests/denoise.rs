//! Denoising: several tiles against one tile, and against the whole shape in memory.

use std::path::Path;

use adwave::Progress;
use adwave::denoise::{Creases, DenoiseChoice, DenoiseParams, SharedNoise, denoise};
use adwave::sample::{NoiseSigma, Sample};
use adwave::shape::{Mesh, PointCloud, PreparedGeometry, Shape, WeldMode};
use adwave_io::{LasReader, ReadLimits, read_path};

use crate::layout::quantized_xyz;
use crate::tests::{RECORD, cloud, joined, write};
use crate::{Params, Task, TilingJob, run, run_task};

fn params() -> Params {
    Params {
        denoise: Some(DenoiseParams::default()),
        neighbors: DenoiseChoice::NEIGHBORS,
        ..Params::default()
    }
}

/// Largest distance between the results of tiles and of memory, in standard deviations of the noise. In memory,
/// polynomials are truncated by the norm of the signal, to a relative error of 1e-4 of the normals; in tiles by the
/// number of steps alone. Coordinates of clouds are rounded.
const MAX_DIFFERENCE: f64 = 0.01;

#[test]
fn a_cloud_in_tiles_of_any_size_has_the_bytes_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let points = cloud(60_000);
    let inputs = [("a.las", &points[..25_000], 0.0), ("b.laz", &points[25_000..], 64.0)];
    let inputs = inputs.map(|(name, points, offset)| {
        let path = folder.path().join(name);
        write(&path, points, offset);
        path
    });
    let one = joined(&folder.path().join("one"), &inputs, &params());
    for n_tiles in [2, 5, 15] {
        let params = Params { n_tiles: Some(n_tiles), n_workers: 2, ..params() };
        let path = folder.path().join(format!("{n_tiles}"));
        assert!(joined(&path, &inputs, &params) == one, "{n_tiles} tiles differ");
    }
}

/// A sphere as a cloud, with noise.
fn noisy_sphere(n: usize) -> Vec<[i32; 3]> {
    let mut sample = Sample::from_name("sphere", Some(n)).unwrap();
    sample.add_noise(NoiseSigma::MeanEdge(0.15), 7).unwrap();
    sample.points.iter().map(|p| p.map(|c| (c * 1e6).round() as i32)).collect()
}

#[test]
fn a_cloud_is_denoised_as_in_memory_all_round() {
    let folder = tempfile::tempdir().unwrap();
    let points = noisy_sphere(30_000);
    let input = folder.path().join("a.las");
    write(&input, &points, 0.0);
    let positions: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| f64::from(c) * 0.001)).collect();
    let shape = Shape::Cloud(PointCloud::new(positions.clone()).unwrap());
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    let expected = denoise(&geometry, &DenoiseParams::default(), Progress::none()).unwrap();
    let params = Params { n_tiles: Some(4), ..params() };
    let job = TilingJob::begin(&folder.path().join("job"), std::slice::from_ref(&input), &params).unwrap().0;
    let summary = run(&job, Progress::none()).unwrap();
    let noise = summary.noise.unwrap();
    assert!((noise.noise / expected.info.noise - 1.0).abs() < 1e-9, "{noise:?}");
    assert_eq!(noise.cloud, expected.info.cloud);
    let mut found = vec![[0.0; 3]; points.len()];
    for tile in 0..summary.n_tiles {
        let mut reader = LasReader::open(&job.tile(tile)).unwrap();
        let mut records = Vec::new();
        while reader.read(usize::MAX, &mut records).unwrap() > 0 {}
        for record in records.chunks_exact(RECORD) {
            let i = usize::from(u16::from_le_bytes([record[12], record[13]]));
            found[i] = quantized_xyz(record).map(|c| f64::from(c) * 0.001);
        }
    }
    let distance = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt();
    let moved: f64 = positions.iter().zip(&expected.points).map(|(p, q)| distance(p, q)).sum();
    assert!(moved / points.len() as f64 > 0.5 * noise.noise);
    let off: Vec<f64> = found.iter().zip(&expected.points).map(|(p, q)| distance(p, q)).collect();
    let most = off.iter().copied().fold(0.0, f64::max);
    println!("{most} at most, noise {}", noise.noise);
    assert!(most < MAX_DIFFERENCE * noise.noise, "{most} of a noise of {}", noise.noise);
}

/// The denoised mesh as bytes, and the denoising that was applied.
fn denoised_mesh(folder: &Path, input: &Path, params: &Params) -> (Vec<u8>, adwave::denoise::DenoiseInfo) {
    let job = TilingJob::begin(folder, &[input.to_owned()], params).unwrap().0;
    let summary = run(&job, Progress::none()).unwrap();
    let path = folder.join("joined.ply");
    crate::join(&job, &path, Progress::none()).unwrap();
    (std::fs::read(path).unwrap(), summary.noise.unwrap())
}

#[test]
fn a_mesh_in_tiles_of_any_size_has_the_bytes_of_one_and_is_denoised_as_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    // A tiny mesh is computed in another unit.
    for (name, size) in [("as it is", 1.0), ("tiny", 1e-40)] {
        let mut sample = Sample::from_name("creature", Some(20_000)).unwrap();
        sample.add_noise(NoiseSigma::MeanEdge(0.3), 5).unwrap();
        for p in &mut sample.points {
            *p = p.map(|c| c * size);
        }
        let mut ply = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            sample.points.len(),
            sample.faces.len()
        )
        .into_bytes();
        ply.extend(sample.points.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
        for face in sample.faces.iter() {
            ply.push(face.len() as u8);
            ply.extend(face.iter().flat_map(|v| v.to_le_bytes()));
        }
        let folder = folder.path().join(name);
        std::fs::create_dir(&folder).unwrap();
        let input = folder.join("a.ply");
        std::fs::write(&input, &ply).unwrap();
        let (one, info) = denoised_mesh(&folder.join("one"), &input, &params());
        for n_tiles in [3, 8] {
            let params = Params { n_tiles: Some(n_tiles), ..params() };
            let (bytes, of_tiles) = denoised_mesh(&folder.join(format!("{n_tiles}")), &input, &params);
            assert!(bytes == one, "{n_tiles} tiles differ");
            assert_eq!(of_tiles, info);
        }
        let path = folder.join("one.ply");
        std::fs::write(&path, one).unwrap();
        let file = read_path(&path, &ReadLimits::default()).unwrap();
        let shape = Shape::Mesh(Mesh::new(sample.points.clone(), sample.faces.clone()).unwrap());
        let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
        let expected = denoise(&geometry, &DenoiseParams::default(), Progress::none()).unwrap();
        assert!((info.noise / expected.info.noise - 1.0).abs() < 1e-9);
        let [of_tiles, in_memory] = [&info, &expected.info].map(|info| info.mesh.as_ref().unwrap());
        assert!(in_memory.shared_at_most > 0.0);
        assert!((of_tiles.shared_at_most / in_memory.shared_at_most - 1.0).abs() < 1e-6, "{name}");
        assert!((info.furthest / expected.info.furthest - 1.0).abs() < 1e-3);
        let off = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|c| (p[c] - q[c]).abs()).fold(0.0, f64::max);
        let most = file.points().iter().zip(&expected.points).map(|(p, q)| off(p, q)).fold(0.0, f64::max);
        assert!(most < MAX_DIFFERENCE * info.noise, "{name}: {most:e} of a noise of {:e}", info.noise);
        // Noise that neighbors share has the unit of the file too.
        let shared = SharedNoise::Deviation(0.3 * info.noise);
        let given = DenoiseParams::default().with_shared(shared);
        let (_, info) =
            denoised_mesh(&folder.join("shared"), &input, &Params { denoise: Some(given), ..params() });
        let expected = denoise(&geometry, &given, Progress::none()).unwrap().info;
        let [of_tiles, in_memory] = [&info, &expected].map(|info| info.mesh.as_ref().unwrap().shared);
        assert!((of_tiles / in_memory - 1.0).abs() < 1e-9, "{name}: {of_tiles:e} and {in_memory:e}");
        assert!((info.furthest / expected.furthest - 1.0).abs() < 1e-3, "{name}");
    }
}

#[test]
fn tasks_may_run_twice_or_elsewhere_and_missing_or_broken_files_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, &cloud(20_000), 0.0);
    let inputs = std::slice::from_ref(&input);
    let expected = joined(&folder.path().join("one"), inputs, &params());
    let path = folder.path().join("tasks");
    let params = Params { n_tiles: Some(3), ..params() };
    drop(TilingJob::begin(&path, inputs, &params).unwrap());
    let job = TilingJob::open(&path).unwrap();
    let done = |task| run_task(&job, task, Progress::none());
    done(Task::Sort).unwrap();
    for tile in [2, 0, 1, 1] {
        done(Task::Neighbors(tile)).unwrap();
    }
    let status = job.status().unwrap();
    assert_eq!((status.neighbors_done, status.bands_done), (3, 0));
    for tile in [1, 0, 2, 0] {
        done(Task::Bands(tile)).unwrap();
    }
    assert_eq!(joined(&path, inputs, &params), expected);
    let others =
        Params { denoise: Some(DenoiseParams::default().with_creases(Creases::Keep)), ..params.clone() };
    assert!(TilingJob::begin(&path, inputs, &others).is_err());
    let gains = Params { levels: 3, gains: vec![0.0, 1.0, 1.0], ..params.clone() };
    assert!(
        TilingJob::begin(&folder.path().join("no"), inputs, &gains)
            .unwrap_err()
            .to_string()
            .contains("separate job")
    );
    let wrong = Params { denoise: Some(DenoiseParams::default().with_noise(f64::NAN)), ..params };
    assert!(TilingJob::begin(&folder.path().join("no"), inputs, &wrong).is_err());
    job.clean().unwrap();
    job.remove_tiles().unwrap();
    let left: Vec<_> = std::fs::read_dir(&path).unwrap().flatten().map(|e| e.file_name()).collect();
    assert_eq!(left, ["joined.las"]);
}

#[test]
fn few_points_points_in_one_spot_and_no_noise() {
    let folder = tempfile::tempdir().unwrap();
    for n in [1, 2, 9, 500] {
        let input = folder.path().join(format!("{n}.las"));
        write(&input, &cloud(n), 0.0);
        joined(&folder.path().join(format!("{n}")), &[input], &params());
    }
    let input = folder.path().join("spot.las");
    write(&input, &[[5; 3]; 900], 0.0);
    joined(&folder.path().join("spot"), std::slice::from_ref(&input), &params());
    let flat: Vec<[i32; 3]> = (0..2500).map(|i| [i % 50, i / 50, 0].map(|c| c * 1000)).collect();
    write(&input, &flat, 0.0);
    let job = TilingJob::begin(&folder.path().join("flat"), &[input], &params()).unwrap().0;
    let summary = run(&job, Progress::none()).unwrap();
    assert!(summary.moved[1] < 1e-9, "{:?}", summary.moved);
}
