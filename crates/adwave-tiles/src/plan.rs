//! What a work is: its inputs, what is asked for, how it is cut.

use std::ops::Range;
use std::path::PathBuf;

use adwave::bands::{FixedSeries, Schedule};
use adwave::denoise::{DenoiseChoice, DenoiseParams};
use adwave::features::{FeatureError, FeatureParams};
use adwave::named_values;
use adwave::saliency::{SaliencyError, SaliencyParams};
use serde::{Deserialize, Serialize};

use crate::denoise::MOST_SAMPLED;
use crate::layout::Layout;
use crate::part::Limits;
use crate::{TilesError, VERTICES_IN_A_BLOCK, mesh};

/// How the levels of a saliency map without a sign, `Λ = Σ_j α_j·‖W_j‖` over j > skip, are weighed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MapWeights {
    /// How many of the finest levels are skipped.
    pub skip: usize,
    /// The α_j.
    pub kind: MapKind,
}

/// The α_j that the numbers of whole levels decide (see [`Weighting`](adwave::saliency::Weighting)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapKind {
    /// By how unevenly a level is spread, over its mean.
    Entropy,
    /// (max − mean)², as the paper has it (eq. 17).
    PerLevel,
    /// 1/mean.
    Normalized,
    /// 1.
    Uniform,
}

named_values!(MapKind, "weighting", {
    Entropy => "entropy", "1/mean, times how unevenly the level is spread";
    PerLevel => "paper", "(max − mean)² (eq. 17)";
    Normalized => "normalized", "1/mean, so that every level counts alike";
    Uniform => "none", "1 for every level";
});

impl MapWeights {
    /// The weights with the levels that a map of one shape skips: none by entropy, else as many as in the paper.
    pub fn new(kind: MapKind) -> Self {
        let skip = match kind {
            MapKind::Entropy => SaliencyParams::default().skip,
            MapKind::PerLevel | MapKind::Normalized | MapKind::Uniform => SaliencyParams::paper().skip,
        };
        Self { skip, kind }
    }
}

/// What is asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Params {
    /// J, the number of dyadic levels.
    pub levels: usize,
    /// The gain of each band from fine to coarse, as many as levels; 1 keeps a band. All 1 where there are none.
    pub gains: Vec<f64>,
    /// The bands, from 1, whose length ‖W_j‖ becomes a field `wavelet_j` of the points, in model units.
    pub magnitudes: Vec<usize>,
    /// The bands, from 1, whose vectors W_j become fields `wavelet_j_x`, `wavelet_j_y` and `wavelet_j_z`, in model units.
    #[serde(default)]
    pub vectors: Vec<usize>,
    /// How a saliency map is weighed that becomes the field `saliency`; none where there is none.
    #[serde(default)]
    pub saliency: Option<MapWeights>,
    /// θ of the features that are looked for (see [`FeatureParams`]); none where there is none.
    #[serde(default)]
    pub theta: Option<f64>,
    /// How noise is taken off the positions; nothing else is done then. Nothing where none is.
    #[serde(default)]
    pub denoise: Option<DenoiseParams>,
    /// How many nearest neighbors a step of the walk in a cloud may take in.
    pub neighbors: usize,
    /// Relative error of the bands (see [`FixedSeries`]).
    pub accuracy: f64,
    /// How many tiles; as few as memory allows where there is no number.
    pub n_tiles: Option<usize>,
    /// Bytes of memory that may be used.
    pub memory: u64,
    /// Tiles that are worked on at a time, each with its part of the memory.
    pub n_workers: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            levels: 8,
            gains: Vec::new(),
            magnitudes: Vec::new(),
            vectors: Vec::new(),
            saliency: None,
            theta: None,
            denoise: None,
            neighbors: 10,
            accuracy: 1e-6,
            n_tiles: None,
            memory: 4 << 30,
            n_workers: 1,
        }
    }
}

/// More neighbors than this make rows that no tile holds.
const MOST_NEIGHBORS: usize = 200;

/// A record of LAS has at most 65 535 bytes, and a field is described by 192 of a record of as many.
const MOST_FIELDS: usize = 300;

/// Rings are numbers of 16 bits; a tile with so many has hardly anything of its own.
const MOST_RINGS: usize = 60_000;

fn of_features(error: FeatureError) -> TilesError {
    TilesError::Input(error.to_string())
}

