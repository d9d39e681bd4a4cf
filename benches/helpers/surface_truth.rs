//! Denoising of clouds of exact surfaces, beside the best quadric that the truth chooses, and the noise found beside
//! the true noise, as tables and as a curve:
//!
//!     surface_truth [first|second] [SEEDS] [CURVE.svg]
//!
//! The first half of the seeds is for development, the second is looked at in the end.

use adwave::shape::{PointCloud, Shape};
use adwave_bench_helpers::truth::{
    CloudNoise, ExactCloud, ExactShape, Sampling, best_quadric_error, root_mean_square,
};
use adwave_bench_helpers::{BenchOutcome, CalibrationDot, calibration_svg, denoise_by_default, seed_parity};
use rayon::prelude::*;

/// Number of points of a cloud, of a plane in lines, and of each two sheets.
const POINTS: usize = 8000;
const POINTS_IN_LINES: usize = 7200;

/// Noise in spacings.
const NOISE: [f64; 9] = [0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0, 3.0];
const NOISE_IN_LINES: [f64; 3] = [0.05, 0.3, 1.0];
const NOISE_OF_SHEETS: [f64; 5] = [0.05, 0.2, 0.4, 0.7, 1.0];

/// Distances of two sheets, in spacings.
const GAPS: [f64; 7] = [0.5, 1.0, 1.5, 2.0, 3.0, 6.0, 10.0];

/// Numbers of neighbors of the quadrics of which the truth chooses one for each cloud.
const SIZES: [usize; 7] = [15, 24, 30, 48, 60, 90, 120];
const SIZES_IN_LINES: [usize; 7] = [15, 30, 60, 120, 240, 480, 960];

/// Range of found / true that counts as found.
const FOUND: [f64; 2] = [0.75, 1.33];

/// Laws of the noise with their names.
type Law = (&'static str, fn(f64) -> CloudNoise);
const LAWS: [Law; 4] = [
    ("along the normals", CloudNoise::Normal),
    ("all directions", CloudNoise::Isotropic),
    ("along sight", CloudNoise::Sight),
    ("by place", CloudNoise::ByPlace),
];

/// A denoised cloud.
struct SurfaceRow {
    /// Indices in [`NOISE`], [`ExactShape::ALL`] and [`LAWS`].
    noise: usize,
    shape: usize,
    law: usize,
    dot: CalibrationDot,
    /// Error after denoising relative to the true noise, and to the error of the best quadric.
    left: f64,
    error: f64,
}

impl SurfaceRow {
    /// Found / true.
    fn ratio(&self) -> f64 {
        self.dot.found / self.dot.truth
    }
}

fn main() -> BenchOutcome<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let first = seed_parity(words.first().map_or("first", String::as_str))?;
    let n_seeds: u64 = words.get(1).map_or(Ok(2), |w| w.parse())?;
    let seeds: Vec<u64> = (0..n_seeds).map(|k| 2 * k + first).collect();
    let rows = surface_rows(&seeds)?;
    println!(
        "| noise in spacings | found / true, smooth | error, smooth | found / true, edges | error, edges |"
    );
    println!("| --- | --: | --: | --: | --: |");
    for (k, noise) in NOISE.iter().enumerate() {
        let cells = [false, true].map(|edges| {
            let own = |r: &&SurfaceRow| r.noise == k && ExactShape::ALL[r.shape].1.has_edges() == edges;
            let own: Vec<&SurfaceRow> = rows.iter().filter(own).collect();
            format!("{} | {}", ratio_cell(&own), error_cell(&own))
        });
        println!("| {noise} | {} |", cells.join(" | "));
    }
    println!("\n| clouds | found / true | in {:.2} to {:.2} | in the interval | error |", FOUND[0], FOUND[1]);
    println!("| --- | --: | --: | --: | --: |");
    for (k, (name, _)) in ExactShape::ALL.iter().enumerate() {
        print_group(name, &rows, |r| r.shape == k);
    }
    for (k, (name, _)) in LAWS.iter().enumerate() {
        print_group(name, &rows, |r| r.law == k);
    }
    print_group("weak noise found", &rows, |r| !r.dot.is_strong);
    print_group("strong noise found", &rows, |r| r.dot.is_strong);
    print_group("all", &rows, |_| true);
    print_lines(&seeds)?;
    print_sheets(&seeds)?;
    if let Some(path) = words.get(2) {
        let dots: Vec<CalibrationDot> = rows.iter().map(|row| row.dot).collect();
        std::fs::write(path, calibration_svg(&dots)).map_err(|e| format!("{path}: {e}"))?;
    }
    Ok(())
}

