//! Text and JSON on the standard output, notes on the standard error.

use crate::args::shown_text;
use crate::error::CliError;
use crate::global::Global;
use comfy_table::{CellAlignment, Row, Table, presets};
use serde_json::Value;
use std::ffi::OsString;
use std::io::Write;

/// Prints the result: `text` for people, or `json` for machines.
pub(crate) fn print(global: &Global<'_>, text: &str, json: &Value) -> Result<(), CliError> {
    print_remarks(global);
    if global.is_piped {
        // The standard output belongs to the shape.
        let report = shown_text(&if global.json { format!("{json:#}") } else { text.trim_end().to_owned() });
        if global.json || !global.quiet {
            tell(&report);
        }
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    let printed = if global.json {
        writeln!(out, "{}", shown_text(&format!("{json:#}")))
    } else if global.quiet {
        Ok(())
    } else {
        writeln!(out, "{}", shown_text(text.trim_end()))
    };
    printed.and_then(|()| out.flush()).map_err(|e| match e.kind() {
        std::io::ErrorKind::BrokenPipe => CliError::ClosedPipe,
        _ => CliError::Environment(format!("cannot write to the standard output: {e}")),
    })
}

/// Prints bytes that are the result of a command as they are, or `json` for machines.
pub(crate) fn print_bytes(global: &Global<'_>, bytes: &[u8], json: &Value) -> Result<(), CliError> {
    if global.json {
        return print(global, "", json);
    }
    let mut out = std::io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|e| match e.kind() {
        std::io::ErrorKind::BrokenPipe => CliError::ClosedPipe,
        _ => CliError::Environment(format!("cannot write to the standard output: {e}")),
    })
}

/// Prints a line on the standard error. If nobody can read it, the work goes on.
pub(crate) fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// A message without the numbers that the system gives its errors, and without bytes of names that are no UTF-8.
pub(crate) fn plain_text(text: &str) -> String {
    const NUMBER: &str = " (os error ";
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(NUMBER) {
        let digits = after.trim_start_matches(|c: char| c.is_ascii_digit() || c == '-');
        plain += before;
        if let Some(after) = digits.strip_prefix(')') {
            rest = after;
        } else {
            plain += NUMBER;
            rest = after;
        }
    }
    shown_text(&(plain + rest))
}

/// Prints a remark that is not part of the result, for people only.
pub(crate) fn note(global: &Global<'_>, text: &str) {
    print_remarks(global);
    if !global.quiet {
        tell(&format!("note: {}", plain_text(&global.inputs.in_row_words(text))));
    }
}

/// Prints the remarks about inputs that were kept until now.
pub(crate) fn print_remarks(global: &Global<'_>) {
    for text in global.inputs.take_remarks() {
        if !global.quiet {
            tell(&format!("note: {}", plain_text(&global.inputs.in_row_words(&text))));
        }
    }
}

/// A table with a head, numbers aligned to the right.
pub(crate) fn table<R: Into<Row>>(head: impl Into<Row>, rows: impl IntoIterator<Item = R>) -> String {
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

/// The most memory that this process has held, in bytes; `None` if the system does not report it.
pub(crate) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    peak.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_the_system_have_no_numbers() {
        assert_eq!(
            plain_text("a.ply: No such file (os error 2); name another"),
            "a.ply: No such file; name another"
        );
        assert_eq!(plain_text("a (os error x) (os error 13)"), "a (os error x)");
    }
}
