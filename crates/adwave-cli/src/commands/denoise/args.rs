//! The arguments of `adwave denoise`.

use crate::args::{
    GivenWalkArgs, LabelArgs, LocalFitArgs, NormalArgs, QuantityArgs, ShapeArgs, SignalArgs, TimeAxisArgs,
    number, parse_named, region, shared_noise, value_type,
};
use adwave::denoise::{Creases, DenoiseParams, NoiseModel, Outliers, SharedNoise};
use adwave::positions::Borders;
use adwave::region::Region;
use adwave_io::ValueType;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
The noise level is estimated from the shape. The amount of smoothing, and whether creases are kept, minimize an estimate of the
error, so no option is needed.

Vertices of a mesh that impulses moved return to the planes around them, and noise that is strong or turns triangles over is first
reduced by a linear filter; the result says so.

Noise that neighbors share, as scanners make it, looks like detail of that size, so it stays; the result says how strong it may
be. If you know that a mesh has no such detail, --shared-noise auto removes it, or --shared-noise with its standard deviation.
No vertex moves farther than three times the noise found at its place, except those that impulses moved.

Points of a cloud move onto planes and quadrics fitted to their neighbors, by the noise found at their place and never farther than
three times that. Where a fit would do harm, and where points form lines, volumes or nothing, they stay; the result says how many.
Outliers are points far from the surface of their neighbors: --outliers keeps them, pulls them there or drops them. Normals of the
file tell sheets apart that are closer to each other than the points. A curve is smoothed along its pieces, by the noise
found along each axis: ends stay where they are, and corners stay sharp. Steps of a field (--signal) are kept, and --noise-model says how its noise depends on its values: counts have
poisson noise, speckle is multiplicative, and magnitudes of MRI are rician: their bias is removed too. Results have no bias from the transform of the values. The result goes into the shape under the field's name or that of its
column or file, or alone into a file of values.

Output by extension:
  a format of shapes   the shape with new positions, or with the signal as a field
  .nii .tif .png …     the image or volume with new values, in the type of its file unless
                       --value-type says otherwise
  .npy                 the result alone, one row per vertex
  .csv .gii            a denoised field alone (a field of the shape's own file goes back into a
                       file of that format)

--border keep leaves the outline of an open shape where it is, so that neighboring tiles of a terrain still fit. --region limits
the change to soft regions, in the words of 'adwave filter'; the noise is estimated from the whole shape.

Examples:
  adwave denoise scan.obj -o clean.obj
  adwave denoise tile.obj -o clean.obj --border keep
  adwave denoise lidar.laz -o clean.laz --only classification=2,9
  adwave denoise scan.obj -o clean.ply --noise-map
  adwave denoise scan.laz -o clean.laz --outliers drop
  adwave denoise volume.nii.gz -o clean.nii.gz
  adwave denoise bold.nii.gz -o clean.nii.gz --in-time
  adwave denoise flow.ply -o calm.ply --signal wind --directions vectors
  adwave denoise track.obj -o clean.obj
  adwave denoise bust.obj -o clean.obj --region 'ball:vertex=120,radius=10%'
  adwave denoise scan.ply -o soft.ply --strength 1.5 --creases none
  adwave denoise scan.ply -o clean.ply --shared-noise auto
  adwave denoise brain.ply -o even.ply --signal thickness
  adwave denoise white.gii -o even.shape.gii --signal thickness.gii
  adwave denoise brain.ply -o even.ply --signal gaze --noise-model poisson
  adwave denoise part.stl -o part-clean.stl --noise-sigma 0.02 --creases keep --json")]
pub(crate) struct DenoiseArgs {
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
    /// Factor on the noise level: 0 changes nothing, 2 removes noise twice as strong as estimated
    #[arg(long, value_name = "S", value_parser = number, default_value_t = DenoiseParams::default().strength, help_heading = "Noise")]
    pub(crate) strength: f64,
    /// Treatment of creases of the shape
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Creases>(), default_value_t, help_heading = "Noise")]
    pub(crate) creases: Creases,
    /// Treatment of the outliers of a cloud, far from the surface of their neighbors
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Outliers>(), default_value_t, help_heading = "Noise")]
    pub(crate) outliers: Outliers,
    /// Dependence of the noise of a field on its values
    #[arg(long, value_name = "MODEL", value_parser = parse_named::<NoiseModel>(), default_value_t, help_heading = "Noise")]
    pub(crate) noise_model: NoiseModel,
    /// Noise of a mesh that neighbors share, as scanners make it: detail (it stays), auto (as much as the mesh admits,
    /// detail of that size included) or its standard deviation along the normals in model units
    #[arg(long, value_name = "KIND", value_parser = shared_noise, default_value = "detail", help_heading = "Noise")]
    pub(crate) shared_noise: SharedNoise,
    /// Standard deviation of the noise along the normals in model units, or in the unit of the field; with
    /// --noise-model poisson that of a value of 1, with multiplicative relative to the value [default: estimated]
    #[arg(long, value_name = "SIGMA", value_parser = number, help_heading = "Noise")]
    pub(crate) noise_sigma: Option<f64>,
    /// Write the noise at each vertex, in model units, as the field "noise" too: no vertex moves farther than 3 times it
    #[arg(long, help_heading = "Noise")]
    pub(crate) noise_map: bool,
    /// Region in which noise is removed; several are joined by "or" ('adwave region' shows them) [default: everywhere]
    #[arg(long, value_name = "REGION", value_parser = region)]
    pub(crate) region: Vec<Region>,
    /// Treatment of the borders of an open shape [default: they are denoised like the rest]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Borders>())]
    pub(crate) border: Option<Borders>,
    #[command(flatten)]
    pub(crate) normals: NormalArgs,
    /// Remove noise in space and time together, from a field whose channels are frames
    #[arg(long, help_heading = "Time")]
    pub(crate) in_time: bool,
    #[command(flatten)]
    pub(crate) time: TimeAxisArgs,
}

impl DenoiseArgs {
    pub(crate) fn to_params(&self) -> DenoiseParams {
        let params = DenoiseParams::default().with_strength(self.strength).with_creases(self.creases);
        let params = params
            .with_outliers(self.outliers)
            .with_noise_model(self.noise_model)
            .with_shared(self.shared_noise);
        let params = params.with_local_fit(self.fit.local_fit.unwrap_or(params.local_fit));
        self.noise_sigma.map_or(params, |noise| params.with_noise(noise))
    }
}
