//! The command `adwave` as a function: [`run`] takes the words of a command line and gives an exit code.
//!
//! Glue only: what is computed stands in the crate `adwave`, what is read and written in `adwave-io`. A program that wants
//! results rather than files and text calls those crates. This one prints to the standard output and the standard error, but
//! it neither ends the process nor installs a signal handler or a thread pool for the whole of it.

mod analysis;
mod args;
mod cli;
mod commands;
mod error;
mod field_file;
mod global;
mod movement;
mod output;
mod progress;
mod provenance;
mod region;
mod shape_input;
mod signal;
mod stopwatch;
mod up;

use clap::FromArgMatches;
use cli::{Cli, Command};
use error::CliError;
use global::Global;
use provenance::Inputs;
use std::ffi::OsString;
use std::sync::atomic::AtomicBool;

/// Runs one command line, the program's name first, and gives its exit code: 0 done, 1 the machine failed, 2 bad usage or
/// input, 130 stopped because `cancel` became true.
///
/// A file that the command replaces is replaced as a whole or not at all. With `--threads N` the command runs in a pool of its
/// own; without, in the caller's.
///
/// ```
/// use std::sync::atomic::AtomicBool;
/// let never = AtomicBool::new(false);
/// assert_eq!(adwave_cli::run(["adwave", "info", "sample:sphere", "--quiet"], &never), 0);
/// assert_eq!(adwave_cli::run(["adwave", "info", "sample:teapot"], &never), 2);
/// ```
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString>>, cancel: &AtomicBool) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let parsed =
        cli::command().try_get_matches_from(&arguments).and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(error) => {
            let error = cli::with_fitting_tips(error);
            // Help and the version come as errors that succeed; where they cannot be printed nothing else can be either.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(1);
        }
    };
    let inputs = Inputs::new(cli.global.provenance);
    let global = Global::new(&cli.global, &arguments, &inputs, cancel);
    let outcome = match cli.global.threads {
        None => start_threads().and_then(|()| all_or_none(&cli.command, &global)),
        Some(asked) => {
            let threads = started(asked.get(), &global);
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map_err(|e| CliError::Environment(format!("cannot start {threads} threads: {e}")))
                .and_then(|pool| pool.install(|| all_or_none(&cli.command, &global)))
        }
    };
    // Who stops a run may take its temporary files away at once; the write that fails then is part of the stop.
    let outcome = match outcome {
        Err(CliError::Environment(_)) if global.progress().is_cancelled() => Err(CliError::Cancelled),
        outcome => outcome,
    };
    match outcome {
        // With `adwave … | head` the reader has seen what it wanted.
        Ok(()) | Err(CliError::ClosedPipe) => 0,
        Err(error) => {
            eprintln!("adwave: {error}");
            error.exit_code()
        }
    }
}

/// Starts the threads that all work shares, unless this runs in threads of somebody else or they have been started. What
/// first needed them would panic where the system refuses them.
fn start_threads() -> Result<(), CliError> {
    if rayon::current_thread_index().is_some() {
        return Ok(());
    }
    match rayon::ThreadPoolBuilder::new().build_global() {
        Err(error) if std::error::Error::source(&error).is_some() => {
            Err(CliError::Environment(format!("cannot start threads: {error}; try --threads 1")))
        }
        _ => Ok(()),
    }
}

/// Threads that a core gets at the most: more only wait for each other.
const THREADS_A_CORE: usize = 4;

/// How many threads are started where so many are asked for.
fn started(asked: usize, global: &Global<'_>) -> usize {
    let most = THREADS_A_CORE * std::thread::available_parallelism().map_or(1, Into::into);
    if asked > most {
        output::note(
            global,
            &format!("{asked} threads are more than {THREADS_A_CORE} a core; {most} are started"),
        );
    }
    asked.min(most)
}

/// The command; the files of its result take their places together. Those of `reproduce` stand each for itself after minutes
/// of work, `studio` writes as long as it runs, and tiles are what a later run goes on from.
fn all_or_none(command: &Command, global: &Global<'_>) -> Result<(), CliError> {
    if matches!(command, Command::Studio(_) | Command::Reproduce(_) | Command::Tiles(_) | Command::Tile(_)) {
        return dispatch(command, global);
    }
    adwave_io::write_together(|| match dispatch(command, global) {
        // Whoever reads the standard output has seen enough of it; the files are wanted.
        Err(CliError::ClosedPipe) => Ok(()),
        // Whoever stops it while the last file is written wants none of them.
        Ok(()) if global.progress().is_cancelled() => Err(CliError::Cancelled),
        outcome => outcome,
    })
}

fn dispatch(command: &Command, global: &Global<'_>) -> Result<(), CliError> {
    match command {
        Command::Info(args) => commands::info::run(args, global),
        Command::Transform(args) => commands::transform::run(args, global),
        Command::Filter(args) => commands::filter::run(args, global),
        Command::Denoise(args) => commands::denoise::run(args, global),
        Command::Simplify(args) => commands::simplify::run(args, global),
        Command::Saliency(args) => commands::saliency::run(args, global),
        Command::Features(args) => commands::features::run(args, global),
        Command::Match(args) => commands::matching::run(args, global),
        Command::Diff(args) => commands::diff::run(args, global),
        Command::Evaluate(args) => commands::evaluate::run(args, global),
        Command::Compare(args) => commands::compare::run(args, global),
        Command::Basis(args) => commands::basis::run(args, global),
        Command::Render(args) => commands::render::run(args, global),
        Command::Region(args) => commands::region::run(args, global),
        Command::Report(args) => commands::report::run(args, global),
        Command::Studio(args) => commands::studio::run(args, global),
        Command::Tiles(args) => commands::tiles::run(args, global),
        Command::Tile(args) => commands::tiles::run_tile(args, global),
        Command::Convert(args) => commands::convert::run(args, global),
        Command::Formats(args) => commands::formats::run(args, global),
        Command::Sample(args) => commands::sample::run(args, global),
        Command::Demo(args) => commands::demo::run(args, global),
        Command::Reproduce(args) => commands::reproduce::run(args, global),
        Command::Completions(args) => commands::shell::completions(args),
        Command::Man(args) => commands::shell::man(args),
    }
}
