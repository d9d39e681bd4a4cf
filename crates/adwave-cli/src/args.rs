//! Every flag, defined once: help, man page and completions come from here.

use crate::analysis_args::{EvaluateArgs, FeaturesArgs, FieldArgs, SaliencyArgs};
use crate::render_args::RenderArgs;
use crate::report_args::ReportArgs;
use adwave::filter::Preset;
use adwave::operator::{CloudGraph, OperatorParams};
use adwave::region::{Region, RegionSyntaxError, parse_region};
use adwave::shape::{CloudArea, MeshArea, WeldMode};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Wavelets for shapes: split a mesh, a point cloud or a graph, or any signal on it, into bands from fine to coarse,
/// change the bands, and put the shape back together without loss.
#[derive(Debug, Parser)]
#[command(
    name = "adwave",
    version,
    after_help = "\
Examples:
  adwave demo                                         all of it, on a built-in shape
  adwave info scan.ply                                what is in a file, and which levels it gets
  adwave transform bunny.obj -o bands.npz             all bands, for numpy
  adwave filter bunny.obj -o smooth.obj --preset suppress
  adwave filter bunny.obj -o crisp.obj --preset enhance --region 'ball:vertex=120,radius=10%'

A SHAPE is a file, '-' for the standard input, or sample:NAME for a built-in shape (see 'adwave sample').
Exit codes: 0 done, 1 the machine failed (disk, permissions), 2 bad usage or input, 130 stopped by Ctrl-C."
)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: GlobalArgs,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Flags of every command.
#[derive(Debug, Args)]
pub(crate) struct GlobalArgs {
    /// Print one JSON object for machines in place of text for people
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Print nothing but errors and, with --json, the result
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Number of threads [default: one for each core]; the result does not depend on it
    #[arg(long, global = true, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Show what a shape consists of, what is unusual about it, and which levels it gets
    Info(InfoArgs),
    /// Split a shape or a signal on it into all its bands
    Transform(TransformArgs),
    /// Change bands, everywhere or by region, and write the shape back with everything its file had
    Filter(FilterArgs),
    /// Map where a signal stands out, over all levels
    Saliency(SaliencyArgs),
    /// Find the places where a level stands out, each with its size
    Features(FeaturesArgs),
    /// Measure how stable the features are, or how well a map agrees with where people look
    Evaluate(EvaluateArgs),
    /// Do the same by another method, and show the differences and the times side by side
    Compare(CompareArgs),
    /// Write the scaling functions and wavelets: those of one vertex as fields, or all as sparse matrices
    Basis(BasisArgs),
    /// Draw a picture of a shape, a field on it, its features; or a sheet of several
    Render(RenderArgs),
    /// Write one page about a shape: health, bands, saliency, features, presets, as pictures and tables
    Report(ReportArgs),
    /// Write a built-in shape
    Sample(SampleArgs),
    /// Decompose, filter and edit a built-in creature, and show what happened
    Demo(DemoArgs),
    /// Make the figures and tables of the paper again, with the numbers behind them and whether its claims hold
    Reproduce(ReproduceArgs),
    /// Print the completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page
    Man(ManArgs),
}

/// A shape, and how its walk is built.
#[derive(Clone, Debug, Args)]
pub(crate) struct ShapeArgs {
    /// File (OBJ, PLY, OFF, STL, XYZ/PTS/PWN/CSV, PCD, LAS/LAZ, GIFTI, MTX; plain or gzip), '-', or sample:NAME
    #[arg(value_name = "SHAPE")]
    pub(crate) shape: String,
    /// Take the shape as this, whatever the file says; a mesh as a cloud is its vertices
    #[arg(long = "as", value_name = "KIND", value_enum, help_heading = "Shape")]
    pub(crate) kind: Option<Kind>,
    /// Number of vertices of a sample (about)
    #[arg(long, value_name = "N", help_heading = "Shape")]
    pub(crate) vertices: Option<usize>,
    /// Noise along the normals of a sample: its standard deviation in mean edge lengths
    #[arg(long, value_name = "S", help_heading = "Shape")]
    pub(crate) noise: Option<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "K", default_value_t = 1, help_heading = "Shape")]
    pub(crate) seed: u64,
    /// Take vertices at exactly equal positions as different vertices
    #[arg(long, help_heading = "Walk")]
    pub(crate) no_weld: bool,
    /// Mesh: how many rings of neighbours one step can reach
    #[arg(long, value_name = "N", default_value = "1", help_heading = "Walk")]
    pub(crate) rings: NonZeroUsize,
    /// Mesh: the area of a vertex
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Walk")]
    pub(crate) mesh_area: MeshAreaArg,
    /// Cloud: how many nearest neighbours one step can reach
    #[arg(long, value_name = "K", default_value = "10", help_heading = "Walk")]
    pub(crate) neighbours: NonZeroUsize,
    /// Cloud: step to the nearest of each point only, as the paper has it, not in both directions
    #[arg(long, help_heading = "Walk")]
    pub(crate) directed: bool,
    /// Cloud: the area of a point
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Walk")]
    pub(crate) cloud_area: CloudAreaArg,
}

