//! Dependencies run one way: `adwave ← {adwave-io, …} ← adwave-cli`. Those of tests and examples alone may run otherwise.

use serde_json::Value;
use std::process::Command;

#[test]
fn crates_depend_only_on_those_below_them() {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let layer = |name: &str| match name {
        "adwave" | "adwave-test-data" => Some(0),
        "adwave-io" | "adwave-baselines" | "adwave-render" => Some(1),
        "adwave-report" => Some(2),
        "adwave-cli" => Some(3),
        "xtask" | "adwave-bench-helpers" => Some(4),
        _ => None,
    };
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() >= 4, "{} packages", packages.len());
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let above = layer(name).unwrap_or_else(|| panic!("say in this test where the crate {name} stands"));
        for dependency in package["dependencies"].as_array().unwrap() {
            let on = dependency["name"].as_str().unwrap();
            if dependency["kind"] == "dev" {
                continue;
            }
            assert_ne!(on, "adwave-test-data", "{name}: only tests may use it");
            if let Some(below) = layer(on) {
                assert!(below < above, "{name} must not depend on {on}");
            }
        }
    }
}

#[test]
fn the_method_knows_no_files_and_no_terminal() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/adwave/src");
    let mut stack = vec![std::path::PathBuf::from(source)];
    let mut n_files = 0;
    while let Some(path) = stack.pop() {
        if path.is_dir() {
            stack.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|e| e == "rs") {
            n_files += 1;
            let text = std::fs::read_to_string(&path).unwrap();
            for banned in ["std::fs", "println!", "eprintln!", "print!(", "std::env", "static mut"] {
                let found =
                    text.lines().find(|line| line.contains(banned) && !line.trim_start().starts_with("//"));
                assert!(found.is_none(), "{}: {banned}", path.display());
            }
        }
    }
    assert!(n_files > 10, "only {n_files} files looked at");
}
