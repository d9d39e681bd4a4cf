//! Benchmark of large clouds by tiles and in other programs: builds ours, makes their environment, runs
//! `benches/clouds`.

use crate::{StepResult, cargo, python, root, run, target};
use std::process::Command;

/// Prints the table. `arguments`: `--points N`.
pub(crate) fn bench_clouds(arguments: &[&str]) -> StepResult {
    cargo(&["build", "--release", "--locked", "--quiet", "-p", "adwave-cli"], &[])?;
    let python = python::environment("clouds")?;
    run(Command::new(python)
        .arg(root().join("benches/clouds/bench_clouds.py"))
        .arg("--adwave")
        .arg(target().join("release/adwave"))
        .arg("--work")
        .arg(root().join("target/clouds"))
        .args(arguments))
}
