//! `cargo xtask same-outputs`: runs a fixed list of commands with two versions of the program and compares their files
//! byte by byte.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Commands, one per line.
const COMMANDS: &str = include_str!("commands.txt");

/// Outputs of one program: success and standard error of each command, and the bytes of each file that it wrote.
struct Outputs {
    exits: Vec<(bool, String)>,
    files: BTreeMap<String, Vec<u8>>,
}

/// Runs the commands with the program of `--before` and with that of this tree, and compares every file.
///
/// # Errors
/// A line of text if an argument is missing, a program cannot be run, or files differ.
pub fn compare(arguments: &[&str], root: &Path, after: &Path, data: &Path) -> Result<(), String> {
    let ["--before", before] = arguments else {
        return Err("same-outputs needs --before PROGRAM: a build of the version to compare with".to_owned());
    };
    let folder = root.join("target/same-outputs");
    let lines: Vec<&str> =
        COMMANDS.lines().filter(|line| !line.starts_with('#') && !line.is_empty()).collect();
    let before = run_all(Path::new(before), &lines, &folder.join("before"), data)?;
    let after = run_all(after, &lines, &folder.join("after"), data)?;
    let mut n_faults = 0;
    for (k, line) in lines.iter().enumerate() {
        if before.exits[k].0 != after.exits[k].0 || !after.exits[k].0 {
            n_faults += 1;
            println!("{line}\n  before: {}\n  after: {}", before.exits[k].1, after.exits[k].1);
        }
    }
    let names: std::collections::BTreeSet<&String> = before.files.keys().chain(after.files.keys()).collect();
    for name in &names {
        let describe = |outputs: &Outputs| outputs.files.get(*name).map_or(-1, |bytes| bytes.len() as i64);
        if before.files.get(*name) != after.files.get(*name) {
            n_faults += 1;
            println!("{name} differs: {} bytes before, {} after", describe(&before), describe(&after));
        }
    }
    println!("{} commands, {} files compared, {n_faults} differences", lines.len(), names.len());
    if n_faults == 0 { Ok(()) } else { Err("the outputs are not the same".to_owned()) }
}

fn run_all(program: &Path, lines: &[&str], folder: &Path, data: &Path) -> Result<Outputs, String> {
    let program = program.canonicalize().map_err(|e| format!("{}: {e}", program.display()))?;
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
    let data = data.canonicalize().ok();
    let mut exits = Vec::new();
    for line in lines {
        if line.contains("{data}") && data.is_none() {
            println!("skipped, the folder of test inputs is missing: {line}");
            exits.push((true, String::new()));
            continue;
        }
        let folder_text = data.as_deref().unwrap_or(Path::new("")).to_string_lossy().into_owned();
        let words = split_words(line).into_iter().map(|word| word.replace("{data}", &folder_text));
        let output = Command::new(&program)
            .args(words)
            .arg("--quiet")
            .current_dir(folder)
            .output()
            .map_err(|e| format!("cannot run {}: {e}", program.display()))?;
        exits.push((output.status.success(), String::from_utf8_lossy(&output.stderr).trim().to_owned()));
    }
    let mut files = BTreeMap::new();
    collect_files(folder, folder, &mut files)?;
    Ok(Outputs { exits, files })
}

/// Splits a line into words, which are separated by spaces outside single quotes.
fn split_words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut is_quoted = false;
    for c in line.chars() {
        match c {
            '\'' => is_quoted = !is_quoted,
            ' ' if !is_quoted => words.push(String::new()),
            _ => words.last_mut().expect("one word at least").push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn collect_files(base: &Path, folder: &Path, files: &mut BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    for path in paths {
        if path.is_dir() {
            collect_files(base, &path, files)?;
        } else {
            let name = path.strip_prefix(base).expect("below the folder").to_string_lossy().into_owned();
            files.insert(name, std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?);
        }
    }
    Ok(())
}
