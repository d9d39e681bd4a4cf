//! Python package: wheel, tests, documentation, and checks before a release.

use crate::{BUILD_WITH_TESTS, StepResult, cargo, python, root, run, target};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// File name of the extension for every CPython from 3.10 on.
const EXTENSION: &str = "_native.abi3.so";
/// Test of an example of the gallery.
const GALLERY_TEST: &str = "test_a_script_draws_the_picture_that_is_shown";

fn package() -> PathBuf {
    root().join("bindings/python")
}

/// Builds `target/wheels/adwave-….whl` for every CPython from 3.10 on, with the oldest manylinux tag that the linker
/// allows.
pub(crate) fn wheel() -> Result<PathBuf, String> {
    let python = python::environment_from(&package().join("build-requirements.txt"), "wheel")?;
    let out = target().join("wheels");
    // An older wheel must not be taken for the new one.
    let _ = std::fs::remove_dir_all(&out);
    let words =
        ["build", "--profile", "wheel", "--locked", "--compatibility", "pypi", "--compression-level", "9"];
    maturin(&python, &words, &out)?;
    let wheel = only_file(&out, "whl")?;
    let name = wheel.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if !name.contains("-cp310-abi3-") {
        return Err(format!("{name} is not for every Python from 3.10 on"));
    }
    let bytes = wheel.metadata().map_err(|e| format!("{name}: {e}"))?.len();
    println!("{}: {:.2} MB", wheel.display(), bytes as f64 / 1e6);
    Ok(wheel)
}

fn maturin(python: &Path, words: &[&str], out: &Path) -> StepResult {
    println!("> maturin {}", words.join(" "));
    let mut command = Command::new(python);
    command.current_dir(package()).args(["-m", "maturin"]).args(words).arg("--out").arg(out);
    if words[0] == "build" {
        command.arg("--interpreter").arg(python);
    }
    run(&mut command)
}

/// Returns the only file with an extension in a folder.
fn only_file(folder: &Path, extension: &str) -> Result<PathBuf, String> {
    let files: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(|e| format!("cannot read {}: {e}", folder.display()))?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension() == Some(OsStr::new(extension)))
        .collect();
    match &files[..] {
        [file] => Ok(file.clone()),
        _ => Err(format!("{} must have one .{extension} file, got {}", folder.display(), files.len())),
    }
}

/// Checks the Python package as it would be published: metadata, licenses and tag of the wheel, and the build from the
/// source distribution.
pub(crate) fn check_release() -> StepResult {
    let python = python::environment_from(&package().join("release-requirements.txt"), "release")?;
    check_workflows(&python)?;
    let wheel = wheel()?;
    println!("> abi3audit --strict");
    run(Command::new(&python).args(["-m", "abi3audit", "--strict"]).arg(&wheel))?;
    println!("> auditwheel show");
    run(Command::new(&python).args(["-m", "auditwheel", "show"]).arg(&wheel))?;
    if cfg!(target_os = "linux") && !wheel.to_string_lossy().contains("manylinux") {
        return Err(format!("{} has no manylinux tag", wheel.display()));
    }
    let out = target().join("sdist");
    let _ = std::fs::remove_dir_all(&out);
    maturin(&python, &["sdist"], &out)?;
    let sdist = only_file(&out, "gz")?;
    println!("> twine check --strict");
    run(Command::new(&python).args(["-m", "twine", "check", "--strict"]).args([&wheel, &sdist]))?;
    build_from_sdist(&python, &sdist)
}

/// Checks the workflows of releases and the recipe of conda, and the checks themselves.
fn check_workflows(python: &Path) -> StepResult {
    for words in [&["-m", "unittest", "--quiet", "test_scripts"][..], &["check_workflows.py"]] {
        println!("> python {}", words.join(" "));
        let folder = root().join(".github/scripts");
        run(Command::new(python).current_dir(folder).env("PYTHONDONTWRITEBYTECODE", "1").args(words))?;
    }
    Ok(())
}

/// Builds a wheel from the source distribution alone, without network access, and imports it from a new environment.
fn build_from_sdist(python: &Path, sdist: &Path) -> StepResult {
    let out = target().join("sdist-wheel");
    let _ = std::fs::remove_dir_all(&out);
    println!("> pip wheel {}", sdist.display());
    // The build backend calls `maturin` by its name.
    let mut folders: Vec<PathBuf> = python.parent().map(Path::to_path_buf).into_iter().collect();
    folders.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
    let path = std::env::join_paths(folders).map_err(|e| format!("cannot extend PATH: {e}"))?;
    run(Command::new(python)
        .env("PATH", path)
        .args(["-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-index"])
        .args(["--no-build-isolation", "--wheel-dir"])
        .arg(&out)
        .arg(sdist)
        .env("CARGO_NET_OFFLINE", "true")
        .env("CARGO_TARGET_DIR", target().join("sdist-build"))
        .env("MATURIN_PEP517_ARGS", "--profile dev --strip"))?;
    let test = test_environment()?;
    let place = target().join("sdist-package");
    install(&test, &only_file(&out, "whl")?, &place)?;
    let example = "import adwave as aw; print(aw.decompose(aw.sample('sphere'), levels=4), aw.__version__)";
    run(Command::new(&test).current_dir(&place).env("PYTHONPATH", &place).args(["-c", example]))
}

