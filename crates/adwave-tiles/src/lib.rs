//! Bands of point clouds and meshes that are larger than memory, tile by tile, with the bits of the whole.
//!
//! 1. **Sort** (`sort`): all points along a Hilbert curve, in runs that fit into memory and are merged. Points at one position are
//!    one vertex; every [`VERTICES_IN_A_BLOCK`] vertices are a block with a bounding box. A tile is a range of blocks.
//! 2. **Neighbors** (`neighbors`): the nearest neighbors of each tile's vertices, exact across its border: a vertex whose k-th
//!    neighbor is as far as another tile's box is compared with that tile's points too. E, the mean distance to a neighbor, is summed
//!    block by block, in an order that no tile decides.
//! 3. **Bands** (`bands`): a polynomial of degree d of Φ₁ sees d rings of neighbors. From a tile a breadth-first search over the
//!    stored neighborhoods goes as many rings as the polynomial sees, over as many blocks as these need; nothing is guessed in meters.
//!
//! 4. **Maps** (`maps`): what the numbers of whole levels decide, where it is asked for: the saliency map, and features.
//!
//! Noise is taken off positions (`denoise`) in place of bands where that is asked for: its weights are decided on a sample of the whole,
//! and the sides of a cloud's normals by a spanning tree over all tiles (`sides`).
//!
//! A row of T (eq. 1) is made of a vertex, its neighbors in the order of the curve, their areas and E; a step of the recurrence of
//! its row. Neither depends on the tile, so that all ways to cut a shape into tiles give the same bytes.
//!
//! A mesh (`mesh`) goes the same way: its faces are dealt out to the tiles that their corners lie in, neighbors and areas are those of the
//! faces, and the results are put back into the order of its file, of which everything else stays.
//!
//! Stages are files in a folder, each written under another name and renamed when it is whole: a run that was ended at any moment goes
//! on where it was.

mod bands;
mod blocks;
mod box_tree;
mod buckets;
mod cloud;
mod denoise;
mod error;
mod files;
mod layout;
mod made;
mod maps;
mod mesh;
mod names;
mod near_file;
mod neighbors;
mod outputs;
mod part;
mod plan;
mod run;
mod sides;
mod sort;
mod stretches;
mod terrain;
#[cfg(test)]
mod tests;
mod totals;
mod work;

pub use blocks::VERTICES_IN_A_BLOCK;
pub use error::TilesError;
pub use mesh::is_mesh;
pub use plan::{Forecast, MapKind, MapWeights, Params};
pub use run::{Summary, join, run, run_job};
pub use terrain::Terrain;
pub use totals::LevelSummary;
pub use work::{Job, Status, Work, forecast};
