//! Where a result came from: version, command, and what was read.

use crate::error::CliError;
use crate::global::Global;
use crate::output::command_line;
use adwave_io::{Provenance, ProvenanceInput};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a run has read.
pub(crate) struct Inputs {
    /// Whether results say in comments too where they came from.
    pub(crate) in_comments: bool,
    sources: Mutex<Vec<Source>>,
}

#[derive(PartialEq, Eq)]
enum Source {
    /// Hashed only when a result says so.
    File(PathBuf),
    /// What can be read once only.
    Bytes(ProvenanceInput),
}

impl Inputs {
    pub(crate) fn new(in_comments: bool) -> Self {
        Self { in_comments, sources: Mutex::default() }
    }

    fn all(&self) -> MutexGuard<'_, Vec<Source>> {
        self.sources.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn add(&self, source: Source) {
        let mut all = self.all();
        if !all.contains(&source) {
            all.push(source);
        }
    }

    /// A file that is read.
    pub(crate) fn add_file(&self, path: &Path) {
        self.add(Source::File(path.to_owned()));
    }

    /// The files that a signal comes from, where it comes from one: `FILE` or `FILE:COLUMN`, and a picture.
    pub(crate) fn add_signal(&self, name: &str, texture: Option<&Path>) {
        let before_column = name.rsplit_once(':').map(|(file, _)| file);
        let file =
            [Some(name), before_column].into_iter().flatten().map(Path::new).find(|file| file.is_file());
        file.into_iter().chain(texture).for_each(|path| self.add_file(path));
    }

    /// Bytes that are no file.
    pub(crate) fn add_bytes(&self, name: &str, bytes: &[u8]) {
        let sha256 = Some(hexadecimal(Sha256::digest(bytes)));
        self.add(Source::Bytes(ProvenanceInput { name: name.to_owned(), sha256 }));
    }

    /// A shape that is made, or a file that is not read whole, by its name without folders.
    pub(crate) fn add_unhashed(&self, name: &str) {
        self.add(Source::Bytes(ProvenanceInput { name: last_part(name).to_owned(), sha256: None }));
    }
}

/// Where the result of this run comes from. Reads the inputs again, for their hashes.
pub(crate) fn provenance(global: &Global<'_>) -> Result<Provenance, CliError> {
    let input = |source: &Source| match source {
        Source::Bytes(input) => Ok(input.clone()),
        Source::File(path) => {
            let name = last_part(&path.to_string_lossy()).to_owned();
            Ok(ProvenanceInput { name, sha256: hash(path, global)? })
        }
    };
    let words = words_of_result(global.arguments.get(1..).unwrap_or_default());
    Ok(Provenance {
        program: concat!("adwave ", env!("CARGO_PKG_VERSION")).to_owned(),
        command: command_line(words.iter()),
        inputs: global.inputs.all().iter().map(input).collect::<Result<_, CliError>>()?,
    })
}

/// The SHA-256 of a file that is one; pipes and devices can be read once only.
fn hash(path: &Path, global: &Global<'_>) -> Result<Option<String>, CliError> {
    if !path.metadata().is_ok_and(|m| m.is_file()) {
        return Ok(None);
    }
    let failed =
        |e: std::io::Error| CliError::Environment(format!("{}: cannot read it again: {e}", path.display()));
    let mut file = File::open(path).map_err(failed)?;
    let (mut sum, mut buffer) = (Sha256::new(), vec![0; 1 << 20]);
    loop {
        global.progress().check().map_err(|_| CliError::Cancelled)?;
        match file.read(&mut buffer).map_err(failed)? {
            0 => return Ok(Some(hexadecimal(sum.finalize()))),
            n => sum.update(&buffer[..n]),
        }
    }
}

fn hexadecimal(bytes: impl AsRef<[u8]>) -> String {
    bytes.as_ref().iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

/// Lines for people.
pub(crate) fn text(made: &Provenance) -> String {
    let mut text = format!("  made by       {}: {}\n", made.program, made.command);
    for input in &made.inputs {
        let sum = input.sha256.as_ref().map_or(String::new(), |sum| format!(", SHA-256 {sum}"));
        text += &format!("  made from     {}{sum}\n", input.name);
    }
    text
}

/// The same for machines.
pub(crate) fn json(made: &Provenance) -> Value {
    let inputs: Vec<Value> =
        made.inputs.iter().map(|input| json!({"name": input.name, "sha256": input.sha256})).collect();
    json!({"program": made.program, "command": made.command, "inputs": inputs})
}

fn last_part(path: &str) -> &str {
    path.rsplit(['/', std::path::MAIN_SEPARATOR]).find(|part| !part.is_empty()).unwrap_or(path)
}

/// The words that the result depends on, without folders.
fn words_of_result(words: &[OsString]) -> Vec<OsString> {
    let mut kept = Vec::new();
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
            _ => kept.push(without_folders(word)),
        }
    }
    kept
}

/// A word of the command line with the names of files, but not their folders: `--output=a/b.ply` is `--output=b.ply`.
fn without_folders(word: &OsStr) -> OsString {
    let text = word.to_string_lossy();
    if !text.contains(['/', std::path::MAIN_SEPARATOR]) {
        return word.to_owned();
    }
    match text.split_once('=').filter(|(flag, _)| flag.starts_with('-')) {
        Some((flag, value)) => format!("{flag}={}", last_part(value)).into(),
        None => last_part(&text).into(),
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
            assert_eq!(without_folders(OsStr::new(word)), OsString::from(expected), "{word}");
        }
    }
}
