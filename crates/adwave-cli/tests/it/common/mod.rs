//! What the command-line tests share.

#![allow(dead_code)] // each test file uses a part of it

pub(crate) mod page;

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The command, run in `folder`.
pub(crate) fn adwave(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("adwave").unwrap();
    command.current_dir(folder).timeout(std::time::Duration::from_secs(120));
    command
}

/// Runs `line` (split at blanks; `'…'` keeps blanks) in `folder` and gives what it prints with --json.
pub(crate) fn json(folder: &Path, line: &str) -> Value {
    let output =
        adwave(folder).args(words(line)).arg("--json").assert().success().get_output().stdout.clone();
    serde_json::from_slice(&output).unwrap()
}

/// Runs `line` in `folder`, expects exit code 2 and one line of error, and gives that line.
pub(crate) fn refused(folder: &Path, line: &str) -> String {
    let output = adwave(folder).args(words(line)).assert().code(2).get_output().clone();
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(output.stdout.is_empty(), "{line} printed a result");
    assert_eq!(text.trim_end().lines().count(), 1, "{line}: {text}");
    assert!(text.starts_with("adwave: "), "{line}: {text}");
    text
}

/// The words of a command line.
pub(crate) fn words(line: &str) -> Vec<String> {
    line.split('\'')
        .enumerate()
        .flat_map(|(k, part)| {
            if k % 2 == 1 {
                vec![part.to_owned()]
            } else {
                part.split_whitespace().map(str::to_owned).collect()
            }
        })
        .collect()
}

/// The folder of real test files.
pub(crate) fn real_files() -> &'static Path {
    Path::new(adwave_test_data::folder!())
}

/// All files below a folder, in order.
pub(crate) fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut stack = vec![folder.to_owned()];
    while let Some(folder) = stack.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                stack.push(path);
            } else {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
