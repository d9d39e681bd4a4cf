//! Laws of the Markdown files: paths in backticks and link targets exist.

use std::path::{Path, PathBuf};

/// Folders at the root of the repository. Text in backticks that begins with one of them is a path.
const ROOTS: [&str; 9] =
    ["benches/", "bindings/", "crates/", "docs/", "fuzz/", "integrations/", "packaging/", "site/", "xtask/"];

/// Markdown file.
struct Document {
    path: PathBuf,
    /// Lines outside of fenced code, with their numbers, counted from 1.
    lines: Vec<(usize, String)>,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Names of folders that have no document of this project.
const SKIPPED: [&str; 4] = ["target", "node_modules", "dist", "__pycache__"];

/// Reads all Markdown files of the repository, without hidden folders and [`SKIPPED`].
fn documents() -> Vec<Document> {
    let mut found = Vec::new();
    let mut folders = vec![root()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap().map(Result::unwrap) {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_skipped = name.starts_with('.') || SKIPPED.contains(&name.as_str());
            let kind = entry.file_type().unwrap();
            if kind.is_dir() && !is_skipped {
                folders.push(entry.path());
            } else if kind.is_file() && entry.path().extension().is_some_and(|e| e == "md") {
                found.push(read_document(entry.path().strip_prefix(root()).unwrap()));
            }
        }
    }
    assert!(found.len() > 10, "only {} documents found", found.len());
    found
}

fn read_document(path: &Path) -> Document {
    let text = std::fs::read_to_string(root().join(path)).unwrap();
    let mut lines = Vec::new();
    let mut in_code = false;
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        } else if !in_code {
            lines.push((i + 1, line.to_owned()));
        }
    }
    Document { path: path.to_owned(), lines }
}

/// Returns the texts between single backticks in a line.
fn code_spans(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

/// Returns the path in a code span, without a trailing slash; `None` if the span is not a path or has a placeholder.
fn path_in(span: &str) -> Option<&str> {
    let word = span.trim_end_matches('/');
    let is_path = ROOTS.iter().any(|folder| word.starts_with(folder));
    let has_placeholder = word.contains(['*', '…', '<', '{', '$', ' ']) || word.contains("NAME");
    (is_path && !has_placeholder).then_some(word)
}

#[test]
fn every_path_in_backticks_exists() {
    let mut missing = Vec::new();
    let mut n_paths = 0;
    for document in documents() {
        for (number, line) in &document.lines {
            for path in code_spans(line).filter_map(path_in) {
                n_paths += 1;
                if !root().join(path).exists() {
                    missing.push(format!("{}:{number}: {path}", document.path.display()));
                }
            }
        }
    }
    assert!(n_paths > 20, "only {n_paths} paths found");
    assert!(missing.is_empty(), "paths that do not exist:\n{}", missing.join("\n"));
}

#[test]
fn every_relative_link_leads_to_a_file() {
    let mut missing = Vec::new();
    for document in documents() {
        let folder = root().join(&document.path).parent().unwrap().to_owned();
        for (number, line) in &document.lines {
            for target in
                line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target)
            {
                let file = target.split('#').next().unwrap();
                let is_elsewhere = file.contains("://") || file.starts_with("mailto:");
                if !file.is_empty() && !is_elsewhere && !folder.join(file).exists() {
                    missing.push(format!("{}:{number}: {target}", document.path.display()));
                }
            }
        }
    }
    assert!(missing.is_empty(), "links that lead nowhere:\n{}", missing.join("\n"));
}
