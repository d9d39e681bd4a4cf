//! Denoising of random meshes whose truth is known, as tables by noise and shape:
//!
//!     mesh_truth [first|second] SEEDS [default|tuned|alone] [FOLDER]
//!
//! The first half of the seeds is for development, the second is looked at in the end. `tuned` also searches settings of
//! the other methods by looking at the truth, `alone` omits them. Pairs `…/noisy.obj` and `…/clean.obj` below FOLDER get
//! a table of their own. With `rows` instead of FOLDER, one line per mesh and noise is printed.

use adwave::Progress;
use adwave::denoise::{DenoiseInfo, DenoiseParams, SharedNoise, denoise};
use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
use adwave_baselines::differential::{Differential, Weights};
use adwave_baselines::normal_filter::{
    BilateralParams, GuidedParams, NormalScheme, bilateral_normals, guided_normals,
};
use adwave_baselines::taubin::{LambdaMu, WindowedSinc, lambda_mu};
use adwave_bench_helpers::truth::{CleanMesh, MeshNoise, MeshShape};
use adwave_bench_helpers::{BenchOutcome, seed_parity};
use adwave_io::{ReadLimits, read_path};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

/// Names of the other methods.
const RIVALS: [&str; 4] = ["bilateral", "guided", "Taubin", "sinc"];

/// Settings of the other methods beside ours.
#[derive(Clone, Copy, PartialEq)]
enum Rivals {
    Default,
    Tuned,
    None,
}

/// One mesh with one noise. Angles are in degrees.
#[derive(Clone, Default)]
struct TruthRow {
    shape: usize,
    noise: usize,
    name: String,
    before: f64,
    after: f64,
    /// Of each other method with its default, then the best of all settings of all.
    rivals: [f64; 4],
    best: f64,
    /// Root mean square motion in mean edges.
    moved: f64,
    seconds: f64,
    info: DenoiseInfo,
}

/// Rows with shared noise that the caller asks to remove; not part of the means.
const SHARED_REMOVED: [(&str, MeshNoise); 3] = [
    ("none, to remove", MeshNoise::Clean),
    ("shared, 0.15, to remove", MeshNoise::Correlated(0.15)),
    ("shared, 0.3, to remove", MeshNoise::Correlated(0.3)),
];

fn main() -> BenchOutcome<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let first = seed_parity(words.first().map_or("first", String::as_str))?;
    let n_seeds: u64 = words.get(1).map_or(Ok(2), |w| w.parse())?;
    let rivals = match words.get(2).map_or("default", String::as_str) {
        "default" => Rivals::Default,
        "tuned" => Rivals::Tuned,
        "alone" => Rivals::None,
        other => return Err(format!("the rivals must be default, tuned or alone, got {other}").into()),
    };
    let cases: Vec<(usize, u64)> = (0..MeshShape::ALL.len())
        .flat_map(|shape| (0..n_seeds).map(move |k| (shape, 2 * k + first)))
        .collect();
    let found = cases.par_iter().map(|&(shape, seed)| {
        let clean = MeshShape::ALL[shape].1.mesh(seed);
        let row = |(noise, kind, shared): (usize, MeshNoise, SharedNoise)| -> Result<TruthRow, String> {
            let name = format!("{} {seed}", MeshShape::ALL[shape].0);
            let row = row(&clean, &kind.apply(&clean, seed), rivals, shared).map_err(|e| e.to_string())?;
            Ok(TruthRow { shape, noise, name, ..row })
        };
        let by_default =
            MeshNoise::ALL.iter().enumerate().map(|(k, (_, kind))| (k, *kind, SharedNoise::Detail));
        let removed = SHARED_REMOVED.iter().zip(MeshNoise::ALL.len()..);
        let removed = removed.map(|((_, kind), k)| (k, *kind, SharedNoise::Estimate));
        by_default.chain(removed).map(row).collect::<Result<Vec<TruthRow>, String>>()
    });
    let rows: Vec<TruthRow> = found.collect::<Result<Vec<_>, String>>()?.concat();
    let folder = words.get(3).map(String::as_str);
    if folder == Some("rows") {
        rows.iter().for_each(print_case);
    }
    print_head("noise");
    for (k, (name, _)) in MeshNoise::ALL.iter().chain(&SHARED_REMOVED).enumerate() {
        print_mean(name, &rows.iter().filter(|r| r.noise == k).collect::<Vec<_>>());
    }
    println!();
    print_head("shape");
    for (k, (name, _)) in MeshShape::ALL.iter().enumerate() {
        print_mean(
            name,
            &rows
                .iter()
                .filter(|r| r.shape == k && (1..MeshNoise::ALL.len()).contains(&r.noise))
                .collect::<Vec<_>>(),
        );
    }
    if let Some(folder) = folder.filter(|f| *f != "rows") {
        print_published(Path::new(folder), rivals)?;
    }
    Ok(())
}

