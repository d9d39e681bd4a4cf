//! `adwave completions` and `adwave man`, from the definitions of the flags; `adwave notices`.

use crate::error::CliError;
use crate::global::Global;
use crate::output::{count, make_folder, print, print_bytes};
use clap::Args;
use serde_json::json;
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

pub(crate) fn completions(
    args: &CompletionsArgs,
    mut command: clap::Command,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "adwave", &mut script);
    let json = json!({"shell": args.shell.to_string(), "script": String::from_utf8_lossy(&script)});
    print_bytes(global, &script, &json)
}

pub(crate) fn man(args: &ManArgs, command: clap::Command, global: &Global<'_>) -> Result<(), CliError> {
    let Some(folder) = &args.output else {
        let mut page = Vec::new();
        clap_mangen::Man::new(command).render(&mut page).map_err(CliError::input)?;
        return print_bytes(global, &page, &json!({"page": String::from_utf8_lossy(&page)}));
    };
    make_folder(folder)?;
    let n_pages = 1 + command.get_subcommands().filter(|command| !command.is_hide_set()).count();
    clap_mangen::generate_to(command, folder).map_err(|e| {
        CliError::Environment(format!("cannot write the manual pages to {}: {e}", folder.display()))
    })?;
    let output = folder.display().to_string();
    let text = format!("{} in {output}\n", count(n_pages, "manual page", "manual pages"));
    print(global, &text, &json!({"output": output, "pages": n_pages}))
}

pub(crate) fn notices(global: &Global<'_>) -> Result<(), CliError> {
    let notices = include_str!("../../THIRD-PARTY-NOTICES.txt");
    print_bytes(global, notices.as_bytes(), &json!({"notices": notices}))
}
