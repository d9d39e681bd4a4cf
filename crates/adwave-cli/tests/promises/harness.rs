//! Runs of the command, the definition of its options, and a list of faults.

use crate::wording::wording_faults;
use assert_cmd::Command;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time within which every run must end.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// One run of the command.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) line: String,
    /// None if a signal or the time limit ended it.
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) out_bytes: Vec<u8>,
    pub(crate) err: String,
    pub(crate) took: Duration,
}

impl Run {
    pub(crate) fn is_done(&self) -> bool {
        self.code == Some(0)
    }

    /// Beginning of the output of the run.
    pub(crate) fn tail(&self) -> String {
        let text = format!("{} {}", self.err.trim(), self.out.trim());
        text.chars().take(400).collect::<String>().replace('\n', " ⏎ ")
    }
}

/// Runs the words of a command in a folder.
pub(crate) fn run_words(folder: &Path, words: &[String], patience: Duration) -> Run {
    let start = Instant::now();
    let mut command = Command::cargo_bin("adwave").unwrap();
    command.current_dir(folder).timeout(patience).env("ADWAVE_NO_BROWSER", "1");
    let output = command.args(words).output().unwrap();
    Run {
        line: format!("adwave {}", words.join(" ")),
        code: output.status.code(),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        out_bytes: output.stdout,
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
        took: start.elapsed(),
    }
}

/// Runs a line in a folder; the words are split at blanks, and `'…'` keeps blanks.
pub(crate) fn run_line(folder: &Path, line: &str) -> Run {
    run_words(folder, &split_words(line), PATIENCE)
}

/// The words of a line.
pub(crate) fn split_words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut is_quoted, mut is_open) = (Vec::new(), String::new(), false, false);
    for c in line.chars() {
        match c {
            '\'' => {
                is_quoted = !is_quoted;
                is_open = true;
            }
            c if c.is_whitespace() && !is_quoted => {
                if is_open {
                    words.push(std::mem::take(&mut word));
                }
                is_open = false;
            }
            c => {
                word.push(c);
                is_open = true;
            }
        }
    }
    if is_open {
        words.push(word);
    }
    words
}

/// Faults that a test found; it fails with all of them.
#[derive(Debug, Default)]
pub(crate) struct Faults {
    faults: Vec<String>,
    n_runs: usize,
}

impl Faults {
    pub(crate) fn add(&mut self, fault: impl Into<String>) {
        self.faults.push(fault.into());
    }

    /// Adds a fault unless a condition holds.
    pub(crate) fn expect(&mut self, holds: bool, fault: impl FnOnce() -> String) {
        if !holds {
            self.add(fault());
        }
    }

    /// Checks what every run must keep to: it ends in time, with a known code, without a panic, in words that people read.
    pub(crate) fn inspect(&mut self, run: &Run) {
        self.n_runs += 1;
        match run.code {
            None => self.add(format!("{}: did not end within {:?}", run.line, run.took)),
            Some(0..=2) => {}
            Some(code) => self.add(format!("{}: exit code {code}: {}", run.line, run.tail())),
        }
        for fault in wording_faults(&run.out).into_iter().chain(wording_faults(&run.err)) {
            self.add(format!("{}: {fault}", run.line));
        }
    }

    /// Ends the test.
    pub(crate) fn finish(self) {
        println!("{} runs", self.n_runs);
        assert!(self.n_runs > 0, "nothing was run");
        assert!(
            self.faults.is_empty(),
            "{} faults in {} runs:\n{}",
            self.faults.len(),
            self.n_runs,
            self.faults.join("\n")
        );
    }
}

/// Tells if all cases are to be run, as `cargo xtask command-check` asks for.
pub(crate) fn runs_all() -> bool {
    std::env::var_os("ADWAVE_COMMAND_CHECK").is_some_and(|value| value == "full")
}

/// Tells if a case is part of the sample of one in `share`; all are if all are to be run. The choice depends on the case alone.
pub(crate) fn is_in_sample(case: &str, share: u64) -> bool {
    // FNV-1a: the same on every machine.
    let hash =
        case.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    runs_all() || (hash >> 20).is_multiple_of(share)
}

/// Definitions of all commands that people see.
pub(crate) fn commands() -> Vec<clap::Command> {
    let all = adwave_cli::definition();
    all.get_subcommands().filter(|command| command.get_name() != "help").cloned().collect()
}

/// Long options of a command, without those that are hidden and without help.
pub(crate) fn options(command: &clap::Command) -> Vec<clap::Arg> {
    let is_option =
        |arg: &&clap::Arg| arg.get_long().is_some_and(|long| !["help", "version"].contains(&long));
    command.get_arguments().filter(|arg| is_option(arg) && !arg.is_hide_set()).cloned().collect()
}

/// An option with its dashes.
pub(crate) fn name(arg: &clap::Arg) -> String {
    format!("--{}", arg.get_long().unwrap_or_default())
}

/// Tells if an option takes a value.
pub(crate) fn takes_value(arg: &clap::Arg) -> bool {
    arg.get_action().takes_values()
}

#[test]
fn words_are_split_as_in_a_shell() {
    assert_eq!(split_words("a 'b c' d='e f'"), ["a", "b c", "d=e f"]);
    assert_eq!(split_words(" x  '' "), ["x", ""]);
}