fn row(clean: &CleanMesh, noisy: &[[f64; 3]], rivals: Rivals, shared: SharedNoise) -> BenchOutcome<TruthRow> {
    let before = clean.angle(noisy);
    let shape = Shape::Mesh(Mesh::new(noisy.to_vec(), Polygons::from_triangles(&clean.triangles))?);
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
    let start = Instant::now();
    let denoised = denoise(&geometry, &DenoiseParams::default().with_shared(shared), Progress::none())?;
    let seconds = start.elapsed().as_secs_f64();
    let square = |(p, q): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
    let moved = noisy.iter().zip(&denoised.points).map(square).sum::<f64>() / noisy.len() as f64;
    let (rivals, best) = match rivals {
        Rivals::None => ([0.0; 4], 0.0),
        _ => rival_angles(clean, &shape, &geometry, rivals == Rivals::Tuned)?,
    };
    Ok(TruthRow {
        before,
        after: clean.angle(&denoised.points),
        rivals,
        best,
        moved: moved.sqrt() / clean.mean_edge(),
        seconds,
        info: denoised.info,
        ..TruthRow::default()
    })
}

/// Angles of the other methods by default, and the best of all settings.
fn rival_angles(
    clean: &CleanMesh,
    shape: &Shape,
    geometry: &PreparedGeometry,
    is_tuned: bool,
) -> BenchOutcome<([f64; 4], f64)> {
    let none = Progress::none();
    let guided = |sigma: Option<f64>, rounds: usize| -> BenchOutcome<f64> {
        let default = GuidedParams::default();
        let params = default.with_sigma_r(sigma.unwrap_or(default.sigma_r)).with_normal_iterations(rounds);
        Ok(clean.angle(&guided_normals(geometry, &params, none)?))
    };
    let bilateral = |sigma: Option<f64>, rounds: usize| -> BenchOutcome<f64> {
        let default = BilateralParams::default();
        let params = default
            .with_sigma_s(sigma.unwrap_or(default.sigma_s))
            .with_scheme(NormalScheme::Local { iterations: rounds });
        Ok(clean.angle(&bilateral_normals(geometry, &params, none)?))
    };
    let k = Differential::new(shape, Weights::Uniform)?;
    let points = shape.points().unwrap_or_default().as_flattened();
    let sinc = |pass: f64| -> BenchOutcome<f64> {
        Ok(clean.angle(WindowedSinc::new(pass, 20)?.apply(&k, points, 3)?.as_chunks().0))
    };
    let taubin = |rounds: usize| -> BenchOutcome<f64> {
        // The defaults of MeshLab.
        let factors = LambdaMu { lambda: 0.5, mu: -0.53 };
        Ok(clean.angle(lambda_mu(&k, points, 3, factors, rounds)?.as_chunks().0))
    };
    let rivals = [bilateral(None, 20)?, guided(None, 20)?, taubin(10)?, sinc(0.1)?];
    let mut best = rivals.iter().copied().fold(f64::INFINITY, f64::min);
    if is_tuned {
        for sigma in [0.2, 0.35, 0.55] {
            best = best.min(guided(Some(sigma), 5)?).min(guided(Some(sigma), 20)?);
            best = best.min(bilateral(Some(sigma), 5)?).min(bilateral(Some(sigma), 20)?);
        }
        for pass in [0.02, 0.05, 0.2, 0.35, 0.6, 1.0] {
            best = best.min(sinc(pass)?);
        }
        for rounds in [2, 5, 20, 50] {
            best = best.min(taubin(rounds)?);
        }
    }
    Ok((rivals, best))
}

