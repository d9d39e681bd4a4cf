//! `adwave formats`: the table of formats.

use crate::error::CliError;
use crate::global::Global;
use crate::output::print;
use adwave_io::Format;
use clap::Args;
use comfy_table::{ContentArrangement, Table, presets};
use serde_json::{Value, json};

#[derive(Debug, Args)]
#[command(after_help = "\
The content of a file decides its format; its name counts only if the content leaves that open. Files that are read may be
compressed by gzip (.gz). A shape that is written in the format that it was read from keeps what the third column names; for another
format a note lists what it cannot store.

Examples:
  adwave formats
  adwave formats --json
  adwave formats --markdown                     the list of docs/FORMATS.md")]
pub(crate) struct FormatsArgs {
    /// Print a table in Markdown
    #[arg(long, conflicts_with = "json")]
    pub(crate) markdown: bool,
}

pub(crate) fn run(args: &FormatsArgs, global: &Global<'_>) -> Result<(), CliError> {
    let text = if args.markdown { Format::markdown_list() } else { terminal_table() };
    let rows: Vec<Value> = Format::all()
        .map(|f| {
            json!({
                "name": f.name(),
                "title": f.title(),
                "extensions": f.endings(),
                "reads": f.reads(),
                "writes": f.writes(),
                "keeps": f.keeps(),
                "loses": f.loses(),
            })
        })
        .collect();
    print(global, &text, &json!({"formats": rows}))
}

fn terminal_table() -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_content_arrangement(ContentArrangement::Dynamic).set_header([
        "format",
        "extensions",
        "reads",
        "writes",
        "keeps of its own file",
        "cannot store",
    ]);
    if table.width().is_none() {
        table.set_width(160);
    }
    for format in Format::all() {
        let endings = format.endings().join(" ");
        let cell = |text: &str| if text.is_empty() { "–".to_owned() } else { text.to_owned() };
        table.add_row([
            format.name().to_owned(),
            cell(&endings),
            cell(format.reads()),
            cell(format.writes()),
            cell(format.keeps()),
            cell(format.loses()),
        ]);
    }
    table.lines().fold(String::new(), |text, line| text + line.trim_end() + "\n")
}
