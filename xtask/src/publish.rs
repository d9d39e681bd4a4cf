//! `cargo xtask package-check`: those checks of a release that need no account, for the crates and for the Python
//! package.

use crate::{StepResult, cargo, notices, package};
use std::process::Command;

/// Runs every check that can run here, and prints a reason for each one that cannot.
///
/// # Errors
/// A line of text from the first failed check.
pub(crate) fn check() -> StepResult {
    notices::check()?;
    cargo(&["publish", "--workspace", "--dry-run", "--locked", "--allow-dirty"], &[])?;
    let has_semver_checks = Command::new("cargo")
        .args(["semver-checks", "--version"])
        .output()
        .is_ok_and(|output| output.status.success());
    if has_semver_checks {
        let tag = Command::new("git").args(["describe", "--tags", "--abbrev=0"]).output();
        match tag {
            Ok(tag) if tag.status.success() => {
                let tag = String::from_utf8_lossy(&tag.stdout).trim().to_owned();
                cargo(&["semver-checks", "--workspace", "--baseline-rev", &tag], &[])?;
            }
            _ => println!("the public interfaces were not compared: there is no release to compare with"),
        }
    } else {
        println!("the public interfaces were not compared: cargo-semver-checks is not installed");
    }
    package::check_release()
}