fn print_head(what: &str) {
    println!(
        "| {what} | noisy | adwave | worse | {} | best | noise | moved | s |\n| --- |{}",
        RIVALS.join(" | "),
        " --: |".repeat(RIVALS.len() + 7)
    );
}

fn print_mean(name: &str, rows: &[&TruthRow]) {
    let mean = |value: &dyn Fn(&TruthRow) -> f64| {
        rows.iter().map(|r| value(r)).sum::<f64>() / rows.len().max(1) as f64
    };
    let worse = rows.iter().filter(|r| r.after > r.before + 1e-9).count();
    let rivals: Vec<String> = (0..RIVALS.len()).map(|k| format!("{:.2}", mean(&|r| r.rivals[k]))).collect();
    println!(
        "| {name} | {:.2} | {:.2} | {worse} of {} | {} | {:.2} | {:.3} | {:.3} | {:.2} |",
        mean(&|r| r.before),
        mean(&|r| r.after),
        rows.len(),
        rivals.join(" | "),
        mean(&|r| r.best),
        mean(&|r| r.info.noise_in_edges),
        mean(&|r| r.moved),
        mean(&|r| r.seconds),
    );
}

fn print_case(row: &TruthRow) {
    let rivals: Vec<String> = row.rivals.iter().map(|r| format!("{r:.2}")).collect();
    println!(
        "{};{};{:.2};{:.2};{};{:.2};{:.3};{:.2};{:?}",
        row.name,
        MeshNoise::ALL.iter().chain(&SHARED_REMOVED).nth(row.noise).map_or("", |(name, _)| name),
        row.before,
        row.after,
        rivals.join(";"),
        row.best,
        row.moved,
        row.seconds,
        row.info
    );
}

/// Table of pairs of files, and of clean files with noise along the normals.
fn print_published(folder: &Path, rivals: Rivals) -> BenchOutcome<()> {
    println!();
    print_head("pair");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder)?.map(|e| e.map(|e| e.path())).collect::<Result<_, _>>()?;
    paths.sort();
    let read = |path: &Path| -> BenchOutcome<CleanMesh> {
        let file = read_path(path, &ReadLimits::default())?;
        // Triangles that share positions are kept as they are.
        let triangles = file.faces().iter().filter(|f| f.len() == 3).map(|f| [f[0], f[1], f[2]]).collect();
        Ok(CleanMesh { points: file.points().to_vec(), triangles, sensor: [0.0; 3] })
    };
    let mut all = Vec::new();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && path.join("noisy.obj").is_file() {
            let (clean, noisy) = (read(&path.join("clean.obj"))?, read(&path.join("noisy.obj"))?);
            all.push(TruthRow { name, ..row(&clean, &noisy.points, rivals, SharedNoise::Detail)? });
        } else if path.is_file() {
            let clean = read(&path)?;
            for sigma in [0.1, 0.2, 0.3] {
                let noisy = MeshNoise::Normal(sigma).apply(&clean, 1);
                all.push(TruthRow {
                    name: format!("{name}, {sigma}"),
                    ..row(&clean, &noisy, rivals, SharedNoise::Detail)?
                });
            }
        }
    }
    for row in &all {
        print_mean(&row.name, &[row]);
    }
    print_mean("mean", &all.iter().collect::<Vec<_>>());
    Ok(())
}
