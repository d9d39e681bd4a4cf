//! Matching of shapes with a known motion, or with none: rates of right and wrong claims, and the calibration of confidences.
//!
//! ```sh
//! cargo run --release -p adwave-register --example match_cases -- choose 40 600 curve.svg shape.ply …
//! ```
//!
//! The seeds `choose` serve to choose constants, the seeds `final` to measure. Terrains need no file; cuts and views are of the
//! given files. The calibration is drawn to `curve.svg`.

#[path = "../../tests/cases/mod.rs"]
mod cases;
mod curve;

use adwave::operator::{OperatorKind, OperatorParams};
use adwave::{Decomposer, Progress};
use adwave_io::{ReadLimits, read_path};
use adwave_register::{
    Motion, PairParams, Registrand, SearchParams, common_lengths, describe_shape, register,
};
use cases::{Random, Surface, Terrain};
use rayon::prelude::*;
use std::path::Path;
use std::time::{Duration, Instant};

/// Largest error of a right motion, as a share of the extent.
const RIGHT: f64 = 0.01;
/// First seed of the second half.
const FINAL_SEED: u64 = 10_000;
/// Noise in mean edges, by turns.
const NOISES: [f64; 3] = [0.0, 0.1, 0.2];

/// Kinds of cases: of terrains, and of files.
const TERRAINS: [&str; 6] =
    ["terrain unrelated", "terrain 25", "terrain 30", "terrain 50", "repeated equal", "repeated similar"];
/// Share by which the reliefs of a row differ if they are similar.
const DIFFERENCES: f64 = 0.2;
const FILES: [&str; 8] = [
    "shapes unrelated",
    "halves disjoint",
    "cut 25",
    "cut 30",
    "cut 50",
    "views 45",
    "views 60",
    "whole 100",
];

/// Two surfaces, and the motion between them if there is one.
struct Case {
    first: Surface,
    second: Surface,
    truth: Option<Motion>,
}

/// Result of a case.
struct Outcome {
    kind: &'static str,
    seed: u64,
    has_truth: bool,
    /// Errors of the best motion and of those that fit equally well, as shares of the extent; empty without a claim. Without a
    /// true motion they are infinite.
    errors: Vec<f64>,
    /// Confidence of each pair, and if it is right.
    pairs: Vec<RatedPair>,
    elapsed: Duration,
}

