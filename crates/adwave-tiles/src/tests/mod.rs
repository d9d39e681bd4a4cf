//! Clouds: several tiles against one tile, against the bands in memory, and after an interruption at any moment.

mod denoise;
mod mesh;
mod motion;
mod selection;

use std::path::{Path, PathBuf};

use adwave::bands::Schedule;
use adwave::features::{Feature, FeatureParams, features};
use adwave::positions::MoveDirection;
use adwave::saliency::{SaliencyParams, Sign, Weighting, saliency};
use adwave::shape::{PointCloud, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{LasLayout, LasReader, LasWriter};

use crate::halo::collect_tile;
use crate::job::forecast::halo_limits;
use crate::layout::{quantized_xyz, set_quantized_xyz};
use crate::{MapKind, MapWeights, Params, Task, TilesError, TilingJob, join, run, run_task};

/// Bytes of a record of point format 0.
pub(crate) const RECORD: usize = 20;

fn random(i: u32, salt: u32) -> f64 {
    let mixed = (i ^ salt.wrapping_mul(0x9e37_79b9)).wrapping_mul(2_654_435_761).rotate_left(13);
    f64::from(mixed.wrapping_mul(2_246_822_519)) / 4_294_967_296.0
}

/// A hilly sheet that is denser on one side, with outliers above it and with duplicate points.
pub(crate) fn cloud(n: u32) -> Vec<[i32; 3]> {
    (0..n)
        .map(|i| {
            let i = if i % 97 == 5 { i - 1 } else { i };
            let (x, y) = (100.0 * random(i, 1) * random(i, 2), 80.0 * random(i, 3));
            let z = 4.0 * (x / 9.0).sin() + 3.0 * (y / 7.0).cos() + 0.05 * random(i, 4);
            let far = if i % 5000 == 17 { 4000.0 * random(i, 5) } else { 0.0 };
            [x, y, z + far].map(|c| (c * 1000.0) as i32)
        })
        .collect()
}

pub(crate) fn write(path: &Path, points: &[[i32; 3]], offset: f64) {
    let layout = LasLayout {
        format: 0,
        record_bytes: RECORD,
        scale: [0.001; 3],
        offset: [offset; 3],
        n_points: points.len() as u64,
        bounds: None,
    };
    let mut writer = LasWriter::new(path, &layout, &[], None).unwrap();
    let mut records = vec![0; RECORD * points.len()];
    for (i, (record, point)) in records.chunks_exact_mut(RECORD).zip(points).enumerate() {
        set_quantized_xyz(record, point.map(|c| c - (offset * 1000.0) as i32));
        record[12..14].copy_from_slice(&(i as u16).to_le_bytes()); // intensity: which point it is
    }
    writer.write(&records).unwrap();
    writer.finish().unwrap();
}

/// Parameters with all kinds of output.
fn maps() -> Params {
    let saliency = Some(MapWeights { skip: 1, kind: MapKind::Entropy });
    Params { vectors: vec![3], saliency, theta: Some(1.6), ..params() }
}

fn params() -> Params {
    Params {
        levels: 5,
        gains: vec![0.0, 0.2, 1.0, 1.5, 1.0],
        along: Some(MoveDirection::Free),
        magnitudes: vec![2, 5],
        ..Params::default()
    }
}

/// Runs a job in `folder` and returns the bytes of the joined tiles.
pub(crate) fn joined(folder: &Path, inputs: &[PathBuf], params: &Params) -> Vec<u8> {
    let job = TilingJob::begin(folder, inputs, params).unwrap().0;
    let summary = run(&job, Progress::none()).unwrap();
    assert!(params.n_tiles.is_none_or(|n| summary.n_tiles <= n));
    let path = folder.join("joined.las");
    join(&job, &path, Progress::none()).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn tiles_of_any_size_give_the_bytes_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let points = cloud(60_000);
    let (a, b) = (folder.path().join("a.las"), folder.path().join("b.laz"));
    write(&a, &points[..25_000], 0.0);
    write(&b, &points[25_000..], 64.0);
    let inputs = [a, b];
    for (name, params) in [("bands", params()), ("maps", maps())] {
        let one = folder.path().join(name);
        let whole = joined(&one, &inputs, &params);
        let features = TilingJob::open(&one).unwrap().features().unwrap();
        assert_eq!(features.is_empty(), params.theta.is_none());
        for n_tiles in [2, 5, 15] {
            let params = Params { n_tiles: Some(n_tiles), n_workers: 2, ..params.clone() };
            let path = folder.path().join(format!("{name}-{n_tiles}"));
            assert!(joined(&path, &inputs, &params) == whole, "{n_tiles} tiles differ");
            assert_eq!(TilingJob::open(&path).unwrap().features().unwrap(), features);
        }
    }
}

/// The added fields of all points in a file, by the index of the point, which the intensity stores.
fn fields_of(path: &Path, n_points: usize, n_fields: usize) -> Vec<Vec<f32>> {
    let mut reader = LasReader::open(path).unwrap();
    let mut records = Vec::new();
    while reader.read(usize::MAX, &mut records).unwrap() > 0 {}
    let size = RECORD + 4 * n_fields;
    assert_eq!(records.len(), size * n_points);
    let mut fields = vec![Vec::new(); n_points];
    for record in records.chunks_exact(size) {
        let i = usize::from(u16::from_le_bytes([record[12], record[13]]));
        fields[i] = record[RECORD..].as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b)).collect();
    }
    fields
}