impl Params {
    pub(crate) fn check(&self) -> Result<(), TilesError> {
        let input = |message: String| Err(TilesError::Input(message));
        if !self.gains.is_empty() && self.gains.len() != self.levels {
            return input(format!(
                "{} gains for {} levels; give one for each band, from fine to coarse",
                self.gains.len(),
                self.levels
            ));
        }
        if let Some(gain) = self.gains.iter().find(|gain| !gain.is_finite()) {
            return input(format!("the gain {gain} is not finite; give a number"));
        }
        let mut bands = self.magnitudes.iter().chain(&self.vectors);
        if let Some(band) = bands.find(|band| !(1..=self.levels).contains(*band)) {
            return input(format!("there is no band {band}; bands are 1 to {}", self.levels));
        }
        if self.fields().len() > MOST_FIELDS {
            return input(format!("{} fields; ask for at most {MOST_FIELDS}", self.fields().len()));
        }
        if let Some(MapWeights { skip, .. }) = self.saliency
            && skip >= self.levels
        {
            return input(SaliencyError::NoLevelLeft { skip, n_levels: self.levels }.to_string());
        }
        if let Some(theta) = self.theta {
            FeatureParams::default().with_theta(theta).check().map_err(of_features)?;
            if self.levels < 3 {
                return Err(of_features(FeatureError::TooFewLevels { n_levels: self.levels }));
            }
        }
        if !(1..=MOST_NEIGHBORS).contains(&self.neighbors) {
            return input(format!("{} neighbors; give 1 to {MOST_NEIGHBORS}", self.neighbors));
        }
        if let Some(denoise) = &self.denoise {
            denoise.check()?;
            if !self.gains.is_empty() || self.has_maps() || !self.wanted().is_empty() {
                return input(
                    "noise is taken off by a work of its own; ask for gains, bands, maps and features of its result".into(),
                );
            }
        }
        if self.n_workers == 0 || self.n_tiles == Some(0) {
            return input("0 workers or tiles do nothing; give at least 1".into());
        }
        Ok(())
    }

    /// The bands that are computed, rising.
    pub(crate) fn wanted(&self) -> Vec<usize> {
        if self.has_maps() {
            return (1..=self.levels).collect();
        }
        let mut wanted: Vec<usize> = self.magnitudes.iter().chain(&self.vectors).copied().collect();
        wanted.sort_unstable();
        wanted.dedup();
        wanted
    }

    /// Whether anything is asked for that the bands of all tiles decide.
    pub(crate) fn has_maps(&self) -> bool {
        self.saliency.is_some() || self.theta.is_some()
    }

    /// The polynomials of the outputs: the change of the coordinates, where any gain is not 1, and the bands that are computed.
    pub(crate) fn series(&self) -> Result<Vec<FixedSeries>, TilesError> {
        let bands = FixedSeries::bands(&Schedule::dyadic(self.levels)?, self.accuracy)?;
        let mut series = Vec::new();
        if self.moves() {
            let factors: Vec<f64> = self.gains.iter().map(|gain| gain - 1.0).collect();
            series.push(FixedSeries::weighted(&bands, &factors));
        }
        series.extend(self.wanted().into_iter().map(|band| bands[band - 1].clone()));
        Ok(series)
    }

    /// Whether any coordinate changes.
    pub(crate) fn moves(&self) -> bool {
        self.denoise.is_some() || self.gains.iter().any(|&gain| gain != 1.0)
    }

    /// The names of the fields that the points get.
    pub(crate) fn fields(&self) -> Vec<String> {
        let lengths = self.magnitudes.iter().map(|band| format!("wavelet_{band}"));
        let vectors =
            self.vectors.iter().flat_map(|band| ["x", "y", "z"].map(|c| format!("wavelet_{band}_{c}")));
        lengths.chain(vectors).chain(self.saliency.map(|_| "saliency".to_owned())).collect()
    }

    /// Bytes of the fields of a point: 32-bit floats.
    pub(crate) fn field_bytes(&self) -> usize {
        4 * (self.magnitudes.len() + 3 * self.vectors.len() + usize::from(self.saliency.is_some()))
    }

    /// How many rings around a tile decide its result.
    pub(crate) fn reach(&self) -> Result<usize, TilesError> {
        if self.denoise.is_some() {
            return Ok(DenoiseChoice::reach()?);
        }
        let reach = self.series()?.iter().map(FixedSeries::reach).max().unwrap_or(0);
        if reach > MOST_RINGS {
            return Err(TilesError::Input(format!(
                "{} levels see {reach} rings, more than {MOST_RINGS}; ask for fewer",
                self.levels
            )));
        }
        Ok(reach)
    }

