//! Benchmark of images and volumes beside SciPy: builds ours, makes their environment, runs `benches/grids`.

use crate::{StepResult, cargo, models_and_part, python, root, run, target};
use std::path::PathBuf;
use std::process::Command;

/// Writes the section on grids of `docs/PERFORMANCE.md`. `arguments`: `--models DIR`, the folder of test data, and
/// `--only PART` for one part that is printed and not written.
pub(crate) fn bench_grids(arguments: &[&str]) -> StepResult {
    let data = std::env::var_os("ADWAVE_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    let (data, only) = models_and_part("bench-grids", arguments, data)?;
    let release = ["build", "--release", "--locked", "--quiet"];
    cargo(&[&release[..], &["-p", "adwave-cli"]].concat(), &[])?;
    cargo(&[&release[..], &["-p", "adwave-bench-helpers", "--bin", "grid_timing"]].concat(), &[])?;
    run(Command::new(python::environment("grids")?)
        .arg(root().join("benches/grids/bench_grids.py"))
        .arg("--adwave")
        .arg(target().join("release/adwave"))
        .arg("--timing")
        .arg(target().join("release/grid_timing"))
        .arg("--work")
        .arg(target().join("bench-grids"))
        .arg("--data")
        .arg(data)
        .arg("--docs")
        .arg(root().join("docs"))
        .args(only.iter().flat_map(|part| ["--only", part])))
}
