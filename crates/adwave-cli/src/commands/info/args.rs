//! The arguments of `adwave info`.

use crate::args::{GivenWalkArgs, LevelArgs, ShapeArgs, length};
use crate::resolve::shape::GivenLength;
use adwave::region::Length;
use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  adwave info scan.las
  adwave info scan.las --only classification=2 --only z=..120
  adwave info land.copc.laz --resolution 5        a coarse look at a large cloud
  adwave info bunny.obj --json | jq .health
  adwave info sample:creature --vertices 200000
  adwave info bunny.obj --detail                  loss of detail, level by level
  adwave info bunny.obj --error 0.1%              bands that can be dropped within that error")]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) walk: GivenWalkArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// Measure how much of the shape is lost if everything finer than each level is dropped
    #[arg(long, help_heading = "Detail")]
    pub(crate) detail: bool,
    /// Report how many of the fine bands can be dropped within this error, in model units or in % of the diagonal
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true, help_heading = "Detail")]
    pub(crate) error: Option<Length>,
}

impl InfoArgs {
    /// The lengths that are given, of levels and of an error.
    pub(super) fn given_lengths(&self) -> Vec<GivenLength> {
        let error = self.error.map(|length| GivenLength { option: "--error", length });
        self.levels.given_lengths().into_iter().chain(error).collect()
    }

    pub(super) fn needs_detail(&self) -> bool {
        self.detail || self.error.is_some()
    }
}