struct RatedPair {
    confidence: f64,
    is_right: bool,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [half, n, seconds, curve, names @ ..] = &arguments[..] else {
        eprintln!("usage: match_cases choose|final CASES SECONDS CURVE.svg FILE…");
        std::process::exit(2);
    };
    let first_seed = if half == "final" { FINAL_SEED } else { 0 };
    let n: u64 = n.parse().expect("a number of cases of each kind");
    let limit = Duration::from_secs(seconds.parse().expect("a number of seconds"));
    let files: Vec<Surface> = names.iter().map(|name| load(Path::new(name))).collect();
    let kinds = TERRAINS.iter().chain(if files.is_empty() { &[][..] } else { &FILES[..] });
    let kinds: Vec<&'static str> = kinds.copied().collect();
    let jobs: Vec<(u64, &'static str)> =
        (first_seed..first_seed + n).flat_map(|seed| kinds.iter().map(move |&kind| (seed, kind))).collect();
    let start = Instant::now();
    let mut outcomes: Vec<Outcome> = Vec::new();
    for chunk in jobs.chunks(2 * rayon::current_num_threads()) {
        if start.elapsed() > limit {
            break;
        }
        outcomes.par_extend(
            chunk.par_iter().filter_map(|&(seed, kind)| run(kind, seed, &case(kind, seed, &files))),
        );
    }
    print_rates(&kinds, &outcomes);
    print_wrong(&outcomes);
    let tenths = tenths(&outcomes);
    print_calibration(&tenths);
    std::fs::write(curve, curve::draw(&tenths)).unwrap_or_else(|e| panic!("{curve}: {e}"));
}

fn load(path: &Path) -> Surface {
    let file = read_path(path, &ReadLimits::default()).unwrap_or_else(|e| panic!("{e}"));
    Surface {
        points: file.points().to_vec(),
        triangles: adwave::shape::triangulate(file.points(), file.faces()),
    }
}

fn case(kind: &str, seed: u64, files: &[Surface]) -> Case {
    let mut random = Random::new(seed);
    let percent = kind.rsplit(' ').next().and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0);
    let overlap = percent / 100.0;
    let file = |k: u64| &files[(k % files.len() as u64) as usize];
    let is_related = !kind.ends_with("unrelated") && !kind.ends_with("disjoint");
    let [first, second] = match kind.split(' ').next() {
        Some("terrain") if is_related => {
            let (terrain, shift) = (Terrain::new(seed), (80.0 * (1.0 - overlap)).round());
            // The second grid lies between the points of the first.
            let (u, v) = (random.uniform(), random.uniform());
            [terrain.patch(0.0, 0.0, 80, 80), terrain.patch(shift + u, v, 80, 79)]
        }
        Some("terrain") => [
            Terrain::new(2 * seed).patch(0.0, 0.0, 70, 70),
            Terrain::new(2 * seed + 1).patch(0.0, 0.0, 70, 70),
        ],
        Some("repeated") => {
            let n = 2 + (5.0 * random.uniform()) as u32;
            let own = (f64::from(n) * random.uniform()) as u32;
            let (terrain, shift) = (Terrain::new(seed), random.uniform());
            let differences = if kind.ends_with("similar") { DIFFERENCES } else { 0.0 };
            [terrain.repeated(own..own + 1, 0.0, differences), terrain.repeated(0..n, shift, differences)]
        }
        Some("shapes") => {
            // Every pair of different files comes in turn.
            let other = 1 + (seed / files.len() as u64) % (files.len() as u64 - 1).max(1);
            [file(seed).clone(), file(seed + other).clone()]
        }
        Some("halves") => file(seed).parts(&random.direction(), 0.45, 0.55),
        Some("cut") => file(seed).overlapping(&random.direction(), overlap),
        Some("views") => {
            let (a, b) = (random.direction(), random.direction());
            [file(seed).view(&a), file(seed).view(&turned(&a, &b, percent.to_radians()))]
        }
        _ => [file(seed).clone(), file(seed).clone()],
    };
    let noise = NOISES[(seed % 3) as usize];
    let motion = random.motion(50.0);
    let first = first.noisy(noise, 2 * seed);
    let second = second.noisy(noise, 2 * seed + 1).moved(&motion);
    Case { first, second, truth: is_related.then_some(motion) }
}

/// Direction at an angle from `a`, towards `b`.
fn turned(a: &[f64; 3], b: &[f64; 3], angle: f64) -> [f64; 3] {
    let axis = adwave::vector::unit(&adwave::vector::cross(a, b)).unwrap_or([0.0, 0.0, 1.0]);
    let side = adwave::vector::cross(&axis, a);
    std::array::from_fn(|k| angle.cos() * a[k] + angle.sin() * side[k])
}

