//! Denoising of random clouds whose truth is known, as a table by noise and shape:
//!
//!     denoise_truth [first|second] [SEEDS] [FOLDER]
//!
//! The first half of the seeds is for development, the second is looked at in the end. Pairs of published clouds below
//! FOLDER, named `…/clean_10000.xyz` and `…/noisy_10000_0.01.xyz`, get a table of their own.

use adwave::denoise::Denoised;
use adwave::shape::{PointCloud, Shape};
use adwave_bench_helpers::truth::{
    CleanCloud, CloudNoise, CloudShape, NoisyCloud, Sensor, Tree, chamfer, into_unit_sphere,
};
use adwave_bench_helpers::{BenchOutcome, denoise_by_default, seed_parity};
use adwave_io::{ReadLimits, read_path};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Number of points of a cloud.
const POINTS: usize = 10_000;

/// One row: what a cloud was before and after.
#[derive(Clone, Copy, Default)]
struct Row {
    chamfer: [f64; 2],
    /// Root mean square distance to the surface, in spacings.
    distance: [f64; 2],
    /// Estimated noise in spacings, and the true one along the normals.
    noise: [f64; 2],
    /// Root mean square motion in spacings.
    moved: f64,
    n_far: usize,
    seconds: f64,
}

fn main() -> BenchOutcome<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let first = seed_parity(words.first().map_or("first", String::as_str))?;
    let n_seeds: u64 = words.get(1).map_or(Ok(2), |w| w.parse())?;
    let cases: Vec<(usize, u64)> = (0..CloudShape::ALL.len())
        .flat_map(|shape| (0..n_seeds).map(move |k| (shape, 2 * k + first)))
        .collect();
    let tables: Vec<(usize, Vec<Row>)> = cases
        .par_iter()
        .map(|&(shape, seed)| {
            let clean = CloudShape::ALL[shape].1.sample(POINTS, seed);
            let dense = Tree::new(&clean.dense);
            let rows =
                CloudNoise::ALL.iter().map(|(_, noise)| row(&clean, &dense, &noise.apply(&clean, seed)));
            let rows = rows.collect();
            (shape, rows)
        })
        .collect();
    println!(
        "| noise | Chamfer before | after | worse | distance before | after | noise found | put in | moved | far |"
    );
    println!("| --- | --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    for (k, (name, _)) in CloudNoise::ALL.iter().enumerate() {
        print_row(name, &tables.iter().map(|(_, rows)| rows[k]).collect::<Vec<_>>());
    }
    println!();
    println!(
        "| shape | Chamfer before | after | worse | distance before | after | noise found | put in | moved | far |"
    );
    println!("| --- | --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    for (shape, (name, _)) in CloudShape::ALL.iter().enumerate() {
        let own = tables.iter().filter(|(s, _)| *s == shape).flat_map(|(_, rows)| rows[1..].iter().copied());
        print_row(name, &own.collect::<Vec<_>>());
    }
    print_sensors(n_seeds, first);
    if let Some(folder) = words.get(2) {
        print_published(Path::new(folder))?;
    }
    Ok(())
}

/// Table of the sensors.
fn print_sensors(n_seeds: u64, first: u64) {
    println!(
        "\n| sensor | Chamfer before | after | worse | distance before | after | noise found | put in | moved | far |"
    );
    println!("| --- | --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    for (name, sensor) in Sensor::ALL {
        let one = |k: u64| {
            let (clean, noisy) = sensor.scan(POINTS, 2 * k + first);
            row(&clean, &Tree::new(&clean.dense), &noisy)
        };
        print_row(name, &(0..n_seeds).map(one).collect::<Vec<_>>());
    }
}