#[test]
fn vectors_map_and_features_are_those_of_the_cloud_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let points = cloud(30_000);
    let input = folder.path().join("a.las");
    write(&input, &points, 0.0);
    let positions: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| f64::from(c) * 0.001)).collect();
    let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(positions.clone()).unwrap()));
    let request_of = |positions: &[[f64; 3]]| {
        let schedule = Schedule::dyadic(5).unwrap();
        let bands = decomposer.decompose(positions.as_flattened(), 3, &schedule).unwrap();
        let wavelets = decomposer.request(positions.as_flattened(), 3, &schedule).norms().unwrap();
        (bands, wavelets)
    };
    let (bands, wavelets) = request_of(&positions);
    let kinds = [
        (MapKind::Entropy, Weighting::Entropy),
        (MapKind::PerLevel, Weighting::PerLevel),
        (MapKind::Normalized, Weighting::Normalized),
        (MapKind::Uniform, Weighting::Uniform),
    ];
    for (kind, weighting) in kinds {
        let saliency_asked = Some(MapWeights { skip: 1, kind });
        let params =
            Params { n_tiles: Some(4), accuracy: 1e-9, saliency: saliency_asked, gains: vec![], ..maps() };
        let work_folder = folder.path().join(format!("{kind:?}"));
        let out = folder.path().join("out.las");
        std::fs::write(&out, joined(&work_folder, std::slice::from_ref(&input), &params)).unwrap();
        let asked =
            SaliencyParams::default().with_sign(Sign::Unsigned).with_skip(1).with_weighting(weighting);
        let map = saliency(&decomposer, &wavelets, &asked, Progress::none()).unwrap().map;
        let most = map.iter().copied().fold(0.0, f64::max);
        for (i, fields) in fields_of(&out, points.len(), 6).iter().enumerate() {
            for c in 0..3 {
                let exact = bands.wavelet(3)[3 * i + c];
                assert!((f64::from(fields[2 + c]) - exact).abs() <= 1e-6 * exact.abs() + 1e-7);
            }
            assert!(
                (f64::from(fields[5]) - map[i]).abs() <= 1e-6 * most,
                "{kind:?}: {} for {}",
                fields[5],
                map[i]
            );
        }
        let asked = FeatureParams::default().with_theta(1.6);
        let exact = features(&decomposer, &wavelets, &asked, Progress::none()).unwrap();
        let found = TilingJob::open(&work_folder).unwrap().features().unwrap();
        assert!(exact.len() > 50);
        let key = |f: &Feature| (f.level, f.position.unwrap().map(|c| (c * 1000.0).round() as i64));
        let (mut a, mut b): (Vec<_>, Vec<_>) =
            (exact.iter().map(key).collect::<Vec<_>>(), found.iter().map(key).collect());
        a.sort_unstable();
        b.sort_unstable();
        assert_eq!(a, b);
        for (exact, found) in exact.iter().zip(&found) {
            assert!((exact.strength / found.strength - 1.0).abs() < 1e-5);
            assert!((exact.sigma / found.sigma - 1.0).abs() < 1e-9, "{} for {}", found.sigma, exact.sigma);
        }
    }
}