/// Runs a case; `None` if a surface is too small to have features.
fn run(kind: &'static str, seed: u64, case: &Case) -> Option<Outcome> {
    if case.first.points.len().min(case.second.points.len()) < 500 {
        return None;
    }
    let start = Instant::now();
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let decomposers = [&case.first, &case.second]
        .map(|surface| Decomposer::with_params(&surface.shape(), &params, Progress::none()).unwrap());
    let lengths = common_lengths(&decomposers[0], &decomposers[1]).unwrap();
    let [a, b] = decomposers.map(|decomposer| {
        let features = describe_shape(&decomposer, None, &lengths, None, Progress::none()).unwrap();
        Registrand::new(&decomposer, features, Progress::none()).unwrap().unwrap()
    });
    let found = register(&a, &b, &SearchParams::default(), Progress::none()).unwrap();
    let elapsed = start.elapsed();
    let error = |motion: &Motion| {
        let truth = case.truth.as_ref();
        truth.map_or(f64::INFINITY, |truth| motion.difference(truth, &case.first.points) / a.extent)
    };
    let clear = found.clear();
    let errors = clear.into_iter().chain(&found.equal).map(|found| error(&found.motion)).collect();
    let rate = |pair: adwave_register::Pair| {
        let (own, other) = (&a.features.keys[pair.first], &b.features.keys[pair.second]);
        let is_right = case.truth.as_ref().is_some_and(|truth| {
            cases::distance(&truth.apply(&own.position), &other.position) <= other.sigma
        });
        RatedPair { confidence: pair.confidence, is_right }
    };
    let pairs = found.pairs(&a, &b, PairParams::default().sigmas).into_iter().map(rate).collect();
    Some(Outcome { kind, seed, has_truth: case.truth.is_some(), errors, pairs, elapsed })
}

fn print_rates(kinds: &[&str], outcomes: &[Outcome]) {
    println!("| cases | number | claimed | right | right among equal ones | wrong | seconds |");
    println!("|---|---|---|---|---|---|---|");
    for kind in kinds {
        let of_kind: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.kind == *kind).collect();
        let number = |is: &dyn Fn(&Outcome) -> bool| of_kind.iter().filter(|outcome| is(outcome)).count();
        let claimed = number(&|o| !o.errors.is_empty());
        let right = number(&|o| o.errors.first().is_some_and(|e| *e < RIGHT));
        let listed = number(&|o| {
            o.has_truth
                && o.errors.first().is_some_and(|e| *e >= RIGHT)
                && o.errors.iter().any(|e| *e < RIGHT)
        });
        let seconds: f64 = of_kind.iter().map(|o| o.elapsed.as_secs_f64()).sum();
        println!(
            "| {kind} | {} | {claimed} | {right} | {listed} | {} | {:.2} |",
            of_kind.len(),
            claimed - right - listed,
            seconds / of_kind.len().max(1) as f64
        );
    }
}

/// Prints the seeds of wrong claims, with the least error of the motions that were listed, so that they can be looked into.
fn print_wrong(outcomes: &[Outcome]) {
    for outcome in outcomes {
        let least = outcome.errors.iter().copied().fold(f64::INFINITY, f64::min);
        if !outcome.errors.is_empty() && least >= RIGHT {
            println!("wrong: {}, seed {}, off by {least:.4}", outcome.kind, outcome.seed);
        }
    }
}

/// Pairs with confidences in one tenth.
#[derive(Clone, Copy, Default)]
struct Tenth {
    n: usize,
    sum: f64,
    n_right: usize,
}

impl Tenth {
    fn mean(&self) -> f64 {
        self.sum / self.n as f64
    }

    fn share_right(&self) -> f64 {
        self.n_right as f64 / self.n as f64
    }
}

/// Pairs by tenth of their confidence.
fn tenths(outcomes: &[Outcome]) -> [Tenth; 10] {
    let mut tenths = [Tenth::default(); 10];
    for pair in outcomes.iter().flat_map(|outcome| &outcome.pairs) {
        let tenth = &mut tenths[((10.0 * pair.confidence) as usize).min(9)];
        tenth.n += 1;
        tenth.sum += pair.confidence;
        tenth.n_right += usize::from(pair.is_right);
    }
    tenths
}

fn print_calibration(tenths: &[Tenth; 10]) {
    println!("\n| confidence | pairs | mean confidence | share right |");
    println!("|---|---|---|---|");
    for (k, tenth) in tenths.iter().enumerate().filter(|(_, tenth)| tenth.n > 0) {
        let low = k as f64 / 10.0;
        let (mean, right) = (tenth.mean(), tenth.share_right());
        println!("| {low:.1} … {:.1} | {} | {mean:.3} | {right:.3} |", low + 0.1, tenth.n);
    }
}
