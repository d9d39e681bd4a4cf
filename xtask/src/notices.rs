//! `cargo xtask notices`: copyright notices and licenses of all parts of the program and the Python package.
//!
//! They are read from the sources of the dependencies as cargo keeps them. `cargo about` would do the same, but it asks
//! a server for license texts, and cannot name the fonts and the C++ library that lie inside two of the packages.

use crate::{StepResult, cargo_output, root};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Path of the file, relative to the root of the repository. `adwave notices` prints it, and the wheel has it as a
/// license file.
pub(crate) const FILE: &str = "crates/adwave-cli/THIRD-PARTY-NOTICES.txt";

/// Beginnings of the names of files with a license or a notice.
const LICENSE_FILES: [&str; 6] = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"];

/// Lists the packages that the program named `program` contains: those that it reaches by normal dependencies. Packages
/// that are used only for building or testing are left out.
fn linked_packages(metadata: &Value, program: &str) -> Result<Vec<Value>, String> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let packages: BTreeMap<String, Value> =
        list(&metadata["packages"]).into_iter().map(|p| (p["id"].to_string(), p)).collect();
    let nodes: BTreeMap<String, Value> =
        list(&metadata["resolve"]["nodes"]).into_iter().map(|n| (n["id"].to_string(), n)).collect();
    let start = packages.iter().find(|(_, p)| p["name"] == program).ok_or("the program is no package")?;
    let (mut seen, mut stack) = (BTreeSet::new(), vec![start.0.clone()]);
    while let Some(id) = stack.pop() {
        if !seen.insert(id.clone()) {
            continue;
        }
        let Some(node) = nodes.get(&id) else { continue };
        for dependency in list(&node["deps"]) {
            if list(&dependency["dep_kinds"]).iter().any(|kind| kind["kind"].is_null()) {
                stack.push(dependency["pkg"].to_string());
            }
        }
    }
    Ok(seen.iter().filter_map(|id| packages.get(id)).filter(|p| !p["source"].is_null()).cloned().collect())
}

/// Reads the files with licenses in the folder of a package, and one level below for the parts that it bundles.
fn license_texts(folder: &Path) -> Vec<(String, String)> {
    let mut texts = Vec::new();
    let mut folders = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let path = entry.path();
            let name = entry.file_name().to_string_lossy().into_owned();
            if path.is_dir() {
                let is_bundled = ["vendor", "fonts", "third_party", "src"].contains(&name.as_str());
                if depth > 0 || is_bundled || LICENSE_FILES.iter().any(|s| name.to_uppercase().starts_with(s))
                {
                    folders.extend((depth < 2).then_some((path, depth + 1)));
                }
            } else {
                let is_license = LICENSE_FILES.iter().any(|s| name.to_uppercase().starts_with(s))
                    || name.to_uppercase().ends_with("OFL.TXT")
                    || name.to_uppercase().contains("LICENSE.TXT");
                if is_license && let Ok(text) = std::fs::read_to_string(&path) {
                    texts.push((name, text.replace("\r\n", "\n").trim().to_owned()));
                }
            }
        }
    }
    texts.sort();
    texts
}

/// Assembles the content of the file; packages that share a text are listed above it.
///
/// # Errors
/// A line of text if cargo does not describe the dependencies.
pub(crate) fn text() -> Result<String, String> {
    let output = cargo_output(&["metadata", "--format-version", "1", "--locked", "--all-features"])?;
    let metadata: Value = serde_json::from_str(&output).map_err(|e| format!("cargo metadata: {e}"))?;
    // By the text without its spacing, in which copies of one license differ.
    let mut by_text: BTreeMap<String, (String, BTreeSet<String>)> = BTreeMap::new();
    let mut without = Vec::new();
    let mut packages = linked_packages(&metadata, "adwave-cli")?;
    packages.extend(linked_packages(&metadata, "adwave-python")?);
    for package in packages {
        let name = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        let title = format!("{} {} ({})", name("name"), name("version"), name("license"));
        let manifest = name("manifest_path");
        let mut texts = license_texts(Path::new(&manifest).parent().unwrap_or(Path::new("")));
        // Where MIT may be chosen, its text alone is enough; notices stay.
        let is_choice =
            name("license").split(['/']).flat_map(|part| part.split(" OR ")).any(|license| license == "MIT")
                && !name("license").contains("AND");
        if is_choice && texts.iter().any(|(file, _)| file.to_uppercase().contains("MIT")) {
            texts.retain(|(file, _)| {
                let file = file.to_uppercase();
                file.contains("MIT") || file.starts_with("NOTICE") || file.starts_with("COPYRIGHT")
            });
        }
        if texts.is_empty() {
            without.push(title.clone());
        }
        for (_, text) in texts {
            let key = text.split_whitespace().collect::<Vec<_>>().join(" ");
            by_text.entry(key).or_insert_with(|| (text, BTreeSet::new())).1.insert(title.clone());
        }
    }
    without.sort();
    without.dedup();
    let mut page = String::from(
        "adwave contains the following software, under the licenses given. Written by `cargo xtask notices`.\n",
    );
    let mut sections: Vec<(Vec<String>, String)> =
        by_text.into_values().map(|(text, titles)| (titles.into_iter().collect(), text)).collect();
    sections.sort();
    for (titles, text) in sections {
        page += &format!("\n{}\n\n{}\n\n{text}\n", "=".repeat(100), titles.join("\n"));
    }
    if !without.is_empty() {
        page += &format!(
            "\n{}\n\nThe sources of the following packages contain no text of their license; it is the one in brackets.\n\n{}\n",
            "=".repeat(100),
            without.join("\n")
        );
    }
    Ok(page)
}

/// Writes the file anew.
///
/// # Errors
/// A line of text, as for [`text`], or if the file cannot be written.
pub(crate) fn write() -> StepResult {
    std::fs::write(root().join(FILE), text()?).map_err(|e| format!("cannot write {FILE}: {e}"))
}

/// Checks that the committed file is up to date.
///
/// # Errors
/// A line of text with the command that updates the file, if it differs from that of the current dependencies.
pub(crate) fn check() -> StepResult {
    let committed = std::fs::read_to_string(root().join(FILE)).map_err(|e| format!("{FILE}: {e}"))?;
    if committed == text()? {
        Ok(())
    } else {
        Err(format!("{FILE} is out of date: run `cargo xtask notices`"))
    }
}
