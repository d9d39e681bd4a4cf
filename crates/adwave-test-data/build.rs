//! Locates the folder of test files.

use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-env-changed=ADWAVE_DATA");
    println!("cargo::rerun-if-changed=build.rs");
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let named = std::env::var_os("ADWAVE_DATA").filter(|name| !name.is_empty());
    let folder = named.map_or_else(beside, PathBuf::from);
    let folder = folder.canonicalize().unwrap_or(folder);
    println!("cargo::rustc-env=ADWAVE_TEST_DATA={}", folder.display());
    if let Ok(entries) = folder.read_dir() {
        // One file stands for the folder, because Cargo would scan a watched folder on every call.
        let files = entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file());
        if let Some(file) = files.min() {
            println!("cargo::rerun-if-changed={}", file.display());
        }
    } else {
        // Not watched: with a watched path that is missing, Cargo would rebuild all dependents on every call.
        println!("cargo::rustc-env=ADWAVE_TEST_DATA_MISSING=1");
    }
}
