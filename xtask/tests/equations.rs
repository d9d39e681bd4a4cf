//! Equations of the paper and sources can be found by one search each: `(eq. N)`, `Algorithm N`, and keys of
//! `docs/references.bib`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const SOURCES: [&str; 8] = [
    "crates/adwave/src",
    "crates/adwave-io/src/formats/fits",
    "crates/adwave-graph/src",
    "crates/adwave-baselines/src",
    "crates/adwave-deform/src",
    "crates/adwave-register/src",
    "crates/adwave-simplify/src",
    "crates/adwave-subdivision/src",
];

/// Reads every file of the method and of the baselines, as lines.
fn sources() -> Vec<(PathBuf, Vec<String>)> {
    let mut stack: Vec<PathBuf> = SOURCES.iter().map(|source| Path::new(ROOT).join(source)).collect();
    let mut files = Vec::new();
    while let Some(path) = stack.pop() {
        if path.is_dir() {
            stack.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            let lines = fs::read_to_string(&path).unwrap().lines().map(str::to_owned).collect();
            files.push((path, lines));
        }
    }
    assert!(files.len() > 100, "only {} files looked at", files.len());
    files
}

/// True if line `at` is code, or belongs to a comment directly above code.
fn is_at_code(lines: &[String], at: usize) -> bool {
    let line = |k: usize| lines.get(k).map_or("", |line| line.trim_start());
    let is_comment = |k: usize| line(k).starts_with("//");
    if line(at).starts_with("//!") {
        return false;
    }
    let after = (at..=lines.len()).find(|&k| !is_comment(k)).unwrap_or(at);
    !line(after).is_empty()
}

/// Lists the places at code where a phrase occurs.
fn places(phrase: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (path, lines) in sources() {
        for (at, line) in lines.iter().enumerate() {
            if line.contains(phrase) && is_at_code(&lines, at) {
                found.push(format!("{}:{}", path.display(), at + 1));
            }
        }
    }
    found
}

#[test]
fn each_equation_is_found_where_it_is_computed() {
    for number in 1..=18 {
        let phrase = format!("(eq. {number})");
        assert!(!places(&phrase).is_empty(), "a search for '{phrase}' finds no code");
    }
    for number in 1..=2 {
        let phrase = format!("Algorithm {number}");
        assert!(!places(&phrase).is_empty(), "a search for '{phrase}' finds no code");
    }
}

#[test]
fn equations_are_cited_in_the_one_form_that_a_search_finds() {
    for (path, lines) in sources() {
        for (at, line) in lines.iter().enumerate() {
            for (start, _) in line.match_indices("eq. ") {
                let number: String = line[start + 4..].chars().take_while(char::is_ascii_digit).collect();
                let is_one =
                    line[..start].ends_with('(') && line[start + 4 + number.len()..].starts_with(')');
                assert!(is_one && !number.is_empty(), "{}:{}: {line}", path.display(), at + 1);
            }
        }
    }
}

/// Returns the names in backticks that look like keys: letters, a year, letters.
fn keys_in(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2).filter(|name| {
        let digits = name.trim_start_matches(|c: char| c.is_ascii_lowercase());
        let rest = digits.trim_start_matches(|c: char| c.is_ascii_digit());
        let year = &digits[..digits.len() - rest.len()];
        digits.len() < name.len()
            && year.len() == 4
            && (year.starts_with("19") || year.starts_with("20"))
            && rest.chars().all(|c| c.is_ascii_lowercase())
    })
}

#[test]
fn every_cited_source_has_an_entry_and_every_entry_is_cited() {
    let bibliography = fs::read_to_string(Path::new(ROOT).join("docs/references.bib")).unwrap();
    let entries: BTreeSet<&str> = bibliography
        .lines()
        .filter(|line| line.starts_with('@'))
        .filter_map(|line| Some(line.split_once('{')?.1.trim_end_matches(',')))
        .collect();
    let files = sources();
    let mut cited = BTreeSet::new();
    for (path, lines) in &files {
        for (at, line) in lines.iter().enumerate().filter(|(_, line)| line.trim_start().starts_with("//")) {
            for key in keys_in(line) {
                assert!(entries.contains(key), "{}:{}: no entry '{key}'", path.display(), at + 1);
                cited.insert(key);
            }
        }
    }
    let idle: Vec<_> = entries.difference(&cited).collect();
    assert!(idle.is_empty(), "nothing cites {idle:?}");
}
