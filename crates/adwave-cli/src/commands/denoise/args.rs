//! The arguments of `adwave denoise`.

use crate::args::{FieldArgs, ShapeArgs, named};
use adwave::denoise::{Creases, DenoiseParams};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
The noise is estimated from the shape, and how much is smoothed, and whether creases stay, by an estimate of the risk;
no option is needed. Of clouds the points move along their normals. Noise that neighbors share is not told from detail.
Of a field (--field) steps stay; it goes into the shape by its name, by that of its column or file, or alone into a file of values.

Output by extension:
  a format of shapes   the shape with new positions, or with the field
  .npy                 the result alone, one row per vertex
  .csv .gii            of a field the result alone (a field of the shape's own file goes back into a file of that format)

Examples:
  adwave denoise scan.obj -o clean.obj
  adwave denoise scan.ply -o soft.ply --strength 1.5 --creases none
  adwave denoise brain.ply -o even.ply --field thickness
  adwave denoise white.gii -o even.shape.gii --field thickness.gii
  adwave denoise part.stl -o part-clean.stl --noise-sigma 0.02 --creases keep --json")]
pub(crate) struct DenoiseArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the result goes; the format is that of the extension (see below)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    /// By how much the noise counts: 0 changes nothing, 2 takes it for twice as large
    #[arg(long, value_name = "S", default_value_t = DenoiseParams::default().strength, help_heading = "Noise")]
    pub(crate) strength: f64,
    /// What becomes of creases of the shape
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Noise")]
    pub(crate) creases: CreasesArg,
    /// Standard deviation of the noise along the normals in model units, or in the unit of the field [default: estimated]
    #[arg(long, value_name = "SIGMA", help_heading = "Noise")]
    pub(crate) noise_sigma: Option<f64>,
    /// Compute the normals that the file has anew; without this they are kept as they are
    #[arg(long)]
    pub(crate) update_normals: bool,
}

named! {
    /// `adwave::denoise::Creases` by its names here.
    CreasesArg for Creases {
        /// What the estimated risk prefers
        Auto = Auto,
        /// They stay sharp
        Keep = Keep,
        /// They are smoothed like all else
        None = None,
    }
}

impl DenoiseArgs {
    /// What is asked of the denoiser.
    pub(crate) fn params(&self) -> DenoiseParams {
        let params = DenoiseParams::default().with_strength(self.strength).with_creases(self.creases.into());
        self.noise_sigma.map_or(params, |noise| params.with_noise(noise))
    }
}
