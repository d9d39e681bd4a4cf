//! Comparison with the programs of others: builds ours, makes their environment, runs `benches/peers`.

use crate::{StepResult, cargo, models_and_part, python, root, run, target};
use std::path::PathBuf;
use std::process::Command;

/// Times this program and the others in one run, and writes `docs/PERFORMANCE.md`. `arguments`: `--models DIR`, a
/// folder that may have a `stanford-bunny.obj`, and `--only PART` for one part that is printed and not written.
pub(crate) fn bench_peers(arguments: &[&str]) -> StepResult {
    let models = std::env::var_os("ADWAVE_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    let (models, only) = models_and_part("bench-peers", arguments, models)?;
    let release = ["build", "--release", "--locked", "--quiet"];
    cargo(&[&release[..], &["-p", "adwave-cli"]].concat(), &[])?;
    cargo(&[&release[..], &["-p", "adwave-bench-helpers", "--bin", "timing_on_request"]].concat(), &[])?;
    let python = python::environment("peers")?;
    let target = target();
    run(Command::new(python)
        .arg(root().join("benches/peers/bench_peers.py"))
        .arg("--ours")
        .arg(target.join("release/timing_on_request"))
        .arg("--adwave")
        .arg(target.join("release/adwave"))
        .arg("--models")
        .arg(models)
        .arg("--work")
        .arg(target.join("bench-peers"))
        .arg("--docs")
        .arg(root().join("docs"))
        .args(only.iter().flat_map(|part| ["--only", part])))
}

/// Times five commands and libraries that do the same against the number of vertices, and writes that section of
/// `docs/PERFORMANCE.md`. `arguments`: `--only COMMAND` for one command, whose table is printed and not written.
pub(crate) fn bench_commands(arguments: &[&str]) -> StepResult {
    let (_, only) = models_and_part("bench-commands", arguments, PathBuf::new())?;
    cargo(&["build", "--release", "--locked", "--quiet", "-p", "adwave-cli"], &[])?;
    run(Command::new(python::environment("commands")?)
        .arg(root().join("benches/commands/bench_commands.py"))
        .arg("--adwave")
        .arg(target().join("release/adwave"))
        .arg("--work")
        .arg(target().join("bench-commands"))
        .arg("--docs")
        .arg(root().join("docs"))
        .args(only.iter().flat_map(|part| ["--only", part])))
}
