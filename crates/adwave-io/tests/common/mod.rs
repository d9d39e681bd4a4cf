//! Where the test inputs are.

use std::path::PathBuf;

/// The folder of test inputs, or `None` with a printed reason when it is not there.
pub(crate) fn test_inputs() -> Option<PathBuf> {
    let folder = std::env::var_os("ADWAVE_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: {} is not there; set ADWAVE_DATA to the folder of test inputs", folder.display());
    None
}
