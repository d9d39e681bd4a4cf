//! The arguments of `adwave tiles` and `adwave tile`.

use crate::args::size;
use crate::commands::denoise::CreasesArg;
use crate::output::available_memory;
use adwave::denoise::{DenoiseChoice, DenoiseParams};
use adwave::features::FeatureParams;
use adwave_tiles::{MapKind, MapWeights, Params};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
The points of all files are sorted along one curve and cut into tiles that fit into memory. Around each tile lie as many rings of
neighbors as its bands see, so that all ways to cut give the same bytes; results come in the order of the curve, with all that the
points had. A mesh comes out as one file of its own format, in its own order, with all that it had; its neighbors are those of its faces.
A run that was ended goes on where it was when the same command is given again. See docs/SCALE.md.

Examples:
  adwave tiles flight-*.laz -o smooth.laz --gains 0,0,0.5,1,1,1,1,1
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --memory 4G
  adwave tiles flight-*.laz -o map.laz --saliency --features features.csv
  adwave tiles flight-*.laz -o clean.laz --denoise
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --forecast
  adwave tiles scan.ply -o smooth.ply --gains 0,0.5,1,1,1,1,1,1 --magnitudes 3,6 --memory 1G
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --plan-only, then on any machine that sees the folder:
  adwave tile tiles/ sort; adwave tile tiles/ neighbors 0; adwave tile tiles/ bands 0")]
pub(crate) struct TilesArgs {
    /// LAS or LAZ files of one point format and scale, folders of such (tiles, an EPT), or one PLY or OBJ with faces
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// A folder for the tiles, or a .las or .laz for all of them in one; of a mesh, a file of its format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Number of dyadic levels [default: as many as there are gains, else 8]
    #[arg(long, value_name = "J", help_heading = "Bands")]
    pub(crate) levels: Option<usize>,
    /// A gain for each band, from fine to coarse: 0 drops it, 1 keeps it, 2 doubles it
    #[arg(
        long,
        value_name = "G,G,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Bands"
    )]
    pub(crate) gains: Vec<f64>,
    /// Bands, from 1, whose length |W_j| each point gets as a field wavelet_j, in model units (an OBJ holds none)
    #[arg(long, value_name = "J,J,…", value_delimiter = ',', help_heading = "Bands")]
    pub(crate) magnitudes: Vec<usize>,
    /// Bands, from 1, that each point gets as fields wavelet_j_x, wavelet_j_y and wavelet_j_z, in model units (an OBJ holds none)
    #[arg(long, value_name = "J,J,…", value_delimiter = ',', help_heading = "Bands")]
    pub(crate) vectors: Vec<usize>,
    /// A field saliency: a map without a sign, the lengths |W_j| of all levels weighed by KIND
    #[arg(
        long,
        value_name = "KIND",
        value_enum,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "entropy",
        help_heading = "Bands"
    )]
    pub(crate) saliency: Option<KindArg>,
    /// How many of the finest levels the map skips [default: 0, with another weighting than entropy 2]
    #[arg(long, value_name = "N", requires = "saliency", help_heading = "Bands")]
    pub(crate) skip: Option<usize>,
    /// Where the features of all tiles go (.csv, .json, or spheres as .ply and others)
    #[arg(long, value_name = "FILE", help_heading = "Bands")]
    pub(crate) features: Option<PathBuf>,
    /// How many times the mean response of its level a feature has
    #[arg(long, value_name = "T", requires = "features", default_value_t = FeatureParams::default().theta, help_heading = "Bands")]
    pub(crate) theta: f64,
    /// How many nearest neighbors a step of the walk takes in, in clouds [default: 10, with --denoise 12]
    #[arg(long, value_name = "K", help_heading = "Bands")]
    pub(crate) neighbors: Option<usize>,
    /// Relative error of the bands
    #[arg(long, value_name = "E", default_value_t = Params::default().accuracy, help_heading = "Bands")]
    pub(crate) accuracy: f64,
    #[command(flatten)]
    pub(crate) noise: NoiseArgs,
    /// Memory that may be used [default: half of what is free]
    #[arg(long, value_name = "SIZE", value_parser = size, help_heading = "Work")]
    pub(crate) memory: Option<u64>,
    /// Number of tiles [default: as few as the memory allows]
    #[arg(long, value_name = "N", help_heading = "Work")]
    pub(crate) tiles: Option<usize>,
    /// Tiles that are worked on at a time, each with its part of the memory
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "Work")]
    pub(crate) workers: usize,
    /// Folder for temporary files [default: the folder of the tiles, or OUT.work beside a file]
    #[arg(long, value_name = "FOLDER", help_heading = "Work")]
    pub(crate) work: Option<PathBuf>,
    /// Say what it will take, and do nothing
    #[arg(long, help_heading = "Work")]
    pub(crate) forecast: bool,
    /// Write the plan, for 'adwave tile'
    #[arg(long, conflicts_with = "forecast", help_heading = "Work")]
    pub(crate) plan_only: bool,
    /// Keep the temporary files
    #[arg(long, help_heading = "Work")]
    pub(crate) keep_work: bool,
}

