//! Python environments below target/, for what other people's programs are compared with.

use crate::{Outcome, root, run};
use std::path::{Path, PathBuf};
use std::process::Command;

const NEEDED: &str = "Python 3.10 or newer with its module venv is needed as `python3` for this command";

/// Whether there is a Python that is new enough.
pub(crate) fn check() -> Outcome {
    let recent = "import sys, venv; sys.exit(sys.version_info < (3, 10))";
    run(Command::new("python3").args(["-c", recent])).map_err(|e| format!("{e}; {NEEDED}"))
}

/// The Python of an environment with the packages of `benches/NAME/requirements.txt`, made where it is not there yet or
/// its list of packages has changed.
pub(crate) fn environment(root: &Path, name: &str) -> Result<PathBuf, String> {
    environment_of(&root.join(format!("benches/{name}/requirements.txt")), name)
}

/// The same with the packages of any list.
pub(crate) fn environment_of(list: &Path, name: &str) -> Result<PathBuf, String> {
    let wanted = std::fs::read_to_string(list).map_err(|e| format!("cannot read {}: {e}", list.display()))?;
    let folder = root().join(format!("target/python-{name}"));
    let python = folder.join("bin/python");
    let stamp = folder.join("installed.txt");
    if std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    check()?;
    println!("> python3 -m venv {}", folder.display());
    run(Command::new("python3").args(["-m", "venv"]).arg(&folder)).map_err(|e| format!("{e}; {NEEDED}"))?;
    run(Command::new(&python)
        .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"])
        .arg(list))?;
    std::fs::write(&stamp, wanted).map_err(|e| format!("cannot write {}: {e}", stamp.display()))?;
    Ok(python)
}