fn row(clean: &CleanCloud, dense: &Tree, noisy: &NoisyCloud) -> Row {
    let start = Instant::now();
    let Ok(Denoised { points, info, .. }) = denoised(noisy.points.clone()) else { return Row::default() };
    let seconds = start.elapsed().as_secs_f64();
    // Vegetation and outliers belong to no surface.
    let is_measured = |x: &usize| !noisy.is_outlier[*x] && clean.normals[*x] != [0.0; 3];
    let measured: Vec<usize> = (0..points.len()).filter(is_measured).collect();
    let pick = |all: &[[f64; 3]]| measured.iter().map(|&x| all[x]).collect::<Vec<_>>();
    let (truth, before, after) = (pick(&clean.points), pick(&noisy.points), pick(&points));
    let distance = |cloud: &[[f64; 3]]| {
        let off = |p: &[f64; 3]| {
            let x = dense.closest(p, |_, _| true).name as usize;
            dot(&clean.dense_normals[x], &difference(p, &clean.dense[x])).powi(2)
        };
        (cloud.iter().map(off).sum::<f64>() / cloud.len() as f64).sqrt() / clean.spacing
    };
    let rms = |squares: &mut dyn Iterator<Item = f64>| (squares.sum::<f64>() / measured.len() as f64).sqrt();
    let along =
        |x: &usize| dot(&clean.normals[*x], &difference(&noisy.points[*x], &clean.points[*x])).powi(2);
    let moves = before.iter().zip(&after).map(|(p, q)| dot(&difference(p, q), &difference(p, q)));
    Row {
        chamfer: [chamfer(&before, &truth), chamfer(&after, &truth)],
        distance: [distance(&before), distance(&after)],
        noise: [info.noise / clean.spacing, rms(&mut measured.iter().map(along)) / clean.spacing],
        moved: rms(&mut moves.into_iter()) / clean.spacing,
        n_far: info.n_far,
        seconds,
    }
}

fn denoised(points: Vec<[f64; 3]>) -> BenchOutcome<Denoised> {
    denoise_by_default(&Shape::Cloud(PointCloud::new(points)?))
}

fn print_row(name: &str, rows: &[Row]) {
    let mean = |value: &dyn Fn(&Row) -> f64| rows.iter().map(value).sum::<f64>() / rows.len().max(1) as f64;
    let worse = rows.iter().filter(|r| r.chamfer[1] > r.chamfer[0]).count();
    println!(
        "| {name} | {:.3} | {:.3} | {worse} of {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {} |",
        mean(&|r| r.chamfer[0]),
        mean(&|r| r.chamfer[1]),
        rows.len(),
        mean(&|r| r.distance[0]),
        mean(&|r| r.distance[1]),
        mean(&|r| r.noise[0]),
        mean(&|r| r.noise[1]),
        mean(&|r| r.moved),
        rows.iter().map(|r| r.n_far).sum::<usize>()
    );
    eprintln!("{name}: {:.2} s a cloud", mean(&|r| r.seconds));
}

/// Table of the published pairs below a folder.
fn print_published(folder: &Path) -> BenchOutcome<()> {
    println!("\n| pair | Chamfer before | after | noise found |\n| --- | --: | --: | --: |");
    for path in noisy_files(folder)? {
        let clean = path.with_file_name("clean_10000.xyz");
        let read = |path: &Path| -> BenchOutcome<Vec<[f64; 3]>> {
            Ok(read_path(path, &ReadLimits::default())?.points().to_vec())
        };
        let (mut truth, mut noisy) = (read(&clean)?, read(&path)?);
        into_unit_sphere(&mut truth, &mut noisy);
        let Denoised { points, info, .. } = denoised(noisy.clone())?;
        let name = path.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned();
        let file = path.file_stem().unwrap_or_default().to_string_lossy();
        let [before, after] = [chamfer(&noisy, &truth), chamfer(&points, &truth)];
        println!("| {name}, {file} | {before:.2} | {after:.2} | {:.4} |", info.noise);
    }
    Ok(())
}

fn noisy_files(folder: &Path) -> BenchOutcome<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(noisy_files(&path)?);
        } else if name.starts_with("noisy_10000_0") && path.extension().is_some_and(|e| e == "xyz") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn difference(p: &[f64; 3], q: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| p[k] - q[k])
}

fn dot(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    (0..3).map(|k| p[k] * q[k]).sum()
}
