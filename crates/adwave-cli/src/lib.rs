//! The command `adwave` as a function: [`run`] takes the words of a command line and returns an exit code.
//!
//! A command resolves its flags, computes and writes. The method is in the crate `adwave`, files are read and written
//! by `adwave-io`; a program that needs results instead of files and text calls those crates. This crate prints to the
//! standard output and the standard error. It neither ends the process, nor installs signal handlers, nor tunes the
//! allocator.

mod args;
mod cli;
mod commands;
mod error;
mod given;
mod global;
mod inputs;
mod output;
mod resolve;

use adwave_io::Transaction;
use clap::FromArgMatches;
use cli::{Cli, Command};
use error::CliError;
use given::GivenOptions;
use global::{Global, RunContext};
pub use global::{HeapUse, OwnDomain, Program};
use inputs::Inputs;
use std::ffi::OsString;
use std::sync::atomic::{AtomicBool, Ordering};

/// Definition of the command line, from which help, completions and the manual pages are made.
pub fn definition() -> clap::Command {
    let mut definition = cli::command();
    definition.build();
    definition
}

/// Runs one command line, the program's name first, and returns its exit code: 0 done, 1 the machine failed, 2 bad
/// usage or input, 130 stopped because `cancel` became true.
///
/// Files that the command replaces are replaced as a whole or not at all. With `--threads N` the command runs in a
/// thread pool of its own; without, in that of the caller.
///
/// ```
/// use std::sync::atomic::AtomicBool;
/// let never = AtomicBool::new(false);
/// assert_eq!(adwave_cli::run(["adwave", "info", "sample:sphere", "--quiet"], &never), 0);
/// assert_eq!(adwave_cli::run(["adwave", "info", "sample:teapot"], &never), 2);
/// ```
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString>>, cancel: &AtomicBool) -> u8 {
    run_for(Program::default(), arguments, cancel)
}

/// [`run`] for a program that tunes its heap or has domains of its own.
pub fn run_for(
    program: Program<'_>,
    arguments: impl IntoIterator<Item = impl Into<OsString>>,
    cancel: &AtomicBool,
) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let definition = cli::command();
    let parsed = definition
        .clone()
        .try_get_matches_from(&arguments)
        .and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, GivenOptions::new(&matches, &definition))));
    let (cli, given) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => {
            let error = cli::improve_tips(error);
            // Help and the version are errors that succeed; if they cannot be printed nothing else can be either.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(1);
        }
    };
    let inputs = Inputs::new(cli.global.provenance);
    let files = transaction(&cli.command);
    let context =
        RunContext { arguments: &arguments, given: &given, inputs: &inputs, files: &files, cancel, program };
    let global = Global::new(&cli.global, context);
    global.tune_heap(heap_use(&cli.command));
    let outcome = given.check().and_then(|()| run_in_threads(&cli, &global));
    let outcome = outcome.and_then(|()| Ok(files.commit()?));
    // Ctrl-C may remove the temporary files at once; a write that fails because of that is part of the stop.
    let outcome = match outcome {
        Err(CliError::Environment(_)) if cancel.load(Ordering::Relaxed) => Err(CliError::Cancelled),
        outcome => outcome,
    };
    match outcome {
        // With `adwave … | head` the reader has seen what it wanted.
        Ok(()) | Err(CliError::ClosedPipe) => 0,
        Err(error) => {
            let text = inputs.in_row_words(&error.to_string());
            output::tell(&format!("adwave: {}", output::plain_text(&text)));
            error.exit_code()
        }
    }
}

/// Runs a command in a thread pool of its own if `--threads` is given, else in that of the caller.
fn run_in_threads(cli: &Cli, global: &Global<'_>) -> Result<(), CliError> {
    let Some(asked) = cli.global.threads else {
        start_global_pool()?;
        return finish(dispatch(&cli.command, global), &cli.command, global);
    };
    let n_threads = limit_threads(asked.get(), global);
    rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build()
        .map_err(|e| CliError::Environment(format!("cannot start {n_threads} threads: {e}")))
        .and_then(|pool| pool.install(|| finish(dispatch(&cli.command, global), &cli.command, global)))
}

/// Starts the threads that all work shares, unless this runs in threads of the caller or they have been started. Their
/// first use would panic if the system refuses them.
fn start_global_pool() -> Result<(), CliError> {
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

/// Most threads per core: more only wait for each other.
const THREADS_PER_CORE: usize = 4;

/// The number of threads to start if `asked` are asked for.
fn limit_threads(asked: usize, global: &Global<'_>) -> usize {
    let most = THREADS_PER_CORE * std::thread::available_parallelism().map_or(1, Into::into);
    if asked > most {
        output::note(
            global,
            &format!("starting {most} threads, {THREADS_PER_CORE} per core, instead of {asked}"),
        );
    }
    asked.min(most)
}

/// True if all files of a result replace older ones together. The files of `reproduce` stand on their own after minutes
/// of work, `studio` writes as long as it runs, and a later run of `tiles` continues from the tiles of an earlier one.
fn is_one_result(command: &Command) -> bool {
    !matches!(command, Command::Studio(_) | Command::Reproduce(_) | Command::Tiles(_) | Command::Tile(_))
}

fn transaction(command: &Command) -> Transaction {
    if is_one_result(command) { Transaction::new() } else { Transaction::immediate() }
}

/// Outcome that decides whether the files of the result stay: a closed standard output does not undo them, but a stop
/// while the last one is written does.
fn finish(outcome: Result<(), CliError>, command: &Command, global: &Global<'_>) -> Result<(), CliError> {
    match outcome {
        outcome if !is_one_result(command) => outcome,
        Err(CliError::ClosedPipe) => Ok(()),
        Ok(()) if global.progress().is_cancelled() => Err(CliError::Cancelled),
        outcome => outcome,
    }
}

/// The use that a command makes of the heap; some commands refine it when they know their input.
fn heap_use(command: &Command) -> HeapUse {
    match command {
        Command::Denoise(_)
        | Command::Features(_)
        | Command::Filter(_)
        | Command::Match(_)
        | Command::Saliency(_) => HeapUse::ReuseVectors,
        _ => HeapUse::ReturnVectors,
    }
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
        Command::Impute(args) => commands::impute::run(args, global),
        Command::Scatter(args) => commands::scatter::run(args, global),
        Command::Render(args) => commands::render::run(args, global),
        Command::Deform(args) => commands::deform::run(args, global),
        Command::Rebase(args) => commands::rebase::run(args, global),
        Command::Transfer(args) => commands::transfer::run(args, global),
        Command::Resample(args) => commands::resample::run(args, global),
        Command::Morph(args) => commands::morph::run(args, global),
        Command::Animate(args) => commands::animate::run(args, global),
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
        Command::Completions(args) => commands::shell::completions(args, cli::command(), global),
        Command::Man(args) => commands::shell::man(args, cli::command(), global),
        Command::Notices => commands::shell::notices(global),
    }
}
