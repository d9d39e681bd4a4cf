//! The arguments of `adwave tiles` and `adwave tile`.

use crate::args::{LocalFitArgs, SelectionArgs, count, number, parse_named, shared_noise, size};
use crate::error::CliError;
use adwave::denoise::{Creases, DenoiseChoice, DenoiseParams, SharedNoise};
use adwave::features::DEFAULT_THETA;
use adwave::filter::{KeepVolume, KeepVolumeError};
use adwave::positions::{Borders, MoveDirection};
use adwave_tiles::{MapKind, MapWeights, Params, TileSelection};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
The points of all files are sorted along a space-filling curve and cut into tiles that fit into memory. Each tile is processed with a
halo of neighbors as wide as its bands reach, so results do not depend on the number of tiles. Points come out in the order of the
curve, with all of their fields. A mesh comes out in its own format and order, with all of its fields; its neighbors are those of
its faces. After an interruption the same command continues where the run stopped. See docs/SCALE.md.

The gains move vertices as 'adwave filter' does: those of a cloud along their normals, those of a mesh in all directions, but along
the normals in parts with a border. Points that --only or --mask leave out keep their values and are nobody's neighbors, as do those
that are flagged as withheld or classified as noise, strays and placeholders; notes count them.

Examples:
  adwave tiles flight-*.laz -o smooth.laz --gains 0,0,0.5,1,1,1,1,1
  adwave tiles flight-*.laz -o ground.laz --gains 0,0.5,1 --along z --only classification=2
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --memory 4G
  adwave tiles flight-*.laz -o map.laz --saliency --features features.csv
  adwave tiles flight-*.laz -o clean.laz --denoise
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --forecast
  adwave tiles scan.ply -o smooth.ply --gains 0,0.5,1,1,1,1,1,1 --magnitudes 3,6 --memory 1G
  adwave tiles flight-*.laz -o tiles/ --magnitudes 3,6 --plan-only     then, where the folder is:
  adwave tile tiles/ sort && adwave tile tiles/ neighbors 0 && adwave tile tiles/ bands 0")]
pub(crate) struct TilesArgs {
    /// LAS or LAZ files of one point format and scale, folders of such files (tiles, an EPT), or one PLY or OBJ with
    /// faces
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Folder for the tiles, or a .las or .laz file for all points; for a mesh, a file of its format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) selection: SelectionArgs,
    /// Number of dyadic levels [default: as many as there are gains, else 8]
    #[arg(long, value_name = "J", value_parser = count, help_heading = "Bands")]
    pub(crate) levels: Option<usize>,
    /// One gain per band, fine to coarse: 0 drops the band, 1 keeps it, 2 doubles it
    #[arg(
        long,
        value_parser = number,
        value_name = "G,G,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Bands"
    )]
    pub(crate) gains: Vec<f64>,
    /// Bands, from 1, whose magnitude |W_j| is written as the field wavelet_j, in model units (an OBJ stores no fields)
    #[arg(long, value_parser = count, value_name = "J,J,…", value_delimiter = ',', help_heading = "Bands")]
    pub(crate) magnitudes: Vec<usize>,
    /// Bands, from 1, that are written as the fields wavelet_j_x, wavelet_j_y and wavelet_j_z, in model units (an OBJ
    /// stores no fields)
    #[arg(long, value_parser = count, value_name = "J,J,…", value_delimiter = ',', help_heading = "Bands")]
    pub(crate) vectors: Vec<usize>,
    /// Write the field saliency: a map without a sign, the weighted sum of |W_j| over all levels
    #[arg(
        long,
        value_name = "KIND",
        value_parser = parse_named::<MapKind>(),
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "entropy",
        help_heading = "Bands"
    )]
    pub(crate) saliency: Option<MapKind>,
    /// Number of the finest levels that the map skips [default: 0, with another weighting than entropy 2]
    #[arg(long, value_name = "N", value_parser = count, requires = "saliency", help_heading = "Bands")]
    pub(crate) skip: Option<usize>,
    /// File for the features of all tiles (.csv, .json, or spheres as .ply and others); those of a cloud are not tested
    /// against the drawing of its points
    #[arg(long, value_name = "FILE", help_heading = "Bands")]
    pub(crate) features: Option<PathBuf>,
    /// Least response of a feature, relative to the mean response of its level
    #[arg(long, value_name = "T", value_parser = number, requires = "features", default_value_t = DEFAULT_THETA, help_heading = "Bands")]
    pub(crate) theta: f64,
    /// Cloud: nearest neighbors that one step reaches [default: 10, with --denoise 12]
    #[arg(long, value_name = "K", value_parser = count, help_heading = "Bands")]
    pub(crate) neighbors: Option<usize>,
    /// Largest error of a band, relative to the band
    #[arg(long, value_name = "E", value_parser = number, default_value_t = Params::default().accuracy, help_heading = "Bands")]
    pub(crate) accuracy: f64,
    #[command(flatten)]
    pub(crate) motion: MotionArgs,
    #[command(flatten)]
    pub(crate) noise: NoiseArgs,
    /// Memory to use, in bytes or with K, M, G [default: half of the free memory]
    #[arg(long, value_name = "SIZE", value_parser = size, help_heading = "Work")]
    pub(crate) memory: Option<u64>,
    /// Number of tiles [default: as few as the memory allows]
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Work")]
    pub(crate) tiles: Option<usize>,
    /// Number of tiles that are processed at a time, each with its share of the memory
    #[arg(long, value_name = "N", value_parser = count, default_value_t = 1, help_heading = "Work")]
    pub(crate) workers: usize,
    /// Folder for temporary files [default: the folder of the tiles, or OUT.work next to a file]
    #[arg(long, value_name = "FOLDER", help_heading = "Work")]
    pub(crate) work: Option<PathBuf>,
    /// Print the memory and disk space that the run needs, and do nothing
    #[arg(long, help_heading = "Work")]
    pub(crate) forecast: bool,
    /// Write the plan for 'adwave tile', and do nothing else
    #[arg(long, conflicts_with = "forecast", help_heading = "Work")]
    pub(crate) plan_only: bool,
    /// Keep the temporary files
    #[arg(long, help_heading = "Work")]
    pub(crate) keep_work: bool,
}