impl ShapeArgs {
    /// How the walk is built.
    pub(crate) fn operator(&self) -> OperatorParams {
        OperatorParams::default()
            .with_weld(if self.no_weld { WeldMode::Off } else { WeldMode::EqualPositions })
            .with_rings(self.rings.get())
            .with_mesh_area(match self.mesh_area {
                MeshAreaArg::Barycentric => MeshArea::Barycentric,
                MeshAreaArg::MixedVoronoi => MeshArea::MixedVoronoi,
            })
            .with_neighbours(self.neighbours.get())
            .with_cloud_graph(if self.directed { CloudGraph::Directed } else { CloudGraph::Union })
            .with_cloud_area(match self.cloud_area {
                CloudAreaArg::KthNeighbour => CloudArea::KthNeighbour,
                CloudAreaArg::Unit => CloudArea::Unit,
                CloudAreaArg::TangentVoronoi => CloudArea::TangentVoronoi,
            })
    }
}

/// What a file can be taken as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    Mesh,
    Cloud,
    Graph,
}

/// `adwave::shape::MeshArea` by its names here.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum MeshAreaArg {
    #[default]
    Barycentric,
    MixedVoronoi,
}

/// `adwave::shape::CloudArea` by its names here.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum CloudAreaArg {
    #[default]
    KthNeighbour,
    Unit,
    TangentVoronoi,
}

/// Which levels.
#[derive(Debug, Args)]
pub(crate) struct LevelArgs {
    /// Number of dyadic levels, 1, 2, 4 … 2^(J-1) steps [default: until a level is 2 % of the diagonal wide, for features 4 %; 4 to 16]
    #[arg(long, short = 'j', value_name = "J", help_heading = "Levels")]
    pub(crate) levels: Option<usize>,
    /// So many levels for each doubling of the steps in place of one: 2^(k/V) steps, whole or not
    #[arg(long, value_name = "V", help_heading = "Levels", conflicts_with_all = ["steps", "lengths"])]
    pub(crate) voices: Option<usize>,
    /// Levels of these numbers of steps, increasing, whole or not, from 1/64
    #[arg(long, value_name = "N,N,…", value_delimiter = ',', help_heading = "Levels", conflicts_with_all = ["levels", "lengths"])]
    pub(crate) steps: Option<Vec<f64>>,
    /// Largest error of a band, relative to the band: 1e-13 to 0.1
    #[arg(long, value_name = "E", default_value_t = 1e-10, help_heading = "Levels")]
    pub(crate) accuracy: f64,
    /// Levels of these widths σ in model units, increasing
    #[arg(
        long,
        value_name = "L,L,…",
        value_delimiter = ',',
        help_heading = "Levels",
        conflicts_with = "levels"
    )]
    pub(crate) lengths: Option<Vec<f64>>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  adwave info scan.las
  adwave info bunny.obj --json | jq .health
  adwave info sample:creature --vertices 200000")]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension:
  .npz        points (n,3), scaling (J+1,n,d), wavelet (J,n,d), steps (J+1), sigma (J+1), for numpy
  .vtp .ply   the shape with the fields S0 … SJ and W1 … WJ, for ParaView

