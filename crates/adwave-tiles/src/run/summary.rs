//! Statistics of a finished job, and the features of all its tiles.

use adwave::denoise::{DenoiseChoice, DenoiseInfo};
use adwave::features::Feature;
use adwave::shape::STRAY_NEIGHBORS;
use serde::{Deserialize, Serialize};

use crate::error::TilesError;
use crate::files::{read_json, write_json};
use crate::index::blocks::Blocks;
use crate::index::neighbor_index::NeighborIndex;
use crate::job::tiling_job::TilingJob;
use crate::stages::features::StoredFeature;
use crate::stages::totals::{BlockSums, LevelSummary, ShapeScale, Totals};

/// Statistics of a finished job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Summary {
    /// Number of points of all inputs, or of vertices in the file of a mesh.
    pub n_points: u64,
    /// Number of points that conditions or a mask leave out.
    pub n_unselected: u64,
    /// Number of points left out because they are flagged as withheld or classified as noise.
    pub n_flagged: u64,
    /// Number of points left out because their position stands for an unknown one.
    pub n_placeholders: u64,
    /// Number of distinct positions of a cloud that take no part because they are far from all others; 0 for a job that
    /// denoises.
    pub n_strays: u64,
    /// Number of distinct positions.
    pub n_vertices: u64,
    /// Number of faces of the mesh; a triangle strip in a PLY counts once.
    pub n_faces: u64,
    /// Number of tiles.
    pub n_tiles: usize,
    /// E: in a cloud the mean distance to a neighbor, in a mesh the mean length of edges; in model units.
    pub mean_length: f64,
    /// Root mean square of the distances that vertices moved, and the largest one, in model units.
    pub moved: [f64; 2],
    /// One entry per computed band.
    pub levels: Vec<LevelSummary>,
    /// Estimated noise and the denoising that was applied; `None` for a job that computes bands.
    pub noise: Option<DenoiseInfo>,
}

impl TilingJob {
    pub(crate) fn summary(
        &self,
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
    ) -> Result<Summary, TilesError> {
        let Totals { moved, n_far, n_members, levels } = self.totals(blocks, neighbor_index)?;
        let noise = match self.plan.params.denoise {
            Some(_) => Some(self.denoise_info(moved[1], n_far)?),
            None => None,
        };
        let shape = &self.plan.shape;
        Ok(Summary {
            n_points: shape.n_points,
            n_unselected: blocks.outsiders.unselected,
            n_flagged: blocks.outsiders.flagged,
            n_placeholders: blocks.outsiders.placeholders,
            n_strays: if shape.is_mesh() || noise.is_some() || blocks.n_vertices <= STRAY_NEIGHBORS as u64 {
                0
            } else {
                blocks.n_vertices.saturating_sub(n_members)
            },
            n_vertices: blocks.n_vertices,
            n_faces: shape.n_faces,
            n_tiles: self.plan.n_tiles(blocks.len()),
            mean_length: neighbor_index.mean_length * shape.layout.unit(),
            moved,
            levels,
            noise,
        })
    }

    /// Adds up the block sums of all tiles.
    fn totals(&self, blocks: &Blocks, neighbor_index: &NeighborIndex) -> Result<Totals, TilesError> {
        let n_tiles = self.plan.n_tiles(blocks.len());
        let sums = (0..n_tiles).map(|tile| read_json::<Vec<BlockSums>>(&self.folder.block_sums(tile)));
        let sums: Vec<Vec<BlockSums>> = sums.collect::<Result<_, _>>()?;
        let scale = ShapeScale {
            n_vertices: blocks.n_vertices,
            mean_length: neighbor_index.mean_length,
            unit: self.plan.shape.layout.unit(),
        };
        Totals::from_blocks(&self.plan.params, sums.into_iter().flatten(), scale)
    }

    /// Statistics of whole levels. The first task that needs them computes and stores them.
    pub(crate) fn levels(
        &self,
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
    ) -> Result<Vec<LevelSummary>, TilesError> {
        let path = self.folder.levels();
        if !path.exists() {
            write_json(&path, &self.totals(blocks, neighbor_index)?.levels)?;
        }
        read_json(&path)
    }

    /// Noise and denoising, with lengths in model units.
    fn denoise_info(&self, furthest: f64, n_far: u64) -> Result<DenoiseInfo, TilesError> {
        let DenoiseChoice { mut info, .. } = read_json(&self.folder.denoise_choice())?;
        let unit = self.plan.shape.layout.unit();
        if let Some(mesh) = &mut info.mesh {
            mesh.impulse_size *= unit;
            mesh.shared_at_most *= unit;
            mesh.shared *= unit;
            mesh.noise_range = mesh.noise_range.map(|level| level * unit);
        }
        let cloud = info.cloud.take().map(|cloud| cloud.in_units(unit));
        Ok(DenoiseInfo { noise: info.noise * unit, cloud, n_far: n_far as usize, furthest, ..info })
    }

    /// Features of all tiles from fine to coarse, the strongest of each level first. `vertex` is for a mesh the index
    /// in its file, for a cloud the index of the point in the joined tiles.
    ///
    /// # Errors
    /// If a tile is not done.
    pub fn features(&self) -> Result<Vec<Feature>, TilesError> {
        if self.plan.params.theta.is_none() {
            return Ok(Vec::new());
        }
        let blocks = self.blocks()?;
        let levels = self.levels(&blocks, &self.neighbor_index(&blocks)?)?;
        let n_tiles = self.plan.n_tiles(blocks.len());
        let mut all: Vec<StoredFeature> = Vec::new();
        for tile in 0..n_tiles {
            all.extend(read_json::<Vec<StoredFeature>>(&self.folder.features(tile))?);
        }
        all.sort_by(|a, b| {
            a.level
                .cmp(&b.level)
                .then(b.response.total_cmp(&a.response))
                .then(a.curve_index.cmp(&b.curve_index))
        });
        let feature = |stored: StoredFeature| Feature {
            vertex: stored.vertex as usize,
            position: Some(stored.position),
            level: stored.level,
            sigma: levels.get(stored.level.wrapping_sub(1)).map_or(0.0, |level| level.sigma),
            response: stored.response,
            strength: stored.response,
            channel: None,
        };
        Ok(all.into_iter().map(feature).collect())
    }
}
