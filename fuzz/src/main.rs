//! Fuzzer with broken input for every reader and parser: `cargo xtask fuzz [--seconds N] [--only TARGET] [--seed N]
//! [--runs N]`.
//!
//! This in-process mutation fuzzer works with the stable compiler. Each target starts from the files below
//! `fuzz/seeds/` (written by `--write-seeds`), mutates them ([`mutate`]) and checks the properties that hold for any
//! input ([`targets`]): content that is finite and in range, or an error of one line; no panic. An input with a new
//! outcome is kept and mutated further, which replaces the coverage that libFuzzer would measure. The same seed and
//! number of runs give the same inputs. Failing inputs are saved below `target/fuzz/`.

#[allow(dead_code, reason = "the tests of adwave-io use all of it")]
#[allow(clippy::unwrap_used, reason = "generated seeds are valid")]
#[path = "../../crates/adwave-io/tests/it/cloud_part/copc_file.rs"]
mod copc_file;
mod mutate;
mod seeds;
mod targets;
mod watch;
mod words;

use mutate::Random;
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use targets::Target;

/// Largest number of inputs that a target keeps.
const MAX_KEPT: usize = 400;
/// Number of findings after which a target is stopped.
const MAX_FINDINGS: usize = 5;

/// Options of the command line.
struct Options {
    /// Total time for all targets.
    seconds: f64,
    only: Option<String>,
    seed: u64,
    /// Inputs per target; `None` runs until the time is up.
    runs: Option<u64>,
}

fn main() -> ExitCode {
    match run(std::env::args().skip(1)) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(n) => {
            eprintln!("{n} inputs fail; they are saved below {}", output().display());
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut arguments: impl Iterator<Item = String>) -> Result<usize, String> {
    let mut options = Options { seconds: 60.0, only: None, seed: 1, runs: None };
    let mut files = Vec::new();
    while let Some(option) = arguments.next() {
        if option == "--write-seeds" {
            return seeds::write(&seeds_folder()).map(|()| 0).map_err(|e| e.to_string());
        }
        let value = arguments.next().ok_or_else(|| format!("{option} needs a value"))?;
        let wrong = || format!("{option} needs a number, got {value}");
        match option.as_str() {
            "--seconds" => options.seconds = value.parse().map_err(|_| wrong())?,
            "--only" => options.only = Some(value),
            "--seed" => options.seed = value.parse().map_err(|_| wrong())?,
            "--runs" => options.runs = Some(value.parse().map_err(|_| wrong())?),
            "--file" => files.push(PathBuf::from(value)),
            _ => {
                return Err(format!(
                    "unknown option {option}; use --seconds, --only, --seed, --runs or --file"
                ));
            }
        }
    }
    let is_asked_for = |t: &Target| options.only.as_ref().is_none_or(|only| only == t.name);
    let targets: Vec<Target> = targets::all().into_iter().filter(is_asked_for).collect();
    if targets.is_empty() {
        let names: Vec<&str> = targets::all().iter().map(|t| t.name).collect();
        return Err(format!("unknown target; use one of {}", names.join(", ")));
    }
    std::fs::create_dir_all(output()).map_err(|e| format!("{}: {e}", output().display()))?;
    // A finding is printed with its input; the panic message itself would be printed for every input.
    std::panic::set_hook(Box::new(|_| {}));
    watch::start(output());
    let seconds = options.seconds / targets.len() as f64;
    let mut n_findings = 0;
    for target in &targets {
        n_findings +=
            if files.is_empty() { fuzz(target, seconds, &options) } else { replay(target, &files)? };
    }
    Ok(n_findings)
}

/// Runs one target for its time, prints its line, and returns the number of findings.
fn fuzz(target: &Target, seconds: f64, options: &Options) -> usize {
    let start = Instant::now();
    let mut random = Random::new(options.seed ^ hash(target.name.as_bytes()));
    let mut kept = read_seeds(target);
    let n_seeds = kept.len();
    let mut outcomes = HashSet::new();
    let (mut n_runs, mut n_ok, mut findings) = (0_u64, 0_u64, Vec::new());
    loop {
        let input = match kept.get(n_runs as usize) {
            // Each seed once, unchanged.
            Some(seed) if n_runs < n_seeds as u64 => seed.clone(),
            _ => mutate::mutate(&kept, target.words, &mut random),
        };
        n_runs += 1;
        match check(target, &input) {
            Ok(outcome) => {
                n_ok += u64::from(outcome.starts_with("ok"));
                if outcomes.insert(hash(kind(&outcome).as_bytes())) && kept.len() < MAX_KEPT {
                    kept.push(input);
                }
            }
            Err(what) => {
                // One finding per kind of failure.
                if outcomes.insert(hash(kind(&what).as_bytes())) {
                    let path = save(target.name, &input);
                    println!("{}: {what}: {}", target.name, path.display());
                    findings.push(path);
                }
            }
        }
        let is_over = match options.runs {
            Some(runs) => n_runs >= runs,
            None => n_runs.is_multiple_of(16) && start.elapsed() > Duration::from_secs_f64(seconds),
        };
        if is_over || findings.len() >= MAX_FINDINGS {
            break;
        }
    }
    println!(
        "{:<12} {n_runs:>8} inputs in {:>5.1} s from {n_seeds} seeds: {n_ok} read, {} outcomes, {} findings",
        target.name,
        start.elapsed().as_secs_f64(),
        outcomes.len(),
        findings.len()
    );
    findings.len()
}

/// Checks files unchanged, such as earlier findings.
fn replay(target: &Target, files: &[PathBuf]) -> Result<usize, String> {
    let mut n_findings = 0;
    for path in files {
        let input = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let outcome = check(target, &input);
        n_findings += usize::from(outcome.is_err());
        println!("{} {}: {}", target.name, path.display(), outcome.unwrap_or_else(|e| e));
    }
    Ok(n_findings)
}

/// Runs the check of a target; returns the outcome, or the violated property as an error.
fn check(target: &Target, input: &[u8]) -> Result<String, String> {
    watch::begin(target.name, input);
    let outcome = catch_unwind(AssertUnwindSafe(|| (target.check)(input)));
    watch::end();
    outcome.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text =
            text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("panic without a message");
        Err(format!("panic: {text}"))
    })
}

/// Outcome without its numbers and without quoted parts of the input.
fn kind(outcome: &str) -> String {
    let mut is_quoted = false;
    let keep = |c: &char| {
        is_quoted ^= matches!(c, '"' | '`' | '\'');
        !is_quoted && !c.is_ascii_digit()
    };
    outcome.chars().filter(keep).collect()
}

fn save(target: &str, input: &[u8]) -> PathBuf {
    let path = output().join(format!("{target}-{:016x}.bin", hash(input)));
    if let Err(error) = std::fs::write(&path, input) {
        eprintln!("cannot write {}: {error}", path.display());
    }
    path
}

fn read_seeds(target: &Target) -> Vec<Vec<u8>> {
    let folder = seeds_folder().join(target.seeds);
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(&folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let mut seeds: Vec<Vec<u8>> = paths.iter().filter_map(|path| std::fs::read(path).ok()).collect();
    if seeds.is_empty() {
        seeds.push(Vec::new());
    }
    seeds
}

fn seeds_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds")
}

fn output() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fuzz")
}

/// Hashes by FNV-1a.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}