Examples:
  adwave transform bunny.obj -o bands.npz --levels 8
  adwave transform brain.ply -o bands.vtp --field thickness
  adwave transform scan.laz -o bands.vtp --lengths 0.1,0.2,0.5,1 --field intensity")]
pub(crate) struct TransformArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the bands go (.npz, .vtp or .ply)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// The signal: coords, a field of the file, or an .npy file with one row a vertex
    #[arg(long, value_name = "NAME", default_value = "coords")]
    pub(crate) field: String,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Regions (0 outside, rising smoothly to 1 inside; lengths in model units or in % of the diagonal):
  ball:vertex=V,radius=R[,falloff=F]        within R of a vertex along the surface (or point=X Y Z)
  stroke:path=X Y Z;X Y Z;…,radius=R        within R of a line over the surface (or vertices=V V …)
  box:min=X Y Z,max=X Y Z[,falloff=F]       half-space:point=X Y Z,normal=X Y Z[,falloff=F]
  field:name=NAME[,low=A][,high=B]          0 where the field is A, 1 where it is B
  vertices:indices=V V …[,radius=R]         all
  !REGION not   REGION & REGION both   REGION | REGION either   ( … )

Examples:
  adwave filter bust.obj -o smooth.obj --preset suppress
  adwave filter bust.obj -o edit.obj --gains 3,2,1,1,1,1 --region 'ball:vertex=120,radius=10%'
  adwave filter bust.obj -o half.ply --preset enhance --region 'half-space:point=0 0 0,normal=1 0 0'
  adwave filter brain.ply -o even.ply --field thickness --preset suppress
  adwave filter bust.obj -o edit.obj --recipe edit.toml")]
pub(crate) struct FilterArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Where the result goes; the format is that of the extension
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// The signal that is filtered: coords, or a field of the file
    #[arg(long, value_name = "NAME")]
    pub(crate) field: Option<String>,
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
        allow_negative_numbers = true,
        conflicts_with = "recipe",
        help_heading = "Edit"
    )]
    pub(crate) gains: Option<Vec<f64>>,
    /// Where the gains apply; several are joined (see below)
    #[arg(long, value_name = "REGION", value_parser = region, conflicts_with = "recipe", help_heading = "Edit")]
    pub(crate) region: Vec<Region>,
    /// Apply the layers of a recipe
    #[arg(long, value_name = "FILE.toml", help_heading = "Edit")]
    pub(crate) recipe: Option<PathBuf>,
    /// Save the edit as a recipe
    #[arg(long, value_name = "FILE.toml", help_heading = "Edit")]
    pub(crate) save_recipe: Option<PathBuf>,
    /// Compute the normals that the file has anew; without this they are kept as they are
    #[arg(long)]
    pub(crate) update_normals: bool,
}

fn region(text: &str) -> Result<Region, RegionSyntaxError> {
    parse_region(text)
}

/// `adwave::filter::Preset` by its names here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PresetArg {
    /// Drop every band
    Suppress,
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
            PresetArg::Enhance => Self::Enhance,
            PresetArg::Band1 => Self::Band1,
            PresetArg::Band2 => Self::Band2,
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
With --vertex and --level the output is the shape with the fields phi and psi (.vtp or .ply).
With --levels it is one file for each matrix, named after OUT: OUT.phi1.npz … OUT.psiJ.npz, for
scipy.sparse.load_npz, or .mtx. Row x is the function of vertex x. Where vertices were welded the matrices are
over the welded ones, and OUT.classes.npy tells which is which.

Examples:
  adwave basis bunny.obj --vertex 120 --level 5 -o wavelet.vtp
  adwave basis bunny.obj --levels 6 -o bunny.npz")]
