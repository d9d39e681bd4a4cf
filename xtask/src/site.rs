//! The site: the front page, the guides, the gallery and the references of Python and Rust, with a search, and its
//! checks.

use crate::{StepResult, cargo, python, root, run, studio, target};
use std::path::PathBuf;
use std::process::Command;

fn sources() -> PathBuf {
    root().join("site")
}

/// Builds `target/docs/index.html` and checks what needs no browser: links and anchors, titles, pictures, sizes, numbers
/// of claims, and the answers of the search. Warnings are errors.
pub(crate) fn build() -> StepResult {
    let python = python::environment_from(&sources().join("requirements.txt"), "docs")?;
    let rust = rust_reference()?;
    let site = target().join("docs");
    println!("> mkdocs build --strict");
    run(Command::new(&python)
        .current_dir(sources())
        .env("NO_MKDOCS_2_WARNING", "1")
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("ADWAVE_RUSTDOC", rust)
        .args(["-m", "mkdocs", "build", "--strict", "--clean", "--site-dir"])
        .arg(&site))?;
    let check = |words: &[&str]| {
        println!("> python {}", words.join(" "));
        run(Command::new(&python).current_dir(sources()).env("PYTHONDONTWRITEBYTECODE", "1").args(words))
    };
    let site_path = site.to_string_lossy();
    check(&["-m", "unittest", "--quiet", "test_checks"])?;
    check(&["check_pages.py", &site_path])?;
    if studio::has_node() {
        println!("> node check_search.mjs");
        run(Command::new("node").current_dir(sources()).args(["check_search.mjs", &site_path]))?;
    } else {
        println!("the answers of the search were not checked: Node is not installed");
    }
    println!("{}", site.join("index.html").display());
    Ok(())
}

/// Builds the site and checks it in a browser, on a desk and on a phone, in light and dark colors; pictures of some
/// pages are written to `target/site-test`.
pub(crate) fn test() -> StepResult {
    build()?;
    let browser = studio::install_requirements()?;
    println!("> node check_browser.mjs");
    run(Command::new("node")
        .current_dir(sources())
        .arg("check_browser.mjs")
        .arg(target().join("docs"))
        .arg(studio::web())
        .arg(target().join("site-test"))
        .env("CHROMIUM", browser))
}

/// Builds the reference of the published crates alone; returns its folder.
fn rust_reference() -> Result<PathBuf, String> {
    let folder = target().join("doc");
    // The references of other crates would be found by its search.
    let _ = std::fs::remove_dir_all(&folder);
    let names = published_crates()?;
    // rustdoc makes a link to another crate only if that has a folder, which cargo removes while it writes the reference
    // of that crate; so they are written one by one, among folders that are there.
    for name in &names {
        let place = folder.join(name.replace('-', "_"));
        std::fs::create_dir_all(&place).map_err(|e| format!("cannot make {}: {e}", place.display()))?;
    }
    let packages: Vec<&str> = names.iter().flat_map(|name| ["--package", name]).collect();
    cargo(&[&["check", "--locked", "--quiet"][..], &packages].concat(), &[])?;
    let words = [&["doc", "--no-deps", "--locked", "--quiet", "--jobs", "1"][..], &packages].concat();
    cargo(&words, &[("RUSTDOCFLAGS", "-D warnings")])?;
    Ok(folder)
}

/// Names of the crates that are published.
fn published_crates() -> Result<Vec<String>, String> {
    let folder = root().join("crates");
    let wrong = |e: std::io::Error| format!("cannot read {}: {e}", folder.display());
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(wrong)?.flatten() {
        let manifest = std::fs::read_to_string(entry.path().join("Cargo.toml")).map_err(wrong)?;
        if !manifest.contains("publish = false") {
            names.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}
