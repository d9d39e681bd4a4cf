//! `adwave completions` and `adwave man`, from the definitions of the flags; `adwave notices`.

use crate::error::CliError;
use clap::Args;
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// Shell
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Folder for one page per command; without it the main page is printed
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
}

pub(crate) fn completions(args: &CompletionsArgs, mut command: clap::Command) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "adwave", &mut script);
    print(&script)
}

pub(crate) fn man(args: &ManArgs, command: clap::Command) -> Result<(), CliError> {
    let Some(folder) = &args.output else {
        let mut page = Vec::new();
        clap_mangen::Man::new(command).render(&mut page).map_err(CliError::input)?;
        return print(&page);
    };
    clap_mangen::generate_to(command, folder).map_err(|e| {
        CliError::Environment(format!("cannot write the manual pages to {}: {e}", folder.display()))
    })
}

pub(crate) fn notices() -> Result<(), CliError> {
    print(include_bytes!("../../THIRD-PARTY-NOTICES.txt"))
}

fn print(bytes: &[u8]) -> Result<(), CliError> {
    std::io::stdout().write_all(bytes).map_err(|e| match e.kind() {
        std::io::ErrorKind::BrokenPipe => CliError::ClosedPipe,
        _ => CliError::Environment(format!("cannot write to the standard output: {e}")),
    })
}
