//! The arguments of `adwave animate`.

use crate::args::{LevelArgs, TimeArgs, file_name, number};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
FRAMES are a folder, a pattern such as 'walk/*.obj', a GLB or glTF with morph targets, or a mesh whose positions over
time are in --positions. All frames have the same vertices and faces. Files are taken in the order of the numbers in
their names.

What is asked for is done in this order: --still, --denoise, bands along time, bands in space.

Output by extension:
  a folder         a file for each frame, with the names of the frames that were read
  a pattern        a file for each frame: 'out/*.ply' gives out/0001.ply and so on
  .glb             one file with a morph target for each frame, which plays
  .npy             positions alone: vertices × 3 × frames

Examples:
  adwave animate 'walk/*.obj' -o clean --denoise --time-step 40ms
  adwave animate walk -o soft --time-fwhm 0.2 --time-step 40ms
  adwave animate walk -o 'lively/*.ply' --fwhm 5% --gains 1,1.5     large motion exaggerated
  adwave animate walk -o walk.glb --still --motion motion.ply   and a map of what moves
  adwave animate bust.obj --positions moves.npy -o calm.npy --time-fwhm 3")]
pub(crate) struct AnimateArgs {
    /// Frames (see above)
    #[arg(value_name = "FRAMES", value_parser = file_name())]
    pub(crate) frames: String,
    /// Positions over time of the mesh FRAMES, vertices × 3 × frames
    #[arg(long, value_name = "FILE.npy", help_heading = "Frames")]
    pub(crate) positions: Option<PathBuf>,
    /// Name of the animation in a glTF [default: the first one with morph targets]
    #[arg(long, value_name = "NAME", help_heading = "Frames")]
    pub(crate) animation: Option<String>,
    /// Result: a folder, a pattern, or a file (see above)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Take the motion of the whole out: each frame is turned and moved onto the mean of all, by least squares
    #[arg(long, help_heading = "Edit")]
    pub(crate) still: bool,
    /// Remove jitter: noise that differs between vertices and frames, whose amount is estimated
    #[arg(long, help_heading = "Edit")]
    pub(crate) denoise: bool,
    /// Factor on the noise of --denoise: below 1 more careful, above 1 more thorough [default: 1]
    #[arg(long, value_name = "S", value_parser = number, requires = "denoise", help_heading = "Edit")]
    pub(crate) strength: Option<f64>,
    /// One gain for each band of the motion in space, fine to coarse: of how far each vertex is from its mean over all
    /// frames. The mean shape stays
    #[arg(
        long,
        value_name = "G,G,…",
        value_parser = number,
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Edit"
    )]
    pub(crate) gains: Option<Vec<f64>>,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) time: TimeArgs,
    /// A gain for each band along time, fast to slow; 0 drops a band [default: 0 for each, which smooths]
    #[arg(
        long,
        value_name = "G,G,…",
        value_parser = number,
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Time"
    )]
    pub(crate) time_gains: Option<Vec<f64>>,
    /// Map of the motion: the mean shape with fields motion_1, motion_2, … and motion_rest, the root mean square over time
    /// of each band in space of the result
    #[arg(long, value_name = "OUT", help_heading = "Edit")]
    pub(crate) motion: Option<PathBuf>,
}
