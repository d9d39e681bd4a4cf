//! Python environments below `target/`.

use crate::{StepResult, root, run, target};
use std::path::{Path, PathBuf};
use std::process::Command;

const REQUIREMENT: &str = "this command needs Python 3.10 or newer with the module venv as `python3`";

/// Fails unless `python3` is new enough and has the module venv.
pub(crate) fn check() -> StepResult {
    let is_recent = "import sys, venv; sys.exit(sys.version_info < (3, 10))";
    run(Command::new("python3").args(["-c", is_recent])).map_err(|e| format!("{e}; {REQUIREMENT}"))
}

/// Returns the Python interpreter of an environment with the packages of `benches/NAME/requirements.txt`. The
/// environment is created again if the list changes.
pub(crate) fn environment(name: &str) -> Result<PathBuf, String> {
    environment_from(&root().join(format!("benches/{name}/requirements.txt")), name)
}

/// Returns the Python interpreter of an environment `target/python-NAME` with the packages of a list.
pub(crate) fn environment_from(list: &Path, name: &str) -> Result<PathBuf, String> {
    let packages =
        std::fs::read_to_string(list).map_err(|e| format!("cannot read {}: {e}", list.display()))?;
    let folder = target().join(format!("python-{name}"));
    let python = folder.join("bin/python");
    let stamp = folder.join("installed.txt");
    if std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == packages) {
        return Ok(python);
    }
    create(&folder)?;
    run(Command::new(&python)
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"])
        .arg(list))?;
    std::fs::write(&stamp, packages).map_err(|e| format!("cannot write {}: {e}", stamp.display()))?;
    Ok(python)
}

/// Creates an empty environment in a folder.
pub(crate) fn create(folder: &Path) -> StepResult {
    check()?;
    println!("> python3 -m venv {}", folder.display());
    run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(folder))
        .map_err(|e| format!("{e}; {REQUIREMENT}"))
}
