//! Memory and disk space of a job, and the size of its tiles.

use serde::{Deserialize, Serialize};

use crate::error::TilesError;
use crate::halo::HaloLimits;
use crate::index::blocks::VERTICES_IN_A_BLOCK;
use crate::layout::RecordLayout;
use crate::params::{Movement, Params};
use crate::sources::input_shape::InputShape;
use crate::stages::denoise::MAX_SAMPLE_VERTICES;
use crate::stages::motion::SURFACE_ROW_BYTES;
use crate::stages::output_row_bytes;

/// Estimated cost of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Forecast {
    /// Number of points of all inputs.
    pub n_points: u64,
    /// Number of tiles.
    pub n_tiles: usize,
    /// Number of points of a tile, without its halo.
    pub points_per_tile: u64,
    /// Number of rings in the halo of a tile.
    pub rings: usize,
    /// Size of a tile with its halo, as a multiple of the tile; an estimate for surfaces.
    pub share: f64,
    /// Bytes of memory at most, an estimate.
    pub memory: u64,
    /// Bytes of temporary files at most, an estimate.
    pub disk: u64,
}

/// Size of the tiles, and the cost of the job with tiles of this size.
pub(crate) struct Tiling {
    pub(crate) blocks_per_tile: usize,
    pub(crate) forecast: Forecast,
}

/// Bytes of memory per vertex for each output.
const OUTPUT_BYTES: u64 = 24;

/// Bytes of memory per vertex of a cloud, measured.
const CLOUD_VERTEX_BYTES: u64 = 275;
const DENOISED_CLOUD_VERTEX_BYTES: u64 = 1000;

/// Bytes of memory per vertex and per face of a mesh, measured.
const MESH_VERTEX_BYTES: u64 = 110;
const MESH_FACE_BYTES: u64 = 40;
const DENOISED_MESH_FACE_BYTES: u64 = 1050;

/// Bytes of memory per vertex of the blocks in which a halo is searched, including the data computed from them.
const LOADED_VERTEX_BYTES: u64 = 220;

/// Cost of the vertices and points of a shape.
struct Cost {
    /// Bytes of memory per vertex of a tile with its halo, with its outputs and records. A tile whose halo is larger
    /// than the forecast is computed in parts.
    vertex_bytes: u64,
    /// Width of a ring, in mean distances between vertices.
    ring_width: f64,
    /// Bytes of temporary files per point.
    disk_bytes: u64,
}

impl Cost {
    fn new(shape: &InputShape, params: &Params) -> Self {
        let record_bytes = shape.layout.record_bytes() as u64;
        let row_bytes = output_row_bytes(shape, params) as u64;
        // Rows without the saliency, and the norms of all bands.
        let map_bytes = if params.has_maps() { row_bytes + 4 * params.levels as u64 } else { 0 };
        let denoises = params.denoise.is_some();
        let (vertex_bytes, ring_width, disk_bytes) = match shape.layout {
            // Neighbors are farther away than the mean distance between vertices. The disk has the sorted records, and
            // either their runs or distances and neighbor lists.
            RecordLayout::Las(_) => {
                let stage_bytes = 8 + 2 * params.neighbors as u64 + map_bytes;
                let vertex_bytes = if denoises { DENOISED_CLOUD_VERTEX_BYTES } else { CLOUD_VERTEX_BYTES };
                (vertex_bytes, 1.8, record_bytes + record_bytes.max(stage_bytes))
            }
            // The disk has the sorted records, and either their runs or faces, areas, neighbor lists and results, these
            // twice during the join.
            RecordLayout::Mesh(_) => {
                let faces_per_vertex = shape.n_faces.div_ceil(shape.n_points.max(1)).max(2);
                let stage_bytes = 18 * faces_per_vertex + 20 + 2 * row_bytes + map_bytes;
                let vertex_bytes = if denoises {
                    DENOISED_MESH_FACE_BYTES * faces_per_vertex
                } else {
                    MESH_VERTEX_BYTES + MESH_FACE_BYTES * faces_per_vertex
                };
                (vertex_bytes, 1.3, record_bytes + record_bytes.max(stage_bytes))
            }
        };
        let n_outputs = params.computed_bands().len() as u64 + 1;
        let (motion_bytes, surface_bytes) = motion_cost(shape, params);
        let vertex_bytes = vertex_bytes + OUTPUT_BYTES * n_outputs + 2 * record_bytes + motion_bytes;
        Self { vertex_bytes, ring_width, disk_bytes: disk_bytes + surface_bytes }
    }

    /// Size of a tile of `n` vertices with its halo, as a multiple of the tile.
    fn halo_factor(&self, n: f64, n_rings: usize) -> f64 {
        (1.0 + 2.0 * n_rings as f64 * self.ring_width / n.sqrt()).powi(2)
    }

