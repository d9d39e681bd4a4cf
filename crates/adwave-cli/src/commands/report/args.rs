//! The arguments of `adwave report`.

use crate::args::{GivenWalkArgs, LevelArgs, ShapeArgs, SignalArgs};
use adwave_render::{Up, View};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
The page is self-contained and opens without a network. It shows what the shape consists of, its bands, smoothed shapes, the
saliency map, the features, the five presets, and the time of each part. Every table can be saved as CSV. A graph gets tables and
charts, and its default signal is the degree. Vertices where the signal is NaN are masked. An image is drawn flat, a volume by its
three middle slices.

Examples:
  adwave report bunny.obj -o bunny.html
  adwave report scan.laz -o scan.html --up z --view 20,30
  adwave report brain.ply -o thickness.html --signal thickness --levels 8
  adwave report pial.gii.gz -o folds.html --signal sulc.gii.gz --view left
  adwave report network.mtx -o network.html --signal degree
  adwave report volume.nii.gz -o volume.html --fwhm 4,8,16
  adwave report sample:creature -o creature.html --json | jq .bands")]
pub(crate) struct ReportArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// File for the page (.html)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) walk: GivenWalkArgs,
    #[command(flatten)]
    pub(crate) signal: SignalArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// View: front, back, left, right, top, bottom, three-quarter, or AZIMUTH,ELEVATION in degrees
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "Pictures"
    )]
    pub(crate) view: View,
    /// Axis of the shape that points up: x, y or z [default: z for LAS, LAZ, GIFTI, FreeSurfer and shapes as low and
    /// open as land, else y]
    #[arg(long, value_name = "AXIS", help_heading = "Pictures")]
    pub(crate) up: Option<Up>,
}
