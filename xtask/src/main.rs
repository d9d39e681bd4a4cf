//! What `cargo xtask …` does: the checks and measurements of the project, each by one command on a bare machine.

mod peers;
mod python;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const USAGE: &str = "\
usage: cargo xtask COMMAND

  test      format, lints, unit, property, documentation and command-line tests: all that must pass
  fuzz [--seconds N] [--only TARGET] [--seed N] [--runs N] [--file FILE]
            broken input for every reader and parser; what breaks is saved below target/fuzz
  oracle    compare the bands with SciPy's, on built-in shapes and on ../shared/data where it is there
  oracle-baselines
            compare eigenvalues with SciPy's on libigl's matrices, and spectral graph wavelets with PyGSP's
  bench-peers [--models DIR] [--only PART]
            time other programs and ours on the same operators and write docs/PERFORMANCE.md

Python packages go into an environment of their own below target/; nothing is installed elsewhere.";

/// A step that did not succeed, in one line.
type Outcome = Result<(), String>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test(),
        ["oracle"] => oracle(),
        ["oracle-baselines"] => oracle_baselines(),
        ["fuzz", ref rest @ ..] => fuzz(rest),
        ["bench-peers", ref rest @ ..] => peers::bench_peers(rest),
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            Ok(())
        }
        _ => Err(USAGE.to_owned()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(what) => {
            eprintln!("{what}");
            ExitCode::FAILURE
        }
    }
}

fn test() -> Outcome {
    cargo(&["fmt", "--all", "--check"], &[])?;
    cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--quiet", "--", "-D", "warnings"], &[])?;
    cargo(&["doc", "--workspace", "--no-deps", "--locked", "--quiet"], &[("RUSTDOCFLAGS", "-D warnings")])?;
    cargo(&["test", "--workspace", "--locked", "--quiet"], &[])?;
    fuzz(&[])
}

/// Broken input for a minute, or as the arguments say. With the optimisation of the tests, so that sums that overflow are
/// seen.
fn fuzz(arguments: &[&str]) -> Outcome {
    let run = ["run", "--locked", "--quiet", "-p", "adwave-fuzz", "--"];
    cargo(&[&run[..], arguments].concat(), &[])
}

fn oracle() -> Outcome {
    cargo(&["build", "--release", "--locked", "--quiet", "-p", "adwave-cli"], &[])?;
    let adwave = root().join("target/release/adwave");
    let samples = root().join("target/oracle-samples");
    std::fs::create_dir_all(&samples).map_err(|e| format!("cannot make {}: {e}", samples.display()))?;
    for (name, vertices) in
        [("sphere", "5000"), ("torus", "5000"), ("plane", "5000"), ("knot", "5000"), ("creature", "20000")]
    {
        let out = samples.join(format!("{name}.ply"));
        let arguments = ["sample", name, "--vertices", vertices, "--quiet", "-o"].map(OsStr::new);
        run(Command::new(&adwave).args(arguments).arg(out))?;
    }
    let python = python::environment(&root(), "oracle")?;
    run(Command::new(python)
        .arg(root().join("benches/oracle/oracle.py"))
        .args([&adwave, &samples])
        .arg("--data")
        .arg(root().join("../shared/data")))
}

fn oracle_baselines() -> Outcome {
    let build =
        ["build", "--release", "--locked", "--quiet", "-p", "adwave-bench-helpers", "--bin", "oracle_values"];
    cargo(&build, &[])?;
    let python = python::environment(&root(), "baselines")?;
    run(Command::new(python)
        .arg(root().join("benches/baselines/oracle.py"))
        .arg(root().join("target/release/oracle_values"))
        .arg("--data")
        .arg(std::env::var_os("ADWAVE_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from)))
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository").to_owned()
}

fn cargo(arguments: &[&str], variables: &[(&str, &str)]) -> Outcome {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    println!("> cargo {}", arguments.join(" "));
    run(Command::new(cargo).current_dir(root()).args(arguments).envs(variables.iter().copied()))
}

/// Runs a command to its end with our own standard streams.
fn run(command: &mut Command) -> Outcome {
    let program = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{program} failed: {status}")),
        Err(e) => Err(format!("cannot run {program}: {e}")),
    }
}