/// Motion by the gains.
#[derive(Debug, Args)]
#[command(next_help_heading = "Motion")]
pub(crate) struct MotionArgs {
    /// Directions in which vertices move by the gains [default: normal for a cloud, free for a mesh]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<MoveDirection>(), requires = "gains")]
    pub(crate) along: Option<MoveDirection>,
    /// Mesh: treatment of borders; 'keep' needs 'adwave filter' [default: natural]
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Borders>(), requires = "gains")]
    pub(crate) border: Option<Borders>,
    #[command(flatten)]
    pub(crate) fit: LocalFitArgs,
    /// Keep the volume of a smoothing; 'offset' and 'thrice' need 'adwave filter'
    #[arg(long, value_name = "HOW", value_parser = parse_named::<KeepVolume>(), requires = "gains")]
    pub(crate) keep_volume: Option<KeepVolume>,
}

/// Arguments that denoising excludes. Each of its arguments names them: clap does not require an argument that
/// conflicts with one given.
const BAND_ARGUMENTS: [&str; 6] = ["gains", "magnitudes", "vectors", "saliency", "features", "levels"];

/// Denoising.
#[derive(Debug, Args)]
#[command(next_help_heading = "Noise")]
pub(crate) struct NoiseArgs {
    /// Remove noise from the positions, as 'adwave denoise' does, instead of computing bands
    #[arg(long, conflicts_with_all = BAND_ARGUMENTS)]
    pub(crate) denoise: bool,
    /// Factor on the noise level: 0 changes nothing, 2 removes noise twice as strong as estimated
    #[arg(long, value_name = "S", value_parser = number, requires = "denoise", conflicts_with_all = BAND_ARGUMENTS, default_value_t = DenoiseParams::default().strength)]
    pub(crate) strength: f64,
    /// Treatment of creases of the shape
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Creases>(), requires = "denoise", conflicts_with_all = BAND_ARGUMENTS, default_value_t)]
    pub(crate) creases: Creases,
    /// Noise of a mesh that neighbors share: detail (it stays), auto (as much as the mesh admits) or its standard
    /// deviation along the normals in model units
    #[arg(long, value_name = "KIND", value_parser = shared_noise, requires = "denoise", conflicts_with_all = BAND_ARGUMENTS, default_value = "detail")]
    pub(crate) shared_noise: SharedNoise,
    /// Standard deviation of the noise along the normals in model units [default: estimated]
    #[arg(long, value_name = "SIGMA", value_parser = number, requires = "denoise", conflicts_with_all = BAND_ARGUMENTS)]
    pub(crate) noise_sigma: Option<f64>,
    /// Accept lengths in model units although coordinates are longitudes and latitudes
    #[arg(long, requires = "noise_sigma")]
    pub(crate) allow_degrees: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
