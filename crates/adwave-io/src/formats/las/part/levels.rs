//! Levels of a cloud.

use std::fs::File;
use std::path::Path;

use adwave::Progress;

use crate::formats::las::part::octree::{Node, Root};
use crate::formats::las::part::selection::Selection;
use crate::formats::las::part::{copc, ept, folder_of_tiles, is_las, named};
use crate::formats::las::stream::LasReader;
use crate::{ReadError, ReadLimits};

/// Levels of a COPC or EPT. Level d adds its points to those of the coarser levels; together they are about spacing /
/// 2ᵈ apart.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudLevels {
    /// Distance of the points of level 0, in model units.
    pub spacing: f64,
    /// Number of points of each level, the coarsest first.
    pub n_points: Vec<u64>,
}

/// Reads the levels of a COPC (identified by its content) or an EPT (its folder, or the `ept.json` in it); `None` for
/// any other file.
///
/// Reads the whole hierarchy but no points: 32 bytes per node of a COPC.
///
/// # Errors
/// The file cannot be read, or is a damaged LAS, LAZ, COPC or EPT. The message is one line that begins with the
/// file's name.
///
/// ```
/// use adwave_io::{ReadLimits, ShapeFile, cloud_levels, write_path};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.laz");
/// write_path(&ShapeFile::from_cloud(vec![[0.0; 3]]), &path, None).unwrap();
/// assert_eq!(cloud_levels(&path, &ReadLimits::default()).unwrap(), None);
/// ```
pub fn cloud_levels(path: &Path, limits: &ReadLimits) -> Result<Option<CloudLevels>, ReadError> {
    levels(path, limits).map_err(|error| named(error, path))
}

fn levels(path: &Path, limits: &ReadLimits) -> Result<Option<CloudLevels>, ReadError> {
    let (all, progress) = (Selection::whole(), Progress::none());
    if let Some(folder) = folder_of_tiles(path) {
        let info = ept::Info::read(&folder, limits, progress)?;
        let nodes = ept::nodes(&folder, &info, &all, limits, progress)?;
        return Ok(Some(count(&info.root, &nodes)));
    }
    if !is_las(path)? {
        return Ok(None);
    }
    let reader = LasReader::open(path)?;
    let Some(info) = copc::Info::of(&reader)? else { return Ok(None) };
    let nodes = copc::nodes(&mut File::open(path)?, &reader, &info, &all, limits, progress)?;
    Ok(Some(count(&info.root, &nodes)))
}

fn count<P>(root: &Root, nodes: &[Node<P>]) -> CloudLevels {
    let mut n_points = Vec::new();
    for node in nodes {
        let level = node.key.depth as usize;
        n_points.resize(n_points.len().max(level + 1), 0);
        n_points[level] += node.n_points;
    }
    CloudLevels { spacing: root.spacing, n_points }
}