/// All surfaces of all seeds with all strengths of noise. Samplings and laws take turns.
fn surface_rows(seeds: &[u64]) -> BenchOutcome<Vec<SurfaceRow>> {
    let clouds: Vec<(usize, u64)> =
        (0..ExactShape::ALL.len()).flat_map(|shape| seeds.iter().map(move |&seed| (shape, seed))).collect();
    let rows = |&(shape, seed): &(usize, u64)| {
        let turn = shape + seed as usize / 2;
        let sampling = Sampling::ALL[turn % Sampling::ALL.len()];
        let cloud = ExactCloud::new(ExactShape::ALL[shape].1, sampling, POINTS, seed);
        let row = |noise: usize| {
            let law = (turn + noise) % LAWS.len();
            let noisy = LAWS[law].1(NOISE[noise]).apply(&cloud.clean, seed).points;
            let row = SurfaceRow { noise, shape, law, ..surface_row(&cloud, &noisy, &SIZES)? };
            let name = format!("{}, seed {seed}, {sampling:?}", ExactShape::ALL[shape].0);
            let (found, error) = (row.ratio(), row.error);
            eprintln!("{name}, {} {}: found {found:.2}, error {error:.2}", LAWS[law].0, NOISE[noise]);
            Ok(row)
        };
        (0..NOISE.len()).into_par_iter().map(row).collect::<Result<Vec<_>, String>>()
    };
    Ok(clouds.par_iter().map(rows).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

fn surface_row(cloud: &ExactCloud, noisy: &[[f64; 3]], sizes: &[usize]) -> Result<SurfaceRow, String> {
    let denoised = PointCloud::new(noisy.to_vec()).map_err(|e| e.to_string())?;
    let denoised = denoise_by_default(&Shape::Cloud(denoised)).map_err(|e| e.to_string())?;
    let info = denoised.info.cloud.ok_or("a cloud must have information about its noise, found none")?;
    let (spacing, truth) = (cloud.clean.spacing, cloud.noise(noisy));
    let error = cloud.error(&denoised.points);
    Ok(SurfaceRow {
        noise: 0,
        shape: 0,
        law: 0,
        dot: CalibrationDot {
            truth: truth / spacing,
            found: denoised.info.noise / spacing,
            interval: info.noise_interval.map(|end| end / spacing),
            is_strong: info.strong.is_some(),
        },
        left: error / truth,
        error: error / best_quadric_error(cloud, noisy, sizes),
    })
}

/// Median and range of found / true.
fn ratio_cell(rows: &[&SurfaceRow]) -> String {
    let mut ratios: Vec<f64> = rows.iter().map(|r| r.ratio()).collect();
    ratios.sort_by(f64::total_cmp);
    let [Some(least), Some(most)] = [ratios.first(), ratios.last()] else { return "–".to_owned() };
    let median = f64::midpoint(ratios[(ratios.len() - 1) / 2], ratios[ratios.len() / 2]);
    format!("{median:.2}, {least:.2} to {most:.2}")
}

/// Mean and worst error relative to the best quadric.
fn error_cell(rows: &[&SurfaceRow]) -> String {
    let worst = rows.iter().map(|r| r.error).fold(0.0, f64::max);
    format!("{:.2}, {worst:.2}", mean(rows, |r| r.error))
}

fn mean(rows: &[&SurfaceRow], value: impl Fn(&SurfaceRow) -> f64) -> f64 {
    rows.iter().map(|r| value(r)).sum::<f64>() / rows.len().max(1) as f64
}

fn print_group(name: &str, rows: &[SurfaceRow], is_own: impl Fn(&SurfaceRow) -> bool) {
    let own: Vec<&SurfaceRow> = rows.iter().filter(|r| is_own(r)).collect();
    let n = own.len();
    let found = own.iter().filter(|r| (FOUND[0]..=FOUND[1]).contains(&r.ratio())).count();
    let covered = own.iter().filter(|r| r.dot.is_covered()).count();
    println!("| {name} | {} | {found} of {n} | {covered} of {n} | {} |", ratio_cell(&own), error_cell(&own));
}

/// Table of planes and spheres in scan lines; noise is in distances of the points along a line.
fn print_lines(seeds: &[u64]) -> BenchOutcome<()> {
    type Scan = fn(f64, usize, u64) -> ExactCloud;
    let plane: Scan = ExactCloud::plane_in_lines;
    let sphere: Scan = ExactCloud::sphere_in_lines;
    let heads = NOISE_IN_LINES.map(|noise| format!("noise {noise}: found / true, left, error"));
    println!("\n| surface | lines apart | {} |", heads.join(" | "));
    println!("| --- | --: | --: | --: | --: |");
    for (name, scan, n, distances) in
        [("plane", plane, POINTS_IN_LINES, [5.0, 8.0, 15.0]), ("sphere", sphere, POINTS, [5.0, 10.0, 20.0])]
    {
        for apart in distances {
            let clouds: Vec<ExactCloud> = seeds.iter().map(|&seed| scan(apart, n, seed)).collect();
            let mut cells = Vec::new();
            for noise in NOISE_IN_LINES {
                let row = |(cloud, &seed): (&ExactCloud, &u64)| {
                    let noisy = CloudNoise::Normal(noise).apply(&cloud.clean, seed).points;
                    surface_row(cloud, &noisy, &SIZES_IN_LINES)
                };
                let rows = clouds.par_iter().zip(seeds).map(row).collect::<Result<Vec<_>, _>>()?;
                let rows: Vec<&SurfaceRow> = rows.iter().collect();
                let [found, left, error] =
                    [mean(&rows, SurfaceRow::ratio), mean(&rows, |r| r.left), mean(&rows, |r| r.error)];
                cells.push(format!("{found:.2}, {left:.2}, {error:.2}"));
            }
            println!("| {name} | {apart} | {} |", cells.join(" | "));
        }
    }
    Ok(())
}

/// Table of two sheets: distance of the points from their own sheet in spacings, before, after, and after with the
/// normals of the sheets given.
fn print_sheets(seeds: &[u64]) -> BenchOutcome<()> {
    let heads = NOISE_OF_SHEETS.map(|noise| format!("noise {noise}: before, after, with normals"));
    println!("\n| gap | {} |", heads.join(" | "));
    println!("| --: |{}", " --: |".repeat(NOISE_OF_SHEETS.len()));
    for gap in GAPS {
        let clouds: Vec<ExactCloud> =
            seeds.iter().map(|&seed| ExactCloud::two_sheets(gap, POINTS, seed)).collect();
        let mut cells = Vec::new();
        for noise in NOISE_OF_SHEETS {
            let errors = |(cloud, &seed): (&ExactCloud, &u64)| -> Result<[f64; 3], String> {
                let noisy = CloudNoise::Normal(noise).apply(&cloud.clean, seed).points;
                let plain = PointCloud::new(noisy.clone()).map_err(|e| e.to_string())?;
                let with_normals = plain.clone().with_normals(cloud.clean.normals.clone());
                let after = |shape: PointCloud| -> Result<f64, String> {
                    let denoised = denoise_by_default(&Shape::Cloud(shape)).map_err(|e| e.to_string())?;
                    Ok(cloud.error(&denoised.points) / cloud.clean.spacing)
                };
                Ok([cloud.error(&noisy) / cloud.clean.spacing, after(plain)?, after(with_normals)?])
            };
            let errors = clouds.par_iter().zip(seeds).map(errors).collect::<Result<Vec<_>, _>>()?;
            let joint = [0, 1, 2].map(|k| root_mean_square(errors.iter().map(|e| e[k])));
            cells.push(joint.map(|error| format!("{error:.2}")).join(", "));
        }
        println!("| {gap} | {} |", cells.join(" | "));
    }
    Ok(())
}
