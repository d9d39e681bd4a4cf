//! The arguments of `adwave render`.

use super::framing::FramingArgs;
use crate::args::{
    CloudPartArgs, SelectionArgs, count, file_name, number, parse_named, region, signal_names,
};
use adwave::directions::Symmetry;
use adwave::region::Region;
use adwave_io::ShapeKind;
use adwave_render::{RenderParams, Up, View};
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
#[derive(Debug, Args)]
#[command(after_help = "\
Without --color a shape has the colors of its file, a map of the sky or the earth its first field, else a single
color. A field with both signs gets a diverging map with 0 in the middle, other fields viridis, from the 1st to the 99th
percentile; NaN is gray. The front view looks from +z with y up, or with --up z from -y. A curve is drawn as round lines, an image flat and in gray, a volume as its three middle slices. --region shows the weights that 'adwave filter' would use; its help explains how regions are written.

Examples:
  adwave render bunny.obj -o bunny.png
  adwave render bunny.obj -o curvature.png --color mean-curvature --view 30,15
  adwave features bunny.obj -o features.csv && \\
    adwave render bunny.obj -o features.png --features features.csv
  adwave saliency bunny.obj -o map.ply && \\
    adwave render map.ply -o map.png --color saliency --color-map turbo
  adwave render scan.las -o plan.png --view top --orthographic
  adwave render flow.ply -o wind.png --glyphs wind
  adwave render bunny.obj -o ear.png --focus vertex=120 --zoom 6
  adwave render bunny.obj -o region.png --region 'ball:vertex=120,radius=10%'
  adwave render scan.las -o ground.png --only classification=2
  adwave render dem.tif -o hills.png --relief 2 --view 20,50
  adwave render before.obj after.obj -o sheet.png --grid
  adwave render pial.gii.gz -o folds.png --color sulc.gii.gz --color mean-curvature \\
    --grid --view left")]
