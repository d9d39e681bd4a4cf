//! The Python package: built as a wheel, and tested from Python.

use crate::{Outcome, cargo, python, root, run, target};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The file that every CPython from 3.10 on loads as the extension.
const EXTENSION: &str = "_native.abi3.so";

fn package() -> PathBuf {
    root().join("bindings/python")
}

/// `target/wheels/adwave-….whl`, by maturin in an environment of its own.
pub(crate) fn wheel() -> Result<PathBuf, String> {
    let python = python::environment_of(&package().join("build-requirements.txt"), "wheel")?;
    let out = target().join("wheels");
    println!("> maturin build --profile wheel");
    // No older wheel is taken for the new one.
    let _ = std::fs::remove_dir_all(&out);
    run(Command::new(&python)
        .current_dir(package())
        .args([
            "-m",
            "maturin",
            "build",
            "--profile",
            "wheel",
            "--locked",
            "--compatibility",
            "linux",
            "--out",
        ])
        .arg(&out)
        .args(["--interpreter"])
        .arg(&python))?;
    let wheels: Vec<PathBuf> = std::fs::read_dir(&out)
        .map_err(|e| format!("cannot read {}: {e}", out.display()))?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension() == Some(OsStr::new("whl")))
        .collect();
    let [wheel] = &wheels[..] else { return Err(format!("{} wheels were built, not one", wheels.len())) };
    let name = wheel.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if !name.contains("-cp310-abi3-") {
        return Err(format!("{name} is not for every Python from 3.10 on"));
    }
    let bytes = wheel.metadata().map_err(|e| format!("{name}: {e}"))?.len();
    println!("{}: {:.2} MB", wheel.display(), bytes as f64 / 1e6);
    Ok(wheel.clone())
}

/// The same tasks by the wheel and by other packages: `benches/python/compare.py`, whose table is printed.
pub(crate) fn bench(arguments: &[&str]) -> Outcome {
    let python = python::environment(&root(), "python")?;
    let place = target().join("bench-python");
    install(&python, &wheel()?, &place)?;
    run(Command::new(&python)
        .env("PYTHONPATH", &place)
        .arg(root().join("benches/python/compare.py"))
        .args(arguments))
}

/// Puts a wheel into a folder.
fn install(python: &Path, wheel: &Path, place: &Path) -> Outcome {
    println!("> pip install {}", wheel.display());
    let _ = std::fs::remove_dir_all(place);
    run(Command::new(python)
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--target"])
        .arg(place)
        .arg(wheel))
}

/// The tests of the package, its documentation's examples and its types: of a wheel, or of what `cargo build` has built.
pub(crate) fn test_package(arguments: &[&str]) -> Outcome {
    let of_wheel = match arguments {
        [] => false,
        ["--wheel"] => true,
        _ => return Err("python knows --wheel only".to_owned()),
    };
    let python = python::environment_of(&package().join("test-requirements.txt"), "package")?;
    let place = target().join("package");
    if of_wheel {
        install(&python, &wheel()?, &place)?;
    } else {
        cargo(&["build", "--workspace", "--locked", "--quiet", "--lib", "--bins", "--tests"], &[])?;
        assemble(&place)?;
    }
    let check = |what: &str, words: &[&str], folder: &Path| {
        println!("> {what}");
        run(Command::new(&python).current_dir(folder).env("PYTHONPATH", &place).args(words))
    };
    let config = package().join("pyproject.toml");
    let (config, tests) = (config.to_string_lossy().into_owned(), package().join("tests"));
    let tests = tests.to_string_lossy().into_owned();
    let words = ["-m", "pytest", "-q", "-c", &config, "--rootdir", ".", "adwave", &tests];
    check("pytest", &words, &place)?;
    let examples = gallery()?;
    check("python run_all.py --quick", &[&examples, "--quick"], &place)?;
    let config_of = ["--config", &config];
    check(
        "ruff check",
        &[&["-m", "ruff", "check", "-q"][..], &config_of, &["python", "tests"]].concat(),
        &package(),
    )?;
    check(
        "ruff format",
        &[&["-m", "ruff", "format", "-q", "--check"][..], &config_of, &["python", "tests"]].concat(),
        &package(),
    )?;
    check("stubtest", &["-m", "mypy.stubtest", "adwave._native", "--ignore-disjoint-bases"], &place)?;
    let own = python.to_string_lossy();
    println!("> basedpyright");
    // Of the sources alone: the assembled package beside them would be a second one of the same names.
    run(Command::new(&python).current_dir(package()).env_remove("PYTHONPATH").args([
        "-m",
        "basedpyright",
        "-p",
        &config,
        "--pythonpath",
        &own,
    ]))
}

/// The examples of `docs/python` where they may write their pictures; the path of what runs them.
fn gallery() -> Result<String, String> {
    let to = target().join("gallery");
    let wrong = |e: std::io::Error| format!("cannot copy the examples to {}: {e}", to.display());
    std::fs::create_dir_all(to.join("pictures")).map_err(wrong)?;
    for entry in std::fs::read_dir(root().join("docs/python")).map_err(wrong)?.flatten() {
        if entry.path().extension() == Some(OsStr::new("py")) {
            std::fs::copy(entry.path(), to.join(entry.file_name())).map_err(wrong)?;
        }
    }
    Ok(to.join("run_all.py").to_string_lossy().into_owned())
}

/// The Python files and the extension of a debug build, side by side as an installed package has them.
fn assemble(place: &Path) -> Outcome {
    let to = place.join("adwave");
    let wrong = |e: std::io::Error| format!("cannot put the package together in {}: {e}", to.display());
    let _ = std::fs::remove_dir_all(place);
    std::fs::create_dir_all(&to).map_err(wrong)?;
    for entry in std::fs::read_dir(package().join("python/adwave")).map_err(wrong)?.flatten() {
        let path = entry.path();
        if path.is_file() && path.extension() != Some(OsStr::new("so")) {
            std::fs::copy(&path, to.join(entry.file_name())).map_err(wrong)?;
        }
    }
    let debug = target().join("debug");
    let built = ["lib_native.so", "lib_native.dylib", "_native.dll"].map(|name| debug.join(name));
    let built = built.iter().find(|path| path.exists());
    let built = built.ok_or_else(|| format!("no extension was built in {}", debug.display()))?;
    // A link: a debug build has hundreds of megabytes.
    std::fs::hard_link(built, to.join(EXTENSION))
        .or_else(|_| std::fs::copy(built, to.join(EXTENSION)).map(|_| ()))
        .map_err(wrong)
}
