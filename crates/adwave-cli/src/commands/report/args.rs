//! The arguments of `adwave report`.

use crate::args::{FieldArgs, LevelArgs, ShapeArgs};
use adwave_render::{Up, View};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
The page holds its pictures and tables and opens from a disk without a network: what the shape is made of, its bands,
smoothed shapes, the saliency map, the features, the four presets, and what each took. Every table can be saved as CSV.
A graph gets tables and charts, and its degree is split where nothing else is said. Where the signal is NaN, vertices are masked.

Examples:
  adwave report bunny.obj -o bunny.html
  adwave report scan.laz -o scan.html --up z --view 20,30
  adwave report brain.ply -o thickness.html --field thickness --levels 8
  adwave report pial.gii.gz -o folds.html --field sulc.gii.gz --view left
  adwave report network.mtx -o network.html --field degree
  adwave report sample:creature -o creature.html --json | jq .bands")]
pub(crate) struct ReportArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the page goes (.html)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// front, back, left, right, top, bottom, three-quarter, or AZIMUTH,ELEVATION in degrees
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "Pictures"
    )]
    pub(crate) view: View,
    /// Which axis of the shape points up: x, y or z [default: z of LAS, LAZ, GIFTI and what is as low and open as land, else y]
    #[arg(long, value_name = "AXIS", help_heading = "Pictures")]
    pub(crate) up: Option<Up>,
}