#[test]
fn a_tile_whose_halo_exceeds_the_memory_is_computed_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, &cloud(60_000), 0.0);
    let (inputs, path) = ([input], folder.path().join("parts"));
    let whole = joined(&folder.path().join("whole"), &inputs, &params());
    drop(TilingJob::begin(&path, &inputs, &params()).unwrap());
    let plan = path.join("plan.json");
    let mut json: serde_json::Value = serde_json::from_slice(&std::fs::read(&plan).unwrap()).unwrap();
    // The fixed share and 10 MB: less than all 60 000 vertices need.
    json["params"]["memory"] = ((64 << 20) + 10_000_000).into();
    std::fs::write(&plan, json.to_string()).unwrap();
    let job = TilingJob::open(&path).unwrap();
    assert_eq!(run(&job, Progress::none()).unwrap().n_tiles, 1);
    // All blocks together exceed the limits, one block does not.
    let blocks = job.blocks().unwrap();
    let neighbor_index = job.neighbor_index(&blocks).unwrap();
    let limits = halo_limits(&job.plan.shape, &job.plan.params).unwrap();
    let fits =
        |range| collect_tile(&blocks, &neighbor_index, range, limits, Progress::none()).unwrap().is_some();
    assert!(!fits(0..blocks.len()) && fits(0..1));
    let out = path.join("joined.las");
    join(&job, &out, Progress::none()).unwrap();
    assert!(std::fs::read(out).unwrap() == whole);
}

#[test]
fn the_bands_are_those_of_the_cloud_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let points = cloud(30_000);
    let input = folder.path().join("a.las");
    write(&input, &points, 0.0);
    let params = Params { n_tiles: Some(4), accuracy: 1e-9, ..params() };
    let bytes = joined(&folder.path().join("job"), &[input], &params);
    std::fs::write(folder.path().join("out.las"), bytes).unwrap();
    let positions: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| f64::from(c) * 0.001)).collect();
    let shape = Shape::Cloud(PointCloud::new(positions.clone()).unwrap());
    let schedule = Schedule::dyadic(5).unwrap();
    let bands = Decomposer::new(&shape).decompose(positions.as_flattened(), 3, &schedule).unwrap();
    let mut reader = LasReader::open(&folder.path().join("out.las")).unwrap();
    let mut records = Vec::new();
    while reader.read(usize::MAX, &mut records).unwrap() > 0 {}
    let size = RECORD + 8;
    assert_eq!(records.len(), size * points.len());
    let mut seen = 0;
    for record in records.chunks_exact(size) {
        // The intensity is the index of the point modulo 65 536.
        let i = usize::from(u16::from_le_bytes([record[12], record[13]]));
        let band = |j: usize| -> [f64; 3] { std::array::from_fn(|c| bands.wavelet(j)[3 * i + c]) };
        let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        for (j, at) in [(2, RECORD), (5, RECORD + 4)] {
            let found = f32::from_le_bytes(record[at..at + 4].try_into().unwrap());
            let exact = length(band(j));
            assert!((f64::from(found) - exact).abs() <= 1e-6 * exact + 1e-9, "{i}: {found} for {exact}");
        }
        let exact: [f64; 3] =
            std::array::from_fn(|c| positions[i][c] - band(1)[c] - 0.8 * band(2)[c] + 0.5 * band(4)[c]);
        for (found, exact) in quantized_xyz(record).into_iter().zip(exact) {
            assert!((f64::from(found) * 0.001 - exact).abs() <= 0.000_501, "{i}: {found} for {exact}");
        }
        seen += 1;
    }
    assert_eq!(seen, points.len());
}

