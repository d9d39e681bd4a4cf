//! Laws that keep the code building on systems on which these tests do not run.

use std::path::{Path, PathBuf};

/// Conditions of systems, each with those that it includes.
const SYSTEMS: [(&str, &[&str]); 3] = [
    ("unix", &["unix", "target_os = \"linux\"", "all(target_os = \"linux\", target_env = \"gnu\")"]),
    ("target_os = \"linux\"", &["target_os = \"linux\"", "all(target_os = \"linux\", target_env = \"gnu\")"]),
    (
        "all(target_os = \"linux\", target_env = \"gnu\")",
        &["all(target_os = \"linux\", target_env = \"gnu\")"],
    ),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Rust files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// Condition for which a manifest has libc.
fn condition_of(manifest: &str) -> Option<&str> {
    let before = manifest.split("\nlibc.workspace").next().filter(|part| part.len() < manifest.len())?;
    before.rsplit_once("[target.'cfg(")?.1.split_once(")'.dependencies]").map(|(condition, _)| condition)
}

/// Conditions under which a source calls libc: that of the attribute above each call.
fn conditions_of_calls(source: &str) -> Vec<(usize, String)> {
    let (mut condition, mut found) = ("none".to_owned(), Vec::new());
    for (k, line) in source.lines().enumerate() {
        let line = line.trim();
        if let Some(rest) = line.strip_prefix("#[cfg(").or_else(|| line.strip_prefix("#![cfg(")) {
            rest.strip_suffix(")]").unwrap_or(rest).clone_into(&mut condition);
        } else if line.contains("libc::") && !line.starts_with("//") {
            found.push((k + 1, condition.clone()));
        }
    }
    found
}

#[test]
fn libc_is_called_only_where_the_manifest_has_it() {
    let crates = std::fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let (mut faults, mut n_calls) = (Vec::new(), 0);
    for folder in crates.chain([root().join("bindings/python")]) {
        let Ok(manifest) = std::fs::read_to_string(folder.join("Cargo.toml")) else { continue };
        let given = condition_of(&manifest);
        let included =
            SYSTEMS.iter().find(|(name, _)| Some(*name) == given).map_or(&[][..], |(_, included)| included);
        for path in sources(&folder.join("src")) {
            for (line, condition) in conditions_of_calls(&std::fs::read_to_string(&path).unwrap()) {
                n_calls += 1;
                if !included.contains(&condition.as_str()) {
                    let place = path.strip_prefix(root()).unwrap().display();
                    faults
                        .push(format!("{place}:{line}: called for {condition}, the manifest has {given:?}"));
                }
            }
        }
    }
    assert!(n_calls > 20, "only {n_calls} calls of libc were found");
    assert!(faults.is_empty(), "libc is missing on some systems:\n{}", faults.join("\n"));
}

#[test]
fn a_call_for_more_systems_than_the_manifest_is_found() {
    let manifest = "[dependencies]\na = 1\n\n[target.'cfg(target_os = \"linux\")'.dependencies]\nlibc.workspace = true\n";
    assert_eq!(condition_of(manifest), Some("target_os = \"linux\""));
    assert_eq!(condition_of("[dependencies]\na = 1\n"), None);
    let source = "#[cfg(unix)]\nfn f() {\n    // libc:: in words\n    libc::raise(2);\n}\n";
    assert_eq!(conditions_of_calls(source), [(4, "unix".to_owned())]);
}
