//! Dependence of bands on the mesh of a surface: builds ours, makes an environment, runs `benches/meshings`.

use crate::{StepResult, cargo, data, models_and_part, python, root, run, target};
use std::process::Command;

/// Compares bands, features and maps of several meshings of the same surfaces, and writes `docs/MESHINGS.md`.
/// `arguments`: `--models DIR`, a folder that may have the models of the paper, and `--only PART` for one part that is
/// printed and not written.
pub(crate) fn bench_meshings(arguments: &[&str]) -> StepResult {
    let (models, only) = models_and_part("bench-meshings", arguments, data().join("paper"))?;
    cargo(&["build", "--release", "--locked", "--quiet", "-p", "adwave-cli"], &[])?;
    let helper = ["-p", "adwave-bench-helpers", "--bin", "surface_matrices"];
    cargo(&[&["build", "--release", "--locked", "--quiet"], &helper[..]].concat(), &[])?;
    let python = python::environment("meshings")?;
    run(Command::new(python)
        .arg(root().join("benches/meshings/bench_meshings.py"))
        .arg("--adwave")
        .arg(target().join("release/adwave"))
        .arg("--matrices")
        .arg(target().join("release/surface_matrices"))
        .arg("--models")
        .arg(models)
        .arg("--fixations")
        .arg(data().join("benchmarks"))
        .arg("--work")
        .arg(root().join("target/meshings"))
        .arg("--docs")
        .arg(root().join("docs"))
        .args(only.iter().flat_map(|part| ["--only", part])))
}
