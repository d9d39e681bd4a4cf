//! The command `adwave`: wavelets for shapes.
//!
//! Glue only: what is computed stands in the crate `adwave`, what is read and written in `adwave-io`.

mod analysis;
mod analysis_args;
mod args;
mod commands;
mod error;
mod interrupt;
mod output;
mod progress;
mod render_args;
mod report_args;
mod shape_input;
mod signal;
mod stopwatch;

use args::{Cli, Command};
use clap::Parser;
use error::CliError;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let outcome = prepare(&cli).and_then(|()| match &cli.command {
        Command::Info(args) => commands::info::run(args, &cli.global),
        Command::Transform(args) => commands::transform::run(args, &cli.global),
        Command::Filter(args) => commands::filter::run(args, &cli.global),
        Command::Saliency(args) => commands::saliency::run(args, &cli.global),
        Command::Features(args) => commands::features::run(args, &cli.global),
        Command::Evaluate(args) => commands::evaluate::run(args, &cli.global),
        Command::Compare(args) => commands::compare::run(args, &cli.global),
        Command::Basis(args) => commands::basis::run(args, &cli.global),
        Command::Render(args) => commands::render::run(args, &cli.global),
        Command::Report(args) => commands::report::run(args, &cli.global),
        Command::Sample(args) => commands::sample::run(args, &cli.global),
        Command::Demo(args) => commands::demo::run(args, &cli.global),
        Command::Reproduce(args) => commands::reproduce::run(args, &cli.global),
        Command::Completions(args) => commands::shell::completions(args),
        Command::Man(args) => commands::shell::man(args),
    });
    match outcome {
        // With `adwave … | head` the reader has seen what it wanted.
        Ok(()) | Err(CliError::ClosedPipe) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("adwave: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// Sets what is global to the run: threads and the answer to Ctrl-C.
fn prepare(cli: &Cli) -> Result<(), CliError> {
    interrupt::install();
    if let Some(threads) = cli.global.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build_global()
            .map_err(|e| CliError::Environment(format!("cannot start {threads} threads: {e}")))?;
    }
    Ok(())
}
