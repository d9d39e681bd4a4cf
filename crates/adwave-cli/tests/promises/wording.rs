//! Words in which the command speaks: patterns that no output contains.

use crate::fixtures::{INPUTS, fixtures};
use crate::harness::{Faults, commands, is_in_sample, run_line, run_words};
use crate::option_cases::{base_line, base_lines};
use std::path::Path;

/// Texts of libraries and of the machine that say nothing to people.
const FOREIGN: [&str; 10] = [
    "invalid float literal",
    "invalid digit found",
    "cannot parse integer",
    "cannot parse float",
    "number too large to fit",
    "os error",
    "called `",
    "panicked at",
    "RUST_BACKTRACE",
    "Some(",
];

/// Words after `1 ` that end in s and are no plural.
const SINGULAR: [&str; 12] =
    ["is", "pass", "as", "was", "has", "plus", "times", "this", "class", "axis", "its", "less"];

/// Longest run of digits that a person reads.
const MOST_DIGITS: usize = 20;

/// Faults of a text that people read, or of JSON.
pub(crate) fn wording_faults(text: &str) -> Vec<String> {
    if text.starts_with('.')
        || text.starts_with("#compdef")
        || text.contains("complete -")
        || text.contains("%PDF")
    {
        return Vec::new(); // a manual page, or completions
    }
    let is_json = text.trim_start().starts_with('{');
    let mut faults: Vec<String> = FOREIGN
        .iter()
        .filter(|pattern| text.contains(**pattern))
        .map(|pattern| format!("says '{pattern}'"))
        .collect();
    for pattern in ["0.0 MB", "0.0 GB", "0.0 GiB"] {
        if text.contains(&format!(" {pattern}")) {
            faults.push(format!("says '{pattern}'"));
        }
    }
    if is_json {
        return faults;
    }
    // Help says what NaN means.
    let is_help = text.contains("Usage: adwave");
    for line in text.lines() {
        faults.extend(
            number_faults(line, is_json)
                .into_iter()
                .filter(|fault| !((is_help || line.contains("and NaN")) && fault.contains("'NaN'"))),
        );
    }
    faults
}

/// Faults of the numbers of a line.
fn number_faults(line: &str, is_json: bool) -> Vec<String> {
    let mut faults = Vec::new();
    let words: Vec<&str> = line.split([' ', '(', ')', ',', ';', ':', '\'', '"']).collect();
    for pair in words.windows(2) {
        let noun = pair[1];
        let is_noun = noun.len() > 2 && noun.ends_with('s') && noun.chars().all(|c| c.is_ascii_lowercase());
        if pair[0] == "1" && is_noun && !SINGULAR.contains(&noun) && !noun.ends_with("ss") {
            faults.push(format!("says '1 {noun}': {line}"));
        }
    }
    // What the user typed is repeated as it was.
    let is_refusal = line.starts_with("adwave: ") || line.starts_with("error: ");
    for word in &words {
        let is_number_word = |bad: &str| word.trim_end_matches(['°', '%']).trim_start_matches('-') == bad;
        if !is_refusal && (is_number_word("NaN") || is_number_word("inf")) && !line.contains("is NaN") {
            faults.push(format!("says '{word}': {line}"));
        }
        // Machines read the zeros of a small number as well as its power of ten. JSON may stand behind a note.
        let is_entry = is_json || line.trim_start().starts_with('"');
        let counted = if is_entry { word.trim_start_matches(['+', '-', '0', '.']) } else { word };
        let digits = counted.chars().filter(char::is_ascii_digit).count();
        let is_number = word.chars().all(|c| c.is_ascii_digit() || "+-.e%".contains(c));
        if is_number && digits > MOST_DIGITS {
            faults.push(format!("has a number of {digits} digits: {line}"));
        }
    }
    faults
}

#[test]
fn every_command_speaks_in_full_words() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for command in commands() {
        let name = command.get_name().to_owned();
        if is_in_sample(&name, 3) {
            faults.inspect(&run_line(folder, &format!("{name} --help")));
        }
        for line in base_lines(&name) {
            for (kind, _) in INPUTS {
                if is_in_sample(&format!("{line} {kind}"), 4) {
                    faults.inspect(&run_words(folder, &base_line(line, kind), crate::harness::PATIENCE));
                }
            }
        }
    }
    for line in [
        "info single.ply",
        "info single.ply --levels 1",
        "info missing.ply",
        "filter single.ply -o one.ply --gains 1 --levels 2",
        "filter single.ply -o one.ply --gains 0.5",
        "convert single.ply -o one.obj",
        "convert single.ply -o no-folder/one.obj",
        "simplify single.ply -o one.ply --vertices 3",
        "basis single.ply --vertex 0 --level 1 -o one.ply",
        "saliency graph.mtx -o one.csv",
        "tiles scan.las -o one.las --gains 0.5 --forecast",
        "tiles scan.las -o one.las --gains 0.5,1",
        "info mesh.ply --steps 1e300",
        "info mesh.ply --only heat=x",
        "region mesh.ply --region ball:vertex=0,radius=x",
        "filter mesh.ply -o one.ply --recipe balls.csv",
        "filter mesh.ply -o one.ply --recipe missing.toml",
        "info mesh.ply --only x=-inf..0",
        "region mesh.ply --region field:name=band-99",
        "sample nonsense",
        "features mesh.ply --best 1",
    ] {
        faults.inspect(&run_line(folder, line));
    }
    faults.finish();
}

#[test]
fn numbers_in_words_are_those_of_the_table() {
    let folder = fixtures();
    let mut faults = Faults::default();
    let run = run_line(folder.path(), "demo -o tour --vertices 2000");
    faults.inspect(&run);
    let n_rows = run
        .out
        .lines()
        .filter(|line| {
            line.trim_start()
                .split(' ')
                .next()
                .is_some_and(|w| Path::new(w).extension().is_some_and(|e| e == "ply"))
        })
        .count();
    faults.expect(run.out.contains(&format!("\n{n_rows} edits")), || format!("{n_rows} rows: {}", run.out));
    let times: Vec<f64> = run
        .out
        .lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.split_whitespace().collect();
            (cells.len() == 6 && cells[0].parse::<usize>().is_ok()).then(|| cells[5].parse().ok()).flatten()
        })
        .collect();
    faults.expect(times.len() > 2 && times.is_sorted(), || format!("times up to a level: {times:?}"));
    faults.finish();
}

#[test]
fn faults_of_wording_are_found() {
    for bad in [
        "1 tiles",
        "x: invalid float literal",
        "a (os error 2)",
        "0 bytes, 0.0 MB",
        "turn by NaN°",
        "0.00000000000000000000000000000000000000012 %",
    ] {
        assert!(!wording_faults(&format!("  {bad}")).is_empty(), "{bad}");
    }
    for good in ["1 tile", "11 tiles", "adwave: --gains: 1 is not enough, got NaN", "level 1 is coarse"] {
        assert!(wording_faults(good).is_empty(), "{good}: {:?}", wording_faults(good));
    }
}

/// Columns of the help on a wide terminal.
const HELP_COLUMNS: usize = 98;

#[test]
fn tables_and_examples_of_the_help_are_not_broken() {
    let definition = adwave_cli::definition();
    let mut faults = Vec::new();
    for command in definition.get_subcommands() {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        for line in help.lines().filter(|line| line.starts_with("  ")) {
            if line.chars().count() > HELP_COLUMNS {
                faults.push(format!("{}: {line}", command.get_name()));
            }
        }
    }
    assert!(faults.is_empty(), "lines of more than {HELP_COLUMNS} columns:\n{}", faults.join("\n"));
}