#[test]
fn a_job_continues_after_any_task_and_tasks_may_run_twice_or_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, &cloud(20_000), 0.0);
    let inputs = [input];
    let params = Params { n_tiles: Some(3), ..maps() };
    let whole = joined(&folder.path().join("whole"), &inputs, &params);
    let path = folder.path().join("parts");
    let job = TilingJob::begin(&path, &inputs, &params).unwrap().0;
    assert!(run_task(&job, Task::Neighbors(0), Progress::none()).is_err());
    std::fs::write(path.join("run-0000000000.bin"), b"half a run").unwrap();
    assert!(!job.is_done(Task::Run(0)));
    run_task(&job, Task::Run(0), Progress::none()).unwrap();
    assert!(job.is_done(Task::Run(0)) && job.n_runs() == 1);
    assert!(matches!(run_task(&job, Task::Run(1), Progress::none()), Err(TilesError::Input(_))));
    run_task(&job, Task::Sort, Progress::none()).unwrap();
    for task in [Task::Neighbors(2), Task::Neighbors(0), Task::Neighbors(0)] {
        run_task(&job, task, Progress::none()).unwrap();
    }
    let early = run_task(&job, Task::Bands(1), Progress::none());
    assert!(early.unwrap_err().to_string().contains("the neighbors of tile 1 must be computed first"));
    let job = TilingJob::open(&path).unwrap();
    run_task(&job, Task::Neighbors(1), Progress::none()).unwrap();
    run_task(&job, Task::Bands(1), Progress::none()).unwrap();
    assert!(run_task(&job, Task::Bands(3), Progress::none()).is_err());
    let early = run_task(&job, Task::Maps(1), Progress::none());
    assert!(early.unwrap_err().to_string().contains("the bands of tile 0 must be computed first"));
    run_task(&job, Task::Bands(0), Progress::none()).unwrap();
    run_task(&job, Task::Bands(2), Progress::none()).unwrap();
    for task in [Task::Maps(2), Task::Maps(0), Task::Maps(0)] {
        run_task(&job, task, Progress::none()).unwrap();
    }
    assert!(job.is_done(Task::Maps(0)) && !job.is_done(Task::Maps(1)));
    assert!(joined(&path, &inputs, &params) == whole);
    // A job with other parameters does not use the same folder.
    let other = Params { levels: 6, gains: vec![1.0; 6], ..params.clone() };
    assert!(matches!(TilingJob::begin(&path, &inputs, &other), Err(TilesError::Input(_))));
    job.clean().unwrap();
    assert_eq!(std::fs::read_dir(&path).unwrap().count(), 4); // three tiles and the joined file
}

#[test]
fn runs_of_any_length_are_merged_to_the_same_order() {
    let folder = tempfile::tempdir().unwrap();
    let points = cloud(30_000);
    let (a, b) = (folder.path().join("a.las"), folder.path().join("b.laz"));
    write(&a, &points[..17_000], 0.0);
    write(&b, &points[17_000..], 64.0);
    let inputs = [a, b];
    let sorted = |most: usize| {
        let path = folder.path().join(format!("runs-{most}"));
        let job = TilingJob::begin(&path, &inputs, &params()).unwrap().0;
        // Files that a killed process left behind are ignored.
        std::fs::write(path.join("run-0000000000.bin"), b"half a run").unwrap();
        std::fs::write(path.join("run-0000000017.bin"), [0; 5 * RECORD]).unwrap();
        std::fs::write(path.join(".adwave-half.tmp"), b"half a file").unwrap();
        job.sort_in_runs(most, most, Progress::none()).unwrap();
        let left =
            std::fs::read_dir(&path).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
        let mut left: Vec<String> = left.collect();
        left.sort();
        assert_eq!(left, ["blocks.bin", "plan.json", "records.bin", "sort.lock"]);
        ["records.bin", "blocks.bin"].map(|name| std::fs::read(path.join(name)).unwrap())
    };
    let one_run = sorted(1_000_000);
    let records: Vec<&[u8]> = one_run[0].chunks_exact(RECORD + 1).collect();
    let numbers: Vec<u16> = records.iter().map(|r| u16::from_le_bytes([r[12], r[13]])).collect();
    // Points at one position keep the order of the inputs.
    let same = |k: &usize| records[*k][..12] == records[k + 1][..12];
    let doubled: Vec<usize> = (0..points.len() - 1).filter(same).collect();
    assert!(doubled.len() > 200 && doubled.iter().all(|&k| numbers[k] < numbers[k + 1]));
    for most in [999, 17_000, 29_999] {
        assert!(sorted(most) == one_run, "runs of {most}");
    }
}

