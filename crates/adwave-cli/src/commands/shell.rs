//! `adwave completions` and `adwave man`: made from the flags' definitions.

use crate::args::{Cli, CompletionsArgs, ManArgs};
use crate::error::CliError;
use clap::CommandFactory;
use std::io::Write;

pub(crate) fn completions(args: &CompletionsArgs) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "adwave", &mut script);
    print(&script)
}

pub(crate) fn man(args: &ManArgs) -> Result<(), CliError> {
    let Some(folder) = &args.output else {
        let mut page = Vec::new();
        clap_mangen::Man::new(Cli::command()).render(&mut page).map_err(CliError::input)?;
        return print(&page);
    };
    clap_mangen::generate_to(Cli::command(), folder)
        .map_err(|e| CliError::Environment(format!("cannot write the pages to {}: {e}", folder.display())))
}

fn print(bytes: &[u8]) -> Result<(), CliError> {
    std::io::stdout().write_all(bytes).map_err(|e| match e.kind() {
        std::io::ErrorKind::BrokenPipe => CliError::ClosedPipe,
        _ => CliError::Environment(format!("cannot write to the standard output: {e}")),
    })
}
