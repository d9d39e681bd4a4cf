//! Bands of point clouds and meshes that are larger than memory, tile by tile, bit-identical to a computation in one
//! piece.
//!
//! A tile is an *interior*, a range of the sorted vertices, plus a *halo*: the rings of neighbors around it that its
//! result depends on. The stages of a job, in order:
//!
//! 1. **Sort**: all points are sorted along a Hilbert curve, in runs that fit into memory and are then merged. Points
//!    at one position are one vertex. Every [`VERTICES_IN_A_BLOCK`] vertices form a block with a bounding box, and a
//!    tile is a range of blocks. The faces of a mesh are distributed to the tiles of their corners.
//! 2. **Neighbors**: the nearest neighbors of each vertex of a cloud, exact across the borders of tiles, or the
//!    one-ring of each vertex of a mesh. E, the mean distance between neighbors, is summed block by block.
//! 3. **Bands**: a polynomial of degree d of Φ₁ depends on d rings of neighbors. A breadth-first search over the stored
//!    neighbor lists collects this halo. A job that denoises moves the positions instead; its weights are chosen on a
//!    sample of the whole shape.
//! 4. **Maps**, only for saliency and features: these depend on statistics of whole levels.
//! 5. **Join**: the tiles in one file.
//!
//! A row of T (eq. 1) depends on a vertex, its neighbors in the order of the curve, their areas and E, and a step of
//! the recurrence depends on its row. Neither depends on the tile, so that every division into tiles gives the same
//! bytes.
//!
//! Each task writes one file under a temporary name and renames it when it is complete. A job that was interrupted
//! continues where it stopped.

mod bounds;
mod bytes;
mod error;
mod files;
mod halo;
mod index;
mod job;
mod layout;
mod params;
mod run;
mod sources;
mod stages;
mod terrain;
#[cfg(test)]
mod tests;
mod vector;

pub use error::TilesError;
pub use index::blocks::VERTICES_IN_A_BLOCK;
pub use job::begin::forecast;
pub use job::forecast::Forecast;
pub use job::status::{Status, Task};
pub use job::tiling_job::TilingJob;
pub use params::{MapKind, MapWeights, Params, TileSelection};
pub use run::{Summary, join, run, run_task};
pub use sources::mesh::is_mesh;
pub use stages::totals::LevelSummary;
pub use terrain::Terrain;