pub(crate) struct BasisArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// The vertex, counted from 0
    #[arg(long, value_name = "V", requires = "level", required_unless_present = "levels")]
    pub(crate) vertex: Option<usize>,
    /// Its level, from 1
    #[arg(long, value_name = "J", requires = "vertex")]
    pub(crate) level: Option<usize>,
    /// All vertices, on this many dyadic levels
    #[arg(long, short = 'j', value_name = "J", conflicts_with = "vertex")]
    pub(crate) levels: Option<usize>,
    /// Drop entries of the matrices below this
    #[arg(long, value_name = "E", default_value_t = 1e-6)]
    pub(crate) drop_tolerance: f64,
    /// Where the functions go
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  adwave sample                                 list the shapes
  adwave sample creature -o creature.ply
  adwave sample knot --vertices 200000 --noise 0.3 --seed 7 -o noisy.obj
  adwave sample sphere --as cloud -o points.ply")]
pub(crate) struct SampleArgs {
    /// Which shape; without it the shapes are listed
    pub(crate) name: Option<String>,
    /// Where it goes; the format is that of the extension
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Number of vertices (about)
    #[arg(long, value_name = "N")]
    pub(crate) vertices: Option<usize>,
    /// Write a mesh, or its vertices only
    #[arg(long = "as", value_name = "KIND", value_enum)]
    pub(crate) kind: Option<Kind>,
    /// Noise along the normals: its standard deviation in mean edge lengths
    #[arg(long, value_name = "S")]
    pub(crate) noise: Option<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub(crate) seed: u64,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Methods:
  mht          smooth the same width by manifold harmonics
  taubin       smooth by the windowed sinc, half the gain at the same frequency
  lee          the saliency map of Lee, Varshney and Jacobs
  feature-map  critical points of a signal smoothed by heat [default signal: mean-curvature]
  sgwt         spectral graph wavelets of the same walk, as many bands, and back
  dw, bdw      diffusion wavelets, biorthogonal ones (up to 6000 vertices), and back

Both results go to DIR as adwave.ply and METHOD.ply, the table as comparison.json.

Examples:
  adwave compare bunny.obj --with mht --harmonics 300 -o out
  adwave compare sample:creature --vertices 3000 --with dw -o out")]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// The other method
    #[arg(long = "with", value_name = "METHOD", value_enum)]
    pub(crate) method: MethodArg,
    /// Folder that the files go to
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) field: FieldArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// mht: number of harmonics
    #[arg(long, value_name = "K", default_value = "200")]
    pub(crate) harmonics: NonZeroUsize,
}

/// `adwave_baselines::compare::Method` by its names here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// Manifold harmonics
    Mht,
    /// Mesh saliency
    Lee,
    /// Critical points
    FeatureMap,
    /// Spectral graph wavelets
    Sgwt,
    /// Diffusion wavelets
    Dw,
    /// Biorthogonal diffusion wavelets
    Bdw,
    /// Windowed sinc
    Taubin,
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder that the files go to
    #[arg(long, short, value_name = "DIR", default_value = "adwave-demo")]
    pub(crate) output: PathBuf,
    /// Number of vertices of the creature (about)
    #[arg(long, value_name = "N")]
    pub(crate) vertices: Option<usize>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
DIR/index.html shows every figure with its pictures, what to see and whether it came out as the paper claims; DIR/figNN
holds the pictures in full size and the numbers as CSV.

Models are found by name in the folders and all folders below: armadillo, dinosaur, skull, horse, kitten, face, bunny,
spot (with its texture), gargoyle, buddha, hand, pegaso, cow, sphere. Built-in shapes stand in for those that are missing.

Examples:
  adwave reproduce -o out
  adwave reproduce fig10 table2 -o out
  adwave reproduce all -o out --models models --models textured-models")]
pub(crate) struct ReproduceArgs {
    /// fig1 … fig15, table1, table2, or all
    #[arg(value_name = "FIGURE", default_value = "all")]
    pub(crate) figures: Vec<String>,
    /// Folder that the files go to
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Folder with copies of the paper's models; may be given several times
    #[arg(long, value_name = "DIR")]
    pub(crate) models: Vec<PathBuf>,
    /// Write the page as Markdown too, with small pictures in a folder beside it
    #[arg(long, value_name = "FILE.md")]
    pub(crate) markdown: Option<PathBuf>,
    /// Make built-in shapes no larger than this: a quick sketch of every figure
    #[arg(long, value_name = "N")]
    pub(crate) most_vertices: Option<NonZeroUsize>,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Folder for one page a command; without it the main page is printed
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_flags_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }
}
