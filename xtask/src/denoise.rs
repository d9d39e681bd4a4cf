//! Benchmark of denoisers: builds ours, makes the environment of the others, runs `benches/denoise`.

use crate::{StepResult, cargo, data, models_and_part, python, root, run, target};
use std::process::Command;

/// Name of the part of `bench-peers` that has its own document.
pub(crate) const PART: &str = "denoise";

/// Runs all denoisers on pairs of noisy and clean meshes and writes `docs/DENOISING.md`. `arguments`: `--models DIR`, a
/// folder with pairs `noisy.obj` and `clean.obj`, and `--only denoise`.
pub(crate) fn bench_denoise(arguments: &[&str]) -> StepResult {
    let (models, _) = models_and_part("bench-peers", arguments, data().join(PART))?;
    let release = ["build", "--release", "--locked", "--quiet"];
    cargo(&[&release[..], &["-p", "adwave-cli"]].concat(), &[])?;
    cargo(&[&release[..], &["-p", "adwave-bench-helpers", "--bin", "denoise_case"]].concat(), &[])?;
    let python = python::environment(PART)?;
    run(Command::new(python)
        .arg(root().join("benches/denoise/bench_denoise.py"))
        .arg("--adwave")
        .arg(target().join("release/adwave"))
        .arg("--steps")
        .arg(target().join("release/denoise_case"))
        .arg("--models")
        .arg(models)
        .arg("--work")
        .arg(root().join("target/denoise"))
        .arg("--docs")
        .arg(root().join("docs")))
}

/// Denoises random meshes and clouds whose clean positions are known, and prints the tables. `arguments`: the half of
/// the seeds, and their number.
pub(crate) fn bench_truth(arguments: &[&str]) -> StepResult {
    let build = ["build", "--release", "--locked", "--quiet", "-p", "adwave-bench-helpers"];
    cargo(&[&build[..], &["--bin", "mesh_truth", "--bin", "denoise_truth"]].concat(), &[])?;
    let (half, n_seeds) = (arguments.first().unwrap_or(&"first"), arguments.get(1).unwrap_or(&"2"));
    let bench = |program: &str, more: &[&str], published: &str| {
        let mut bench = Command::new(target().join("release").join(program));
        bench.arg(half).arg(n_seeds).args(more);
        let published = data().join(published);
        if published.is_dir() {
            bench.arg(published);
        }
        run(&mut bench)
    };
    bench("mesh_truth", &["tuned"], PART)?;
    bench("denoise_truth", &[], "domains/points")
}