    /// What has no bearing on the result is left out: two runs that agree in the rest can share a folder.
    pub(crate) fn decides(&self) -> Self {
        Self { memory: 0, n_workers: 0, n_tiles: None, ..self.clone() }
    }
}

/// An input file, as it was when the work began.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Input {
    pub(crate) path: PathBuf,
    pub(crate) bytes: u64,
    pub(crate) n_points: u64,
    /// What is added to its whole coordinates, so that all inputs have one offset.
    pub(crate) shift: [i64; 3],
}

/// A work: what goes into it, what is asked for and how it is cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub(crate) inputs: Vec<Input>,
    pub(crate) layout: Layout,
    /// The box of all points: of a cloud that of its headers, in steps of the scale; of a mesh in model units. It orders the points
    /// and decides nothing else.
    pub(crate) bounds: ([f64; 3], [f64; 3]),
    pub(crate) params: Params,
    pub(crate) blocks_per_tile: usize,
    pub(crate) n_points: u64,
    /// Faces of a mesh.
    pub(crate) n_faces: u64,
}

/// What vertices and points of a kind of shape cost.
struct Cost {
    /// Bytes of memory for each vertex of a tile and its rings, measured. A tile that has more around it than was forecast is worked on
    /// in parts.
    vertex_bytes: u64,
    /// Rings of a tile's sides as vertices.
    vertices_per_ring: f64,
    /// Bytes of temporary files for each point.
    disk: u64,
}

/// Bytes of memory for each output of a vertex.
const OUTPUT_BYTES: u64 = 24;

/// Bytes of memory for each vertex of a cloud that is denoised, and each face of a mesh.
const DENOISED_CLOUD_BYTES: u64 = 1000;
const DENOISED_FACE_BYTES: u64 = 1050;

/// The same for each vertex of the blocks that the rings are searched in, and what is made of these.
const SEARCHED_BYTES: u64 = 220;

impl Cost {
    fn of(plan: &Plan) -> Self {
        let record_bytes = plan.layout.record_bytes() as u64;
        // Results as they are before the maps, and the lengths of all bands.
        let made = if plan.params.has_maps() { plan.row_bytes() + 4 * plan.params.levels } else { 0 };
        let made = made as u64;
        let denoises = plan.params.denoise.is_some();
        match plan.layout {
            // Neighbors reach further than the mean distance between vertices. On disk are the sorted records, once more while runs are
            // merged; or distances and neighbors, and sides.
            Layout::Las(_) => Self {
                vertex_bytes: if denoises { DENOISED_CLOUD_BYTES } else { 275 },
                vertices_per_ring: 1.8,
                disk: record_bytes
                    + record_bytes
                        .max(8 + 2 * plan.params.neighbors as u64 + made + if denoises { 5 } else { 0 }),
            },
            // The sorted records, faces, areas and neighbors, and results, once more while they are joined.
            Layout::Mesh(_) => {
                let faces_per_vertex = plan.n_faces.div_ceil(plan.n_points.max(1)).max(2);
                let results = 2 * plan.row_bytes() as u64 + made;
                Self {
                    vertex_bytes: if denoises {
                        DENOISED_FACE_BYTES * faces_per_vertex
                    } else {
                        110 + 40 * faces_per_vertex
                    },
                    vertices_per_ring: 1.3,
                    disk: record_bytes + record_bytes.max(18 * faces_per_vertex + 20 + results),
                }
            }
        }
    }
}

/// Boxes and their tree, each run's buffer, the program itself.
fn fixed_bytes(n_points: u64) -> u64 {
    200 * n_points.div_ceil(VERTICES_IN_A_BLOCK as u64) + (64 << 20)
}

/// What a work will take.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    /// Points of all inputs.
    pub n_points: u64,
    /// Tiles that these are cut into.
    pub n_tiles: usize,
    /// Points of a tile.
    pub points_per_tile: u64,
    /// Rings of neighbors around a tile that its result depends on.
    pub rings: usize,
    /// A tile with its rings, as a multiple of the tile: on a surface, about.
    pub share: f64,
    /// Bytes of memory that a tile takes at most, about.
    pub memory: u64,
    /// Bytes of temporary files at the most.
    pub disk: u64,
}

