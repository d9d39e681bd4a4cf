//! The local fit of a smoothed field.

use super::parse::parse_named;
use adwave::local_fit::LocalFit;
use clap::Args;

/// The local fit of a smoothed field.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct LocalFitArgs {
    /// Fit by which fields, and heights that move along x, y or z, are smoothed [default: linear]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<LocalFit>(), help_heading = "Signal")]
    pub(crate) local_fit: Option<LocalFit>,
}