pub(crate) struct RenderArgs {
    /// Files, '-', or sample:NAME; several with --grid
    #[arg(value_name = "SHAPE", required = true, value_parser = file_name())]
    pub(crate) shapes: Vec<String>,
    #[command(flatten)]
    pub(crate) part: CloudPartArgs,
    #[command(flatten)]
    pub(crate) selection: SelectionArgs,
    /// File for the picture (.png)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[arg(
        long,
        value_name = "FIELD",
        help = concat!("Signal that the colors show: ", signal_names!(), "; 'plain' for a single color. Several with --grid"),
        help_heading = "Colors"
    )]
    pub(crate) color: Vec<String>,
    /// Show the weights of a region instead of a signal; several are joined by "or"
    #[arg(long, value_name = "REGION", value_parser = region, conflicts_with = "color", help_heading = "Colors")]
    pub(crate) region: Vec<Region>,
    /// Color map: viridis, magma, inferno, plasma, cividis, turbo, cool, warm, gray, coolwarm, red-blue or spectral
    #[arg(long = "color-map", visible_alias = "colormap", value_name = "NAME", help_heading = "Colors")]
    pub(crate) color_map: Option<String>,
    /// Values of the first and last color: auto, or LOW,HIGH
    #[arg(
        long,
        value_name = "RANGE",
        default_value = "auto",
        allow_hyphen_values = true,
        help_heading = "Colors"
    )]
    pub(crate) range: RangeArg,
    /// Draw an image as a relief: heights are its values times this factor, in the unit of its spacing
    #[arg(long, value_name = "FACTOR", value_parser = number, allow_hyphen_values = true, num_args = 0..=1, default_missing_value = "1", help_heading = "Picture")]
    pub(crate) relief: Option<f64>,
    /// Leave out the color bar
    #[arg(long, help_heading = "Colors")]
    pub(crate) no_bar: bool,
    /// Show the features in a .csv or .json of 'adwave features', as balls of their size
    #[arg(long, value_name = "FILE", help_heading = "Features")]
    pub(crate) features: Option<PathBuf>,
    /// Draw the vectors of this signal as cones along them, at vertices about equally far from each other
    #[arg(long, value_name = "FIELD", help_heading = "Features")]
    pub(crate) glyphs: Option<String>,
    /// Draw cones (vectors), lines or crosses
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Symmetry>(), requires = "glyphs", help_heading = "Features")]
    pub(crate) glyph_kind: Option<Symmetry>,
    /// View: front, back, left, right, top, bottom, three-quarter, or AZIMUTH,ELEVATION in degrees
    #[arg(
        long,
        value_name = "VIEW",
        default_value = "three-quarter",
        allow_hyphen_values = true,
        help_heading = "Picture"
    )]
    pub(crate) view: View,
    /// Axis of the shape that points up: x, y or z [default: z for LAS, LAZ, GIFTI, FreeSurfer and shapes as low and
    /// open as land, else y]
    #[arg(long, value_name = "AXIS", help_heading = "Picture")]
    pub(crate) up: Option<Up>,
    #[command(flatten)]
    pub(crate) framing: FramingArgs,
    /// Orthographic instead of mildly perspective projection: lengths can be measured in the picture
    #[arg(long, help_heading = "Picture")]
    pub(crate) orthographic: bool,
    /// Size in pixels, with --grid of one panel [default: 1200x900, with --grid 600x500]
    #[arg(long, value_name = "WxH", help_heading = "Picture")]
    pub(crate) size: Option<SizeArg>,
    /// Transparent background
    #[arg(long, help_heading = "Picture")]
    pub(crate) transparent: bool,
    /// Edges sharper than this angle are shaded as creases, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = number, default_value_t = RenderParams::default().crease_angle, help_heading = "Picture")]
    pub(crate) crease: f64,
    /// All shapes and signals on one sheet, with captions and at one scale; --grid=N for N columns
    #[arg(
        long,
        value_parser = count,
        value_name = "COLUMNS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "0",
        help_heading = "Picture"
    )]
    pub(crate) grid: Option<usize>,
    /// With --grid: every shape fills its panel
    #[arg(long, requires = "grid", help_heading = "Picture")]
    pub(crate) own_scale: bool,
    /// Take the shapes as this kind, whatever their files say
    #[arg(long = "as", value_name = "KIND", value_parser = parse_named::<ShapeKind>(), help_heading = "Shape")]
    pub(crate) kind: Option<ShapeKind>,
    /// Approximate number of vertices of samples
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Shape")]
    pub(crate) vertices: Option<usize>,
    /// Picture of the texture, for --color texture…
    #[arg(long, value_name = "FILE", help_heading = "Shape")]
    pub(crate) texture: Option<PathBuf>,
}

impl RenderArgs {
    /// Number of columns of a sheet with `n_panels` panels.
    pub(crate) fn columns(&self, n_panels: usize) -> usize {
        let columns = self.grid.and_then(NonZeroUsize::new).map(NonZeroUsize::get);
        columns.unwrap_or_else(|| (1..=n_panels).find(|c| c * c >= n_panels).unwrap_or(1))
    }
}

/// Values of the first and last color.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RangeArg {
    Auto,
    Fixed(f64, f64),
}

impl FromStr for RangeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let numbers = text.split_once(',').and_then(|(low, high)| {
            Some((low.trim().parse::<f64>().ok()?, high.trim().parse::<f64>().ok()?))
        });
        match numbers {
            Some((low, high)) if low < high && (high - low).is_finite() => Ok(Self::Fixed(low, high)),
            _ => Err("must be auto, or two numbers LOW,HIGH with the smaller one first".to_owned()),
        }
    }
}

/// Width and height in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SizeArg(pub(crate) u32, pub(crate) u32);

impl FromStr for SizeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text
            .split_once(['x', 'X', '×'])
            .and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)));
        match numbers {
            Some((0, _) | (_, 0)) => Err("width and height must be at least 1".to_owned()),
            Some((width, height)) => Ok(Self(width, height)),
            None => Err("must be WIDTHxHEIGHT in pixels, such as 1200x900".to_owned()),
        }
    }
}