    /// Bytes of memory for a tile of `n` vertices with its halo.
    fn tile_bytes(&self, n: f64, n_rings: usize) -> u64 {
        (n * self.halo_factor(n, n_rings) * self.vertex_bytes as f64) as u64
    }
}

/// Bytes of memory of a vertex of a tile with its halo for the directions in which it moves, and bytes of temporary
/// files.
fn motion_cost(shape: &InputShape, params: &Params) -> (u64, u64) {
    /// Normals before and after a step.
    const NORMAL_BYTES: u64 = 48;
    if params.denoise.is_some() || !params.changes_positions() {
        return (0, 0);
    }
    if params.moves_heights() {
        let n_values = params.height_series().map_or(0, |series| series.n_values());
        return (8 * n_values as u64, 0);
    }
    match params.movement(shape.is_mesh()) {
        Movement::Free => (0, 0),
        Movement::Directed(direction) if direction.axis().is_some() => (0, 0),
        _ if shape.is_mesh() => (NORMAL_BYTES, SURFACE_ROW_BYTES as u64),
        _ => (NORMAL_BYTES, 0),
    }
}

/// Bytes of memory that do not depend on the tiles: the block table with its tree, buffers, the program itself.
fn fixed_bytes(n_points: u64) -> u64 {
    200 * n_points.div_ceil(VERTICES_IN_A_BLOCK as u64) + (64 << 20)
}

/// Chooses the size of the tiles: the requested number, or the fewest that fit into memory.
pub(crate) fn choose_tiling(shape: &InputShape, params: &Params) -> Result<Tiling, TilesError> {
    let (n_points, cost) = (shape.n_points, Cost::new(shape, params));
    let rings = params.n_rings(shape.is_mesh())?;
    let n_blocks = n_points.div_ceil(VERTICES_IN_A_BLOCK as u64);
    let fixed = fixed_bytes(n_points);
    let worker_memory = params.memory.saturating_sub(fixed) / params.n_workers as u64;
    let bytes_of_all = (n_points as f64 * cost.vertex_bytes as f64) as u64;
    let tile_points = |blocks: u64| (blocks * VERTICES_IN_A_BLOCK as u64).min(n_points);
    let tile_bytes = |blocks: u64| cost.tile_bytes(tile_points(blocks) as f64, rings);
    let mut blocks = match params.n_tiles {
        Some(n_tiles) => n_blocks.div_ceil(n_tiles as u64).max(1),
        None => n_blocks.max(1),
    };
    if params.n_tiles.is_none() && bytes_of_all > worker_memory && n_blocks > 1 {
        let (mut fitting, mut too_many) = (1, n_blocks);
        while too_many - fitting > 1 {
            let middle = fitting.midpoint(too_many);
            if tile_bytes(middle) <= worker_memory { fitting = middle } else { too_many = middle }
        }
        // Tiles of equal size, so that the last one is not small.
        blocks = n_blocks.div_ceil(n_blocks.div_ceil(fitting));
    }
    let memory = tile_bytes(blocks).min(bytes_of_all) * params.n_workers as u64 + fixed;
    let sample = n_points.min(MAX_SAMPLE_VERTICES as u64) * cost.vertex_bytes + fixed;
    if params.denoise.is_some() && sample > params.memory {
        return Err(TilesError::Memory(format!(
            "the sample for the noise estimate needs about {} MB, but only {} MB may be used; allow more memory",
            sample >> 20,
            params.memory >> 20
        )));
    }
    if memory > params.memory {
        return Err(TilesError::Memory(format!(
            "tiles of {} points with {rings} rings around them need about {} MB, but only {} MB may be used; allow more memory{}",
            tile_points(blocks),
            memory >> 20,
            params.memory >> 20,
            if params.n_tiles.is_some() {
                ", request more tiles or leave their number out"
            } else {
                " or request fewer levels"
            }
        )));
    }
    let n_tiles = n_blocks.div_ceil(blocks).max(1) as usize;
    let points_per_tile = tile_points(blocks);
    let share = if n_tiles > 1 { cost.halo_factor(points_per_tile as f64, rings) } else { 1.0 };
    let disk = n_points * cost.disk_bytes;
    let forecast = Forecast { n_points, n_tiles, points_per_tile, rings, share, memory, disk };
    Ok(Tiling { blocks_per_tile: blocks as usize, forecast })
}

/// Number of halo rings, and the numbers of vertices that the memory of a worker allows.
pub(crate) fn halo_limits(shape: &InputShape, params: &Params) -> Result<HaloLimits, TilesError> {
    let free = params.memory.saturating_sub(fixed_bytes(shape.n_points));
    let worker_memory = free / params.n_workers.max(1) as u64;
    Ok(HaloLimits {
        n_rings: params.n_rings(shape.is_mesh())?,
        max_vertices: worker_memory / Cost::new(shape, params).vertex_bytes,
        max_loaded: worker_memory / LOADED_VERTEX_BYTES,
    })
}
