//! Text and JSON on the standard output, notes on the standard error.

use crate::error::CliError;
use crate::global::Global;
use comfy_table::{CellAlignment, Table, presets};
use serde_json::Value;
use std::ffi::OsString;
use std::io::Write;

/// Prints the result: `text` for people, or `json` for machines.
pub(crate) fn print(global: &Global<'_>, text: &str, json: &Value) -> Result<(), CliError> {
    print_remarks(global);
    if global.is_piped {
        // The standard output belongs to the shape.
        let report = if global.json { format!("{json:#}") } else { text.trim_end().to_owned() };
        if global.json || !global.quiet {
            eprintln!("{report}");
        }
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    let printed = if global.json {
        writeln!(out, "{json:#}")
    } else if global.quiet {
        Ok(())
    } else {
        writeln!(out, "{}", text.trim_end())
    };
    printed.and_then(|()| out.flush()).map_err(|e| match e.kind() {
        std::io::ErrorKind::BrokenPipe => CliError::ClosedPipe,
        _ => CliError::Environment(format!("cannot write to the standard output: {e}")),
    })
}

/// Prints a remark that is not part of the result, for people only.
pub(crate) fn note(global: &Global<'_>, text: &str) {
    print_remarks(global);
    if !global.quiet {
        eprintln!("note: {text}");
    }
}

/// Prints the remarks about inputs that were kept until now.
pub(crate) fn print_remarks(global: &Global<'_>) {
    for text in global.inputs.take_remarks() {
        if !global.quiet {
            eprintln!("note: {text}");
        }
    }
}

/// A table with a head, numbers aligned to the right.
pub(crate) fn table<const N: usize>(head: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(head).add_rows(rows);
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
        column.set_padding((0, 2));
    }
    table.lines().fold(String::new(), |text, line| text + "  " + line.trim_end() + "\n")
}

/// The command of these words, quoted so that it can be typed.
pub(crate) fn command_line<'a>(words: impl Iterator<Item = &'a OsString>) -> String {
    let is_safe = |c: char| c.is_alphanumeric() || "-_./:,=+@%".contains(c);
    let quote = |word: String| {
        if !word.is_empty() && word.chars().all(is_safe) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = words.map(|word| quote(word.to_string_lossy().into_owned()));
    std::iter::once("adwave".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// The most memory that this process has held, in bytes; `None` if the system does not tell.
pub(crate) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    peak.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
