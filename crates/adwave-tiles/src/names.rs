//! The files of a work's folder, by their names.

use std::path::{Path, PathBuf};

use crate::TilesError;
use crate::files::TEMPORARY;

/// The name of the plan in its folder.
pub(crate) const PLAN: &str = "plan.json";
/// Held by who sorts.
pub(crate) const LOCK: &str = "sort.lock";
/// The table of blocks, whose presence says that the sort is done, and the sorted records.
pub(crate) const TABLE: &str = "blocks.bin";
pub(crate) const RECORDS: &str = "records.bin";
/// The lengths of the files of faces, whose presence says that these are whole.
pub(crate) const FACES: &str = "faces.json";
/// Numbers of whole levels, for the maps.
pub(crate) const LEVELS: &str = "levels.json";

/// What a sample decides of the noise.
pub(crate) const CHOICE: &str = "choice.json";
/// Which pieces of a cloud are turned, over all tiles.
pub(crate) const SIDES: &str = "sides.bin";

/// The names of the files of a folder.
pub(crate) fn names(folder: &Path) -> Result<Vec<String>, TilesError> {
    let entries = std::fs::read_dir(folder).map_err(TilesError::io(folder))?;
    Ok(entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
}

pub(crate) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1)
}

/// `before-00012.after`, with any number.
fn is_numbered(name: &str, before: &str, after: &str) -> bool {
    let number = name.strip_prefix(before).and_then(|rest| rest.strip_suffix(after));
    number.is_some_and(|n| !n.is_empty() && n.bytes().all(|c| c.is_ascii_digit()))
}

/// Some records of a cloud, sorted. Name and length say which points are in it, whatever the length of other runs.
pub(crate) fn run(folder: &Path, first: u64) -> PathBuf {
    folder.join(format!("run-{first:010}.bin"))
}

pub(crate) fn is_run(name: &str) -> bool {
    is_numbered(name, "run-", ".bin")
}

pub(crate) fn is_tile(name: &str) -> bool {
    is_numbered(name, "tile-", ".laz") || is_numbered(name, "tile-", ".bin")
}

/// Faces of a tile, or corners on the way to them.
pub(crate) fn is_faces(name: &str) -> bool {
    is_numbered(name, "faces-", ".bin") || is_numbered(name, "corners-", ".bin")
}

/// Results of a mesh that are being joined.
pub(crate) fn is_part(name: &str) -> bool {
    is_numbered(name, "part-", ".bin")
}

/// Whether a work has a file of that name.
pub(crate) fn is_own(name: &str) -> bool {
    [PLAN, LOCK, TABLE, RECORDS, FACES, LEVELS, CHOICE, SIDES].contains(&name)
        || is_run(name)
        || is_tile(name)
        || is_faces(name)
        || is_part(name)
        || is_numbered(name, "near-", ".bin")
        || is_numbered(name, "sides-", ".bin")
        || is_numbered(name, "tile-", ".json")
        || is_numbered(name, "made-", ".bin")
        || is_numbered(name, "lengths-", ".bin")
        || is_numbered(name, "features-", ".json")
}