#[test]
fn two_concurrent_sorts_sort_once_and_files_of_another_job_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, &cloud(20_000), 0.0);
    let inputs = [input];
    let path = folder.path().join("job");
    let job = TilingJob::begin(&path, &inputs, &params()).unwrap().0;
    std::thread::scope(|scope| {
        let both = [0, 1].map(|_| scope.spawn(|| run_task(&job, Task::Sort, Progress::none())));
        assert!(both.into_iter().all(|sort| sort.join().unwrap().is_ok()));
    });
    for tile in 0..job.n_tiles().unwrap() {
        run_task(&job, Task::Neighbors(tile), Progress::none()).unwrap();
    }
    std::fs::remove_file(path.join("plan.json")).unwrap();
    let other = Params { neighbors: 4, ..params() };
    let begun = TilingJob::begin(&path, &inputs, &other).map(|_| ());
    assert!(matches!(&begun, Err(TilesError::Input(what)) if what.contains("earlier job")), "{begun:?}");
}

#[test]
fn few_points_points_in_one_spot_and_no_points() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    for (i, points) in
        [vec![[5, 6, 7]], vec![[5, 6, 7]; 9000], vec![[1, 0, 0], [2, 0, 0], [9, 0, 0]]].iter().enumerate()
    {
        write(&input, points, 0.0);
        let out = joined(&folder.path().join(i.to_string()), std::slice::from_ref(&input), &params());
        assert!(!out.is_empty());
    }
    write(&input, &[], 0.0);
    let none = TilingJob::begin(&folder.path().join("none"), &[input], &params()).map(|_| ());
    assert!(matches!(none, Err(TilesError::Input(_))), "{none:?}");
}

#[test]
fn broken_files_of_the_folder_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, &cloud(9000), 0.0);
    let params = Params { n_tiles: Some(3), ..params() };
    for name in ["records.bin", "blocks.bin", "near-00001.bin", "plan.json"] {
        let path = folder.path().join("job");
        let job = TilingJob::begin(&path, std::slice::from_ref(&input), &params).unwrap().0;
        run_task(&job, Task::Sort, Progress::none()).unwrap();
        for tile in 0..job.n_tiles().unwrap() {
            run_task(&job, Task::Neighbors(tile), Progress::none()).unwrap();
        }
        let bytes = std::fs::read(path.join(name)).unwrap();
        for cut in [0, 7, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(path.join(name), &bytes[..cut]).unwrap();
            let result = TilingJob::open(&path).and_then(|job| run(&job, Progress::none()));
            assert!(
                result.as_ref().is_err_and(|e| e.to_string().contains(name)),
                "{name} cut at {cut}: {result:?}"
            );
        }
        std::fs::remove_dir_all(&path).unwrap();
    }
}

#[test]
fn broken_files_of_the_maps_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, &cloud(9000), 0.0);
    let params = Params { n_tiles: Some(3), ..maps() };
    let path = folder.path().join("job");
    let job = TilingJob::begin(&path, std::slice::from_ref(&input), &params).unwrap().0;
    run(&job, Progress::none()).unwrap();
    for name in
        ["made-00001.bin", "lengths-00001.bin", "tile-00001.json", "levels.json", "features-00001.json"]
    {
        let bytes = std::fs::read(path.join(name)).unwrap();
        for cut in [0, 1, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(path.join(name), &bytes[..cut]).unwrap();
            let again = ["levels.json", "tile-00000.laz", "tile-00001.laz", "tile-00002.laz"];
            for other in again.iter().filter(|other| *other != &name && !name.starts_with("features")) {
                let _ = std::fs::remove_file(path.join(other));
            }
            let result = run(&job, Progress::none()).and_then(|_| job.features());
            assert!(
                result.as_ref().is_err_and(|e| e.to_string().contains(name)),
                "{name} cut at {cut}: {result:?}"
            );
        }
        std::fs::write(path.join(name), bytes).unwrap();
        assert!(run(&job, Progress::none()).is_ok());
    }
}
