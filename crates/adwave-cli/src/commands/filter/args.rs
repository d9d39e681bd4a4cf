//! The arguments of `adwave filter`.

use crate::args::{FieldArgs, LevelArgs, ShapeArgs, named};
use crate::region::{region, regions_help};
use adwave::filter::Preset;
use adwave::positions::{Borders, MoveDirection};
use adwave::region::Region;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = concat!(regions_help!(), "
Output by extension:
  a format of shapes   the shape with new positions, or with the field that --field names
  .npy                 the result alone, one row per vertex
  .csv .gii            of a field the result alone (a field of the shape's own file goes back into a file of that format)

Examples:
  adwave filter bust.obj -o smooth.obj --preset suppress
  adwave filter bust.obj -o edit.obj --gains 3,2,1,1,1,1 --region 'ball:vertex=120,radius=10%'
  adwave filter bust.obj -o half.ply --preset enhance --region 'half-space:point=0 0 0,normal=1 0 0'
  adwave filter lidar.laz -o smooth.laz --preset smooth --along z
  adwave filter brain.ply -o even.ply --field thickness --preset suppress
  adwave filter pial.gii.gz -o smooth.shape.gii --field thick.gii.gz --preset suppress
  adwave filter bust.obj -o edit.obj --recipe edit.toml"))]
pub(crate) struct FilterArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the result goes; the format is that of the extension (see below)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// A ready-made filter
    #[arg(long, value_enum, conflicts_with_all = ["gains", "recipe"], help_heading = "Edit")]
    pub(crate) preset: Option<PresetArg>,
    /// One gain a band, fine to coarse: 1 keeps it, 0 drops it
    #[arg(
        long,
        value_name = "G,G,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        conflicts_with = "recipe",
        help_heading = "Edit"
    )]
    pub(crate) gains: Option<Vec<f64>>,
    /// Where the gains apply; several are joined by "or" (see below; 'adwave region' shows them)
    #[arg(long, value_name = "REGION", value_parser = region, conflicts_with = "recipe", help_heading = "Edit")]
    pub(crate) region: Vec<Region>,
    /// Keep the volume of a closed mesh
    #[arg(long, value_name = "HOW", value_enum, num_args = 0..=1, default_missing_value = "offset", help_heading = "Edit")]
    pub(crate) keep_volume: Option<KeepVolumeArg>,
    /// In which directions vertices may move when coordinates are filtered [default: that of the recipe, else normal for a cloud and free
    /// for a mesh]
    #[arg(long, value_name = "KIND", value_enum, help_heading = "Edit")]
    pub(crate) along: Option<AlongArg>,
    /// What becomes of borders when coordinates are filtered [default: that of the recipe, else natural]
    #[arg(long, value_name = "KIND", value_enum, help_heading = "Edit")]
    pub(crate) border: Option<BordersArg>,
    /// Apply the layers of a recipe
    #[arg(long, value_name = "FILE.toml", help_heading = "Edit")]
    pub(crate) recipe: Option<PathBuf>,
    /// Save the edit as a recipe, its levels as widths
    #[arg(long, value_name = "FILE.toml", help_heading = "Edit")]
    pub(crate) save_recipe: Option<PathBuf>,
    /// Save levels as numbers of steps: the same bits on this shape, another size of detail on others
    #[arg(long, requires = "save_recipe", help_heading = "Edit")]
    pub(crate) save_steps: bool,
    /// Compute the normals that the file has anew; without this they are kept as they are
    #[arg(long)]
    pub(crate) update_normals: bool,
}

/// How volume is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum KeepVolumeArg {
    /// Exactly: by one offset along the normals of what moved
    Offset,
    /// Of a smoothing by n steps: 1 − (1 − Φⁿ)², by one level more
    Twice,
    /// Of a smoothing by n steps: 1 − (1 − Φⁿ)³, by two levels more
    Thrice,
}

/// `adwave::positions::Along` by its names here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AlongArg {
    /// Along the normals: samples stay where they are on the surface
    Normal,
    /// Within the surface: samples are evened out, the shape stays
    Surface,
    /// Along x
    X,
    /// Along y
    Y,
    /// Along z, as the heights of a terrain should
    Z,
    /// In all directions (the paper's): points of a cloud slide together where they are dense
    Free,
}

impl From<AlongArg> for MoveDirection {
    fn from(along: AlongArg) -> Self {
        match along {
            AlongArg::Normal => Self::Normal,
            AlongArg::Surface => Self::Surface,
            AlongArg::X => Self::X,
            AlongArg::Y => Self::Y,
            AlongArg::Z => Self::Z,
            AlongArg::Free => Self::Free,
        }
    }
}

named! {
    /// `adwave::positions::Borders` by its names here.
    BordersArg for Borders {
        /// What is flat stays, the outline is drawn neither in nor out
        Natural = Natural,
        /// The same, and the outline stays where it is
        Keep = Keep,
        /// As the bands have it: smoothing draws borders in (the paper's)
        Free = Free,
    }
}

/// `adwave::filter::Preset` by its names here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PresetArg {
    /// Smooth, and keep limbs and volume: 1 − (1 − Φⁿ)²; 'smooth' is the same
    #[value(alias = "smooth")]
    Suppress,
    /// Drop every band, as the paper has it: thin parts shrink
    SuppressPaper,
    /// Strengthen every band, fine ones most
    Enhance,
    /// Keep the fine bands, drop the middle ones
    Band1,
    /// Drop the fine bands, strengthen the middle ones
    Band2,
}

impl From<PresetArg> for Preset {
    fn from(preset: PresetArg) -> Self {
        match preset {
            PresetArg::Suppress => Self::Suppress,
            PresetArg::SuppressPaper => Self::SuppressPaper,
            PresetArg::Enhance => Self::Enhance,
            PresetArg::Band1 => Self::Band1,
            PresetArg::Band2 => Self::Band2,
        }
    }
}
