//! The work folder of a job: the names of its files.

use std::path::{Path, PathBuf};

use crate::error::TilesError;
use crate::files::{NumberedName, is_temporary};
use crate::layout::RecordLayout;
use crate::stages::join::PART_NAME;
use crate::stages::sort::RUN_NAME;
use crate::stages::sort::faces::CORNERS_NAME;

const PLAN: &str = "plan.json";
const SORT_LOCK: &str = "sort.lock";
const BLOCK_TABLE: &str = "blocks.bin";
const RECORDS: &str = "records.bin";
const FACE_FILE_LENGTHS: &str = "faces.json";
const LEVELS: &str = "levels.json";
const DENOISE_CHOICE: &str = "choice.json";
const HEIGHT_FIT: &str = "fit.json";
const OPEN_PARTS: &str = "open.json";

const fn tile_name(prefix: &'static str, suffix: &'static str) -> NumberedName {
    NumberedName { prefix, n_digits: 5, suffix }
}

const NEIGHBORS: NumberedName = tile_name("near-", ".bin");
const SURFACE: NumberedName = tile_name("surface-", ".bin");
const FACES: NumberedName = tile_name("faces-", ".bin");
const ROWS_BEFORE_MAPS: NumberedName = tile_name("made-", ".bin");
const BAND_NORMS: NumberedName = tile_name("lengths-", ".bin");
const FEATURES: NumberedName = tile_name("features-", ".json");
const BLOCK_SUMS: NumberedName = tile_name("tile-", ".json");
const CLOUD_TILE: NumberedName = tile_name("tile-", ".laz");
const MESH_TILE: NumberedName = tile_name("tile-", ".bin");

/// A work folder. Every file is written under a temporary name and renamed, so that its presence means that it is
/// complete.
#[derive(Clone, Debug)]
pub(crate) struct WorkFolder {
    pub(crate) path: PathBuf,
}

impl WorkFolder {
    pub(crate) fn new(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    pub(crate) fn plan(&self) -> PathBuf {
        self.path.join(PLAN)
    }

    /// Lock of the process that sorts.
    pub(crate) fn sort_lock(&self) -> PathBuf {
        self.path.join(SORT_LOCK)
    }

    /// The block table, which is written after the sorted records.
    pub(crate) fn block_table(&self) -> PathBuf {
        self.path.join(BLOCK_TABLE)
    }

    /// The sorted records.
    pub(crate) fn records(&self) -> PathBuf {
        self.path.join(RECORDS)
    }

    /// Lengths of the face files; written after the face files.
    pub(crate) fn face_file_lengths(&self) -> PathBuf {
        self.path.join(FACE_FILE_LENGTHS)
    }

    /// Statistics of whole levels, for the maps.
    pub(crate) fn levels(&self) -> PathBuf {
        self.path.join(LEVELS)
    }

    /// Noise and weights that the sample decides.
    pub(crate) fn denoise_choice(&self) -> PathBuf {
        self.path.join(DENOISE_CHOICE)
    }

    /// Statistics of the fits of heights.
    pub(crate) fn height_fit(&self) -> PathBuf {
        self.path.join(HEIGHT_FIT)
    }

    /// Parts of a mesh with a border.
    pub(crate) fn open_parts(&self) -> PathBuf {
        self.path.join(OPEN_PARTS)
    }

    /// Normals and border flags of the vertices of a tile of a mesh.
    pub(crate) fn surface(&self, tile: usize) -> PathBuf {
        SURFACE.path(&self.path, tile as u64)
    }

    pub(crate) fn neighbors(&self, tile: usize) -> PathBuf {
        NEIGHBORS.path(&self.path, tile as u64)
    }

    pub(crate) fn faces(&self, tile: usize) -> PathBuf {
        FACES.path(&self.path, tile as u64)
    }

    /// Output rows of a tile without the saliency.
    pub(crate) fn rows_before_maps(&self, tile: usize) -> PathBuf {
        ROWS_BEFORE_MAPS.path(&self.path, tile as u64)
    }

    /// Norms of all bands at the vertices of a tile.
    pub(crate) fn band_norms(&self, tile: usize) -> PathBuf {
        BAND_NORMS.path(&self.path, tile as u64)
    }

    pub(crate) fn features(&self, tile: usize) -> PathBuf {
        FEATURES.path(&self.path, tile as u64)
    }

    /// Sums over the blocks of a tile.
    pub(crate) fn block_sums(&self, tile: usize) -> PathBuf {
        BLOCK_SUMS.path(&self.path, tile as u64)
    }

    /// The result of a tile.
    pub(crate) fn tile(&self, tile: usize, layout: &RecordLayout) -> PathBuf {
        let name = match layout {
            RecordLayout::Las(_) => CLOUD_TILE,
            RecordLayout::Mesh(_) => MESH_TILE,
        };
        name.path(&self.path, tile as u64)
    }

    /// Names of all files in the folder.
    pub(crate) fn file_names(&self) -> Result<Vec<String>, TilesError> {
        let entries = std::fs::read_dir(&self.path).map_err(TilesError::io(&self.path))?;
        Ok(entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
    }

    fn remove(&self, matches: impl Fn(&str) -> bool) -> Result<(), TilesError> {
        for name in self.file_names()?.iter().filter(|name| matches(name)) {
            let path = self.path.join(name);
            match std::fs::remove_file(&path) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(TilesError::io(&path)(e)),
                _ => {}
            }
        }
        Ok(())
    }

    /// Removes the files of tasks that were killed before the sort, except for runs.
    pub(crate) fn remove_before_sort(&self) -> Result<(), TilesError> {
        self.remove(|name| FACES.matches(name) || CORNERS_NAME.matches(name) || is_temporary(name))
    }

    pub(crate) fn remove_runs(&self) -> Result<(), TilesError> {
        self.remove(|name| RUN_NAME.matches(name))
    }

    pub(crate) fn remove_join_parts(&self) -> Result<(), TilesError> {
        self.remove(|name| PART_NAME.matches(name))
    }

    pub(crate) fn remove_tiles(&self) -> Result<(), TilesError> {
        self.remove(is_tile)
    }

    /// Removes all files but the tiles. Files whose presence means that others are complete are removed first, the plan
    /// last.
    pub(crate) fn clean(&self) -> Result<(), TilesError> {
        self.remove(|name| name == BLOCK_TABLE || name == FACE_FILE_LENGTHS)?;
        self.remove(|name| is_job_file(name) && name != PLAN && !is_tile(name) || is_temporary(name))?;
        self.remove(|name| name == PLAN)
    }
}

/// Returns true for the name of a tile's result.
fn is_tile(name: &str) -> bool {
    CLOUD_TILE.matches(name) || MESH_TILE.matches(name)
}

/// Returns true for names that the files of a job have.
pub(crate) fn is_job_file(name: &str) -> bool {
    const NAMES: [&str; 9] = [
        PLAN,
        SORT_LOCK,
        BLOCK_TABLE,
        RECORDS,
        FACE_FILE_LENGTHS,
        LEVELS,
        DENOISE_CHOICE,
        HEIGHT_FIT,
        OPEN_PARTS,
    ];
    const NUMBERED_NAMES: [NumberedName; 12] = [
        RUN_NAME,
        CORNERS_NAME,
        NEIGHBORS,
        SURFACE,
        FACES,
        ROWS_BEFORE_MAPS,
        BAND_NORMS,
        FEATURES,
        BLOCK_SUMS,
        CLOUD_TILE,
        MESH_TILE,
        PART_NAME,
    ];
    NAMES.contains(&name) || NUMBERED_NAMES.iter().any(|numbered| numbered.matches(name))
}
