//! A job: its folder, its plan, and the index once it is there.

use std::path::{Path, PathBuf};

use crate::error::TilesError;
use crate::files::read_json;
use crate::index::blocks::Blocks;
use crate::index::face_lists::{FaceFile, FaceFiles};
use crate::index::neighbor_index::{NeighborIndex, NeighborRule};
use crate::index::neighbor_lists::NeighborFile;
use crate::job::folder::WorkFolder;
use crate::job::forecast::halo_limits;
use crate::job::plan::Plan;
use crate::layout::{MAX_POINTS, RecordLayout};
use crate::stages::StageContext;

/// A job on one cloud or mesh: a work folder with a plan and the results so far.
#[derive(Debug)]
pub struct TilingJob {
    pub(crate) folder: WorkFolder,
    pub(crate) plan: Plan,
}

impl TilingJob {
    /// Opens the job of a folder.
    ///
    /// # Errors
    /// If the folder has no plan, or the plan is broken.
    pub fn open(folder: &Path) -> Result<Self, TilesError> {
        let folder = WorkFolder::new(folder);
        let path = folder.plan();
        if !path.exists() {
            return Err(TilesError::Input(format!("{} does not exist; plan the job first", path.display())));
        }
        let plan: Plan = read_json(&path)?;
        plan.params.check()?;
        let layout = &plan.shape.layout;
        let is_valid = plan.blocks_per_tile > 0
            && layout.record_bytes() >= layout.position_bytes()
            && plan.shape.n_points <= MAX_POINTS
            && !plan.shape.files.is_empty();
        if !is_valid {
            return Err(TilesError::broken(&path, "its numbers are inconsistent"));
        }
        Ok(Self { folder, plan })
    }

    /// Path of a tile's result: its points for a cloud, for a mesh the result rows that the join reads.
    pub fn tile(&self, tile: usize) -> PathBuf {
        self.folder.tile(tile, &self.plan.shape.layout)
    }

    /// Returns true if the input is a mesh.
    pub fn is_mesh(&self) -> bool {
        self.plan.shape.is_mesh()
    }

    /// Returns true if the job has a maps stage, which is then the last one before the join.
    pub fn has_maps(&self) -> bool {
        self.plan.params.has_maps()
    }

    /// Returns true if all points are sorted and the faces of a mesh are distributed. The number of tiles is known from
    /// then on.
    pub fn is_sorted(&self) -> bool {
        self.has_blocks() && (!self.is_mesh() || self.folder.face_file_lengths().exists())
    }

    pub(crate) fn has_blocks(&self) -> bool {
        self.folder.block_table().exists() && self.folder.records().exists()
    }

    /// Opens the index; an error before the sort.
    pub(crate) fn blocks(&self) -> Result<Blocks, TilesError> {
        if !self.is_sorted() {
            return Err(TilesError::Input(format!(
                "the points of the job in {} are not sorted; run its sort first",
                self.folder.path.display()
            )));
        }
        self.open_blocks()
    }

    /// Opens the index once the points are sorted, even if the faces are not distributed yet.
    pub(crate) fn open_blocks(&self) -> Result<Blocks, TilesError> {
        Blocks::open(&self.folder.block_table(), &self.folder.records(), self.plan.shape.layout)
    }

    /// Number of tiles.
    ///
    /// # Errors
    /// Before the sort.
    pub fn n_tiles(&self) -> Result<usize, TilesError> {
        Ok(self.plan.n_tiles(self.blocks()?.len()))
    }

    /// Opens the neighbor files of all tiles.
    pub(crate) fn neighbor_index(&self, blocks: &Blocks) -> Result<NeighborIndex, TilesError> {
        let n_tiles = self.plan.n_tiles(blocks.len());
        let open = |tile| {
            NeighborFile::open(&self.folder.neighbors(tile), &self.plan.blocks_of_tile(tile, blocks.len()))
        };
        let files = (0..n_tiles).map(open).collect::<Result<Vec<_>, _>>()?;
        let rule = match self.plan.shape.layout {
            RecordLayout::Las(_) => {
                let n_others = (blocks.n_vertices as usize).saturating_sub(1);
                NeighborRule::Nearest(self.plan.params.neighbors.min(n_others))
            }
            RecordLayout::Mesh(_) => NeighborRule::Edges,
        };
        Ok(NeighborIndex::new(files, blocks, self.plan.blocks_per_tile, rule))
    }

    /// The face files of all tiles.
    pub(crate) fn face_files(&self) -> Result<FaceFiles, TilesError> {
        let lengths: Vec<u64> = read_json(&self.folder.face_file_lengths())?;
        let file = |(tile, n_bytes)| FaceFile { path: self.folder.faces(tile), n_bytes };
        let files = lengths.into_iter().enumerate().map(file).collect();
        Ok(FaceFiles { files, blocks_per_tile: self.plan.blocks_per_tile })
    }

    pub(crate) fn context<'a>(
        &'a self,
        blocks: &'a Blocks,
        neighbor_index: &'a NeighborIndex,
    ) -> Result<StageContext<'a>, TilesError> {
        let Plan { shape, params, .. } = &self.plan;
        Ok(StageContext { shape, params, blocks, neighbor_index, limits: halo_limits(shape, params)? })
    }

    /// Deletes all temporary files, including those that killed processes left behind. The tiles stay.
    ///
    /// # Errors
    /// If a file cannot be deleted.
    pub fn clean(&self) -> Result<(), TilesError> {
        self.folder.clean()
    }

    /// Deletes the tiles, once they are joined.
    ///
    /// # Errors
    /// If a file cannot be deleted.
    pub fn remove_tiles(&self) -> Result<(), TilesError> {
        self.folder.remove_tiles()
    }
}
