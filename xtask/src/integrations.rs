//! Tests of the plug-ins of other programs in these programs, without a window.

use crate::{StepResult, package, python, root, run};
use std::path::Path;
use std::process::Command;

/// Tests the plug-in of napari in napari, which is installed below `target/`, and that of QGIS in the QGIS of the system,
/// if there is one.
pub(crate) fn test() -> StepResult {
    let place = package::assembled()?;
    let napari = root().join("integrations/napari");
    let python = python::environment_from(&napari.join("test-requirements.txt"), "napari")?;
    let mut paths = vec![place.clone(), napari.join("src")];
    println!("> pytest of the plug-in of napari");
    run(without_window(&python, &paths)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        .arg(napari.join("tests")))?;
    let system = Path::new("/usr/bin/python3");
    let has_qgis = Command::new(system).args(["-c", "import qgis.core, osgeo"]).output();
    if !has_qgis.is_ok_and(|output| output.status.success()) {
        println!(
            "the plug-in of QGIS was not tested: {} has no qgis (apt-get install qgis)",
            system.display()
        );
        return Ok(());
    }
    paths.truncate(1);
    println!("> unittest of the plug-in of QGIS");
    run(without_window(system, &paths)
        .args(["-m", "unittest", "discover", "-s"])
        .arg(root().join("integrations/qgis/tests")))
}

/// Command of a Python that finds the packages of some folders and opens no window.
fn without_window(python: &Path, paths: &[std::path::PathBuf]) -> Command {
    let mut command = Command::new(python);
    let joined = std::env::join_paths(paths).unwrap_or_default();
    command.env("PYTHONPATH", joined).env("PYTHONDONTWRITEBYTECODE", "1").env("QT_QPA_PLATFORM", "offscreen");
    command
}