impl Plan {
    /// How the work is cut, and what it takes.
    pub(crate) fn cut(&self) -> Result<(usize, Forecast), TilesError> {
        let Self { params, n_points, .. } = self;
        let (n_points, cost) = (*n_points, Cost::of(self));
        let rings = params.reach()?;
        let per_vertex = self.bytes_per_vertex(&cost);
        let share = |m: f64| (1.0 + 2.0 * rings as f64 * cost.vertices_per_ring / m.sqrt()).powi(2);
        let taken = |m: f64| (m * share(m) * per_vertex as f64) as u64;
        let n_blocks = n_points.div_ceil(VERTICES_IN_A_BLOCK as u64);
        let fixed = fixed_bytes(n_points);
        let each = params.memory.saturating_sub(fixed) / params.n_workers as u64;
        let mut blocks = match params.n_tiles {
            Some(n_tiles) => n_blocks.div_ceil(n_tiles as u64).max(1),
            None => n_blocks.max(1),
        };
        let whole = (n_points as f64 * per_vertex as f64) as u64;
        let size = |blocks: u64| (blocks * VERTICES_IN_A_BLOCK as u64).min(n_points) as f64;
        if params.n_tiles.is_none() && whole > each && n_blocks > 1 {
            let (mut fits, mut too_many) = (1, n_blocks);
            while too_many - fits > 1 {
                let middle = fits.midpoint(too_many);
                if taken(size(middle)) <= each { fits = middle } else { too_many = middle }
            }
            // Equal tiles, so that none is left over.
            blocks = n_blocks.div_ceil(n_blocks.div_ceil(fits));
        }
        let memory = taken(size(blocks)).min(whole) * params.n_workers as u64 + fixed;
        let sample = n_points.min(MOST_SAMPLED as u64) * per_vertex + fixed;
        if params.denoise.is_some() && sample > params.memory {
            return Err(TilesError::Memory(format!(
                "the sample that the noise is estimated by takes about {} MB and {} MB may be used; allow more memory",
                sample >> 20,
                params.memory >> 20
            )));
        }
        if memory > params.memory {
            return Err(TilesError::Memory(format!(
                "tiles of {} points with {rings} rings around them take about {} MB and {} MB may be used; allow more memory{}",
                size(blocks),
                memory >> 20,
                params.memory >> 20,
                if params.n_tiles.is_some() {
                    ", ask for more tiles or none"
                } else {
                    " or ask for fewer levels"
                }
            )));
        }
        let n_tiles = n_blocks.div_ceil(blocks).max(1) as usize;
        let points_per_tile = size(blocks) as u64;
        let share = if n_tiles > 1 { share(points_per_tile as f64) } else { 1.0 };
        let disk = n_points * cost.disk;
        let forecast = Forecast { n_points, n_tiles, points_per_tile, rings, share, memory, disk };
        Ok((blocks as usize, forecast))
    }

    /// Bytes of a record as it comes out: of a mesh what the join is given for a vertex.
    pub(crate) fn row_bytes(&self) -> usize {
        match self.layout {
            Layout::Las(steps) => steps.record_bytes + self.params.field_bytes(),
            Layout::Mesh(_) => mesh::result_bytes(&self.params),
        }
    }

    /// Bytes of memory for each vertex of a tile and its rings, with its outputs and records.
    fn bytes_per_vertex(&self, cost: &Cost) -> u64 {
        let n_outputs = self.params.wanted().len() as u64 + 1;
        cost.vertex_bytes + OUTPUT_BYTES * n_outputs + 2 * self.layout.record_bytes() as u64
    }

    /// How far the part that decides a tile goes, and how large memory allows it to be.
    pub(crate) fn limits(&self) -> Result<Limits, TilesError> {
        let free = self.params.memory.saturating_sub(fixed_bytes(self.n_points));
        let each = free / self.params.n_workers.max(1) as u64;
        Ok(Limits {
            rings: self.params.reach()?,
            vertices: each / self.bytes_per_vertex(&Cost::of(self)),
            searched: each / SEARCHED_BYTES,
        })
    }

    /// The blocks of a tile.
    pub(crate) fn tile(&self, tile: usize, n_blocks: usize) -> Range<usize> {
        let first = tile * self.blocks_per_tile;
        first.min(n_blocks)..(first + self.blocks_per_tile).min(n_blocks)
    }

    pub(crate) fn n_tiles(&self, n_blocks: usize) -> usize {
        n_blocks.div_ceil(self.blocks_per_tile)
    }
}