The kinds of jobs run in this order: run, sort, neighbors, sides (only if a cloud is denoised), bands, maps (only if there is a map or
features). Jobs of one kind may run in any order, at the same time and on several machines. The sort does the runs that are missing.
'status' reports how many jobs of each kind there are. A job that is repeated writes the same file again. 'adwave tiles' with the
same arguments does the remaining jobs and joins the tiles.

Examples:
  adwave tile tiles/ status
  adwave tile tiles/ run 2
  adwave tile tiles/ sort
  adwave tile tiles/ neighbors 3
  adwave tile tiles/ bands 3
  adwave tile tiles/ maps 3")]
pub(crate) struct TileArgs {
    /// Folder of 'adwave tiles --plan-only'
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
    /// Kind of job
    #[arg(value_name = "JOB", value_enum)]
    pub(crate) job: JobKind,
    /// Index of the run or tile, from 0
    #[arg(value_name = "INDEX", value_parser = count, default_value = "0")]
    pub(crate) index: usize,
    /// Do nothing if the job is done already
    #[arg(long)]
    pub(crate) if_missing: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum JobKind {
    /// Report the number of jobs and how many are done
    Status,
    /// Sort a part of the points of a cloud along the curve
    Run,
    /// Merge all points in the order of the curve, and assign the faces of a mesh to tiles
    Sort,
    /// Find the neighbors of the points of a tile
    Neighbors,
    /// Compute the bands or the denoised positions of a tile, and write its points
    Bands,
    /// Compute the saliency map and the features of a tile, if they are asked for
    Maps,
}

impl TilesArgs {
    /// Parameters of the run.
    pub(crate) fn to_params(&self) -> Result<Params, CliError> {
        /// Free memory in bytes that is assumed if the system does not report it.
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
            let weights = MapWeights::new(kind);
            MapWeights { skip: self.skip.unwrap_or(weights.skip), ..weights }
        });
        params.theta = self.features.as_ref().map(|_| self.theta);
        params.denoise = self.noise.to_params();
        let default = if self.noise.denoise { DenoiseChoice::NEIGHBORS } else { params.neighbors };
        params.neighbors = self.neighbors.unwrap_or(default);
        params.accuracy = self.accuracy;
        params.n_tiles = self.tiles;
        params.memory = self.memory.unwrap_or_else(|| adwave_io::free_memory().unwrap_or(UNKNOWN) / 2);
        params.n_workers = self.workers;
        params.selection = TileSelection::from(&self.selection.to_selection()?);
        self.motion.set(&mut params)?;
        Ok(params)
    }
}

impl MotionArgs {
    fn set(&self, params: &mut Params) -> Result<(), CliError> {
        params.along = self.along;
        params.borders = self.border.unwrap_or_default();
        if let Some(fit) = self.fit.local_fit {
            if self.along.and_then(MoveDirection::axis).is_none() {
                return Err(CliError::Input(
                    "--local-fit is for heights (--along x, y or z); leave it out".to_owned(),
                ));
            }
            params.local_fit = fit;
        }
        match self.keep_volume {
            None => Ok(()),
            Some(how @ KeepVolume::Twice) => {
                if params.gains.iter().any(|gain| *gain != 0.0) {
                    return Err(KeepVolumeError::NotSmoothing { layer: 1, how }.into());
                }
                params.levels += 1;
                params.gains.push(2.0);
                Ok(())
            }
            Some(how) => Err(CliError::Input(format!(
                "--keep-volume in tiles must be 'twice', got '{how}', which depends on the whole shape; filter it in memory \
                 ('adwave filter')"
            ))),
        }
    }
}

impl NoiseArgs {
    fn to_params(&self) -> Option<DenoiseParams> {
        let params = DenoiseParams::default().with_strength(self.strength).with_creases(self.creases);
        let params = params.with_shared(self.shared_noise);
        let params = self.noise_sigma.map_or(params, |noise| params.with_noise(noise));
        self.denoise.then_some(params)
    }
}