/// What goes without noise being taken off: said of each argument, since one that conflicts with what is there is not required either.
const OF_BANDS: [&str; 6] = ["gains", "magnitudes", "vectors", "saliency", "features", "levels"];

/// What is asked for where noise is taken off.
#[derive(Debug, Args)]
#[command(next_help_heading = "Noise")]
pub(crate) struct NoiseArgs {
    /// Take the noise off the positions, as 'adwave denoise' does, in place of all that bands give
    #[arg(long, conflicts_with_all = OF_BANDS)]
    pub(crate) denoise: bool,
    /// By how much the noise counts: 0 changes nothing, 2 takes it for twice as large
    #[arg(long, value_name = "S", requires = "denoise", conflicts_with_all = OF_BANDS, default_value_t = DenoiseParams::default().strength)]
    pub(crate) strength: f64,
    /// What becomes of creases of the shape
    #[arg(long, value_name = "KIND", value_enum, requires = "denoise", conflicts_with_all = OF_BANDS, default_value_t)]
    pub(crate) creases: CreasesArg,
    /// Standard deviation of the noise along the normals in model units [default: estimated]
    #[arg(long, value_name = "SIGMA", requires = "denoise", conflicts_with_all = OF_BANDS)]
    pub(crate) noise_sigma: Option<f64>,
}

/// How the levels of the map are weighed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum KindArg {
    /// 1/mean by how unevenly the level is spread
    Entropy,
    /// (max − mean)² (eq. 17)
    Paper,
    /// 1/mean, so that every level counts alike
    Normalized,
    /// 1
    None,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Jobs of one kind may run in any order, at the same time and on several machines; runs come before the sort, which does those that are
missing, all neighbors after it, where a cloud is denoised all orientations after these, all bands after them, and, where there is a map or
features, all maps after all bands. 'status' says how many there are of each. A job that is done twice gives the same file again. 'adwave tiles' with the same arguments does what is left and joins.

Examples:
  adwave tile tiles/ status
  adwave tile tiles/ run 2
  adwave tile tiles/ sort
  adwave tile tiles/ neighbors 3
  adwave tile tiles/ bands 3
  adwave tile tiles/ maps 3")]
pub(crate) struct TileArgs {
    /// The folder of 'adwave tiles --plan-only'
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// What to do
    #[arg(value_name = "JOB", value_enum)]
    pub(crate) job: JobKind,
    /// Which run or tile, from 0
    #[arg(value_name = "INDEX", default_value = "0")]
    pub(crate) index: usize,
    /// Do nothing where it is done already
    #[arg(long)]
    pub(crate) if_missing: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum JobKind {
    /// Nothing; say what is done, and how many jobs there are
    Status,
    /// Some points of a cloud in the order of the curve, for the sort, which does those that are missing
    Run,
    /// All points in the order of the curve, and the faces of a mesh to its tiles, once
    Sort,
    /// The neighbors of the points of a tile
    Neighbors,
    /// The orientation of the normals of a tile, if a cloud is denoised
    Orientation,
    /// The bands of a tile or its positions without noise, and its points as they come out
    Bands,
    /// The saliency map and the features of a tile, where they were asked for
    Maps,
}

impl TilesArgs {
    /// What is asked for.
    pub(crate) fn params(&self) -> Params {
        /// Where the system does not say what is free.
        const UNKNOWN: u64 = 8 << 30;
        let levels = match self.gains.len() {
            0 => Params::default().levels,
            n => n,
        };
        let mut params = Params::default();
        params.levels = self.levels.unwrap_or(levels);
        params.gains.clone_from(&self.gains);
        params.magnitudes.clone_from(&self.magnitudes);
        params.vectors.clone_from(&self.vectors);
        params.saliency = self.saliency.map(|kind| {
            // As 'adwave saliency' has it.
            const SKIPPED: usize = 2;
            let (kind, skip) = match kind {
                KindArg::Entropy => (MapKind::Entropy, 0),
                KindArg::Paper => (MapKind::PerLevel, SKIPPED),
                KindArg::Normalized => (MapKind::Normalized, SKIPPED),
                KindArg::None => (MapKind::Uniform, SKIPPED),
            };
            MapWeights { kind, skip: self.skip.unwrap_or(skip) }
        });
        params.theta = self.features.as_ref().map(|_| self.theta);
        params.denoise = self.noise.params();
        let usual = if self.noise.denoise { DenoiseChoice::NEIGHBORS } else { params.neighbors };
        params.neighbors = self.neighbors.unwrap_or(usual);
        params.accuracy = self.accuracy;
        params.n_tiles = self.tiles;
        params.memory = self.memory.unwrap_or_else(|| available_memory().unwrap_or(UNKNOWN) / 2);
        params.n_workers = self.workers;
        params
    }
}

impl NoiseArgs {
    fn params(&self) -> Option<DenoiseParams> {
        let params = DenoiseParams::default().with_strength(self.strength).with_creases(self.creases.into());
        let params = self.noise_sigma.map_or(params, |noise| params.with_noise(noise));
        self.denoise.then_some(params)
    }
}
