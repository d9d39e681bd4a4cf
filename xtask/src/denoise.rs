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

/// Denoises random meshes, clouds and curves whose clean positions are known, and prints the tables. `arguments`: the
/// half of the seeds, their number, and `--curve FILE` for the chart of the noise found over the true noise of clouds.
pub(crate) fn bench_truth(arguments: &[&str]) -> StepResult {
    let (words, curve) = match *arguments {
        [ref words @ .., "--curve", file] => (words, file),
        _ => (arguments, "target/denoise-calibration.svg"),
    };
    let (half, n_seeds) = match *words {
        [] => ("first", "2"),
        [half] => (half, "2"),
        [half, n_seeds] => (half, n_seeds),
        _ => ("", ""),
    };
    let (Ok(n_seeds), "first" | "second") = (n_seeds.parse::<u64>(), half) else {
        let found = words.join(" ");
        return Err(format!("bench-denoise: {found} is not understood; see `cargo xtask help`"));
    };
    let programs = ["mesh_truth", "denoise_truth", "surface_truth", "curve_truth"];
    let build = ["build", "--release", "--locked", "--quiet", "-p", "adwave-bench-helpers"];
    let bins = programs.iter().flat_map(|program| ["--bin", program]);
    cargo(&build.into_iter().chain(bins).collect::<Vec<_>>(), &[])?;
    let bench = |program: &str, n_seeds: u64, more: &[&str], published: Option<&str>| {
        let mut bench = Command::new(target().join("release").join(program));
        bench.arg(half).arg(n_seeds.to_string()).args(more);
        let published = published.map(|folder| data().join(folder)).filter(|folder| folder.is_dir());
        run(bench.args(published))
    };
    bench("mesh_truth", n_seeds, &["tuned"], Some(PART))?;
    bench("denoise_truth", n_seeds, &[], Some("domains/points"))?;
    bench("surface_truth", n_seeds, &[curve], None)?;
    // Curves are small.
    bench("curve_truth", 3 * n_seeds, &[], None)
}