/// Compares the wheel with other packages on the same tasks, and prints the table of `benches/python/compare.py`.
pub(crate) fn bench(arguments: &[&str]) -> StepResult {
    let python = python::environment("python")?;
    let place = target().join("bench-python");
    install(&python, &wheel()?, &place)?;
    run(Command::new(&python)
        .env("PYTHONPATH", &place)
        .arg(root().join("benches/python/compare.py"))
        .args(arguments))
}

/// Installs a wheel into a folder.
fn install(python: &Path, wheel: &Path, place: &Path) -> StepResult {
    println!("> pip install {}", wheel.display());
    let _ = std::fs::remove_dir_all(place);
    run(Command::new(python)
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--target"])
        .arg(place)
        .arg(wheel))
}

/// Returns the Python interpreter of the environment in which the package is tested.
pub(crate) fn test_environment() -> Result<PathBuf, String> {
    python::environment_from(&package().join("test-requirements.txt"), "package")
}

/// Runs the tests of the package, the examples of its documentation and its type checks, on a wheel or on a debug
/// build.
pub(crate) fn test_package(arguments: &[&str]) -> StepResult {
    let with_wheel = match arguments {
        [] => false,
        ["--wheel"] => true,
        _ => return Err(format!("python takes --wheel only, got {}", arguments.join(" "))),
    };
    let python = test_environment()?;
    let place = target().join("package");
    if with_wheel {
        install(&python, &wheel()?, &place)?;
    } else {
        cargo(&BUILD_WITH_TESTS, &[])?;
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
    // On the sources only: the assembled package would be a second one of the same names.
    run(Command::new(&python).current_dir(package()).env_remove("PYTHONPATH").args([
        "-m",
        "basedpyright",
        "-p",
        &config,
        "--pythonpath",
        &own,
    ]))
}

/// Builds the package with the extension of a debug build; returns the folder from which it can be imported.
pub(crate) fn assembled() -> Result<PathBuf, String> {
    let place = target().join("package");
    cargo(&BUILD_WITH_TESTS, &[])?;
    assemble(&place)?;
    Ok(place)
}

/// Runs the tests and the examples of `adwave.torch` with PyTorch and PyTorch Geometric, which the other tests do without.
/// Of the workspace only the extension is built.
pub(crate) fn test_torch() -> StepResult {
    let python = python::environment_from(&package().join("torch-requirements.txt"), "torch")?;
    let place = target().join("package");
    cargo(&["build", "--package", "adwave-python", "--locked", "--quiet"], &[])?;
    assemble(&place)?;
    let tests = package().join("tests");
    let starting_with = |folder: &Path, prefixes: &[&str]| -> Result<Vec<PathBuf>, String> {
        let entries =
            std::fs::read_dir(folder).map_err(|e| format!("cannot read {}: {e}", folder.display()))?;
        let is_wanted = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            path.extension() == Some(OsStr::new("py")) && prefixes.iter().any(|p| name.starts_with(p))
        };
        Ok(entries.flatten().map(|entry| entry.path()).filter(is_wanted).collect())
    };
    let modules = starting_with(&place.join("adwave"), &["torch.", "_torch_"])?;
    println!("> pytest of adwave.torch");
    run(Command::new(&python)
        .current_dir(&place)
        .env("PYTHONPATH", &place)
        .args(["-m", "pytest", "-q", "-c"])
        .arg(package().join("pyproject.toml"))
        .args(["-o", "addopts=", "--rootdir", ".", "--doctest-modules"])
        .args(modules)
        .args(starting_with(&tests, &["test_torch", "test_walks"])?)
        .arg(format!("{}::{}[learn_the_gains]", tests.join("test_gallery.py").display(), GALLERY_TEST)))
}

/// Copies the examples of `docs/python` to a folder in which they may write their pictures; returns the path of the
/// script that runs them.
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

/// Assembles the package from its Python files and the extension of a debug build.
fn assemble(place: &Path) -> StepResult {
    let to = place.join("adwave");
    let wrong = |e: std::io::Error| format!("cannot assemble the package in {}: {e}", to.display());
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
    // A link, since a debug build has hundreds of megabytes.
    std::fs::hard_link(built, to.join(EXTENSION))
        .or_else(|_| std::fs::copy(built, to.join(EXTENSION)).map(|_| ()))
        .map_err(wrong)
}
