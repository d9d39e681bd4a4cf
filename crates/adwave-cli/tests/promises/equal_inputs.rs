//! Commands on two shapes, with one shape as both: no NaN, no infinity, and null only where it means something.

use crate::fixtures::{INPUTS, fixtures};
use crate::harness::{Faults, PATIENCE, commands, is_in_sample, run_words, split_words};
use crate::option_cases::{base_lines, with_words};
use serde_json::Value;

/// Keys whose null says that there is none of the thing.
const NULL_KEYS: [&str; 8] =
    ["alignment", "motion", "apart_sigmas", "share", "fwhm", "output", "area", "volume"];

/// Words that change how two shapes are compared.
const VARIANTS: [&str; 6] =
    ["", "--align", "--by closest", "--motion similarity", "--motion none", "--by closest --align"];

/// Keys of nulls in a report that are not among those that may be null, and of numbers that are none.
fn odd_values(json: &Value, key: &str, found: &mut Vec<String>) {
    match json {
        Value::Null if !NULL_KEYS.contains(&key) => found.push(format!("{key} is null")),
        Value::Object(entries) => entries.iter().for_each(|(key, value)| odd_values(value, key, found)),
        Value::Array(values) => values.iter().for_each(|value| odd_values(value, key, found)),
        _ => {}
    }
}

#[test]
fn a_shape_compared_with_itself_has_finite_numbers() {
    let folder = fixtures();
    let folder = folder.path();
    std::fs::create_dir_all(folder.join("out")).unwrap();
    let mut faults = Faults::default();
    let compares = |command: &clap::Command| command.get_positionals().any(|arg| arg.get_id() == "other");
    let commands: Vec<String> =
        commands().iter().filter(|c| compares(c)).map(|c| c.get_name().to_owned()).collect();
    assert!(commands.len() >= 2, "{commands:?}");
    for command in &commands {
        for line in base_lines(command) {
            for (kind, file) in INPUTS.into_iter().chain([("closed", "closed.ply"), ("single", "single.ply")])
            {
                for variant in VARIANTS {
                    if !is_in_sample(&format!("{line} {kind} {variant}"), 6) {
                        continue;
                    }
                    let base = split_words(&line.replace("{in}", file).replace("{other}", file));
                    let words = with_words(&base, &split_words(variant));
                    let text = run_words(folder, &words, PATIENCE);
                    faults.inspect(&text);
                    let run = run_words(folder, &with_words(&words, &["--json".to_owned()]), PATIENCE);
                    faults.inspect(&run);
                    if run.is_done() {
                        let mut odd = Vec::new();
                        odd_values(&serde_json::from_str(&run.out).unwrap_or_default(), "", &mut odd);
                        faults.expect(odd.is_empty(), || format!("{}: {}", run.line, odd.join(", ")));
                    }
                }
            }
        }
    }
    faults.finish();
}
