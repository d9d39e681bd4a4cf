//! The flags that several commands have, each defined once. Those of one command stand with it.

mod analysis;
mod named;
mod shape;

pub(crate) use analysis::{BorderArgs, DetectArgs, FieldArgs, MapArgs, ResponseArg, signal_names};
pub(crate) use named::named;
pub(crate) use shape::{Kind, LevelArgs, ShapeArgs, any_length, at_least_one};

use clap::Args;
use std::num::NonZeroUsize;

/// Flags of every command.
#[derive(Debug, Args)]
pub(crate) struct GlobalArgs {
    /// Print one JSON object for machines in place of text for people
    #[arg(long, global = true, help_heading = "General")]
    pub(crate) json: bool,
    /// Print nothing but errors and, with --json, the result
    #[arg(long, short, global = true, help_heading = "General")]
    pub(crate) quiet: bool,
    /// Number of threads [default: one for each core]; the result does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = at_least_one, help_heading = "General")]
    pub(crate) threads: Option<NonZeroUsize>,
}
