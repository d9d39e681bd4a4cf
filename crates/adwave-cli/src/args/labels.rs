//! Fields of labels.

use clap::Args;

/// Treatment of a field whose name and values are those of labels.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct LabelArgs {
    /// Take a field of integers for numbers although its name is one of labels, such as 'classification'
    #[arg(long, help_heading = "Signal")]
    pub(crate) as_numbers: bool,
}
