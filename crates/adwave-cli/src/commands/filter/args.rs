//! The arguments of `adwave filter`.

use crate::args::{
    GainRows, GivenWalkArgs, LabelArgs, LevelArgs, LocalFitArgs, NormalArgs, QuantityArgs, ShapeArgs,
    SignalArgs, TimeArgs, gain_rows, number, parse_named, region, regions_help, value_type,
};
use adwave::bands::Precision;
use adwave::filter::{KeepVolume, Preset};
use adwave::positions::{Borders, MoveDirection};
use adwave::region::Region;
use adwave_io::ValueType;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = concat!(regions_help!(), "
Output by extension:
  a format of shapes   the shape with new positions, or with the signal as a field
  .nii .tif .png …     the image or volume with new values, in the type of its file unless
                       --value-type says otherwise
  .npy                 the result alone, one row per vertex
  .csv .gii            a filtered field alone (a field of the shape's own file goes back into a
                       file of that format)

Examples:
  adwave filter bust.obj -o smooth.obj --preset suppress
  adwave filter bust.obj -o edit.obj --gains 3,2,1,1,1,1 --region 'ball:vertex=120,radius=10%'
  adwave filter bust.obj -o a.ply --preset enhance --region 'half-space:point=0 0 0,normal=1 0 0'
  adwave filter lidar.laz -o smooth.laz --preset smooth --along z --only classification=2
  adwave filter centerline.vtk -o smooth.vtk --preset smooth --lengths 1,2,4
  adwave filter brain.ply -o even.ply --signal thickness --preset suppress
  adwave filter land.laz -o even.laz --field classification --as-labels \\
    --preset suppress-paper --levels 3
  adwave filter volume.nii.gz -o smooth.nii.gz --fwhm 6 --preset suppress --only values=5..
  adwave filter dem.tif -o plain.tif --lengths 100 --gains 0 --value-type f32
  adwave filter bold.nii.gz -o smooth.nii.gz --fwhm 6 --preset suppress --time-fwhm 4s
  adwave filter bold.nii.gz -o slow.nii.gz --fwhm 6,12 --time-fwhm 4s --gains-by-time '0,0;1,1'
  adwave filter rest.dtseries.nii -o smooth.dtseries.nii --surface white_left.gii.gz \\
    --fwhm 6 --preset suppress
  adwave filter flow.ply -o calm.ply --signal wind --directions vectors \\
    --fwhm 5% --preset suppress
  adwave filter dti.nii.gz -o smooth.nii.gz --tensors fsl --fwhm 4 --preset suppress
  adwave filter pial.gii.gz -o smooth.shape.gii --signal thick.gii.gz --preset suppress \\
    --mask lh.cortex.label
  adwave filter bust.obj -o edit.obj --recipe edit.toml"))]
pub(crate) struct FilterArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// File for the result; its extension names the format (see above)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Type of the numbers of an image or a volume: u8, i16, u16, i32, f32, f64 and others [default: that of the file]
    #[arg(long, value_name = "TYPE", value_parser = value_type)]
    pub(crate) value_type: Option<ValueType>,
    #[command(flatten)]
    pub(crate) walk: GivenWalkArgs,
    #[command(flatten)]
    pub(crate) signal: SignalArgs,
    #[command(flatten)]
    pub(crate) quantity: QuantityArgs,
    #[command(flatten)]
    pub(crate) fit: LocalFitArgs,
    #[command(flatten)]
    pub(crate) labels: LabelArgs,
    /// Filter the share of each label of the field, and give each vertex the label with the largest share
    #[arg(long, conflicts_with_all = ["as_numbers", "local_fit"], help_heading = "Signal")]
    pub(crate) as_labels: bool,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// Number format of the bands: 32 bits take less time, with an error bound that is printed
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Precision>(), default_value_t, help_heading = "Levels")]
    pub(crate) precision: Precision,
    #[command(flatten)]
    pub(crate) edit: EditArgs,
    #[command(flatten)]
    pub(crate) time: TimeArgs,
    /// One gain per band along time, fine to coarse: 1 keeps the band, 0 drops it [default: 0 for each, which smooths]
    #[arg(
        long,
        value_name = "G,G,…",
        value_parser = number,
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Time"
    )]
    pub(crate) time_gains: Option<Vec<f64>>,
    /// Gains of the bands in space for each band along time, fine to coarse, and for the rest, as rows of --gains:
    /// '1,1;0,1;0,0' for two bands along time. --time-gains then multiply all of a band [default: 1 for each]
    #[arg(
        long,
        value_name = "G,…;G,…",
        value_parser = gain_rows,
        allow_hyphen_values = true,
        conflicts_with_all = ["gains", "preset", "recipe"],
        help_heading = "Time"
    )]
    pub(crate) gains_by_time: Option<GainRows>,
    #[command(flatten)]
    pub(crate) normals: NormalArgs,
}

/// The edit: what changes, where, and how positions follow.
#[derive(Debug, Args)]
#[command(next_help_heading = "Edit")]
pub(crate) struct EditArgs {
    /// Ready-made filter
    #[arg(long, value_parser = parse_named::<Preset>(), conflicts_with_all = ["gains", "recipe"])]
    pub(crate) preset: Option<Preset>,
    /// One gain per band, fine to coarse: 1 keeps the band, 0 drops it
    #[arg(
        long,
        value_name = "G,G,…",
        value_parser = number,
        value_delimiter = ',',
        allow_hyphen_values = true,
        conflicts_with = "recipe"
    )]
    pub(crate) gains: Option<Vec<f64>>,
    /// Region in which the gains apply; several are joined by "or" (see above; 'adwave region' shows them)
    #[arg(long, value_name = "REGION", value_parser = region, conflicts_with = "recipe")]
    pub(crate) region: Vec<Region>,
    /// Keep the volume of a closed mesh
    #[arg(long, value_name = "HOW", value_parser = parse_named::<KeepVolume>(), num_args = 0..=1, default_missing_value = "offset")]
    pub(crate) keep_volume: Option<KeepVolume>,
    /// Directions in which vertices may move when coordinates are filtered [default: as in the recipe, else normal for
    /// a cloud and free for a mesh or curve]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<MoveDirection>())]
    pub(crate) along: Option<MoveDirection>,
    /// Treatment of borders, and of the ends of a curve, when coordinates are filtered [default: as in the recipe, else
    /// natural]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Borders>())]
    pub(crate) border: Option<Borders>,
    /// Apply the layers of a recipe
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) recipe: Option<PathBuf>,
    /// Save the edit as a recipe, its levels as widths
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) save_recipe: Option<PathBuf>,
    /// Save levels as numbers of steps: the same bits on this shape, another size of detail on others
    #[arg(long, requires = "save_recipe")]
    pub(crate) save_steps: bool,
}
