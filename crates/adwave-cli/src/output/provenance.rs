//! Provenance of a result: version, command, and inputs.

use super::command_line;
use crate::error::CliError;
use crate::global::Global;
use crate::inputs::last_component;
use adwave_io::Provenance;
use serde_json::{Value, json};
use std::ffi::{OsStr, OsString};

/// Provenance of the result of this run. Reads the inputs again, for their hashes.
pub(crate) fn provenance(global: &Global<'_>) -> Result<Provenance, CliError> {
    let words = words_of_result(global.arguments.get(1..).unwrap_or_default());
    Ok(Provenance {
        program: concat!("adwave ", env!("CARGO_PKG_VERSION")).to_owned(),
        command: command_line(words.iter()),
        inputs: global.inputs.describe(global.progress())?,
    })
}

/// Provenance in lines for people.
pub(crate) fn provenance_text(provenance: &Provenance) -> String {
    let mut text = format!("  made by       {}: {}\n", provenance.program, provenance.command);
    for input in &provenance.inputs {
        let sum = input.sha256.as_ref().map_or(String::new(), |sum| format!(", SHA-256 {sum}"));
        text += &format!("  made from     {}{sum}\n", input.name);
    }
    text
}

/// Provenance as `program`, `command` and `inputs`.
pub(crate) fn provenance_json(provenance: &Provenance) -> Value {
    let inputs: Vec<Value> =
        provenance.inputs.iter().map(|input| json!({"name": input.name, "sha256": input.sha256})).collect();
    json!({"program": provenance.program, "command": provenance.command, "inputs": inputs})
}

/// The words that the result depends on, without folders.
fn words_of_result(words: &[OsString]) -> Vec<OsString> {
    let mut relevant = Vec::new();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        let flag = text.split('=').next().unwrap_or_default();
        match flag {
            "--json" | "--quiet" | "-q" => {}
            "--threads" | "--max-input" => {
                if flag.len() == text.len() {
                    words.next();
                }
            }
            _ => relevant.push(strip_folders(word)),
        }
    }
    relevant
}

/// A word of the command line with the names of files, but not their folders: `--output=a/b.ply` becomes
/// `--output=b.ply`.
fn strip_folders(word: &OsStr) -> OsString {
    let text = word.to_string_lossy();
    if !text.contains(['/', std::path::MAIN_SEPARATOR]) {
        return word.to_owned();
    }
    match text.split_once('=').filter(|(flag, _)| flag.starts_with('-')) {
        Some((flag, value)) => format!("{flag}={}", last_component(value)).into(),
        None => last_component(&text).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_words_that_the_result_depends_on_stay() {
        let words =
            "filter a.ply --threads 3 -o b/c.ply --quiet --threads=2 --max-input 8G --gains 0,1 --json";
        let words: Vec<OsString> = words.split(' ').map(OsString::from).collect();
        assert_eq!(words_of_result(&words), ["filter", "a.ply", "-o", "c.ply", "--gains", "0,1"]);
    }

    #[test]
    fn folders_are_left_out() {
        for (word, expected) in [
            ("/home/me/a.ply", "a.ply"),
            ("a.ply", "a.ply"),
            ("--output=../b/c.ply", "--output=c.ply"),
            ("--gains", "--gains"),
            ("folder/", "folder"),
            ("ball:center=1,2,3", "ball:center=1,2,3"),
        ] {
            assert_eq!(strip_folders(OsStr::new(word)), OsString::from(expected), "{word}");
        }
    }
}
